"""Flaws by name, of teeth that are known to have them."""

import math
from dataclasses import replace
from itertools import product

import pytest

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.fillet import teeth_without_undercut
from gearopt.physics.geometry.flaws import flaws


def pair(z1, z2, x1=0.0, x2=0.0, rack=None, distance=None):
    return GearPair.of_teeth(
        3.0, z1, z2, 30.0, 0.0, rack or Rack(), (x1, x2), working_distance=distance
    )


@pytest.mark.parametrize(
    ("made", "fatal", "others"),
    [
        (pair(25, 50), set(), set()),
        (pair(14, 50), set(), {"undercut", "interference"}),
        (pair(17, 17), set(), set()),
        (pair(8, 50), {"usable contact ratio below 1"}, {"undercut", "interference"}),
        (pair(10, 40, 0.8), {"pointed tooth"}, set()),
        (pair(12, 40, 0.7, -0.7), set(), {"thin tip"}),
        (pair(60, 100, -1.8, -1.8), {"no centre distance"}, set()),
        (pair(25, 50, distance=100.0), {"no centre distance"}, set()),
        (pair(25, 50, distance=116.0), {"contact ratio below 1"}, set()),
        (pair(25, 50, distance=112.4), set(), {"no backlash"}),
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
    assert f"with {teeth} teeth" in said and "cuts 17 teeth and more cleanly" in said
    assert (f"profile shift {shift:g}" in said) is (shift > 0.0)
    named = float(said.split()[-1].rstrip("."))
    assert named == pytest.approx(1.0 - teeth / 17.097 + 0.005, abs=0.0051)
    assert "undercut" not in {f.name for f in flaws(pair(teeth, 60, named))}


def test_sentences_name_what_they_are_asked_to():
    found = flaws(pair(25, 50, rack=Rack(addendum=1.3)), " of stage 2")
    assert len(found) > 2 and all(" of stage 2" in flaw.sentence for flaw in found)


def test_internal_gears_are_refused_by_name():
    with pytest.raises(ValueError, match="internal gears are not covered"):
        pair(20, -60)
