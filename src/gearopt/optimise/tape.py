"""Reads casadi tapes: which terms are, provably, log-convex in the log variables.

A term is `CONSTANT`, `MONOMIAL` (log-affine), `POSYNOMIAL` (here in the wide sense: built from
monomials by sums, products, positive powers and maxima, hence log-convex) or `OTHER`. The rules
are those of disciplined geometric programming (Agrawal, Diamond, Boyd, 2019). Parameters and data
are constants: the proof holds at their present values.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array
from gearopt.optimise.trace import Block

CONSTANT, MONOMIAL, POSYNOMIAL, OTHER = range(4)


@dataclass(frozen=True)
class Kinds:
    """Kind of the objective and of every inequality and equality row, in the problem's order."""

    objective: int
    inequalities: tuple[int, ...]
    equalities: tuple[int, ...]

    @property
    def log_convex(self) -> bool:
        """Whether the whole problem is convex in the logarithms of its variables."""
        return (
            self.objective <= POSYNOMIAL
            and all(k <= POSYNOMIAL for k in self.inequalities)
            and all(k <= MONOMIAL for k in self.equalities)
        )


@dataclass(frozen=True)
class _Term:
    kind: int
    value: Any = None  # of a constant: a float, or an array over the rows of a repeat

    @property
    def positive(self) -> bool:
        """Whether the term is known to be > 0."""
        if self.kind == CONSTANT:
            return bool(np.all(self.value > 0))
        return self.kind != OTHER


_UNKNOWN = _Term(OTHER)


def kinds(problem: Problem) -> Kinds:
    """Read the tapes of a problem at its present parameter values, once for each."""
    key = ("kinds", problem.parameter_values().tobytes())
    if key not in problem.memo:
        problem.memo[key] = _kinds(problem)
    found: Kinds = problem.memo[key]
    return found


def _kinds(problem: Problem) -> Kinds:
    objective: list[int] = []
    inequalities: list[int] = []
    equalities: list[int] = []
    for block in problem.traced().blocks:
        f, g, h = _read(problem, block)
        times = block.repeat.count if block.repeat else 1
        objective += f
        inequalities += g * times
        equalities += h * times
    total = max(objective)
    if len(objective) > 1 and total == MONOMIAL:
        total = POSYNOMIAL  # a sum over blocks
    return Kinds(total, tuple(inequalities), tuple(equalities))


def _read(problem: Problem, block: Block) -> tuple[list[int], list[int], list[int]]:
    rows = walk(
        block.function, _inputs(problem, block), lambda value: _Term(CONSTANT, value), _apply
    )
    f, g, h = ([_as_row(term) for term in out] for out in rows)
    return f, g, h


def walk(function: Any, inputs: list[list[Any]], constant: Any, apply: Any) -> list[list[Any]]:
    """Run a reader over a tape: what it makes of every scalar of every output.

    inputs: one reading of every scalar of every input; constant(value) reads a number and
    apply(operation, readings) an operation.
    """
    import casadi as ca

    work: list[Any] = [None] * function.sz_w()
    found = [[constant(0.0)] * function.size1_out(k) for k in range(function.n_out())]
    with np.errstate(all="ignore"):
        for k in range(function.n_instructions()):
            operation = function.instruction_id(k)
            source, target = function.instruction_input(k), function.instruction_output(k)
            if operation == ca.OP_INPUT:
                work[target[0]] = inputs[source[0]][source[1]]
            elif operation == ca.OP_CONST:
                work[target[0]] = constant(function.instruction_constant(k))
            elif operation == ca.OP_OUTPUT:
                found[target[0]][target[1]] = work[source[0]]
            else:
                work[target[0]] = apply(operation, [work[s] for s in source])
    return found


def _as_row(term: _Term) -> int:
    """A row is used through its logarithm, so a constant counts only when positive."""
    return term.kind if term.positive else OTHER


def _inputs(problem: Problem, block: Block) -> list[list[_Term]]:
    def variables(declared: tuple[Any, ...]) -> list[_Term]:
        return [_Term(MONOMIAL) if v.log else _UNKNOWN for v in declared for _ in range(v.size)]

    repeat = block.repeat
    data: list[Array] = [np.asarray(v, float) for v in repeat.data.values()] if repeat else []
    return [
        variables(problem.variables),
        variables(repeat.variables) if repeat else [],
        [_Term(CONSTANT, float(v)) for v in problem.parameter_values()],
        [_Term(CONSTANT, v) for v in data],
    ]


def _apply(operation: int, terms: list[_Term]) -> _Term:
    """The kind of `operation(terms)`."""
    import casadi as ca

    if all(t.kind == CONSTANT for t in terms):
        value = fold(operation, [t.value for t in terms])
        return _UNKNOWN if value is None else _Term(CONSTANT, value)
    first, last = terms[0], terms[-1]
    if operation in (ca.OP_CONSTPOW, ca.OP_POW):
        return _power(first, last)
    if operation == ca.OP_ADD and any(t.kind == CONSTANT and np.all(t.value == 0) for t in terms):
        return first if last.kind == CONSTANT else last
    if not all(t.positive for t in terms):
        return _UNKNOWN
    if operation in (ca.OP_ADD, ca.OP_FMAX):
        return _Term(POSYNOMIAL)
    if operation == ca.OP_MUL:
        return _Term(max(MONOMIAL, first.kind, last.kind))
    if operation == ca.OP_DIV:
        return _Term(max(MONOMIAL, first.kind)) if last.kind <= MONOMIAL else _UNKNOWN
    if operation == ca.OP_INV:
        return _Term(MONOMIAL) if first.kind <= MONOMIAL else _UNKNOWN
    if operation in (ca.OP_SQ, ca.OP_SQRT, ca.OP_TWICE, ca.OP_ASSIGN, ca.OP_FABS):
        return _Term(max(MONOMIAL, first.kind))
    return _UNKNOWN


def _power(base: _Term, exponent: _Term) -> _Term:
    if exponent.kind != CONSTANT or not base.positive:
        return _UNKNOWN
    if base.kind == POSYNOMIAL and not np.all(exponent.value > 0):
        return _UNKNOWN
    return _Term(max(MONOMIAL, base.kind))


def fold(operation: int, values: list[Any]) -> Any:
    """What an operation makes of numbers, or None where this reader does not know it."""
    known = _folds().get(operation)
    return known(*values) if known else None


@cache
def _folds() -> dict[int, Any]:
    """How casadi's operations act on numbers."""
    import casadi as ca

    return {
        ca.OP_ASSIGN: lambda a: a,
        ca.OP_ADD: np.add,
        ca.OP_SUB: np.subtract,
        ca.OP_MUL: np.multiply,
        ca.OP_DIV: np.divide,
        ca.OP_NEG: np.negative,
        ca.OP_POW: np.power,
        ca.OP_CONSTPOW: np.power,
        ca.OP_SQ: np.square,
        ca.OP_TWICE: lambda a: a + a,
        ca.OP_INV: np.reciprocal,
        ca.OP_SQRT: np.sqrt,
        ca.OP_FABS: np.abs,
        ca.OP_EXP: np.exp,
        ca.OP_LOG: np.log,
        ca.OP_SIN: np.sin,
        ca.OP_COS: np.cos,
        ca.OP_TAN: np.tan,
        ca.OP_FMAX: np.maximum,
        ca.OP_FMIN: np.minimum,
    }
