"""Finite bounds of the canonical columns by interval reasoning, rounded outwards.

Epigraph variables have no bounds of their own; a dual bound needs them. They follow from the rows,
the cones, and from the wish to be no worse than a design that is known.
"""

from typing import Any

import numpy as np

from gearopt.optimise.conic.canonical import Canonical
from gearopt.optimise.terms import Array

PASSES = 12  # a chain of epigraphs longer than that is rare; looser bounds stay valid
EPSILON = 2.3e-16
CONTRADICTION = 1e-9  # relative crossing of two bounds that proves emptiness
MARGIN = 1e-5  # relative; a contradiction of bound and point shows up to here
ENOUGH = 0.01  # a pass that narrows no column by this share is the last


def cutoff(value: float) -> float:
    """A cost a little above that of a known point, whose rows may be violated a little."""
    return value + MARGIN * abs(value)


def propagate(
    data: Canonical, lower: Array, upper: Array, most: float = np.inf
) -> tuple[Array, Array] | None:
    """Bounds (n,), (n,) of all points of the box that are feasible and cost at most `most`.

    None: there are none.
    """
    low, high, empty = narrowed(data, lower, upper, most)
    return None if empty else (low, high)


@np.errstate(all="ignore")
def narrowed(
    data: Canonical, lower: Array, upper: Array, most: float = np.inf
) -> tuple[Array, Array, bool]:
    """The same bounds, and whether they cross; then they are those before, which still hold.

    Interval evaluation of A x + s = b, s in K, c.x + d <= most.
    """
    row, column, value = data.entries
    priced = np.flatnonzero(data.c)
    size = len(data.b)
    row = np.concatenate([row, np.full(len(priced), size)])
    column = np.concatenate([column, priced])
    value = np.concatenate([value, data.c[priced]])
    b = np.append(data.b, most - data.d + EPSILON * 4 * (abs(most) + abs(data.d)))
    rounding = EPSILON * (10.0 + np.bincount(row, minlength=size + 1))
    low, high = lower.copy(), upper.copy()
    for _ in range(PASSES):
        if not _to_allowed(data, low, high):
            return low, high, True
        at_low, at_high = value * low[column], value * high[column]
        small, large = np.minimum(at_low, at_high), np.maximum(at_low, at_high)
        below, below_inf, size_below = _sums(row, small, size + 1)
        above, above_inf, size_above = _sums(row, large, size + 1)
        error = rounding * (size_below + size_above + np.abs(b))
        s_low = np.where(above_inf > 0, -np.inf, b - above - error)
        s_high = np.where(below_inf > 0, np.inf, b - below + error)
        _cones(data, s_low, s_high)
        s_low[size] = 0.0
        if (s_low > s_high + CONTRADICTION * (np.abs(s_low) + np.abs(b)) + error).any():
            return low, high, True
        rest_low = _rest(row, small, below, below_inf, -np.inf)
        rest_high = _rest(row, large, above, above_inf, np.inf)
        extra = (rounding * 2)[row] * (size_below + size_above + np.abs(b))[row]
        top = (b - s_low)[row] - rest_low + extra
        bottom = (b - s_high)[row] - rest_high - extra
        first, second = bottom / value, top / value
        new_low, new_high = low.copy(), high.copy()
        _tighten(np.maximum, new_low, column, np.where(value > 0, first, second), -1.0)
        _tighten(np.minimum, new_high, column, np.where(value > 0, second, first), 1.0)
        scale = np.maximum(np.abs(new_low), np.abs(new_high))
        crossed = new_low > new_high
        empty = (new_low > new_high + CONTRADICTION * scale).any()
        new_low[crossed], new_high[crossed] = new_high[crossed], new_low[crossed]
        if empty:
            return new_low, new_high, True
        width = high - low
        finer = np.isfinite(new_low) & ~np.isfinite(low)
        finer |= np.isfinite(new_high) & ~np.isfinite(high)
        finer |= np.isfinite(width) & (new_high - new_low < (1.0 - ENOUGH) * width)
        low, high = new_low, new_high
        if not finer.any():
            break
    return low, high, False


def _to_allowed(data: Canonical, low: Array, high: Array) -> bool:
    """Move the bounds of discrete columns, in place, to allowed values; False if none is left."""
    for column, allowed in data.allowed.items():
        slack = CONTRADICTION * (1.0 + np.abs(allowed))
        kept = allowed[(allowed >= low[column] - slack) & (allowed <= high[column] + slack)]
        if not len(kept):
            return False
        low[column], high[column] = kept[0], kept[-1]
    return True


def _sums(row: Any, terms: Array, count: int) -> tuple[Any, Any, Any]:
    """Sum of the finite terms of each row, number of infinite ones, sum of magnitudes."""
    finite = np.isfinite(terms)
    kept = np.where(finite, terms, 0.0)
    return (
        np.bincount(row, kept, count),
        np.bincount(row, ~finite, count),
        np.bincount(row, np.abs(kept), count),
    )


def _rest(row: Any, terms: Array, total: Array, infinite: Any, bad: float) -> Array:
    """Each row's sum without the entry itself; `bad` where another entry is infinite."""
    finite = np.isfinite(terms)
    others = infinite[row] - ~finite
    return np.where(others > 0, bad, total[row] - np.where(finite, terms, 0.0))


def _tighten(better: np.ufunc, bound: Array, column: Any, found: Array, out: float) -> None:
    """Improve bounds in place by what was found, rounded outwards; NaN improves nothing."""
    found = np.where(np.isnan(found), out * np.inf, found + out * EPSILON * np.abs(found))
    better.at(bound, column, found)


def _cones(data: Canonical, low: Array, high: Array) -> None:
    """Tighten the intervals of the slacks, in place, by what the cones say of them."""
    low[: data.zero] = np.maximum(low[: data.zero], 0.0)
    high[: data.zero] = np.minimum(high[: data.zero], 0.0)
    end = data.zero + data.nonneg
    low[data.zero : end] = np.maximum(low[data.zero : end], 0.0)
    out = 1.0 + 1e-13  # outwards, for the roots and squares below
    for block in data.blocks:
        k, rest = block.start, slice(block.start + 1 + block.rotated, block.start + block.size)
        near = np.maximum(0.0, np.maximum(low[rest], -high[rest]))
        square = float((near**2).sum()) / out
        low[k] = max(low[k], 0.0)
        if block.rotated:
            low[k + 1] = max(low[k + 1], 0.0)
            low[k] = max(low[k], square / high[k + 1] / out if square else 0.0)
            low[k + 1] = max(low[k + 1], square / high[k] / out if square else 0.0)
            reach = np.sqrt(high[k] * high[k + 1]) * out
            reach = np.inf if np.isnan(reach) else reach
        else:
            low[k] = max(low[k], np.sqrt(square) / out)
            reach = high[k] * out
        low[rest] = np.maximum(low[rest], -reach)
        high[rest] = np.minimum(high[rest], reach)
