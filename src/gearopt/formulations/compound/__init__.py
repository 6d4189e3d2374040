"""A compound train of two pairs whose ratio comes nearest to a given one: four numbers of teeth.

Minimise |i/u - 1|, i = z3 z4/(z1 z2), over teeth in a range; or (1/u - 1/i)^2, as Sandgren posed it
(J. Mech. Des. 112, 1990) with u = 6.931 and 12 to 60 teeth, a standard case of discrete
optimisation. The two may differ in what is nearest where the error is not small.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.posed import caps
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Terms, Var

RANDOM = False
COUNTS = "pair of numbers of teeth matched"
ERROR, SQUARED, LARGEST = "ratio_error", "squared_error", "largest_gear"  # objectives
PAIRS = "all ratios of one pair were combined with the best of the other, in rational arithmetic"
LOOK = 500  # pairs between two checks of clock and watcher: some 10 ms
BASE = 2**24  # a digit of the ratio times two numbers of teeth is a whole number that doubles hold


@dataclass(frozen=True)
class Compound:
    """The ratio u > 0 to come near to, and the minimum and maximum number of teeth of any gear.

    goal: ERROR, |i/u - 1|, or SQUARED, (1/u - 1/i)^2.
    """

    ratio: Fraction
    teeth: tuple[int, int]
    goal: str = ERROR

    @property
    def reach(self) -> tuple[Fraction, Fraction]:
        """The minimum and maximum ratio of these numbers of teeth."""
        low, high = self.teeth
        return Fraction(low, high) ** 2, Fraction(high, low) ** 2

    def ratio_error(self, inverse: Fraction) -> Fraction:
        """Return the objective of a train of this 1/i, exactly."""
        if self.goal == SQUARED:
            return (1 / self.ratio - inverse) ** 2
        return abs(1 / (inverse * self.ratio) - 1)


def problem(train: Compound, names: Sequence[str] = ()) -> Problem:
    """Return the problem of a train; variables: teeth of the drivers z1, z2 and the driven z3, z4.

    names: of its goal (by default) and LARGEST; `exact` proves the best train, or of both the whole
    front.

    With u = p/q the text is |q z3 z4 - p z1 z2|/(p z1 z2), or ((q z3 z4 - p z1 z2)/(p z3 z4))^2.
    The whole numerator is summed by the digits of p and q, the highest first: no digit is lost
    where the two products nearly cancel.
    """
    names = names or (train.goal,)
    low, high = train.teeth
    p, q = train.ratio.numerator, train.ratio.denominator
    digits = list(zip(*_digits(q, p), strict=True))

    def evaluate(x: Any, _: Any) -> Terms:
        z1, z2, z3, z4 = x.teeth
        drivers, driven, rest = z1 * z2, z3 * z4, 0.0
        for for_driven, for_drivers in digits:
            rest = rest * BASE + (for_driven * driven - for_drivers * drivers)
        largest = np.maximum(np.maximum(z1, z2), np.maximum(z3, z4)) if LARGEST in names else 0.0
        error, squared = abs(rest / (float(p) * drivers)), (rest / (float(p) * driven)) ** 2
        goals = {ERROR: error, SQUARED: squared, LARGEST: largest}
        return Terms({name: goals[name] for name in names})

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Match every pair with the two nearest ratios of the other pair; no other is nearer."""
        ratio_error, best, looked, done = nearest(train, budget, watch)
        x = np.array(best, float)
        if not done:
            return Outcome(x, finished=False, evaluations=looked, message="stopped early")
        words = (
            f"Proof: each of the {looked:,} ratios of one pair was combined with the two best "
            "ratios of the other pair, in rational arithmetic."
        )
        proof = {"method": "exhausted", "arithmetic": "rational", "pairs_matched": looked}
        proof |= {"sentence": words}
        return Outcome(x, bound=float(ratio_error), proof=proof, evaluations=looked)

    def front(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Match the pairs of fewer and fewer teeth; the seed changes nothing."""
        return _front(train, problem, Clock(budget, watch))

    teeth = Var("teeth", "", low, high, low, 4, integer=True, key="train.teeth")
    methods = {"exact": exact if len(names) == 1 else front}
    return Problem("compound", (teeth,), (), evaluate, methods=methods)


def _front(train: Compound, problem: Problem, clock: Clock) -> Outcome:
    """Return the nearest ratio of every largest gear that brings it nearer, within limits."""
    low, most = train.teeth
    nearest_trains, done = [], True
    while most >= low and done:
        limited = replace(train, teeth=(low, most))
        _, best, looked, done = nearest(limited, clock.left, clock.inner(values=False))
        clock.evaluations += looked
        if done:
            nearest_trains.append(best)
            most = max(best) - 1
            clock.tell()
    points = np.array(nearest_trains, float).reshape(-1, 4)
    known = caps(problem)
    limits = np.array([known.get(name, np.inf) for name in problem.rows.objectives])
    points = points[(problem.batch(points).F <= limits).all(axis=1)] if len(points) else points
    words = f"Proof: for each of these numbers of teeth of the largest gear {PAIRS}."
    proof = {"method": "exhausted", "arithmetic": "rational", "sentence": words}
    x, others = (points[0], tuple(points[1:])) if len(points) else (None, ())
    if not done:
        text = "stopped early: trains of smaller gears are missing"
        return Outcome(x, False, others=others, evaluations=clock.evaluations, message=text)
    none = "" if len(points) else "no train is within the largest values of interest"
    return Outcome(
        x,
        infeasible=not len(points),
        proof=proof,
        others=others,
        evaluations=clock.evaluations,
        message=none,
    )


def _digits(*numbers: int) -> list[list[float]]:
    """Return the digits of whole numbers in BASE, the highest first, as many of each."""
    count = max(1, *(-(-n.bit_length() // 24) for n in numbers))
    return [[float(n >> 24 * k & BASE - 1) for k in reversed(range(count))] for n in numbers]


def nearest(
    train: Compound, budget: Budget | None = None, watch: Watch | None = None
) -> tuple[Fraction, tuple[int, ...], int, bool]:
    """Return the exact minimum of the goal, its teeth, the pairs matched, whether all.

    The ratios of one pair are sorted once; of the other pair's, only the neighbours of what is
    missing count, as the goal falls up to it and rises beyond. Ties go to the fewest teeth, then to
    the smallest numbers.
    """
    clock = Clock(budget or Budget(), watch)
    pairs, whole = _pairs(train, clock)
    ratios, target = sorted(sorted(pairs, key=float)), 1 / train.ratio  # floats are compared faster
    best: tuple[Fraction, int, tuple[int, ...]] = (train.ratio_error(ratios[0] ** 2) + 1, 0, ())
    place = len(ratios)
    for looked, first in enumerate(ratios, 1):
        missing = target / first
        while place and ratios[place - 1] >= missing:
            place -= 1
        for second in ratios[max(0, place - 1) : place + 1]:
            ratio_error = train.ratio_error(first * second)
            if ratio_error <= best[0]:
                (a, c), (b, d) = pairs[first], pairs[second]
                teeth = (*sorted((a, b)), *sorted((c, d)))
                best = min(best, (ratio_error, sum(teeth), teeth))
                clock.best = float(best[0])
        clock.evaluations = looked
        if (looked % LOOK == 0 or looked == clock.budget.evaluations) and not clock.tell():
            break
    return best[0], best[2], looked, whole and looked == len(ratios)


def _pairs(train: Compound, clock: Clock) -> tuple[dict[Fraction, tuple[int, int]], bool]:
    """Return the ratios of one pair with their smallest teeth; False: stopped before the end."""
    low, high = train.teeth
    pairs: dict[Fraction, tuple[int, int]] = {}
    for a in range(low, high + 1):
        for b in range(low, high + 1):
            pairs.setdefault(Fraction(a, b), (a, b))
        if clock.over and a < high:
            return pairs, False
    return pairs, True


def wider(train: Compound, minimum: int, maximum: int) -> list[tuple[int, int]]:
    """Return ranges of teeth from minimum to maximum that reach the ratio by the smallest change.

    More teeth or fewer, and both only where neither alone suffices, then with the highest minimum
    that does; none where nothing does.
    """
    low, high = train.teeth
    ratio = max(train.ratio, 1 / train.ratio)
    more = low, _root(ratio * low**2)
    fewer = math.isqrt(math.floor(high**2 / ratio)), high
    least = math.isqrt(math.floor(maximum**2 / ratio))
    both = least, _root(ratio * least**2)
    alone = [r for r in (more, fewer) if minimum <= r[0] and r[1] <= maximum]
    return alone or [r for r in (both,) if minimum <= r[0]]


def _root(square: Fraction) -> int:
    """Return the smallest whole number with at least this square."""
    root = math.isqrt(math.floor(square))
    return root if root**2 >= square else root + 1
