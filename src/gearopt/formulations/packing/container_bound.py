"""A lower bound on the objective of any packing, computed here and valid for every choice.

Every way to assign the cylinders to layers is examined, by the counts of each kind. Its
height is exact; the plan must hold each layer, so its area is at least the minimum of w d(w) with
d(w) the maximum that any layer needs (`depth`), found by subdivision: on [a, b] w d(w) >= a d(b).

The depth of a rectangle of width w that holds discs of radius rho, y across it, is bounded by
`depth`; each of its bounds falls as w grows:

- area: w d >= sum pi rho^2;
- Oler's inequality for points at least D apart in a convex set (Acta Math. 105, 1961),
  N <= 2 A/(sqrt 3 D^2) + P/(2 D) + 1, applied to the axes of all discs of radius >= D/2;
- order: two axes are at most s = w - rho_i - rho_j apart across, so at least sqrt(D^2 - s^2) along;
  three of them have a minimum span; the minimum over all orders of the longest chain of these.

Discs are grown by half the gap, so that the container's inside is its size less 2 wall - gap.

The bound is valid after every step: a stopped computation returns what it has proven.
"""

import heapq
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, product

import numpy as np

from gearopt.formulations.packing.plan import Plan, minimum_layers
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

CHOICES = 3000  # ways to assign the cylinders; beyond them the bound is the volume of the cylinders
TIGHT = 1e-9  # relative; how near to its infimum the subdivision takes the bound
ROUNDING = 1e-12  # relative, taken off every bound: some thousand roundings
CELLS = 20_000  # of a subdivision, which then ends with what it has proven
ORDERS = 300  # of the kinds of discs along the depth; beyond it the bound by order is left out
SLIPS = 4e-15  # relative; more than the roundings of a distance across
LARGEST = 8  # discs whose pairs count where the order is left out; small ones add nothing
HALVINGS = 40  # of the one-dimensional search of a triple: to 1e-12 of a width
Layer = tuple[float, ...]  # grown radii
Need = Callable[[Array], Array]  # depth at widths
Late = Callable[[], bool]


def never() -> bool:
    """Return False: nothing hurries the bound."""
    return False


def always() -> bool:
    """Return True: the bound is to be the one without the orders."""
    return True


@dataclass(frozen=True)
class Bound:
    """A lower bound on the objective of all packings of a plan.

    choices: number of ways to assign the cylinders; 0: too many. complete: all that can be best
    were examined to the end.
    """

    value: float
    choices: int
    complete: bool = True


def bound(plan: Plan, late: Late = never) -> Bound:
    """Return the bound of a plan; late, asked often, stops the work with a weaker bound."""
    kinds = _kinds(plan)
    free = [n for (_, _, layer), n in kinds.items() if not layer]
    if math.prod(math.comb(n + plan.max_layers - 1, plan.max_layers - 1) for n in free) > CHOICES:
        return Bound(_coarse(plan) * (1.0 - ROUNDING), 0)
    ways = [_described(plan, layers) for layers in set(_ways(plan, kinds))]
    heap = [(tall * _quick(plan, discs), 0, k) for k, (tall, discs) in enumerate(ways)]
    heapq.heapify(heap)
    best = math.inf
    while heap[0][1] < 2:  # the way with the lowest bound is examined ever more closely
        value, looked, k = heap[0]
        if late():
            known = max(value, _coarse(plan)) * (1.0 - ROUNDING)
            return Bound(known, len(ways), complete=False)
        tall, discs = ways[k]
        last = looked == 1 or not _ordered(plan, discs)
        area = _area(plan, discs, best / tall, late, thorough=last)
        value = max(value, tall * area)
        best = min(best, value) if last else best
        heapq.heapreplace(heap, (value, 2 if last else 1, k))
    return Bound(heap[0][0] * (1.0 - ROUNDING), len(ways))


def _described(
    plan: Plan, layers: tuple[tuple[tuple[float, float], ...], ...]
) -> tuple[float, tuple[Layer, ...]]:
    """Return the height that counts and the different layers of discs of an assignment."""
    tall = sum(max((h for _, h in layer), default=0.0) for layer in layers)
    discs = {tuple(sorted(r for r, _ in layer)) for layer in layers if layer}
    return tall if plan.objective == "volume" else 1.0, tuple(sorted(discs))


def _ordered(plan: Plan, discs: tuple[Layer, ...]) -> bool:
    """Return whether orders of discs count in some layer, so that examining them helps."""
    few = any(len(layer) > 1 and orders_of(np.array(layer)) <= ORDERS for layer in discs)
    return plan.shape != "circle" and few


def _kinds(plan: Plan) -> dict[tuple[float, float, int], int]:
    """Return the number of cylinders of each grown radius, height and layer (0: free)."""
    counts: dict[tuple[float, float, int], int] = {}
    for c in plan.cylinders:
        layer = 0 if plan.max_layers > 1 and c.layer is None else c.layer or 1
        kind = (c.radius + 0.5 * plan.gap, c.height, layer)
        counts[kind] = counts.get(kind, 0) + 1
    return counts


def _ways(
    plan: Plan, kinds: dict[tuple[float, float, int], int]
) -> Iterator[tuple[tuple[tuple[float, float], ...], ...]]:
    """Yield every assignment: (radius, height) of the cylinders of each layer, in any order.

    Layers that need not hold one may be taken in any order, so that the first one always does.
    """
    needed = minimum_layers(plan)  # by fixed places that overlap
    shares = [
        [tuple(n * (k == layer) for k in range(1, plan.max_layers + 1))]
        if layer
        else list(_shares(n, plan.max_layers))
        for (_, _, layer), n in kinds.items()
    ]
    for chosen in product(*shares):
        layers = [
            tuple(
                (r, h)
                for (r, h, _), share in zip(kinds, chosen, strict=True)
                for _ in range(share[k])
            )
            for k in range(plan.max_layers)
        ]
        if all(layers[: plan.filled]) and sum(map(bool, layers)) >= needed:
            yield tuple(sorted(layers))


def _shares(count: int, layers: int) -> Iterator[tuple[int, ...]]:
    """Yield every way to write a count as a sum over layers."""
    if layers == 1:
        yield (count,)
        return
    for here in range(count + 1):
        for rest in _shares(count - here, layers - 1):
            yield (here, *rest)


def _coarse(plan: Plan) -> float:
    """Return the bound without assignments: all volumes, and the widest and highest cylinder."""
    area = math.pi * plan.radius**2
    widest = _quick(plan, ((float(plan.radius.max() + 0.5 * plan.gap),),))
    if plan.objective == "area":
        return max(float(area.sum()) / plan.max_layers, widest)
    return max(float((area * plan.height).sum()), widest * float(plan.height.max()))


def _spare(plan: Plan) -> float:
    """Return the size of the container less that of the inside of grown discs."""
    return 2.0 * plan.wall - plan.gap


def _held(plan: Plan) -> tuple[float, float]:
    """Return the inside width and depth that the fixed cylinders take."""
    low, high, near, far = plan.held_box
    grown = plan.gap if plan.fixed else 0.0
    return high - low + grown, far - near + grown


def _quick(plan: Plan, layers: tuple[Layer, ...]) -> float:
    """Return the area of the container around the largest disc."""
    size = 2.0 * max(max(layer) for layer in layers) + _spare(plan)
    if plan.shape == "circle":
        return 0.25 * math.pi * size**2
    return size * (size if plan.width is None else plan.width)


def _area(
    plan: Plan, layers: tuple[Layer, ...], enough: float, late: Late, thorough: bool
) -> float:
    """Return the minimum area of the container of some layers (any of them alone needs no more).

    enough: an area beyond which the answer need not be exact. thorough: orders count too.
    """
    if plan.shape == "circle":
        return math.pi * _circle(plan, layers) ** 2
    spare, (across, along) = _spare(plan), _held(plan)
    widest = 2.0 * max(max(layer) for layer in layers)

    def need(w: Array) -> Array:
        hurry = late if thorough else always
        return np.asarray(np.max([depth(layer, w, hurry) for layer in layers], axis=0))

    if plan.width is not None:
        deep = max(along, float(need(np.array([plan.width - spare]))[0]))
        return plan.width * (deep + spare)
    if plan.shape == "square":
        return float(_square_side(need, max(widest, across, along), late) + spare) ** 2
    return min(
        _rectangle(need, max(widest, a), max(widest, b), spare, enough, late)
        for a, b in {(across, along), (along, across)}
    )


def _square_side(need: Need, minimum: float, late: Late) -> float:
    """Return a lower bound on the side at which a square is deep enough."""
    low, high = minimum, max(minimum, float(need(np.array([minimum]))[0]))
    if high <= minimum:
        return minimum
    while high - low > TIGHT * high and not late():
        middle = 0.5 * (low + high)
        enough = float(need(np.array([middle]))[0]) <= middle
        low, high = (low, middle) if enough else (middle, high)
    return low


def _rectangle(
    need: Need, across: float, along: float, spare: float, enough: float, late: Late
) -> float:
    """Return the minimum area of a rectangle, not wider than deep, of across by along or more."""

    def deep(w: Array) -> Array:
        return np.asarray(np.maximum(np.maximum(need(w), along), w) + spare)

    first = np.array([across])
    minimum = float((first + spare)[0] * deep(first)[0])
    edge = np.linspace(across, max(across, math.sqrt(minimum) - spare), 65)
    low, high = edge[:-1], edge[1:]
    proven = math.inf
    while len(low):
        deepest = np.maximum(need(high), along)  # these fall as w grows, w itself rises
        values = np.maximum(deepest, high) + spare
        minimum = min(minimum, float(((high + spare) * values).min()))
        floor = (low + spare) * (np.maximum(deepest, low) + spare)
        open_ = floor < min(enough, minimum * (1.0 - TIGHT))
        proven = min(proven, float(floor[~open_].min(initial=math.inf)))
        low, high, floor = low[open_], high[open_], floor[open_]
        if len(low) > CELLS or late():
            return min(proven, minimum, float(floor.min(initial=math.inf)))
        middle = 0.5 * (low + high)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return min(proven, minimum)


def _circle(plan: Plan, layers: tuple[Layer, ...]) -> float:
    """Minimum radius of a circle by discs, pairs, Oler's inequality and fixed cylinders."""
    inside = 0.0
    for layer in layers:
        rho = np.sort(np.array(layer))[::-1]
        inside = max(inside, float(rho[:2].sum()), math.sqrt(float((rho**2).sum())))
        for smallest in np.unique(rho):
            count = int((rho >= smallest).sum())
            # 2 pi q^2/sqrt(3) + pi q + 1 >= count with q = (R - rho)/(2 rho)
            a = 2.0 * math.pi / math.sqrt(3.0)
            q = (-math.pi + math.sqrt(math.pi**2 + 4.0 * a * (count - 1))) / (2.0 * a)
            inside = max(inside, float(smallest * (1.0 + 2.0 * q)))
    inside = max(inside, 0.5 * max(_held(plan)))
    return inside + 0.5 * _spare(plan)


def depth(radii: Sequence[float], w: Array, late: Late = never) -> Array:
    """Return a lower bound on the depth of discs of these radii at widths w >= 2 max(radii), (m,).

    late: asked while the orders are examined; once it is true the bound is the one without them.
    """
    rho = np.sort(np.asarray(radii, float))[::-1]
    lower = np.maximum(2.0 * rho[0], math.pi * float((rho**2).sum()) / w)
    for smallest in np.unique(rho):
        lower = np.maximum(lower, _oler(2.0 * smallest, int((rho >= smallest).sum()), w))
    by_order = _by_order(rho, w, late) if orders_of(rho) <= ORDERS else None
    if by_order is not None:
        return np.asarray(np.maximum(lower, by_order))
    for a, b in _kinds_of_pairs(rho[:LARGEST]):
        lower = np.maximum(lower, a + b + _pair(a, b, w))
    return np.asarray(lower)


def orders_of(rho: Array) -> float:
    """Return the number of different orders of discs."""
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
    """Return the distance along of two axes, `apart` in all and `across` across; rounded down.

    The root is steep where the two are equal: an error of 1e-16 there would be 1e-8 along.
    """
    difference = apart - across - SLIPS * (apart + across)
    return np.asarray(np.sqrt(np.maximum(difference * (apart + across), 0.0)))


def _pair(a: float, b: float, w: Array) -> Array:
    return _along(a + b, w - a - b)


def _triple(a: float, b: float, c: float, w: Array) -> Array:
    """Return the minimum distance along from the first to the last of three discs in this order.

    Across, the middle one lies between the others (u + v <= their maximum), or beside both.
    """
    ab, bc, ac = w - a - b, w - b - c, w - a - c
    between = np.full(w.shape, np.inf)
    for u in (np.maximum(ac - bc, 0.0), np.minimum(ab, ac), np.clip(a + b, 0.0, ac), ac - (b + c)):
        inside = np.clip(u, np.maximum(ac - bc, 0.0), np.minimum(ab, ac))
        between = np.minimum(between, _along(a + b, inside) + _along(b + c, ac - inside))
    between = np.maximum(between, _along(a + c, ac))
    beside = np.minimum(_beside(a + c, a + b, b + c, ab, bc), _beside(a + c, b + c, a + b, bc, ab))
    return np.asarray(np.minimum(between, beside))


def _beside(outer: float, first: float, second: float, maximum: Array, other: Array) -> Array:
    """Return the minimum distance along of three discs, the middle one beside the outer two.

    It is `maximum` across from the first, and up to `other` from the last.

    With v from 0 to the smaller of them, the outer distance grows and the sum of the inner ones
    falls.
    """
    low, high = np.zeros(maximum.shape), np.minimum(maximum, other)
    fixed = _along(first, maximum)
    for _ in range(HALVINGS):
        v = 0.5 * (low + high)
        rising = _along(outer, maximum - v) < fixed + _along(second, v)
        low, high = np.where(rising, v, low), np.where(rising, high, v)
    return np.asarray(np.maximum(_along(outer, maximum - low), fixed + _along(second, high)))


def _by_order(rho: Array, w: Array, late: Late) -> Array | None:
    """Return the minimum over all orders of the longest chain of distances along; None if late."""
    pair: Callable[..., Array] = _kept(_pair, w)
    triple: Callable[..., Array] = _kept(_triple, w)
    minimum = np.full(w.shape, np.inf)
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
        minimum = np.minimum(minimum, deepest)
    return minimum


def _kept(law: Callable[..., Array], w: Array) -> Callable[..., Array]:
    """Return a law at fixed widths, each of its values computed once."""
    known: dict[tuple[float, ...], Array] = {}

    def value(*radii: float) -> Array:
        if radii not in known:
            known[radii] = law(*radii, w)
        return known[radii]

    return value


def orders(items: list[float]) -> Iterator[tuple[float, ...]]:
    """Yield every different order of some items, each once."""
    if not items:
        yield ()
    for item in dict.fromkeys(items):
        rest = items.copy()
        rest.remove(item)
        for tail in orders(rest):
            yield (item, *tail)
