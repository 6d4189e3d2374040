"""Tips, roots and contact ratios against a printed report, a textbook and the geometry itself."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.trace import legacy_numpy
from gearopt.physics.geometry import (
    centre_distance,
    cylinder_volume,
    gear_volume,
    overlap_ratio,
    reference_diameter,
    root_diameter,
    standard_contact_ratio,
    teeth_without_undercut,
    tip_diameter,
    transverse_contact_ratio,
    transverse_pressure_angle,
)
from gearopt.physics.loads import pitch_line_velocity

ALPHA = math.radians(20.0)
# KISSsoft report of 03/2017, high-speed pair of the NREL 5 MW gearbox (gfsReboucas/Drivetrain,
# @NREL_5MW/stage_03.rtf): z 24/95, m_n 14, beta 10, x 0.48/0.6691, k m_n -0.938, a 861, b 360.
# Printed: d, d_b, d_a, d_f, alpha_t, alpha_wt, g_alpha, eps_alpha, eps_beta, v at 1165.9 rpm.
MODULE, HELIX, SHIFTS, SHORTER = 14.0, math.radians(10.0), (0.48, 0.6691), -0.938
REFERENCE, BASE = (341.183, 1350.517), (320.026, 1266.77)
TIP, ROOT = (380.747, 1395.376), (319.623, 1334.252)


def test_diameters_of_a_printed_report():
    """Its gears are shifted and shortened, which is taken away first."""
    for z, x, d, d_b, d_a, d_f in zip((24, 95), SHIFTS, REFERENCE, BASE, TIP, ROOT, strict=True):
        found = reference_diameter(MODULE, z, HELIX)
        assert found == pytest.approx(d, abs=6e-4)
        assert found * math.cos(transverse_pressure_angle(ALPHA, HELIX)) == pytest.approx(
            d_b, abs=6e-4
        )
        shift = 2 * x * MODULE
        assert tip_diameter(found, MODULE) == pytest.approx(d_a - shift - 2 * SHORTER, abs=2e-3)
        assert root_diameter(found, MODULE) == pytest.approx(d_f - shift, abs=2e-3)
    assert math.degrees(transverse_pressure_angle(ALPHA, HELIX)) == pytest.approx(20.284, abs=6e-4)


def test_contact_ratios_of_a_printed_report():
    pitch = math.pi * MODULE / math.cos(HELIX) * math.cos(math.radians(20.284))
    found = transverse_contact_ratio(TIP, BASE, 861.0, math.radians(22.856), pitch)
    assert found == pytest.approx(1.463, abs=6e-4)
    assert found * pitch == pytest.approx(61.276, abs=0.01)  # alpha_wt is printed to 1e-3 degrees
    assert overlap_ratio(360.0, MODULE, HELIX) == pytest.approx(1.421, abs=6e-4)
    speed = 1165.9 * math.pi / 30.0
    assert 1e-3 * pitch_line_velocity(speed, REFERENCE[0]) == pytest.approx(20.83, abs=6e-3)


def test_a_textbook_pair_without_profile_shift():
    """Shigley, example 14-5: 17/52 teeth, P_n 10, phi_n 20, psi 30: Z 0.4507 in, m_N 0.6895."""
    module, helix, u = 0.1, math.radians(30.0), 52 / 17  # in inches
    pitch = math.pi * module / math.cos(helix) * math.cos(transverse_pressure_angle(ALPHA, helix))
    line = standard_contact_ratio(module, 17, u, ALPHA, helix) * pitch
    assert line == pytest.approx(0.4507, rel=2e-3)  # the book rounds radii and angles
    assert math.pi * module * math.cos(ALPHA) / (0.95 * line) == pytest.approx(0.6895, rel=2e-3)


@pytest.mark.parametrize(("z1", "z2", "helix"), [(18, 18, 0), (21, 115, 25), (22.4, 95.5, 12)])
def test_the_path_of_contact_lies_between_the_tip_circles(z1, z2, helix):
    """Points of the line of action through the pitch point that lie inside both tip circles."""
    m, beta = 2.0, math.radians(helix)
    angle = transverse_pressure_angle(ALPHA, beta)
    d1, d2 = (reference_diameter(m, z, beta) for z in (z1, z2))
    steps = np.linspace(-6 * m, 6 * m, 2_000_001)
    x, y = steps * math.sin(angle), steps * math.cos(angle)
    inside = (np.hypot(x + d1 / 2, y) < tip_diameter(d1, m) / 2) & (
        np.hypot(x - d2 / 2, y) < tip_diameter(d2, m) / 2
    )
    pitch = math.pi * d1 * math.cos(angle) / z1
    expected = inside.sum() * (steps[1] - steps[0]) / pitch
    assert standard_contact_ratio(m, z1, z2 / z1, ALPHA, beta) == pytest.approx(expected, abs=2e-5)


def test_contact_ratio_of_two_racks_is_the_limit():
    """eps_alpha -> 4 h_aP/(m_n pi sin(2 alpha)) for many teeth: 1.981 at 20 degrees."""
    expected = 4.0 / (math.pi * math.sin(2.0 * ALPHA))
    assert standard_contact_ratio(1.0, 1e7, 1.0, ALPHA, 0.0) == pytest.approx(expected, rel=1e-4)


def test_spur_gears_do_not_overlap_and_hands_do_not_count():
    assert overlap_ratio(40.0, 2.0, 0.0) == 0.0
    assert overlap_ratio(40.0, 2.0, -0.3) == overlap_ratio(40.0, 2.0, 0.3) > 0.0


def test_teeth_without_undercut():
    """17.10 spur teeth of 20 degrees; there a rack's tip line meets the base circle."""
    assert teeth_without_undercut(ALPHA, 0.0) == pytest.approx(17.097, abs=5e-4)
    for helix in (0.0, 0.4):
        z = teeth_without_undercut(ALPHA, helix)
        angle = transverse_pressure_angle(ALPHA, helix)
        reach = reference_diameter(1.0, z, helix) / 2 * math.sin(angle)  # to the base circle
        assert reach * math.sin(angle) == pytest.approx(1.0, rel=1e-12)  # the rack's tip line


def test_two_cylinders_make_a_pair():
    both = cylinder_volume(46.3, 27.8) + cylinder_volume(46.3 * 5.4, 27.8)
    assert both == pytest.approx(gear_volume(46.3, 27.8, 5.4), rel=1e-15)


@pytest.mark.parametrize(
    "law",
    [
        lambda a, b, c, d: tip_diameter(a, b),
        lambda a, b, c, d: root_diameter(a, b),
        lambda a, b, c, d: transverse_pressure_angle(d, 0.4),
        lambda a, b, c, d: teeth_without_undercut(d, 0.4),
        lambda a, b, c, d: standard_contact_ratio(b, a, c, d, 0.4),
        lambda a, b, c, d: transverse_contact_ratio((a + 2, 4 * a), (a, 3 * a), 2 * a, d, b),
        lambda a, b, c, d: overlap_ratio(a, b, 0.4),
        lambda a, b, c, d: cylinder_volume(a, b),
        lambda a, b, c, d: pitch_line_velocity(a, b),
        lambda a, b, c, d: centre_distance(a, c),
    ],
)
def test_traced_equals_batch_and_derivatives_central_differences(law):
    point = np.array([46.3, 2.3, 5.4, 0.37])
    x = ca.SX.sym("x", 4)
    with legacy_numpy():
        value = law(*ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    batch = law(*np.tile(point, (3, 1)).T)
    assert np.allclose(batch, traced, rtol=1e-13, atol=0)
    for k in range(4):
        step = 1e-5 * point[k]
        ends = [law(*(point + s * step * np.eye(4)[k])) for s in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-7, abs=1e-8)
