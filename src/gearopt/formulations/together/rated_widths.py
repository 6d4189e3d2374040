"""Face widths of rated stages for the kernels: lower bounds by cells of the torque.

A stage carries torques of a window only, given the ratios of the others. A kernel asks for the
least width at a torque or any stronger one, so that every cell holds the least of those above it,
too: what is used may fall with the torque. Cells are narrowed for the pairs that are still of use.
"""

import math
from collections.abc import Callable

import numpy as np

from gearopt.formulations.teeth.columns import Index
from gearopt.formulations.teeth.later_stages import ragged, slices
from gearopt.formulations.teeth.rated import RatedTable
from gearopt.formulations.teeth.stage import EDGE
from gearopt.formulations.together.tables import DELTA, ENTRIES, Drive
from gearopt.optimise.terms import Array

STEPS = tuple(DELTA * factor for factor in (32.0, 8.0, 2.0, 0.5))  # widths of cells, one by one
ROWS = 2_000_000  # pairs, modules and cells that are bounded, at most
SLICE = 50_000  # of them, between two checks of the clock
CLOSE = 0.02  # of what is used above 1, over the width of a cell

Tables = list[RatedTable]


def narrower(
    tables: Tables, drive: Drive, step: float, goes_on: Callable[[], bool]
) -> Drive | None:
    """Return a drive with widths in cells of a step, of the pairs that it holds.

    The drive itself where that takes too long; None if stopped.
    """
    cells = math.ceil((drive.log_high + 2.0 * DELTA) / step)
    modules, pairs = drive.modules.shape[1], drive.z1.size
    if cells * modules * pairs > ENTRIES:
        return drive
    work = [_rows(t, drive, k, step, cells) for k, t in enumerate(tables)]
    if sum(len(w[0]) for w in work) > ROWS:
        return drive
    found = np.full((cells, modules, pairs), np.inf)
    for k, (table, rows) in enumerate(zip(tables, work, strict=True)):
        if not _fill(table, drive, k, step, rows, found, goes_on):
            return None
    made = np.minimum.accumulate(found[::-1], axis=0)[::-1]
    return drive._replace(bisected=np.ascontiguousarray(made), step=step)


def _rows(
    table: RatedTable, drive: Drive, stage: int, step: float, cells: int
) -> tuple[Index, Index, Index]:
    """Return cell, module and pair (of the drive) of all widths that may be asked of a stage."""
    own = slice(drive.start[stage], drive.start[stage + 1])
    low, high = _window(drive, stage)
    first = (np.maximum(low - EDGE, 0.0) / step).astype(np.int64)
    last = np.minimum((high + EDGE) / step, cells - 1).astype(np.int64)
    count = np.where(high + EDGE >= low, np.maximum(last - first + 1, 0), 0)
    pair, cell = ragged(first, count)
    spans = drive.last[own][pair] - drive.first[own][pair] + 1
    place, module = ragged(drive.first[own][pair], np.maximum(spans, 0))
    pair, cell = pair[place] + own.start, cell[place]
    if drive.bisected.size:
        before = np.minimum(cell * step / drive.step, drive.bisected.shape[0] - 1)
        some = np.isfinite(drive.bisected[before.astype(np.int64), module, pair])
        cell, module, pair = cell[some], module[some], pair[some]
    return cell, module, pair


def _window(drive: Drive, stage: int) -> tuple[Array, Array]:
    """Return the ends (n,) of the log torque over that of the input, of the pairs of a stage."""
    count = drive.kind.size
    ends = [drive.log_ratio[drive.start[k] : drive.start[k + 1]] for k in range(count)]
    least = [e.min(initial=math.inf) for e in ends]
    most = [e.max(initial=-math.inf) for e in ends]
    own = ends[stage]
    if stage == 0:
        return np.zeros(len(own)), np.zeros(len(own))
    low = np.maximum(sum(least[:stage]), drive.log_low - own - sum(most[stage + 1 :]))
    high = np.minimum(sum(most[:stage]), drive.log_high - own - sum(least[stage + 1 :]))
    return low, high


def _fill(
    table: RatedTable,
    drive: Drive,
    stage: int,
    step: float,
    rows: tuple[Index, Index, Index],
    found: Array,
    goes_on: Callable[[], bool],
) -> bool:
    """Set the widths of a stage; False if stopped."""
    cell, module, pair = rows
    own = _places(table, drive, stage)
    low, high = _window(drive, stage)
    start = int(drive.start[stage])
    for part in slices(np.ones(len(cell), np.int64), SLICE):
        k, q, p = cell[part], module[part], pair[part]
        ends = np.maximum(k * step, low[p - start]), np.minimum((k + 1) * step, high[p - start])
        shy = EDGE if stage else 0.0  # the first stage carries the input torque
        torques = [drive.torque * np.exp(e) for e in (ends[0] - shy, np.maximum(*ends) + shy)]
        width = table.least_width((torques[0], torques[1]), own[p - start], q, CLOSE * step)
        found[k, q, p] = width
        if not goes_on():
            return False
    return True


def _places(table: RatedTable, drive: Drive, stage: int) -> Index:
    """Return where the pairs of a stage of the drive stand in its table."""
    own = slice(drive.start[stage], drive.start[stage + 1])
    base = int(table.z2.max(initial=0)) + 1
    known = table.z1 * base + table.z2
    order = np.argsort(known, kind="stable")
    wanted = (np.rint(drive.z1[own]) * base + np.rint(drive.z2[own])).astype(np.int64)
    return np.asarray(order[np.searchsorted(known[order], wanted)])
