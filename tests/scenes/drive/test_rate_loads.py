"""Loads and lives of rated files: Miner's spectra, printed lives, Shigley's pair by formulas."""

import math

import pytest
from rated_files import pair, two_stages
from scipy.optimize import brentq

import gearopt
from gearopt.formulations.drive.rating import DriveRating
from gearopt.optimise.typed import typed

BENDING = ((6.1514, 0.1192), (1.3558, 0.0178))  # Y_N of carburised steel: A N^-B, the larger
PITTING = ((2.466, 0.056), (1.4488, 0.023))  # Z_N


def rated(tables):
    return gearopt.rate(tables).design["rating"]


def level(power, share, **more):
    return {"power": power, "share": share} | more


def test_one_level_is_the_plain_load():
    plain = rated(pair(duty={"power": "14 kW"}))
    one = rated(pair(load=[level("14 kW", "100 %")]))
    for ours, theirs in zip(one["gears"], plain["gears"], strict=True):
        for name, value in theirs.items():
            same = pytest.approx(value, rel=1e-12) if isinstance(value, float) else value
            assert ours[name] == same, name
    for name in ("meshes", "factors", "shafts", "teeth"):
        assert one[name] == plain[name]
    assert one["power_capacity_kW"] == pytest.approx(plain["power_capacity_kW"], rel=1e-12)


def test_levels_of_one_load_are_that_load():
    split = [level("14 kW", "30 %"), level("14 kW", "70 %")]
    one, two = (rated(pair(load=load)) for load in ([level("14 kW", 1)], split))
    for ours, theirs in zip(two["gears"], one["gears"], strict=True):
        for name in ("bending_safety", "contact_safety", "bending_damage", "contact_damage"):
            assert ours[name] == pytest.approx(theirs[name], rel=1e-9)


def life(curve, factor):
    """Cycles at which A N^-B, the larger of two, is a factor."""
    return max((factor / a) ** (-1.0 / b) for a, b in curve)


@pytest.mark.parametrize("name", ["bending", "contact"])
def test_two_levels_by_hand(name):
    """Miner's sum is 1 as all stresses grow by the safety factor: solved here anew.

    K_v depends on speed alone: bending stresses go with the power, contact stresses with its root.
    """
    curve = BENDING if name == "bending" else PITTING
    symbol = "s_at" if name == "bending" else "s_ac"
    powers, shares, hours = (30.0, 12.0), (0.02, 0.98), 8000.0
    load = [level(f"{p} kW", s) for p, s in zip(powers, shares, strict=True)]
    found = rated(pair({"life": "8000 h"}, load=load))
    strength = next(f for f in found["factors"] if f["symbol"] == symbol)
    for k, member in enumerate(("pinion", "wheel")):
        row = found["gears"][k]
        rpm = 1450.0 / (1.0 if k == 0 else 3.0)
        cycles = [60.0 * rpm * hours * share for share in shares]
        hardest = row[f"{name}_stress_MPa"]
        power = 1.0 if name == "bending" else 0.5
        stresses = [hardest * (p / powers[0]) ** power for p in powers]

        def damage(factor, n=cycles, s=stresses, allowed=strength[member]):
            lives = [life(curve, factor * one / allowed) for one in s]
            return sum(a / b for a, b in zip(n, lives, strict=True))

        assert row[f"{name}_damage"] == pytest.approx(damage(1.0), rel=1e-9)
        told = [lv[f"{name}_damage"] for lv in found["levels"] if lv["member"] == member]
        assert sum(told) == pytest.approx(damage(1.0), rel=1e-9)
        safety = brentq(lambda f: damage(f) - 1.0, 0.1, 20.0, xtol=1e-13)
        assert row[f"{name}_safety"] == pytest.approx(safety, rel=1e-9)


def test_levels_have_their_own_speed():
    """Half the speed: twice the torque, half the cycles."""
    load = [level("10 kW", "50 %"), level("10 kW", "50 %", input_speed="725 rpm")]
    rows = [r for r in rated(pair(load=load))["levels"] if r["member"] == "pinion"]
    assert rows[0]["cycles"] == pytest.approx(2 * rows[1]["cycles"], rel=1e-12)
    assert rows[1]["bending_stress_MPa"] > 1.8 * rows[0]["bending_stress_MPa"]  # K_v is smaller
    assert [r["input_speed_rpm"] for r in rows] == pytest.approx([1450, 725], rel=1e-12)


def test_stresses_are_those_of_the_largest_and_forces_of_the_largest_force():
    """K_v makes a fast level with less force the harder one."""
    load = [level("10 kW", 0.5, input_speed="500 rpm"), level("70 kW", 0.5, input_speed="4000 rpm")]
    found = rated(pair({"quality": 5}, load=load))
    for row in found["gears"]:
        for name in ("bending_stress_MPa", "contact_stress_MPa"):
            own = [r[name] for r in found["levels"] if r["member"] == row["member"]]
            assert row[name] == max(own) == own[1]
    force = 10e6 / (500 * math.pi / 30) * 2.0 / 60.0  # T/r
    assert found["meshes"][0]["tangential_force_N"] == pytest.approx(force, rel=1e-12)
    assert found["shafts"][0]["torque_Nm"] == pytest.approx(1e-3 * force * 30.0, rel=1e-12)


OVERLOADED = {  # lives within the curves: on both branches, of a spectrum, of a later stage
    "short": pair(duty={"power": "40 kW"}),
    "long": pair(duty={"power": "16.5 kW"}),
    "spectrum": pair(load=[level("40 kW", "5 %"), level("10 kW", "95 %")]),
    "two stages": two_stages(duty={"power": "25 kW"}, first={"face_width": "60 mm"}),
}


@pytest.mark.parametrize("name", OVERLOADED)
def test_at_the_printed_life_safety_is_one(name):
    tables = OVERLOADED[name]
    printed = rated(tables)["life_h"]
    assert 0.0 < printed < math.inf
    tables["rating"]["life"] = f"{printed!r} h"
    again = gearopt.rate(tables)
    found = again.design["rating"]
    least = min(min(r["bending_safety"], r["contact_safety"]) for r in found["gears"])
    assert least == pytest.approx(1.0, abs=1e-9) and found["safe"] and again.feasible
    assert found["life_h"] == pytest.approx(printed, rel=1e-6)


def test_lives_beyond_the_curves_are_not_told():
    """The curves end at 1e10 cycles; a tooth that breaks at once has a life of 0."""
    rows = rated(pair(duty={"power": "2 kW"}))["gears"]
    assert all(r.get("bending_life_cycles") is r.get("life_h") is None for r in rows)
    assert rated(pair(duty={"power": "500 kW"}))["life_h"] == 0.0


def test_the_gear_that_fails_first_has_the_life_of_the_drive():
    """A pinion known to 1e10 cycles, before its wheel of 5e9, with a third of them."""
    stress = rated(pair())["gears"][0]["contact_stress_MPa"]
    strengths = [f"{stress / (1.4488 * n**-0.023)!r} MPa" for n in (3e10, 5e9)]
    found = rated(pair({"given": {"s_ac": strengths}}))
    assert [g.get("life_h") for g in found["gears"]] == [None, pytest.approx(5e9 / 60 / 1450 * 3)]
    assert found.get("life_h") is None
    rating = typed(DriveRating, found, "rating")
    assert rating.shortest_lived.member == "pinion"
    assert rating.known_life_h(rating.gears[0]) == pytest.approx(1e10 / 60 / 1450)


def test_a_life_in_revolutions_of_the_input():
    hours = rated(pair({"life": "1000 h"}))
    turns = pair({"input_revolutions": 1000 * 60 * 1450})
    del turns["rating"]["life"]
    ours, theirs = (d["gears"][0] for d in (rated(turns), hours))
    assert ours["contact_safety"] == pytest.approx(theirs["contact_safety"], rel=1e-14)
    assert rated(turns)["required_life_h"] == pytest.approx(1000.0, rel=1e-12)


@pytest.mark.parametrize(
    ("hand", "thrust"), [({}, "opposed"), ({"pinion_hand": "right"}, "added")], ids=str
)
def test_thrusts_of_an_intermediate_shaft(hand, thrust):
    """By default those of its wheel and its pinion are against each other."""
    tables = two_stages(second=hand, gears={"helix_angle": "15 deg"})
    found = rated(tables)
    ends = [m["axial_force_N"] for m in found["meshes"]]
    shaft = abs(found["shafts"][1]["axial_force_N"])
    expected = ends[1] - ends[0] if thrust == "opposed" else ends[1] + ends[0]
    assert shaft == pytest.approx(expected, rel=1e-12)
    assert sum(s["axial_force_N"] for s in found["shafts"]) == pytest.approx(0.0, abs=1e-9)
    hands = [t["hand"] for t in found["teeth"]]
    assert hands[0] == "right" and hands[1] == "left"
    assert hands[2] == ("left" if thrust == "opposed" else "right")
    assert all(t["hand"] == "spur" for t in rated(two_stages())["teeth"])


def test_torques_of_the_shafts():
    shafts = rated(two_stages())["shafts"]
    first = 7500.0 / (1450 * math.pi / 30)
    assert [s["torque_Nm"] for s in shafts] == pytest.approx(
        [first, 3 * first, 3 * 67 / 18 * first], rel=1e-12
    )
    assert [s["rotation"] for s in shafts] == ["clockwise", "anticlockwise", "clockwise"]


@pytest.mark.parametrize("name", ["shigley_14_4", "shigley_14_5"])
def test_a_textbook_pair_by_its_formulas(name, solved):
    """The factors that the result prints, put into the equations of stress here, in lbf and in."""
    rating = solved(name).design["rating"]
    f = {
        r["symbol"]: [r["pinion"], r["pinion"] if r["wheel"] is None else r["wheel"]]
        for r in ({"wheel": None} | r for r in rating["factors"])
    }
    slope = math.cos(math.radians(30.0)) if name.endswith("5") else 1.0
    diameter, pitch, width = 1.7 / slope, 10.0 * slope, 1.5
    load = 33000.0 * 4.0 / (math.pi * diameter * 1800.0 / 12.0)
    psi = 0.45359237 * 9.80665 / 25.4**2
    for k, row in enumerate(rating["gears"]):
        shared = f["K_o"][0] * f["K_v"][0] * f["K_m"][0] * f["K_s"][k]
        bending = load * shared * pitch / width * f["K_B"][k] / f["J"][k]
        assert row["bending_stress_MPa"] / psi == pytest.approx(bending, rel=1e-5)
        contact = 2300.0 * math.sqrt(load * shared * f["C_f"][0] / (diameter * width * f["I"][0]))
        assert row["contact_stress_MPa"] / psi == pytest.approx(contact, rel=1e-5)
        weaker = f["K_T"][0] * f["K_R"][0]
        safe = f["s_at"][k] / psi * f["Y_N"][k] / weaker / bending
        assert row["bending_safety"] == pytest.approx(safe, rel=1e-5)
        safe = f["s_ac"][k] / psi * f["Z_N"][k] * f["C_H"][k] / weaker / contact
        assert row["contact_safety"] == pytest.approx(safe, rel=1e-5)
