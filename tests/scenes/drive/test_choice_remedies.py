"""Impossible drives at given centre distances: lists, ranges, series and sums are moved."""

import math
from fractions import Fraction

import pytest
from test_distances_together import FEW, asked
from test_given_distance import PAIR, written
from test_several_distances import AGMA_ONLY

import gearopt
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.scenes.drive.explain.choice_moves import choice_groups, teeth_groups
from gearopt.scenes.drive.explain.rated_conflict import conflict
from gearopt.scenes.drive.explain.tried import Case, any_possible
from gearopt.scenes.explaining.engine import FeasibilityQuestions, smallest
from gearopt.scenes.explaining.possible import Verdict
from gearopt.scenes.reading.load import load
from gearopt.scenes.reading.toml_writing import toml_text

slow = pytest.mark.slow
ISO = "".join(
    f"{line}\n"
    for line in PAIR.replace('standard = "both"', 'standard = "iso6336"').splitlines()
    if not line.startswith(AGMA_ONLY)
)
SERIES = '{ from = "60 mm", to = "90 mm", series = "R20" }'
STEPS = '{ from = "60 mm", to = "90 mm", step = "5 mm" }'
SPUR = ISO.replace("12 deg", "0 deg")
UNDERCUT = SPUR.replace("[14, 40]", "[8, 11]") + "[shift]\npinion_shift = 0\n"
FEW_SPUR = SPUR.replace("[14, 40]", "[18, 22]")
OF_SUM = SPUR.replace('centre_distance = "125 mm"\n', "").replace("[14, 40]", "[9, 11]")


def at(distance, text=ISO):
    return text.replace('"125 mm"', distance)


def groups(tmp_path, text, way=1):
    scene = load(written(tmp_path, text)).scene
    return scene, [*choice_groups(scene, way), *teeth_groups(scene, way)]


@pytest.mark.parametrize(
    ("distance", "way", "written_first"),
    [
        ('["112 mm", "125 mm"]', 1, "112 mm, 125 mm, 140 mm"),
        ('["112 mm", "125 mm"]', -1, "100 mm, 112 mm, 125 mm"),
        ('["106 mm", "125 mm"]', 1, "106 mm, 125 mm, 132 mm"),  # of R40
        ('["101 mm", "117 mm"]', 1, "101 mm, 112 mm, 117 mm"),
        (STEPS, 1, "60 mm, 95 mm, 5 mm"),
        (STEPS, -1, "55 mm, 90 mm, 5 mm"),
        (SERIES, 1, "60 mm, 100 mm, R20"),
        (SERIES, -1, "56 mm, 90 mm, R20"),
    ],
)
def test_the_next_value_goes_on_as_the_file_does(tmp_path, distance, way, written_first):
    scene, found = groups(tmp_path, at(distance), way)
    (move,) = found[0].numbers
    now = scene.stage[0].centre_distance
    value = move.text(move.write(now, move.steps[0], move), move.path)
    entries = value.values() if isinstance(value, dict) else value
    assert ", ".join(entries) == written_first
    assert move.steps[0] > 1.0 and len(set(move.steps)) == len(move.steps)


def test_distances_of_both_stages_get_one_more_together(tmp_path):
    _, found = groups(tmp_path, asked(""))
    both = next(group for group in found if len(group.numbers) > 1)
    assert [move.path[1] for move in both.numbers] == [0, 1]
    for move in both.numbers:
        text = move.text(move.write(None, move.steps[0], move), move.path)
        assert [*text] == ["112 mm", "125 mm", "140 mm"]


@pytest.mark.parametrize(
    ("sums", "way", "first", "last"),
    [
        ("-0.2", 1, "-0.1", "1"),
        ("[0, 1.2]", 1, "[0, 1.2, 1.3]", "[0, 1.2, 1.5]"),
        ("{ from = 0, to = 1, step = 0.2 }", 1, "0.0 1.2", "0.0 1.4"),
        ("{ from = 0, to = 1, step = 0.2 }", -1, "-0.2 1.0", "-0.4 1.0"),
        ("1.5", 1, "", ""),
    ],
)
def test_sums_of_shifts_go_as_far_as_a_file_may_have_them(tmp_path, sums, way, first, last):
    scene, found = groups(tmp_path, f"{OF_SUM}[shift]\nsum = {sums}\n", way)
    moves = [move for group in found for move in group.numbers if move.path == ("shift", "sum")]
    assert bool(moves) == bool(first)
    for move in moves:
        for factor, wanted in ((move.steps[0], first), (move.steps[-1], last)):
            value = move.write(scene.shift.sum, factor, move)
            ends = getattr(value, "low", None), getattr(value, "high", None)
            of_range = " ".join(f"{float(end):.1f}" for end in ends if end is not None)
            assert (of_range or toml_text(move.text(value, move.path))) == wanted


def test_the_sum_moves_to_sums_that_stages_have(tmp_path):
    scene, found = groups(tmp_path, asked('sum_of_centre_distances = "224 mm"'))
    (move,) = found[0].numbers
    now = scene.limits.sum_of_centre_distances
    sums = [move.write(now, factor, move)[0].exact[0] for factor in move.steps]
    assert sums == [237, 250]
    both = move.together(now, move.steps[-1], move)
    assert [end.exact[0] for end in both] == [224, 250]


def test_stages_in_line_get_the_same_distance(tmp_path):
    scene, found = groups(tmp_path, asked("coaxial = true"))
    stages = [move.path for move in found[0].numbers]
    assert stages == [("stage", k, "centre_distance") for k in (0, 1)]
    first, second = found[0].numbers
    assert first.steps == second.steps


def test_the_nearest_member_of_the_series_with_a_design_is_found(tmp_path):
    scene, found = groups(tmp_path, at(SERIES.replace('"90', '"80'), FEW_SPUR))
    case = Case(scene, Clock(Budget(seconds=60.0), None), seconds=20.0)
    asked_of = FeasibilityQuestions(
        scene, lambda other, clock: Verdict(any_possible(case, [other.train()])), case.clock
    )
    known = smallest(asked_of, found[0].moves)
    (change,) = asked_of.edited(known.at(known.high)).changes
    assert change.write == '{from = "60 mm", to = "112 mm", series = "R20"}'
    assert known.sure and change.factor == pytest.approx(1.4)


def test_shifts_that_undercut_all_pinions_are_the_conflict(tmp_path):
    scene = load(written(tmp_path, UNDERCUT)).scene
    known = conflict(Case(scene, Clock(Budget(seconds=60.0), None), seconds=20.0))
    assert known.names == ("pinion_shift", "centre_distance[1]") and known.any_resolves


def test_a_sum_of_shifts_that_slides_too_much_is_in_the_conflict(tmp_path):
    scene = load(written(tmp_path, OF_SUM + "[shift]\nsum = -0.2\n")).scene
    known = conflict(Case(scene, Clock(Budget(seconds=60.0), None), seconds=20.0))
    assert known.names == ("pinion_teeth_high[1]", "specific_sliding", "sum_of_profile_shifts")
    assert known.any_resolves


def solved_with(file, remedy):
    return gearopt.solve(file, remedy.edits, remedies=False).status


@slow
@pytest.mark.parametrize(
    ("text", "key", "write"),
    [
        (at('["80 mm", "90 mm"]'), "stage[1].centre_distance", '["80 mm", "90 mm", "100 mm"]'),
        (at(STEPS), "stage[1].centre_distance", '{from = "60 mm", to = "100 mm", step = "5 mm"}'),
        (UNDERCUT, "shift.pinion_shift", ""),
        (OF_SUM + "[shift]\nsum = -0.2\n", "shift.sum", "0.1"),
        (ISO.replace("12 deg", "8 deg").replace("[limits]", "[limits]\noverlap_ratio = 3"),)
        + ("gears.helix_angle", '"15 deg"'),
    ],
)
def test_what_a_stage_chooses_from_is_a_remedy(tmp_path, text, key, write):
    file = written(tmp_path, text)
    explained = gearopt.explain(file)
    ways = {r.changes[0].key: r for r in explained.remedies if r.changes[0].write == write}
    assert explained.result.status == "infeasible" and key in ways
    assert all(solved_with(file, remedy) == "optimal" for remedy in explained.remedies)


@slow
def test_a_number_far_too_small_is_moved_to_the_nearest_with_a_design(tmp_path):
    file = written(tmp_path, at('"20 mm"'))
    (nearest,) = (r for r in gearopt.explain(file).remedies if r.kind == "least")
    assert nearest.changes[0].key == "stage[1].centre_distance" and nearest.factor > 3.0
    assert solved_with(file, nearest) == "optimal"


@slow
@pytest.mark.parametrize(
    ("limit", "key"),
    [
        ("coaxial = true", "limits.coaxial"),
        ('sum_of_centre_distances = "160 mm"', "limits.sum_of_centre_distances"),
    ],
)
def test_ties_of_distances_are_named_moved_and_dropped(tmp_path, limit, key):
    lists = '["80 mm", "112 mm"]', '["80 mm", "140 mm"]'
    file = written(tmp_path, asked(limit, *lists))
    explained = gearopt.explain(file)
    assert explained.result.status == "infeasible"
    assert key.removeprefix("limits.") in explained.conflict
    dropped = [r for r in explained.remedies if r.kind == "choice" and r.changes[0].key == key]
    moved = [r for r in explained.remedies if r.kind != "choice"]
    assert len(dropped) == 1 and moved
    assert all(solved_with(file, remedy) == "optimal" for remedy in explained.remedies)


@slow
def test_a_front_of_sums_is_that_of_every_two_distances(tmp_path):
    lists = '["112 mm", "125 mm", "140 mm"]', '["112 mm", "125 mm"]'
    text = FEW.replace('"100 mm"', lists[0]).replace('"160 mm"', lists[1])
    file = written(tmp_path, text)
    best = {}
    for first in (112, 125, 140):
        for second in (112, 125):
            one = {
                f"stage[{k + 1}].centre_distance": f"{a} mm" for k, a in enumerate((first, second))
            }
            value = gearopt.solve(file, one, remedies=False).value or math.inf
            best[first + second] = min(best.get(first + second, math.inf), value)
    left = [
        s for s, v in best.items() if v < min([w for t, w in best.items() if t < s] + [math.inf])
    ]
    front = gearopt.pareto(file, objectives=["gear_volume", "sum_of_centre_distances"])
    assert front.status == "complete"
    found = sorted((p.values[1], p.values[0]) for p in front.points)
    assert [s for s, _ in found] == pytest.approx(sorted(left))
    assert [v for _, v in found] == pytest.approx([best[s] for s in sorted(left)], rel=1e-9)
    least = gearopt.solve(file, {"objective.minimise": "sum_of_centre_distances"}, remedies=False)
    assert least.status == "optimal" and Fraction(least.value) == min(left)
