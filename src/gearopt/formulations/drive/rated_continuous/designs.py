"""Designs of a drive that ratings limit, found by trying: in boxes, and near a design."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from itertools import product
from typing import Any

import numpy as np

from gearopt.formulations.drive.rated_continuous.boxes import (
    B_OVER_D,
    D2,
    ROUND,
    SUM,
    X1,
    B,
    D,
    M,
    T,
    U,
    Z,
    first_boxes,
    shafts_about,
)
from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength import ALLOWANCE
from gearopt.formulations.strength.standard import Rows, Standard
from gearopt.formulations.strength.widths import Standing
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

TRIED = 48  # diameters
# teeth, helix angles, shifts that are tried each, of so many of them; within a box, in polishing
SIDES = {False: (1, 5, 4, 3, 2), True: (1, 9, 7, 5, 3)}
ABOVE = 0.02  # at least, of a box, within which a diameter is looked for
RATIO_TIE = 1e-10  # of ratios
FIRST_STEP, LAST_STEP = 0.18, 1e-5  # of logarithms, by which a design is moved
SHORTER = 0.4  # of a step that gained little
LITTLE = 1e-4  # of the value

Design = tuple[tuple[GearPair, ...], float]  # pairs and value


def design_in_boxes(
    train: Train, after: Sequence[float], smallest: Callable[..., GearPair | None]
) -> Design | None:
    """Return the pairs of a drive, each the smallest in the box of its stage, and the objective.

    None where a box holds no pair or the total ratio misses its limits. after (stages,):
    ln(T/T_in) behind each stage. smallest(k, before, after): a pair of ratio near exp(after -
    before).
    """
    pairs, value, at = [], 0.0, 0.0
    for k, then in enumerate(after):
        pair = smallest(k, at, then)
        if pair is None:
            return None
        pairs.append(pair)
        value += float(objective_share(train, k, pair))
        at += math.log(pair.ratio)
    low, high = float(train.lowest_ratio), float(train.highest_ratio)
    good = math.log(low) - RATIO_TIE <= at <= math.log(high) + RATIO_TIE
    return (tuple(pairs), value) if good else None


def polished(train: Train, best: Design, clock: Clock) -> Design:
    """Return the best design near a design: ratios, teeth, b/d1, shifts in ever shorter steps.

    The design need not be one that the ratings accept; only better ones than its value count.
    """
    size = FIRST_STEP
    while size > LAST_STEP and clock.tell():
        pairs, before = best
        at = np.cumsum([math.log(float(pair.ratio)) for pair in pairs])
        boxes = [_around(train, k, pair, size) for k, pair in enumerate(pairs)]

        @cache
        def tried(k: int, at: float, then: float, boxes: list[Array] = boxes) -> GearPair | None:
            return smallest(train, k, boxes[k], at, then, polishing=True)

        for moves in product((-size, 0.0, size), repeat=len(pairs) - 1):
            if clock.over:
                return best
            neighbour = design_in_boxes(train, [*(at[:-1] + np.array(moves)), at[-1]], tried)
            if neighbour is not None and neighbour[1] < best[1]:
                best = neighbour
        if not best[1] < before * (1.0 - LITTLE):
            size *= SHORTER
    return best


def _around(train: Train, k: int, pair: GearPair, size: float) -> Array:
    """Return a box (rows, 2) of `boxes.ROWS` about the pair of stage k, within its limits.

    The rows in FREE but the end are cut to the pair's size +- `size`, twice that for d1.
    """
    limits = first_boxes(shafts_about(train, 1), k).sizes[:, :, 0]
    box = limits.copy()
    d, x1 = pair.pinion.reference_diameter, pair.pinion.profile_shift
    at = {Z: math.log(pair.pinion_teeth), B_OVER_D: math.log(pair.face_width / d)}
    at |= {D: math.log(d), X1: x1, SUM: x1 + pair.wheel.profile_shift}
    if train.stages[k].helix is not None:
        at[T] = math.log(math.tan(pair.pinion.helix_angle))
    for row, value in at.items():
        reach = 2.0 * size if row == D else size
        box[row] = np.clip(value + np.array([-reach, reach]), *limits[row])
    return box


@dataclass(frozen=True)
class Trials:
    """Pairs (n,) of a stage that are tried, of one ratio.

    shapes (4, m): ln z1 and ln tan(beta), x1 and x1 + x2, the latter three where the stage has
    their ranges; row: the shape of each pair; diameter d1 [mm].
    """

    stage: Stage
    ratio: float
    shapes: Array
    row: Any
    diameter: Any

    def take(self, place: Any) -> "Trials":
        """Return some of the pairs."""
        return replace(self, row=self.row[place], diameter=self.diameter[place])

    @cached_property
    def of_unit_module(self) -> GearPair:
        """Pairs of the shapes (m,), of a module of 1 mm."""
        return self._made(self.shapes, np.ones(self.shapes.shape[1]))

    @property
    def module(self) -> Array:
        """Normal modules [mm]."""
        unit = self.of_unit_module.pinion.reference_diameter
        return np.asarray(self.diameter / unit[self.row])

    def pairs(self, width: Any) -> GearPair:
        """Return the pairs with face widths [mm]."""
        return self._made(self.shapes[:, self.row], self.module).of_width(width)

    def _made(self, shapes: Array, module: Array) -> GearPair:
        (z, tangent), (first, total) = np.exp(shapes[:2]), shapes[2:]
        chosen = {"helix_angle": np.arctan(tangent), "pinion_shift": first, "shift_sum": total}
        cut = self.stage.cut(**{name: chosen[name] for name in self.stage.ranges})
        return cut.pair(module, z, z * self.ratio, 1.0)

    def narrowest(self, train: Train, torque: float, low: Array, high: Array) -> Array:
        """Return the narrowest face widths [mm] from low to high that carry; inf: none."""
        speed, stage = float(train.speed_at(torque)), self.stage
        safety = train.safety_of(stage)
        thinned = any(stage.toothing.thickness_allowances)

        def rows(standard: Standard, place: Array) -> Rows:
            some = self.take(place)
            pairs = some.pairs(1.0)
            ends = (np.full(len(place), torque),) * 2, (np.full(len(place), speed),) * 2
            if thinned:
                return standard.rows(standard.prepared(pairs), pairs, *ends, safety)
            shape, at = np.unique(some.row, return_inverse=True)
            teeth = standard.prepared(self._made(self.shapes[:, shape], np.ones(len(shape))))
            return standard.rows(teeth.take(at).scaled(some.module), pairs, *ends, safety)

        standards = stage.options[0].standards[::-1] if stage.options else ()
        makers = [partial(rows, standard) for standard in standards]
        if train.law.limits:
            load = torque, speed, stage.allowable
            low = train.law.minimum_width(self.pairs(1.0), *load, (low, high))
        return Standing(makers).first_width(np.arange(len(low)), low, high, ALLOWANCE)


def smallest(
    train: Train, k: int, box: Array, before: float, after: float, polishing: bool = False
) -> GearPair | None:
    """Return the pair of the least share that the ratings accept among some of a box.

    before, after: ln of the torques over the input's, the latter as near as the box has it. SIDES
    teeth, helix angles and shifts are tried, with TRIED diameters each and the narrowest face width
    that carries.
    """
    stage, ratio = train.stages[k], math.exp(float(np.clip(after - before, *box[U])))
    wide = np.ptp(box, axis=1) > ROUND
    sides = SIDES[polishing][int(wide[[Z, T, X1, SUM]].sum())]
    spread = [
        np.linspace(box[row, 0], box[row, 1], sides if wide[row] else 1) for row in (Z, T, X1, SUM)
    ]
    shapes = np.array([side.ravel() for side in np.meshgrid(*spread)])
    d = np.exp(np.linspace(box[D, 0], max(box[D, 1], box[D, 0] + ABOVE), TRIED))
    row, d = (side.ravel() for side in np.meshgrid(np.arange(shapes.shape[1]), d))
    trials = Trials(stage, ratio, shapes, row, d)
    low, high = _width_ends(stage, box, trials)
    allowed = _keeps_size_limits(train, k, trials.pairs(low)) & (low <= high)
    some = np.flatnonzero(allowed & _keeps_shift_limits(stage, trials.of_unit_module)[row])
    trials, low, high = trials.take(some), low[some], high[some]
    width = trials.narrowest(train, train.torque * math.exp(before), low, high)
    some = np.flatnonzero(np.isfinite(width))
    if not len(some):
        return None
    trials, width = trials.take(some), width[some]
    share = np.broadcast_to(objective_share(train, k, trials.pairs(width)), width.shape)
    best = int(share.argmin())
    return trials.take(best).pairs(width[best])


def _width_ends(stage: Stage, box: Array, trials: Trials) -> tuple[Array, Array]:
    """Least and greatest face widths [mm] of pairs in a box."""
    over_d, width, module = np.exp(box[B_OVER_D]), np.exp(box[B]), trials.module
    low, high = over_d[:, None] * trials.diameter
    few, many = stage.face_width.over_module
    least, most = float(few or 0), math.inf if many is None else float(many)
    low = np.maximum(np.maximum(low, width[0]), least * module)
    return low, np.minimum(np.minimum(high, width[1]), most * module)


def _keeps_shift_limits(stage: Stage, pair: GearPair) -> Any:
    """Return which pairs keep to the limits of chosen profile shifts."""
    shifting = stage.toothing.shifting
    used = {} if shifting is None else shifting.used(pair)
    every = np.ones(np.shape(pair.pinion_teeth), bool)
    return np.all([every, *(v <= 1.0 for v in used.values())], axis=0)


def _keeps_size_limits(train: Train, k: int, pair: GearPair) -> Any:
    """Return which pairs keep to the limits of a stage on sizes."""
    sizes = first_boxes(shafts_about(train, 1), k).sizes[:, :, 0]
    d, width = pair.pinion.reference_diameter, pair.face_width
    rows = {Z: pair.pinion_teeth, B_OVER_D: width / d, D: d, M: pair.normal_module, B: width}
    rows[D2] = pair.wheel.reference_diameter
    allowed = np.ones(np.shape(d), bool)
    for row, value in rows.items():
        allowed &= (np.log(value) >= sizes[row, 0] - ROUND) & (
            np.log(value) <= sizes[row, 1] + ROUND
        )
    numbers, over = dict[str, Any](train.numbers()), width / pair.normal_module
    low, high = train.stages[k].face_width.over_module
    allowed &= (over >= float(low or 0) - ROUND) & (over <= float(high or math.inf) * (1.0 + ROUND))
    z = pair.wheel_teeth
    allowed &= (z >= numbers["wheel_low"][k] - RATIO_TIE) & (
        z <= numbers["wheel_high"][k] + RATIO_TIE
    )
    return allowed
