"""The fillet against a rack rolled point by point, printed form diameters and undercut teeth."""

import math

import numpy as np
import pytest

from gearopt.physics.gears import Gear, GearPair, Rack, reference_diameter
from gearopt.physics.geometry.fillet import (
    fillet_end,
    fillet_point,
    form_diameter,
    half_angle,
    is_undercut,
    largest_tip_radius,
    least_fillet_radius,
    profile,
    tool_tip,
)

# Digest of the profile modification paper, section 3: m, z, x, form radius R_j, half angle theta_f
PAIRS = [
    (3.0, 25, 0.0, 35.47097391076563, 0.1205151856599913),
    (3.0, 50, 0.0, 72.47031991045625, 0.06025759282999565),
    (4.0, 18, 0.3, 34.07967719987271, None),
    (4.0, 40, -0.1, 76.56051519517268, None),
]
# Section 10: z, R_j/r_b of undercut teeth of module 3
UNDERCUT = [(8, 1.0128), (9, 1.0086), (10, 1.0058), (12, 1.0023), (14, 1.0007)]


def gear(module, teeth, shift=0.0, helix=0.0, rack=None):
    d = reference_diameter(module, teeth, helix)
    return Gear(module, teeth, d, 10.0 * module, helix, rack or Rack(), shift)


@pytest.mark.parametrize(("m", "z", "x", "form", "theta"), PAIRS)
def test_form_radii_of_the_reference_pairs(m, z, x, form, theta):
    made = gear(m, z, x)
    assert form_diameter(made) / 2 == pytest.approx(form, rel=1e-14)
    root = fillet_point(made, math.pi / 2)
    assert root.radius == pytest.approx(made.root_diameter / 2, rel=1e-14)
    if theta:
        assert root.half_angle == pytest.approx(theta, rel=1e-13)


def test_form_diameters_of_a_printed_report():
    """KISSsoft 03/2017, NREL 5 MW, helical 24/95: d_Ff 328.991 and 1341.487."""
    pair = GearPair.of_teeth(14.0, 24, 95, 360.0, math.radians(10.0), profile_shifts=(0.48, 0.6691))
    assert form_diameter(pair.pinion) == pytest.approx(328.991, abs=6e-4)
    assert form_diameter(pair.wheel) == pytest.approx(1341.487, abs=6e-4)


@pytest.mark.parametrize(("z", "ratio"), UNDERCUT)
def test_form_radii_of_undercut_teeth(z, ratio):
    made = gear(3.0, z)
    assert is_undercut(made)
    assert form_diameter(made) / made.base_diameter == pytest.approx(ratio, abs=6e-5)
    point = fillet_point(made, fillet_end(made))
    assert point.half_angle == pytest.approx(half_angle(made, point.radius), abs=1e-12)


def test_undercut_begins_where_the_tool_reaches_the_tangent_point():
    """z = 2 (h_fP - rho_fP (1 - sin alpha))/sin(alpha)^2 without shift: 17.09; x moves it to 0."""
    rack = Rack()
    sine = math.sin(rack.pressure_angle)
    limit = 2 * (rack.dedendum - rack.tip_radius * (1 - sine)) / sine**2
    assert not is_undercut(gear(2.0, limit + 1e-6))
    assert is_undercut(gear(2.0, limit - 1e-6))
    assert not is_undercut(gear(2.0, 10, (limit - 10) / limit + 1e-6))
    for made in (gear(2.0, limit - 1e-3), gear(2.0, limit + 1e-3)):
        assert form_diameter(made) / made.base_diameter == pytest.approx(1.0, abs=1e-6)


def rolled(made, samples, steps):
    """Return the least half angle of a tooth at some radii, as a rolled rack leaves it.

    The transverse rack's outline, straight flank and tip ellipse, is moved past the gear in small
    steps; in the gear's frame the material that it covers is cut away.
    """
    tip, helix = tool_tip(made), made.helix_angle
    alpha = made.transverse_pressure_angle
    theta = np.linspace(made.rack.pressure_angle, math.pi / 2, samples)
    across = (tip.half_width + tip.radius * np.cos(theta)) / math.cos(helix)
    below = tip.depth + tip.radius * np.sin(theta)
    flank = np.linspace(-2.5 * made.normal_module, below[0], samples)
    beside = across[0] + (below[0] - flank) * math.tan(alpha)
    across, below = np.r_[beside, across], np.r_[flank, below]
    radius = made.reference_diameter / 2
    roll = np.linspace(-1.2, 1.2, steps)[:, None] * 4.0 * made.normal_module / radius
    x, y = across + radius * roll, np.broadcast_to(radius - below, (steps, len(below)))
    angle = np.arctan2(x, y) - roll  # from the middle of the space
    return np.hypot(x, y).ravel(), (math.pi / made.teeth - angle).ravel()


@pytest.mark.parametrize(
    ("z", "x", "helix", "rack"),
    [
        (25, 0.0, 0.0, Rack()),
        (17, 0.4, 0.4, Rack(tip_radius=0.25)),
        (9, 0.0, 0.0, Rack()),  # undercut
        (30, 0.1, 0.2, Rack(dedendum=1.4, tip_radius=0.25, protuberance=0.03)),
    ],
)
def test_the_fillet_is_the_envelope_of_a_rolled_rack(z, x, helix, rack):
    """What the rack leaves of a tooth at a radius is as thick as the fillet is there."""
    made = gear(3.0, z, x, helix, rack)
    at, half = rolled(made, 400, 2001)
    end = float(fillet_end(made))
    theta = np.linspace(end + 0.02, 1.25, 12)  # near the root circle radii say little
    point = fillet_point(made, theta)
    for radius, expected in zip(point.radius, point.half_angle, strict=True):
        near = np.abs(at - radius) < 0.004
        assert half[near].min() == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("helix", [0.0, 0.5])
def test_slopes_are_those_of_the_curve(helix):
    made = gear(2.0, 13, 0.2, helix)
    for theta in (0.5, 0.9, 1.3):
        before, after = (fillet_point(made, theta + s * 1e-6) for s in (1, -1))
        slope = math.atan2(before.x - after.x, after.y - before.y)
        assert slope == pytest.approx(fillet_point(made, theta).slope, abs=1e-8)


def test_fillet_and_involute_meet_with_one_tangent():
    made = gear(2.0, 30, 0.1, 0.3)
    point = fillet_point(made, fillet_end(made))
    assert point.half_angle == pytest.approx(half_angle(made, point.radius), abs=1e-13)
    at = [point.radius * (1 + s * 1e-6) for s in (0.0, 1.0)]
    x, y = ([r * f(half_angle(made, r)) for r in at] for f in (math.sin, math.cos))
    assert math.atan2(x[0] - x[1], y[1] - y[0]) == pytest.approx(point.slope, abs=1e-5)


def test_the_least_radius_is_the_curvature_at_the_root():
    made = gear(3.0, 25)
    points = [fillet_point(made, math.pi / 2 - k * 1e-3) for k in (1, 0)]
    (x1, y1), (x0, y0) = ((p.x, p.y) for p in points)
    turned = points[1].slope - points[0].slope
    radius = math.hypot(x1 - x0, y1 - y0) / abs(turned)
    assert least_fillet_radius(made) == pytest.approx(radius, rel=2e-3)


def test_protuberance_lifts_the_form_circle():
    """By a tool 0.02 m_n thicker at its tip the fillet ends further out, and below the tip."""
    plain, thick = (gear(3.0, 25, rack=Rack(tip_radius=0.3, protuberance=p)) for p in (0.0, 0.02))
    assert form_diameter(plain) < form_diameter(thick) < thick.tip_diameter - 6.0
    point = fillet_point(thick, fillet_end(thick))
    assert point.half_angle == pytest.approx(half_angle(thick, point.radius), abs=1e-12)


def test_a_full_round_leaves_no_tip_land():
    rack = Rack(tip_radius=largest_tip_radius(math.radians(20.0), 1.25))
    assert tool_tip(gear(1.0, 30, rack=rack)).half_width == pytest.approx(0.0, abs=1e-15)
    assert largest_tip_radius(math.radians(20.0), 1.25) == pytest.approx(0.4719, abs=5e-5)


def test_a_profile_runs_from_root_to_tip():
    made = gear(3.0, 25)
    x, y = profile(made, 20, 30)
    radius = np.hypot(x, y)
    assert len(x) == 49 and (np.diff(radius) > 0).all()
    assert (radius[0], radius[-1]) == pytest.approx((33.75, 40.5))
    assert 2 * radius[-1] * math.atan2(x[-1], y[-1]) == pytest.approx(3 * 0.7198193893, rel=1e-9)
