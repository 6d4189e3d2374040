"""`sa`: one long annealing run of the kernel alone, without a local method."""

from typing import Any

import numpy as np

from gearopt.formulations.packing import text
from gearopt.formulations.packing.plan import Plan, row
from gearopt.formulations.packing.state import LOOKS, Finish, Floor, Spent, anneal, ready, scattered
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch

MOVES = 300_000  # for each cylinder, where the budget names no evaluations
HOT, COLD = 0.3, 1e-6  # temperatures, in units of the objective's logarithm

RANDOM = True
PACED = True  # the cooling is stretched over the evaluations it is given
COUNTS = "annealing move"
SETTINGS = {"temperatures": (HOT, COLD), "moves, each cylinder, where none are given": MOVES}


def method(plan: Plan, floor: Floor, finish: Finish) -> Any:
    """The run of `sa` for a plan: `finish` adds bound and proof."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Anneal once; the best state that meets all limits, or else the row of all, is kept."""
        ready()
        spent, rng = Spent(clock := Clock(budget, watch)), np.random.default_rng(seed)
        first = text.point(plan, row(plan))
        spent.keep(float(problem.batch(first[None]).F[0, 0]), first)
        least = floor(problem, spent)
        clock.bound = least.value
        most = budget.evaluations
        moves = MOVES * len(plan.radius) if most is None else most
        begin = scattered(plan, plan.most, rng)
        if clock.tell():
            anneal(plan, problem, begin, plan.most, moves, (HOT, COLD), rng, spent, LOOKS)
        outcome = Outcome(spent.x, not clock.stopped, evaluations=clock.evaluations)
        return finish(outcome, spent, least)

    return run
