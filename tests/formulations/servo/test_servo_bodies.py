"""What the gears of a servo train keep clear of: rows, relaxed rows, whole numbers are one law."""

import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from campaigns import few
from servo_trains import PAPER, STIFF

from gearopt.errors import SolveError
from gearopt.formulations.servo.split import Bodies, problem, relaxation, stiff
from gearopt.formulations.servo.split.bodies import clear_rows, minimum_teeth, rows
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.optimise.solve import solve
from gearopt.physics.gears import GearPair


def flat(found):
    return {
        f"{name}{k}": value
        for name, parts in found.items()
        for k, value in enumerate(parts if isinstance(parts, tuple) else (parts,))
    }


def test_relaxed_rows_are_below_the_true_ones_where_both_break_at_one():
    """A train that keeps its limits keeps the relaxed ones, for any sizes and ratios above 1."""
    rng = np.random.default_rng(3)
    for _ in range(500):
        m1, m2 = rng.uniform(0.1, 5.0, 2)
        d1, d3 = m1 * rng.uniform(12, 60), m2 * rng.uniform(12, 60)
        n1, n2 = rng.uniform(1.0, 20.0, 2)
        pairs = (
            GearPair.of_diameter(m1, d1 / m1, d1, n1, 1.0),
            GearPair.of_diameter(m2, d3 / m2, d3, n2, 1.0),
        )
        shaft, output, motor = rng.uniform(0.01, 60.0, 3)
        bodies = Bodies(F(shaft), F(output), F(motor))
        true = flat(rows(bodies, pairs))
        relaxed = flat(clear_rows(shaft, output, motor, pairs))
        assert (
            true.keys() == relaxed.keys() == {"output_shaft0", "hub0", "shaft0", "shaft1", "motor0"}
        )
        for name in true:
            assert true[name] > 1.0 or relaxed[name] <= 1.0 + 1e-12


def test_the_numbers_of_the_paper():
    """Shaft 8, hub 16, motor 24 mm: 22.4 mm of gear 2 and hub in 58.5 mm, and so on."""
    bodies = Bodies(F(8), F(16), F(24))
    found = rows(bodies, pairs((16, 26, 96, 208, 0.5, 0.5)))
    assert found["output_shaft"] == pytest.approx((24.5 + 8.0) / 58.5)
    assert found["hub"] == pytest.approx(16.0 / 102.75)
    assert found["shaft"] == pytest.approx((8.0 / 46.75, 8.0 / 11.75))
    assert found["motor"] == pytest.approx(16.0 / 28.0)


def test_a_train_with_nothing_in_the_way_is_the_same():
    free = replace(PAPER, pinion_teeth=(16, 24))
    held = replace(free, bodies=Bodies(F(8), F(16), F(24)))
    results = [solve(problem(t), "enumeration") for t in (free, held)]
    assert results[0].value == results[1].value
    assert results[0].proof["feasible_trains"] == results[1].proof["feasible_trains"] > 1000


@pytest.mark.parametrize("bodies", few([Bodies(F(8), F(16), F(60)), Bodies(F(16), F(80), F(0))], 1))
def test_bodies_in_the_way_change_the_train_and_raise_the_bound(bodies):
    loose = replace(PAPER, error=math.radians(0.3), bore=F(15), pinion_teeth=(16, 40))
    held = replace(loose, bodies=bodies)
    free, found = (solve(problem(t)) for t in (loose, held))
    assert free.value < found.value and found.status == "optimal"
    assert solve(problem(held), "enumeration").value == pytest.approx(found.value, rel=1e-12)
    bounds = [solve(relaxation(t)).bound for t in (loose, held)]
    assert bounds[0] <= bounds[1] * (1.0 + 1e-9) and bounds[1] <= found.value


def test_numbers_too_long_for_whole_numbers_are_refused():
    long = (F(1, 2), F(1, 2) + F(1, 10**17))
    with pytest.raises(SolveError, match="fewer digits"):
        minimum_teeth(Bodies(), long, 300)
    with pytest.raises(ValueError, match="not below zero"):
        Bodies(F(-1))


@pytest.mark.parametrize("shaft", [F(10), F(127, 20), F(1, 10**17), F(math.e * 3)])
def test_gears_beside_the_output_shaft_are_compared_exactly(shaft):
    """In fractions: m1 (z2 + 2) + shaft against m2 (z3 + z4); of pitches of 12 and 10 to an inch.

    The shafts are of whole modules, of a part of one, and of more digits than 64 bits hold.
    """
    modules = (F(254, 120), F(254, 100))
    found = minimum_teeth(Bodies(output_shaft=shaft), modules, 400)
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        for z2 in (17, 50, 100):
            beside = (modules[i] * (z2 + 2) + shaft) / modules[j]
            for teeth in (math.floor(beside), math.ceil(beside), math.ceil(beside) + 1):
                whole = found.units[i] * (z2 + 2) + found.output <= found.units[j] * teeth
                assert whole == (beside <= teeth)


@pytest.mark.parametrize("tips", [(1.0, 105.0), (61.0, 0.2)])
def test_wheels_smaller_than_a_tooth_are_impossible(tips):
    """There was an error of a log variable instead: tip diameters less two modules below zero."""
    result = solve(stiff(replace(STIFF, wheel_tips=tips)))
    assert result.status == "infeasible" and "wheel_tip_diameter" in str(result.proof["conflict"])


@pytest.mark.parametrize("bore", [F(10**9), F(1, 10**9)])
def test_a_bore_far_from_all_other_lengths_is_within_the_search(bore):
    result = solve(relaxation(replace(PAPER, bore=bore)))
    assert result.status == ("infeasible" if bore > 1 else "optimal")
    teeth = 16, max(16, math.ceil(bore / F(1, 2)))
    own = solve(stiff(replace(STIFF, bore=(float(bore), 3.5), pinion_teeth=teeth)))
    assert own.status == ("infeasible" if bore > 1 else "optimal")


def test_the_lightest_train_keeps_its_wheels_off_the_shafts():
    free, thick = (solve(stiff(replace(STIFF, output=d))) for d in (0.0, 102.7))
    wheels = [r.design["pinion_diameter_mm"][1] * r.design["ratio"][1] for r in (free, thick)]
    assert free.status == thick.status == "optimal" and thick.value >= free.value
    assert wheels[0] < 103.9 < 102.7 + 2.5 * 0.5 - 1e-6 <= wheels[1]
    assert solve(stiff(replace(STIFF, output=110.0))).status == "infeasible"
