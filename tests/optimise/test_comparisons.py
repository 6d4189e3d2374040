"""Limits as comparisons and objectives that are maximised: the same answers as written by hand."""

import pickle

import cvxpy as cp
import numpy as np
import pytest

import gearopt
from gearopt import Budget, Conic, Param, Problem, Result, SolveError, Terms, Var, solve

SIDES = tuple(Var(name, "m", 0.1, 50.0, 1.0, log=True) for name in "hwd")


def written(x, p):
    limits = {
        "wall": 2.0 * x.h * (x.w + x.d) / p.A,
        "floor": x.w * x.d / 10.0,
        "aspect": (x.h / (2.0 * x.w), x.d / (2.0 * x.w)),
    }
    return Terms(minimise={"cost": 1.0 / (x.h * x.w * x.d)}, limits=limits)


def compared(x, p):
    limits = {
        "wall": 2.0 * x.h * (x.w + x.d) <= p.A,
        "floor": 10.0 >= x.w * x.d,
        "aspect": (x.h <= 2.0 * x.w, 2.0 * x.w >= x.d),
    }
    return Terms(maximise={"volume": x.h * x.w * x.d}, limits=limits)


def posed(text, **changes):
    return Problem("box", SIDES, (Param("A", "m2", 200.0, role="limit"),), text).at(**changes)


def test_comparisons_of_positive_sides_are_their_quotients():
    """Rows are the same bit by bit; what is maximised is told by its own name and signs."""
    by_hand, ours = posed(written), posed(compared)
    points = np.random.default_rng(1).uniform(0.1, 50.0, (50, 3))
    assert np.array_equal(by_hand.batch(points).G, ours.batch(points).G)
    result, other = solve(ours), solve(by_hand)
    assert result.status == other.status == "optimal" and result.maximised
    assert result.objective["name"] == "volume"
    assert result.value == pytest.approx(1.0 / other.value, rel=1e-6) and result.bound > 0.0
    price = 2.0 * result.multipliers["wall"] / result.value  # of the wall: d ln V / d ln A
    assert price == pytest.approx(-2.0 * other.multipliers["wall"] / other.value, rel=1e-4)
    assert "126.49" in repr(result) and Result.from_dict(result.to_dict()).maximised
    (wall,) = gearopt.explain(ours).influences
    assert wall.sensitivity == pytest.approx(result.multipliers["wall"] / result.value, rel=1e-4)
    assert gearopt.evaluate(ours, result.design).value == pytest.approx(result.value)
    assert solve(pickle.loads(pickle.dumps(ours))).value == result.value


@pytest.mark.parametrize("seed", range(12))
def test_differences_are_what_they_say(seed):
    """Random rows of both signs: a point meets the row where it meets the comparison."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(0.0, 3.0, (2, 3))

    def text(x, p):
        w = np.array(x.w)
        left, right = np.sum(a * w) + p.c, np.sum(b * w**2) - 1.0
        return Terms(
            minimise={"f": np.sum(w**2)},
            limits={"le": left <= right, "ge": (left >= -4.0, x.w[0] <= np.exp(x.w[1]))},
            equal={"eq": x.w[0] + x.w[1] == 0.25 * x.w[2]},
        )

    three = Var("w", "", -5.0, 5.0, 0.5, size=3)
    problem = Problem("rows", (three,), (Param("c", "", rng.normal()),), text)
    w = rng.uniform(-5.0, 5.0, (200, 3))
    w[:, 2] = 4.0 * (w[:, 0] + w[:, 1])
    got, c = problem.batch(w), problem.parameter_values()[0]
    assert [row.name for row in problem.rows.inequalities] == ["le", "ge[1]", "ge[2]"]
    left, right = w @ a + c, w**2 @ b - 1.0
    holds = np.column_stack([left <= right, left >= -4.0, w[:, 0] <= np.exp(w[:, 1])])
    assert np.array_equal(got.G <= 1.0, holds) and np.allclose(got.H, 1.0)
    traced = problem.traced().terms(w[0], [c])
    assert np.allclose(np.array(traced[1]).ravel(), got.G[0], rtol=1e-12)


def test_whole_numbers_repeats_and_choices_take_comparisons():
    def text(x, p):
        return Terms(
            minimise={"f": np.where(x.a <= 3, x.a + 10.0, x.a) + x.b},
            limits={"far": x.a * x.b >= 12.0, "near": x.a + x.b <= 8.0},
        )

    whole = tuple(Var(n, "", 0, 10, 1, integer=True) for n in "ab")
    result = solve(
        Problem("w", whole, (), text), method="annealing", budget=Budget(evaluations=3000)
    )
    best = min(
        (a + 10 if a <= 3 else a) + b
        for a in range(11)
        for b in range(11)
        if a * b >= 12 and a + b <= 8
    )
    assert result.value == best and result.feasible
    row = gearopt.Repeat(
        "load", (), {"f": np.array([1.0, 4.0])}, lambda x, p, r: Terms({}, {"held": x.a >= r.f})
    )
    lift = Problem("l", (Var("a", "", 0, 9, 5),), (), lambda x, p: Terms({"a": x.a}), (row,))
    result = solve(lift)
    assert result.value == pytest.approx(4.0) and "load.held[2]" in result.limits


def test_cvxpy_comparisons_are_rows():
    def text(x, p):
        limits = {
            "return": x.w @ np.array([0.1, 0.2, 0.15]) >= p.r,
            "budget": cp.sum(x.w) == 1,
            "parts": x.w <= 0.9,
        }
        return Terms(maximise={"calm": -cp.sum_squares(x.w)}, limits=limits)

    shares = (Var("w", "", 0, 1, 1 / 3, size=3),)
    problem = Conic("portfolio", shares, (Param("r", "", 0.16),), text)
    result = solve(problem)
    assert result.status == "optimal" and result.value == pytest.approx(-0.353333, rel=1e-5)
    assert problem.rows.equalities == ("budget",)
    assert solve(problem.at(r=0.19)).value == pytest.approx(-0.68, rel=1e-5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (lambda x, p: Terms({"f": x.a}, {"g": 1.0 <= x.a <= 2.0, "h": x.a <= 1.0}), "two limits"),
        (lambda x, p: Terms({"f": x.a}, {"g": x.a < 2.0}), "no comparison of variables by <="),
    ],
)
def test_what_is_no_limit_is_told(text, words):
    with pytest.raises(SolveError, match=words):
        solve(Problem("p", (Var("a", "", 0.0, 9.0, 5.0),), (), text))


def test_a_parameter_that_limits_are_divided_by_stays_positive():
    problem = posed(compared)
    assert problem.rows.objectives == ("negative_of_volume",)
    with pytest.raises(SolveError, match="parameter A"):
        solve(problem.at(A=-1.0), budget=Budget(evaluations=5))
