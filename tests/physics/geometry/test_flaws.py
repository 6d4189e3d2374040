"""Flaws by name, of teeth that are known to have them."""

from dataclasses import replace

import pytest

from gearopt.physics.gears import GearPair, Rack
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


def test_internal_gears_are_refused_by_name():
    with pytest.raises(ValueError, match="internal gears are not covered"):
        pair(20, -60)
