"""Backlash, pitch error, tolerances and transmission error against known numbers and identities."""

import math

import numpy as np
import pytest

from gearopt.physics.backlash import (
    backlash_angle,
    normal_backlash,
    output_error,
    pitch_error_angle,
    play_backlash,
    radial_backlash,
    thickness_backlash,
    transverse_pressure_angle,
)

ALPHA = math.radians(20.0)
RADIAL = (
    sum((0.0180, 0.0240, 0.0042, 0.0000, 0.0025, 0.0000, 0.0025)),
    sum((0.0200, 0.0270, 0.0054, 0.0025, 0.0030, 0.0030, 0.0040)),
)
PITCH = (0.0290, 0.0330)


def errors_deg(d2, d4, downstream):
    """Backlash and pitch of both stages and at the output [deg]."""
    backlash = [
        backlash_angle(radial_backlash(r, ALPHA), d) for r, d in zip(RADIAL, (d2, d4), strict=True)
    ]
    pitch = [pitch_error_angle(p, d) for p, d in zip(PITCH, (d2, d4), strict=True)]
    ratios = (downstream, 1.0)
    found = [*backlash, output_error(backlash, ratios), *pitch, output_error(pitch, ratios)]
    return np.degrees(found)


def test_table_4_data():
    assert RADIAL == pytest.approx((0.0512, 0.0649), abs=1e-12)
    found = errors_deg(48.0, 104.0, 8.0)
    expected = [0.0889769, 0.0520547, 0.0631768, 0.0692324, 0.0363608, 0.0450148]
    assert found == pytest.approx(expected, abs=6e-8)
    assert found[2] + found[5] == pytest.approx(0.10819163246984825, rel=1e-12)


def test_the_printed_angles_come_from_other_wheels():
    found = errors_deg(50.0, 122.0, 122.0 / 13.0)
    expected = [0.0854178, 0.0443745, 0.0534764, 0.0664631, 0.0309961, 0.0380782]
    assert found == pytest.approx(expected, abs=6e-8)


@pytest.mark.parametrize("beta", [0.0, 0.3, 0.6])
def test_tooth_thickness_form_is_that_of_din_3967(beta):
    upper_1, upper_2, distance = -0.022, -0.030, -0.011
    j_t = thickness_backlash(upper_1, upper_2, distance, ALPHA, beta)
    alpha_t = transverse_pressure_angle(ALPHA, beta)
    base = math.asin(math.sin(beta) * math.cos(ALPHA))
    j_bn = -(upper_1 + upper_2) * math.cos(ALPHA)
    j_bn += 2.0 * distance * math.sin(alpha_t) * math.cos(base)
    assert normal_backlash(j_t, ALPHA, beta) == pytest.approx(j_bn, rel=1e-13)
    assert normal_backlash(j_t, ALPHA, beta) == pytest.approx(
        j_t * math.cos(alpha_t) * math.cos(base), rel=1e-13
    )


def test_moving_gears_apart_is_the_exact_tooth_space_to_first_order():
    """j = 2 a_w (inv(alpha_w) - inv(alpha)) on the working circles of spur gears."""
    a = 28.0
    for shift in (1e-3, 1e-4):
        working = math.acos(a * math.cos(ALPHA) / (a + shift))
        involute = [math.tan(x) - x for x in (working, ALPHA)]
        exact = 2.0 * (a + shift) * (involute[0] - involute[1])
        assert radial_backlash(shift, ALPHA) == pytest.approx(exact, rel=3.0 * shift)


def test_minimum_backlash_of_the_guide_line_is_no_servo_target():
    """ISO/TR 10064-2: a = 58.5, m = 0.5 mm give j_t = 0.0740 mm = 0.0815 deg at d = 104 mm."""
    j_bn = 2.0 / 3.0 * (0.06 + 0.0005 * 58.5 + 0.03 * 0.5)
    j_t = j_bn / normal_backlash(1.0, ALPHA)
    assert j_bn == pytest.approx(0.0695, abs=6e-5) and j_t == pytest.approx(0.0740, abs=6e-5)
    assert math.degrees(backlash_angle(j_t, 104.0)) == pytest.approx(0.0815, abs=6e-5)


def turns(shift):
    """Ends between which a wheel can turn about a shifted centre, pinion held [rad].

    By the flanks alone, point by point: 26 and 208 teeth of module 0.5 mm. shift (..., 2) [mm].
    """
    r, base = np.array([6.5, 52.0]), np.array([6.5, 52.0]) * math.cos(ALPHA)
    radii = np.linspace(base[0] * 1.002, 7.2, 4001)

    def involute(radius, of):
        tangent = np.sqrt((radius / of) ** 2 - 1.0)
        return tangent - np.arctan(tangent)

    there = math.tan(ALPHA) - ALPHA
    half = 0.5 * math.pi / 26.0 + there - involute(radii, base[0])  # of the pinion's tooth
    x, y = radii * np.cos(half), radii * np.sin(half)
    ends = []
    for side in (1.0, -1.0):
        across, up = r.sum() + shift[0] - x, side * y - shift[1]
        gap = 0.5 * math.pi / 208.0 - there + involute(np.hypot(across, up), base[1])
        ends.append((side * np.arctan2(up, across) - gap).max())
    return ends[0], -ends[1]


def test_an_axis_with_play_is_found_by_the_flanks_alone():
    """An axis anywhere within its play; displaced radially; eccentric, over one turn."""
    size, r = 1e-3, 52.0
    tight = np.subtract(*turns((0.0, 0.0))[::-1])
    assert tight == pytest.approx(0.0, abs=1e-8)
    apart = np.subtract(*turns((size, 0.0))[::-1])
    assert r * apart == pytest.approx(radial_backlash(size, ALPHA), rel=1e-3)
    around = np.linspace(0.0, 2.0 * math.pi, 181)
    ends = np.array([turns((size * math.cos(t), size * math.sin(t))) for t in around])
    assert r * (ends[:, 1].max() - ends[:, 0].min()) == pytest.approx(
        play_backlash(size, ALPHA), rel=1e-3
    )
    pitch = pitch_error_angle(2.0 * size / math.cos(ALPHA), 2.0 * r)
    assert np.ptp(ends, axis=0) == pytest.approx([pitch, pitch], rel=1e-3)
    assert play_backlash(1.0, ALPHA) * math.sin(ALPHA) == pytest.approx(radial_backlash(1.0, ALPHA))
