"""A drive and its gearbox as the arrays that the kernels search, and the minimum cost of the rest.

Gears follow from the teeth (`pairs`); shafts may depend on the torque they carry, and count with
the minimum radius in a cell of it. Facing bodies follow from the order of the slabs alone, but for
short bearings beside gears: those are left to the last check of a train.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.formulations.drive.gearbox import ANYWHERE, Gearbox, Shaft
from gearopt.formulations.drive.layout.chain import Chain
from gearopt.formulations.drive.layout.slabs import Slabs, arrange, face_each_other, orders
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.train import Train
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

Make = Callable[[tuple[GearPair, ...]], Gearbox]
GoesOn = Callable[[], bool]
Index = NDArray[np.int64]

DELTA = 0.01  # cells of log ratio: a third of it in sizes, below the usual ratio tolerance
ENTRIES = 20_000_000  # of bisected widths, 160 MB
KERNELS = "gearopt.formulations.drive.together.together_kernel"
ROUNDS = 3  # of dropping pairs; each uses the minimum widths of the one before
SLICE = 2_000_000  # pairs sized between two checks of clock and watcher
BINS = 48  # of wheel radii, for what a larger wheel saves in width


class Drive(NamedTuple):
    """N stages with their pairs one after the other (start), M arrangements of the slabs.

    kind: of face widths, 0 tied, 1 free, 2 given, 3 on steps (given: the width or the step). load:
    as in `teeth.stage.Table`; for a law without one (size 0), bisected holds minimum widths (rows,
    modules) by log ratio reached, in cells of `step`: the rows of pair p are row[p] : row[p + 1],
    the first one that of `cell[p]`. cosine (N,): of the helix angles;
    addenda (N, 2): of pinion and wheel in modules. sizes (pairs, modules, 3): centre distance and
    tip radii of pinion and wheel, where they do not follow from these (else empty). toothing: which
    of the stage's cuts a pair. distance: number of its given distance among those of the stage that
    go together with others; fits (N, numbers): whether the distances of a stage and those after it
    do, by the sum of strides (N,) times their numbers. shaft, bearing (N+1, cells): minimum
    radius by log ratio reached. gap: between gears, from shafts, to the wall, along the axis. faces
    (M, N+1, 4, N+1, 4): whether bodies of two shafts face each other: wheel, pinion, shaft,
    bearing. widths: minimum of each stage, others (M, N): minimum length that the stages before one
    add. aim (8,): maximum width, height and length; constant of the objective and its factor of the
    length; exponents of width and height; 1 for the longest side.
    """

    torque: float
    low_ratio: float
    log_low: float
    log_high: float
    cosine: Array
    addenda: Array
    sizes: Array
    distance: Index
    stride: Index
    fits: NDArray[np.bool_]
    delta: float
    start: Index
    z1: Array
    z2: Array
    toothing: Index
    log_ratio: Array
    need: Array
    first: Index
    last: Index
    least_steps: Array
    most_steps: Array
    modules: Array
    exponent: Array
    kind: Index
    low: Array
    high: Array
    given: Array
    load: Array
    bisected: Array
    row: Index
    cell: Index
    step: float
    least_before: Array
    shaft: Array
    bearing: Array
    gap: Array
    ends: float
    motor: float
    faces: NDArray[np.uint8]
    slabs: Index
    slab_of: Index
    widths: Array
    others: Array
    aim: Array


class Rest(NamedTuple):
    """Minimum cost of stages 0..k-1, by cell of their log ratio; filled in by the kernel.

    least (N, N, cells): minimum width of each stage. edge (N, bins): tip radii of wheel k - 1.
    front (N, M, cells, bins): length that is added in slabs of their own.
    """

    least: Array
    edge: Array
    front: Array


def frame(train: Train, make: Make) -> Gearbox:
    """Return a gearbox with the constants of all, whose shafts carry the input torque.

    SolveError where its pairs are not those it is made of, where face widths decide which bodies
    face each other, or where profile shifts that are given do not cancel.
    """
    pairs = _loaded_like(train, 1.0)
    box = make(pairs)
    if box.pairs != pairs:
        raise SolveError("the gearbox must have the gear pairs that it is made of")
    _refuse(train, box)
    return box


def numbers(train: Train, make: Make, tables: Sequence[Table] = ()) -> tuple[Drive, Gearbox]:
    """Return the arrays of a drive, and a gearbox with its constants; SolveError as in `frame`.

    tables: those of the stages, where they are known.
    """
    stages = train.stages
    tables = tables or [table(train, k, train.highest_ratio) for k in range(len(stages))]
    cells = int(math.log(train.highest_ratio) / DELTA) + 2
    box = frame(train, make)
    boxes = [make(_loaded_like(train, math.exp(c * DELTA))) for c in range(cells)]
    slabs, faces = _facing(box)
    wide = max(s.bearing_width for s in box.shafts)
    gap = box.clearances
    end = max(gap.axial, wide) if box.partial else gap.axial + wide
    power, factor = _objective(box)
    maximum = (min(box.largest[0], box.width or math.inf), *box.largest[1:])
    before = [math.prod(float(s.ratio[0]) for s in stages[:k]) for k in range(len(stages))]
    columns: tuple[Any, ...] = (
        train.torque,
        float(train.lowest_ratio),
        math.log(train.lowest_ratio),
        math.log(train.highest_ratio),
        np.array([s.toothing.cosine for s in stages]),
        np.array([s.toothing.addenda for s in stages]),
        _sizes(train, tables),
        *_distances(train, tables),
        DELTA,
        *_pairs(tables),
        *_stages(train, tables),
        *_loads(train, tables),
        np.array(before),
        np.array([[b.shafts[x].radius for b in boxes] for x in range(len(box.shafts))]),
        np.array([[_bearing(b.shafts[x]) for b in boxes] for x in range(len(box.shafts))]),
        np.array([gap.gears, gap.shafts, gap.wall, gap.axial]),
        2.0 * end,
        box.motor,
        faces,
        np.array([len(s) for s in slabs]),
        np.array([[_slab(s, k) for k in range(len(stages))] for s in slabs]),
        np.zeros(len(stages)),
        np.zeros((len(slabs), len(stages))),
        np.array([*maximum, *factor, *power, float(box.objective == "longest_side")]),
    )
    return Drive(*columns), box


def _loaded_like(train: Train, ratio: float) -> tuple[GearPair, ...]:
    """Return gear pairs whose shafts all carry the torque behind a ratio."""
    pairs = []
    for k, stage in enumerate(train.stages):
        z = float(stage.pinion_teeth[0])
        pairs.append(GearPair.of_teeth(float(stage.modules[0]), z, z if k else z * ratio, 1.0))
    return tuple(pairs)


def _follows(train: Train) -> bool:
    """Whether the sizes of gears follow from more than teeth and module of their stage."""
    return train.several_toothings or any(s.toothing.shifting is not None for s in train.stages)


def _sizes(train: Train, tables: Sequence[Table]) -> Array:
    """Return centre distances and tip radii of all pairs and modules; NaN: none of its modules."""
    if not _follows(train):
        return np.zeros((0, 0, 3))
    count, most = sum(len(t.z1) for t in tables), max(len(t.modules) for t in tables)
    if count * most > ENTRIES:
        raise SolveError(
            f"the stages have {count:,} ways of cutting a pair to choose from, too many beside a "
            "box: give fewer teeth, distances, helix angles or shifts"
        )
    sizes = np.full((count, most, 3), np.nan)
    stop = 0
    for t in tables:
        start, stop = stop, stop + len(t.z1)
        every = np.arange(len(t.z1))
        for k, module in enumerate(t.modules):
            pair = t.made(np.full(len(every), module), every)
            radii = (0.5 * gear.tip_diameter for gear in pair.gears)
            for place, length in enumerate((pair.centre_distance, *radii)):
                sizes[start:stop, k, place] = length
    return sizes


def _distances(train: Train, tables: Sequence[Table]) -> tuple[Index, Index, NDArray[np.bool_]]:
    """Return distance, stride and fits of a `Drive`: all are 0 and fit where none are bound."""
    count, pairs = len(tables), sum(len(t.z1) for t in tables)
    if not train.distances:
        return np.zeros(pairs, np.int64), np.zeros(count, np.int64), np.ones((count, 1), bool)
    known = [sorted(set(column)) for column in zip(*train.distances, strict=True)]
    rows = np.array(
        [[k.index(a) for k, a in zip(known, row, strict=True)] for row in train.distances]
    )
    sizes = [len(k) + 1 for k in known]  # the last one: of a distance that goes with none
    stride = np.cumprod([1, *sizes[:-1]])
    fits = np.zeros((count, math.prod(sizes)), bool)
    for j in range(count):
        fits[j, rows[:, j:] @ stride[j:]] = True
    numbers = []
    for t, one in zip(tables, known, strict=True):
        of_cut = [
            one.index(a) if (a := cut.working_distance) in one else len(one)
            for cut in t.stage.toothings
        ]
        numbers.append(np.array(of_cut, np.int64)[t.toothing])
    return np.concatenate(numbers), stride, fits


def _bearing(shaft: Shaft) -> float:
    return shaft.bearing_radius if shaft.bearing_width > 0 else 0.0


def _slab(slabs: Slabs, stage: int) -> int:
    return next(k for k, own in enumerate(slabs) if stage in own)


def _refuse(train: Train, box: Gearbox) -> None:
    if not all(t.on_reference or t.shifting is not None for s in train.stages for t in s.toothings):
        raise SolveError("together with its layout, a drive needs profile shifts that cancel")
    if not train.rated and not all(s.face_width.plain for s in train.stages):
        raise SolveError("together with its layout, face widths have limits of b/d1 alone")
    choice = any(not s.face_width.tied and s.face_width.fixed is None for s in train.stages)
    shared = box.slabs is None or any(len(s) > 1 for s in box.slabs)
    widest = max(s.bearing_width for s in box.shafts)  # up to the gap, a bearing stays in it
    bearings = box.partial and widest > (0.0 if shared else box.clearances.axial)
    along = any(k.x != ANYWHERE for k in box.keep_outs)
    if choice and (along or (bearings and len(box.pairs) > 2)):
        what = "keep-outs with a range of x" if along else "bearings beside gears"
        raise SolveError(f"together with {what}, face widths must be tied to d1 or given")


def _objective(box: Gearbox) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the exponents of width and height; constant and factor of the length."""
    if box.objective == "longest_side":
        return (1.0, 1.0), (box.width or 0.0, 0.0)
    wide = box.objective in ("box_volume", "plan_area", "face_area", "width")
    high = box.objective in ("box_volume", "face_area", "height")
    size = box.width if box.width is not None and wide else 1.0
    factor = (0.0, size) if box.objective in ("box_volume", "plan_area") else (size, 0.0)
    return (float(wide and box.width is None), float(high)), factor


def _facing(box: Gearbox) -> tuple[list[Slabs], NDArray[np.uint8]]:
    """Return orders of slabs undominated for any sizes, and the bodies that face each other."""
    shafts = tuple(Shaft(1.0, 1.0, 0.0 if box.partial else s.bearing_width) for s in box.shafts)
    alike = replace(box, pairs=(GearPair.of_teeth(1.0, 2, 2, 1.0),) * len(box.pairs), shafts=shafts)
    undominated: list[tuple[Slabs, NDArray[np.uint8]]] = []
    for slabs in (box.slabs,) if box.slabs is not None else orders(box):
        new = (slabs, _faces(alike, slabs))
        if not any(_no_worse(old, new) for old in undominated):
            undominated = [old for old in undominated if not _no_worse(new, old)] + [new]
    return [slabs for slabs, _ in undominated], np.stack([faces for _, faces in undominated])


def _no_worse(a: tuple[Slabs, NDArray[np.uint8]], b: tuple[Slabs, NDArray[np.uint8]]) -> bool:
    """Return whether the same stages share slabs and bodies of a face each other only as in b."""
    return sorted(a[0]) == sorted(b[0]) and bool((a[1] <= b[1]).all())


def _faces(box: Gearbox, slabs: Slabs) -> NDArray[np.uint8]:
    """Which bodies of the shafts stand side by side and do not mesh: 1, (N+1, 4, N+1, 4)."""
    bodies = arrange(box, slabs).bodies
    facing = np.zeros((len(bodies), 4, len(bodies), 4), np.uint8)
    for x, of_shaft in enumerate(bodies):
        for y, other in enumerate(bodies):
            for p in of_shaft:
                for q in other:
                    if x != y and face_each_other(p, q):
                        facing[x, _kind(p.name), y, _kind(q.name)] = 1
    return facing


def _kind(name: str) -> int:
    return ("wheel", "pinion", "shaft", "bearing").index(name.split()[0])


def _pairs(tables: Sequence[Table]) -> tuple[Any, ...]:
    """Return the start of each stage's pairs, and their numbers one after the other."""
    start = np.concatenate([[0], np.cumsum([len(t.z1) for t in tables])])
    columns = [
        np.concatenate([np.asarray(getattr(t, name), kind) for t in tables])
        for name, kind in (
            ("z1", float),
            ("z2", float),
            ("toothing", np.int64),
            ("log_ratio", float),
            ("need", float),
            ("first", np.int64),
            ("last", np.int64),
        )
    ]
    maximum = max(len(t.modules) for t in tables)
    stepped = any(t.steps is not None for t in tables)
    steps = [
        np.zeros((maximum if stepped else 1, int(start[-1]) if stepped else 1)) for _ in range(2)
    ]
    for k, t in enumerate(tables):
        if t.steps is not None:
            for steps_of_stage, values in zip(steps, t.steps, strict=True):
                steps_of_stage[: len(t.modules), start[k] : start[k + 1]] = values
    return start, *columns, *steps


def _stages(train: Train, tables: Sequence[Table]) -> tuple[Array, ...]:
    """Numbers of whole stages, from modules to face widths."""
    faces = [s.face_width for s in train.stages]
    modules = np.full((len(tables), max(len(t.modules) for t in tables)), np.inf)
    for k, t in enumerate(tables):
        modules[k, : len(t.modules)] = t.modules
    kinds = [
        3 if f.step is not None else 2 if f.fixed is not None else 0 if f.tied else 1 for f in faces
    ]
    return (
        modules,
        np.array([t.exponent for t in tables]),
        np.array(kinds),
        np.array([float(f.low) for f in faces]),
        np.array([math.inf if f.high is None else float(f.high) for f in faces]),
        np.array([float(f.step or f.fixed or 0) for f in faces]),
    )


def _loads(train: Train, tables: Sequence[Table]) -> tuple[Array, Array, Index, Index, float]:
    """Return the loads of all pairs, or minimum widths by cells of torque (up to ENTRIES).

    Of ratings these are the narrowest widths, in one cell: `search.narrower` makes others of them.
    """
    loads = [t.load for t in tables if t.load is not None]
    span = math.log(train.highest_ratio) + 2.0 * DELTA
    none = np.zeros(1, np.int64)
    if loads and not train.rated:
        return np.concatenate(loads), np.empty((0, 0)), none, none, span
    pairs, modules = sum(len(t.z1) for t in tables), max(len(t.modules) for t in tables)
    cells = max(1, min(math.ceil(span / DELTA), ENTRIES // max(1, pairs * modules)))
    cells = 1 if train.rated else cells
    step = span / cells
    widths = np.full((pairs, cells, modules), np.inf)
    stop = 0
    for t in tables:
        start, stop = stop, stop + len(t.z1)
        every = np.arange(len(t.z1))
        for cell in range(cells):
            torque = np.full(len(t.z1), train.torque * math.exp(cell * step))
            for k in range(len(t.modules)):
                narrowest = (
                    t.narrowest(k) if isinstance(t, RatedTable) else t.width(torque, every, k)
                )
                widths[start:stop, cell, k] = narrowest
    rows = cells * np.arange(pairs + 1)
    return np.empty(0), widths.reshape(-1, modules), rows, np.zeros(pairs, np.int64), step


def useful(drive: Drive, cut: float) -> Drive:
    """Return the drive with those pairs alone whose stage does not exceed the cut by itself."""
    kernels = kernel(KERNELS)
    for _ in range(ROUNDS):
        keep = np.zeros(drive.z1.size, bool)
        count = drive.kind.size
        widths = np.array([kernels.useful(drive, j, cut, keep) for j in range(count)])
        kept = np.concatenate([[0], np.cumsum(keep)])[drive.start]
        names = ("z1", "z2", "toothing", "distance", "log_ratio", "need", "first", "last")
        fewer = {n: getattr(drive, n)[keep] for n in names}
        fewer["load"] = drive.load[keep] if drive.load.size else drive.load
        if not drive.load.size:
            count_of = np.diff(drive.row)
            fewer["bisected"] = drive.bisected[np.repeat(keep, count_of)]
            fewer["row"] = np.concatenate([[0], np.cumsum(count_of[keep])])
            fewer["cell"] = drive.cell[keep]
        if drive.least_steps.shape[1] == keep.size:
            steps = {n: getattr(drive, n)[:, keep] for n in ("least_steps", "most_steps")}
            fewer |= {n: np.ascontiguousarray(v) for n, v in steps.items()}
        if drive.sizes.size:
            fewer["sizes"] = drive.sizes[keep]
        widths = np.where(np.isfinite(widths), widths, 0.0)
        others = _others(drive, widths)
        drive = drive._replace(start=kept, widths=widths, others=others, **fewer)
    return drive


def _others(drive: Drive, widths: Array) -> Array:
    """Return the minimum length that stages before each one add in own slabs, (M, N)."""
    added = np.zeros_like(drive.others)
    for m, slab in enumerate(drive.slab_of):
        for j in range(1, widths.size):
            alone = [s for s in range(drive.slabs[m]) if not (slab[j:] == s).any()]
            added[m, j] = sum(widths[:j][slab[:j] == s].max() for s in alone)
    return added


def rest(drive: Drive, goes_on: GoesOn) -> Rest | None:
    """Return the tables of the stages before each one; None if stopped."""
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
    rows = slice(drive.start[j], drive.start[j + 1]) if j >= 0 else slice(0, 0)
    if drive.sizes.size:
        return _bins(_of_wheels(drive, rows))
    modules = drive.modules[j][drive.first[rows]], drive.modules[j][drive.last[rows]]
    cosine, addendum = drive.cosine[j], drive.addenda[j, 1]
    radii = [m * (0.5 * drive.z2[rows] / cosine + addendum) for m in modules]
    return _bins(np.concatenate(radii))


def _of_wheels(drive: Drive, rows: slice) -> Array:
    """Return the tip radii of wheels, of all their modules."""
    first, last = drive.first[rows, None], drive.last[rows, None]
    module = np.arange(drive.sizes.shape[1])
    return np.asarray(drive.sizes[rows, :, 2][(first <= module) & (module <= last)])


def _bins(radii: Array) -> Array:
    """Return BINS radii from the least to the largest; zeros of none."""
    if not radii.size:
        return np.zeros(BINS)
    return np.geomspace(radii.min() * (1.0 - 1e-9), radii.max(), BINS)


def chains(drive: Drive, box: Gearbox) -> list[Chain]:
    """For each first stage, a chain of the shafts from there on, for the kernel to fill."""
    links = []
    for first in range(drive.kind.size):
        shafts = drive.kind.size + 1 - first
        place = np.tile([-np.inf, np.inf], (shafts, 2))
        for p in box.places if first == 0 else ():
            place[p.shaft] = (*p.y, *p.z)
        level = sorted(box.level) if first == 0 else []
        links.append(
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
    return links
