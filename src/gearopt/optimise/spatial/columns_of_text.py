"""The columns of a problem: its text walked, bounds and values, logarithms of positive columns."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.box import allowed_values, whole_ends
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.spatial.columns import (
    ABS,
    ASIN,
    ATAN,
    CONTINUOUS,
    COSINE,
    EXP,
    FLOOR,
    LINEAR,
    LISTED,
    LOG,
    MAXIMUM,
    MINIMUM,
    POWER,
    PRODUCT,
    QUOTIENT,
    ROOT,
    ROOT_SWEEPS,
    ROUNDED,
    SINE,
    TANH,
    WHOLE,
    Affine,
    Builder,
    Columns,
    Refused,
    added,
    divided,
    multiplied,
    of_column,
    of_two,
    powered,
    raised,
    refuse,
    scaled,
)
from gearopt.optimise.spatial.partial import open_at_zero, partial_relations
from gearopt.optimise.tape import walk
from gearopt.optimise.terms import Array


def _reader(builder: Builder) -> Callable[[int, list[Affine]], Affine]:
    import casadi as ca

    from gearopt.optimise.tape import fold

    plain = {
        ca.OP_EXP: EXP, ca.OP_LOG: LOG, ca.OP_SIN: SINE, ca.OP_COS: COSINE, ca.OP_TANH: TANH,
        ca.OP_ATAN: ATAN, ca.OP_ASIN: ASIN, ca.OP_FABS: ABS, ca.OP_FLOOR: FLOOR,
    }  # fmt: skip
    unity, quarter = Affine({}, 1.0), Affine({}, math.pi / 2.0, ROUNDED)
    names = {getattr(ca, n): n[3:].lower() for n in dir(ca) if n.startswith("OP_")}

    def exponential(a: Affine, sign: float) -> Affine:
        return of_column(builder, EXP, scaled(a, sign))

    known: dict[int, Callable[..., Affine]] = {
        ca.OP_ASSIGN: lambda a: a,
        ca.OP_ADD: added,
        ca.OP_SUB: lambda a, b: added(a, b, -1.0),
        ca.OP_NEG: lambda a: scaled(a, -1.0),
        ca.OP_TWICE: lambda a: scaled(a, 2.0),
        ca.OP_MUL: lambda a, b: multiplied(builder, a, b),
        ca.OP_DIV: lambda a, b: divided(builder, a, b),
        ca.OP_INV: lambda a: divided(builder, unity, a),
        ca.OP_SQ: lambda a: powered(builder, a, 2.0),
        ca.OP_SQRT: lambda a: powered(builder, a, 0.5),
        ca.OP_POW: lambda a, b: raised(builder, a, b),
        ca.OP_CONSTPOW: lambda a, b: raised(builder, a, b),
        ca.OP_TAN: lambda a: divided(
            builder, of_column(builder, SINE, a), of_column(builder, COSINE, a)
        ),
        ca.OP_ACOS: lambda a: added(quarter, of_column(builder, ASIN, a), -1.0),
        ca.OP_SINH: lambda a: scaled(added(exponential(a, 1.0), exponential(a, -1.0), -1.0), 0.5),
        ca.OP_COSH: lambda a: scaled(added(exponential(a, 1.0), exponential(a, -1.0)), 0.5),
        ca.OP_LOG1P: lambda a: of_column(builder, LOG, added(unity, a)),
        ca.OP_EXPM1: lambda a: added(exponential(a, 1.0), unity, -1.0),
        ca.OP_HYPOT: lambda a, b: powered(
            builder, added(powered(builder, a, 2.0), powered(builder, b, 2.0)), 0.5
        ),
        ca.OP_FMAX: lambda a, b: of_two(builder, MAXIMUM, a, b),
        ca.OP_FMIN: lambda a, b: of_two(builder, MINIMUM, a, b),
        ca.OP_CEIL: lambda a: scaled(of_column(builder, FLOOR, scaled(a, -1.0)), -1.0),
    }

    def apply(operation: int, readings: list[Affine]) -> Affine:
        if all(a.fixed and a.doubt == 0.0 for a in readings):
            number = fold(operation, [a.constant for a in readings])
            if number is not None:
                if not np.isfinite(number):
                    raise Refused(f"{names[operation]} of constants, which is no number")
                return Affine({}, float(number))
        if operation in plain:
            return of_column(builder, plain[operation], readings[0])
        if operation not in known:
            raise Refused(f"the operation {names.get(operation, operation)}")
        return known[operation](*readings[: 2 if len(readings) > 1 else 1])

    return apply


def _outputs(problem: Problem, builder: Builder) -> tuple[Affine, list[Affine], list[Affine]]:
    """Readings of the objective, the inequalities and the equalities."""

    def constant(number: float) -> Affine:
        if not math.isfinite(number):
            raise Refused("a constant that is no number")
        return Affine({}, float(number))

    shared = sum(v.size for v in problem.variables)
    objective, start = Affine({}), shared
    inequalities, equalities = list[Affine](), list[Affine]()
    for block in problem.traced().blocks:
        repeat = block.repeat
        for row in range(repeat.count if repeat else 1):
            width = repeat.width if repeat else 0
            inputs = [
                [Affine({j: (1.0, 0.0)}) for j in range(shared)],
                [Affine({start + j: (1.0, 0.0)}) for j in range(width)],
                [constant(v) for v in problem.parameter_values()],
                [constant(v[row]) for v in repeat.data.values()] if repeat else [],
            ]
            f, g, h = walk(block.function, inputs, constant, _reader(builder))
            for value in f:
                objective = added(objective, value)
            inequalities += g
            equalities += h
            start += width
    return objective, inequalities, equalities


def columns(problem: Problem, slack: float = 0.0, logarithms: bool = True) -> Columns:
    """Columns of a problem at its present parameters.

    slack: by which rows may exceed 1. logarithms: with those of positive products and powers.
    SolveError names the operation that has no relaxation, or a text that cannot be traced.
    """
    one_objective(problem.name, problem.rows.objectives)
    builder = Builder(problem.name)
    for variable, _ in problem.columns:
        builder.new(variable.integer and variable.values is None)
    count = builder.width
    try:
        f, g, h = _outputs(problem, builder)
    except Refused as refused:
        raise SolveError(f"{problem.name}: no relaxation of its text is known: {refused}") from None
    aim = builder.column(f)
    limits, equal = [builder.column(a) for a in g], [builder.column(a) for a in h]
    builder.keep([aim, *limits, *equal])
    lower, upper = np.full(builder.width, -np.inf), np.full(builder.width, np.inf)
    lower[:count], upper[:count] = _allowed_ends(problem)
    for j in (*limits, *equal):
        upper[j] = min(upper[j], 1.0 + slack)
    for j in equal:
        lower[j] = max(lower[j], 1.0 - slack)
    first = _assembled(problem, builder, count, lower, upper, aim)
    _check_bases(problem.name, builder, first)
    if (partial := partial_relations(first)).any():
        open_at_zero(problem, builder, partial)
        first = _assembled(problem, builder, count, lower, upper, aim)
    low, high = first.lower.copy(), first.upper.copy()
    if not (logarithms and first.propagated(low, high, ROOT_SWEEPS)):
        return first
    _logarithms(builder, low)
    more = builder.width - len(lower)
    lower = np.concatenate([lower, np.full(more, -np.inf)])
    upper = np.concatenate([upper, np.full(more, np.inf)])
    return _assembled(problem, builder, count, lower, upper, aim)


def _check_bases(name: str, builder: Builder, form: Columns) -> None:
    """Raise SolveError for u^v with u that may be negative: at whole v exp(v log u) is another."""
    doubtful = dict(builder.bases)
    kinds, results, of = form.relations[:, :3].T
    while doubtful:  # without their powers, which may be negative, and logarithms, cut off at 0
        powers = [w for some in doubtful.values() for w in some]
        left_out = (kinds == LOG) & np.isin(of, list(doubtful))
        left_out |= (kinds == EXP) & np.isin(results, powers)
        relations, low, high = form.relations.copy(), form.lower.copy(), form.upper.copy()
        relations[left_out, 0] = LINEAR
        if not replace(form, relations=relations).propagated(low, high, ROOT_SWEEPS):
            return
        if not (positive := [j for j in doubtful if low[j] >= 0.0]):
            refuse(
                name,
                "a variable power of what may be negative; write np.exp(v * np.log(u)) for u**v "
                "where u is positive",
            )
        for j in positive:
            del doubtful[j]


def _logarithms(builder: Builder, low: Array) -> None:
    """Add log w = log u + log v and its like, where all three are positive (Lemma 75)."""

    def logarithm(j: int) -> Affine:
        kind, inner, _ = builder.maker(j)
        return Affine({inner: (1.0, 0.0)}) if kind == EXP else builder.operation(LOG, j)

    for r in range(len(builder.relations)):
        kind, w, u, v = builder.relations[r]
        if kind not in (PRODUCT, QUOTIENT, POWER, ROOT):
            continue
        if not all(low[j] > 0.0 for j in (w, u, v) if j >= 0):
            continue
        of_u = logarithm(u)
        if kind in (POWER, ROOT):
            right = scaled(of_u, builder.exponents[r])
        else:
            right = added(of_u, logarithm(v), 1.0 if kind == PRODUCT else -1.0)
        builder.sum_of(added(right, logarithm(w), -1.0), None)


def _assembled(
    problem: Problem, builder: Builder, count: int, lower: Array, upper: Array, aim: int
) -> Columns:
    """Columns as arrays; whole and listed variables within their allowed ends."""
    lower, upper, listed = lower.copy(), upper.copy(), list[float]()
    sort = np.where(builder.whole, WHOLE, CONTINUOUS).astype(np.int64)
    first, last = np.zeros(builder.width, np.int64), np.zeros(builder.width, np.int64)
    for j, (variable, _) in enumerate(problem.columns):  # a row may limit a variable itself
        if variable.values is not None:
            values = allowed_values(problem, j)
            sort[j], first[j], last[j] = LISTED, len(listed), len(listed) + len(values)
            listed += values
            inside = [v for v in values if lower[j] <= v <= upper[j]] or [np.inf, -np.inf]
            lower[j], upper[j] = inside[0], inside[-1]
        elif variable.integer:
            lower[j], upper[j] = np.ceil(lower[j]), np.floor(upper[j])
    start, terms = [0], list[tuple[int, tuple[float, float]]]()
    for r in range(len(builder.relations)):
        terms += builder.sums[r].terms.items() if r in builder.sums else []
        start.append(len(terms))
    none = Affine({})
    kept = [builder.sums.get(r, none) for r in range(len(builder.relations))]
    sums = (
        np.array(start, np.int64),
        np.array([j for j, _ in terms], np.int64),
        np.array([f for _, (f, _) in terms], float),
        np.array([e for _, (_, e) in terms], float),
        np.array([a.constant for a in kept], float),
        np.array([a.doubt for a in kept], float),
    )
    columns = Columns(
        count,
        np.array(builder.relations, np.int64).reshape(-1, 4),
        np.array(builder.exponents, float),
        sums,
        (sort, first, last, np.array(listed, float)),
        lower,
        upper,
        aim,
        _below(builder, count),
        bool((lower > upper).any()),
    )
    return columns


def _allowed_ends(problem: Problem) -> tuple[Array, Array]:
    """Least and greatest values (n,) of the variables; a discrete one may be a rounding outside."""
    lower, upper = (bound.copy() for bound in problem.bounds()[:2])
    for j, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            values = allowed_values(problem, j)
            lower[j], upper[j] = values[0], values[-1]
        elif variable.integer:
            least, greatest = whole_ends(problem, j)
            lower[j] = max(least, np.ceil(lower[j] - 0.25))  # not by a part of a large number
            upper[j] = min(greatest, np.floor(upper[j] + 0.25))
    return lower, upper


def _below(builder: Builder, count: int) -> Any:
    below = np.zeros((builder.width, count), bool)
    below[np.arange(count), np.arange(count)] = True
    for r, (kind, w, u, v) in enumerate(builder.relations):
        if w < 0:
            continue
        arguments = [u, v] if kind != LINEAR else [j for j in builder.sums[r].terms if j != w]
        for j in arguments:
            if j >= 0:
                below[w] |= below[j]
    return below
