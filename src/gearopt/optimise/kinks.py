"""Kinks and jumps of a text at a point, read from its tape: there gradients tell no minimum.

|a| has a kink at a = 0, max and min where their arguments are equal; sign, floor, ceil and
comparisons (`np.where`) jump. casadi differentiates them as if one branch, or the mean of both,
went on: of x^2 - |x| it gives the slope 0 at 0, which is a local maximum.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.scale import sizes
from gearopt.optimise.tape import fold, walk
from gearopt.optimise.terms import Array

TERM_TIE = 1e-6  # of the terms that are compared: they are equal
NOISE = 1e-12  # of the objective: a smaller fall is rounding
PROBE_STEPS = (1e-6, 1e-4, 1e-2)  # of a variable's own scale, by which the objective is probed


@dataclass(frozen=True)
class _Reading:
    """A number of a tape at a point: value, size of the terms it is made of, whether x moves it.

    kink: the name of a function that has one there; "" for none. Arrays over rows of a repeat.
    """

    value: Any
    size: Any
    moves: bool = False
    kink: str = ""


def kink(problem: Problem, x: Array, active: Any) -> str:
    """Return the name of a function that has a kink or jump at x; "" where none has.

    Of the objective, the equalities and the inequalities that are active (ng,).
    """
    every = _read(problem, x)
    inequalities = [k for k, on in zip(every[1], active, strict=True) if on]
    return next((name for name in (*every[0], *inequalities, *every[2]) if name), "")


def probed(problem: Problem, x: Array) -> tuple[str, bool, Array]:
    """Return the variable along which the objective falls, whether it rises along all others.

    By PROBE_STEPS to both sides of each variable, alone, that exceed no limit further; "": none.
    Beside them the lowest of these points along that variable, else x.
    """
    lower, upper, _ = problem.bounds()
    steps, count = np.diag(sizes(problem, x)), len(x)
    ways = np.vstack([steps, -steps])
    points = np.clip(x + np.vstack([step * ways for step in PROBE_STEPS]), lower, upper)
    batch = problem.batch(np.vstack([x, points]))
    excess = np.hstack([batch.G - 1.0, np.abs(batch.H - 1.0)])
    free = (excess[1:] <= np.maximum(excess[0], 0.0)).all(axis=1) & (points != x).any(axis=1)
    change = batch.F[1:, 0] - batch.F[0, 0]
    noise = NOISE * abs(batch.F[0, 0])
    less, more = (
        np.reshape(free & side, (len(PROBE_STEPS), -1))
        for side in (change < -noise, change > noise)
    )
    falling = np.flatnonzero(less.all(axis=0))
    name = str(problem.columns[falling[0] % count][1]) if len(falling) else ""
    rising = bool((more | ~free.reshape(more.shape)).all())
    if not name:
        return name, rising, x
    along = np.arange(len(PROBE_STEPS)) * len(ways) + falling[0]
    return name, rising, points[along[change[along].argmin()]]


def _read(problem: Problem, x: Array) -> tuple[list[str], list[str], list[str]]:
    """Return the kinks of the objectives of all blocks, and of all rows of g and h, in order."""
    kinks: tuple[list[str], list[str], list[str]] = ([], [], [])
    scales, start = sizes(problem, x), sum(v.size for v in problem.variables)
    shared = [_Reading(v, s, True) for v, s in zip(x[:start], scales[:start], strict=True)]
    p = [_Reading(v, abs(v)) for v in problem.parameter_values()]
    for block in problem.traced().blocks:
        repeat, inner, data = block.repeat, [], []
        if repeat is not None:
            stop = start + repeat.count * repeat.width
            parts = (a[start:stop].reshape(repeat.count, -1).T for a in (x, scales))
            inner = [_Reading(v, s, True) for v, s in zip(*parts, strict=True)]
            data = [_Reading(np.asarray(v, float), np.abs(v)) for v in repeat.data.values()]
            start = stop
        terms = walk(block.function, [shared, inner, p, data], _constant, _apply)
        count = repeat.count if repeat else 1
        for part, more, times in zip(kinks, terms, (1, count, count), strict=True):
            part += [reading.kink for reading in more] * times
    return kinks


def _constant(value: float) -> _Reading:
    return _Reading(value, abs(value))


def _apply(operation: int, terms: list[_Reading]) -> _Reading:
    """Return the reading of `operation(terms)`."""
    import casadi as ca

    values = [t.value for t in terms]
    name, near = _bends().get(operation, ("", None))
    moves = any(t.moves for t in terms)
    bent = near is not None and moves and np.any(near(*values, _largest(terms)))
    value = _value(operation, values)
    size = np.abs(value)
    if operation in (ca.OP_ADD, ca.OP_SUB, ca.OP_FMAX, ca.OP_FMIN):
        size = _largest(terms)
    elif operation in (ca.OP_MUL, ca.OP_SQ):
        size = terms[0].size * terms[-1].size
    elif operation in (ca.OP_NEG, ca.OP_FABS, ca.OP_ASSIGN):
        size = terms[0].size
    elif operation == ca.OP_TWICE:
        size = 2.0 * terms[0].size
    elif operation == ca.OP_DIV:
        size = terms[0].size / np.abs(values[1])
    inner = next((t.kink for t in terms if t.kink), "")
    return _Reading(value, size, moves, name if bent else inner)


def _largest(terms: list[_Reading]) -> Any:
    """Return the largest size of some readings."""
    return np.maximum(terms[0].size, terms[-1].size)


def _value(operation: int, values: list[Any]) -> Any:
    """Return the number that an operation makes; NaN where this reader does not know it."""
    known = fold(operation, values)
    if known is not None:
        return known
    other = _others().get(operation)
    return other(*values) if other else np.nan


Near = Callable[..., Any]


@cache
def _bends() -> dict[int, tuple[str, Near]]:
    """Name of casadi's operation, and whether its numbers are at a kink."""
    import casadi as ca

    def zero(a: Any, size: Any) -> Any:
        return np.abs(a) <= TERM_TIE * size

    def equal(a: Any, b: Any, size: Any) -> Any:
        return np.abs(a - b) <= TERM_TIE * size

    def whole(a: Any, size: Any) -> Any:
        return np.abs(a - np.round(a)) <= TERM_TIE * np.maximum(size, 1.0)

    compared = (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE)
    return {
        ca.OP_FABS: ("abs", zero),
        ca.OP_SIGN: ("sign", zero),
        ca.OP_FLOOR: ("floor", whole),
        ca.OP_CEIL: ("ceil", whole),
        ca.OP_FMAX: ("maximum", equal),
        ca.OP_FMIN: ("minimum", equal),
        **dict.fromkeys(compared, ("a comparison", equal)),
    }


@cache
def _others() -> dict[int, Any]:
    """Return how further operations act on numbers."""
    import casadi as ca

    return {
        ca.OP_SIGN: np.sign,
        ca.OP_FLOOR: np.floor,
        ca.OP_CEIL: np.ceil,
        ca.OP_LT: np.less,
        ca.OP_LE: np.less_equal,
        ca.OP_EQ: np.equal,
        ca.OP_NE: np.not_equal,
        ca.OP_NOT: np.logical_not,
        ca.OP_AND: np.logical_and,
        ca.OP_OR: np.logical_or,
        ca.OP_IF_ELSE_ZERO: lambda c, v: np.where(np.asarray(c, bool), v, 0.0),
        ca.OP_ASIN: np.arcsin,
        ca.OP_ACOS: np.arccos,
        ca.OP_ATAN: np.arctan,
        ca.OP_ATAN2: np.arctan2,
        ca.OP_SINH: np.sinh,
        ca.OP_COSH: np.cosh,
        ca.OP_TANH: np.tanh,
        ca.OP_HYPOT: np.hypot,
        ca.OP_LOG1P: np.log1p,
        ca.OP_EXPM1: np.expm1,
    }
