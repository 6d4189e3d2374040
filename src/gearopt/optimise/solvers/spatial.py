"""Spatial branch and bound: the global optimum of smooth text, with a bound that is proven.

Continuous, whole and listed variables alike. Its records are the claim, judged by the certificate.
"""

import numpy as np

from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import compiling_aside, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.spatial.columns import ROOM, Columns, columns
from gearopt.optimise.spatial.incumbent import Incumbent
from gearopt.optimise.spatial.step import Stepper
from gearopt.optimise.spatial.tree import Tree, searched

STARTS = 3  # random points from which Ipopt begins beside the guess

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
    rng = np.random.default_rng(seed)
    low, high, guess = problem.bounds()
    incumbent.seek(guess)
    wide = np.isfinite(high - low)
    for _ in range(STARTS):
        point = np.where(wide, low + rng.random(len(low)) * np.where(wide, high - low, 0.0), guess)
        if not clock.tell():
            break
        incumbent.seek(point)
    tree = Tree(problem, form, clock, incumbent)

    def watched(bound: float) -> bool:
        clock.bound = bound
        return clock.tell()

    left = searched(tree, watched) if not clock.stopped else None
    done = left is not None and min(left.least, tree.unsplit) >= incumbent.cutoff
    return Outcome(
        incumbent.x,
        done or not clock.stopped,
        infeasible=done and incumbent.x is None,
        evaluations=clock.evaluations,
        records=tuple(tree.records),
    )


def _ready(problem: Problem, clock: Clock) -> Columns | None:
    """Columns of a problem, kernels compiled aside; None where the watcher ended that."""
    intervals, rows = (kernel(f"{ROOM}.{name}_kernel") for name in ("interval", "relaxation"))
    form: Columns | None = compiling_aside(clock, intervals.propagate, lambda: columns(problem))
    if form is None or not compiling_aside(clock, rows.scores, Stepper(form).rehearsed):
        return None
    return form
