"""Loads of planetary stages against a printed report and against counting.

KISSsoft 03/2017, NREL 5 MW gearbox, stage_02.rtf of gfsReboucas/Drivetrain: 18/36/93 teeth, three
planets, 162105.5 N m on the sun at 294.5 1/min, carrier at 47.8 1/min, 175200 h.
"""

import math
from fractions import Fraction

import pytest

from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.case import Case, Practice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.planetary.loads import mesh_load_factor, turned, with_ring, with_sun
from gearopt.physics.rating import Operation

RPM = math.pi / 30.0
RELATIVE = 7782.3e6 / 3.0 / 175200.0 / 60.0 * RPM  # 246.8 1/min of the sun, by its load cycles
SUN = Operation(162105.5e3 * RELATIVE, RELATIVE, 175200.0)


def case(pair, load):
    steel = Material("Eh", "MQ")
    return Case(pair, load.operation, (steel, steel), Practice(meshes=load.meshes))


def stage():
    outer = GearPair.of_teeth(21.0, 18, 36, 550.0)
    return outer, GearPair.internal(21.0, 36, -93, 550.0)


def test_forces_and_cycles_are_printed():
    """F_t 285900.438 N at both meshes; N_L 7782.3, 1297.1, 1506.3 million; v 4.88 m/s."""
    outer, inner = stage()
    sun = case(outer, with_sun(SUN, 3))
    ring = case(inner, with_ring(SUN, 3, 36 / 18, held=True))
    assert sun.load == pytest.approx(285900.438, rel=2e-6)
    assert ring.load == pytest.approx(285900.438, rel=2e-6)
    assert sun.cycles == pytest.approx((7782.3e6, 1297.1e6), rel=1e-4)
    assert ring.cycles == pytest.approx((1297.1e6, 1506.3e6), rel=1e-4)
    assert ring.speed == pytest.approx(4880.0, rel=2e-3)
    assert ring.practice.meshes == (1.0, 0.0)


def test_cycles_are_those_of_counting():
    """Teeth of sun and ring meet every planet in a turn against the carrier, one by one.

    Over so many turns that all gears turn whole times, tooth pairs are counted.
    """
    planets, (z_s, z_p, z_r) = 3, (18, 36, 93)
    turns = 2 * z_p * z_r  # of the sun against the carrier: whole numbers of all three
    meetings = turns * z_s * planets  # tooth pairs at all meshes with the sun
    per_tooth = {"sun": Fraction(meetings, z_s), "ring": Fraction(meetings, z_r)}
    per_tooth["planet"] = Fraction(meetings, planets * z_p)  # with the sun, on one flank
    load = Operation(1.0, 2.0 * math.pi / 3600.0, float(turns))  # one turn an hour
    outer, inner = stage()
    sun = case(outer, with_sun(load, planets)).cycles
    ring = case(inner, with_ring(load, planets, z_p / z_s, held=False)).cycles
    assert sun == pytest.approx((per_tooth["sun"], per_tooth["planet"]), rel=1e-12)
    assert ring == pytest.approx((per_tooth["planet"], per_tooth["ring"]), rel=1e-12)


def test_a_planet_as_pinion_has_the_same_load():
    """Sun 19, planet 17: the pair either way round has the same F_t, speed and cycles."""
    load = with_sun(SUN, 3)
    pair = GearPair.of_teeth(45.0, 19, 17, 491.0)
    other = GearPair.of_teeth(45.0, 17, 19, 491.0)
    one_way, back = case(pair, load), case(other, turned(load, 17 / 19))
    assert back.load == pytest.approx(one_way.load, rel=1e-12)
    assert back.speed == pytest.approx(one_way.speed, rel=1e-12)
    assert back.cycles[::-1] == pytest.approx(one_way.cycles, rel=1e-12)
    assert back.practice.meshes == (1.0, 3.0)


@pytest.mark.parametrize(
    ("rule", "values"),
    [
        ("wind", {3: 1.10, 4: 1.25, 5: 1.35, 6: 1.44, 7: 1.47}),
        ("class society", {3: 1.0, 4: 1.2, 5: 1.3, 6: 1.4, 9: 1.4}),
        ("square root", {1: 1.0, 3: 1.0, 4: 1.25, 7: 1.5, 12: 1.75}),
    ],
)
def test_mesh_load_factors_are_those_of_the_tables(rule, values):
    for planets, value in values.items():
        assert mesh_load_factor(planets, rule) == pytest.approx(value, rel=1e-12)


def test_what_a_rule_has_not_is_refused():
    with pytest.raises(ValueError, match="no K_gamma of 2 planets by 'wind': 3 to 7; give K_gamma"):
        mesh_load_factor(2, "wind")
    with pytest.raises(ValueError, match="no K_gamma of 8 planets"):
        mesh_load_factor(8, "wind")
    with pytest.raises(ValueError, match="no rule 'AGMA' of K_gamma; known: wind, class society"):
        mesh_load_factor(3, "AGMA")
