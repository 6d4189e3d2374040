"""Own scales of variables and objectives, and optima of zero: proven by every judge."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.errors import CertificateError
from gearopt.formulations import compound
from gearopt.optimise.certificate import Verdict, _doubted, certify, reconcile
from gearopt.optimise.comparing.comparison import excess
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result
from gearopt.optimise.scale import (
    FEASIBLE,
    gap,
    is_known,
    measured,
    objective_scale,
    sizes,
    unit,
    zero_scale,
)
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Terms, Var

INF = np.inf
AIM = np.array([3.0, -2.0])


def plane(minimise, low=-10.0, high=10.0, limits=None, equal=None, size=1.0, factor=1.0):
    """Two variables in a unit of 1/size, and an objective times a factor."""

    def evaluate(x, p):
        a, b = (v / size for v in x.x)
        limited = {} if limits is None else {"limit": limits(a, b)}
        held = {} if equal is None else {"held": equal(a, b)}
        return Terms({"f": factor * minimise(a, b)}, limited, equal=held)

    guess = min(max(1.0, low), high)
    return Problem("plane", (Var("x", "", size * low, size * high, size * guess, 2),), (), evaluate)


def squares(a, b):
    return (a - 3.0) ** 2 + (b + 2.0) ** 2


ZERO = {
    "squares": plane(squares),
    "open": plane(squares, -INF, INF),
    "at the origin": plane(lambda a, b: a**2 + b**2),
    "written out": plane(lambda a, b: a**2 - 6.0 * a + 9.0 + b**2),
    "slope": plane(lambda a, b: a + b, 0.0),
    "difference": plane(lambda a, b: a - b, limits=lambda a, b: 1.0 + b - a),
    "distance": plane(lambda a, b: a - 3.0, limits=lambda a, b: 1.0 + (3.0 - a) / 7.0),
    "valley beside a limit": plane(lambda a, b: (a - b) ** 2, limits=lambda a, b: (a + b) / 3.0),
    "along a line": plane(lambda a, b: (a - b) ** 2, equal=lambda a, b: (a + b) / 4.0),
}


@pytest.mark.parametrize("method", ["qp", "ipopt"])
@pytest.mark.parametrize("name", ZERO)
def test_an_optimum_of_zero_is_proven(name, method):
    result = solve(ZERO[name], method)
    assert result.status == "optimal" and 0.0 <= result.gap <= 1e-6
    assert abs(result.value) <= 1e-11 and -1e-11 <= result.bound <= 1e-12


@pytest.mark.parametrize("size", [1e-6, 1e6])
@pytest.mark.parametrize("factor", [1e-12, 1e12])
def test_an_optimum_of_zero_is_proven_in_any_unit(size, factor):
    for name, method in (("squares", "qp"), ("slope", "ipopt")):
        minimise, low = (squares, -10.0) if name == "squares" else (lambda a, b: a + b, 0.0)
        result = solve(plane(minimise, low, size=size, factor=factor), method)
        assert result.status == "optimal" and abs(result.value) <= 1e-11 * factor
        assert result.gap <= 1e-7


def test_what_is_small_by_nature_is_not_zero():
    """1e-12 beside squares of 9 is judged relative to itself: the bound is 0.5e-12 below it."""
    result = solve(plane(lambda a, b: squares(a, b) + 1e-12), "qp")
    assert result.status == "stationary" and result.gap == pytest.approx(0.52, rel=1e-3)
    assert "scale" not in result.certificate
    off = Outcome(AIM + 1e-5)  # not zero, nor at a minimum
    verdict = certify(plane(squares), off, 1e-6)
    assert verdict.status == "feasible" and verdict.gap > 0.9


def conic(objective, low=-10.0, high=10.0, **kinds):
    x = Var("x", "", low, high, 1.0, 2, **kinds)
    return Conic("conic", (x,), (), lambda x, p: Terms({"f": objective(x.x)}))


def distance(x):
    import cvxpy as cp

    return cp.norm1(x - AIM)


@pytest.mark.parametrize(
    ("objective", "kinds"),
    few(
        [
            (lambda x: 1e-9 * distance(x), {}),
            (lambda x: distance(x - np.array([0.5, 0.0])) - 0.5, {"integer": True}),
            (distance, {}),
            (distance, {"integer": True}),
            (lambda x: x[0] + x[1], {"low": 0.0}),
        ],
        2,
    ),
)
def test_an_optimum_of_zero_is_proven_of_a_conic_problem(objective, kinds):
    result = solve(conic(objective, **kinds))
    assert result.status == "optimal" and result.gap <= 1e-6
    assert abs(result.value) <= 1e-10 and result.bound <= 1e-12
    assert all(abs(v) <= 1e-6 for k, v in result.certificate.items() if k != "scale")


def test_a_claimed_bound_of_zero_is_judged_by_the_scale():
    problem = plane(lambda a, b: 3.0 * a + b, 0.0)

    def judged(x, bound, gap=1e-6):
        claim = Outcome(np.array(x), bound=bound, proof={"method": "own"})
        return certify(problem, claim, gap, exact=True)

    exact = judged([0.0, 0.0], 0.0)
    assert (exact.status, exact.gap) == ("optimal", 0.0) and "scale" not in exact.certificate
    near = judged([1e-12, 0.0], -4e-7)
    assert near.status == "optimal" and near.gap == pytest.approx(1e-7, rel=1e-4)
    assert near.certificate["scale"] == pytest.approx(4.0, rel=1e-6)
    assert judged([0.0, 0.0], -4e-6 * (1.0 + 1e-6)).status == "feasible"
    assert judged([0.0, 0.0], -4e-6 * (1.0 - 1e-6)).status == "optimal"
    assert judged([1e-7, 0.0], 0.0).status == "feasible"  # 3e-7 is more than 1e-8 of 4
    assert judged([0.0, 0.0], 3e-8).status == "optimal"  # no contradiction: 1e-8 of the scale
    with pytest.raises(CertificateError, match="below the claimed bound"):
        judged([0.0, 0.0], 5e-8)


def train(ratio, teeth=(12, 60)):
    return compound.problem(compound.Compound(Fraction(ratio), teeth, compound.SQUARED))


def test_errors_of_whole_teeth_are_small_by_nature():
    """Sandgren's train: 2.7e-12 is the least, 1e-9 is another train; an exact ratio has error 0."""
    problem = train("6.931")
    best = solve(problem)
    assert best.status == "optimal" and best.value == pytest.approx(2.70086e-12, rel=1e-5)
    other = np.array([16.0, 19.0, 43.0, 49.0])
    for a, b, c, d in ((13, 20, 34, 53), (13, 30, 51, 53), (15, 26, 53, 51)):
        other = np.array([a, b, c, d], float)
        value = problem.batch(other[None]).F[0, 0]
        assert 1e-11 < value < 1e-8
        for bound in (best.value, 0.0):
            claim = Outcome(other, bound=bound, proof={"method": "exhausted"})
            assert certify(problem, claim, 1e-6, exact=True).status == "feasible"
    assert certify(problem, Outcome(other, bound=0.0), 1e-6, exact=True).gap == 1.0
    assert solve(train("6")).status == "optimal" and solve(train("6")).value == 0.0


def test_where_nothing_moves_a_gap_may_be_unknown():
    problem = Problem(
        "count", (Var("n", "", 0, 9, 3, integer=True),), (), lambda x, p: Terms({"f": x.n - 3.0})
    )
    claim = Outcome(np.array([3.0]), bound=-1.0, proof={})
    verdict = certify(problem, claim, 1e-6, exact=True)
    assert (verdict.status, verdict.gap, verdict.bound) == ("feasible", None, -1.0)


def test_results_are_reconciled_by_the_scale():
    value = {"name": "f", "value": 1e-12}
    found = Result("a", "feasible", "exact", value, certificate={"feasibility": 0.0})
    ideal = Result("b", "optimal", "qp", value, bound=-2e-9, gap=0.0, certificate={"scale": 4.0})
    known = reconcile(found, ideal, 1e-6)
    assert known.status == "optimal" and known.gap == pytest.approx(5.0025e-10, rel=1e-4)
    assert known.certificate == {"feasibility": 0.0, "scale": 4.0}
    plain = reconcile(found, replace(ideal, certificate={}), 1e-6)
    assert plain.status == "feasible" and plain.gap > 1e3 and "scale" not in plain.certificate
    below = replace(found, objective={"name": "f", "value": -1.0})
    assert reconcile(below, replace(ideal, bound=-1.0 + 5e-9), 1e-6).status == "optimal"
    with pytest.raises(CertificateError, match="below the relaxation"):
        reconcile(below, replace(ideal, bound=-1.0 + 5e-8), 1e-6)


def test_methods_are_compared_by_the_scale():
    assert excess(3e-9, -1e-9, 4.0) == pytest.approx(1e-9)
    assert excess(3e-9, -1e-9) == pytest.approx(4.0)
    assert excess(0.5, 0.0) == 0.5
    found = gearopt.compare(
        plane(lambda a, b: (a - 3.0) ** 2 + (b + 2.0) ** 2, -5.0, 5.0),
        methods=("qp", "annealing"),
        seeds=1,
        evaluations=320,
        seconds=0.02,
    )
    (group,) = found.groups
    assert group.proven and group.scale > 0.0 and group.reference > -1e-10
    runs = {row.method: row.equal_evaluations.runs[0] for row in group.rows}
    assert runs["qp"].gap <= 1e-6 and 0.0 <= runs["annealing"].gap < INF
    assert runs["annealing"].gap == pytest.approx(
        (runs["annealing"].objective - group.reference) / group.scale, rel=1e-9
    )


def test_the_scale_of_a_variable():
    def size(lower, upper, guess, at, **kinds):
        return sizes(
            Problem("one", (Var("x", "", lower, upper, guess, **kinds),), (), lambda x, p: None),
            np.array([at]),
        )[0]

    assert size(-10.0, 10.0, 1.0, 4.0) == 4.0 and size(-10.0, 10.0, 1.0, -4.0) == 4.0
    assert size(-10.0, 10.0, -5.0, 4.0) == 5.0
    assert size(-10.0, 10.0, 0.0, 0.0) == 0.02  # a thousandth of the box
    assert size(100.0, 100.5, 100.2, 100.1) == 0.5
    assert size(-INF, INF, 0.0, 0.0) == 1.0 and size(0.0, INF, 0.0, 0.0) == 1.0
    assert size(-INF, INF, 3.0, 0.0) == 3.0 and size(-INF, INF, 0.3, 0.2) == 0.3
    assert size(7.0, 7.0, 7.0, 7.0) == 7.0 and size(0.0, 0.0, 0.0, 0.0) == 1.0
    assert size(1e-6, 10.0, 1.0, 1e-3, log=True) == 1e-3
    assert size(1e-6, 10.0, 1.0, -1e-3, log=True) == 1e-3


def test_the_scale_of_an_objective():
    """3 |a| + |b| for slopes of 3 and 1; inside the box; not of discrete and fixed variables."""
    problem = plane(lambda a, b: 3.0 * a - b)
    assert objective_scale(problem, np.array([2.0, -4.0])) == pytest.approx(10.0, rel=1e-6)
    assert objective_scale(problem, np.array([10.0, -10.0])) == pytest.approx(40.0, rel=1e-6)
    assert objective_scale(plane(squares), AIM, 0.1) == pytest.approx(10.0 * (0.3**2 + 0.2**2))
    edge = plane(lambda a, b: np.sqrt(a) + np.sqrt(10.0 - b), 0.0)
    assert math.isfinite(objective_scale(edge, np.array([0.0, 10.0])))
    root = plane(lambda a, b: np.sqrt(1.0 - b) + a, -10.0)
    found = objective_scale(root, np.array([1.0, 1.0]))  # NaN beyond b = 1 counts as nothing
    assert found == pytest.approx(1e4, rel=1e-3)
    pole = plane(lambda a, b: 1.0 / (a - 1.0) + b)
    assert objective_scale(pole, np.array([1.0, 1.0])) == 0.0  # no number there, nor a warning
    steep = plane(lambda a, b: a + 1e3 * (np.maximum(a, 10.0) - np.minimum(b, -10.0)))
    assert objective_scale(steep, np.array([10.0, -10.0])) == pytest.approx(10.0, rel=1e-4)
    mixed = Problem(
        "mixed",
        (Var("n", "", 0, 9, 3, integer=True), Var("x", "", 0, 9, 2.0), Var("c", "", 5, 5, 5)),
        (),
        lambda x, p: Terms({"f": 100.0 * x.n + x.x + 100.0 * x.c}),
    )
    assert objective_scale(mixed, np.array([3.0, 2.0, 5.0])) == pytest.approx(2.0, rel=1e-4)
    whole = conic(distance, integer=True)
    assert objective_scale(whole, np.array([4.0, 1.0])) == pytest.approx(5.0, rel=1e-6)


def test_many_variables_are_moved_some_at_a_time(monkeypatch):
    many = Problem("many", (Var("x", "", -9, 9, 1.0, 40),), (), lambda x, p: Terms({"f": sum(x.x)}))
    whole = objective_scale(many, np.ones(40))
    counts = []
    batch = Problem.batch
    monkeypatch.setattr(Problem, "batch", lambda self, x: counts.append(len(x)) or batch(self, x))
    monkeypatch.setattr("gearopt.optimise.scale.ENTRIES", 800)
    assert objective_scale(many, np.ones(40)) == whole == pytest.approx(40.0, rel=1e-6)
    assert counts == [1, 20, 20, 20, 20]
    monkeypatch.setattr("gearopt.optimise.scale.ENTRIES", 20)
    assert objective_scale(many, np.ones(40)) == whole


def test_a_gap_is_relative_to_the_value_or_to_the_scale():
    assert gap(2.0, 1.0) == 0.5 and gap(-2.0, -3.0) == 0.5 and gap(-2.0, -1.0) == -0.5
    assert gap(0.0, 0.0) == 0.0 and gap(0.0, -1.0) == INF and gap(0.0, 1.0) == -INF
    assert gap(FEASIBLE, 0.0, 1.0) == FEASIBLE and gap(2.0 * FEASIBLE, 0.0, 1.0) == 1.0
    assert is_known(1.0, 0.0) and not is_known(0.0, 0.0) and not is_known(-FEASIBLE, 1.0)
    assert unit(-2.0, 5.0) == 2.0 and unit(1e-9, 5.0) == 5.0


def test_a_zero_is_measured_by_the_way_from_the_guess():
    problem = plane(lambda a, b: a + b, 0.0)  # 2 at the guess
    at = np.array([1e-12, 0.0])
    assert measured(problem, at, 1e-12, -1e-9, 1e-6) == (
        pytest.approx(5e-10, rel=1e-2),
        {"scale": pytest.approx(2.0)},
    )
    valley = plane(lambda a, b: (a - b) ** 2)  # 0 at the guess
    scale = zero_scale(valley, np.array([2.0, 2.0]))
    assert scale == pytest.approx(2 * 0.01 * 2.0**2)
    assert zero_scale(valley, np.array([2.0, 2.001])) == 0.0
    assert zero_scale(plane(lambda a, b: a - b), np.array([2.0, 2.0])) == pytest.approx(4.0)


def of_two(minimise, guess, low=-10.0, high=10.0, log=False):
    both = tuple(Var(v, "", low, high, guess, log=log) for v in "ab")
    return Problem("two", both, (), lambda x, p: Terms({"f": minimise(x.a, x.b)}))


def test_what_a_zero_is_measured_by():
    sums, difference = (lambda a, b: a + b), (lambda a, b: a - b)
    assert zero_scale(of_two(sums, 1.0), np.array([-1e-9, 0.0])) == pytest.approx(
        2.0 + 1e-9, rel=1e-13
    )
    less = of_two(lambda a, b: a + b - 1.0, 1.0)  # the way, however short beside the magnitudes
    assert zero_scale(less, np.array([0.0, 1.0])) == pytest.approx(1.0)
    for guess, x, magnitudes in ((-1.0, -3.0, 6.0), (-2.0, -1.0, 4.0), (0.0, 0.0, 0.04)):
        assert zero_scale(of_two(difference, guess), np.full(2, x)) == pytest.approx(magnitudes)
    logs = of_two(lambda a, b: (a - 1.0) * (a - 5.0), 5.0, 0.1, log=True)
    assert zero_scale(logs, np.array([1.0, 5.0])) == pytest.approx(4.01)
    level = of_two(difference, 1.0)  # the guess is as good
    for beside, scale in ((1e-10, 2.0), (1e-9, 0.0), (-1e-9, 0.0), (1.5e-8, 0.0)):
        assert zero_scale(level, np.array([1.0 + beside, 1.0])) == pytest.approx(scale, rel=1e-6)


def test_above_a_positive_bound_no_value_is_zero():
    assert gap(1e-12, 1e-13, 1.0) == pytest.approx(0.9) and gap(1e-12, 0.0, 1.0) == 1e-12
    assert gap(1e-12, 2e-12, 1.0) == pytest.approx(-1e-12)
    problem, at = plane(lambda a, b: a + b, 0.0), np.array([1e-12, 0.0])
    assert measured(problem, at, 1e-12, 1e-13, 1e-6) == (pytest.approx(0.9), {})
    assert measured(problem, at, 1e-12, 0.0, 1e-6)[1] == {"scale": pytest.approx(2.0)}


U = 1e11
WIDE = {  # sums of terms of different size in wide boxes: width, guess, optimum, text
    "s, t": (1e12, 2e11, 1e-3, lambda a, b: ((a - b) / 1e3) ** 2 + (b / U - 1.0) ** 2 + 1e-3),
    "1e7": (1e7, 9e6, 1e-3, lambda a, b: (a - b) ** 2 + (b / 1e7 - 0.5) ** 2 + 1e-3),
    "1e8": (1e8, 9e7, 1e-3, lambda a, b: (a - b) ** 2 + (b / 1e8 - 0.5) ** 2 + 1e-3),
    "1e11": (1e11, 1e3, 1.0, lambda a, b: (a - 3.0) ** 2 + (b - 4.0) ** 2 / 3.0 + 1.0),
    "1e15": (1e15, 1e3, 1.0, lambda a, b: (a - 3.0) ** 2 + (b - 4.0) ** 2 / 3.0 + 1.0),
    "1e9": (1e9, 1e3, 1.0, lambda a, b: (a - 3e8) ** 2 + (b - 4e8) ** 2 / 3.0 + 1.0),
}


@pytest.mark.parametrize("name", WIDE)
@pytest.mark.parametrize("method", ["ipopt", "qp", "annealing"])
def test_nothing_is_optimal_above_its_optimum_in_a_wide_box(name, method):
    width, guess, least, text = WIDE[name]
    evaluate = lambda x, p: Terms({"f": text(x.a, x.b)})  # noqa: E731
    both = tuple(Var(v, "", 0.0, width, guess) for v in "ab")
    for budget in (Budget(evaluations=8), Budget(evaluations=2000)):
        result = solve(Problem("wide", both, (), evaluate), method, budget)
        assert result.bound is None or result.bound <= least * (1.0 + 1e-9)
        near = result.value is not None and result.value <= least * (1.0 + 1e-6)
        assert near or result.status in ("feasible", "limit")


def test_a_gap_within_the_tolerance_needs_no_scale():
    problem, at = plane(lambda a, b: a + b, 0.0), np.array([1e-12, 0.0])
    assert measured(problem, at, 1.0, 1.0 - 1e-7, 1e-6) == (pytest.approx(1e-7), {})
    assert measured(problem, at, 1.0, 0.5, 1e-6) == (0.5, {})


@pytest.mark.parametrize(
    ("at", "below", "status"),
    [
        (0.5, 0.009, "stationary"),  # of a value of 1
        (0.5, 0.02, "feasible"),
        (-0.5, 0.009, "stationary"),
        (0.0, 1.5e-6, "stationary"),  # of a way of 2 from the guess
        (0.0, 3e-6, "feasible"),
    ],
)
def test_a_bound_far_below_doubts_a_minimum(at, below, status):
    problem, value = plane(lambda a, b: a + b), 2.0 * at
    before = Verdict("stationary", value, bound=value - below, message="Ended.")
    found = _doubted(problem, np.full(2, at), before)
    assert found.status == status
    doubt = f"not proven to be a minimum: the bound is lower by {below:.3g}. Ended."
    assert found.message == ("Ended." if status == "stationary" else doubt)
