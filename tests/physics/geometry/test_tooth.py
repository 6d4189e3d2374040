"""Thickness, span, balls and backlash against brute force on involutes and published values."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearopt.physics.backlash import thickness_backlash
from gearopt.physics.gears import Gear, GearPair, Rack, reference_diameter
from gearopt.physics.geometry.tooth import (
    ball_contact_diameter,
    circumferential_backlash,
    normal_backlash,
    normal_thickness,
    over_balls,
    span,
    span_diameter,
    span_teeth,
    tip_clearances,
    tip_thickness,
    transverse_thickness,
)


def gear(module, teeth, shift=0.0, helix=0.0, allowance=0.0):
    d = reference_diameter(module, teeth, helix)
    return Gear(module, teeth, d, 20.0, helix, Rack(), shift, thickness_allowance=allowance)


# Digest of the profile modification paper, section 10: z, x, s_a/m
@pytest.mark.parametrize(
    ("z", "x", "thick"),
    [(12, 0.5, 0.2851), (12, 0.7, 0.1133), (10, 0.8, -0.1092), (25, 1.2, 0.1556)],
)
def test_thin_and_pointed_tips(z, x, thick):
    assert tip_thickness(gear(3.0, z, x)) / 3.0 == pytest.approx(thick, abs=6e-5)


def test_thickness_at_the_reference_circle():
    """s_n = m_n (pi/2 + 2 x tan(alpha_n)) + A_sn, measured normal to the helix."""
    made = gear(3.0, 30, 0.2, 0.35, -0.05)
    expected = 3.0 * (math.pi / 2 + 0.4 * math.tan(math.radians(20))) - 0.05
    assert normal_thickness(made, made.reference_diameter) == pytest.approx(expected, rel=1e-14)
    transverse = transverse_thickness(made, made.reference_diameter)
    assert transverse == pytest.approx(expected / math.cos(0.35), rel=1e-14)


def flank(module, z, x, allowance, side, radius):
    """Return points of an involute of a spur gear, unwound from its base circle, tooth on +y."""
    alpha = math.radians(20)
    thick = module * (math.pi / 2 + 2 * x * math.tan(alpha)) + allowance
    base = module * z / 2 * math.cos(alpha)
    t = np.sqrt((radius / base) ** 2 - 1)
    angle = side * (thick / (module * z) + math.tan(alpha) - alpha - (t - np.arctan(t)))
    return np.array([radius * np.sin(angle), radius * np.cos(angle)])


@pytest.mark.parametrize(("z", "x", "k"), [(20, 0.0, 3), (33, 0.4, 5), (60, -0.3, 7)])
def test_span_is_the_least_distance_of_parallel_planes(z, x, k):
    """Between parallel lines that touch outer flanks of k teeth of a spur gear, by sampling."""
    made = gear(2.0, z, x, allowance=-0.04)
    radius = np.linspace(made.base_diameter / 2 + 1e-6, made.tip_diameter / 2, 20001)
    left = flank(2.0, z, x, -0.04, -1, radius)
    middle = math.pi * (k - 1) / z  # direction of the middle of the k teeth
    along = np.array([math.cos(middle), -math.sin(middle)])
    half = float(np.max(-along @ left))  # farthest reach of the left flank from the middle plane
    assert span(made, k) == pytest.approx(2 * half, rel=1e-7)
    at = radius[np.argmax(-along @ left)]
    assert span_diameter(made, k) == pytest.approx(2 * at, rel=1e-3)


def test_recommended_spans_of_tables():
    """20 degrees, x = 0: 3 teeth at z 20, 7.6604 m; 5 at z 40, 13.8448 (any table of spans)."""
    for z, k, value in ((20, 3, 7.6604), (40, 5, 13.8448)):
        assert span_teeth(gear(1.0, z)) == k
        assert span(gear(1.0, z), k) == pytest.approx(value, abs=6e-5)


@pytest.mark.parametrize(("z", "x"), [(20, 0.0), (21, 0.3), (45, -0.2)])
def test_dimension_over_balls_by_touching_circles(z, x):
    """A circle on the centre line of a space that touches the involute: found by its distance."""
    made, ball = gear(2.0, z, x, allowance=-0.03), 3.6
    radius = np.linspace(made.base_diameter / 2 + 1e-9, made.tip_diameter / 2 + 3.0, 40001)
    right = flank(2.0, z, x, -0.03, 1, radius)
    space = np.array([math.sin(math.pi / z), math.cos(math.pi / z)])

    def gap(centre):
        return float(np.min(np.hypot(*(right - (centre * space)[:, None])))) - ball / 2

    centre = brentq(gap, made.base_diameter / 2, made.tip_diameter / 2 + 3.0, xtol=1e-12)
    opposite = 2 * centre * (math.cos(math.pi / (2 * z)) if z % 2 else 1.0)
    assert over_balls(made, ball) == pytest.approx(opposite + ball, rel=1e-8)
    touched = radius[np.argmin(np.hypot(*(right - (centre * space)[:, None])))]
    assert ball_contact_diameter(made, ball) == pytest.approx(2 * touched, rel=1e-4)


def test_balls_and_spans_of_helical_gears_are_those_of_their_transverse_section():
    """Of a pin of diameter D/cos(beta_b) in the transverse plane; spans are by cos(beta_b)."""
    helix = 0.4
    made = gear(2.0, 24, 0.1, helix)
    base = math.asin(math.sin(helix) * math.cos(math.radians(20)))
    alpha_t = float(made.transverse_pressure_angle)
    shift_t = 0.1 * math.cos(helix)
    rack = Rack(alpha_t, math.cos(helix), 1.25 * math.cos(helix))
    spur = Gear(2.0 / math.cos(helix), 24, made.reference_diameter, 20.0, 0.0, rack, shift_t)
    assert span(made, 4) == pytest.approx(span(spur, 4) * math.cos(base), rel=1e-13)
    centre = over_balls(made, 3.6) - 3.6
    wide = 3.6 / math.cos(base)
    assert centre == pytest.approx(over_balls(spur, wide) - wide, rel=1e-13)


def test_a_helical_gear_over_pins_of_another_program():
    """127 teeth, 12 per inch normal, 10.5 degrees, t 0.1309, pins 0.144 in: 10.967749 in over them.

    Pins find the opposite tooth space along the helix, whatever the number of teeth; balls in one
    transverse plane are half a pitch off it. Source: bfoster59/MOP, `AGMA reference`.
    """
    module, helix = 25.4 / 12, math.radians(10.5)
    made = gear(module, 127, helix=helix, allowance=0.1309 * 25.4 - module * math.pi / 2)
    ball = 0.144 * 25.4
    centres = (over_balls(made, ball) - ball) / math.cos(math.pi / 254)
    assert (centres + ball) / 25.4 == pytest.approx(10.967749, abs=2e-6)


def test_backlash_of_nominal_teeth_is_none_and_allowances_make_it():
    pair = GearPair.of_teeth(3.0, 17, 52, 30.0, 0.3, profile_shifts=(0.3, 0.2))
    assert circumferential_backlash(pair) == pytest.approx(0.0, abs=1e-13)
    rows = zip(pair.gears, (-0.05, -0.08), strict=True)
    thin = [replace(gear, thickness_allowance=a) for gear, a in rows]
    small = GearPair(*thin, pair.centre_distance + 0.02)
    found = float(normal_backlash(small))
    linear = (0.05 + 0.08) * math.cos(math.radians(20))
    base = math.asin(math.sin(0.3) * math.cos(math.radians(20)))
    linear += 2 * 0.02 * math.sin(pair.working_angle) * math.cos(base)
    assert found == pytest.approx(linear, rel=2e-3)


def test_the_linear_law_of_backlash_is_its_limit():
    pair = GearPair.of_teeth(3.0, 20, 60, 30.0)
    thin = [replace(gear, thickness_allowance=-1e-4) for gear in pair.gears]
    found = circumferential_backlash(GearPair(*thin, pair.centre_distance + 1e-4))
    linear = thickness_backlash(-1e-4, -1e-4, 1e-4, math.radians(20.0))
    assert found == pytest.approx(linear, rel=1e-4)


def test_clearances_of_unshifted_teeth():
    assert tip_clearances(GearPair.of_teeth(4.0, 20, 50, 30.0)) == pytest.approx((1.0, 1.0))
