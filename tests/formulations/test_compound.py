"""The compound train: against full enumeration, and Sandgren's published optimum."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from gearopt.formulations.compound import Compound, nearest, problem
from gearopt.optimise.solve import solve


def test_sandgrens_optimum():
    result = solve(problem(Compound(Fraction(6931, 1000), (12, 60))))
    assert result.status == "optimal" and result.gap < 1e-8
    assert result.value == pytest.approx(2.7008571488865134e-12, rel=1e-9)
    assert result.design["teeth"] == [16, 19, 43, 49]


@pytest.mark.parametrize("seed", range(20))
def test_it_is_what_full_enumeration_finds(seed):
    rng = np.random.default_rng(seed)
    low = int(rng.integers(5, 15))
    high = low + int(rng.integers(0, 9))
    ratio = Fraction(int(rng.integers(1, 10_000)), int(rng.integers(1, 5_000)))
    error, teeth, _, done = nearest(Compound(ratio, (low, high)))
    z = range(low, high + 1)
    least = min(abs(1 / ratio - Fraction(a * b, c * d)) for a, b, c, d in product(z, repeat=4))
    assert done and error == least
    assert abs(1 / ratio - Fraction(teeth[0] * teeth[1], teeth[2] * teeth[3])) == least


def test_a_ratio_that_can_be_met_is_met_exactly():
    result = solve(problem(Compound(Fraction(6), (12, 60))))
    assert result.status == "optimal" and result.value == 0.0 and result.bound == 0.0
