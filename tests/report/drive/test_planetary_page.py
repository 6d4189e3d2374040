"""Planetary stages of a drive on their page: places, teeth, speeds and forces are the design's."""

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from page_reader import Reader, marks, numbers, ours
from read_numbers import repeated

import gearopt
from gearopt.formulations.drive.design import drive_design
from gearopt.report.design_tables import stage_table
from gearopt.report.drawing.drawn_stage import PLATE
from gearopt.report.drawing.mesh_view import axes, sector
from gearopt.report.drawing.solid import twist
from gearopt.report.drawing.stage_gears import meshes, sun_planet_ring
from gearopt.report.drawing.train_views import section, views
from gearopt.report.kinds.drive import planetary
from gearopt.report.kinds.drive.planetary_solid import _placed
from gearopt.report.kinds.drive.rating_tables import name
from gearopt.report.kinds.drive.rating_words import life_governed, rating_of
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page
from gearopt.report.shown import table_rows
from gearopt.report.words import limit_words, own_limits

TEETH = ("sun_teeth", "planet_teeth", "ring_teeth")
SETS = (  # held member, planets, teeth, further keys
    ("ring", 3, (32, 51, 136), {}),
    ("sun", 4, (30, 25, 81), {"equally_spaced": False}),
    ("carrier", 5, (26, 20, 69), {"helix_angle": "9 deg"}),
)


@cache
def result():
    """Three planetary stages and a pinion in a ring, given."""
    stages = [
        {"type": "planetary", "fixed": held, "planets": n, "module": "3 mm", "face_width": "30 mm"}
        | dict(zip(TEETH, teeth, strict=True))
        | {"mesh_load_factor": 1.2}
        | more
        for held, n, teeth, more in SETS
    ]
    inner = {"type": "internal", "pinion_teeth": 23, "ring_teeth": 90}
    stages.append(inner | {"module": "4 mm", "face_width": "50 mm"})
    tables = {"gearopt": 1, "kind": "drive", "stage": stages}
    tables["duty"] = {"power": "15 kW", "input_speed": "1480 rpm"}
    tables["gears"] = {"treatment": "carburised"}
    rating = {"standard": "iso6336", "life": "20000 h", "iso6336": {"accuracy_grade": 6}}
    rating |= {"minimum_bending_safety": 1.0, "minimum_contact_safety": 1.0}
    return gearopt.rate(tables | {"rating": rating})


@cache
def shown():
    return page(result(), "x")


def stages():
    return drive_design(result().design).stages


def sets():
    """Each set as it turns, with its stage."""
    for stage in stages()[:3]:
        yield stage, planetary.gear_set(stage, sun_planet_ring(stage))


def test_speeds_and_torques_are_those_of_willis_and_of_the_shafts():
    """n_s + r n_r = (1 + r) n_c, T_s : T_r : T_c = 1 : r : -(1 + r), r = z_r/z_s."""
    shafts = result().design["rating"]["shafts"]
    for k, stage in enumerate(stages()[:3], 1):
        rows = {row.member: row for row in planetary.members(stage, k)}
        r = stage.ring_teeth / stage.sun_teeth
        n = {name: row.speed_rpm for name, row in rows.items()}
        torque = {name: row.torque_Nm for name, row in rows.items()}
        assert n["sun"] + r * n["ring"] == pytest.approx((1.0 + r) * n["carrier"])
        own = planetary.planet_load(stage).speed_rpm * stage.planet_teeth
        assert own == pytest.approx((n["carrier"] - n["sun"]) * stage.sun_teeth)
        assert n[stage.fixed] == 0.0
        assert torque["ring"] == pytest.approx(r * torque["sun"])
        assert torque["carrier"] == pytest.approx(-(1.0 + r) * torque["sun"])
        ends = {row.use: row for row in rows.values()}
        for use, shaft in (("input", shafts[k - 1]), ("output", shafts[k])):
            assert abs(ends[use].speed_rpm) == pytest.approx(shaft["speed_rpm"])
            assert abs(ends[use].torque_Nm) == pytest.approx(shaft["torque_Nm"])
        assert ends["input"].power_kW == pytest.approx(15.0)
        assert ends["output"].power_kW == pytest.approx(-15.0)
        faster = planetary.members(replace(stage, driver="wheel"), k)
        assert {row.use for row in faster if row.power_kW and row.power_kW > 0} == {"input"}


def test_a_pin_carries_the_forces_of_both_meshes():
    """Those of the rating, at the working circles of each mesh."""
    rated = result().design["rating"]["meshes"]
    for k, stage in enumerate(stages()[:3]):
        outer, inner = rated[2 * k : 2 * k + 2]
        load = planetary.planet_load(stage)
        along = outer["tangential_force_N"] + inner["tangential_force_N"]
        assert load.tangential_N == pytest.approx(along)
        across = outer["radial_force_N"] - inner["radial_force_N"]
        assert load.radial_N == pytest.approx(across)
        lost = outer["tangential_force_N"] * outer["pitch_line_velocity_m_per_s"] * stage.planets
        assert load.rolling_kW == pytest.approx(1e-3 * lost)


def test_planets_are_where_their_teeth_fit_and_as_far_apart_as_told():
    for stage in stages()[:3]:
        rows = planetary.planets(stage)
        whole = stage.sun_teeth + stage.ring_teeth
        angles = np.array([row.angle_deg for row in rows])
        assert np.allclose(np.mod(angles * whole / 360.0 + 0.5, 1.0), 0.5)
        assert np.abs(angles - np.arange(len(rows)) * 360.0 / len(rows)).max() <= 180.0 / whole
        at = stage.centre_distance_mm * np.exp(1j * np.radians(angles))
        apart = np.abs(at - np.roll(at, 1)).min() - stage.wheel_tip_diameter_mm
        assert planetary.planet_load(stage).gap_mm == pytest.approx(apart)


def test_outlines_have_the_teeth_of_the_gears():
    """Tips, roots and the thickness m_n (pi/2 + 2 x tan(alpha_n))/cos(beta) at d."""
    for stage, seen in sets():
        of_ring = stage.ring_diameter_mm, stage.ring_tip_diameter_mm, stage.ring_root_diameter_mm
        members = ("pinion", "wheel")
        sizes = ("diameter_mm", "tip_diameter_mm", "root_diameter_mm", "profile_shift")
        rows = [[getattr(stage, f"{m}_{size}") for size in sizes] for m in members]
        rows.append([*of_ring, stage.ring_profile_shift])
        wheels = (seen.sun, seen.planet, seen.ring)
        for wheel, (d, tip, root, x) in zip(wheels, rows, strict=True):
            r, angle = np.hypot(*wheel.outline.T), np.arctan2(*wheel.outline.T[::-1])
            assert 2.0 * r.min() == pytest.approx(min(tip, root), rel=1e-9)
            assert 2.0 * r.max() == pytest.approx(max(tip, root), rel=1e-9)
            half = len(r) // wheel.teeth // 2
            side = slice(half, 2 * half)  # from the tip of the first tooth to its root
            order = np.argsort(r[side])
            thick = 2.0 * np.interp(0.5 * d, r[side][order], angle[side][order]) * 0.5 * d
            beta = math.radians(stage.helix_angle_deg)
            meant = 3.0 * (0.5 * math.pi + 2.0 * x * math.tan(math.radians(20.0)))
            assert thick == pytest.approx(meant / math.cos(beta), abs=0.05)


def test_teeth_are_in_mesh_at_every_moment():
    turns = np.linspace(0.0, 1.7, 23)
    for stage, seen in sets():
        bodies = [b for b in seen.bodies(turns) if b.style != "rim" and b.title]
        sun, *planets, ring = bodies
        z = dict(zip(("sun", "planet", "ring"), (seen.sun, seen.planet, seen.ring), strict=True))

        def phase(body, name, direction, z=z):
            return z[name].teeth * (direction - body.places[:, 2]) / (2.0 * np.pi)

        assert len(planets) == stage.planets
        for planet in planets:
            x, y = planet.places[:, :2].T
            assert np.allclose(np.hypot(x, y), stage.centre_distance_mm)
            line = np.arctan2(y, x)
            outer = phase(sun, "sun", line) + phase(planet, "planet", line + np.pi)
            inner = phase(planet, "planet", line) - phase(ring, "ring", line)
            for both in (outer, inner):
                assert np.allclose(np.mod(both, 1.0), 0.5, atol=1e-6)


def test_helices_of_gears_in_mesh_run_alike_in_space():
    """Twist times teeth: equal of planet and ring, opposite of sun and planet."""
    stage, seen = list(sets())[2]
    placed = dict(_placed(stage, seen, sun_planet_ring(stage)))
    rate = {name: twist(it.gear) * abs(it.gear.teeth) for name, it in placed.items()}
    assert rate["planet"] == pytest.approx(rate["ring"]) == pytest.approx(-rate["sun"])
    assert rate["sun"] > 0.0


@pytest.mark.slow
def test_flanks_of_rings_touch_at_the_pitch_point():
    """The inner mesh in section: outlines of planet, or pinion, and ring pass C and no more."""
    pairs = [mesh for stage in stages() for mesh in meshes(stage) if mesh[1][1] == "ring"]
    assert len(pairs) == 4
    for pair, _ in pairs:
        for gear, at in zip(pair.gears, axes(pair), strict=True):
            points = np.array(sector(gear, at)) + (0.0, at)
            a, b = points[:-1], points[1:]
            share = np.clip(-(a * (b - a)).sum(1) / np.maximum(((b - a) ** 2).sum(1), 1e-12), 0, 1)
            assert np.hypot(*(a + share[:, None] * (b - a)).T).min() < 0.01
        reach = np.array([0.5 * float(d) for d in pair.working_diameters])
        assert reach[0] + reach[1] == pytest.approx(float(pair.centre_distance))
    assert len(re.findall("planet and ring", "".join(Reader(shown()).text))) >= 3


def test_views_of_the_train_are_to_scale():
    """Rings with rims, planets at their places, all at the scale of the widest dimension."""
    *fronts, side = (ET.fromstring(it.svg) for it in views(result().design["stages"], METRIC))
    assert len(fronts) == 4
    outside = [stage.ring_outside_diameter_mm for stage in stages()]
    texts = [{t.text for t in svg.iter("text")} for svg in fronts]
    ring = marks(fronts[0], "path", "tip")[0].get("d")
    scale = 2.0 * float(re.search(r"A ([\d.]+)", ring)[1]) / outside[0]
    for k, (stage, front) in enumerate(zip(stages()[:3], fronts, strict=False)):
        assert f"⌀ {outside[k]:.2f}" in texts[k] and f"ring {k + 1}" in texts[k]
        (path,) = (mark.get("d") for mark in marks(front, "path", "tip"))
        radii = sorted({float(r) / scale for r in re.findall(r"A ([\d.]+)", path)})
        assert radii == pytest.approx([stage.ring_tip_diameter_mm / 2, outside[k] / 2], abs=0.05)
        drawn = np.array([numbers(e, "cx", "cy", "r") for e in marks(front, "circle", "tip")])
        x, y = drawn[:, 0] / scale, -drawn[:, 1] / scale
        sun = np.argmin(np.abs(drawn[:, 2] / scale - stage.pinion_tip_diameter_mm / 2))
        at = np.delete((x - x[sun]) + 1j * (y - y[sun]), sun)
        meant = [math.radians(row.angle_deg) for row in planetary.planets(stage)]
        places = stage.centre_distance_mm * np.exp(1j * np.array(meant))
        assert np.allclose(np.sort_complex(at.round(1)), np.sort_complex(places.round(1)), atol=0.2)
    assert f"{stages()[3].centre_distance_mm:.2f}" in texts[3]
    rects = [numbers(e, "width", "height") for e in marks(side, "rect", "tip")]
    for k, stage in enumerate(stages()):
        thick = 0.5 * (outside[k] - stage.ring_tip_diameter_mm)
        near = [abs(w / scale - stage.face_width_mm) + abs(h / scale - thick) for w, h in rects]
        assert sorted(near)[1] < 0.1  # both cuts of its ring
    plates = [e for e in marks(side, "rect", "shaft") if e.find("title").text.startswith("plate")]
    assert len(plates) == 1 + 2 + 2 + 1  # a carrier; with a ring that turns; a ring
    assert all(numbers(e, "width")[0] == pytest.approx(PLATE[1] - PLATE[0]) for e in plates)


@pytest.mark.slow
def test_what_means_nothing_of_shafts_in_line_is_left_out():
    text = "".join(Reader(shown()).text)
    assert "centre distances [mm]" not in text and "total length" not in text.replace("\n", " ")
    assert "teeth z1 of the pinion or sun" in text and "K_γ" in text
    chance = {"1853", "498"}  # a safety factor and a gap, overlap ratios of both meshes
    assert set(repeated(shown())) <= {"6336", *chance}
    rows = table_rows(result(), "members", "metric")
    assert [row["use"] for row in rows[:3]] == ["input", "fixed", "output"]
    assert [row["power [kW]"] for row in rows[-2:]] == pytest.approx([15.0, -15.0])
    assert rows[-1]["member"] == "ring" and rows[-1]["speed [rpm]"] > 0.0
    assert "members.csv" in ours(shown()) and "planets.csv" in ours(shown())
    assert planetary.loads(result(), METRIC).terminal


@pytest.mark.slow
def test_a_ring_is_drawn_as_its_own_tool_cuts_it():
    """Rings by a cutter, and by a tool of other addenda than the planets'."""
    own = {"cutter_teeth": 21, "cutter_tip_radius": 0.2}, {"addendum": 0.9, "tool_addendum": 1.4}
    for ring in own:
        asked = result().asked
        stage = asked["stage"][0] | {"ring": ring}
        rated = gearopt.rate(asked | {"stage": [stage]})
        (drawn,) = drive_design(rated.design).stages
        gears = sun_planet_ring(drawn)
        assert gears is not None and bool(gears[2].cutter) == ("cutter_teeth" in ring)
        assert -float(gears[2].root_diameter) == pytest.approx(drawn.ring_root_diameter_mm)
        assert drawn.ring_root_diameter_mm != pytest.approx(stages()[0].ring_root_diameter_mm)
        rows = rated.table("teeth")
        assert all(row["teeth z"] > 0 and row["tip diameter d_a [mm]"] > 0 for row in rows)


def test_a_ring_of_other_diameters_than_its_tool_cuts_is_not_drawn_with_teeth():
    stage = replace(stages()[0], ring_root_diameter_mm=stages()[0].ring_root_diameter_mm + 0.1)
    assert sun_planet_ring(stage) is None and len(meshes(stage)) == 1


@cache
def pinion_in_ring(life="20000 h"):
    duty = {"power": "5.5 kW", "input_speed": "1450 rpm"}
    stage = {"type": "internal", "pinion_teeth": 24, "ring_teeth": 96, "module": "1.5 mm"}
    rating = {"standard": "iso6336", "life": life, "iso6336": {"accuracy_grade": 6}}
    tables = {"gearopt": 1, "kind": "drive", "duty": duty, "rating": rating}
    tables |= {"stage": [stage | {"face_width": "12 mm"}], "gears": {"treatment": "carburised"}}
    return gearopt.rate(tables)


def test_a_pinion_in_a_ring_has_each_row_once_and_no_wheel():
    (stage,), rating = pinion_in_ring().design["stages"], rating_of(pinion_in_ring())
    table = stage_table([stage], METRIC)
    labels = [str(row[0]).split(" [")[0] for row in table.rows]
    assert labels.count("mass of the ring") == 1 and "teeth z2 of the ring" in labels
    assert not {"teeth of the ring z_r", "tip diameter of the ring"} & {*labels}
    assert "outside diameter of the ring" in labels
    assert len({*labels}) == len(labels)
    limits = {limit_words(name) for name in own_limits(pinion_in_ring())}
    assert limits == {
        f"{gear} {mode} of stage 1"
        for gear in ("pinion", "ring")
        for mode in ("bending", "contact")
    }
    assert [name(rating, gear) for gear in rating.gears] == ["pinion", "ring"]


def test_a_life_beyond_the_end_of_the_curves_is_no_failure():
    """1e10 cycles are 114,942 h at 1450 per minute."""
    short, long = (rating_of(pinion_in_ring(life)) for life in ("20000 h", "175200 h"))
    assert short.safe and long.safe and short.gears[0].life_h is long.gears[0].life_h is None
    assert life_governed(short) == "pinion, beyond 1e10 cycles"
    assert "life lies farther and is rated at the strength of that end" in life_governed(long)
    assert "with its curve extended" in life_governed(replace(long, by="AGMA"))


def test_what_drives_a_stage_that_increases_the_speed_is_named():
    """Of held ring, sun and carrier: carrier, carrier and ring; the ring of a pinion in it."""
    faster = [stage | {"driver": "wheel"} for stage in result().design["stages"]]
    (row,) = [row for row in stage_table(faster, METRIC).rows if row[0] == "driving member"]
    assert [cell.text for cell in row[1:]] == ["carrier", "carrier", "ring", "ring"]


def test_a_set_alone_has_one_axis_whose_position_is_no_choice():
    first, *_, inner = result().design["stages"]
    alone, pair = (
        section(replace(result(), design=result().design | {"stages": [stage]}), METRIC)
        for stage in (first, inner)
    )
    assert "in one plane" not in alone.heading + " ".join(alone.words)
    assert "Both shafts are drawn in one plane" in pair.words[0]
