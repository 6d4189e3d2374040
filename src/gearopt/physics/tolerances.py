"""Flank tolerances of cylindrical gears by grade: ISO 1328-1:2013, clause 5.

Formulas and rounding rule (5.2.3) agree in three or more independent public implementations; the
runout of its informative annex stands in one of them alone: unverified. Sizes and tolerances in
mm, unrounded; `rounded_tolerance` rounds as the standard asks. The standard holds within `scope`
and does not allow extrapolation. Arguments are floats, arrays of one shape, or casadi scalars;
grades may be fractions (6.5 lies between 6 and 7).
"""

import math
from typing import Any

import numpy as np

from gearopt.physics.choosing import choose

MICROMETRE = 1e-3  # mm
SCOPE = {
    "grade": (1.0, 11.0),
    "teeth": (5.0, 1000.0),
    "diameter": (5.0, 15000.0),  # mm
    "module": (0.5, 70.0),  # mm
    "face_width": (4.0, 1200.0),  # mm
    "helix_angle": (0.0, math.radians(45.0)),  # rad
}


def grade_factor(grade: Any) -> Any:
    """Return the factor sqrt(2)^(A - 5) of grade A against grade 5 (5.2.2)."""
    return 2.0 ** (0.5 * (grade - 5.0))


def single_pitch_tolerance(diameter: Any, module: Any, grade: Any) -> Any:
    """Return f_pT: (0.001 d + 0.4 m_n + 5) um at grade 5 [mm]; eq. (5)."""
    return MICROMETRE * (0.001 * diameter + 0.4 * module + 5.0) * grade_factor(grade)


def total_pitch_tolerance(diameter: Any, module: Any, grade: Any) -> Any:
    """Return F_pT: (0.002 d + 0.55 sqrt(d) + 0.7 m_n + 12) um at grade 5 [mm]; eq. (6)."""
    unit = 0.002 * diameter + 0.55 * diameter**0.5 + 0.7 * module + 12.0
    return MICROMETRE * unit * grade_factor(grade)


def profile_slope_tolerance(diameter: Any, module: Any, grade: Any) -> Any:
    """Return f_HalphaT: (0.4 m_n + 0.001 d + 4) um at grade 5 [mm]; eq. (7)."""
    return MICROMETRE * (0.4 * module + 0.001 * diameter + 4.0) * grade_factor(grade)


def profile_form_tolerance(module: Any, grade: Any) -> Any:
    """Return f_falphaT: (0.55 m_n + 5) um at grade 5 [mm]; eq. (8)."""
    return MICROMETRE * (0.55 * module + 5.0) * grade_factor(grade)


def total_profile_tolerance(diameter: Any, module: Any, grade: Any) -> Any:
    """Return F_alphaT = sqrt(f_HalphaT^2 + f_falphaT^2), of unrounded values [mm]; eq. (9)."""
    slope = profile_slope_tolerance(diameter, module, grade)
    return (slope**2 + profile_form_tolerance(module, grade) ** 2) ** 0.5


def helix_slope_tolerance(diameter: Any, face_width: Any, grade: Any) -> Any:
    """Return f_HbetaT: (0.05 sqrt(d) + 0.35 sqrt(b) + 4) um at grade 5 [mm]; eq. (10)."""
    unit = 0.05 * diameter**0.5 + 0.35 * face_width**0.5 + 4.0
    return MICROMETRE * unit * grade_factor(grade)


def helix_form_tolerance(diameter: Any, face_width: Any, grade: Any) -> Any:
    """Return f_fbetaT: (0.07 sqrt(d) + 0.45 sqrt(b) + 4) um at grade 5 [mm]; eq. (11)."""
    unit = 0.07 * diameter**0.5 + 0.45 * face_width**0.5 + 4.0
    return MICROMETRE * unit * grade_factor(grade)


def total_helix_tolerance(diameter: Any, face_width: Any, grade: Any) -> Any:
    """Return F_betaT = sqrt(f_HbetaT^2 + f_fbetaT^2), of unrounded values [mm]; eq. (12)."""
    slope = helix_slope_tolerance(diameter, face_width, grade)
    return (slope**2 + helix_form_tolerance(diameter, face_width, grade) ** 2) ** 0.5


def runout_tolerance(diameter: Any, module: Any, grade: Any) -> Any:
    """Return F_rT = 0.9 F_pT [mm] of the informative annex: unverified, and no requirement."""
    return 0.9 * total_pitch_tolerance(diameter, module, grade)


def rounded_tolerance(tolerance: Any) -> Any:
    """Return a tolerance [mm] rounded by 5.2.3: steps of 1 um above 10 um, 0.5 from 5, else 0.1.

    Halves are rounded up; what lies within 1e-9 um of a half counts as one.
    """
    size = tolerance / MICROMETRE
    unit = choose(size > 10.0, 1.0, choose(size >= 5.0, 0.5, 0.1))
    rounded = np.floor(size / unit + 0.5 + 1e-9) * unit
    return MICROMETRE * rounded


def scope(**quantities: Any) -> dict[str, Any]:
    """Return margins to the standard's ranges: negative where the formulas do not hold.

    quantities by the names of SCOPE: grade, teeth, diameter, module, face_width [mm], helix_angle
    [rad]. ValueError for another name.
    """
    if unknown := set(quantities) - set(SCOPE):
        raise ValueError(f"no range of {unknown.pop()!r}; known: {', '.join(SCOPE)}")
    return {
        name: np.minimum(value - SCOPE[name][0], SCOPE[name][1] - value)
        for name, value in quantities.items()
    }
