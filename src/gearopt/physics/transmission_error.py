"""Once-per-turn transmission error of eccentric gears, and how such errors add up.

An error has an amplitude and a phase. Errors of gears on one shaft keep their phase to each other
and add as vectors; those of shafts of other speeds do not. Angles in rad, lengths in mm.
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np


def eccentricity_error(eccentricity: Any, diameter: Any, pressure_angle: Any) -> Any:
    """Return the amplitude e/r_b = 2 e/(d cos(alpha)) [rad] of an eccentric wheel.

    eccentricity e, reference diameter d [mm] > 0; transverse pressure_angle alpha [rad]. Its
    frequency is once per turn of that gear. Derived: e is the amplitude along the line of action.
    """
    return 2.0 * eccentricity / (diameter * np.cos(pressure_angle))


def in_phase_amplitude(amplitudes: Iterable[float], phases: Iterable[float]) -> float:
    """Return the amplitude of the vector sum of errors of one frequency, as on one shaft.

    amplitudes, all of one unit, and phases [rad]. Turning one gear on its shaft by pi cancels two
    equal ones.
    """
    pairs = list(zip(amplitudes, phases, strict=True))
    return math.hypot(
        math.fsum(a * math.cos(p) for a, p in pairs), math.fsum(a * math.sin(p) for a, p in pairs)
    )


def unrelated_amplitude(amplitudes: Iterable[float]) -> float:
    """Return the root of the sum of squares: typical of errors whose phases are unrelated.

    It is sqrt(2) times the root mean square of their sum over all phases; the worst case is the
    plain sum.
    """
    return math.hypot(*amplitudes)
