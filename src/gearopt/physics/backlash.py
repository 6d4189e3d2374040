"""Backlash and pitch error as angles, and their way to the output (external cylindrical gears).

Angles are the total lost motion between both flanks, not plus or minus half of it. Arguments are
floats, arrays of one shape, or casadi scalars.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from gearopt.physics.gears import transverse_pressure_angle


def radial_backlash(radial_displacement: Any, pressure_angle: Any, helix_angle: Any = 0.0) -> Any:
    """Return the circumferential backlash j_t = 2 tan(alpha_t) Delta_r [mm] of gears moved apart.

    radial_displacement Delta_r [mm] >= 0, small against the module, the sum of one-sided terms;
    normal pressure_angle, helix_angle [rad]. Source: Youn, eq. (9), there for spur gears.
    """
    return (
        2.0 * np.tan(transverse_pressure_angle(pressure_angle, helix_angle)) * radial_displacement
    )


def play_backlash(play: Any, pressure_angle: Any, helix_angle: Any = 0.0) -> Any:
    """Return the circumferential lost motion 2 delta/cos(alpha_t) [mm] of an axis with play.

    play delta [mm]: radius of the circle in which the axis is free. As the torque reverses the
    force of the teeth takes it by delta along either line of action, whose length is
    j_t cos(alpha_t). Kinematics; `radial_backlash` of delta is what opens without a force, less by
    sin(alpha_t). Normal pressure_angle, helix_angle [rad].
    """
    return 2.0 * play / np.cos(transverse_pressure_angle(pressure_angle, helix_angle))


def thickness_backlash(
    pinion_allowance: Any,
    wheel_allowance: Any,
    distance_allowance: Any,
    pressure_angle: Any,
    helix_angle: Any = 0.0,
) -> Any:
    """Return the backlash j_t = -(A_sn1 + A_sn2)/cos(beta) + 2 A_a tan(alpha_t) [mm].

    allowances A_sn of the normal tooth thickness (negative: thinner) and A_a of the centre distance
    [mm], small against the module; normal pressure_angle, helix_angle [rad]. Upper allowances of
    the teeth and the lower one of the distance give the minimum backlash, the others the largest.
    Source: ISO 21771 and DIN 3967 as j_bn = -(A_sn1 + A_sn2) cos(alpha_n)
    + 2 A_a sin(alpha_t) cos(beta_b), see `normal_backlash`.
    """
    thinner = -(pinion_allowance + wheel_allowance) / np.cos(helix_angle)
    return thinner + radial_backlash(distance_allowance, pressure_angle, helix_angle)


def normal_backlash(backlash: Any, pressure_angle: Any, helix_angle: Any = 0.0) -> Any:
    """Return the normal backlash j_t cos(alpha_t) cos(beta_b) = j_t cos(alpha_n) cos(beta) [mm].

    circumferential backlash j_t [mm]; normal pressure_angle, helix_angle [rad]. Source: ISO 21771.
    """
    return backlash * np.cos(pressure_angle) * np.cos(helix_angle)


def backlash_angle(backlash: Any, diameter: Any) -> Any:
    """Return the angle 2 j_t/D [rad] by which a wheel can turn within its backlash.

    circumferential backlash j_t, reference diameter D of the wheel [mm]. Source: Youn, eq. (9).
    """
    return 2.0 * backlash / diameter


def pitch_error_angle(pitch_deviation: Any, diameter: Any) -> Any:
    """Return the angle 2 delta_p/D [rad] of a cumulative pitch deviation.

    pitch_deviation delta_p [mm], of both gears of a mesh at the worst (the source counts one);
    reference diameter D of the wheel [mm]. Source: Youn, eq. (10).
    """
    return 2.0 * pitch_deviation / diameter


def output_error(angles: Iterable[Any], downstream_ratios: Iterable[Any]) -> Any:
    """Return the error sum_i e_i/n_i [rad] at the output of angles at other shafts, all at worst.

    angles e_i [rad] at the wheel of stage i; downstream_ratios n_i: product of the ratios of the
    stages after it, 1 for the last. Source: used but not printed by Youn.
    """
    return sum(e / n for e, n in zip(angles, downstream_ratios, strict=True))
