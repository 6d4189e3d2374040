"""Pairs of unlike gears: what is of each gear, of the softer one, or the mean of both."""

import math
from dataclasses import replace

import pytest
from iso6336_pairs import EH, LOAD, V, spur, steels

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.iso6336.batch import range_of
from gearopt.physics.iso6336.case import Case, Practice
from gearopt.physics.iso6336.chain import quantities
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate
from gearopt.physics.iso6336.running_in import helix_allowance, pitch_allowance
from gearopt.physics.iso6336.stiffness import reduced_mass

UNLIKE = EH, V


def found(materials=UNLIKE, practice=None, operation=LOAD, pair=None):
    return quantities(Case(pair or spur(), operation, materials, practice or Practice()))


def test_a_tooth_of_the_wheel_may_have_several_contacts_a_revolution():
    case = Case(spur(), replace(LOAD, contacts=(2.0, 3.0)), UNLIKE, Practice())
    once = Case(spur(), LOAD, UNLIKE, Practice())
    assert case.cycles == pytest.approx((2.0 * once.cycles[0], 3.0 * once.cycles[1]))
    turns = LOAD.pinion_speed * LOAD.hours * 3600.0 / (2.0 * math.pi)
    assert once.cycles == pytest.approx((turns, turns / once.pair.ratio))


def test_factors_of_the_oil_follow_the_softer_gear():
    """C_ZL of 1500 MPa is 0.91, of 850 and less 0.83, by part 2, clause 12."""
    case = Case(spur(), LOAD, UNLIKE, Practice(viscosity=100.0))
    limit = min(quantities(case)["sigma_Hlim"])
    c = 0.83 if limit <= 850.0 else 0.91 if limit >= 1200.0 else limit / 4375.0 + 0.6357
    expected = c + 4.0 * (1.0 - c) / (1.2 + 134.0 / 100.0) ** 2
    assert limit < 1200.0 < max(quantities(case)["sigma_Hlim"])
    assert quantities(case)["Z_L"][0] == pytest.approx(expected, rel=1e-9)


def test_running_in_is_the_mean_of_both_gears():
    """Of the misalignment and of the pitch deviation, in either order of the gears."""
    for first, second in (UNLIKE, UNLIKE[::-1]):
        case = Case(spur(), LOAD, (first, second), Practice())
        made = quantities(case)
        alone = [quantities(Case(spur(), LOAD, (m, m), Practice())) for m in (first, second)]
        for law, name in ((pitch_allowance, "f_pb"), (helix_allowance, "f_ma")):
            worn = [
                law(m.family, made[name], q["sigma_Hlim"][0], case.speed)
                for m, q in zip((first, second), alone, strict=True)
            ]
            assert worn[0] != pytest.approx(worn[1], rel=0.1)
        between = sorted(q["K_Hbeta"] for q in alone)
        assert between[0] < made["K_Hbeta"] < between[1]


def test_bores_and_densities_count_for_their_own_gear():
    """m_red by hand, in t/mm: d_m of addendum 1 and dedendum 1.25 at m_n 4 is d - 1."""
    pair = GearPair.of_teeth(4.0, 20, 60, 40.0)
    mean = 4.0 * 20 - 1.0, 4.0 * 60 - 1.0
    bores, densities = (30.0, 120.0), (7.85e-9, 7.1e-9)
    light = [1.0 - (d / m) ** 4 for d, m in zip(bores, mean, strict=True)]
    base = 80.0 * math.cos(math.radians(20.0))
    inverse = 1.0 / (light[0] * densities[0]) + 1.0 / (light[1] * densities[1] * 9.0)
    expected = math.pi / 8.0 * (mean[0] / base) ** 2 * mean[0] ** 2 / inverse
    assert reduced_mass(pair, densities, bores) == pytest.approx(expected, rel=1e-12)


def test_deep_teeth_lower_the_root_stress():
    """Y_DT below 1 of grade 4 and a contact ratio above 2.05, in the stress itself."""
    deep = Rack(math.radians(20.0), 1.35, 1.6, 0.2)
    pair = GearPair.of_teeth(4.0, 60, 90, 40.0, 0.0, deep)
    fine, coarse = (found(steels(EH), Practice(grades=(g, g)), pair=pair) for g in (4.0, 5.0))
    assert fine["Y_DT"] < 1.0 == coarse["Y_DT"]
    for k in (0, 1):
        assert fine["sigma_F0"][k] == pytest.approx(fine["Y_DT"] * coarse["sigma_F0"][k])


def test_the_power_of_a_rating_is_that_at_its_least_safety():
    one = rate(spur(), replace(LOAD, power=2.0 * LOAD.power), steels(EH))
    least = min(*one.bending_safety, *(s**2 for s in one.contact_safety))
    assert one.power == pytest.approx(2.0 * LOAD.power * least, rel=1e-12)


def test_the_range_of_a_resonance_ratio_counts_the_load_with_its_factors():
    """N between N_S of the bare line load and that with K_A: subcritical only with it."""
    pair, steel = spur(), steels(EH)
    bare = Case(pair, replace(LOAD, power=0.2 * LOAD.power, overload=1.0), steel, Practice())
    line = bare.load / pair.face_width
    assert line < 50.0
    heavy = replace(bare, operation=replace(bare.operation, overload=100.0 / line))
    light = 0.5 + 0.35 * math.sqrt(line / 100.0)
    resonance = quantities(heavy)["N"]
    between = 0.5 * (light + 0.85)
    speed = bare.operation.pinion_speed * between / resonance

    def at(case):
        power = case.operation.power * speed / case.operation.pinion_speed
        return replace(case, operation=replace(case.operation, power=power, pinion_speed=speed))

    assert quantities(at(heavy))["N"] == pytest.approx(between)
    assert range_of(at(heavy)) == "subcritical"
    assert range_of(at(bare)) == "main resonance"


def test_a_material_without_a_yield_strength_may_be_given_one():
    soft, hard = (Material("V alloy", "MQ", 300.0, yield_strength=y) for y in (500.0, 900.0))
    assert found((soft, soft))["Y_deltarelT"] != found((hard, hard))["Y_deltarelT"]
