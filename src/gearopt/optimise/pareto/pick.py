"""One design of a front, with the reason: the knee, the compromise, the best of given weights."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearopt.optimise.pareto.measures import ideal, nadir
from gearopt.optimise.terms import Array

KNEE, COMPROMISE, WEIGHTS = "knee", "compromise", "weights"


@dataclass(frozen=True)
class Pick:
    """Place of a point in a front (from 0), which rule took it, and the reason in words."""

    place: int
    rule: str
    reason: str


def picks(values: Array, names: Sequence[str], weights: Mapping[str, float] | None) -> list[Pick]:
    """Return the designs of a front (N, k) that rules take; that of weights first, if given."""
    if not len(values):
        return []
    unit = scaled(values)
    found = []
    if weights is not None:
        w = np.array([float(weights.get(name, 0.0)) for name in names])
        words = ", ".join(f"{n.replace('_', ' ')} {v:g}" for n, v in zip(names, w, strict=True))
        reason = f"the minimum weighted sum of the normalised objectives: {words}"
        found.append(Pick(int((unit @ w).argmin()), WEIGHTS, reason))
    if (k := knee(unit)) is not None:
        reason = "the point furthest below the straight line between the ends of the front"
        found.append(Pick(k, KNEE, reason))
    near = int(np.linalg.norm(unit, axis=1).argmin())
    reason = "the point nearest to the ideal point, in normalised objectives"
    found.append(Pick(near, COMPROMISE, reason))
    return found


def scaled(values: Array) -> Array:
    """Return values (N, k) from 0, the least of an objective on the front, to 1, its largest."""
    width = nadir(values) - ideal(values)
    return np.asarray((values - ideal(values)) / np.where(width > 0.0, width, 1.0))


def knee(unit: Array) -> int | None:
    """Return the point furthest below the plane through the ends; None where none lies below.

    unit (N, k): scaled values. The ends are the points of the least value of each objective.
    """
    if len(unit) < 3:
        return None
    ends = unit[unit.argmin(axis=0)]
    if np.linalg.matrix_rank(ends) < unit.shape[1]:
        return None
    normal = np.linalg.solve(ends, np.ones(unit.shape[1]))
    depth = (1.0 - unit @ normal) / np.linalg.norm(normal)
    k = int(depth.argmax())
    return k if depth[k] > 1e-9 else None


def neighbours(values: Array, place: int) -> list[int]:
    """Return the points next to one along every objective, one below and one above."""
    found: list[int] = []
    for column in values.T:
        order = np.argsort(column, kind="stable").tolist()
        at = order.index(place)
        found += [k for k in (*order[max(0, at - 1) : at], *order[at + 1 : at + 2])]
    return sorted(set(found))
