"""Profile shifts of pinions to choose from at given distances: against all pairs, and refusals."""

import pytest
from test_given_distance import PAIR, shares, written
from test_several_distances import FEW

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import load

SHIFTS = "[shift]\npinion_shift = { from = 0.1, to = 0.5, step = 0.2 }\n"


def test_the_best_shift_of_the_pinion_is_that_of_all_pairs(tmp_path):
    path = written(tmp_path, f"{FEW}\n{SHIFTS}")
    train = load(path).scene.train()
    ratios = float(train.lowest_ratio), float(train.highest_ratio)
    every = [
        (*row, x)
        for x in (0.1, 0.3, 0.5)
        for row in shares(train, 0, train.torque, ratios, shift=x)
    ]
    best = min(every)
    result = gearopt.solve(path)
    stage = result.design["stages"][0]
    assert result.status == "optimal"
    assert result.value == pytest.approx(best[0], rel=1e-9)
    found = stage["normal_module_mm"], stage["pinion_teeth"], stage["wheel_teeth"]
    assert (*found, stage["pinion_profile_shift"]) == best[1:]
    assert (
        "The profile shift of the pinion of stage 1 was chosen from 3 values, 0.1 to 0.5."
        in (result.report["notes"])
    )


@pytest.mark.slow
def test_a_list_of_shifts_is_the_best_of_each_alone_at_several_distances(tmp_path):
    def solved(shifts, distances='["118 mm", "125 mm"]'):
        text = FEW.replace('"125 mm"', distances)
        path = written(tmp_path, f"{text}\n[shift]\npinion_shift = {shifts}\n")
        return gearopt.solve(path, remedies=False).value

    each = [solved(x, f'"{a} mm"') for x in (0.2, 0.4) for a in (118, 125)]
    assert solved([0.2, 0.4]) == pytest.approx(min(filter(None, each)), rel=1e-12)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (SHIFTS + "rule = 'equal sliding'\n", "shift.rule.*changes nothing beside pinion_shift"),
        ("[shift]\npinion_shift = 5\n", "shift.pinion_shift.*between -1 and 2"),
        (
            "[shift]\npinion_shift = { from = 0, to = 0.6 }\n",
            "(or give a step)",
        ),
        ("[shift]\npinion_shift = { from = 0.6, to = 0, step = 0.1 }\n", "ends in the wrong order"),
        (SHIFTS.replace("0.2 }", "0.001 }"), "has 401 values, above 200"),
    ],
)
def test_what_is_no_shift_of_pinions_is_refused(tmp_path, table, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, PAIR + table))
    assert all(part in str(refusal.value) for part in told.split(".*"))


def test_too_many_ways_to_cut_a_stage_are_refused(tmp_path):
    many = PAIR.replace('"125 mm"', '"R40"').replace("0.2 }", "0.002 }")
    many = many.replace('"12 deg"', '{ from = "5 deg", to = "30 deg", step = "5 deg" }')
    table = SHIFTS.replace("0.2 }", "0.01 }")
    with pytest.raises(SceneError, match="ways of cutting a stage"):
        load(written(tmp_path, many + table))
