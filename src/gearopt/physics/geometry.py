"""Sizes of external cylindrical gears without profile shift (ISO 21771 terms), in mm.

Arguments are floats, arrays of one shape, or casadi scalars. Tooth numbers may be real.
"""

from typing import Any

import numpy as np

# Of the normal module, from the reference to the tip and to the root line of the basic rack: ISO
# 53:1998, profile A; the same in Rack.m of github.com/gfsReboucas/Drivetrain, and what the
# diameters of its KISSsoft report (NREL 5 MW gearbox, stage 3) follow.
ADDENDUM = 1.0
DEDENDUM = 1.25
NEGLIGIBLE = 0.01  # modules that a rack may reach too deep: 17 teeth of 20 degrees need 0.006


def reference_diameter(module: Any, teeth: Any, helix_angle: float = 0.0) -> Any:
    """Reference (pitch) diameter d = m_n z / cos(beta) [mm].

    module [mm] > 0, the normal one, or the transverse one m_n/cos(beta) without a helix angle;
    teeth > 0; helix_angle [rad], |beta| < pi/2.
    Source: ISO 21771:2007, reference diameter.
    """
    return module * teeth / np.cos(helix_angle)


def tip_diameter(diameter: Any, normal_module: Any) -> Any:
    """Tip diameter d_a = d + 2 h_aP of a gear without profile shift, h_aP = 1 m_n [mm].

    reference diameter d, normal_module m_n [mm] > 0.
    Source: ISO 21771:2007, tip diameter; basic rack ISO 53 profile A (see ADDENDUM).
    """
    return diameter + 2.0 * ADDENDUM * normal_module


def root_diameter(diameter: Any, normal_module: Any) -> Any:
    """Root diameter d_f = d - 2 h_fP of a gear without profile shift, h_fP = 1.25 m_n [mm].

    reference diameter d, normal_module m_n [mm] > 0; nominal: without backlash.
    Source: ISO 21771:2007, root diameter; basic rack ISO 53 profile A (see DEDENDUM).
    """
    return diameter - 2.0 * DEDENDUM * normal_module


def transverse_pressure_angle(pressure_angle: Any, helix_angle: float) -> Any:
    """Transverse pressure angle alpha_t = arctan(tan(alpha_n)/cos(beta)) [rad].

    pressure_angle alpha_n, the normal one, from 0 to below pi/2; helix_angle beta, |beta| < pi/2.
    Source: ISO 21771:2007, transverse pressure angle.
    """
    return np.arctan(np.tan(pressure_angle) / np.cos(helix_angle))


def teeth_without_undercut(pressure_angle: Any, helix_angle: float) -> Any:
    """Least teeth z = 2 cos(beta)/sin(alpha_t)^2 that a rack of addendum 1 m_n does not undercut.

    pressure_angle alpha_n, helix_angle beta [rad]; for gears without profile shift.
    Source: the rack's tip line passes through the tangent point of the base circle, h = (d/2)
    sin(alpha_t)^2; 17.1 for spur gears of 20 degrees. With z teeth the line lies 1 - z/limit
    modules too deep, up to NEGLIGIBLE of which gears are made as they are: 17 teeth of 20 degrees
    (0.006), 32 of 14.5, 12 of 25, as tables of least teeth have them.
    """
    transverse = transverse_pressure_angle(pressure_angle, helix_angle)
    return 2.0 * ADDENDUM * np.cos(helix_angle) / np.sin(transverse) ** 2


def transverse_contact_ratio(
    tip_diameters: tuple[Any, Any],
    base_diameters: tuple[Any, Any],
    centres: Any,
    working_angle: Any,
    base_pitch: Any,
) -> Any:
    """Transverse contact ratio eps_alpha = g_alpha/p_bt: how many pairs of teeth touch on average.

    g_alpha = (sqrt(d_a1^2 - d_b1^2) + sqrt(d_a2^2 - d_b2^2))/2 - a sin(alpha_wt). Tip diameters
    d_a > base diameters d_b of pinion and wheel; centres: their distance a; base_pitch p_bt, the
    transverse one, all [mm] > 0; working_angle alpha_wt, the transverse one [rad].
    Valid without undercut (see `teeth_without_undercut`), else too large.
    Source: ISO 6336-1:2006 and ISO 21771:2007, transverse contact ratio.
    """
    (a1, a2), (b1, b2) = tip_diameters, base_diameters
    reach = 0.5 * (np.sqrt(a1**2 - b1**2) + np.sqrt(a2**2 - b2**2))
    return (reach - centres * np.sin(working_angle)) / base_pitch


def standard_contact_ratio(
    normal_module: Any, pinion_teeth: Any, ratio: Any, pressure_angle: Any, helix_angle: float
) -> Any:
    """Transverse contact ratio eps_alpha of a pair without profile shift at its reference centres.

    normal_module [mm] > 0; pinion_teeth z1 > 0; ratio u = z2/z1 >= 1; pressure_angle alpha_n,
    helix_angle beta [rad]. Tips by ISO 53 profile A; validity as `transverse_contact_ratio`.
    """
    angle = transverse_pressure_angle(pressure_angle, helix_angle)
    pinion = reference_diameter(normal_module, pinion_teeth, helix_angle)
    both = (pinion, pinion * ratio)
    return transverse_contact_ratio(
        (tip_diameter(both[0], normal_module), tip_diameter(both[1], normal_module)),
        (both[0] * np.cos(angle), both[1] * np.cos(angle)),
        centre_distance(pinion, ratio),
        angle,
        np.pi * normal_module / np.cos(helix_angle) * np.cos(angle),
    )


def overlap_ratio(face_width: Any, normal_module: Any, helix_angle: float) -> Any:
    """Overlap ratio eps_beta = b sin(|beta|)/(pi m_n); 0 for spur gears.

    face_width b, normal_module m_n [mm] > 0; helix_angle beta [rad], |beta| < pi/2.
    Source: ISO 21771:2007 and ISO 6336-1:2006, overlap ratio.
    """
    return face_width * np.abs(np.sin(helix_angle)) / (np.pi * normal_module)


def centre_distance(pinion_diameter: Any, ratio: Any) -> Any:
    """Reference centre distance a = d1 (1 + u)/2 [mm].

    pinion_diameter d1 [mm] > 0; ratio u = z2/z1 >= 1.
    Source: Chong and Lee, symbols of section 1 (a = (d1 + d2)/2).
    """
    return 0.5 * pinion_diameter * (1.0 + ratio)


def cylinder_volume(diameter: Any, face_width: Any) -> Any:
    """Volume V = (pi/4) b d^2 of a gear as a solid reference cylinder [mm^3].

    diameter d, face_width b [mm] > 0.
    """
    return 0.25 * np.pi * face_width * diameter**2


def gear_volume(pinion_diameter: Any, face_width: Any, ratio: Any) -> Any:
    """Volume of pinion and wheel as solid reference cylinders V = (pi/4) b d1^2 (1 + u^2) [mm^3].

    pinion_diameter d1, face_width b [mm] > 0; ratio u >= 1.
    Source: Chong and Lee, eq. (4), correct as printed.
    """
    return 0.25 * np.pi * face_width * pinion_diameter**2 * (1.0 + ratio**2)
