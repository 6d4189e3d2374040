"""Load spectra as what rated stages carry: Miner's sum of arrays, in rows and in the search."""

from dataclasses import replace

import numpy as np
import pytest
from rated_brute_force import least_share
from rated_drives import MODULES, RACK, TIED, F, agma, iso, rated_drive

from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.search import search, within
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.strength.standard import Load, Option
from gearopt.optimise.result import Budget
from gearopt.physics.agma.rating import rate_spectrum as agma_spectrum
from gearopt.physics.iso6336.rating import rate_spectrum as iso_spectrum

LEVELS = Load(500.0, 1.3), Load(9000.0, 0.8, 0.9), Load(9000.0, 0.4, 1.1)
AGMA, ISO = replace(agma(), loads=LEVELS), replace(iso(), loads=LEVELS)
Z1, Z2 = np.array([20.0, 25.0, 31.0]), np.array([61.0, 60.0, 90.0])
MODULE, TORQUE, POWER = np.array([2.0, 3.0, 4.0]), np.array([4e4, 1.5e5, 9e5]), 9e6
WIDTH = np.array([30.0, 50.0, 80.0])


def pair(width=WIDTH):
    return Toothing(0.3, (RACK, RACK)).pair(MODULE, Z1, Z2, width)


@pytest.mark.parametrize("standard, rated", [(AGMA, agma_spectrum), (ISO, iso_spectrum)])
def test_safety_factors_of_rows_are_those_of_one_pair(standard, rated):
    found = np.array(standard.safeties(pair(), TORQUE, POWER / TORQUE))
    made = standard.materials if standard is ISO else standard.steels
    for k in range(3):
        one = Toothing(0.3, (RACK, RACK)).pair(MODULE[k], Z1[k], Z2[k], WIDTH[k])
        speed = POWER / TORQUE[k]
        operations = tuple(load.of(standard.operation, TORQUE[k], speed) for load in LEVELS)
        alone = rated(one, operations, made, standard.practice)
        expected = (*alone.bending_safety, *alone.contact_safety)
        np.testing.assert_allclose(found[:, k], expected, rtol=1e-12)


def test_rows_of_agma_scale_with_one_solution():
    """K_m, I, J and K_s are those of all levels, so that one root serves every width."""
    speed = POWER / TORQUE
    rows = AGMA.rows(AGMA.prepared(pair(1.0)), pair(1.0), (TORQUE,) * 2, (speed,) * 2, (1.2, 1.1))
    for factor in (0.7, 1.0, 1.6):
        made = AGMA.safeties(pair(WIDTH * factor), TORQUE, speed)
        used = np.max([1.2 / np.array(made[:2]), (1.1 / np.array(made[2:])) ** 2], axis=(0, 1))
        np.testing.assert_allclose(rows.used(WIDTH * factor, WIDTH * factor), used, rtol=1e-12)


@pytest.mark.parametrize("standard", [AGMA, ISO])
def test_life_factors_that_are_given_are_refused(standard):
    wrong = replace(standard, given={"Y_NT": (1.0, 1.0), "Y_N": (1.0, 1.0)})
    with pytest.raises(ValueError, match="follow from the levels"):
        wrong.safeties(pair(), TORQUE, POWER / TORQUE)
    with pytest.raises(ValueError, match="follow from the levels"):
        wrong.rows(wrong.prepared(pair()), pair(), (TORQUE,) * 2, (POWER / TORQUE,) * 2, (1.0, 1.0))


@pytest.mark.slow
@pytest.mark.parametrize("standards", [(AGMA,), (replace(ISO, suffix="_iso"),)])
def test_the_best_under_a_spectrum_is_that_of_all_candidates(standards):
    choice = {"pinion_teeth": (20, 22), "modules": MODULES[4:9]}
    train = rated_drive(F(3), [TIED], options=(Option(standards),), **choice)
    found = search(train, 1, Budget())
    pairs = [
        (z1, z2)
        for z1, start, stop in spans(train, 0, train.highest_ratio)
        for z2 in range(start, stop + 1)
        if within(train, ((z1, z2),))
    ]
    best = min(least_share(train, 0, train.torque, *pair) for pair in pairs)
    assert found.found[0][0] == pytest.approx(best, rel=1e-11)
