"""Hertz's pressure, rim stress and equal shares of a strain wave gearing."""

import math
from dataclasses import replace

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
    stresses = rim_stresses(BASE, bent(BASE), 1e5, 206e3, 1.6, 0.6)
    mean, lift = 39.6186, 0.5064  # mm, of another program: rho = mean + lift cos(2 p)
    ends = [(mean + 5.0 * s * lift) / (mean + s * lift) ** 2 for s in (1.0, -1.0)]
    by_hand = 1.6 * 206e3 * 0.4 * 0.5 * (ends[0] - ends[1])
    assert stresses == pytest.approx((by_hand, 33.79), rel=3e-4)
    assert rim_utilisation(stresses, (400.0, 230.0), 1.5) == pytest.approx(0.527, abs=1e-3)
    thin = 1.6 * 206e3 * 0.4 * 3.0 * 0.5 / 39.625**2  # a thin ring, small deflection
    assert stresses[0] == pytest.approx(thin, rel=0.015)
    slope = -math.tan(flank(BASE).contacts.direction.angle[-1])
    assert ratcheting_torque(BASE, 3e3, slope) == pytest.approx(331e3, rel=2e-3)


def bent(gearing):
    curve = flank(gearing, 7).curve
    return tuple(curvature(curve, angle)[0] for angle in (0.0, 0.5 * math.pi))


def test_discs_bend_the_rim_most_where_they_do_not_touch_it():
    """Thin rings: w + w'' is C_1 on the discs of 30 degrees and A + B on the minor axis."""
    discs = replace(BASE, wave="discs")
    on_disc, beside = (abs(k * 39.625 - 1.0) * 39.625 / 0.5 for k in bent(discs))
    assert (on_disc, beside) == pytest.approx((2.4467, 11.2237 - 8.0586), rel=0.05)
    stress, _ = rim_stresses(discs, bent(discs), 1e5, 206e3, 1.6, 0.6)
    thin = 1.6 * 206e3 * 0.4 * 0.5 * (2.4467 + 3.1651) * 0.5 / 39.625**2
    assert stress == pytest.approx(thin, rel=0.02)
