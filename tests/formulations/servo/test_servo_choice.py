"""Trains that are stiff enough and fit a box, against looking at all."""

import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from servo_trains import PAPER
from uncompiled import uncompiled

from gearopt.formulations.servo import choice, servo_box, split
from gearopt.formulations.servo.choice import Choice, train_problem
from gearopt.formulations.servo.ratio import Drive, ServoDuty
from gearopt.formulations.servo.servo_box import Room, ServoBox, first_that_fits
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

DRIVE = Drive(1.98e1, 8.6e-3, 50.0, motor_friction=3.0, load_friction=400.0)
FASTEST = ServoDuty(DRIVE, "acceleration")
GOALS = "inertia", "mass", "error", FASTEST.goal


def posed(rng):
    """A small train of random numbers; half of them with modules whose diameters tie."""
    one = int(rng.integers(6, 12))
    other = 2 * one if rng.random() < 0.5 else one + int(rng.integers(1, 6))
    modules = F(one, 20), F(other, 20)
    return replace(
        PAPER,
        ratio=F(int(rng.integers(40, 110)), 10),
        tolerance=F(int(rng.integers(10, 120)), 1000),
        modules=modules,
        pinion_teeth=(14, 19),
        max_wheel_teeth=60,
        bore=14 * modules[0],
        wheel_tips=(45 * modules[1], 60 * modules[1]),
        error=math.radians(float(rng.uniform(0.5, 1.5))),
        bending=float(rng.uniform(500.0, 3000.0)),
        sector=float(rng.uniform(0.2, 1.0)),
        bodies=split.Bodies(F(2), F(3), F(4)),
        duty=FASTEST,
    )


def springs(rng, stiffness):
    line = None if rng.random() < 0.5 else 10.3e3
    return Springs(79e3, (5.0, 40.0), line, 206e3, minimum=stiffness)


def asked(train, points, rng):
    """Limits that some of the trains meet: a stiffness, a box, or both; ties on purpose."""
    made = pairs(points.T, train.face_width)
    known = springs(rng, None)
    values = np.sort(known.output_stiffness(made))
    known = replace(known, minimum=float(values[int(rng.integers(len(values)))]))
    size = float(rng.uniform(0.7, 1.5) * (points[:, 3] * points[:, 5]).min())
    room = Room(2.0, 2.0, float(rng.uniform(0.5, math.pi)), (size, size * rng.uniform(1.0, 1.5)))
    kind = int(rng.integers(3))
    return (known if kind != 1 else None), (room if kind != 0 else None)


def brute_force(chosen, points):
    """The least objective of the trains that keep stiffness and box, by other code."""
    worth = split.problem(chosen.train, chosen.goal).batch(points).F[:, 0]
    order = np.argsort(worth, kind="stable")
    if least := chosen.minimum_stiffness:
        made = pairs(points[order].T, chosen.train.face_width)
        order = order[chosen.springs.output_stiffness(made) >= least * (1.0 - 1e-12)]
    if chosen.room is None:
        return float(worth[order[0]]) if len(order) else None
    fit = first_that_fits(boxes(points[order], chosen))
    return None if fit is None else float(worth[order[fit[0]]])


def boxes(points, chosen):
    """The boxes of trains, one by one, their sizes computed at once."""
    made, room = pairs(points.T, chosen.train.face_width), chosen.room
    tips = np.stack([0.5 * gear.tip_diameter for pair in made for gear in pair.gears], axis=1)
    links = np.stack([pair.centre_distance for pair in made], axis=1)
    radii = np.stack([tips[:, 0].clip(room.motor_radius), tips[:, 1:3].max(axis=1), tips[:, 3]])
    for sizes, link in zip(radii.T.tolist(), links.tolist(), strict=True):
        yield ServoBox(tuple(sizes), tuple(link), room.hub, room.half_sweep, room.box)


def compared(seeds):
    answered, impossible = 0, 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        train, goal = posed(rng), GOALS[seed % 4]
        points = split.feasible(train, goal)
        if not len(points):
            continue
        chosen = Choice(train, goal, *asked(train, points, rng))
        best = brute_force(chosen, points)
        factor = choice.GOALS[goal].factor
        found = solve(train_problem(chosen))
        if best is None:
            assert found.status == "infeasible", (seed, found)
            impossible += 1
            continue
        assert found.status == "optimal", (seed, found.message)
        assert found.value == pytest.approx(factor * best, rel=1e-12), seed
        answered += 1
        given = choice.best_kept(train, goal, chosen.kept, math.inf, Clock(Budget()), some=True)
        assert chosen.keeps(given)
    return answered, impossible


def test_stiff_trains_in_boxes_are_what_looking_at_all_finds():
    answered, impossible = compared((2, 7, 8))
    assert answered and impossible


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 160, 16))
def test_hundreds_of_stiff_trains_in_boxes_are_what_looking_at_all_finds(first):
    answered, impossible = compared(range(first, first + 16))
    assert answered > 3 and impossible


def test_a_look_at_a_range_of_links_excludes_no_layout():
    """What fits with one link of stage 2 is not excluded for any range around it."""
    rng = np.random.default_rng(3)
    code, tried = uncompiled("gearopt.formulations.servo.servo_box_kernel"), 0
    for _ in range(400):
        a, b = rng.uniform(10.0, 30.0, 2)
        radii, half = tuple(rng.uniform(5.0, 25.0, 3)), float(rng.uniform(0.3, math.pi))
        box = ServoBox(radii, (a, b), 3.0, half, tuple(rng.uniform(50.0, 110.0, 2)))
        given = servo_box.numbers(box)
        angle = float(rng.uniform(0.0, 0.5 * math.pi))
        if math.isnan(code.room(given, 1.0, angle, angle, 0.0)):
            continue
        tried += 1
        low, high = angle - rng.uniform(0.0, 0.3), angle + rng.uniform(0.0, 0.3)
        wide = np.array([a, b * rng.uniform(0.3, 1.0), b * rng.uniform(1.0, 3.0)])
        assert not math.isnan(code.room(given._replace(link=wide), 1.0, low, high, 1e-12))
    assert tried > 100


def test_a_search_stops_when_told_and_pauses_change_nothing(monkeypatch):
    rng = np.random.default_rng(11)
    train = posed(rng)
    points = split.feasible(train)
    chosen = Choice(train, "mass", *asked(train, points, rng))
    whole = choice.best_kept(train, "mass", chosen.kept, 1e-3, Clock(Budget()))
    monkeypatch.setattr(choice, "KERNEL_STEPS", (1, 1))
    seen = []
    clock = Clock(Budget(), lambda event: seen.append(event) or True)
    assert np.array_equal(choice.best_kept(train, "mass", chosen.kept, 1e-3, clock), whole)
    assert len(seen) > 100
    with pytest.raises(TimeoutError):
        choice.best_kept(train, "mass", chosen.kept, 1e-3, Clock(Budget(seconds=0.0)))
