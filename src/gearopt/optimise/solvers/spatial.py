"""Spatial branch and bound: the global optimum of smooth text, with a bound that is proven.

Continuous, whole and listed variables alike. Its records are the claim, judged by the certificate.
"""

import math
from dataclasses import replace

import numpy as np

from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock
from gearopt.optimise.failures import current
from gearopt.optimise.kernels import compiling_aside, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.spatial import enumeration
from gearopt.optimise.spatial.columns import ROOM, Columns
from gearopt.optimise.spatial.columns_of_text import columns
from gearopt.optimise.spatial.enumeration import Boxes, Enumerated, enumerated
from gearopt.optimise.spatial.incumbent import Incumbent
from gearopt.optimise.spatial.step import Record, Stepper
from gearopt.optimise.spatial.tree import Tree, searched
from gearopt.optimise.terms import Array

ENUMERATED, COUNTED = 0.5, 0.8  # of the seconds, of the boxes of a budget, are for intervals alone
BOXES = 200_000  # of these where the budget names no end
TRIED, WAITING = 40_000, 0.6  # boxes after which no more may wait for each that was halved
PER_EVALUATION = 200  # such boxes count as one: they take that part of the time of others
NARROW = (
    "boxes too narrow to be split are left, in which no point that meets all limits was found: a "
    "value down to {:.10g} is not excluded"
)
STARTS = 3  # random points from which Ipopt begins beside the guess
EASY = 16  # boxes within which they are not needed, where a point is known

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = True
COUNTS = "box"
SETTINGS = {"gap": GAP, "random starts": STARTS, "linear solver": "HiGHS"}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Search from the guess and random points until the gap is closed.

    SolveError where an operation of the text has no relaxation here.
    """
    clock = Clock(budget, watch)
    if not clock.tell() or (form := _ready(problem, clock)) is None:
        return Outcome(None, False)
    incumbent = Incumbent(problem, clock, max(budget.gap, GAP))
    incumbent.begin(problem.bounds()[2])
    starts = _random_points(problem, seed)
    claim = _enumerated(problem, clock, incumbent) if clock.tell() else None
    if claim is not None and (claim.lower_bound >= incumbent.cutoff or clock.stopped):
        return _outcome(incumbent, claim.lower_bound >= incumbent.cutoff, (claim,))

    def watched(bound: float) -> bool:
        if len(tree.records) >= EASY:
            _tried(incumbent, starts)
        clock.bound = max(bound, claim.lower_bound if claim else bound)
        return clock.tell()

    tree = Tree(problem, form, clock, incumbent)
    opened = list(tree.root()) if not clock.stopped else []
    if opened and incumbent.x is None:
        _tried(incumbent, starts)
        if incumbent.x is not None:
            tree = Tree(problem, form, clock, incumbent)
            opened = list(tree.root())
    left = searched(tree, opened, watched) if not clock.stopped else None
    records: tuple[Record | Enumerated, ...] = tuple(tree.records)
    if claim is not None and (left is None or claim.lower_bound > min(left.least, tree.unsplit)):
        records = (claim,)
    done = left is not None and min(left.least, tree.unsplit) >= incumbent.cutoff
    narrow = not done and left is not None and left.least >= incumbent.cutoff
    message = NARROW.format(tree.unsplit) if narrow else ""
    return replace(_outcome(incumbent, done, records), message=message)


def _outcome(incumbent: Incumbent, done: bool, records: tuple[Record | Enumerated, ...]) -> Outcome:
    """Claim of a search that is done, or was stopped, with its records."""
    return Outcome(
        incumbent.x,
        done or not incumbent.clock.stopped,
        infeasible=done and incumbent.x is None,
        evaluations=incumbent.clock.evaluations,
        records=records,
    )


def _random_points(problem: Problem, seed: int) -> list[Array]:
    """Points of the box, STARTS of them; where it is infinite, the guess."""
    rng = np.random.default_rng(seed)
    low, high, guess = problem.bounds()
    wide = np.isfinite(high - low)
    ways = np.where(wide, high - low, 0.0)
    return [np.where(wide, low + rng.random(len(low)) * ways, guess) for _ in range(STARTS)]


def _tried(incumbent: Incumbent, starts: list[Array]) -> None:
    """Seek better points from those that are left of some, which are taken."""
    while starts and incumbent.clock.tell():
        incumbent.seek(starts.pop(0))


def _enumerated(problem: Problem, clock: Clock, incumbent: Incumbent) -> Enumerated | None:
    """Return the claim of an enumeration of whole and listed variables; None for others.

    It may take ENUMERATED of the seconds, as the certificate needs as long again.
    """
    form = enumeration.columns(problem)
    if not enumeration.takes(form):
        return None
    boxes = Boxes(form)
    before, seconds, evaluations = clock.evaluations, clock.left.seconds, clock.left.evaluations
    late = math.inf if seconds is None else clock.seconds + ENUMERATED * seconds
    endless = BOXES if seconds is None else math.inf
    most = endless if evaluations is None else COUNTED * evaluations * PER_EVALUATION

    def judge(points: Array) -> None:
        clock.evaluations = before + math.ceil(boxes.made / PER_EVALUATION)
        tried = np.vstack([points, boxes.middles()])
        value, x = enumeration.best_of(problem, tried, incumbent.value)
        if x is not None:
            incumbent.judge(x)
        clock.bound = min(boxes.lower_bound, incumbent.cutoff)

    def goes_on() -> bool:
        hopeless = boxes.made > TRIED and boxes.waiting > WAITING
        return clock.tell() and clock.seconds < late and boxes.made < most and not hopeless

    first = Boxes(form)
    if not compiling_aside(clock, first.kernel.halved, lambda: first.halve(math.inf)):
        return None
    skipped = current().skipped
    enumerated(boxes, lambda: incumbent.cutoff, judge, goes_on)
    if current().skipped > skipped:  # of the last points, for which no time was left
        return None
    return Enumerated(min(boxes.lower_bound, incumbent.cutoff), boxes.made)


def _ready(problem: Problem, clock: Clock) -> Columns | None:
    """Columns of a problem, kernels compiled aside; None where the watcher ended that."""
    intervals, rows = (kernel(f"{ROOM}.{name}_kernel") for name in ("interval", "relaxation"))
    form: Columns | None = compiling_aside(clock, intervals.propagate, lambda: columns(problem))
    if form is None or not compiling_aside(clock, rows.scores, Stepper(form).rehearsed):
        return None
    return form
