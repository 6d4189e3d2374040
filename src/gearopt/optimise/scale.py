"""The own scale of the variables and of the objective, and the gap that is measured by it.

What is small is decided against the own scale of a quantity, so that neither the unit of a variable
nor a factor of the objective decides it.
"""

import math

import numpy as np

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array

FEASIBLE = 1e-8  # of its own scale a variable, of 1 a row is off; that is below any data error
PART = 1e-3  # of its box is the least scale of a variable, so that one at zero has a scale too
ENTRIES = 1_000_000  # of the points that are evaluated at once


def sizes(problem: Problem | Conic, x: Array) -> Array:
    """Own scale of every variable at a point (n,): what it would have to move by to matter.

    Itself for a log variable; else the largest of |x|, |guess| and PART of its box, at most the
    width of its box. 1 where all of these are zero or infinite.
    """
    lower, upper, guess = problem.bounds()
    logarithmic = np.array([v.log for v, _ in problem.columns])
    width = np.where(upper > lower, upper - lower, np.inf)
    part = np.where(np.isfinite(width), PART * width, 0.0)
    size = np.minimum(width, np.maximum(np.maximum(np.abs(x), np.abs(guess)), part))
    size = np.where(logarithmic, np.abs(x), size)
    return np.where(size > 0.0, size, 1.0)


def objective_scale(problem: Problem | Conic, x: Array, step: float = FEASIBLE) -> float:
    """How far the objective moves, in all, where each variable moves by its own scale.

    Measured with steps of `step` of each scale, inside the box, and divided by it. Discrete
    variables of a Problem stay where they are: its text may know no values between theirs.
    """
    lower, upper, _ = problem.bounds()
    fixed = np.array([v.discrete and isinstance(problem, Problem) for v, _ in problem.columns])
    moves = np.flatnonzero(~fixed)
    size = step * sizes(problem, x)
    with np.errstate(all="ignore"):
        here = float(problem.batch(x[None]).F[0, 0])
        total, count = 0.0, max(1, ENTRIES // (2 * len(x)))
        for some in (moves[k : k + count] for k in range(0, len(moves), count)):
            points = np.tile(x, (2, len(some), 1))
            at = np.arange(len(some))
            points[0, at, some] = np.minimum(x[some] + size[some], upper[some])
            points[1, at, some] = np.maximum(x[some] - size[some], lower[some])
            moved = np.abs(problem.batch(points.reshape(-1, len(x))).F[:, 0] - here)
            moved[~np.isfinite(moved)] = 0.0
            total += float(moved.reshape(2, -1).max(axis=0).sum())
    return total / step


def gap(value: float, bound: float, scale: float = 0.0) -> float:
    """How far a value lies above a bound, relative to |value|.

    A value below FEASIBLE of the objective's scale is zero, as far as it can be known: then the gap
    is relative to the scale.
    """
    if (size := unit(value, scale)) > 0.0:
        return (value - bound) / size
    return 0.0 if value == bound else math.copysign(math.inf, value - bound)


def unit(value: float, scale: float) -> float:
    """What differences of the objective are relative to: |value|, or of zero its scale."""
    return abs(value) if is_known(value, scale) else scale


def is_known(value: float, scale: float) -> bool:
    """Whether a value of the objective can be told from zero."""
    return abs(value) > FEASIBLE * scale


def measured(
    problem: Problem | Conic,
    x: Array,
    value: float,
    bound: float,
    enough: float,
    rounding: float = 0.0,
) -> tuple[float, dict[str, float]]:
    """The gap of a point, and {"scale": ...} where it is relative to the objective's own scale.

    enough: a gap relative to |value| up to it needs no scale. rounding: that was taken off the
    bound, and keeps a value from being known better.
    """
    found = gap(value, bound)
    if 0.0 <= found <= enough:
        return found, {}
    scale = objective_scale(problem, x) + rounding / FEASIBLE
    return (found, {}) if is_known(value, scale) else (gap(value, bound, scale), {"scale": scale})
