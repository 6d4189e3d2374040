"""Measures of a front: dominance, hypervolume, and the distance to a better front."""

import numpy as np
from numpy.typing import NDArray

from gearopt.optimise.terms import Array

TIE = 1e-9  # relative; objectives that differ by less are equal
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
    found = np.empty_like(values)
    for k, column in enumerate(values.T):
        order = np.argsort(column, kind="stable")
        ranked = column[order]
        new = np.diff(ranked) > tie * np.maximum(np.abs(ranked[1:]), np.abs(ranked[:-1]))
        first = np.concatenate([[0], np.flatnonzero(new) + 1])
        found[order, k] = np.repeat(ranked[first], np.diff([*first, len(ranked)]))
    return found


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
