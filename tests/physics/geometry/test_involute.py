"""The involute function and its inverse, against mpmath-free closed forms and a bisection."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.geometry.involute import (
    angle_at_distance,
    involute,
    involute_angle,
    shift_sum,
    working_pressure_angle,
)

ALPHA = math.radians(20.0)


def test_values_of_tables():
    """inv 20 = 0.014904, inv 25 = 0.029975 (any table of involutes)."""
    assert involute(ALPHA) == pytest.approx(0.014904384, abs=5e-10)
    assert involute(math.radians(25.0)) == pytest.approx(0.029975, abs=5e-7)


def test_the_inverse_from_2_to_85_degrees():
    angles = np.radians(np.linspace(2.0, 85.0, 2000))
    assert np.allclose(involute_angle(involute(angles)), angles, rtol=1e-11, atol=0)
    steep = angles[angles > 0.2]
    assert np.allclose(involute_angle(involute(steep)), steep, rtol=2e-13, atol=0)
    assert involute_angle(0.0) == pytest.approx(0.0, abs=1e-50)
    assert np.isnan(involute_angle(np.array([-0.01]))).all()


def test_the_inverse_has_the_derivative_of_the_inverse():
    """d alpha/d inv = 1/tan(alpha)^2, through the traced steps."""
    x = ca.SX.sym("x")
    with legacy_numpy():
        y = involute_angle(x)
    slope = ca.Function("slope", [x], [ca.gradient(y, x)])
    for degrees in (5.0, 20.0, 45.0, 80.0):
        angle = math.radians(degrees)
        assert float(slope(involute(angle))) == pytest.approx(math.tan(angle) ** -2, rel=1e-9)


def test_both_ways_between_shifts_and_centre_distance():
    """z 18/40, x +0.3/-0.1: alpha_w 21.0270 degrees (digest of the profile modification paper)."""
    angle = working_pressure_angle(0.2, 58, ALPHA, ALPHA)
    assert math.degrees(angle) == pytest.approx(21.0270, abs=5e-5)
    assert shift_sum(angle, 58, ALPHA, ALPHA) == pytest.approx(0.2, rel=1e-12)
    distance = 0.5 * 58 * 4.0 * math.cos(ALPHA) / math.cos(angle)
    assert distance == pytest.approx(116.7806, abs=5e-5)
    assert angle_at_distance(0.5 * 58 * 4.0, ALPHA, distance) == pytest.approx(angle, rel=1e-12)


def test_shifts_too_small_for_any_centre_distance():
    least = -58 * involute(ALPHA) / (2 * math.tan(ALPHA))
    assert working_pressure_angle(least + 1e-6, 58, ALPHA, ALPHA) > 0
    assert np.isnan(working_pressure_angle(least - 1e-6, 58, ALPHA, ALPHA))
    assert np.isnan(angle_at_distance(100.0, ALPHA, 93.0))
