"""`hop`: many short annealing runs, each polished by Ipopt; the best packing so far is never lost.

A hop starts from a random scatter in a random number of layers or, now and then, from the best
packing with a cylinder thrown elsewhere; the kernel anneals it, its layers are kept, and Ipopt
solves the smooth text for the places. The search ends after so many hops without a better packing.
"""

import math
from typing import Any

import numpy as np

from gearopt.formulations.packing import points, text
from gearopt.formulations.packing.plan import Places, Plan, row
from gearopt.formulations.packing.state import Finish, Floor, Spent, anneal, scattered
from gearopt.optimise.box import violation
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array

PATIENCE = 200  # hops without a better packing end the search
MOVES = 1500  # of an annealing run, for each cylinder
HOT, COLD = 0.1, 1e-4  # temperatures, in units of the objective's logarithm
WARM = 0.05  # where a hop starts from the best packing
FROM_BEST = 0.3  # share of such hops
HOPEFUL = 1.05  # times the best: what annealing leaves above is not polished, which costs more
BETTER = 1e-10  # relative; a smaller improvement is rounding and counts as none
FEASIBLE = 1e-9  # largest violation of all rows together
PROVEN = 1e-8  # relative gap to the bound that ends the search; the bound is 1e-9 loose itself

RANDOM = True
COUNTS = "annealing move or Ipopt iteration"
SETTINGS = {
    "hops without a better packing": PATIENCE,
    "moves of a hop, each cylinder": MOVES,
    "temperatures": (HOT, COLD),
    "hops from the best packing": FROM_BEST,
    "polished": f"below {HOPEFUL} times the best",
    "local method": "ipopt",
}


def method(plan: Plan, floor: Floor, finish: Finish) -> Any:
    """The run of `hop` for a plan: it stops at the bound; `finish` adds bound and proof."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Hop until the bound is reached, nothing better is found, or the budget is spent."""
        spent, rng, idle = Spent(budget, watch), np.random.default_rng(seed), 0
        least = floor(problem)
        spent.bound = least.value
        best = points.point(plan, row(plan))
        spent.best = float(problem.batch(best[None]).F[0, 0])
        while idle < PATIENCE and spent.goes_on() and not spent.close(PROVEN):
            most = int(rng.integers(plan.fewest, plan.most + 1))
            begin, hot = scattered(plan, most, rng), HOT
            if rng.random() < FROM_BEST:
                begin, hot = _kicked(plan, points.places(plan, problem, best), rng), WARM
                most = max(most, int(begin.layer.max()))
            moves = min(MOVES * len(plan.radius), spent.left())
            last, _, _ = anneal(plan, begin, most, moves, (hot, COLD), rng, spent)
            value, found = math.inf, best
            if float(problem.batch(points.point(plan, last)[None]).F[0, 0]) < HOPEFUL * spent.best:
                value, found = polished(plan, problem, last, spent)
            idle = 0 if value < spent.best * (1.0 - BETTER) else idle + 1
            if value < spent.best:
                spent.best, best = value, found
        return finish(Outcome(best, not spent.stopped, evaluations=spent.evaluations), spent, least)

    return run


def _kicked(plan: Plan, best: Places, rng: np.random.Generator) -> Places:
    """The best packing with one free cylinder put where another one is."""
    x, y, layer, centre = best.copied()
    k, other = rng.choice(plan.free), rng.integers(len(x))
    x[k], y[k] = x[other] + rng.normal(), y[other] + rng.normal()
    if k in plan.lifted:
        layer[k] = layer[other]
    return Places(x, y, layer, centre)


def polished(plan: Plan, problem: Problem, begin: Places, spent: Spent) -> tuple[float, Array]:
    """Objective and point of the packing that Ipopt makes of one; infinite where it fails."""
    if "smooth" not in problem.memo:
        problem.memo["smooth"] = text.smooth(plan, begin.layer)
    needed, height = text.of_layers(plan, begin.layer)
    local = problem.memo["smooth"].at(height=height, **({"needed": needed} if needed else {}))
    ended = ipopt.run(
        local,
        Budget(),
        0,
        lambda event: spent.goes_on(event.evaluations),
        start=points.start(plan, begin),
    )
    spent.evaluations += ended.evaluations
    if ended.x is None or ended.infeasible:
        return math.inf, np.empty(0)
    found = points.point(plan, points.places(plan, local, ended.x, begin.layer))
    value, excess = violation(problem, found[None])
    return (float(value[0]) if excess[0] <= FEASIBLE else math.inf), found
