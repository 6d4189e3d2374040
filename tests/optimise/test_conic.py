"""The second kind of problem: cvxpy text through the same `solve`, with our own certificate."""

import itertools
import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest
from conic_cases import catalogue, disc, linear
from scipy.optimize import linprog

import gearopt
from gearopt.errors import SolveError
from gearopt.optimise.conic.canonical import canonical
from gearopt.optimise.conic.cone_bound import propagate
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Param, Terms, Var

RANDOM = 50


def test_result_has_everything_a_result_has():
    result = gearopt.solve(disc(1.5))
    assert result.status == "optimal" and result.method == "conic"
    assert result.objective == {"name": "height", "value": pytest.approx(2.5, rel=1e-12)}
    assert result.bound <= 2.5 <= result.value + 1e-11 and result.gap < 1e-10
    assert result.design["at_mm"] == pytest.approx([3.0, 2.5], abs=1e-6)
    assert result.limits == {"disc": pytest.approx(1.0, abs=1e-11)}
    assert result.report["square"] == pytest.approx([9.0, 6.25], abs=1e-5)
    assert result.report["sum"] == pytest.approx(5.5, abs=1e-6)
    words = "Proof: a convex conic problem; the bound is a dual one, computed from its data"
    assert result.proof["method"] == "dual" and result.proof["sentence"] == f"{words}."
    assert set(result.certificate) == {"feasibility", "stationarity", "complementarity"}
    assert max(result.certificate.values()) < 1e-10
    assert {"cvxpy", "clarabel"} <= set(result.versions)
    assert Result.from_json(result.to_json()) == result


def test_new_parameters_do_not_canonicalise_again():
    problem, calls = disc(), []

    def counted(x, p, inner=problem.evaluate):
        calls.append(1)
        return inner(x, p)

    problem = replace(problem, evaluate=counted)
    first = problem.model().problem
    for radius in (1.0, 3.0, 0.5):
        result = solve(problem.at(radius=radius))
        assert result.value == pytest.approx(4.0 - radius, rel=1e-11)
    assert len(calls) == 1
    assert problem.at(radius=7.0).model().problem is first
    with pytest.raises(ValueError, match="no parameter 'diameter'"):
        problem.at(diameter=1.0)


def test_parameters_may_change_their_sign():
    """cvxpy concludes curvature from signs: w |x| is convex for w >= 0 only."""
    problem = Conic(
        "weighted",
        (Var("x", "", -1.0, 3.0, 0.0),),
        (Param("w", "", 1.0), Param("slope", "", 1.0)),
        lambda x, p: Terms({"c": p.w * cp.abs(x.x) + p.slope * x.x}),
    )
    assert solve(problem.at(slope=2.0)).value == pytest.approx(-1.0, rel=1e-11)
    assert solve(problem.at(slope=-2.0)).value == pytest.approx(-3.0, rel=1e-11)
    with pytest.raises(SolveError, match="minimise c is not convex"):
        solve(problem.at(w=-1.0))


def test_the_two_kinds_refuse_each_others_methods():
    smooth = Problem("smooth", (Var("x", "", 0.0, 1.0, 0.5),), (), lambda x, p: Terms({"x": x.x}))
    with pytest.raises(SolveError, match=r"ipopt takes a Problem .*; disc is a Conic"):
        solve(disc(), "ipopt")
    with pytest.raises(SolveError, match=r"conic takes a Conic .*; smooth is a Problem"):
        solve(smooth, "conic")
    with pytest.raises(SolveError, match="no method 'simplex'; methods: conic"):
        solve(disc(), "simplex")


X = (Var("x", "", 0.5, 2.0, 1.0, size=2),)


@pytest.mark.parametrize(
    ("terms", "words"),
    [
        (lambda x, p: Terms({"c": cp.sqrt(x.x[0])}), "minimise c is not convex"),
        (lambda x, p: Terms({"c": x.x}), "objective c is not a scalar"),
        (lambda x, p: Terms({"c": x.x[0], "d": x.x[1]}), r"2 objectives \(c, d\)"),
        (lambda x, p: Terms({"c": x.x[0]}, {"l": cp.log(x.x)}), "limits l is not convex"),
        (
            lambda x, p: Terms({"c": x.x[0]}, {"l": cp.SOC(x.x[0], x.x)}),
            "l is a constraint of its own",
        ),
        (lambda x, p: Terms({"c": x.x[0]}, equal={"e": x.x**2}), "equal e is not affine"),
        (lambda x, p: Terms({"c": x.x[0] / p.w}), "multiply by p.per.NAME"),
        (lambda x, p: Terms({"c": x.x[0] * p.per.zero}), "divides by a parameter that is zero"),
        (lambda x, p: Terms({"c": cp.exp(x.x[0])}), "exponential, semidefinite or power cone"),
        (lambda x, p: Terms({"c": x.x[0]}, {"l": x.x}, {"l[2]": x.x[0]}), "two rows are named"),
        (lambda x, p: x.x, "not Terms"),
    ],
)
def test_refusals_name_the_term(terms, words):
    with pytest.raises(SolveError, match=words):
        solve(Conic("refused", X, (Param("w", "", 2.0), Param("zero", "", 0.0)), terms))


def test_blocks_equalities_and_unused_variables():
    """Least norm on a plane; y is used nowhere, z only in a define."""

    def evaluate(x, p):
        return Terms(
            {"norm": cp.norm(x.x)},
            {"box": (x.x[0], x.x[1:] / 2.0)},
            {"under": x.z},
            {"plane": x.x @ np.array([1.0, 2.0, 2.0]) / 9.0},
        )

    variables = (
        Var("x", "", -5.0, 5.0, 0.0, size=3),
        Var("y", "", 1.0, 4.0, 2.0),
        Var("z", "", 0.0, 3.0, 0.0),
    )
    result = solve(Conic("plane", variables, (), evaluate))
    assert result.status == "optimal"
    assert result.value == pytest.approx(3.0, rel=1e-10)
    assert result.design["x"] == pytest.approx([1.0, 2.0, 2.0], abs=1e-6)
    assert list(result.limits) == ["box[1]", "box[2][1]", "box[2][2]"]
    assert 1.0 <= result.design["y"] <= 4.0 and result.design["z"] <= 1.0 + 1e-8


def random_linear(seed):
    """A linear program, sometimes impossible, sometimes with columns spread over 1e8."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(3, 15), rng.integers(2, 20)
    rows, c = rng.normal(size=(m, n)), rng.normal(size=n)
    ends = rows @ rng.uniform(0.0, 1.0, n) + rng.uniform(-0.3, 1.0, m)
    ends = ends - (rng.uniform(0.0, 1.5) * math.sqrt(n) if seed % 3 == 0 else 0.0)
    return rng, c, rows, ends


@pytest.mark.slow
def test_random_linear_programs_against_highs():
    found = {"optimal": 0, "infeasible": 0}
    for seed in range(RANDOM):
        rng, c, rows, ends = random_linear(seed)
        unit = 10.0 ** rng.uniform(-4.0, 4.0, len(c)) if seed % 5 == 0 else np.ones(len(c))
        result = solve(linear(c / unit, rows / unit, ends, tuple(unit)))
        highs = linprog(c, rows, ends, bounds=(0.0, 1.0))
        assert result.status == ("optimal" if highs.status == 0 else "infeasible"), seed
        found[result.status] += 1
        if highs.status == 0:
            assert result.value == pytest.approx(highs.fun, rel=1e-8, abs=1e-8)
            assert result.bound <= highs.fun + 1e-8
        else:
            assert all(name.startswith("r[") for name in result.proof["conflict"])
    assert min(found.values()) >= 5


def test_a_conflict_is_impossible_by_itself():
    """The named rows alone, as a linear program, have no solution either."""
    tried = 0
    for seed in range(0, 24, 3):
        _, c, rows, ends = random_linear(seed)
        result = solve(linear(c, rows, ends))
        if result.status == "infeasible":
            names = result.proof["conflict"]
            kept = [int(n[2:-1]) - 1 for n in names] if rows.shape[0] > 1 else [0]
            assert linprog(0 * c, rows[kept], ends[kept], bounds=(0.0, 1.0)).status == 2
            tried += len(names) < len(ends)
    assert tried >= 3


@pytest.mark.slow
def test_random_quadratic_programs_against_their_optimality_conditions():
    """sum_squares(L x - 1) + c.x in a box: projected gradient of zero is the optimum."""
    for seed in range(RANDOM):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 12))
        left = rng.normal(size=(n - 2 if seed % 4 == 0 and n > 2 else n + 1, n))
        c = rng.normal(size=n)
        problem = Conic(
            "quadratic",
            (Var("x", "", -0.5, 0.5, 0.0, size=n),),
            (),
            lambda x, p, left=left, c=c: Terms({"q": cp.sum_squares(left @ x.x - 1.0) + c @ x.x}),
        )
        result = solve(problem)
        assert result.status == "optimal" and result.gap < 1e-9, seed
        x = np.array(result.design["x"])
        gradient = 2.0 * left.T @ (left @ x - 1.0) + c
        assert np.abs(x - np.clip(x - gradient, -0.5, 0.5)).max() < 1e-7


@pytest.mark.slow
def test_random_cone_programs_against_the_closed_form():
    """min c.x on an ellipsoid |B (x - z)| <= r: c.z - r |B^-T c|; a half-space 1 % lower: none."""
    for seed in range(RANDOM):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 10))
        B, c, z = rng.normal(size=(n, n)), rng.normal(size=n), rng.normal(size=n)
        reach = np.linalg.norm(np.linalg.solve(B.T, c))

        def evaluate(x, p, B=B, c=c, z=z, below=c @ z - 1.01 * reach, cut=seed % 5 == 0):
            limits = {"ball": cp.norm(B @ (x.x - z))}
            return Terms({"c": c @ x.x}, limits | ({"half": c @ x.x - below + 1} if cut else {}))

        result = solve(Conic("cone", (Var("x", "", -1e3, 1e3, 0.0, size=n),), (), evaluate))
        if seed % 5 == 0:
            assert result.status == "infeasible"
            assert set(result.proof["conflict"]) <= {"ball", "half"}
        else:
            assert result.status == "optimal" and result.gap < 1e-8
            assert result.value == pytest.approx(c @ z - reach, rel=1e-9, abs=1e-9)


@pytest.mark.slow
def test_random_integer_programs_against_enumeration():
    found = {"optimal": 0, "infeasible": 0}
    for seed in range(RANDOM):
        rng = np.random.default_rng(seed)
        n, m = int(rng.integers(2, 7)), int(rng.integers(1, 5))
        rows, c = np.rint(10 * rng.normal(size=(m, n))), np.rint(10 * rng.normal(size=n))
        ends = np.rint(rows @ rng.uniform(0.0, 3.0, n) + rng.uniform(-20.0, 3.0, m))
        points = np.array(list(itertools.product(range(4), repeat=n)))
        good = points[(points @ rows.T <= ends).all(axis=1)]
        result = solve(linear(c, rows, ends, 3, integer=True))
        found[result.status] += 1
        assert result.status == ("optimal" if len(good) else "infeasible"), seed
        if len(good):
            assert result.value == pytest.approx((good @ c).min(), abs=1e-9)
            assert result.bound <= (good @ c).min() + 1e-9
    assert min(found.values()) >= 3


@pytest.mark.slow
def test_finite_sets_in_a_cone_program():
    problem, best = catalogue()
    for budget, value in best.items():
        result = solve(problem.at(budget=budget))
        assert result.status == "optimal" and result.gap < 1e-8
        assert result.value == pytest.approx(value, rel=1e-12)
        assert set(result.design["t_mm"]) <= set(problem.variables[0].values)
        parts = f"{result.proof['nodes']:,} parts of the ranges of variables."
        assert result.proof["nodes"] > 1 and result.proof["sentence"].endswith(parts)
    impossible = solve(problem.at(budget=0.03))
    assert impossible.status == "infeasible" and impossible.proof["conflict"] == ["rss"]


def test_grades_against_dynamic_programming():
    """One grade a component, 6 components of 9: a multiple-choice knapsack."""
    rng = np.random.default_rng(1)
    grade = np.sqrt(2.0) ** np.arange(-4, 5)
    use, cost = 10.0 ** rng.uniform(-2.0, 1.0, (6, 1)) * grade, np.repeat(1.0 / grade[None], 6, 0)
    budget = use[:, 4].sum()

    def evaluate(x, p):
        pick = cp.reshape(x.pick, (6, 9), order="C")
        return Terms(
            {"cost": cp.sum(cp.multiply(cost, pick))},
            {"budget": cp.sum(cp.multiply(use / budget, pick))},
            equal={"one": cp.sum(pick, axis=1)},
        )

    result = solve(
        Conic("grades", (Var("pick", "", 0, 1, 0, size=54, integer=True),), (), evaluate)
    )
    front = [(0.0, 0.0)]
    for row in range(6):
        sums = sorted((u + use[row, k], c + cost[row, k]) for u, c in front for k in range(9))
        front = [(u, c) for u, c in sums if u <= budget * (1.0 + 1e-12)]
        front = [f for k, f in enumerate(front) if k == 0 or f[1] < min(g[1] for g in front[:k])]
    assert result.status == "optimal"
    assert result.value == pytest.approx(min(c for _, c in front), rel=1e-12)


def test_integers_with_continuous_variables():
    """min (k - 2.6)^2 + (x - k/2)^2, x <= 1: k = 2, x = 1 costs 0.36; k = 3, x = 1 costs 0.41."""
    problem = Conic(
        "mixed",
        (Var("k", "", 0, 9, 0, integer=True), Var("x", "", 0.0, 5.0, 0.0)),
        (),
        lambda x, p: Terms({"q": cp.square(x.k - 2.6) + cp.square(x.x - x.k / 2)}, {"x": x.x}),
    )
    result = solve(problem)
    assert result.status == "optimal"
    assert result.value == pytest.approx(0.36, rel=1e-9)
    assert result.design["k"] == 2 and isinstance(result.design["k"], int)


def test_integers_that_no_point_meets():
    """2 x = 1 has a real solution and no whole one; 3 x + 3 y = 7 needs branching."""
    one = Conic(
        "parity",
        (Var("x", "", 0, 5, 0, integer=True),),
        (),
        lambda x, p: Terms({"x": x.x}, equal={"half": 2.0 * x.x}),
    )
    result = solve(one)
    assert result.status == "infeasible"
    two = Conic(
        "sevenths",
        (Var("x", "", 0, 9, 0, size=2, integer=True),),
        (),
        lambda x, p: Terms({"x": x.x[0]}, equal={"seven": 3.0 / 7.0 * cp.sum(x.x)}),
    )
    assert solve(two).status == "infeasible"


@pytest.mark.parametrize("weights", [(0.0, 0.0), (0.0, 2.0), (-0.0, 1.0)])
def test_parameters_that_are_zero(weights):
    """An entry of zero in the canonical data bounds nothing: x <= 1/w, or 10 where w is 0."""
    problem = Conic(
        "zero",
        (Var("x", "", 0.0, 10.0, 1.0, size=2),),
        (Param("w", "", (1.0, 1.0), 2),),
        lambda x, p: Terms({"c": -cp.sum(x.x)}, {"use": cp.multiply(p.w, x.x)}),
    )
    assert solve(problem).value == pytest.approx(-2.0, rel=1e-10)
    best = -sum(min(10.0, 1.0 / w) if w else 10.0 for w in weights)
    result = solve(problem.at(w=weights))
    assert result.status == "optimal" and result.value == pytest.approx(best, rel=1e-10)


def test_a_stored_zero_bounds_nothing():
    """0 x <= 1 is no bound of x, however the entry is stored."""
    data = canonical(linear(np.ones(2), np.ones((1, 2)), np.ones(1), 5.0))
    stored = data.A.copy()
    stored.data[:] = 0.0
    low, high = propagate(replace(data, A=stored, b=np.ones_like(data.b)), data.lower, data.upper)
    assert low.tolist() == [0.0, 0.0] and high.tolist() == [5.0, 5.0]
