"""Factors of load and strength by AGMA 2001-D04: K_v, K_s, K_m, K_B, K_R, K_T, C_p.

Arguments are floats, arrays of one shape or casadi scalars unless a docstring says less. Constants
are those of the inch form. Where 2001-D04 is quoted, the formulas agree in Shigley, a digest of the
field and at least one public program (r3kste/pydome, `Spur`), unless marked.
"""

import math
from typing import Any

import numpy as np

from gearopt.physics.choosing import choose

INCH = 25.4  # mm
FEET_PER_MINUTE = 12.0 * INCH / 60.0  # mm/s, of one ft/min
QUALITIES = (5.0, 11.0)  # of the curves of K_v
ACCURACIES = 17.0  # Q_v + A_v of one curve
WIDEST = 40.0 * INCH  # face width of the curves of K_m, mm
THINNEST = 0.5  # backup ratio at which the chart of K_B begins
WARM = 120.0  # degrees C up to which K_T is 1

# C_ma = A + B F + C F^2, F in inches. Source: AGMA 2001-D04, clause 15, in a public program with
# the metric constants of 2101-D04 (0.0380; -1.69e-7/mm^2; efirvida/python-gearbox), and in three
# with these. Shigley, table 14-9, prints -0.930e-4 for commercial (1e-3 of K_m at 8 inches) and
# 0.00360 for extra precision (3 % of K_m).
ALIGNMENT = {
    "open": (0.247, 0.0167, -0.765e-4),
    "commercial": (0.127, 0.0158, -1.093e-4),
    "precision": (0.0675, 0.0128, -0.926e-4),
    "extra precision": (0.0380, 0.0102, -0.822e-4),
}

# Lewis form factor Y of full-depth teeth of 20 degrees. Source: Shigley, table 14-2; pydome
LEWIS = {
    12: 0.245,
    13: 0.261,
    14: 0.277,
    15: 0.290,
    16: 0.296,
    17: 0.303,
    18: 0.309,
    19: 0.314,
    20: 0.322,
    21: 0.328,
    22: 0.331,
    24: 0.337,
    26: 0.346,
    28: 0.353,
    30: 0.359,
    34: 0.371,
    38: 0.384,
    43: 0.397,
    50: 0.409,
    60: 0.422,
    75: 0.435,
    100: 0.447,
    150: 0.460,
    300: 0.472,
    400: 0.480,
    math.inf: 0.485,
}

# K_R by reliability. Source: AGMA 2001-D04, table 11; Shigley, table 14-10
RELIABILITY = {0.5: 0.70, 0.9: 0.85, 0.99: 1.0, 0.999: 1.25, 0.9999: 1.50}


def dynamic_factor(speed: Any, quality: Any) -> Any:
    """Return K_v = ((A + sqrt(V))/A)^B >= 1 for a pitch line velocity [mm/s], V in ft/min.

    quality: transmission accuracy Q_v. B = (12 - Q_v)^(2/3)/4, A = 50 + 56 (1 - B) for 6 to 11;
    (50 + sqrt(V))/50 for 5 up to below 6. Up to `highest_speed`. ValueError for a number outside 5
    to 11: above, K_v lies between 1.02 and 1.11 and is to be given. B88 has 1/K_v, C_v = K_v.
    Source: AGMA 2001-C95, clause 8; D04 names the same curves by A_v (`quality_of_accuracy`).
    """
    if isinstance(quality, int | float) and not QUALITIES[0] <= quality <= QUALITIES[1]:
        raise ValueError(f"no curve of K_v for Q_v = {quality:g}: 5 to 11; above, give K_v itself")
    exponent, offset = dynamic_curve(quality)
    return ((offset + np.sqrt(speed / FEET_PER_MINUTE)) / offset) ** exponent


def quality_of_accuracy(accuracy: Any) -> Any:
    """Return Q_v = 17 - A_v of a transmission accuracy level number A_v, smaller is better.

    accuracy A_v, 6 to 12: near the accuracy grade of AGMA 2015-1. The exponent of D04 is
    (A_v - 5)^(2/3)/4, C95's (12 - Q_v)^(2/3)/4. ValueError for a number outside 6 to 12.
    Source: AGMA 2001-D04, clause 8, in two public programs; AGMA's answer to an inquiry about it:
    the curves of C95 with other names, so that A_v 12 is the line of Q_v 5.
    """
    if isinstance(accuracy, int | float) and not 6.0 <= accuracy <= 12.0:
        raise ValueError(f"no curve of K_v for A_v = {accuracy:g}: 6 to 12; below, give K_v itself")
    return ACCURACIES - accuracy


def highest_speed(quality: Any) -> Any:
    """Return the pitch line velocity [mm/s] at which the curve of K_v ends: (A + Q_v - 3)^2 ft/min.

    2500 ft/min for Q_v of 5 to below 6. Source: AGMA 2001-D04, clause 8.
    """
    offset = dynamic_curve(quality)[1]
    return FEET_PER_MINUTE * choose(quality < 6.0, 2500.0, (offset + quality - 3.0) ** 2)


def dynamic_curve(quality: Any) -> tuple[Any, Any]:
    """Return B and A of the curve of K_v of a quality; see `dynamic_factor`."""
    exponent = 0.25 * (12.0 - quality) ** (2.0 / 3.0)
    offset = 50.0 + 56.0 * (1.0 - exponent)
    return choose(quality < 6.0, 1.0, exponent), choose(quality < 6.0, 50.0, offset)


def lewis_form(teeth: Any) -> Any:
    """Return the Lewis form factor Y of LEWIS, linear in the number of teeth between entries.

    teeth 12 to 400; a rack's beyond, and of rings; of fewer teeth that of 12. Floats or arrays, not
    casadi.
    Source: Shigley, table 14-2.
    """
    known = [z for z in LEWIS if math.isfinite(z)]
    found = np.interp(teeth, known, [LEWIS[z] for z in known])
    straight = (np.asarray(teeth) > known[-1]) | np.less(teeth, 0.0)
    return np.where(straight, LEWIS[math.inf], found)[()]


def size_factor(face_width: Any, module: Any, form: Any) -> Any:
    """Return K_s = 1.192 (F sqrt(Y)/P)^0.0535 with F and 1/P in inches, at least 1.

    face_width b, transverse module [mm]; form: Lewis form factor Y. AGMA 2001-D04 (clause 20) takes
    1 for most gears; this form is that of Shigley, eq. (14-10), from Lewis's formula.
    """
    return np.maximum(1.0, 1.192 * (face_width * module / INCH**2 * form**0.5) ** 0.0535)


def _drawn(face_width: Any) -> Any:
    """Return a face width in inches, at most WIDEST: parabolas beyond would fall, to K_m < 0."""
    return np.minimum(face_width, WIDEST) / INCH


def proportion_factor(face_width: Any, pinion_diameter: Any) -> Any:
    """Return the pinion proportion factor C_pf of a face width b and the diameter d of the pinion.

    F/(10 d) - 0.025 for F <= 1 inch, F/(10 d) - 0.0375 + 0.0125 F up to 17, F/(10 d) - 0.1109 +
    0.0207 F - 0.000228 F^2 up to 40, held there beyond; F/(10 d) at least 0.05. Lengths [mm]; d:
    working pitch diameter. Source: AGMA 2001-D04, clause 15.
    """
    slender = np.maximum(face_width / (10.0 * pinion_diameter), 0.05)
    width = _drawn(face_width)
    middle = -0.0375 + 0.0125 * width
    wide = -0.1109 + 0.0207 * width - 0.000228 * width**2
    return slender + choose(width <= 1.0, -0.025, choose(width <= 17.0, middle, wide))


def alignment_factor(face_width: Any, curve: str) -> Any:
    """Return the mesh alignment factor C_ma of a face width b [mm]; curve: a key of ALIGNMENT.

    Beyond WIDEST that of WIDEST. ValueError for another curve. Source: AGMA 2001-D04, clause 15.
    """
    if curve not in ALIGNMENT:
        raise ValueError(f"no curve {curve!r} of C_ma; known: {', '.join(ALIGNMENT)}")
    return _aligned(face_width, ALIGNMENT[curve])


def _aligned(face_width: Any, curve: tuple[float, float, float]) -> Any:
    width = _drawn(face_width)
    return curve[0] + curve[1] * width + curve[2] * width**2


def load_distribution_factor(
    face_width: Any,
    pinion_diameter: Any,
    curve: str = "commercial",
    crowned: bool = False,
    offset: Any = 0.0,
    adjusted: bool = False,
) -> Any:
    """Return K_m = 1 + C_mc (C_pf C_pm + C_ma C_e), the same for pitting (C_m) and bending.

    face_width b, pinion_diameter d [mm]. C_mc: 0.8 crowned or leads corrected, else 1. C_pm: 1.1
    where the pinion is offset by S1/S >= 0.175 of the bearings' span from its middle, else 1. C_e:
    0.8 adjusted at assembly or lapped, else 1. For b/d <= 2, straddle mounted, b <= WIDEST.
    Source: AGMA 2001-D04, clause 15, empirical method.
    """
    leads, mounted = 0.8 if crowned else 1.0, 0.8 if adjusted else 1.0
    shared = leads, choose(offset < 0.175, 1.0, 1.1), mounted
    return distributed(face_width, pinion_diameter, ALIGNMENT[curve], shared)


def distributed(
    face_width: Any,
    pinion_diameter: Any,
    curve: tuple[float, float, float],
    shared: tuple[Any, Any, Any],
) -> Any:
    """K_m of `load_distribution_factor`; curve: of ALIGNMENT; shared: C_mc, C_pm, C_e."""
    proportion = proportion_factor(face_width, pinion_diameter) * shared[1]
    return 1.0 + shared[0] * (proportion + _aligned(face_width, curve) * shared[2])


def rim_factor(backup_ratio: Any) -> Any:
    """Return K_B = 1.6 ln(2.242/m_B), at least 1, of the backup ratio m_B = rim/whole depth.

    1 from 1.2 up. Source: AGMA 2001-D04, annex B; for m_B >= 0.5.
    """
    return np.maximum(1.0, 1.6 * np.log(2.242 / backup_ratio))


def rim_factor_b88(backup_ratio: Any) -> Any:
    """Return K_B = 3.4 - 2 m_B, at least 1, for m_B from 0.5.

    Source: AGMA 2001-B88, as a textbook has it; a course's program of its tables agrees
    (github.com/nadimasmar/MECH-393, gears_tables.py).
    """
    return np.maximum(1.0, 3.4 - 2.0 * backup_ratio)


def reliability_factor(reliability: Any) -> Any:
    """Return K_R of a reliability R by its curves.

    0.658 - 0.0759 ln(1 - R) below 0.99, 0.50 - 0.109 ln(1 - R) from there. For 0.5 <= R <= 0.9999.
    The table RELIABILITY has 0.85 for 0.8328 at 0.90, 0.70 for 0.7106 at 0.5. Source: Shigley, eq.
    (14-38), a fit of AGMA 2001-D04, table 11.
    """
    unreliable = np.log(1.0 - reliability)
    return choose(reliability < 0.99, 0.658 - 0.0759 * unreliable, 0.50 - 0.109 * unreliable)


def temperature_factor(temperature_C: Any) -> Any:
    """Return K_T: 1 up to 120 degrees C, (460 + T)/620 above, T in degrees F; at least 1.

    temperature of the gear blank or the oil [degrees C]. AGMA 2001-D04, clause 19, gives 1 and
    leaves higher temperatures to judgement. The form above 120 degrees is customary (textbooks of
    machine design; a public program has it at all temperatures); it starts with a jump to 1.14.
    """
    fahrenheit = 1.8 * temperature_C + 32.0
    hot = choose(temperature_C > WARM, 1.0, 0.0)
    return 1.0 + hot * np.maximum(0.0, (460.0 + fahrenheit) / 620.0 - 1.0)


def elastic_coefficient(
    pinion_modulus: Any, pinion_poisson: Any, wheel_modulus: Any, wheel_poisson: Any
) -> Any:
    """Return C_p = 1/sqrt(pi ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2)) [sqrt(MPa)]; 2101: Z_E.

    moduli E [MPa]. 189.8 of steel with E = 206000, nu = 0.3; AGMA's customary 2300 sqrt(psi) is
    190.98. Source: AGMA 2001-D04, eq. (31); ISO 6336-2.
    """
    pinion = (1.0 - pinion_poisson**2) / pinion_modulus
    return (np.pi * (pinion + (1.0 - wheel_poisson**2) / wheel_modulus)) ** -0.5


WHEELS = (180.0, 400.0)  # HB of wheels against surface hardened pinions
LARGEST_HARDNESS_RATIO = 1.34  # of C_H, of any hardness: 1 + 0.00075 450 rounded up
LARGEST_RATIO = 20.0  # where the chart of through-hardened pairs ends
MICROINCH = 1e-6 * INCH  # mm


def hardness_ratio_factor(pinion_hardness: Any, wheel_hardness: Any, ratio: Any) -> Any:
    """Return C_H = 1 + A (u - 1) of a through-hardened wheel by a through-hardened pinion.

    That of the pinion is 1. A = 8.98e-3 HB_1/HB_2 - 8.29e-3 for HB_1/HB_2 of 1.2 to 1.7, 0 below,
    0.00698 above: A jumps by 2.5e-3 at 1.2 and by 4e-6 at 1.7. Hardnesses [HB]; a ratio u above 20,
    where the chart ends, counts as 20.
    Source: AGMA 2001-D04, clause 14, figure; Shigley, eq. (14-36); the limit of 20 is of its chart.
    """
    harder = pinion_hardness / wheel_hardness
    slope = choose(harder < 1.2, 0.0, choose(harder > 1.7, 0.00698, 8.98e-3 * harder - 8.29e-3))
    return 1.0 + slope * (np.minimum(ratio, LARGEST_RATIO) - 1.0)


def surface_hardened_factor(finish: Any, wheel_hardness: Any) -> Any:
    """Return C_H = 1 + B (450 - HB_2), at least 1, of a pinion of 48 HRC or more.

    B = 0.00075 exp(-0.0112 f_P), f_P: its finish R_a in microinches; finish R_a [mm] (the metric
    form of the standard has exp(-0.448 f_P), f_P in um, 1.6 % more of the exponent: the inch form
    is taken). For wheels of 180 to 400 HB. Source: AGMA 2001-D04, clause 14; Shigley, eq. (14-37).
    """
    slope = 0.00075 * np.exp(-0.0112 * finish / MICROINCH)
    return np.maximum(1.0, 1.0 + slope * (450.0 - wheel_hardness))
