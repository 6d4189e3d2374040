"""Relief as it is made: the worst case over tolerances, drawn samples, and the best nominal one."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Mesh, Relief
from gearopt.formulations.pair.relief.parametric import Ranges, reliefs, variables
from gearopt.formulations.pair.relief.relief_search import (
    MICRO,
    ROUNDING,
    Box,
    Numbers,
    halves,
    numbers,
)
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import compiled, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Watch
from gearopt.optimise.terms import Array, Terms

KERNEL = "gearopt.formulations.pair.relief.relief_box_kernel"
GAP = 1e-3  # relative, of a worst case
SHORTEST = 1e-3  # of a length: a tolerance leaves as much of it
SIGNS = np.array(np.meshgrid(*[(-1.0, 1.0)] * 4)).reshape(4, -1).T  # corners of the tolerances


@dataclass(frozen=True)
class Tolerance:
    """How far amounts and lengths [mm] of both gears may lie from the nominal, either way.

    Amounts stay at least 0.
    """

    amount: float
    length: float = 0.0

    @property
    def widths(self) -> Array:
        """Half widths (4,) [mm] of amounts 1, 2 and lengths 1, 2."""
        return np.array([self.amount, self.amount, self.length, self.length])

    def moved(self, nominal: Any, parts: Any) -> Array:
        """Return points (..., 4) [mm] that lie so many half widths from the nominal ones."""
        points = nominal + self.widths * parts
        shortest = SHORTEST * np.asarray(nominal)[..., 2:]
        return np.concatenate(
            [np.maximum(points[..., :2], 0.0), np.maximum(points[..., 2:], shortest)], axis=-1
        )


@dataclass(frozen=True)
class Worst:
    """The worst case over tolerances: value [mm] at a point (4,), and that none exceeds `bound`."""

    value: float
    bound: float
    point: Array
    boxes: int


def worst(
    mesh: Mesh,
    nominal: tuple[Relief, Relief],
    tolerance: Tolerance,
    budget: Budget | None = None,
    watch: Watch | None = None,
) -> Worst | None:
    """Return the largest peak-to-peak [mm] of all loads over the box of tolerances, proven.

    Boxes are halved, largest bound first, until value and bound agree to the gap of the budget, or
    it is spent or the watcher ends it; None if that is while kernels are compiled, which takes no
    budget. point: amounts 1, 2 and lengths 1, 2 [mm].
    """
    x = _numbers(nominal)
    ends = [tolerance.moved(x, sign) for sign in (-1.0, 1.0)]
    data = numbers(mesh, ends[0], ends[1], _powers(nominal))
    entries = (kernel(KERNEL).ceiling,)
    if not compiled(lambda: _ceiling(data, data.low, data.high), entries, watch):
        return None
    clock = Clock(budget or Budget(gap=GAP), watch)
    bound, point, value = _ceiling(data, data.low, data.high)
    gap = max(clock.budget.gap, ROUNDING)

    def branch(least: float, box: Box) -> Iterator[tuple[float, Box]]:
        nonlocal point, value
        for half in halves(data, *box):
            bound, at, there = _ceiling(data, *half)
            clock.evaluations += 1
            if there > value:
                value, point = there, at
            yield max(-bound, least), half

    left = best_first(
        [(-bound, (data.low, data.high))],
        lambda least, _: -least > value * (1.0 + gap) and clock.tell(),
        branch,
    )
    bound = max(value, -left.least)
    return Worst(value / MICRO, bound / MICRO, data.variables(point), clock.evaluations)


def _numbers(nominal: tuple[Relief, Relief]) -> Array:
    """Return amounts 1, 2 and lengths 1, 2 [mm]."""
    return np.array([*(r.amount for r in nominal), *(r.length for r in nominal)], float)


def _powers(nominal: tuple[Relief, Relief]) -> tuple[float, float]:
    return float(nominal[0].exponent), float(nominal[1].exponent)


def _ceiling(made: Numbers, low: Array, high: Array) -> tuple[float, Array, float]:
    """Return a bound of a box from above [um], its worst corner, and the value there [um]."""
    point = np.empty(4)
    given = made.stiffness, made.tips, made.exponents, made.loads
    bound, value = kernel(KERNEL).ceiling(*given, low, high, point)
    return bound + ROUNDING, point, value


def drawn(
    mesh: Mesh, nominal: tuple[Relief, Relief], tolerance: Tolerance, count: int, seed: int
) -> Array:
    """Return the largest peak-to-peak [mm] over the loads of (count,) pairs as they are made.

    Amounts and lengths are drawn uniformly within their tolerances.
    """
    parts = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 4))
    return _values(mesh, tolerance.moved(_numbers(nominal), parts), _powers(nominal))


def _values(mesh: Mesh, points: Array, exponents: tuple[float, float]) -> Array:
    ranges = Ranges((0.0, 0.0), (1.0, 1.0), exponents)
    columns = np.moveaxis(points, -1, 0)
    apart = mesh.separations(*reliefs(columns[:2], columns[2:], ranges))
    return np.asarray(mesh.criteria(apart).peak_to_peak.max(axis=-1))


def robust_problem(mesh: Mesh, ranges: Ranges, tolerance: Tolerance) -> Problem:
    """Pose the nominal relief whose worst corner of the tolerances is least; for samplers.

    The worst of a whole box, which may lie inside, is proven by `worst` afterwards.
    """
    signs = np.vstack([np.zeros(4), SIGNS])

    def evaluate(x: Any, p: Any) -> Terms:
        nominal = np.stack(np.broadcast_arrays(*x.amount, *x.length), axis=-1)
        points = tolerance.moved(nominal[..., None, :], signs)
        values = _values(mesh, points, ranges.exponents)
        report: Mapping[str, Any] = {"nominal": values[..., 0]}
        return Terms({"worst_peak_to_peak": values.max(axis=-1)}, report=report)

    return Problem("robust relief", variables(ranges), (), evaluate, vectorised=True)
