"""A strain wave gearing whose flexspline's teeth are given by a law of later practice."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import Cutter, CutterDesign, cutter_of
from gearopt.formulations.strain_wave.demand import SHIFTS, Demand, Duty, common_limits
from gearopt.formulations.strain_wave.design import (
    ROWS,
    TURNS,
    WITHIN,
    Carried,
    Deflected,
    Extras,
    carrying_teeth,
    clearance_columns,
    floats,
    gap_of,
    load_columns,
    other_deflections,
    sizes_of,
)
from gearopt.formulations.strain_wave.exchange import STEP_DEG
from gearopt.formulations.strain_wave.sharing import compliance_of, shared
from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.circular_arc import DoubleArc, half_locus_tooth, tooth_heights
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.lands import flexspline_widths
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
from gearopt.physics.strain_wave.strength import ratcheting_torque
from gearopt.physics.strain_wave.swept_mesh import (
    SweptMesh,
    Touching,
    gaps,
    intervals,
    mean_pairs,
    swept_mesh,
    tooth_gaps,
    touching,
)
from gearopt.physics.strain_wave.vectors import Vector

DOUBLE_ARC, HALF_LOCUS = "double arc", "half locus"
ARCS = 2001  # places of a tooth over the wave, by which teeth within a clearance are counted
SHOWN = 4  # one of these is listed
TOUCH = 1e-6  # mm: within 1 nm, which a sweep does not tell apart, flanks touch
FLATTEST = 1e-6  # 1/mm: of a tangent, whose radius is told as 1 km


@dataclass(frozen=True)
class Law:
    """How the flexspline's teeth are made: DOUBLE_ARC or HALF_LOCUS.

    thickness [mm] at half the height; of double arcs also the radii of the convex and the concave
    arc and the length of the tangent between them [mm]. The pressure angle is the tangent's.
    """

    name: str
    thickness: float
    radii: tuple[float, float] = (0.0, 0.0)
    tangent: float = 0.0


def double_arc(gearing: StrainWave, law: Law) -> DoubleArc:
    """Return the flank of two arcs and their tangent."""
    middle = Vector(tooth_heights(gearing)[1], 0.5 * law.thickness)
    return DoubleArc(law.radii, float(gearing.pressure_angle), middle, 0.5 * law.tangent)


@dataclass(frozen=True)
class SweptGearing:
    """A gearing with its teeth in mesh; where it is conjugate, stretches of the angle phi [rad]."""

    mesh: SweptMesh
    touching: Touching
    stretches: tuple[tuple[float, float], ...]

    @property
    def pairs(self) -> float:
        """Mean conjugate pairs per lobe and flank."""
        return mean_pairs(self.mesh, list(self.stretches))


def swept_tooth(gearing: StrainWave, law: Law) -> Profile:
    """Return the flexspline's flank by a law; ValueError where half a locus is not high enough."""
    if law.name == HALF_LOCUS:
        return half_locus_tooth(gearing, neutral_curve(gearing), law.thickness)
    low, _, high = tooth_heights(gearing)
    return double_arc(gearing, law).profile(low, high)


@lru_cache(maxsize=2)
def swept_gearing(gearing: StrainWave, law: Law) -> SweptGearing:
    """Return a gearing by its law; the pressure angle of half a locus is that of its middle.

    ValueError as of `swept_tooth`, and where no flanks are conjugate. Kept: a file is looked at as
    it is read, and again as it is solved.
    """
    tooth = swept_tooth(gearing, law)
    if law.name == HALF_LOCUS:
        gearing = replace(gearing, pressure_angle=_slope(gearing, tooth, 0.5))
    mesh = swept_mesh(gearing, neutral_curve(gearing), tooth)
    contacts = touching(mesh)
    if not len(contacts.arcs):
        raise ValueError("tooth and space are conjugate at no pose of the wave")
    return SweptGearing(mesh, contacts, tuple(intervals(contacts)))


def _slope(gearing: StrainWave, tooth: Profile, share: float) -> float:
    """Return the angle [rad] of a flank to the tooth's axis, by its share of the addendum."""
    _, middle, high = tooth_heights(gearing)
    k = int(np.searchsorted(tooth.points.x, middle + share * (high - middle)))
    return math.atan(-float(tooth.directions.y[k] / tooth.directions.x[k]))


def carried(duty: Duty, swept: SweptGearing, shift: float = 0.0) -> Carried:
    """Loads of the teeth of one lobe, numbered from the major axis.

    shift: turn of the wave generator in pitches. Arms and curvatures are those of the nearest pose
    of conjugate contact; of two contacts of a tooth the one that presses harder.
    """
    mesh, teeth = swept.mesh, int(swept.mesh.gearing.teeth)
    number = np.arange(-(teeth // 4), teeth // 4 + 1)
    arcs = (number + shift) * 2.0 * math.pi / teeth
    inside = np.abs(arcs) < 0.499 * math.pi
    number, arcs = number[inside], arcs[inside]
    gap = tooth_gaps(mesh, arcs)
    near = np.isfinite(gap)
    number, arcs = number[near], arcs[near]
    gap = np.where(gap[near] < TOUCH, 0.0, gap[near])
    rim = (duty.cup, duty.face_width) if duty.elastic else None
    compliance = compliance_of(mesh.gearing, number, duty.pair_stiffness, rim)
    arms, bends = _nearest(swept.touching, arcs)
    loads = shared(compliance, gap, arms, duty.moment)
    return Carried(number, arcs, gap, loads, duty.pressure(loads.forces, bends))


def _nearest(found: Touching, arcs: Any) -> tuple[Any, Any]:
    """Return arm [mm] and 1/R [1/mm] of the contact at the pose nearest to angles phi [rad]."""
    apart = np.abs(arcs[:, None] - found.arcs)
    close = apart <= apart.min(axis=1, keepdims=True) + math.radians(STEP_DEG)
    hardest = np.where(close, found.gap_curvature, -1.0).argmax(axis=1)
    return found.arms[hardest], found.gap_curvature[hardest]


def loads_by_law(demand: Demand, swept: SweptGearing) -> dict[str, Any]:
    """Fields of a `WaveDesign`: loads of its teeth, and pressures by each way of sharing them."""
    duty = demand.duty
    turned = [carried(duty, swept, k / TURNS) for k in range(TURNS)]
    shared_by_shift = (float(carried(duty, swept, shift).stresses.max()) for shift in SHIFTS)
    return {
        **load_columns(turned),
        **carrying_teeth(turned[0]),
        "pairs_in_contact": swept.pairs,
        "equal_pressure_MPa": _equal(duty, swept, swept.pairs),
        "whole_pairs_pressure_MPa": _equal(duty, swept, max(1.0, math.floor(swept.pairs))),
        "shared_pressure_MPa": max(shared_by_shift),
    }


def sizes_by_law(demand: Demand, swept: SweptGearing, law: Law) -> dict[str, Any]:
    """Fields of a `WaveDesign`: law, sizes, contacts along the flank, clearances of its teeth."""
    mesh = swept.mesh
    gearing = mesh.gearing
    least, at = _least(mesh)
    arcs = np.linspace(-0.499 * math.pi, 0.499 * math.pi, ARCS)
    clear = tooth_gaps(mesh, arcs)
    each = (arcs[1] - arcs[0]) * float(gearing.teeth) / (2.0 * math.pi)
    within = [float((clear <= 1e-3 * v).sum() * each) for v in WITHIN]
    return {
        "law": law.name,
        "thickness_mm": law.thickness,
        "arc_radii_mm": law.radii if law.name == DOUBLE_ARC else (),
        "tangent_mm": law.tangent if law.name == DOUBLE_ARC else None,
        **sizes_of(demand, gearing, mesh.curve),
        **_columns(swept),
        **clearance_columns(arcs[::SHOWN], clear[::SHOWN]),
        "ratcheting_torque_Nm": 1e-3 * float(_ratcheting_torque(demand, gearing)),
        "least_clearance_mm": 0.0 if abs(least) < TOUCH else gap_of(least),
        "least_clearance_at_deg": at,
        "within_um": WITHIN,
        "teeth_within": tuple(within),
    }


def deflections_by_law(swept: SweptGearing, extras: Extras) -> dict[str, Any]:
    """Fields of a `WaveDesign`: other deflections of a gearing, while there is time."""
    return {"deflections": other_deflections(extras, lambda by: _deflected(swept.mesh, by))}


def cutter_by_law(swept: SweptGearing, asked: Cutter) -> CutterDesign:
    """The cutter of a gearing's flexspline."""
    return cutter_of(swept.mesh.gearing, _blank(swept.mesh), asked)


def used_by_law(demand: Demand, swept: SweptGearing) -> dict[str, float]:
    """Return the utilisation of every limit by a gearing of a law, as `wave_report.used`."""
    mesh = swept.mesh
    gearing, tooth = mesh.gearing, mesh.tooth.points
    widths = *flexspline_widths(gearing, tooth[0], tooth[-1]), mesh.spline_land
    ratchets_at = _ratcheting_torque(demand, gearing)
    utilisations = common_limits(demand, gearing, mesh.curve, swept.pairs, ratchets_at, widths)
    least, _ = _least(mesh)
    if least < -TOUCH:
        utilisations["interference"] = 1.0 - least / float(gearing.module)
    return {name: float(value) for name, value in utilisations.items()}


def _ratcheting_torque(demand: Demand, gearing: StrainWave) -> Any:
    """Return the torque [N mm] at which teeth ratchet, by their pressure angle."""
    slope = math.tan(float(gearing.pressure_angle))
    return ratcheting_torque(gearing, demand.radial_stiffness, slope)


def _equal(duty: Duty, swept: SweptGearing, pairs: float) -> float:
    """Return the largest pressure [MPa] if conjugate pairs shared the load equally."""
    contacts = swept.touching
    load = duty.moment / (float(contacts.arms.mean()) * pairs)
    return float(duty.pressure(load, contacts.gap_curvature.max()))


@lru_cache(maxsize=4)  # the parts of a description ask for the same
def _least(mesh: SweptMesh) -> tuple[float, float]:
    """Return the least clearance [mm] over poses that were not swept, and its pose [degrees]."""
    angles = np.arange(-90.0 + 0.5 * STEP_DEG, 90.0, STEP_DEG)
    clearances = gaps(mesh, np.radians(angles))
    k = int(np.argmin(clearances))
    return float(clearances[k]), float(angles[k])


def _deflected(mesh: SweptMesh, by: float) -> Deflected:
    """Return the least clearance of the same teeth on a wave generator of another deflection."""
    deflection = float(mesh.gearing.deflection) + by
    gearing = replace(mesh.gearing, deflection=deflection, neutral=mesh.gearing.neutral_radius)
    least, _ = _least(replace(mesh, gearing=gearing, curve=neutral_curve(gearing)))
    return Deflected(deflection=deflection, least_clearance_mm=gap_of(least))


def _blank(mesh: SweptMesh) -> Profile:
    """Return the flank on the undeformed flexspline, seen from its centre."""
    tooth, out = mesh.tooth, float(mesh.gearing.neutral_radius)
    points = Vector(out + tooth.points.x, tooth.points.y)
    return Profile(points, tooth.directions, tooth.curvatures)


def _columns(swept: SweptGearing) -> dict[str, Any]:
    mesh, at = swept.mesh, swept.touching
    k = np.rint(np.linspace(0, len(at.arcs) - 1, ROWS)).astype(int)
    k = k[np.argsort(at.arcs[k], kind="stable")]
    tooth = mesh.tooth.points
    n = np.rint(np.linspace(0, len(tooth.x) - 1, 2 * ROWS - 1)).astype(int)
    j = np.rint(np.linspace(0, len(mesh.radii) - 1, 2 * ROWS - 1)).astype(int)
    signed = [-1.0 / np.where(np.abs(v) < FLATTEST, -FLATTEST, v) for v in at.curvatures]
    return {
        "arc_deg": floats(np.degrees(at.arcs[k])),
        "radius_mm": floats(at.radii[k]),
        "height_mm": floats(at.heights[k]),
        "half_thickness_mm": floats(np.interp(at.heights[k], tooth.x, tooth.y)),
        "flexspline_curvature_mm": floats(signed[0][k]),
        "circular_curvature_mm": floats(signed[1][k]),
        "relative_curvature_mm": floats(1.0 / at.gap_curvature[k]),
        "touching_deg": tuple(floats(np.degrees(ends)) for ends in swept.stretches),
        "tooth_height_mm": floats(tooth.x[n]),
        "tooth_half_mm": floats(tooth.y[n]),
        "space_across_mm": floats((mesh.radii * np.sin(mesh.halves))[j]),
        "space_out_mm": floats((mesh.radii * np.cos(mesh.halves))[j]),
    }
