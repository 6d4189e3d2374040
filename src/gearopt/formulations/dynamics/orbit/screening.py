"""Designs of little vibration all over the ranges, as starts of a local method.

The problem has many local optima, all of which a local method calls solved. Designs that fill the
ranges are measured; the best of each neighbourhood are moved at random by ever shorter steps, all
side by side. What is left of them is sorted by its measure.
"""

import numpy as np

from gearopt.formulations.dynamics.orbit.orbit_text import reduced
from gearopt.formulations.dynamics.orbit.task import Task, solid
from gearopt.optimise.box import Box, box, violation
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array

SCREENED, CHUNK = 2048, 256  # designs drawn, and measured at once: some 50 ms
KEPT, APART = 64, 0.1  # of which the best are moved, so far from each other in a box of width 1
MOVES, ROUNDS = 8, 12  # tried of each in a round; rounds
LONGEST, SHORTEST = 0.2, 0.005  # moves of the first and of the last round, in a box of width 1
PENALTY = 5.0  # times the violation, added to the logarithm of the measure


def screened(task: Task, clock: Clock, seed: int) -> Array:
    """Return designs (N, 5) of a Latin hypercube after their moves, the most promising first."""
    rng, space = np.random.default_rng(seed), box(reduced(task))
    rows = np.tile(np.arange(SCREENED), (5, 1))
    unit = (rng.permuted(rows, axis=1).T + rng.random((SCREENED, 5))) / SCREENED
    points = within(task, space.points(unit))
    value = merit(task, points, clock)
    points = points[: len(value)]
    kept = apart(space, points[np.argsort(value, kind="stable")], KEPT)
    return narrowed(task, kept, clock, rng, LONGEST)


def narrowed(
    task: Task, points: Array, clock: Clock, rng: np.random.Generator, longest: float
) -> Array:
    """Return designs (N, 5) after ROUNDS of random moves that shrink from `longest`, sorted."""
    space, value = box(reduced(task)), merit(task, points, clock)
    points = points[: len(value)].copy()
    for step in np.geomspace(longest, SHORTEST, ROUNDS):
        if clock.over:
            break
        unit = space.unit(points)
        moves = step * rng.standard_normal((MOVES, *unit.shape))
        moved = within(task, space.points((unit + moves).reshape(-1, 5)))
        merits = merit(task, moved, clock)
        if len(merits) < len(moved):
            break
        each = merits.reshape(MOVES, -1)
        best, column = each.argmin(axis=0), np.arange(len(points))
        better = each[best, column] < value
        points[better] = moved.reshape(MOVES, -1, 5)[best, column][better]
        value = np.minimum(value, each.min(axis=0))
    return points[np.argsort(value, kind="stable")]


def merit(task: Task, points: Array, clock: Clock) -> Array:
    """Return the logarithm of the measure with a penalty for limits exceeded, (N,).

    Of the first designs alone where the clock stops.
    """
    merits, text = [np.empty(0)], reduced(task)
    for first in range(0, len(points), CHUNK):
        part = points[first : first + CHUNK]
        value, excess = violation(text, part)
        merits.append(np.log(value) + PENALTY * excess)
        clock.evaluations += len(part)
        if not clock.tell():
            break
    return np.concatenate(merits)


def within(task: Task, points: Array) -> Array:
    """Return designs moved into the limits as far as the ranges allow.

    A bearing stiffer than the displacement asks, a ramp that fits the contact ratio, and a face
    width, then a rim, that the mass allows.
    """
    low, high = task.box()
    kb, ratio, ramp, width, rim = points.T
    kb = np.maximum(kb, task.load / task.most_displacement)
    ramp = np.minimum(ramp, np.minimum(ratio - 1.0, 2.0 - ratio))
    most = task.most_mass / solid(task)
    width = np.maximum(np.minimum(width, most / rim), low[3])
    rim = np.minimum(rim, most / width)
    return np.asarray(np.clip(np.stack([kb, ratio, ramp, width, rim], axis=1), low, high))


def apart(space: Box, points: Array, count: int) -> Array:
    """Return the first designs (at most `count`) that are APART from those before them."""
    unit, kept = space.unit(points), [0]
    for k in range(1, len(points)):
        if len(kept) == count:
            break
        if np.linalg.norm(unit[kept] - unit[k], axis=1).min() > APART:
            kept.append(k)
    return points[kept]
