"""All feasible trains.

Trains are points of `split.problem`, (trains, 6). `check` is called several times a second and may
raise, to stop.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.servo.split.numbers import Numbers, posed
from gearopt.formulations.servo.split.servo_train import ServoTrain
from gearopt.formulations.servo.split.teeth import problem
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.servo.split.order_kernel"
TEETH = "gearopt.formulations.servo.split.teeth_kernel"
KERNEL_STEPS = 1_000_000  # of the kernel between two checks
FIRST_NOTES = 4096  # trains that it may note between two checks, at first


def unchecked() -> None:
    """Let a list of trains go on to its end."""


def feasible(
    train: ServoTrain,
    goal: str = "inertia",
    maximum: int = 0,
    check: Callable[[], None] = unchecked,
) -> Array | None:
    """Return all feasible trains; None for more than `maximum` above 0.

    A duty as goal adds its limits.
    """
    return _listed(*posed(train, goal), -math.inf, math.inf, maximum, check)


def trains(train: ServoTrain, error: float) -> Array:
    """Return all feasible trains with an error [rad] up to `error`, the minimum first."""
    found = _listed(*posed(train, "error"), -math.inf, error, 0, unchecked)
    assert found is not None
    return found[problem(train, "error").batch(found).F[:, 0].argsort(kind="stable")]


def _listed(
    given: Numbers, aim: int, above: float, maximum: float, limit: int, check: Callable[[], None]
) -> Array | None:
    """Return trains between two values; None where they are more than a limit above 0."""
    parts, total, first = [], 0, 0
    rows, count = np.empty((FIRST_NOTES, 6), np.int64), kernel(TEETH).first_stages(given)[0]
    while first < count:
        check()
        good, last = kernel(KERNEL).between(given, aim, first, KERNEL_STEPS, above, maximum, rows)
        if good > len(rows):
            rows = np.empty((2 * good, 6), np.int64)
            continue
        parts.append(rows[:good].copy())
        total, first = total + good, last
        if 0 < limit < total:
            return None
    return points(given, np.concatenate([rows[:0], *parts]))


def points(given: Numbers, rows: Any) -> Array:
    """Return the points of a kernel's rows (N, 6): pinion and wheel teeth, modules."""
    z1, z2, z3, z4, i, j = rows.T
    return np.column_stack([z1, z3, z2, z4, given.module[i], given.module[j]]).astype(float)
