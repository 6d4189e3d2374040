"""A local method from many random starts: the guess first, then points of the box.

The best certified point is kept.
"""

import numpy as np

from gearopt.optimise.box import box
from gearopt.optimise.certificate import certify
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt

STARTS = 50  # where the budget names no end

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = True
COUNTS = "Ipopt iteration of any start"
SETTINGS = {"starts": STARTS, "local method": "ipopt"}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Run ipopt from STARTS starts, or until the budget is spent."""
    clock, rng, space = Clock(budget, watch), np.random.default_rng(seed), box(problem)
    best: Outcome | None = None
    least, spent = np.inf, 0
    for k in range(STARTS):
        start = None if k == 0 else space.points(rng.random((1, len(space.low))))[0]
        outcome = ipopt.run(problem, Budget(), seed, clock.inner(), start=start)
        spent = clock.evaluations = spent + outcome.evaluations
        verdict = certify(problem, outcome, 0.0)
        if verdict.objective is not None and verdict.objective < least:
            least, best = verdict.objective, outcome
        if verdict.status == "infeasible" or clock.stopped:
            best = best or outcome
            break
    if best is None:
        words = "no start led to a design"
        return Outcome(None, not clock.stopped, evaluations=spent, message=words)
    return Outcome(
        best.x,
        not clock.stopped,
        best.lam_g,
        best.lam_h,
        best.infeasible,
        evaluations=spent,
        message=best.message,
    )
