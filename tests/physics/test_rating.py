"""Miner's sum and load spectra by hand, whatever the standard."""

import math

import numpy as np
import pytest

from gearopt.physics.agma.life import bending_curve, pitting_curve
from gearopt.physics.iso6336.curves import pitting_curve as iso_curve
from gearopt.physics.rating import Level, damage, governing, miner_sum, spectrum_safety

BENT, PRESSED = bending_curve("carburised"), pitting_curve("carburised")


def levels(curve, *rows):
    """Levels of cycles and stresses relative to the allowable stress."""
    return [Level(cycles, curve, stress) for cycles, stress in rows]


def test_miners_sum_by_hand():
    assert miner_sum((1e6, 2e6, 0.0), (4e6, 4e6, 0.0)) == pytest.approx(0.75)
    assert miner_sum((1.0,), (0.0,)) == math.inf


def test_one_level_is_a_plain_load():
    known = 380.0 * BENT.factor(1e6) / 200.0
    assert spectrum_safety(levels(BENT, (1e6, 200 / 380))) == pytest.approx(known, rel=1e-14)
    halves = levels(BENT, (5e5, 200 / 380), (5e5, 200 / 380))
    assert spectrum_safety(halves) == pytest.approx(known, rel=1e-12)


def test_two_levels_by_hand():
    """On the short branch, N = (A/Y)^(1/B): the sum of n_i (f s_i)^(1/B) is (A s_at)^(1/B)."""
    a, b = BENT.short
    rows = (1e5, 500.0), (2e5, 400.0)
    expected = a * 380.0 * sum(n * s ** (1 / b) for n, s in rows) ** -b
    made = levels(BENT, *((n, s / 380.0) for n, s in rows))
    found = spectrum_safety(made)
    assert found == pytest.approx(expected, rel=1e-12)
    assert damage(made, found) == pytest.approx(1.0, rel=1e-9)


def test_a_level_without_cycles_or_load_changes_nothing():
    one = spectrum_safety(levels(PRESSED, (1e8, 0.7)))
    assert spectrum_safety(levels(PRESSED, (1e8, 0.7), (0.0, 7.0), (1e9, 0.0))) == one
    assert spectrum_safety(levels(PRESSED, (0.0, 0.7))) == math.inf


def test_levels_with_curves_of_their_own():
    """A level on a curve twice as strong counts as one of half the stress."""
    own = [Level(1e5, BENT, 1.2), Level(2e5, PRESSED, 0.9)]
    assert damage(own) == pytest.approx(1e5 / BENT.life(1.2) + 2e5 / PRESSED.life(0.9))
    assert damage(own, spectrum_safety(own)) == pytest.approx(1.0, rel=1e-9)


def test_many_spectra_at_once():
    """Arrays row by row as floats; what is no number stays none."""
    rng = np.random.default_rng(1)
    cycles, stresses = 10.0 ** rng.uniform(2.0, 9.0, (3, 40)), rng.uniform(0.3, 1.5, (3, 40))
    cycles[0, :5], stresses[1, 5:10], stresses[2, 39] = 0.0, 0.0, np.nan
    for curve in (
        BENT,
        PRESSED,
        pitting_curve("nitrided"),
        iso_curve("Eh"),
        iso_curve("GG", lowest=1.0),
    ):
        found = spectrum_safety(levels(curve, *zip(cycles, stresses, strict=True)))
        for k in range(39):
            rows = zip(cycles[:, k], stresses[:, k], strict=True)
            made = levels(curve, *((float(n), float(s)) for n, s in rows))
            assert found[k] == pytest.approx(spectrum_safety(made), rel=1e-14)
            assert damage(made, found[k] * (1.0 - 1e-9)) <= 1.0
            assert damage(made, found[k] * (1.0 + 1e-9)) > 1.0
        assert np.isnan(found[39])


def test_what_governs_is_compared_by_load():
    """S_H^2 of 1.44 lies below S_F of 1.5."""
    assert governing((1.5, 2.0), (1.3, 1.2)) == (pytest.approx(1.44), ("wheel", "contact"))
    assert governing((1.4, 2.0), (1.3, 1.2)) == (1.4, ("pinion", "bending"))
