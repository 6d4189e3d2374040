"""Enumeration with interval pruning: boxes of whole and listed values, halved until none is left.

A box is narrowed by the intervals of its columns and goes where its objective cannot be below the
cutoff. What is left of it in the end are single points, which the text itself judges. The number of
points of the whole box does not matter, only that of the boxes that intervals cannot close.
"""

import math
from collections.abc import Callable
from dataclasses import field

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.scale import violation
from gearopt.optimise.spatial.columns import CONTINUOUS, EXACT, ROOM, ROOT_SWEEPS, Columns
from gearopt.optimise.spatial.columns_of_text import columns as columns_of
from gearopt.optimise.terms import Array

SWEEPS = 2
# Boxes after which no more may wait for each that was halved: else it begins again, and tries all
# variables at each, not the widest alone.
EASY, GROWING = 20_000, 0.25
CHUNK = 2600  # boxes times relations that are halved at once: 0.05 s
DEPTH = 5  # times in succession
KEPT = 1_000_000  # boxes that wait; beyond, the last ones are halved first, so that fewer wait
MIDDLES = 64  # of the boxes of the least bounds are tried as points


def columns(problem: Problem) -> Columns:
    """Columns of a problem whose rows may exceed 1 by what the contract allows."""
    return columns_of(problem, slack=FEASIBLE, logarithms=False)


def takes(form: Columns) -> bool:
    """Whether all variables are whole or listed, and small enough for sums of two to be exact."""
    count = form.variables
    ends = np.concatenate([form.lower[:count], form.upper[:count]])
    return bool((form.sets[0][:count] != CONTINUOUS).all() and (np.abs(ends) < 0.5 * EXACT).all())


@dataclass(frozen=True)
class Enumerated:
    """Claim of an enumeration: no feasible point is below a value; its number of boxes."""

    lower_bound: float
    boxes: int


@dataclass
class Boxes:
    """Boxes that wait, by the ends of the variables; it has state because they are halved.

    low, high (N, n), bound (N,) of the objective; made: number of boxes so far, since: when it
    began; chunk: how many are halved next; trials: variables that are tried at each.
    """

    form: Columns
    low: Array = field(init=False)
    high: Array = field(init=False)
    bound: Array = field(init=False)
    made: int = 1
    since: int = 0
    chunk: int = 4
    trials: int = 1

    def __post_init__(self) -> None:
        form = self.form
        self.kernel = kernel(f"{ROOM}.enumeration_kernel")
        self.root = np.array([form.lower, form.upper])
        inside = not form.empty and form.propagated(self.root[0], self.root[1], ROOT_SWEEPS)
        self.begin(int(inside), self.root[0, form.objective])
        width, levels = len(form.lower), np.zeros(DEPTH + 2, np.int64)
        boxes, parts = (np.empty((k, 2, width)) for k in (len(levels), 4))
        self.work = boxes, levels, parts, np.zeros(width, bool), np.zeros(width, bool)

    def begin(self, count: int, bound: float) -> None:
        """Let the whole box wait, or none, with its bound."""
        self.low, self.high = (
            np.array(end[None, : self.form.variables][:count]) for end in self.root
        )
        self.bound = np.full(count, bound)

    @property
    def lower_bound(self) -> float:
        """Least bound of the boxes that wait, inf where none does."""
        return float(self.bound.min()) if len(self.bound) else math.inf

    @property
    def waiting(self) -> float:
        """How many boxes wait for each that was halved."""
        return len(self.bound) * 2 * self.trials / max(1, self.made - self.since)

    def points(self) -> Array:
        """Boxes of a single point (N, n), which wait no longer."""
        single = (self.low == self.high).all(axis=1)
        points: Array = self.low[single]
        self.low, self.high, self.bound = (a[~single] for a in (self.low, self.high, self.bound))
        return points

    def middles(self) -> Array:
        """Allowed values near the middles of the boxes of the least bounds (N, n)."""
        some = np.arange(len(self.bound))
        if len(some) > MIDDLES:
            some = np.argpartition(self.bound, MIDDLES)[:MIDDLES]
        low, high = self.low[some], self.high[some]
        middle = np.floor(0.5 * (low + high))
        sort, first, last, values = self.form.sets
        for j in np.flatnonzero(last[: middle.shape[1]] > first[: middle.shape[1]]):
            of_j = values[first[j] : last[j]]
            at = np.searchsorted(of_j, low[:, j]) + np.searchsorted(of_j, high[:, j])
            middle[:, j] = of_j[at // 2]
        return middle

    def halve(self, cutoff: float) -> bool:
        """Halve the boxes of the least bounds, and drop all that is not below a cutoff; True."""
        kept = self.bound < cutoff
        if not kept.all():
            self.low, self.high, self.bound = (a[kept] for a in (self.low, self.high, self.bound))
        form = self.form
        if self.trials < form.variables and self.made > EASY and self.waiting > GROWING:
            self.trials, self.chunk, self.since = form.variables, 1, self.made
            self.begin(min(1, len(self.bound)), self.lower_bound)
        count = len(self.bound)
        some = min(self.chunk, count)
        if not some:
            return True
        taken = np.arange(count - some, count)
        if some < count <= KEPT:
            taken = np.argpartition(self.bound, some)[:some]
        out = tuple(
            np.empty((some << DEPTH, *a.shape[1:])) for a in (self.low, self.high, self.bound)
        )
        columns = form.relations, form.exponent, form.sums, form.sets
        left, halves = self.kernel.halved(
            columns, self.root, form.objective, cutoff, SWEEPS, self.trials,
            self.low[taken], self.high[taken], self.bound[taken], self.work, out,
        )  # fmt: skip
        self.chunk = min(2 * some, max(1, CHUNK // (1 + len(form.relations)) // self.trials))
        self.made += halves
        stays = np.ones(count, bool)
        stays[taken] = False
        self.low, self.high, self.bound = (
            np.concatenate([a[stays], b[:left]])
            for a, b in zip((self.low, self.high, self.bound), out, strict=True)
        )
        return True


def best_of(problem: Problem, points: Array, below: float) -> tuple[float, Array | None]:
    """Least value of feasible points (N, n) below a value, and its point; inf, None for none."""
    if not len(points):
        return math.inf, None
    with np.errstate(all="ignore"):
        batch = problem.batch(points)
        value = batch.F[:, 0]
        rows = np.hstack([batch.G - 1.0, np.abs(batch.H - 1.0)])
        met = (np.isfinite(batch.G) & (batch.G <= 1.0 + FEASIBLE)).all(axis=1)
        met &= (rows <= FEASIBLE).all(axis=1) & np.isfinite(value) & (value < below)
        order = np.flatnonzero(met)[np.argsort(value[met], kind="stable")]
        for k in order:
            alone = type(batch)(batch.F[[k]], batch.G[[k]], batch.H[[k]], {})
            if violation(problem, points[k], alone)[0] <= FEASIBLE:
                return float(value[k]), points[k]
    return math.inf, None


def enumerated(
    boxes: Boxes,
    cutoff: Callable[[], float],
    judge: Callable[[Array], None],
    goes_on: Callable[[], bool],
) -> None:
    """Halve boxes until none is left below the cutoff, or it does not go on.

    judge(points): of single points, which wait no longer, and of middles, which may be any.
    """
    judge(boxes.points())
    while len(boxes.bound) and goes_on():
        boxes.halve(cutoff())
        judge(boxes.points())


def proven(problem: Problem, claim: Enumerated) -> float:
    """Bound of all feasible points, by boxes halved anew below what is claimed (Lemma 79)."""
    form = columns(problem)
    if not takes(form) or math.isnan(claim.lower_bound):
        return -math.inf
    boxes, least = Boxes(form), claim.lower_bound
    most = 2 * claim.boxes + 1000

    def judge(points: Array) -> None:
        nonlocal least
        least = min(least, best_of(problem, points, least)[0])

    enumerated(boxes, lambda: claim.lower_bound, judge, lambda: boxes.made < most)
    return min(least, boxes.lower_bound)
