"""Open corners beside known points, below which a point that none beats may still lie.

A point that no known one beats lies below one of the corners (local upper bounds). So a part of a
search is of use only where its lower bounds lie below one; bounds of weighted sums count as well.
Source: Klamroth, Lacour, Vanderpooten, European Journal of Operational Research 245 (2015) 767.
"""

import numpy as np
from numpy.typing import NDArray

from gearopt.optimise.pareto.measures import TIE
from gearopt.optimise.terms import Array

BLOCK = 2_000_000  # comparisons at once


def corners(values: Array, open_: Array) -> Array:
    """Return the corners (n, k) that points (N, k) leave open of corners (m, k).

    Without a point one corner is open, of the largest values that are allowed.
    """
    for point in values[np.argsort(values[:, 0], kind="stable")] if len(values) else ():
        open_ = _without(open_, point)
    return open_


def _without(open_: Array, one: Array) -> Array:
    """Return the corners that another point leaves open."""
    cut = (one < open_).all(axis=1)
    if not cut.any():
        return open_
    left, split = open_[~cut], open_[cut]
    opened = []
    for k in range(len(one)):
        moved = split.copy()
        moved[:, k] = one[k]
        opened.append(moved[_largest(moved, left)])
    return np.vstack([left, *opened])


def _largest(moved: Array, left: Array) -> NDArray[np.int64]:
    """Return which of some corners, that share a coordinate, lie below no other one."""
    kept: list[int] = []
    for i in np.lexsort(-moved.T):
        others = np.vstack([moved[kept], left])
        if not (moved[i] <= others).all(axis=1).any():
            kept.append(int(i))
    return np.array(kept, dtype=np.int64)


def weighed(points: Array, weights: Array) -> Array:
    """Return points (n, k) with their weighted sums behind them (n, k + w); weights (w, k)."""
    with np.errstate(invalid="ignore"):
        sums = [np.where(w > 0.0, points * w, 0.0).sum(axis=1) for w in weights]
    return np.column_stack([points, *sums])


def useful(bounds: Array, open_: Array) -> NDArray[np.bool_]:
    """Return which lower bounds (n, m) lie below one of the corners (L, m); a tie does."""
    below = np.zeros(len(bounds), dtype=bool)
    limits = open_[np.argsort(open_[:, 0], kind="stable")] * (1.0 + TIE)
    some = np.flatnonzero(np.isfinite(bounds).all(axis=1))
    first, last = _range(bounds[some], limits)
    some, first, last = (a[first < last] for a in (some, first, last))
    count = max(1, len(some) * len(open_) * bounds.shape[1] // BLOCK)
    place = np.arange(len(limits))
    for part in np.array_split(np.arange(len(some)), count):
        here = (first[part, None] <= place) & (place < last[part, None])
        for column in range(bounds.shape[1]):
            here &= bounds[some[part], column, None] <= limits[None, :, column]
        below[some[part]] = here.any(axis=1)
    return below


def _range(bounds: Array, limits: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last (left out) corner that each bound can lie below.

    limits: by the first coordinate. Of two objectives the second one falls, as no corner lies
    below another.
    """
    first = np.searchsorted(limits[:, 0], bounds[:, 0])
    last = np.full(len(bounds), len(limits))
    if (limits[1:, 1] <= limits[:-1, 1]).all():
        last = np.searchsorted(-limits[:, 1], -bounds[:, 1], side="right")
    return first, last
