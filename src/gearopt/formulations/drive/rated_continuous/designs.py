"""Designs of a drive that ratings limit, found by trying: in boxes, and near a design."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from gearopt.formulations.drive.rated_continuous.boxes import (
    B_OVER_D,
    D2,
    ROUND,
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
from gearopt.formulations.drive.train import Train
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

TRIED = 48  # diameters
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
    """Return the best design near a design: ratios, teeth and b/d1 in ever shorter steps.

    The design need not be one that the ratings accept; only better ones than its value count.
    """
    size = FIRST_STEP
    while size > LAST_STEP and clock.tell():
        pairs, before = best
        at = np.cumsum([math.log(float(pair.ratio)) for pair in pairs])
        boxes = [_around(train, k, pair, size) for k, pair in enumerate(pairs)]

        @cache
        def tried(k: int, at: float, then: float, boxes: list[Array] = boxes) -> GearPair | None:
            return smallest(train, k, boxes[k], at, then, 3)

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
    """Return a box (rows, 2), in logarithms, about the pair of stage k, within its limits.

    The rows of z1, b/d1 and d1 are cut to the pair's size +- `size` (twice that for d1).
    """
    limits = first_boxes(shafts_about(train, 1), k).sizes[:, :, 0]
    box = limits.copy()
    d = pair.pinion.reference_diameter
    rows = [
        (Z, pair.pinion_teeth, size),
        (B_OVER_D, pair.face_width / d, size),
        (D, d, 2.0 * size),
    ]
    if train.stages[k].helix is not None:
        rows.append((T, math.tan(pair.pinion.helix_angle), size))
    for row, value, wide in rows:
        ends = np.log(float(value)) + np.array([-wide, wide])
        box[row] = np.clip(ends, *limits[row])
    return box


def smallest(
    train: Train, k: int, box: Array, before: float, after: float, sides: int
) -> GearPair | None:
    """Return the pair of the least share that the ratings accept among some of a box.

    before, after: ln of the torques over the input's, the latter as near as the box has it; sides:
    so many teeth, b/d1 and helix angles are tried, with TRIED diameters each.
    """
    stage, ratio = train.stages[k], math.exp(float(np.clip(after - before, *box[U])))
    spread = [
        np.linspace(box[row, 0], box[row, 1], sides if np.ptp(box[row]) > ROUND else 1)
        for row in (Z, B_OVER_D, T)
    ]
    diameters = np.linspace(box[D, 0], max(box[D, 1], box[D, 0] + ABOVE), TRIED)
    sizes = np.exp([side.ravel() for side in np.meshgrid(*spread, diameters)])

    def pairs(z: Array, b_over_d: Array, tangent: Array, d: Array) -> GearPair:
        cut = stage.toothing if stage.helix is None else stage.inclined(np.arctan(tangent))
        module = d * np.cos(cut.helix_angle) / z
        return cut.of_diameter(module, z, d, ratio, b_over_d * d)

    sizes = sizes[:, _keeps_size_limits(train, k, pairs(*sizes))]
    if not sizes.shape[1]:
        return None
    torque = train.torque * math.exp(before)
    for accepts in _judges(train, k, torque, float(train.speed_at(torque))):
        sizes = sizes[:, accepts(pairs(*sizes))]
        if not sizes.shape[1]:
            return None
    return pairs(*sizes[:, int(objective_share(train, k, pairs(*sizes)).argmin())])


def _judges(
    train: Train, k: int, torque: float, speed: float
) -> Iterator[Callable[[GearPair], Any]]:
    """Tests of pairs (n,) of a stage: its load limits, then each of its standards."""
    stage = train.stages[k]
    if train.law.limits:
        law = train.law
        yield lambda pair: np.asarray(
            law.largest_utilisation(pair, torque, speed, stage.allowable) <= 1.0
        )
    for option in stage.options[:1]:
        for standard in reversed(option.standards):
            alone = replace(option, standards=(standard,))

            def accepts(pair: GearPair, alone: Option = alone) -> Any:
                loads = np.full((2, *np.shape(pair.ratio)), [[torque], [speed]])
                used = alone.utilisations(pair, loads[0], loads[1], train.safety)
                return np.asarray(np.max([*used.values()], axis=0) <= 1.0)

            yield accepts


def _keeps_size_limits(train: Train, k: int, pair: GearPair) -> Array:
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
