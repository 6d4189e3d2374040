"""The involute function, its inverse, and how sum of profile shifts and centre distance meet.

Arguments are floats, arrays of one shape, or casadi scalars.
"""

from typing import Any

import numpy as np

NEWTON_STEPS = 9  # from the guess to the last digit, for 0.01 to 85 degrees; 6 suffice below 45


def involute(angle: Any) -> Any:
    """Return inv(alpha) = tan(alpha) - alpha [rad]; angle alpha [rad] from 0 to below pi/2."""
    return np.tan(angle) - angle


@np.errstate(invalid="ignore")
def involute_angle(value: Any) -> Any:
    """Return the angle alpha [rad] with inv(alpha) = value; NaN for arrays and floats below 0.

    value >= 0 [rad], up to 11 (85 degrees). Newton's method on t - arctan(t) = value, t =
    tan(alpha), which is convex and rising: from the guess (3 value)^(1/3), too small, the first
    step overshoots and all later ones fall monotonically to the root. A fixed number of them, so
    that it can be traced. Relative error below 1e-14/alpha^2.
    """
    value = value + 1e-300  # a root of 0 without 0/0
    t = (3.0 * value) ** (1.0 / 3.0)
    for _ in range(NEWTON_STEPS):
        t = t - (t - np.arctan(t) - value) * (1.0 + t * t) / (t * t)
    return np.arctan(t)


def working_pressure_angle(
    shift_sum: Any, teeth_sum: Any, normal_angle: Any, transverse_angle: Any
) -> Any:
    """Return the transverse working pressure angle alpha_wt [rad] without backlash.

    inv(alpha_wt) = inv(alpha_t) + 2 (x1 + x2)/(z1 + z2) tan(alpha_n); z1 + z2 < 0 of internal
    pairs. NaN where no centre distance is short enough: x1 + x2 < -(z1 + z2) inv(alpha_t)/(2
    tan(alpha_n)), of internal pairs greater. Source: ISO 21771:2007.
    """
    shifted = 2.0 * shift_sum / teeth_sum * np.tan(normal_angle)
    return involute_angle(involute(transverse_angle) + shifted)


def shift_sum(working_angle: Any, teeth_sum: Any, normal_angle: Any, transverse_angle: Any) -> Any:
    """Sum x1 + x2 that meshes without backlash at alpha_wt [rad]; see `working_pressure_angle`."""
    change = involute(working_angle) - involute(transverse_angle)
    return 0.5 * teeth_sum * change / np.tan(normal_angle)


@np.errstate(invalid="ignore")
def angle_at_distance(reference_distance: Any, transverse_angle: Any, distance: Any) -> Any:
    """Angle alpha_wt = arccos(a_0 cos(alpha_t)/a) [rad] at a distance a [mm] (ISO 21771:2007).

    a_0 = (d1 + d2)/2, below 0 of internal pairs as a is; NaN where base circles overlap, or one
    holds the other.
    """
    return np.arccos(reference_distance * np.cos(transverse_angle) / distance)
