"""Wide logarithms: split, they have the same optima, multipliers and proofs as unsplit."""

import math
import time

import casadi as ca
import numpy as np
import pytest
from campaigns import few

from gearopt.optimise import nonlinear, tape
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Param, Repeat, Terms, Var


def wide(name, size):
    """Sums, products, powers and shared sums of `size` variables; a parameter that is zero."""
    weights = np.linspace(1.0, 3.0, size)

    def text(x, p):
        total = sum(v * a for v, a in zip(x.w, weights, strict=True))
        cost = sum(a / v for v, a in zip(x.w, weights, strict=True))
        running, rows = 0.0, []
        for v in x.w:
            running = running + v
            rows.append(running / (4.0 * size))
        return {
            "budget": lambda: Terms({"cost": cost + p.zero}, {"budget": total / (p.most * size)}),
            "norm": lambda: Terms(
                {"cost": np.sqrt(sum(v**2 for v in x.w)) * 3.0 + cost**2 / x.w[0] ** 0.5}
            ),
            "product": lambda: Terms(
                {"cost": cost}, {"product": np.prod(x.w) / 2.0}, equal={"first": x.w[0] / x.w[1]}
            ),
            "shared": lambda: Terms({"cost": cost}, {"running": tuple(rows)}),
            "nested": lambda: Terms({"cost": cost * total + (cost + 1.0) * (total + x.w[0]) ** 2}),
            "equal": lambda: Terms({"cost": cost + total}, equal={"mean": np.prod(x.w) / 3.0}),
        }[name]()

    w = Var("w", "", 1e-2, 1e2, 1.5, size=size, log=True)
    return Problem(name, (w,), (Param("most", "", 2.0), Param("zero", "", 0.0)), text)


@pytest.mark.parametrize("name", few(["budget", "norm", "nested", "product", "shared", "equal"], 3))
def test_split_and_unsplit_programs_have_one_optimum(name, monkeypatch):
    unsplit = solve(wide(name, 12))
    monkeypatch.setattr(nonlinear, "DENSE_VARIABLES", 2)
    monkeypatch.setattr(nonlinear, "GROUP", 3)
    problem = wide(name, 12)
    shape = form(problem)
    assert nonlinear.split(shape, tape.kinds(problem)).levels.numel() > 0
    split = solve(problem)
    assert split.status == unsplit.status == "optimal"
    assert split.value == pytest.approx(unsplit.value, rel=1e-9)
    assert split.design["w"] == pytest.approx(unsplit.design["w"], rel=1e-4)
    mine, theirs = (ipopt.run(one, Budget(), 0, None) for one in (problem, wide(name, 12)))
    assert mine.lam_g == pytest.approx(theirs.lam_g, abs=1e-6)
    assert mine.lam_h == pytest.approx(theirs.lam_h, abs=1e-6)


@pytest.mark.parametrize("name", few(["budget", "shared", "nested", "norm", "product", "equal"], 3))
def test_a_split_program_is_sparse_and_starts_on_its_levels(name):
    problem = wide(name, 120)
    parts = nonlinear.split(form(problem), tape.kinds(problem))
    y, p = np.zeros(120), problem.parameter_values()
    z = np.concatenate([y, np.array(parts.start(y, p)).ravel()])
    given = [parts.z, parts.p]
    objective, rows, levels = (
        np.array(ca.Function("at", given, [part])(z, p)).ravel()
        for part in (
            parts.objective,
            ca.vertcat(parts.inequalities, parts.equalities),
            parts.levels,
        )
    )
    batch = problem.batch(np.ones((1, 120)))
    assert objective == pytest.approx(np.log(batch.F[0]), rel=1e-12)
    assert rows == pytest.approx(np.log(np.hstack([batch.G[0], batch.H[0]])), rel=1e-12, abs=1e-14)
    assert levels == pytest.approx(0.0, abs=1e-12)
    lam = ca.SX.sym("lam", len(rows) + len(levels))
    every = ca.vertcat(parts.inequalities, parts.equalities, parts.levels)
    slope = ca.Function("slope", [*given, lam], [ca.gradient(ca.dot(lam, every), parts.z)])
    assert slope.jac_sparsity(0, 0).nnz() < 40 * len(z)  # of a dense one: 120 a row


@pytest.mark.slow
def test_two_thousand_separable_variables_against_the_closed_form():
    """min sum a/w with sum a w <= n: w is n/sum a for all, proven."""
    size = 2000
    weights = np.linspace(1.0, 3.0, size)

    def text(x, p):
        return Terms(
            {"cost": sum(a / v for a, v in zip(weights, x.w, strict=True))},
            {"budget": sum(a * v for a, v in zip(weights, x.w, strict=True)) / size},
        )

    w = Var("w", "", 1e-3, 1e3, 1.5, size=size, log=True)
    result = solve(Problem("separable", (w,), (), text), budget=Budget(evaluations=100))
    assert result.status == "optimal" and result.gap < 1e-8
    assert result.value == pytest.approx(weights.sum() ** 2 / size, rel=1e-8)


def test_rows_of_a_repeat_are_split_too():
    size = 120
    data = np.linspace(1.0, 3.0, size)
    own = Var("own", "", 1e-3, 1e3, 1.5, log=True)

    def row_text(x, p, row):
        return Terms({"cost": row.a / x.own}, {"share": x.own / x.total})

    problem = Problem(
        "rows",
        (Var("total", "", 1e-3, 1e3, 1.5, log=True),),
        (),
        lambda x, p: Terms({"cost": 0.5 * x.total}),
        (Repeat("row", (own,), {"a": data}, row_text),),
    )
    assert nonlinear.split(form(problem), tape.kinds(problem)).levels.numel() > 0
    result = solve(problem)  # sum a/t + t/2 is least at t = sqrt(2 sum a)
    assert result.status == "optimal"
    assert result.value == pytest.approx(math.sqrt(2.0 * data.sum()), rel=1e-9)


def test_an_impossible_wide_problem_is_proven_so():
    def text(x, p):
        return Terms(
            {"cost": sum(x.w)}, {"most": sum(x.w) / 60.0, "least": tuple(2.0 / v for v in x.w)}
        )

    w = Var("w", "", 1e-1, 1e2, 1.0, size=60, log=True)
    result = solve(Problem("too much", (w,), (), text))
    assert result.status == "infeasible" and "most" in result.proof["conflict"]


def test_the_dense_hessian_of_a_wide_plain_objective_is_not_coloured():
    """min sqrt(1 + |w - a|^2), not proven log-convex: its Hessian is dense."""
    target = np.linspace(1.0, 3.0, 80)

    def text(x, p):
        return Terms(
            {"f": np.sqrt(1.0 + sum((v - a) ** 2 for v, a in zip(x.w, target, strict=True)))}
        )

    problem = Problem("distance", (Var("w", "", 0.0, 9.0, 1.5, size=80),), (), text)
    shape = form(problem)
    y, p, f, g, h = shape.expressions
    assert nonlinear.dense_hessian(y, p, f, ca.vertcat(g, h))
    assert solve(problem).value == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(
    "method", ["ipopt", "gp", "qp", "multistart", "annealing", "nsga2", "scip"]
)
def test_the_budget_counts_what_building_takes(method, monkeypatch):
    """Every tape takes 100 s of a clock of ours; a budget of 10 s is then over at once."""
    late = [0.0]

    def text(x, p):
        late[0] += 100.0
        return Terms({"f": x.a + 1.0 / x.a if method != "qp" else (x.a - 1.0) ** 2})

    real = time.perf_counter
    monkeypatch.setattr(time, "perf_counter", lambda: real() + late[0])
    problem = Problem("late", (Var("a", "", 0.5, 3.0, 2.0, log=True),), (), text)
    assert not run(problem, method, Budget(seconds=10.0))[1].finished
