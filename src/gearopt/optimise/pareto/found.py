"""A front as a method finds it: points with their values, and the proof of each."""

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.pareto.front import Impossible
from gearopt.optimise.pareto.measures import unbeaten
from gearopt.optimise.terms import Array


@dataclass(frozen=True)
class Point:
    """One design: x (n,), its values (k,), and whether nothing beats it within the gap.

    bound: least value that the first objective can have where the others are no larger; slopes
    (k - 1,): its change by a unit more of each other one, None where it is not known.
    """

    x: Array
    values: Array
    proven: bool = False
    bound: float | None = None
    slopes: Array | None = None


@dataclass(frozen=True)
class Step:
    """The points (N, k) that a method has after so many seconds and evaluations."""

    seconds: float
    evaluations: int
    values: Array


@dataclass(frozen=True)
class Found:
    """A front as a method finds it; points by the first objective, none beaten by another.

    complete: every design that none beats is among them, proven. error: largest distance of the
    true front to the line through the points, in the ranges of the objectives; None: not known.
    epsilon: how much worse than any design one of the points is at most, in the objective in which
    it is more so, in the same ranges; None: not proven.
    beaten (N, k): values of feasible points that others beat. infeasible: there is no point at all,
    proven. unknown: values of the second objective between which the front is not known, as steps
    there are not proven; infinite: no end. steps: how the front grew. proof["sentence"] says it for
    a reader.
    """

    points: tuple[Point, ...]
    complete: bool = False
    error: float | None = None
    epsilon: float | None = None
    beaten: Array = field(default_factory=lambda: np.empty((0, 0)))
    skipped: tuple[Impossible, ...] = ()
    infeasible: bool = False
    unknown: tuple[tuple[float, float], ...] = ()
    finished: bool = True
    steps: tuple[Step, ...] = ()
    proof: Mapping[str, Any] = field(default_factory=dict)
    evaluations: int = 0
    message: str = ""

    @property
    def values(self) -> Array:
        """Return the values of the points (N, k)."""
        return np.array([p.values for p in self.points])


def sifted(points: list[Point]) -> tuple[tuple[Point, ...], Array]:
    """Return the points that no other beats, and the values of those that are beaten."""
    if not points:
        return (), np.empty((0, 0))
    values = np.array([p.values for p in points])
    kept = unbeaten(values)
    return tuple(points[k] for k in kept), np.delete(values, kept, axis=0)
