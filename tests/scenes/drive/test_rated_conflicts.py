"""Impossible rated drives: what excludes each other, and what would make them possible."""

from dataclasses import replace
from pathlib import Path

import pytest
from impossible_drives import has_a_design, some_file

import gearopt
from gearopt.formulations.drive.teeth.search import reaches
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.report.headline import lead
from gearopt.scenes.drive.explain import rated_remedies
from gearopt.scenes.drive.explain.rated_conflict import _Filter, conflict
from gearopt.scenes.drive.explain.requirements import requirements, without
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.reading.load import load

ELEVATOR = Path(__file__).parents[3] / "problems" / "elevator_by_both.toml"


def found_of(scene):
    return conflict(Case(scene, Clock(Budget(seconds=100.0), None), seconds=20.0))


def is_a_conflict(scene, found):
    """Whether its members alone are impossible, and without any one possible, by all candidates."""
    every = {name for group in requirements(scene) for family in group for name in family}
    rest = frozenset(every - {*found.names})
    members = {*found.names} & every
    return (
        bool(found.names)
        and not found.unsure
        and not any(map(has_a_design, without(scene, rest)))
        and all(any(map(has_a_design, without(scene, rest | {name}))) for name in members)
    )


@pytest.mark.parametrize(
    ("known", "asked", "answer"),
    [
        ({"module", "life"}, {"module", "life", "coprime"}, True),
        ({"module", "life"}, {"life"}, False),
        ({"materials", "life"}, {"life"}, None),  # of other materials are other best grades
        ({"module", "centre_distance[1]"}, {"module"}, None),
    ],
)
def test_a_design_that_keeps_more_answers_and_none_where_less_is_kept(known, asked, answer):
    """None: asked anew, for which there is no time."""
    over = Clock(Budget(seconds=0.0), None)
    scene = load(some_file(1)).scene
    case = Case(scene, over, answers={frozenset(known): answer is True})
    assert _Filter(case).possible(asked) is answer


@pytest.mark.parametrize("seed", [1, pytest.param(0, marks=pytest.mark.slow)])
def test_a_conflict_is_one_by_every_candidate(seed):
    scene = load(some_file(seed)).scene
    assert is_a_conflict(scene, found_of(scene))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_conflicts_of_random_drives_are_ones_and_every_remedy_works(seed):
    for more in range(20):
        tables = some_file(1000 * (seed + 1) + 8 * more + seed % 8)
        if gearopt.solve(tables).status == "infeasible":
            break
    scene = load(tables).scene
    assert is_a_conflict(scene, found_of(scene))
    for remedy in gearopt.explain(tables).remedies:
        assert gearopt.solve(tables, remedy.edits).value is not None, remedy


NARROW = some_file(1) | {
    "limits": {"pinion_teeth": [20, 22], "module": ["1 mm", "2 mm"]},
    "gears": {"treatment": "carburised"},
    "duty": {"power": "9 kW", "input_speed": "1000 rpm", "ratio": 3},
}


@pytest.mark.slow
def test_remedies_are_of_use_and_verified():
    tables = NARROW | {"stage": [{"face_width_over_diameter": 0.3}]}
    found = gearopt.explain(tables)
    assert found.result.status == "infeasible" and found.conflict and not found.unsure
    assert "face_width_over_diameter[1]" in found.conflict and "module_high[1]" in found.conflict
    ways = {change.key: change for remedy in found.remedies for change in remedy.changes}
    assert "stage[1].face_width_over_diameter" in ways and "limits.module[2]" in ways
    assert all(change.factor <= 3.1 for change in ways.values())
    assert [r.kind for r in found.remedies].count("least") == 1
    for remedy in found.remedies:
        assert gearopt.solve(tables, remedy.edits).value is not None


def test_a_conflict_is_said_first_and_what_may_not_matter_last(monkeypatch):
    monkeypatch.setattr(rated_remedies, "CONFLICT_SECONDS", 60.0)  # on a busy machine, too
    tables = NARROW | {"stage": [{"face_width_over_diameter": 0.3}]}
    result = gearopt.solve(tables)
    ways = result.report["ways_out"]
    assert ways["untried"] and "minimum contact safety" in lead(result)
    assert lead(result).endswith("cannot be met together")
    doubtful = ways | {"unsure": ["face_width_over_diameter[1]"]}
    words = lead(replace(result, report={"ways_out": doubtful}))
    assert words.endswith(
        "face width over diameter of stage 1 (which of these take part was not decided in the time)"
    )


def test_a_conflict_of_which_nothing_is_sure_is_said_to_be_open(solved):
    ways = {"conflict": ["ratio_high[1]"], "unsure": ["ratio_high[1]"], "remedies": []}
    result = replace(solved("elevator"), status="infeasible", report={"ways_out": ways})
    assert lead(result) == (
        "no design meets all limits, perhaps because of maximum ratio of stage 1 "
        "(not decided in the time)"
    )
    known = replace(result, message="No gears have room.")
    assert lead(known) == "No gears have room"
    alone = replace(known, report={"ways_out": ways | {"unsure": [], "untried": True}})
    assert lead(alone).startswith(
        "No gears have room; the limit on maximum ratio of stage 1 cannot"
    )


def test_of_many_requirements_that_may_not_matter_some_are_named(solved):
    names = ["a[1]", *(f"{letter}[1]" for letter in "bcdef")]
    ways = {"conflict": names, "unsure": names[1:], "remedies": []}
    result = replace(solved("elevator"), status="infeasible", report={"ways_out": ways})
    assert lead(result).startswith(
        "the limit on a of stage 1 cannot be met together with b of stage 1, c of stage 1, "
        "d of stage 1 and 2 others (which of these take part was not decided in the time)"
    )
    first = replace(result, asked={"limits": {"f": 1, "e": 2}})
    assert "together with e of stage 1, f of stage 1, b of stage 1 and 2 others" in lead(first)


OUT_OF_REACH = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "30 kW", "input_speed": "1000 rpm", "ratio": 12, "ratio_tolerance": "1 %"},
    "gears": {"treatment": "carburised", "iso_material": "Eh", "helix_angle": "12 deg"}
    | {"face_width_over_diameter": [0.3, 1.0]},
    "stage": [{}, {}],
    "limits": {"pinion_teeth": [20, 22], "wheel_teeth": [60, 62], "module": ["1 mm", "1.5 mm"]},
    "teeth": {},
    "rating": {"standard": "iso6336", "life": "20000 h", "minimum_bending_safety": 1.4}
    | {"minimum_contact_safety": 1.1, "iso6336": {"accuracy_grade": 6}},
}
NARROW_TEETH = {"pinion_teeth": [20, 21], "wheel_teeth": [50, 52], "module": ["1 mm", "1.5 mm"]}


@pytest.mark.parametrize(
    ("changed", "families"),
    [
        ({}, {"wheel_teeth_high", "pinion_teeth_low"}),
        (
            {"stage": [{"centre_distance": "80 mm"}, {"centre_distance": "100 mm"}]},
            {"wheel_teeth_high", "pinion_teeth_low"},
        ),
        ({"shift": {"sum": [0, 0.4]}}, {"wheel_teeth_high", "pinion_teeth_low"}),
        (
            {"duty": OUT_OF_REACH["duty"] | {"ratio": "127/21", "ratio_tolerance": "0.01 %"}}
            | {"limits": NARROW_TEETH},
            {"wheel_teeth_high", "pinion_teeth_low", "ratio_tolerance"},
        ),
        (
            {"limits": {"pinion_teeth": [20, 22], "stage_ratio": [1, 3]}},
            {"stage_ratio_high"},
        ),
    ],
)
def test_numbers_of_teeth_out_of_reach_are_the_conflict(changed, families):
    """Though too weak as well; by themselves, and without any of them there are some."""
    scene = load(OUT_OF_REACH | changed).scene
    known = found_of(scene)
    assert {name.split("[")[0] for name in known.names} == families and not known.unsure
    every = {name for group in requirements(scene) for family in group for name in family}
    rest = frozenset(every - {*known.names})
    assert not any(map(reaches, without(scene, rest)))
    assert all(any(map(reaches, without(scene, rest | {name}))) for name in known.names)


def test_numbers_of_teeth_out_of_reach_are_told_at_once():
    words = lead(gearopt.solve(OUT_OF_REACH))
    assert "maximum wheel teeth of stages 1 and 2" in words and "safety" not in words


@pytest.mark.slow
def test_a_stage_like_the_last_is_a_remedy_that_a_file_can_hold():
    limits = {"pinion_teeth": [20, 22], "stage_ratio": [1, 4]}
    duty = {"power": "1 kW", "input_speed": "1000 rpm", "ratio": 6, "ratio_tolerance": "2 %"}
    tables = NARROW | {"limits": limits, "duty": duty}
    found = gearopt.explain(tables)
    assert found.conflict == ("stage_ratio_high[1]",)
    (more,) = (r for r in found.remedies if r.what == "stages")
    assert gearopt.solve(tables, more.edits).value is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "asked"), [("minimum_contact_safety", 6), ("minimum_bending_safety", 40)]
)
def test_a_safety_factor_one_step_nearer_to_what_was_asked_is_impossible(key, asked):
    """By a complete search of its own: between are hundreds of steps that drives suffice for."""
    impossible = {f"rating.{key}": asked}
    found = gearopt.explain(ELEVATOR, impossible, budget=Budget(seconds=120.0))
    (change,) = next(r.changes for r in found.remedies if r.changes[0].key == f"rating.{key}")
    most = float(change.write)
    for safety, status in ((most, "optimal"), (1.001 * most, "infeasible")):
        answer = gearopt.solve(ELEVATOR, {change.key: safety}, remedies=False)
        assert answer.status == status
