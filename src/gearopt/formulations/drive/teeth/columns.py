"""Tooth pairs of one stage within its limits; ties are decided in fractions."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.formulations.drive.shares import least_share
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.profile_shift import SUMS, Meshing

Index = NDArray[np.int64]
Columns = tuple[Any, ...]
Ranges = tuple[tuple[int, int, int], ...]  # pinion teeth, with the first and last of the wheel

PAIRS = 3_000_000  # tooth pairs of one stage: about 1 GB of tables
KEPT, KEPT_PAIRS = 128, 200_000  # tables of teeth at given distances that are kept; their pairs
NO_WIDTH = 1e12  # in modules: of teeth that never overlap
NEAR = 1e-9  # of a sum of profile shifts beside its ends, which is looked at


@dataclass(frozen=True)
class _Rows:
    """Tooth pairs (n,), which toothing cuts each, and columns of `Table` of the same names."""

    z1: Index
    z2: Index
    toothing: Index
    first: Index
    last: Index
    steps: tuple[Array, Array] | None


def columns(train: Train, position: int, cut: Fraction, tick: Callable[[], float]) -> Columns:
    """Return the fields of the table of a stage (counted from 0) for ratios up to `cut`.

    tick: called several times a second; what it raises ends the work.
    """
    tick()
    stage = train.stages[position]
    ranges = tuple(spans(train, position, cut))
    blocks = []
    for toothings in _toothings_by_helix(stage):
        tick()
        blocks.append(_block(stage, _few_enough_ranges(stage, ranges), train.coprime, toothings))
    rows = blocks[0] if len(blocks) == 1 else _rows_by_ratio(blocks)
    ratio = rows.z2 / rows.z1
    load, need, exponent, slope = closed(train, position, rows.z1, ratio)
    tick()
    return (
        train,
        position,
        rows.z1,
        rows.z2,
        rows.toothing,
        ratio,
        np.log(ratio),
        np.array([float(m) for m in stage.modules]),
        rows.first,
        rows.last,
        rows.steps,
        load,
        need,
        exponent,
        slope,
        cut,
    )


def closed(
    train: Train, position: int, z1: Index, ratio: Array
) -> tuple[Array | None, Array, float, Array]:
    """Return load, need, exponent and slope of a `Table`."""
    stage = train.stages[position]
    cosine = stage.toothing.cosine
    if not train.law.proportional:
        return None, np.zeros_like(ratio), 1.0, np.zeros_like(ratio)
    one = stage.toothing.of_diameter(1.0, z1, z1 / cosine, ratio, 1.0)
    load = train.law.largest_utilisation(one, 1.0, 0.0, stage.allowable)
    slope = np.zeros_like(ratio)
    if train.objective in ("gear_volume", "mass"):  # no module counts: d1 is 1 mm here
        size = load * (z1 / cosine) ** 2  # b d1^2 for a torque of 1 N mm
        slope = np.asarray(least_share(train, position, GearPair.of_teeth(1.0, 1.0, ratio, size)))
    face = stage.face_width
    if face.fixed is not None:
        return load, (load / float(face.fixed)) ** 0.5, 0.5, slope
    widest = face.widest * z1 / cosine  # b/m_n
    if face.over_module[1] is not None:
        widest = np.minimum(widest, float(face.over_module[1]))
    return load, (load / widest) ** (1.0 / 3.0), 1.0 / 3.0, slope


def _toothings_by_helix(stage: Stage) -> list[list[int]]:
    """Return the toothings of a stage by helix angle."""
    by_angle: dict[float, list[int]] = {}
    for k, toothing in enumerate(stage.toothings):
        by_angle.setdefault(toothing.helix_angle, []).append(k)
    return list(by_angle.values())


def _block(stage: Stage, ranges: Ranges, coprime: bool, toothings: list[int]) -> _Rows:
    """Return tooth pairs of some ranges as they are cut by some toothings of one helix angle."""
    cut = stage.toothings[toothings[0]]
    cosine, stage = cut.cosine, _stage_of_overlap(stage, cut)
    if cut.shift_sum is not None:
        z1, z2, toothing = _of_sums(stage, *_pairs(ranges, coprime), np.array(toothings))
        ends = None
    elif cut.shifting is None:
        (z1, z2), ends = _pairs(ranges, coprime), None
        if stage.planetary:
            keep = stage.possible(z1, z2)
            z1, z2 = z1[keep], z2[keep]
        toothing = np.full(len(z1), toothings[0])
    else:
        cuts = tuple(stage.toothings[k] for k in toothings)
        few = sum(stop - start + 1 for _, start, stop in ranges) * len(cuts) <= KEPT_PAIRS
        meshing = _meshing_pairs if few else _meshing_pairs.__wrapped__
        z1, z2, row, ends = meshing(stage.modules, cuts, ranges, coprime)
        toothing = np.array(toothings)[row]
    first, last = _module_ends(stage, z1, z2, cosine)
    if ends is not None:
        first, last = np.maximum(first, ends[0]), np.minimum(last, ends[1])
    return _Rows(z1, z2, toothing, first, last, _steps(stage, z1, cosine))


def _stage_of_overlap(stage: Stage, cut: Toothing) -> Stage:
    """A stage whose widths over module are those of its overlap ratio at least, with a toothing.

    What is irrational has no tie; of spur gears no width has any overlap.
    """
    if not stage.overlap:
        return stage
    sine, face = math.sin(abs(cut.helix_angle)), stage.face_width
    least = Fraction(stage.overlap * math.pi / sine if sine else NO_WIDTH)
    over = max(least, face.over_module[0] or least), face.over_module[1]
    return replace(stage, face_width=replace(face, over_module=over))


def _rows_by_ratio(blocks: list[_Rows]) -> _Rows:
    """Return the rows of all blocks by ratio, then by teeth, then by toothing."""

    def column(name: str) -> Any:
        return np.concatenate([getattr(block, name) for block in blocks])

    z1, z2, toothing = column("z1"), column("z2"), column("toothing")
    order = np.lexsort((toothing, z1, z2 / z1))
    steps = None
    if blocks[0].steps is not None:
        ends = zip(*(block.steps for block in blocks if block.steps is not None), strict=True)
        low, high = (np.concatenate(end, axis=1)[:, order] for end in ends)
        steps = low, high
    first, last = column("first")[order], column("last")[order]
    return _Rows(z1[order], z2[order], toothing[order], first, last, steps)


def _few_enough_ranges(stage: Stage, ranges: Ranges) -> Ranges:
    """The ranges of the wheels of a stage; SolveError where they are too many for the memory."""
    helices = len(
        _toothings_by_helix(stage) if stage.toothing.shift_sum is None else stage.toothings
    )
    count = sum(stop - start + 1 for _, start, stop in ranges) * helices
    if count > PAIRS:
        raise SolveError(
            f"a stage has {count:,} tooth pairs to choose from: narrow its pinion teeth, or limit "
            "its wheel teeth or ratio (pinion_teeth, wheel_teeth, stage_ratio)"
        )
    return ranges


def _pairs(ranges: Ranges, coprime: bool) -> tuple[Index, Index]:
    """Return all (z1, z2) of ranges, by ratio, then by teeth."""
    wheels = [np.arange(start, stop + 1, dtype=np.int64) for _, start, stop in ranges]
    z1 = np.repeat([z for z, _, _ in ranges], [len(w) for w in wheels]).astype(np.int64)
    z2 = np.concatenate(wheels)
    if coprime:
        keep = np.gcd(z1, z2) == 1
        z1, z2 = z1[keep], z2[keep]
    order = np.argsort(z2 / z1, kind="stable")
    return z1[order], z2[order]


def spans(train: Train, position: int, cut: Fraction) -> list[tuple[int, int, int]]:
    """Return every pinion z1 of a stage with its minimum and maximum wheel teeth up to a ratio.

    The maximum is one below the minimum where there are none. Wheels that are too large with the
    smallest module are left out.
    """
    stage = train.stages[position]
    low = max(stage.ratio[0], train.lowest_ratio) if len(train.stages) == 1 else stage.ratio[0]
    high = cut if stage.ratio[1] is None else min(cut, stage.ratio[1])
    most_wheel = stage.wheel_teeth[1]
    if stage.wheel_diameter is not None:
        widest = max(toothing.cosine for toothing in stage.toothings)
        most = math.floor(stage.wheel_diameter * Fraction(widest) / stage.modules[0])
        most_wheel = most if most_wheel is None else min(most_wheel, most)
    least_z1, most_z1 = stage.pinion_teeth
    assert most_z1 is not None
    found = []
    for z in range(least_z1, most_z1 + 1):
        start = max(stage.wheel_teeth[0], math.ceil(low * z))
        stop = math.floor(high * z)
        stop = stop if most_wheel is None else min(stop, most_wheel)
        found.append((z, start, max(stop, start - 1)))
    return found


def _module_ends(stage: Stage, z1: Index, z2: Index, cosine: float) -> tuple[Index, Index]:
    """Return the first and last module index by wheel diameter and limits of the face width."""
    last = np.full(len(z1), len(stage.modules) - 1, dtype=np.int64)
    exact_cosine = Fraction(cosine)
    if stage.wheel_diameter is not None:
        teeth = [math.floor(stage.wheel_diameter * exact_cosine / m) for m in stage.modules]
        last = np.minimum(last, (np.array(teeth)[:, None] >= z2).sum(axis=0) - 1)
    face = stage.face_width
    if face.fixed is None and face.plain:
        return np.zeros_like(last), last
    pinions, place = np.unique(z1, return_inverse=True)
    ends = [_modules(stage, face.proportions(int(z) / exact_cosine)) for z in pinions]
    first, end = np.array(ends, dtype=np.int64).reshape(-1, 2).T
    return first[place], np.minimum(last, end[place])


@np.errstate(invalid="ignore")
def _fits_distances(stage: Stage, teeth: Index, toothings: Index) -> NDArray[np.bool_]:
    """Whether sums z1 + z2 fit distances, by the sum of shifts: (modules, sums, toothings)."""
    modules = np.array([float(module) for module in stage.modules])[:, None, None]
    cuts = stage.toothing_of(toothings)
    pinions, wheels = np.ones((len(teeth), 1)), teeth[:, None] - 1.0  # of which the sum counts
    shifts = Meshing(
        modules, (pinions, wheels), cuts.helix_angle, cuts.racks, cuts.working_distance
    ).shift_sum
    return np.asarray((shifts >= SUMS[0] - NEAR) & (shifts <= SUMS[1] + NEAR))


def _shiftable(
    stage: Stage, z1: Index, z2: Index, toothing: Index, near: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return whether shifts that a centre distance asks for are allowed: (modules, n).

    near: those that are looked at; others are not.
    """
    shifting = stage.toothing.shifting
    assert shifting is not None
    module, row = np.nonzero(near)
    allowed = np.zeros_like(near)
    sizes = np.array([float(m) for m in stage.modules])
    shifts = stage.toothing_of(toothing[row]).shifts(sizes[module], z1[row], z2[row])
    for limits in (shifting.used_by_gears, shifting.used_in_mesh):
        cut = stage.toothing_of(toothing[row])
        pair = cut.pair(sizes[module], z1[row], z2[row], 1.0, shifts)
        keep = np.logical_and.reduce([used <= 1.0 for used in limits(pair).values()])
        module, row = module[keep], row[keep]
        shifts = shifts[0][keep], shifts[1][keep], shifts[2][keep]
    allowed[module, row] = True
    return allowed


@lru_cache(KEPT)
def _meshing_pairs(
    modules: tuple[Fraction, ...], cuts: tuple[Toothing, ...], ranges: Ranges, coprime: bool
) -> tuple[Index, Index, Index, tuple[Index, Index]]:
    """Return the pairs that centre distances allow, their toothing, first and last module index.

    cuts: toothings of one helix angle. SolveError where a module between them is not allowed: a sum
    of shifts from -1 to 2 leaves room for few. Kept, since safety factors and face widths, which
    remedies move, do not matter.
    """
    stage = Stage((), FaceWidth(Fraction(0), None), modules, (0, None), toothings=cuts)
    toothings, (z1, z2) = np.arange(len(cuts)), _pairs(ranges, coprime)
    sums, place = np.unique(z1 + z2, return_inverse=True)
    distances = np.array([cut.working_distance for cut in cuts])
    _, first_of, distance = np.unique(distances, return_index=True, return_inverse=True)
    near = _fits_distances(stage, sums, toothings[first_of])
    pair, way = np.nonzero(np.asarray(near.any(axis=0))[:, distance][place])
    z1, z2, toothing = z1[pair], z2[pair], toothings[way]
    allowed = _shiftable(stage, z1, z2, toothing, near[:, place[pair], distance[way]])
    keep = allowed.any(axis=0)
    allowed, toothing = allowed[:, keep], toothing[keep]
    first = allowed.argmax(axis=0).astype(np.int64)
    last = len(allowed) - 1 - allowed[::-1].argmax(axis=0).astype(np.int64)
    if np.any(allowed.sum(axis=0) != last - first + 1):
        raise SolveError("modules so close to each other leave gaps at a given centre distance")
    return z1[keep], z2[keep], toothing, (first, last)


def _of_sums(stage: Stage, z1: Index, z2: Index, toothings: Index) -> tuple[Index, Index, Index]:
    """Return the pairs that sums of shifts allow, and their toothing: of some of the stage's.

    Of one module: teeth of any have the same shape.
    """
    pair, way = np.nonzero(np.ones((len(z1), len(toothings)), bool))
    z1, z2, toothing = z1[pair], z2[pair], toothings[way]
    keep = _shiftable(stage, z1, z2, toothing, np.ones((1, len(z1)), bool))[0]
    return z1[keep], z2[keep], toothing[keep]


def _modules(stage: Stage, span: tuple[Fraction, Fraction | None]) -> tuple[int, int]:
    """Return the first and last index of modules with which some b has b/m in a span."""
    face, (low, high) = stage.face_width, span
    narrow, wide = (face.least, None) if face.fixed is None else (face.fixed, face.fixed)
    possible = high is None or low <= high
    possible &= wide is None or wide >= face.least
    first = sum(high is not None and high * m < narrow for m in stage.modules)
    last = sum(wide is None or low * m <= wide for m in stage.modules) - 1
    return first, last if possible else -1


def _steps(stage: Stage, z1: Index, cosine: float) -> tuple[Array, Array] | None:
    """Return the minimum and maximum number of width steps for every module and pair."""
    face = stage.face_width
    if face.step is None:
        return None
    exact_cosine = Fraction(cosine)
    teeth = np.unique(z1)
    place = np.searchsorted(teeth, z1)
    minimum = np.empty((len(stage.modules), len(teeth)))
    maximum = np.empty_like(minimum)
    for k, module in enumerate(stage.modules):
        for i, z in enumerate(teeth):
            low, high = face.proportions(int(z) / exact_cosine)
            assert high is not None
            minimum[k, i] = max(1, math.ceil(max(low * module, face.least) / face.step))
            maximum[k, i] = math.floor(high * module / face.step)
    return minimum[:, place], maximum[:, place]
