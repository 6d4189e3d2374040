"""A compound train of two pairs whose ratio comes nearest to a given one: four whole tooth numbers.

Minimise (1/u - z1 z2/(z3 z4))^2 over teeth in a range. Posed by Sandgren (J. Mech. Des. 112, 1990)
with u = 6.931 and 12 to 60 teeth, where it is a standard case of discrete optimisation.
"""

import time
from bisect import bisect_left
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Terms, Var

RANDOM = False
COUNTS = "pair of tooth numbers matched"
LOOK = 500  # pairs between two looks at the watcher: some 10 ms


@dataclass(frozen=True)
class Compound:
    """The ratio u > 0 to come near to, and the least and most teeth of any gear."""

    ratio: Fraction
    teeth: tuple[int, int]


def problem(train: Compound) -> Problem:
    """Variables: teeth of the drivers z1, z2 and of the driven z3, z4; `exact` proves the best."""
    low, high = train.teeth
    target = float(1 / train.ratio)

    def evaluate(x: Any, p: Any) -> Terms:
        z1, z2, z3, z4 = x.teeth
        return Terms({"squared_error": (target - z1 * z2 / (z3 * z4)) ** 2})

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Every pair with the two that miss least with it; no other can be nearer."""
        error, best, looked, done = nearest(train, watch)
        x = np.array(best, float)
        if not done:
            return Outcome(x, finished=False, evaluations=looked, message="stopped early")
        proof = {"method": "exhausted", "arithmetic": "rational", "pairs_matched": looked}
        return Outcome(x, bound=float(error**2), proof=proof, evaluations=looked)

    teeth = Var("teeth", "", low, high, low, 4, integer=True)
    return Problem("compound", (teeth,), (), evaluate, methods={"exact": exact})


def nearest(
    train: Compound, watch: Watch | None = None
) -> tuple[Fraction, tuple[int, ...], int, bool]:
    """Least |1/u - z1 z2/(z3 z4)|, exactly, its teeth, the pairs looked at, and whether all were.

    The ratios of one pair are sorted once; of the other pair's, only the neighbours of what is
    missing count. Ties go to the fewest teeth, then to the smallest numbers.
    """
    low, high = train.teeth
    pairs: dict[Fraction, tuple[int, int]] = {}
    for a in range(low, high + 1):
        for b in range(low, high + 1):
            pairs.setdefault(Fraction(a, b), (a, b))
    ratios, target, clock = sorted(pairs), 1 / train.ratio, time.perf_counter()
    found: list[tuple[Fraction, int, tuple[int, ...]]] = []
    for looked, first in enumerate(ratios, 1):
        place = bisect_left(ratios, target / first)
        for second in ratios[max(0, place - 1) : place + 1]:
            (a, c), (b, d) = pairs[first], pairs[second]
            drivers, driven = sorted((a, b)), sorted((c, d))
            teeth = (*drivers, *driven)
            found.append((abs(target - first * second), sum(teeth), teeth))
        if watch is not None and looked % LOOK == 0:
            seconds = time.perf_counter() - clock
            if watch(Event(seconds, looked, float(min(found)[0] ** 2))) is False:
                break
    error, _, best = min(found)
    return error, best, looked, looked == len(ratios)
