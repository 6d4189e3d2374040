"""Reads casadi tapes: the degree of every term as a polynomial in the natural variables.

0 constant, 1 affine, 2 quadratic, `OTHER` everything else. Proven from the operations alone, not
sampled: cancellations (x^3 - x^3) are not seen, and kinks (abs, sign, max), whose derivatives would
pass for constants, are `OTHER`. Parameters and data are constants at their present values.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import fold, walk
from gearopt.optimise.terms import Array
from gearopt.optimise.trace import Block

CONSTANT, AFFINE, QUADRATIC, OTHER = range(4)


@dataclass(frozen=True)
class Degrees:
    """Degree of the objective and of every inequality and equality row, in the problem's order."""

    objective: int
    inequalities: tuple[int, ...]
    equalities: tuple[int, ...]


@dataclass(frozen=True)
class _Term:
    degree: int
    value: Any = None  # of a constant, where it is known


def degrees(problem: Problem) -> Degrees:
    """Read the tapes of a problem at its present parameter values, once for each."""
    key = ("degrees", problem.parameter_values().tobytes())
    if key not in problem.memo:
        problem.memo[key] = _degrees(problem)
    found: Degrees = problem.memo[key]
    return found


def _degrees(problem: Problem) -> Degrees:
    objective: list[int] = []
    rows: tuple[list[int], list[int]] = ([], [])
    for block in problem.traced().blocks:
        read = walk(
            block.function, _inputs(problem, block), lambda value: _Term(CONSTANT, value), _apply
        )
        f, g, h = ([term.degree for term in out] for out in read)
        times = block.repeat.count if block.repeat else 1
        objective += f
        rows[0].extend(g * times)
        rows[1].extend(h * times)
    return Degrees(max(objective), tuple(rows[0]), tuple(rows[1]))


def _inputs(problem: Problem, block: Block) -> list[list[_Term]]:
    repeat = block.repeat
    data: list[Array] = [np.asarray(v, float) for v in repeat.data.values()] if repeat else []
    return [
        [_Term(AFFINE)] * sum(v.size for v in problem.variables),
        [_Term(AFFINE)] * (repeat.width if repeat else 0),
        [_Term(CONSTANT, float(v)) for v in problem.parameter_values()],
        [_Term(CONSTANT, v) for v in data],
    ]


def _apply(operation: int, terms: list[_Term]) -> _Term:
    """The degree of `operation(terms)`."""
    import casadi as ca

    first, last = terms[0], terms[-1]
    if all(t.degree == CONSTANT for t in terms):
        known = all(t.value is not None for t in terms)
        return _Term(CONSTANT, fold(operation, [t.value for t in terms]) if known else None)
    if operation in (ca.OP_ADD, ca.OP_SUB):
        return _Term(max(first.degree, last.degree))
    if operation in (ca.OP_NEG, ca.OP_TWICE, ca.OP_ASSIGN):
        return first
    if operation == ca.OP_MUL:
        return _Term(min(first.degree + last.degree, OTHER))
    if operation == ca.OP_DIV:
        return _Term(first.degree if last.degree == CONSTANT else OTHER)
    if operation == ca.OP_SQ:
        return _Term(min(2 * first.degree, OTHER))
    if operation in (ca.OP_POW, ca.OP_CONSTPOW) and last.degree == CONSTANT:
        for power in (0, 1, 2):
            if last.value is not None and np.all(last.value == power):
                return _Term(min(power * first.degree, OTHER))
    return _Term(OTHER)
