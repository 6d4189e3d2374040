"""Quadratic programs: degrees read from the tape, curvature, bounds with and without a box."""

from fractions import Fraction

import numpy as np
import pytest
from campaigns import few

from gearopt.errors import SolveError
from gearopt.optimise.certificate import certify
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import (
    AFFINE,
    CONSTANT,
    OTHER,
    QUADRATIC,
    Curvature,
    box,
    curvature,
    degrees,
    least,
)
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import solve
from gearopt.optimise.solvers import qp
from gearopt.optimise.terms import Param, Repeat, Terms, Var

INF = np.inf


def plane(evaluate, low=-10.0, high=10.0, size=2, repeats=()):
    """Two variables x and a parameter a = 2."""
    x = Var("x", "", low, high, min(max(1.0, low), high), size=size)
    return Problem("plane", (x,), (Param("a", "", 2.0),), evaluate, repeats)


def sharing(pairs):
    """Loads F [N] on tooth pairs of stiffness k [N/um] and gap e [um] under W [N]."""

    def evaluate(x, p):
        energy = sum(f**2 / (2.0 * k) + e * f for f, k, e in zip(x.F, p.k, p.e, strict=True))
        return Terms({"energy": energy}, equal={"load": sum(x.F) / p.W})

    loads = Var("F", "N", 0.0, INF, 100.0, size=pairs)
    one = (1.0,) * pairs
    parameters = (
        Param("k", "N/um", one, pairs),
        Param("e", "um", one, pairs),
        Param("W", "N", 1e3),
    )
    return Problem("load sharing", (loads,), parameters, evaluate)


def positions(pairs, count, seed=0):
    """k, e, W of random positions."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield rng.uniform(5, 30, pairs), rng.uniform(0, 30, pairs), rng.uniform(500, 5000)


def shared(k, e, load):
    """F_i = k_i max(0, delta - e_i) with sum W: the pairs of least gap carry, one after another."""
    order = np.argsort(e)
    stiffness, moment = np.cumsum(k[order]), np.cumsum(k[order] * e[order])
    closed = (load + moment) / stiffness
    delta = closed[np.flatnonzero(closed > e[order])[-1]]
    return k * np.maximum(delta - e, 0.0)


def exact_energy(k, e, load):
    """The least energy of a position in rational arithmetic."""
    k, e, load = [Fraction(v) for v in k], [Fraction(v) for v in e], Fraction(load)
    order = sorted(range(len(k)), key=lambda i: e[i])
    for count in range(len(k), 0, -1):
        carry = order[:count]
        delta = (load + sum(k[i] * e[i] for i in carry)) / sum(k[i] for i in carry)
        if delta > e[carry[-1]]:
            loads = [(i, k[i] * (delta - e[i])) for i in carry]
            return sum(f * f / (2 * k[i]) + e[i] * f for i, f in loads)
    raise AssertionError("no pair carries")


@pytest.mark.parametrize("pairs", few(range(2, 7), [3]))
def test_load_sharing_is_the_closed_form(pairs):
    """Open bounds above: the proof rests on the curvature alone."""
    problem = sharing(pairs)
    for k, e, load in positions(pairs, 30):
        result = solve(problem.at(k=tuple(k), e=tuple(e), W=load), "qp", gap=1e-9)
        assert result.status == "optimal" and result.gap <= 1e-12
        assert np.abs(result.design["F_N"] - shared(k, e, load)).max() <= 1e-12 * load
        assert Fraction(result.bound) <= exact_energy(k, e, load)
    assert sum(key[0] == "qp" for key in problem.memo if isinstance(key, tuple)) == 1


def test_ipopt_proves_it_too_and_a_wrong_point_is_not_optimal():
    k, e, load = np.array([10.0, 20.0, 5.0]), np.array([0.0, 5.0, 500.0]), 1000.0
    problem = sharing(3).at(k=tuple(k), e=tuple(e), W=load)
    result = solve(problem, "ipopt")
    assert result.status == "optimal"
    assert result.proof["sentence"].startswith("Proof: a convex quadratic program; ")
    right = shared(k, e, load)
    for shift in (1e-3, 0.1):
        verdict = certify(problem, Outcome(right + shift * load * np.array([1, -1, 0])), 1e-6)
        assert verdict.status == "feasible" or (verdict.status == "optimal" and shift < 0.01)
        assert Fraction(verdict.bound) <= exact_energy(k, e, load)
        assert verdict.objective > verdict.bound


def text(kind):
    return {
        "constant": lambda x, p: p.a**2 / 3.0,
        "affine": lambda x, p: 1.0 - (2.0 * x.x[0] - p.a * x.x[1]) / p.a,
        "product": lambda x, p: x.x[0] * (x.x[1] - 1.0),
        "square": lambda x, p: (x.x[0] + 1.0) ** p.a,
        "cubic": lambda x, p: x.x[0] ** 2 * x.x[1],
        "quotient": lambda x, p: 1.0 / x.x[0],
        "kink": lambda x, p: abs(x.x[0]),
        "step": lambda x, p: np.sign(x.x[0]),
        "stairs": lambda x, p: np.floor(x.x[0]),
        "most": lambda x, p: np.maximum(x.x[0], x.x[1]),
        "root": lambda x, p: (x.x[0] + 11.0) ** (p.a / 4.0),
    }[kind]


@pytest.mark.parametrize(
    ("kind", "degree"),
    [("constant", CONSTANT), ("affine", AFFINE), ("product", QUADRATIC), ("square", QUADRATIC)]
    + [(k, OTHER) for k in ("cubic", "quotient", "kink", "step", "stairs", "most", "root")],
)
def test_degrees_are_read_from_the_tape(kind, degree):
    """A kink has constant derivatives almost everywhere: no sample tells it from an affine row."""
    problem = plane(lambda x, p: Terms({"f": x.x[0]}, {"row": text(kind)(x, p)}))
    assert degrees(problem).inequalities == (degree,)
    if degree > AFFINE:
        with pytest.raises(SolveError, match="row is not affine"):
            solve(problem, "qp")
    objective = plane(lambda x, p: Terms({"f": text(kind)(x, p) + x.x[1]}))
    assert degrees(objective).objective == max(degree, AFFINE)
    if degree == OTHER:
        with pytest.raises(SolveError, match="the objective f is not quadratic"):
            solve(objective, "qp")


def test_a_parameter_decides_the_degree():
    problem = plane(lambda x, p: Terms({"f": x.x[0] ** p.a + x.x[1] ** 2}))
    assert degrees(problem).objective == QUADRATIC
    assert degrees(problem.at(a=3.0)).objective == OTHER
    assert degrees(problem).objective == QUADRATIC


def test_what_is_not_convex_is_refused_with_its_curvature():
    def evaluate(x, p):
        return Terms({"energy": x.x[0] ** 2 + p.a * x.x[0] * x.x[1] + x.x[1] ** 2})

    assert solve(plane(evaluate), "qp").value == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(SolveError, match="energy has curvature -1"):
        solve(plane(evaluate).at(a=3.0), "qp")
    assert solve(plane(evaluate).at(a=3.0), "ipopt").status != "optimal"  # a saddle


def test_integers_and_several_objectives_are_refused():
    whole = Problem("w", (Var("n", "", 0, 9, 1, integer=True),), (), lambda x, p: Terms({"f": x.n}))
    with pytest.raises(SolveError, match="n is discrete"):
        solve(whole, "qp")
    with pytest.raises(SolveError, match="2 objectives"):
        qp.run(plane(lambda x, p: Terms({"f": x.x[0], "g": x.x[1]})), Budget(), 0, None)


@pytest.mark.parametrize("method", ["qp", "ipopt"])
def test_a_linear_program_is_proven_over_its_box(method):
    def evaluate(x, p):
        return Terms({"f": -x.x[0] - 2.0 * x.x[1]}, {"g": x.x[0] + x.x[1]})

    boxed, open_ended = (solve(plane(evaluate, 0.0, high), method) for high in (10.0, INF))
    assert boxed.status == "optimal" and boxed.bound <= -2.0
    assert open_ended.bound is None or open_ended.bound <= -2.0  # rounding decides the slope's sign
    assert boxed.value == pytest.approx(-2.0, rel=1e-9)


def test_a_valley_is_proven_over_a_box_only():
    """(x1 + x2 - 3)^2 + 1 has no least point but a line of them."""

    def evaluate(x, p):
        return Terms({"f": (x.x[0] + x.x[1] - 3.0) ** 2 + 1.0}, {"g": x.x[0] / 5.0})

    assert solve(plane(evaluate), "qp").status == "optimal"
    assert solve(plane(evaluate, -INF, INF), "qp").bound is None


def test_rows_that_exclude_each_other_are_proven_and_named():
    def evaluate(x, p):
        total = x.x[0] + x.x[1]
        limits = {"most": total, "least": 3.0 - total, "idle": x.x[0] / 100.0}
        return Terms({"f": x.x[0] ** 2 + x.x[1] ** 2}, limits)

    result = solve(plane(evaluate), "qp")
    assert result.status == "infeasible"
    assert sorted(result.proof["conflict"]) == ["least", "most"]
    assert 0.5 - 1e-9 < result.proof["least_violation"] <= 0.5
    told = qp.run(plane(evaluate), Budget(), 0, None).message
    assert "smallest relative violation of the limits reached is 50 %" in told
    assert solve(plane(evaluate, -INF, INF), "qp").status == "failed"


def test_equalities_that_repeat_others_are_left_out():
    def evaluate(x, p):
        total = x.x[0] + x.x[1]
        rows = {"sum": total, "again": (2.0 * total + p.a) / 4.0, "first": x.x[0] / 0.3}
        return Terms({"f": x.x[0] ** 2 + 3.0 * x.x[1] ** 2}, equal=rows)

    result = solve(plane(evaluate), "qp")
    assert result.status == "optimal" and result.evaluations == 3
    assert result.design["x"] == pytest.approx([0.3, 0.7], abs=1e-12)
    contradicted = solve(plane(evaluate).at(a=2.5), "qp")
    assert contradicted.status == "infeasible"
    assert {"sum", "again"} <= set(contradicted.proof["conflict"])


def test_unbounded_below_is_not_solved():
    result = solve(plane(lambda x, p: Terms({"f": x.x[0] + x.x[1] ** 2}), -INF, INF), "qp")
    assert result.status == "failed" and result.value is None


def test_a_repeat_is_one_program():
    def evaluate(x, p, row):
        energy = x.F[0] ** 2 / 20.0 + x.F[1] ** 2 / 40.0 + 5.0 * x.F[1]
        return Terms({"f": energy}, equal={"load": (x.F[0] + x.F[1]) / row.W})

    loads = np.array([20.0, 300.0, 1000.0])
    pose = Repeat("pose", (Var("F", "N", 0.0, INF, 1.0, size=2),), {"W": loads}, evaluate)
    result = solve(
        plane(lambda x, p: Terms({"f": (x.x - 1.0) ** 2}), size=1, repeats=(pose,)), "qp"
    )
    assert result.status == "optimal" and result.design["x"] == pytest.approx(1.0, abs=1e-12)
    for k, load in enumerate(loads, 1):
        expected = shared(np.array([10.0, 20.0]), np.array([0.0, 5.0]), load)
        assert result.design[f"pose[{k}].F_N"] == pytest.approx(expected, abs=1e-11 * load)


def test_what_daqp_leaves_open_is_given_to_qrqp(monkeypatch):
    monkeypatch.setitem(qp.SOLVERS, "daqp", {"daqp": {"iter_limit": 1}})
    k, e, load = next(positions(4, 1))
    problem = sharing(4).at(k=tuple(k), e=tuple(e), W=load)
    result = solve(problem, "qp")
    assert result.status == "optimal" and result.evaluations == 2
    assert np.abs(result.design["F_N"] - shared(k, e, load)).max() <= 1e-12 * load


def test_watch_and_budget():
    problem = sharing(2)
    assert solve(problem, "qp", watch=lambda event: False).status == "limit"
    assert solve(problem, "qp", Budget(seconds=0.0)).status == "limit"
    seen = []
    assert (
        solve(problem, "qp", watch=lambda event: seen.append(event.best) or True).value == seen[-1]
    )


def test_curvature_is_that_of_the_scaled_matrix():
    """Units of 1e6 and 1e-6 side by side do not hide a negative curvature, nor make one."""
    units = np.diag([1e6, 1.0, 1e-6])
    good = np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 2.0]])
    found = curvature(units @ good @ units)
    assert found.convex and 0.5 - 1e-12 < found.floor <= 0.5
    bad = good + np.array([[0, 1.1, 0], [1.1, 0, 0], [0, 0, 0]])
    assert not curvature(units @ bad @ units).convex
    assert curvature(np.ones((2, 2))).convex and curvature(np.ones((2, 2))).floor < 0.0
    assert not curvature(np.array([[1.0, 1.0], [1.0, 0.0]])).convex
    assert not curvature(np.array([[np.nan]])).convex
    empty = curvature(np.diag([4.0, 0.0]))
    assert empty.convex and list(empty.diagonal) == [4.0, 0.0]


def test_the_least_of_a_quadratic_is_never_overestimated():
    """Against random points of the box, bounded on no, one or both sides."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        n = int(rng.integers(1, 5))
        root = rng.normal(size=(n, n))
        hessian, gradient = root @ root.T, rng.normal(size=n) * 10.0 ** rng.uniform(-3, 1)
        low, high = (
            np.where(rng.random(n) < 0.3, s * INF, s * rng.uniform(0, 3, n)) for s in (-1, 1)
        )
        y = np.zeros(n)
        bound = least(gradient, np.zeros(n), y, low, high, curvature(hessian))
        points = rng.normal(size=(2000, n)) * 10.0 ** rng.uniform(-2, 1, (2000, 1))
        newton = -np.linalg.solve(hessian + 1e-12 * np.eye(n), gradient)
        points = np.clip(np.vstack([points, newton, y]), low, high)
        values = points @ gradient + 0.5 * np.einsum("ni,ij,nj->n", points, hessian, points)
        assert bound <= values.min() + 1e-9 * abs(values.min())
        assert np.isfinite(bound)  # a definite Hessian needs no bounds


def test_doubt_of_a_slope_counts_to_infinity():
    zero, one = np.zeros(1), np.ones(1)
    assert box(zero, zero, zero, -one * INF, one * INF)[0] == 0.0
    assert box(one, zero, zero, -one, one * INF)[0] == -1.0
    assert box(one, 2.0 * one, zero, -one, one * INF)[0] == -INF
    flat = Curvature(zero, 1.0, 1e-14)
    assert least(zero, 1e-16 * one, zero, -one * INF, one * INF, flat) == -INF
