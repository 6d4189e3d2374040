"""Multipliers from gradients alone, against closed forms."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.certificate import certify
from gearopt.optimise.dual import multipliers
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome
from gearopt.optimise.stationarity import ACTIVE_WITHIN
from gearopt.optimise.terms import Terms, Var


def at(problem, x):
    shape = form(problem)
    low, high, _ = (shape.to_y(b) for b in problem.bounds())
    return multipliers(shape, shape.to_y(np.array(x)), problem.parameter_values(), low, high)


def pair(**rows):
    both = (Var("x", "", 0.01, 100, 1.0, log=True), Var("y", "", 0.01, 100, 1.0, log=True))
    return Problem(
        "pair",
        both,
        (),
        lambda x, p: Terms(
            {"f": x.x**3.0 * x.y**2.0},
            **{k: {n: row(x) for n, row in v.items()} for k, v in rows.items()},
        ),
    )


def test_a_limit_carries_the_slope_of_the_objective():
    """log f = 3 log x + 2 log y, limits 1/x and 1/y at 1: multipliers 3 and 2; an idle one is 0."""
    problem = pair(
        limits={"x": lambda x: 1.0 / x.x, "y": lambda x: 1.0 / x.y, "idle": lambda x: x.x / 9}
    )
    lam_g, lam_h = at(problem, [1.0, 1.0])
    assert lam_g == pytest.approx([3.0, 2.0, 0.0], abs=1e-12) and len(lam_h) == 0


def test_an_equality_may_have_either_sign():
    problem = pair(limits={"y": lambda x: 1.0 / x.y}, equal={"x": lambda x: x.x / 2.0})
    lam_g, lam_h = at(problem, [2.0, 1.0])
    assert lam_g == pytest.approx([2.0], abs=1e-12)
    assert lam_h == pytest.approx([-3.0], abs=1e-12)


def test_a_variable_on_its_bound_needs_no_multiplier():
    problem = pair(limits={"y": lambda x: 1.0 / x.y})
    lam_g, _ = at(problem, [0.01, 1.0])
    assert lam_g == pytest.approx([2.0], abs=1e-12)


def test_no_multiplier_is_negative():
    """At a point where a row pulls the wrong way its multiplier is 0, not below."""
    problem = pair(limits={"wrong": lambda x: x.x, "right": lambda x: 1.0 / x.y})
    lam_g, _ = at(problem, [1.0, 1.0])
    assert lam_g == pytest.approx([0.0, 2.0], abs=1e-12)


@pytest.fixture(params=["dense", "sparse"])
def either(request, monkeypatch):
    """Solve dense systems, or all as large sparse ones."""
    if request.param == "sparse":
        monkeypatch.setattr("gearopt.optimise.dual.DENSE_ENTRIES", -1)
        monkeypatch.setattr("gearopt.optimise.dual.SPARSE", 1.0)


def given(gradient, g=(), of_g=(), of_h=(), y=None, low=None, high=None):
    """Multipliers of numbers as they are: slopes, rows, their derivatives, and where y lies."""
    size = len(gradient)
    rows = [np.array(r, float).reshape(-1, size) for r in (of_g, of_h)]
    sizes = {1: len(rows[0]), 2: len(rows[1])}

    def derivatives(y, p, lam_g, lam_h):
        assert not lam_g.any() and not lam_h.any()
        return 0.0, np.array(g, float), np.zeros(sizes[2]), np.array(gradient, float), None

    derivatives.numel_out = sizes.get
    sparse = [ca.sparsify(ca.DM(r)) for r in rows]
    shape = SimpleNamespace(derivatives=derivatives, jacobians=lambda y, p: sparse)
    y = np.zeros(size) if y is None else np.array(y, float)
    ends = (
        np.full(size, s * np.inf) if e is None else np.array(e) for s, e in ((-1, low), (1, high))
    )
    return multipliers(shape, y, np.empty(0), *ends)


@pytest.mark.usefixtures("either")
def test_rows_count_from_a_millionth_below_their_limit():
    one = {"gradient": [-2.0], "of_g": [[1.0]]}
    for g, lam in (
        (0.0, 2.0),
        (1e-9, 2.0),
        (-ACTIVE_WITHIN, 2.0),
        (-1.001 * ACTIVE_WITHIN, 0.0),
        (-1.0, 0.0),
    ):
        assert given(g=[g], **one)[0] == pytest.approx([lam])
    assert ACTIVE_WITHIN == 1e-6


@pytest.mark.usefixtures("either")
def test_variables_on_their_bounds_do_not_count():
    """Two slopes, one row that could level either; on a bound a slope may stay."""
    two = {"gradient": [-2.0, -8.0], "g": [0.0], "of_g": [[1.0, 2.0]]}
    both = given(**two)[0][0]
    assert both == pytest.approx((2.0 + 16.0) / 5.0)
    for ends, lam in (
        ({"low": [-np.inf, 0.0]}, 2.0),
        ({"low": [-np.inf, -ACTIVE_WITHIN]}, 2.0),
        ({"low": [-np.inf, -1.001 * ACTIVE_WITHIN]}, both),
        ({"high": [np.inf, 0.0]}, 2.0),
        ({"high": [np.inf, ACTIVE_WITHIN]}, 2.0),
        ({"high": [np.inf, 1.001 * ACTIVE_WITHIN]}, both),
        ({"low": [0.0, -np.inf]}, 4.0),
        ({"low": [0.0, -np.inf], "high": [np.inf, 0.0]}, 0.0),
    ):
        assert given(**two, **ends)[0] == pytest.approx([lam])


@pytest.mark.usefixtures("either")
def test_rows_that_pull_the_wrong_way_are_left_out_one_after_another():
    """Without the first the second pulls the wrong way too; the equality may."""
    lam_g, lam_h = given(
        gradient=[-1.0, 2.0, 3.0],
        g=[0.0, -1.0, 0.0, 0.0],
        of_g=[[1.0, 0.0, 0.0], [5.0, 5.0, 5.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.5]],
        of_h=[[0.0, 0.0, 1.0]],
    )
    assert lam_g == pytest.approx([1.0, 0.0, 0.0, 0.0], abs=1e-12)
    assert lam_h == pytest.approx([-3.0])
    twice = [[-2.0, -2.0], [-1.0, 2.0], [0.0, 1.0]]
    lam_g, _ = given(gradient=[-1.0, -2.0], g=np.zeros(3), of_g=twice)
    assert lam_g == pytest.approx([0.0, 0.0, 2.0], abs=1e-12)


@pytest.mark.usefixtures("either")
@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_rows_that_repeat_others_share_their_multiplier(unit):
    """In any unit; rows without a slope have none, and the only row may be of the wrong sign."""
    both = {"g": np.zeros(3), "of_g": unit * np.array([[1.0, 2.0], [1.0, 2.0], [0.0, 0.0]])}
    lam_g, lam_h = given([-3.0, -6.0], of_h=[[unit, -unit]], **both)
    assert (lam_g >= 0.0).all() and lam_g[2] == 0.0
    assert lam_g.sum() * unit == pytest.approx(3.0, rel=1e-9)
    assert lam_h * unit == pytest.approx([0.0], abs=1e-9)
    assert given([3.0], g=[0.0], of_g=[[unit]])[0] == pytest.approx([0.0])
    assert given([3.0], g=[0.0], of_g=[[0.0]])[0] == pytest.approx([0.0])


def test_large_systems_of_few_entries_are_solved_as_sparse_ones(monkeypatch):
    from scipy.sparse import linalg

    seen, solve = [], linalg.splu
    monkeypatch.setattr(linalg, "splu", lambda matrix: seen.append(1) or solve(matrix))
    rows = {"g": [0.0, -1.0, 0.0], "of_g": [[1.0, 0, 0], [0, 0, 0], [0, 1, 0]], "of_h": [[0, 0, 1]]}
    for small, share, sparse in ((9, 1.0, 0), (8, 0.3333, 0), (8, 0.33334, 1)):
        monkeypatch.setattr("gearopt.optimise.dual.DENSE_ENTRIES", small)
        monkeypatch.setattr("gearopt.optimise.dual.SPARSE", share)
        seen.clear()
        lam_g, lam_h = given([-1.0, -2.0, 3.0], **rows)
        assert lam_g == pytest.approx([1.0, 0.0, 2.0]) and lam_h == pytest.approx([-3.0])
        assert len(seen) == sparse


def test_against_all_choices_of_rows():
    """The best of all subsets of rows with multipliers >= 0, of random cases."""
    rng = np.random.default_rng(5)
    for _ in range(60):
        rows = rng.normal(size=(3, 3))
        lam = np.maximum(rng.normal(size=3), 0.0)
        gradient = -rows.T @ lam  # a KKT point
        found, _ = given(gradient, g=np.zeros(3), of_g=rows)
        assert found == pytest.approx(lam, abs=1e-9)


@pytest.mark.parametrize("held", [0, 2])
def test_of_rows_that_depend_on_each_other_those_are_kept_that_level_the_slopes(held):
    """At corners where more limits meet than there are variables, in any units; with equalities."""
    rng = np.random.default_rng(6)
    missed = 0
    for _ in range(100):
        size, count = rng.integers(3, 8), rng.integers(4, 12)
        of_g, of_h = rng.normal(size=(count, size)), rng.normal(size=(held, size))
        of_g[1] = of_g[0]
        of_g[3] = of_g[2] + of_g[0]
        lam = np.where(rng.random(count) < 0.6, rng.random(count), 0.0)
        gradient = 10.0 ** rng.integers(-18, 18) * (-of_g.T @ lam - of_h.T @ rng.normal(size=held))
        of_g *= 10.0 ** rng.integers(-3, 3, (count, 1))
        lam_g, lam_h = given(gradient, g=np.zeros(count), of_g=of_g, of_h=of_h)
        left = gradient + of_g.T @ lam_g + of_h.T @ lam_h
        missed += not np.abs(left).max() <= 1e-9 * np.abs(gradient).max()
        assert (lam_g >= 0.0).all()
    assert missed == 0


def test_a_corner_of_many_limits_is_a_minimum():
    """Four planes meet in three variables; the slope of a concave objective is within three."""
    planes = np.array([[-3, -1, -3], [-1, 1, 0], [3, 1, -2], [0, -3, 0]])
    slope = -planes.T @ np.array([1, 1, 0, 1])

    def text(x, p):
        limits = {f"plane_{k}": 1.0 + row @ np.array(x.x) for k, row in enumerate(planes)}
        bent = -0.1 * sum(v**2 for v in x.x)
        return Terms({"f": slope @ np.array(x.x) + bent + 9.0}, limits)

    problem = Problem("corner", (Var("x", "", -9.0, 9.0, 1.0, 3),), (), text)
    assert certify(problem, Outcome(np.zeros(3)), 1e-6).status == "stationary"


def test_without_an_end_of_the_choice_rows_of_the_wrong_sign_are_left_out(monkeypatch):
    def endless(*system):
        raise RuntimeError("Maximum number of iterations reached.")

    monkeypatch.setattr("scipy.optimize.nnls", endless)
    lam_g, _ = given([-1.0, -2.0], g=np.zeros(2), of_g=[[-1.0, 0.0], [0.0, 1.0]])
    assert lam_g == pytest.approx([0.0, 2.0])


@pytest.mark.usefixtures("either")
def test_slopes_that_are_no_numbers_have_no_multipliers():
    """Of free variables; a row that is off its limit and a variable on its bound do not matter."""
    one = {"gradient": [-1.0, -2.0], "g": [0.0, -1.0], "of_g": [[np.nan, 1.0], [np.inf, np.inf]]}
    assert given(**one) is None
    assert given(**one, low=[0.0, -np.inf])[0] == pytest.approx([2.0, 0.0])
    assert given([np.inf, -2.0], g=[0.0], of_g=[[1.0, 1.0]]) is None
    root = Problem(
        "root",
        (Var("x", "", -2, 2, 1.0), Var("y", "", -2, 2, 1.0)),
        (),
        lambda x, p: Terms({"f": x.x}, {"far": 1.0 - np.sqrt(x.x**2 + x.y**2)}),
    )
    assert certify(root, Outcome(np.zeros(2)), 1e-6).status == "feasible"


def test_systems_that_are_too_large_are_left_alone(monkeypatch):
    monkeypatch.setattr("gearopt.optimise.dual.MAX_ENTRIES", 6)
    rows = {"g": [0.0], "of_g": [[1.0, 0.0]], "of_h": [[0.0, 1.0], [0.0, 1.0]]}
    assert given([-1.0, 2.0], **rows) is not None
    monkeypatch.setattr("gearopt.optimise.dual.MAX_ENTRIES", 5)
    assert given([-1.0, 2.0], **rows) is None
