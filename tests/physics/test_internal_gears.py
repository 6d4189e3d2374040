"""Gears with negative teeth: prints of two wind gearboxes, and a handbook's internal pair."""

import math

import numpy as np
import pytest

from gearopt.physics.gears import ISO_53_A, Cutter, GearPair, Rack, is_internal, replace

# KISSsoft 03/2017 report of a 5 MW gearbox, stage 2, in github.com/gfsReboucas/Drivetrain
# (@NREL_5MW/stage_02.rtf); the mass is that of the tube from (d_a + d_f)/2 to 2148.82 mm.
RACKS = ISO_53_A, Rack(tip_radius=0.3)


def printed_pair(**changes: object) -> GearPair:
    """The planet and the ring of the printed stage, the planet's tip as printed."""
    pair = GearPair.internal(
        21.0, 36, -93, 550.0, 0.0, RACKS, (0.5039, 0.1171), working_distance=-584.0
    )
    shorter = (815.663 - pair.pinion.tip_diameter) / 42.0
    planet = replace(pair.pinion, tip_alteration=shorter)
    return GearPair(planet, replace(pair.wheel, **changes), -584.0)


def test_a_printed_planet_and_ring() -> None:
    pair = printed_pair()
    assert math.degrees(pair.working_angle) == pytest.approx(15.630, abs=6e-4)
    assert pair.wheel.tip_diameter == pytest.approx(-1906.081, abs=1e-3)
    assert pair.wheel.root_diameter == pytest.approx(-2000.581, abs=1e-3)
    assert pair.transverse_contact_ratio == pytest.approx(1.618, abs=5e-4)
    assert is_internal(pair.wheel_teeth) and not is_internal(pair.pinion_teeth)


def test_the_tube_of_the_printed_ring_has_the_printed_mass_and_inertia() -> None:
    ring = printed_pair(body_diameter=-1953.331, outside_diameter=-2148.82).wheel
    assert 1e3 * ring.mass(7.83e-9) == pytest.approx(2712.328, rel=2e-4)
    assert ring.inertia(7.83e-9) / 1e3 == pytest.approx(2859.10528, rel=2e-4)


def test_shifts_of_a_helical_stage_give_its_centre_distance() -> None:
    # first stage of a 10 MW gearbox, github.com/gfsReboucas/Drivetrain
    shifts = 0.2093, -0.1591
    pair = GearPair.internal(30.0, 31, -89, 800.0, math.radians(8.0), profile_shifts=shifts)
    assert pair.centre_distance == pytest.approx(-877.033, abs=2e-3)
    assert math.degrees(pair.working_angle) == pytest.approx(19.9096, abs=5e-4)


def test_a_planet_and_ring_without_shifts() -> None:
    # sample of the REXS library (github.com/fva-net/rexs-api-java): 22/61, m 4, a 78
    pair = GearPair.internal(4.0, 22, -61, 50.0, cutter=Cutter(23))
    assert pair.centre_distance == pytest.approx(-78.0, rel=1e-15)
    assert pair.wheel.root_diameter == pytest.approx(-254.0, rel=1e-15)


def test_a_handbook_pair_as_numbers_and_arrays() -> None:
    # handbook of a maker of stock gears, table of internal gears; eps_alpha recomputed elsewhere
    pair = GearPair.internal(3.0, 16, -24, 1.0, profile_shifts=(0.0, -0.5))
    teeth = np.array([16.0, 16.0]), np.array([-24.0, -24.0])
    many = GearPair.internal(3.0, *teeth, 1.0, profile_shifts=(0.0, -0.5))
    assert math.degrees(pair.working_angle) == pytest.approx(31.0937, abs=1e-4)
    assert pair.centre_distance == pytest.approx(-13.1683, abs=5e-5)
    assert pair.working_diameters == pytest.approx((52.673, -79.010), abs=5e-4)
    diameters = pair.wheel.tip_diameter, pair.wheel.root_diameter, pair.wheel.base_diameter
    assert diameters == pytest.approx((-69.0, -82.5, -67.658), abs=5e-4)
    assert pair.transverse_contact_ratio == pytest.approx(1.679497, abs=1e-5)
    assert np.all(many.transverse_contact_ratio == pair.transverse_contact_ratio)


def test_a_cutter_cuts_as_deep_as_its_tips_reach() -> None:
    # without shifts the cutter rolls on the reference circles, and its addendum is the dedendum
    pair = GearPair.internal(2.0, 20, -60, 1.0, cutter=Cutter(25, 0.0, 1.25, 0.2))
    assert pair.wheel.root_diameter == pytest.approx(-125.0, rel=1e-15)
    # worn by x_0 and set for the same reference circles: no shift in sum, the same depth
    worn = replace(pair.wheel, cutter=Cutter(25, -0.1, 1.25, 0.2), profile_shift=0.1)
    assert worn.root_diameter == pytest.approx(-(70.0 + 2.0 * (25.0 + 2.0 * 1.15)), rel=1e-15)


def test_positive_teeth_are_no_ring_and_external_pairs_take_none() -> None:
    with pytest.raises(ValueError, match="negative"):
        GearPair.internal(2.0, 20, 60, 1.0)
    with pytest.raises(ValueError, match="only external"):
        GearPair.of_teeth(2.0, 20, -60, 1.0)
