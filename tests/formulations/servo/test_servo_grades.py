"""Grades: numbers found before, dynamic programming against enumeration and two MILP solvers."""

import math
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from campaigns import few
from servo_tolerances import BASE, E_RSS, E_WC, components

from gearopt.errors import SolveError
from gearopt.formulations.servo.tolerance import problem as allocation
from gearopt.formulations.servo.tolerance.conic import milp
from gearopt.formulations.servo.tolerance.grades import Choice, Graded, problem, whole
from gearopt.formulations.servo.tolerance.stack import ErrorBudget, Stack
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

STEPS = np.sqrt(2.0) ** np.arange(-4, 5)
CASES = [("worst_case", E_WC, 10.035533906), ("rss", E_RSS, 7.328427125)]


def servo(rule, error):
    """Nine grades t0 sqrt(2)^(-4..4) that cost t0/t."""
    parts = tuple(
        Graded(c.name, c.sensitivity, tuple((float(t0 * g), float(1.0 / g)) for g in STEPS))
        for c, t0 in zip(components(), BASE, strict=True)
    )
    return Choice(parts, error, rule)


@pytest.mark.parametrize(("rule", "error", "cost"), CASES)
def test_grades_of_the_servo_drive(rule, error, cost):
    result = solve(problem(servo(rule, error)))
    assert result.value == pytest.approx(cost, abs=6e-10)
    assert result.status == "optimal" and result.gap < 1e-13
    assert result.proof["method"] == "exhausted" and result.proof["pairs_kept"] < 700
    chosen = STEPS[np.array(result.design["grade"]) - 1]
    assert (1.0 / chosen).sum() == pytest.approx(result.value, rel=1e-14)
    t = [result.report[f"tolerance_mm[{k}]"] for k in range(1, 15)]
    assert t == pytest.approx(BASE * chosen, rel=1e-14)
    free = Stack(components(), (ErrorBudget(rule, error),))
    assert solve(allocation(free)).value < result.value  # a relaxation


@pytest.mark.slow
@pytest.mark.parametrize(("rule", "error", "cost"), CASES)
def test_the_milp_proves_the_same(rule, error, cost):
    result = solve(milp(servo(rule, error)))
    assert result.status == "optimal" and result.gap < 1e-9
    assert result.value == pytest.approx(cost, abs=6e-10)
    exact = solve(problem(servo(rule, error)))
    assert result.value == pytest.approx(exact.value, rel=1e-11)


def some(seed, number=float):
    """Up to six components of up to five grades, of small whole numbers: many ties."""
    rng = np.random.default_rng(seed)

    def draw(most):
        return number(int(rng.integers(1, most)))

    parts = []
    for i in range(rng.integers(1, 7)):
        grades = tuple((draw(12) / 10, draw(8)) for _ in range(rng.integers(1, 6)))
        parts.append(Graded(str(i), draw(5) / 3, grades))
    error = number(int(rng.integers(5, 60))) / 10
    return Choice(tuple(parts), error, ("worst_case", "rss")[seed % 2])


def enumerated(choice):
    """Least cost over all picks in rational arithmetic; None where none is allowed."""
    power = 1 if choice.rule == "worst_case" else 2
    costs = []
    for pick in product(*(c.grades for c in choice.components)):
        parts = zip(choice.components, pick, strict=True)
        if sum((c.sensitivity * t) ** power for c, (t, _) in parts) <= choice.error**power:
            costs.append(sum(cost for _, cost in pick))
    return min(costs, default=None)


@pytest.mark.parametrize("seed", few(range(40), 12))
def test_against_enumeration_with_exact_ties(seed):
    choice = some(seed, F)
    assert choice.rational
    least, result = enumerated(choice), solve(problem(choice))
    assert result.proof["arithmetic"] == "rational"
    if least is None:
        assert result.status == "infeasible"
    else:
        assert result.status == "optimal" and result.value == float(least) == result.bound
    double = solve(problem(some(seed)))  # the same in doubles, ties within 1e-12
    assert (double.status, double.value) == (result.status, result.value)


@pytest.mark.parametrize("seed", range(0, 60, 12))
def test_against_two_milp_solvers(seed):
    from scipy.optimize import Bounds, LinearConstraint
    from scipy.optimize import milp as highs

    choice = some(seed)
    weights, costs = (np.concatenate(rows) for rows in (choice.weights, choice.costs))
    own = np.repeat(np.eye(len(choice.costs)), [len(row) for row in choice.costs], axis=1)
    rows = [LinearConstraint(own, 1, 1), LinearConstraint(weights[None], -np.inf, 1.0 + 1e-12)]
    other = highs(costs, constraints=rows, integrality=np.ones(len(costs)), bounds=Bounds(0, 1))
    ours, cone = solve(problem(choice)), solve(milp(choice))
    assert ours.status == cone.status == ("optimal" if other.success else "infeasible")
    if other.success:
        assert [ours.value, cone.value] == pytest.approx([other.fun] * 2, rel=1e-9)


def test_a_tie_that_doubles_miss():
    """1/10 + 2/10 = 3/10, and 1/3 + 1/3 + 1/3 = 1, at the limit itself."""
    for s, limit in (((F(1, 10), F(2, 10)), F(3, 10)), ((F(1, 3),) * 3, F(1))):
        parts = tuple(Graded(str(v), v, ((1, 1), (F(1, 2), 5))) for v in s)
        assert solve(problem(Choice(parts, limit))).value == len(s)
        less = solve(problem(Choice(parts, limit - F(1, 10**40))))
        assert less.value == len(s) + 4


def test_numbers_beyond_64_bits_stay_exact():
    """Denominators of 10^30, where the cheaper pick is over the limit by one part in 10^30."""
    tiny = F(1, 10**30)
    parts = tuple(Graded(name, 1, ((F(1, 2), 1), (F(1, 2) - tiny, 2))) for name in "ab")
    assert whole(Choice(parts, 1).weights)[0][0].dtype == object
    assert solve(problem(Choice(parts, 1))).value == 2
    assert solve(problem(Choice(parts, 1 - tiny))).value == 3
    assert solve(problem(Choice(parts, 1 - 3 * tiny))).status == "infeasible"


def test_finest_grades_that_break_the_budget_are_named():
    parts = (
        Graded("pitch", 1, ((F(1, 100), 1),)),
        Graded("wheel", 1, ((2, 1), (1, 3))),
        Graded("pinion", 2, ((3, 1), (1, 3))),
    )
    result = solve(problem(Choice(parts, F(5, 2))))
    assert result.status == "infeasible"
    assert result.proof["components"] == ["pinion", "wheel"]
    assert result.message.startswith("the finest grades of pinion, wheel alone exceed")
    assert solve(milp(Choice(parts, F(5, 2)))).status == "infeasible"


def test_of_equal_costs_the_lighter():
    parts = (
        Graded("a", 1.0, ((3.0, 1.0), (2.0, 1.0), (1.0, 4.0))),
        Graded("b", 1.0, ((1.0, 1.0),)),
    )
    result = solve(problem(Choice(parts, 10.0)))
    assert result.design["grade"] == [2, 1] and result.limits["worst_case"] == pytest.approx(0.3)


def test_a_run_can_be_stopped():
    posed = problem(servo("worst_case", E_WC))
    for given in ({"watch": lambda event: False}, {"budget": Budget(evaluations=1000)}):
        assert solve(posed, **given).status == "limit"


def test_samplers_find_no_cheaper_grades():
    posed = problem(servo("rss", E_RSS))
    best = solve(posed).value
    found = solve(posed, "annealing", budget=Budget(evaluations=3000), seed=1)
    assert found.status == "feasible" and best <= found.value < 14.0


def test_what_is_refused():
    with pytest.raises(ValueError, match="grades t > 0"):
        Choice((Graded("a", 1.0, ((0.0, 1.0),)),), 1.0)
    with pytest.raises(ValueError, match="worst_case or rss"):
        Choice((Graded("a", 1.0, ((1.0, 1.0),)),), 1.0, "mean_plus_sd")
    with pytest.raises(SolveError):
        solve(problem(servo("rss", E_RSS)), "ipopt")


def test_many_components():
    """40 of ten grades: 1e40 picks."""
    rng = np.random.default_rng(0)
    parts = tuple(
        Graded(str(i), float(rng.uniform(0.1, 1.0)), tuple((t, 1.0 / t) for t in range(1, 11)))
        for i in range(40)
    )
    result = solve(problem(Choice(parts, 100.0)))
    assert result.status == "optimal"
    picks = [c.grades[g - 1] for c, g in zip(parts, result.design["grade"], strict=True)]
    assert result.value == pytest.approx(math.fsum(cost for _, cost in picks), rel=1e-13)
    used = math.fsum(c.sensitivity * t for c, (t, _) in zip(parts, picks, strict=True))
    assert 99.0 < used <= 100.0 * (1.0 + 1e-12)
