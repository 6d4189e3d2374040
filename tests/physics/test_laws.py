"""Gear laws against numbers of the source paper's tables and against identities."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import k_factor, torque, unit_load

BETA = math.radians(25.0)
# Chong and Lee, Table 2 (loads recomputed): m, z1, z2, d1, a, b, K, U; input 7.5 kW at 1450 rpm
PROCESS_ONE = [
    (2, 25, 124, 55.17, 164.4, 33.1, 1.178, 27.05),
    (3, 25, 109, 82.75, 221.76, 62.1, 1.416, 31.78),
]


def test_table_2_process_one():
    load = torque(7.5e6, 1450 * math.pi / 30)
    assert load == pytest.approx(49392.9, abs=0.05)
    total = 0.0
    for m, z1, z2, d1, a, b, k, u_load in PROCESS_ONE:
        pair = GearPair.of_teeth(m, z1, z2, b, BETA)
        d, u = pair.pinion.reference_diameter, pair.ratio
        assert d == pytest.approx(d1, abs=0.006)
        assert pair.centre_distance == pytest.approx(a, abs=0.03)
        assert k_factor(load, d, b, u) == pytest.approx(k, abs=6e-4)
        assert unit_load(load, d, b, m) == pytest.approx(u_load, abs=0.006)
        total += pair.volume
        load *= u
    assert total == pytest.approx(8708993, abs=0.6)


def test_volume_at_the_k_limit_depends_on_torque_and_ratio_alone():
    """V = pi T/(2 K) (u + 1)(u^2 + 1)/u whatever the diameter (Chong and Lee, eqs. 2 and 4)."""
    load, limit, u = 49392.9, 2.07, 4.7
    for d in (20.0, 50.0, 400.0):
        b = k_factor(load, d, 1.0, u) / limit
        expected = math.pi * load / (2 * limit) * (u + 1) * (u * u + 1) / u
        pair = GearPair.of_diameter(1.0, d, d, u, b)
        assert pair.volume == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    "law",
    [
        lambda a, b, c, d: k_factor(a, b, c, d),
        lambda a, b, c, d: unit_load(a, b, c, d),
        lambda a, b, c, d: torque(a, b),
    ],
)
def test_traced_equals_batch_and_derivatives_central_differences(law):
    point = np.array([49392.9, 46.3, 27.8, 5.4])
    x = ca.SX.sym("x", 4)
    with legacy_numpy():
        value = law(*ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    batch = law(*np.tile(point, (3, 1)).T)
    assert np.allclose(batch, traced, rtol=2e-15, atol=0)
    for k in range(4):
        step = 1e-5 * point[k]
        ends = [law(*(point + s * step * np.eye(4)[k])) for s in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-8, abs=1e-9)
