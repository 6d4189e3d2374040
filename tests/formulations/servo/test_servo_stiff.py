"""Servo trains of a least frequency: least mass, its bound, and what is out of reach."""

import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from servo_trains import PAPER, STIFF

from gearopt.formulations.servo.split import (
    problem,
    relaxation,
    stiff,
)
from gearopt.formulations.servo.split.servo_train import pairs, train_error
from gearopt.optimise import tape
from gearopt.optimise.certificate import certify
from gearopt.optimise.certified import limits
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.solvers import ipopt
from gearopt.physics.stiffness import stiffness_of_frequency

SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("frequency", "grams", "sizes"),
    [
        (150.0, 70.59627, (8, 11.50, 5.3517, 8.9691, 2, 2, 6.66)),
        pytest.param(200.0, 86.40050, (8, 12.20, 5.6311, 8.5241, 2, 2.18, 8.70), marks=SLOW),
        pytest.param(250.0, 128.15908, (8, 14.09, 6.5010, 7.3835, 2, 3.42, 10.59), marks=SLOW),
        (300.0, 181.12544, (8, 16.02, 7.3949, 6.4910, 2, 5.00, 12.52)),
    ],
)
def test_least_mass_under_stiffness(frequency, grams, sizes):
    """Our proven optima; the print's last digits at 200 Hz (8.5242) and 250 Hz (128.15907) differ.

    Its ratios at 200 Hz multiply to 48.0002, so n_2 there is 1e-4 off.
    """
    text = stiff(replace(STIFF, stiffness=stiffness_of_frequency(frequency, 19.8)))
    assert tape.kinds(text).log_convex
    result = solve(text)
    assert result.status == "optimal" and result.gap < 1e-10
    assert 1e3 * result.value == pytest.approx(grams, abs=7e-6)
    design = result.design
    found = [*design["pinion_diameter_mm"], *design["ratio"], *design["face_width_mm"]]
    digits = [6e-3, 6e-3, 6e-5, 7e-5, 6e-3, 6e-3, 6e-3]
    for value, expected, digit in zip(
        (*found, design["shaft_diameter_mm"]), sizes, digits, strict=True
    ):
        assert value == pytest.approx(expected, abs=digit)
    assert solve(text, "gp").value == pytest.approx(result.value, rel=1e-7)


def test_the_papers_point_of_the_stiff_train():
    text, point = stiff(STIFF), np.array([8.0, 13.0, 6.0, 8.0, 6.0, 6.0, 8.0])
    assert 1e3 * text.batch(point[None]).F[0, 0] == pytest.approx(210.88, abs=6e-3)
    stiffness = 1.0 / limits(text, point)["stiffness"]
    assert math.sqrt(stiffness / 19.8) / (2 * math.pi) == pytest.approx(210.1, abs=0.06)


def test_five_random_starts_end_at_one_optimum():
    text = stiff(replace(STIFF, stiffness=stiffness_of_frequency(250.0, 19.8)))
    rng, guess = np.random.default_rng(0), text.bounds()[2]
    for _ in range(5):
        start = guess * np.exp(rng.uniform(-0.5, 0.5, guess.size))
        verdict = certify(text, ipopt.run(text, Budget(), 0, None, start=start), 1e-6)
        assert verdict.status == "optimal"
        assert 1e3 * verdict.objective == pytest.approx(128.159074, abs=6e-7)


def test_the_first_stages_share_of_the_error_does_not_depend_on_the_split():
    """D_2 n_2 = D_1 N: an angle of stage 1 counts by its pinion and the total ratio alone."""
    shares = [
        train_error((PAPER.lost_motion[0], 0.0), pairs((16, 20, 16 * n_1, 960 / n_1, 0.5, 0.5)))
        for n_1 in (3, 6, 12)
    ]
    assert shares == pytest.approx([PAPER.lost_motion[0] / (8.0 * 48.0)] * 3, rel=1e-14)


def test_a_stiffness_out_of_reach_is_proven_and_named():
    text = stiff(STIFF).at(stiffness=stiffness_of_frequency(2000.0, 19.8))
    result = solve(text)
    assert result.status == "infeasible"
    assert {"stiffness", "inertia"} <= set(result.proof["conflict"])


def test_an_exact_ratio_is_an_equality_and_not_two_limits():
    """Two limits leave no interior: multipliers, and so the bound, would be worthless."""
    whole = replace(PAPER, tolerance=F(0), error=math.radians(0.115))
    bound = solve(relaxation(whole))
    assert bound.status == "optimal" and bound.gap < 1e-9
    best = solve(problem(whole))
    assert best.status == "optimal" and bound.bound <= best.value
    (z1, z3), (z2, z4) = best.design["pinion_teeth"], best.design["wheel_teeth"]
    assert z2 * z4 == 48 * z1 * z3
    text = stiff(replace(STIFF, ratio=(48.0, 48.0)))
    tied = solve(text.at(stiffness=stiffness_of_frequency(250.0, 19.8)))
    assert tied.status == "optimal" and tied.gap < 1e-9
    assert 1e3 * tied.value == pytest.approx(128.159074, abs=6e-7)
