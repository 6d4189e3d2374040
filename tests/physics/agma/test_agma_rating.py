"""Whole ratings: two textbook examples, what is given, lives that close, spectra, units."""

import math
from dataclasses import replace

import pytest

from gearopt.physics.agma.allowables import PSI
from gearopt.physics.agma.mesh import mean_load_sharing, mesh_of, pitch_point_factor
from gearopt.physics.agma.rating import rate, rate_spectrum
from gearopt.physics.agma.rating_factors import PAIRED, SHARED, Practice, Steel
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.rating import Operation

POUND = 4.4482216152605  # N
HORSEPOWER = 550.0 * 12.0 * POUND * 25.4  # N mm/s
SPEED = 1800.0 * math.pi / 30.0
STEELS = Steel(hardness=240.0), Steel(hardness=200.0)
EXAMPLE = Operation(4.0 * HORSEPOWER, SPEED, 1e8 / 60.0 / 1800.0, reliability=0.90)
SHIGLEY = Practice(quality=6, size=True)
CUSTOMARY = 2300.0 * PSI**0.5  # C_p


def spur():
    """Shigley 14-4: 17/52 teeth, P 10, F 1.5 in."""
    return GearPair.of_teeth(2.54, 17, 52, 38.1, rack=Rack(tip_radius=0.25))


def helical():
    """Shigley 14-5: 17/52 teeth, P_n 10, psi 30, F 1.5 in."""
    return GearPair.of_teeth(2.54, 17, 52, 38.1, math.radians(30.0), Rack(tip_radius=0.25))


def psi(values):
    return [value / PSI for value in values]


def test_shigley_14_4_with_the_books_i_and_j():
    """Figures of the book; the tolerance is that of its rounded I, K_m and J."""
    book = {"I": pitch_point_factor(spur()), "J": (0.30, 0.40), "C_p": CUSTOMARY}
    found = rate(spur(), EXAMPLE, STEELS, SHIGLEY, book)
    assert found.speed / (12 * 25.4 / 60) == pytest.approx(801.1, abs=0.06)
    assert found.load / POUND == pytest.approx(164.8, abs=0.06)
    value = {symbol: factor.value for symbol, factor in found.factors.items()}
    assert value["I"] == pytest.approx(0.121, abs=6e-4)
    assert value["K_v"] == pytest.approx(1.377, abs=6e-4)
    assert value["K_s"] == pytest.approx((1.043, 1.052), abs=6e-4)
    assert value["K_m"] == pytest.approx(1.22, abs=6e-3)
    assert value["K_R"] == 0.85 and value["K_T"] == 1.0 and value["K_B"] == (1.0, 1.0)
    assert psi(value["s_at"]) == pytest.approx([31350, 28260], abs=3)
    assert psi(value["s_ac"]) == pytest.approx([106400, 93500], abs=25)
    assert value["Y_N"] == pytest.approx((0.977, 0.996), abs=6e-4)
    assert value["Z_N"] == pytest.approx((0.948, 0.973), abs=6e-4)
    assert value["C_H"] == pytest.approx((1.0, 1.005), abs=2e-4)
    assert psi(found.bending_stress) == pytest.approx([6417, 4854], rel=1e-3)
    assert psi(found.contact_stress) == pytest.approx([70360, 70660], rel=1e-3)
    assert found.bending_safety == pytest.approx((5.62, 6.82), rel=2e-3)
    assert found.contact_safety == pytest.approx((1.69, 1.52), rel=3e-3)
    assert found.governs == ("wheel", "contact") and found.unverified == ()


def test_shigley_14_4_by_908_is_less_safe():
    """I 0.0986 for the book's 0.121: contact stresses 10 % above the book's."""
    found = rate(spur(), EXAMPLE, STEELS, SHIGLEY, {"C_p": CUSTOMARY})
    assert found.factors["I"].value == pytest.approx(0.09862, abs=6e-6)
    assert found.factors["J"].value == pytest.approx((0.3215, 0.3926), abs=0.012)
    # of the book's 70 360 psi of the pinion and 0.1211
    expected = 70330.7 * math.sqrt(0.12108 / 0.09862)
    assert psi(found.contact_stress)[0] == pytest.approx(expected, rel=1e-3)


def test_shigley_14_5_with_the_books_i_and_j():
    """The book keeps K_s of 14-4, and takes m_N = p_N/(0.95 Z)."""
    pair = helical()
    mesh = mesh_of(pair)
    sharing = mean_load_sharing(pair, mesh.path)
    assert sharing == pytest.approx(0.6895, rel=2e-3)
    book = {
        "I": pitch_point_factor(pair, sharing),
        "J": (0.423, 0.529),
        "C_p": CUSTOMARY,
        "K_s": (1.043, 1.052),
    }
    found = rate(pair, EXAMPLE, STEELS, SHIGLEY, book)
    assert pair.pinion.reference_diameter / 25.4 == pytest.approx(1.963, abs=6e-4)
    assert found.load / POUND == pytest.approx(142.7, abs=0.06)
    assert found.factors["I"].value == pytest.approx(0.195, abs=1e-3)
    assert found.factors["K_v"].value == pytest.approx(1.404, abs=6e-4)
    assert found.factors["K_m"].value == pytest.approx(1.208, abs=6e-4)
    assert psi(found.bending_stress) == pytest.approx([3445, 2779], rel=1e-3)
    assert psi(found.contact_stress) == pytest.approx([48230, 48440], rel=1e-3)
    assert found.bending_safety == pytest.approx((10.5, 11.9), rel=6e-3)
    assert found.contact_safety == pytest.approx((2.46, 2.22), rel=3e-3)


def test_the_least_volume_of_the_digest_is_just_safe_against_pitting():
    """Digest, section 7: contact 755.99 MPa, all that the wheel may bear; bending 176.9 of 242.4.

    Metric constants there (200 v, 2.22 HB + 200), so 2e-3 apart; volumes by relaxation and by
    enumeration 1 703 170 and 1 717 666 mm^3.
    """
    duty = Operation(15e6, 1450.0 * math.pi / 30.0, 1e8 / 60.0 / 1450.0, overload=1.25)
    steels = Steel(hardness=300.0), Steel(hardness=260.0)
    relaxed = GearPair.of_teeth(1.92313077, 46.6666671, 140.0000013, 26.92383104)
    found = rate(relaxed, duty, steels, Practice(quality=7))
    assert relaxed.volume == pytest.approx(1703169.8832, rel=1e-6)
    assert found.contact_stress[1] == pytest.approx(755.9882, rel=2e-3)
    assert found.contact_safety[1] == pytest.approx(1.0, rel=2e-3)
    assert found.bending_stress[0] == pytest.approx(176.9, rel=3e-3)
    factors = found.factors
    allowed = [s * y for s, y in zip(factors["s_at"].value, factors["Y_N"].value, strict=True)]
    assert allowed == pytest.approx([242.4361657, 225.9875956], rel=2e-3)
    allowed = [s * z for s, z in zip(factors["s_ac"].value, factors["Z_N"].value, strict=True)]
    assert allowed == pytest.approx([821.3463459, 755.9882023], rel=2e-3)
    assert found.governs == ("wheel", "contact")
    whole = GearPair.of_teeth(2.0, 45, 135, 27.0)
    assert whole.volume == pytest.approx(1717665.7834, rel=1e-9)
    assert 1.0 < rate(whole, duty, steels, Practice(quality=7)).contact_safety[1] < 1.006


def test_inches_and_millimetres_are_one_rating():
    """The same by the standard's inch form, written out, to 1e-9."""
    found = rate(spur(), EXAMPLE, STEELS, SHIGLEY, {"I": 0.1, "J": (0.3, 0.4), "C_p": CUSTOMARY})
    d, face, pitch, wheel = 17 / 10, 1.5, 10.0, 52 / 17
    speed = math.pi * d * 1800 / 12
    load = 33000 * 4 / speed
    b = 0.25 * (12 - 6) ** (2 / 3)
    a = 50 + 56 * (1 - b)
    k_v = ((a + math.sqrt(speed)) / a) ** b
    alignment = 0.127 + 0.0158 * face - 1.093e-4 * face**2
    k_m = 1 + face / (10 * d) - 0.0375 + 0.0125 * face + alignment
    k_s = [1.192 * (face * math.sqrt(y) / pitch) ** 0.0535 for y in (0.303, 0.409 + 0.2 * 0.013)]
    for k, j in ((0, 0.3), (1, 0.4)):
        bent = load * k_v * k_s[k] * pitch / face * k_m / j
        pressed = 2300 * math.sqrt(load * k_v * k_s[k] * k_m / (d * face * 0.1))
        assert found.bending_stress[k] / PSI == pytest.approx(bent, rel=1e-9)
        assert found.contact_stress[k] / PSI == pytest.approx(pressed, rel=1e-9)
    strong = (77.3 * 200 + 12800) * 1.3558 * (1e8 / wheel) ** -0.0178 / 0.85
    assert found.bending_safety[1] == pytest.approx(strong / bent, rel=1e-9)


def test_any_factor_can_be_given():
    given = {symbol: 1.25 for symbol in SHARED} | {symbol: (1.1, 1.2) for symbol in PAIRED}
    found = rate(spur(), EXAMPLE, STEELS, SHIGLEY, given)
    assert {factor.clause for factor in found.factors.values()} == {"given"}
    product = 1.25**3 * 1.1 * 1.1
    assert found.bending_stress[0] == pytest.approx(found.load * product / (38.1 * 2.54 * 1.1))
    with pytest.raises(ValueError, match="K_x"):
        rate(spur(), EXAMPLE, STEELS, SHIGLEY, {"K_x": 1.0})


@pytest.mark.parametrize("pair", [spur(), helical()], ids=["spur", "helical"])
@pytest.mark.parametrize("treatment", ["through-hardened", "carburised", "nitrided"])
def test_rating_at_the_life_it_prints_is_safe_by_1(pair, treatment):
    steels = tuple(replace(steel, treatment=treatment, hardness=300.0) for steel in STEELS)
    for power in (30.0, 60.0, 90.0):
        heavy = replace(EXAMPLE, power=power * HORSEPOWER)
        found = rate(pair, heavy, steels)
        ratios = 1.0, float(pair.ratio)
        for k in (0, 1):
            for mode in ("bending", "contact"):
                cycles = getattr(found, f"{mode}_life")[k]
                if cycles > 0.0:
                    again = replace(heavy, hours=cycles * ratios[k] / 60.0 / 1800.0)
                    safety = getattr(rate(pair, again, steels), f"{mode}_safety")[k]
                    assert safety == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("given", [0.5, 1.0, 2.0])
def test_a_given_life_factor_leaves_lives_on_the_side_of_their_safety(given):
    """As long as asked for where S is 1, longer where it is above."""
    factors = {"Y_N": (given, given), "Z_N": (given, given)}
    for power in (0.3, 1.0, 4.0):
        case = replace(EXAMPLE, power=power * EXAMPLE.power)
        found = rate(spur(), case, STEELS, None, factors)
        for lives, safety in (
            (found.bending_life, found.bending_safety),
            (found.contact_life, found.contact_safety),
        ):
            for k in (0, 1):
                assert (lives[k] >= found.cycles[k]) == (safety[k] >= 1.0)


def test_at_its_permissible_power_the_pair_is_just_safe():
    found = rate(spur(), EXAMPLE, STEELS)
    limit = rate(spur(), replace(EXAMPLE, power=found.power), STEELS)
    least = min(*limit.bending_safety, *(s**2 for s in limit.contact_safety))
    assert least == pytest.approx(1.0, rel=1e-12) and limit.governs == found.governs


def test_one_level_is_the_plain_rating_and_halves_of_it_too():
    plain = rate(spur(), EXAMPLE, STEELS)
    half = replace(EXAMPLE, hours=EXAMPLE.hours / 2)
    for operations in ((EXAMPLE,), (half, half)):
        found = rate_spectrum(spur(), operations, STEELS)
        assert found.bending_safety == pytest.approx(plain.bending_safety, rel=1e-9)
        assert found.contact_safety == pytest.approx(plain.contact_safety, rel=1e-9)
        for k in (0, 1):
            damage = plain.cycles[k] / plain.contact_life[k]
            assert found.contact_damage[k] == pytest.approx(damage, rel=1e-9)


def test_an_overload_of_a_spectrum_counts_by_miner():
    peak = replace(EXAMPLE, power=3 * EXAMPLE.power, hours=10.0)
    found = rate_spectrum(spur(), (EXAMPLE, peak), STEELS)
    for k in (0, 1):
        parts = [level.cycles[k] / level.contact_life[k] for level in found.levels]
        assert found.contact_damage[k] == pytest.approx(sum(parts), rel=1e-12, abs=0.0)
        parts = [level.cycles[k] / level.bending_life[k] for level in found.levels]
        assert found.bending_damage[k] == pytest.approx(sum(parts), rel=1e-12, abs=0.0)
    assert found.contact_safety[0] < min(level.contact_safety[0] for level in found.levels)
    with pytest.raises(ValueError, match="Z_N"):
        rate_spectrum(spur(), (EXAMPLE,), STEELS, None, {"Z_N": (1.0, 1.0)})


def test_marks_travel():
    """B88 bending of grade 2 and Y_N of induction hardening are unverified."""
    old = Practice(edition="B88", backup=(0.9, None))
    steels = tuple(replace(steel, grade=2) for steel in STEELS)
    assert set(rate(spur(), EXAMPLE, steels, old).unverified) == {"s_at"}
    hard = Steel("induction, roots"), Steel("carburised")
    assert rate(spur(), EXAMPLE, hard).unverified == ("Y_N",)
    assert rate(helical(), EXAMPLE, STEELS).unverified == ("I", "J")


def test_limits_of_the_curves_are_remarked():
    fast = replace(EXAMPLE, pinion_speed=20 * SPEED, hours=1e6)
    found = rate(spur(), fast, STEELS)
    assert "ends at" in found.factors["K_v"].remark
    assert "1e+10" in found.factors["Z_N"].remark
    wide = rate(spur().of_width(100.0), EXAMPLE, STEELS)
    assert "2 pinion diameters" in wide.factors["K_m"].remark


@pytest.mark.parametrize(
    ("strengths", "member", "mode"),
    [
        (((10.0, 900.0), (9e3, 9e3)), "pinion", "bending"),
        (((900.0, 10.0), (9e3, 9e3)), "wheel", "bending"),
        (((900.0, 900.0), (100.0, 9e3)), "pinion", "contact"),
        (((900.0, 900.0), (9e3, 100.0)), "wheel", "contact"),
    ],
)
def test_the_weakest_of_four_governs_and_permits_the_power(strengths, member, mode):
    """Strengths [MPa] of which one is small; the power is in proportion to S_F and S_H^2."""
    given = {"s_at": strengths[0], "s_ac": strengths[1]}
    found = rate(spur(), EXAMPLE, STEELS, None, given)
    assert found.governs == (member, mode)
    k = ("pinion", "wheel").index(member)
    least = found.bending_safety[k] if mode == "bending" else found.contact_safety[k] ** 2
    assert found.power == pytest.approx(EXAMPLE.power * least, rel=1e-12)


def test_factors_given_act_where_the_standard_has_them():
    """Stresses and safety factors of a factor given 21 % above its value; contact by its root."""
    plain = rate(spur(), EXAMPLE, STEELS)
    for symbol, bent, pressed in (("C_f", 1.0, 1.1), ("K_o", 1.21, 1.1), ("K_m", 1.21, 1.1)):
        more = rate(spur(), EXAMPLE, STEELS, None, {symbol: 1.21 * plain.factors[symbol].value})
        for k in (0, 1):
            assert more.bending_stress[k] == pytest.approx(bent * plain.bending_stress[k])
            assert more.contact_stress[k] == pytest.approx(pressed * plain.contact_stress[k])
    for symbol in ("K_R", "K_T"):
        more = rate(spur(), EXAMPLE, STEELS, None, {symbol: 1.21 * plain.factors[symbol].value})
        assert more.bending_stress == plain.bending_stress
        assert more.bending_safety == pytest.approx([s / 1.21 for s in plain.bending_safety])
        assert more.contact_safety == pytest.approx([s / 1.21 for s in plain.contact_safety])


def test_what_is_usual_where_nothing_is_said():
    """Steel of E 206000, nu 0.3; 99 %, below 120 degrees C, pinion between its bearings."""
    found = rate(spur(), Operation(1e6, SPEED, 1e4), STEELS).factors
    assert found["C_p"].value == pytest.approx(189.8117, abs=5e-5)
    assert found["K_R"].value == found["K_T"].value == found["K_o"].value == 1.0
    assert found["K_T"].clause == "2001-D04, 19" and found["C_p"].clause == "2001-D04, 12"
    hot = rate(spur(), replace(EXAMPLE, temperature_C=121.0), STEELS).factors["K_T"]
    assert hot.value > 1.1 and "customary" in hot.clause and not hot.verified


def test_what_lies_beyond_tables_and_charts_is_unverified():
    """Strengths off the lines' hardness, C_H of a large ratio; within them nothing is."""
    harder = Steel(hardness=390.0), Steel(hardness=280.0)
    inside = rate(spur(), EXAMPLE, harder)
    wide = rate(GearPair.of_teeth(2.54, 17, 357, 38.1), EXAMPLE, harder)
    assert inside.unverified == () and wide.unverified == ("C_H",)
    assert "ratio of 20" in wide.factors["C_H"].remark
    off = rate(spur(), EXAMPLE, (Steel(hardness=600.0), Steel(hardness=280.0)))
    assert off.unverified == ("s_at", "s_ac")


def test_strengths_may_be_given_without_a_hardness():
    """C_H is 1 then, and Y_N that of the softest curve; both say so."""
    soft = Steel(), Steel()
    given = {"s_at": (200.0, 200.0), "s_ac": (800.0, 800.0)}
    found = rate(spur(), EXAMPLE, soft, None, given).factors
    assert found["C_H"].value == (1.0, 1.0) and "no hardness" in found["C_H"].remark
    assert "160 HB" in found["Y_N"].remark and found["Z_N"].remark == ""
    with pytest.raises(ValueError, match="hardness in HB"):
        rate(spur(), EXAMPLE, soft)


def test_remarks_of_rims_and_of_soft_wheels():
    thin = rate(spur(), EXAMPLE, STEELS, Practice(backup=(0.4, 1.0)))
    assert "thinner" in thin.factors["K_B"].remark
    assert thin.factors["K_B"].value[1] == pytest.approx(1.6 * math.log(2.242), rel=1e-12)
    hard = Steel("carburised"), Steel(hardness=150.0)
    assert "180 to 400 HB" in rate(spur(), EXAMPLE, hard).factors["C_H"].remark
    fine = rate(spur(), EXAMPLE, (hard[0], STEELS[1]), Practice(backup=(2.0, None)))
    assert fine.factors["C_H"].remark == fine.factors["K_B"].remark == ""
    # Shigley, eq. (14-37): 0.8 um is 31.5 microinches
    expected = 1 + 0.00075 * math.exp(-0.0112 * 31.496) * 250
    assert fine.factors["C_H"].value[1] == pytest.approx(expected, rel=1e-5)


def test_an_idler_has_seven_tenths_of_its_strength():
    plain = rate(spur(), EXAMPLE, STEELS)
    idler = rate(spur(), EXAMPLE, (STEELS[0], replace(STEELS[1], reversed_load=True)))
    assert idler.bending_safety[1] == pytest.approx(0.7 * plain.bending_safety[1], rel=1e-12)
    assert idler.bending_safety[0] == plain.bending_safety[0]
    assert idler.contact_safety == plain.contact_safety


@pytest.mark.parametrize(
    ("change", "given", "named"),
    [
        ({"power": 0.0}, {}, "leave it out"),
        ({"power": math.nan}, {}, "power"),
        ({"pinion_speed": -1.0}, {}, "pinion speed"),
        ({"overload": 0.0}, {}, "overload"),
        ({"hours": -1.0}, {}, "life"),
        ({"reliability": 1.0}, {}, "0.9999"),
        ({}, {"J": (0.3, 0.0)}, "J is 0"),
        ({}, {"K_m": math.inf}, "K_m"),
    ],
)
def test_numbers_without_a_rating_are_refused(change, given, named):
    with pytest.raises(ValueError, match=named):
        rate(spur(), replace(EXAMPLE, **change), STEELS, None, given)


def test_a_rim_of_no_thickness_is_refused():
    with pytest.raises(ValueError, match="K_B"):
        rate(spur(), EXAMPLE, STEELS, Practice(backup=(None, 0.0)))


def test_refused_teeth_are_refused_by_name_unless_i_and_j_are_given():
    pointed = GearPair.of_teeth(2.54, 10, 52, 38.1, profile_shifts=(0.8, 0.0))
    with pytest.raises(ValueError, match="pointed tooth"):
        rate(pointed, EXAMPLE, STEELS)
    for given in ({"I": 0.1}, {"J": (0.3, 0.4)}):
        with pytest.raises(ValueError, match="pointed tooth"):
            rate(pointed, EXAMPLE, STEELS, None, given)
    assert rate(pointed, EXAMPLE, STEELS, None, {"I": 0.1, "J": (0.3, 0.4)}).load > 0
    with pytest.raises(ValueError, match="edition"):
        rate(spur(), EXAMPLE, STEELS, Practice(edition="1990"))
