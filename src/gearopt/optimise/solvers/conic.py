"""Linear, quadratic and second-order cone problems, mixed-integer ones too.

Clarabel on data that we scale, point and multipliers sharpened by Newton's method; our own branch
and bound where variables are discrete.
"""

from dataclasses import replace

from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.branch import branch, solved
from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.interior import TOLERANCES
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import Budget, Outcome, Watch

RANDOM = False
COUNTS = "Clarabel iteration; relaxation solved, where variables are discrete"
SETTINGS = {"solver": "Clarabel", "tolerances": TOLERANCES}


def run(problem: Conic, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a conic problem; SolveError where cvxpy's rules do not find it convex."""
    clock = Clock(budget, watch)
    if not clock.tell():
        return Outcome(None, finished=False, message="stopped before it began")
    data = canonical(problem)
    if data.allowed:  # its evaluations are relaxations
        clock.budget = replace(budget, evaluations=None)
    found = solved(problem, replace(data, allowed={}), clock)
    if data.allowed and not clock.stopped:
        return branch(problem, data, found, Clock(budget, watch, clock.start))
    return Outcome(
        found.x,
        finished=not clock.stopped,
        infeasible=found.leaf.ray,
        leaves=(found.leaf,),
        evaluations=found.steps,
        message="" if found.gap <= 1e-6 or found.words == "Solved" else f"Clarabel: {found.words}",
    )
