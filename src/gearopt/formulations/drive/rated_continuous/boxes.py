"""Boxes of designs of a stage that ratings limit, and the least share of each in the objective.

In a box the ratings ask for no less than some d1^2 b/T: with all else in its least a geometric
program of monomials, which has a closed form.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive.shares import least_share
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength.cells import LOWER, NUDGE, UPPER, Cells
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

ROWS = (
    *("teeth", "width_over_diameter", "diameter", "end", "helix", "pinion_shift", "shift_sum"),
    *("module", "width", "wheel", "ratio"),
)
Z, B_OVER_D, D, END, T, X1, SUM, M, B, D2, U = range(len(ROWS))
# from which the others follow: how much a share changes with them, as with a logarithm
FREE = {Z: 1.0, B_OVER_D: 1.0, D: 1.0, END: 1.0, T: 1.0, X1: 0.5, SUM: 0.25}
LENGTHS = 1e-3, 1e5  # mm: of diameters
NARROWEST, WIDEST = 1e-3, 1e3  # b/d1 without limits
TEETH = 1e6
ROUND = 1e-12  # of logarithms: a box this narrow is a point
MARGIN = 1e-9  # relative, of what is needed: rounding
BEYOND = 1.0 + 3.0 * NUDGE * np.array([-1.0, 1.0])  # so that a module or a width that is given
# counts, at a step of the tolerances, on its better side, too


@dataclass(frozen=True)
class Boxes:
    """Boxes (n,) of designs of a stage.

    sizes (rows, 2, n): logarithms of both ends of ROWS; end: the total ratio behind the last stage,
    else 0; helix: tan(beta) of a stage with a range of it, else 0. Of a range of profile shifts x1
    and x1 + x2 themselves, else 0. before, after (n,): cells of the
    shafts before and after the stage.
    """

    sizes: Array
    before: Any
    after: Any

    @property
    def widths(self) -> Array:
        """Widths (rows, n) of the rows in FREE, those of shifts as of logarithms."""
        return np.asarray(np.diff(self.sizes[list(FREE)], axis=1)[:, 0] * np.c_[[*FREE.values()]])

    def take(self, place: Any) -> "Boxes":
        """Return some of the boxes."""
        return Boxes(self.sizes[:, :, place], self.before[place], self.after[place])

    def __len__(self) -> int:
        return len(self.before)


def joined(boxes: list[Boxes]) -> Boxes:
    """Return all boxes of a list."""
    return Boxes(
        np.concatenate([one.sizes for one in boxes], axis=2),
        np.concatenate([one.before for one in boxes]),
        np.concatenate([one.after for one in boxes]),
    )


@dataclass(frozen=True)
class Shafts:
    """Shafts between the stages of a drive: ln of their torque over the input's, in `count` cells.

    potential (stages + 1,): slope of what is moved from the share of one stage to that of the next,
    about `middle`, at each shaft; it cancels along a drive, and what is left of a share changes
    little with the torques at a good design.
    """

    train: Train
    count: int
    potential: Array
    middle: Array

    @property
    def step(self) -> float:
        """Width of a cell."""
        return math.log(float(self.train.highest_ratio)) / self.count

    @property
    def last(self) -> int:
        """The last stage, from 0."""
        return len(self.train.stages) - 1

    def torques(self, k: int, boxes: Boxes) -> tuple[Array, Array]:
        """Return ln of the torques before and after a stage over the input's, (2, n) each."""
        before = np.stack([boxes.before, boxes.before + 1]) * (self.step if k else 0.0)
        if k == self.last:
            return before, boxes.sizes[END]
        return before, np.stack([boxes.after, boxes.after + 1]) * self.step


def shafts_about(train: Train, count: int, pairs: Sequence[GearPair] = ()) -> Shafts:
    """Return shafts whose potentials are those of a design; none of no pairs."""
    size = len(train.stages) + 1
    potential, middle = np.zeros(size), np.zeros(size)
    for k, pair in enumerate(pairs):
        u = float(pair.ratio)
        middle[k + 1] = middle[k] + math.log(u)
        if k < size - 2:
            power, _, rise = growth(train, k, u)
            potential[k + 1] = float(least_share(train, k, pair)) * (rise - power / (1.0 + u))
    return Shafts(train, count, potential, middle)


def first_boxes(shafts: Shafts, k: int) -> Boxes:
    """Return the boxes of all designs of a stage, one a cell of its shafts."""
    train = shafts.train
    stage, numbers = train.stages[k], dict[str, Any](train.numbers())
    face, last = stage.face_width, k == shafts.last
    sizes = np.empty((len(ROWS), 2))
    sizes[Z] = max(1.0, numbers["pinion_low"][k]), min(TEETH, numbers["pinion_high"][k])
    narrow = float(face.low) or min(NARROWEST, NARROWEST * face.widest)
    wide = face.widest if math.isfinite(face.widest) else max(WIDEST, WIDEST * narrow)
    sizes[B_OVER_D] = narrow, wide
    sizes[D] = LENGTHS
    total = float(train.lowest_ratio), float(train.highest_ratio)
    sizes[END] = total if last else (1.0, 1.0)
    sizes[T] = (1.0, 1.0) if stage.helix is None else np.tan(stage.helix)
    sizes[M] = max(numbers["module_low"][k], 1e-6), min(numbers["module_high"][k], LENGTHS[1])
    sizes[B] = max(float(face.least), 1e-9), LENGTHS[1] * wide
    if face.fixed is not None:
        sizes[B] = float(face.fixed)
    for row in (M, B):
        sizes[row] *= BEYOND
    sizes[D2] = 1e-6, min(numbers["wheel_diameter"][k], LENGTHS[1] * TEETH)
    sizes[U] = float(stage.ratio[0]), min(float(stage.ratio[1] or total[1]), total[1])
    cells = np.arange(shafts.count)
    grid = np.meshgrid(cells if k else cells[:1], cells[:1] if last else cells, indexing="ij")
    i, j = (side.ravel() for side in grid)
    some = (j >= i) | last
    i, j = i[some], j[some]
    sizes[[X1, SUM]] = 1.0
    sizes = np.log(sizes)
    if stage.shifts is not None:
        sizes[[X1, SUM]] = stage.shifts
    return Boxes(np.repeat(sizes[:, :, None], len(i), axis=2), i, j)


def bounded(shafts: Shafts, k: int, boxes: Boxes) -> tuple[Boxes, Array]:
    """Boxes that may hold designs, made as small as limits and ratings allow, and least shares."""
    stage = shafts.train.stages[k]
    before, after = shafts.torques(k, boxes)
    sizes = boxes.sizes.copy()
    sizes[U, 0] = np.maximum(sizes[U, 0], after[0] - before[1] - ROUND)
    sizes[U, 1] = np.minimum(sizes[U, 1], after[1] - before[0] + ROUND)
    follow(shafts.train, k, sizes)
    some = np.flatnonzero(possible(sizes))
    boxes = Boxes(sizes, boxes.before, boxes.after).take(some)
    before, after, sizes = before[:, some], after[:, some], boxes.sizes
    if not len(boxes):
        return boxes, np.zeros(0)
    cells = cells_of(shafts.train, k, sizes, before)
    if stage.shifts is not None:
        some = np.flatnonzero(_may_be_made(stage, cells))
        boxes, before, after = boxes.take(some), before[:, some], after[:, some]
        if not len(boxes):
            return boxes, np.zeros(0)
        sizes, cells = boxes.sizes, cells_of(shafts.train, k, boxes.sizes, before)
    torque = cells.torque
    needed = needed_by_cells(shafts.train, stage, cells)
    weak = _needed_by_weak(stage, cells, shafts.train.safety_of(stage), needed[0])
    most = np.maximum(weak * (1.0 + 1.0 / cells.ratio[1]), needed[1]) * torque[0]
    with np.errstate(divide="ignore"):
        least = np.log(most * (1.0 - MARGIN))  # of d1^2 b = d1^3 (b/d1)
    sizes[D, 0] = np.maximum(sizes[D, 0], (least - sizes[B_OVER_D, 1]) / 3.0)
    sizes[B_OVER_D, 0] = np.maximum(sizes[B_OVER_D, 0], least - 3.0 * sizes[D, 1])
    follow(shafts.train, k, sizes)
    parts = [(needed[0], True, True), (needed[1], False, True), (weak, True, False)]
    value = _bound_by_sizes(shafts, k, sizes, before, after)
    for part in parts:
        value = np.maximum(value, _bound_by_ratings(shafts, k, sizes, part, before, after))
    some = np.flatnonzero(possible(sizes))
    return boxes.take(some), value[some]


def cells_of(train: Train, k: int, sizes: Array, before: Array) -> Cells:
    """Return the designs of boxes as cells; before: ln of the torque before the stage."""
    torque, size, stage = train.torque * np.exp(before), np.exp(sizes), train.stages[k]
    ends = size[Z], size[U], size[D], size[D2], size[M], size[B], size[B_OVER_D]
    by_name = {
        "helix_angle": np.arctan(size[T]),
        "pinion_shift": sizes[X1],
        "shift_sum": sizes[SUM],
    }
    ranges = {name: by_name[name] for name in stage.ranges}
    return Cells(stage.toothing, *ends, torque, train.speed_at(torque)[::-1], ranges)


def _may_be_made(stage: Stage, cells: Cells) -> Any:
    """Return which cells may hold teeth within the limits of chosen profile shifts."""
    shifting = stage.toothing.shifting
    assert shifting is not None
    rows = cells.teeth_alone(shifting.left).values()
    return np.all([~(most < 0.0) for _, most in rows], axis=0)


def possible(sizes: Array) -> Array:
    """Mask of boxes that are not empty; a box empty by rounding alone is made a point."""
    filled = (sizes[:, 1] >= sizes[:, 0] - ROUND).all(axis=0)
    sizes[:, 1] = np.maximum(sizes[:, 0], sizes[:, 1])
    return np.asarray(filled)


def follow(train: Train, k: int, sizes: Array) -> None:
    """Make boxes smaller by the rows that tie their sides, in place."""
    stage = train.stages[k]
    straight, cosine = cosines(stage, sizes)
    numbers = dict[str, Any](train.numbers())
    for name, row in (("wheel_low", 0), ("wheel_high", 1)):
        with np.errstate(divide="ignore"):
            end = np.log(numbers[name][k])
        pick = (np.maximum, np.minimum)[row]
        sizes[Z, row] = pick(sizes[Z, row], end - sizes[U, 1 - row])
    low, high = stage.face_width.over_module
    if low is not None:
        sizes[B_OVER_D, 0] = np.maximum(sizes[B_OVER_D, 0], math.log(low) + cosine - sizes[Z, 1])
    if high is not None:
        high_over_d = math.log(high) + straight
        sizes[B_OVER_D, 1] = np.minimum(sizes[B_OVER_D, 1], high_over_d - sizes[Z, 0])
        sizes[Z, 1] = np.minimum(sizes[Z, 1], high_over_d - sizes[B_OVER_D, 0])
    ties = (D, M, Z, (-straight, -cosine)), (B, B_OVER_D, D, (0.0, 0.0)), (D2, D, U, (0.0, 0.0))
    for _ in range(2):
        for whole, side, other, (least, most) in ties:
            (a_low, a_high), (b_low, b_high) = sizes[side], sizes[other]
            a_low, a_high, (c_low, c_high) = a_low + least, a_high + most, sizes[whole]
            sizes[whole] = np.maximum(c_low, a_low + b_low), np.minimum(c_high, a_high + b_high)
            c_low, c_high = sizes[whole]
            sizes[side, 0] = np.maximum(a_low - least, c_low - b_high - most)
            sizes[side, 1] = np.minimum(a_high - most, c_high - b_low - least)
            sizes[other] = np.maximum(b_low, c_low - a_high), np.minimum(b_high, c_high - a_low)


def cosines(stage: Stage, sizes: Array) -> tuple[Any, Any]:
    """Logarithms of cos(beta), the greatest and the least, of boxes."""
    if stage.helix is None:
        return (math.log(stage.toothing.cosine),) * 2
    least, most = -0.5 * np.log1p(np.exp(2.0 * sizes[T]))
    return least, most


def body_squares(stage: Stage, sizes: Array) -> tuple[Any, Any]:
    """Least squares of the diameter d + 2 x m_n of the bodies over d, of pinion and wheel."""
    if stage.shifts is None:
        return 1.0, 1.0
    (x_low, x_high), (sum_low, _) = sizes[X1], sizes[SUM]
    cosine, squares = cosines(stage, sizes), []
    for x, rows in ((x_low, [Z]), (sum_low - x_high, [Z, U])):
        most = cosine[0] - sizes[rows, LOWER].sum(axis=0)  # of m_n/d, logarithms
        least = cosine[1] - sizes[rows, UPPER].sum(axis=0)
        part = 1.0 + 2.0 * x * np.exp(np.where(x > 0.0, least, most))
        squares.append(np.maximum(part, 0.0) ** 2)
    return squares[0], squares[1]


def needed_by_cells(train: Train, stage: Stage, cells: Cells) -> tuple[Array, Array]:
    """Return the least d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending [1/MPa].

    An index of a proportional law over 1 + 1/u falls neither with z1 nor with u (`Law`).
    """
    zero, u = np.zeros(cells.teeth.shape[1]), cells.ratio[LOWER]
    needs = [(zero, zero)]
    with np.errstate(all="ignore"):
        if train.law.limits and train.law.proportional:
            z = cells.teeth[LOWER]
            pair = cells.toothing.of_diameter(cells.toothing.cosine / z, z, 1.0, u, 1.0)
            load = train.law.largest_utilisation(pair, 1.0, cells.speed[LOWER], stage.allowable)
            needs.append((load / (1.0 + 1.0 / u), zero))
        given = stage.toothing.working_distance is not None  # then teeth alone say little
        for standard in stage.options[0].standards if stage.options and not given else ():
            needs.append(standard.needed(cells, train.safety_of(stage)))
    pressed, bent = (np.maximum.reduce([one[i] for one in needs]) for i in (0, 1))
    return np.nan_to_num(pressed, nan=0.0), np.nan_to_num(bent, nan=0.0)


def _needed_by_weak(stage: Any, cells: Cells, safety: Any, usual: Array) -> Array:
    """Return the least of contact that holds with the least torque: T K(T) does not fall with T."""
    standards = [one for option in stage.options[:1] for one in option.standards]
    standards = [one for one in standards if not one.monotone]
    given = cells.toothing.working_distance is not None
    if given or not standards or np.array_equal(*cells.torque):
        return usual
    weak = replace(cells, torque=np.stack([cells.torque[LOWER]] * 2))
    with np.errstate(all="ignore"):
        needs = [np.nan_to_num(one.needed(weak, safety)[0], nan=0.0) for one in standards]
    return np.asarray(np.maximum.reduce([usual, *needs]))


def _potential_change(shafts: Shafts, k: int, before: Any, after: Any) -> Any:
    """Addition of the potentials of `Shafts` to the share of a stage, by torques at its shafts."""
    (first, second), (at, then) = shafts.potential[k : k + 2], shafts.middle[k : k + 2]
    return first * (before - at) - second * (after - then)


def _bound_by_sizes(shafts: Shafts, k: int, sizes: Array, before: Array, after: Array) -> Array:
    """Lower bound of the share of designs in boxes, potentials added, by their least sizes."""
    share, moved = _least_sizes(shafts, k, sizes, before, after)
    return np.asarray(share * (1.0 - MARGIN) + moved)


def _least_sizes(
    shafts: Shafts, k: int, sizes: Array, before: Array, after: Array
) -> tuple[Array, Array]:
    """Terms of `_bound_by_sizes`: share at the least sizes, least addition of the potentials."""
    size = np.exp(sizes[:, LOWER])
    stage = shafts.train.stages[k]
    pair = stage.toothing.by_reference.of_diameter(size[M], size[Z], size[D], size[U], size[B])
    if stage.shifts is not None:
        rows = zip(pair.gears, body_squares(stage, sizes), strict=True)
        bodies = (replace(g, body_diameter=g.reference_diameter * s**0.5) for g, s in rows)
        pair = GearPair(*bodies)
    first, second = shafts.potential[k : k + 2]
    moved = _potential_change(shafts, k, before[int(first < 0.0)], after[int(second > 0.0)])
    fewest = size[Z], size[Z] * size[U]
    own_share = least_share(shafts.train, k, pair, fewest=fewest)
    return np.asarray(own_share), moved


def _bound_by_ratings(
    shafts: Shafts, k: int, sizes: Array, needed: Any, before: Array, after: Array
) -> Array:
    """Return the least share of designs that the ratings may accept.

    needed: d1^2 b over 1 + 1/u (or not) and over T (or the least T), and whether. The share is
    convex in the logarithms t and e of the torques before and after: above its tangent.
    """
    coefficient, pressed, loaded = needed
    t, e = before.mean(axis=0), after.mean(axis=0)
    half = 0.5 * (before[1] - before[0]), 0.5 * (after[1] - after[0])
    first, second = shafts.potential[k : k + 2]
    u, power = np.exp(e - t), 1.0
    power, grown, rise = growth(shafts.train, k, u, body_squares(shafts.train.stages[k], sizes))
    wide, slope = (1.0 + 1.0 / u, 1.0 / (1.0 + u)) if pressed else (1.0, 0.0)
    least = shafts.train.torque * np.exp(t if loaded else before[0]) * coefficient * wide
    if not shafts.train.by_width:
        least = least / np.exp(sizes[B_OVER_D, 1])
    value = least**power * grown * (1.0 - MARGIN)
    by_t, by_e = value * (power * (loaded + slope) - rise), value * (rise - power * slope)
    lost = np.abs(by_t + first) * half[0] + np.abs(by_e - second) * half[1]
    return np.asarray(value + _potential_change(shafts, k, t, e) - lost)


def cut(shafts: Shafts, k: int, boxes: Boxes, limit: Array) -> Boxes:
    """Boxes without designs whose share, less the potentials' addition, exceeds a limit (n,)."""
    before, after = shafts.torques(k, boxes)
    sizes = boxes.sizes.copy()
    share, moved = _least_sizes(shafts, k, sizes, before, after)
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.log((limit - moved) / share) + MARGIN
    room = np.where(np.isfinite(room), np.maximum(room, 0.0), np.inf)
    power = 2.0 if shafts.train.by_width and not shafts.train.hollow else 1.0
    sizes[D, 1] = np.minimum(sizes[D, 1], sizes[D, 0] + room / power)
    if shafts.train.by_width:
        sizes[B, 1] = np.minimum(sizes[B, 1], sizes[B, 0] + room)
    return Boxes(sizes, boxes.before, boxes.after)


def growth(
    train: Train, k: int, u: Any, bodies: tuple[Any, Any] = (1.0, 1.0)
) -> tuple[float, Any, Any]:
    """Return p, and of a ratio u the share over (d1^2 b)^p and its slope in logarithms.

    Of lengths p is 1/3, and b = d1. bodies: squares of the diameters of bodies over those of
    reference circles, of pinion and wheel.
    """
    power, exponent = (1.0, 2.0) if train.by_width else (1.0 / 3.0, 1.0)
    tooth = train.stages[k].toothing.by_reference
    pairs = [tooth.of_diameter(1.0, 20.0, 1.0, x, 1.0) for x in (1.0, 2.0)]
    single, double = (least_share(train, k, pair) for pair in pairs)
    of_wheel = (double - single) / (2.0**exponent - 1.0)  # of u = 1
    rising = of_wheel * bodies[1] * u**exponent
    grown = (single - of_wheel) * bodies[0] + rising
    return power, grown, exponent * rising / grown
