"""Drawn errors against exact moments and quantiles."""

import math

import numpy as np
import pytest
from servo_tolerances import BASE, E_WC, S, stack

from gearopt.formulations.servo.tolerance import problem
from gearopt.formulations.servo.tolerance.sampling import binomial_interval, drawn, order_interval
from gearopt.formulations.servo.tolerance.stack import (
    NORMAL,
    RUN_OUT,
    UNIFORM,
    Component,
    ErrorBudget,
    Stack,
)
from gearopt.optimise.solve import solve

LAWS = UNIFORM, RUN_OUT, NORMAL


def moments(parts, t):
    s = np.array([c.sensitivity for c in parts])
    mean = np.array([c.distribution.mean for c in parts])
    sd = np.array([c.distribution.sd for c in parts])
    return (s * mean) @ t, np.linalg.norm(s * sd * t)


def below(parts, t, x):
    """P(e <= x) of uniform and run-out terms by Gil-Pelaez, from their characteristic functions."""
    from scipy.integrate import quad
    from scipy.special import j0

    mean, sd = moments(parts, t)

    def integrand(w):
        size = 1.0
        for c, width in zip(parts, t, strict=True):
            a = w * c.sensitivity * width
            size *= np.sinc(0.5 * a / np.pi) if c.distribution is UNIFORM else j0(a)
        return math.sin(w * (x - mean)) * size / w  # sinc is even about the mean

    return 0.5 + quad(integrand, 1e-9, 12.0 / sd, limit=500, epsabs=1e-10)[0] / math.pi


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_draws_have_the_stated_moments(law):
    x = law.draw(np.random.default_rng(0), 200_000)
    assert x.mean() == pytest.approx(law.mean, abs=5 * law.sd / math.sqrt(len(x)))
    assert x.std() == pytest.approx(law.sd, rel=0.02)


def test_the_baseline_of_the_paper():
    """Mean 0.0510, sd 0.0138, 99.865 % quantile 0.0872, mean + 3 sd 0.0925, worst case 0.1082."""
    base = stack(("mean_plus_sd", 0.0925))
    mean, sd = moments(base.components, BASE)
    found = drawn(base, BASE, 0.0925)
    assert [mean, sd, mean + 3 * sd] == pytest.approx([0.0510, 0.0138, 0.0925], abs=5e-5)
    assert found.mean_deg == pytest.approx(mean, abs=5 * sd / math.sqrt(found.count))
    assert found.sd_deg == pytest.approx(sd, rel=5e-3)
    assert found.worst_case_deg == pytest.approx(0.1082, abs=5e-5) and found.largest_deg < 0.1082
    assert found.quantile_deg == pytest.approx(0.0872, abs=2e-4)
    assert found.quantile_low_deg < 0.0872 < found.quantile_high_deg
    assert found.quantile_high_deg - found.quantile_low_deg < 8e-4
    exact = [
        below(base.components, BASE, x) for x in (found.quantile_low_deg, found.quantile_high_deg)
    ]
    assert exact[0] < found.probability < exact[1]
    digit = [below(base.components, BASE, x) for x in (0.08715, 0.08725)]
    assert digit[0] < found.probability < digit[1]  # 0.0872 is the exact quantile, as printed
    share = below(base.components, BASE, 0.0925)
    assert found.yield_low < share < found.yield_high and share > 0.9999
    assert found.limit_deg == 0.0925 and found.seed == 0


def test_backlash_alone():
    """Mean 0.0285, mean + 3 sd 0.0544, worst case 0.0632 deg."""
    base = stack(("worst_case", E_WC))
    radial = np.array(["pitch" not in c.name for c in base.components])
    mean, sd = moments(base.components, np.where(radial, BASE, 0.0))
    assert [mean, mean + 3 * sd] == pytest.approx([0.0285, 0.0544], abs=5e-5)
    assert (S * BASE)[radial].sum() == pytest.approx(0.0632, abs=5e-5)


def test_the_statistical_optimum_holds_its_budget():
    """99.865 % quantile 0.1062 within the budget 0.1082, worst case 0.1443."""
    best = stack(("mean_plus_sd", E_WC), least=0.25, most=4.0)
    t = np.array(solve(problem(best)).design["t_mm"])
    found = drawn(best, t, E_WC)
    assert found.quantile_deg == pytest.approx(0.1062, abs=3e-4)
    assert found.quantile_low_deg < 0.1062 < found.quantile_high_deg < E_WC
    digit = [below(best.components, t, x) for x in (0.10615, 0.10625)]
    assert digit[0] < found.probability < digit[1]  # 0.1062 is the exact quantile, as printed
    assert found.yield_low > found.probability
    assert found.worst_case_deg == pytest.approx(0.1443, abs=5e-5)


def test_intervals_hold_as_often_as_they_say():
    """Quantile 0.9 of 300 uniform draws, 400 times: 95 % and no less; nor far more."""
    one = Stack((Component("a", 1.0, 1.0),), (ErrorBudget("worst_case", 1.0),))
    runs = [drawn(one, [1.0], 0.9, 300, 0.9, 0.95, seed) for seed in range(400)]
    quantile = np.mean([r.quantile_low_deg <= 0.9 <= r.quantile_high_deg for r in runs])
    share = np.mean([r.yield_low <= 0.9 <= r.yield_high for r in runs])
    assert 0.94 < quantile < 0.99 and 0.94 < share < 0.99


def test_intervals_against_their_definition():
    """By binomial sums: the chance to miss is at most 5 % a side, and more with one rank less."""
    count, p = 50, 0.9

    def missed(first, last):
        chance = [math.comb(count, k) * p**k * (1 - p) ** (count - k) for k in range(count + 1)]
        return sum(chance[:first]), sum(chance[last:])

    first, last = order_interval(count, p, 0.9)
    assert max(missed(first, last)) <= 0.05 < min(missed(first + 1, last - 1))
    assert order_interval(100, 0.99865, 0.99)[1] == 101  # too few draws for an upper end
    assert binomial_interval(0, 10, 0.95) == pytest.approx((0.0, 1.0 - 0.025**0.1), rel=1e-12)
    assert binomial_interval(10, 10, 0.95) == pytest.approx((0.025**0.1, 1.0), rel=1e-12)
    assert binomial_interval(4, 10, 0.95) == pytest.approx((0.12155, 0.73762), abs=5e-6)


def test_few_draws_and_seeds():
    base = stack(("worst_case", E_WC))
    few = drawn(base, BASE, E_WC, 100)
    assert few.quantile_high_deg is None and few.quantile_low_deg < few.quantile_deg
    assert few == drawn(base, BASE, E_WC, 100) != drawn(base, BASE, E_WC, 100, seed=1)
    with pytest.raises(ValueError, match="two draws"):
        drawn(base, BASE, E_WC, 1)
