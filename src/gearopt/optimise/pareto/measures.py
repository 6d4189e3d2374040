"""Measures of a front: dominance, hypervolume, and the distance to a better front.

One design is picked with its reason: the knee, the compromise, the best of given weights.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

TIE = 1e-9  # relative; objectives that differ by less are equal
DECADES = 2.0  # that an objective spans from which on picks measure it by its logarithm
ZERO = 1e-6  # of the next larger value of an objective along a front: no more than a rounding
REFERENCE_AT = 1.05  # of the way from the ideal point to the nadir point: the reference point


def unbeaten(values: Array, tie: float = TIE, equal: bool = False) -> NDArray[np.int64]:
    """Return the rows of values (N, k) that no other row beats, by the first objective.

    A row is beaten by one that is at most as large in every objective and smaller in one; of equal
    rows the first is kept, or all (`equal`). Those within `tie` of each other, relative, are equal.
    """
    from moocore import is_nondominated

    if not len(values):
        return np.empty(0, dtype=np.int64)
    merged = _merged(values, tie)
    kept = np.flatnonzero(is_nondominated(merged, keep_weakly=equal))
    return np.asarray(kept[np.argsort(merged[kept, 0], kind="stable")])


def _merged(values: Array, tie: float) -> Array:
    """Return values of which neighbours within a tie are made equal to the least of them."""
    merged = np.empty_like(values)
    for k, column in enumerate(values.T):
        order = np.argsort(column, kind="stable")
        ranked = column[order]
        new = np.diff(ranked) > tie * np.maximum(np.abs(ranked[1:]), np.abs(ranked[:-1]))
        first = np.concatenate([[0], np.flatnonzero(new) + 1])
        merged[order, k] = np.repeat(ranked[first], np.diff([*first, len(ranked)]))
    return merged


def ideal(values: Array) -> Array:
    """Return the least of every objective (k,) over points (N, k)."""
    return np.asarray(values.min(axis=0))


def nadir(values: Array) -> Array:
    """Return the largest of every objective (k,) over the points (N, k) of a front."""
    return np.asarray(values.max(axis=0))


def reference(front: Array) -> Array:
    """Return the point (k,) from which the hypervolume of a front (N, k) is measured.

    An objective that is the same all along the front counts as ranging over its own size.
    """
    low, high = ideal(front), nadir(front)
    width = high - low
    size = np.where(low == 0.0, 1.0, np.abs(low))
    return np.asarray(np.where(width > 0.0, low + REFERENCE_AT * width, low + size))


def hypervolume(values: Array, corner: Array) -> float:
    """Return the volume that points (N, k) beat, up to a corner (k,); 0 without a point in it."""
    from moocore import hypervolume as volume

    inside = values[(values < corner).all(axis=1)] if len(values) else values
    return float(volume(inside, ref=corner)) if len(inside) else 0.0


def igd(values: Array, front: Array) -> float:
    """Return the mean distance of a front's points to the nearest of points (N, k), in its ranges.

    Inverted generational distance plus: only what is worse than the front counts. inf: no points.
    """
    from moocore import igd_plus

    if not len(values):
        return float("inf")
    low, width = ideal(front), nadir(front) - ideal(front)
    width = np.where(width > 0.0, width, 1.0)
    return float(igd_plus((values - low) / width, ref=(front - low) / width))


KNEE, COMPROMISE, WEIGHTS = "knee", "compromise", "weights"


@dataclass(frozen=True)
class Pick:
    """Place of a point in a front (from 0), which rule took it, and the reason in words.

    decades: names of the objectives that are measured by their logarithms. weights: of all
    objectives, in their order, where they decide.
    """

    place: int
    rule: str
    reason: str
    decades: tuple[str, ...] = ()
    weights: tuple[float, ...] = ()


def picks(values: Array, names: Sequence[str], weights: Mapping[str, float] | None) -> list[Pick]:
    """Return the designs of a front (N, k) that rules take; that of weights first, if given."""
    if not len(values):
        return []
    unit = scaled(values)
    wide = tuple(n for n, log in zip(names, by_decades(values), strict=True) if log)
    parts = by_parts(values)
    picked = []
    if weights is not None:
        w = tuple(float(weights.get(name, 0.0)) for name in names)
        reason = "the minimum weighted sum of the normalised objectives"
        picked.append(Pick(int((unit @ np.array(w)).argmin()), WEIGHTS, reason, wide, w))
    sizes, scale = (unit, "") if parts is None else (parts, ", in logarithms")
    if (k := knee(sizes)) is not None:
        reason = "the point furthest below the straight line between the ends of the front"
        picked.append(Pick(k, KNEE, f"{reason}{scale}", wide))
    near = int(np.linalg.norm(sizes, axis=1).argmin())
    reason = "the point nearest to the ideal point, in normalised objectives"
    if parts is not None:
        reason = "the point nearest to the least value of every objective, per cent for per cent"
    picked.append(Pick(near, COMPROMISE, reason, wide))
    return picked


def by_parts(values: Array) -> Array | None:
    """Return ln(value/least value) of objectives (N, k): equal parts more of each count alike.

    None where an objective is not positive, or spans more than DECADES, so that parts of it are not
    what a designer weighs.
    """
    low = ideal(values)
    if (low <= 0.0).any() or by_decades(values).any():
        return None
    return np.asarray(np.log(values / low))


def scaled(values: Array) -> Array:
    """Return values (N, k) from 0, the least of an objective on the front, to 1, its largest.

    Of an objective that spans more than two decades, its logarithms, zeros as its least value.
    """
    floors, values = least_sizes(values), values.astype(float)
    some = by_decades(values)
    values[:, some] = np.log10(np.maximum(values, floors)[:, some])
    width = nadir(values) - ideal(values)
    return np.asarray((values - ideal(values)) / np.where(width > 0.0, width, 1.0))


def by_decades(values: Array) -> NDArray[np.bool_]:
    """Which objectives (k,) of a front (N, k) span more than DECADES, none of them negative."""
    floors = least_sizes(values)
    return np.asarray((ideal(values) >= 0.0) & (nadir(values) > 10.0**DECADES * floors))


def least_sizes(values: Array) -> Array:
    """Least value above zero of every objective (k,): what is ZERO beside the next one is zero."""
    floors = np.full(values.shape[1], np.inf)
    for k, column in enumerate(values.T):
        sizes = np.sort(column[column > 0.0])
        far = np.flatnonzero(sizes[:-1] < ZERO * sizes[1:])
        if len(sizes):
            floors[k] = sizes[far[-1] + 1 if len(far) else 0]
    return floors


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
    places: list[int] = []
    for column in values.T:
        order = np.argsort(column, kind="stable").tolist()
        at = order.index(place)
        places += [k for k in (*order[max(0, at - 1) : at], *order[at + 1 : at + 2])]
    return sorted(set(places))
