"""Basin hopping (`hop`): rounds of short annealing runs, each polished by Ipopt.

A round starts from random placements in a random number of layers, then changes its own best
packing: two cylinders of about one size change places, or one is thrown elsewhere. A share of the
hops starts from a random placement all the same: changes seldom alter the number of layers. The
kernel anneals the start (a changed packing cold, to keep what is good in it), its layers are kept,
and Ipopt solves the smooth text for the places. A round ends after so many hops without a better
packing of its own; the next one starts afresh, while the budget lasts, until several have ended
alike.
"""

import math
from typing import Any

import numpy as np

from gearopt.formulations.packing.packing_text import (
    of_layers,
    places,
    point,
    point_of_packing,
    smooth,
)
from gearopt.formulations.packing.plan import Places, Plan
from gearopt.formulations.packing.sa import Finish, Floor, Spent, anneal, begun, ready, scattered
from gearopt.optimise.box import violation
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array

SCATTERS = 5  # random starts of a round
FRESH, FRESH_LAYERS = (
    0.15,
    0.5,
)  # share of random starts among the later hops; where layers are free
PATIENCE = 100  # hops without a better packing end a round
ALIKE = 5  # rounds that end with the best packing found end the search
ROUNDS = 10  # at the most, where the budget has no end
MOVES, MOVES_COLD = (
    1500,
    300,
)  # of an annealing run, per cylinder: from a random start, from a change
HOT, COLD = 0.1, 1e-4  # temperatures, in units of the objective's logarithm
WARM = 1e-3  # where a hop starts from the best packing of its round
SWAPS = 0.5  # share of changes in which two cylinders change places
RANKS = 3  # two that do are at most so far from one another in the order of sizes
HOPEFUL = 1.05  # times the round's best: what annealing leaves above is not polished, at high cost
BETTER = 1e-10  # relative; a smaller improvement is rounding and counts as none
ROUND_TIE = 1e-7  # relative; rounds that end so near are alike
FEASIBLE = 1e-9  # largest violation of all rows together
PROVEN = 1e-8  # relative gap to the bound that ends the search; the bound is 1e-9 loose itself

RANDOM = True
COUNTS = "annealing move or Ipopt iteration"
SETTINGS = {
    "basin hops without a better packing that end a round": PATIENCE,
    "rounds that end alike end the search": ALIKE,
    "random starts of a round": SCATTERS,
    "share of random starts later, and where the number of layers is free": (FRESH, FRESH_LAYERS),
    "annealing moves per cylinder, from a random start and from the best": (MOVES, MOVES_COLD),
    "temperatures from a random start": (HOT, COLD),
    "temperatures from the best": (WARM, COLD),
    "polished": f"below {HOPEFUL} times the round's best",
    "local method": "ipopt",
}


def method(plan: Plan, floor: Floor, finish: Finish) -> Any:
    """Return the run of `hop` for a plan; it stops at the bound, `finish` adds bound and proof."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Hop until the bound is reached, rounds end alike, or the budget is spent."""
        if not ready(watch):
            return Outcome(None, False, message=UNREADY)
        clock, rng = Clock(budget, watch), np.random.default_rng(seed)
        spent, lower = begun(plan, problem, clock, floor)
        endless = budget.seconds is None and budget.evaluations is None
        ends: list[float] = []
        while clock.tell() and not spent.close(PROVEN):
            value = _round(plan, problem, rng, spent)
            if not clock.stopped:
                ends.append(value)
            alike = sum(v <= clock.best + ROUND_TIE * abs(clock.best) for v in ends)
            if alike >= ALIKE or (endless and len(ends) >= ROUNDS):
                break
        finished = not clock.stopped or (bool(ends) and not clock.refused)
        outcome = Outcome(spent.x, finished, evaluations=clock.evaluations)
        return finish(outcome, spent, lower)

    return run


def _round(plan: Plan, problem: Problem, rng: np.random.Generator, spent: Spent) -> float:
    """Run one round; return the objective of its best packing, inf where none met all limits."""
    best, current, idle, hops = math.inf, np.empty(0), 0, 0
    fresh = FRESH_LAYERS if plan.max_layers > plan.fewest else FRESH
    while idle < PATIENCE and spent.clock.tell() and not spent.close(PROVEN):
        if hops < SCATTERS or not len(current) or rng.random() < fresh:
            max_layers, moves, hot = int(rng.integers(plan.fewest, plan.max_layers + 1)), MOVES, HOT
            begin = scattered(plan, max_layers, rng)
        else:
            moves, hot = MOVES_COLD, WARM
            begin = _changed(plan, places(plan, problem, current), rng)
            max_layers = max(plan.fewest, int(begin.layer.max()))
        left, moves = spent.clock.left.evaluations, moves * len(plan.radius)
        moves = moves if left is None else min(moves, left)
        last = anneal(plan, problem, begin, max_layers, moves, (hot, COLD), rng, spent)
        value, candidate = math.inf, current
        if float(problem.batch(point(plan, last)[None]).F[0, 0]) < HOPEFUL * best:
            value, candidate = polished(plan, problem, last, spent)
        idle, hops = 0 if value < best * (1.0 - BETTER) else idle + 1, hops + 1
        if value < best:
            best, current = value, candidate
            spent.keep(value, candidate)
    return best


def _changed(plan: Plan, best: Places, rng: np.random.Generator) -> Places:
    """Return a packing with two cylinders exchanged, or one of them thrown elsewhere."""
    x, y, layer, centre = best.copied()
    k = int(rng.choice(plan.free))
    partners = _partners(plan, k) if rng.random() < SWAPS else []
    if partners:
        other = int(rng.choice(partners))
        for part in (x, y, layer) if k in plan.free_layers else (x, y):
            part[[k, other]] = part[[other, k]]
        return Places(x, y, layer, centre)
    other = int(rng.integers(len(x)))
    x[k], y[k] = x[other] + rng.normal(), y[other] + rng.normal()
    if k in plan.free_layers:
        layer[k] = layer[other]
    return Places(x, y, layer, centre)


def _partners(plan: Plan, k: int) -> list[int]:
    """Return the free cylinders of about the size of k, but not equal, that may change places."""
    free_layers, order = set(plan.free_layers), np.argsort(plan.radius, kind="stable").tolist()
    rank = order.index(k)
    near = order[max(0, rank - RANKS) : rank + RANKS + 1]
    sizes = list(zip(plan.radius, plan.height, strict=True))
    return [
        j
        for j in near
        if j in plan.free and sizes[j] != sizes[k] and (j in free_layers) == (k in free_layers)
    ]


def polished(plan: Plan, problem: Problem, begin: Places, spent: Spent) -> tuple[float, Array]:
    """Return objective (inf where Ipopt fails) and point of the polished packing."""
    if "smooth" not in problem.memo:
        problem.memo["smooth"] = smooth(plan, begin.layer)
    needed, height = of_layers(plan, begin.layer)
    local = problem.memo["smooth"].at(height=height, **({"needed": needed} if needed else {}))
    ended = ipopt.run(
        local,
        Budget(),
        0,
        lambda event: spent.clock.tell(event.evaluations),
        start=point_of_packing(plan, begin),
    )
    spent.clock.evaluations += ended.evaluations
    if ended.x is None or ended.infeasible:
        return math.inf, np.empty(0)
    polished_point = point(plan, places(plan, local, ended.x, begin.layer))
    value, excess = violation(problem, polished_point[None])
    return (float(value[0]) if excess[0] <= FEASIBLE else math.inf), polished_point
