"""Branch and bound over boxes of each stage of a drive that ratings limit.

A shaft between two stages has cells of torque; the least sum of shares along cells that meet is a
bound of the drive. Designs are looked for in the boxes of the least sum.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive.rated_continuous.boxes import (
    END,
    FREE,
    ROUND,
    ROWS,
    Boxes,
    Shafts,
    bounded,
    cut,
    first_boxes,
    joined,
    shafts_about,
)
from gearopt.formulations.drive.rated_continuous.designs import (
    Design,
    design_in_boxes,
    polished,
    smallest,
)
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

START = 8  # cells of a shaft at first
STEP = 0.15  # width of a box in logarithms, below which borders of laws divide it first
MAX_BOXES = 300_000  # boxes, beyond which the search ends
SHARE = 0.5  # of the gap: boxes that are so far above the least are not divided yet
PATHS = 4  # of the least sums, a stage, in which designs are looked for
GOVERNS = 0.8  # of the most that a standard uses: others that use less are left out
IDLE_POLISHES = 2  # of them, after none was found


@dataclass(frozen=True)
class Searched:
    """A bound of a drive, its best design (None: none was found) and the value of that."""

    bound: float
    pairs: tuple[GearPair, ...] | None
    value: float


Rows = list[tuple[Boxes, Array]]


def search(
    train: Train, known: Sequence[GearPair], most: float, clock: Clock, close: float
) -> Searched:
    """Return the bound that is reached and the best design.

    known: the best design so far, of value `most`; none: empty and infinite. close: relative gap
    that ends the search, as MAX_BOXES boxes do.
    """
    shafts = shafts_about(_without_idle_standards(train, known), START, known)
    best, before, tried = Searched(-math.inf, None, most), most, PATHS
    stages = range(shafts.last + 1)
    rows = [bounded(shafts, k, first_boxes(shafts, k)) for k in stages]
    while True:
        totals = _totals(shafts, rows)
        here = min(total.min(initial=math.inf) for total in totals)
        improved = _improved_design(train, shafts, rows, totals, best, tried)
        best, tried = improved, PATHS if improved.value < best.value else IDLE_POLISHES
        far = best.value * (1.0 - close)
        best = replace(best, bound=max(best.bound, min(here, far)))
        keep = [total < far for total in totals]
        rows = [(b.take(k), v[k]) for (b, v), k in zip(rows, keep, strict=True)]
        totals = [t[k] for t, k in zip(totals, keep, strict=True)]
        clock.best, clock.bound = best.value, best.bound
        if here >= far or sum(map(len, totals)) > MAX_BOXES or not clock.tell():
            least = float(best.bound) if best.bound > 0.0 else -math.inf
            return replace(best, bound=least, value=float(best.value))
        aim = here + SHARE * (far - here) if far < math.inf else 2.0 * abs(here)
        chosen = [total <= aim for total in totals]
        if _coarse(shafts, rows, chosen):
            if best.pairs and best.value < before:
                best = Searched(best.bound, *polished(train, (best.pairs, best.value), clock))
                before = best.value
            about = best.pairs or known
            shafts = shafts_about(_without_idle_standards(train, about), 2 * shafts.count, about)
            rows = [bounded(shafts, k, _halved_shafts(shafts, k, rows[k][0])) for k in stages]
        else:
            spare = [far - (t - v) for t, (_, v) in zip(totals, rows, strict=True)]
            rows = [_divided_boxes(shafts, k, rows[k], chosen[k], spare[k]) for k in stages]


def _without_idle_standards(train: Train, pairs: Sequence[GearPair]) -> Train:
    """Return a drive without the standards that are far from governing a design: a relaxation."""
    stages, torque = list(train.stages), train.torque
    for k, pair in enumerate(pairs):
        option, used = stages[k].options[:1], []
        for standard in option[0].standards if option else ():
            single = replace(option[0], standards=(standard,))
            speed = train.speed_at(torque)
            utilisations = single.utilisations(pair, torque, speed, train.safety_of(stages[k]))
            used.append((float(max(utilisations.values())), standard))
        most = max((u for u, _ in used), default=0.0)
        left = tuple(standard for u, standard in used if u >= GOVERNS * most)
        if option:
            stages[k] = replace(stages[k], options=(replace(option[0], standards=left),))
        torque *= float(pair.ratio)
    return replace(train, stages=tuple(stages))


def _totals(shafts: Shafts, rows: Rows) -> list[Array]:
    """Return the least value of a drive through each box."""
    before, after = _sums(shafts, rows)
    return [
        before[k][b.before] + value + after[k + 1][b.after] for k, (b, value) in enumerate(rows)
    ]


def _sums(shafts: Shafts, rows: Rows) -> tuple[list[Array], list[Array]]:
    """Return the least sums before and after every cell of every shaft."""
    sizes = [1] + [shafts.count] * shafts.last + [1]
    before, after = [np.zeros(1)], [np.zeros(1)]
    for k, (boxes, value) in enumerate(rows):
        sums = np.full(sizes[k + 1], np.inf)
        np.minimum.at(sums, boxes.after, before[k][boxes.before] + value)
        before.append(sums)
    for k, (boxes, value) in reversed(list(enumerate(rows))):
        sums = np.full(sizes[k], np.inf)
        np.minimum.at(sums, boxes.before, after[0][boxes.after] + value)
        after.insert(0, sums)
    return before, after


def _borders(shafts: Shafts, k: int, sizes: Array) -> tuple[Array, Array]:
    """Return by row (rows, n) the middlemost border of a law within boxes, and how many."""
    borders, number = np.zeros(sizes.shape[::2]), np.zeros(sizes.shape[::2], int)
    options = shafts.train.stages[k].options[:1]
    for standard in (one for option in options for one in option.standards):
        for name, ends in standard.steps.items():
            row, at = ROWS.index(name), np.log(np.asarray(ends))
            low = np.searchsorted(at, sizes[row, 0] + ROUND, side="right")
            high = np.searchsorted(at, sizes[row, 1] - ROUND)
            middle = np.minimum((low + high) // 2, len(at) - 1)
            borders[row], number[row] = at[middle], np.maximum(high - low, 0)
    return borders, number


def _halves(shafts: Shafts, k: int, boxes: Boxes) -> Boxes:
    """Return both halves of boxes, across their widest side or at a border of a law."""
    wide = boxes.widths
    side, places = wide.argmax(axis=0), np.arange(len(boxes))
    side = np.asarray(list(FREE))[side]
    at = boxes.sizes[side, :, places].mean(axis=1)
    border, number = _borders(shafts, k, boxes.sizes)
    row = number.argmax(axis=0)
    some = (number.max(axis=0) > 0) & (wide.max(axis=0) < STEP)
    side, at = np.where(some, row, side), np.where(some, border[row, places], at)
    first, second = boxes.sizes.copy(), boxes.sizes.copy()
    first[side, 1, places] = at
    second[side, 0, places] = at
    return joined([Boxes(s, boxes.before, boxes.after) for s in (first, second)])


def _divided_boxes(
    shafts: Shafts, k: int, rows: tuple[Boxes, Array], chosen: Any, spare: Array
) -> tuple[Boxes, Array]:
    """Return boxes of a stage with the chosen ones divided; spare: values that may be better."""
    boxes, value = rows
    if not chosen.any():
        return boxes, value
    halves = _halves(shafts, k, cut(shafts, k, boxes.take(chosen), spare[chosen]))
    divided_boxes, new = bounded(shafts, k, halves)
    return joined([boxes.take(~chosen), divided_boxes]), np.concatenate([value[~chosen], new])


def _coarse(shafts: Shafts, rows: Rows, chosen: list[Array]) -> bool:
    """Return whether the cells of shafts are wider than the boxes that are to be divided."""
    if not shafts.last:
        return False
    wide = [boxes.widths.max(axis=0)[c] for (boxes, _), c in zip(rows, chosen, strict=True)]
    return bool(shafts.step > np.concatenate(wide).mean())


def _halved_shafts(shafts: Shafts, k: int, boxes: Boxes) -> Boxes:
    """Return boxes in shafts of twice as many cells."""
    halves = []
    for i in (0, 1) if k else (0,):
        for j in (0, 1) if k < shafts.last else (0,):
            before = 2 * boxes.before + i if k else boxes.before
            after = 2 * boxes.after + j if k < shafts.last else boxes.after
            halves.append(Boxes(boxes.sizes, before, after))
    whole = joined(halves)
    inside = 0 < k < shafts.last
    return whole.take(whole.after >= whole.before) if inside else whole


def _improved_design(
    train: Train, shafts: Shafts, rows: Rows, totals: list[Array], best: Searched, count: int
) -> Searched:
    """Return the best design of the boxes of the least sums, if it is better."""
    sums = _sums(shafts, rows)
    seen = set()
    for k, total in enumerate(totals):
        for place in np.argsort(total)[:count]:
            path = _path(shafts, rows, sums, k, int(place))
            if path is None or path in seen:
                continue
            seen.add(path)
            design = _design(train, shafts, rows, path)
            if design is not None and design[1] < best.value:
                best = Searched(best.bound, *design)
    return best


def _path(
    shafts: Shafts, rows: Rows, sums: tuple[list[Array], list[Array]], k: int, place: int
) -> tuple[int, ...] | None:
    """Return the boxes of the least sum through a box of a stage; None where there is none."""
    before, after = sums
    path = [place]
    if not all(len(value) for _, value in rows):
        return None
    for m in range(k + 1, shafts.last + 1):
        boxes, value = rows[m]
        at = rows[m - 1][0].after[path[-1]]
        total = np.where(boxes.before == at, value + after[m + 1][boxes.after], np.inf)
        path.append(int(total.argmin()))
        if not math.isfinite(total.min()):
            return None
    for m in reversed(range(k)):
        boxes, value = rows[m]
        at = rows[m + 1][0].before[path[0]]
        total = np.where(boxes.after == at, value + before[m][boxes.before], np.inf)
        path.insert(0, int(total.argmin()))
        if not math.isfinite(total.min()):
            return None
    return tuple(path)


def _design(train: Train, shafts: Shafts, rows: Rows, path: tuple[int, ...]) -> Design | None:
    """Return the best design that is found in the boxes of a path."""
    boxes = [rows[k][0].sizes[:, :, place] for k, place in enumerate(path)]
    cells = [int(rows[k][0].after[place]) for k, place in enumerate(path[:-1])]
    after = [*((cell + 0.5) * shafts.step for cell in cells), float(boxes[-1][END, 0])]
    return design_in_boxes(
        train,
        after,
        lambda k, at, then: smallest(train, k, boxes[k], at, then),
    )
