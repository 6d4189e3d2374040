"""The compound train: against full enumeration in fractions, and Sandgren's published optimum."""

import math
from fractions import Fraction
from itertools import combinations_with_replacement as multisets
from itertools import product

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.compound import ERROR, SQUARED, Compound, nearest, problem, wider
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve


def enumerated(ratio, low, high, goal=ERROR):
    """The least miss and the teeth that tie goes to: fewest, then smallest; all in fractions."""
    pairs = list(multisets(range(low, high + 1), 2))

    def miss(drivers, driven):
        if goal == SQUARED:
            return (1 / ratio - Fraction(drivers, driven)) ** 2
        return abs(Fraction(driven, drivers) / ratio - 1)

    return min(
        (miss(a * b, c * d), a + b + c + d, (a, b, c, d))
        for (a, b), (c, d) in product(pairs, pairs)
    )


def test_nearest_is_nearest_in_the_ratio_itself():
    """2.15625 is 2.10 % off, 2.25, which is nearer in 1/ratio, 2.16 %."""
    for goal, teeth, ratio in (
        (ERROR, [16, 16, 23, 24], Fraction(69, 32)),
        (SQUARED, [16, 16, 24, 24], Fraction(9, 4)),
    ):
        train = Compound(Fraction("2.2025"), (16, 24), goal)
        result = solve(problem(train))
        assert result.status == "optimal" and result.design["teeth"] == teeth
        assert result.value == pytest.approx(float(train.ratio_error(1 / ratio)), rel=1e-14)


def test_sandgrens_optimum():
    result = solve(problem(Compound(Fraction(6931, 1000), (12, 60), SQUARED)))
    assert result.status == "optimal" and result.gap < 1e-15
    exact = (Fraction(1000, 6931) - Fraction(16 * 19, 43 * 49)) ** 2
    assert result.value == pytest.approx(float(exact), rel=1e-15)
    assert result.value == pytest.approx(2.7008571e-12, rel=1e-8)  # as published
    assert result.design["teeth"] == [16, 19, 43, 49]


@pytest.mark.parametrize("seed", range(20))
def test_it_is_what_full_enumeration_finds(seed):
    rng = np.random.default_rng(seed)
    low = int(rng.integers(5, 15))
    high = low + int(rng.integers(0, 9))
    ratio, goal = Fraction(*map(int, rng.integers(1, (10_000, 5_000)))), (ERROR, SQUARED)[seed % 2]
    error, teeth, _, done = nearest(Compound(ratio, (low, high), goal))
    least, _, best = enumerated(ratio, low, high, goal)
    assert done and (error, teeth) == (least, best)


@pytest.mark.parametrize(
    ("high", "seed"), few(product((8, 11, 14), range(4)), [*product((8, 11), range(2))])
)
def test_ties_on_both_sides_are_decided_exactly(high, seed):
    """u just between two ratios: above and below miss by the same, or by 1e-30 more."""
    rng, low = np.random.default_rng(seed), 5
    z = range(low, high + 1)
    products = sorted({Fraction(a * b, c * d) for a, b, c, d in product(z, repeat=4)})
    k = int(rng.integers(0, len(products) - 1))
    for shift in (Fraction(0), Fraction(1, 10**30), -Fraction(1, 10**30)):
        ratio = (products[k] + products[k + 1]) / 2 + shift
        error, teeth, _, _ = nearest(Compound(ratio, (low, high)))
        least, _, best = enumerated(ratio, low, high)
        assert (error, teeth) == (least, best)
        if shift:
            a, b, c, d = teeth
            assert Fraction(c * d, a * b) == products[k + (shift > 0)]


@pytest.mark.parametrize("seed", range(30))
def test_the_text_loses_no_digit(seed):
    """Where the products nearly cancel, and of ratios of up to forty digits."""
    rng = np.random.default_rng(seed)
    a, b, c, d = teeth = tuple(int(z) for z in rng.integers(5, 401, 4))
    near = Fraction(c * d, a * b) * (1 + Fraction(1, 10 ** int(rng.integers(2, 40))))
    for ratio in (near, Fraction(c * d, a * b), Fraction(int(rng.integers(1, 10**9)), 1000)):
        train = Compound(ratio, (5, 400), (ERROR, SQUARED)[seed % 2])
        found = problem(train).batch(np.array([teeth], float)).F[0, 0]
        exact = float(train.ratio_error(Fraction(a * b, c * d)))
        assert found == pytest.approx(exact, rel=2e-14, abs=0.0)


@pytest.mark.parametrize("digits", [4, 9, 15, 20])
def test_a_ratio_of_many_digits_is_proven(digits):
    ratio = Fraction(
        math.floor(Fraction(3141592653589793238462643, 10**24) * 10**digits), 10**digits
    )
    train = Compound(ratio, (12, 60))
    result = solve(problem(train))
    assert result.status == "optimal" and result.gap < 1e-14
    a, b, c, d = result.design["teeth"]
    miss = train.ratio_error(Fraction(a * b, c * d))
    assert result.value == pytest.approx(float(miss), rel=1e-14, abs=0.0)


@pytest.mark.parametrize("power", [6, 9, 12, 20, 30])
def test_a_ratio_that_is_nearly_met_is_proven(power):
    """The miss is far below the rounding of the two quotients."""
    ratio = Fraction(31 * 47, 13 * 17) * (1 + Fraction(1, 10**power))
    train = Compound(ratio, (12, 60))
    result = solve(problem(train))
    assert result.status == "optimal" and result.gap < 1e-13 and result.value > 0.0
    miss = train.ratio_error(Fraction(13 * 17, 31 * 47))
    assert result.value == pytest.approx(float(miss), rel=1e-13, abs=0)


def test_a_ratio_that_can_be_met_is_met_exactly():
    result = solve(problem(Compound(Fraction(6), (12, 60))))
    assert result.status == "optimal" and result.value == 0.0 and result.bound == 0.0


@pytest.mark.parametrize("budget", [Budget(evaluations=100), Budget(seconds=0.0)])
def test_a_budget_ends_it(budget):
    result = solve(problem(Compound(Fraction(7), (5, 100))), budget=budget)
    assert result.status == "limit" and result.bound is None and result.value >= 0.0
    assert result.evaluations <= 500


def test_the_minimum_goes_down_no_further_than_it_must():
    """sqrt(1000) = 31.6: 12 teeth need 380, 13 would need 412."""
    assert wider(Compound(Fraction(1000), (20, 40)), 5, 400) == [(12, 380)]
    assert wider(Compound(Fraction(5000), (20, 40)), 5, 2000) == [(20, 1415)]


@pytest.mark.parametrize("seed", range(20))
def test_a_wider_range_is_the_smallest_that_reaches(seed):
    """Each end moved on its own, counted up and down until the ratio is within."""
    rng = np.random.default_rng(seed)
    low = int(rng.integers(5, 40))
    high = int(rng.integers(low, 100))
    ratio = Fraction(int(rng.integers(1, 9000)), int(rng.choice([1, 7, 100])))
    ratio = 1 / ratio if seed % 2 else ratio
    train = Compound(ratio, (low, high))

    def reaches(a, b):
        least, most = Compound(ratio, (a, b)).reach
        return least <= ratio <= most

    if reaches(low, high):
        return
    more = next(((low, h) for h in range(high, 401) if reaches(low, h)), None)
    fewer = next(((k, high) for k in range(low, 4, -1) if reaches(k, high)), None)
    held = next((k for k in range(low, 4, -1) if reaches(k, 400)), 0)  # the highest minimum
    both = next(((held, h) for h in range(high, 401) if held and reaches(held, h)), None)
    expected = [r for r in (more, fewer) if r] or [r for r in (both,) if r]
    assert wider(train, 5, 400) == expected


@pytest.mark.parametrize("seed", few(range(6), 3))
def test_the_front_of_error_and_largest_gear_is_that_of_all_trains(seed):
    rng = np.random.default_rng(seed)
    low, ratio = int(rng.integers(5, 12)), Fraction(int(rng.integers(1, 900)), 100)
    high = low + 8
    best, wanted = None, []
    for most in range(low, high + 1):
        miss = enumerated(ratio, low, most)[0]
        if best is None or miss < best:
            wanted.append((float(miss), most))
            best = miss
    names = ("ratio_error", "largest_gear")
    made = found(problem(Compound(ratio, (low, high)), names), names, {})
    assert made.complete and made.values == pytest.approx(np.array(wanted)[::-1], rel=1e-9)


def test_the_front_of_sandgrens_train_ends_in_his_optimum():
    names = ("squared_error", "largest_gear")
    train = problem(Compound(Fraction(6931, 1000), (12, 60), SQUARED), names)
    made = found(train, names, {})
    assert made.complete and made.values[0] == pytest.approx([2.7008571e-12, 49.0], rel=1e-8)
    assert made.values[-1] == pytest.approx([(1000 / 6931 - 1.0) ** 2, 12.0], rel=1e-12)
    some = found(train, names, {"largest_gear": 40.0})
    assert some.complete and some.values[:, 1].max() <= 40.0
    stopped = found(train, names, {}, budget=Budget(evaluations=100))
    assert not stopped.complete and "missing" in stopped.message
