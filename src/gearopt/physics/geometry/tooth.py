"""Tooth thickness and the dimensions that measure it: span, dimension over balls, backlash.

Arguments are gears and pairs of floats, arrays of one shape or casadi scalars. Diameters of a ring
are negative, its thicknesses and what a gauge shows between its teeth positive.
"""

from typing import Any

import numpy as np

from gearopt.physics.gears import Gear, GearPair, signed
from gearopt.physics.geometry.fillet import base_half_angle, half_angle
from gearopt.physics.geometry.involute import involute, involute_angle


def helix_angle_at(gear: Gear, diameter: Any) -> Any:
    """Return the helix angle arctan(tan(beta) d_y/d) [rad] at a diameter d_y [mm]."""
    return np.arctan(np.tan(gear.helix_angle) * diameter / gear.reference_diameter)


def base_helix_angle(gear: Gear) -> Any:
    """Return the base helix angle arcsin(sin(beta) cos(alpha_n)) [rad]."""
    return np.arcsin(np.sin(gear.helix_angle) * np.cos(gear.rack.pressure_angle))


def transverse_thickness(gear: Gear, diameter: Any) -> Any:
    """Transverse tooth thickness s_yt = d_y (s_t/d + inv(alpha_t) - inv(alpha_yt)) [mm], an arc.

    At d_y >= d_b, with the thickness allowance; below 0 beyond a tooth's point. ISO 21771:2007.
    """
    return diameter * half_angle(gear, 0.5 * diameter)


def normal_thickness(gear: Gear, diameter: Any) -> Any:
    """Normal tooth thickness s_yn = s_yt cos(beta_y) [mm] at d_y >= d_b [mm]; ISO 21771:2007."""
    return transverse_thickness(gear, diameter) * np.cos(helix_angle_at(gear, diameter))


def tip_thickness(gear: Gear) -> Any:
    """Return the normal tip tooth thickness s_an [mm]; negative for a pointed tooth."""
    return normal_thickness(gear, gear.tip_diameter)


def span_teeth(gear: Gear) -> int:
    """Return the number of teeth k whose span is touched near the diameter d + 2 x m_n.

    z/pi (tan(alpha_v)/cos(beta_b)^2 - 2 x/z tan(alpha_n) - inv(alpha_t)) + 1/2, rounded, at least
    2, alpha_v at that diameter; spaces of a ring. Of a gear of floats. Source: ISO 21771:2007,
    number of teeth in a span measurement.
    """
    middle = gear.reference_diameter + 2.0 * gear.profile_shift * gear.normal_module
    tangent = np.tan(np.arccos(min(1.0, float(gear.base_diameter / middle))))
    teeth, angle = gear.teeth, gear.rack.pressure_angle
    shifted = 2.0 * gear.profile_shift / teeth * np.tan(angle)
    rolled = tangent / np.cos(base_helix_angle(gear)) ** 2 - shifted
    turned = rolled - involute(gear.transverse_pressure_angle)
    return max(2, round(float(signed(teeth, teeth) / np.pi * turned + 0.5)))


def span(gear: Gear, teeth: Any) -> Any:
    """Span measurement W_k [mm] over k teeth, or spaces, with the thickness allowance.

    m_n cos(alpha_n) (pi (k - 1/2) + z inv(alpha_t) + 2 x tan(alpha_n)) + A_sn cos(alpha_n); of a
    ring all terms after the first change their sign. Source: ISO 21771:2007, span measurement.
    """
    angle = gear.rack.pressure_angle
    rolled = gear.teeth * involute(gear.transverse_pressure_angle)
    arcs = np.pi * (teeth - 0.5) + signed(rolled, gear.teeth)
    arcs = arcs + signed(2.0 * gear.generating_shift * np.tan(angle), gear.teeth)
    return gear.normal_module * np.cos(angle) * arcs


def span_diameter(gear: Gear, teeth: Any) -> Any:
    """Diameter sqrt(d_b^2 + (W_k cos(beta_b))^2) [mm] where a span touches flanks; ISO 21771."""
    base = np.cos(base_helix_angle(gear))
    return signed(np.hypot(gear.base_diameter, span(gear, teeth) * base), gear.teeth)


def over_balls(gear: Gear, ball_diameter: Any) -> Any:
    """Return the dimension M_dK [mm] over two balls in opposite tooth spaces, of a ring between.

    inv(alpha_Kt) = D_M/(z m_n cos(alpha_n)) - pi/(2 z) + 2 x tan(alpha_n)/z + inv(alpha_t), their
    centres on d_K = d_b/cos(alpha_Kt); M = d_K + D_M for even z, d_K cos(pi/(2 z)) + D_M for odd z
    (for balls of helical gears in one transverse plane), of a ring |d_K| and - D_M. z: whole floats
    or arrays. ball_diameter D_M [mm]. Source: ISO 21771:2007, dimension over balls.
    """
    angle = involute_angle(_ball_value(gear, ball_diameter))
    centres = gear.base_diameter / np.cos(angle)
    odd = np.asarray(gear.teeth) % 2 == 1
    across = centres * np.where(odd, np.cos(0.5 * np.pi / gear.teeth), 1.0)[()] + ball_diameter
    return signed(across, gear.teeth)


def ball_contact_diameter(gear: Gear, ball_diameter: Any) -> Any:
    """Diameter d_b/cos(alpha_Mt) [mm] where a ball in a tooth space touches the flanks.

    tan(alpha_Mt) = tan(alpha_Kt) - D_M cos(beta_b)/d_b. Source: ISO 21771:2007.
    """
    angle = involute_angle(_ball_value(gear, ball_diameter))
    base = gear.base_diameter
    tangent = np.tan(angle) - ball_diameter * np.cos(base_helix_angle(gear)) / base
    return signed(np.hypot(base, base * tangent), gear.teeth)


def over_pins(gear: Gear, pin_diameter: Any) -> Any:
    """Dimension M_dR [mm] over two pins [mm] in opposite spaces, of a ring between them.

    As over balls; pins lie along the helix of helical teeth, so that M = d_K + D_M of odd z, too.
    Source: ISO 21771:2007; a printed report (KISSsoft, 95 teeth of 10 degrees).
    """
    if not gear.helix_angle:
        return over_balls(gear, pin_diameter)
    centres = gear.base_diameter / np.cos(involute_angle(_ball_value(gear, pin_diameter)))
    return signed(centres + pin_diameter, gear.teeth)


def chord(gear: Gear) -> tuple[Any, Any]:
    """Normal chordal thickness and its height [mm] below the tip, at the reference circle.

    d_n sin(s_n/d_n) and (d_a - d)/2 + d_n (1 - cos(s_n/d_n))/2, d_n = d/cos(beta)^2 that of the
    curvature along s_n; of a ring the height is less by the last term. Sources: DIN 3960; metric
    gear handbook, table 10-1 (z 12, m 10: 17.8256 and 13.6657); printed reports of helical gears.
    """
    d, thickness = gear.reference_diameter, normal_thickness(gear, gear.reference_diameter)
    across = d / np.cos(gear.helix_angle) ** 2
    height = 0.5 * (gear.tip_diameter - d) + 0.5 * across * (1.0 - np.cos(thickness / across))
    return across * np.sin(thickness / across), height


def _ball_value(gear: Gear, ball_diameter: Any) -> Any:
    angle, teeth = gear.rack.pressure_angle, gear.teeth
    filled = ball_diameter / (teeth * gear.normal_module * np.cos(angle))
    return filled - np.pi / teeth + base_half_angle(gear)


def circumferential_backlash(pair: GearPair) -> Any:
    """Circumferential backlash j_wt [mm] at the working pitch circles, transverse (ISO 21771:2007).

    Pitch minus both thicknesses there, which hold the allowances: exact, where
    `backlash.thickness_backlash` is linear in them. Negative: the teeth do not fit in.
    """
    pinion, wheel = pair.working_diameters
    pitch = np.pi * pinion / pair.pinion_teeth
    used = transverse_thickness(pair.pinion, pinion) + transverse_thickness(pair.wheel, wheel)
    return pitch - used


def normal_backlash(pair: GearPair) -> Any:
    """Return the normal backlash j_bn = j_wt cos(alpha_wt) cos(beta_b) [mm]."""
    across = np.cos(pair.working_angle) * np.cos(base_helix_angle(pair.pinion))
    return circumferential_backlash(pair) * across


def tip_clearances(pair: GearPair) -> tuple[Any, Any]:
    """Tip clearances c = a - d_a/2 - d_f/2 [mm] of both tips, roots nominal (ISO 21771:2007)."""
    rows = zip(pair.gears, pair.gears[::-1], strict=True)
    first, second = (
        pair.centre_distance - 0.5 * (gear.tip_diameter + mate.root_diameter) for gear, mate in rows
    )
    return first, second


def virtual_teeth(gear: Gear) -> Any:
    """Virtual number of teeth z_n = z/(cos(beta_b)^2 cos(beta)) of ISO 6336-3:2006."""
    return gear.teeth / (np.cos(base_helix_angle(gear)) ** 2 * np.cos(gear.helix_angle))
