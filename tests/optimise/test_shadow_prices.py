"""`Result.multipliers`: closed forms by hand, and central differences of problems solved again."""

import re
from pathlib import Path

import conic_cases
import cvxpy as cp
import numpy as np
import pytest

from gearopt import Budget, Conic, Param, Problem, Repeat, Result, Terms, Var, evaluate, solve
from gearopt.optimise.terms import flat

STEP = 1e-4


def shifted(problem, name, to):
    """The problem whose row has the right-hand side `to`: row/to <= 1 says the same."""

    def text(x, p):
        found = problem.evaluate(x, p)
        rows = [dict(flat(block)) for block in (found.limits, found.equal)]
        (block,) = (rows_ for rows_ in rows if name in rows_)
        block[name] = block[name] / to if isinstance(problem, Problem) else block[name] + 1.0 - to
        return Terms(found.minimise, rows[0], found.defines, rows[1], found.report)

    return type(problem)(problem.name, problem.variables, problem.parameters, text)


def slope(problem, name):
    """Central difference of the minimum."""
    ends = [solve(shifted(problem, name, 1.0 + side * STEP)).value for side in (-1, 1)]
    return (ends[1] - ends[0]) / (2.0 * STEP)


def projection(a=1.0):
    """The point of x + y >= 2 nearest to the origin, with x - y = a - 1: by hand.

    x + y = 2 and x - y = d give (4 + d^2)/2. Where 1 + r stands for 1: x + y >= 2 - r, d + r.
    """
    x, y = (Var(n, "", -5.0, 5.0, 1.0) for n in "xy")

    def text(x, p):
        limits = {"sum": 3.0 - x.x - x.y, "far": (x.x + 9.0) / 100.0}
        return Terms({"f": x.x**2 + x.y**2}, limits, equal={"apart": 2.0 - a + x.x - x.y})

    return Problem("projection", (x, y), (), text)


@pytest.mark.parametrize("method", [None, "qp", "ipopt"])
def test_those_of_a_quadratic_program_by_hand(method):
    """f = ((2 - r)^2 + d^2)/2 with d = a - 1: df/dr = -2, df/dd = d."""
    found = solve(projection(1.5), method=method)
    assert found.status == "optimal" and found.value == pytest.approx(2.125, rel=1e-9)
    assert found.multipliers == pytest.approx({"sum": -2.0, "far": 0.0, "apart": 0.5}, abs=1e-7)


def test_those_of_a_geometric_program_by_hand():
    """The sum of two sides of a rectangle of area 4/(1 + r) is 4 (1 + r)^-1/2: -2."""
    x, y = (Var(n, "mm", 0.1, 90.0, 3.0, log=True) for n in "xy")
    corner = Problem(
        "corner", (x, y), (), lambda x, p: Terms({"f": x.x + x.y}, {"area": 4.0 / (x.x * x.y)})
    )
    found = solve(corner)
    assert found.status == "optimal"
    assert found.multipliers == pytest.approx({"area": -2.0}, rel=1e-6)
    assert slope(corner, "area") == pytest.approx(-2.0, rel=1e-5)


def test_rows_of_a_repeat_have_theirs():
    """The largest of three needs decides: w = 3/(1 + r)."""
    w = Var("w", "mm", 0.1, 90.0, 9.0, log=True)
    data = {"need": np.array([1.0, 3.0, 2.0])}
    each = Repeat("load", (), data, lambda x, p, row: Terms({}, {"use": row.need / x.w}))
    found = solve(Problem("shelf", (w,), (), lambda x, p: Terms({"w": x.w}), (each,)))
    expected = {"load.use[1]": 0.0, "load.use[2]": -3.0, "load.use[3]": 0.0}
    assert found.multipliers == pytest.approx(expected, abs=1e-5)


def reducer():
    """The speed reducer of docs/own_problem.md, whose form is not convex."""
    page = (Path(__file__).parents[2] / "docs" / "own_problem.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", page, re.S)[1].split("result = ")[0]
    scope = {}
    exec(code, scope)
    return scope["reducer"]


@pytest.mark.slow
def test_those_of_a_local_minimum_are_differences_of_solved_problems():
    problem = reducer()
    found = solve(problem)
    assert found.status == "optimal" and set(found.multipliers) == set(found.limits)
    binding = {n for n, v in found.multipliers.items() if v}
    assert binding == {"stress_1", "stress_2", "slenderness[1]", "shaft_length[2]"}
    for name in sorted(binding)[:2]:
        assert found.limits[name] == pytest.approx(1.0, abs=1e-6)
        assert found.multipliers[name] == pytest.approx(slope(problem, name), rel=1e-4), name


def budget():
    """Costs a/t of three tolerances in a sum and a norm; one is given."""
    t = Var("t", "mm", 0.0, np.inf, 0.02, size=3)

    def text(x, p):
        limits = {"sum": np.array([3.0, 2.0, 1.0]) @ x.t * 10.0, "rss": cp.norm(x.t) * 50.0}
        cost = cp.sum(cp.multiply(p.a, cp.inv_pos(x.t)))
        return Terms({"cost": cost}, limits, equal={"given": x.t[0] * 100.0})

    return Conic("budget", (t,), (Param("a", "mm", (1.0, 2.0, 3.0), 3),), text)


@pytest.mark.parametrize(
    "problem",
    [conic_cases.disc(), pytest.param(budget(), marks=pytest.mark.slow)],
    ids=lambda p: p.name,
)
def test_those_of_a_conic_problem_are_differences_of_solved_problems(problem):
    found = solve(problem)
    assert found.status == "optimal" and any(found.multipliers.values())
    for name, value in found.multipliers.items():
        assert value == pytest.approx(slope(problem, name), rel=1e-5, abs=1e-6), name


def test_of_what_is_no_proven_minimum_there_are_none():
    whole = Var("x", "", 1, 9, 3, integer=True)
    count = Problem("count", (whole,), (), lambda x, p: Terms({"f": x.x}, {"least": 2.5 / x.x}))
    assert solve(count, method="annealing", budget=Budget(evaluations=200)).multipliers == {}
    assert solve(conic_cases.catalogue()[0]).multipliers == {}
    assert evaluate(projection(), [1.0, 1.0]).multipliers == {}


def test_they_are_kept_in_json():
    found = solve(projection())
    assert Result.from_json(found.to_json()).multipliers == found.multipliers
    with pytest.raises(ValueError, match="value of the wrong type in multipliers"):
        Result.from_dict(found.to_dict() | {"multipliers": [1.0]})
