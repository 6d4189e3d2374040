"""Hertz's pressure, rim stress and equal shares of a strain wave gearing."""

import math

import numpy as np
import pytest

from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import curvature
from gearopt.physics.strain_wave.strength import (
    contact_modulus,
    equal_share,
    hertz_pressure,
    ratcheting_torque,
    rim_stresses,
    rim_utilisation,
)

BASE = StrainWave(0.5, 160, profile_shift=0.9)
STEEL = contact_modulus((206e3, 206e3), (0.3, 0.3))


def test_the_papers_form_is_hertz():
    """q 100 N/mm, R 350 mm: 2 pi with its E, which is 2 E*, is pi with E*."""
    mean = 1.0 / (0.5 * 2.0 * (1.0 - 0.3**2) / 206e3)
    paper = math.sqrt(100.0 * mean / (2.0 * math.pi * 350.0))
    assert hertz_pressure(100.0, STEEL, 1.0 / 350.0) == pytest.approx(paper, rel=1e-14)
    half_width = 2.0 * math.sqrt(100.0 * 350.0 / (math.pi * STEEL))
    assert hertz_pressure(100.0, STEEL, 1 / 350.0) == pytest.approx(
        2 * 100 / (math.pi * half_width)
    )


def test_a_flat_contact_has_no_pressure():
    assert hertz_pressure(100.0, STEEL, 0.0) == 0.0


def test_stress_falls_with_the_profile_shift_without_an_end():
    """x, pairs, least R, pressure at N and at the whole pairs: no least stress in between."""
    rows = [
        (0.0, 1.183, 279, 119.8, 130.4),
        (0.6, 1.123, 302, 118.1, 125.2),
        (0.9, 1.096, 313, 117.4, 122.9),
        (1.2, 1.072, 325, 116.7, 120.8),
        (1.8, 1.028, 346, 115.3, 116.9),
    ]
    found = []
    for x, pairs, radius, mean, whole in rows:
        made = flank(StrainWave(0.5, 160, profile_shift=x))
        gap, arm = made.contacts.gap_curvature.max(), made.gearing.base_radius
        loads = [equal_share(1e5, arm, n) / 10.0 for n in (made.pairs_in_contact, 1.0)]
        stresses = [hertz_pressure(q, STEEL, gap) for q in loads]
        assert made.pairs_in_contact == pytest.approx(pairs, abs=6e-4)
        assert 1.0 / gap == pytest.approx(radius, abs=0.6)
        assert stresses == pytest.approx([mean, whole], abs=0.06)
        found.append(stresses)
    assert (np.diff(np.array(found), axis=0) < 0.0).all()


def test_the_rim_of_the_base_case():
    curve = flank(BASE, 7).curve
    apex = curvature(curve, 0.0)[0]
    stresses = rim_stresses(BASE, apex, 1e5, 206e3, 1.6, 0.6)
    assert stresses == pytest.approx((124.0, 34.0), abs=0.6)
    assert rim_utilisation(stresses, (400.0, 230.0), 1.5) == pytest.approx(0.52, abs=5e-3)
    thin = 1.6 * 206e3 * 0.4 * 3.0 * 0.5 / 39.625**2  # a thin ring, small deflection
    assert stresses[0] == pytest.approx(thin, rel=0.03)
    slope = -math.tan(flank(BASE).contacts.direction.angle[-1])
    assert ratcheting_torque(BASE, 3e3, slope) == pytest.approx(331e3, rel=2e-3)
