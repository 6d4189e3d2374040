"""`stationary` is said of local minima alone, in any unit, and never of a run that was stopped."""

import math
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.drive import continuous_sizing
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise import polish
from gearopt.optimise.certificate import certify
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import natural
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.stationarity import acting, evaluated, residuals
from gearopt.optimise.terms import Named, Terms, Var

INF = np.inf
FACTORS, UNITS = (1e-12, 1e-6, 1.0, 1e6, 1e12), (1e-6, 1.0, 1e6)


def plane(minimise, low=-2.0, high=2.0, guess=(-1.2, 1.0), limits=None, equal=None):
    """Two variables a, b, and the text of an objective, of a limit and of an equality."""

    def evaluate(x, p):
        limited = {} if limits is None else {"limit": limits(x.a, x.b)}
        return Terms(
            {"f": minimise(x.a, x.b)},
            limited,
            equal={} if equal is None else {"e": equal(x.a, x.b)},
        )

    pair = tuple(Var(n, "", low, high, g) for n, g in zip("ab", guess, strict=True))
    return Problem("plane", pair, (), evaluate)


def line(minimise, low, high, guess, **kinds):
    x = Var("x", "", low, high, guess, **kinds)
    return Problem("line", (x,), (), lambda x, p: Terms({"f": minimise(x.x)}))


def rosenbrock(a, b):
    return (1.0 - a) ** 2 + 100.0 * (b - a**2) ** 2


def golinski():
    """The speed reducer of docs/own_problem.md without its idle limits."""

    def evaluate(x, p):
        b, m, z, l1, l2, d1, d2 = x.b, x.m, x.z, x.l1, x.l2, x.d1, x.d2
        volume = (
            0.7854 * b * m**2 * (3.3333 * z**2 + 14.9334 * z - 43.0934)
            - 1.508 * b * (d1**2 + d2**2)
            + 7.4777 * (d1**3 + d2**3)
            + 0.7854 * (l1 * d1**2 + l2 * d2**2)
        )
        limits = {
            "stress_1": np.sqrt(16.9e6 + (745 * l1 / (m * z)) ** 2) / (110 * d1**3),
            "stress_2": np.sqrt(157.5e6 + (745 * l2 / (m * z)) ** 2) / (85 * d2**3),
            "slender": 5 * m / b,
            "length": (1.1 * d2 + 1.9) / l2,
        }
        return Terms({"volume": volume}, limits)

    ends = {
        "b": (2.6, 3.6),
        "m": (0.7, 0.8),
        "z": (17, 28),
        "l1": (7.3, 8.3),
        "l2": (7.3, 8.3),
        "d1": (2.9, 3.9),
        "d2": (5.0, 5.5),
    }
    variables = tuple(Var(n, "", *e, sum(e) / 2) for n, e in ends.items())
    return Problem("golinski", variables, (), evaluate)


def elevator():
    """Real-valued sizes of a two-stage drive, convex in logarithms: ratio 1450/66.5, 7.5 kW."""
    widths = (FaceWidth(Fraction(w), Fraction(w)) for w in ("0.6", "0.75"))
    own = {"modules": (), "pinion_teeth": (20, 40), "toothings": (Toothing(math.radians(25.0)),)}
    stages = tuple(Stage((2.07, 48.0), w, **own) for w in widths)
    total = Fraction(1450) / Fraction("66.5")
    return continuous_sizing.problem(
        Train(49392.913, total, Fraction(1, 100), stages, law=K_FACTOR)
    )


CASES = {
    "rosenbrock": lambda: plane(rosenbrock),
    "rosenbrock, open": lambda: plane(rosenbrock, -INF, INF),
    "offset": lambda: plane(lambda a, b: rosenbrock(a, b) + 5.0),
    "exponentials": lambda: plane(
        lambda a, b: np.exp(a) + np.exp(-a - b) + b**2, -5.0, 31.0, (31.0, 1.0)
    ),
    "disc": lambda: plane(rosenbrock, guess=(0.5, 0.5), limits=lambda a, b: a**2 + b**2),
    "arc": lambda: plane(
        lambda a, b: np.cos(a) + b**2, 0.1, 9.0, (1.0, 1.0), equal=lambda a, b: a * b / 2.0
    ),
    "corner": lambda: plane(
        lambda a, b: -a - 2.0 * b - a * b, 0.0, 10.0, (5.0, 5.0), lambda a, b: (a**2 + b**2) / 25.0
    ),
    "golinski": golinski,
    "elevator": elevator,
    "cube": lambda: Problem(
        "cube",
        (Var("x", "", 0.01, 100.0, 2.0, size=3, log=True),),
        (),
        lambda x, p: Terms(
            {"f": 1.0 / (x.x[0] * x.x[1] * x.x[2])},
            {"area": (x.x[0] * x.x[1] + x.x[1] * x.x[2] + x.x[2] * x.x[0]) / 3.0},
        ),
    ),
}


def times(value, unit):
    return tuple(v * unit for v in value) if isinstance(value, tuple) else value * unit


def measured(problem, factor, unit):
    """The same problem with its objective times a factor and its variables in another unit."""

    def evaluate(x, p):
        own = Named(**{name: times(v, 1.0 / unit) for name, v in vars(x).items()})
        terms = problem.evaluate(own, p)
        return replace(terms, minimise={n: factor * f for n, f in terms.minimise.items()})

    variables = tuple(
        replace(v, **{k: times(getattr(v, k), unit) for k in ("lower", "upper", "guess")})
        for v in problem.variables
    )
    return Problem(problem.name, variables, problem.parameters, evaluate)


@cache
def solved(name):
    """A case with its result and its optimum."""
    problem = CASES[name]()
    result, outcome = run(problem)
    return problem, result, outcome


QUICK = [(name, 1e-12, 1e6) for name in ("rosenbrock, open", "disc", "arc", "golinski", "cube")]


@pytest.mark.parametrize(("name", "factor", "unit"), few(product(CASES, FACTORS, UNITS), QUICK))
def test_neither_a_factor_nor_a_unit_changes_the_answer(name, factor, unit):
    _, plain, outcome = solved(name)
    result, again = run(measured(CASES[name](), factor, unit))
    convex = name in ("cube", "elevator")
    assert result.status == plain.status == ("optimal" if convex else "stationary")
    assert result.value / factor == pytest.approx(plain.value, rel=1e-9, abs=1e-15)
    assert again.x / unit == pytest.approx(outcome.x, rel=1e-6)


SMOOTH = [name for name in CASES if name not in ("cube", "elevator")]


@pytest.mark.parametrize("name", few(SMOOTH, ["golinski", "arc", "corner", "rosenbrock, open"]))
def test_a_point_beside_the_optimum_is_not_stationary(name):
    """Moved by a thousandth of each variable, towards the inside where that is needed."""
    problem, _, outcome = solved(name)
    rng = np.random.default_rng(7)
    lower, upper, _ = problem.bounds()
    seen = 0
    for k in range(80):
        free = rng.random(len(lower)) < 0.5 if k % 2 else np.ones(len(lower), bool)
        moved = outcome.x * (1.0 + 1e-3 * rng.choice([-1.0, 1.0], len(lower)) * free)
        x = np.clip(moved, lower, upper)
        if name == "arc":
            x[1] = 2.0 / x[0]  # on its equality
        verdict = certify(problem, Outcome(x, lam_g=outcome.lam_g, lam_h=outcome.lam_h), 1e-6)
        if np.abs(x / outcome.x - 1.0).max() > 1e-4:
            assert verdict.status in ("feasible", "failed")
            seen += verdict.status == "feasible"
    assert seen >= 3


@pytest.mark.parametrize(
    "name", few(["rosenbrock", "exponentials", "golinski", "arc"], ["golinski", "arc"])
)
def test_a_stopped_run_is_never_stationary(name):
    problem = CASES[name]()
    whole = run(problem)[0].evaluations
    for count in range(2, whole - 3):
        outcome = ipopt.run(problem, Budget(evaluations=count), 0, None)
        if outcome.x is None or solved(name)[1].value > 0.999999 * problem.batch(outcome.x[None]).F:
            continue
        assert not outcome.finished and certify(problem, outcome, 1e-6).status == "limit"
        claimed = replace(outcome, finished=True)
        assert certify(problem, claimed, 1e-6).status == "feasible"
    stopped = replace(solved(name)[2], finished=False)  # the optimum, by a run that was stopped
    assert certify(solved(name)[0], stopped, 1e-6).status == "limit"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_residuals_term_by_term(sign):
    """F = s (3 t^2 x - 5 t) + 1e-6 u with t/8 <= 1 and x <= 2, log x; at x = 3/2, t = 3, u = 2."""

    def evaluate(x, p):
        minimise = sign * (3.0 * x.t**2 * x.x - 5.0 * x.t) + 1e-6 * x.u
        return Terms({"f": minimise}, {"t": x.t / 8.0, "x": x.x / 2.0})

    x, t = Var("x", "", 0.1, 9.0, 1.0, log=True), Var("t", "", 0.0, 10.0, 4.0)
    problem = Problem("mixed", (x, t, Var("u", "", -10.0, 10.0, 1.0)), (), evaluate)
    shape = form(problem)
    low, high, _ = (shape.to_y(b) for b in problem.bounds())
    y, lam = shape.to_y(np.array([1.5, 3.0, 2.0])), np.array([2.0, 0.5])
    point = evaluated(problem, shape, y, low, high, lam, np.empty(0))
    assert point.pull == pytest.approx([41.0, 22.25, 1e-6])
    assert point.gradient == pytest.approx([40.5 * sign + 0.5, 22.0 * sign + 0.25, 1e-6])
    slopes, bends = np.array([41.0, 22.25 * 4.0, 2e-6]), np.array([40.5, 9.0 * 16.0, 0.0])
    unit = slopes + 0.5 * bends
    assert acting(point) == pytest.approx(unit + 1e-8 * unit[1], rel=1e-12)
    room = 3.0 if sign > 0.0 else 4.0  # to the bound below, or its own scale
    promised = [abs(40.5 * sign + 0.5) / unit[0], abs(22.0 * sign + 0.25) * room / unit[1]]
    promised.append(2e-6 / (2e-6 + 1e-8 * unit[1]))
    found = residuals(point)
    assert found["stationarity"] == pytest.approx(max(promised), rel=1e-6)
    assert found["complementarity"] == pytest.approx(2.0 * 5.0 / 8.0 / unit[1], rel=1e-6)


def test_what_acts_is_added_up_whatever_its_sign():
    """a^2 + b at (1, -1) with a row of slopes -2, -3 and an equality 2 - a^2, whose force is -4."""
    problem = plane(
        lambda a, b: a**2 + b,
        guess=(1.0, 1.0),
        limits=lambda a, b: -2.0 * a - 3.0 * b,
        equal=lambda a, b: 2.0 - a**2 + b - b,
    )
    shape, y = form(problem), np.array([1.0, -1.0])
    low, high, _ = problem.bounds()
    point = evaluated(problem, shape, y, low, high, np.array([5.0]), np.array([-4.0]))
    assert point.pull == pytest.approx([2.0 + 10.0 + 8.0, 1.0 + 15.0])
    assert point.gradient == pytest.approx([2.0 - 10.0 + 8.0, 1.0 - 15.0])
    unit = point.pull + 0.5 * np.array([2.0 + 8.0, 0.0])
    assert acting(point) == pytest.approx(unit + 1e-8 * unit.max(), rel=1e-12)


def test_what_acts_in_a_quadratic_program():
    """The unit is no logarithm's, though it is convex: 3 a + a^2/2 + b^2 at (1, 2)."""
    problem = plane(lambda a, b: 3.0 * a + a**2 / 2.0 + b**2, guess=(1.0, 1.0))
    shape, y = natural(problem), np.array([1.0, 2.0])
    low, high, _ = problem.bounds()
    point = evaluated(problem, shape, y, low, high, np.empty(0), np.empty(0))
    assert shape.convex
    assert acting(point) == pytest.approx(np.array([4.5, 12.0]) + 12e-14, rel=1e-15)


def test_what_acts_on_logarithms():
    """F = log(x + 1/x) at x = 2: slope 0.6, curvature 0.64; 1 where the whole is convex."""
    x, t = Var("x", "", 0.1, 9.0, 1.0, log=True), Var("t", "", 0.1, 9.0, 1.0)
    for variables, expected in (((x,), [1.0]), ((x, t), [0.92 + 0.92e-14, 0.92e-14])):
        problem = Problem("sum", variables, (), lambda x, p: Terms({"f": x.x + 1.0 / x.x}))
        shape, at = form(problem), np.full(len(variables), 2.0)
        ends = (shape.to_y(b) for b in (at, *problem.bounds()[:2]))
        point = evaluated(problem, shape, *ends, np.empty(0), np.empty(0))
        assert acting(point) == pytest.approx(expected, rel=1e-12)
    assert residuals(point)["complementarity"] == 0.0


@pytest.mark.parametrize(("off", "status"), [(0.45e-6, "stationary"), (0.55e-6, "feasible")])
def test_a_minimum_is_met_within_a_millionth(off, status):
    """Of -cos x: slope d over half the curvature is 2 d, in units of the guess."""
    problem = line(lambda x: -np.cos(x), -2.0, 2.0, 1.0)
    verdict = certify(problem, Outcome(np.array([off])), 1e-6)
    assert verdict.status == status
    assert verdict.certificate["stationarity"] == pytest.approx(2.0 * off, rel=1e-5)


def test_far_out_on_an_exponential_is_not_stationary():
    """The optimum is 1.8; stopped after 20 iterations at 2.9e13 it was called stationary."""
    problem = line(lambda x: np.exp(x) + np.exp(-2.0 * x), -5.0, 200.0, 100.0)
    for x in (100.0, 31.0, 3.0, 0.3):
        assert certify(problem, Outcome(np.array([x])), 1e-6).status == "feasible"
    assert solve(problem).value == pytest.approx(1.5 * 2.0 ** (1.0 / 3.0), rel=1e-12)


def test_annealing_in_si_units_is_not_stationary(monkeypatch):
    """Sizes of micrometres, an objective of 1e-12: close, but on a slope (before its polish)."""
    monkeypatch.setattr(polish, "polished", lambda last, found, starts: found)
    problem = measured(CASES["rosenbrock"](), 1e-12, 1e-6)
    result, _ = run(problem, "annealing", Budget(evaluations=3200))
    assert result.status == "feasible" and result.value > 0.0


MINIMA = {
    "parabola": (lambda x: 5.0 + x**2, 0.0, -1.0, 1.0),
    "small": (lambda x: 5.0 + 1e-12 * x**2, 0.0, -1e-6, 1e-6),
    "quartic": (lambda x: x**4, 0.0, -1.0, 1.0),
    "sine": (np.sin, 1.5 * np.pi, 0.0, 6.0),
    "kink": (abs, 0.0, -1.0, 1.0),
    "kink of a hill": (lambda x: np.maximum(x, -x) - 0.5 * x**2, 0.0, -1.0, 1.0),
    "end of a slope": (lambda x: x - x**2 / 8.0, 0.0, 0.0, 1.0),
    "lower end": (lambda x: x - x**2 / 16.0, 2.0, 2.0, 3.0),
    "upper end": (lambda x: x**2 / 16.0 - x - x**3, 3.0, 2.0, 3.0),
    "cubic at its end": (lambda x: x**3, 0.0, 0.0, 1.0),
}
NO_MINIMA = {
    "parabola": (lambda x: 5.0 - x**2, 0.0, -1.0, 1.0),
    "small": (lambda x: 5.0 - 1e-12 * x**2, 0.0, -1e-6, 1e-6),
    "parabola at its end": (lambda x: -(x**2), 0.0, 0.0, 1.0),
    "parabola at its other end": (lambda x: -(x**2), 0.0, -1.0, 0.0),
    "quartic": (lambda x: -(x**4), 0.0, -1.0, 1.0),
    "sine": (np.sin, 0.5 * np.pi, 0.0, 6.0),
    "kink": (lambda x: -abs(x), 0.0, -1.0, 1.0),
    "kink of a bowl": (lambda x: x**2 - abs(x), 0.0, -1.0, 1.0),
    "one side of a kink": (lambda x: np.maximum(x, 0.0) ** 2 - 0.1 * x**2, 0.0, -1.0, 1.0),
    "cubic": (lambda x: x**3, 0.0, -1.0, 1.0),
    "cubic above zero": (lambda x: 7.0 + x**3, 0.0, -5.0, 5.0),
    "quintic above zero": (lambda x: 7.0 + x**5, 0.0, -5.0, 5.0),
    "quartic above zero": (lambda x: 1.0 - x**4, 0.0, -5.0, 5.0),
    "cubic at its other end": (lambda x: x**3, 0.0, -1.0, 0.0),
}


@pytest.mark.parametrize("name", MINIMA)
def test_a_minimum_is_stationary(name):
    minimise, x, low, high = MINIMA[name]
    verdict = certify(line(minimise, low, high, x), Outcome(np.array([x])), 1e-6)
    assert verdict.status in ("stationary", "optimal") and verdict.message == ""


@pytest.mark.parametrize("name", NO_MINIMA)
def test_where_slopes_vanish_but_the_objective_falls_is_said(name):
    minimise, x, low, high = NO_MINIMA[name]
    problem = line(minimise, low, high, x)
    verdict = certify(problem, Outcome(np.array([x]), message="Ended."), 1e-6)
    assert verdict.status == "feasible"
    words = "not a minimum: gradients vanish there, but the objective falls along x. Ended."
    assert verdict.message == words
    if name == "parabola":
        result = solve(problem)  # Ipopt's guess is the maximum, which it leaves for an end
        assert result.status in ("stationary", "optimal") and result.value < verdict.objective


ROOT = math.sqrt(0.5)
PLANES = {  # objective, point, limit, equality, least and largest value of a and b; falls along
    "saddle": (lambda a, b: a * b, (0, 0), None, None, -3, 3, "a, b"),
    "bowl": (lambda a, b: a**2 - 1.9 * a * b + b**2, (0, 0), None, None, -3, 3, ""),
    "saddle of parabolas": (lambda a, b: a**2 - b**2, (0, 0), None, None, -3, 3, "b"),
    "steep saddle": (lambda a, b: 1e12 * a**2 - b**2, (0, 0), None, None, -3, 3, "b"),
    "monkey": (lambda a, b: 1e-9 * (a**3 - 3 * a * b**2), (0, 0), None, None, -3, 3, "a"),
    "far side": (lambda a, b: a + b, (ROOT, ROOT), None, "circle", -3, 3, "a, b"),
    "near side": (lambda a, b: a + b, (-ROOT, -ROOT), None, "circle", -3, 3, ""),
    "disc": (lambda a, b: a + b, (-ROOT, -ROOT), "circle", None, -3, 3, ""),
    "rim": (lambda a, b: a**3 / 9 - a**2 - 2 * b**2, (1, 0), "circle", None, -3, 3, "b"),
    "top of the rim": (lambda a, b: -(a**2) - 2 * b**2, (0, 1), "circle", None, -3, 3, ""),
    "corner, falling": (lambda a, b: -a * b, (0, 0), None, None, 0, 3, "a, b"),
    "corner, held": (lambda a, b: a + b - a * b, (0, 0), None, None, 0, 3, ""),
    "edge": (lambda a, b: a - b**2, (0, 0), None, None, 0, 3, "b"),
    "edge without a price": (lambda a, b: a**2 - b**2, (0, 0), None, "sum", -3, 3, None),
    "valley": (lambda a, b: (b - a**2) ** 2, (1, 1), None, None, -3, 3, ""),
}


@pytest.mark.parametrize("name", PLANES)
def test_curvature_is_looked_at_along_the_limits(name):
    minimise, point, limit, equal, low, high, along = PLANES[name]
    texts = {"circle": lambda a, b: a**2 + b**2, "sum": lambda a, b: 1.0 + a - b, None: None}
    problem = plane(minimise, low, high, point, texts[limit], texts[equal])
    verdict = certify(problem, Outcome(np.array(point, float)), 1e-6)
    assert verdict.status in (("feasible",) if along else ("stationary", "optimal"))
    if along:
        falls = verdict.message.rstrip(".").rsplit(" along ", 1)[1]
        assert sorted(falls.split(", ")) == along.split(", ")


@pytest.mark.parametrize(
    ("text", "least"),
    [
        (lambda a, b: a**2 - b**2 + b**4, -0.25),
        (lambda a, b: a * b + a**4 + b**4, -0.125),
        (lambda a, b: (a - 0.5) ** 2 - abs(a - 0.5) + b**2, -0.25),
        (lambda a, b: np.cos(3.0 * a) * np.cos(3.0 * b) + 0.1 * (a**2 + b**2), None),
    ],
)
def test_ipopt_goes_on_from_a_saddle_and_a_kink_along_which_the_objective_falls(text, least):
    result = solve(plane(text, -3.0, 3.0, (0.5 if least == -0.25 else 0.0, 0.0)), "ipopt")
    assert result.status == "stationary" and "falls" not in result.message
    assert result.value == pytest.approx(least, rel=1e-9) if least else result.value < -0.8


def test_limits_without_a_price_leave_a_minimum_open():
    """a b with a, b >= 0 is least at 0, but its curvature alone does not say so."""
    problem = plane(lambda a, b: a * b, 0.0, 3.0, (0.0, 0.0))
    verdict = certify(problem, Outcome(np.zeros(2)), 1e-6)
    assert (
        verdict.status == "feasible"
        and "minimum: limits are active with Lagrange multipliers of zero" in verdict.message
    )
    blocked = plane(lambda a, b: -a * b, -3.0, 3.0, (0.0, 0.0), lambda a, b: 1.0 + a + b)
    verdict = certify(blocked, Outcome(np.zeros(2)), 1e-6)
    assert verdict.status == "feasible" and "falls along" in verdict.message


def test_kinks_across_the_axes_leave_open_whether_it_is_a_minimum():
    """|a + b| - |a - b|/2 + a^2 + b^2 rises along both axes and falls along a = -b."""
    bent = plane(lambda a, b: abs(a + b) - 0.5 * abs(a - b) + a**2 + b**2, -1.0, 1.0, (0.0, 0.0))
    verdict = certify(bent, Outcome(np.zeros(2)), 1e-6)
    assert verdict.status == "feasible" and "abs has a kink there" in verdict.message


def test_a_curvature_that_is_no_number_is_no_minimum():
    problem = line(lambda x: abs(x) ** 1.5, -1.0, 1.0, 0.0)
    verdict = certify(problem, Outcome(np.array([0.0])), 1e-6)
    assert verdict.status == "feasible" and verdict.message == "its curvature is not a number."


def test_too_many_variables_for_a_look_at_the_curvature_is_said(monkeypatch):
    monkeypatch.setattr("gearopt.optimise.stationarity.MAX_FREE", 1)
    problem, result, outcome = solved("rosenbrock")
    verdict = certify(problem, outcome, 1e-6)
    assert verdict.status == "feasible"
    assert "curvature was not examined: 2 variables are off their bounds" in verdict.message
    monkeypatch.setattr("gearopt.optimise.stationarity.MAX_FREE", 2)
    assert certify(problem, outcome, 1e-6).status == "stationary"
    monkeypatch.setattr("gearopt.optimise.stationarity.MAX_FREE", 1)
    convex, _, outcome = solved("cube")
    assert certify(convex, outcome, 1e-6).message == ""
