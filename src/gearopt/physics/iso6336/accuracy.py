"""Deviations of the teeth that part 1 takes, from tolerances of ISO 1328-1:1995 or 2013.

The standard of 1995 takes the geometric means of ranges of module, diameter and face width, and
rounds: the exact form has these steps, the smooth one takes the sizes as they are, unrounded.
Grades may be fractions. Deviations [mm], sizes [mm]; floats or arrays.
"""

from functools import cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics import tolerances
from gearopt.physics.gears import GearPair
from gearopt.physics.tolerances import helix_slope_tolerance, rounded_tolerance

TOLERANCES = ("1995", "2013")
# Ends of the ranges [mm]. Source: ISO 1328-1:1995, 5.2; gfsReboucas/Drivetrain, Gear.m
DIAMETERS = (5.0, 20, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6000, 8000, 10000)
MODULES = (0.5, 2.0, 3.5, 6, 10, 16, 25, 40, 70)
WIDTHS = (4.0, 10, 20, 40, 80, 160, 250, 400, 650, 1000)
RANGES_1995 = {
    "grade": (0.0, 12.0),
    "module": (MODULES[0], MODULES[-1]),
    "diameter": (DIAMETERS[0], DIAMETERS[-1]),
    "face_width": (WIDTHS[0], WIDTHS[-1]),
}


@dataclass(frozen=True)
class Deviations:
    """Deviations of a pair [mm].

    base_pitch f_pb, transverse, and profile_form f_falpha: the larger of both gears; alignment
    f_ma = hypot(f_Hbeta1, f_Hbeta2), the mesh misalignment of manufacture; helix_slope: the larger
    f_Hbeta.
    """

    base_pitch: Any
    profile_form: Any
    alignment: Any
    helix_slope: Any


def range_mean(size: Any, ends: tuple[float, ...]) -> Any:
    """Return the geometric mean of the range in which a size lies; upper ends belong to it.

    A size beyond the ranges counts to the nearest one. Source: ISO 1328-1:1995, 5.2.
    """
    return _means(ends)[range_of(size, ends[1:-1])]


@cache
def _means(ends: tuple[float, ...]) -> Any:
    bounds = np.asarray(ends, float)
    return np.sqrt(bounds[:-1] * bounds[1:])


def range_of(size: Any, ends: Any) -> Any:
    """Return the index of the range in which a size lies, by the ends between ranges."""
    place = 0
    for end in ends:
        place = place + (size > end)
    return place


@cache
def slopes_1995(grade: float) -> Any:
    """Return f_Hbeta of every range of diameter and of face width [mm]."""
    means = _means(DIAMETERS)[:, None], _means(WIDTHS)
    return rounded_tolerance(helix_slope_1995(*means, grade))


def single_pitch_1995(diameter: Any, module: Any, grade: Any) -> Any:
    """Return the single pitch deviation f_pt of a grade [mm], unrounded.

    (0.3 (m + 0.4 sqrt(d)) + 4) um times `grade_factor`. Source: ISO 1328-1:1995, 6.1.
    """
    unit = 0.3 * (module + 0.4 * diameter**0.5) + 4.0
    return tolerances.MICROMETRE * unit * tolerances.grade_factor(grade)


def profile_form_1995(diameter: Any, module: Any, grade: Any) -> Any:
    """Return the profile form deviation f_falpha of a grade [mm], unrounded.

    (2.5 sqrt(m) + 0.17 sqrt(d) + 0.5) um times `grade_factor`. Source: ISO 1328-1:1995, annex B.
    """
    unit = 2.5 * module**0.5 + 0.17 * diameter**0.5 + 0.5
    return tolerances.MICROMETRE * unit * tolerances.grade_factor(grade)


def helix_slope_1995(diameter: Any, face_width: Any, grade: Any) -> Any:
    """Return the helix slope deviation f_Hbeta of a grade [mm], unrounded.

    (0.07 sqrt(d) + 0.45 sqrt(b) + 3) um times `grade_factor`. Source: ISO 1328-1:1995, annex B.
    """
    unit = 0.07 * diameter**0.5 + 0.45 * face_width**0.5 + 3.0
    return tolerances.MICROMETRE * unit * tolerances.grade_factor(grade)


def deviations(
    pair: GearPair, grades: tuple[Any, Any], edition: str = "1995", smooth: bool = False
) -> Deviations:
    """Return the deviations of a pair whose gears have accuracy grades of ISO 1328.

    edition: one of TOLERANCES; smooth: without ranges and rounding. f_pb = f_pt cos(alpha_t).
    ValueError for another edition. Source: ISO 6336-1:2006, 6.5, 7.5 and 8.3; a printed report
    (KISSsoft, NREL 5 MW) has its f_pb and f_falpha so.
    """
    if edition not in TOLERANCES:
        raise ValueError(f"no tolerances {edition!r}; known: {', '.join(TOLERANCES)}")
    found = [
        _of_gear(gear, grade, edition, smooth)
        for gear, grade in zip(pair.gears, grades, strict=True)
    ]
    pitch, form, slope = (np.maximum(a, b) for a, b in zip(*found, strict=True))
    cosine = np.cos(pair.pinion.transverse_pressure_angle)
    (_, _, first), (_, _, second) = found
    return Deviations(pitch * cosine, form, (first**2 + second**2) ** 0.5, slope)


def beyond(pair: GearPair, grades: tuple[Any, Any], edition: str = "1995") -> list[str]:
    """Return which sizes of a pair of floats lie outside the ranges of ISO 1328-1.

    Source: ISO 1328-1:1995, 1, of the diameters, modules and widths above, and `tolerances.SCOPE`.
    """
    ranges = tolerances.SCOPE if edition == "2013" else RANGES_1995
    outside = []
    for gear, grade in zip(pair.gears, grades, strict=True):
        sizes = {
            "grade": grade,
            "module": gear.normal_module,
            "diameter": abs(gear.reference_diameter),
            "face_width": gear.face_width,
        }
        outside += [name for name, size in sizes.items() if not _within(size, ranges[name])]
    return [name.replace("_", " ") for name in dict.fromkeys(outside)]


def _within(size: Any, ends: tuple[float, float]) -> bool:
    return bool(ends[0] <= size <= ends[1])


def helix_slope(
    diameter: Any, face_width: Any, grade: Any, edition: str = "1995", smooth: bool = False
) -> Any:
    """Return f_Hbeta of a gear [mm], as `deviations` has it; diameter, face_width [mm]."""
    if smooth and edition == "1995":
        return helix_slope_1995(diameter, face_width, grade)
    if edition == "1995":
        places = range_of(diameter, DIAMETERS[1:-1]), range_of(face_width, WIDTHS[1:-1])
        return slopes_1995(grade)[places]
    if smooth:
        return helix_slope_tolerance(diameter, face_width, grade)
    return slope_2013(diameter, face_width, grade)


def slope_2013(diameter: Any, face_width: Any, grade: Any) -> Any:
    """Return f_Hbeta [mm] by ISO 1328-1:2013, rounded."""
    return rounded_tolerance(helix_slope_tolerance(diameter, face_width, grade))


def _of_gear(gear: Any, grade: Any, edition: str, smooth: bool) -> tuple[Any, Any, Any]:
    """Return f_pt, f_falpha, f_Hbeta of a gear."""
    diameter, module, width = np.abs(gear.reference_diameter), gear.normal_module, gear.face_width
    slope = helix_slope(diameter, width, grade, edition, smooth)
    if edition == "2013":
        pitch = tolerances.single_pitch_tolerance(diameter, module, grade)
        form = tolerances.profile_form_tolerance(module, grade)
    else:
        if not smooth:
            diameter, module = range_mean(diameter, DIAMETERS), range_mean(module, MODULES)
        pitch = single_pitch_1995(diameter, module, grade)
        form = profile_form_1995(diameter, module, grade)
    if smooth:
        return pitch, form, slope
    return rounded_tolerance(pitch), rounded_tolerance(form), slope
