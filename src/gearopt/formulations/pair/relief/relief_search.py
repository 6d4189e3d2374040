"""The best amounts and lengths of relief, proven: branch and bound over boxes of them.

Bounds of boxes come from `relief_box_kernel`. Boxes are halved, best bound first, along the side
that is longest beside its range, and dropped once nothing in them is better by more than the gap.
Measures may have a largest value: their weights are then such that a box is dropped only if each
point in it is no better or exceeds one of them.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.pair.relief.relief_box_kernel"
MICRO = 1e3  # um a mm: amounts of relief are numbers of size 1 there
ROUNDING = 1e-9  # um: taken off every bound
NOTHING = 1e-8  # um: of values, a difference that no gear has
GAP = 1e-6  # relative; where no gap is asked for
WITHIN = 0.99  # of a gap: roundings included
NO_CONTACT = 1e6  # mm: of a pair that is not in contact from the tips
TINY = 1e-300  # um
TOLD = 256  # boxes between two words to the watcher
Box = tuple[Array, Array]  # its lower and upper ends
RANDOM = False
COUNTS = "box bounded"
SETTINGS = {"gap": GAP}
EMPTY = "Proof: every box of amounts and lengths was searched: no relief keeps to these limits."
SENTENCE = "Proof: every box of amounts and lengths was searched; bounds by cutting planes."
STOPPED = (
    "Proof of the lower bound: no box of amounts and lengths has less; bounds by cutting planes."
)


@dataclass(frozen=True)
class Numbers:
    """A mesh as the kernel takes it, in um and N: uncoupled stiffnesses (p, n), tips (2, p, n).

    low, high (4,): a1, l1, a2, l2 with a = amount^(1/p); exponents (2,), loads (q,); waves (h, p)
    from approaches to the parts of their harmonics.
    """

    stiffness: Array
    tips: Array
    exponents: Array
    loads: Array
    waves: Array
    low: Array
    high: Array

    def bound(
        self, weights: Array, low: Array, high: Array, aim: float
    ) -> tuple[float, Array, Array]:
        """Return a bound of a box [um], a point (a1, b1, a2, b2) of it, and its measures [um]."""
        point, measures = np.empty(4), np.empty(weights.shape)
        given = self.stiffness, self.tips, self.exponents, self.loads, self.waves, weights
        lower = kernel(KERNEL).bound(*given, low, high, aim, point, measures)
        return lower - ROUNDING, point, measures

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
    tips = np.array([np.where(there, x, NO_CONTACT) for x in mesh.from_tips])
    ends = []
    for end in (low, high):
        roots = (MICRO * np.asarray(end[:2])) ** (1.0 / powers)
        ends.append(np.array([roots[0], end[2], roots[1], end[3]]))
    waves = mesh.waves()
    parts = np.vstack([waves.real, waves.imag])
    return Numbers(stiffness, tips, powers, np.array(mesh.loads), parts, *ends)


@dataclass(frozen=True)
class Goal:
    """Which measures' largest is minimised (2, q), and the largest allowed of each [um].

    Measures are peak-to-peaks and amplitudes of harmonics at every load; those without a largest
    value have an infinite one.
    """

    minimised: Any
    most: Array

    @property
    def limited(self) -> bool:
        """Whether a measure has a largest value."""
        return bool(np.isfinite(self.most).any())

    def used(self, measures: Array) -> float:
        """Return the largest part of a limit that is used."""
        return float((measures / self.most).max())

    def value(self, measures: Array) -> float:
        """Objective [um]; infinite where a limit is exceeded."""
        return float(measures[self.minimised].max()) if self.used(measures) <= 1.0 else np.inf

    def weights(self, aim: float) -> Array:
        """Return weights with which a box whose bound reaches the aim holds nothing better."""
        return np.maximum(np.where(self.minimised, 1.0, 0.0), aim / self.most)


def search(mesh: Mesh, exponents: tuple[float, float], goal: Goal) -> Callable[..., Outcome]:
    """Return the method of `parametric.problem` that proves the least value of a goal."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Halve boxes until none may hold a better relief; the seed changes nothing."""
        clock = Clock(budget, watch)
        mesh_numbers, code = numbers(mesh, *problem.bounds()[:2], exponents), kernel(KERNEL)
        ones = np.ones(goal.most.shape)
        if not compiled(
            lambda: mesh_numbers.bound(ones, mesh_numbers.low, mesh_numbers.high, 0.0),
            (code.bound,),
            watch,
        ):
            return Outcome(None, False, message=UNREADY)
        clock.start = Clock().start
        known = _allowed(mesh_numbers, goal, clock) if goal.limited else _first(mesh_numbers, goal)
        if isinstance(known, Outcome):
            return known
        point, bound, ended = _searched(mesh_numbers, goal, clock, *known)
        said = SENTENCE if ended else STOPPED
        proof = {"method": "boxes", "boxes": clock.evaluations, "sentence": said}
        proof |= {"scope": mesh.sampled}
        x, spent = mesh_numbers.variables(point), clock.evaluations
        lowest = max(bound, 0.0) / MICRO if ended or not goal.limited else None  # never below 0
        return Outcome(x, ended, bound=lowest, proof=proof, evaluations=spent)

    return run


def _first(made: Numbers, goal: Goal) -> tuple[Array, float]:
    """Return the point where the relaxation of the whole box is least, and its value."""
    _, point, measures = made.bound(goal.weights(1.0), made.low, made.high, np.inf)
    return point, goal.value(measures)


def _allowed(made: Numbers, goal: Goal, clock: Clock) -> tuple[Array, float] | Outcome:
    """Return a point that keeps to the limits and its value, or that there is none."""
    weights, proof = 1.0 / goal.most, True
    allowed: tuple[Array, float] | None = None

    def branch(_: float, box: Box) -> Iterator[tuple[float, Box]]:
        nonlocal allowed, proof
        least, point, measures = made.bound(weights, *box, 1.0)
        clock.evaluations += 1
        if goal.used(measures) <= 1.0:
            allowed = point, goal.value(measures)
            return
        parts = halves(made, *box) if least < 1.0 else ()
        proof &= least >= 1.0 or bool(parts)
        yield from ((least, half) for half in parts)

    whole = 0.0, (made.low, made.high)
    best_first([whole], lambda *_: allowed is None and clock.tell(), branch)
    spent = clock.evaluations
    if allowed is not None:
        return allowed
    if clock.stopped:
        return Outcome(None, False, evaluations=spent)
    sentence = {"method": "boxes", "boxes": spent, "sentence": EMPTY}
    if not proof:
        return Outcome(None, evaluations=spent, message="boxes too small to be halved are left")
    return Outcome(None, infeasible=True, proof=sentence, evaluations=spent, message=EMPTY)


def halves(made: Numbers, low: Array, high: Array) -> tuple[Box, ...]:
    """Return the halves of a box along the side that matters most; none of a point.

    Sides are measured by their ranges, those of lengths times the part of the amount they shape.
    """
    width = np.where(made.high > made.low, made.high - made.low, np.inf)
    parts = (high - low) / width
    parts[1::2] *= high[::2] / np.maximum(made.high[::2], TINY)
    side = int(np.argmax(parts))
    middle = 0.5 * (low[side] + high[side])
    if not low[side] < middle < high[side]:
        return ()
    below, above = high.copy(), low.copy()
    below[side] = above[side] = middle
    return (low, below), (above, high)


def _searched(
    made: Numbers, goal: Goal, clock: Clock, point: Array, best: float
) -> tuple[Array, float, bool]:
    """Return the best point, a bound [um], and whether the search came to its end.

    point, best: known before. Bounds of boxes under limits are no bounds of what is minimised, so
    all boxes are visited.
    """
    gap = WITHIN * max(clock.budget.gap, GAP)
    floor = np.inf  # of boxes not to be halved

    def aim() -> float:
        return best - max(gap * best, NOTHING)

    def goes_on(least: float, _: Box) -> bool:
        if not goal.limited and least >= aim():
            return False
        clock.best = best / MICRO
        clock.bound = -np.inf if goal.limited else min(least, floor, best) / MICRO
        return clock.evaluations % TOLD >= 2 or clock.tell()

    def branch(least: float, box: Box) -> Iterator[tuple[float, Box]]:
        nonlocal point, best, floor
        parts = halves(made, *box)
        if not parts and (box[0] < box[1]).any():
            floor = 0.0 if goal.limited else min(floor, least)
        for half in parts:
            sought = aim()  # of the weights, with which alone a bound says anything under limits
            lower, x, measures = made.bound(goal.weights(sought), *half, sought)
            clock.evaluations += 1
            if (value := goal.value(measures)) < best:
                best, point = value, x
            if lower < sought or not goal.limited:
                yield max(lower, least * (not goal.limited)), half

    root = made.bound(goal.weights(aim()), made.low, made.high, aim())[0]
    left = best_first([(root, (made.low, made.high))], goes_on, branch)
    if clock.stopped:
        return point, min(left.least, floor, best), False
    return point, min(floor, best, aim() if goal.limited else left.least), True
