"""Teeth as a straight-sided hob cuts them, judged beside conjugate ones by the same functions."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import (
    DEFORMED,
    POINTS,
    Cutter,
    CutterDesign,
    ToothForm,
)
from gearopt.formulations.strain_wave.demand import (
    SHIFTS,
    Duty,
    loads_at,
    loads_turned,
    shared_pressure,
)
from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.clearance import (
    interference,
    involute_gap,
    teeth_within,
    tooth_arcs,
    tooth_clearances,
)
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc, radii
from gearopt.physics.strain_wave.straight_hob import (
    Cut,
    hobbed,
    reference_radius,
    relieved,
    round_blank,
)
from gearopt.physics.strain_wave.tooth_motion import pose_of
from gearopt.physics.strain_wave.vectors import Vector

SAME_RADIUS = 1e-6  # mm: a contact that far inside the tip circle is still on it
STEP_DEG = 0.05  # of the wave, at which clearances are looked at, and between
TOUCHING = 1e-9  # mm of clearance that infeed leaves
INFEEDS = 20  # at most; each leaves a thousandth of the clearance
NM = 6  # digits of a play in mm: points of the flank are that near
POSITIONS = 32  # of the wave generator over a pitch, at which the play is looked for
NEAR, STEPS = math.radians(15.0), 128  # of the wave, and poses a pitch, of contacts within flanks
SHOWN = 241  # clearances over the wave that are listed
TOLD_DEG = 60.0  # of the wave on either side


@dataclass(frozen=True)
class CutFlank:
    """A conjugate flank, and the one that is cut in its place; offset [mm] of the hob's edge."""

    conjugate: Flank
    flank: Flank
    cut: Cut
    tooth: Profile
    offset: float

    @property
    def deviation(self) -> Any:
        """How far points lie within the conjugate flank, normal to it [mm]."""
        inside = self.conjugate.contacts.point.y - self.tooth.points.y
        return inside * self.conjugate.contacts.direction.left.y


def cut_flank(conjugate: Flank, asked: Cutter) -> CutFlank | None:
    """Return the flank that a hob cuts, fed in until teeth touch at the first pose of the wave.

    Without clearance and without interference; None where the hob cuts no flank from root to tip.
    """
    gearing, points = conjugate.gearing, conjugate.contacts.point
    curve = conjugate.curve if asked.generation == DEFORMED else round_blank(gearing)
    middle = len(points.x) // 2
    place = Vector(float(radii(curve, 0.0)[0]) + points.x[middle], points.y[middle])
    offset = float(Vector(math.sin(asked.angle), math.cos(asked.angle)).dot(place))
    for _ in range(INFEEDS):
        cut = hobbed(gearing, curve, asked.angle, offset, points.x)
        if not cut.regular:
            return None
        tooth = relieved(cut.tooth, asked.relief) if asked.relief else cut.tooth
        there = replace(conjugate.contacts, point=tooth.points)
        flank = replace(conjugate, contacts=there)
        gap = interference(flank, STEP_DEG).gap
        if abs(gap) < TOUCHING:
            break
        offset += gap
    return CutFlank(conjugate, flank, cut, tooth, offset)


def hob_design(duty: Duty, conjugate: Flank, asked: Cutter) -> CutterDesign:
    """Return a straight-sided hob with the teeth that it cuts, beside the conjugate ones."""
    gearing = conjugate.gearing
    head: dict[str, Any] = {
        "generation": asked.generation,
        "teeth": 0,
        "pitch_radius_mm": float(gearing.blank_radius),
        "cutter_radius_mm": 0.0,
        "least_teeth": None,
        "given_deg": math.degrees(asked.angle),
        "tip_relief_mm": asked.relief,
    }
    if (result := cut_flank(conjugate, asked)) is None:
        return CutterDesign(**head, regular=False, least_speed=0.0)
    at = conjugate.contacts
    exact = Profile(at.point, at.direction, at.curvatures[1])
    pick = np.rint(np.linspace(0, len(at.point.x) - 1, POINTS)).astype(int)
    line = reference_radius(gearing, asked.angle, result.offset)
    arcs = np.radians(np.linspace(-TOLD_DEG, TOLD_DEG, SHOWN)) + float(tooth_arcs(conjugate, 0))
    gaps = tooth_clearances(result.flank, arcs)
    near = np.isfinite(gaps)
    exactly = _form("conjugate", duty, conjugate, exact, 0.0)
    exactly = replace(exactly, shared_pressure_MPa=shared_pressure(duty, conjugate))
    return CutterDesign(
        **head,
        regular=True,
        least_speed=1.0,
        x_mm=_floats((result.cut.edge.x - line)[pick]),
        y_mm=_floats(result.cut.edge.y[pick]),
        reference_radius_mm=line,
        cut_height_mm=_floats(result.tooth.points.x[pick]),
        cut_half_mm=_floats(result.tooth.points.y[pick]),
        cut_within_mm=_floats(result.deviation[pick]),
        cut_wave_deg=_floats(np.degrees(arcs[near])),
        cut_clearance_mm=_floats(gaps[near]),
        forms=(
            exactly,
            _form("as cut", duty, result.flank, result.tooth, float(result.deviation.max())),
        ),
    )


def _form(name: str, duty: Duty, flank: Flank, tooth: Profile, deviation: float) -> ToothForm:
    """Judge a flank by its clearances and loads, all of the same functions."""
    _, middle = loads_at(duty, flank)
    within = teeth_within(flank, np.array([1e-3, 5e-3]))
    return ToothForm(
        teeth=name,
        deviation_mm=deviation,
        least_clearance_mm=round(interference(flank, STEP_DEG).gap, 8) + 0.0,
        play_mm=play(flank),
        near=float(within[0]),
        nearby=float(within[1]),
        carrying_teeth=middle.carrying,
        effective_teeth=middle.effective,
        windup_mrad=1e3 * middle.windup,
        **_contacts(duty, flank, tooth),
    )


def _contacts(duty: Duty, flank: Flank, tooth: Profile) -> dict[str, Any]:
    """The part of the load that ends of flanks carry, and the pressure.

    Pressures as `demand.pressures`, with 1/R of the nearest pose of contact within the flanks; None
    where at most positions the tooth of the largest load touches at an end: no line contact.
    """
    pitch = 2.0 * math.pi / float(flank.gearing.teeth)
    arcs = tooth_arcs(flank, np.arange(-NEAR / pitch, NEAR / pitch, 1.0 / STEPS))
    curvature, at_end = nearest_contacts(flank, tooth, arcs)
    inside = ~at_end & (curvature > 0.0)
    largest, ends, deep = [], [], 0
    for teeth, loads in loads_turned(duty, flank, SHIFTS):
        beside = nearest_contacts(flank, tooth, teeth.arcs)[1]
        deep += not beside[loads.forces.argmax()]
        ends.append(float(loads.forces[beside].sum() / loads.forces.sum()))
        if inside.any():
            nearby = np.interp(teeth.arcs, arcs[inside], curvature[inside])
            largest.append(float(duty.pressure(loads.forces, nearby).max()))
    return {
        "at_ends": 100.0 * sum(ends) / len(ends),
        "shared_pressure_MPa": max(largest) if largest and 2 * deep >= len(ends) else None,
    }


def nearest_contacts(flank: Flank, tooth: Profile, arcs: Any) -> tuple[Any, Any]:
    """Return 1/R [1/mm] where teeth at angles phi [rad] come nearest, and whether at an end.

    The point of the flank that has the least distance to the involute at that pose, by a parabola
    through three points; 1/R is the
    difference of its curvature and that of the parallel involute through it. At an end: that of the
    tooth, or the tip of the circular spline.
    """
    gearing, points = flank.gearing, tooth.points
    at = pose_of(gearing, flank.curve, angle_of_arc(flank.curve, np.asarray(arcs, float)))
    place = at.placed(Vector(points.x[:, None], points.y[:, None]))
    gap, radius = involute_gap(gearing, place)
    reached = np.where(radius >= gearing.tip_radius, gap, math.inf)
    last, column = len(points.x) - 1, np.arange(np.size(arcs))
    k = np.clip(reached.argmin(axis=0), 1, last - 1)
    low, least, high = (gap[k + step, column] for step in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        share = 0.5 * (low - high) / (low - 2.0 * least + high)
    within = (np.abs(share) <= 1.0) & (low + high > 2.0 * least)
    share = np.where(within, share, 0.0)
    base = gearing.base_radius
    tangent = np.sqrt(np.maximum((radius / base) ** 2 - 1.0, 1e-12))
    relative = -1.0 / (base * tangent) - tooth.curvatures[:, None]
    curvature, depth = (_between(v, k, column, share) for v in (relative, radius))
    return curvature, ~within | (depth < gearing.tip_radius - SAME_RADIUS)


def _between(values: Any, k: Any, column: Any, share: Any) -> Any:
    """Return values (n, m) at rows k + share, -1 <= share <= 1, one of each column."""
    slope = 0.5 * (values[k + 1, column] - values[k - 1, column])
    return values[k, column] + share * slope


def play(flank: Flank) -> float:
    """Return the play [mm] of one side of the teeth without load, normal to the flanks.

    The least clearance of all teeth of a lobe, at the position of the wave generator where it is
    largest; the circular spline turns by the play over r_b until teeth touch.
    """
    most = int(flank.gearing.teeth) // 4
    shifts = np.linspace(-0.5, 0.5, POSITIONS, endpoint=False)
    arcs = tooth_arcs(flank, np.arange(-most, most + 1) + shifts[:, None])
    inside = np.abs(arcs) < 0.5 * math.pi
    gaps = np.full(arcs.shape, math.inf)
    gaps[inside] = tooth_clearances(flank, arcs[inside])
    return max(0.0, round(float(gaps.min(axis=1).max()), NM))


def _floats(values: Any) -> tuple[float, ...]:
    return tuple(map(float, values))
