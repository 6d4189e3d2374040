"""Span, balls, pins and chords with allowances against printed reports and handbooks."""

from dataclasses import replace
from math import radians

import pytest

from gearopt.physics.fits import thickness_allowances
from gearopt.physics.gears import Gear, GearPair, reference_diameter
from gearopt.physics.geometry.tooth import (
    chord,
    circumferential_backlash,
    normal_thickness,
    over_balls,
    over_pins,
    span,
    span_teeth,
)

# z, m_n, beta, x, D_M; k; W_k nominal, at A_sne, at A_sni; M_dK likewise; s_n, chord; x_Ee, x_Ei
# KISSsoft 03/2017, reports of the NREL 5 MW gearbox (gfsReboucas/Drivetrain), DIN 3967 cd25
PRINTED = {
    "sun": ((18, 21, 0, 0.389, 45), 3, (165.869, 165.747, 165.690), (466.306, 466.079, 465.974)),
    "planet": (
        (36, 21, 0, 0.5039, 40),
        5,
        (296.803, 296.638, 296.563),
        (836.492, 836.128, 835.961),
    ),
    "ring": (
        (-93, 21, 0, 0.1171, 35),
        11,
        (676.615, 676.916, 677.038),
        (1900.511, 1901.454, 1901.836),
    ),
    "pinion": (
        (24, 14, 10, 0.48, 28),
        4,
        (154.167, 154.045, 153.989),
        (397.284, 397.035, 396.921),
    ),
    "wheel": (
        (95, 14, 10, 0.6691, 25),
        13,
        (542.490, 542.264, 542.171),
        (1404.574, 1403.997, 1403.756),
    ),
}
THICKNESS = {  # s_n, its chord, generating shifts
    "sun": (38.933, 38.864, 0.3805, 0.3766),
    "planet": (40.689, 40.670, 0.4924, 0.4872),
    "ring": (34.777, 34.775, 0.0962, 0.0877),
    "pinion": (26.883, 26.857, 0.4672, 0.4614),
    "wheel": (28.810, 28.808, 0.6455, 0.6357),
}


def gears(name):
    """The gear, and it at both allowances."""
    z, m, beta, x, _ = PRINTED[name][0]
    helix = radians(beta)
    gear = Gear(m, z, reference_diameter(m, z, helix), 550.0, helix, profile_shift=x)
    ends = thickness_allowances(abs(float(gear.reference_diameter)), "cd", 25)
    return gear, *(replace(gear, thickness_allowance=end) for end in ends)


@pytest.mark.parametrize("name", PRINTED)
def test_span_and_balls_are_those_printed(name):
    (*_, ball), k, spans, balls = PRINTED[name]
    each = gears(name)
    assert span_teeth(each[0]) == k
    assert [float(span(gear, k)) for gear in each] == pytest.approx(spans, abs=1.1e-3)
    assert [float(over_balls(gear, ball)) for gear in each] == pytest.approx(balls, abs=2e-3)


@pytest.mark.parametrize("name", THICKNESS)
def test_thickness_chord_and_shifts_are_those_printed(name):
    gear, upper, lower = gears(name)
    thickness, wide, *shifts = THICKNESS[name]
    found = float(normal_thickness(gear, gear.reference_diameter)), float(chord(gear)[0])
    assert found == pytest.approx((thickness, wide), abs=1e-3)
    assert [upper.generating_shift, lower.generating_shift] == pytest.approx(shifts, abs=1.5e-4)


def test_pins_of_helical_teeth_of_odd_number_lie_along_the_helix():
    assert float(over_pins(gears("wheel")[0], 25)) == pytest.approx(1404.763, abs=1e-3)
    assert float(over_pins(gears("pinion")[0], 28)) == pytest.approx(397.284, abs=1e-3)
    spur = Gear(1.0, 21, 21.0, 10.0)
    assert over_pins(spur, 1.7) == over_balls(spur, 1.7)


def test_handbook_of_metric_gears():
    """Chord of z 12, m 10, x 0.3 (table 10-1); span of z 24, m 3, x 0.4; pins of z 20, m 1."""
    wide, height = chord(Gear(10.0, 12, 120.0, 50.0, profile_shift=0.3))
    assert (float(wide), float(height)) == pytest.approx((17.8256, 13.6657), abs=5e-5)
    gear = Gear(3.0, 24, 72.0, 30.0, profile_shift=0.4)
    assert span_teeth(gear) == 4
    assert float(span(gear, 4)) == pytest.approx(32.8266, abs=5e-5)
    assert float(over_pins(Gear(1.0, 20, 20.0, 10.0), 1.7)) == pytest.approx(22.2941, abs=5e-5)


def test_spans_of_a_published_listing():
    """Planetary 21/43 of m 1.75 (lecture listing, lecad.uni-lj.si)."""
    for z, x, k, wide in ((21, 0.438, 3, 13.9546), (43, 0.0426, 5, 24.3530)):
        gear = Gear(1.75, z, 1.75 * z, 38.0, profile_shift=x)
        assert span_teeth(gear) == k
        assert float(span(gear, k)) == pytest.approx(wide, abs=1e-4)


@pytest.mark.parametrize(
    ("names", "distance", "field", "printed"),
    [
        (("sun", "planet"), 584.0, 0.035, (0.283, 0.490)),
        (("planet", "ring"), 584.0, 0.035, (0.463, 0.708)),
        (("pinion", "wheel"), 861.0, 0.028, (0.359, 0.571)),
    ],
)
def test_range_of_backlash_is_the_one_printed(names, distance, field, printed):
    """But for what shifts of four decimals leave at the given distance, 0.5 um at most."""
    first, second = (gears(name) for name in names)
    sign = -1.0 if second[0].teeth < 0 else 1.0
    left = float(circumferential_backlash(GearPair(first[0], second[0], sign * distance)))
    assert abs(left) < 6e-4
    for k, off, wanted in zip((1, 2), (-field, field), printed, strict=True):
        pair = GearPair(first[k], second[k], sign * (distance + sign * off))
        assert float(circumferential_backlash(pair)) - left == pytest.approx(wanted, abs=1e-3)
