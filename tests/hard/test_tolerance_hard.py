"""Tolerance allocation where raw solvers fail: zero influence, no budget, no exponent, spreads."""

import math

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.servo.tolerance import problem
from gearopt.formulations.servo.tolerance.conic import continuous
from gearopt.formulations.servo.tolerance.sampling import THREE_SD, drawn, order_interval
from gearopt.formulations.servo.tolerance.stack import (
    NORMAL,
    RUN_OUT,
    Component,
    ErrorBudget,
    Stack,
)
from gearopt.optimise.solve import solve

RULES = ("worst_case", "rss")


def stack(a, s, k=1.0, rules=("worst_case",), error=1.0, **given):
    components = (
        Component(f"part {i}", float(x), float(y), k, **given)
        for i, (x, y) in enumerate(zip(s, a, strict=True), 1)
    )
    return Stack(tuple(components), tuple(ErrorBudget(rule, error) for rule in rules))


def widths(result):
    return np.array(result.design["t_mm"])


def test_no_influence_goes_to_its_upper_end_or_is_refused():
    with pytest.raises(ValueError, match=r"part 2 has no influence .* give it an upper end"):
        stack([1.0, 1.0, 1.0], [1.0, 0.0, 2.0])
    held = stack([1.0, 1.0, 1.0], [1.0, 0.0, 2.0], most=10.0)
    for method in ("exact", "ipopt", "gp"):
        result = solve(problem(held), method)
        assert result.status == "optimal"
        assert result.value == pytest.approx((1.0 + math.sqrt(2.0)) ** 2 + 0.1, rel=1e-9)
        assert widths(result)[1] == pytest.approx(10.0, rel=1e-9)
    run_out = stack([1.0, 1.0], [1.0, 2.0], rules=("mean_plus_sd",), distribution=NORMAL)
    assert solve(problem(run_out)).status == "optimal"  # no mean, and yet of influence


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("k", [0.5, 1.0, 2.0])
def test_a_budget_towards_zero(k, rule):
    """C scales as E^-k and t as E, exactly."""
    a, s = [1.0, 4.0, 2.0], [3.0, 1.0, 2.0]
    one = solve(problem(stack(a, s, k, (rule,))))
    for error in (1e-3, 1e-9, 1e-30, 1e-60):
        result = solve(problem(stack(a, s, k, (rule,), error)))
        assert result.status == "optimal" and result.gap < 1e-12
        assert result.value == pytest.approx(one.value * error**-k, rel=1e-12)
        assert widths(result) == pytest.approx(error * widths(one), rel=1e-12)


def test_two_budgets_towards_zero():
    a, s = [1.0, 4.0, 2.0], [3.0, 1.0, 2.0]

    def both(error):
        parts = stack(a, s).components
        budgets = (ErrorBudget("worst_case", error), ErrorBudget("rss", 0.6 * error))
        return solve(problem(Stack(parts, budgets)))

    for error in (1e-9, 1e-30, 1e-60, 1e60):
        assert both(error).value == pytest.approx(both(1.0).value / error, rel=1e-12)


def cube_law(error, k):
    return solve(problem(stack([1.0, 4.0], [3.0, 1.0], k, RULES, error)))


def test_costs_of_1e180():
    far = cube_law(1e-60, 3.0)
    assert far.status == "optimal" and far.gap < 1e-12
    assert far.value == pytest.approx(cube_law(1.0, 3.0).value * 1e180, rel=1e-12)


@pytest.mark.filterwarnings("ignore:overflow")  # of the text, at its guess
def test_of_costs_beyond_doubles_nothing_is_claimed():
    beyond = cube_law(1e-100, 4.0)
    assert beyond.status == "failed" and beyond.value is None
    assert beyond.message.startswith("beyond the range of doubles")


def test_an_exponent_towards_zero():
    """-a ln t: WC t = E a/(s sum a), RSS (s t/E)^2 = a/sum a; small k comes near to it."""
    a, s, error = np.array([1.0, 4.0, 2.0]), np.array([3.0, 1.0, 2.0]), 0.1
    share = a / a.sum()
    expected = {"worst_case": error * share / s, "rss": error * np.sqrt(share) / s}
    for rule, t in expected.items():
        result = solve(problem(stack(a, s, 0.0, (rule,), error)))
        assert result.status == "optimal" and result.gap < 1e-13
        assert widths(result) == pytest.approx(t, rel=1e-14)
        assert result.value == pytest.approx(-(a * np.log(t)).sum(), rel=1e-14)
        ipopt = solve(problem(stack(a, s, 0.0, (rule,), error)), "ipopt")
        assert widths(ipopt) == pytest.approx(t, rel=1e-6)
        for k in (1e-3, 1e-6, 1e-12):
            near = solve(problem(stack(a, s, k, (rule,), error)))
            assert near.status == "optimal" and near.gap < 1e-12
            assert widths(near) == pytest.approx(t, rel=3.0 * k + 1e-13)


def test_exponents_of_zero_among_others():
    """Roots, as no closed form covers them: the stationarity -dC/dt = lam s of each."""
    parts = (Component("log", 2.0, 3.0, 0.0), Component("power", 1.0, 1.0, 2.0))
    result = solve(problem(Stack(parts, (ErrorBudget("worst_case", 0.1),))))
    assert result.status == "optimal" and result.gap < 1e-12
    first, second = widths(result)
    assert 3.0 / first / 2.0 == pytest.approx(2.0 / second**3, rel=1e-10)
    assert 2.0 * first + second == pytest.approx(0.1, rel=1e-13)


@pytest.mark.parametrize("k", few([1.0, 0.5, 2.0], 2))
def test_one_component_and_equal_components(k):
    """One: WC = RSS = a (s/E)^k. n equal ones: WC = n^(k/2) RSS."""
    one = [solve(problem(stack([2.0], [3.0], k, (rule,)))).value for rule in RULES]
    assert one == pytest.approx([2.0 * 3.0**k] * 2, rel=1e-14)
    for n in (2, 9, 1000):
        same = [solve(problem(stack([2.0] * n, [3.0] * n, k, (rule,)))).value for rule in RULES]
        assert same[0] == pytest.approx(n ** (k / 2) * same[1], rel=1e-12)
        assert same[0] == pytest.approx(2.0 * n * (3.0 * n) ** k, rel=1e-12)


def test_one_component_under_every_rule_at_once():
    both = stack([2.0], [3.0], rules=(*RULES, "mean_plus_sd"))
    result = solve(problem(both))
    assert result.status == "optimal"
    assert result.value == pytest.approx(6.0 * (0.5 + 3.0 / math.sqrt(12.0)), rel=1e-12)


@pytest.mark.parametrize("half", [3, 5])
def test_spreads_with_cost_falling(half):
    """A s = 1, eight terms: C = 64 whatever the spread; 1e10 in a and s is half = 5."""
    s = np.logspace(-half, half, 8)
    tolerances = stack(1.0 / s, s)
    for method in ("exact", "ipopt", "gp"):
        result = solve(problem(tolerances), method)
        assert result.status == "optimal" or method == "gp"  # whose gap may be 1e-5
        assert result.value == pytest.approx(64.0, rel=6e-9)
        assert 64.0 * (1.0 - 1e-4) < result.bound <= 64.0 * (1.0 + 1e-14)
        assert s * widths(result) == pytest.approx([0.125] * 8, rel=1e-4)
    exact = solve(problem(tolerances))
    assert exact.value == pytest.approx(64.0, rel=1e-14) and exact.gap < 1e-13
    assert s * widths(exact) == pytest.approx([0.125] * 8, rel=1e-14)
    assert solve(continuous(tolerances)).value == pytest.approx(64.0, rel=3e-9)


@pytest.mark.parametrize(("half", "best"), [(3, 1348784.861), (5, 1.0789376448e10)])
def test_spreads_with_cost_rising(half, best):
    """C = (sum sqrt(a s))^2, t_i = sqrt(a_i/s_i)/sum sqrt(a s)."""
    s = np.logspace(-half, half, 8)
    tolerances = stack(s, s)
    closed = np.sqrt(s * s).sum() ** 2
    assert closed == pytest.approx(best, rel=5e-10)  # as printed
    exact = solve(problem(tolerances))
    assert exact.status == "optimal" and exact.gap < 1e-13
    assert exact.value == pytest.approx(closed, rel=1e-14)
    assert widths(exact) == pytest.approx([1.0 / s.sum()] * 8, rel=1e-14)
    ipopt, gp, cone = (
        solve(problem(tolerances), "ipopt"),
        solve(problem(tolerances), "gp"),
        solve(continuous(tolerances)),
    )
    assert ipopt.status == cone.status == "optimal"
    assert [ipopt.value, cone.value] == pytest.approx([closed] * 2, rel=1e-10)
    assert gp.value == pytest.approx(closed, rel=6e-7)
    assert closed * (1.0 - 1e-4) < gp.bound <= closed * (1.0 + 1e-12)


@pytest.mark.parametrize("rising", [False, True])
@pytest.mark.parametrize("half", few([3, 5, 8], [8]))
def test_spreads_by_roots(half, rising):
    """Two budgets, and mean + 3 sd: no closed form; the bound of the multipliers closes the gap."""
    s = np.logspace(-half, half, 8)
    parts = stack(s if rising else 1.0 / s, s).components
    two = (ErrorBudget("worst_case", 1.0), ErrorBudget("rss", 0.6))
    for budgets in (two, (ErrorBudget("mean_plus_sd", 1.0),)):
        posed = problem(Stack(parts, budgets))
        exact, ipopt = solve(posed), solve(posed, "ipopt")
        assert exact.status == ipopt.status == "optimal"
        assert exact.gap < 1e-12
        assert ipopt.value == pytest.approx(exact.value, rel=1e-9)


@pytest.mark.parametrize(("rule", "p"), [("worst_case", 1), ("rss", 2)])
def test_square_law_in_millimetres(rule, p):
    """T of 0.02 mm that cost 1 each, k = 2: raw Clarabel is 7 % off in t; none of these is."""
    t0 = np.array([18, 24, 29, 20, 27, 33, 18, 24, 29, 20, 27, 33, 25, 30]) * 1e-3
    s = 1.0 + np.arange(14)
    error = float(np.linalg.norm(s * t0, p))
    w = (t0**2 / s**p) ** (1.0 / (2.0 + p))
    t = error * w / np.linalg.norm(s * w, p)
    tolerances = stack(t0**2, s, 2.0, (rule,), error)
    exact = solve(problem(tolerances))
    assert exact.value == pytest.approx((t0**2 / t**2).sum(), rel=1e-13)
    assert widths(exact) == pytest.approx(t, rel=1e-13)
    for other in (solve(problem(tolerances), "ipopt"), solve(continuous(tolerances))):
        assert other.status == "optimal"
        assert other.value == pytest.approx(exact.value, rel=1e-9)
        assert widths(other) == pytest.approx(t, rel=1e-4)


def test_least_tolerances_above_the_budget_are_named():
    parts = (
        Component("pinion reading", 2.0, 1.0, least=0.04),
        Component("wheel reading", 1.0, 1.0, least=0.05),
        Component("pitch", 1.0, 1.0, least=0.001),
        Component("bearing", 1.0, 1.0),
    )
    posed = problem(Stack(parts, (ErrorBudget("worst_case", 0.1),)))
    exact = solve(posed)
    assert exact.status == "infeasible"
    assert exact.proof["components"] == ["pinion reading", "wheel reading"]
    assert exact.proof["conflict"] == ["worst_case", "least[1]", "least[2]"]
    assert exact.proof["least_utilisation"] == pytest.approx(1.31)
    assert "pinion reading, wheel reading alone use up the budget worst_case" in exact.message
    ipopt = solve(posed, "ipopt")
    assert ipopt.status == "infeasible"
    assert {"worst_case", "least[1]", "least[2]"} <= set(ipopt.proof["conflict"])
    rss = problem(Stack(parts, (ErrorBudget("worst_case", 0.2), ErrorBudget("rss", 0.09))))
    assert solve(rss).proof["conflict"] == ["rss", "least[1]", "least[2]"]


@pytest.mark.parametrize("rule", RULES)
def test_just_impossible_and_just_possible(rule):
    """Least tolerances that use the budget up to a millionth, or wholly."""
    s = np.logspace(-3, 3, 8)
    even = 1.0 / 8.0 if rule == "worst_case" else 8.0**-0.5

    def posed(share):
        parts = tuple(
            Component(str(i), float(v), float(1.0 / v), least=float(share * even / v))
            for i, v in enumerate(s)
        )
        return problem(Stack(parts, (ErrorBudget(rule, 1.0),)))

    never = solve(posed(1.0 + 1e-6))
    assert never.status == "infeasible" and len(never.proof["components"]) == 8
    cost = 8.0 / even
    for share in (1.0 - 1e-6, 1.0 - 1e-15, 1.0):
        ever = solve(posed(share))
        assert ever.status == "optimal" and ever.gap < 1e-9
        assert ever.value == pytest.approx(cost, rel=1e-9)


def test_the_tail_of_drawn_errors_rests_on_few_of_them():
    """Of 4e5 draws 540 are beyond the 99.865 % quantile: its interval is that of their ranks."""
    count, tail = 400_000, 1.0 - THREE_SD
    first, last = order_interval(count, THREE_SD, 0.99)
    assert count * tail == pytest.approx(540.0, abs=1e-6)
    half = 2.5758 * math.sqrt(count * THREE_SD * tail)  # normal law for the binomial one
    assert count - first == pytest.approx(540.0 + half, abs=2.0)
    assert count - last == pytest.approx(540.0 - half, abs=2.0)
    uniform = stack([1.0], [1.0])
    found = drawn(uniform, np.ones(1), 1.0)
    assert found.quantile_low_deg < THREE_SD < found.quantile_high_deg
    assert found.quantile_high_deg - found.quantile_low_deg == pytest.approx(
        2.0 * half / count, rel=0.3
    )


def test_a_run_out_is_arcsine_and_never_beyond_its_tolerance():
    """P(cos phi > c) = acos(c)/pi; a normal error of its variance would reach 3/sqrt(2)."""
    one = stack([1.0], [1.0], rules=("mean_plus_sd",), distribution=RUN_OUT)
    found = drawn(one, np.ones(1), 1.0)
    assert found.quantile_deg == pytest.approx(math.cos(math.pi * (1.0 - THREE_SD)), abs=2e-6)
    assert found.largest_deg <= 1.0 and found.yield_share == 1.0
    assert one.used(np.ones(1))[0] == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-12)


def test_a_centred_root_sum_of_squares_is_wrong_for_backlash():
    """Sixteen one-sided deviations: rss 4, mean 8, sd sqrt(16/12); hardly any train is below 4."""
    parts = stack([1.0] * 16, [1.0] * 16, rules=("rss", "mean_plus_sd"))
    rss, honest = parts.used(np.ones(16))
    assert rss == 4.0 and honest == pytest.approx(8.0 + 3.0 * math.sqrt(16.0 / 12.0))
    found = drawn(parts, np.ones(16), rss)
    assert found.mean_deg == pytest.approx(8.0, abs=0.01) and found.yield_high < 1e-3
    assert drawn(parts, np.ones(16), honest).yield_low > 0.998


def test_nothing_left_for_a_tolerance_is_impossible():
    parts = (Component("wheel", 1.0, 1.0, least=1.0, most=1.0), Component("pinion", 1.0, 1.0))
    result = solve(problem(Stack(parts, (ErrorBudget("worst_case", 1.0),))))
    assert result.status == "infeasible" and result.proof["components"] == ["wheel"]
    some = solve(problem(Stack(parts, (ErrorBudget("worst_case", 1.0 + 1e-6),))))
    assert some.status == "optimal"
    assert widths(some) == pytest.approx([1.0, 1e-6], rel=1e-9)
