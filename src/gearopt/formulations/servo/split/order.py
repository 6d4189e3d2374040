"""All feasible trains, and their Pareto front.

Trains are points of `split.problem`, (trains, 6). `check` is called several times a second and may
raise, to stop.
"""

import math
from bisect import bisect_left, bisect_right
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
STEPS = 1_000_000  # of the kernel between two checks
FEW = 60  # rows that are tried against all others
MANY = 2000  # rows from which on that is quicker than one by one
SLOW, IDLE = 0.005, 5  # part of the rows that must go at a time, or in so many more attempts
ROOM = 4096  # trains that it may note between two checks, at first


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
    rows, count = np.empty((ROOM, 6), np.int64), kernel(TEETH).first_stages(given)[0]
    while first < count:
        check()
        good, last = kernel(KERNEL).between(given, aim, first, STEPS, above, maximum, rows)
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


def pareto_front(worth: Array) -> list[int]:
    """Return the Pareto front of rows of worth (N, 2 or 3), all columns minimised.

    In the order of the first column; of equal rows the first one counts.
    """
    if worth.shape[1] == 2:
        worth = np.column_stack([worth, np.zeros(len(worth))])
    rows = _rest(worth)
    return [int(rows[k]) for k in _one_by_one(worth[rows])]


def _rest(worth: Array) -> Any:
    """Return the rows that are left once those that a few good ones dominate are dropped."""
    low, rows, idle = worth.min(0), np.arange(len(worth)), 0
    columns = np.ascontiguousarray(worth.T)
    spread = worth.max(0) - low
    width = np.where(spread > 0.0, spread, 1.0)  # a column of one value orders nothing
    for direction in np.random.default_rng(0).dirichlet([0.5, 0.5, 0.5], FEW) / width:
        a, b, c = columns
        best = (direction @ columns).argmin()
        x, y, z = columns[:, best]
        kept = (a < x) | (b < y) | (c < z) | ((a == x) & (b == y) & (c == z))
        dropped = len(rows) - int(kept.sum())
        if dropped:
            rows, columns = rows[kept], np.ascontiguousarray(columns[:, kept])
        idle = idle + 1 if dropped < SLOW * len(rows) else 0
        if idle > IDLE or len(rows) < MANY:
            break
    return rows


def _one_by_one(worth: Array) -> list[int]:
    """Return the Pareto front, by column 1, each row compared with a stair of the rest."""
    kept: list[int] = []
    stairs: list[tuple[float, float]] = []  # of columns 2 and 3: one rising, the other falling
    for k in np.lexsort(worth.T[::-1]):
        step = (float(worth[k, 1]), float(worth[k, 2]))
        at = bisect_right(stairs, (step[0], math.inf))
        if at and stairs[at - 1][1] <= step[1]:
            continue
        kept.append(int(k))
        at = bisect_left(stairs, step)
        while at < len(stairs) and stairs[at][1] >= step[1]:
            del stairs[at]
        stairs.insert(at, step)
    return kept
