"""All trains of whole teeth that no other train beats, by branch and bound on several objectives.

A node is a choice of the first k stages. Its bounds, one an objective and one a weighted sum of
them, are what the stages cost plus a table of lower bounds on the rest (`later_stages`). It is
dropped where they lie below none of the corners that the known trains leave open. Of every pair,
module and option the narrowest face is taken: no objective falls as a face grows. The search ends
when no node is left.
"""

import heapq
import itertools
import math
from collections.abc import Iterator
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth.columns import Index
from gearopt.formulations.drive.teeth.later_stages import Bound, bound, ragged
from gearopt.formulations.drive.teeth.progress import SearchEnded, Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.search import search, within
from gearopt.formulations.drive.teeth.stage import EDGE, Table
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.corners import corners, useful, weighed
from gearopt.optimise.pareto.measures import TIE, unbeaten
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

BEAM = 256  # nodes followed down at once
LEAVES = 512  # nodes completed at once
CELL_WIDTH = 0.0025  # width of the cells of log ratio
RATED_CELL_WIDTH = 0.01  # of rated drives, whose bounds take long
WEIGHTS = {  # of weighted sums whose bounds are of use, by the number of objectives
    2: ((0.2, 0.8), (0.5, 0.5), (0.8, 0.2)),
    3: ((1.0, 1.0, 1.0), (1.0, 1.0, 0.1), (1.0, 0.1, 1.0), (0.1, 1.0, 1.0)),
}

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Choice:
    """Pairs (indices), modules, widths [mm] and options of stages, (n, stages)."""

    pair: Index
    module: Array
    width: Array
    option: Index

    def take(self, which: Index | Mask | slice) -> "Choice":
        """Return the choices in some rows."""
        return Choice(self.pair[which], self.module[which], self.width[which], self.option[which])

    def after(self, own: "Choice") -> "Choice":
        """Return the choices with those of another stage added behind."""
        columns = ("pair", "module", "width", "option")
        return Choice(*(np.hstack([getattr(self, n), getattr(own, n)]) for n in columns))

    def __add__(self, other: "Choice") -> "Choice":
        columns = ("pair", "module", "width", "option")
        return Choice(*(np.vstack([getattr(self, n), getattr(other, n)]) for n in columns))


@dataclass(frozen=True)
class Nodes:
    """Nodes (n,) of one level: bounds (n, objectives + weights), costs alike, log of the ratio."""

    level: int
    bound: Array
    cost: Array
    log_ratio: Array
    made: Choice

    def take(self, which: Index | Mask | slice) -> "Nodes":
        """Return some of the nodes."""
        columns = self.bound[which], self.cost[which], self.log_ratio[which]
        return Nodes(self.level, *columns, self.made.take(which))

    def __len__(self) -> int:
        return len(self.cost)


@dataclass(frozen=True)
class Designs:
    """Trains that none beats: values (n, objectives), gear pairs and options.

    clock: of the search; compared: trains that were sized; opened: nodes expanded.
    """

    values: Array
    trains: list[tuple[tuple[GearPair, ...], tuple[int, ...]]]
    clock: Clock
    compared: int
    opened: int


@dataclass
class Search:
    """A search as it goes on; it has state because it fills it.

    train: one of `Train.of_one_option`, by its number. weights (w, objectives): of the sums that
    are bounded too. values (n, objectives), made: the trains that none beats so far; open
    (corners, objectives + w): what they leave open; low (objectives,): their least values.
    compared: trains sized; opened: nodes expanded.
    """

    train: Train
    clock: Clock
    most: Array
    weights: Array
    tables: list[Table] = field(default_factory=list)
    rest: list[Bound] = field(default_factory=list)
    values: Array = field(default_factory=lambda: np.empty((0, 0)))
    made: Choice | None = None
    open: Array = field(default_factory=lambda: np.empty((0, 0)))
    low: Array = field(default_factory=lambda: np.empty(0))
    compared: int = 0
    opened: int = 0
    number: int = 0

    def trains(self) -> list[tuple[tuple[GearPair, ...], tuple[int, ...]]]:
        """Return gear pairs and options of the trains that none beats, by the first objective."""
        if self.made is None:
            return []
        found = []
        for k in range(len(self.values)):
            modules, widths = self.made.module[k].tolist(), self.made.width[k].tolist()
            teeth, cuts = (
                _teeth_of(self, self.made, k),
                zip(self.tables, self.made.pair[k], strict=True),
            )
            toothings = [table.toothing[row] for table, row in cuts]
            rows = zip(teeth, modules, widths, toothings, strict=True)
            pairs = tuple(
                self.train.pair(stage, module, z1, z2, width, toothing)
                for stage, ((z1, z2), module, width, toothing) in enumerate(rows)
            )
            found.append((pairs, tuple(map(int, self.made.option[k]))))
        return found

    def tick(self) -> float:
        """Seconds left; SearchEnded is raised where budget and watcher stop the search."""
        self.clock.best = float(self.values[:, 0].min(initial=math.inf))
        if not self.clock.tell():
            raise SearchEnded
        seconds = self.clock.left.seconds
        return math.inf if seconds is None else seconds


def fronts(train: Train, most: Array, clock: Clock) -> Designs:
    """Return every train that none beats, ties once; `clock.stopped`: not exhausted.

    most (objectives,): largest values of interest; inf: any.
    """
    states = [_searched(row, most, clock) for row in train.of_one_row]
    compared, opened = (
        sum(getattr(state, name) for state in states) for name in ("compared", "opened")
    )
    values = np.concatenate([state.values for state in states])
    trains = [design for state in states for design in state.trains()]
    if len(states) > 1:
        left = unbeaten(values)
        values, trains = values[left], [trains[k] for k in left.tolist()]
    return Designs(values, trains, clock, compared, opened)


def _searched(train: Train, most: Array, clock: Clock) -> Search:
    """Search the drives of one row of distances."""
    count = len(train.objectives)
    state = Search(train, clock, most, np.empty((0, count)), values=np.empty((0, count)))
    shelf: list[RatedTable] = []
    try:
        for state.number, state.train in enumerate(train.of_one_option):
            state.rest, state.weights = [], np.empty((0, count))
            state.open = np.full((1, count), np.inf)
            state.tables = stage_tables(state.train, train.highest_ratio, state.tick, shelf)
            if all(len(t.ratio) for t in state.tables) and _ends(state):
                _bounds(state)
                _all(state)
    except SearchEnded:
        state.clock.stopped = True
        _inside(state)  # the ends of the front are found without its limits
    return state


def _ends(state: Search) -> bool:
    """Begin with the trains that are best in one objective; return whether there are any.

    Of many that tie, as at given centre distances all do in their sum, the first will do.
    """
    for objective in state.train.objectives:
        watch, budget = state.clock.inner(values=False), replace(state.clock.left, gap=TIE)
        best = search(state.train.minimising(objective), 1, budget, watch)
        for _, teeth in best.found:
            _add_teeth(state, teeth)
        state.tick()
        if not best.found:
            return False
    return True


def _bounds(state: Search) -> None:
    """Compute the bounds of every objective, and of weighted sums in the ranges of the ends."""
    width = np.ptp(state.values, axis=0)
    width = np.where(width > 0.0, width, np.abs(state.values[0]))
    state.weights = np.array([np.array(w) / width for w in WEIGHTS[len(width)]])
    delta = RATED_CELL_WIDTH if state.train.rated else CELL_WIDTH
    alone = [state.train.minimising(name) for name in state.train.objectives]
    for train in (*alone, *(state.train.weighing(w) for w in state.weights)):
        own = [table.of(train) for table in state.tables]
        state.rest.append(bound(train, own, delta, state.tick))
    state.low = state.values.min(axis=0)
    _inside(state)
    state.open = weighed(corners(state.values, state.most[None, :]), state.weights)


def _inside(state: Search) -> None:
    """Keep the trains up to the largest values of interest."""
    inside = np.flatnonzero((state.values <= state.most * (1.0 + TIE)).all(axis=1))
    if state.made is not None:
        state.values, state.made = state.values[inside], state.made.take(inside)


def _add_teeth(state: Search, teeth: Teeth) -> None:
    """Add the designs that trains of given teeth allow."""
    nodes = _root(state)
    for (z1, z2), table in zip(teeth, state.tables, strict=True):
        pair = np.flatnonzero((table.z1 == z1) & (table.z2 == z2))
        if not len(pair):
            return
        node, row = np.indices((len(nodes), len(pair))).reshape(2, -1)
        nodes = _children(state, nodes, (node, pair[row]))
        nodes = nodes.take(unbeaten(nodes.cost, equal=True))
    _keep(state, nodes)


def _root(state: Search) -> Nodes:
    """The root of the search: no teeth of any stage are chosen."""
    none, zero = np.empty((1, 0)), np.zeros((1, len(state.train.objectives) + len(state.weights)))
    places = np.empty((1, 0), dtype=np.int64)
    return Nodes(0, zero, zero, np.zeros(1), Choice(places, none, none, places))


def _all(state: Search) -> None:
    """Search to the end, the most promising nodes first."""
    last, order = len(state.tables) - 1, itertools.count()
    heap: list[tuple[float, int, Nodes]] = [(0.0, next(order), _root(state))]
    count = len(state.train.objectives)
    low, scale = state.low, state.weights.mean(axis=0)
    while heap:
        nodes: Nodes | None = heapq.heappop(heap)[2]
        while nodes is not None and len(nodes):
            state.tick()
            width = LEAVES if nodes.level == last else BEAM
            rest, nodes = nodes.take(slice(width, None)), nodes.take(slice(0, width))
            if len(rest):
                score = float((rest.bound[0, :count] - low) @ scale)
                heapq.heappush(heap, (score, next(order), rest))
            nodes = nodes.take(useful(nodes.bound, state.open))
            state.opened += len(nodes)
            if nodes.level == last:
                _complete(state, nodes)
                break
            nodes = _children(state, nodes, _pairs(state, nodes))
            nodes = nodes.take(np.argsort((nodes.bound[:, :count] - low) @ scale, kind="stable"))


def _pairs(state: Search, nodes: Nodes) -> tuple[Index, Index]:
    """Return nodes and pairs of use of a stage that is not the last one."""
    level, rest = nodes.level, state.rest[0]
    if level == 0:
        pair = np.arange(len(state.tables[0].ratio))
        return np.zeros(len(pair), dtype=np.int64), pair
    cell = rest.cell(nodes.log_ratio)
    lower = np.stack([own.onward(level, cell) for own in state.rest], axis=2)
    lower += nodes.cost[:, None, :]
    use = useful(lower.reshape(-1, lower.shape[2]), state.open).reshape(lower.shape[:2])
    owner, column = np.nonzero(use)
    start = rest.starts[level][column]
    group, pair = ragged(start, rest.starts[level][column + 1] - start)
    return owner[group], pair


def _children(state: Search, nodes: Nodes, places: tuple[Index, Index]) -> Nodes:
    """Return the children of use of nodes by pairs."""
    (node, pair), level = places, nodes.level
    table = state.tables[level]
    state.clock.evaluations += len(pair)
    log_ratio = nodes.log_ratio[node] + table.log_ratio[pair]
    ahead = np.zeros((len(pair), nodes.cost.shape[1]))
    if level < len(state.tables) - 1 and state.rest:
        ahead = np.stack([r.to_go[level + 1][r.cell(log_ratio)] for r in state.rest], axis=1)
    lower = nodes.cost[node] + ahead
    reached = nodes.log_ratio[node]
    torque, _ = state.train.pinion_torques(reached, reached, table.log_ratio[pair])
    parts = list(_rows(state, level, torque, pair, lower))
    owner, module, width, option, cost = (np.concatenate(c) for c in zip(*parts, strict=True))
    use = useful(lower[owner] + cost, state.open)
    owner, cost = owner[use], cost[use]
    own = Choice(pair[owner, None], module[use, None], width[use, None], option[use, None])
    made = nodes.made.take(node[owner]).after(own)
    whole = nodes.cost[node[owner]] + cost
    return Nodes(level + 1, lower[owner] + cost, whole, log_ratio[owner], made)


Rows = tuple[Index, Array, Array, Index, Array]


def _rows(state: Search, level: int, torque: Array, pair: Index, lower: Array) -> Iterator[Rows]:
    """Yield owners, modules, widths [mm], options and costs of pairs (n,) at torques.

    lower (n, objectives + w): what a train with them costs beside them; pairs without use at the
    narrowest face that the file allows are left out.
    """
    table = state.tables[level]
    if table.one_module:
        value, module, width = table.smallest(torque, pair)
        some = np.flatnonzero(np.isfinite(value))
        yield _row(state, level, pair, some, module[some], width[some], 0)
        return
    for option in range(max(1, len(table.stage.options))):
        for k, module in enumerate(table.modules):
            some = np.flatnonzero((table.first[pair] <= k) & (k <= table.last[pair]))
            narrow = table.made(module, pair[some])
            narrow = narrow.of_width(table.width_ends(narrow, k, pair[some])[0])
            some = some[useful(lower[some] + _costs(state, level, narrow, option), state.open)]
            width = table.carrying(torque[some], pair[some], k, option)
            some, width = some[np.isfinite(width)], width[np.isfinite(width)]
            yield _row(state, level, pair, some, np.full(len(some), module), width, option)


def _row(
    state: Search, level: int, pair: Index, some: Index, module: Array, width: Array, option: int
) -> Rows:
    one = state.tables[level].made(module, pair[some]).of_width(width)
    options = np.full(len(some), option + state.number)
    return some, module, width, options, _costs(state, level, one, option)


def _costs(state: Search, level: int, pair: GearPair, option: int) -> Array:
    """Shares of pairs in every objective and weighted sum, (n, objectives + w)."""
    names = state.train.objectives
    made = [
        objective_share(state.train, level, pair, option=option, objective=name) for name in names
    ]
    return weighed(np.stack([np.asarray(m, float) for m in made], axis=1), state.weights)


def _complete(state: Search, nodes: Nodes) -> None:
    """Add the last stage to nodes, and keep the trains that none beats."""
    train, table = state.train, state.tables[-1]
    low, high = math.log(train.lowest_ratio), math.log(train.highest_ratio)
    start = np.searchsorted(table.log_ratio, low - nodes.log_ratio - EDGE)
    stop = np.searchsorted(table.log_ratio, high - nodes.log_ratio + EDGE)
    made = _children(state, nodes, ragged(start, stop - start))
    state.compared += len(made)
    _keep(state, made)


def _keep(state: Search, nodes: Nodes) -> None:
    """Keep the trains that meet the ratio limits exactly and that none beats."""
    count = len(state.train.objectives)
    nodes = nodes.take(_within(state, nodes))
    nodes = nodes.take(unbeaten(nodes.cost[:, :count], equal=True))
    if not len(nodes):
        return
    values = np.vstack([state.values, nodes.cost[:, :count]])
    made = nodes.made if state.made is None else state.made + nodes.made
    columns = zip(state.tables, made.pair.T, strict=True)
    teeth = [z for table, pair in columns for z in (table.z1[pair], table.z2[pair])]
    order = np.lexsort((*teeth[::-1], np.sum(teeth, axis=0)))  # fewest teeth first, of ties kept
    kept = order[unbeaten(values[order])]
    fresh = values[kept[kept >= len(state.values)]]
    state.values, state.made = values[kept], made.take(kept)
    if state.rest:
        state.open = weighed(corners(fresh, state.open[:, :count]), state.weights)


def _within(state: Search, nodes: Nodes) -> Mask:
    """Return which trains meet the ratio limits: by integers where logarithms leave it open."""
    low, high = math.log(state.train.lowest_ratio), math.log(state.train.highest_ratio)
    good = (nodes.log_ratio > low + EDGE) & (nodes.log_ratio < high - EDGE)
    near = ~good & (nodes.log_ratio > low - EDGE) & (nodes.log_ratio < high + EDGE)
    for k in np.flatnonzero(near):
        good[k] = within(state.train, _teeth_of(state, nodes.made, int(k)))
    return np.asarray(good)


def _teeth_of(state: Search, made: Choice, k: int) -> Teeth:
    """Return the teeth of a train."""
    rows = zip(state.tables, made.pair[k], strict=False)
    return tuple((int(t.z1[j]), int(t.z2[j])) for t, j in rows)
