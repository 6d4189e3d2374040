"""Load indices of a gear pair: torque, K-factor, unit load, Lewis stress (external gears).

Arguments are floats, arrays of one shape, or casadi scalars.
"""

import math
from collections.abc import Sequence
from typing import Any


def torque(power: Any, angular_speed: Any) -> Any:
    """Return the torque T = P/omega [N mm] for power [N mm/s] at angular_speed [rad/s].

    angular_speed > 0. Equals 30e6 P/(pi n) for P in kW and n in rpm.
    """
    return power / angular_speed


def torque_ratios(ratios: Sequence[Any], drivers: Sequence[str] = ()) -> list[tuple[Any, Any]]:
    """Torque of every stage's pinion, and of the shaft behind the stage, over that of the input.

    Without losses, so that the input's speed over theirs is the same. ratios u = z2/z1; drivers:
    the member that drives each stage, by default every pinion: a wheel that drives leaves 1/u.
    """
    reached, rows = 1.0, []
    for u, driver in zip(ratios, drivers or ("pinion",) * len(ratios), strict=True):
        behind = reached * u if driver == "pinion" else reached / u
        rows.append((reached if driver == "pinion" else behind, behind))
        reached = behind
    return rows


def k_factor(pinion_torque: Any, pinion_diameter: Any, face_width: Any, ratio: Any) -> Any:
    """Return the K-factor W_t/(d1 b) (u + 1)/u [MPa], W_t = 2 T1/d1: the index of contact stress.

    pinion_torque T1 [N mm]; pinion_diameter d1, face_width b [mm] > 0; ratio u >= 1.
    Source: Chong and Lee, eq. (10); sigma_H = Z_E-like constant times sqrt(K), their eq. (1).
    """
    return 2.0 * pinion_torque / (pinion_diameter**2 * face_width) * (1.0 + 1.0 / ratio)


def unit_load(pinion_torque: Any, pinion_diameter: Any, face_width: Any, normal_module: Any) -> Any:
    """Return the unit load W_t/(b m_n) [MPa], W_t = 2 T1/d1: the index of tooth-root stress.

    pinion_torque T1 [N mm]; pinion_diameter d1, face_width b, normal_module m_n [mm] > 0.
    Source: Chong and Lee, eq. (11).
    """
    return 2.0 * pinion_torque / (pinion_diameter * face_width * normal_module)


def lewis_stress(torque: Any, diameter: Any, face_width: Any, module: Any, form_factor: Any) -> Any:
    """Return the Lewis stress 2 T/(d b m Y) [MPa] at the root of a gear.

    torque T [N mm] on the gear of pitch diameter d, face_width b, module m [mm]; form_factor Y on
    the module. No dynamic nor stress concentration factor.
    """
    return 2.0 * torque / (diameter * face_width * module * form_factor)


def pitch_line_velocity(angular_speed: Any, diameter: Any) -> Any:
    """Return the speed v = omega d/2 of the reference circles in mesh [mm/s].

    angular_speed omega [rad/s] and reference diameter d [mm] of one of the two gears, both > 0.
    """
    return 0.5 * angular_speed * diameter


def torsion_diameter(torque: Any, shear_stress: Any) -> Any:
    """Return the diameter (16 T/(pi tau))^(1/3) [mm] of a solid shaft twisted to a shear stress.

    torque T [N mm], shear_stress tau [MPa] > 0; torsion alone, no bending and no notches.
    Source: polar section modulus pi d^3/16 of a round bar.
    """
    return (16.0 * torque / (math.pi * shear_stress)) ** (1.0 / 3.0)
