"""What the tape reader proves about a text, and what it must not."""

import numpy as np
import pytest

from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import CONSTANT, MONOMIAL, OTHER, POSYNOMIAL, kinds
from gearopt.optimise.terms import Param, Terms, Var

CASES = {
    "monomial": (lambda x, p: 3.0 * x.a**2 / x.b, MONOMIAL),
    "monomial with root": (lambda x, p: p.c * np.sqrt(x.a) * x.b**-0.7, MONOMIAL),
    "reciprocal": (lambda x, p: 1.0 / x.a, MONOMIAL),
    "root of a square": (lambda x, p: (p.c * x.a**2) ** 0.5, MONOMIAL),
    "what casadi makes the size of x": (lambda x, p: np.sqrt((3.0 * x.a) ** 2), MONOMIAL),
    "sum": (lambda x, p: x.a + 2.0 / x.b, POSYNOMIAL),
    "sum with zero": (lambda x, p: 0.0 + x.a * x.b, MONOMIAL),
    "power of a sum": (lambda x, p: (x.a + x.b) ** 1.5, POSYNOMIAL),
    "sum over a monomial": (lambda x, p: (1.0 + x.a) / x.b, POSYNOMIAL),
    "product of sums": (lambda x, p: (1.0 + x.a) * (2.0 + x.b), POSYNOMIAL),
    "maximum": (lambda x, p: np.maximum(x.a, 2.0 * x.b), POSYNOMIAL),
    "constant": (lambda x, p: 2.0 * p.c, CONSTANT),
    "folded constants": (lambda x, p: (p.c - 1.0) * x.a, MONOMIAL),
    "difference": (lambda x, p: x.a - 0.5 * x.b, OTHER),
    "negative coefficient": (lambda x, p: -p.c * x.a, OTHER),
    "coefficient that a parameter turns negative": (lambda x, p: (1.0 - p.c) * x.a, OTHER),
    "root of one over a sum": (lambda x, p: (x.a + x.b) ** -0.5, OTHER),
    "quotient of sums": (lambda x, p: x.a / (1.0 + x.b), OTHER),
    "logarithm": (lambda x, p: np.log(x.a), OTHER),
    "size of a difference": (lambda x, p: np.abs(x.a - x.b), OTHER),
    "sine": (lambda x, p: np.sin(x.a), OTHER),
    "linear variable": (lambda x, p: x.a * x.l, OTHER),
    "minimum": (lambda x, p: np.minimum(x.a, x.b), OTHER),
}


def problem(text):
    variables = (
        Var("a", "", 0.1, 10, 1.0, log=True),
        Var("b", "", 0.1, 10, 2.0, log=True),
        Var("l", "", 0.1, 10, 2.0),
    )
    return Problem("p", variables, (Param("c", "", 2.0),), lambda x, p: Terms({"f": text(x, p)}))


@pytest.mark.parametrize("name", CASES)
def test_kind(name):
    text, kind = CASES[name]
    assert kinds(problem(text)).objective == kind


@pytest.mark.parametrize("name", [n for n, (_, k) in CASES.items() if k in (MONOMIAL, POSYNOMIAL)])
def test_a_proven_text_is_log_convex_on_random_segments(name):
    """The claim itself: log f at the middle <= mean of log f at the ends (= for monomials)."""
    text, kind = CASES[name]
    found = problem(text)
    rng = np.random.default_rng(0)
    ends = np.exp(rng.uniform(-2, 2, (2, 200, 3)))
    middle = np.sqrt(ends[0] * ends[1])
    values = [np.log(found.batch(x).F[:, 0]) for x in (*ends, middle)]
    excess = values[2] - 0.5 * (values[0] + values[1])
    assert excess.max() < 1e-12
    if kind == MONOMIAL:
        assert np.abs(excess).max() < 1e-12


def test_the_proof_follows_the_parameter():
    found = problem(lambda x, p: (3.0 - p.c) * x.a + x.b)
    assert kinds(found).objective == POSYNOMIAL
    assert kinds(found.at(c=5.0)).objective == OTHER
