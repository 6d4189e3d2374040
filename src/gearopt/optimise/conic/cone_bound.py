"""Proofs by multipliers of the canonical rows: a lower bound, or that nothing is feasible.

With y in the dual cone, y.(b - A x) >= 0 for every feasible x. Hence cost(x) is at least
cost(x) + y.(A x - b), a convex function, which on a box is at least its value at any point plus the
minimum of its linear part there. Rounding of every term is taken off; the cone is entered strictly.

Epigraph variables have no bounds of their own. They follow by interval reasoning, rounded outwards,
from the rows, the cones, and from the wish to be no worse than a design that is known.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.conic.canonical import Canonical
from gearopt.optimise.terms import Array

PASSES = 12  # a chain of epigraphs longer than that is rare; looser bounds stay valid
EPSILON = 2.3e-16
CONTRADICTION = 1e-9  # relative crossing of two bounds that proves emptiness
MARGIN = 1e-5  # relative; a contradiction of bound and point shows up to here
LEAST_NARROWING = 0.01  # a pass that narrows no column by this share is the last


def cutoff(value: float) -> float:
    """Return A cost a little above that of a known point, whose rows may be violated a little."""
    return value + MARGIN * abs(value)


def propagate(
    data: Canonical, lower: Array, upper: Array, most: float = np.inf
) -> tuple[Array, Array] | None:
    """Return bounds (n,), (n,) of all feasible points of the box that cost at most `most`.

    None: there are none.
    """
    low, high, empty = narrowed(data, lower, upper, most)
    return None if empty else (low, high)


@np.errstate(all="ignore")
def narrowed(
    data: Canonical, lower: Array, upper: Array, most: float = np.inf
) -> tuple[Array, Array, bool]:
    """Return the same bounds, and whether they cross; then they are the previous ones.

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
        finer |= np.isfinite(width) & (new_high - new_low < (1.0 - LEAST_NARROWING) * width)
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
    """Return sum of the finite terms of each row, number of infinite ones, sum of magnitudes."""
    finite = np.isfinite(terms)
    kept = np.where(finite, terms, 0.0)
    return (
        np.bincount(row, kept, count),
        np.bincount(row, ~finite, count),
        np.bincount(row, np.abs(kept), count),
    )


def _rest(row: Any, terms: Array, total: Array, infinite: Any, bad: float) -> Array:
    """Return each row's sum without the entry itself; `bad` where another entry is infinite."""
    finite = np.isfinite(terms)
    others = infinite[row] - ~finite
    return np.where(others > 0, bad, total[row] - np.where(finite, terms, 0.0))


def _tighten(better: np.ufunc, bound: Array, column: Any, found: Array, out: float) -> None:
    """Improve bounds in place by new ones, rounded outwards; NaN improves nothing."""
    found = np.where(np.isnan(found), out * np.inf, found + out * EPSILON * np.abs(found))
    better.at(bound, column, found)


def _cones(data: Canonical, low: Array, high: Array) -> None:
    """Tighten the intervals of the slacks, in place, by the cones."""
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


ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound
STRICT = 4e-15  # share by which a multiplier is moved into its cone, for the rounding of norms


@dataclass(frozen=True)
class Leaf:
    """One part of the box and the claim about it: `solve` certifies a list of them.

    lower, upper (n,): canonical columns, discrete ones at allowed values. x (n,): where the cost
    is expanded. y (m,): multipliers. ray: they are to prove that the part is empty.
    """

    lower: Array
    upper: Array
    x: Array
    y: Array | None
    ray: bool = False


@dataclass(frozen=True)
class Proof:
    """Proof by multipliers on a box.

    least: no feasible point of the box has a lower cost. charge, slack: what it lost to the
    gradient that is left and to rows off their limit, in units of the cost. weights (m,): the
    multipliers used.
    """

    least: float
    charge: float
    slack: float
    weights: Array


def inside(data: Canonical, y: Array) -> Array:
    """Return multipliers moved into the dual cone, strictly; NaN becomes 0.

    Of p q >= |w|^2 the dual is 4 y_p y_q >= |y_w|^2.
    """
    y = np.where(np.isfinite(y), y, 0.0)
    end = data.zero + data.nonneg
    y[data.zero : end] = np.maximum(y[data.zero : end], 0.0)
    for block in data.blocks:
        k, rest = block.start, slice(block.start + 1 + block.rotated, block.start + block.size)
        y[k] = max(y[k], 0.0)
        norm = math.sqrt(float(y[rest] @ y[rest])) * (1.0 + STRICT * 0.25)
        if block.rotated:
            y[k + 1] = max(y[k + 1], 0.0)
            reach = 2.0 * math.sqrt(y[k]) * math.sqrt(y[k + 1])
        else:
            reach = y[k]
        if norm > reach * (1.0 - STRICT):
            y[rest] *= reach / norm * (1.0 - STRICT)
    return y


@np.errstate(all="ignore")
def lagrangian(
    data: Canonical, low: Array, high: Array, x: Array, y: Array, priced: bool = True
) -> Proof:
    """Return the minimum of cost(x) + y.(A x - b) on the box; priced=False: without cost.

    low, high (n,): finite where the gradient is not zero, else the bound is -inf.
    """
    x = np.clip(np.where(np.isfinite(x), x, 0.0), low, high)
    y = inside(data, y)
    row, column, value = data.entries
    c, P = (data.c, data.P) if priced else (0.0 * data.c, 0.0 * data.P)
    product = value * y[row]
    gradient = c + P @ x + np.bincount(column, product, len(x))
    sizes = np.abs(c) + abs(P) @ np.abs(x) + np.bincount(column, np.abs(product), len(x))
    weighted = y * data.b
    at = c @ x + 0.5 * x @ (P @ x) + np.bincount(column, product, len(x)) @ x - weighted.sum()
    reach = np.maximum(np.abs(high - x), np.abs(low - x))
    loss = np.where(gradient == 0.0, 0.0, np.minimum(gradient * (low - x), gradient * (high - x)))
    error = np.where(sizes == 0.0, 0.0, sizes * np.maximum(reach, np.abs(x)))
    allowance = (
        ROUNDING * (1.0 + max(len(x), len(y)) / 100.0) * (error.sum() + np.abs(weighted).sum())
    )
    shortfall, unit = data.convexity
    if priced and shortfall:
        allowance += 0.5 * shortfall * float(((reach / unit)[P.diagonal() != 0] ** 2).sum())
    offset = data.d if priced else 0.0
    least = at + offset + loss.sum() - allowance - ROUNDING * abs(offset)
    cost = c @ x + 0.5 * x @ (P @ x)
    proven = -math.inf if math.isnan(least) else float(least)
    return Proof(proven, float(-loss.sum()), abs(float(cost - at)), y)


@np.errstate(all="ignore")
def emptiness(data: Canonical, low: Array, high: Array, x: Array, y: Array) -> float:
    """Return by how much the user's rows must be widened together for a point to exist.

    Proven where it is positive; -inf where nothing is known.
    """
    proof = lagrangian(data, low, high, x, y, priced=False)
    weights = np.abs(proof.weights)
    total = weights[data.label >= 0].sum()
    scale = total if total > 0 else float(weights @ (1.0 + np.abs(data.b)))
    return proof.least / scale if scale > 0 and math.isfinite(proof.least) else -math.inf
