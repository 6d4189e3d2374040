"""The dual bound and its rounding, and proofs of emptiness, term by term against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.optimise.certificate import certify
from gearopt.optimise.dual import ROUNDING, bound, farkas
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import curvature, natural
from gearopt.optimise.result import Outcome
from gearopt.optimise.solve import solve
from gearopt.optimise.stationarity import evaluated
from gearopt.optimise.terms import Terms, Var

INF = np.inf


def posynomial(low=1e-3, high=1e3):
    """Logarithms a, b of x, y: F = log((x + 3)/50), G = (a - b - log 2, -b), H = a + b - log 5."""

    def evaluate(x, p):
        limits = {"ratio": x.x / x.y / 2.0, "least": 1.0 / x.y}
        return Terms({"f": (x.x + 3.0) / 50.0}, limits, equal={"product": x.x * x.y / 5.0})

    pair = tuple(Var(n, "", low, high, 1.0, log=True) for n in "xy")
    return Problem("posynomial", pair, (), evaluate)


def program(low=-10.0, high=10.0):
    """F = 2 (a - 3)^2 + b^2 - a b + 7, G = (a - 2 b + 3)/4 - 1, H = (a + b)/8 - 1."""

    def evaluate(x, p):
        minimise = 2.0 * (x.a - 3.0) ** 2 + x.b**2 - x.a * x.b + 7.0
        limits = {"limit": (x.a - 2.0 * x.b + 3.0) / 4.0}
        return Terms({"f": minimise}, limits, equal={"sum": (x.a + x.b) / 8.0})

    return Problem("program", tuple(Var(n, "", low, high, 1.0) for n in "ab"), (), evaluate)


def at(problem, shape, x, lam_g, lam_h):
    low, high, _ = (shape.to_y(b) for b in problem.bounds())
    y = shape.to_y(np.array(x, float))
    return evaluated(problem, shape, y, low, high, np.array(lam_g), np.array(lam_h))


def linear_least(slopes, y, low, high):
    """Least of s (z - y) over the box, of all variables together."""
    return sum(min(s * (low - v), s * (high - v)) for s, v in zip(slopes, y, strict=True))


@pytest.mark.parametrize("seed", range(4))
def test_the_bound_of_a_log_convex_form(seed):
    """L = F + l G + v H and the least of its linear part, by hand."""
    assert ROUNDING == 1e-14
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0.5, 4.0, 2)
    first, second = rng.uniform(0.5, 3.0, 2)
    equal = rng.uniform(-3.0, 3.0)
    problem = posynomial()
    point = at(problem, form(problem), (x, y), (first, second), (equal,))
    a, b = math.log(x), math.log(y)
    g = np.array([a - b - math.log(2.0), -b])
    h = a + b - math.log(5.0)
    minimise = math.log((x + 3.0) / 50.0)
    lagrangian = minimise + first * g[0] + second * g[1] + equal * h
    slopes = x / (x + 3.0) + first + equal, -first - second + equal
    wide = math.log(1e3)
    least, rounding = bound(point)
    expected = lagrangian + linear_least(slopes, (a, b), -wide, wide)
    assert least == pytest.approx(expected, abs=1e-12)
    assert least < expected
    rows = first * (1.0 + abs(g[0])) + second * (1.0 + abs(g[1])) + abs(equal) * (1.0 + abs(h))
    assert rounding == pytest.approx(ROUNDING * (1.0 - minimise + rows), rel=1e-9, abs=0.0)
    pulls = x / (x + 3.0) + first + abs(equal), first + second + abs(equal)
    assert point.pull == pytest.approx(pulls, rel=1e-12, abs=0.0)


def test_rounding_of_slopes_is_charged_over_the_box():
    """A box of 1e15 to either side: the doubt of a slope, 1e-14 of all that is added up in it."""
    wide = 300.0 * math.log(10.0)
    problem = posynomial(1e-300, 1e300)
    point = at(problem, form(problem), (1.0, 1.0), (1e9, 0.0), (0.0,))
    point = replace(point, gradient=np.zeros(2))
    least, rounding = bound(point)
    lagrangian = math.log(4.0 / 50.0) - 1e9 * math.log(2.0)
    assert lagrangian - least - rounding == pytest.approx(ROUNDING * wide * 2e9, rel=1e-3, abs=0.0)


@pytest.mark.parametrize("b", [2.0, -2.0])
@pytest.mark.parametrize(("low", "high"), [(-10.0, 10.0), (-INF, INF)])
def test_the_bound_of_a_quadratic_program(b, low, high):
    """At (1, b), in a box and without one: the least of L over the box is known exactly."""
    lam_g, lam_h, x = 0.5, 3.0, np.array([1.0, b])
    problem = program(low, high)
    point = at(problem, natural(problem), x, (lam_g,), (lam_h,))
    g, h = (1.0 - 2.0 * b + 3.0) / 4.0 - 1.0, (1.0 + b) / 8.0 - 1.0
    minimise = 8.0 + b**2 - b + 7.0
    lagrangian = minimise + lam_g * g + lam_h * h
    hessian = np.array([[4.0, -1.0], [-1.0, 2.0]])
    slope_f = np.array([4.0 * (1.0 - 3.0) - b, 2.0 * b - 1.0])
    slope = slope_f + lam_g * np.array([0.25, -0.5]) + lam_h / 8.0
    least, rounding = bound(point)
    assert least <= lagrangian - 0.5 * slope @ np.linalg.solve(hessian, slope)
    floor = 1.0 - 1.0 / math.sqrt(8.0)  # the least eigenvalue of Q scaled to unit diagonal
    bowl = -0.5 * slope**2 / (floor * np.diag(hessian))
    assert least == pytest.approx(lagrangian + bowl.sum(), abs=1e-9)
    along = np.abs(hessian) @ np.abs(x)
    sizes = minimise + lam_g * (1.0 + abs(g)) + lam_h * (1.0 + abs(h))
    sizes += np.abs(x) @ (along + np.abs(slope_f - hessian @ x))
    assert rounding == pytest.approx(ROUNDING * sizes, rel=1e-9, abs=0.0)
    other, linear = np.array([3.0, b]), slope_f - hessian @ x
    point = at(problem, natural(problem), other, (0.0,), (0.0,))
    sizes = abs(point.f) + np.abs(other) @ (np.abs(hessian) @ np.abs(other) + np.abs(linear))
    assert bound(point)[1] == pytest.approx(ROUNDING * sizes, rel=1e-9, abs=0.0)


def test_rounding_of_a_quadratic_slope_is_charged():
    """Of a variable that bends: by the weak curvature; of one that does not: over its box."""

    def evaluate(x, p):
        return Terms({"f": x.a**2 + x.b**2 + 1.98 * x.a * x.b - 1e3 * x.a + 3.0 * x.c})

    variables = tuple(Var(n, "", -1e9, 1e9, 1.0) for n in "abc")
    problem = Problem("weak", variables, (), evaluate)
    shape = natural(problem)
    point = replace(at(problem, shape, (1e3, 1e3, 0.0), (), ()), pull=np.zeros(3))
    hessian = np.array([[2.0, 1.98], [1.98, 2.0]])
    slope = point.gradient[:2]
    floor = curvature(np.array([[2.0, 1.98, 0.0], [1.98, 2.0, 0.0], np.zeros(3)])).floor
    doubt = ROUNDING * (hessian @ [1e3, 1e3] + [1e3, 0.0])
    least, rounding = bound(replace(point, gradient=np.append(slope, 0.0)))
    plain = point.f - (slope**2 / (4.0 * floor)).sum() - rounding
    expected = (2.0 * np.abs(slope) * doubt / (4.0 * floor)).sum() + ROUNDING * 3.0 * 1e9
    assert plain - least == pytest.approx(expected, rel=0.05, abs=0.0)
    still = bound(replace(point, gradient=np.zeros(3)))
    assert point.f - still[0] - rounding == pytest.approx(ROUNDING * 3.0 * 1e9, rel=0.05, abs=0.0)
    pulled = bound(replace(point, gradient=np.zeros(3), pull=np.array([0.0, 0.0, 7.0])))
    assert still[0] - pulled[0] == pytest.approx(ROUNDING * 7.0 * 1e9, rel=0.05, abs=0.0)


def clash(span=10.0, **equal):
    """x >= 3 and x <= 2; y is idle."""

    def evaluate(x, p):
        rows = {"large": 3.0 / x.x, "small": x.x / 2.0, "idle": x.y / 1e9}
        return Terms({"f": x.x * x.y}, rows, equal={k: x.x / v for k, v in equal.items()})

    pair = tuple(Var(n, "", 1.0 / span, span, 1.0, log=True) for n in "xy")
    return Problem("clash", pair, (), evaluate)


def test_the_least_violation_is_bounded_by_normalised_multipliers():
    problem = clash()
    shape = form(problem)
    low, high, _ = (shape.to_y(b) for b in problem.bounds())

    def least(lam, x=(1.0, 1.0)):
        claim = Outcome(np.array(x), lam_g=np.array(lam), lam_h=np.empty(0), infeasible=True)
        return farkas(problem, shape, claim, low, high)

    found, lam, _ = least([4.0, 4.0, 0.0])
    assert list(lam) == [0.5, 0.5, 0.0]
    assert found == pytest.approx(0.5 * math.log(1.5), abs=1e-13)
    assert found < 0.5 * math.log(1.5) - 1e-16
    assert least([4.0, 4.0, -7.0])[0] == found  # below zero is none
    tilted, lam, _ = least([2.0, 1.0, 1.0], (2.0, 5.0))
    assert list(lam) == [0.5, 0.25, 0.25]
    box = math.log(10.0)
    rows = 0.5 * math.log(1.5) + 0.25 * math.log(5e-9)
    rows += 0.25 * (math.log(2.0) - box) + 0.25 * (-box - math.log(5.0))  # slopes -1/4 and 1/4
    assert tilted == pytest.approx(rows, abs=1e-12)
    assert least([0.0, 0.0, 0.0])[0] == -INF
    assert least([-1.0, 0.0, 0.0])[0] == -INF
    assert least([math.nan, 0.0, 0.0])[0] == -INF


def test_equalities_count_with_either_sign():
    """x = 2 and x = 3: v = (1, -1) and (-1, 1) prove it, the right one, by half the distance."""
    problem = clash(two=2.0, three=3.0)
    for sign, proves in ((1.0, True), (-1.0, False)):
        claim = Outcome(
            np.array([2.5, 1.0]),
            lam_g=np.zeros(3),
            lam_h=sign * np.array([5.0, -5.0]),
            infeasible=True,
        )
        verdict = certify(problem, claim, 1e-6)
        assert verdict.status == ("infeasible" if proves else "failed")
        if proves:
            assert sorted(verdict.proof["conflict"]) == ["three", "two"]
            assert verdict.proof["least_violation"] == pytest.approx(math.sqrt(1.5) - 1.0)


def test_the_rounding_of_a_proof_of_emptiness_is_taken_off():
    """Of the rows in a narrow box, of their slopes (and those of the objective) in a wide one."""
    narrow, wide = clash(1.0 + 1e-9, two=2e3), clash(1e300)
    x, lam_h = np.array([1.0, 1.0]), np.array([0.5])
    shape, (low, high, _) = form(narrow), narrow.bounds()
    claim = Outcome(x, lam_g=np.array([0.125, 0.25, 0.125]), lam_h=-lam_h)
    found, _, _ = farkas(narrow, shape, claim, np.log(low), np.log(high))
    logs = [math.log(v) for v in (3.0, 0.5, 1e-9, 1.0 / 2e3)]
    weights = 0.125, 0.25, 0.125, -0.5
    slopes = -0.125 + 0.25 - 0.5, 0.125
    exact = math.fsum(w * v for w, v in zip(weights, logs, strict=True))
    exact -= sum(abs(s) for s in slopes) * math.log(high[0])
    rows = ROUNDING * (
        1.0 + sum(abs(w) * (1.0 + abs(v)) for w, v in zip(weights, logs, strict=True))
    )
    assert exact - found == pytest.approx(rows, rel=0.05, abs=0.0)

    shape, (low, high, _) = form(wide), wide.bounds()
    claim = Outcome(np.array([2.5, 1.0]), lam_g=np.array([1.0, 1.0, 0.0]), lam_h=np.empty(0))
    found, _, _ = farkas(wide, shape, claim, np.log(low), np.log(high))
    ends = 300.0 * math.log(10.0)
    pull = ROUNDING * ((1.0 + 1.0) * (ends + math.log(2.5)) + 1.0 * ends)
    assert 0.5 * math.log(1.5) - found == pytest.approx(pull, rel=2e-2, abs=0.0)


def test_a_proof_of_emptiness_needs_only_the_bounds_that_slopes_point_to():
    def evaluate(x, p):
        return Terms({"f": 1.0 + 0.0 * x.y}, {"large": 3.0 / x.x, "small": x.x / 2.0})

    x = Var("x", "", 0.1, INF, 1.0, log=True), Var("y", "", 0.1, 10.0, 1.0, log=True)
    problem = Problem("open", x, (), evaluate)
    for lam, status in (((1.0, 1.0), "failed"), ((1.0, 0.9), "failed")):
        claim = Outcome(np.ones(2), lam_g=np.array(lam), lam_h=np.empty(0), infeasible=True)
        assert certify(problem, claim, 1e-6).status == status  # a doubt of the slope to infinity


def endless(seed, size):
    """A random geometric program of `size` variables above 1e-9: monomials of three of them."""
    rng = np.random.default_rng(seed)

    def monomial():
        columns, powers = rng.choice(size, 3, replace=False), rng.choice([-2, -1, -0.5, 1, 2], 3)
        return lambda w: math.prod(w[k] ** e for k, e in zip(columns, powers, strict=True))

    inside, costs = np.exp(rng.normal(size=size)), [monomial() for _ in range(3)]
    rows = [(monomial(), monomial()) for _ in range(size)]
    tops = [(a(inside) + b(inside)) / 0.9 for a, b in rows]

    def text(x, p):
        cost = sum(x.w) + sum(0.1 / v for v in x.w) + sum(term(x.w) for term in costs)
        used = tuple((a(x.w) + b(x.w)) / top for (a, b), top in zip(rows, tops, strict=True))
        return Terms({"cost": cost}, {"row": used})

    return text


@pytest.mark.parametrize(("seed", "size"), [(1, 3), (2, 10), (0, 20)])
def test_a_geometric_program_without_upper_bounds_is_proven(seed, size):
    results = []
    for top in (math.inf, 1e9):
        w = Var("w", "", 1e-9, top, 1.0, size=size, log=True)
        results.append(solve(Problem("endless", (w,), (), endless(seed, size)), "ipopt"))
    open_, boxed = results
    assert open_.status == boxed.status == "optimal" and open_.gap < 1e-8
    assert open_.bound <= boxed.value * (1.0 + 1e-12) and boxed.bound <= open_.value


def test_a_minimum_that_lies_at_infinity_is_not_proven_nor_one_at_a_lower_end_lost():
    """a b + c/a + 1/c: a grows without end as b falls to its lower end."""
    a, b, c = (Var(n, "", 1e-6, math.inf, 1.0, log=True) for n in "abc")
    text = lambda x, p: Terms({"f": 2.0 * x.a * x.b + 1.0 / x.c}, {"g": 1.0 / (x.a * x.b * x.c)})  # noqa: E731
    result = solve(Problem("flat", (a, b, c), (), text), "ipopt")
    assert result.bound is None or result.bound <= result.value
    vanishing = Problem("vanishing", (a,), (), lambda x, p: Terms({"f": 1.0 + 1.0 / x.a}))
    result = solve(vanishing, "ipopt")
    assert result.bound is None or result.bound <= 1.0
