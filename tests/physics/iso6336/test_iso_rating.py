"""Whole ratings: what is given, refusals, doubts, lives that close, spectra, limits of geometry."""

import math
from dataclasses import replace

import pytest
from iso6336_cases import case_report
from iso6336_pairs import EH, LOAD, V, helical, spur, steels

from gearopt.bench.rating import iso_example
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.factors import CLAUSES, PAIRED, SHARED
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate, rate_spectrum
from gearopt.physics.iso6336.refusals import SENTENCES


def test_every_factor_can_be_given():
    """What is given is taken, and named so; each moves some safety factor, up or down."""
    plain = rate(helical(), LOAD, steels(EH))
    for symbol in CLAUSES:
        value = plain.factors[symbol].value
        changed = tuple(1.1 * v for v in value) if symbol in PAIRED else 1.1 * value
        found = rate(helical(), LOAD, steels(EH), given={symbol: changed})
        assert found.factors[symbol].clause == "given" and found.factors[symbol].value == changed
        moved = found.bending_safety + found.contact_safety
        assert moved != plain.bending_safety + plain.contact_safety, symbol
    assert set(CLAUSES) == {*SHARED, *PAIRED}


def test_giving_what_is_computed_changes_nothing():
    plain = rate(helical(), LOAD, steels(EH))
    given = {symbol: factor.value for symbol, factor in plain.factors.items()}
    found = rate(helical(), LOAD, steels(EH), given=given)
    assert found.bending_safety == pytest.approx(plain.bending_safety, rel=1e-14)
    assert found.contact_life == pytest.approx(plain.contact_life, rel=1e-9)


def test_lives_are_where_safety_factors_are_1():
    """Rated for the life that is found, a gear has a safety factor of 1."""
    for material, power in ((EH, 4e8), (V, 2e7)):
        heavy = replace(LOAD, power=power)
        first = rate(spur(), heavy, steels(material))
        for lives, safeties in (
            (first.bending_life, "bending_safety"),
            (first.contact_life, "contact_safety"),
        ):
            for k in (0, 1):
                if not 0.0 < lives[k] < math.inf:
                    continue
                hours = heavy.hours * lives[k] / first.cycles[k]
                again = rate(spur(), replace(heavy, hours=hours), steels(material))
                assert getattr(again, safeties)[k] == pytest.approx(1.0, rel=1e-9)
    assert 0.0 < first.contact_life[0] < math.inf


def test_static_strength_has_static_factors():
    """At a turn or two: 1.6 sigma_Hlim, 2.5 2 sigma_Flim (0.44 Y_S + 0.12), no film, no size."""
    found = rate(spur(), replace(LOAD, hours=1e-4), steels(EH))
    value = {symbol: factor.value for symbol, factor in found.factors.items()}
    assert value["Z_NT"] == pytest.approx((1.6, 1.6)) and value["Y_NT"] == pytest.approx((2.5, 2.5))
    for symbol in ("Z_L", "Z_v", "Z_R", "Y_RrelT", "Y_X"):
        assert value[symbol] == (1.0, 1.0)
    assert value["Y_deltarelT"][0] == pytest.approx(0.44 * value["Y_S"][0] + 0.12)


def test_soft_wheels_harden_against_hard_pinions():
    wheel = Material("V alloy", "MQ", 300.0, yield_strength=700.0)
    found = rate(spur(), replace(LOAD, hours=2e4), (EH, wheel))
    assert found.factors["Z_W"].value[0] == 1.0
    assert found.factors["Z_W"].value[1] == pytest.approx(1.1 * (3.0 / _film()) ** 0.15, rel=1e-9)
    assert found.factors["Z_W"].verified
    soft = rate(spur(), replace(LOAD, hours=2e4), (wheel, EH)).factors["Z_W"]
    assert soft.value == (1.0, 1.0)  # a hard wheel gives a soft pinion nothing (IACS UR M56, 2.11)
    short = rate(spur(), replace(LOAD, hours=1.0), (EH, wheel)).factors["Z_W"]
    assert not short.verified and "static" in short.remark
    both = replace(wheel, hardness=360.0), replace(wheel, hardness=240.0)
    known = 1.0 + 2.0 * (0.00898 * 1.5 - 0.00829)
    found = rate(spur(), replace(LOAD, hours=2e4), both)
    assert found.factors["Z_W"].value == pytest.approx((1.0, known))


def _film():
    """R_zH [um] of 4.8/4.8 um, v 6.3 m/s, 220 mm2/s, rho_red 10.774 mm, within 3 to 16."""
    rho = 42.0 * 126.0 / 168.0 * math.sin(math.radians(20.0))
    film = (1500.0 / (6.3 * 220.0)) ** 0.33
    return max(4.8 * (10.0 / rho) ** 0.33 * film, 3.0)


def test_idlers_have_seven_tenths():
    idle = replace(EH, reversed_load=True)
    one, two = rate(spur(), LOAD, (EH, EH)), rate(spur(), LOAD, (idle, EH))
    assert two.bending_safety[0] == pytest.approx(0.7 * one.bending_safety[0])
    assert two.bending_safety[1] == one.bending_safety[1]


def test_rims_and_deep_teeth():
    thin = rate(spur(), LOAD, steels(EH), Practice(backup=(None, 0.8)))
    plain = rate(spur(), LOAD, steels(EH))
    assert thin.bending_stress[0] == plain.bending_stress[0]
    ratio = thin.bending_stress[1] / plain.bending_stress[1]
    assert ratio == pytest.approx(1.6 * math.log(2.242 / 0.8))
    assert thin.factors["Y_B"].verified
    deep = GearPair.of_teeth(4.0, 60, 80, 40.0, rack=Rack(addendum=1.35, dedendum=1.6))
    fine = rate(deep, LOAD, steels(EH), Practice(grades=(4.0, 4.0))).factors["Y_DT"]
    coarse = rate(deep, LOAD, steels(EH)).factors["Y_DT"]
    assert fine.value < 1.0 == coarse.value


def test_doubts_are_named():
    """Below 100 N/mm, tempered steel, main resonance, modification, 2019: each marks its factor."""
    light = rate(spur(), replace(LOAD, power=1e5), steels(EH))
    assert {"c_prime", "c_gamma_alpha", "K_v"} <= set(light.unverified)
    soft = rate(spur(), LOAD, steels(V))
    assert {"K_v", "K_Halpha"} <= set(soft.unverified)
    slow = rate(spur(), replace(LOAD, pinion_speed=100.0), steels(V))
    assert not {"K_v", "K_Halpha"} & set(slow.unverified)
    guess = rate(spur(), LOAD, steels(replace(V, yield_strength=0.0)))
    assert "estimated" in guess.factors["Y_deltarelT"].remark
    assert "Y_deltarelT" in guess.unverified and "Y_deltarelT" not in soft.unverified
    iron = rate(spur(), LOAD, steels(Material("GG", "MQ", 200.0)))
    assert {"Y_deltarelT", "Y_RrelT"} <= set(iron.unverified)
    weak = rate(spur(), LOAD, steels(replace(V, yield_strength=400.0)))
    assert (
        weak.factors["Y_deltarelT"].remark
        == "yield point outside 500 to 1000 MPa: its end is taken"
    )
    fast = rate(spur(), replace(LOAD, pinion_speed=2000.0, power=7e8), steels(EH))
    assert fast.factors["N"].value > 0.85 and "K_v" in fast.unverified
    crowned = rate(spur(), LOAD, steels(EH), Practice(helix_modification="crowned"))
    assert {"K_Hbeta", "K_Fbeta"} <= set(crowned.unverified)
    given = rate(spur(), LOAD, steels(EH), Practice(helix_modification="crowned"), {"K_Hbeta": 1.2})
    assert "K_Fbeta" not in given.unverified
    assert (
        crowned.factors["K_Hbeta"].value < rate(spur(), LOAD, steels(EH)).factors["K_Hbeta"].value
    )
    new = rate(helical(), LOAD, steels(EH), Practice(edition="2019"))
    assert {"Y_F", "Z_BD", "K_Falpha"} <= set(new.unverified)
    assert new.factors["Z_H"].clause == "6336-2:2019, 6"
    assert new.factors["f_pb"].clause == "ISO 1328-1:1995"
    clauses = {"Y_NT": 12, "Y_deltarelT": 13, "Y_RrelT": 14, "Y_X": 15}
    for symbol, clause in clauses.items():
        assert CLAUSES[symbol][0] == f"6336-3, {clause}, method B"


def test_numbers_and_words_that_mean_nothing_are_refused():
    for what, message in (
        ({"power": 0.0}, "a level without load does no damage"),
        ({"pinion_speed": -1.0}, "pinion speed is -1"),
        ({"overload": 0.0}, "application factor is 0"),
        ({"hours": -1.0}, "cannot be below 0"),
        ({"power": math.inf}, "power is inf"),
    ):
        with pytest.raises(ValueError, match=message):
            rate(spur(), replace(LOAD, **what), steels(EH))
    for practice, message in (
        (Practice(edition="1996"), "no edition '1996'; known: 2006, 2019"),
        (Practice(tolerances="1962"), "no tolerances"),
        (Practice(shift="real"), "no shift 'real'"),
        (Practice(helix_modification="bent"), "no helix modification"),
        (Practice(profile_modification="some"), "no profile modification"),
        (Practice(grades=(6.0, 13.0)), "no accuracy grade"),
        (Practice(viscosity=0.0), "viscosity"),
        (Practice(backup=(0.4, None)), "backup ratio"),
        (Practice(lowest=0.1), "at 1e10 cycles"),
    ):
        with pytest.raises(ValueError, match=message):
            rate(spur(), LOAD, steels(EH), practice)
    with pytest.raises(ValueError, match="no factor 'K_x'; known: K_A"):
        rate(spur(), LOAD, steels(EH), given={"K_x": 1.0})
    with pytest.raises(ValueError, match="K_v is 0"):
        rate(spur(), LOAD, steels(EH), given={"K_v": 0.0})
    assert rate(spur(), LOAD, steels(EH), given={"C_a": 0.0, "f_ma": 0.0})


@pytest.mark.parametrize(
    ("name", "pair"),
    [
        ("no centre distance", GearPair.of_teeth(4.0, 20, 40, 40.0, profile_shifts=(-2.0, -2.0))),
        ("pointed tool", GearPair.of_teeth(4.0, 20, 40, 40.0, rack=Rack(dedendum=2.5))),
        (
            "usable contact ratio below 1",
            GearPair.of_teeth(4.0, 20, 40, 40.0, rack=Rack(tip_radius=1.6)),
        ),
        ("no root", GearPair.of_teeth(4.0, 6, 90, 40.0, profile_shifts=(-2.0, 2.0))),
        ("no involute", GearPair.of_teeth(4.0, 20, 40, 40.0, rack=Rack(addendum=-1.0))),
        ("pointed tooth", GearPair.of_teeth(4.0, 8, 40, 40.0, profile_shifts=(1.5, 0.0))),
        (
            "contact ratio below 1",
            GearPair.of_teeth(4.0, 20, 40, 40.0, rack=Rack(addendum=0.4)),
        ),
        (
            "contact ratio of 2.5 or more",
            GearPair.of_teeth(
                4.0, 150, 150, 40.0, rack=Rack(math.radians(15.0), 1.6, 1.9, tip_radius=0.2)
            ),
        ),
    ],
)
def test_a_pair_without_a_rating_is_refused_by_name(name, pair):
    with pytest.raises(ValueError, match=f"^{name}: "):
        rate(pair, LOAD, steels(EH))
    assert name in SENTENCES


def test_one_level_of_a_spectrum_is_a_rating():
    heavy = replace(LOAD, power=3e8)
    one, spectrum = rate(spur(), heavy, steels(EH)), rate_spectrum(spur(), (heavy,), steels(EH))
    assert spectrum.bending_safety == pytest.approx(one.bending_safety, rel=1e-9)
    assert spectrum.contact_safety == pytest.approx(one.contact_safety, rel=1e-9)
    damage = [n / life for n, life in zip(one.cycles, one.contact_life, strict=True)]
    assert spectrum.contact_damage == pytest.approx(damage, rel=1e-9)


def test_two_levels_of_a_spectrum_by_hand():
    """N = 5e7 (sigma_Hlim/sigma)^p between 1e5 and 5e7 cycles, p = ln(500)/ln(1.6)."""
    names = ("K_v", "K_Hbeta", "K_Fbeta", "K_Halpha", "K_Falpha")
    given = dict.fromkeys(names, 1.0) | dict.fromkeys(("Z_L", "Z_v", "Z_R"), (1.0, 1.0))
    first = replace(LOAD, power=1.5e8, pinion_speed=100.0, hours=100.0)
    second = replace(first, power=1.2e8, hours=200.0)
    found = rate_spectrum(spur(), (first, second), steels(EH), given=given)
    limit, power = 1500.0, math.log(500.0) / math.log(1.6)
    cycles = [100.0 * hours * 3600.0 / (2.0 * math.pi) for hours in (100.0, 200.0)]
    stress = [level.contact_stress[0] for level in found.levels]
    lives = [5e7 * (limit / s) ** power for s in stress]
    assert all(1e5 < life < 5e7 for life in lives)
    expected = sum(n / life for n, life in zip(cycles, lives, strict=True))
    assert found.contact_damage[0] == pytest.approx(expected, rel=1e-9)
    assert found.contact_safety[0] == pytest.approx(expected ** (-1.0 / power), rel=1e-6)
    with pytest.raises(ValueError, match="follow from the levels"):
        rate_spectrum(spur(), (first,), steels(EH), given={"Z_NT": (1.0, 1.0)})


def test_published_designs_are_safe_by_either_edition():
    """2019 changes sigma_F of the report by f_eps and cos(beta)^3: Y_F 18 % lower, Y_beta 4.7 %."""
    case = case_report()
    old = rate(case.pair, case.operation, case.materials, case.practice, case.given)
    new = replace(case.practice, edition="2019", profile_modification="by analysis")
    found = rate(case.pair, case.operation, case.materials, new, case.given)
    sharing = 1.50275**-0.5
    known = old.bending_stress[0] * sharing / math.cos(math.radians(10.0)) ** 3
    assert found.bending_stress[0] == pytest.approx(known, rel=1e-4)
    assert found.contact_stress == old.contact_stress
    assert iso_example().practice.shift == "nominal"


def test_load_shares_are_limited():
    """Pitch off by 1 mm: K_Halpha is eps_gamma/(eps_alpha Z_eps^2), K_Falpha with Y_eps."""
    given = {"f_pb": 1.0}
    for pair in (spur(), helical()):
        coarse = rate(pair, LOAD, steels(EH), given=given).factors
        ratio, total = pair.transverse_contact_ratio, pair.overlap_ratio
        total = total + ratio
        most = total / (ratio * coarse["Z_eps"].value ** 2)
        assert coarse["K_Halpha"].value == pytest.approx(most, rel=1e-12)
        assert coarse["K_Falpha"].value == pytest.approx(total / (0.25 * ratio + 0.75), rel=1e-12)
    new = rate(helical(), LOAD, steels(EH), Practice("2019"), given)
    found = new.factors["K_Falpha"].value
    base = math.cos(math.asin(math.sin(0.25) * math.cos(math.radians(20.0)))) ** 2
    assert found == pytest.approx(total / (ratio * (0.25 + 0.75 * base / ratio)), rel=1e-12)


def test_remarks_say_what_leaves_its_range():
    """Coarse roots, slow gears, sharp notches, long lives, hardness and strengths off lines."""
    coarse = replace(EH, root=41e-3)
    assert rate(spur(), LOAD, (EH, coarse)).factors["Y_RrelT"].remark == "roughness above 40 µm"
    assert not rate(spur(), LOAD, (EH, replace(EH, root=40e-3))).factors["Y_RrelT"].remark
    # v z1/100 sqrt(u^2/(1 + u^2)) = 3 m/s at v 15.06 m/s, 358.5 rad/s
    for speed, said in ((358.0, True), (359.0, False)):
        remark = rate(spur(), replace(LOAD, pinion_speed=speed), steels(EH)).factors["K_v"].remark
        assert remark.startswith("slow") == said
    for resonance, name in ((1.1, "main resonance,"), (1.2, "above the main resonance,")):
        found = rate(spur(), LOAD, steels(EH), given={"N": resonance}).factors["K_v"]
        assert found.remark.startswith(name) and not found.verified
    long = rate(spur(), replace(LOAD, hours=2e5), steels(EH)).factors
    assert long["Z_NT"].remark == long["Y_NT"].remark == "beyond 1e+10 cycles"
    assert not rate(spur(), LOAD, steels(EH)).factors["Z_NT"].remark
    soft = rate(spur(), LOAD, steels(replace(V, hardness=100.0))).factors["sigma_Hlim"]
    assert "its end is taken" in soft.remark
    between = rate(spur(), LOAD, steels(EH), given={"sigma_Hlim": (1000.0, 1500.0)})
    assert "between 850 MPa and 1200 MPa" in between.factors["Z_L"].remark
    for limit in (800.0, 850.0, 1200.0):
        found = rate(spur(), LOAD, steels(EH), given={"sigma_Hlim": (limit, 1500.0)})
        assert not found.factors["Z_R"].remark
    sharp = GearPair.of_teeth(4.0, 200, 200, 40.0, rack=Rack(tip_radius=0.02))
    assert rate(sharp, LOAD, steels(EH)).factors["Y_S"].remark == "q_s outside 1 to 8"


@pytest.mark.parametrize(
    ("sizes", "practice", "said"),
    [
        ((0.4, 21, 63, 30.0), Practice(), "module outside ISO 1328-1"),
        ((1.0, 21, 63, 3.0), Practice(), "face width outside ISO 1328-1"),
        ((0.2, 21, 63, 3.0), Practice(), "module, diameter, face width outside ISO 1328-1"),
        ((3.0, 21, 63, 30.0), Practice(grades=(6.0, 12.0), tolerances="2013"), "grade outside"),
        ((3.0, 21, 63, 30.0), Practice(grades=(6.0, 12.0)), ""),
        ((0.5, 21, 63, 4.0), Practice(tolerances="2013"), ""),
    ],
)
def test_tolerances_beyond_their_standard_are_unverified(sizes, practice, said):
    """1995: m 0.5 to 70, d 5 to 10,000, b 4 to 1000 mm, grades 0 to 12; 2013: grades 1 to 11."""
    found = rate(GearPair.of_teeth(*sizes), replace(LOAD, power=1e5), steels(EH), practice).factors
    for symbol in ("f_pb", "f_falpha", "f_ma"):
        assert found[symbol].remark.startswith(said) and found[symbol].verified == (not said)
        assert bool(found[symbol].remark) == bool(said)


def test_steep_angles_and_large_shifts_are_told():
    """IACS UR M56, 3.1: normal pressure angles up to 25, helix angles up to 30 degrees."""

    def told(symbol, helix=0.0, angle=20.0, shift=0.0):
        rack = Rack(pressure_angle=math.radians(angle), tip_radius=0.2)
        pair = GearPair.of_teeth(
            4.0, 40, 80, 40.0, math.radians(helix), rack, profile_shifts=(shift, shift)
        )
        return rate(pair, LOAD, steels(EH)).factors[symbol]

    assert told("Y_beta", 31.0).remark.startswith("beta above 30 degrees")
    assert told("Y_F", angle=26.0).remark.startswith("alpha_n above 25 degrees")
    assert not told("Y_beta", 30.0).remark and not told("Y_F", angle=25.0).remark
    for shift, sound in ((-0.26, False), (-0.25, True), (1.0, True), (1.01, False)):
        assert told("c_prime", shift=shift).verified == sound


def test_wear_gives_the_tips_a_relief():
    """C_ay of 1500 and 700 MPa, 1.995 and 8.511 um: their mean, where none is given."""
    hard = rate(spur(), LOAD, steels(EH)).factors["C_a"].value
    assert hard == pytest.approx(1.995e-3, abs=1e-6)
    mixed = rate(spur(), LOAD, steels(EH), given={"sigma_Hlim": (1500.0, 700.0)})
    assert mixed.factors["C_a"].value == pytest.approx(0.5 * (1.995e-3 + 8.511e-3), abs=1e-6)
    assert rate(spur(), LOAD, steels(EH), Practice(relief=0.01)).factors["C_a"].value == 0.01


def test_a_spectrum_tells_damages_and_safety_of_both_gears_apart():
    """One level: Miner's sum is cycles over life, of bending and of contact, of each gear."""
    hard = replace(LOAD, power=6.0 * LOAD.power)
    one, found = rate(spur(), hard, steels(EH)), rate_spectrum(spur(), (hard,), steels(EH))
    for k in (0, 1):
        for damage, life in (
            (found.bending_damage, one.bending_life),
            (found.contact_damage, one.contact_life),
        ):
            wanted = one.cycles[k] / life[k] if life[k] > 0.0 else math.inf
            assert damage[k] == pytest.approx(wanted, rel=1e-9)
    assert found.bending_safety == pytest.approx(one.bending_safety, rel=1e-9)
    assert found.contact_safety == pytest.approx(one.contact_safety, rel=1e-9)


def test_the_roughness_of_both_flanks_counts():
    rough, fine = replace(EH, flank=8e-3), replace(EH, flank=4e-3)
    ways = [
        rate(spur(), LOAD, pair).factors["Z_R"].value for pair in ((rough, fine), (fine, rough))
    ]
    between = rate(spur(), LOAD, steels(replace(EH, flank=6e-3))).factors["Z_R"].value
    assert ways[0] == ways[1] == between
