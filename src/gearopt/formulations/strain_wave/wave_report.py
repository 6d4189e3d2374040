"""A strain wave gearing for its report: sizes, flank, clearances, loads, stresses, cutter.

Fields are keys of a result, with their units; lists of one table are columns of equal length.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import Cutter, CutterDesign, cutter_of
from gearopt.formulations.strain_wave.demand import Demand, limits, slipping
from gearopt.formulations.strain_wave.duty import (
    Duty,
    equal_pressure,
    loads_at,
    pressures,
    shared_pressure,
)
from gearopt.formulations.strain_wave.exchange import STEP_DEG, stretched
from gearopt.formulations.strain_wave.shift import (
    ShiftPoint,
    largest_addendum,
    last_shift_of_one_pair,
    shift_curve,
)
from gearopt.formulations.strain_wave.wave_design import COUNT
from gearopt.formulations.strain_wave.wave_sharing import REACH
from gearopt.physics.strain_wave.circular_arc import teeth_on_path
from gearopt.physics.strain_wave.clearance import interference, teeth_within, tooth_arcs
from gearopt.physics.strain_wave.clearance import tooth_clearances as clearances_of
from gearopt.physics.strain_wave.conjugate import Flank, contact, least_deflection
from gearopt.physics.strain_wave.cutter import blank_profile
from gearopt.physics.strain_wave.neutral_curve import curvature
from gearopt.physics.strain_wave.strength import rim_stresses
from gearopt.physics.strain_wave.tooth_motion import motion

Columns = tuple[float, ...]
WITHIN = (1.0, 2.0, 5.0, 10.0, 20.0)  # um
ROWS = 21  # of the flank's table
OTHER_DEFLECTIONS = (-0.05, -0.02, 0.02, 0.05)  # modules beside the design's
SHIFTS = (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1)  # profile shifts of the curve
FINE = 80  # clearances that are listed on either side of the arc of contact
GUARDS = ("curvature", "cusp")  # keep the flank regular
TURNS = 8  # positions of the wave generator over one pitch
HALF_LOCUS = (math.radians(0.5), math.radians(60.0))  # of the wave, that such teeth use


@dataclass(frozen=True, kw_only=True)
class ToothLoad:
    """A tooth: its number from the middle of the arc of contact, and what it carries."""

    tooth: int
    wave_angle_deg: float
    clearance_mm: float
    force_N: float
    contact_pressure_MPa: float


@dataclass(frozen=True, kw_only=True)
class ShiftRow:
    """A profile shift: pairs, least radius, pressures by equal, whole and shared loads."""

    profile_shift: float
    pairs: float
    radius_mm: float
    equal_MPa: float
    whole_MPa: float
    shared_MPa: float
    least_clearance_mm: float


@dataclass(frozen=True, kw_only=True)
class Deflected:
    """The same teeth on a wave generator of another deflection."""

    deflection: float
    least_clearance_mm: float


@dataclass(frozen=True, kw_only=True)
class RoundRow:
    """A round of the search: cuts so far, pressure, least clearance over the wave."""

    cuts: int
    pressure_MPa: float
    least_clearance_mm: float
    iterations: int


@dataclass(frozen=True, kw_only=True)
class WaveDesign:
    """A strain wave gearing and what is computed of it.

    flank: columns from root to tip; heights over the neutral curve, half thicknesses of the tooth;
    radius of the circular spline and radii of curvature. along_wave: clearances of a tooth by its
    angle on the wave; load: the load that a tooth carries there. teeth: of one lobe with the wave
    generator at its middle position; effective_teeth: how many would carry the largest load alike.
    """

    ratio: float
    flexspline_teeth: int
    circular_spline_teeth: int
    module_mm: float
    pressure_angle_deg: float
    profile_shift: float
    addendum: float
    clearance: float
    deflection: float
    rim_mm: float
    wave_generator: str
    wrap_angle_deg: float
    face_width_mm: float
    torque_Nm: float
    outer_diameter_mm: float
    base_diameter_mm: float
    tip_diameter_mm: float
    active_diameter_mm: float
    root_diameter_mm: float
    neutral_diameter_mm: float
    pairs_in_contact: float
    effective_teeth: float
    carrying_teeth: int
    windup_mrad: float
    equal_pressure_MPa: float
    whole_pairs_pressure_MPa: float
    shared_pressure_MPa: float
    rim_bending_MPa: float
    rim_shear_MPa: float
    ratcheting_torque_Nm: float
    least_clearance_mm: float
    least_clearance_at_deg: float
    least_deflection: float
    half_locus_teeth: float
    shift_of_one_pair: float | None
    largest_addendum: float | None
    within_um: Columns
    teeth_within: Columns
    arc_deg: Columns
    radius_mm: Columns
    height_mm: Columns
    half_thickness_mm: Columns
    flexspline_curvature_mm: Columns
    circular_curvature_mm: Columns
    relative_curvature_mm: Columns
    wave_angle_deg: Columns
    wave_clearance_mm: Columns
    load_angle_deg: Columns
    load_N: Columns
    load_pressure_MPa: Columns
    teeth: tuple[ToothLoad, ...]
    shifts: tuple[ShiftRow, ...]
    deflections: tuple[Deflected, ...]
    cutter: CutterDesign | None = None
    rounds: tuple[RoundRow, ...] = ()


def described(
    demand: Demand, made: Flank, cutter: Cutter | None, rounds: Sequence[RoundRow] = ()
) -> WaveDesign:
    """Return all that is told of a gearing and its flank; cutter: the tool that is asked for."""
    gearing, duty = made.gearing, demand.duty
    teeth, windup, effective = _teeth(duty, made)
    found = interference(made, STEP_DEG, 201)
    return WaveDesign(
        **_sizes(demand, made),
        **_columns(made),
        **_loads(duty, made),
        carrying_teeth=sum(t.force_N > 0.0 for t in teeth),
        effective_teeth=effective,
        windup_mrad=windup,
        equal_pressure_MPa=equal_pressure(duty, made),
        whole_pairs_pressure_MPa=equal_pressure(duty, made, whole=True),
        shared_pressure_MPa=shared_pressure(duty, made),
        least_clearance_mm=_gap(found.least),
        least_clearance_at_deg=math.degrees(found.angle),
        least_deflection=least_deflection(gearing),
        half_locus_teeth=teeth_on_path(gearing, *HALF_LOCUS),
        shift_of_one_pair=last_shift_of_one_pair(gearing),
        largest_addendum=largest_addendum(gearing),
        within_um=WITHIN,
        teeth_within=_floats(teeth_within(made, 1e-3 * np.array(WITHIN))),
        teeth=teeth,
        shifts=tuple(_shift(p) for p in shift_curve(gearing, duty, SHIFTS)),
        deflections=tuple(_deflected(made, by) for by in OTHER_DEFLECTIONS),
        cutter=cutter_of(gearing, blank_profile(made), cutter) if cutter else None,
        rounds=tuple(rounds),
    )


def sketched(demand: Demand, made: Flank) -> dict[str, Any]:
    """Return sizes, pairs, pressures and the least clearance of a gearing, under the same keys."""
    return {
        **_sizes(demand, made),
        "pairs_in_contact": float(made.pairs_in_contact),
        "equal_pressure_MPa": equal_pressure(demand.duty, made),
        "shared_pressure_MPa": shared_pressure(demand.duty, made),
        "least_clearance_mm": _gap(interference(made, STEP_DEG, 201).least),
    }


def used(demand: Demand, made: Flank) -> dict[str, float]:
    """Return the utilisation of every limit by a gearing: the largest of a limit on several points.

    interference: above 1, in modules, where teeth cut each other at some pose. Limits that only
    keep the flank regular are named where they are exceeded.
    """
    angle = np.linspace(made.contacts.motion.angle[0], made.contacts.motion.angle[-1], COUNT)
    at = [contact(made.gearing, motion(made.gearing, made.curve, p)) for p in angle]
    found = limits(demand, made.gearing, made.curve, at)
    if not math.isfinite(demand.outer_radius):
        del found["outer_radius"]
    least = interference(made, STEP_DEG, 201)
    clear = 0.0 if least.free else least.least
    flat = {k: float(max(v) if isinstance(v, tuple) else v) for k, v in found.items()}
    if clear < 0.0:
        flat["interference"] = 1.0 - clear / float(made.gearing.module)
    return {k: v for k, v in flat.items() if k not in GUARDS or v > 1.0}


def _sizes(demand: Demand, made: Flank) -> dict[str, Any]:
    gearing, duty = made.gearing, demand.duty
    apex = curvature(made.curve, 0.0)[0]
    wall = duty.cup.wall
    bending, shear = rim_stresses(gearing, apex, duty.torque, duty.moduli[0], demand.notch, wall)
    tip = contact(gearing, motion(gearing, made.curve, made.contacts.motion.angle[-1]))
    return {
        "ratio": float(gearing.ratio),
        "flexspline_teeth": int(gearing.teeth),
        "circular_spline_teeth": int(gearing.circular_teeth),
        "module_mm": float(gearing.module),
        "pressure_angle_deg": math.degrees(gearing.pressure_angle),
        "profile_shift": float(gearing.profile_shift),
        "addendum": float(gearing.addendum),
        "clearance": float(gearing.clearance),
        "deflection": float(gearing.deflection),
        "rim_mm": float(gearing.rim),
        "wave_generator": gearing.wave,
        "wrap_angle_deg": math.degrees(gearing.wrap) if gearing.wave == "discs" else 0.0,
        "face_width_mm": duty.face_width,
        "torque_Nm": 1e-3 * duty.torque,
        "outer_diameter_mm": 2.0 * float(demand.radius_needed(gearing)),
        "base_diameter_mm": 2.0 * float(gearing.base_radius),
        "tip_diameter_mm": 2.0 * float(gearing.tip_radius),
        "active_diameter_mm": 2.0 * float(gearing.active_radius),
        "root_diameter_mm": 2.0 * float(gearing.root_radius),
        "neutral_diameter_mm": 2.0 * float(gearing.neutral_radius),
        "pairs_in_contact": float(made.pairs_in_contact),
        "rim_bending_MPa": float(bending),
        "rim_shear_MPa": float(shear),
        "ratcheting_torque_Nm": 1e-3 * float(slipping(demand, gearing, tip)),
    }


def _columns(made: Flank) -> dict[str, Any]:
    at = made.contacts
    k = np.rint(np.linspace(0, len(at.tangent) - 1, ROWS)).astype(int)
    middle = float(tooth_arcs(made, 0))
    arcs = middle + np.linspace(-REACH, REACH, 2 * FINE + 1)
    gaps = clearances_of(made, arcs)
    near = np.isfinite(gaps)
    return {
        "arc_deg": _floats(np.degrees(at.motion.arc[k])),
        "radius_mm": _floats(at.radius[k]),
        "height_mm": _floats(at.point.x[k]),
        "half_thickness_mm": _floats(at.point.y[k]),
        "flexspline_curvature_mm": _floats(1.0 / np.abs(at.curvatures[1][k])),
        "circular_curvature_mm": _floats(1.0 / np.abs(at.curvatures[0][k])),
        "relative_curvature_mm": _floats(1.0 / at.gap_curvature[k]),
        "wave_angle_deg": _floats(np.degrees(arcs[near])),
        "wave_clearance_mm": tuple(map(_gap, gaps[near])),
    }


def _loads(duty: Duty, made: Flank) -> dict[str, Any]:
    """Return the load of a tooth by its angle, by turning the wave generator through a pitch."""
    rows: list[tuple[float, float, float]] = []
    for shift in np.arange(TURNS) / TURNS:
        teeth, loads = loads_at(duty, made, float(shift))
        stress = pressures(duty, made, teeth, loads)
        near = np.abs(teeth.numbers) <= teeth.numbers.max() // 2
        rows += zip(teeth.arcs[near], loads.forces[near], stress[near], strict=True)
    arcs, forces, stresses = np.array(sorted(rows)).T
    return {
        "load_angle_deg": _floats(np.degrees(arcs)),
        "load_N": _floats(forces),
        "load_pressure_MPa": _floats(stresses),
    }


def _teeth(duty: Duty, made: Flank) -> tuple[tuple[ToothLoad, ...], float, float]:
    """Return the teeth that carry and their neighbours, windup [mrad], effective teeth."""
    teeth, loads = loads_at(duty, made)
    stress = pressures(duty, made, teeth, loads)
    carries = np.flatnonzero(loads.forces > 0.0)
    shown = range(max(0, carries[0] - 3), min(len(stress), carries[-1] + 4))
    rows = tuple(
        ToothLoad(
            tooth=int(teeth.numbers[k]),
            wave_angle_deg=math.degrees(teeth.arcs[k]),
            clearance_mm=_gap(teeth.gaps[k]),
            force_N=float(loads.forces[k]),
            contact_pressure_MPa=float(stress[k]),
        )
        for k in shown
    )
    return rows, 1e3 * loads.windup, loads.effective


def _shift(point: ShiftPoint) -> ShiftRow:
    return ShiftRow(
        profile_shift=point.shift,
        pairs=point.pairs,
        radius_mm=point.radius,
        equal_MPa=point.equal,
        whole_MPa=point.whole,
        shared_MPa=point.shared,
        least_clearance_mm=_gap(point.least_gap),
    )


def _deflected(made: Flank, by: float) -> Deflected:
    deflection = float(made.gearing.deflection) + by
    found = interference(stretched(made, deflection), STEP_DEG)
    return Deflected(deflection=deflection, least_clearance_mm=_gap(found.least))


def _gap(value: float) -> float:
    """Return a clearance [mm] without what rounding leaves of a contact."""
    return round(float(value), 9) + 0.0


def _floats(values: Any) -> Columns:
    return tuple(map(float, values))
