"""A problem's text traced by casadi: one tape for the problem, one mapped tape a repeat."""

import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.blame import blaming, quiet, remedy
from gearopt.optimise.evaluation import called, sample, text_of
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import SECTIONS, Array, Repeat, Terms, checked, flat, flatten

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
        own = ca.reshape(x[start:stop], r.width, r.count)
        data = ca.DM(np.array([np.asarray(v, float) for v in r.data.values()]))
        mapped = block.function.map(f"{r.name}_rows", "serial", r.count, [0, 2], [])
        f, g, h = mapped(x[:shared], own, p, data)
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
    """SolveError names a term whose tape is not what the text gives on floats."""
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
    own = ca.SX.sym("own", repeat.width if repeat else 0)
    data = ca.SX.sym("data", len(repeat.data) if repeat else 0)
    text, where = text_of(problem, repeat)
    scalars = [ca.vertsplit(v) if v.numel() else [] for v in (shared, own, p, data)]
    row = dict(zip(repeat.data, scalars[3], strict=True)) if repeat else {}
    try:
        with blaming(text, where, "traced"), quiet():
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
        ca.Function("block", [shared, own, p, data], [f, g, h]), tuple(terms.minimise), repeat
    )


def _split(terms: Any) -> Any:
    """Columns of symbols, which are what arrays become, as tuples."""
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
        """f, g, h of one point."""
        self._x[:] = point
        self._run()
        return self._out  # type: ignore[return-value]
