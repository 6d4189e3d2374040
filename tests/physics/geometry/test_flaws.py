"""Flaws by name, of teeth that are known to have them."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.fillet import half_angle, profile, teeth_without_undercut
from gearopt.physics.geometry.flaws import flaws, shifts_at, tip_intrusion


def pair(z1, z2, x1=0.0, x2=0.0, rack=None, distance=None):
    return GearPair.of_teeth(
        3.0, z1, z2, 30.0, 0.0, rack or Rack(), (x1, x2), working_distance=distance
    )


@pytest.mark.parametrize(
    ("made", "fatal", "others"),
    [
        (pair(25, 50), set(), set()),
        (pair(14, 50), set(), {"undercut"}),  # interference goes without saying
        (pair(17, 17), set(), set()),
        (pair(8, 50), {"usable contact ratio below 1"}, {"undercut"}),
        (pair(10, 40, 0.8), {"pointed tooth"}, set()),
        (pair(12, 40, 0.7, -0.7), set(), {"thin tip"}),
        (pair(60, 100, -1.8, -1.8), {"no centre distance"}, set()),
        (pair(25, 50, distance=100.0), {"no centre distance"}, set()),
        (pair(25, 50, distance=116.0), {"contact ratio below 1"}, set()),
        (pair(25, 50, distance=112.4), set(), {"no backlash", "interference"}),
        (pair(25, 50, distance=112.4996), set(), set()),  # 112.5 mm as a drawing rounds it
        (pair(25, 50, distance=113.7), set(), {"large backlash"}),  # 0.89 mm; 0.14 mm is usual
        (pair(25, 50, distance=114.3), set(), {"large backlash", "small contact ratio"}),
        (pair(25, 50, rack=Rack(tip_radius=0.5)), set(), {"pointed tool"}),
        (pair(25, 50, rack=Rack(0.5, 1.0, 1.8)), {"pointed tool"}, set()),
        (pair(25, 50, rack=Rack(addendum=1.3)), set(), {"no tip clearance", "interference"}),
    ],
)
def test_flaws_of_teeth(made, fatal, others):
    found = flaws(made)
    assert {flaw.name for flaw in found if flaw.fatal} == fatal
    assert {flaw.name for flaw in found if not flaw.fatal} == others
    assert [flaw.fatal for flaw in found] == sorted((f.fatal for f in found), reverse=True)
    assert all(flaw.sentence.endswith(".") for flaw in found)


def test_a_gear_inside_its_base_circle_and_one_without_root():
    low = [replace(gear, tip_alteration=-3.0) for gear in pair(60, 60).gears]
    assert {flaw.name for flaw in flaws(GearPair(*low))} >= {"no involute"}
    assert "no root" in {flaw.name for flaw in flaws(pair(5, 40, -1.5))}


def test_teeth_without_undercut():
    """17.10 spur teeth of 20 degrees; there the end of the rack's flank meets the base circle."""
    assert teeth_without_undercut(Rack(), 0.0) == pytest.approx(17.097, abs=5e-4)
    for helix, rack in product((0.0, 0.4), (Rack(), Rack(0.25, 1.0, 1.4, 0.2))):
        z = teeth_without_undercut(rack, helix)
        tangent = math.tan(rack.pressure_angle) / math.cos(helix)
        lever = 0.5 * z / math.cos(helix) * math.sin(math.atan(tangent)) ** 2
        flank = rack.dedendum - rack.tip_radius * (1.0 - math.sin(rack.pressure_angle))
        assert lever == pytest.approx(flank, rel=1e-12)


@pytest.mark.parametrize(("teeth", "shift"), [(10, 0.0), (12, 0.1), (16, 0.0)])
def test_the_shift_that_is_named_avoids_undercut(teeth, shift):
    """Without it: x = 1 - z/17.097, as textbooks have it."""
    (said,) = (f.sentence for f in flaws(pair(teeth, 60, shift)) if f.name == "undercut")
    assert f"(z = {teeth}" in said and "17 teeth or more without undercut at x = 0" in said
    assert (f", x = {shift:g})" in said) is (shift > 0.0)
    named = float(said.split()[-1].rstrip("."))
    assert named == pytest.approx(1.0 - teeth / 17.097 + 0.005, abs=0.0051)
    assert "undercut" not in {f.name for f in flaws(pair(teeth, 60, named))}


def rolled(made, member):
    """How deep the mate's tip corner comes into a gear's teeth [m_n], the mate turned by steps."""
    own, mate = made.gears[member], made.gears[1 - member]
    radius, half = (f(*profile(own, 300, 300)) for f in (np.hypot, np.arctan2))
    top = 0.5 * mate.tip_diameter
    turned = np.linspace(-3.0, 3.0, 9001) / mate.teeth
    corner = turned + half_angle(mate, top)  # from the line of centres
    place = top * np.exp(1j * (0.5 * np.pi - corner))
    place = np.conj(place) + 1j * made.centre_distance
    angle = 0.5 * np.pi - np.angle(place) - turned * mate.teeth / own.teeth
    within = (radius[0] < abs(place)) & (abs(place) < radius[-1])
    deep = (angle - np.pi / own.teeth + np.interp(abs(place), radius, half)) * abs(place)
    return np.max(deep[within], initial=0.0) / own.normal_module


@pytest.mark.parametrize(
    ("made", "cut"),
    [
        (pair(25, 50), (False, False)),
        (pair(10, 40), (False, False)),  # undercut: the tool has made room for any tip
        (pair(14, 50, rack=Rack(addendum=1.2)), (True, False)),  # but not for a longer one
        (pair(29, 108, 0.38, 0.28, Rack(addendum=1.22, tip_radius=0.17)), (True, False)),
        (pair(25, 50, distance=111.5), (True, True)),
    ],
)
def test_tips_that_cut_into_fillets_are_found_as_gears_roll(made, cut):
    """A form circle that is not reached is not enough: corners sweep below their contact."""
    misfits = [f.sentence for f in flaws(made) if f.name == "interference" and f.misfit]
    for k, member in enumerate(("pinion", "wheel")):
        assert any(member in said for said in misfits) is cut[k]
        if made.working_distance is None:
            assert tip_intrusion(made, k) / 3.0 == pytest.approx(rolled(made, k), abs=2e-4)


def test_a_centre_distance_asks_for_its_sum_of_profile_shifts():
    """At the distance of given shifts the sum is theirs; backlash falls by 2 tan(alpha) a mm."""
    shifted = pair(24, 74, 0.5, 0.3)
    at = replace(shifted, working_distance=float(shifted.centre_distance))
    assert shifts_at(at) == pytest.approx(0.8, rel=1e-9) and not flaws(at)
    near = replace(shifted, working_distance=float(shifted.centre_distance) - 0.02)
    flaw = flaws(near)[0]
    opened = 2.0 * math.tan(float(shifted.working_angle)) * 0.02
    assert flaw.name == "no backlash" and flaw.misfit == pytest.approx(opened / 3.0, rel=1e-2)


def test_sentences_name_what_they_are_asked_to():
    found = flaws(pair(25, 50, rack=Rack(addendum=1.3)), " of stage 2")
    assert len(found) > 2 and all(" of stage 2" in flaw.sentence for flaw in found)


def test_internal_gears_are_refused_by_name():
    with pytest.raises(ValueError, match="internal gears are not covered"):
        pair(20, -60)
