"""What a search prepares for a cut-off: tooth pairs still of use, and the tables of the rest."""

from collections.abc import Callable

import numpy as np

from gearopt.formulations.layout.chain import Chain
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.together.tables import BINS, Drive, Rest
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

KERNELS = "gearopt.formulations.together.rest_kernel"
ROUNDS = 3  # of dropping pairs; each knows the least widths of the one before
SLICE = 2_000_000  # pairs sized between two looks at clock and watcher

GoesOn = Callable[[], bool]


def useful(drive: Drive, cut: float) -> Drive:
    """The drive with those pairs alone whose stage does not exceed the cut by itself."""
    kernels = kernel(KERNELS)
    for _ in range(ROUNDS):
        keep = np.zeros(drive.z1.size, bool)
        count = drive.kind.size
        widths = np.array([kernels.useful(drive, j, cut, keep) for j in range(count)])
        kept = np.concatenate([[0], np.cumsum(keep)])[drive.start]
        names = ("z1", "z2", "log_ratio", "need", "first", "last")
        fewer = {n: getattr(drive, n)[keep] for n in names}
        fewer["load"] = drive.load[keep] if drive.load.size else drive.load
        fewer["bisected"] = drive.bisected if drive.load.size else drive.bisected[:, :, keep]
        if drive.least_steps.shape[1] == keep.size:
            steps = {n: getattr(drive, n)[:, keep] for n in ("least_steps", "most_steps")}
            fewer |= {n: np.ascontiguousarray(v) for n, v in steps.items()}
        widths = np.where(np.isfinite(widths), widths, 0.0)
        others = _others(drive, widths)
        drive = drive._replace(start=kept, widths=widths, others=others, **fewer)
    return drive


def _others(drive: Drive, widths: Array) -> Array:
    """Least length that the stages before each one add in slabs of their own, (M, N)."""
    found = np.zeros_like(drive.others)
    for m, slab in enumerate(drive.slab_of):
        for j in range(1, widths.size):
            own = [s for s in range(drive.slabs[m]) if not (slab[j:] == s).any()]
            found[m, j] = sum(widths[:j][slab[:j] == s].max() for s in own)
    return found


def rest(drive: Drive, goes_on: GoesOn) -> Rest | None:
    """The tables of the stages before each one; None if stopped."""
    kernels = kernel(KERNELS)
    count, many = drive.kind.size, drive.slabs.size
    cells = int(drive.log_high / drive.delta) + 3
    tables = Rest(
        np.full((count, count, cells), np.inf),
        np.array([_edges(drive, k - 1) for k in range(count)]),
        np.full((count, many, cells, BINS), np.inf),
    )
    for k in range(1, count):
        size = max(1, int(drive.start[k] - drive.start[k - 1]) * drive.modules.shape[1])
        step = max(1, SLICE // size)
        for cell in range(0, cells - 1, step):  # the last one stays empty
            kernels.fill(drive, k, cell, min(cells - 1, cell + step), tables)
            if not goes_on():
                return None
    return tables


def _edges(drive: Drive, j: int) -> Array:
    """Radii that divide those of the wheels of a stage (none before the first: zeros)."""
    own = slice(drive.start[j], drive.start[j + 1]) if j >= 0 else slice(0, 0)
    modules = drive.modules[j][drive.first[own]], drive.modules[j][drive.last[own]]
    radii = [m * (0.5 * drive.z2[own] / drive.cosine + 1.0) for m in modules]
    if j < 0 or not radii[0].size:
        return np.zeros(BINS)
    return np.geomspace(radii[0].min() * (1.0 - 1e-9), radii[1].max(), BINS)


def chains(drive: Drive, box: Gearbox) -> list[Chain]:
    """For each first stage, a chain of the shafts from there on, for the kernel to fill."""
    found = []
    for first in range(drive.kind.size):
        shafts = drive.kind.size + 1 - first
        place = np.tile([-np.inf, np.inf], (shafts, 2))
        for p in box.places if first == 0 else ():
            place[p.shaft] = (*p.y, *p.z)
        level = sorted(box.level) if first == 0 else []
        found.append(
            Chain(
                np.zeros(shafts - 1),
                np.zeros(shafts),
                np.zeros((1, shafts, shafts)),
                np.zeros((0, 4)),
                np.zeros((1, 0, shafts)),
                place,
                np.array(level, np.int64),
                np.zeros(shafts - 1, np.int64),
                np.zeros((shafts - 1, 3)),
                np.array([*drive.aim[:2], np.inf]),
                drive.aim[5:7].copy(),
                np.zeros(1),
                bool(drive.aim[7]),
                np.zeros(1),
            )
        )
    return found
