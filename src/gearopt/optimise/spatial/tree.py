"""Spatial branch and bound: the search, which keeps a record of every box for the certificate.

A node is a box that was narrowed, relaxed and bounded (`step`). Its duals come from HiGHS; whole
and listed variables are branched on first, then the variable below which the relations fit worst.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import field
from functools import partial
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.best_first import Open, best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.spatial.columns import CONTINUOUS, WHOLE, Columns
from gearopt.optimise.spatial.incumbent import Incumbent
from gearopt.optimise.spatial.linear import Linear, better_ray
from gearopt.optimise.spatial.step import (
    ROOT_SWEEPS,
    SWEEPS,
    Record,
    Sparse,
    Squeeze,
    Stepper,
    squeezed,
)
from gearopt.optimise.terms import Array

SQUEEZES = 3  # rounds of bounds tightening at the root
WORTH = 0.1  # share of a width that one of them must take
LP_SHARE, KEPT_OFF = 0.75, 0.1  # where a box is split: towards the relaxation's point, off its ends
NARROW = 1e-11  # relative width below which a variable is not split
WHOLE_WITHIN = 1e-6  # of an allowed value a relaxation's point counts as there
OFTEN, SELDOM = 3, 400  # boxes between two points that are sought; doubled where one brings nothing


@dataclass(frozen=True)
class Node:
    """A box to be split: its record, ends (C,), its split, and what helps its children."""

    record: int
    lower: Array
    upper: Array
    split: tuple[int, float, float]
    at: Array
    basis: Any


@dataclass
class Tree:
    """A search as it goes; it has state because records, incumbent and linear solver do.

    records: of all boxes, parents first. unsplit: least bound of leaves that no split can improve.
    due: number of boxes from which on a point is sought, interval: how many were awaited.
    """

    problem: Problem
    columns: Columns
    clock: Clock
    incumbent: Incumbent
    records: list[Record] = field(default_factory=list)
    unsplit: float = math.inf
    due: int = 0
    interval: int = OFTEN

    def __post_init__(self) -> None:
        self.stepper = Stepper(self.columns)
        self.linear = Linear(self.stepper)
        self.widths = np.zeros(self.columns.variables)
        self.score = np.zeros(self.columns.variables)

    @property
    def cutoff(self) -> float:
        """Value from which on no point is of interest."""
        return self.incumbent.cutoff

    def root(self) -> Iterator[tuple[float, Node]]:
        """The whole box, tightened, as a node; none where it is closed already."""
        lower, upper = self.columns.lower.copy(), self.columns.upper.copy()
        cutoff = self.cutoff
        self.clock.evaluations += 1
        inside = not self.columns.empty and self.stepper.narrowed(lower, upper, cutoff, ROOT_SWEEPS)
        squeezes = tuple(self.squeezes(lower, upper)) if inside else ()
        inside = inside and not (squeezes and squeezes[-1].empties)
        self.widths = (upper - lower)[: self.columns.variables].copy()
        yield from self.closed(
            Record(-1, 0, cutoff, tuple(s.squeeze for s in squeezes)),
            (lower, upper) if inside else None,
            np.zeros(len(lower)),
            None,
        )

    def squeezes(self, lower: Array, upper: Array) -> Iterator["Squeezed"]:
        """Rounds of bounds tightening of the root box, in place."""
        at = np.full(len(lower), np.nan)
        for _ in range(SQUEEZES):
            before = upper - lower
            duals = list[tuple[int, float, Sparse]]()
            cutoff = self.cutoff
            inside = squeezed(
                self.stepper, lower, upper, at, cutoff, partial(self.ends, lower, upper, duals)
            )
            yield Squeezed(Squeeze(cutoff, at, tuple(duals)), not inside)
            width = upper - lower
            gained = (width < (1.0 - WORTH) * before)[: self.columns.variables].any()
            if not (inside and gained) or self.clock.over:
                return

    def ends(
        self, lower: Array, upper: Array, duals: list[tuple[int, float, Sparse]]
    ) -> list[tuple[int, float, Array]]:
        """Duals of the least and greatest values of the variables; those that help are kept."""
        bounds = list[tuple[int, float, Array]]()
        aim = self.columns.objective
        self.linear.load(lower, upper, aim, 1.0, None)
        for j in range(self.columns.variables):
            for sign in (1.0, -1.0):
                if not upper[j] - lower[j] > NARROW * max(1.0, abs(lower[j])) or self.clock.over:
                    continue
                self.linear.aim(j, sign)
                hint = self.linear.solved()
                end = self.stepper.safe(hint.y, j, sign, lower, upper)
                here = lower[j] if sign > 0.0 else -upper[j]
                width = upper[j] - lower[j]
                if not hint.ray and end > here + (1e-3 * width if width < math.inf else 0.0):
                    bounds.append((j, sign, hint.y))
                    duals.append((j, sign, Sparse.of(hint.y)))
        return bounds

    def closed(
        self, record: Record, box: tuple[Array, Array] | None, at: Array, basis: Any
    ) -> Iterator[tuple[float, Node]]:
        """Record a box; yield it with its bound where it must be split."""
        if box is None:
            self.records.append(record)
            return
        lower, upper = box
        if self.single(lower, upper):
            self.records.append(record)
            return
        self.stepper.fill(lower, upper, at)
        self.linear.load(lower, upper, self.columns.objective, 1.0, basis)
        hint = self.linear.solved()
        y = better_ray(self.stepper, hint.y, lower, upper) if hint.ray else hint.y
        after = self.stepper.closed(lower, upper, record.cutoff, y, hint.ray)
        duals = Sparse.of(y)
        split = None
        if not after.empty and not self.single(lower, upper) and after.bound < record.cutoff:
            self.seek(hint.x, lower, upper)
            if after.bound < self.cutoff:
                split = self.split(hint.x, y, lower, upper)
                if split is None:
                    self.incumbent.seek(_middle(lower[: len(self.score)], upper[: len(self.score)]))
                    self.unsplit = min(self.unsplit, after.bound)
        place = len(self.records)
        self.records.append(
            Record(
                record.parent, record.side, record.cutoff, record.squeezes, at, duals, hint.ray,
                split,
            )
        )  # fmt: skip
        if split is not None:
            known = at if hint.x is None else hint.x
            yield after.bound, Node(place, lower, upper, split, known, hint.basis or basis)

    def single(self, lower: Array, upper: Array) -> bool:
        """Whether a box is one point, which is judged then."""
        count = self.columns.variables
        if not np.array_equal(lower[:count], upper[:count]):
            return False
        self.unsplit = min(self.unsplit, self.incumbent.judge(lower[:count]))
        return True

    def branch(self, bound: float, node: Node) -> Iterator[tuple[float, Node]]:
        """Both parts of a node, those that are not closed at once, with their bounds."""
        j, below, above = node.split
        for side in (0, 1):
            self.clock.evaluations += 1
            lower, upper = node.lower.copy(), node.upper.copy()
            if side == 0:
                upper[j] = below
            else:
                lower[j] = above
            cutoff = self.cutoff
            inside = self.stepper.narrowed(lower, upper, cutoff, SWEEPS)
            for least, child in self.closed(
                Record(node.record, side, cutoff),
                (lower, upper) if inside else None,
                node.at,
                node.basis,
            ):
                yield max(least, bound), child

    def seek(self, x: Array | None, lower: Array, upper: Array) -> None:
        """Look for a better point from the relaxation's, the more seldom the less that brings."""
        if len(self.records) < self.due or self.clock.over:
            return
        count, before = self.columns.variables, self.incumbent.value
        low, high = lower[:count], upper[:count]
        self.incumbent.seek(_middle(low, high) if x is None else np.clip(x[:count], low, high))
        gained = self.incumbent.value < before
        self.interval = OFTEN if gained else min(2 * self.interval, SELDOM)
        self.due = len(self.records) + self.interval

    def split(
        self, x: Array | None, y: Array, lower: Array, upper: Array
    ) -> tuple[int, float, float] | None:
        """Variable and ends of the two parts; None where no variable is wide enough."""
        count = self.columns.variables
        low, high = lower[:count], upper[:count]
        middle = _middle(low, high)
        point = middle if x is None else np.clip(x[:count], low, high)
        sort = self.columns.sets[0][:count]
        discrete = (sort != CONTINUOUS) & (high > low)
        if discrete.any():
            off = np.where(discrete, self.off(point), -1.0)
            j = int(off.argmax())
            if off[j] > WHOLE_WITHIN or not self.wide(low, high).any():
                if off[j] <= WHOLE_WITHIN:
                    j = int(np.where(discrete, high - low, -1.0).argmax())
                return self.between(j, float(point[j]), float(low[j]), float(high[j]))
        wide = self.wide(low, high) | discrete
        if not wide.any():
            return None
        if x is None:
            self.score[:] = 0.0
        else:
            self.stepper.kernel.scores(
                self.columns.relations, self.columns.exponent, self.columns.below, x, y,
                lower, upper, self.widths, self.score,
            )  # fmt: skip
        score = np.where(wide, self.score, -1.0)
        j = int(score.argmax())
        if not score[j] > 0.0:
            known = np.isfinite(high - low) & (self.widths > 0.0) & np.isfinite(self.widths)
            relative = np.divide(high - low, self.widths, out=np.full(count, np.inf), where=known)
            j = int(np.where(wide, relative, -1.0).argmax())
        if discrete[j]:
            return self.between(j, float(point[j]), float(low[j]), float(high[j]))
        at = _inside(float(point[j]), float(low[j]), float(high[j]))
        return j, at, at

    def wide(self, low: Array, high: Array) -> Any:
        """Which continuous variables can be split."""
        size = np.maximum(np.abs(low), np.abs(high))
        continuous = self.columns.sets[0][: len(low)] == CONTINUOUS
        return continuous & (high - low > NARROW * np.where(size < np.inf, size, 1.0))

    def off(self, point: Array) -> Array:
        """Distance of every variable from its nearest allowed value, in steps of these."""
        sort, first, last, values = self.columns.sets
        off = np.abs(point - np.round(point))
        for j in np.flatnonzero(last[: len(point)] > first[: len(point)]):
            of_j = values[first[j] : last[j]]
            k = int(np.clip(np.searchsorted(of_j, point[j]), 1, max(1, len(of_j) - 1)))
            if len(of_j) > 1:
                a, b = of_j[k - 1], of_j[k]
                off[j] = min(abs(point[j] - a), abs(b - point[j])) / (b - a)
        return off

    def between(self, j: int, at: float, low: float, high: float) -> tuple[int, float, float]:
        """The two neighbouring allowed values around a point, inside the box."""
        sort, first, last, values = self.columns.sets
        if sort[j] == WHOLE:
            below = min(max(math.floor(at), low), high - 1.0)
            return j, below, below + 1.0
        of_j = values[first[j] : last[j]]
        of_j = of_j[(of_j >= low) & (of_j <= high)]
        k = int(np.clip(np.searchsorted(of_j, at, side="right"), 1, len(of_j) - 1))
        return j, float(of_j[k - 1]), float(of_j[k])


@dataclass(frozen=True)
class Squeezed:
    """A round of tightening, and whether it left nothing."""

    squeeze: Squeeze
    empties: bool


def _middle(low: Array, high: Array) -> Array:
    """Finite points of boxes whose ends may be infinite."""
    return np.array([_inside(math.nan, float(a), float(b)) for a, b in zip(low, high, strict=True)])


def _inside(at: float, low: float, high: float) -> float:
    """Where an interval is split: near a point, off the ends; by size where an end is infinite."""
    if low == -math.inf and high == math.inf:
        return 0.0
    if low == -math.inf:
        return min(2.0 * high, -1.0) if high <= 0.0 else 0.0 if high > 1.0 else -1.0
    if high == math.inf:
        return max(2.0 * low, 1.0) if low >= 0.0 else 0.0 if low < -1.0 else 1.0
    middle = low + 0.5 * (high - low)
    if math.isnan(at):
        return middle
    off = KEPT_OFF * (high - low)
    return min(max(LP_SHARE * at + (1.0 - LP_SHARE) * middle, low + off), high - off)


def searched(
    tree: Tree, opened: Iterable[tuple[float, Node]], watched: Callable[[float], bool]
) -> Open[Node]:
    """Search from nodes with their bounds on; what is left open.

    watched(bound): whether it goes on, told the bound.
    """

    def goes_on(bound: float, node: Node) -> bool:
        return bound < tree.cutoff and watched(min(bound, tree.unsplit))

    with np.errstate(invalid="ignore"):  # widths of what is infinite at both ends
        return best_first(opened, goes_on, tree.branch)
