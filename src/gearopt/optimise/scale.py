"""The own scale of the variables and of the objective; the gap and the violation measured by it.

What is small is decided against the own scale of a quantity, so that neither the unit of a variable
nor a factor of the objective decides it.
"""

import math
from typing import Any

import numpy as np

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Batch, Problem
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.terms import Array

# of its box is the minimum scale of a variable, so that one at zero has a scale too
LEAST_SCALE = 1e-3
COARSE, FINE = 1e-2, 1e-10  # steps that see curvature, and gradients alone
NOTHING = 1e-28  # the square of a rounding
ENTRIES = 1_000_000  # of the points that are evaluated at once


def sizes(problem: Problem | Conic, x: Array) -> Array:
    """Own scale of every variable at a point (n,): the change that matters.

    Itself for a log variable; else the largest of |x|, |guess| and LEAST_SCALE of its box, at most
    the width of its box. 1 where all of these are zero or infinite.
    """
    lower, upper, guess = problem.bounds()
    logarithmic = np.array([v.log for v, _ in problem.columns])
    width = np.where(upper > lower, upper - lower, np.inf)
    part = np.where(np.isfinite(width), LEAST_SCALE * width, 0.0)
    size = np.minimum(width, np.maximum(np.maximum(np.abs(x), np.abs(guess)), part))
    size = np.where(logarithmic, np.abs(x), size)
    return np.where(size > 0.0, size, 1.0)


def objective_scale(
    problem: Problem | Conic, x: Array, step: float = FEASIBLE, own: Array | None = None
) -> float:
    """Return how far the objective moves, in all, where variables move by their own scales.

    Measured with steps of `step` of each scale (`own`, by default `sizes`), inside the box, and
    divided by it. Discrete variables of a Problem stay where they are: its text may know no values
    between theirs.
    """
    lower, upper, _ = problem.bounds()
    moves = np.flatnonzero(~_fixed(problem))
    size = step * (sizes(problem, x) if own is None else own)
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


def _fixed(problem: Problem | Conic) -> Any:
    """Return which variables may only have certain values, (n,)."""
    return np.array([v.discrete and isinstance(problem, Problem) for v, _ in problem.columns])


def way(problem: Problem | Conic, x: Array) -> float:
    """Return how far the objective has come from that of the guess; NaN where it is none."""
    begin = np.where(_fixed(problem), x, problem.bounds()[2])
    with np.errstate(all="ignore"):
        first, here = (float(v) for v in problem.batch(np.stack([begin, x])).F[:, 0])
    return abs(first - here)


def zero_scale(problem: Problem | Conic, x: Array) -> float:
    """Scale of an objective of zero: the `way` from the guess.

    0 where the objective at x is no zero: where it moves by less than itself as every variable
    moves by FEASIBLE of its magnitude. A width of the box plays no part, as it may be any. From a
    guess that is as good, how far it moves in all where the variables do: by COARSE of their
    magnitude if it is NOTHING beside that, else by FINE.
    """
    here, came = float(problem.batch(x[None]).F[0, 0]), way(problem, x)
    size = np.maximum(np.abs(x), np.abs(problem.bounds()[2]))
    size = np.where([v.log for v, _ in problem.columns], np.abs(x), size)
    size = np.where(size > 0.0, size, sizes(problem, x))
    moved = objective_scale(problem, x, own=size)
    if is_known(here, moved):
        return 0.0
    if came > FEASIBLE * moved and math.isfinite(came):
        return came
    wide = objective_scale(problem, x, COARSE, size)
    if abs(here) <= NOTHING * wide:
        return wide
    fine = objective_scale(problem, x, FINE, size)
    return fine if abs(here) <= FINE * fine else 0.0


def gap(value: float, bound: float, scale: float = 0.0) -> float:
    """Return how far a value lies above a bound, relative to |value|.

    A value below FEASIBLE of the objective's scale is zero, as far as it can be known: then the gap
    is relative to the scale. Above a bound that is positive no optimum is zero.
    """
    if (size := unit(value, 0.0 if 0.0 < bound <= value else scale)) > 0.0:
        return (value - bound) / size
    return 0.0 if value == bound else math.copysign(math.inf, value - bound)


def unit(value: float, scale: float) -> float:
    """Scale of differences of the objective: |value|, or of zero its scale."""
    return abs(value) if is_known(value, scale) else scale


def is_known(value: float, scale: float) -> bool:
    """Return whether a value of the objective differs from zero."""
    return abs(value) > FEASIBLE * scale


def measured(
    problem: Problem | Conic, x: Array, value: float, bound: float, enough: float
) -> tuple[float, dict[str, float]]:
    """Return the gap of a point, and {"scale": ...} where it is relative to that.

    enough: a gap relative to |value| up to it needs no scale.
    """
    relative = gap(value, bound)
    if 0.0 <= relative <= enough or 0.0 < bound <= value:
        return relative, {}
    scale = zero_scale(problem, x)
    return (
        (relative, {}) if is_known(value, scale) else (gap(value, bound, scale), {"scale": scale})
    )


RUNAWAY = 1e9  # a variable without a bound that moves this factor from its guess is held by nothing


def violation(problem: Problem | Conic, x: Array, batch: Batch) -> tuple[float, str]:
    """Return the largest violation of rows, bounds and discreteness, and the name of its row.

    Of rows and of the limits that the problem looks at more closely (`exact_limits`). A row that
    is infinite, of either sign, or no number is violated.
    That of a bound is relative to the variable's own scale, of a value to that or to 1.
    """
    lower, upper, _ = problem.bounds()
    size = sizes(problem, x)
    names = [r.name for r in problem.rows.inequalities] + list(problem.rows.equalities)
    names += [f"bound of {name}" for _, name in problem.columns]
    names += [f"set of values of {name}" for _, name in problem.columns]
    columns = zip(problem.columns, x, np.minimum(size, 1.0), strict=True)
    discrete = [_distance(v, value, unit) for (v, _), value, unit in columns]
    amounts = np.concatenate(
        [
            np.where(np.isneginf(batch.G[0]), np.inf, batch.G[0] - 1.0),
            np.abs(batch.H[0] - 1.0),
            np.maximum(lower - x, x - upper) / np.minimum(size, np.maximum(1.0, np.abs(x))),
            np.array(discrete),
        ]
    )
    worst = int(amounts.argmax())  # the first NaN; at least 0, that of a value that is met
    largest = float(amounts[worst]), names[worst]
    if isinstance(problem, Conic) or problem.exact_limits is None or math.isnan(largest[0]):
        return largest
    return max(largest, *((used - 1.0, name) for name, used in problem.exact_limits(x).items()))


def broken(problem: Problem | Conic, x: Array, excess: float, worst: str) -> str:
    """Return the sentence, without a full stop, on the largest violation at a point.

    excess, worst: as `violation` returns them. A variable has its value and what it may be.
    """
    lower, upper, _ = problem.bounds()
    for (variable, name), value, low, high in zip(problem.columns, x, lower, upper, strict=True):
        if worst == f"set of values of {name}":
            kind = "a whole number" if variable.values is None else "one of its values"
            return f"{name} = {value:.6g} is not {kind}"
        for side, end, outside in (("above", high, value > high), ("below", low, value < low)):
            if worst == f"bound of {name}" and outside and f"{value:.6g}" != f"{end:.6g}":
                return f"{name} = {value:.6g} is {side} its bound {end:.6g}"
    return f"{worst} is violated by {excess:.3g}"


def _distance(variable: Any, value: float, unit: float) -> float:
    """Return the distance of a discrete variable from its nearest value, in a unit of it."""
    if variable.values is not None:
        return float(min(abs(value - v) for v in variable.values)) / unit
    return abs(value - round(value)) if variable.integer else 0.0


def runaway(problem: Problem | Conic, x: Array, lower: Array, upper: Array, guess: Array) -> str:
    """Name a variable that nothing holds: unbounded, and far beyond any scale of its guess."""
    scale = RUNAWAY * np.maximum(1.0, np.abs(guess))
    loose = ~(np.isfinite(lower) & np.isfinite(upper)) & (np.abs(x) > scale)
    if not loose.any():
        return ""
    k = int(np.argmax(loose))
    return f"{problem.columns[k][1]} is unbounded ({x[k]:.3g}): give it a bound or a limit"
