"""All flank tolerances of a gear by ISO 1328-1, editions 1995 and 2013, rounded as printed.

Those of 1995 met 40 values of printed reports; no printed example of 2013 was found (unverified).
"""

from gearopt.physics import tolerances as of_2013
from gearopt.physics.gears import Gear
from gearopt.physics.iso6336.accuracy import (
    DIAMETERS,
    MODULES,
    WIDTHS,
    helix_slope_1995,
    profile_form_1995,
    range_mean,
    single_pitch_1995,
)
from gearopt.physics.tolerances import MICROMETRE, grade_factor, rounded_tolerance

NAMES = (  # f_pt, F_p; F_alpha, f_falpha, f_Halpha; F_beta, f_fbeta, f_Hbeta; F_r
    *("single_pitch", "total_pitch", "total_profile", "profile_form", "profile_slope"),
    *("total_helix", "helix_form", "helix_slope", "runout"),
)


def flank_tolerances(gear: Gear, grade: float, edition: str = "1995") -> dict[str, float]:
    """Tolerances [mm] of a gear of floats by NAMES; grade, or tolerance class of 2013."""
    sizes = abs(float(gear.reference_diameter)), float(gear.normal_module), float(gear.width)
    values = _of_1995(*sizes, grade) if edition == "1995" else _of_2013(*sizes, grade)
    return {n: float(rounded_tolerance(v)) for n, v in zip(NAMES, values, strict=True)}


def _of_1995(d: float, m: float, b: float, grade: float) -> tuple[float, ...]:
    """Tolerances of the geometric means of the ranges of diameter, module and face width [mm].

    Of grade 5 in um F_p = 0.3 m + 1.25 sqrt(d) + 7, F_alpha = 3.2 sqrt(m) + 0.22 sqrt(d) + 0.7,
    f_Halpha = 2 sqrt(m) + 0.14 sqrt(d) + 0.5, F_beta = 0.1 sqrt(d) + 0.63 sqrt(b) + 4.2,
    F_r = 0.24 m + sqrt(d) + 5.6, f_fbeta = f_Hbeta. Source: ISO 1328-1:1995, 6 and annex B, and
    ISO 1328-2:1997 of the runout; printed reports (KISSsoft, NREL 5 MW).
    """
    d, m, b = (range_mean(d, DIAMETERS), range_mean(m, MODULES), range_mean(b, WIDTHS))
    unit = MICROMETRE * grade_factor(grade)
    slope = helix_slope_1995(d, b, grade)
    return (
        single_pitch_1995(d, m, grade),
        unit * (0.3 * m + 1.25 * d**0.5 + 7.0),
        unit * (3.2 * m**0.5 + 0.22 * d**0.5 + 0.7),
        profile_form_1995(d, m, grade),
        unit * (2.0 * m**0.5 + 0.14 * d**0.5 + 0.5),
        unit * (0.1 * d**0.5 + 0.63 * b**0.5 + 4.2),
        slope,
        slope,
        unit * (0.24 * m + d**0.5 + 5.6),
    )


def _of_2013(d: float, m: float, b: float, grade: float) -> tuple[float, ...]:
    """Tolerances of the sizes as they are: `tolerances`."""
    return (
        of_2013.single_pitch_tolerance(d, m, grade),
        of_2013.total_pitch_tolerance(d, m, grade),
        of_2013.total_profile_tolerance(d, m, grade),
        of_2013.profile_form_tolerance(m, grade),
        of_2013.profile_slope_tolerance(d, m, grade),
        of_2013.total_helix_tolerance(d, b, grade),
        of_2013.helix_form_tolerance(d, b, grade),
        of_2013.helix_slope_tolerance(d, b, grade),
        of_2013.runout_tolerance(d, m, grade),
    )
