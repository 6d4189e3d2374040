"""Maxima in log-convex texts: at their kinks the optimum is proven by the epigraph form."""

import numpy as np
import pytest

from gearopt.optimise.epigraphs import epigraph, raised
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Param, Terms, Var


def posed(text, size=2, low=0.01, high=100.0):
    variables = (Var("w", "", low, high, 1.0, size=size, log=True),)
    return Problem("maxima", variables, (Param("c", "", 2.0),), text)


def kink(x, p):
    """w1 + 1/w2 + max(1/w1, c w2): least 2 sqrt(3) at w1 = 1/sqrt(3), c w2 = sqrt(3) for c = 2."""
    return Terms({"f": x.w[0] + np.maximum(1.0 / x.w[0], p.c * x.w[1]) + 1.0 / x.w[1]})


def nested(x, p):
    a, b, c = x.w
    inner = np.maximum(b**2, np.maximum(c**-0.5, np.sqrt(a)))
    limit = np.maximum(a / (3.0 * b), 1.0 / (4.0 * c)) + c / 10.0
    return Terms({"f": p.c * a**-1.5 * inner + b**0.3 / c + a}, {"g": limit})


def test_a_maximum_becomes_an_epigraph_whose_bound_is_the_text_s():
    result = solve(posed(kink), "annealing", Budget(evaluations=1000))
    assert result.status == "optimal" and result.value == pytest.approx(12.0**0.5, rel=1e-10)
    assert list(result.design) == ["w"] and not result.multipliers
    problem = posed(nested, 3)
    result = solve(problem)
    assert result.status == "optimal" and result.multipliers["g"] < 0.0
    again = solve(problem.at(c=3.0))
    assert again.status == "optimal" and again.value > result.value
    points = np.exp(np.random.default_rng(0).uniform(-2.0, 2.0, (20_000, 3)))
    batch = problem.batch(points)
    values = batch.F[batch.G.max(axis=1) <= 1.0, 0]
    assert result.bound <= result.value <= values.min() < 1.1 * result.value


def test_heights_lie_between_their_ends():
    problem = posed(nested, 3)
    low, high, _ = epigraph(problem).bounds()
    points = np.exp(np.random.default_rng(1).uniform(np.log(0.01), np.log(100.0), (200, 3)))
    for x in (*points, np.full(3, 0.01), np.full(3, 100.0)):
        heights = raised(problem, x)
        assert (low <= heights).all() and (heights <= high).all()


def test_what_has_no_epigraph_is_taken_as_it_is():
    assert epigraph(posed(lambda x, p: Terms({"f": x.w[0] + x.w[1]}))) is None
    assert epigraph(posed(lambda x, p: Terms({"f": -np.maximum(x.w[0], x.w[1])}))) is None
    assert epigraph(posed(kink, high=np.inf)) is None
