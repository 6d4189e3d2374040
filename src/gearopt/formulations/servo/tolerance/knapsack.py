"""The cheapest pick of one (weight, cost) a component within a weight: dynamic programming.

After every component, the pairs of sums are kept that no other pair is better than in both; the
least weight of the components still to come prunes. Whole numbers are compared exactly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array

FITS = 2**62  # sums of whole numbers below it are of 64 bits, else of Python's own


@dataclass(frozen=True)
class Picked:
    """Positions picked, from 0; None where nothing is within the weight, or it was stopped.

    finished: all was looked at. largest: most pairs kept.
    """

    positions: tuple[int, ...] | None
    finished: bool
    largest: int


def picked(
    weights: Sequence[Array],
    costs: Sequence[Array],
    limit: Any,
    clock: Clock,
) -> Picked:
    """Least sum of costs with a sum of weights <= limit; of equals, the least weight.

    weights, costs: an array a component, of doubles or whole numbers; the clock counts pairs and is
    told before each component.
    """
    lightest = [w.min() for w in weights]
    later = [sum(lightest[k + 1 :]) for k in range(len(weights))]
    weight, cost = 0 * weights[0][:1], 0 * costs[0][:1]
    trail, largest = [], 1
    for own_weight, own_cost, rest in zip(weights, costs, later, strict=True):
        if not clock.tell():
            return Picked(None, False, largest)
        weight = np.add.outer(weight, own_weight).ravel()
        cost = np.add.outer(cost, own_cost).ravel()
        clock.evaluations += len(weight)
        order = _best(weight, cost, np.flatnonzero(weight + rest <= limit))
        if not len(order):
            return Picked(None, True, largest)
        trail.append(np.divmod(order, len(own_weight)))
        weight, cost = weight[order], cost[order]
        largest = max(largest, len(order))
    place, chosen = len(cost) - 1, []  # costs fall as weights rise: the last is the cheapest
    for before, position in reversed(trail):
        chosen.append(int(position[place]))
        place = int(before[place])
    return Picked(tuple(reversed(chosen)), True, largest)


def _best(weight: Array, cost: Array, inside: Any) -> Any:
    """Places, by rising weight, of the pairs that are cheaper than every lighter one."""
    order = inside[np.argsort(cost[inside], kind="stable")]
    order = order[np.argsort(weight[order], kind="stable")]
    lowest = np.minimum.accumulate(cost[order])
    cheaper = np.ones(len(order), bool)
    cheaper[1:] = cost[order][1:] < lowest[:-1]
    return order[cheaper]


def whole(rows: Sequence[Sequence[Fraction]]) -> tuple[list[Any], int]:
    """Rows of fractions as whole numbers of their common denominator, and that denominator."""
    unit = math.lcm(*(v.denominator for row in rows for v in row))
    numbers = [[int(v * unit) for v in row] for row in rows]
    most = unit + sum(max(map(abs, row)) for row in numbers)
    kind: Any = np.int64 if most < FITS else object
    return [np.array(row, dtype=kind) for row in numbers], unit
