"""Linear, quadratic and second-order cone problems, mixed-integer ones too.

Clarabel on data that we scale, point and multipliers sharpened by Newton's method; our own branch
and bound where variables are discrete.
"""

import time
from dataclasses import replace

import numpy as np

from gearopt.optimise.conic.branch import branch
from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.interior import TOLERANCES
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.conic.relaxation import solved
from gearopt.optimise.result import Budget, Event, Outcome, Watch

RANDOM = False
COUNTS = "relaxation solved"
SETTINGS = {"solver": "Clarabel", "tolerances": TOLERANCES}


def run(problem: Conic, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a conic problem; SolveError where cvxpy's rules do not find it convex."""
    clock = time.perf_counter()
    deadline = clock + (np.inf if budget.seconds is None else budget.seconds)
    stopped = False

    def goes_on(spent: int, best: float, bound: float) -> bool:
        nonlocal stopped
        least, most = (float(v) if np.isfinite(v) else None for v in (best, bound))
        event = Event(time.perf_counter() - clock, spent, least, most)
        late = time.perf_counter() > deadline
        stopped = stopped or late or (watch is not None and watch(event) is False)
        return not stopped

    if not goes_on(0, np.inf, -np.inf):
        return Outcome(None, finished=False, message="stopped before it began")
    data = canonical(problem)
    found = solved(problem, replace(data, allowed={}), deadline, goes_on)
    if data.allowed and not stopped:
        return branch(problem, data, found, budget, deadline, goes_on)
    return Outcome(
        found.x,
        finished=not stopped,
        infeasible=found.leaf.ray,
        leaves=(found.leaf,),
        evaluations=found.steps,
        message="" if found.gap <= 1e-6 or found.words == "Solved" else f"Clarabel: {found.words}",
    )
