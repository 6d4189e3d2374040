"""The least depth of a rectangle of given width that can hold discs: a lower bound.

Discs of radius rho in a strip of width w, y across its depth. Every bound falls as w grows:

- area: w d >= sum pi rho^2;
- Oler's inequality for points at least D apart in a convex set (Acta Math. 105, 1961),
  N <= 2 A/(sqrt 3 D^2) + P/(2 D) + 1, applied to the axes of all discs of radius >= D/2;
- order: two axes are at most s = w - rho_i - rho_j apart across, so at least sqrt(D^2 - s^2) along;
  three of them have a least span; the least over all orders of the longest chain of these.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import numpy as np

from gearopt.optimise.terms import Array

ORDERS = 300  # of the kinds of discs along the depth; beyond it the bound by order is left out
SLIPS = 4e-15  # relative; more than the roundings of a distance across
LARGEST = 8  # discs whose pairs count where the order is left out; small ones add nothing
HALVINGS = 40  # of the one-dimensional search of a triple: to 1e-12 of a width


Late = Callable[[], bool]


def never() -> bool:
    """Late: a bound that nothing hurries."""
    return False


def always() -> bool:
    """Late: a bound without the orders."""
    return True


def depth(radii: Sequence[float], w: Array, late: Late = never) -> Array:
    """Lower bound on the depth that discs of these radii need at widths w >= 2 max(radii), (m,).

    late: asked while the orders are looked at; once it says so the bound is the one without them.
    """
    rho = np.sort(np.asarray(radii, float))[::-1]
    found = np.maximum(2.0 * rho[0], math.pi * float((rho**2).sum()) / w)
    for least in np.unique(rho):
        found = np.maximum(found, _oler(2.0 * least, int((rho >= least).sum()), w))
    by_order = _by_order(rho, w, late) if orders_of(rho) <= ORDERS else None
    if by_order is not None:
        return np.asarray(np.maximum(found, by_order))
    for a, b in _kinds_of_pairs(rho[:LARGEST]):
        found = np.maximum(found, a + b + _pair(a, b, w))
    return np.asarray(found)


def orders_of(rho: Array) -> float:
    """Number of different orders of discs."""
    counts = np.unique(rho, return_counts=True)[1]
    if len(rho) > 20:
        return math.inf
    return math.factorial(len(rho)) / math.prod(math.factorial(int(c)) for c in counts)


def _kinds_of_pairs(rho: Array) -> set[tuple[float, float]]:
    return {(float(a), float(b)) for a, b in combinations(rho, 2)}


def _oler(apart: float, count: int, w: Array) -> Array:
    a = np.maximum(w - apart, 0.0) / apart
    b = (count - 1 - a) / (2.0 / math.sqrt(3.0) * a + 1.0)
    return np.asarray(apart * (1.0 + np.maximum(b, 0.0)))


def _along(apart: float, across: Array) -> Array:
    """Distance along of two axes `apart` from each other and `across` apart across; rounded down.

    The root is steep where the two are equal: an error of 1e-16 there would be 1e-8 along.
    """
    least = apart - across - SLIPS * (apart + across)
    return np.asarray(np.sqrt(np.maximum(least * (apart + across), 0.0)))


def _pair(a: float, b: float, w: Array) -> Array:
    return _along(a + b, w - a - b)


def _triple(a: float, b: float, c: float, w: Array) -> Array:
    """Least distance along from the first to the last of three discs in this order.

    Across, the middle one lies between the others (u + v <= their most), or beside both.
    """
    ab, bc, ac = w - a - b, w - b - c, w - a - c
    between = np.full(w.shape, np.inf)
    for u in (np.maximum(ac - bc, 0.0), np.minimum(ab, ac), np.clip(a + b, 0.0, ac), ac - (b + c)):
        inside = np.clip(u, np.maximum(ac - bc, 0.0), np.minimum(ab, ac))
        between = np.minimum(between, _along(a + b, inside) + _along(b + c, ac - inside))
    between = np.maximum(between, _along(a + c, ac))
    beside = np.minimum(_beside(a + c, a + b, b + c, ab, bc), _beside(a + c, b + c, a + b, bc, ab))
    return np.asarray(np.minimum(between, beside))


def _beside(outer: float, first: float, second: float, most: Array, other: Array) -> Array:
    """The same where the middle one is `most` across from one and at most `other` from the other.

    With v from 0 to the less of them, the outer distance grows and the sum of the inner ones falls.
    """
    low, high = np.zeros(most.shape), np.minimum(most, other)
    fixed = _along(first, most)
    for _ in range(HALVINGS):
        v = 0.5 * (low + high)
        rising = _along(outer, most - v) < fixed + _along(second, v)
        low, high = np.where(rising, v, low), np.where(rising, high, v)
    return np.asarray(np.maximum(_along(outer, most - low), fixed + _along(second, high)))


def _by_order(rho: Array, w: Array, late: Late) -> Array | None:
    """The least over all orders of the longest chain of distances along; None once it is late."""
    pair: Callable[..., Array] = _kept(_pair, w)
    triple: Callable[..., Array] = _kept(_triple, w)
    least = np.full(w.shape, np.inf)
    for order in orders(sorted(rho.tolist())):
        if order > order[::-1]:
            continue  # the mirror image
        ends: list[Array] = []
        for k, c in enumerate(order):
            at = np.full(w.shape, c)
            for j, a in enumerate(order[:k]):
                if late():
                    return None
                step = pair(a, c)
                for b in set(order[j + 1 : k]):
                    step = np.maximum(step, triple(a, b, c))
                at = np.maximum(at, ends[j] + step)
            ends.append(at)
        deepest = np.max([e + c for e, c in zip(ends, order, strict=True)], axis=0)
        least = np.minimum(least, deepest)
    return least


def _kept(law: Callable[..., Array], w: Array) -> Callable[..., Array]:
    """A law at fixed widths, each of its values computed once."""
    known: dict[tuple[float, ...], Array] = {}

    def value(*radii: float) -> Array:
        if radii not in known:
            known[radii] = law(*radii, w)
        return known[radii]

    return value


def orders(items: list[float]) -> Iterator[tuple[float, ...]]:
    """Every different order of some items, each once."""
    if not items:
        yield ()
    for item in dict.fromkeys(items):
        rest = items.copy()
        rest.remove(item)
        for tail in orders(rest):
            yield (item, *tail)
