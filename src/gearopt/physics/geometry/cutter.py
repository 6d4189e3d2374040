"""What the round at the tips of a pinion-type cutter cuts: the fillets of a ring.

Transverse section. The round is an ellipse of half-axes rho radially and rho/cos(beta) across it,
for spur gears a circle; it touches the cutter's tip circle and its involute. A point of it is named
by the angle theta that the round's normal has there in its normal section, from the tangent of the
circle about the cutter's axis: pi/2 on the tip circle, as of a rack in `fillet`.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear
from gearopt.physics.geometry.involute import involute

STEPS = 8  # towards the flank's end of an ellipse, each of which leaves less than a hundredth


@dataclass(frozen=True)
class CutterTip:
    """Where the round at a corner of the cutter's tips lies.

    centre: radius r_M0 [mm] of its centre; angle [rad] of its centre from the middle of the tooth,
    negative of a cutter that would be pointed; radius rho_a0 [mm]; flank_end: theta where it leaves
    the involute; flank_radius [mm]: of the cutter there. pitch_radius r_w0, distance a_0 [mm]: of
    the cut at the generating profile shift x_E.
    """

    centre: Any
    angle: Any
    radius: Any
    flank_end: Any
    flank_radius: Any
    pitch_radius: Any
    distance: Any


@dataclass(frozen=True)
class Cut:
    """A point of a tool as it cuts, from the gear's axis [mm], and the turn of the gear then [rad].

    across, along: its place, along the line of centres and across it; roll: the angle of the gear's
    space; normal: the angle of the tool's normal from across, towards the root [rad].
    """

    across: Any
    along: Any
    roll: Any
    normal: Any


def reference_and_base(gear: Gear) -> tuple[Any, Any]:
    """Return the radii r_0 and r_b0 [mm] of the cutter of a gear."""
    assert gear.cutter is not None
    share = 0.5 * gear.cutter.teeth / gear.teeth
    return share * gear.reference_diameter, share * gear.base_diameter


def cutter_half_angle(gear: Gear, radius: Any) -> Any:
    """Return half the angle [rad] of a tooth of the cutter at a radius [mm] >= r_b0."""
    assert gear.cutter is not None
    cutter, angle = gear.cutter, gear.rack.pressure_angle
    thick = 0.5 * np.pi + 2.0 * cutter.profile_shift * np.tan(angle)
    at = np.arccos(np.minimum(reference_and_base(gear)[1] / radius, 1.0))
    return thick / cutter.teeth + involute(gear.transverse_pressure_angle) - involute(at)


@np.errstate(invalid="ignore", divide="ignore")
def cutter_tip(gear: Gear) -> CutterTip:
    """Return the tip round of the cutter of a gear.

    Its normal at the flank's end touches the base circle: of spur gears cos(theta) = r_b0/r_M0.
    NaN where the round's centre lies within the base circle, and without a centre distance.
    """
    assert gear.cutter is not None
    radius, cosine = gear.cutter.tip_radius * gear.normal_module, np.cos(gear.helix_angle)
    base = reference_and_base(gear)[1]
    centre = 0.5 * gear.cutter_tip_diameter - radius
    normal, theta = np.arccos(base / centre), np.arccos(base / centre)
    for _ in range(STEPS):
        theta = np.arctan(np.tan(normal) * cosine)
        aside = np.sin(normal) * np.cos(theta) / cosine - np.cos(normal) * np.sin(theta)
        normal = np.arccos((base + radius * aside) / centre)
    across, out = radius * np.cos(theta) / cosine, centre + radius * np.sin(theta)
    flank = np.hypot(across, out)
    angle = cutter_half_angle(gear, flank) - np.arctan2(across, out)
    distance = gear.cutting(gear.generating_shift)[1]
    pitch = distance * gear.cutter.teeth / (gear.cutter.teeth + gear.teeth)
    return CutterTip(centre, angle, radius, theta, flank, pitch, distance)


def cut_by(gear: Gear, theta: Any, tip: CutterTip) -> Cut:
    """Return where the round cuts with its point theta, as the normal there meets the pitch point.

    In the cutter's frame the normal meets the cutter's pitch circle at the pitch point of that
    moment, which tells how far the cutter has turned, and the gear with it.
    """
    cosine = np.cos(gear.helix_angle)
    across, out = tip.radius * np.cos(theta) / cosine, tip.centre + tip.radius * np.sin(theta)
    normal = np.arctan2(np.sin(theta), np.cos(theta) * cosine)
    aside, down = np.cos(normal), np.sin(normal)
    lever = across * down - out * aside  # of the normal about the cutter's axis
    reach = np.sqrt(tip.pitch_radius**2 - lever**2) - across * aside - out * down
    pitch = np.arctan2(across + reach * aside, out + reach * down)
    radius, angle = np.hypot(across, out), np.arctan2(across, out) - pitch
    roll = -(pitch + tip.angle) * tip.pitch_radius / (tip.distance - tip.pitch_radius)
    return Cut(radius * np.sin(angle), tip.distance - radius * np.cos(angle), roll, normal + pitch)
