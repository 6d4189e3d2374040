"""Along the shafts: which stages share a slab, in which order, and which bodies must keep apart."""

from collections.abc import Iterator
from functools import cache, lru_cache
from itertools import combinations

import numpy as np

from gearopt.formulations.drive.gearbox import ANYWHERE, Gearbox, Planetary, Range
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

Slabs = tuple[tuple[int, ...], ...]
TOUCH = 1e-9  # mm; bodies whose axial ranges share less than this do not face each other


@dataclass(frozen=True)
class Body:
    """A gear, shaft or bearing: a cylinder around a shaft's axis, from x[0] to x[1]."""

    name: str
    radius: float
    x: Range
    gear: bool = False
    stage: int = -1


@dataclass(frozen=True)
class Need:
    """Why two axes must keep apart: the bodies, their distance [mm] and the clearance in it."""

    between: tuple[str, str]
    distance: float
    clearance: float


@dataclass(frozen=True)
class Arrangement:
    """One order of slabs: its length, the bodies of each shaft, minimum distances and their causes.

    apart (N+1, N+1): minimum distance of two axes, of neighbours too. needs: its causes. keep_apart
    (K, N+1): minimum distance of an axis from a keep-out. axes: of every shaft.
    """

    slabs: Slabs
    length: float
    bodies: tuple[tuple[Body, ...], ...]
    apart: Array
    needs: dict[tuple[int, int], Need]
    keep_apart: Array
    axes: tuple[int, ...]


@dataclass(frozen=True)
class Clash:
    """Two axes that cannot be as far apart as they must: by `short` mm."""

    shafts: tuple[int, int]
    need: Need
    there: float

    @property
    def short(self) -> float:
        """Missing length [mm]."""
        return self.need.distance - self.there


@lru_cache(maxsize=64)
def arrangements(box: Gearbox) -> tuple[Arrangement, ...]:
    """Return the given arrangement or all undominated ones, the shortest first.

    Where none is possible, the stages in order stand for all: no layout of them is feasible.
    """
    if box.slabs is not None:
        return (arrange(box, box.slabs),)
    kept: list[Arrangement] = []
    for slabs in sorted(orders(box), key=lambda s: (-len(s), s)):
        order = arrange(box, slabs)
        possible = order.length <= box.largest[2] + TOUCH and not clashes(box, order)
        if possible and not any(_dominates(k, order) for k in kept):
            kept = [k for k in kept if not _dominates(order, k)] + [order]
    return tuple(sorted(kept, key=lambda a: a.length)) or (arrange(box, in_order(box)),)


def in_order(box: Gearbox) -> Slabs:
    """Return every stage in a slab of its own, from the input on."""
    return tuple((k,) for k in range(len(box.pairs)))


def clashes(box: Gearbox, one: Arrangement) -> tuple[Clash, ...]:
    """Return the axes that the centre distances between them cannot hold apart, the worst first.

    Those of neighbours are exactly their centre distance apart, others at most the sum.
    """
    links = [p.centre_distance for p in box.pairs]
    short = [Clash(pair, need, sum(links[pair[0] : pair[1]])) for pair, need in one.needs.items()]
    return tuple(sorted((c for c in short if c.short > TOUCH), key=lambda c: -c.short))


def _dominates(a: Arrangement, b: Arrangement) -> bool:
    """Return whether a, which no data forbid, is no worse than b in every respect."""
    free = np.triu_indices(len(a.apart), 2)  # neighbours are where their gears mesh
    return bool(
        a.length <= b.length + TOUCH
        and (a.apart[free] <= b.apart[free] + TOUCH).all()
        and (a.keep_apart <= b.keep_apart + TOUCH).all()
    )


def orders(box: Gearbox) -> tuple[Slabs, ...]:
    """Return orders of slabs without neighbours in one; of mirror images that are alike, one.

    They are not alike to a keep-out at one end of the box, nor for bearings beside gears of a
    shared slab: these gears start together, so that only at the other end bearings may be apart.
    """
    ended = any(keep.x != ANYWHERE for keep in box.keep_outs)
    beside = box.partial and any(s.bearing_width > 0.0 for s in box.shafts)

    def alike(slabs: Slabs) -> bool:
        return not ended and not (beside and len(slabs) < len(box.pairs))

    kept = filter(box.in_line, _orders(len(box.pairs)))
    return tuple(s for s in kept if s <= s[::-1] or not alike(s))


@cache
def _orders(stages: int) -> tuple[Slabs, ...]:

    def splits(left: frozenset[int]) -> Iterator[Slabs]:
        if not left:
            yield ()
        for slab in _subsets(left):
            for rest in splits(left - set(slab)):
                yield (slab, *rest)

    return tuple(splits(frozenset(range(stages))))


def _subsets(stages: frozenset[int]) -> Iterator[tuple[int, ...]]:
    """Non-empty sets of stages of which no two follow each other."""
    ordered = sorted(stages)
    for bits in range(1, 2 ** len(ordered)):
        chosen = tuple(s for k, s in enumerate(ordered) if bits >> k & 1)
        if all(b - a > 1 for a, b in zip(chosen, chosen[1:], strict=False)):
            yield chosen


def arrange(box: Gearbox, slabs: Slabs) -> Arrangement:
    """Return the bodies of an order of slabs, and the distances their axes must keep."""
    bodies, length = _bodies(box, slabs)
    count = len(bodies)
    apart, needs, axes = np.zeros((count, count)), {}, box.axes
    once = [  # a disc on the first of its shafts
        [b for b in own if b.stage != k - 1 or not b.name.startswith("planetary")]
        for k, own in enumerate(bodies)
    ]
    for i, j in combinations(range(count), 2):
        if axes[i] == axes[j]:
            continue
        causes = [_need(box, p, q) for p in once[i] for q in once[j] if face_each_other(p, q)]
        if i == 0 and j == count - 1 and box.motor > 0:
            gap, output = box.clearances.shafts, box.shafts[-1].radius
            between = ("motor", f"shaft {count}")
            causes.append(Need(between, box.motor + output + gap, gap))
        if causes:
            needs[i, j] = max(causes, key=lambda n: n.distance)
            apart[i, j] = apart[j, i] = needs[i, j].distance
    near = np.array(
        [
            [largest_beside(own, keep.x).radius + box.clearances.shafts for own in bodies]
            for keep in box.keep_outs
        ]
    ).reshape(len(box.keep_outs), count)
    return Arrangement(slabs, length, bodies, apart, needs, np.maximum(near, 0.0), axes)


def _bodies(box: Gearbox, slabs: Slabs) -> tuple[tuple[tuple[Body, ...], ...], float]:
    """Return the bodies of every shaft, and the length of the box."""
    gap = box.clearances.axial
    widest = max(s.bearing_width for s in box.shafts)
    end = max(gap, widest) if box.partial else gap + widest
    start: dict[int, float] = {}
    x = end
    for slab in slabs:
        start |= dict.fromkeys(slab, x)
        x += max(gear.width for s in slab for gear in box.pairs[s].gears) + gap
    length = x - gap + end
    return tuple(_on(box, k, start, length) for k in range(len(box.shafts))), length


def _on(box: Gearbox, k: int, start: dict[int, float], length: float) -> tuple[Body, ...]:
    """Return the gears, shaft and bearings of one shaft."""
    gears = []
    for stage, word in ((k - 1, "wheel"), (k, "pinion")):
        if 0 <= stage < len(box.pairs):
            gear, both = getattr(box.pairs[stage], word), box.pairs[stage].gears
            word = "planetary stage" if isinstance(gear, Planetary) else word
            x0 = start[stage] + 0.5 * (max(each.width for each in both) - gear.width)
            x = (x0, x0 + gear.width)
            gears.append(Body(f"{word} {stage + 1}", 0.5 * gear.tip_diameter, x, True, stage))
    shaft, wide = box.shafts[k], box.shafts[k].bearing_width
    span = (0.0, length)
    if box.partial:
        span = (min(g.x[0] for g in gears) - wide, max(g.x[1] for g in gears) + wide)
    for disc in (g for g in gears if g.name.startswith("planetary")):
        span = _up_to(disc, disc.stage == k, start, span)
    bodies = [*gears, Body(f"shaft {k + 1}", shaft.radius, span)]
    if wide > 0.0:
        ends = ((span[0], span[0] + wide), (span[1] - wide, span[1]))
        bodies += [Body(f"bearing of shaft {k + 1}", shaft.bearing_radius, x) for x in ends]
    return tuple(bodies)


def _up_to(disc: Body, driving: bool, start: dict[int, float], span: Range) -> Range:
    """The part of a shaft on its side of a planetary stage, which it drives or is driven by.

    Power goes on along x where the next stage is farther, or the last one nearer.
    """
    s = disc.stage if disc.stage + 1 in start else disc.stage - 1
    if (start[s + 1] > start[s]) == driving:
        return span[0], min(span[1], disc.x[0])
    return max(span[0], disc.x[1]), span[1]


def largest_beside(bodies: tuple[Body, ...], x: Range) -> Body:
    """Return the largest of the bodies of a shaft that overlap a range along it."""
    none = Body("", -np.inf, x)
    return max((p for p in bodies if _overlap(p.x, x)), key=lambda p: p.radius, default=none)


def face_each_other(p: Body, q: Body) -> bool:
    """Return whether two bodies stand side by side and do not mesh."""
    return not (p.gear and q.gear and p.stage == q.stage) and _overlap(p.x, q.x)


def _overlap(a: Range, b: Range) -> bool:
    return min(a[1], b[1]) - max(a[0], b[0]) > TOUCH


def _need(box: Gearbox, p: Body, q: Body) -> Need:
    gap = box.clearances.gears if p.gear and q.gear else box.clearances.shafts
    return Need((p.name, q.name), p.radius + q.radius + gap, gap)
