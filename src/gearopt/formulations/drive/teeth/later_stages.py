"""A lower bound on the stages still to come, as a function of the ratio reached so far.

What stages k..N cost depends on the past only through the cumulative ratio p (it sets the torque)
and on how much of the total ratio is left. On a grid of log p, cell [x, x + delta): torque is the
least of the cell, at its lower edge where pinions drive, and the ratio still needed is from the
whole cell, so every value is a rigorous lower bound; the last stage moreover carries at least the
torque that its own ratio leaves over. Backward recursion over the stages; the finer the grid, the
closer the bound.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.formulations.drive.teeth.stage import EDGE, Cells, Table
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

ENTRIES = 10_000_000  # of the last stage's table
SLICE = 500_000  # of them, between two checks of the clock
ROUNDING = 1e-6  # relative: above that of single precision

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class LastCosts:
    """Lower bounds of what pairs of the last stage's table cost behind each cell, by the bound.

    start, count (cells,): the pairs that may follow a cell; begins: their places in cost (n,).
    """

    table: Table
    start: NDArray[np.int64]
    count: NDArray[np.int64]
    begins: NDArray[np.int64]
    cost: NDArray[np.float32]

    def least(self, cell: NDArray[np.int64], pair: NDArray[np.int64]) -> NDArray[np.float32]:
        """Bounds of pairs behind cells; inf of those that the bound left out."""
        number = pair - self.start[cell]
        inside = (number >= 0) & (number < self.count[cell])
        found = np.full(len(pair), np.inf, np.float32)
        found[inside] = self.cost[(self.begins[cell] + number)[inside]]
        return found


@dataclass(frozen=True)
class Bound:
    """Minimum cost of the stages still to come, tabulated by the ratio reached so far.

    to_go[k] (cells,): that of stages k..N-1 from a cell of log cumulative ratio. minimum[k] (cells,
    ratio cells): that of stage k alone. starts[k]: first pair of each ratio cell, so that pairs of
    cell r are starts[k][r] : starts[k][r + 1]. first[k] (cells, pairs): first modules of use, of
    stages whose ratings are limits. last: costs of the last stage's pairs; None: not kept.
    """

    delta: float
    to_go: list[Array]
    minimum: list[Array | None]
    starts: list[NDArray[np.int64]]
    first: list[NDArray[np.int16] | None]
    last: LastCosts | None

    def cell(self, log_ratio: Array) -> NDArray[np.int64]:
        """Return the cell of a log ratio."""
        return _cell(log_ratio, self.delta)

    def onward(self, stage: int, cell: NDArray[np.int64]) -> Array:
        """Return the minimum cost of stages `stage`.. by cell and by ratio cell of `stage`."""
        minimum = self.minimum[stage]
        assert minimum is not None
        return np.asarray(minimum[cell] + _ahead(self.to_go[stage + 1], minimum.shape[1])[cell])


def _cell(log_ratio: Array, delta: float) -> NDArray[np.int64]:
    return (log_ratio / delta).astype(np.int64)


def bound(
    train: Train,
    tables: list[Table],
    delta: float,
    tick: Callable[[], float],
    useful: list[Mask] | None = None,
    most: float = math.inf,
    coarse: Bound | None = None,
) -> Bound:
    """Return the bound of all stages but the first, on cells of `delta` in log ratio.

    Every table has a pair. tick: called several times a second; what it raises ends the work.
    useful: of `useful_cells`, outside of which everything counts as inf, as may what costs more
    than so much. coarse: the bound on cells twice as wide, of costs up to at least so much.
    """
    cells = int((math.log(train.highest_ratio) + EDGE) / delta) + 1
    widest = max(float(t.log_ratio[-1]) for t in tables)
    ratio_cells = int(widest / delta) + 1
    count = len(tables)
    minimum: list[Array | None] = [None] * count
    first: list[NDArray[np.int16] | None] = [None] * count
    to_go = [np.full(cells + ratio_cells + 2, np.inf) for _ in range(count)]
    last = None
    if count > 1:  # a single stage has its exact costs alone
        mask = None if useful is None else useful[-1]
        to_go[-1][:cells], last = _last(train, tables[-1], cells, delta, tick, mask, most)
    for k in range(count - 2, 0, -1):
        ahead = _ahead(to_go[k + 1], ratio_cells)[:cells]
        mask = None if useful is None else useful[k][:cells, :ratio_cells]
        alike = [train.stages[k] == train.stages[j] for j in (k - 1, k + 1)]
        now, first[k] = (
            (minimum[k + 1], first[k + 1]) if alike[1] and mask is None else (None, None)
        )
        if now is None:
            if not (alike[0] and k > 1):  # else it is that of the stage before, too
                on = np.isfinite(ahead)  # beyond it no train goes on
                mask = on if mask is None else mask & on
            before = None if coarse is None else coarse.first[k]
            asked = Cells(cells, ratio_cells, delta, mask, most, before)
            now, first[k] = tables[k].grid(asked, tick)
        minimum[k] = now
        tick()
        to_go[k][:cells] = (now + ahead).min(axis=1)
    columns = [_cell(t.log_ratio, delta) for t in tables]
    edges = np.arange(ratio_cells)
    starts = [np.append(np.searchsorted(c, edges), len(c)) for c in columns]
    return Bound(delta, to_go, minimum, starts, first, last)


def first_costs(train: Train, table: Table, rest: Bound, delta: float, most: float) -> Array:
    """Return lower bounds of the first stage's pairs, close for the least of a cell of ratio.

    inf: with what the rest takes at least, more than `most`.
    """
    every, begin = np.arange(len(table.ratio)), np.zeros(len(table.ratio))
    torque, _ = train.pinion_torques(begin, begin, table.log_ratio)
    place = _cell(table.log_ratio, delta)
    ahead = rest.to_go[1][rest.cell(table.log_ratio)] if len(rest.to_go) > 1 else np.zeros(1)
    room = np.where(np.isfinite(ahead), most, -np.inf) - np.where(np.isfinite(ahead), ahead, 0.0)
    return table.least_cost((torque, torque), every, place, delta, room)


def useful_cells(tables: list[Table], rest: Bound, first: Array, most: float) -> list[Mask]:
    """Return the cells of a grid half as wide that trains of at most so much pass through.

    By stage: of torque and ratio (cells, ratio cells); of the last stage (cells,); the first has
    none. What the stages before cost at least is found forwards, as `to_go` is backwards; first:
    `first_costs`.
    """
    before = np.full(len(rest.to_go[-1]), np.inf)
    np.minimum.at(before, rest.cell(tables[0].log_ratio), first)
    masks: list[Mask] = [np.empty(0, bool)]
    for k in range(1, len(tables) - 1):
        now = rest.minimum[k]
        assert now is not None
        reached = before[: len(now), None] + now
        ahead = _ahead(rest.to_go[k + 1], now.shape[1])[: len(now)]
        masks.append(_halved(reached + ahead <= most))
        row, column = np.nonzero(np.isfinite(reached))
        before = np.full_like(before, np.inf)
        for one in (0, 1):
            np.minimum.at(before, row + column + one, reached[row, column])
    masks.append(_halved(before + rest.to_go[-1] <= most))
    return masks


def _halved(mask: Mask) -> Mask:
    """Return a mask of cells half as wide."""
    for axis in range(mask.ndim):
        mask = np.repeat(mask, 2, axis)
    return mask


def _ahead(to_go: Array, ratio_cells: int) -> Array:
    """to_go after a ratio cell r from a cell x: the sum lies in cell x + r or x + r + 1."""
    return sliding_window_view(np.minimum(to_go[:-1], to_go[1:]), ratio_cells)


def _last(
    train: Train,
    table: Table,
    cells: int,
    delta: float,
    tick: Callable[[], float],
    useful: Mask | None,
    most: float,
) -> tuple[Array, LastCosts | None]:
    """Return the last stage's minimum cost from every cell: exact pairs, lowest possible torque.

    Where ratings limit, also what each pair costs at least.
    """
    low, high = math.log(train.lowest_ratio), math.log(train.highest_ratio)
    edge = np.arange(cells) * delta
    start = np.searchsorted(table.log_ratio, low - edge - delta - EDGE)
    stop = np.searchsorted(table.log_ratio, high - edge + EDGE)
    count = stop - start
    if useful is not None:
        count = np.where(useful[:cells], count, 0)
    if count.sum() > ENTRIES:
        raise SolveError(
            "the ratio tolerance leaves too many pairs to the last stage: narrow it, or limit "
            "wheel teeth or stage ratio (limits.wheel_teeth, limits.stage_ratio)"
        )
    found, kept = np.full(cells, np.inf), [np.empty(0, np.float32)]
    for part in slices(count, SLICE):
        tick()
        cell, pair = ragged(start[part], count[part])
        ratio = table.log_ratio[pair]
        reached = (
            np.maximum(edge[part][cell], low - ratio),
            np.minimum(edge[part][cell] + delta, high - ratio),
        )
        ends = train.pinion_torques(reached[0] - EDGE, reached[1] + EDGE, ratio)
        cost = table.least_cost(ends, pair, cell, delta, most)
        np.minimum.at(found[part], cell, cost)
        kept.append(np.asarray(cost * (1.0 - ROUNDING), np.float32))
    if not train.rated:  # then costs themselves take no longer
        return found, None
    begins = np.cumsum(count) - count
    return found, LastCosts(table, start, count, begins, np.concatenate(kept))


def slices(count: NDArray[np.int64], maximum: int) -> Iterator[slice]:
    """Yield slices of counts that sum up to `maximum` or less, or of one entry; none is empty."""
    done = np.cumsum(count)
    first = before = 0
    while first < len(count):
        last = max(first + 1, int(np.searchsorted(done, before + maximum, side="right")))
        yield slice(first, last)
        first, before = last, int(done[last - 1])


def ragged(
    start: NDArray[np.int64], count: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return owner and index of all start[i] .. start[i] + count[i] - 1, one after the other."""
    owner = np.repeat(np.arange(len(count)), count)
    ends = np.cumsum(count)
    return owner, np.arange(len(owner)) - np.repeat(ends - count, count) + np.repeat(start, count)
