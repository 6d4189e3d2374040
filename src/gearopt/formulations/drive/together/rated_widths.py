"""Face widths of rated stages for the kernels: lower bounds by cells of the torque.

A stage carries torques of a window only, given the ratios of the others. A kernel asks for the
least width at a torque or any stronger one, so that every cell holds the least of those above it,
too: what is used may fall with the torque. Cells are narrowed for the pairs that are still of use.
"""

import math
from collections.abc import Callable

import numpy as np

from gearopt.formulations.drive.teeth.columns import Index
from gearopt.formulations.drive.teeth.later_stages import slices
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.stage import EDGE
from gearopt.formulations.drive.together.tables import DELTA, ENTRIES, KERNELS, Drive
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

# widths of cells, one by one
CELL_WIDTHS = tuple(DELTA * factor for factor in (32.0, 8.0, 2.0, 0.5))
ROWS = 6_000_000  # pairs, modules and cells that are bounded, at most
SLICE = 50_000  # of them, between two checks of the clock
CELL_TOLERANCE = 0.02  # of what is used above 1, over the width of a cell

Tables = list[RatedTable]


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
    rows, module = np.nonzero(np.isfinite(_known(drive, pair, reached)))
    some = low[pair[rows]] <= high[pair[rows]] + EDGE
    rows, module = rows[some], module[some]
    if len(rows) > ROWS:
        return drive
    found = np.full((int(row[-1]), drive.modules.shape[1]), np.inf)
    for k, table in enumerate(tables):
        first, stop = np.searchsorted(rows, row[[drive.start[k], drive.start[k + 1]]])
        own, shy = _places(table, drive, k), EDGE if k else 0.0  # first: the input torque itself
        for part in slices(np.ones(stop - first, np.int64), SLICE):
            r, q = rows[first:stop][part], module[first:stop][part]
            p = pair[r]
            ends = np.maximum(reached[r], low[p]), np.minimum(reached[r] + step, high[p])
            torques = [drive.torque * np.exp(e) for e in (ends[0] - shy, np.maximum(*ends) + shy)]
            place = own[p - drive.start[k]]
            found[r, q] = table.least_width(
                (torques[0], torques[1]), place, q, CELL_TOLERANCE * step
            )
            if not goes_on():
                return None
    _hold_stronger(found, row, cells)
    return drive._replace(bisected=found, row=row, cell=cell, step=step)


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
        first=ends[0],
        last=np.where(some.any(axis=1), ends[1], 0),
        **steps,
    )


def _known(drive: Drive, pair: Index, reached: Array) -> Array:
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
    own = ends[stage]
    if stage == 0:
        return np.zeros(len(own)), np.zeros(len(own))
    low = np.maximum(sum(least[:stage]), drive.log_low - own - sum(most[stage + 1 :]))
    high = np.minimum(sum(most[:stage]), drive.log_high - own - sum(least[stage + 1 :]))
    return low, high


def _places(table: RatedTable, drive: Drive, stage: int) -> Index:
    """Return where the pairs of a stage of the drive stand in its table."""
    own = slice(drive.start[stage], drive.start[stage + 1])
    base = int(table.z2.max(initial=0)) + 1
    known = table.z1 * base + table.z2
    order = np.argsort(known, kind="stable")
    wanted = (np.rint(drive.z1[own]) * base + np.rint(drive.z2[own])).astype(np.int64)
    return np.asarray(order[np.searchsorted(known[order], wanted)])
