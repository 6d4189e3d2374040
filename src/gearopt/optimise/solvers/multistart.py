"""A local method from many random starts: the guess first, then points of the box.

The best certified point is kept.
"""

import math
import time

import numpy as np

from gearopt.optimise.box import box
from gearopt.optimise.certificate import certify
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.solvers import ipopt

STARTS = 50  # where the budget names no end

RANDOM = True
COUNTS = "Ipopt iteration of any start"
SETTINGS = {"starts": STARTS, "local method": "ipopt"}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Run ipopt from STARTS starts, or until the budget is spent."""
    clock, rng, space = time.perf_counter(), np.random.default_rng(seed), box(problem)
    best: Outcome | None = None
    least, spent, stopped = np.inf, 0, False

    def goes_on(event: Event) -> bool:
        nonlocal stopped
        seconds = time.perf_counter() - clock
        found = min(least, math.inf if event.best is None else event.best)
        value = found if math.isfinite(found) else None
        late = budget.seconds is not None and seconds > budget.seconds
        full = budget.evaluations is not None and spent + event.evaluations >= budget.evaluations
        told = watch is None or watch(Event(seconds, spent + event.evaluations, value)) is not False
        stopped = stopped or late or full or not told
        return not stopped

    for k in range(STARTS):
        start = None if k == 0 else space.points(rng.random((1, len(space.low))))[0]
        outcome = ipopt.run(problem, Budget(), seed, goes_on, start=start)
        spent += outcome.evaluations
        verdict = certify(problem, outcome, 0.0)
        if verdict.objective is not None and verdict.objective < least:
            least, best = verdict.objective, outcome
        if verdict.status == "infeasible" or stopped:
            best = best or outcome
            break
    if best is None:
        return Outcome(None, not stopped, evaluations=spent, message="no start led to a design")
    return Outcome(
        best.x,
        not stopped,
        best.lam_g,
        best.lam_h,
        best.infeasible,
        evaluations=spent,
        message=best.message,
    )
