"""Laws of tooth and mesh: traced = batch, derivatives = central differences."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.gears import Gear, GearPair, Rack
from gearopt.physics.geometry.contact import (
    active_root_diameters,
    contact_path,
    diameters_at,
    specific_sliding,
)
from gearopt.physics.geometry.fillet import (
    fillet_point,
    least_fillet_radius,
    undercut_depth,
)
from gearopt.physics.geometry.tooth import (
    circumferential_backlash,
    normal_backlash,
    span,
    span_diameter,
    tip_clearances,
    tip_thickness,
    virtual_teeth,
)


def gear(v, teeth=23.0):
    diameter = v[0] * teeth * v[1] / np.cos(0.3 * v[2])
    return Gear(v[0], teeth * v[1], diameter, 30.0, 0.3 * v[2], Rack(), 0.2 * v[3], 0.0, -0.01)


def pair(v, distance=None):
    shifts = 0.2 * v[3], 0.1 * v[1]
    return GearPair.of_teeth(v[0], 23.0 * v[1], 50.0, 30.0, 0.3 * v[2], Rack(), shifts, distance)


LAWS = [
    lambda v: gear(v).generating_shift,
    lambda v: fillet_point(gear(v), 0.8 * v[3]).x,
    lambda v: fillet_point(gear(v), 0.8 * v[3]).slope,
    lambda v: least_fillet_radius(gear(v)),
    lambda v: undercut_depth(gear(v)),
    lambda v: tip_thickness(gear(v)),
    lambda v: span(gear(v), 4),
    lambda v: span_diameter(gear(v), 4),
    lambda v: virtual_teeth(gear(v)),
    lambda v: pair(v).working_angle,
    lambda v: pair(v).centre_distance,
    lambda v: pair(v).transverse_contact_ratio,
    lambda v: contact_path(pair(v)).highest_single,
    lambda v: active_root_diameters(pair(v))[0],
    lambda v: diameters_at(pair(v), contact_path(pair(v)), 0.5)[1],
    lambda v: specific_sliding(contact_path(pair(v)), pair(v).ratio, 1.0)[0],
    lambda v: circumferential_backlash(pair(v, 90.0 * v[0])),
    lambda v: normal_backlash(pair(v, 90.0 * v[0])),
    lambda v: tip_clearances(pair(v))[1],
]


@pytest.mark.parametrize("law", LAWS)
def test_traced_equals_batch_and_derivatives_central_differences(law):
    point = np.array([1.1, 1.05, 0.9, 1.2])
    x = ca.SX.sym("x", 4)
    with legacy_numpy():
        value = law(ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    assert np.allclose(law(np.tile(point, (3, 1)).T), traced, rtol=1e-12, atol=1e-13)
    assert math.isfinite(float(traced[0]))
    for k in range(4):
        ends = [law(point + s * 1e-5 * np.eye(4)[k]) for s in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-6, abs=1e-7)
