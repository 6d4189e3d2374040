"""The relief of a spur pair on its page: before and after, what to grind, harmonics."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.pair.contact import PairMesh, contact
from gearopt.formulations.pair.relief.meshing import Relief
from gearopt.formulations.pair.relief_map import Removed, described
from gearopt.physics.gears import GearPair
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.report.kinds.pair import PAGES
from gearopt.report.kinds.pair.contact import moving
from gearopt.report.kinds.pair.relief import (
    answers,
    diameter_at,
    flanks,
    grinding,
    harmonics,
    profile_plot,
    relief_words,
    steps,
)
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import sections

PAIR = GearPair.of_teeth(3.0, 25, 50, 30.0)
LOADS = (0.6, 1.0, 1.25)
RELIEFS = Relief(12e-3, 5.0, 2.0), Relief(10e-3, 4.0, 2.0)  # mm


@pytest.fixture(scope="module")
def relieved():
    """The reference pair at three loads, parabolic relief on both gears."""
    elastic = ElasticPair(PAIR, (30.0, 50.0))
    made = PairMesh.of(elastic, "profile + Sainsot", 2e5, 7.84e-7, 24, LOADS)
    found = contact(made, "given", (13308.6, 20127.6), ())
    return found, described(made, Removed.of(made.mesh, RELIEFS), "peak_to_peak", (0.6, 1.0))


def test_before_and_after_are_side_by_side_and_in_every_plot(relieved):
    found, relief = relieved
    section = moving(found, relief, PAIR, METRIC)
    (moves,) = section.animations
    assert [view.caption for view in moves.views] == ["Without relief", "With relief"]
    assert moves.row.printed * (2 * moves.row.widest + 18.0) <= 680.0 * 1.0001  # on paper, too
    shares, errors, _ = section.figures
    assert [t["name"] for t in shares.data] == ["", "", "", "at 60 %", "at 100 %", "at 125 %"]
    before, after = shares.data[1]["y"], shares.data[4]["y"]
    assert before[0] == pytest.approx(40.1, abs=0.1)  # comes with two fifths of the load
    assert after[0] < 0.2 * before[0] and after[-1] < 0.2 * before[-1]
    ends = [np.ptp(trace["y"]) for trace in errors.data]
    assert ends[1] == pytest.approx(4.99, abs=0.02) and ends[4] < ends[1]
    readings = dict(moves.read_out)
    totals = [
        sum(float(readings[f"{words}: share of pair {k}"].rstrip(" %")) for k in (1, 2))
        for words in ("without relief", "with relief")
    ]
    assert totals == pytest.approx([100.0, 100.0], abs=0.11)


def test_dots_are_there_only_where_a_pair_carries(relieved):
    """A relief of 60 um takes contact away for a part of the path."""
    found, _ = relieved
    deep = Relief(60e-3, 5.0), Relief(60e-3, 5.0)
    elastic = ElasticPair(PAIR, (30.0, 50.0))
    made = PairMesh.of(elastic, "profile + Sainsot", 2e5, 7.84e-7, 24, LOADS)
    relief = described(made, Removed.of(made.mesh, deep), "peak_to_peak", (1.0,))
    (moves,) = moving(found, relief, PAIR, METRIC).animations
    dots = [body for body in moves.views[1].front if body.title.endswith("pair 2")][0]
    there = np.isfinite(np.asarray(dots.places)[:, 0])
    shares = next(r.values for r in moves.readings if r.name == "with relief: share of pair 2")
    assert np.array_equal(there, np.nan_to_num(shares) > 0.0)
    assert 0 < there.sum() < np.isfinite(shares).sum()


def test_what_is_ground_is_told_by_roll_angle_and_diameter(relieved):
    """Rolling angles by the involute itself: length of the tangent over the base radius."""
    pinion, wheel = (steps(flank, METRIC) for flank in flanks(*relieved, PAIR))
    base = 75.0 * math.cos(math.radians(20.0))
    tip = math.sqrt(81.0**2 - base**2) / base
    start = tip - 5.0 / (0.5 * base)
    heads, rows = pinion.values
    assert heads == ["diameter [mm]", "roll angle [°]", "removed [µm]"] and len(rows) == 11
    first, last = rows[0], rows[-1]
    assert last == pytest.approx([81.0, math.degrees(tip), 12.0])
    assert first == pytest.approx([base * math.hypot(1.0, start), math.degrees(start), 0.0])
    assert rows[5][2] == pytest.approx(12.0 / 4.0)  # a parabola half way
    _, rows = wheel.values
    assert rows[-1][0] == pytest.approx(156.0) and rows[5][2] == pytest.approx(10.0 / 4.0)
    texts = [cell.text for cell in pinion.on_page[1][-1]]
    assert texts == ["81.000", f"{math.degrees(tip):.3f}", "12.00"]
    assert pinion.csv().splitlines()[0] == "diameter [mm],roll angle [°],removed [µm]"


def test_in_inches_every_number_to_grind_is_in_inches(relieved):
    _, relief = relieved
    table = grinding(relief, INCH)
    rows = {row[0]: row[1:] for row in table.values[1]}
    assert rows["tip diameter [in]"] == pytest.approx([81.0 / 25.4, 156.0 / 25.4])
    starts = [relief.pinion.start_diameter_mm / 25.4, relief.wheel.start_diameter_mm / 25.4]
    assert rows["starts at diameter [in]"] == pytest.approx(starts)
    last = steps(flanks(*relieved, PAIR)[0], INCH).on_page[1][-1]
    assert [cell.text for cell in last][::2] == ["3.1890", "0.4724"]  # in, mil


def test_sentences_on_a_relief_have_the_inches_of_its_table(relieved):
    _, relief = relieved
    amounts = (flank.amount_mm / 25.4e-3 for flank in (relief.pinion, relief.wheel))
    for said, amount in zip(answers(relief, INCH), amounts, strict=False):
        assert f"Grind {amount:.4f} mil off the tips" in said
    assert " µm" in relief_words(relief, METRIC)
    assert " mil" in relief_words(relief, INCH) and " µm" not in relief_words(relief, INCH)


def test_the_plot_of_a_flank_has_both_axes_alike(relieved):
    _, relief = relieved
    for k, one in enumerate(flanks(*relieved, PAIR)):
        figure = profile_plot(one, METRIC)
        across, above = figure.layout["xaxis"], figure.layout["xaxis2"]
        assert above["matches"] == "x" and above["overlaying"] == "x"
        base = float(PAIR.gears[k].base_diameter)
        for roll, text in zip(above["tickvals"], above["ticktext"], strict=True):
            assert base * math.hypot(1.0, math.radians(roll)) == pytest.approx(
                float(text), abs=0.006
            )
            assert across["range"][0] < roll < across["range"][1]
        x, y = (np.array(figure.data[0][axis]) for axis in "xy")
        flank = (relief.pinion, relief.wheel)[k]
        assert y[x < flank.start_roll_angle_deg].max() == 0.0
        assert y.max() == pytest.approx(1e3 * flank.amount_mm)


def test_a_gear_that_keeps_its_involute_has_no_profile_to_grind(relieved):
    found, relief = relieved
    kept = replace(relief, wheel=replace(relief.wheel, amount_mm=0.0, length_mm=0.0))
    assert [flank.member for flank in flanks(found, kept, PAIR)] == ["pinion"]


def test_a_shape_of_its_own_is_told_by_its_points(relieved):
    """The columns of the path say what is removed: here those of parabolas."""
    found, relief = relieved
    told = (replace(flank, exponent=None) for flank in (relief.pinion, relief.wheel))
    free = replace(relief, **dict(zip(("pinion", "wheel"), told, strict=True)))
    for one, other in zip(flanks(found, free, PAIR), flanks(found, relief, PAIR), strict=True):
        rolls = other.at(40)
        assert one.removed(rolls) == pytest.approx(other.removed(rolls), abs=6e-5)
        assert "convex" in profile_plot(one, METRIC).caption
        assert steps(one, METRIC).values[1][-1][2] == pytest.approx(1e3 * one.relief.amount_mm)


def test_what_is_removed_agrees_with_the_columns_of_the_path(relieved):
    found, relief = relieved
    for flank, gear in zip(flanks(found, relief, PAIR), PAIR.gears, strict=True):
        assert flank.removed(flank.rolls) == pytest.approx(flank.listed, abs=1e-9)
        assert diameter_at(flank.base, flank.relief.tip_roll_angle_deg) == pytest.approx(
            float(gear.tip_diameter)
        )


def test_harmonics_stand_beside_each_other_at_three_loads(relieved):
    """Amplitudes of both transmission errors by a Riemann sum over the drawn curves."""
    found, relief = relieved
    (figure,) = harmonics(found, relief, METRIC).figures
    assert len(figure.data) == 6
    notes = [note["text"] for note in figure.layout["annotations"]]
    assert notes == ["at 60 %, made for it", "at 100 %, made for it", "at 125 %"]
    domains = [figure.layout[f"xaxis{k}"]["domain"] for k in ("", "2", "3")]
    assert all(a[1] < b[0] for a, b in zip(domains, domains[1:], strict=False))
    travel = np.asarray(found.travel_mm) / found.base_pitch_mm
    even = (np.arange(40_000) + 0.5) / 40_000
    every = [one for both in zip(found.loads, relief.at, strict=True) for one in both]
    for k, (one, trace) in enumerate(zip(every, figure.data, strict=True)):
        assert trace["xaxis"] == ("x", "x2", "x3")[k // 2]
        curve = 1e3 * np.interp(even, travel, one.transmission_error_mm)
        by_sum = [2 * abs(np.mean(curve * np.exp(-2j * math.pi * n * even))) for n in (1, 2, 3)]
        assert trace["y"][:3] == pytest.approx(by_sum, abs=2e-3)


def test_of_many_loads_a_few_are_shown(relieved):
    found, relief = relieved
    many = replace(found, loads=found.loads * 2)
    more = replace(relief, at=relief.at * 2)
    (figure,) = harmonics(many, more, INCH).figures
    assert len(figure.data) == 2 * 3 and "[mil]" in figure.layout["yaxis"]["title"]["text"]


def test_the_page_of_a_relief_shows_what_to_grind_and_what_it_does(solved):
    found = {section.heading: section for section in sections(solved("relief_two_loads"))}
    order = ["Relief", "Teeth in mesh", "Harmonics of the transmission error", "Contact"]
    assert [heading for heading in found if heading in order] == order
    relief = found["Relief"]
    assert len(relief.figures) == 2
    names = [table.name for table in relief.tables]
    assert {"relief", "pinion profile", "wheel profile", "modified profile"} <= set(names)
    ends = [table.values[1][-1] for table in relief.tables if table.name.endswith("l profile")]
    assert ends[0][0] == pytest.approx(156.0) and 13.0 < ends[0][2] < 14.5
    said = " ".join(relief.words)
    assert "varies by up to 1.239 µm at the loads this relief is made for, not 1.203 µm" in said
    mesh = found["Teeth in mesh"]
    assert len(mesh.animations[0].views) == 2
    assert "B to D, shaded: without relief one pair of teeth carries alone" in mesh.words[0]
    points = next(t for t in found["Contact"].tables if t.name == "points of contact")
    assert points.caption.endswith("one pair of teeth carries the load, without relief.")
    assert "carries alone without relief" in found["Tooth sections"].words[0]
    train = found["Gears with all shafts in one plane"].words[0]
    assert train == "Both shafts are drawn in one plane: their positions are not optimised."
    assert len(found["Harmonics of the transmission error"].figures[0].data) == 6


def test_key_figures_without_relief_are_those_of_its_loads_and_called_so(solved):
    """4.99 µm at 60 and 100 %, as [0.6, 1] is what the relief is made for: docs/pair.md."""
    tiles = {tile.name: tile for tile in PAGES.tiles(solved("relief_two_loads"), METRIC)}
    plain = tiles["peak to peak without relief"]
    assert float(plain.value.split()[0]) == pytest.approx(4.99, abs=5e-3)
    assert plain.remark.startswith("at the worst of 2 loads")
    assert "mean mesh stiffness without relief" in tiles
