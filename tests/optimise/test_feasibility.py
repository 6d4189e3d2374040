"""Violations of rows, bounds and sets of values, each in its own unit and by its name."""

import math

import numpy as np
import pytest

from gearopt.optimise.problem import Problem
from gearopt.optimise.scale import runaway, violation
from gearopt.optimise.terms import Terms, Var

INF = np.inf


def problem(*variables, limits=None, equal=None):
    def evaluate(x, p):
        rows = [{k: row(x) for k, row in (rows or {}).items()} for rows in (limits, equal)]
        return Terms({"f": 1.0 + 0.0 * vars(x)[variables[0].name]}, rows[0], equal=rows[1])

    return Problem("any", variables, (), evaluate)


def of(posed, *x):
    at = np.array(x, float)
    with np.errstate(invalid="ignore"):
        return violation(posed, at, posed.batch(at[None]))


def test_rows_are_compared_with_1():
    posed = problem(
        Var("a", "", -9, 9, 1.0),
        Var("b", "", -9, 9, 1.0),
        limits={"low": lambda x: x.a, "high": lambda x: x.b},
        equal={"same": lambda x: x.a * x.b + 1.0},
    )
    assert of(posed, 0.0, 0.5) == (0.0, "same")
    assert of(posed, 1.5, 0.0) == (0.5, "low")
    assert of(posed, 0.0, 1.25) == (0.25, "high")
    assert of(posed, -0.5, 0.5) == (0.25, "same")  # short of 1
    assert of(posed, 0.5, 0.5) == (0.25, "same")  # beyond 1
    assert of(posed, -5.0, 0.0)[0] == 0.0


def test_bounds_are_measured_by_the_variable():
    """Of its box, of itself, of 1 where that is less, of itself for logarithms."""
    assert of(problem(Var("x", "", 0, 10, 5)), -0.5) == (0.5, "bound of x")
    assert of(problem(Var("x", "", 0, 10, 5)), 12.0) == (pytest.approx(2.0 / 10.0), "bound of x")
    assert of(problem(Var("x", "", 0, 0.1, 0.05)), 0.11)[0] == pytest.approx(0.1)
    assert of(problem(Var("x", "", 1e-6, INF, 2e-6)), 0.9e-6)[0] == pytest.approx(0.05)
    assert of(problem(Var("x", "", 0.0, 1e6, 2e5)), -0.1)[0] == pytest.approx(0.1)
    assert of(problem(Var("x", "", 100, INF, 300)), 50.0)[0] == pytest.approx(1.0)
    assert of(problem(Var("x", "", -INF, -100, -300)), -50.0)[0] == pytest.approx(1.0)
    assert of(problem(Var("x", "", 5, 5, 5)), 6.0)[0] == pytest.approx(1.0 / 6.0)
    assert of(problem(Var("x", "", 1e-3, 1e3, 1, log=True)), 0.9e-3)[0] == pytest.approx(1 / 9)
    assert of(problem(Var("x", "", 1e-3, 1e3, 1, log=True)), 2e3)[0] == pytest.approx(0.5)
    assert of(problem(Var("x", "", 0, 10, 5)), 3.0)[0] == 0.0


def test_sets_of_values_are_met():
    posed = problem(
        Var("n", "", 0, 90, 3, integer=True),
        Var("m", "mm", 1, 2, 1, values=(1.0, 1.25, 2.0)),
        Var("x", "", 0, 9, 1),
    )
    assert of(posed, 3.0, 1.25, 0.3)[0] == 0.0
    assert of(posed, 3.25, 1.25, 0.3) == (0.25, "set of values of n")
    assert of(posed, 2.75, 1.25, 0.3) == (0.25, "set of values of n")
    assert of(posed, 3.0, 1.5, 0.3) == (pytest.approx(0.25), "set of values of m")
    tiny = problem(Var("m", "m", 1e-9, 4e-9, 1e-9, values=(1e-9, 2e-9, 4e-9)))
    assert of(tiny, 2e-9)[0] == 0.0
    assert of(tiny, 1.5e-9)[0] == pytest.approx(1.0 / 3.0)  # of itself, not of 1
    large = problem(Var("m", "", 100, 400, 100, values=(100.0, 200.0, 400.0)))
    assert of(large, 200.5)[0] == pytest.approx(0.5)


def test_the_first_number_that_is_none_is_named():
    posed = problem(
        Var("a", "", -9, 9, 1.0),
        limits={"fine": lambda x: x.a, "root": lambda x: np.sqrt(x.a)},
        equal={"other": lambda x: np.sqrt(x.a)},
    )
    worst, name = of(posed, -1.0)
    assert math.isnan(worst) and name == "root"
    assert of(posed, 4.0) == (3.0, "fine")


def test_an_infinite_row_is_violated():
    posed = problem(Var("a", "", -9, 9, 1.0), limits={"inverse": lambda x: -1.0 / x.a})
    assert of(posed, 0.0) == (INF, "inverse") and of(posed, -0.0) == (INF, "inverse")
    assert of(posed, 1.0)[0] == 0.0


@pytest.mark.parametrize(
    ("lower", "upper", "guess", "x", "named"),
    [
        (-INF, INF, 0.0, 1.1e9, True),
        (-INF, INF, 0.0, -1.1e9, True),
        (-INF, INF, 0.0, 0.9e9, False),
        (-INF, INF, 0.0, 1e9, False),
        (-INF, INF, 5.0, 4e9, False),
        (-INF, INF, 5.0, 6e9, True),
        (-INF, INF, -5.0, 4e9, False),
        (-INF, INF, 0.1, 0.5e9, False),
        (0.0, INF, 0.0, 1.1e9, True),
        (-INF, 0.0, 0.0, -1.1e9, True),
        (-2e9, 2e9, 0.0, 1.1e9, False),
    ],
)
def test_a_variable_that_nothing_holds_is_named(lower, upper, guess, x, named):
    posed = problem(Var("held", "", -1, 1, 0), Var("x", "", lower, upper, guess))
    words = runaway(posed, np.array([0.5, x]), *posed.bounds())
    assert words == (f"x is unbounded ({x:.3g}): give it a bound or a limit" if named else "")
