"""The exact method: interval branch and bound on the link angles, from a good first layout.

Cells of angles are halved until each is either empty (no point in it keeps the distances) or
bounded above the best layout by the gap asked for: `branch_kernel.branch`. The gap is narrowed in
steps, so that a search which is stopped has the bound of its last full step.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gearopt.formulations.layout.annealing import anneal, point
from gearopt.formulations.layout.chain import Chain
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Array

RANDOM = False
COUNTS = "layout measured or cell bounded"
GAPS = (0.1, 0.01, 1e-3, 1e-4, 1e-5)  # each is proven before the next is tried
GAP = 1e-6  # the last one where the budget asks for none
INSIDE = 1e-2  # a gap is proven smaller by this part of it, so that rounding leaves it there
STARTS, STEPS = 8, 20_000  # annealing runs for the first layout, and their steps
SETTINGS = {"first layout": f"{STARTS} annealing runs of {STEPS}, the best polished"}
NODES = 5_000  # of a slice: below 0.1 s
DEEP = 4_000  # open cells: a depth-first search leaves one a halving, some 60 halvings an angle
NEAR = 1.0  # mm; a layout that lacks no more may be mended by polishing

Polish = Callable[[Array], tuple[Array, float]]


@dataclass
class Search:
    """A search as it runs; its state is what a stopped one still knows.

    best, x: the best layout. bound: proven. nodes: cells looked at. evaluations: layouts measured.
    empty: no layout is feasible.
    """

    budget: Budget
    watch: Watch | None
    best: float = math.inf
    x: Array | None = None
    bound: float = 0.0
    nodes: int = 0
    evaluations: int = 0
    stopped: bool = False
    empty: bool = False
    clock: float = field(default_factory=time.perf_counter)

    def left(self, most: int) -> int:
        """How much of `most` the budget's evaluations allow."""
        if self.budget.evaluations is None:
            return most
        return max(0, min(most, self.budget.evaluations - self.nodes - self.evaluations))

    def goes_on(self) -> bool:
        """Whether budget and watcher let it go on."""
        seconds, spent = time.perf_counter() - self.clock, self.nodes + self.evaluations
        late = self.budget.seconds is not None and seconds > self.budget.seconds
        full = self.budget.evaluations is not None and spent >= self.budget.evaluations
        best = self.best if math.isfinite(self.best) else None
        event = Event(seconds, spent, best, self.bound or None)
        told = self.watch is None or self.watch(event) is not False
        self.stopped = self.stopped or late or full or not told
        return not self.stopped


def method(chain: Chain, turns: tuple[float, float], polish: Polish) -> Any:
    """A run(problem, budget, seed, watch) for the best layout with a proven bound.

    turns: range of the first angle. polish(point) -> a point no worse, and its value (inf where
    neither is feasible).
    """

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        _compile(chain)
        search = Search(budget, watch)
        _first(search, chain, seed, polish)
        wanted, proven = budget.gap or GAP, None
        for rel in [g for g in GAPS if g > wanted] + [wanted]:
            bound = None
            if not search.stopped:
                bound = _prove(search, chain, turns, rel * (1.0 - INSIDE), polish)
            if bound is None:
                break
            if bound < search.best * (1.0 - rel):  # cells that could not be halved are left
                search.bound, search.stopped = max(search.bound, bound), True
                break
            proven = rel
            search.bound = max(search.bound, min(bound, search.best))
            if math.isinf(search.best):
                search.empty = math.isinf(bound)
                break
        if proven == wanted:
            search.stopped = False
        return _outcome(search, proven)

    return run


def _outcome(search: Search, proven: float | None) -> Outcome:
    proof = {
        "method": "branch and bound, stopped early" if search.stopped else "exhausted",
        "arithmetic": "intervals in double, widened by 1e-12",
        "nodes": search.nodes,
        "pruning_margin": proven,
    }
    spent = search.nodes + search.evaluations
    if search.empty:
        return Outcome(None, infeasible=True, proof=proof, evaluations=spent)
    return Outcome(
        search.x,
        not search.stopped,
        bound=search.bound or None,
        proof=proof,
        evaluations=spent,
        message="" if search.x is not None else "no layout was found",
    )


def _compile(chain: Chain) -> None:
    """Have the kernel compiled, on its first use on a machine, before the clock is started."""
    links = chain.link.size
    kernels = kernel("gearopt.formulations.layout.branch_kernel")
    cells, bounds, theta = np.zeros((2, 2, links)), np.zeros(2), np.zeros(links)
    kernels.branch(chain, 0, cells, bounds, 0, math.inf, math.inf, GAP, NODES, theta)


def _first(search: Search, chain: Chain, seed: int, polish: Polish) -> None:
    """A good layout: the best of some annealing runs, polished."""
    for k in range(STARTS):
        spent = search.evaluations

        def goes(steps: int, best: float, spent: int = spent) -> bool:
            search.evaluations = spent + steps
            return search.goes_on()

        found, _ = anneal(chain, STARTS * seed + k, search.left(STEPS), goes)
        if found[0] < search.best:
            search.best, search.x = float(found[0]), point(chain, found)
        if search.stopped:
            return
    if search.x is not None:
        _take(search, *polish(search.x))


def _take(search: Search, x: Array, value: float) -> None:
    if value < search.best:
        search.best, search.x = value, x


def _prove(
    search: Search,
    chain: Chain,
    turns: tuple[float, float],
    rel: float,
    polish: Polish,
) -> float | None:
    """A bound within `rel` of the best layout, which may improve; None if stopped before."""
    kernels = kernel("gearopt.formulations.layout.branch_kernel")
    links, floor = chain.link.size, math.inf
    theta = np.zeros(links)
    cells, bounds = np.zeros((DEEP, 2, links)), np.zeros(DEEP)
    for m in range(chain.factor.size):
        cells[0, 0], cells[0, 1] = -math.pi, math.pi
        cells[0, :, 0] = turns
        bounds[0], count = 0.0, 1
        while count:
            start = search.best
            count, best, floor, nodes, near = kernels.branch(
                chain, m, cells, bounds, count, start, floor, rel, search.left(NODES), theta
            )
            search.nodes += nodes
            x = np.append(theta, m) if chain.factor.size > 1 else theta.copy()
            if best < start:
                _take(search, x, best)
            if best < start or near < NEAR:
                _take(search, *polish(x))
            if not search.goes_on() and (count or m + 1 < chain.factor.size):
                return None
    return floor
