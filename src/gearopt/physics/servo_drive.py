"""A motor that turns a load through a gear train of ratio N: acceleration, move time, torque.

Angles and speeds are magnitudes, each of its own shaft; friction opposes the motion. Source: Youn,
eqs. (1) to (6), corrected and extended by efficiency and a falling torque line; checked against
the derivation from the power balance of the motor and of the load. Arguments are floats, arrays of
one shape, or casadi scalars.
"""

import math
from typing import Any

import numpy as np


def reflected_inertia(
    load_inertia: Any, motor_inertia: Any, ratio: Any, efficiency: Any = 1.0
) -> Any:
    """Return the inertia J_L + eta N^2 J_M [t mm2] that the motor's torque accelerates.

    load_inertia J_L, motor_inertia J_M [t mm2] >= 0; ratio N > 0, motor over load speed; efficiency
    0 < eta <= 1 of the train. Source: Youn, eq. (3), with efficiency.
    """
    return load_inertia + efficiency * ratio**2 * motor_inertia


def load_acceleration(
    ratio: Any,
    load_inertia: Any,
    motor_inertia: Any,
    torque: Any,
    load_friction: Any = 0.0,
    efficiency: Any = 1.0,
    torque_slope: Any = 0.0,
) -> Any:
    """Return the load's acceleration (eta N (T - b N) - F_L)/(J_L + eta N^2 J_M) [rad/s2].

    ratio N > 0; load_inertia J_L, motor_inertia J_M [t mm2], not both 0; torque T = T_M - F_M, the
    motor's at standstill less its friction, load_friction F_L >= 0 [N mm]; efficiency 0 < eta <= 1;
    torque_slope b >= 0 [N mm], see there. Negative where the torque does not overcome friction.
    Source: Youn, eq. (3) for eta = 1, b = 0.
    """
    inertia = reflected_inertia(load_inertia, motor_inertia, ratio, efficiency)
    return (efficiency * ratio * (torque - torque_slope * ratio) - load_friction) / inertia


def load_deceleration(
    ratio: Any,
    load_inertia: Any,
    motor_inertia: Any,
    torque: Any,
    load_friction: Any = 0.0,
) -> Any:
    """Return the load's deceleration (N T + F_L)/(J_L + N^2 J_M) [rad/s2] while the motor brakes.

    ratio N > 0; load_inertia J_L, motor_inertia J_M [t mm2], not both 0; torque T = T_M + F_M, the
    motor's and its friction, load_friction F_L >= 0 [N mm]. Losses of the train would help to brake
    and are not counted. Derived from Youn, eq. (1), friction reversed.
    """
    return (ratio * torque + load_friction) / reflected_inertia(load_inertia, motor_inertia, ratio)


def mean_ramp(acceleration: Any, deceleration: Any) -> Any:
    """Return 2/(1/a + 1/d) [rad/s2], of ramps a and d: as long, together, as two ramps like it."""
    return 2.0 / (1.0 / acceleration + 1.0 / deceleration)


def torque_slope(stall_torque: Any, load_speed: Any, no_load_speed: Any) -> Any:
    """Return the torque b = T_s omega_L/omega_0 [N mm] that a motor loses per unit of ratio.

    The motor's line is T_s (1 - omega/omega_0): stall_torque T_s [N mm], no_load_speed omega_0 > 0
    of the motor and load_speed omega_L [rad/s].
    """
    return stall_torque * load_speed / no_load_speed


def move_time(angle: Any, peak_speed: Any, acceleration: Any) -> Any:
    """Return the time Theta/v + v/a [s] from rest to rest: two ramps of mean a, top speed v.

    angle Theta [rad], peak_speed v [rad/s], acceleration a [rad/s2] of the load, that of both ramps
    or their `mean_ramp`, all > 0, with v^2 <= a Theta; at equality the speed has no flat part and
    t = 2 sqrt(Theta/a) is minimum.
    """
    return angle / peak_speed + peak_speed / acceleration


def shortest_move_time(angle: Any, speed_limit: Any, acceleration: Any) -> Any:
    """Return the minimum time [s] from rest to rest where the load's speed is limited.

    angle Theta [rad], speed_limit [rad/s], acceleration a [rad/s2] of the load, that of both ramps
    or their `mean_ramp`, all > 0.
    """
    peak = np.minimum(np.sqrt(acceleration * angle), speed_limit)
    return move_time(angle, peak, acceleration)


def rms_torque(
    ratio: Any,
    load_inertia: Any,
    motor_inertia: Any,
    peak_acceleration: Any,
    load_friction: Any = 0.0,
    motor_friction: Any = 0.0,
) -> Any:
    """Return the root mean square of the motor's torque [N mm] where the load swings as A sin(w t).

    T^2 = (A w^2)^2/2 (J_L/N + N J_M)^2 + (F_L/N + F_M)^2: Coulomb friction is in phase with the
    speed, inertia with the acceleration, so the mean of their product is 0. ratio N > 0;
    load_inertia J_L, motor_inertia J_M [t mm2]; peak_acceleration A w^2 [rad/s2]; load_friction
    F_L, motor_friction F_M [N mm] >= 0. Gears without loss. Derived from Youn, eq. (1).
    """
    inertia = load_inertia / ratio + ratio * motor_inertia
    friction = load_friction / ratio + motor_friction
    return ((peak_acceleration * inertia) ** 2 / 2.0 + friction**2) ** 0.5


def best_acceleration(load_inertia: float, motor_inertia: float, torque: float) -> float:
    """Return the acceleration T/(2 sqrt(J_L J_M)) [rad/s2] at N = sqrt(J_L/J_M), no friction.

    load_inertia J_L, motor_inertia J_M [t mm2] > 0; torque T [N mm]. Source: Youn, eq. (6).
    """
    return torque / (2.0 * math.sqrt(load_inertia) * math.sqrt(motor_inertia))
