"""What samplers return: discrete values within their bounds, continuous ones polished by Ipopt."""

import math
import re
import time
from itertools import product

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.errors import SolveError
from gearopt.optimise.box import box
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Param, Repeat, Terms, Var

SAMPLERS = ("annealing", "nsga2")
INCH = 0.0625
SMALL = Budget(evaluations=3_000)


def vessel():
    """Sandgren's pressure vessel (J. Mech. Des. 112, 1990): plates of multiples of 0.0625 in.

    Shell and head thickness, inner radius and length [in]; its optimum 6059.714335048436 is proven
    by Yang, Huyck, Karamanoglu and Khan (Int. J. Bio-Inspired Computation 5, 2013, 329-335).
    """

    def evaluate(x, p):
        cost = 0.6224 * x.shell * x.radius * x.length + 1.7781 * x.head * x.radius**2
        cost += 3.1661 * x.shell**2 * x.length + 19.84 * x.shell**2 * x.radius
        volume = math.pi * x.radius**2 * x.length + 4.0 / 3.0 * math.pi * x.radius**3
        limits = {
            "shell": 0.0193 * x.radius / x.shell,
            "head": 0.00954 * x.radius / x.head,
            "volume": 1_296_000.0 / volume,
        }
        return Terms({"cost": cost}, limits)

    plates = tuple(INCH * k for k in range(1, 100))
    thickness = [Var(n, "in", INCH, 99 * INCH, 1.0, values=plates) for n in ("shell", "head")]
    radius = Var("radius", "in", 10.0, 200.0, 50.0)
    return Problem(
        "vessel", (*thickness, radius, Var("length", "in", 10.0, 200.0, 100.0)), (), evaluate
    )


@pytest.mark.parametrize(("method", "seed"), few(product(SAMPLERS, (0, 1)), [("annealing", 0)]))
def test_the_pressure_vessel(method, seed):
    result = solve(vessel(), method, Budget(evaluations=4_000), seed=seed)
    assert result.value == pytest.approx(6059.714335048436, rel=1e-9)
    assert (result.design["shell_in"], result.design["head_in"]) == (0.8125, 0.4375)
    assert result.design["radius_in"] == pytest.approx(42.0984455958549, rel=1e-6)
    assert result.evaluations <= 4_000


def whole(low, high, guess=None, **kind):
    """Least (n - 0.4)^2 + (x - 1.3)^2: the least whole number of the bounds, and x = 1.3."""
    n = Var("n", "", low, high, (low + high) / 2.0 if guess is None else guess, **kind)
    x = Var("x", "", 0.5, 3.0, 1.0)
    return Problem(
        "whole", (n, x), (), lambda x, p: Terms({"f": (x.n - 0.4) ** 2 + (x.x - 1.3) ** 2})
    )


@pytest.mark.parametrize("method", SAMPLERS)
@pytest.mark.parametrize(
    ("low", "high", "best"),
    few(
        [(0.3, 3.7, 1), (-2.5, 0.2, 0), (1.5, 2.5, 2), (0.7, 60.5, 1)],
        [(0.7, 60.5, 1)],
    ),
)
def test_whole_numbers_between_fractions(method, low, high, best):
    result = solve(whole(low, high, integer=True), method, SMALL)
    assert result.status == "feasible" and result.design["n"] == best
    assert result.value == pytest.approx((best - 0.4) ** 2, abs=1e-12)


def posynomial(low, high, **kind):
    """Least n + 4/n + x, x >= 1: n the nearest to 2."""
    n = Var("n", "", low, high, (low * high) ** 0.5, **kind)
    return Problem(
        "posynomial",
        (n, Var("x", "", 1.0, 3.0, 2.0, log=True)),
        (),
        lambda x, p: Terms({"f": x.n + 4.0 / x.n + x.x}),
    )


@pytest.mark.parametrize("method", [*SAMPLERS, "scip"])
@pytest.mark.parametrize(
    ("low", "high", "value"),
    few([(0.3, 3.7, 5.0), (2.2, 9.9, 3 + 4 / 3 + 1)], [(2.2, 9.9, 3 + 4 / 3 + 1)]),
)
def test_every_method_for_whole_numbers_takes_fractional_bounds(method, low, high, value):
    result = solve(posynomial(low, high, integer=True), method, SMALL)
    assert result.value == pytest.approx(value, rel=1e-7)


@pytest.mark.parametrize("method", [*SAMPLERS, "scip"])
@pytest.mark.parametrize("kind", [{"integer": True}, {"values": (1.0, 2.0)}])
def test_bounds_that_hold_no_value_are_named(method, kind):
    with pytest.raises(SolveError, match=r"between 1\.2 and 1\.9 for n"):
        solve(posynomial(1.2, 1.9, **kind), method, SMALL)


def test_a_bound_that_is_computed_holds_its_value():
    """3 x 0.1 is above 0.3 by a rounding, and so is 0.1 x 30 above 3."""
    values = whole(3 * 0.1, 0.9, 0.5, values=(0.3, 0.6))
    assert values.bounds()[0][0] > 0.3 and box(values).sets[0].tolist() == [0.3, 0.6]
    space = box(whole(0.1 * 3 * 10, 5.0, 4.0, integer=True))
    assert space.points(np.zeros((1, 2)))[0, 0] == 3.0


def coupled(scale=1.0):
    """Least a^2 + b^2 n with a b = 1 and a + c = 2: a^4 = n, and n = 1 is the best."""

    def evaluate(x, p):
        equal = {"product": x.a * x.b / p.one, "sum": (x.a + x.c) / 2.0}
        return Terms({"f": scale * (x.a**2 + x.n * x.b**2)}, equal=equal)

    free = [Var(name, "", 0.1, 3.0, 1.7) for name in "abc"]
    return Problem(
        "coupled",
        (*free, Var("n", "", 0.5, 4.5, 3.0, integer=True)),
        (Param("one", "", 1.0),),
        evaluate,
    )


@pytest.mark.parametrize(
    ("scale", "method"), few(product([1.0, 1e6], SAMPLERS), [(1e6, "annealing")])
)
def test_equalities_are_met(scale, method):
    result = solve(coupled(scale), method, SMALL, seed=3)
    assert result.status == "feasible" and result.certificate["feasibility"] <= 1e-8
    assert result.value == pytest.approx(2.0 * scale, rel=1e-8) and result.design["n"] == 1


def rows_with_choices():
    """A discrete variable in every row of a repeat: y_k is 1, 2 or 4, the nearest to row.t/x."""

    def own(x, p, row):
        return Terms({"f": (x.x * x.y - row.t) ** 2})

    choice = Var("y", "", 1.0, 4.0, 2.0, values=(1.0, 2.0, 4.0))
    rows = Repeat("rows", (choice,), {"t": np.array([1.1, 2.1, 4.3])}, own)
    scale = Var("x", "", 0.5, 2.0, 1.5)
    return Problem("choices", (scale,), (), lambda x, p: Terms({}), (rows,))


@pytest.mark.parametrize("method", few(SAMPLERS, ["annealing"]))
def test_discrete_variables_of_rows_are_held_each_at_its_own(method):
    targets = np.array([1.1, 2.1, 4.3])
    best = min(
        ((targets - y * (targets @ y) / (y @ y)) ** 2).sum()
        for y in map(np.array, product((1.0, 2.0, 4.0), repeat=3))
    )
    result = solve(rows_with_choices(), method, SMALL)
    assert result.value == pytest.approx(best, rel=1e-8)


def waves():
    """A wide dip and a narrow, deeper one: Ipopt from a far point finds the wide one."""

    def evaluate(x, p):
        return Terms({"f": 1.0 + 0.1 * (x.x - 8.0) ** 2 - 3.0 * np.exp(-20.0 * (x.x - 1.0) ** 2)})

    return Problem("waves", (Var("x", "", 0.0, 10.0, 8.0),), (), evaluate)


@pytest.mark.parametrize(("seed", "method"), few(product(range(3), SAMPLERS), 1))
def test_a_polish_never_returns_worse_than_the_sampler_found(seed, method):
    told = []
    result = solve(waves(), method, SMALL, seed, watch=lambda e: told.append(e.best) is None)
    assert result.value <= min(v for v in told if v is not None)
    numbers = [v for v in told if v is not None]
    assert numbers == sorted(numbers, reverse=True)


@pytest.mark.parametrize("method", few(SAMPLERS, ["annealing"]))
def test_what_cannot_be_traced_is_not_polished_and_says_so(method):
    def evaluate(x, p):
        return Terms({"f": x.n + (x.x - 1.3) ** 2 + 0.0 * np.frexp(x.x)[0]})

    variables = Var("x", "", 0.0, 10.0, 8.0), Var("n", "", 1, 3, 2, integer=True)
    result = solve(Problem("table", variables, (), evaluate), method, SMALL)
    assert result.status == "feasible" and result.value == pytest.approx(1.0, abs=1e-3)
    assert result.message.startswith("not polished: the text of table cannot be traced")
    alone = Problem(
        "alone", variables[:1], (), lambda x, p: Terms({"f": (x.x - 1.3) ** 2 + np.frexp(x.x)[0]})
    )
    result = solve(alone, method, SMALL)
    assert result.status == "feasible" and result.bound is None
    assert result.message.startswith("not polished: the text of alone cannot be traced")


MEASURED = {1: 0.8999416, 3: 0.8521369, 7: 0.8131789, 31: 0.7950415}  # of a, b, c = 1, 2, 1.8


def simulated(x, p):
    """Squared misfit of y' = -a y - b y^3 + c at 4 times, by steps that are asked for numbers."""
    y, misfit = 1.0, 0.0
    for k in range(32):
        if x.b > 8.0:
            raise OverflowError("no step")
        y += 0.05 * (x.c - x.a * y - float(x.b) * y**3)
        misfit += (y - MEASURED[k]) ** 2 if k in MEASURED else 0.0
    return Terms({"misfit": misfit})


@pytest.mark.parametrize("method", few([None, *SAMPLERS], 1))
def test_a_simulation_is_polished_without_derivatives_and_its_failed_points_are_told(method):
    ends = {"a": 5.0, "b": 10.0, "c": 5.0}
    variables = tuple(Var(n, "", 0.0, end, end / 2.0) for n, end in ends.items())
    problem = Problem("ode", variables, (), simulated)
    result = gearopt.solve(problem, method=method, budget=Budget(evaluations=200))
    assert result.status == "feasible" and result.value < 1e-6 and result.evaluations <= 200
    assert "polished by cobyqa: the text of ode cannot be traced" in result.message
    assert re.search(r"\d+ of \d+ points failed: OverflowError: no step at a = ", result.message)


@pytest.mark.slow
@pytest.mark.parametrize("method", SAMPLERS)
def test_seconds_end_between_two_points_of_a_population_and_slow_points_are_kept(method):
    asked = []

    def slow(x, p):
        asked.append(float(x.x))
        time.sleep(0.02)
        return Terms({"f": (float(x.x) - 1.3) ** 2})

    problem = Problem("slow", (Var("x", "", 0.0, 10.0, 8.0),), (), slow)
    began = time.perf_counter()
    result = gearopt.solve(problem, method=method, budget=Budget(seconds=0.6))
    assert result.status == "limit" and result.evaluations <= len(asked)
    assert asked.count(result.design["x"]) == 1 and result.value < 0.5
    assert time.perf_counter() - began < 1.9


@pytest.mark.parametrize("method", SAMPLERS)
def test_a_watcher_that_stops_the_sampler_is_not_asked_again(method):
    asked = []
    result = solve(coupled(), method, watch=lambda event: asked.append(event) or len(asked) < 5)
    assert len(asked) == 5 and result.status == "limit"


@pytest.mark.parametrize("method", few(SAMPLERS, 1))
def test_a_polish_is_told_counted_and_ended_by_the_watcher(method):
    """Ipopt's iterations come after the sampler's evaluations, which leave room for them."""
    events = []
    result = solve(coupled(), method, SMALL, watch=lambda e: events.append(e) is None)
    spent = [e.evaluations for e in events]
    assert spent == sorted(spent) and 2_000 < spent[-1] <= result.evaluations <= 3_000
    sampled = max(n for n, more in zip(spent, spent[1:], strict=False) if more > n + 1)
    stopped = solve(coupled(), method, SMALL, watch=lambda e: e.evaluations <= sampled + 3)
    assert stopped.evaluations < result.evaluations and stopped.status in ("limit", "failed")


def test_a_problem_without_continuous_variables_is_sampled_with_all_of_the_budget():
    only = Problem(
        "only",
        (Var("n", "", 1, 60, 30, size=3, integer=True),),
        (),
        lambda x, p: Terms({"f": (x.n[0] * x.n[1] / x.n[2] - 7.3) ** 2 + 1.0}),
    )
    assert solve(only, "annealing", Budget(evaluations=3_200)).evaluations == 3_200
    assert solve(only, "nsga2", Budget(evaluations=3_000)).evaluations == 3_000
