"""Known ways in which conic solvers' word is wrong: each shows the lie, then what we say.

Tolerance allocation: least cost sum a/t^k under sum s t <= E (worst case) or |s t| <= E (RSS), with
the closed form t = E w / |s w|_p, w = (a/s^p)^(1/(k + p)).
"""

import math
import warnings
from itertools import product

import cvxpy as cp
import numpy as np
import pytest
from campaigns import few

from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.certificate import certify
from gearopt.optimise.conic.cone_bound import Leaf
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import run, solve
from gearopt.optimise.terms import Param, Terms, Var


def allocation(a, s, k=1, rss=False, budget=1.0, upper=math.inf):
    def evaluate(x, p):
        weighted = cp.multiply(p.s, x.t)
        used = cp.norm(weighted) if rss else cp.sum(weighted)
        cost = cp.sum(cp.multiply(p.a, cp.power(x.t, -k)))
        return Terms({"cost": cost}, {"budget": used / budget})

    size = len(a)
    parameters = (Param("a", "", tuple(a), size), Param("s", "1/mm", tuple(s), size))
    return Conic("allocation", (Var("t", "mm", 0.0, upper, 1.0, size=size),), parameters, evaluate)


def closed_form(a, s, k=1, rss=False, budget=1.0):
    p = 2 if rss else 1
    w = (a / s**p) ** (1 / (k + p))
    t = budget * w / ((s * w) ** p).sum() ** (1 / p)
    return (a / t**k).sum(), t


def spread(low, high, rising=False):
    s = np.logspace(low, high, 8)
    return (s if rising else 1.0 / s), s


def told(problem, solver):
    """Status, the user's point and the leaf of a raw solver on the same canonical data."""
    model, data = problem.model(), canonical(problem)
    given, chain, inverse = model.problem.get_problem_data(solver, solver_opts={})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        raw = chain.solve_via_data(model.problem, given)
        model.problem.unpack_results(raw, chain, inverse)
    z, y = (raw["x"], raw["y"]) if isinstance(raw, dict) else (np.array(raw.x), np.array(raw.z))
    return model.problem.status, z[data.user], Leaf(data.lower, data.upper, z, data.turned(y))


@pytest.mark.parametrize(
    ("solver", "low", "high", "status", "too_high"),
    [
        (cp.SCS, -6, 0, "optimal", 0.4),  # 382 % too high
        pytest.param(cp.SCS, -2, 4, "optimal", 0.4, marks=pytest.mark.slow),  # 55 %
        pytest.param(cp.CLARABEL, -2, 4, "optimal", 1e3, marks=pytest.mark.slow),  # 9e4 times
        (cp.CLARABEL, -5, 5, "optimal_inaccurate", 1e2),  # a factor of 1200
    ],
)
def test_coefficient_spreads(solver, low, high, status, too_high):
    """a s = 1, eight terms: C* = 64 whatever the spread."""
    problem = allocation(*spread(low, high))
    said, t, leaf = told(problem, solver)
    t = np.abs(t) / max(1.0, float(problem.batch(np.abs(t)[None]).G[0, 0]))  # moved into the budget
    assert said.startswith(status)  # SCS says "optimal_inaccurate" of the first on some machines
    assert problem.batch(t[None]).F[0, 0] > 64.0 * (1.0 + too_high)

    refused = certify(problem, Outcome(t, leaves=(leaf,)), 1e-6)
    assert refused.status != "optimal"
    assert refused.bound is None or refused.bound <= 64.0
    ours, outcome = run(problem)
    assert ours.status == "optimal" and ours.gap < 1e-9
    assert ours.value == pytest.approx(64.0, rel=1e-9)
    assert certify(problem, Outcome(t, leaves=outcome.leaves), 1e-6).gap > too_high / (1 + too_high)


@pytest.mark.parametrize(
    ("half", "best"),
    [pytest.param(3, 1348784.8608242690, marks=pytest.mark.slow), (5, 10789376447.824598)],
)
def test_cost_rising_with_sensitivity(half, best):
    """C* = (sum sqrt(a s))^2; Clarabel fails or is far off, SCS too."""
    problem = allocation(*spread(-half, half, rising=True))
    for solver in (cp.CLARABEL, cp.SCS):
        try:
            said, t, leaf = told(problem, solver)
        except cp.error.SolverError:
            continue  # it says so itself
        if not np.isfinite(t).all():
            continue  # so does SCS at 1e10
        off = problem.batch(np.abs(t)[None])
        assert said != "optimal"
        assert off.G[0, 0] > 1.0 + 1e-6 or off.F[0, 0] > best * (1.0 + 1e-6)
        assert certify(problem, Outcome(np.abs(t), leaves=(leaf,)), 1e-6).status != "optimal"
    ours = solve(problem)
    assert ours.status == "optimal" and ours.gap < 1e-9
    assert ours.value == pytest.approx(best, rel=1e-10)
    assert max(ours.certificate.values()) < 1e-9


@pytest.mark.parametrize(
    ("half", "k", "rss", "rising"),
    [
        pytest.param(half, k, rss, rising, marks=[pytest.mark.slow] * slow)
        for half, k, rss, rising in product((3, 5), (1, 2), (False, True), (False, True))
        for slow in [half == 3 or (k + rss + rising) % 2]  # any two of the others in all ways
    ],
)
def test_every_law_at_wide_spreads(half, k, rss, rising):
    """Costs up to 1e15: the answer to 1e-6, within our own gap."""
    a, s = spread(-half, half, rising)
    best, t = closed_form(a, s, k, rss)
    ours = solve(allocation(a, s, k, rss))
    assert ours.status == "optimal"
    assert ours.value == pytest.approx(best, rel=1e-6)
    assert ours.bound <= best * (1.0 + 1e-10)
    shares = a / np.array(ours.design["t_mm"]) ** k / best  # some are 1e-10 of the cost
    assert shares == pytest.approx(a / t**k / best, abs=1e-4)


@pytest.mark.parametrize("rss", [pytest.param(False, marks=pytest.mark.slow), True])
def test_square_law_in_millimetres(rss):
    """t of 0.02 mm, every term costs 1: SCS says optimal at 149 and 10 % more."""
    t0 = np.array([18, 24, 29, 20, 27, 33, 18, 24, 29, 20, 27, 33, 25, 30]) * 1e-3
    s = 1.0 / t0
    budget = float(np.linalg.norm(s * t0) if rss else s @ t0)
    best, t = closed_form(t0**2, s, 2, rss, budget)
    problem = allocation(t0**2, s, 2, rss, budget)
    said, there, leaf = told(problem, cp.SCS)
    off = problem.batch(there[None])
    assert said == "optimal"
    assert abs(off.F[0, 0] / best - 1.0) > 0.05 and np.abs(there / t - 1.0).max() > 0.2
    assert certify(problem, Outcome(there, leaves=(leaf,)), 1e-6).status != "optimal"
    ours = solve(problem)
    assert ours.status == "optimal"
    assert ours.value == pytest.approx(best, rel=1e-10)
    assert ours.design["t_mm"] == pytest.approx(t, rel=1e-6)


def test_many_positions_in_one_quadratic_program():
    """Load sharing of 400 positions, 4 pairs each: raw tolerance is that of the global norm."""
    count, pairs = 400, 4
    rng = np.random.default_rng(0)
    stiffness = 10 ** rng.uniform(1.0, 2.0, (count, pairs))
    gap, load = rng.uniform(0.0, 20.0, (count, pairs)), rng.uniform(500.0, 5000.0, count)

    def evaluate(x, p):
        force = cp.reshape(x.F, (count, pairs), order="C")
        work = cp.sum(cp.multiply(0.5 / stiffness, cp.square(force)) + cp.multiply(gap, force))
        return Terms({"work": work}, equal={"sum": cp.multiply(1.0 / load, cp.sum(force, axis=1))})

    forces = Var("F", "N", 0.0, 1e5, 1.0, size=count * pairs)
    problem = Conic("sharing", (forces,), (), evaluate)
    exact = np.array([shared(*row) for row in zip(stiffness, gap, load, strict=True)])
    said, there, _ = told(problem, cp.CLARABEL)
    assert said == "optimal"
    assert np.abs((there.reshape(count, pairs) - exact) / load[:, None]).max() > 1e-5
    ours = solve(problem)
    assert ours.status == "optimal" and ours.gap < 1e-9
    found = np.array(ours.design["F_N"]).reshape(count, pairs)
    assert np.abs((found - exact) / load[:, None]).max() < 1e-12


def shared(stiffness, gap, load):
    """Forces of springs with gaps under one load: the deflection that the touching ones need."""
    order = np.argsort(gap)
    k, e = stiffness[order], gap[order]
    for touching in range(len(k), 0, -1):
        deflection = (load + (k * e)[:touching].sum()) / k[:touching].sum()
        if deflection >= e[touching - 1]:
            return np.maximum(0.0, stiffness * (deflection - gap))
    raise AssertionError


def test_one_component_and_equal_components():
    """One component: WC = RSS. n equal ones: WC = sqrt(n) RSS (k = 1)."""
    one = [solve(allocation([2.0], [3.0], rss=rss)).value for rss in (False, True)]
    assert one == pytest.approx([6.0, 6.0], rel=1e-10)
    for n in (2, 9):
        same = [solve(allocation([2.0] * n, [3.0] * n, rss=rss)).value for rss in (False, True)]
        assert same[0] == pytest.approx(math.sqrt(n) * same[1], rel=1e-10)


@pytest.mark.parametrize("k", few([1, 2], 1))
def test_small_budgets_scale(k):
    """C is exactly E^-k times that of E = 1, t is E times it."""
    a, s = np.array([1.0, 4.0, 2.0]), np.array([3.0, 1.0, 2.0])
    at_one = solve(allocation(a, s, k))
    for budget in (1e-3, 1e-8):
        ours = solve(allocation(a, s, k, budget=budget))
        assert ours.status == "optimal"
        assert ours.value == pytest.approx(at_one.value * budget**-k, rel=1e-10)
        assert np.array(ours.design["t_mm"]) / budget == pytest.approx(
            at_one.design["t_mm"], rel=1e-6
        )


def test_a_tolerance_without_influence_needs_a_bound():
    """s = 0: the cost falls as t grows for ever."""
    loose = solve(allocation([1.0, 1.0, 1.0], [1.0, 0.0, 2.0]))
    assert loose.status not in ("optimal", "stationary") and loose.bound is None
    assert loose.message.startswith("t[2] is unbounded")
    held = solve(allocation([1.0, 1.0, 1.0], [1.0, 0.0, 2.0], upper=10.0))
    assert held.status == "optimal"
    assert held.value == pytest.approx((1.0 + math.sqrt(2.0)) ** 2 + 0.1, rel=1e-10)
    assert held.design["t_mm"][1] == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize("half", few([5, 3, 0], 1))
def test_just_impossible_and_just_possible(half):
    """Least tolerances that use the budget up to a millionth."""
    a, s = spread(-half, half)

    def problem(share):
        least = tuple(share / 8.0 / s)
        most = tuple(1e3 / s)
        given = allocation(a, s)
        return Conic(
            "least", (Var("t", "mm", least, most, least, size=8),), given.parameters, given.evaluate
        )

    never = solve(problem(1.0 + 1e-6))
    assert never.status == "infeasible" and never.proof["conflict"] == ["budget"]
    ever = solve(problem(1.0 - 1e-6))
    assert ever.status == "optimal" and ever.value == pytest.approx(64.0, rel=1e-9)


def test_a_point_that_gains_by_its_violation_is_not_optimal():
    """1e-8 over the budget with a multiplier of 1e9: 10 % too good."""
    problem = Conic(
        "steep",
        (Var("x", "", 0.0, 2.0, 1.0),),
        (),
        lambda x, p: Terms({"cost": 1e8 - 1e9 * (x.x - 1.0)}, {"most": x.x}),
    )
    ours, outcome = run(problem)
    assert ours.value == pytest.approx(1e8, rel=1e-9)
    verdict = certify(problem, Outcome(np.array([1.0 + 9e-9]), leaves=outcome.leaves), 1e-12)
    assert verdict.status != "optimal"
    over = certify(problem, Outcome(np.array([1.0 + 2e-8]), leaves=outcome.leaves), 1e-6)
    assert over.status == "failed" and "most is violated" in over.message


def test_stopped_early_is_a_limit():
    a, s = spread(-3, 3)
    assert run(allocation(a, s), budget=Budget(seconds=0.0))[0].status == "limit"
