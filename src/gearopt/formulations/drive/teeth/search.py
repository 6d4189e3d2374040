"""Best-first branch and bound over the tooth pairs of the stages, with dives.

A node is a choice of the first k pairs; its bound is what they cost plus `bound` on the rest. Nodes
wait in chunks sorted by bound; the chunk with the minimum bound is taken, its best nodes are
followed down to complete trains at once. The search ends when no open bound is below the best
train.
"""

import functools
import heapq
import math
import operator
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.formulations.drive.rated_continuous.quick_bound import quick_bound
from gearopt.formulations.drive.teeth.choices import valued
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.later_stages import (
    SLICE,
    Bound,
    bound,
    first_costs,
    ragged,
    useful_cells,
)
from gearopt.formulations.drive.teeth.progress import TIE, Progress, SearchEnded, Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.reach import PAIRS_AT_ONCE, first_cut, largest_ratio, reach
from gearopt.formulations.drive.teeth.stage import EDGE, Table
from gearopt.formulations.drive.teeth.tables import stage_tables, thinned
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget, Event, Watch
from gearopt.optimise.terms import Array

FEW_WAYS = 4, 16  # toothings of a stage that a first look begins with
BEAM = 4  # nodes followed down at once; measured best for two to four stages
LEAVES = 256  # nodes completed at once
FIRST_LOOK = 20_000  # pairs examined for a first train
GRACE = 0.5  # s beyond one and a half times those asked, for a first train
PATIENCE = 2_000_000  # pairs examined before a finer grid pays
# first cells of rated drives, times usual ones; the last coarse ones
FIRST_CELLS, LAST_COARSE_CELL = 32.0, 0.006
PROMISING = 32  # children of a node that a first dive looks at
DIVE = 1000  # pairs examined on each of these grids, for a train
CELLS = 10_000_000  # largest grid of a stage, 80 MB
MOST_PRODUCTS = 300_000  # of ratios of all stages but the last that are looked at
SLACK = 1e-12  # relative: far above the rounding of a product of six ratios


Places = tuple[NDArray[np.int64], NDArray[np.int64]]
Few = tuple[int, Array | None]


@dataclass(frozen=True)
class Chunk:
    """Nodes of one level, by bound: cost so far, log of the ratio so far, pairs chosen."""

    level: int
    bound: Array
    cost: Array
    log_ratio: Array
    path: NDArray[np.int64]

    def part(self, which: slice | NDArray[np.bool_]) -> "Chunk":
        """Some of the nodes."""
        return Chunk(
            self.level, self.bound[which], self.cost[which], self.log_ratio[which], self.path[which]
        )


def search(
    train: Train,
    wanted: int,
    budget: Budget,
    watch: Watch | None = None,
    floor: float = -math.inf,
    whole: bool = True,
    shelf: list[RatedTable] | None = None,
) -> Progress:
    """Return the `wanted` best trains; `stopped` or `enough` where the search was not exhausted.

    A first look at stage ratios near the even split gives a train; what it does not exclude by
    the ratio of a single stage is then searched to the end. Of rated drives that look is a dive,
    in each material alone where there is a choice; where time ends first, among far fewer; where it
    gives no train all ratios are searched at once. floor: a
    bound known from elsewhere. whole: False where its own bound is of no use, as that of a part of
    the caller's drive. shelf: tables of like drives, which spare this one work; its own are added.
    """
    shelf = [] if shelf is None else shelf
    progress = Progress(wanted, Clock(budget, watch), floor)
    maximum = largest_ratio(train)
    cut = min(maximum, first_cut(train))
    progress.whole = whole
    try:
        apart = cut == maximum and len(train.of_one_option) * len(train.of_one_row) > 1
        for one in _glimpses(train, progress):
            _glance(train, one, cut, progress, shelf)
            if apart and progress.found:
                _bound_apart(train, cut, progress, shelf)
                apart = False
        progress.whole = whole and cut == maximum
        closed, far = False, maximum
        if progress.found or not train.rated:  # else dives found none, and there may be none
            closed = not progress.found and _look(train, cut, progress, FIRST_LOOK, shelf)
            far = reach(train, cut, maximum, progress.threshold, progress.tick, shelf)
        progress.whole = whole
        if not (closed and far <= cut):
            _look(train, max(cut, far), progress, math.inf, shelf)
    except SearchEnded:  # whoever's clock ended it, it was not exhausted
        progress.clock.stopped |= not progress.enough
    return progress


def _glimpses(train: Train, progress: Progress) -> Iterator[Train]:
    """Rated drives of one material each, at one row of distances, in which a train is looked for.

    Rows are taken from the middle of all, where most trains are; of many toothings FEW_WAYS, and
    all where there is no train yet.
    """
    most_ways = max(len(stage.toothings) for stage in train.stages)
    for one in train.of_one_material if train.rated else ():
        rows = one.of_one_row
        for row in sorted(rows, key=lambda row: abs(rows.index(row) - len(rows) // 2)):
            looked = list[Train]()
            for count in (*FEW_WAYS, most_ways):
                few = row.of_few_toothings(count)
                if few not in looked and not (count not in FEW_WAYS and progress.found):
                    yield few
                looked.append(few)


def _glance(
    train: Train, own: Train, cut: Fraction, progress: Progress, shelf: list[RatedTable]
) -> None:
    """Look for a first train among few, else among all, whatever the budget's evaluations.

    own: the drive of one material in which it is looked for; it is valued with the best materials.
    Where there is no train yet, the first look may end half the budget's seconds and GRACE after
    them. What is looked at does not depend on them, so that more seconds find nothing worse.
    """
    seconds = progress.clock.budget.seconds or 0.0
    progress.patience = 0.0 if progress.found else 0.5 * seconds + GRACE
    tables = stage_tables(own, cut, progress.tick, shelf)
    few = thinned(tables)
    for some in (few, tables):
        before = progress.found[:1]
        if some is not few and not before and all(map(operator.is_, few, tables)):
            break  # the same again
        carries = _first_dive(own, tables, some, progress)
        if progress.whole and progress.found and not before:
            progress.quick = quick_bound(train, progress.found[0][0])
            progress.tick()  # which tells of both
        if own is not train and progress.found[:1] != before:
            best = progress.found[0][1]
            progress.add(np.array([valued(train, best)[0]]), iter([best]))
        progress.patience = 0.0
        if progress.found or not carries:
            break
    progress.patience = -math.inf
    progress.tick()


def _first_dive(train: Train, tables: list[Table], few: list[Table], progress: Progress) -> bool:
    """Look for a train of all pairs of the last stage and few of the others.

    Return whether some of the few of the last stage carry: else there is hardly a train.
    """
    if not all(len(t.ratio) for t in tables):
        return False
    delta = FIRST_CELLS * _width(tables)
    rest = bound(train, few, delta, progress.tick, None, progress.threshold)
    if all(map(operator.is_, few, tables)):
        progress.begun = train, tables, rest
    _dive(train, [*few[:-1], tables[-1]], rest, progress)
    return len(tables) == 1 or bool(np.isfinite(rest.to_go[-1]).any())


def _bound_apart(train: Train, cut: Fraction, progress: Progress, shelf: list[RatedTable]) -> None:
    """Raise the bound to that of stages whose options and distances need not go together.

    Drives of one option and one row of distances have none before each of them was begun.
    """
    apart = replace(train, distances=(), same_option=False)
    tables = stage_tables(apart, cut, progress.tick, shelf)
    delta = FIRST_CELLS * _width(tables)
    rest = bound(apart, tables, delta, progress.tick, None, progress.threshold)
    first = first_costs(apart, tables[0], rest, LAST_COARSE_CELL, progress.threshold)
    progress.raise_lower(_least(tables, rest, first))


def _look(
    train: Train, cut: Fraction, progress: Progress, patience: float, shelf: list[RatedTable]
) -> bool:
    """Search all ratios up to a cut, on ever finer grids; False when patience ran out.

    Where all stages take the same option, or distances that go together, the drives of one option
    and one row of distances each are searched in turn, that of the least bound first.
    """
    waiting: list[tuple[float, int, Iterator[float]]] = []
    parts = [row for one in train.of_one_option for row in one.of_one_row]
    for k, one in enumerate(parts):
        own = stage_tables(one, cut, progress.tick, shelf)
        if all(len(t.ratio) for t in own):
            waiting.append((-math.inf, k, _rounds(one, own, progress, patience)))
    while waiting and waiting[0][0] <= progress.threshold:
        _, k, rounds = heapq.heappop(waiting)
        progress.beside = waiting[0][0] if waiting else math.inf
        lower = next(rounds, None)
        if lower is None:
            return False
        if lower < math.inf:
            heapq.heappush(waiting, (lower, k, rounds))
    return True


def _rounds(
    train: Train, tables: list[Table], progress: Progress, patience: float
) -> Iterator[float]:
    """Search on ever finer grids; yield the bound of open nodes, inf: none; end impatiently."""
    coarse, useful = train.rated, None  # whose bounds take long: few cells at first
    delta = _width(tables) * (FIRST_CELLS if coarse else 1.0)
    first: Array | None = None
    rest: Bound | None = None
    while True:
        finer = math.log(train.highest_ratio) * tables[-1].log_ratio[-1] / (delta / 2) ** 2
        last = not coarse and (len(tables) <= 2 or finer > CELLS)
        own = DIVE if coarse else math.inf if last else PATIENCE
        enough = progress.clock.evaluations + min(patience, own)
        if first is None and not progress.found and _same(train, tables, progress.begun):
            _, tables, rest = progress.begun
        else:
            rest = bound(train, tables, delta, progress.tick, useful, progress.threshold, rest)
        if train.rated:
            begins = first is None
            if first is None:
                first = first_costs(train, tables[0], rest, LAST_COARSE_CELL, progress.threshold)
            progress.raise_lower(_least(tables, rest, first))
            if begins:
                _dive(train, tables, rest, progress, first)
        lower = _closed(train, tables, rest, progress, enough, first)
        if lower < math.inf and patience <= PATIENCE and not coarse:
            return
        yield lower
        if train.rated:
            assert first is not None
            useful = useful_cells(tables, rest, first, progress.threshold)
        delta /= 2
        coarse = coarse and delta > LAST_COARSE_CELL


def _same(train: Train, tables: list[Table], begun: tuple[Any, list[Table], Any]) -> bool:
    """Return whether a first look was at these tables, of no larger ratios than there are."""
    alike = [len(t.ratio) for t in tables] == [len(t.ratio) for t in begun[1]]
    return alike and train == begun[0]


def _width(tables: list[Table]) -> float:
    """Return the usual width of a cell of log ratio."""
    return 0.01 if len(tables) <= 3 else 0.005


def _least(tables: list[Table], rest: Bound, first: Array) -> float:
    """Return a bound of all trains: first costs of the first stage, and of the rest to go."""
    if len(tables) == 1:
        return float(first.min(initial=math.inf))
    ahead = rest.to_go[1][rest.cell(tables[0].log_ratio)]
    return float((first + ahead).min(initial=math.inf))


def _dive(
    train: Train, tables: list[Table], rest: Bound, progress: Progress, first: Array | None = None
) -> None:
    """Look for a train among the most promising nodes: its objective cuts the search after it.

    first: bounds of the first stage's pairs, where they are known.
    """
    chunk: Chunk | None = _root()
    few: tuple[int, Array | None] = (PROMISING, first)
    while chunk is not None:
        width = LEAVES if chunk.level == len(tables) - 1 else BEAM
        chunk = _expand(train, tables, rest, chunk.part(slice(0, width)), progress, few)
        few = PROMISING, None


def _root() -> Chunk:
    """Return the node of no choice."""
    zero = np.zeros(1)
    return Chunk(0, np.array([-math.inf]), zero, zero, np.empty((1, 0), dtype=np.int64))


def _closed(
    train: Train,
    tables: list[Table],
    rest: Bound,
    progress: Progress,
    patience: float,
    first: Array | None,
) -> float:
    """Least bound that one search leaves for a finer grid, inf where it is exhausted.

    first: bounds of the first stage's pairs, where they are known.
    """

    def goes_on(lower: float, _: Chunk) -> bool:
        if lower > progress.threshold:
            return False
        progress.raise_lower(lower)
        progress.tick()
        return progress.clock.evaluations <= patience

    def branch(_: float, taken: Chunk) -> Iterator[tuple[float, Chunk]]:
        chunk: Chunk | None = taken
        while chunk is not None:  # the best nodes are followed at once, the others wait
            progress.nodes += 1
            width = LEAVES if chunk.level == len(tables) - 1 else BEAM
            later = chunk.part(slice(width, None))
            if len(later.bound):
                yield float(later.bound[0]), later
            part = chunk.part(slice(0, width))
            chunk = _expand(train, tables, rest, part, progress, (0, first))

    left = best_first([(-math.inf, _root())], goes_on, branch)
    return left.least if left.least <= progress.threshold else math.inf


def _expand(
    train: Train,
    tables: list[Table],
    rest: Bound,
    chunk: Chunk,
    progress: Progress,
    few: Few = (0, None),
) -> Chunk | None:
    """Return the useful children of some nodes, or None (complete trains are kept).

    few: of so many of the most promising children only, for each node, 0: of all; bounds of their
    costs where they are known.
    """
    chunk = chunk.part(chunk.bound <= progress.threshold)
    level, stage = chunk.level, tables[chunk.level]
    if level == len(tables) - 1:
        _complete(train, tables, rest, chunk, progress, few)
        return None
    if level == 0:
        pair = np.arange(len(stage.ratio))
        if few[1] is not None:
            ahead = rest.to_go[1][rest.cell(stage.log_ratio)]
            pair = np.flatnonzero(few[1] + ahead <= progress.threshold)
        node = np.zeros(len(pair), dtype=np.int64)
    else:
        onward = chunk.cost[:, None] + rest.onward(level, rest.cell(chunk.log_ratio))
        owner, cell = np.nonzero(onward <= progress.threshold)
        start = rest.starts[level][cell]
        group, pair = ragged(start, rest.starts[level][cell + 1] - start)
        node = owner[group]
    if few[0]:
        node, pair = _promising(train, stage, rest, chunk, (node, pair), progress.threshold, *few)
    progress.clock.evaluations += len(pair)
    log_ratio = chunk.log_ratio[node] + stage.log_ratio[pair]
    ahead = rest.to_go[level + 1][rest.cell(log_ratio)]
    most = np.where(np.isfinite(ahead), progress.threshold - chunk.cost[node], -np.inf)
    most -= np.where(np.isfinite(ahead), ahead, 0.0)
    own = _costs(train, stage, chunk, (node, pair), most, progress)
    if progress.wanted == 1 or len(stage.stage.toothings) > 1:
        alike = stage.ratio if progress.wanted == 1 else stage.names
        keep = _best_of_ratio(node, alike[pair], own)
        node, pair, own = node[keep], pair[keep], own[keep]
        log_ratio, ahead = log_ratio[keep], ahead[keep]
    cost = chunk.cost[node] + own
    lower = cost + ahead
    use = np.flatnonzero(np.isfinite(lower) & (lower <= progress.threshold))
    use = use[np.argsort(lower[use], kind="stable")]
    if not len(use):
        return None
    path = np.column_stack([chunk.path[node[use]], pair[use]])
    return Chunk(level + 1, lower[use], cost[use], log_ratio[use], path)


def _promising(
    train: Train,
    stage: Table,
    rest: Bound,
    chunk: Chunk,
    places: Places,
    most: float,
    few: int,
    first: Array | None,
) -> Places:
    """Return the nodes and pairs of the least rough bounds, a few for each node.

    most: bounds above which any is as good as another.
    """
    node, pair = places
    ahead = np.zeros(len(pair))
    if chunk.level < len(rest.to_go) - 1:
        cell = rest.cell(chunk.log_ratio[node] + stage.log_ratio[pair])
        ahead = rest.to_go[chunk.level + 1][cell]
        goes = np.isfinite(ahead)
        node, pair, ahead = node[goes], pair[goes], ahead[goes]
    reached = chunk.log_ratio[node]
    torque, _ = train.pinion_torques(reached, reached, stage.log_ratio[pair])
    before = chunk.cost[node] + ahead
    own = stage.rough_cost(torque, pair, most - before) if first is None else first[pair]
    rough = before + own
    best = np.sort(np.argsort(rough, kind="stable")[: few * len(chunk.cost)])
    return node[best], pair[best]


def _costs(
    train: Train,
    stage: Table,
    chunk: Chunk,
    places: Places,
    most: Array,
    progress: Progress,
) -> Array:
    """Return the cost of pairs of a stage behind nodes of a chunk, where it is at most so much."""
    node, pair = places
    reached = chunk.log_ratio[node]
    torque, _ = train.pinion_torques(reached, reached, stage.log_ratio[pair])
    found = np.empty(len(pair))
    for start in range(0, len(pair), SLICE):
        if start:  # a first dive, however short the budget, ends with a train
            progress.tick()
        part = slice(start, start + SLICE)
        found[part] = stage.cost(torque[part], pair[part], most[part])
    return found


def _best_of_ratio(node: NDArray[np.int64], ratio: Any, cost: Array) -> NDArray[np.bool_]:
    """Mark of a node's pairs of equal ratio the one of lowest cost, then of fewest teeth.

    What follows depends on the ratio alone. Pairs come by ratio, then by teeth. ratio: or any
    numbers (n,) that are equal where pairs are alike.
    """
    if not len(node):
        return np.empty(0, dtype=bool)
    new = np.concatenate([[True], (np.diff(node) != 0) | (np.diff(ratio) != 0)])
    group = np.cumsum(new) - 1
    minimum = np.minimum.reduceat(cost, np.flatnonzero(new))
    good = np.flatnonzero(np.isfinite(cost) & (cost <= minimum[group] * (1.0 + TIE)))
    keep = np.zeros(len(node), dtype=bool)
    keep[good[np.unique(group[good], return_index=True)[1]]] = True
    return keep


def _complete(
    train: Train,
    tables: list[Table],
    rest: Bound,
    chunk: Chunk,
    progress: Progress,
    few: Few,
) -> None:
    """Add the last stage to nodes and keep the best trains that meet the ratio limits exactly."""
    stage = tables[-1]
    low, high = math.log(train.lowest_ratio), math.log(train.highest_ratio)
    start = np.searchsorted(stage.log_ratio, low - chunk.log_ratio - EDGE)
    stop = np.searchsorted(stage.log_ratio, high - chunk.log_ratio + EDGE)
    node, pair = ragged(start, stop - start)
    if rest.last is not None and rest.last.table is stage:
        least = rest.last.least(rest.cell(chunk.log_ratio)[node], pair)
        some = np.flatnonzero(chunk.cost[node] + least <= progress.threshold)
        node, pair = node[some], pair[some]
    if few[0]:
        node, pair = _promising(train, stage, rest, chunk, (node, pair), progress.threshold, *few)
    progress.clock.evaluations += len(pair)
    most = progress.threshold - chunk.cost[node]
    total = chunk.cost[node] + _costs(train, stage, chunk, (node, pair), most, progress)
    progress.compared += int(np.isfinite(total).sum())
    use = np.flatnonzero(np.isfinite(total) & (total <= progress.threshold))
    use = use[np.argsort(total[use], kind="stable")]

    def teeth(k: np.int64) -> Teeth:
        path = [*chunk.path[node[k]], pair[k]]
        return tuple((int(t.z1[j]), int(t.z2[j])) for t, j in zip(tables, path, strict=True))

    kept: list[tuple[float, Teeth]] = []
    maximum = math.inf
    for k in use:
        if total[k] > maximum:
            break
        candidate = teeth(k)
        if within(train, candidate) and candidate not in (t for _, t in kept):
            kept.append((float(total[k]), candidate))
            if len(kept) == progress.wanted:
                maximum = float(total[k]) * (1.0 + TIE)
    progress.add(np.array([v for v, _ in kept]), iter([t for _, t in kept]))


def within(train: Train, teeth: Teeth) -> bool:
    """Return whether the total ratio lies within its limits, in integers."""
    wheels, pinions = math.prod(z2 for _, z2 in teeth), math.prod(z1 for z1, _ in teeth)
    low, high = train.lowest_ratio, train.highest_ratio
    return (
        low.numerator * pinions <= wheels * low.denominator
        and wheels * high.denominator <= high.numerator * pinions
    )


def reaches(train: Train) -> bool | None:
    """Whether numbers of teeth have a total ratio that is allowed, whatever they carry.

    Exact: doubles leave out what is off by more than their rounding, the rest is compared in
    integers. None: there are too many to look at.
    """
    tables, known = list[list[tuple[int, int]]](), list[Array]()
    for k in range(len(train.stages)):
        rows = spans(train, k, train.highest_ratio)
        if sum(stop - start + 1 for _, start, stop in rows) > PAIRS_AT_ONCE:
            return None
        z1 = np.concatenate([np.full(stop - start + 1, z) for z, start, stop in rows])
        z2 = np.concatenate([np.arange(start, stop + 1) for _, start, stop in rows])
        kept = np.gcd(z1, z2) == 1 if train.coprime else np.ones(len(z1), bool)
        ratios, first = np.unique((z2 / z1)[kept], return_index=True)
        known.append(ratios)
        columns = (column[kept][first].tolist() for column in (z1, z2))
        tables.append([*zip(*columns, strict=True)])
    shape = [len(ratios) for ratios in known[:-1]]
    if math.prod(shape) > MOST_PRODUCTS:
        return None
    products = functools.reduce(np.multiply.outer, known[:-1], np.ones(())).ravel()
    start = np.searchsorted(known[-1], float(train.lowest_ratio) * (1.0 - SLACK) / products)
    stop = np.searchsorted(known[-1], float(train.highest_ratio) * (1.0 + SLACK) / products)
    for row in np.flatnonzero(stop > start).tolist():
        before = map(int, np.unravel_index(row, shape) if shape else ())
        chosen = tuple(teeth[i] for teeth, i in zip(tables, before, strict=False))
        near = tables[-1][start[row] : stop[row]]
        if any(within(train, (*chosen, teeth)) for teeth in near):
            return True
    return False


def possible(
    train: Train, seconds: float, watch: Watch | None, shelf: list[RatedTable] | None = None
) -> bool | None:
    """Return whether any train meets all limits; None where that is not known in time.

    shelf: as of `search`.
    """
    teeth = any_train(train, seconds, watch, shelf)
    return teeth if teeth is None else bool(teeth)


def any_train(
    train: Train, seconds: float, watch: Watch | None, shelf: list[RatedTable] | None = None
) -> Teeth | None:
    """Return the teeth of a train that meets all limits, () if there is none; None: not known.

    shelf: as of `search`.
    """

    def first(event: Event) -> bool:
        wanted = watch is None or watch(event) is not False
        return event.best is None and wanted  # one train is enough

    train = replace(train, any_will_do=train.rated)
    try:
        progress = search(train, 1, Budget(seconds=seconds), first, whole=False, shelf=shelf)
    except SolveError:  # too many pairs to examine
        return None
    if progress.found:
        return progress.found[0][1]
    return None if progress.clock.stopped else ()
