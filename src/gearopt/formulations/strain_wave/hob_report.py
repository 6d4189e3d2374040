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
from gearopt.formulations.strain_wave.demand import SHIFTS, Duty, loads_turned, shared_pressure
from gearopt.formulations.strain_wave.sharing import teeth_turned
from gearopt.physics.strain_wave import clearance, straight_hob
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc, radii
from gearopt.physics.strain_wave.tooth_motion import pose_of
from gearopt.physics.strain_wave.vectors import Vector

TOUCHING = 1e-9  # mm of clearance that infeed leaves
INFEEDS = 20  # at most; each leaves a thousandth of the clearance
POSITIONS = np.linspace(-0.5, 0.5, 32, endpoint=False)  # of the wave generator, in pitches: play
TOLD = np.radians(np.linspace(-60.0, 60.0, 241))  # of the wave, where clearances are listed


def cut_flank(conjugate: Flank, asked: Cutter) -> tuple[Flank, straight_hob.Cut, float] | None:
    """Return the flank that a hob cuts in place of a conjugate one, and the offset of the hob [mm].

    Fed in until teeth touch at one pose of the wave and interfere at none. Contacts are those of
    the conjugate flank with points and 1/R as cut. None where no flank is cut from root to tip.
    """
    gearing, at = conjugate.gearing, conjugate.contacts
    curve = conjugate.curve if asked.generation == DEFORMED else straight_hob.round_blank(gearing)
    middle = at.point[len(at.point.x) // 2]
    place = Vector(float(radii(curve, 0.0)[0]) + middle.x, middle.y)
    offset = float(Vector(math.sin(asked.angle), math.cos(asked.angle)).dot(place))
    for _ in range(INFEEDS):
        cut = straight_hob.hobbed(gearing, curve, asked.angle, offset, at.point.x)
        tooth = straight_hob.relieved(cut.tooth, asked.relief) if asked.relief else cut.tooth
        if not cut.regular or tooth.points.y[-1] <= 0.0:
            return None
        relative = at.curvatures[0] - tooth.curvatures
        flank = replace(conjugate, contacts=replace(at, point=tooth.points, gap_curvature=relative))
        gap = clearance.interference(flank).gap
        if abs(gap) < TOUCHING:
            break
        offset += gap
    return flank, cut, offset


def hob_design(duty: Duty, conjugate: Flank, asked: Cutter) -> CutterDesign:
    """Return a straight-sided hob with the teeth that it cuts, beside the conjugate ones."""
    gearing, at = conjugate.gearing, conjugate.contacts
    asked = replace(asked, angle=asked.angle or float(gearing.pressure_angle))
    result = cut_flank(conjugate, asked)
    design = CutterDesign(
        generation=asked.generation,
        pitch_radius_mm=float(gearing.blank_radius),
        regular=result is not None,
        least_speed=0.0,
        given_deg=math.degrees(asked.angle),
        tip_relief_mm=asked.relief,
    )
    if result is None:
        return design
    flank, cut, offset = result
    within = (at.point.y - flank.contacts.point.y) * at.direction.left.y
    line = straight_hob.reference_radius(gearing, asked.angle, offset)
    pick = np.rint(np.linspace(0, len(within) - 1, POINTS)).astype(int)
    gaps = clearance.tooth_clearances(flank, TOLD)
    columns = {
        "x_mm": (cut.edge.x - line)[pick],
        "y_mm": cut.edge.y[pick],
        "cut_height_mm": flank.contacts.point.x[pick],
        "cut_half_mm": flank.contacts.point.y[pick],
        "cut_within_mm": within[pick],
        "cut_wave_deg": np.degrees(TOLD[np.isfinite(gaps)]),
        "cut_clearance_mm": gaps[np.isfinite(gaps)],
    }
    forms = _form(duty, conjugate, 0.0), _form(duty, flank, float(within.max()))
    lists: dict[str, Any] = {name: tuple(map(float, v)) for name, v in columns.items()}
    return replace(design, **lists, reference_radius_mm=line, forms=forms)


def _form(duty: Duty, flank: Flank, deviation: float) -> ToothForm:
    """Judge a flank by its clearances and loads.

    Play is the least clearance of all teeth of a lobe, at the position of the wave generator where
    it is largest: the circular spline turns by it over r_b until teeth touch.
    """
    within = clearance.teeth_within(flank, np.array([1e-3, 5e-3]))
    idle = teeth_turned(flank, duty.pair_stiffness, None, POSITIONS.tolist())
    turned = loads_turned(duty, flank, SHIFTS)
    ends = [touch_at_ends(flank, teeth.arcs) for teeth, _ in turned]
    forces = [loads.forces for _, loads in turned]
    share = [f[end].sum() / f.sum() for f, end in zip(forces, ends, strict=True)]
    most = [end[f.argmax()] for f, end in zip(forces, ends, strict=True)]
    middle = turned[SHIFTS.index(0.0)][1]
    line = np.mean(most) <= 0.5 and bool((flank.contacts.gap_curvature > 0.0).all())
    return ToothForm(
        deviation_mm=deviation,
        least_clearance_mm=round(clearance.interference(flank).gap, 8) + 0.0,
        play_mm=round(max(float(teeth.gaps.min()) for teeth in idle), 6),
        near=float(within[0]),
        nearby=float(within[1]),
        carrying_teeth=middle.carrying,
        effective_teeth=middle.effective,
        windup_mrad=1e3 * middle.windup,
        at_ends=100.0 * float(np.mean(share)),
        shared_pressure_MPa=shared_pressure(duty, flank) if line else None,
    )


def touch_at_ends(flank: Flank, arcs: Any) -> Any:
    """Return whether teeth at angles phi [rad] come nearest at an end of a flank.

    By points of the flank; ends are those of the tooth and the tip of the circular spline.
    """
    gearing, points = flank.gearing, flank.contacts.point
    at = pose_of(gearing, flank.curve, angle_of_arc(flank.curve, np.asarray(arcs, float)))
    place = at.placed(Vector(points.x[:, None], points.y[:, None]))
    gap, radius = clearance.involute_gap(gearing, place)
    reached = radius >= gearing.tip_radius
    nearest = np.where(reached, gap, math.inf).argmin(axis=0)
    return (nearest == reached.argmax(axis=0)) | (nearest == len(points.x) - 1)
