"""The geometry of the teeth of one gear of a pair, for the table of a rating (ISO 21771)."""

import math
from typing import Any

from gearopt.formulations.drive.rating import ToothGeometry
from gearopt.physics.gears import MEMBERS, Gear, GearPair
from gearopt.physics.geometry.contact import active_root_diameters, contact_path, specific_sliding
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import (
    ball_contact_diameter,
    base_helix_angle,
    over_balls,
    span,
    span_diameter,
    span_teeth,
    tip_clearances,
    tip_thickness,
)
from gearopt.physics.shaft_forces import OTHER

BALL = 1.728  # diameter over normal module; usual for measurement over balls of 20 degrees


def tooth_geometry(stage: int, pair: GearPair, member: int, pinion_hand: str) -> ToothGeometry:
    """Return the geometry of the pinion (0) or the wheel (1) of a stage."""
    gear, path = pair.gears[member], contact_path(pair)
    ends = [specific_sliding(path, pair.ratio, at)[member] for at in (path.start, path.end)]
    hand = pinion_hand if member == 0 else OTHER[pinion_hand]
    whole = abs(gear.teeth - round(gear.teeth)) < 1e-9
    return ToothGeometry(
        stage=stage,
        member=MEMBERS[member],
        hand=hand if gear.helix_angle else "spur",
        teeth=round(gear.teeth) if whole else gear.teeth,
        profile_shift=float(gear.profile_shift),
        generating_shift=float(gear.generating_shift),
        reference_diameter_mm=float(gear.reference_diameter),
        working_pitch_diameter_mm=float(pair.working_diameters[member]),
        base_diameter_mm=float(gear.base_diameter),
        tip_diameter_mm=float(gear.tip_diameter),
        tip_form_diameter_mm=float(gear.active_tip_diameter) if gear.rack.tip_chamfer else None,
        root_diameter_mm=float(gear.root_diameter),
        form_diameter_mm=float(form_diameter(gear)),
        active_root_diameter_mm=_finite(active_root_diameters(pair)[member]),
        tip_thickness_mm=float(tip_thickness(gear)),
        tip_clearance_mm=float(tip_clearances(pair)[member]),
        largest_specific_sliding=_finite(min(map(float, ends))),
        **(_measured(gear) if whole else {}),
    )


def _finite(value: float) -> float | None:
    """Return a number; None where the mate's tip passes the end of the involute."""
    return float(value) if math.isfinite(value) else None


def _measured(gear: Gear) -> dict[str, Any]:
    """Return span and dimension over balls, where they touch the flanks.

    Both ends of the span of helical teeth lie within the face width; balls stand out of the tips.
    """
    teeth = span_teeth(gear)
    low, high = float(form_diameter(gear)), float(gear.active_tip_diameter)
    dimensions: dict[str, Any] = {}
    width = float(span(gear, teeth))
    helical = width * abs(math.sin(base_helix_angle(gear)))  # along the axis
    if low <= float(span_diameter(gear, teeth)) <= high and helical < gear.width:
        dimensions |= {"span_teeth": teeth, "span_mm": width}
    ball = BALL * gear.normal_module
    over = float(over_balls(gear, ball))
    if low <= float(ball_contact_diameter(gear, ball)) <= high < over:
        dimensions |= {"ball_diameter_mm": ball, "over_balls_mm": over}
    return dimensions
