"""The values of discrete variables, and the box that samplers move in.

In it are logarithms of positive variables and indices of finite sets. Coordinates are in [0, 1];
`points` maps them to natural points whose discrete variables are exact.
"""

import math
from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array

ROUNDING = 1e-12  # relative; a bound that is computed (3 x 0.1) still holds the value it stands for


def allowed_values(problem: Problem | Conic, column: int) -> Sequence[float]:
    """Return values of one component of a point in order: those of its set, or its whole numbers.

    SolveError where its bounds hold none, or where an integer has no finite bounds.
    """
    variable, name = problem.columns[column]
    if variable.values is None:
        minimum, maximum = whole_ends(problem, column)
        if not (math.isfinite(minimum) and math.isfinite(maximum)):
            raise SolveError(f"{problem.name}: the integer {name} needs finite bounds")
        return range(int(minimum), int(maximum) + 1)
    low, high = _widened(problem, column)
    values = tuple(sorted({float(v) for v in variable.values if low <= v <= high}))
    return values or _nothing(problem, column, "value of its set")


def check_discrete(problem: Problem) -> None:
    """Raise SolveError where the bounds of a discrete variable hold none of its values."""
    for column, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            allowed_values(problem, column)
        elif variable.integer:
            whole_ends(problem, column)


def whole_ends(problem: Problem | Conic, column: int) -> tuple[float, float]:
    """Return minimum and maximum whole number within the bounds of an integer, or infinities."""
    low, high = _widened(problem, column)
    minimum = float(math.ceil(low)) if math.isfinite(low) else low
    maximum = float(math.floor(high)) if math.isfinite(high) else high
    return (minimum, maximum) if minimum <= maximum else _nothing(problem, column, "whole number")


def _widened(problem: Problem | Conic, column: int) -> tuple[float, float]:
    low, high = (float(b[column]) for b in problem.bounds()[:2])
    return low - ROUNDING * abs(low), high + ROUNDING * abs(high)


def _nothing(problem: Problem | Conic, column: int, what: str) -> NoReturn:
    low, high = (float(b[column]) for b in problem.bounds()[:2])
    name = problem.columns[column][1]
    raise SolveError(f"{problem.name}: no {what} lies between {low:g} and {high:g} for {name}")


@dataclass(frozen=True)
class Box:
    """Lower and upper ends (n,) in search coordinates, and how each coordinate is read.

    minimum, maximum: natural ends, those of integers whole.
    """

    low: Array
    high: Array
    minimum: Array
    maximum: Array
    logarithmic: Array
    whole: Array
    sets: dict[int, Array]

    def points(self, unit: Array) -> Array:
        """Return the points (N, n) that `unit` scales to these, rounded to allowed values."""
        y = self.low + np.clip(unit, 0.0, 1.0) * (self.high - self.low)
        x = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, y, 0.0)), y)
        x = np.where(self.whole, np.clip(np.rint(x), self.minimum, self.maximum), x)
        for k, values in self.sets.items():
            x[:, k] = values[np.clip(np.rint(y[:, k]), 0, len(values) - 1).astype(int)]
        return x

    def unit(self, points: Array) -> Array:
        """Return points (N, n) scaled to [0, 1]^n.

        By logarithm where that is marked; listed values by their place in the list.
        """
        x = np.asarray(points, float)
        y = np.where(self.logarithmic, np.log(np.where(self.logarithmic, x, 1.0)), x)
        for k, values in self.sets.items():
            y[:, k] = np.abs(values[None, :] - x[:, k, None]).argmin(axis=1)
        width = np.where(self.high > self.low, self.high - self.low, 1.0)
        return np.clip((y - self.low) / width, 0.0, 1.0)


def box(problem: Problem) -> Box:
    """Return the search box of a problem; SolveError names a variable without finite bounds.

    A positive variable whose ends differ by more than a factor of 10 is searched by its logarithm,
    whether declared log or not.
    """
    minimum, maximum = (bound.copy() for bound in problem.bounds()[:2])
    low, high = minimum.copy(), maximum.copy()
    logarithmic, whole = np.zeros(len(low), bool), np.zeros(len(low), bool)
    sets: dict[int, Array] = {}
    for k, (variable, name) in enumerate(problem.columns):
        if not maximum[k] / 2.0 - minimum[k] / 2.0 < np.finfo(float).max / 2.0:
            raise SolveError(
                f"a sampler needs finite bounds; {name} has {minimum[k]:g} and {maximum[k]:g}"
            )
        if variable.values is not None:
            sets[k] = np.array(allowed_values(problem, k))
            low[k], high[k] = 0.0, len(sets[k]) - 1.0
            continue
        if variable.integer:
            whole[k], (minimum[k], maximum[k]) = True, whole_ends(problem, k)
        logarithmic[k] = variable.log or (minimum[k] > 0 and maximum[k] > 10.0 * minimum[k])
        low[k], high[k] = minimum[k], maximum[k]
        if logarithmic[k]:
            low[k], high[k] = np.log([minimum[k], maximum[k]])
    return Box(low, high, minimum, maximum, logarithmic, whole, sets)


def violation(problem: Problem, points: Array) -> tuple[Array, Array]:
    """First objective (N,) and total violation (N,) >= 0 of points.

    inf where the objective or a row is infinite, of either sign, or no number.
    """
    with np.errstate(all="ignore"):
        batch = problem.batch(points)
        excess = np.maximum(batch.G - 1.0, 0.0).sum(axis=1) + np.abs(batch.H - 1.0).sum(axis=1)
    value = batch.F[:, 0]
    known = np.isfinite(np.hstack([batch.F[:, :1], batch.G, batch.H])).all(axis=1)
    return np.where(np.isfinite(value), value, np.inf), np.where(known, excess, np.inf)
