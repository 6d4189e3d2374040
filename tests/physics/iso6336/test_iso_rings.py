"""Rings by ISO 6336 beside the printed cases: rows, limits, masses, rims and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from iso6336_cases import RING_1, RING_2, case_ring_1, case_ring_2, case_stage_2

from gearopt.physics.gears import Cutter, GearPair, Rack
from gearopt.physics.geometry.fillet import fillet_end, fillet_point
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336 import stiffness
from gearopt.physics.iso6336.batch import rate_rows, spectrum_rows
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.chain import quantities
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate, rate_spectrum
from gearopt.physics.iso6336.refusals import REFUSALS, refusal
from gearopt.physics.iso6336.table import tooth_table
from gearopt.physics.iso6336.tooth_form import tangent_theta, virtual_gear
from gearopt.physics.rating import Operation

EH, V = Material("Eh", "MQ"), Material("V alloy", "MQ", 300.0, yield_strength=700.0)
LOAD = Operation(5e7, 60.0, 2000.0, overload=1.25, contacts=(1.0, 3.0))


def rated(case):
    return rate(case.pair, case.operation, case.materials, case.practice, case.given)


def ring_of(z_1=25, z_2=-71, beta=0.0, shifts=(0.2, 0.1), outside=None, cutter=None):
    racks = Rack(), Rack(tip_radius=0.3)
    pair = GearPair.internal(4.0, z_1, z_2, 40.0, beta, racks, shifts, cutter=cutter)
    return GearPair(pair.pinion, replace(pair.wheel, outside_diameter=outside))


@pytest.mark.parametrize(("make", "rows"), [(case_ring_2, RING_2), (case_ring_1, RING_1)])
def test_the_ratings_are_the_printed_ones(make, rows):
    """S_F 4.18/3.88 and S_H 3.43/1.81 (stage 2), 2.71/2.79 and 1.80/0.96 (stage 1)."""
    rating = rated(make())
    assert rating.bending_safety == pytest.approx(rows["S_F"][0], rel=rows["S_F"][1])
    assert rating.contact_safety == pytest.approx(rows["S_H"][0], rel=rows["S_H"][1])
    assert rating.governs == ("wheel", "contact")
    assert rating.unverified == ()


def test_the_dynamic_factor_of_the_sun_with_its_own_mass():
    """K_v 1.02 of sun and planet, 1.06 of planet and ring, from the teeth alone."""
    case = case_stage_2()
    given = {name: value for name, value in case.given.items() if name != "K_v"}
    sun = rated(replace(case, given=given))
    assert sun.factors["K_v"].value == pytest.approx(1.02, abs=5e-3)
    assert rated(case_ring_2()).factors["K_v"].value == pytest.approx(1.06, abs=5e-3)


def rows_of(count, seed):
    """Random internal pairs and loads of arrays, and the same as lists of floats."""
    rng = np.random.default_rng(seed)
    z_1 = rng.integers(14, 40, count).astype(float)
    z_2 = -(z_1 + rng.integers(5, 90, count))
    x_1, x_2 = rng.uniform(-0.2, 0.6, count), rng.uniform(-0.4, 0.4, count)
    module = rng.choice([1.0, 2.5, 6.0], count)
    power, speed = 10 ** rng.uniform(5.0, 7.0, count), 10 ** rng.uniform(0.5, 2.0, count)

    def pair(k, beta):
        racks = Rack(), Rack(tip_radius=0.3)
        args = module[k], z_1[k], z_2[k], 10.0 * module[k], beta, racks, (x_1[k], x_2[k])
        return GearPair.internal(*args, cutter=Cutter(20, tip_radius=0.2))

    def load(k):
        return Operation(power[k], speed[k], 2000.0, overload=1.25, contacts=(1.0, 3.0))

    return pair, load


@pytest.mark.parametrize(
    ("edition", "beta"),
    [
        ("2006", 0.0),
        ("2019", 0.2),
        pytest.param("2006", 0.2, marks=pytest.mark.slow),
        pytest.param("2019", 0.0, marks=pytest.mark.slow),
    ],
)
def test_rows_are_ratings(edition, beta):
    count = 30
    pair, load = rows_of(count, 5)
    practice = Practice(edition=edition, meshes=(1.0, 0.0))
    everything = slice(None)
    rows = rate_rows(pair(everything, beta), load(everything), (EH, V), practice)
    levels = [load(everything), replace(load(everything), power=1.3 * load(everything).power)]
    spectra = spectrum_rows(pair(everything, beta), levels, (EH, V), practice)
    refused = 0
    for k in range(count):
        one = float_pair(pair(k, beta)), load(k)
        if rows.refusal[k]:
            refused += 1
            with pytest.raises(ValueError, match=REFUSALS[int(rows.refusal[k])]):
                rate(*one, (EH, V), practice)
            continue
        rating = rate(*one, (EH, V), practice)
        safety = [each[k] for each in (*rows.bending, *rows.contact)]
        exact = (*rating.bending_safety, *rating.contact_safety)
        assert safety == pytest.approx(exact, rel=1e-12)
        if k % 10 == 0:
            harder = replace(one[1], power=1.3 * one[1].power)
            spectrum = rate_spectrum(one[0], (one[1], harder), (EH, V), practice)
            safety = [each[k] for each in (*spectra.bending, *spectra.contact)]
            exact = (*spectrum.bending_safety, *spectrum.contact_safety)
            assert safety == pytest.approx(exact, rel=1e-12)
    assert refused < count // 2


def float_pair(pair):
    def plain(gear):
        names = "normal_module", "teeth", "reference_diameter", "face_width", "profile_shift"
        return replace(gear, **{name: float(getattr(gear, name)) for name in names})

    return GearPair(plain(pair.pinion), plain(pair.wheel))


def test_a_table_of_teeth_holds_what_ratings_take():
    pair, _ = rows_of(40, 8)
    pairs = pair(slice(None), 0.0)
    table = tooth_table(pairs)
    sound = np.isfinite(table.contact)
    assert sound.sum() > 20
    for k in np.flatnonzero(sound)[::5]:
        values = quantities(replace(case_ring_2(), pair=float_pair(pair(k, 0.0)), given={}))
        assert table.zone[k] == pytest.approx(values["Z_H"], rel=1e-12)
        assert [f[k] for f in table.forms] == pytest.approx(values["Y_F"], rel=1e-12)
        assert [s[k] for s in table.singles] == pytest.approx(values["Z_BD"], rel=1e-12)


def test_a_ring_and_a_wheel_of_many_teeth_are_one_rack():
    """With z_2 to infinity from either side: contact, stiffness and the pinion's root are equal."""
    sides = []
    for z_2 in (-10_000_000, 10_000_000):
        if z_2 < 0:
            pair = GearPair.internal(4.0, 25, z_2, 40.0, 0.0, (Rack(), Rack()), (0.2, 0.0))
        else:
            pair = GearPair.of_teeth(4.0, 25, z_2, 40.0, profile_shifts=(0.2, 0.0))
        given = {"f_pb": 0.01, "f_falpha": 0.01, "f_ma": 0.01, "N": 0.1, "K_Hbeta": 1.1}
        case = replace(case_ring_2(), pair=pair, operation=LOAD, given=given, practice=Practice())
        sides.append(quantities(case))
    for symbol in ("Z_H", "Z_eps", "c_prime", "c_gamma_alpha", "sigma_H0", "K_v", "K_Halpha"):
        assert sides[0][symbol] == pytest.approx(sides[1][symbol], rel=1e-5), symbol
    for symbol in ("Y_F", "Y_S", "Z_BD", "sigma_F", "sigma_H"):
        assert sides[0][symbol][0] == pytest.approx(sides[1][symbol][0], rel=1e-5), symbol


@pytest.mark.parametrize("turning", ["sun", "ring"])
def test_the_reduced_mass_is_that_of_the_fastest_vibration(turning):
    """sqrt(k/m_red) is the frequency of a central gear against N planets, all springs alike.

    Eigenvalues of masses at the base circles: one central gear, N planets, N meshes.
    """
    planets, spring = 3, 14.0e3
    if turning == "sun":
        pair, meshes = GearPair.of_teeth(4.0, 18, 26, 40.0), (3.0, 1.0)
    else:
        pair, meshes = ring_of(outside=-340.0), (1.0, 3.0)
    masses = []
    for gear in pair.gears:
        mean = stiffness.mean_diameter(gear)
        hole = 340.0 if gear.teeth < 0 else 0.0
        masses.append(np.pi / 8.0 * 7.83e-9 * abs(mean**4 - hole**4) / gear.base_diameter**2)
    central, planet = masses if turning == "sun" else masses[::-1]
    stiff = np.zeros((planets + 1, planets + 1))
    for k in range(1, planets + 1):
        stiff[np.ix_([0, k], [0, k])] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inverse = np.diag([1.0 / central, *[1.0 / planet] * planets])
    fastest = np.linalg.eigvals(inverse @ stiff).real.max()
    reduced = stiffness.reduced_mass(pair, (7.83e-9, 7.83e-9), (0.0, 0.0), meshes)
    assert spring / reduced == pytest.approx(fastest, rel=1e-9)


def test_rims_of_rings():
    """Y_B = 1.15 ln(8.324 m_n/s_R): 1.7935 at 1.75, 1.3833 at 2.5, 1.0 from 3.5 (by hand)."""
    assert bending.ring_rim_factor(2.5) == pytest.approx(1.38328, abs=1e-5)
    assert bending.ring_rim_factor(1.7500001) == pytest.approx(1.79346, abs=1e-5)
    assert bending.ring_rim_factor(3.5) == bending.ring_rim_factor(9.0) == 1.0
    thin = ring_of(outside=-(71 * 4 + 2 * 4 * (1.25 - 0.1) + 2 * 2.5 * 4))
    rating = rate(thin, LOAD, (EH, V))
    assert rating.factors["Y_B"].value == pytest.approx((1.0, 1.38328), abs=1e-5)
    assert not rating.factors["Y_B"].verified
    usual = rate(ring_of(), LOAD, (EH, V)).factors["Y_B"]
    assert usual.value == (1.0, 1.0)
    assert usual.remark == "rim of the ring of 3.5 m_n taken for granted"


def test_a_rim_that_is_too_thin_is_refused():
    pair = ring_of(outside=-(71 * 4 + 2 * 4 * (1.25 - 0.1) + 2 * 1.5 * 4))
    with pytest.raises(ValueError, match="ring of s_R/m_n = 1.5, 1.75 or less: make its outside"):
        rate(pair, LOAD, (EH, V))
    assert rate(pair, LOAD, (EH, V), given={"Y_B": (1.0, 2.0)}).bending_safety[1] > 0.0
    rows = rate_rows(pair, LOAD, (EH, V))
    assert np.isnan(rows.bending[1])
    assert rows.bending[0] > 0.0


def test_what_is_no_pair_with_a_ring_is_refused():
    pair = ring_of()
    turned = GearPair(pair.wheel, pair.pinion)
    assert REFUSALS[int(refusal(turned))] == "internal gear"
    for z_2 in (-38, -40):
        assert REFUSALS[int(refusal(ring_of(z_1=40, z_2=z_2)))] == "internal gear"
    outwards = replace(pair, working_distance=92.0)  # a ring's is negative
    assert REFUSALS[int(refusal(outwards))] == "no centre distance"
    with pytest.raises(ValueError, match="internal gear: a ring is the wheel of a pair"):
        rate(turned, LOAD, (EH, V))


def test_what_no_source_confirms_of_rings_is_said():
    helical = rate(ring_of(beta=0.2), LOAD, (EH, V), Practice(meshes=(1.0, 3.0)))
    for symbol, words in (
        ("N", "mass of a ring that turns"),
        ("K_gamma", "all planets carry alike"),
        ("K_Hbeta", "method C has no planets on pins"),
        ("Y_F", "helical rings"),
    ):
        assert not helical.factors[symbol].verified, symbol
        assert words in helical.factors[symbol].remark, symbol
    newer = rate(ring_of(), LOAD, (EH, V), Practice(edition="2019"))
    assert "Y_F" in newer.unverified
    assert newer.factors["Z_BD"].value[1] == 1.0


def tangent_section(gear, slope):
    """Thickness and place [modules] where a fillet's tangent has an angle to the centre line.

    The tangent is that of finite differences.
    """
    theta = np.linspace(float(fillet_end(gear)), 0.5 * np.pi - 1e-4, 4001)
    point = fillet_point(gear, theta)
    turned = np.arctan2(np.abs(np.gradient(point.x)), np.abs(np.gradient(point.y)))
    at = int(np.argmin(np.abs(turned - slope)))
    return 2.0 * point.x[at] / gear.normal_module, point.y[at] / gear.normal_module


@pytest.mark.parametrize("make", [case_ring_2, case_ring_1])
def test_the_section_is_where_a_tangent_of_60_degrees_touches(make):
    gear = virtual_gear(make().pair.wheel)
    thickness, place = tangent_section(gear, np.pi / 3.0)
    theta = 0.5 * np.pi - tangent_theta(gear)
    point = fillet_point(gear, theta)
    assert (thickness, place) == pytest.approx((2.0 * point.x, point.y), rel=1e-3)


@pytest.mark.parametrize(("teeth", "shift"), [(20, 0.0), (30, 0.1), (40, -0.1)])
@pytest.mark.parametrize("make", [case_ring_2, case_ring_1])
def test_the_virtual_round_is_near_the_fillet_that_the_cutter_leaves(make, teeth, shift):
    """s_Fn of the virtual rack within 2 %, its place within 0.12 modules, of the cut fillet."""
    cutter = Cutter(teeth, shift, tip_radius=0.3)
    gear = replace(make().pair.wheel, cutter=cutter)
    cut = tangent_section(gear, np.pi / 3.0)
    virtual = tangent_section(virtual_gear(gear), np.pi / 3.0)
    assert virtual[0] == pytest.approx(cut[0], rel=0.02)
    assert virtual[1] == pytest.approx(cut[1], abs=0.12)
