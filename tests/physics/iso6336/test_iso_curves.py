"""Life curves of parts 2 and 3 by their knots, their inverse, and yield points."""

import math

import numpy as np
import pytest

from gearopt.physics.iso6336.curves import Curve, bending_curve, pitting_curve, reference_share
from gearopt.physics.iso6336.materials import Material


def test_curves_and_their_inverse():
    """Z_NT 1.6 to 1e5, 1 at 5e7, 0.85 at 1e10; Y_NT of V 2.5 at 1e4, NT 1.6 at 1e3."""
    curve = pitting_curve("Eh")
    assert curve.factor(1.0) == pytest.approx(1.6) and curve.factor(1e12) == pytest.approx(0.85)
    assert curve.factor(math.sqrt(1e5 * 5e7)) == pytest.approx(math.sqrt(1.6))
    for cycles in (2e5, 3e6, 4e8, 9e9):
        assert curve.life(curve.factor(cycles)) == pytest.approx(cycles, rel=1e-9)
    assert curve.life(1.61) == 0.0 and curve.life(0.84) == math.inf
    assert bending_curve("V").factor(1e4) == pytest.approx(2.5)
    assert bending_curve("NT").factor(1e3) == pytest.approx(1.6)
    assert bending_curve("NV nitrocarburised").factor(10.0) == pytest.approx(1.1)
    assert pitting_curve("GG").factor(2e6) == pytest.approx(1.0)
    assert pitting_curve("NV nitrocarburised").factor(1e5) == pytest.approx(1.1)


def test_limited_pitting_and_the_best_material():
    limited = pitting_curve("V", limited=True)
    for cycles, factor in ((6e5, 1.6), (1e7, 1.3), (1e9, 1.0), (1e10, 0.85)):
        assert limited.factor(cycles) == pytest.approx(factor)
    assert pitting_curve("NT", limited=True) == pitting_curve("NT")
    best = pitting_curve("Eh", lowest=1.0)
    assert best.factor(1e10) == 1.0 and best.life(0.99) == math.inf


def test_other_factors_follow_the_life_factor():
    """Half-way in log-log from static to reference: the geometric mean of the two."""
    curve = pitting_curve("Eh")
    assert reference_share(curve, 1e3) == 0.0 and reference_share(curve, 1e9) == 1.0
    assert reference_share(curve, math.sqrt(1e5 * 5e7)) == pytest.approx(0.5)
    steps = Curve((1e3, 1e6), (np.array([2.0, 4.0]), np.array([1.0, 1.0])))
    assert steps.factor(1e3) == pytest.approx([2.0, 4.0])
    assert steps.life(np.array([1.5, 5.0]))[1] == 0.0


def test_yield_points_are_estimated_where_they_are_not_given():
    assert Material("V alloy", "ML", 300.0).strength_for_notches == pytest.approx(720.0)
    assert Material("V alloy", "ML", 300.0, yield_strength=800.0).strength_for_notches == 800.0
    assert Material("GG", "MQ", 220.0).strength_for_notches == 300.0
