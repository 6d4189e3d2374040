"""Stress cycle factors against worked examples; lives as inverses."""

import math

import numpy as np
import pytest

from gearopt.physics.agma.life import (
    KINDS,
    SERVICES,
    bending_curve,
    cycles_of,
    pitting_curve,
)

CURVES = [
    *(bending_curve(kind, 330.0, service) for kind in KINDS for service in SERVICES),
    *(pitting_curve(kind, service) for kind in KINDS for service in SERVICES),
]


def test_factors_of_an_example():
    """Shigley 14-4, 1e8 cycles of the pinion, u 52/17: Y_N 0.977, 0.996; Z_N 0.948, 0.973."""
    cycles = np.array([1e8, 1e8 * 17 / 52])
    bent = bending_curve("through-hardened", 240.0).factor(cycles)
    assert bent == pytest.approx([0.977, 0.996], abs=6e-4)
    pressed = pitting_curve("through-hardened").factor(cycles)
    assert pressed == pytest.approx([0.948, 0.973], abs=6e-4)


# Digest of the profile modification paper, section 9: kind, HB, A, B below 3e6 cycles; of pitting
SHORT = [
    ("through-hardened", 160.0, 2.3194, 0.0538),
    ("through-hardened", 250.0, 4.9404, 0.1045),
    ("through-hardened", 400.0, 9.4518, 0.148),
    ("carburised", 0.0, 6.1514, 0.1192),
    ("nitrided", 0.0, 3.517, 0.0817),
]
LONG = {"general": (1.3558, 0.0178), "critical": (1.6831, 0.0323)}
PRESSED = [
    ("carburised", "general", 1e5, 2.466, 0.056),
    ("carburised", "general", 1e9, 1.4488, 0.023),
    ("carburised", "critical", 1e9, 2.466, 0.056),
    ("nitrided", "general", 1e5, 1.249, 0.0138),
    ("nitrided", "general", 1e9, 1.4488, 0.023),
]


@pytest.mark.parametrize(("kind", "hardness", "a", "b"), SHORT)
def test_bending_curves_by_their_constants(kind, hardness, a, b):
    for service, (c, d) in LONG.items():
        curve = bending_curve(kind, hardness, service)
        for cycles in (1e3, 3e4):
            assert curve.factor(cycles) == pytest.approx(a / cycles**b, rel=1e-12)
        assert curve.factor(1e9) == pytest.approx(c / 1e9**d, rel=1e-12)
        assert curve.factor(10.0) == curve.factor(1e3)


@pytest.mark.parametrize(("kind", "service", "cycles", "a", "b"), PRESSED)
def test_pitting_curves_by_their_constants(kind, service, cycles, a, b):
    curve = pitting_curve(kind, service)
    assert curve.factor(cycles) == pytest.approx(a / cycles**b, rel=1e-12)
    assert curve.factor(10.0) == curve.factor(1e4) > curve.factor(1.01e4)


def test_short_lives_of_the_figure():
    """Left ends of the charts, at 1000 cycles: 160, 250, 400 HB, carburised, nitrided."""
    for hardness, value in ((160, 1.6), (250, 2.4), (400, 3.4)):
        assert bending_curve("through-hardened", hardness).factor(1e3) == pytest.approx(value, 0.01)
    assert bending_curve("carburised").factor(1e3) == pytest.approx(2.7, abs=0.01)
    assert bending_curve("nitrided").factor(1e3) == pytest.approx(2.0, abs=0.01)
    assert pitting_curve("carburised").factor(1e4) == pytest.approx(1.47, abs=0.01)
    assert pitting_curve("nitrided").factor(1e4) == pytest.approx(1.10, abs=0.01)


@pytest.mark.parametrize("curve", CURVES)
def test_curves_fall_without_a_step_and_have_an_inverse(curve):
    cycles = np.logspace(math.log10(curve.shortest), 10, 20001)
    factors = curve.factor(cycles)
    assert (np.diff(factors) < 0).all()
    assert np.abs(np.diff(np.log(factors))).max() < 0.15 * np.diff(np.log(cycles)).max()
    assert np.allclose(curve.life(factors), cycles, rtol=1e-9, atol=0)
    assert curve.life(float(factors[0]) * 1.001) == 0.0
    assert curve.factor(0.01 * curve.shortest) == pytest.approx(factors[0], rel=1e-15)


@pytest.mark.parametrize("cycles", [1e7, 3e6])
def test_the_join_is_that_of_the_figure(cycles):
    """Within 3e-4 of 1 at 1e7 in pitting; of 1.04 at 3e6 cycles in bending."""
    for curve in CURVES:
        wanted = 1.0397 if curve.shortest == 1e3 else 1.0
        at = 3e6 if curve.shortest == 1e3 else 1e7
        assert curve.factor(at) == pytest.approx(wanted, abs=3e-4)


def test_between_hardnesses_curves_lie_between():
    low, middle, high = (bending_curve("through-hardened", h).factor(1e4) for h in (250, 300, 400))
    assert low < middle < high
    assert bending_curve("through-hardened", 500).factor(1e4) == high


def test_words_without_a_curve_are_refused():
    with pytest.raises(ValueError, match="through-hardened"):
        bending_curve("soft")
    with pytest.raises(ValueError, match="critical"):
        pitting_curve("nitrided", "perfect")


def test_cycles_by_hand():
    assert cycles_of(1000.0, 1500.0, 2.0) == 2.0 * cycles_of(1000.0, 1500.0) == 1.8e8
