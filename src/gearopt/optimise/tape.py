"""A problem's text traced by casadi, and which of its terms are, provably, log-convex.

One tape for the problem, one mapped tape a repeat. A term is `CONSTANT`, `MONOMIAL` (log-affine),
`POSYNOMIAL` (here in the wide sense: built from monomials by sums, products, positive powers and
maxima, hence log-convex) or `OTHER`. The rules are those of disciplined geometric programming
(Agrawal, Diamond, Boyd, 2019). Parameters and data are constants: the proof holds at their present
values.
"""

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.deadline import allowed, within
from gearopt.optimise.evaluation import blaming, called, quiet, remedy, sample, seconds, text_of
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import SECTIONS, Array, Repeat, Terms, Var, checked, flat, flatten

_NUMPY_MODE = threading.Lock()
POINTS = 4  # at which a tape is held against the text: the guess and random ones
AGREEMENT = 1e-6  # of the largest value of a term; what casadi does otherwise than numpy is gross


@dataclass(frozen=True)
class Block:
    """The tape of one text: function(shared x, own x, p, data) -> f, g, h as scalars columns."""

    function: Any
    objectives: tuple[str, ...]
    repeat: Repeat | None


@dataclass(frozen=True)
class Traced:
    """terms(x, p) -> f, g, h (casadi Function; limits, defines and equal as quotients to 1).

    blocks: the SX tapes behind it, the problem's own text first, for `tape.py`.
    """

    terms: Any
    blocks: tuple[Block, ...]


@contextmanager
def legacy_numpy() -> Iterator[None]:
    """Let numpy functions on casadi scalars give casadi scalars (a process-wide casadi switch)."""
    import casadi as ca

    with _NUMPY_MODE:
        before = ca.GlobalOptions.getNumpyMode()
        try:
            ca.GlobalOptions.setNumpyMode(-1)
            yield
        finally:
            ca.GlobalOptions.setNumpyMode(before)


def trace(problem: Problem) -> Traced:
    """Run the texts once on casadi scalars; SolveError names a text that casadi cannot run.

    The tapes are held against the text on floats: `math` functions, for one, make NaN of a symbol.
    """
    import casadi as ca

    rows = problem.rows
    with legacy_numpy():
        blocks = [_block(problem, None)] + [_block(problem, r) for r in problem.repeats]
    shared = sum(v.size for v in problem.variables)
    total = shared + sum(r.count * r.width for r in problem.repeats)
    kind = ca.MX if problem.repeats else ca.SX
    x = kind.sym("x", total)
    p = kind.sym("p", len(problem.parameter_values()))
    empty = kind(0, 1)
    f, g, h = blocks[0].function(x[:shared], empty, p, empty)
    objective = dict.fromkeys(rows.objectives, 0)
    objective |= zip(blocks[0].objectives, ca.vertsplit(f) if f.numel() else [], strict=True)
    rows_g, rows_h = [g], [h]
    start = shared
    for r, block in zip(problem.repeats, blocks[1:], strict=True):
        stop = start + r.count * r.width
        repeated = ca.reshape(x[start:stop], r.width, r.count)
        data = ca.DM(np.array([np.asarray(v, float) for v in r.data.values()]))
        mapped = block.function.map(f"{r.name}_rows", "serial", r.count, [0, 2], [])
        f, g, h = mapped(x[:shared], repeated, p, data)
        for name, value in zip(block.objectives, ca.vertsplit(ca.sum2(f)), strict=True):
            objective[name] = objective[name] + value
        rows_g.append(ca.vec(g))
        rows_h.append(ca.vec(h))
        start = stop
    outputs = [ca.vertcat(*objective.values()), ca.vertcat(*rows_g), ca.vertcat(*rows_h)]
    terms = ca.Function("terms", [x, p], outputs, ["x", "p"], ["f", "g", "h"])
    _compare(problem, terms)
    return Traced(terms, tuple(blocks))


def _compare(problem: Problem, terms: Any) -> None:
    """Raise SolveError for a term whose tape differs from the text on floats."""
    points, p = sample(problem, POINTS), problem.parameter_values()
    batch, rows = problem.batch(points), problem.rows
    ours = np.hstack([batch.F, batch.G, batch.H])
    tape = np.array([np.concatenate([np.array(v).ravel() for v in terms(x, p)]) for x in points])
    known = np.isfinite(ours)
    size = np.where(known, np.abs(ours), 0.0).max(axis=0)
    size[len(rows.objectives) :] += 1e-3  # the unit of a row is 1: what is less is rounding
    with np.errstate(invalid="ignore"):
        apart = known & ~(np.abs(tape - ours) <= AGREEMENT * size)
    if not apart.any():
        return
    k = int(np.argmax(apart.any(axis=0)))
    at = int(np.argmax(apart[:, k]))
    names = [*rows.objectives, *(r.name for r in rows.inequalities), *rows.equalities]
    raise SolveError(
        f"the text of {problem.name} cannot be traced: {names[k]} is {ours[at, k]:.6g} on numbers, "
        f"but {tape[at, k]:.6g} on symbols. {remedy(None)}"
    )


def _block(problem: Problem, repeat: Repeat | None) -> Block:
    import casadi as ca

    shared = ca.SX.sym("x", sum(v.size for v in problem.variables))
    p = ca.SX.sym("p", len(problem.parameter_values()))
    repeated = ca.SX.sym("own", repeat.width if repeat else 0)
    data = ca.SX.sym("data", len(repeat.data) if repeat else 0)
    text, where = text_of(problem, repeat)
    scalars = [ca.vertsplit(v) if v.numel() else [] for v in (shared, repeated, p, data)]
    row = dict(zip(repeat.data, scalars[3], strict=True)) if repeat else {}
    try:
        limit = allowed(seconds(problem, repeat))
        with blaming(text, where, "traced"), quiet(), within(limit):
            terms = called(problem, repeat, scalars[0], scalars[1], row, scalars[2])
            terms = checked(_split(terms), where)
            f, g, h = _columns(terms)
    except SolveError as refused:
        if refused.__cause__ is None:
            raise
        raise SolveError(f"{refused}. {remedy(refused.__cause__)}") from refused.__cause__
    names = {part: [n for n, _ in flat(getattr(terms, part))] for part in SECTIONS}
    if names != problem.names(repeat):
        raise SolveError(f"the text of {where} cannot be traced: it returns other names on symbols")
    return Block(
        ca.Function("block", [shared, repeated, p, data], [f, g, h]), tuple(terms.minimise), repeat
    )


def _split(terms: Any) -> Any:
    """Columns of symbols, which arrays become, as tuples."""
    import casadi as ca

    def tuples(block: Any) -> Any:
        if not isinstance(block, Mapping):
            return block
        wide = {n: v for n, v in block.items() if isinstance(v, ca.SX) and v.numel() > 1}
        return {**block, **{n: tuple(ca.vertsplit(ca.vec(v))) for n, v in wide.items()}}

    if not isinstance(terms, Terms):
        return terms
    return Terms(**{part: tuples(getattr(terms, part)) for part in SECTIONS})


def _columns(terms: Terms) -> tuple[Any, Any, Any]:
    import casadi as ca

    inequal, equal = flatten(terms)
    f, g, h = (ca.vertcat(ca.SX(0, 1), *c) for c in (terms.minimise.values(), inequal, equal))
    return f, g, h


class Compiled:
    """Call f, g, h of one point without casadi's call overhead; keeps its buffers, so has state.

    compiled(x) -> (f, g, h): views that the next call overwrites; limits and equal as quotients.
    """

    def __init__(self, problem: Problem) -> None:
        function = problem.traced().terms
        self._x = np.zeros(function.size1_in(0))
        self._p = problem.parameter_values()
        self._out = tuple(np.zeros(function.size1_out(k)) for k in range(3))
        self._buffer, self._run = function.buffer()
        self._buffer.set_arg(0, self._x.data)
        self._buffer.set_arg(1, self._p.data)
        for k, out in enumerate(self._out):
            self._buffer.set_res(k, out.data)

    def __call__(self, point: Array) -> tuple[Array, Array, Array]:
        """Return f, g, h of one point."""
        self._x[:] = point
        self._run()
        return self._out  # type: ignore[return-value]


CONSTANT, MONOMIAL, POSYNOMIAL, OTHER = range(4)


@dataclass(frozen=True)
class Kinds:
    """Kind of the objective and of every inequality and equality row, in the problem's order."""

    objective: int
    inequalities: tuple[int, ...]
    equalities: tuple[int, ...]

    @property
    def log_convex(self) -> bool:
        """Return whether a problem of these kinds (not degrees) is convex in logarithms."""
        rows = max((self.objective, *self.inequalities))
        return rows <= POSYNOMIAL and max(self.equalities, default=0) <= MONOMIAL


@dataclass(frozen=True)
class Term:
    """The kind of a term; value: of a constant, a float or an array over the rows of a repeat."""

    kind: int
    value: Any = None

    @property
    def positive(self) -> bool:
        """Return whether the term is known to be > 0."""
        if self.kind == CONSTANT:
            return bool(np.all(self.value > 0))
        return self.kind != OTHER


_UNKNOWN = Term(OTHER)


def kinds(problem: Problem) -> Kinds:
    """Return which terms are log-convex, read at the present parameter values, once for each."""
    key = _key(problem)
    if key not in problem.memo:
        problem.memo[key] = _kinds(problem, lambda v: Term(MONOMIAL) if v.log else _UNKNOWN)
    term_kinds: Kinds = problem.memo[key]
    return term_kinds


def _key(problem: Problem) -> Any:
    return "kinds", problem.parameter_values().tobytes()


def same_kinds(problem: Problem, other: Problem) -> None:
    """Let a problem that differs in positive factors of its rows alone have the kinds of another.

    Both share what was built (`Problem.at`); nothing happens where the other's are not known yet.
    """
    if (known := problem.memo.get(_key(other))) is not None:
        problem.memo[_key(problem)] = known


def log_convex_in_logarithms(problem: Problem) -> bool:
    """Return whether the terms of a problem were log-convex if all its variables were log."""
    return _kinds(problem, lambda v: Term(MONOMIAL)).log_convex


def _kinds(problem: Problem, variable: Callable[[Var], Term]) -> Kinds:
    objective, inequalities, equalities = (
        # a row is used through its logarithm, so a constant counts only when positive
        [term.kind if term.positive else OTHER for term in terms]
        for terms in read(problem, variable, _apply)
    )
    total = max(objective)
    if len(objective) > 1 and total == MONOMIAL:
        total = POSYNOMIAL  # a sum over blocks
    return Kinds(total, tuple(inequalities), tuple(equalities))


def read(
    problem: Problem,
    variable: Callable[[Var], Term],
    apply: Callable[[int, list[Term]], Term],
) -> tuple[list[Term], list[Term], list[Term]]:
    """Readings of the objectives of all blocks, and of all rows of f, g and h.

    variable(v): its reading of a component of v; apply: see `walk`.
    """
    readings: tuple[list[Term], list[Term], list[Term]] = ([], [], [])
    for block in problem.traced().blocks:
        repeat = block.repeat
        repeated, data = (repeat.variables, repeat.data.values()) if repeat else ((), ())
        inputs = [
            *(
                [variable(v) for v in some for _ in range(v.size)]
                for some in (problem.variables, repeated)
            ),
            [Term(CONSTANT, float(v)) for v in problem.parameter_values()],
            [Term(CONSTANT, np.asarray(v, float)) for v in data],
        ]
        terms = walk(block.function, inputs, lambda value: Term(CONSTANT, value), apply)
        for part, more, times in zip(
            readings, terms, (1, *2 * [repeat.count if repeat else 1]), strict=True
        ):
            part += more * times
    return readings


def walk(function: Any, inputs: list[list[Any]], constant: Any, apply: Any) -> list[list[Any]]:
    """Run a reader over a tape; return its reading of every scalar of every output.

    inputs: one reading of every scalar of every input; constant(value) reads a number and
    apply(operation, readings) an operation.
    """
    import casadi as ca

    work: list[Any] = [None] * function.sz_w()
    readings = [[constant(0.0)] * function.size1_out(k) for k in range(function.n_out())]
    with np.errstate(all="ignore"):
        for k in range(function.n_instructions()):
            operation = function.instruction_id(k)
            source, target = function.instruction_input(k), function.instruction_output(k)
            if operation == ca.OP_INPUT:
                work[target[0]] = inputs[source[0]][source[1]]
            elif operation == ca.OP_CONST:
                work[target[0]] = constant(function.instruction_constant(k))
            elif operation == ca.OP_OUTPUT:
                readings[target[0]][target[1]] = work[source[0]]
            else:
                work[target[0]] = apply(operation, [work[s] for s in source])
    return readings


def _apply(operation: int, terms: list[Term]) -> Term:
    """Return the kind of `operation(terms)`."""
    import casadi as ca

    if all(t.kind == CONSTANT for t in terms):
        value = fold(operation, [t.value for t in terms])
        return _UNKNOWN if value is None else Term(CONSTANT, value)
    first, last = terms[0], terms[-1]
    if operation in (ca.OP_CONSTPOW, ca.OP_POW):
        return _power(first, last)
    if operation == ca.OP_ADD and any(t.kind == CONSTANT and np.all(t.value == 0) for t in terms):
        return first if last.kind == CONSTANT else last
    if not all(t.positive for t in terms):
        return _UNKNOWN
    if operation in (ca.OP_ADD, ca.OP_FMAX):
        return Term(POSYNOMIAL)
    if operation == ca.OP_MUL:
        return Term(max(MONOMIAL, first.kind, last.kind))
    if operation == ca.OP_DIV:
        return Term(max(MONOMIAL, first.kind)) if last.kind <= MONOMIAL else _UNKNOWN
    if operation == ca.OP_INV:
        return Term(MONOMIAL) if first.kind <= MONOMIAL else _UNKNOWN
    if operation in (ca.OP_SQ, ca.OP_SQRT, ca.OP_TWICE, ca.OP_ASSIGN, ca.OP_FABS):
        return Term(max(MONOMIAL, first.kind))
    return _UNKNOWN


def _power(base: Term, exponent: Term) -> Term:
    if exponent.kind != CONSTANT or not base.positive:
        return _UNKNOWN
    if base.kind == POSYNOMIAL and not np.all(exponent.value > 0):
        return _UNKNOWN
    return Term(max(MONOMIAL, base.kind))


def fold(operation: int, values: list[Any]) -> Any:
    """Value of an operation on numbers; None where this reader does not know it."""
    known = _folds().get(operation)
    return known(*values) if known else None


@cache
def _folds() -> dict[int, Any]:
    """Return how casadi's operations act on numbers."""
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
