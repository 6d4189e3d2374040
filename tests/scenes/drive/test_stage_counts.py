"""The best number of stages of a range, against a file for every number."""

import io
import math
from dataclasses import replace
from functools import cache

import pytest
from campaigns import few
from edits import edited, scene_of
from rich.console import Console

import gearopt
from gearopt import Budget, SceneError
from gearopt.optimise.certificate import least
from gearopt.optimise.result import Result
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page, tables
from gearopt.report.terminal import show
from gearopt.scenes.reading.load import read

FILE = """
gearopt = 1
kind = "drive"
stages = {stages}
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = {ratio}
ratio_tolerance = "{tolerance}"
[gears]
face_width_over_diameter = {width}
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [18, 30]
{limits}
[objective]
{objective}
"""
USUAL = {"ratio": 12, "tolerance": "1 %", "width": 0.7, "limits": "", "objective": ""}
TEETH = "\n[teeth]\n"
CAP = {"ratio": 40, "limits": "stage_ratio = [1, 5]"}
DUTIES = {  # the last: real-valued sizes
    "low ratio": ({"ratio": 5}, TEETH),
    "high ratio, capped": (CAP, TEETH),
    "tight": ({"ratio": 31.3, "tolerance": "0.05 %"}, TEETH + "coprime = true\n"),
    "length": ({"objective": 'minimise = "total_length"'}, TEETH),
    "centre distances": ({"objective": 'minimise = "sum_of_centre_distances"'}, TEETH),
    "free width": (
        {"width": "[0.4, 0.9]", "objective": 'minimise = "mass"\ndensity = "7.85 kg/dm^3"'},
        TEETH,
    ),
    "real-valued": ({"ratio": 20}, ""),
}


def text_of(stages, changes=None, teeth=TEETH, more=""):
    head, _, tail = FILE.format(**(USUAL | {"stages": stages} | (changes or {}))).partition("[obj")
    return f"{head}{teeth}[obj{tail}{more}"


@cache
def solved(stages, name):
    changes, teeth = DUTIES[name]
    return gearopt.solve(scene_of(text_of(stages, changes, teeth))[0], top=3 if teeth else 1)


@pytest.mark.parametrize("name", few(DUTIES, ["low ratio"]))
def test_the_best_is_that_of_separate_files(name):
    """Value, bound, design and the table; counts that are impossible alone are in the table too."""
    found, own = solved("[1, 3]", name), {n: solved(n, name) for n in (1, 2, 3)}
    best = min((r for r in own.values() if r.value is not None), key=lambda r: r.value)
    assert found.status == "optimal" and found.value == best.value
    assert found.bound == min(r.bound for r in own.values() if r.bound is not None)
    assert found.design == best.design and found.limits == best.limits
    assert [row["stages"] for row in found.report["counts"]] == [1, 2, 3]
    for row in found.report["counts"]:
        alone = own[row["stages"]]
        assert (row["status"], row["objective"]) == (alone.status, alone.value)
        assert row["bound"] == alone.bound
        assert math.prod(row["ratios"]) == pytest.approx(alone.design.get("ratio", 1.0))
    lists = [t for r in own.values() for t in r.report.get("trains", ())]
    three = sorted(t["objective"] for t in lists)[:3]
    assert [t["objective"] for t in found.report.get("trains", ())] == three


def test_equal_ends_are_one_number():
    one, pair = solved(2, "low ratio"), solved("[2, 2]", "low ratio")
    assert "counts" not in pair.report and pair.design == one.design


def test_impossible_numbers_are_out_of_the_way():
    """Five to one at most in each stage: 40:1 takes three."""
    found = solved("[1, 3]", "high ratio, capped")
    assert [r["status"] for r in found.report["counts"]] == ["infeasible", "infeasible", "optimal"]
    assert "ratio_low" in found.report["counts"][0]["conflict"]


@cache
def impossible(teeth):
    text = text_of("[1, 2]", CAP, teeth)
    return scene_of(text)[1], gearopt.explain(scene_of(text)[0])


@pytest.mark.slow
@pytest.mark.parametrize("teeth", ["", TEETH], ids=["real-valued", "whole teeth"])
def test_where_all_are_impossible_the_smallest_change_is_told(teeth):
    """Two stages of (0.99 40)^(1/2) at the least; or three stages."""
    content, found = impossible(teeth)
    assert found.result.status == "infeasible" and found.result.bound is None
    first, last = found.remedies[0], found.remedies[-1]
    assert first.kind == "least" and first.changes[0].key == "limits.stage_ratio"
    assert first.factor == pytest.approx((0.99 * 40) ** 0.5 / 5, rel=5e-3)
    assert (last.changes[0].key, last.changes[0].write) == ("stages", "[1, 3]")
    for remedy in found.remedies:
        assert gearopt.solve(edited(content, remedy), remedies=False).value is not None
    less = edited(content, first, back=first.changes)
    assert gearopt.solve(less, remedies=False).status == "infeasible"


@pytest.mark.slow
def test_one_number_of_stages_may_be_another():
    ways = solved(2, "high ratio, capped").report["ways_out"]["remedies"]
    assert ways[-1]["changes"][0]["write"] == "3"


def test_the_bound_of_a_search_that_ends_early_is_the_least_of_all():
    """No time at all: every number keeps the bound of real-valued sizes, if that was found."""
    scene = scene_of(text_of("[1, 3]"))[0]
    found = gearopt.solve(scene, budget=Budget(1e-9))
    assert found.status == "limit" and found.value is None
    bounds = [row["bound"] for row in found.report["counts"]]
    assert found.bound == (None if None in bounds else min(bounds))
    exact = gearopt.solve(scene)
    assert found.bound is None or found.bound <= exact.value


def part(status, value=None, bound=None):
    return Result("x", status, "m", {"name": "f", "value": value}, bound=bound)


def test_the_best_of_parts_is_no_better_known_than_the_worst_known_part():
    """Of two parts: what is proven of both, of one, of none."""
    best, open_ = part("optimal", 2.0, 2.0), part("limit", 3.0, 1.5)
    found = least([best, open_], 1e-6)
    assert (found.status, found.value, found.bound, found.gap) == ("limit", 2.0, 1.5, 0.25)
    assert least([best, part("limit", None, 2.5)], 1e-6).status == "optimal"
    assert least([best, part("infeasible")], 1e-6).bound == 2.0
    without = least([best, part("feasible", 5.0)], 1e-6)
    assert (without.status, without.bound, without.gap) == ("feasible", None, None)
    assert least([part("infeasible"), part("infeasible")], 1e-6).status == "infeasible"


def test_a_gap_of_every_number_is_one_of_the_whole():
    found = gearopt.solve(scene_of(text_of("[2, 4]"))[0], gap=0.2)
    assert found.status == "optimal" and found.gap <= 0.2
    assert found.bound == min(row["bound"] for row in found.report["counts"])


def test_events_name_the_number_and_end_all():
    seen = []
    gearopt.solve(scene_of(text_of("[2, 3]"))[0], watch=lambda e: seen.append(e.part) or True)
    assert {"2 stages, sizing", "2 stages, teeth", "3 stages, teeth"} <= set(seen)
    found = gearopt.solve(scene_of(text_of("[2, 3]"))[0], watch=lambda e: False)
    assert found.status == "limit"


@pytest.mark.slow
def test_what_is_explained_and_compared_is_the_best_number():
    scene = scene_of(text_of("[1, 3]", {"ratio": 5}))[0]
    found = gearopt.explain(scene)
    count = len(found.result.design["stages"])
    assert f"held at {count}" in found.message and found.influences
    alone = gearopt.explain(scene.held(count))
    assert [i.sensitivity for i in found.influences] == [i.sensitivity for i in alone.influences]
    compared = gearopt.compare(scene, methods="exact", seeds=1, evaluations=500, seconds=0.2)
    assert f"{count} stages (the best)" in compared.groups[0].words


REFUSED = {  # what is added to a file, or a number of stages: a word of the message
    "[[stage]]\n[[stage]]\n": "[[stage]]",
    "[process_one]\nstage_ratios = [3, 4]\n": "one number of stages",
    '[layout]\nshaft_diameters = ["20 mm", "30 mm", "40 mm"]\n': "shaft_stress",
    '[layout]\nshaft_stress = "40 MPa"\nslabs = [[1], [2]]\n': "leave it out",
    '[layout]\nshaft_stress = "40 MPa"\n[[place]]\nshaft = 4\ny = "0 mm"\n': "is for one "
    "number of stages, and stages is a range: shaft 4 is no intermediate shaft of a drive of "
    "2 stages. Write stages = 3, or leave the place out",
    '[layout]\nshaft_stress = "40 MPa"\n[[place]]\nshaft = 3\ny = "0 mm"\n': "one number of stages",
    '[layout]\nshaft_stress = "40 MPa"\nsplit_line = [1, 4]\n': "Write stages = 3",
    '[layout]\nshaft_stress = "40 MPa"\nsplit_line = [1, 3]\n': "Write stages = 2, or leave",
}


@pytest.mark.parametrize("more", REFUSED)
def test_what_is_for_one_number_of_stages_is_refused(more):
    with pytest.raises(SceneError) as wrong:
        read(text_of("[2, 3]", more=more).encode())
    assert REFUSED[more] in str(wrong.value).replace("\\", "")


@pytest.mark.parametrize(
    ("stages", "right"), [("[4, 2]", "[2, 4]"), ("[2, 9]", "6"), ("[0, 2]", "[1, 2]")]
)
def test_wrong_ranges_are_refused(stages, right):
    with pytest.raises(SceneError) as wrong:
        read(text_of(stages).encode())
    assert right in str(wrong.value)


BOX = '[layout]\nshaft_stress = "40 MPa"\n'


@pytest.mark.slow
def test_the_gears_of_the_best_number_are_laid_out():
    found = gearopt.solve(scene_of(text_of("[1, 2]", {"ratio": 5}, more=BOX))[0])
    counts = found.parts[0].report["counts"]
    best = min((r for r in counts if r["objective"]), key=lambda r: r["objective"])
    alone = gearopt.solve(scene_of(text_of(best["stages"], {"ratio": 5}, more=BOX))[0])
    assert found.status == "optimal" and found.value == pytest.approx(alone.value, rel=1e-9)


@pytest.mark.slow
def test_boxes_of_all_numbers_are_compared():
    more = BOX + "together = true\n"
    found = gearopt.solve(scene_of(text_of("[1, 2]", {"ratio": 5}, more=more))[0])
    each = [gearopt.solve(scene_of(text_of(n, {"ratio": 5}, more=more))[0]) for n in (1, 2)]
    assert found.value == pytest.approx(min(r.value for r in each), rel=1e-6)
    assert [r["stages"] for r in found.report["counts"]] == [1, 2]


def test_page_and_terminal_show_every_number():
    found = replace(solved("[1, 3]", "high ratio, capped"), scene="drive")
    screen = Console(width=110, record=True, file=io.StringIO())
    show(found, screen)
    assert "Impossible with 1 stage: " in screen.export_text()
    rows = tables(found, METRIC)["numbers-of-stages.csv"].splitlines()
    assert len(rows) == 4 and rows[3].startswith("3,proven optimal,")
    assert '"above the best, %",bound [cm³]' in rows[0]
    assert "Number of stages" in page(found, "", METRIC)
