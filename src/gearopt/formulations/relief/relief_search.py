"""The best amounts and lengths of relief, proven: branch and bound over boxes of them.

Bounds of boxes come from `relief_box_kernel`. Boxes are halved, best bound first, along the side
that is longest beside its range, and dropped once nothing in them is better by more than the gap.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.formulations.relief.meshing import Mesh
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.relief.relief_box_kernel"
MICRO = 1e3  # um a mm: amounts of relief are numbers of size 1 there
ROUNDING = 1e-9  # um: taken off every bound
GAP = 1e-6  # relative; where no gap is asked for
FAR = 1e6  # mm: of a pair that is not in contact from the tips
TOLD = 256  # boxes between two words to the watcher
RANDOM = False
COUNTS = "box bounded"
SETTINGS = {"gap": GAP}
SENTENCE = "Proof: every box of amounts and lengths was searched; bounds of boxes by planes."


@dataclass(frozen=True)
class Numbers:
    """What the kernel needs of a mesh, in um and N: uncoupled stiffnesses (p, n), tips (2, p, n).

    low, high (4,): a1, l1, a2, l2 with a = amount^(1/p); exponents (2,), loads (l,).
    """

    stiffness: Array
    tips: Array
    exponents: Array
    loads: Array
    low: Array
    high: Array

    def bound(self, low: Array, high: Array, aim: float) -> tuple[float, Array, float]:
        """Return a bound of a box [um], a point (a1, b1, a2, b2) of it, and its value [um]."""
        point = np.empty(4)
        given = self.stiffness, self.tips, self.exponents, self.loads
        found, value = kernel(KERNEL).bound(*given, low, high, aim, point)
        return found - ROUNDING, point, value

    def variables(self, point: Array) -> Array:
        """Return the variables (amounts 1, 2, lengths 1, 2) [mm] of a point (a1, b1, a2, b2)."""
        a, b = point[::2], point[1::2]
        lengths = np.where(a > 0.0, a / np.where(b > 0.0, b, 1.0), self.high[1::2])
        lengths = np.clip(lengths, self.low[1::2], self.high[1::2])
        return np.concatenate([a**self.exponents / MICRO, lengths])


def numbers(mesh: Mesh, low: Array, high: Array, exponents: tuple[float, float]) -> Numbers:
    """Return a mesh as the kernel takes it; low, high: amounts 1, 2, lengths 1, 2 [mm].

    ValueError for exponents below 1, whose relief is not convex.
    """
    powers = np.array(exponents, float)
    if not (powers >= 1.0).all():
        raise ValueError("the search takes exponents of relief of at least 1")
    there = mesh.cycle.present
    stiffness = np.where(there, 1.0 / (MICRO * (mesh.compliances - mesh.coupling)), 0.0)
    tips = np.array([np.where(there, x, FAR) for x in mesh.from_tips])
    ends = []
    for end in (low, high):
        roots = (MICRO * np.asarray(end[:2])) ** (1.0 / powers)
        ends.append(np.array([roots[0], end[2], roots[1], end[3]]))
    return Numbers(stiffness, tips, powers, np.array(mesh.loads), *ends)


def search(mesh: Mesh, exponents: tuple[float, float]) -> Callable[..., Outcome]:
    """Return the method of `parametric.problem` that proves the least peak-to-peak of all loads."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Halve boxes until none may hold a better relief; the seed changes nothing."""
        clock = Clock(budget, watch)
        made, code = numbers(mesh, *problem.bounds()[:2], exponents), kernel(KERNEL)
        if not compiled(lambda: made.bound(made.low, made.high, 0.0), (code.bound,), watch):
            return Outcome(None, False, message=UNREADY)
        clock.start = Clock().start
        point, bound, ended = _searched(made, clock)
        proof = {"method": "boxes", "boxes": clock.evaluations, "sentence": SENTENCE}
        x, spent = made.variables(point), clock.evaluations
        return Outcome(x, ended, bound=bound / MICRO, proof=proof, evaluations=spent)

    return run


def _searched(made: Numbers, clock: Clock) -> tuple[Array, float, bool]:
    """Return the best point, a bound [um], and whether the search came to its end."""
    gap = max(clock.budget.gap, GAP)
    least, point, best = made.bound(made.low, made.high, np.inf)
    boxes: list[Any] = [(least, 0, made.low, made.high)]
    width = np.where(made.high > made.low, made.high - made.low, np.inf)
    floor = np.inf  # of boxes too small to be halved
    while boxes and boxes[0][0] < best * (1.0 - gap):
        least, turn, low, high = heapq.heappop(boxes)
        clock.best, clock.bound = best / MICRO, min(least, floor, best) / MICRO
        if turn % TOLD < 2 and not clock.tell():
            return point, min(least, floor, best), False
        side = int(np.argmax((high - low) / width))
        middle = 0.5 * (low[side] + high[side])
        if not low[side] < middle < high[side]:
            floor = min(floor, least)
            continue
        for lower, upper in ((low[side], middle), (middle, high[side])):
            ends = low.copy(), high.copy()
            ends[0][side], ends[1][side] = lower, upper
            found, x, value = made.bound(ends[0], ends[1], best * (1.0 - gap))
            clock.evaluations += 1
            if value < best:
                best, point = value, x
            heapq.heappush(boxes, (max(found, least), clock.evaluations, *ends))
    return point, min([floor, best, *(box[0] for box in boxes[:1])]), True
