"""Fronts of servo trains, against their text at every choice of teeth and modules."""

import math
from dataclasses import replace
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from campaigns import few
from servo_trains import PAPER

from gearopt.formulations.servo import front as train_front
from gearopt.formulations.servo import split
from gearopt.formulations.servo.choice import Choice
from gearopt.formulations.servo.front import front, front_problem
from gearopt.formulations.servo.ratio import Drive, ServoDuty
from gearopt.formulations.servo.servo_box import Room, first_that_fits, of_train
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Budget

DRIVE = Drive(1.98e1, 8.6e-3, 50.0, motor_friction=3.0, load_friction=400.0)
FASTEST = ServoDuty(DRIVE, "acceleration")
MOTION = FASTEST.goal
SPRINGS = Springs(79e3, (5.0, 40.0), 10.3e3, 206e3, minimum=4e4)
ROOM = Room(2.0, 2.0, 1.0, (26.0, 26.0))


def posed(rng, error=1.5):
    """A small train of random numbers, modules of 0.3 and 0.6 mm, whose diameters tie."""
    return replace(
        PAPER,
        ratio=F(int(rng.integers(40, 110)), 10),
        tolerance=F(int(rng.integers(10, 120)), 1000),
        modules=(F(3, 10), F(6, 10)),
        pinion_teeth=(14, 16),
        max_wheel_teeth=52,
        bore=F(21, 5),
        wheel_tips=(F(16), F(28)),
        error=math.radians(error),
        bending=float(rng.uniform(500.0, 3000.0)),
        sector=float(rng.uniform(0.2, 1.0)),
        bodies=split.Bodies(F(2), F(3), F(4)),
        duty=FASTEST,
    )


def every_train(chosen, goals):
    """All choices whose text meets all limits, and fits the box, with their values."""
    train, problem = chosen.train, front_problem(chosen, goals)
    pinions = range(train.pinion_teeth[0], train.pinion_teeth[1] + 1)
    wheels = range(train.pinion_teeth[0], train.max_wheel_teeth + 1)
    modules = [float(m) for m in train.modules]
    grid = np.array(list(product(pinions, pinions, wheels, wheels)), float)
    n = grid[:, 2] * grid[:, 3] / (grid[:, 0] * grid[:, 1])
    low, high = (float(r) for r in train.ratios)
    grid = grid[(n >= low * (1 - 1e-9)) & (n <= high * (1 + 1e-9))]
    points = np.vstack(
        [np.column_stack([grid, *np.full((len(grid), 2), m).T]) for m in product(modules, modules)]
    )
    batch = problem.batch(points)
    good = (batch.G <= 1.0 + 1e-11).all(axis=1)
    points, values = points[good], batch.F[good]
    if chosen.room is not None:
        fits = [
            first_that_fits([of_train(pairs(x, train.face_width), chosen.room)]) is not None
            for x in points
        ]
        points, values = points[fits], values[fits]
    return points, values


def unbeaten(values):
    """Rows of values that no other beats, by the definition; equal ones once."""
    rows = np.unique(np.array([[float(f"{v:.10g}") for v in row] for row in values]), axis=0)
    return [r for r in rows if not ((rows <= r).all(axis=1) & (rows < r).any(axis=1)).any()]


def same(chosen, goals, most=None):
    _, values = every_train(chosen, goals)
    limits = {} if most is None else {goals[1]: most(values)}
    wanted = values if most is None else values[values[:, 1] <= limits[goals[1]] * (1 + 1e-9)]
    made = found(front_problem(chosen, goals), goals, limits)
    if not len(wanted):
        assert made.infeasible and made.message
        return 0
    assert made.complete and made.finished
    rows = np.array(unbeaten(wanted))
    assert made.values == pytest.approx(rows[np.argsort(rows[:, 0])], rel=1e-8)
    return len(rows)


@pytest.mark.parametrize(
    ("goals", "springs", "room"),
    [
        (("inertia", "error"), None, None),
        (("error", "mass", "inertia"), SPRINGS, None),
        (("mass", MOTION), None, None),
        (("inertia", "error"), SPRINGS, ROOM),
    ],
)
def test_a_front_is_complete_beside_a_look_at_every_choice(goals, springs, room):
    rng = np.random.default_rng(4)
    assert same(Choice(posed(rng), "inertia", springs, room), goals) >= 2


@pytest.mark.slow
def test_fronts_of_many_small_trains_are_complete():
    sizes = []
    for seed in range(24):
        rng = np.random.default_rng(seed)
        goals = [("inertia", "error"), ("inertia", "mass", "error"), (MOTION, "mass", "error")]
        chosen = Choice(
            posed(rng, rng.uniform(0.6, 1.5)),
            "inertia",
            SPRINGS if seed % 2 else None,
            replace(ROOM, box=tuple(rng.uniform(22.0, 32.0, 2))) if seed % 4 > 1 else None,
        )
        sizes.append(same(chosen, goals[seed % 3]))
    assert sum(n == 0 for n in sizes) >= 1 and sum(n >= 3 for n in sizes) >= 12


def test_largest_values_of_interest_cut_the_front():
    chosen = Choice(posed(np.random.default_rng(4)))
    goals = ("inertia", "error")
    assert same(chosen, goals, lambda v: float(np.median(v[:, 1]))) >= 1
    assert same(chosen, goals, lambda v: float(0.99 * v[:, 1].min())) == 0


@pytest.mark.parametrize("goal", few([MOTION, "mass"], 1))
def test_the_front_is_that_of_all_trains(goal, monkeypatch):
    monkeypatch.setattr(train_front, "MAX_WAITING", 70)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        train = replace(posed(rng), modules=(F(3, 10),))
        points = split.feasible(train, goal if goal == MOTION else "inertia")
        chosen = Choice(train, goal)
        made, worth = front(chosen, chosen.weighed, Clock(Budget()))
        if not len(points):
            assert not len(made)
            continue
        every = split.problem(train, *chosen.weighed).batch(points).F
        assert worth == pytest.approx(np.array(unbeaten(every)), rel=1e-8)
