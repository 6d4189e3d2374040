"""Bounds of conic problems: multipliers, leaves, propagation; what is forged proves nothing."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest
import scipy.sparse as sp
from conic_cases import catalogue, disc

from gearopt.errors import CertificateError, SolveError
from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.certificate import certify, covers
from gearopt.optimise.conic.cone_bound import Leaf, inside, lagrangian, propagate
from gearopt.optimise.conic.interior import after, equal, scaled
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import run, solve
from gearopt.optimise.terms import Terms, Var


def test_what_is_not_bounded_is_named():
    down = Conic(
        "down",
        (Var("x", "", -math.inf, math.inf, 0.0),),
        (),
        lambda x, p: Terms({"c": x.x}, {"top": x.x}),
    )
    result = solve(down)
    assert result.status == "failed" and "x is unbounded" in result.message
    wide = Conic(
        "wide",
        (Var("k", "", 0, math.inf, 0, integer=True),),
        (),
        lambda x, p: Terms({"c": x.k}),
    )
    with pytest.raises(SolveError, match="integer k needs bounds"):
        solve(wide)


def test_bounds_of_variables_follow_from_limits():
    """No upper bounds given: 0 <= x and sum <= 1 are enough for a proof."""
    problem = Conic(
        "simplex",
        (Var("x", "", 0.0, math.inf, 0.0, size=3),),
        (),
        lambda x, p: Terms({"c": np.array([-1.0, -2.0, -3.0]) @ x.x}, {"sum": cp.sum(x.x)}),
    )
    result = solve(problem)
    assert result.status == "optimal" and result.value == pytest.approx(-3.0, rel=1e-11)


def test_any_multipliers_give_a_valid_bound():
    """Weak duality holds for noise, huge and tiny numbers, NaN and signs of the wrong kind."""
    problem = disc()
    data = canonical(problem)
    low, high = propagate(data, data.lower, data.upper, 2.0)
    rng = np.random.default_rng(0)
    for k in range(200):
        y = rng.normal(size=len(data.b)) * 10.0 ** rng.uniform(-12.0, 12.0)
        y[rng.integers(len(y))] = (np.nan, np.inf, -1.0, 0.0)[k % 4]
        x = rng.normal(size=len(data.c)) * 10.0 ** rng.uniform(-3.0, 3.0)
        assert lagrangian(data, low, high, x, y).least <= 2.0


def test_multipliers_are_moved_into_the_dual_cone():
    problem, _ = catalogue()
    data = canonical(problem)
    assert {block.rotated for block in data.blocks} == {True, False}
    rng = np.random.default_rng(0)
    for _ in range(50):
        y = inside(data, rng.normal(size=len(data.b)))
        assert (y[data.zero : data.zero + data.nonneg] >= 0.0).all()
        for block in data.blocks:
            rows = y[block.rows]
            if block.rotated:
                assert rows[0] >= 0 and rows[1] >= 0
                assert 4.0 * rows[0] * rows[1] >= (rows[2:] ** 2).sum()
            else:
                assert rows[0] >= np.linalg.norm(rows[1:])


def test_propagation_loses_no_feasible_point():
    """Points of the disc, with their slacks, stay in the box; those no dearer than the cutoff."""
    problem = Conic(
        "cost",
        (Var("t", "", 0.01, 1e6, 1.0, size=2),),
        (),
        lambda x, p: Terms({"c": cp.sum(cp.inv_pos(x.t))}, {"sum": cp.sum(x.t) / 4.0}),
    )
    data = canonical(problem)
    low, high = propagate(data, data.lower, data.upper, 2.0)
    t = data.user
    others = np.setdiff1d(np.arange(len(low)), t)
    rng = np.random.default_rng(0)
    kept = 0
    for point in rng.uniform(0.3, 4.0, (500, 2)):
        if point.sum() <= 4.0 and (1.0 / point).sum() <= 2.0:
            kept += 1
            assert (low[t] <= point).all() and (point <= high[t]).all()
            inverse = np.sort(1.0 / point)
            assert low[others].max() <= inverse[1] and high[others].min() >= inverse[0]
    assert kept > 20
    assert np.isfinite(low).all() and np.isfinite(high).all()
    assert (high[t] <= 4.0).all() and (low[t] >= 0.49).all()
    assert propagate(data, data.lower, data.upper, 0.4) is None


def test_scales_are_powers_of_two_and_keep_the_cones():
    problem, _ = catalogue()
    data = replace(canonical(problem), allowed={})
    for scale in (equal(data), after(data, equal(data), np.geomspace(1e-6, 1e6, len(data.c)))):
        for numbers in (scale.column, scale.row, np.array([scale.cost])):
            assert (np.frexp(numbers)[0] == 0.5).all()
        for block in data.blocks:
            row = scale.row[block.rows]
            if block.rotated:
                assert (row[2:] ** 2 == row[0] * row[1]).all()
            else:
                assert (row == row[0]).all()
        one = scaled(data, scale)
        point = np.random.default_rng(0).uniform(0.5, 1.5, len(data.c))
        slack = one.back.T @ (scale.row * (data.b - data.A @ (scale.column * point)))
        free = np.setdiff1d(
            np.arange(len(one.b)), np.arange(data.zero + data.nonneg, one.zero + one.nonneg)
        )
        assert (one.b - one.A @ point)[free] == pytest.approx(slack[free], rel=1e-12, abs=1e-12)


def leaves_of(problem):
    result, outcome = run(problem)
    assert result.status == "optimal" and len(outcome.leaves) > 2
    return canonical(problem), outcome


def test_a_search_with_a_hole_proves_nothing():
    problem, _ = catalogue()
    data, outcome = leaves_of(problem)
    assert covers(data, outcome.leaves)
    for k in range(len(outcome.leaves)):
        holed = outcome.leaves[:k] + outcome.leaves[k + 1 :]
        assert not covers(data, holed)
        assert certify(problem, replace(outcome, leaves=holed), 1e-6).bound is None
        narrow = outcome.leaves[k]
        column = data.user[0]
        for end, values in (("lower", 0.08), ("upper", 0.01)):
            moved = getattr(narrow, end).copy()
            if moved[column] != values:
                moved[column] = values
                bad = (*holed, replace(narrow, **{end: moved}))
                assert not covers(data, bad)
    assert not covers(data, ())


def test_forged_multipliers_prove_nothing():
    problem, best = catalogue()
    _, outcome = leaves_of(problem)
    for forge in (lambda y: 1e6 * y, lambda y: -y, lambda y: 0.0 * y):
        forged = tuple(
            replace(leaf, y=None if leaf.y is None else forge(leaf.y), ray=True)
            for leaf in outcome.leaves
        )
        assert certify(problem, replace(outcome, leaves=forged), 1e-6).status == "feasible"
        claim = Outcome(None, infeasible=True, leaves=forged)
        assert certify(problem, claim, 1e-6).status == "failed"
        wrong = tuple(replace(leaf, ray=False) for leaf in forged)
        bound = certify(problem, replace(outcome, leaves=wrong), 1e-6).bound
        assert bound is None or bound <= best[0.2]


def test_a_bound_above_a_feasible_point_is_an_error():
    """Canonical data that are not the user's problem: the contradiction is not swallowed."""
    problem = disc()
    _, outcome = run(problem)
    key = problem.parameter_values().tobytes()
    data = canonical(problem)
    problem.memo["canonical"] = (key, replace(data, d=data.d + 1.0))
    with pytest.raises(CertificateError, match="lies below the dual bound"):
        certify(problem, outcome, 1e-6)


def test_a_quadratic_form_that_is_not_convex_bounds_nothing():
    problem = Conic(
        "form",
        (Var("x", "", -1.0, 1.0, 0.0, size=2),),
        (),
        lambda x, p: Terms({"q": cp.quad_form(x.x, np.array([[2.0, 1.0], [1.0, 2.0]]))}),
    )
    data = canonical(problem)
    assert data.convexity[0] == 0.0
    bent = replace(data, P=sp.csr_array(np.array([[2.0, 4.0], [4.0, 2.0]])))
    low, high = data.lower, data.upper
    assert bent.convexity[0] == pytest.approx(1.0, rel=1e-12)
    least = lagrangian(bent, low, high, np.zeros(2), np.zeros(0)).least
    assert least <= -2.0  # x = (1, -1)
    worse = replace(data, P=sp.csr_array(np.array([[-2.0, 0.0], [0.0, 2.0]])))
    assert lagrangian(worse, low, high, np.zeros(2), np.zeros(0)).least == -math.inf


def test_points_are_judged_by_the_users_rows():
    problem = disc()
    leaf = Leaf(*canonical(problem).lower[None], canonical(problem).upper, np.zeros(1), None)
    outside = certify(problem, Outcome(np.array([3.0, 1.9]), leaves=(leaf,)), 1e-6)
    assert outside.status == "failed" and outside.message.startswith("disc is violated by 0.05")
    inside_it = certify(problem, Outcome(np.array([3.0, 3.0]), leaves=(leaf,)), 1e-6)
    assert inside_it.status == "feasible" and inside_it.bound is None


def test_budgets_and_watch_stop_the_search_with_a_valid_bound():
    problem, best = catalogue()
    early = solve(problem, budget=Budget(evaluations=3))
    assert early.status == "limit"
    assert early.bound is not None and early.bound <= best[0.2] <= early.value
    events = []
    stopped = solve(problem, watch=lambda event: events.append(event) or len(events) < 4)
    assert stopped.status == "limit" and len(events) == 4
    assert solve(problem, watch=lambda event: False).status == "limit"
    loose = solve(problem, budget=Budget(gap=0.5), gap=0.5)
    assert loose.status == "optimal" and loose.evaluations < solve(problem).evaluations
