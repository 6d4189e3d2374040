"""Wide ranges of teeth: a search among few pinions first, then among those of use."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive.shares import least_share
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.progress import MARGIN
from gearopt.formulations.drive.teeth.reach import first_cut
from gearopt.formulations.drive.train import Train
from gearopt.optimise.terms import Array
from gearopt.physics.gears import reference_diameter

PAIRS_AT_ONCE = 200_000  # tooth pairs of a stage that are searched at once


def narrowed(train: Train) -> Train:
    """Return the drive with its smallest pinions, no stage of more than PAIRS_AT_ONCE pairs.

    A pinion alone may have more. The drive itself where its ranges are not wide.
    """
    stages = []
    for k, stage in enumerate(train.stages):
        low, _ = stage.pinion_teeth
        found = spans(train, k, first_cut(train))
        pairs = np.cumsum([stop - start + 1 for _, start, stop in found])
        few = int(np.searchsorted(pairs, PAIRS_AT_ONCE, side="right"))
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
        teeth = np.arange(low, high + 1)
        useful = np.flatnonzero(_least(train, k, teeth) <= maximum * (1.0 + MARGIN))
        stages.append(replace(stage, pinion_teeth=(low, low + int(useful.max(initial=0)))))
    return replace(train, stages=tuple(stages))


def _least(train: Train, k: int, teeth: NDArray[np.int64]) -> Array:
    """Return the minimum share (n,) of a stage (counted from 0) with pinions of so many teeth."""
    stage = train.stages[k]
    module, face = float(stage.modules[0]), stage.face_width
    d = reference_diameter(module, teeth, stage.toothing.helix_angle)
    width = float(face.low) * d if face.fixed is None else np.full(len(d), float(face.fixed))
    pair = train.pair(k, module, teeth, teeth * float(stage.ratio[0]), width)
    options = range(max(1, len(stage.options)))
    shares = [least_share(train, k, pair, option=o) for o in options]
    return np.asarray(np.minimum.reduce(shares))
