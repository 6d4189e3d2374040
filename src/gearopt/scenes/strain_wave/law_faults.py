"""Shapes that no tooth can have: the key at fault, and a value to write instead."""

import math
from dataclasses import replace

from gearopt.formulations.strain_wave.swept_report import (
    DOUBLE_ARC,
    Law,
    double_arc,
    swept_gearing,
    swept_tooth,
)
from gearopt.physics.strain_wave.circular_arc import DoubleArc, tooth_heights
from gearopt.physics.strain_wave.conjugate import existence, flank, least_deflection
from gearopt.physics.strain_wave.gearing import StrainWave

THINNEST = 0.05  # modules that a tooth's tip is thick at least
ANGLES = (20, 25, 30, 35, 40)  # degrees that are tried instead
ADDENDA = (0.8, 0.7, 0.6, 0.5, 0.4, 0.3)  # modules that are tried instead
HIGHER, TRIED = 0.01, 60  # modules between deflections that are tried instead, and how many
Fault = tuple[str, tuple[str, str], str | float | None]  # rule, place, and what to write there


def contact_fault(gearing: StrainWave) -> Fault | None:
    """Return why an involute has no conjugate flank from root to tip; None where it has one."""
    if flank(gearing).complete.all():
        return None
    least, deflection = least_deflection(gearing), float(gearing.deflection)
    if math.isinf(least):
        return _never(gearing)
    first = math.ceil(100.0 * max(least, deflection)) / 100.0
    tried = (first + HIGHER * k for k in range(TRIED))
    enough = (w for w in tried if flank(replace(gearing, deflection=w), 41).complete.all())
    write, place = next(enough, None), ("gears", "deflection")
    rule = "leaves a part of the flank without conjugate contact"
    if write is None:
        return _shorter_or_steeper(gearing, rule)
    write = round(write, 2)
    if deflection >= least:
        return rule, place, write
    arcs = existence(gearing)
    beyond = math.degrees(min(abs(end) for arc in arcs for end in arc)) if arcs else 90.0
    where = f"from {beyond:.1f} degrees of the wave on" if arcs else "nowhere on the wave"
    rule = (
        f"is too small: there is no contact at the major axis below {least:.4f}, where the instant "
        f"centre enters the base circle; contact exists {where}"
    )
    return rule, place, write


def _shorter_or_steeper(gearing: StrainWave, rule: str) -> Fault:
    """Return a fault with an addendum, else a pressure angle, that gives a flank, if any does."""
    tip, angle = float(gearing.addendum), math.degrees(gearing.pressure_angle)
    for addendum in (a for a in ADDENDA if a < tip):
        if flank(replace(gearing, addendum=addendum), 41).complete.all():
            return rule, ("gears", "addendum"), addendum
    for degrees in (a for a in ANGLES if a > angle):
        if flank(_steeper(gearing, degrees), 41).complete.all():
            return rule, ("gears", "pressure_angle"), f"{degrees} deg"
    return rule, ("gears", "addendum"), None


def _never(gearing: StrainWave) -> Fault:
    """Return the fault by which no deflection brings contact to the major axis: rim, else angle."""
    rule = "no deflection up to 2 modules brings contact to the major axis"
    usual = 0.01 * float(gearing.module * gearing.teeth)
    if gearing.rim > usual and math.isfinite(least_deflection(replace(gearing, rim=usual))):
        return f"is too thick: {rule}", ("gears", "rim"), _mm(usual)
    steeper = (a for a in ANGLES if math.isfinite(least_deflection(_steeper(gearing, a))))
    angle = next(steeper, None)
    write = None if angle is None else f"{angle} deg"
    return f"is too small: {rule}", ("gears", "pressure_angle"), write


def _steeper(gearing: StrainWave, degrees: int) -> StrainWave:
    return replace(gearing, pressure_angle=math.radians(degrees))


def law_fault(gearing: StrainWave, law: Law) -> Fault | None:
    """Return why a law gives no tooth; None where it gives one."""
    pitch = math.pi * float(gearing.module)
    if law.thickness > 0.9 * pitch:
        rule = f"is above {0.9 * pitch:.4g} mm, nine tenths of the pitch"
        return rule, ("teeth", "thickness"), _mm(0.5 * pitch)
    if law.name == DOUBLE_ARC and (fault := _arc_fault(gearing, law, double_arc(gearing, law))):
        return fault
    try:
        tooth = swept_tooth(gearing, law)
    except ValueError as reason:
        return str(reason), ("gears", "addendum"), None
    tip, least = 2.0 * float(tooth.points.y[-1]), THINNEST * float(gearing.module)
    if tip < least:
        rule = f"is too small: the tip would be {tip:.4g} mm thick, at least {least:.4g} mm"
        return rule, ("teeth", "thickness"), _mm(law.thickness + least - tip)
    try:
        swept_gearing(gearing, law)
    except ValueError:
        return (
            "makes flanks that are conjugate nowhere on the wave",
            ("gears", "deflection"),
            None,
        )
    return None


def _arc_fault(gearing: StrainWave, law: Law, arcs: DoubleArc) -> Fault | None:
    low, middle, high = tooth_heights(gearing)
    longest = 2.0 * (middle - low)
    if law.tangent > 0.9 * longest:
        rule = f"is above {0.9 * longest:.4g} mm, nine tenths of the flank's height"
        return rule, ("teeth", "tangent"), _mm(0.1 * longest)
    ends = ("convex_radius", high - middle), ("concave_radius", middle - low)
    for (key, depth), radius in zip(ends, law.radii, strict=True):
        least = arcs.least_radius(depth)
        if radius < least:
            rule = f"is too small for the addendum: the arc needs {least:.4g} mm to the flank's end"
            return rule, ("teeth", key), _mm(1.1 * least)
    return None


def _mm(value: float) -> str:
    return f"{value:.3g} mm"
