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
    whole = abs(gear.teeth - round(gear.teeth)) < 1e-9
    return ToothGeometry(
        stage=stage,
        member=MEMBERS[member],
        hand=hand_of(gear, member, pinion_hand),
        teeth=round(gear.teeth) if whole else gear.teeth,
        profile_shift=float(gear.profile_shift),
        generating_shift=float(gear.generating_shift),
        face_width_mm=float(gear.width),
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


def hand_of(gear: Gear, member: int, pinion_hand: str) -> str:
    """Hand of the helix of the pinion (0) or the wheel (1); a ring has that of its pinion."""
    if not gear.helix_angle:
        return "spur"
    return pinion_hand if member == 0 or gear.teeth < 0 else OTHER[pinion_hand]


def _finite(value: float) -> float | None:
    """Return a number; None where the mate's tip passes the end of the involute."""
    return float(value) if math.isfinite(value) else None


def _measured(gear: Gear) -> dict[str, Any]:
    """Return span and dimension over balls, where they touch the flanks."""
    dimensions: dict[str, Any] = {}
    if (teeth := spanned_teeth(gear)) is not None:
        dimensions |= {"span_teeth": teeth, "span_mm": float(span(gear, teeth))}
    if touches(gear, ball := BALL * gear.normal_module):
        over = float(over_balls(gear, ball))
        dimensions |= {"ball_diameter_mm": ball, "over_balls_mm": over}
    return dimensions


def spanned_teeth(gear: Gear) -> int | None:
    """Teeth whose span touches the flanks, of helical teeth within the face width; else None."""
    teeth = span_teeth(gear)
    helical = float(span(gear, teeth)) * abs(math.sin(base_helix_angle(gear)))  # along the axis
    return teeth if helical < gear.width and _on_flank(gear, span_diameter(gear, teeth)) else None


def touches(gear: Gear, ball: float) -> bool:
    """Whether a ball touches the flanks of a tooth space and stands out of the tips."""
    out = float(gear.active_tip_diameter) < float(over_balls(gear, ball))
    return out and _on_flank(gear, ball_contact_diameter(gear, ball))


def _on_flank(gear: Gear, diameter: Any) -> bool:
    """Whether a diameter lies on the involute, up to the chamfer of the tip."""
    return float(form_diameter(gear)) <= float(diameter) <= float(gear.active_tip_diameter)
