"""Laws of ISO 6336 by hand: deviations, running-in, load factors, curves, factors of strength."""

import math

import pytest
from iso6336_pairs import EH, LOAD, spur, steels

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336 import contact_factors as contact
from gearopt.physics.iso6336 import load_factors as loads
from gearopt.physics.iso6336 import running_in, stiffness
from gearopt.physics.iso6336.accuracy import (
    DIAMETERS,
    MODULES,
    WIDTHS,
    deviations,
    helix_slope_1995,
    profile_form_1995,
    range_mean,
    single_pitch_1995,
)
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.curves import bending_curve, pitting_curve
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate
from gearopt.physics.iso6336.tooth_form import load_sharing, tangent_theta, virtual_gear
from gearopt.physics.tolerances import rounded_tolerance

UM = 1e-3


def test_ranges_of_1995():
    assert range_mean(341.2, DIAMETERS) == pytest.approx(math.sqrt(280.0 * 560.0))
    assert range_mean(280.0, DIAMETERS) == pytest.approx(math.sqrt(125.0 * 280.0))
    assert range_mean(1.0, DIAMETERS) == 10.0 and range_mean(1e5, DIAMETERS) == 8e7**0.5


def test_deviations_of_1995_by_the_tables():
    """d 341.2, m 14, b 360, grade 6: f_pt 14, f_falpha 18 um; d 1350: 17, 22 um (a report)."""
    for diameter, pitch, form in ((341.2, 14.0, 18.0), (1350.5, 17.0, 22.0)):
        size, module = range_mean(diameter, DIAMETERS), math.sqrt(160.0)
        assert rounded_tolerance(single_pitch_1995(size, module, 6.0)) == pytest.approx(pitch * UM)
        assert rounded_tolerance(profile_form_1995(size, module, 6.0)) == pytest.approx(form * UM)
    # 0.07 sqrt(396) + 0.45 sqrt(316.2) + 3 = 12.395 um at grade 5
    assert helix_slope_1995(396.0, 316.2, 5.0) == pytest.approx(12.395 * UM, rel=1e-4)


def test_formulas_of_1995_by_hand():
    """d 100, m 4, b 64 at grade 5, unrounded: 6.4, 7.2 and 7.3 um; twice that at grade 7."""
    assert single_pitch_1995(100.0, 4.0, 5.0) == pytest.approx(6.4 * UM, rel=1e-12)
    assert profile_form_1995(100.0, 4.0, 5.0) == pytest.approx(7.2 * UM, rel=1e-12)
    assert helix_slope_1995(100.0, 64.0, 7.0) == pytest.approx(14.6 * UM, rel=1e-12)


def test_deviations_of_a_pair_by_either_edition():
    """2013: f_pT (0.001 d + 0.4 m + 5) cos(alpha_t) of the wheel, 0.1 + 2 + 5 um = 7 um."""
    pair = GearPair.of_teeth(5.0, 20, 20, 40.0)
    new = deviations(pair, (5.0, 5.0), "2013")
    assert new.base_pitch == pytest.approx(7.0 * UM * math.cos(math.radians(20.0)))
    assert new.profile_form == pytest.approx(8.0 * UM)  # 0.55 m + 5 = 7.75
    assert new.helix_slope == pytest.approx(6.5 * UM)  # 0.05 sqrt(d) + 0.35 sqrt(b) + 4 = 6.71
    assert new.alignment == pytest.approx(6.5 * UM * math.sqrt(2.0))
    worse = deviations(pair, (5.0, 9.0), "2013")
    assert worse.base_pitch == pytest.approx(28.0 * UM * math.cos(math.radians(20.0)))
    with pytest.raises(ValueError, match="no tolerances '1962'; known: 1995, 2013"):
        deviations(pair, (5.0, 5.0), "1962")


@pytest.mark.parametrize(
    ("family", "slow", "middle", "fast"),
    [("V", 0.16, 12.8, 6.4), ("GG", 0.275, 22.0, 11.0), ("Eh", 0.075, 3.0, 3.0)],
)
def test_running_in_of_pitch_deviations(family, slow, middle, fast):
    """160/1000 of 50 um; of 500 um above 5 and above 10 m/s 12800/1000 and 6400/1000 um."""
    law = running_in.pitch_allowance
    expected = min(slow * 50.0, 3.0 if family == "Eh" else math.inf)
    assert law(family, 50.0 * UM, 1000.0, 4e3) == pytest.approx(expected * UM)
    assert law(family, 500.0 * UM, 1000.0, 8e3) == pytest.approx(middle * UM)
    assert law(family, 500.0 * UM, 1000.0, 2e4) == pytest.approx(fast * UM)


@pytest.mark.parametrize(
    ("family", "slow", "middle", "fast"),
    [("St", 0.64, 51.2, 25.6), ("GGG ferritic", 0.55, 45.0, 22.0), ("NT", 0.15, 6.0, 6.0)],
)
def test_running_in_of_helix_deviations(family, slow, middle, fast):
    """320/500 of 30 um; of 500 um above 5 and above 10 m/s 25600/500 and 12800/500 um."""
    law = running_in.helix_allowance
    assert law(family, 30.0 * UM, 500.0, 4e3) == pytest.approx(slow * 30.0 * UM)
    assert law(family, 500.0 * UM, 500.0, 8e3) == pytest.approx(middle * UM)
    assert law(family, 500.0 * UM, 500.0, 2e4) == pytest.approx(fast * UM)


def test_running_in_takes_no_more_than_there_is():
    assert running_in.helix_allowance("V", 10.0 * UM, 200.0, 1e3) == pytest.approx(10.0 * UM)
    assert running_in.pitch_allowance("V", 10.0 * UM, 100.0, 1e3) == pytest.approx(10.0 * UM)
    for speed in (1e3, 8e3, 2e4):
        assert running_in.helix_allowance("GG", 30.0 * UM, 300.0, speed) == pytest.approx(16.5 * UM)


def test_flexibility_by_hand():
    """z_n 20/40, x 0.5/-0.2."""
    terms = (
        (0.04723, 0.15551 / 20, 0.25791 / 40, -0.00635 * 0.5, -0.11654 * 0.5 / 20),
        (0.00193 * 0.2, 0.24188 * 0.2 / 40, 0.00529 * 0.25, 0.00182 * 0.04),
    )
    known = sum(map(sum, terms))
    assert stiffness.flexibility((20.0, 40.0), (0.5, -0.2)) == pytest.approx(known, rel=1e-14)


def test_the_gear_with_fewer_teeth_counts_as_the_pinion():
    ahead = GearPair.of_teeth(4.0, 17, 19, 40.0, profile_shifts=(0.4, 0.1))
    turned = GearPair(ahead.wheel, ahead.pinion)
    one, two = stiffness.theoretical_stiffness(ahead), stiffness.theoretical_stiffness(turned)
    assert one == two


def test_stiffness_of_racks_webs_and_metals():
    """C_B 0.975 and 0.875; cast iron of 103 GPa against steel: E/E_st = 2/3."""
    assert stiffness.rack_factor((Rack(), Rack())) == pytest.approx(0.975)
    assert stiffness.rack_factor((Rack(), Rack(dedendum=1.45))) == pytest.approx(0.925)
    assert stiffness.rack_factor((Rack(math.radians(18.0)),) * 2) == pytest.approx(0.975 * 0.96)
    assert stiffness.blank_factor(0.2, 1.0) == stiffness.blank_factor(0.01, 0.1)
    assert stiffness.blank_factor(1.0, 3.0) == 1.0
    assert stiffness.blank_factor(2.0, 2.0) == pytest.approx(
        1.0 + math.log(1.2) / 5 / math.exp(0.4)
    )
    pair = GearPair.of_teeth(4.0, 20, 40, 40.0)
    steel = stiffness.single_stiffness(pair, 500.0)
    mixed = stiffness.single_stiffness(pair, 500.0, (206000.0, 103000.0))
    assert mixed == pytest.approx(steel * 2.0 / 3.0)
    assert stiffness.single_stiffness(pair, 6.25) == pytest.approx(0.5 * steel)
    assert stiffness.mesh_stiffness(14.0, 1.0) == (14.0, 0.85 * 14.0)
    assert stiffness.mesh_stiffness(14.0, 1.8)[0] == pytest.approx(22.4)


def test_reduced_mass_of_equal_discs():
    """u = 1, no bores: pi/16 rho d_m^4/d_b^2, half of one disc's mass at the base circle."""
    pair = GearPair.of_teeth(4.0, 30, 30, 40.0)
    mean = 0.5 * (pair.pinion.tip_diameter + pair.pinion.root_diameter)
    known = math.pi / 16.0 * 7.83e-9 * mean**4 / pair.pinion.base_diameter**2
    assert stiffness.reduced_mass(pair, (7.83e-9,) * 2, (0.0, 0.0)) == pytest.approx(known)
    assert loads.resonance_speed(20.0, 2e4, 2e-4) == pytest.approx(1e4 / 20.0)


def test_coefficients_of_the_dynamic_factor():
    """eps_gamma 1.6 and 3, by the table of part 1."""
    assert loads.coefficients(1.6) == pytest.approx(
        (0.32, 0.34, 0.23, 0.90, 0.47, 0.47, 0.125 * math.sin(-0.4 * math.pi) + 0.875)
    )
    expected = (0.32, 0.57 / 2.7, 0.096 / 1.44, 0.42 / 1.56, 0.47, 0.12 / 1.26, 1.0)
    assert loads.coefficients(3.0) == pytest.approx(expected)
    assert loads.coefficients(1.2)[6] == pytest.approx(0.75)


def test_dynamic_factor_in_every_range():
    """B 0.5, 0.4, 0.2, eps_gamma 1.4: C_v7 0.75."""
    dynamics = loads.Dynamics(0.5, 0.4, 0.2, 1.4)
    shared = 0.32 * 0.5 + 0.34 * 0.4
    main = 1.0 + shared + 0.9 * 0.2
    high = 0.47 * 0.5 + 0.47 * 0.4 + 0.75
    known = {
        0.5: 1.0 + 0.5 * (shared + 0.23 * 0.2),
        1.0: main,
        1.325: 0.5 * (main + high),
        2.0: high,
    }
    for resonance, factor in known.items():
        assert loads.dynamic_factor(dynamics, resonance, 200.0) == pytest.approx(factor)
    assert loads.lower_limit(25.0) == pytest.approx(0.675) and loads.lower_limit(400.0) == 0.85


def test_face_load_by_hand():
    """w 300 N/mm, b/d1 1: f_sh 6.9 um; F_betax 1.33 6.9 + 10 = 19.177 um."""
    shaft = loads.shaft_misalignment(300.0, 1.0)
    assert shaft == pytest.approx(6.9 * UM)
    found = loads.initial_misalignment(shaft, 10.0 * UM, 300.0, 8.0 * UM)
    assert found == pytest.approx(19.177 * UM)
    assert loads.shaft_misalignment(300.0, 1.0, -1.0) == pytest.approx(300 * 0.023 * 0.6 * UM)
    crowned = loads.initial_misalignment(
        shaft, 10.0 * UM, 300.0, 8.0 * UM, loads.HELIX_MODIFICATIONS["crowned"]
    )
    assert crowned == pytest.approx(14.177 * UM)
    least = loads.initial_misalignment(0.0, 0.0, 300.0, 2.0 * UM)
    assert least == pytest.approx(1.5 * UM)  # 0.005 um w
    assert loads.initial_misalignment(0.0, 0.0, 300.0, 8.0 * UM) == pytest.approx(4.0 * UM)
    assert loads.face_load_factor(15.0 * UM, 16e3, 300.0) == pytest.approx(1.4)
    assert loads.face_load_factor(150.0 * UM, 16e3, 300.0) == pytest.approx(4.0)


def test_root_face_load_by_hand():
    """b/h = 4: N_F = 16/21; below 3 it counts as 3: 9/13."""
    assert loads.root_face_load_factor(1.5, 40.0, 10.0) == pytest.approx(1.5 ** (16 / 21))
    assert loads.root_face_load_factor(1.5, 10.0, 10.0) == pytest.approx(1.5 ** (9 / 13))


def test_transverse_load_by_hand():
    """q = 20e3 0.01/400 = 0.5."""
    law = loads.transverse_load_factor
    assert law(20e3, 0.01, 400.0, 1.6) == pytest.approx(0.8 * 1.1)
    assert law(20e3, 0.01, 400.0, 3.0) == pytest.approx(0.9 + 0.2 * math.sqrt(4.0 / 3.0))
    assert loads.limited(0.9, 1.2) == 1.0 and loads.limited(1.5, 1.2) == 1.2
    assert loads.limited(0.9, 0.8) == 1.0


def test_zone_factor_of_spur_gears():
    """sqrt(2/(cos^2 tan)) = 2.4946 of 20 degrees, in every textbook 2.49 to 2.5."""
    pair = GearPair.of_teeth(4.0, 20, 40, 40.0)
    assert contact.zone_factor(pair) == pytest.approx(2.4946, abs=5e-5)
    assert contact.elasticity_factor((206e3,) * 2, (0.3,) * 2) == pytest.approx(189.8, abs=0.05)
    # steel on cast steel of 202 GPa: 188.9 in the table of DIN 3990
    assert contact.elasticity_factor((206e3, 202e3), (0.3,) * 2) == pytest.approx(188.9, abs=0.05)


def test_lubrication_between_soft_and_hard():
    for limit, c in ((500.0, 0.83), (850.0, 0.83), (1025.0, 0.87), (1200.0, 0.91), (1500.0, 0.91)):
        known = c + 4.0 * (1.0 - c) / (1.2 + 134.0 / 100.0) ** 2
        assert contact.lubricant_factor(limit, 100.0) == pytest.approx(known)
        known = c + 0.02 + 2.0 * (0.98 - c) / math.sqrt(0.8 + 3.2)
        assert contact.velocity_factor(limit, 1e4) == pytest.approx(known)
        power = 0.15 - (c - 0.83) / 0.08 * 0.07
        known = (3.0 / (5.0 * 0.5 ** (1 / 3))) ** power
        assert contact.roughness_factor(limit, 5e-3, 20.0) == pytest.approx(known)


def test_work_hardening():
    assert contact.work_hardening_factor(130.0, 3e-3) == pytest.approx(1.2)
    assert contact.work_hardening_factor(300.0, 3e-3) == pytest.approx(1.1)
    assert contact.work_hardening_factor(600.0, 6e-3) == pytest.approx(0.5**0.15)
    assert contact.static_hardening_factor(470.0) == pytest.approx(1.0)
    assert contact.static_hardening_factor(100.0) == pytest.approx(1.05)
    rough = contact.equivalent_roughness(6e-3, 12e-3, 10.0, 5e3, 300.0)
    assert rough == pytest.approx(6e-3 * 0.5**0.66)
    rough = contact.equivalent_roughness(6e-3, 6e-3, 10.0, 1e4, 300.0)
    assert rough == pytest.approx(6e-3 * 0.5**0.33)
    assert contact.equivalent_roughness(6e-3, 6e-3, 10.0, 5.0, 300.0) == 16e-3
    assert contact.equivalent_roughness(1e-3, 6e-3, 10.0, 5e3, 300.0) == 3e-3
    assert contact.tempered_hardening_factor(300.0, 200.0, 4.0) == pytest.approx(
        1.0 + 3.0 * (0.00898 * 1.5 - 0.00829)
    )
    assert contact.tempered_hardening_factor(220.0, 200.0, 4.0) == 1.0
    assert contact.tempered_hardening_factor(600.0, 200.0, 40.0) == pytest.approx(
        1.0 + 19.0 * (0.00898 * 1.7 - 0.00829)
    )


def test_helix_rim_and_deep_tooth_factors():
    assert bending.helix_factor(math.radians(24.0), 0.5) == pytest.approx(0.9)
    assert bending.helix_factor(math.radians(-40.0), 3.0) == pytest.approx(0.75)
    assert bending.rim_factor(1.2) == 1.0
    assert bending.rim_factor(1.2 - 1e-9) == pytest.approx(1.0, abs=2e-4)
    assert bending.rim_factor(0.6) == pytest.approx(1.6 * math.log(2.242 / 0.6))
    assert bending.deep_tooth_factor(2.3, 5.0) == bending.deep_tooth_factor(2.0, 3.0) == 1.0
    assert bending.deep_tooth_factor(2.3, 4.0) == pytest.approx(2.366 - 0.666 * 2.3)
    assert bending.deep_tooth_factor(2.6, 3.0) == 0.7


def test_notch_surface_and_size_factors():
    assert bending.notch_factor(0.0281, 2.5) == 1.0
    assert bending.slip_layer("V", 700.0) == pytest.approx(0.5 * (0.0194 + 0.0064))
    assert bending.slip_layer("V", 2000.0) == 0.0014 and bending.slip_layer("NT", 0.0) == 0.1005
    assert bending.slip_layer("GG", 150.0) == 0.3124
    for family in ("St", "V", "Eh", "NT", "GTS", "GG"):
        assert bending.static_notch_factor(family, 2.0, 600.0) == pytest.approx(1.0)
    assert bending.static_notch_factor("Eh", 2.5, 0.0) == pytest.approx(0.44 * 2.5 + 0.12)
    assert bending.static_notch_factor("NV", 2.5, 0.0) == pytest.approx(0.20 * 2.5 + 0.60)
    slope = 0.82 * (300.0 / 600.0) ** 0.25
    known = (1.0 + slope * 1.5) / (1.0 + slope)
    assert bending.static_notch_factor("V", 2.5, 600.0) == pytest.approx(known)
    slope = 0.93 * (200.0 / 400.0) ** 0.25
    known = (1.0 + slope * 1.5) / (1.0 + slope)
    assert bending.static_notch_factor("St", 2.5, 400.0) == pytest.approx(known)
    for family, low, high in (("V", 1.107, 0.907), ("St", 1.074, 0.944), ("NT", 1.027, 0.969)):
        assert bending.surface_factor(family, 1e-3) == pytest.approx(low, abs=1e-3)
        assert bending.surface_factor(family, 40e-3) == pytest.approx(high, abs=1e-3)
    assert bending.surface_factor("Eh", 0.5e-3) == 1.12
    for family, at, end in (("V", 0.97, 0.85), ("IF", 0.95, 0.80), ("GG", 0.925, 0.70)):
        assert bending.size_factor(family, 5.0) == bending.size_factor(family, 1.0) == 1.0
        assert bending.size_factor(family, 10.0) == pytest.approx(at)
        assert bending.size_factor(family, 50.0) == pytest.approx(end)


def test_load_sharing_of_2019():
    assert load_sharing(1.6, 0.0) == 1.0 and load_sharing(2.1, 0.0) == 0.7
    assert load_sharing(1.6, 1.0) == load_sharing(1.6, 3.0) == pytest.approx(1.6**-0.5)
    assert load_sharing(1.6, 0.5) == pytest.approx(math.sqrt(0.5 + 0.5 / 1.6))
    assert load_sharing(2.2, 0.5) == pytest.approx(math.sqrt(0.25 + 0.5 / 2.2))


@pytest.mark.parametrize("teeth", [12, 20, 50, 200])
@pytest.mark.parametrize("shift", [-0.3, 0.0, 0.8])
def test_the_tangent_is_at_30_degrees(teeth, shift):
    """The slope of the fillet of the rack itself, by differences of its points."""
    from gearopt.physics.geometry.fillet import fillet_point

    gear = GearPair.of_teeth(3.0, teeth, teeth, 30.0, profile_shifts=(shift, 0.0)).pinion
    virtual = virtual_gear(gear)
    angle = math.pi / 2.0 - tangent_theta(virtual)
    above, below = (fillet_point(virtual, angle + h) for h in (1e-6, -1e-6))
    slope = math.atan2(abs(above.x - below.x), abs(above.y - below.y))
    assert slope == pytest.approx(math.radians(30.0), abs=1e-6)


def test_ranges_of_sizes_are_those_of_iso_1328():
    """Every end, from below and above: the mean jumps there, and nowhere between."""
    for ends, known in (
        (DIAMETERS, (5, 20, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6000, 8000, 10000)),
        (MODULES, (0.5, 2, 3.5, 6, 10, 16, 25, 40, 70)),
        (WIDTHS, (4, 10, 20, 40, 80, 160, 250, 400, 650, 1000)),
    ):
        for low, high in zip(known[:-1], known[1:], strict=True):
            for size in (low * 1.0001, high):
                assert range_mean(size, ends) == pytest.approx(math.sqrt(low * high), rel=1e-12)


def test_ends_of_tables():
    """Slip layers and deep teeth hold still beyond the ends of their tables."""
    assert bending.slip_layer("St", 300.0) == bending.slip_layer("St", 200.0) == 0.0833
    assert bending.slip_layer("St", 350.0) == pytest.approx(0.5 * (0.0833 + 0.0445))
    assert bending.slip_layer("V", 500.0) == bending.slip_layer("V", 400.0) == 0.0281
    assert bending.slip_layer("V", 600.0) == 0.0194 and bending.slip_layer("V", 800.0) == 0.0064
    assert bending.slip_layer("V", 550.0) == pytest.approx(0.5 * (0.0281 + 0.0194))
    assert bending.slip_layer("V", 900.0) == pytest.approx(0.5 * (0.0064 + 0.0014))
    assert bending.slip_layer("GG", 300.0) == bending.slip_layer("GGG ferritic", 400.0) == 0.3095
    assert bending.slip_layer("GG", 225.0) == pytest.approx(0.5 * (0.3124 + 0.3095))
    assert bending.deep_tooth_factor(2.5, 4.0) == pytest.approx(2.366 - 0.666 * 2.5)
    assert bending.deep_tooth_factor(2.051, 4.0) == pytest.approx(2.366 - 0.666 * 2.051)
    for families, known in (
        (("St", "V", "GTS", "GGG", "Eh", "IF"), ((1e5, 1.6), (5e7, 1.0), (1e10, 0.85))),
        (("GG", "GGG ferritic", "NT", "NV"), ((1e5, 1.3), (2e6, 1.0), (1e10, 0.85))),
    ):
        for family in families:
            curve = pitting_curve(family)
            assert tuple(zip(curve.cycles, curve.values, strict=True)) == known
    for families, first in (
        (("St", "V", "GTS", "GGG"), (1e4, 2.5)),
        (("Eh", "IF"), (1e3, 2.5)),
        (("GG", "GGG ferritic", "NT", "NV"), (1e3, 1.6)),
        (("NV nitrocarburised",), (1e3, 1.1)),
    ):
        for family in families:
            curve = bending_curve(family)
            known = (first, (3e6, 1.0), (1e10, 0.85))
            assert tuple(zip(curve.cycles, curve.values, strict=True)) == known


def test_parts_of_helix_modifications():
    """B_1 and B_2: f_sh 100 and f_ma 1000 um count apart."""
    parts = {
        "none": (1.0, 1.0),
        "crowned": (1.0, 0.5),
        "crowned for deflection": (0.5, 0.5),
        "helix corrected": (0.1, 1.0),
        "helix corrected and crowned": (0.1, 0.5),
        "end relief": (0.7, 0.7),
    }
    assert set(parts) == set(loads.HELIX_MODIFICATIONS)
    for word, (first, second) in parts.items():
        found = loads.initial_misalignment(0.1, 1.0, 1.0, 0.0, loads.HELIX_MODIFICATIONS[word])
        assert found == pytest.approx(0.133 * first + second)
    assert contact.PROFILE_MODIFICATIONS == {"none": 1.2, "by experience": 1.07, "by analysis": 1.0}


@pytest.mark.parametrize(
    ("name", "hardness", "known"),
    [("St", 150.0, 264.0), ("V carbon", 200.0, 480.0), ("GTS", 200.0, 416.0), ("GG", 180.0, 150.0)],
)
def test_estimated_yield_points(name, hardness, known):
    """3.2 MPa a unit of hardness, 0.55 of it (St), 0.75 (V), 0.65 (GTS); GG by its two grades."""
    assert Material(name, "MQ", hardness).strength_for_notches == pytest.approx(known)


def test_the_table_of_coefficients_jumps_at_a_total_ratio_of_2():
    below, above = loads.coefficients(2.0), loads.coefficients(2.0 + 1e-12)
    jumps = [b / a - 1.0 for a, b in zip(below, above, strict=True)]
    assert jumps == pytest.approx([0.0, -0.0138, -0.0514, -0.0675, 0.0, -0.0180, 0.0], abs=1e-4)


@pytest.mark.parametrize("word", loads.HELIX_MODIFICATIONS)
def test_light_ends_leave_the_root_the_factor_of_the_flank(word):
    """K_Fbeta = K_Hbeta with crowning or end relief. Source: IACS UR M56, 1.6.4."""
    found = rate(spur(), LOAD, steels(EH), Practice(helix_modification=word)).factors
    flank, root = found["K_Hbeta"].value, found["K_Fbeta"].value
    assert root == flank if "crowned" in word or "relief" in word else 1.0 < root < flank


@pytest.mark.parametrize(
    ("name", "verified"),
    [("St", True), ("St cast", False), ("V alloy", True), ("V cast alloy", False)],
)
def test_strengths_of_cast_steels_are_unverified(name, verified):
    steel = Material(name, "ME", 205.0, yield_strength=600.0)
    found = rate(spur(), LOAD, steels(steel)).factors
    assert found["sigma_Hlim"].verified == found["sigma_Flim"].verified == verified
