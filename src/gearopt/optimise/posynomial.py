"""The posynomials of a problem, read from its tape: coefficients and exponents of every row.

For back ends that need the model itself (SCIP), not only its values. Every variable that is
positive by its bounds counts as a factor, whether declared log or not.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import walk
from gearopt.optimise.terms import Array

MOST_TERMS = 200  # of one expanded row; beyond it the text should name an intermediate variable


@dataclass(frozen=True)
class Posynomial:
    """sum_k coefficients[k] * prod_j x_j**exponents[k, j]; coefficients (t,) > 0 unless empty."""

    coefficients: Array
    exponents: Array


@dataclass(frozen=True)
class Model:
    """Objective, inequalities (<= 1) and equalities (monomials, = 1) of a problem."""

    objective: Posynomial
    inequalities: tuple[Posynomial, ...]
    equalities: tuple[Posynomial, ...]


def read(problem: Problem) -> Model:
    """Expand every row of a problem's tape; SolveError names the row that is no posynomial."""
    if problem.repeats:
        raise SolveError(f"{problem.name} has repeats, which this reader does not expand")
    rows = problem.rows
    (block,) = problem.traced().blocks
    f, g, h = _outputs(problem, block.function)
    names = [*rows.objectives, *(r.name for r in rows.inequalities), *rows.equalities]
    for name, term in zip(names, [*f, *g, *h], strict=True):
        if term is None or not (term.coefficients > 0).all() or not len(term.coefficients):
            raise SolveError(f"{problem.name}: {name} is no posynomial")
        if not (np.isfinite(term.coefficients).all() and np.isfinite(term.exponents).all()):
            raise SolveError(f"{problem.name}: {name} has an infinite coefficient or exponent")
    for name, term in zip(rows.equalities, h, strict=True):
        if len(term.coefficients) != 1:
            raise SolveError(f"{problem.name}: the equality {name} is no monomial")
    return Model(f[0], tuple(g), tuple(h))


def _outputs(problem: Problem, function: Any) -> list[list[Any]]:
    lower, _, _ = problem.bounds()
    count = len(lower)
    inputs: list[list[Any]] = [
        [_variable(k, lower) for k in range(count)],
        [],
        [_constant(value, count) for value in problem.parameter_values()],
        [],
    ]
    return walk(function, inputs, lambda value: _constant(value, count), _apply)


def _constant(value: float, count: int) -> Posynomial:
    return Posynomial(np.array([float(value)]), np.zeros((1, count)))


def _variable(index: int, lower: Array) -> Posynomial | None:
    if not lower[index] > 0:
        return None
    exponents = np.zeros((1, len(lower)))
    exponents[0, index] = 1.0
    return Posynomial(np.ones(1), exponents)


def _apply(operation: int, terms: list[Posynomial | None]) -> Posynomial | None:
    import casadi as ca

    if any(t is None for t in terms):
        return None
    a, b = terms[0], terms[-1]
    assert a is not None and b is not None
    if operation == ca.OP_ADD:
        return _sum(a, b)
    if operation == ca.OP_SUB:
        return _sum(a, Posynomial(-b.coefficients, b.exponents))
    if operation == ca.OP_NEG:
        return Posynomial(-a.coefficients, a.exponents)
    if operation == ca.OP_TWICE:
        return Posynomial(2.0 * a.coefficients, a.exponents)
    if operation == ca.OP_MUL:
        return _product(a, b)
    if operation == ca.OP_SQ:
        return _product(a, a)
    if operation == ca.OP_DIV:
        inverse = _power(b, -1.0)
        return None if inverse is None else _product(a, inverse)
    if operation == ca.OP_INV:
        return _power(a, -1.0)
    if operation == ca.OP_SQRT:
        return _power(a, 0.5)
    if operation in (ca.OP_POW, ca.OP_CONSTPOW):
        constant = len(b.coefficients) == 1 and not b.exponents.any()
        return _power(a, float(b.coefficients[0])) if constant else None
    return a if operation == ca.OP_ASSIGN else None


def _sum(a: Posynomial, b: Posynomial) -> Posynomial | None:
    return _collected(
        np.concatenate([a.coefficients, b.coefficients]), np.concatenate([a.exponents, b.exponents])
    )


def _product(a: Posynomial, b: Posynomial) -> Posynomial | None:
    coefficients = np.outer(a.coefficients, b.coefficients).ravel()
    exponents = (a.exponents[:, None, :] + b.exponents[None, :, :]).reshape(
        len(coefficients), a.exponents.shape[1]
    )
    return _collected(coefficients, exponents)


def _power(a: Posynomial, exponent: float) -> Posynomial | None:
    if len(a.coefficients) == 1 and a.coefficients[0] > 0:
        return Posynomial(a.coefficients**exponent, exponent * a.exponents)
    if exponent == int(exponent) and 1 <= exponent <= 8:
        result: Posynomial | None = a
        for _ in range(int(exponent) - 1):
            result = None if result is None else _product(result, a)
        return result
    return None


def _collected(coefficients: Array, exponents: Array) -> Posynomial | None:
    """Equal monomials added up; zeros dropped."""
    unique, place = np.unique(np.round(exponents, 12), axis=0, return_inverse=True)
    total = np.bincount(place.ravel(), weights=coefficients, minlength=len(unique))
    keep = total != 0
    if keep.sum() > MOST_TERMS:
        return None
    return Posynomial(total[keep], unique[keep])
