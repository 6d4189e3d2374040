"""Meshes whose stiffness varies: what their windup varies by, and trains held to that error."""

import math
from dataclasses import replace
from fractions import Fraction as F
from functools import cache

import numpy as np
import pytest
from servo_trains import PAPER, STIFF, trains_within

from gearopt.formulations.servo.choice import Choice, train_problem
from gearopt.formulations.servo.split import problem, relaxation, stiff
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.optimise.solve import solve

PAPERS = 16, 26, 96, 208, 0.5, 0.5
ENDS = 0.75, 1.25  # of the mean stiffness, 50 % apart
LOADED = 3e4  # N mm, of which the error is a large part
SMALL = replace(
    PAPER,
    ratio=F(6),
    tolerance=F(2, 100),
    modules=(F(3, 10), F(2, 5)),
    pinion_teeth=(14, 18),
    max_wheel_teeth=52,
    bore=F(21, 5),
    wheel_tips=(F(20), F(20)),
    bending=3000.0,
    error=math.pi,
)


def springs(line, torque=421.7, minimum=None):
    return Springs(86.1e3, (8.0, 50.0), line, 206e3, 19.8, torque, minimum, variation=0.5)


def lines(teeth, line):
    """Mean stiffness of a mesh of these teeth per face width [MPa], by Buckingham and Lewis."""
    if line is not None:
        return line
    factors = [y / (0.242 + 7.25 * y) for y in (0.154 - 0.912 / z for z in teeth)]
    return 206e3 / sum(1.0 / z for z in factors)


def windups(train, line, torque, width=6.0):
    """Windup [rad] under a torque at the output as both meshes turn, from single to double contact.

    Contact ratio 1.6, without phase between the stages: their teeth differ in number.
    """
    z1, z3, z2, z4, m1, m2 = train
    turn = np.linspace(0.0, 2.0 * math.pi, 2_001)  # of the middle shaft
    angle = 0.0
    for teeth, m, wheel, speed, passed in (
        ((z3, z4), m2, z4, 1.0, z3),
        ((z1, z2), m1, z2, z4 / z3, z2),
    ):
        double = (passed * turn / (2.0 * math.pi)) % 1.0 < 0.6
        k = lines(teeth, line) * width * np.where(double, *ENDS[::-1])
        lever = 0.5 * m * wheel
        angle = angle + torque / speed / (k * lever**2) / speed
    return angle + torque * 32.0 * 50.0 / (math.pi * 86.1e3 * 8.0**4) / (z4 / z3) ** 2


@pytest.mark.parametrize("line", [10.3e3, None])
def test_windup_and_what_it_varies_by_as_the_teeth_turn(line):
    chain, gears = springs(line), pairs(PAPERS, 6.0)
    found, turned = chain.design(gears), windups(PAPERS, line, 421.7)
    assert math.radians(found.windup_deg) == pytest.approx(turned.max(), rel=1e-12)
    assert math.radians(found.windup_variation_deg) == pytest.approx(np.ptp(turned), rel=1e-12)
    assert 1e3 * found.output_Nm_per_rad == pytest.approx(421.7 / turned.max(), rel=1e-12)


@cache
def points():
    """Every train of SMALL within ratio, tips and bore, as points of `problem`."""
    return np.array(
        [(z1, z3, z2, z4, *map(float, m)) for (z1, z2, z3, z4), m in trains_within(SMALL)]
    )


def error(point, line, torque):
    """Error of a train, each stage by the diameter that its wheel has in effect at the output."""
    z1, z3, z2, z4, m1, m2 = point
    ends = 1.0 / ENDS[0] - 1.0 / ENDS[1]
    stages = ((z1, z2), m1 * z2 * z4 / z3), ((z3, z4), m2 * z4)
    return sum(
        lost / d + torque * ends * 4.0 / (lines(teeth, line) * 6.0 * d**2)
        for lost, (teeth, d) in zip(SMALL.lost_motion, stages, strict=True)
    )


@pytest.mark.parametrize("line", [10.3e3, None])
@pytest.mark.parametrize(("goal", "share"), [("error", 0.1), ("inertia", 0.02), ("mass", 0.1)])
def test_the_best_train_within_an_error_that_the_load_makes_too(line, goal, share):
    """Among all trains, listed; with a stiffness that half of them have, too."""
    errors = np.array([error(p, line, LOADED) for p in points()])
    assert (errors > 1.1 * np.array([error(p, line, 0.0) for p in points()])).all()
    limit = float(np.quantile(errors, share)) * (1.0 + 1e-9)
    train = replace(SMALL, error=limit, elastic=springs(line, LOADED))
    text = problem(train, goal)
    values = text.batch(points())
    free = problem(replace(train, error=math.pi), goal).batch(points())
    kept = (free.G <= 1.0 + 1e-12).all(axis=1) & (errors <= limit)
    worth = errors if goal == "error" else values.F[:, 0]
    best = float(worth[kept].min())
    for method in ("exact", "enumeration"):
        assert solve(text, method).value == pytest.approx(best, rel=1e-12)
    assert 0.7 * best < solve(relaxation(train, goal)).bound <= best * (1.0 + 1e-9)
    stiff_by = np.array([1.0 / windups(p, line, 1.0).max() for p in points()[kept]])
    chain = springs(line, LOADED, minimum=float(np.median(stiff_by)) * (1.0 - 1e-9))
    held = solve(train_problem(Choice(train, goal, chain)))
    known = text.batch(np.array(point_of(held))[None]).F[0, 0]
    assert known == pytest.approx(worth[kept][stiff_by >= chain.minimum].min(), rel=1e-12)


def point_of(result):
    design = result.design
    return [*design["pinion_teeth"], *design["wheel_teeth"], *design["module_mm"]]


def test_the_lightest_train_has_the_error_of_its_load():
    """At twice the torque its error limit, less by what the load makes, is met as before."""
    given = replace(STIFF, stiffness=(2.0 * math.pi * 200.0) ** 2 * 19.8)
    loaded = replace(given, elastic=springs(STIFF.line_stiffness, 3e4))
    found = solve(stiff(loaded))
    assert found.status == "optimal" and found.value > solve(stiff(given)).value
    (d1, d3), (n1, n2) = found.design["pinion_diameter_mm"], found.design["ratio"]
    widths = found.design["face_width_mm"]
    wheels = d1 * n1 * n2, d3 * n2
    error = sum(
        lost / d + 3e4 * (1.0 / ENDS[0] - 1.0 / ENDS[1]) * 4.0 / (STIFF.line_stiffness * b * d**2)
        for lost, d, b in zip(STIFF.lost_motion, wheels, widths, strict=True)
    )
    assert error == pytest.approx(STIFF.error, rel=1e-6)
