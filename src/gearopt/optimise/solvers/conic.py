"""Linear, quadratic and second-order cone problems, mixed-integer ones too.

Clarabel on data that we scale, point and multipliers sharpened by Newton's method; our own branch
and bound where variables are discrete.
"""

import time
from dataclasses import replace

import numpy as np

from gearopt.optimise.conic.branch import branch
from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.conic.relaxation import solved
from gearopt.optimise.result import Budget, Event, Outcome, Watch


def run(problem: Conic, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a conic problem; SolveError where cvxpy's rules do not find it convex."""
    clock = time.perf_counter()
    if watch is not None and watch(Event(0.0, 0)) is False:
        return Outcome(None, finished=False, message="stopped before it began")
    deadline = clock + (np.inf if budget.seconds is None else budget.seconds)
    data = canonical(problem)
    found = solved(problem, replace(data, allowed={}), deadline)
    if data.allowed:
        return branch(problem, data, found, budget, watch, clock)
    finished = time.perf_counter() <= deadline
    return Outcome(
        found.x,
        finished,
        infeasible=found.leaf.ray,
        leaves=(found.leaf,),
        evaluations=found.steps,
        message="" if found.gap <= 1e-6 or found.words == "Solved" else f"Clarabel: {found.words}",
    )
