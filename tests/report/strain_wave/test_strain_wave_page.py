"""The page of a strain wave gearing: its teeth move as kinematics say, drawings are to scale."""

import math
import re
from dataclasses import replace

import front_cases
import numpy as np
import pytest
from page_reader import Reader

from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.optimise.pareto.objectives import Objective
from gearopt.optimise.typed import typed
from gearopt.report.answer import decided, limits
from gearopt.report.drawing.sheet import Row
from gearopt.report.front import heads
from gearopt.report.headline import of_limits
from gearopt.report.kinds.strain_wave import (
    cutter,
    loaded_teeth,
    moving,
    numbers,
    search,
    shift,
    tiles,
    warns,
)
from gearopt.report.kinds.strain_wave.cutter import drawing
from gearopt.report.kinds.strain_wave.motion import drawn, running
from gearopt.report.kinds.strain_wave.tables import sizes
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.frame import templates
from gearopt.report.pages.result import page, tables
from gearopt.report.words import goal_words


@pytest.fixture(scope="module")
def result(solved):
    return solved("strain_wave_base")


@pytest.fixture(scope="module")
def found(result):
    return typed(WaveDesign, result.design)


def test_the_first_sentence_has_the_digits_of_the_tables_in_inches(result, found):
    pressure = INCH.amount(found.shared_pressure_MPa, "MPa")
    assert decided(result, INCH).endswith(f"a contact pressure of up to {pressure}.")
    assert pressure.removesuffix(" psi") in page(result, "gearopt solve x.toml", INCH)
    overlapping = replace(result, design=result.design | {"least_clearance_mm": -0.0123456})
    assert "teeth overlap by 0.486 mil, at" in warns(overlapping, INCH)[0]


@pytest.mark.parametrize(
    ("over", "said"),
    [
        ({"ratcheting": 1.183}, "The given design exceeds the limit on ratcheting by 18 %; "),
        (
            {"pairs": 1.053, "ratcheting": 1.038, "rim_fatigue": 0.5},
            "The given design exceeds the limits on conjugate pairs by 5.3 % and ratcheting by "
            "3.8 %; ",
        ),
        ({"rim_fatigue": 1.024}, "The given design exceeds the limit on rim fatigue by 2.4 %; "),
        ({}, ""),
    ],
)
def test_the_first_sentence_names_the_limits_that_are_exceeded(result, over, said):
    loads = decided(result)
    words = decided(replace(result, limits=result.limits | over))
    assert words.lower() == f"{said}{loads}".lower() and words.startswith(said)


def test_a_limit_that_is_far_away_is_unused(result):
    far = replace(result, limits=result.limits | {"flexspline_space": -0.456})
    section = limits(far, METRIC)
    (row,) = [r for r in section.tables[0].rows if r[0] == "flexspline space"]
    assert (row[-1].text, row[-1].value) == ("unused", pytest.approx(-45.6))
    assert section.words[-1].startswith("Unused: the limit is farther away than ")
    assert not any("Unused" in words for words in limits(result, METRIC).words)
    assert of_limits(replace(result, limits={"minor_axis": -0.2})) == "no limit is active"


def test_sizes_have_no_zeros_that_say_nothing(found):
    wide = replace(found, face_width_mm=10_000.0, rim_mm=0.8, module_mm=0.512345)
    rows = {row[0].text: row[1].text for row in sizes(wide, METRIC).on_page[1]}
    assert rows["face width [mm]"] == "10,000" and rows["rim [mm]"] == "0.8"
    assert rows["module [mm]"] == "0.5123"


@pytest.fixture(scope="module")
def animation(found):
    return running(found, "runs", METRIC)


def teeth_of(animation, view):
    bodies = animation.views[view].bodies
    return [body for body in bodies if body.title == "tooth of the flexspline"]


def placed(body, moment):
    """Outline of a body at a moment, by a rotation written out."""
    x, y, angle = np.asarray(body.places)[moment]
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return np.asarray(body.outline) @ turn.T + (x, y)


def test_all_teeth_stand_on_a_curve_of_the_right_length(animation, found):
    """Feet of 160 teeth at one moment: even arcs, perimeter 2 pi R_m, radii R_m +- 0.5 mm."""
    teeth = teeth_of(animation, 0)
    assert len(teeth) == 160
    for moment in (0, 37, 72):
        feet = np.array([np.asarray(b.places)[moment, :2] for b in teeth])
        steps = np.hypot(*(np.roll(feet, -1, axis=0) - feet).T)
        assert steps == pytest.approx(np.full(160, steps.mean()), rel=2e-4)
        assert steps.sum() == pytest.approx(math.pi * found.neutral_diameter_mm, rel=2e-4)
        radii = np.hypot(*feet.T)
        assert radii.max() == pytest.approx(found.neutral_diameter_mm / 2 + 0.5, abs=2e-3)
        assert radii.min() == pytest.approx(found.neutral_diameter_mm / 2 - 0.5, abs=2e-2)


def test_after_half_a_turn_the_next_tooth_is_in_the_place_of_the_last(animation):
    teeth = teeth_of(animation, 0)
    for k in (0, 40, 159):
        last, first = placed(teeth[k], -1), placed(teeth[(k + 1) % 160], 0)
        before = placed(teeth[(k - 1) % 160], 0)
        off = min(np.abs(last - first).max(), np.abs(last - before).max())
        assert off < 1e-9


def test_no_tooth_in_the_drawing_cuts_the_circular_spline(animation, found):
    """Corners of every tooth at every tenth moment against the involute, written out."""
    base = 0.5 * found.base_diameter_mm
    alpha, shift, z = math.radians(found.pressure_angle_deg), found.profile_shift, 162
    eta = (math.pi / 2 + 2 * shift * math.tan(alpha)) / z + math.tan(alpha) - alpha
    for body in teeth_of(animation, 1):
        for moment in range(0, 145, 12):
            x, y = placed(body, moment).T
            radius = np.hypot(x, y)
            inside = radius > 0.5 * found.tip_diameter_mm
            angle = np.mod(np.arctan2(x, y)[inside] + math.pi / z, 2 * math.pi / z) - math.pi / z
            t = np.sqrt((radius[inside] / base) ** 2 - 1.0)
            room = base * (eta - (t - np.arctan(t)) - np.abs(angle))
            assert room.size == 0 or room.min() > -2e-6


def test_colours_are_the_loads_of_the_table(animation, found):
    """A tooth at a place of the wave has the load that the table of teeth has there."""
    body = next(b for b in teeth_of(animation, 1) if np.nanmax(b.values) > 0.0)
    assert np.max(body.values) == pytest.approx(max(found.load_N), rel=0.02)
    assert np.min(body.values) == 0.0
    assert animation.scale.high >= max(found.load_N)


def test_the_output_falls_back_by_a_tooth_in_half_a_turn(animation):
    readings = {r.name: np.asarray(r.values) for r in animation.readings}
    assert np.ptp(readings["wave generator"]) == pytest.approx(180.0)
    assert np.ptp(readings["output"]) == pytest.approx(360.0 / 160.0)
    seen = readings["tooth at the top: angle on the wave"]
    assert np.nanmin(np.abs(seen)) < 1.3 and np.isnan(seen).any()


def test_the_cutter_is_drawn_to_scale_on_its_grid(result, found):
    section = cutter(result, METRIC)
    svg = section.drawings[0].svg
    path = re.search(r'class="tip"[^>]* d="M ([^Z]*) Z"', svg) or re.search(
        r'd="M ([^Z]*) Z"[^>]*class="tip"', svg
    )
    points = np.array([[float(v) for v in p.split()] for p in path[1].split(" L ")])
    edge = points[: len(found.cutter.x_mm)]
    across = np.ptp(np.array(found.cutter.y_mm)) * 100.0 * 96.0 / 25.4
    up = np.ptp(np.array(found.cutter.x_mm)) * 100.0 * 96.0 / 25.4
    assert np.ptp(edge[:, 0]) == pytest.approx(across, abs=0.01)
    assert np.ptp(edge[:, 1]) == pytest.approx(up, abs=0.01)
    whole = np.ptp(points[:, 0]) / (100.0 * 96.0 / 25.4)
    root, tip = found.cutter.y_mm[0], found.cutter.y_mm[-1]
    assert whole == pytest.approx(math.pi * 0.5 - 2 * min(root, tip), rel=1e-4)
    names = [table.name for table in section.tables]
    assert names == ["cutting edges", "points of the cutting edge"]
    lines = section.tables[1].csv().splitlines()
    assert len(lines) == 52 and lines[0] == "x [mm],y [mm]"


def test_a_cutter_never_shrinks_and_fits_a_sheet_by_default(result, found):
    """2.9 mm at 50:1 are 145 mm, at 100:1 290 mm: more than an A4 sheet has, so one of its own."""
    wide = cutter(result, METRIC)
    drawn_wide = wide.drawings[0]
    assert drawn_wide.true and drawn_wide.width / 96.0 * 25.4 == pytest.approx(306.4, abs=1.0)
    told = result.report | {"cutter_drawing": {"scale": None, "grid_mm": 0.05}}
    narrow = cutter(replace(result, report=told), METRIC).drawings[0]
    assert "50:1" in narrow.caption and narrow.width / 96.0 * 25.4 < 180.0
    row = templates().get_template("row.html").module.row
    shown = [row(Row([one])) for one in (drawn_wide, narrow)]
    assert 'class="true wide"' in shown[0] and "@page sheet" in shown[0]
    assert 'class="true"' in shown[1] and "@page" not in shown[1]
    numbers_at = re.findall(r'<text class="size"[^>]*>(-?[0-9.]+)</text>', narrow.svg)
    assert {"0.000", "0.500", "-0.500"} <= set(numbers_at)


@pytest.mark.slow
def test_a_drawing_beyond_all_paper_is_left_out(result):
    report = result.report | {"cutter_drawing": {"scale": 1e9, "grid_mm": 0.1}}
    section = cutter(replace(result, report=report), METRIC)
    assert not section.drawings and "No drawing: at 1e+09:1 it would be" in section.words[-1]


@pytest.mark.slow
def test_the_grid_of_a_high_or_wide_cutter_has_few_lines(found):
    """Edges 1 m high, or 10 km wide, on a grid of 0.05 mm: at most 62 lines either way."""
    for high, wide in ((1e3, 1.0), (1.0, 1e7)):
        x, y = (
            np.multiply(v, f) for v, f in ((found.cutter.x_mm, high), (found.cutter.y_mm, wide))
        )
        edge = replace(found.cutter, x_mm=tuple(x), y_mm=tuple(y), straight_deg=0.0)
        svg = drawing(edge, wide * math.pi * 0.5, 1e-3, 0.05, METRIC).svg
        assert 4 < len(re.findall('class="(grid|extension)"', svg)) <= 2 * 62


def test_sections_say_what_was_found(result, found):
    told = {tile.name: tile for tile in tiles(result, METRIC)}
    assert told["teeth that carry"].value == "6 per lobe"
    assert "117.38 MPa" in told["contact pressure, load shared"].remark
    assert not warns(result) and search(result, METRIC) is None
    mesh = moving(result, METRIC)
    assert [f.follows for f in mesh.figures] == [mesh.animations[0].name] * 2
    curve = shift(result, METRIC).figures[0].data
    assert "always touch carries" in shift(result, METRIC).figures[0].caption
    own = replace(result, design=result.design | {"largest_addendum": 0.89998})
    assert "With an addendum above about 0.90 modules" in shift(own, METRIC).words[-1]
    assert (
        shift(own, METRIC).words[-1].endswith("(sought at steps of 0.25° of the wave generator).")
    )
    assert (
        "generates the flank to rounding; its edge has no cusp" in cutter(result, METRIC).words[0]
    )
    assert [line["name"] for line in curve] == ["conjugate pairs", "whole pairs", "load shared"]
    assert all(np.all(np.diff(line["y"]) < 0.0) for line in curve)
    sizes = dict((row[0], row[1]) for row in numbers(result, METRIC).tables[0].rows)
    assert sizes["teeth of the flexspline"].value == 160
    built = {
        "flexspline, undeformed: tip diameter [mm]": 79.25 + 2.0 * 1.12856,
        "root diameter of the flexspline [mm]": 80.05,
        "bore of the flexspline [mm]": 78.45,
        "wave generator: major diameter [mm]": 79.45,
    }
    assert {name: sizes[name].value for name in built} == pytest.approx(built, abs=2e-5)
    minor = sizes["minor diameter [mm]"].value
    assert 77.4 < minor < 77.45  # 2 (39.625 - 0.5 - 0.4) less the 13 um by which its length is kept


@pytest.mark.parametrize(
    ("pressures", "told"),
    [((3.0, 2.0, 1.0), "falls"), ((1.0, 2.0, 3.0), ""), ((3.0, 1.0, 2.0), "")],
)
def test_pressures_fall_with_the_shift_only_where_all_of_them_do(result, pressures, told):
    """Equal and whole pressures fall in all cases; a shared one may rise, or have a minimum."""
    three = result.design["shifts"][:3]
    rows = [row | {"shared_MPa": p} for row, p in zip(three, pressures, strict=True)]
    words = shift(replace(result, design=result.design | {"shifts": rows}), METRIC).words
    assert not any("has a minimum" in word for word in words)
    assert [w for w in words if "every contact pressure" in w] == (
        [f"Over the shifts shown every contact pressure {told} as the shift grows."] if told else []
    )


def test_the_stress_of_the_teeth_has_one_name(result):
    """On its page, in all tables, and as an objective, in fronts and comparisons, too."""
    shown = Reader(page(replace(result, asked={}), "x")).text
    shown += tables(result).values()
    before = re.findall(r"(\w*)\W*\bpressures?\b(?!.angle)", " ".join(shown), re.IGNORECASE)
    assert len(before) > 8 and set(map(str.lower, before)) == {"contact"}
    name = "contact pressure of conjugate pairs"
    assert goal_words("pressure", "strain_wave") == name != goal_words("pressure", None)
    made = replace(
        front_cases.own(), scene="strain_wave", objectives=(Objective("pressure", "MPa"),)
    )
    assert heads(made, METRIC) == (f"{name} [MPa]",)


def test_the_gearing_of_a_report_is_the_one_it_was_made_of(found):
    gearing = drawn(found).gearing
    assert 2.0 * gearing.neutral_radius == pytest.approx(found.neutral_diameter_mm, rel=1e-14)
    assert 2.0 * gearing.tip_radius == pytest.approx(found.tip_diameter_mm, rel=1e-14)


def test_a_cutter_with_a_cusp_and_teeth_that_cut_are_warned_of(result):
    """The result of the base file with a clearance below 0 and a cutter without an edge."""
    cusp = {k: result.design["cutter"][k] for k in ("pitch_radius_mm", "least_teeth")}
    cusp |= {"teeth": 8, "cutter_radius_mm": 2.0, "regular": False, "least_speed": -1.7}
    own = replace(result, design=result.design | {"least_clearance_mm": -0.031, "cutter": cusp})
    first, second = warns(own)
    assert "overlap by 3" in first and "have a cusp" in second
    assert not cutter(own, METRIC).drawings
    assert "would have a cusp" in cutter(own, METRIC).words[0]


def test_teeth_without_a_load_have_clearances_and_no_colours(result):
    """As of face widths of ten million kilometres, where loads are rounding."""
    none = [0.0 for _ in result.design["load_N"]]
    section = moving(replace(result, design=result.design | {"load_N": none}), METRIC)
    assert len(section.figures) == 1 and not section.animations and section.tables


def test_the_terminal_shows_some_of_many_teeth_evenly(result):
    """Tooth 0 and every third of 61; all 12 of a short table, which the page has whole."""
    whole = result.design["teeth"]
    (table,) = loaded_teeth(result, METRIC).terminal
    assert [row[0].value for row in table.rows] == [tooth["tooth"] for tooth in whole]
    many = [whole[0] | {"tooth": number} for number in range(-30, 31)]
    long = replace(result, design=result.design | {"teeth": many})
    table, words = loaded_teeth(long, METRIC).terminal
    assert [row[0].value for row in table.rows] == [*range(-30, 31, 3)]
    assert words.startswith("Some of the teeth")
    assert len(moving(long, METRIC).tables[1].rows) == 61
