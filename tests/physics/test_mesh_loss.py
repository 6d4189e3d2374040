"""The loss factor against sliding integrated over the path of contact; friction by hand."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.mesh_loss import (
    FRICTION_ERROR,
    friction_coefficient,
    mesh_efficiency,
    tooth_loss_factor,
)


@pytest.mark.parametrize(
    ("teeth", "shifts"), [((20, 20), (0, 0)), ((25, 50), (0, 0)), ((18, 61), (0.4, 0.1))]
)
def test_the_loss_factor_is_mean_sliding_of_a_shared_load(teeth, shifts):
    """Mean over a base pitch of the shares times |sliding|, over the speed of the base circle."""
    pair = GearPair.of_teeth(3.0, *teeth, 30.0, profile_shifts=shifts)
    path = contact_path(pair)
    assert 1.0 < path.transverse_ratio < 2.0
    phases = (np.arange(200_000) + 0.5) / 200_000 * path.base_pitch + path.start
    lost = np.zeros_like(phases)
    loaded = np.zeros_like(phases)
    for k in (0, 1):
        at = phases + k * path.base_pitch
        inside = at < path.end
        lost += inside * np.abs((1.0 + 1.0 / pair.ratio) * at)
        loaded += inside
    mean = float(np.mean(lost / loaded)) / (pair.pinion.base_diameter / 2)
    assert tooth_loss_factor(pair) == pytest.approx(mean, rel=1e-5)


def test_helical_gears_slide_alike_at_a_higher_normal_force():
    """As the spur gear of their transverse section, but 1/cos(beta_b) of its normal force."""
    helix = 0.3
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0, helix)
    assert tooth_loss_factor(pair) < tooth_loss_factor(GearPair.of_teeth(3.0, 25, 50, 30.0))
    cosine = math.cos(helix)
    rack = Rack(float(pair.pinion.transverse_pressure_angle), cosine, 1.25 * cosine)
    spur = GearPair.of_teeth(3.0 / cosine, 25, 50, 30.0, rack=rack)
    base = math.asin(math.sin(helix) * math.cos(math.radians(20)))
    expected = tooth_loss_factor(spur) / math.cos(base)
    assert tooth_loss_factor(pair) == pytest.approx(expected, rel=1e-12)
    # mu goes with curvature^-0.2, normal radii being 1/cos(beta_b) of transverse ones
    helical, straight = (friction_coefficient(p, 5e3, 1e4, 20.0, 4e-4) for p in (pair, spur))
    assert helical == pytest.approx(straight * math.cos(base) ** 0.2, rel=1e-12)


def test_an_oil_of_less_friction_and_the_error_of_the_model():
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
    plain, polyglycol = (
        friction_coefficient(pair, 5e3, 1e4, 20.0, 4e-4, oil) for oil in (1.0, 0.585)
    )
    assert polyglycol == pytest.approx(0.585 * plain, rel=1e-12)
    for own, formula in ((0.846, 1.0), (0.65, 0.8), (0.585, 0.75)):  # X_L by measured losses
        assert abs(own / formula - 1.0) < FRICTION_ERROR


def test_friction_by_hand():
    """Spur 25/50, m 3, b 30: W_t 5333 N, v 10 m/s, 20 mPa s, R_a 0.4 um."""
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
    alpha = math.radians(20)
    line = 5333.0 / math.cos(alpha) / 30.0
    curvature = 37.5 * math.sin(alpha) * 2 / 3
    expected = (line / (20.0 * math.sin(alpha) * curvature)) ** 0.2 * 20.0**-0.05 * 0.4**0.25
    found = friction_coefficient(pair, 5333.0, 1e4, 20.0, 0.4e-3)
    assert found == pytest.approx(0.048 * expected, rel=1e-12)
    assert 0.03 < found < 0.06  # what measurements of steel gears in oil give
    assert 0.985 < mesh_efficiency(tooth_loss_factor(pair), found) < 0.998


def test_traced():
    point = np.array([3.0, 25.0, 0.1])
    x = ca.SX.sym("x", 3)

    def law(v):
        pair = GearPair.of_teeth(v[0], v[1], 50.0, 30.0, 0.2, profile_shifts=(v[2], 0.0))
        return mesh_efficiency(
            tooth_loss_factor(pair), friction_coefficient(pair, 5e3, 1e4, 20.0, 4e-4)
        )

    with legacy_numpy():
        value = law(ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    assert law(point) == pytest.approx(traced[0], rel=1e-13)
    for k in range(3):
        step = 1e-5 * point[k]
        ends = [law(point + s * step * np.eye(3)[k]) for s in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5)
