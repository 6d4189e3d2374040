"""The root fillet that a rack or a cutter with a rounded tip generates, and where it ends.

Transverse section of the gear, exact for helical gears too: the tip round of the tool is a circle
in its normal section, an ellipse in the transverse one. A point of the fillet is named by the angle
theta of the tool's normal there, in the tool's normal section, from the pitch line: alpha_n where
the round leaves the flank of the tool, pi/2 at its tip. Coordinates of a tooth: y along its centre
line from the gear's axis, x > 0 across it. For the virtual spur gear of AGMA 908 or ISO 6336-3 pass
a gear of its teeth without helix angle.

Radii of a ring are negative as its diameters are, and so are its half angles; its tooth stands
upright at y < 0, its tip towards the axis. It is cut by its pinion-type cutter, else by the
counterpart of its rack, which rolls on the concave side of its reference circle: the limit of
cutters with many teeth, which no such tool could enter, and the profile that its shift means.
"""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, Rack, signed, transverse_pressure_angle
from gearopt.physics.geometry.cutter import Cut, CutterTip, cut_by, cutter_tip
from gearopt.physics.geometry.involute import involute

HALVINGS = 50  # of an interval of tool angles: to the last digit
NEGLIGIBLE = 0.01  # modules that a rack may reach too deep: 17 teeth of 20 degrees need 0.006
NOT_ROWS = "rack", "body_diameter", "cutter", "outside_diameter"  # of arrays in a gear
TOUCHES = 1e-12  # of sin(alpha_t)^2 z/2: undercut by less is none


@dataclass(frozen=True)
class ToolTip:
    """Where the round of the tool's tip lies as it cuts a gear; lengths [mm], normal section.

    depth: of its centre below the pitch line of the cut, c = (h_fP - x_E) m_n - rho; half_width:
    of its centre from the middle of the tool's tooth, E = pi m_n/4 - (h_fP m_n - rho) tan(alpha_n)
    - (rho - pr)/cos(alpha_n), negative for a tool that would be pointed; radius rho.
    Source: derived; for pr = 0 E = pi m_n/4 - h_fP m_n tan(alpha_n) - rho (1 - sin(alpha_n))/
    cos(alpha_n), as ISO 6336-3 has it but for its sign.
    """

    depth: Any
    half_width: Any
    radius: Any


@dataclass(frozen=True)
class FilletPoint:
    """A point of a fillet: x, y [mm]; slope of its tangent to the centre line of the tooth [rad].

    slope > 0: the tooth gets thinner outwards; its normal into the tooth is (-cos(slope),
    -sin(slope)). radius [mm] and half_angle [rad]: the same point in polar coordinates.
    """

    x: Any
    y: Any
    slope: Any
    radius: Any
    half_angle: Any


def tool_tip(gear: Gear) -> ToolTip:
    """Return the tip round of the rack that cuts a gear at its generating profile shift x_E."""
    rack, module = gear.rack, gear.normal_module
    radius = rack.tip_radius * module
    depth = (rack.dedendum - gear.generating_shift) * module - radius
    inside = rack.dedendum * module - radius
    left = (radius - rack.protuberance * module) / np.cos(rack.pressure_angle)
    half = np.pi / 4.0 * module - inside * np.tan(rack.pressure_angle) - left
    return ToolTip(depth, half, radius)


def has_tip(gear: Gear) -> Any:
    """Whether the tool's flanks end before they meet; its rounds may meet in an edge before."""
    tip = tool_tip(gear)
    return np.greater(tip.half_width + tip.radius * np.cos(gear.rack.pressure_angle), 0.0)


def largest_tip_radius(pressure_angle: Any, dedendum: Any) -> Any:
    """Tip radius rho_fP [normal modules] of a tool whose tip is one full round, E = 0."""
    left = np.pi / 4.0 - dedendum * np.tan(pressure_angle)
    return left * np.cos(pressure_angle) / (1.0 - np.sin(pressure_angle))


def fillet_point(gear: Gear, theta: Any, tip: ToolTip | CutterTip | None = None) -> FilletPoint:
    """Return the point of the fillet that the tool cuts where its normal has the angle theta.

    theta [rad] in the tool's normal section, from `fillet_end` (root side of the flank) to pi/2
    (the root circle, or what undercut leaves of it). tip: `tool_tip` of the gear, if known, or
    `cutter_tip`.
    Derived: a point is cut as its normal passes through the pitch point.
    """
    if tip is None:
        tip = tool_tip(gear) if gear.cutter is None else cutter_tip(gear)
    cut = _cut(gear, theta, tip) if isinstance(tip, ToolTip) else cut_by(gear, theta, tip)
    across, along = signed(cut.across, gear.teeth), signed(cut.along, gear.teeth)
    at = signed(np.hypot(across, along), gear.teeth)
    half = np.pi / gear.teeth - np.arctan2(across, along) + cut.roll
    slope = cut.normal - cut.roll - np.pi / gear.teeth
    return FilletPoint(at * np.sin(half), at * np.cos(half), slope, at, half)


def _cut(gear: Gear, theta: Any, tip: ToolTip) -> Cut:
    """Return where the rack's round cuts with its point theta; see `cutter.cut_by`."""
    cosine, radius = np.cos(gear.helix_angle), 0.5 * gear.reference_diameter
    below = tip.depth + tip.radius * np.sin(theta)
    across = (tip.half_width + tip.radius * np.cos(theta)) / cosine
    beside = below * cosine * np.cos(theta) / np.sin(theta)
    normal = np.arctan2(np.sin(theta), cosine * np.cos(theta))
    return Cut(beside, radius - below, (beside - across) / radius, normal)


def least_fillet_radius(gear: Gear) -> Any:
    """Radius of curvature rho + c^2/(r + c) [mm] of the fillet of a spur gear at the root circle.

    c: depth of the centre of the tool's tip round, r: reference radius. Source: AGMA 908-B89,
    clause 5, as the least of the fillet; Euler and Savary.
    """
    tip, radius = tool_tip(gear), 0.5 * gear.reference_diameter
    return tip.radius + tip.depth**2 / (radius + tip.depth)


def undercut_depth(gear: Gear) -> Any:
    """How far the tool's straight flank reaches below its last useful point [mm]; > 0: undercut.

    h_Ff - x_E m_n - (d/2) sin(alpha_t)^2, h_Ff = h_fP m_n - rho (1 - sin(alpha_n)); below 0 of a
    ring, from whose tangent point the rack moves away. Source: ISO 21771:2007, undercut.
    """
    tip = tool_tip(gear)
    end = tip.depth + tip.radius * np.sin(gear.rack.pressure_angle)
    return signed(end - _lever(gear), gear.teeth)


def teeth_without_undercut(rack: Rack, helix_angle: Any) -> Any:
    """Return the minimum teeth z = 2 h_Ff/m_n cos(beta)/sin(alpha_t)^2 without undercut by a rack.

    helix_angle beta [rad]; without profile shift; h_Ff as in `undercut_depth`, one module for
    profile A of ISO 53: 17.1 spur teeth. With z teeth the rack's flank ends h_Ff (1 - z/limit) too
    deep, up to NEGLIGIBLE of which gears are made as they are: 17 teeth of 20 degrees (0.006), 12
    of 25, as tables of minimum numbers of teeth have them.
    """
    sine = np.sin(rack.pressure_angle)
    transverse = transverse_pressure_angle(rack.pressure_angle, helix_angle)
    depth = rack.dedendum - rack.tip_radius * (1.0 - sine)
    return 2.0 * depth * np.cos(helix_angle) / np.sin(transverse) ** 2


def is_undercut(gear: Gear) -> Any:
    """Whether the tool cuts away involute above the base circle: bool or array of them."""
    return undercut_depth(gear) > TOUCHES * _lever(gear)


def _lever(gear: Gear) -> Any:
    """Depth (d/2) sin(alpha_t)^2 [mm] of the base circle's tangent point below the pitch line."""
    return 0.5 * gear.reference_diameter * np.sin(gear.transverse_pressure_angle) ** 2


def half_angle(gear: Gear, radius: Any) -> Any:
    """Half the angle s_t/d + inv(alpha_t) - inv(alpha_yt) [rad] of a tooth at a radius [mm].

    s_n = m_n (pi/2 + 2 x tan(alpha_n)) + A_sn; below the base circle that of the base circle;
    negative of a ring. Source: ISO 21771:2007, tooth thickness half angle.
    """
    return base_half_angle(gear) - involute(profile_angle(gear, radius))


def profile_angle(gear: Gear, radius: Any) -> Any:
    """Return alpha_yt = arccos(d_b/d_y) [rad] at a radius d_y/2 [mm]; 0 below the base circle."""
    return np.arccos(np.minimum(0.5 * gear.base_diameter / radius, 1.0))


def base_half_angle(gear: Gear) -> Any:
    """Return half the angle of a tooth on its base circle [rad], which may be below the fillet."""
    shifted = 0.5 * np.pi + 2.0 * gear.generating_shift * np.tan(gear.rack.pressure_angle)
    return shifted / gear.teeth + involute(gear.transverse_pressure_angle)


def fillet_end(gear: Gear) -> Any:
    """Return the tool angle theta [rad] of the point where fillet and involute meet.

    alpha_n without undercut and protuberance: there they meet with one tangent. Else where the two
    curves cross, by halving an interval (`HALVINGS`): with undercut below alpha_n and above it the
    crossing lies between the base circle and the end of the tool's flank; protuberance moves that
    end to alpha_n - arccos(1 - pr/rho). Of a cutter `CutterTip.flank_end`. Floats or arrays of one
    shape, not casadi.
    """
    if gear.cutter is not None:
        return cutter_tip(gear).flank_end
    rack = gear.rack
    searched = np.asarray(is_undercut(gear) | np.greater(rack.protuberance, 0.0))
    angle = np.array(np.broadcast_to(rack.pressure_angle, searched.shape), float)
    if searched.any():
        angle[searched] = _crossing(_rows(gear, searched))
    return angle[()]


def _rows(gear: Gear, chosen: Any) -> Gear:
    """Return the chosen ones of a gear of arrays; chosen: booleans of their shape."""

    def part(value: Any) -> Any:
        return np.broadcast_to(value, chosen.shape)[chosen]

    rack = Rack(*(part(getattr(gear.rack, each.name)) for each in fields(Rack)))
    names = [each.name for each in fields(gear) if each.name not in NOT_ROWS]
    return replace(gear, rack=rack, **{name: part(getattr(gear, name)) for name in names})


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def _crossing(gear: Gear) -> Any:
    """Return the tool angle at which fillet and involute cross; a gear of arrays."""
    rack, tip = gear.rack, tool_tip(gear)
    share = np.where(rack.protuberance > 0.0, rack.protuberance / rack.tip_radius, 0.0)
    low = rack.pressure_angle - np.arccos(1.0 - np.minimum(share, 1.0))
    at_base = _at_base(gear, tip, rack.pressure_angle)
    high = np.where(is_undercut(gear), at_base, rack.pressure_angle)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        inside = _inside(gear, tip, middle) < 0.0
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    return high


def _inside(gear: Gear, tip: ToolTip, theta: Any) -> Any:
    """Return how far the fillet is outside the involute [rad]; negative: it cuts it away."""
    point = fillet_point(gear, theta, tip)
    return signed(point.half_angle - half_angle(gear, point.radius), gear.teeth)


def _at_base(gear: Gear, tip: ToolTip, angle: Any) -> Any:
    """Return the tool angle at which the fillet crosses the base circle."""
    low, high = angle, np.full_like(angle, 0.5 * np.pi)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        outside = fillet_point(gear, middle, tip).radius > 0.5 * gear.base_diameter
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    return low


def form_diameter(gear: Gear) -> Any:
    """Root form diameter d_Ff [mm], where fillet and involute meet (ISO 21771:2007)."""
    return 2.0 * fillet_point(gear, fillet_end(gear)).radius


def profile(gear: Gear, on_fillet: int, on_flank: int, rolled: bool = False) -> tuple[Any, Any]:
    """Return x and y [mm] of one side of a tooth, from the root circle to the tip circle.

    on_fillet, on_flank: points of either, at least 2; the arrays have on_fillet + on_flank - 1;
    those of the flank are at even radii, or rolled: at even angles of roll. Of
    one gear of floats; a flank above a pointed tip is left as it is computed, with x < 0.
    """
    theta = np.linspace(0.5 * np.pi, float(fillet_end(gear)), on_fillet)
    fillet = fillet_point(gear, theta)
    ends, base = (fillet.radius[-1], 0.5 * gear.tip_diameter), 0.5 * gear.base_diameter
    if rolled:
        low, high = (float(max(r**2 - base**2, 0.0)) ** 0.5 for r in ends)  # r_b times the roll
        radius = signed(np.hypot(base, np.linspace(low, high, on_flank)[1:]), gear.teeth)
    else:
        radius = np.linspace(*ends, on_flank)[1:]
    half = half_angle(gear, radius)
    x = np.concatenate((fillet.x, radius * np.sin(half)))
    return x, np.concatenate((fillet.y, radius * np.cos(half)))
