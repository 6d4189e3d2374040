"""The exact method: interval branch and bound on the link angles, from a good first layout.

Cells of angles are halved until each is either empty (no point in it keeps the distances) or
bounded above the best layout by the requested gap: `branch_kernel.branch`. The gap is narrowed in
steps, so that a search which is stopped has the bound of its last full step.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.drive.layout import annealing
from gearopt.formulations.drive.layout.annealing import ANNEAL, anneal, point
from gearopt.formulations.drive.layout.chain import Chain
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import ending
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel, warm
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

BRANCH = "gearopt.formulations.drive.layout.branch_kernel"
RANDOM = False
COUNTS = "layout measured or range of link angles bounded"
GAPS = (0.1, 0.01, 1e-3, 1e-4, 1e-5)  # each is proven before the next is tried
GAP = 1e-6  # the last one where the budget requests none
INSIDE = 1e-2  # a gap is proven smaller by this part of it, so that rounding leaves it there
STARTS, STEPS = 8, 20_000  # annealing runs for the first layout, and their steps
SETTINGS = {"first layout": f"{STARTS} annealing runs of {STEPS}, the best polished"}
NODES = 5_000  # of a slice, below 0.1 s, after which a near miss is polished
UNCOMPILED_STEPS = 100  # of a slice of uncompiled Python, some hundredths of a second
DEEP = 4_000  # open cells: a depth-first search leaves one per halving, some 60 halvings per angle
MENDED_WITHIN = 1.0  # mm; a layout that lacks no more may be mended by polishing

Polish = Callable[[Array], tuple[Array, float]]


@dataclass
class Search:
    """A search as it runs; its state is the knowledge that a stopped one still has.

    clock: counts layouts measured and cells examined (nodes); has the best value and what is
    proven. x: the best layout. empty: no layout is feasible.
    """

    clock: Clock
    x: Array | None = None
    nodes: int = 0
    empty: bool = False

    def left(self, maximum: int) -> int:
        """Return how much of `maximum` the budget's evaluations allow."""
        left = self.clock.left.evaluations
        return maximum if left is None else min(maximum, left)


def method(chain: Chain, turns: tuple[float, float], polish: Polish) -> Any:
    """Return a run(problem, budget, seed, watch) for the best layout with a proven bound.

    turns: range of the first angle. polish(point) -> a point no worse, and its value (inf where
    neither is feasible).
    """

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        if not annealing.ready(chain, watch):
            return Outcome(None, False, message=UNREADY)
        search = Search(clock := Clock(budget, watch))
        _first(search, chain, seed, polish)
        wanted, proven = budget.gap or GAP, None
        for rel in [g for g in GAPS if g > wanted] + [wanted]:
            bound = None
            if not clock.stopped:
                bound = _prove(search, chain, turns, rel * (1.0 - INSIDE), polish)
            if bound is None:
                break
            if bound < clock.best * (1.0 - rel):  # cells that could not be halved are left
                clock.bound, clock.stopped = max(clock.bound, bound), True
                break
            proven = rel
            clock.bound = max(clock.bound, min(bound, clock.best))
            if math.isinf(clock.best):
                search.empty = math.isinf(bound)
                break
        if proven == wanted:
            clock.stopped = False
        return _outcome(search, proven)

    return run


def _outcome(search: Search, proven: float | None) -> Outcome:
    clock = search.clock
    method = "branch and bound, stopped early" if clock.stopped else "exhausted"
    proof = {
        "method": method,
        "arithmetic": "intervals in double, widened by 1e-12",
        "nodes": search.nodes,
        "pruning_margin": proven,
        "sentence": f"Proof: {search.nodes:,} ranges of link angles, each bounded by interval "
        f"arithmetic; {ending(not clock.stopped)}.",
    }
    if search.empty:
        return Outcome(None, infeasible=True, proof=proof, evaluations=clock.evaluations)
    return Outcome(
        search.x,
        not clock.stopped,
        bound=clock.bound if clock.bound > 0.0 else None,
        proof=proof,
        evaluations=clock.evaluations,
        message="" if search.x is not None else "no layout was found",
    )


def ready(chain: Chain, watch: Watch | None = None) -> bool:
    """Have the kernels compiled, on their first use on a machine; False if the watcher ended that.

    It comes before the clock is started, so that the time is in no budget.
    """
    links, branch = chain.link.size, kernel(BRANCH).branch

    def work() -> None:
        anneal(chain, 0, 1, lambda steps, best: True)
        cells, bounds, theta = np.zeros((2, 2, links)), np.zeros(2), np.zeros(links)
        branch(chain, 0, cells, bounds, 0, math.inf, math.inf, math.inf, GAP, NODES, theta)

    return compiled(work, (kernel(ANNEAL).anneal, branch), watch)


def _first(search: Search, chain: Chain, seed: int, polish: Polish) -> None:
    """Keep a good layout: the best of some annealing runs, polished."""
    clock = search.clock
    for k in range(STARTS):
        spent = clock.evaluations

        def goes(steps: int, best: float, spent: int = spent) -> bool:
            clock.evaluations = spent + steps
            return clock.tell()

        layout, _ = anneal(chain, STARTS * seed + k, search.left(STEPS), goes)
        if layout[0] < clock.best:
            clock.best, search.x = float(layout[0]), point(chain, layout)
        if clock.stopped:
            return
    if search.x is not None:
        _take(search, *polish(search.x))


def _take(search: Search, x: Array, value: float) -> None:
    if value < search.clock.best:
        search.clock.best, search.x = value, x


def first_cell(links: int, turns: tuple[float, float]) -> tuple[Array, Array]:
    """Return room for DEEP cells (DEEP, 2, links) and their bounds, with that of all angles first.

    turns: range of the first angle [rad].
    """
    cells = np.zeros((DEEP, 2, links))
    cells[0, 0], cells[0, 1] = -math.pi, math.pi
    cells[0, :, 0] = turns
    return cells, np.zeros(DEEP)


def _prove(
    search: Search,
    chain: Chain,
    turns: tuple[float, float],
    rel: float,
    polish: Polish,
) -> float | None:
    """Return a bound within `rel` of the best layout, which may improve; None if stopped before."""
    branch, clock = kernel(BRANCH).branch, search.clock
    floor, theta = math.inf, np.zeros(chain.link.size)
    for m in range(chain.factor.size):
        (cells, bounds), count, near, spent = first_cell(theta.size, turns), 1, math.inf, 0
        while count:
            start, size = clock.best, UNCOMPILED_STEPS if warm().waits(branch) else NODES
            limit = search.left(min(size, NODES - spent))
            state = (count, start, near, floor, rel, limit, theta)
            searched = warm().call(clock, branch, chain, m, cells, bounds, *state)
            if searched is None:
                return None
            count, best, near, floor, nodes = searched
            search.nodes, clock.evaluations = search.nodes + nodes, clock.evaluations + nodes
            spent += nodes
            x = np.append(theta, m) if chain.factor.size > 1 else theta.copy()
            if best < start:
                _take(search, x, best)
            if best < start or not count or spent >= NODES:
                if best < start or near < MENDED_WITHIN:
                    _take(search, *polish(x))
                near, spent = math.inf, 0
            if not clock.tell() and (count or m + 1 < chain.factor.size):
                return None
    return floor
