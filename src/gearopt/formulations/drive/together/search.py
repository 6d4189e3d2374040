"""The search over whole trains and their layouts: incumbents, depth-first passes, last checks.

A pass drops whatever cannot be below the best value by more than a margin; margins narrow from pass
to pass, so that a search which is stopped has the bound of its last full pass.

Of rated stages kernels ask for the least width at a torque or any stronger one (`narrower`): lower
bounds by cells of the torque, of which a stage carries a window only, given the ratios of the
others. What is used of a capacity may fall with the torque, so every cell holds the least of those
above it, too. Cells are narrowed for the pairs that are still of use.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.layout.chain import Chain, chain, turns
from gearopt.formulations.drive.layout.exact import first_cell
from gearopt.formulations.drive.layout.slabs import TOUCH, Arrangement, arrangements, clashes
from gearopt.formulations.drive.teeth.columns import Index
from gearopt.formulations.drive.teeth.later_stages import slices
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.search import within
from gearopt.formulations.drive.teeth.stage import EDGE, TEETH, Table
from gearopt.formulations.drive.teeth.tables import stage_tables, table
from gearopt.formulations.drive.together.tables import (
    DELTA,
    ENTRIES,
    KERNELS,
    Drive,
    Make,
    Rest,
    chains,
    rest,
    useful,
)
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

MARGINS = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4)  # of the passes
CHOICES = 50_000  # pairs examined in a slice of an expansion
CELLS = 100_000  # cells of angles in a slice of a sift
CHILDREN = 4096  # nodes that an expansion makes at once
PARENTS = 256  # nodes expanded together
STALE = 0.9  # tables are recomputed for a best value this much better
LAYOUT_GAP = 1e-3  # relative gap to which a train is laid out, or the margin where it is smaller
LOOKS = (400, 20_000)  # cells spent on a node's layout, on a whole train's

Nodes = NDArray[np.int64]  # (n, N, 2): pair and module of each stage
Made = tuple[tuple[GearPair, ...], tuple[int, ...]]  # gear pairs and their options


@dataclass(frozen=True)
class Design:
    """A train with its layout: gear pairs, their options, slabs, link angles [rad]; its value."""

    value: float
    pairs: tuple[GearPair, ...]
    options: tuple[int, ...]
    slabs: tuple[tuple[int, ...], ...]
    angles: Array


@dataclass
class Search:
    """A search as it runs; its state is the knowledge that a stopped one still has.

    clock: counts choices and cells examined; has the best value and what is proven. best: the best
    design. Nodes by number of stages chosen: made, and left after a check of their layout. trains:
    laid out to the end. tables: those of the stages, by default made.
    """

    train: Train
    make: Make
    clock: Clock
    seed: int
    best: Design | None = None
    trains: int = 0
    made: dict[int, int] = field(default_factory=dict)
    left: dict[int, int] = field(default_factory=dict)
    tables: Sequence[Table] = ()

    def __post_init__(self) -> None:
        self.tables = self.tables or stage_tables(self.train, self.train.highest_ratio)

    @property
    def value(self) -> float:
        """The best value, inf without a design."""
        return self.clock.best


def cuts(value: float, margin: float) -> tuple[float, float]:
    """Two values: nodes not below the first are dropped, designs below the second are sought.

    Between the two a search may do either: equal, it would resolve their level without end.
    """
    return value * (1.0 - margin), value * (1.0 - 0.8 * margin)


def sized(train: Train, drive: Drive, node: Nodes) -> Iterator[Made]:
    """Yield the gear pairs of a whole node with their options; none where one is too weak.

    The widths of a node are bounds where the strength law has no closed form. Where all stages
    take the same option, there are such pairs of each.
    """
    for option, single in enumerate(train.of_one_option):
        if (sizing := _sized(single, drive, node)) is not None:
            yield (sizing if single is train else (sizing[0], (option,) * len(node)))


def _sized(train: Train, drive: Drive, node: Nodes) -> Made | None:
    torque, pairs, options = train.torque, [], []
    for j, (p, k) in enumerate(node):
        z1, z2, cut = float(drive.z1[p]), float(drive.z2[p]), int(drive.toothing[p])
        fixed = train.fixed_teeth(j, round(z1), round(z2), cut)
        widths = widths_of(fixed, j, torque, int(k))
        option = min(range(len(widths)), key=widths.__getitem__)
        if (width := widths[option]) == math.inf:
            return None
        pairs.append(train.pair(j, float(drive.modules[j, k]), z1, z2, width, cut))
        options.append(option)
        torque *= z2 / z1
    return tuple(pairs), tuple(options)


def widths_of(train: Train, stage: int, torque: float, module: int) -> list[float]:
    """Return the minimum face widths [mm] of the options of a stage whose teeth are given."""
    whole_stage, widths = train.stages[stage], []
    for way in [replace(whole_stage, options=(o,)) for o in whole_stage.options] or [whole_stage]:
        stages = (*train.stages[:stage], way, *train.stages[stage + 1 :])
        single = replace(train, stages=stages, same_option=False)
        only = table(single, stage, train.highest_ratio)
        widths.append(only.width(np.array([torque]), np.array([0]), module).item())
    return widths


def orders_of(box: Gearbox) -> list[Arrangement]:
    """Return the arrangements in which no shafts clash and the box is not too long."""
    longest = box.largest[2] + TOUCH
    return [a for a in arrangements(box) if not clashes(box, a) and a.length <= longest]


def lay(search: Search, made: Made, margin: float) -> bool:
    """Keep the best layout of a train if it improves the best value by more than a margin.

    False where it is not proven that no other layout of the train does.
    """
    box, proven = search.make(made[0]), True
    search.trains += 1
    for order in orders_of(box):
        if not _below(search, box, order, margin):
            continue
        ordered = replace(box, slabs=order.slabs)
        budget, watch = Budget(gap=min(margin, LAYOUT_GAP)), search.clock.inner(values=False)
        outcome = layout.problem(ordered).methods["exact"](None, budget, search.seed, watch)
        proven = proven and outcome.finished
        if outcome.x is not None:
            keep(search, made, order, outcome.x)
    return proven


def keep(search: Search, made: Made, order: Arrangement, angles: Array) -> None:
    """Keep a layout if it is the best so far."""
    text = layout.problem(replace(search.make(made[0]), slabs=order.slabs))
    value = float(text.batch(angles[None]).F[0, 0])
    if value < search.value:
        search.clock.best = value
        search.best = Design(value, *made, order.slabs, angles)


def _below(search: Search, box: Gearbox, order: Arrangement, margin: float) -> bool:
    """Return whether an order may have a layout that improves the best value by a margin."""
    if search.best is None:
        return True
    cut, aim = cuts(search.value, margin)
    kernels = kernel("gearopt.formulations.drive.layout.branch_kernel")
    shape, theta = chain(box, (order,)), np.zeros(len(box.pairs))
    cells, bounds = first_cell(theta.size, turns(box))
    count, best, floor = 1, aim, math.inf
    while count and best == aim and search.clock.tell():
        count, best, _, floor, nodes = kernels.branch(
            shape, 0, cells, bounds, count, best, 0.0, floor, 1.0 - cut / aim, 20_000, theta
        )
        search.clock.evaluations += nodes
    return count > 0 or best < aim or floor < cut


@dataclass(frozen=True)
class Work:
    """Pairs of use and tables that passes work with, made for a best value."""

    value: float
    drive: Drive
    rest: Rest
    chains: list[Chain]
    turns: list[tuple[float, float]]


def prepare(search: Search, drive: Drive, box: Gearbox, margin: float) -> Work | None:
    """Return the tables for all cuts down to a margin; None if stopped. box: one of any sizes."""
    cut = search.value * (1.0 - margin)
    fewer = useful(drive, cut)
    for step in CELL_WIDTHS if search.train.rated else ():
        closer = narrower(search.tables, shortened(fewer, cut), step, search.clock.tell)
        if closer is None:
            return None
        fewer = useful(closer, cut)
    tables = rest(fewer, search.clock.tell)
    # Before all shafts are there, only the sides of the box distinguish the directions.
    bare = turns(replace(box, places=(), keep_outs=(), level=()))
    ranges = [turns(box)] + [bare] * (drive.kind.size - 1)
    shafts = chains(fewer, box)
    return None if tables is None else Work(search.value, fewer, tables, shafts, ranges)


def prove(search: Search, work: Work, margin: float) -> bool:
    """Drop all that is not below the best value by more than a margin; False if not finished.

    It is not finished where it was stopped, nor where the best value has improved so much that new
    tables pay.
    """
    last = work.drive.kind.size - 1
    stack: list[tuple[int, Nodes, Array, Any]] = [
        (last, np.zeros((1, last + 1, 2), np.int64), np.zeros(1), np.array([0, -1]))
    ]
    while stack:
        stage, parents, bounds, place = stack.pop()
        cut, aim = cuts(search.value, margin)
        of_use = int(np.searchsorted(bounds, cut))
        if place[0] >= of_use:
            continue
        stop = min(of_use, (int(place[0]) // PARENTS + 1) * PARENTS)
        nodes, lower = _children(search, work, stage, parents, place, stop, (cut, aim))
        stack.append((stage, parents, bounds, place))
        if stage > 0:
            stack.append((stage - 1, nodes, lower, np.array([0, -1])))
        else:
            _last_looks(search, work.drive, nodes, lower, margin)
        if not search.clock.tell() or search.value < STALE * work.value:
            return False
    return True


def _last_looks(search: Search, drive: Drive, nodes: Nodes, bounds: Array, margin: float) -> None:
    """Lay out whole trains that may be below the cut; one without a proof ends the search."""
    for node, value in zip(nodes, bounds, strict=True):
        teeth = tuple((round(drive.z1[p]), round(drive.z2[p])) for p, _ in node)
        if value < search.value * (1.0 - margin) and within(search.train, teeth):
            for whole_train in sized(search.train, drive, node):
                proven = lay(search, whole_train, margin)
                search.clock.stopped = search.clock.stopped or not proven
        if search.clock.stopped:
            return


def _children(
    search: Search,
    work: Work,
    stage: int,
    parents: Nodes,
    place: Any,
    stop: int,
    levels: tuple[float, float],
) -> tuple[Nodes, Array]:
    """Return the children of some nodes that may lead below a cut, the best first."""
    kernels = kernel(KERNELS)
    count = work.drive.kind.size
    nodes, bounds = np.zeros((CHILDREN, count, 2), np.int64), np.zeros(CHILDREN)
    children, looked = kernels.expand(
        work.drive, work.rest, stage, parents, place, stop, levels[0], CHOICES, nodes, bounds
    )
    search.clock.evaluations += looked
    search.made[stage] = search.made.get(stage, 0) + children
    order = np.argsort(bounds[:children], kind="stable")
    nodes, bounds = nodes[order], bounds[order]
    alive, sums = np.zeros(children, np.int64), np.zeros((children, 2 + count - stage))
    start, maximum = 0, LOOKS[0] if stage > 0 else LOOKS[1]
    shape = work.chains[stage]
    while start < children:
        start, cells = kernels.sift(
            work.drive,
            work.rest,
            shape,
            work.turns[stage],
            stage,
            nodes,
            start,
            levels,
            (maximum, CELLS),
            alive,
            sums,
        )
        search.clock.evaluations += cells
        if not search.clock.tell():
            break
    alive[start:] = 2
    use = np.nonzero(alive)[0]
    search.left[stage] = search.left.get(stage, 0) + len(use)
    return nodes[use], bounds[use]


# widths of cells, one by one
CELL_WIDTHS = tuple(DELTA * factor for factor in (32.0, 8.0, 2.0, 0.5))
ROWS = 6_000_000  # pairs, modules and cells that are bounded, at most
SLICE = 50_000  # of them, between two checks of the clock
CELL_TOLERANCE = 0.02  # of what is used above 1, over the width of a cell

Tables = Sequence[Table]


def narrower(
    tables: Tables, drive: Drive, step: float, goes_on: Callable[[], bool]
) -> Drive | None:
    """Return a drive with widths in cells of a step, of the pairs that it holds.

    The drive itself where that takes too long; None if stopped.
    """
    count = drive.kind.size
    windows = [_window(drive, k) for k in range(count)]
    low, high = (np.concatenate(ends) for ends in zip(*windows, strict=True))
    cell = (np.maximum(low - EDGE, 0.0) / step).astype(np.int64)
    cells = np.maximum((np.maximum(high + EDGE, 0.0) / step).astype(np.int64) - cell + 1, 1)
    row = np.concatenate([[0], np.cumsum(cells)])
    if row[-1] * drive.modules.shape[1] > ENTRIES:
        return drive
    pair = np.repeat(np.arange(len(cells)), cells)
    reached = (cell[pair] + np.arange(row[-1]) - row[pair]) * step  # log torque over the input's
    rows, module = np.nonzero(np.isfinite(_known_widths(drive, pair, reached)))
    some = low[pair[rows]] <= high[pair[rows]] + EDGE
    rows, module = rows[some], module[some]
    if len(rows) > ROWS:
        return drive
    widths = np.full((int(row[-1]), drive.modules.shape[1]), np.inf)
    for k, rated in enumerate(tables):
        assert isinstance(rated, RatedTable)
        first, stop = np.searchsorted(rows, row[[drive.start[k], drive.start[k + 1]]])
        places, shy = _places(rated, drive, k), EDGE if k else 0.0  # first: the input torque itself
        for part in slices(np.ones(stop - first, np.int64), SLICE):
            r, q = rows[first:stop][part], module[first:stop][part]
            p = pair[r]
            ends = np.maximum(reached[r], low[p]), np.minimum(reached[r] + step, high[p])
            torques = [drive.torque * np.exp(e) for e in (ends[0] - shy, np.maximum(*ends) + shy)]
            place = places[p - drive.start[k]]
            widths[r, q] = rated.least_width(
                (torques[0], torques[1]), place, q, CELL_TOLERANCE * step
            )
            if not goes_on():
                return None
    _hold_stronger(widths, row, cells)
    return drive._replace(bisected=widths, row=row, cell=cell, step=step)


def shortened(drive: Drive, cut: float) -> Drive:
    """Return the drive without the bisected widths with which a stage alone exceeds the cut.

    Modules that a pair, or no stage, can have then are left out.
    """
    kernels = kernel(KERNELS)
    drive = drive._replace(bisected=drive.bisected.copy())
    for j in range(drive.kind.size):
        kernels.shorten(drive, j, cut)
    some = np.logical_or.reduceat(np.isfinite(drive.bisected), drive.row[:-1], axis=0)
    most = int(np.flatnonzero(some.any(axis=0)).max(initial=0)) + 1
    ends = some.argmax(axis=1), some.shape[1] - 1 - some[:, ::-1].argmax(axis=1)
    steps = {n: getattr(drive, n) for n in ("least_steps", "most_steps")}
    if drive.least_steps.shape[0] > most:
        steps = {n: np.ascontiguousarray(v[:most]) for n, v in steps.items()}
    return drive._replace(
        bisected=np.ascontiguousarray(drive.bisected[:, :most]),
        modules=np.ascontiguousarray(drive.modules[:, :most]),
        sizes=np.ascontiguousarray(drive.sizes[:, :most]),
        first=ends[0],
        last=np.where(some.any(axis=1), ends[1], 0),
        **steps,
    )


def _known_widths(drive: Drive, pair: Index, reached: Array) -> Array:
    """Return the widths (n, modules) that are known of pairs at log torques over the input's."""
    cell = (reached / drive.step).astype(np.int64) - drive.cell[pair]
    place = np.minimum(drive.row[pair] + np.maximum(cell, 0), drive.row[pair + 1] - 1)
    return np.asarray(drive.bisected[place])


def _hold_stronger(found: Array, row: Index, cells: Index) -> None:
    """Set every row of widths to the least of it and those of stronger torques of its pair."""
    for back in range(2, int(cells.max(initial=1)) + 1):
        place = row[1:][cells >= back] - back
        found[place] = np.minimum(found[place], found[place + 1])


def _window(drive: Drive, stage: int) -> tuple[Array, Array]:
    """Return the ends (n,) of the log torque over that of the input, of the pairs of a stage."""
    count = drive.kind.size
    ends = [drive.log_ratio[drive.start[k] : drive.start[k + 1]] for k in range(count)]
    least = [e.min(initial=math.inf) for e in ends]
    most = [e.max(initial=-math.inf) for e in ends]
    ratios = ends[stage]
    if stage == 0:
        return np.zeros(len(ratios)), np.zeros(len(ratios))
    low = np.maximum(sum(least[:stage]), drive.log_low - ratios - sum(most[stage + 1 :]))
    high = np.minimum(sum(most[:stage]), drive.log_high - ratios - sum(least[stage + 1 :]))
    return low, high


def _places(table: Table, drive: Drive, stage: int) -> Index:
    """Return where the pairs of a stage of the drive stand in its table."""
    rows = slice(drive.start[stage], drive.start[stage + 1])
    ways = len(table.stage.toothings)
    known = table.names * ways + table.toothing
    order = np.argsort(known, kind="stable")
    teeth = (np.rint(drive.z1[rows]) * TEETH + np.rint(drive.z2[rows])).astype(np.int64)
    wanted = teeth * ways + drive.toothing[rows]
    return np.asarray(order[np.searchsorted(known[order], wanted)])
