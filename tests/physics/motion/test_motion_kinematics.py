"""Deformation of a mesh with moving axes, against flanks constructed point by point."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.motion.kinematics import KINEMATICS, Rest, exact, growth, paper, tangent

REST = Rest(140.0, math.radians(20.0))
MOVES = ((2.0, 1.0, 2e-3, -1e-3), (6.0, -3.0, 5e-3, 1e-3), (0.1, 0.2, -1e-4, 3e-4))


def involute(base, centre, start, way, unwound):
    """Point of an involute that leaves its base circle at the angle `start`."""
    angle = start + way * unwound / base
    normal = np.array([math.cos(angle), math.sin(angle)])
    along = way * np.array([normal[1], -normal[0]])
    return centre + base * normal + unwound * along


@pytest.mark.parametrize("move", MOVES)
def test_exact_is_the_gap_between_two_flanks(move):
    u, v, turn1, turn2 = move
    r1, r2, alpha = 60.0, 80.0, REST.pressure_angle
    first = -alpha + math.tan(alpha)  # where the flanks begin that meet at the pitch point
    second = math.pi - alpha + math.tan(alpha)
    centre = np.array([140.0 / math.cos(alpha) + u, v])
    distance, phi = np.hypot(*centre), math.atan2(v, centre[0])
    normal = phi - math.acos(140.0 / distance)
    flank1 = involute(r1, np.zeros(2), first + turn1, -1, -r1 * (normal - first - turn1))
    flank2 = involute(r2, centre, second + turn2, -1, -r2 * (normal + math.pi - second - turn2))
    along = np.array([-math.sin(normal), math.cos(normal)])
    across = np.array([math.cos(normal), math.sin(normal)])
    assert abs((flank2 - flank1) @ across) < 1e-12  # both lie on the common tangent
    gap = exact(REST, u, v).approach - r1 * turn1 - r2 * turn2
    assert gap == pytest.approx((flank2 - flank1) @ along, abs=5e-14)


@pytest.mark.parametrize("eps", [1e-3, -2e-2])
def test_a_turn_of_the_whole_pair_changes_the_papers_deformation_and_not_the_exact_one(eps):
    place = np.array([REST.centre_distance + 2.0, 1.0])
    cosine, sine = math.cos(eps), math.sin(eps)
    turned = np.array([[cosine, -sine], [sine, cosine]]) @ place
    turned[0] -= REST.centre_distance
    for law, lost in ((exact, 0.0), (paper, -140.0 * eps)):
        change = law(REST, *turned).approach - 140.0 * eps - law(REST, 2.0, 1.0).approach
        assert change == pytest.approx(lost, abs=5e-14)


@pytest.mark.parametrize("kind", list(KINEMATICS))
def test_gradient_and_curvature_are_differences(kind):
    law, h = KINEMATICS[kind], 1e-3
    for u, v in np.random.default_rng(0).uniform((-1.0, -4.0), (8.0, 4.0), (6, 2)):
        found = law(REST, u, v)
        du = [law(REST, u + s * h, v) for s in (1, -1)]
        dv = [law(REST, u, v + s * h) for s in (1, -1)]
        for pair, g in ((du, found.gradient[0]), (dv, found.gradient[1])):
            assert (pair[0].approach - pair[1].approach) / (2 * h) == pytest.approx(g, abs=1e-8)
        suu = (du[0].gradient[0] - du[1].gradient[0]) / (2 * h)
        suv = (du[0].gradient[1] - du[1].gradient[1]) / (2 * h)
        svv = (dv[0].gradient[1] - dv[1].gradient[1]) / (2 * h)
        assert found.curvature == pytest.approx((suu, suv, svv), abs=1e-8)
    assert np.hypot(*exact(REST, 3.0, 1.0).gradient) == pytest.approx(1.0, abs=1e-15)


def test_tangent_is_exact_to_first_order_and_along_the_line_of_action():
    sine, cosine = math.sin(REST.pressure_angle), math.cos(REST.pressure_angle)
    along = exact(REST, 3.0 * sine, 3.0 * cosine).approach
    assert along == pytest.approx(3.0, abs=1e-13)
    assert tangent(REST, 3.0 * sine, 3.0 * cosine).approach == pytest.approx(3.0, abs=1e-15)
    across = [exact(REST, h * cosine, -h * sine).approach for h in (0.1, 0.05)]
    assert across[0] / across[1] == pytest.approx(4.0, rel=1e-2)  # second order


@pytest.mark.parametrize("kind", list(KINEMATICS))
def test_backlash_grows_with_the_centre_distance(kind):
    found, h = growth(kind, REST, 1.2, 0.4), 1e-3
    ahead = growth(kind, REST, 1.2 + h, 0.4).length, growth(kind, REST, 1.2, 0.4 + h).length
    back = growth(kind, REST, 1.2 - h, 0.4).length, growth(kind, REST, 1.2, 0.4 - h).length
    slopes = (np.array(ahead) - np.array(back)) / (2 * h)
    assert slopes == pytest.approx(np.array(found.gradient), abs=1e-8)
    if kind == "exact":  # 2 R (inv(alpha') - inv(alpha))
        wide = math.acos(140.0 / math.hypot(REST.centre_distance + 1.2, 0.4))
        inv = math.tan(wide) - wide - math.tan(REST.pressure_angle) + REST.pressure_angle
        assert found.length == pytest.approx(280.0 * inv, rel=1e-11)


def test_traced_is_evaluated():
    with legacy_numpy():
        u, v = ca.SX.sym("u"), ca.SX.sym("v")
        for law in KINEMATICS.values():
            function = ca.Function("g", [u, v], [ca.SX(law(REST, u, v).approach)])
            assert float(function(1.2, -0.7)) == pytest.approx(law(REST, 1.2, -0.7).approach)
