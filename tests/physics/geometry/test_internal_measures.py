"""Measures and backlash of a printed ring: KISSsoft 03/2017 report of a 5 MW wind gearbox.

Stage 2 (z 36/-93, m_n 21) in github.com/gfsReboucas/Drivetrain, @NREL_5MW/stage_02.rtf, with its
allowances DIN 3967 cd25 and centre distance 584 js7. The tips of a second ring: a listing of a
planetary design program (lecture notes, lecad.uni-lj.si).
"""

import math

import numpy as np
import pytest

from gearopt.physics.gears import Gear, GearPair, Rack, replace
from gearopt.physics.geometry.contact import contact_path, largest_sliding, specific_sliding
from gearopt.physics.geometry.fillet import fillet_point
from gearopt.physics.geometry.involute import shift_sum
from gearopt.physics.geometry.profile_shift import Meshing
from gearopt.physics.geometry.tooth import (
    ball_contact_diameter,
    circumferential_backlash,
    normal_thickness,
    over_balls,
    span,
    span_diameter,
    span_teeth,
    tip_clearances,
    transverse_thickness,
)

RING = Gear(21.0, -93, -1953.0, 550.0, 0.0, Rack(tip_radius=0.3), 0.1171)


@pytest.mark.parametrize(
    ("allowance", "spanned", "between"),
    [(0.0, 676.615, 1900.511), (-0.32, 676.916, 1901.454), (-0.45, 677.038, 1901.836)],
)
def test_printed_span_and_dimension_between_balls(allowance, spanned, between):
    ring = replace(RING, thickness_allowance=allowance)
    assert span_teeth(ring) == 11
    assert span(ring, 11) == pytest.approx(spanned, abs=1e-3)
    assert over_balls(ring, 35.0) == pytest.approx(between, abs=2e-3)


def test_printed_thickness_shift_and_root_of_thinner_teeth():
    assert normal_thickness(RING, RING.reference_diameter) == pytest.approx(34.777, abs=1e-3)
    thinner = replace(RING, thickness_allowance=-0.32)
    assert thinner.generating_shift == pytest.approx(0.0962, abs=1.5e-4)
    cut = 2.0 * fillet_point(thinner, 0.5 * math.pi).radius
    assert cut == pytest.approx(-2001.460, abs=2e-3)
    # along an involute the angle of half a tooth of a ring and inv(alpha_y) move together
    ray = np.linspace(-1953.0, -1906.0, 5)
    angle = transverse_thickness(RING, ray) / ray
    base = RING.base_diameter / ray
    inv = np.sqrt(1.0 / base**2 - 1.0) - np.arccos(base)
    assert np.diff(angle + inv) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("allowances", "distance", "backlash"),
    [((-0.175, -0.32), -584.035, 0.463), ((-0.255, -0.45), -583.965, 0.708)],
)
def test_printed_backlash(allowances, distance, backlash):
    """The larger distance of an internal pair leaves the smaller backlash."""
    shifts = 0.5039, 0.1171
    pair = GearPair.internal(21.0, 36, -93, 550.0, profile_shifts=shifts)
    thinned = [
        replace(g, thickness_allowance=a) for g, a in zip(pair.gears, allowances, strict=True)
    ]
    loose = GearPair(thinned[0], thinned[1], distance)
    assert circumferential_backlash(loose) == pytest.approx(backlash, abs=1e-3)


def test_no_backlash_at_the_distance_of_the_shifts_and_the_way_back():
    pair = GearPair.internal(2.0, 20, -51, 10.0, 0.2, profile_shifts=(0.3, -0.2))
    assert circumferential_backlash(pair) == pytest.approx(0.0, abs=1e-13)
    angles = pair.pinion.rack.pressure_angle, pair.pinion.transverse_pressure_angle
    assert shift_sum(pair.working_angle, -31, *angles) == pytest.approx(0.1, abs=1e-13)
    given = replace(pair, working_distance=pair.centre_distance)
    assert given.working_angle == pytest.approx(pair.working_angle, rel=1e-13)


def test_printed_tips_of_a_ring_and_its_shortened_planet():
    """21/43/108, m 1.75, a 56.8: d_a 78.817 and 185.4992; the planet is shortened to its sun."""
    ring = Gear(1.75, -108, -189.0, 38.0)
    assert -ring.tip_diameter == pytest.approx(185.4992, abs=1e-3)
    sun = Meshing(1.75, (21.0, 43.0), 0.0, (Rack(), Rack()), 56.8)
    planet = Gear(1.75, 43, 75.25, 38.0, 0.0, Rack(), 0.0426, sun.tip_alteration)
    assert planet.tip_diameter == pytest.approx(78.817, abs=1e-3)


def test_tip_clearances_and_sliding_by_construction():
    """Clearance from root to tip along the line of centres; sliding from speeds of both flanks."""
    pair = GearPair.internal(2.0, 20, -60, 10.0)
    assert tip_clearances(pair) == pytest.approx((0.5, 0.5), abs=1e-12)
    path = contact_path(pair)
    for at in (path.start, path.end):
        rho_1, rho_2 = 10.0 * 2.0 * math.sin(math.radians(20.0)) + np.array(
            [at, at + 40.0 * math.sin(math.radians(20.0))]
        )  # from the tangent points, 20 and 60 mm of radius from the pitch point
        rolled = 3.0 * rho_1, rho_2  # speeds of the flanks along each other, omega_2 = 1
        expected = 1.0 - rolled[1] / rolled[0], 1.0 - rolled[0] / rolled[1]
        assert specific_sliding(path, pair.ratio, at) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("teeth", "shift"), [(30, 0.0), (36, 0.4)])
def test_the_largest_sliding_is_at_the_roots(teeth, shift):
    pair = GearPair.internal(2.0, teeth, -93, 10.0, profile_shifts=(shift, 0.1))
    path = contact_path(pair)
    first, second = (specific_sliding(path, pair.ratio, at) for at in (path.start, path.end))
    assert largest_sliding(pair) == pytest.approx(-min(first[0], second[1]), rel=1e-12)
    assert 0.0 < max(first[1], second[0]) < 1.0  # tips slide ahead of the roots they meet


def test_measures_touch_the_flanks_where_they_say():
    """A ball of the touched thickness: its centre and the flank by the involute of a circle."""
    at = ball_contact_diameter(RING, 35.0)
    assert RING.root_diameter < at < RING.tip_diameter
    assert RING.root_diameter < span_diameter(RING, 11) < RING.tip_diameter
    # the normal at the ball's contact touches the base circle and meets the ball's centre
    base, touch = 0.5 * RING.base_diameter, 0.5 * at
    from_tangent = math.sqrt(touch**2 - base**2)
    centre = 0.5 * (over_balls(RING, 35.0) + 35.0) / math.cos(0.5 * math.pi / 93)
    assert math.hypot(base, from_tangent - 17.5) == pytest.approx(centre, rel=1e-12)
