"""Multipliers from gradients alone, against closed forms."""

import numpy as np
import pytest

from gearopt.optimise.form import form
from gearopt.optimise.multipliers import multipliers
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var


def at(problem, x):
    shape = form(problem)
    low, high, _ = (shape.to_y(b) for b in problem.bounds())
    return multipliers(shape, shape.to_y(np.array(x)), problem.parameter_values(), low, high)


def pair(**rows):
    both = (Var("x", "", 0.01, 100, 1.0, log=True), Var("y", "", 0.01, 100, 1.0, log=True))
    return Problem(
        "pair",
        both,
        (),
        lambda x, p: Terms(
            {"f": x.x**3.0 * x.y**2.0},
            **{k: {n: row(x) for n, row in v.items()} for k, v in rows.items()},
        ),
    )


def test_a_limit_carries_the_slope_of_the_objective():
    """log f = 3 log x + 2 log y, limits 1/x and 1/y at 1: multipliers 3 and 2; an idle one is 0."""
    problem = pair(
        limits={"x": lambda x: 1.0 / x.x, "y": lambda x: 1.0 / x.y, "idle": lambda x: x.x / 9}
    )
    lam_g, lam_h = at(problem, [1.0, 1.0])
    assert lam_g == pytest.approx([3.0, 2.0, 0.0], abs=1e-12) and len(lam_h) == 0


def test_an_equality_may_have_either_sign():
    problem = pair(limits={"y": lambda x: 1.0 / x.y}, equal={"x": lambda x: x.x / 2.0})
    lam_g, lam_h = at(problem, [2.0, 1.0])
    assert lam_g == pytest.approx([2.0], abs=1e-12)
    assert lam_h == pytest.approx([-3.0], abs=1e-12)


def test_a_variable_on_its_bound_needs_no_multiplier():
    problem = pair(limits={"y": lambda x: 1.0 / x.y})
    lam_g, _ = at(problem, [0.01, 1.0])
    assert lam_g == pytest.approx([2.0], abs=1e-12)


def test_no_multiplier_is_negative():
    """At a point where a row pulls the wrong way its multiplier is 0, not below."""
    problem = pair(limits={"wrong": lambda x: x.x, "right": lambda x: 1.0 / x.y})
    lam_g, _ = at(problem, [1.0, 1.0])
    assert lam_g == pytest.approx([0.0, 2.0], abs=1e-12)
