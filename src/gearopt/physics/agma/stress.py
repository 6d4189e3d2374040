"""Stresses, safety factors, permissible power and life by AGMA 2001-D04, clauses 5 and 7.

Arguments are floats, arrays of one shape or casadi scalars. Two definitions of safety against
pitting are in use: S_H of stresses, as the standard has it, and S_H^2 of loads, which alone
compares with S_F.
"""

from typing import Any

import numpy as np

from gearopt.physics.agma.life import Curve


def tangential_load(power: Any, pinion_speed: Any, working_diameter: Any) -> Any:
    """Return W_t = 2 P/(omega d_w1) [N] at the working pitch circle.

    power P [N mm/s], pinion_speed omega [rad/s], d_w1 [mm]. Source: AGMA 2001-D04, clause 7.
    """
    return 2.0 * power / (pinion_speed * working_diameter)


def bending_stress(
    load: Any, face_width: Any, transverse_module: Any, geometry_factor: Any, factors: Any = 1.0
) -> Any:
    """Return s_t = W_t K_o K_v K_s K_m K_B/(b m_t J) [MPa].

    load W_t [N]; face_width b of the narrower gear, transverse_module m_n/cos(beta) [mm];
    geometry_factor J; factors: the product of the K. Source: AGMA 2001-D04, eq. (10).
    """
    return load * factors / (face_width * transverse_module * geometry_factor)


def contact_stress(
    elastic_coefficient: Any,
    load: Any,
    face_width: Any,
    working_diameter: Any,
    geometry_factor: Any,
    factors: Any = 1.0,
) -> Any:
    """Return s_c = C_p sqrt(W_t K_o K_v K_s K_m C_f/(d_w1 b I)) [MPa], of both gears.

    elastic_coefficient C_p [sqrt(MPa)]; load W_t [N]; face_width b, working_diameter d_w1 [mm];
    geometry_factor I; factors: the product of the K and C_f. Source: AGMA 2001-D04, eq. (1).
    """
    area = face_width * working_diameter * geometry_factor
    return elastic_coefficient * np.sqrt(load * factors / area)


def bending_safety(
    allowable: Any, cycle_factor: Any, temperature: Any, reliability: Any, stress: Any
) -> Any:
    """Return S_F = s_at Y_N/(K_T K_R s_t), of stress and of load alike.

    allowable s_at, stress s_t [MPa]. Source: AGMA 2001-D04, eq. (13); Shigley, eq. (14-41).
    """
    return allowable * cycle_factor / (temperature * reliability * stress)


def contact_safety(
    allowable: Any,
    cycle_factor: Any,
    hardness_ratio: Any,
    temperature: Any,
    reliability: Any,
    stress: Any,
) -> Any:
    """Return S_H = s_ac Z_N C_H/(K_T K_R s_c), of stress; the load may grow by its square.

    allowable s_ac, stress s_c [MPa]; hardness_ratio C_H: 1 of the pinion. Source: AGMA 2001-D04,
    eq. (4); Shigley, eq. (14-42), who compares S_F with S_H^2.
    """
    return allowable * cycle_factor * hardness_ratio / (temperature * reliability * stress)


def bending_life(curve: Curve, cycle_factor: Any, safety: Any) -> Any:
    """Return the cycles at which S_F is 1: Y_N(N) = Y_N/S_F.

    curve of Y_N; cycle_factor Y_N with which the safety S_F was computed. 0: breaks at once.
    """
    return curve.life(cycle_factor / safety)


def contact_life(curve: Curve, cycle_factor: Any, safety: Any) -> Any:
    """Return the cycles at which S_H is 1: Z_N(N) = Z_N/S_H; see `bending_life`."""
    return curve.life(cycle_factor / safety)
