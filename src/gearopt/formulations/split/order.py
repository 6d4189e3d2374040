"""All feasible trains in the order of an objective, in lots, however many there are."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from gearopt.formulations.ratio.duty import UNITS
from gearopt.formulations.split.numbers import Numbers, numbers
from gearopt.formulations.split.teeth import problem
from gearopt.formulations.split.train import OBJECTIVES, ServoTrain
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.split.order_kernel"
FIRST = 1e-3  # by which the trains of the first lot are worse than the best one, at the most
WIDER = 4.0  # from a lot of few trains to the next one
LOT = 1_000_000  # trains of a lot, at the most; more where they are as good as each other
ALIKE = 1e-9  # relative: no lot is split further


def in_order(
    train: ServoTrain, goal: str, best: float, check: Callable[[], None]
) -> Iterator[Array]:
    """Lots of trains as points of `split.problem`, (trains, 6), the best first; together all.

    best: the least objective, > 0. check is called now and then and may raise.
    """
    given, posed = numbers(train, goal in UNITS), problem(train, goal)
    aim, above, step = (*OBJECTIVES, *UNITS).index(goal), -math.inf, FIRST
    reached = best
    while True:
        most = reached + step * best
        most = most if math.isfinite(most) and step < 1.0 / ALIKE else math.inf
        found = _listed(given, aim, above, most, LOT if step > ALIKE else 0, check)
        if found is None:
            step /= WIDER
            continue
        if len(found):
            yield found[posed.batch(found).F[:, 0].argsort(kind="stable")]
        if math.isinf(most):
            return
        above = reached = most
        step *= WIDER if len(found) < LOT / WIDER else 1.0


def _listed(
    given: Numbers, aim: int, above: float, most: float, limit: int, check: Callable[[], None]
) -> Array | None:
    """Trains between two values; None where they are more than a limit above 0."""
    code, parts, total = kernel(KERNEL), [], 0
    rows = np.empty((1024, 6), np.int64)
    for k in range(len(given.module) * int(given.pinion[1] - given.pinion[0] + 1)):
        check()
        count = code.between(given, aim, k, above, most, rows)
        if count > len(rows):
            rows = np.empty((2 * count, 6), np.int64)
            code.between(given, aim, k, above, most, rows)
        parts.append(rows[:count].copy())
        total += count
        if 0 < limit < total:
            return None
    z1, z2, z3, z4, i, j = np.concatenate(parts).T
    return np.column_stack([z1, z3, z2, z4, given.module[i], given.module[j]]).astype(float)
