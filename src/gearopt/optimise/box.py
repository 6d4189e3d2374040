"""The box that samplers move in: logarithms of positive variables, indices of finite sets.

Coordinates are in [0, 1]; `points` maps them to natural points whose discrete variables are exact.
"""

from dataclasses import dataclass

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise import discrete
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array


@dataclass(frozen=True)
class Box:
    """Lower and upper ends (n,) in search coordinates, and how each coordinate is read.

    least, most: natural ends, those of integers whole.
    """

    low: Array
    high: Array
    least: Array
    most: Array
    logarithmic: Array
    whole: Array
    sets: dict[int, Array]

    def points(self, unit: Array) -> Array:
        """Natural points (N, n) of coordinates (N, n) in [0, 1]."""
        y = self.low + np.clip(unit, 0.0, 1.0) * (self.high - self.low)
        x = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, y, 0.0)), y)
        x = np.where(self.whole, np.clip(np.rint(x), self.least, self.most), x)
        for k, values in self.sets.items():
            x[:, k] = values[np.clip(np.rint(y[:, k]), 0, len(values) - 1).astype(int)]
        return x

    def unit(self, points: Array) -> Array:
        """Coordinates (N, n) of natural points (N, n)."""
        x = np.asarray(points, float)
        y = np.where(self.logarithmic, np.log(np.where(self.logarithmic, x, 1.0)), x)
        for k, values in self.sets.items():
            y[:, k] = np.abs(values[None, :] - x[:, k, None]).argmin(axis=1)
        width = np.where(self.high > self.low, self.high - self.low, 1.0)
        return np.clip((y - self.low) / width, 0.0, 1.0)


def box(problem: Problem) -> Box:
    """The search box of a problem; SolveError names a variable without finite bounds or values.

    A positive variable whose ends differ by more than a factor of 10 is searched by its logarithm,
    whether declared log or not.
    """
    least, most = (bound.copy() for bound in problem.bounds()[:2])
    low, high = least.copy(), most.copy()
    logarithmic, whole = np.zeros(len(low), bool), np.zeros(len(low), bool)
    sets: dict[int, Array] = {}
    for k, (variable, name) in enumerate(problem.columns):
        if not most[k] / 2.0 - least[k] / 2.0 < np.finfo(float).max / 2.0:
            raise SolveError(
                f"a sampler needs finite bounds; {name} has {least[k]:g} and {most[k]:g}"
            )
        if variable.values is not None:
            sets[k] = np.array(discrete.values(problem, k))
            low[k], high[k] = 0.0, len(sets[k]) - 1.0
            continue
        if variable.integer:
            whole[k], (least[k], most[k]) = True, discrete.ends(problem, k)
        logarithmic[k] = variable.log or (least[k] > 0 and most[k] > 10.0 * least[k])
        low[k], high[k] = least[k], most[k]
        if logarithmic[k]:
            low[k], high[k] = np.log([least[k], most[k]])
    return Box(low, high, least, most, logarithmic, whole, sets)


def violation(problem: Problem, points: Array) -> tuple[Array, Array]:
    """First objective (N,) and total violation (N,) >= 0 of points; NaN counts as inf."""
    with np.errstate(all="ignore"):
        batch = problem.batch(points)
        excess = np.maximum(batch.G - 1.0, 0.0).sum(axis=1) + np.abs(batch.H - 1.0).sum(axis=1)
    value = batch.F[:, 0]
    return (
        np.where(np.isnan(value), np.inf, value),
        np.where(np.isnan(excess) | np.isnan(value), np.inf, excess),
    )
