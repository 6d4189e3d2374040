"""How large the ratio of a stage may be: of pairs there are, of a first look, of trains of use."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive.shares import least_share, objective_share
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.progress import MARGIN
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.formulations.drive.train import LENGTHS, Train
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair, reference_diameter


def largest_ratio(train: Train) -> Fraction:
    """Return the largest ratio of a pair that the limits of teeth and wheels leave a stage."""
    rows = (row for k in range(len(train.stages)) for row in spans(train, k, train.highest_ratio))
    ratios = (Fraction(stop, z) for z, start, stop in rows if stop >= start)
    return max(ratios, default=train.highest_ratio)


def first_cut(train: Train) -> Fraction:
    """Return the largest stage ratio of a first look: three times that of an even split."""
    even = float(train.ratio) ** (1.0 / len(train.stages))
    return min(train.highest_ratio, Fraction(3.0 * even))


def reach(
    train: Train,
    cut: Fraction,
    maximum: Fraction,
    threshold: float,
    tick: Callable[[], float] = lambda: math.inf,
    shelf: list[RatedTable] | None = None,
) -> Fraction:
    """Return the largest stage ratio that a train at least as good as `threshold` may have.

    tick: called several times a second; what it raises ends the work.
    Any stage carries at least the least torque; its share alone then grows with its ratio, where
    its law is proportional and the objective a volume, mass or length.
    """
    if train.rated:
        every = stage_tables(train, maximum, tick, shelf)
        names = (train.objective, *(name for name, _ in train.weights))
        if "total_length" not in names:  # equal stages have the same shares
            every = [t for k, t in enumerate(every) if train.stages[k] not in train.stages[:k]]
        far = max(t.useful_ratio(float(cut), threshold) for t in every)
        return max(cut, Fraction(far)) if far > float(cut) else cut
    if not train.law.proportional or train.objective not in ("gear_volume", "mass", *LENGTHS):
        return maximum
    ratios = np.geomspace(float(cut), float(maximum), 2000)
    useful = np.zeros(len(ratios), dtype=bool)
    for k, stage in enumerate(train.stages):
        load = _least_size(train, k, ratios)
        if train.objective in ("gear_volume", "mass"):
            one = GearPair.of_teeth(1.0, 1.0, ratios, load)  # d1 is 1 mm
            lower = least_share(train, k, one)
        else:
            face = stage.face_width
            d = (load / float(face.fixed or face.widest)) ** (0.5 if face.fixed else 1.0 / 3.0)
            lower = objective_share(
                train, k, GearPair.of_teeth(d, 1.0, ratios, math.nan)
            )  # a length, whatever the width
        useful |= np.asarray(lower) <= threshold
    beyond = [*ratios[1:], maximum]  # the next of the grid; at its end `maximum` itself, unrounded
    last = np.flatnonzero(useful)
    return Fraction(beyond[last[-1]]) if len(last) else cut


def _least_size(train: Train, k: int, ratios: Array) -> Array:
    """Return the minimum b d1^2 [mm3] for the least torque at given ratios, of the fewest teeth."""
    stage = train.stages[k]
    z = float(stage.pinion_teeth[0])
    unit = stage.toothing.of_diameter(stage.toothing.cosine / z, z, 1.0, ratios, 1.0)
    return train.law.largest_utilisation(unit, train.torques[0], train.speed, stage.allowable)


PAIRS_AT_ONCE = 200_000  # tooth pairs of a stage that are searched at once


def narrowed(train: Train) -> Train:
    """Return the drive with its smallest pinions, no stage of more than PAIRS_AT_ONCE pairs.

    A pinion alone may have more. The drive itself where its ranges are not wide.
    """
    stages = []
    for k, stage in enumerate(train.stages):
        low, _ = stage.pinion_teeth
        ranges = spans(train, k, first_cut(train))
        pairs = np.cumsum([stop - start + 1 for _, start, stop in ranges])
        helices = len({toothing.helix_angle for toothing in stage.toothings})
        few = int(np.searchsorted(helices * pairs, PAIRS_AT_ONCE, side="right"))
        stages.append(replace(stage, pinion_teeth=(low, low + max(few - 1, 0))))
    return replace(train, stages=tuple(stages))


def trimmed(train: Train, maximum: float) -> Train:
    """Return the drive without pinions whose stage alone costs more than `maximum`.

    Exact: of a train of at most that objective nothing is left out.
    """
    stages = []
    for k, stage in enumerate(train.stages):
        low, high = stage.pinion_teeth
        assert high is not None
        own_bodies = stage.toothing.shifting is not None or stage.planetary
        if own_bodies:  # which are no reference cylinders
            stages.append(stage)
            continue
        teeth = np.arange(low, high + 1)
        useful = np.flatnonzero(_least(train, k, teeth) <= maximum * (1.0 + MARGIN))
        stages.append(replace(stage, pinion_teeth=(low, low + int(useful.max(initial=0)))))
    return replace(train, stages=tuple(stages))


def _least(train: Train, k: int, teeth: NDArray[np.int64]) -> Array:
    """Return the minimum share (n,) of a stage (counted from 0) with pinions of so many teeth."""
    stage = train.stages[k]
    module, face = float(stage.modules[0]), stage.face_width
    shares = []
    for own in stage.toothings:
        d = reference_diameter(module, teeth, own.helix_angle)
        width = float(face.low) * d if face.fixed is None else np.full(len(d), float(face.fixed))
        pair = own.pair(module, teeth, teeth * float(stage.ratio[0]), width)
        options = range(max(1, len(stage.options)))
        shares += [least_share(train, k, pair, option=o) for o in options]
    return np.asarray(np.minimum.reduce(shares))
