"""One box of the search: narrowed, relaxed and bounded, by the search and by the certificate alike.

A step takes duals from outside, a linear solver or a record, and believes nothing of them. It is a
function of its box, cutoff, touching points and duals, so that a record of these says what it gave.
"""

import math
from collections.abc import Callable
from dataclasses import field
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.kernels import kernel
from gearopt.optimise.spatial.columns import LINEAR, ROOM, Columns
from gearopt.optimise.terms import Array

SWEEPS, AFTER_SWEEPS, ROOT_SWEEPS = 5, 2, 20
SLOTS = 4  # rows of a relation that is no sum


@dataclass(frozen=True)
class Sparse:
    """Duals that differ from 0: their rows and values."""

    rows: Any
    values: Array

    @classmethod
    def of(cls, y: Array) -> "Sparse":
        """Kept duals of a vector (m,)."""
        rows = np.flatnonzero(y).astype(np.int32)
        return cls(rows, y[rows])

    def spread(self, count: int) -> Array:
        """Duals as a vector (count,)."""
        y = np.zeros(count)
        y[self.rows] = self.values
        return y


@dataclass(frozen=True)
class Bounded:
    """A box after its step: ends (C,), None where it is empty, and the bound of the objective."""

    lower: Array | None
    upper: Array | None
    bound: float

    @property
    def empty(self) -> bool:
        """Whether no point of the box is below the cutoff."""
        return self.lower is None


EMPTY = Bounded(None, None, math.inf)


@dataclass
class Stepper:
    """Work space of the steps of one problem; it has state because kernels write into it."""

    columns: Columns
    rows: tuple[Any, ...] = field(init=False)
    slopes: Array = field(init=False)
    doubts: Array = field(init=False)

    def __post_init__(self) -> None:
        width, start = len(self.columns.lower), [0]
        of_sums = np.diff(self.columns.sums[0])
        for r, (kind, *_) in enumerate(self.columns.relations):
            sizes = [of_sums[r]] if kind == LINEAR else SLOTS * [3]
            for size in sizes:
                start.append(start[-1] + int(size))
        m, entries = len(start) - 1, start[-1]
        self.rows = (
            np.array(start, np.int64),
            np.zeros(m, np.int64),
            np.zeros(entries, np.int64),
            np.zeros(entries),
            np.zeros(m),
            np.zeros(m),
        )
        self.slopes, self.doubts = np.zeros(width), np.zeros(width)
        self.kernel = kernel(f"{ROOM}.relaxation_kernel")

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.rows[1])

    def narrowed(self, lower: Array, upper: Array, cutoff: float, sweeps: int) -> bool:
        """Narrow a box (C,) in place by interval propagation; False where it is empty.

        cutoff: upper bound on the objective. sweeps: passes over the relations.
        """
        aim = self.columns.objective
        upper[aim] = min(upper[aim], cutoff)
        if not lower[aim] <= upper[aim]:
            return False
        return self.columns.propagated(lower, upper, sweeps)

    def fill(self, lower: Array, upper: Array, at: Array) -> None:
        """Write the rows of a box, tangents at `at` (C,)."""
        relations, exponent, sums = (
            self.columns.relations,
            self.columns.exponent,
            self.columns.sums,
        )
        self.kernel.fill(relations, exponent, sums, lower, upper, at, self.rows)

    def safe(self, y: Array, aim: int, sign: float, lower: Array, upper: Array) -> float:
        """Bound of sign times a column by the present rows (Lemma 77)."""
        return float(
            self.kernel.safe_bound(self.rows, y, aim, sign, lower, upper, self.slopes, self.doubts)
        )

    def closed(self, lower: Array, upper: Array, cutoff: float, y: Array, ray: bool) -> Bounded:
        """The box after its duals: its rows are filled; narrowed in place by reduced costs."""
        aim = self.columns.objective
        if ray:
            if self.safe(y, -1, 0.0, lower, upper) > 0.0:
                return EMPTY
            return Bounded(lower, upper, float(lower[aim]))
        z = self.safe(y, aim, 1.0, lower, upper)
        bound = max(z, float(lower[aim]))
        if bound >= cutoff:
            return Bounded(lower, upper, bound)
        lower[aim] = max(lower[aim], z)
        if z > -math.inf:
            sets = self.columns.sets
            if not self.kernel.reduce(sets, self.slopes, self.doubts, z, cutoff, lower, upper):
                return EMPTY
        if not self.narrowed(lower, upper, cutoff, AFTER_SWEEPS):
            return EMPTY
        return Bounded(lower, upper, max(bound, float(lower[aim])))

    def rehearsed(self) -> bool:
        """Call every kernel once, which compiles it; the last is `scores`."""
        lower, upper = self.columns.lower.copy(), self.columns.upper.copy()
        self.fill(lower, upper, np.zeros(len(lower)))
        y, width = np.zeros(self.count), self.columns.variables
        self.safe(y, -1, 0.0, lower, upper)
        sets = self.columns.sets
        self.kernel.reduce(sets, self.slopes, self.doubts, 0.0, 0.0, lower, upper)
        self.kernel.cut(sets, lower, upper, 0, -math.inf, math.inf)
        self.kernel.scale(self.rows, lower, upper, *scaling(self))
        self.kernel.scores(
            self.columns.relations, self.columns.exponent, self.columns.below, lower, y,
            lower, upper, np.ones(width), np.zeros(width),
        )  # fmt: skip
        return True


def scaling(stepper: Stepper) -> tuple[Any, ...]:
    """Arrays that `scale` writes: shift, unit (C,), factor (m,), and the linear program."""
    m, width, entries = stepper.count, len(stepper.columns.lower), len(stepper.rows[2])
    return (
        np.zeros(width),
        np.zeros(width),
        np.zeros(m),
        (
            np.zeros(m + 1, np.int32),
            np.zeros(entries, np.int32),
            np.zeros(entries),
            np.zeros(m),
            np.zeros(m),
            np.zeros(width),
            np.zeros(width),
        ),
    )


@dataclass(frozen=True)
class Squeeze:
    """One round of bounds tightening: tangents' points, and (column, sign, duals) of each bound."""

    cutoff: float
    at: Array
    duals: tuple[tuple[int, float, Sparse], ...]


def squeezed(
    stepper: Stepper,
    lower: Array,
    upper: Array,
    at: Array,
    cutoff: float,
    bounds: Callable[[], Any],
) -> bool:
    """Tighten a box in place by bounds of single columns; False where nothing is left.

    bounds() -> (column, sign, duals (m,)), asked when the rows of the box are filled.
    """
    stepper.fill(lower, upper, at)
    ends = []
    for j, sign, y in bounds():
        if abs(sign) != 1.0 or not 0 <= j < len(lower):  # forged
            continue
        end = stepper.safe(y, j, sign, lower, upper)
        if end > -math.inf:
            ends.append((j, sign, end))
    narrow = stepper.kernel.cut
    for j, sign, end in ends:
        low, high = (end, math.inf) if sign > 0.0 else (-math.inf, -end)
        if not narrow(stepper.columns.sets, lower, upper, j, low, high):
            return False
    return stepper.narrowed(lower, upper, cutoff, ROOT_SWEEPS)


@dataclass(frozen=True)
class Record:
    """Reason for which a box was closed, or the split of it.

    parent: its place in the list of records, -1 of the root; side: 0 below, 1 above the parent's
    split. cutoff: known then. squeezes: of the root. at: points of tangents; duals: None where
    intervals alone, or the point itself, decide. ray: duals of emptiness. split: (variable, end of
    the part below, end of the part above), None of a leaf.
    """

    parent: int
    side: int
    cutoff: float
    squeezes: tuple[Squeeze, ...] = ()
    at: Array | None = None
    duals: Sparse | None = None
    ray: bool = False
    split: tuple[int, float, float] | None = None
