"""Ways of cutting the teeth of a stage, in ranges that hold all of its toothings."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.train import LENGTHS, Stage, Train
from gearopt.physics.geometry.profile_shift import PINIONS, SUMS

FEW = 6  # toothings that are looked at one by one, where no shifts are chosen
WEIGHTS = {"helix_angle": 1.5, "pinion_shift": 1.0, "shift_sum": 0.5}  # widths beside ln(z1)
HELICES, BLUNT = (math.radians(0.999), math.radians(45.0)), 0.1  # rad; m_n: of Lemma 64 (d), (e)


def of(train: Train, stage: Stage) -> list[Stage]:
    """Stages of one toothing, or of ranges of all that toothings choose, which hold each of it.

    Spur gears are apart from helical ones. None where cells have no bound over ranges.
    """
    if stage.ranges:
        return [stage]
    cuts, shifting = stage.toothings, stage.toothing.shifting
    if shifting is None and stage.toothing.working_distance is not None:
        return []
    if shifting is None and len(cuts) <= FEW:
        return [replace(stage, toothings=(cut,)) for cut in cuts]
    angles = sorted({abs(cut.helix_angle) for cut in cuts})
    inclined = [angle for angle in angles if angle]
    blunt = min(rack.tip_radius for rack in stage.toothing.racks) < BLUNT
    steep = inclined and not HELICES[0] <= inclined[0] <= inclined[-1] <= HELICES[1]
    if train.hollow or steep or shifting is not None and (blunt or train.objective in LENGTHS):
        return []
    chosen = (("pinion_shift", PINIONS), ("shift_sum", SUMS)) if shifting is not None else ()
    shifts = [_ends([getattr(cut, name) for cut in cuts], ends) for name, ends in chosen]
    plain = replace(stage.toothing, helix_angle=0.0, working_distance=None)
    plain = plain.at({name: 0.0 for name, _ in chosen})
    helices: list[tuple[float, float] | None] = [None] if len(inclined) < len(angles) else []
    if inclined:
        helices.append((inclined[0], inclined[-1]))
    ways = (replace(stage, toothings=(plain,), helix=helix) for helix in helices)
    return [replace(way, shifts=(shifts[0], shifts[1]) if shifts else None) for way in ways]


def _ends(values: Sequence[Any], widest: tuple[float, float]) -> tuple[float, float]:
    """Least and greatest of given values; the widest ends where one is not given."""
    return widest if None in values else (min(values), max(values))


def halves(stage: Stage) -> list[Stage]:
    """Both halves of a stage of ranges, across the widest of them; none of a stage without."""
    if not stage.ranges:
        return []
    (low, high), parts = stage.pinion_teeth, dict[str, float]()
    if high is not None:
        parts["pinion_teeth"] = math.log(high / low)
    parts |= {name: WEIGHTS[name] * (b - a) for name, (a, b) in stage.ranges.items()}
    side = max(parts, key=lambda name: parts[name])
    if side == "pinion_teeth":
        assert high is not None
        middle = min(math.isqrt(low * high), high - 1)
        ends = (low, middle), (middle + 1, high)
        return [replace(stage, pinion_teeth=pair) for pair in ends] if low < high else []
    a, b = stage.ranges[side]
    both = (a, 0.5 * (a + b)), (0.5 * (a + b), b)
    if side == "helix_angle":
        return [replace(stage, helix=pair) for pair in both]
    assert stage.shifts is not None
    first, total = stage.shifts
    rows = [(pair, total) if side == "pinion_shift" else (first, pair) for pair in both]
    return [replace(stage, shifts=row) for row in rows]
