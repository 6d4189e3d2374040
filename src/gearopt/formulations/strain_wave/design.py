"""A strain wave gearing for its report: sizes, flank, clearances, loads, stresses, cutter.

Fields are keys of a result, with their units; lists of one table are columns of equal length.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import field, replace
from typing import Annotated, Any, TypeVar

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import Cutter, CutterDesign, cutter_of
from gearopt.formulations.strain_wave.demand import (
    Demand,
    Duty,
    equal_pressure,
    flank_ratcheting_torque,
    limits,
    loads_turned,
    pressures,
    rim_of,
    shared_pressure,
)
from gearopt.formulations.strain_wave.exchange import CUTTING, STEP_DEG, RangeEnd, stretched
from gearopt.formulations.strain_wave.sharing import REACH, Loads
from gearopt.formulations.strain_wave.shift import (
    largest_addendum,
    last_shift_of_one_pair,
    shift_curve,
)
from gearopt.formulations.strain_wave.sizing import COUNT
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.typed import Shown
from gearopt.physics.strain_wave.clearance import interference, teeth_within, tooth_arcs
from gearopt.physics.strain_wave.clearance import tooth_clearances as clearances_of
from gearopt.physics.strain_wave.conjugate import Flank, contact, least_deflection
from gearopt.physics.strain_wave.cutter import blank_profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, radii
from gearopt.physics.strain_wave.tooth_motion import motion

T = TypeVar("T")
Columns = tuple[float, ...]
REPLACED = 0.3  # s that line and arc in place of a cutter's edge take
SOUGHT = 0.2  # s that a part takes which is sought: the largest addendum, a curve over shifts
INVOLUTE = "involute"  # law of the circular spline's teeth, to which the flexspline's are conjugate
WITHIN = (1.0, 2.0, 5.0, 10.0, 20.0)  # um
ROWS = 21  # of the flank's table
DIGITS = 12  # of numbers in modules: a solver leaves 1e-13 of a 0
OTHER_DEFLECTIONS = (-0.05, -0.02, 0.02, 0.05)  # modules beside the design's
SHIFTS = (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1)  # profile shifts of the curve
CLEARANCES_LISTED = 80  # clearances that are listed on either side of the arc of contact
GUARDS = ("curvature", "cusp")  # keep the flank regular
LOADS_LISTED = 0.5  # part of the teeth whose loads are listed
CONTACT, FLANK = "conjugate contact", "points of the flexspline's flank"
SPACE = "points of the circular spline's flank"
CLEARANCE, LOAD = "clearance over the wave", "load over the wave"
TURNS = 8  # positions of the wave generator over one pitch


@dataclass(frozen=True, kw_only=True)
class ToothLoad:
    """A tooth: its number from the middle of the arc of contact, and its load."""

    tooth: Annotated[int, Shown("tooth")]
    wave_angle_deg: Annotated[float, Shown("on the wave", form=".3f")]
    clearance_mm: Annotated[float, Shown("clearance", unit="um")]
    force_N: Annotated[float, Shown("load")]
    contact_pressure_MPa: Annotated[float, Shown("contact pressure")]


@dataclass(frozen=True, kw_only=True)
class ShiftRow:
    """A profile shift: pairs, least radius, pressures by equal, whole and shared loads."""

    profile_shift: Annotated[float, Shown("profile shift", form="g")]
    pairs: Annotated[float, Shown("pairs")]
    radius_mm: Annotated[float, Shown("least R")]
    equal_MPa: Annotated[float, Shown("contact pressure of conjugate pairs")]
    whole_MPa: Annotated[float, Shown("contact pressure, by the whole pairs that always touch")]
    shared_MPa: Annotated[float, Shown("contact pressure, load shared")]
    least_clearance_mm: Annotated[float, Shown("least clearance", unit="um")]


@dataclass(frozen=True, kw_only=True)
class Deflected:
    """The same teeth on a wave generator of another deflection."""

    deflection: Annotated[float, Shown("deflection, modules", form="g")]
    least_clearance_mm: Annotated[float, Shown("least clearance", unit="um")]


@dataclass(frozen=True, kw_only=True)
class RoundRow:
    """A round of the search: cuts so far, pressure, least clearance over the wave."""

    cuts: Annotated[int, Shown("passages held clear")]
    pressure_MPa: Annotated[float, Shown("contact pressure of conjugate pairs")]
    least_clearance_mm: Annotated[float, Shown("least clearance", unit="um")]
    iterations: Annotated[int, Shown("iterations")]


@dataclass(frozen=True, kw_only=True)
class WaveDesign:
    """A strain wave gearing and all that is computed of it.

    law: how the teeth are made; what only involutes have is None of others, or empty. arc to
    relative_curvature: contacts by the tooth's angle on the wave, with heights over the neutral
    curve, half thicknesses of the tooth, radius on the circular spline, radii of curvature.
    wave_major, wave_minor: diameters of the wave generator inside the flexspline's rim.
    elastic_rim: whether teeth share the load, and wind up, on a rim that yields.
    touching: stretches of the wave on which flanks are conjugate. tooth: the flank from root to
    tip, height and half thickness; space: that of the circular spline from its tip, across from the
    middle of the space and out from the axis. wave: clearances of a tooth by its angle; load: what
    it carries there. teeth: of one lobe with the wave generator at its middle position;
    effective_teeth: how many would carry the largest load alike. left_out: what is missing for lack
    of time, in words.
    """

    law: Annotated[str, Shown("law of the teeth", "teeth")] = INVOLUTE
    ratio: Annotated[float, Shown("ratio, circular spline at rest", "teeth")]
    flexspline_teeth: Annotated[int, Shown("teeth of the flexspline", "teeth")]
    circular_spline_teeth: Annotated[int, Shown("teeth of the circular spline", "teeth")]
    module_mm: Annotated[float, Shown("module", "teeth", "mm", "4")]
    pressure_angle_deg: Annotated[float, Shown("pressure angle", "teeth")]
    profile_shift: Annotated[float, Shown("profile shift, modules", "teeth")]
    addendum: Annotated[float, Shown("addendum, modules", "teeth")]
    deflection: Annotated[float, Shown("deflection, modules", "teeth")]
    rim_mm: Annotated[float, Shown("rim", "teeth", form="4")]
    thickness_mm: Annotated[
        float | None, Shown("thickness at half the height", "teeth", form="4")
    ] = None
    arc_radii_mm: Columns = ()
    tangent_mm: float | None = None
    clearance: float
    elastic_rim: bool = False
    wave_generator: Annotated[str, Shown("wave generator", "gearing")]
    face_width_mm: Annotated[float, Shown("face width", "gearing", form="4")]
    outer_diameter_mm: Annotated[float, Shown("outer diameter", "gearing", form="4")]
    tip_diameter_mm: Annotated[float, Shown("circular spline: tip diameter", "gearing", form="4")]
    active_diameter_mm: Annotated[float, Shown("last active diameter", "gearing", form="4")]
    root_diameter_mm: Annotated[float, Shown("root diameter", "gearing", form="4")]
    base_diameter_mm: Annotated[float | None, Shown("base diameter", "gearing", form="4")] = None
    wrap_angle_deg: float
    torque_Nm: float
    neutral_diameter_mm: float
    wave_major_mm: float
    wave_minor_mm: float
    pairs_in_contact: Annotated[float, Shown("conjugate pairs per lobe and flank", "loads")]
    carrying_teeth: Annotated[int, Shown("teeth that carry, per lobe", "loads")]
    effective_teeth: Annotated[float, Shown("equivalent number, equally loaded", "loads")]
    windup_mrad: Annotated[float, Shown("windup", "loads")]
    shared_pressure_MPa: Annotated[float, Shown("contact pressure, load shared", "loads")]
    equal_pressure_MPa: Annotated[float, Shown("contact pressure of conjugate pairs", "loads")]
    whole_pairs_pressure_MPa: Annotated[
        float, Shown("contact pressure, by the whole pairs that always touch", "loads")
    ]
    rim_bending_MPa: Annotated[float, Shown("bending of the rim", "loads")]
    rim_shear_MPa: Annotated[float, Shown("shear of the rim", "loads")]
    ratcheting_torque_Nm: Annotated[float, Shown("ratcheting torque", "loads")]
    least_deflection: Annotated[
        float | None, Shown("least deflection with contact, modules", "loads")
    ] = None
    least_clearance_mm: float
    least_clearance_at_deg: float
    shift_of_one_pair: float | None = None
    largest_addendum: float | None = None
    within_um: Columns
    teeth_within: Columns
    arc_deg: Annotated[Columns, Shown("on the wave", CONTACT, form=".4f")]
    radius_mm: Annotated[Columns, Shown("radius", CONTACT)]
    height_mm: Annotated[Columns, Shown("height", CONTACT)]
    half_thickness_mm: Annotated[Columns, Shown("half thickness", CONTACT)]
    flexspline_curvature_mm: Annotated[Columns, Shown("R_f", CONTACT)]
    circular_curvature_mm: Annotated[Columns, Shown("R_c", CONTACT)]
    relative_curvature_mm: Annotated[Columns, Shown("R", CONTACT)]
    touching_deg: tuple[tuple[float, float], ...]
    tooth_height_mm: Annotated[Columns, Shown("height over the neutral curve", FLANK)]
    tooth_half_mm: Annotated[Columns, Shown("half thickness", FLANK)]
    space_across_mm: Annotated[Columns, Shown("across, from the middle of the space", SPACE)]
    space_out_mm: Annotated[Columns, Shown("out, from the axis", SPACE)]
    wave_angle_deg: Annotated[Columns, Shown("on the wave", CLEARANCE, form=".4f")]
    wave_clearance_mm: Annotated[Columns, Shown("clearance", CLEARANCE, "um")]
    load_angle_deg: Annotated[Columns, Shown("on the wave", LOAD, form=".4f")]
    load_N: Annotated[Columns, Shown("load", LOAD)]
    load_pressure_MPa: Annotated[Columns, Shown("contact pressure", LOAD)]
    teeth: tuple[ToothLoad, ...]
    shifts: tuple[ShiftRow, ...] = ()
    deflections: tuple[Deflected, ...]
    cutter: CutterDesign | None = None
    rounds: tuple[RoundRow, ...] = ()
    range_ends: tuple[RangeEnd, ...] = ()
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True)
class Extras:
    """Parts that a description may lack; left_out: names of those that time was short for."""

    clock: Clock
    left_out: list[str] = field(default_factory=list)

    def of(self, name: str, compute: Callable[[], T], without: T, lasts: float = 0.0) -> T:
        """A computed part, or `without` it where the time is over; lasts: s that it takes."""
        left = self.clock.left.seconds
        if not self.clock.over and (left is None or left >= lasts):
            return compute()
        self.left_out.append(name)
        return without


def loads_and_pressures(demand: Demand, flank: Flank) -> dict[str, Any]:
    """Fields of a `WaveDesign`: loads of its teeth, and pressures by each way of sharing them."""
    turned = _carried(demand.duty, flank)
    return {
        **load_columns(turned, LOADS_LISTED),
        **carrying_teeth(turned[0]),
        "equal_pressure_MPa": equal_pressure(demand.duty, flank),
        "whole_pairs_pressure_MPa": equal_pressure(demand.duty, flank, whole=True),
        "shared_pressure_MPa": shared_pressure(demand.duty, flank),
    }


def sizes_and_clearances(demand: Demand, flank: Flank, extras: Extras) -> dict[str, Any]:
    """Fields of a `WaveDesign`: sizes, contacts along the flank, clearances of its teeth."""
    least = interference(flank, STEP_DEG)
    name = "teeth within a clearance"
    none: Columns = ()
    gaps = 1e-3 * np.array(WITHIN)
    within = extras.of(name, lambda: floats(teeth_within(flank, gaps)), none, SOUGHT)
    return {
        **_sizes(demand, flank),
        **_columns(flank),
        "least_clearance_mm": gap_of(least.gap),
        "least_clearance_at_deg": math.degrees(least.angle),
        "within_um": WITHIN[: len(within)],
        "teeth_within": within,
    }


def deflections_and_ends(flank: Flank, extras: Extras) -> dict[str, Any]:
    """Fields of a `WaveDesign`: ends of deflection, shift and addendum, and other deflections."""
    gearing = flank.gearing
    deflections = other_deflections(extras, lambda by: _deflected(flank, by))
    name = "the largest addendum"
    addendum = extras.of(name, lambda: largest_addendum(gearing), None, SOUGHT)
    name = "the largest profile shift at which one pair always touches"
    shift = extras.of(name, lambda: last_shift_of_one_pair(gearing), None, SOUGHT)
    name = "the least deflection with contact"
    return {
        "deflections": deflections,
        "largest_addendum": addendum,
        "least_deflection": extras.of(name, lambda: least_deflection(gearing), None, SOUGHT),
        "shift_of_one_pair": shift,
    }


def profile_shifts(duty: Duty, flank: Flank, extras: Extras) -> dict[str, Any]:
    """Fields of a `WaveDesign`: the curve over profile shifts, if there is time."""
    none: tuple[ShiftRow, ...] = ()
    name = "the curve over profile shifts"
    return {"shifts": extras.of(name, lambda: _shifts(flank.gearing, duty), none, SOUGHT)}


def other_deflections(extras: Extras, at: Callable[[float], Deflected]) -> tuple[Deflected, ...]:
    """The gearing on wave generators of OTHER_DEFLECTIONS where teeth meet, while there is time."""
    none: tuple[Deflected, ...] = ()

    def meeting() -> tuple[Deflected, ...]:
        others = map(at, OTHER_DEFLECTIONS)
        return tuple(other for other in others if math.isfinite(other.least_clearance_mm))

    return extras.of("other deflections", meeting, none, SOUGHT)


def cutter_design(flank: Flank, asked: Cutter, extras: Extras) -> CutterDesign:
    """The cutter, while there is time with a line and an arc that replace its edge."""
    name = "straight and circular edges of the cutter"
    asked = extras.of(name, lambda: asked, replace(asked, replaced=False), REPLACED)
    return cutter_of(flank.gearing, blank_profile(flank), asked)


def sketched(demand: Demand, flank: Flank) -> dict[str, Any]:
    """Return sizes, pairs, pressures and the least clearance of a gearing, under the same keys."""
    return {
        **_sizes(demand, flank),
        "pairs_in_contact": float(flank.pairs_in_contact),
        "equal_pressure_MPa": equal_pressure(demand.duty, flank),
        "shared_pressure_MPa": shared_pressure(demand.duty, flank),
        "least_clearance_mm": gap_of(interference(flank, STEP_DEG).gap),
    }


def used(demand: Demand, flank: Flank) -> dict[str, float]:
    """Return the utilisation of every limit by a gearing: the largest of a limit on several points.

    interference: above 1, in modules, where teeth cut each other at some pose. Limits that only
    keep the flank regular are named where they are exceeded.
    """
    angle = np.linspace(flank.contacts.motion.angle[0], flank.contacts.motion.angle[-1], COUNT)
    at = [contact(flank.gearing, motion(flank.gearing, flank.curve, p)) for p in angle]
    rows = limits(demand, flank.gearing, flank.curve, at)
    least = interference(flank, STEP_DEG)
    flat = {k: float(max(v) if isinstance(v, tuple) else v) for k, v in rows.items()}
    if least.gap < CUTTING:
        flat["interference"] = 1.0 - least.gap / float(flank.gearing.module)
    return {k: v for k, v in flat.items() if k not in GUARDS or v > 1.0}


def _sizes(demand: Demand, flank: Flank) -> dict[str, Any]:
    gearing = flank.gearing
    tip = contact(gearing, motion(gearing, flank.curve, flank.contacts.motion.angle[-1]))
    return {
        **sizes_of(demand, gearing, flank.curve),
        "base_diameter_mm": 2.0 * float(gearing.base_radius),
        "pairs_in_contact": float(flank.pairs_in_contact),
        "ratcheting_torque_Nm": 1e-3 * float(flank_ratcheting_torque(demand, gearing, tip)),
    }


def sizes_of(demand: Demand, gearing: StrainWave, curve: NeutralCurve) -> dict[str, Any]:
    """Return the sizes of a gearing and the stresses of its rim, of teeth of any law."""
    duty = demand.duty
    major, minor = (float(radii(curve, angle)[0]) for angle in (0.0, 0.5 * math.pi))
    bending, shear = rim_of(demand, gearing, curve)
    return {
        "ratio": float(gearing.ratio),
        "flexspline_teeth": int(gearing.teeth),
        "circular_spline_teeth": int(gearing.circular_teeth),
        "module_mm": float(gearing.module),
        "pressure_angle_deg": math.degrees(gearing.pressure_angle),
        "profile_shift": round(float(gearing.profile_shift), DIGITS),
        "addendum": round(float(gearing.addendum), DIGITS),
        "clearance": float(gearing.clearance),
        "deflection": round(float(gearing.deflection), DIGITS),
        "rim_mm": float(gearing.rim),
        "elastic_rim": duty.elastic,
        "wave_generator": gearing.wave,
        "wrap_angle_deg": math.degrees(gearing.wrap) if gearing.wave == "discs" else 0.0,
        "face_width_mm": duty.face_width,
        "torque_Nm": 1e-3 * duty.torque,
        "outer_diameter_mm": 2.0 * float(demand.radius_needed(gearing)),
        "tip_diameter_mm": 2.0 * float(gearing.tip_radius),
        "active_diameter_mm": 2.0 * float(gearing.active_radius),
        "root_diameter_mm": 2.0 * float(gearing.root_radius),
        "neutral_diameter_mm": 2.0 * float(gearing.neutral_radius),
        "wave_major_mm": 2.0 * major - float(gearing.rim),
        "wave_minor_mm": 2.0 * minor - float(gearing.rim),
        "rim_bending_MPa": float(bending),
        "rim_shear_MPa": float(shear),
    }


def _columns(flank: Flank) -> dict[str, Any]:
    at = flank.contacts
    k = np.rint(np.linspace(0, len(at.tangent) - 1, ROWS)).astype(int)
    middle = float(tooth_arcs(flank, 0))
    arcs = middle + np.linspace(-REACH, REACH, 2 * CLEARANCES_LISTED + 1)
    involute = flank.gearing.half_angle - (at.tangent - np.arctan(at.tangent))
    return {
        "arc_deg": floats(np.degrees(at.motion.arc[k])),
        "radius_mm": floats(at.radius[k]),
        "height_mm": floats(at.point.x[k]),
        "half_thickness_mm": floats(at.point.y[k]),
        "flexspline_curvature_mm": floats(1.0 / np.abs(at.curvatures[1][k])),
        "circular_curvature_mm": floats(1.0 / np.abs(at.curvatures[0][k])),
        "relative_curvature_mm": floats(1.0 / at.gap_curvature[k]),
        "touching_deg": (floats(np.degrees(at.motion.arc[[0, -1]])),),
        "tooth_height_mm": floats(at.point.x[k]),
        "tooth_half_mm": floats(at.point.y[k]),
        "space_across_mm": floats((at.radius * np.sin(involute))[k]),
        "space_out_mm": floats((at.radius * np.cos(involute))[k]),
        **clearance_columns(arcs, clearances_of(flank, arcs)),
    }


def clearance_columns(arcs: Any, gaps: Any) -> dict[str, Any]:
    """Return clearances [mm] by the angle phi [rad] where they are finite."""
    near = np.isfinite(gaps)
    return {
        "wave_angle_deg": floats(np.degrees(arcs[near])),
        "wave_clearance_mm": tuple(map(gap_of, gaps[near])),
    }


@dataclass(frozen=True)
class Carried:
    """Load of the teeth of a lobe: number, angle phi [rad], gap [mm], load, pressure [MPa]."""

    numbers: Any
    arcs: Any
    gaps: Any
    loads: Loads
    stresses: Any


def _carried(duty: Duty, flank: Flank) -> list[Carried]:
    """Loads of the teeth at TURNS positions of the wave generator over a pitch."""
    return [
        Carried(t.numbers, t.arcs, t.gaps, loads, pressures(duty, flank, t, loads))
        for t, loads in loads_turned(duty, flank, [k / TURNS for k in range(TURNS)])
    ]


def load_columns(turned: Sequence[Carried], share: float = 1.0) -> dict[str, Any]:
    """Return the load of a tooth by its angle, from turns of the wave generator over a pitch.

    share: part of the teeth that is told, those nearest to the middle.
    """
    rows: list[tuple[float, float, float]] = []
    for at in turned:
        near = np.abs(at.numbers) <= share * at.numbers.max()
        rows += zip(at.arcs[near], at.loads.forces[near], at.stresses[near], strict=True)
    arcs, forces, stresses = np.array(sorted(rows)).T
    return {
        "load_angle_deg": floats(np.degrees(arcs)),
        "load_N": floats(forces),
        "load_pressure_MPa": floats(stresses),
    }


def carrying_teeth(at: Carried) -> dict[str, Any]:
    """Return fields of a design: `teeth`, from three before the first that carries to three behind.

    And how many carry, how many would carry the largest load if all carried the same, and the
    windup [mrad].
    """
    carries = np.flatnonzero(at.loads.forces > 0.0)
    shown = range(max(0, carries[0] - 3), min(len(at.stresses), carries[-1] + 4))
    rows = tuple(
        ToothLoad(
            tooth=int(at.numbers[k]),
            wave_angle_deg=math.degrees(at.arcs[k]),
            clearance_mm=gap_of(at.gaps[k]),
            force_N=float(at.loads.forces[k]),
            contact_pressure_MPa=float(at.stresses[k]),
        )
        for k in shown
    )
    return {
        "teeth": rows,
        "carrying_teeth": len(carries),
        "effective_teeth": at.loads.effective,
        "windup_mrad": 1e3 * at.loads.windup,
    }


def _shifts(gearing: StrainWave, duty: Duty) -> tuple[ShiftRow, ...]:
    return tuple(
        ShiftRow(
            profile_shift=point.shift,
            pairs=point.pairs,
            radius_mm=point.radius,
            equal_MPa=point.equal,
            whole_MPa=point.whole,
            shared_MPa=point.shared,
            least_clearance_mm=gap_of(point.least_gap),
        )
        for point in shift_curve(gearing, duty, SHIFTS)
    )


def _deflected(flank: Flank, by: float) -> Deflected:
    deflection = float(flank.gearing.deflection) + by
    least = interference(stretched(flank, deflection), STEP_DEG)
    return Deflected(deflection=deflection, least_clearance_mm=gap_of(least.gap))


def gap_of(value: float) -> float:
    """Clearance [mm], the rounding of a contact taken off."""
    return round(float(value), 9) + 0.0


def floats(values: Any) -> Columns:
    """Numbers of an array as a column of a result."""
    return tuple(map(float, values))
