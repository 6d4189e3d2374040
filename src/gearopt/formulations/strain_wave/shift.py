"""The paper's search: profile shift against Hertz's pressure, and the limits that end it."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from gearopt.formulations.strain_wave.demand import Duty, equal_pressure, shared_pressure
from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.clearance import interference, interferes
from gearopt.physics.strain_wave.conjugate import Flank, flank
from gearopt.physics.strain_wave.gearing import StrainWave

POINTS = 201  # of a flank
STEP_DEG = 0.25  # of the wave, between which least clearances are found exactly
BISECTIONS = 14  # to 2e-4 of a shift of 0 to 3


@dataclass(frozen=True)
class ShiftPoint:
    """Pairs in contact, least R [mm] and pressures [MPa] of a profile shift x.

    equal: load shared by the conjugate pairs; whole: by the pairs that always touch; shared: by
    clearances and elasticity. least_gap [mm] over the wave, negative where teeth interfere.
    """

    shift: float
    pairs: float
    radius: float
    equal: float
    whole: float
    shared: float
    least_gap: float


def shift_curve(gearing: StrainWave, duty: Duty, shifts: Iterable[float]) -> list[ShiftPoint]:
    """Return the points of all shifts that have a conjugate flank."""
    points = []
    for x in shifts:
        meshing = flank(replace(gearing, profile_shift=float(x)), POINTS)
        if not bool(np.all(meshing.complete)) or not (meshing.contacts.gap_curvature > 0.0).all():
            continue
        points.append(
            ShiftPoint(
                float(x),
                float(meshing.pairs_in_contact),
                float(1.0 / meshing.contacts.gap_curvature.max()),
                equal_pressure(duty, meshing),
                equal_pressure(duty, meshing, whole=True),
                shared_pressure(duty, meshing),
                interference(meshing, STEP_DEG).gap,
            )
        )
    return points


def last_shift_of_one_pair(gearing: StrainWave, most: float = 3.0) -> float | None:
    """Return the profile shift up to which one conjugate pair always touches, 0 to `most`.

    A side condition that ends the fall of the stress; None where the pairs do not cross 1.
    """

    def enough(x: float) -> bool:
        meshing = flank(replace(gearing, profile_shift=x), 3)
        return bool(meshing.pairs_in_contact >= 1.0)

    return _last(enough, 0.0, most)


def largest_addendum(gearing: StrainWave, low: float = 0.3, high: float = 1.0) -> float | None:
    """Return the largest addendum h_a in modules without interference over the whole wave."""

    def free(addendum: float) -> bool:
        meshing: Flank = flank(replace(gearing, addendum=addendum), 41)
        return bool(np.all(meshing.complete)) and not interferes(meshing, STEP_DEG, 11)

    return _last(free, low, high)


def _last(holds: Callable[[float], bool], low: float, high: float) -> float | None:
    """Return where a condition that holds at `low` ends; None where both ends agree."""
    if not holds(low) or holds(high):
        return None
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
