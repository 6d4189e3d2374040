"""[[cost]] of a servo axis's file: a deviation's own cost and exponent; tooth thickness."""

import math
from pathlib import Path

import pytest
from campaigns import few
from scene_files import dump, parse

import gearopt
from gearopt.errors import SceneError
from gearopt.physics.backlash import backlash_angle, thickness_backlash
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[3] / "problems"


def scene(name, **tables):
    content = parse((PROBLEMS / f"servo_gimbal_{name}.toml").read_text(encoding="utf-8"))
    return read(dump(content | tables).encode(), "my.toml")[1]


def pitch(**more):
    return [{"deviation": "pitch"} | more]


@pytest.mark.parametrize(
    ("rule", "cost"), few([("rss", 7.837665499), ("worst_case", 10.476355529)], 1)
)
def test_exponents_of_a_half_and_two_in_turn(rule, cost):
    """14 deviations, each as dear as before; a root search and a conic solver agree."""
    result = gearopt.solve(scene("costs", budget=[{"rule": rule}]))
    assert result.status == "optimal" and result.value == pytest.approx(cost, abs=6e-10)
    rows = result.design["tolerances"]
    assert sum(row["new_cost"] for row in rows) == pytest.approx(cost, abs=6e-10)
    prices = [math.log(r["new_cost"]) / math.log(r["old_mm"] / r["new_mm"]) for r in rows]
    assert prices == pytest.approx([0.5, 2.0] * 7, rel=1e-9)


def test_a_cost_of_both_pitches_is_pitch_cost():
    own = gearopt.solve(scene("tolerances", cost=pitch(cost=4)))
    short = gearopt.solve(scene("tolerances", tolerances={"exponent": 1, "pitch_cost": 4}))
    assert own.value == pytest.approx(short.value, rel=1e-12)
    assert own.design["allocation"]["old_cost"] == 20.0


def test_a_dearer_deviation_becomes_wider(solved):
    plain = solved("servo_gimbal_tolerances").design["tolerances"]
    dear = gearopt.solve(scene("tolerances", cost=pitch(stage=2, cost=4))).design["tolerances"]
    wider = [b["new_mm"] > a["new_mm"] for a, b in zip(plain, dear, strict=True)]
    assert wider == [False] * 13 + [True]


def test_grades_have_costs_of_their_own():
    result = gearopt.solve(scene("grades", cost=pitch(stage=2, cost=4, exponent=2)))
    row = result.design["tolerances"][-1]
    assert row["old_cost"] == 4.0
    assert row["new_cost"] == pytest.approx(4.0 * (row["old_mm"] / row["new_mm"]) ** 2)
    assert result.value == pytest.approx(sum(r["new_cost"] for r in result.design["tolerances"]))


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (pitch(), "says nothing"),
        ([{"deviation": "pinion_thickness", "cost": 2}], "no [[mesh]] has"),
        ([*pitch(cost=2), *pitch(stage=2, cost=3)], "repeats a deviation"),
    ],
)
def test_a_cost_that_means_nothing_is_refused(rows, words):
    with pytest.raises(SceneError, match=r"cost") as refused:
        scene("tolerances", cost=rows)
    assert words in str(refused.value)


def test_thinner_teeth_open_the_backlash_by_their_law():
    """2 j_t/D of stage 1 at the output, j_t = the allowance; 10 um on 48 mm behind 8 to 1."""
    mesh = parse((PROBLEMS / "servo_gimbal_tolerances.toml").read_text(encoding="utf-8"))["mesh"]
    mesh[0] |= {"pinion_thickness": "0.01 mm"}
    result = gearopt.solve(scene("tolerances", mesh=mesh))
    (row,) = (e for e in result.design["errors"] if "thickness" in e["source"])
    law = backlash_angle(thickness_backlash(-0.01, 0.0, 0.0, math.radians(20.0)), 48.0) / 8.0
    assert math.radians(row["error_deg"]) == pytest.approx(law, rel=1e-12)
    assert law == pytest.approx(2.0 * 0.01 / 48.0 / 8.0, rel=1e-12)
