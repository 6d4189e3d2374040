"""A problem's text traced by casadi: one tape for the problem, one mapped tape a repeat."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Repeat, Terms, flatten, namespace

_NUMPY_MODE = threading.Lock()


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
    """Run the texts once on casadi scalars; SolveError names a text that casadi cannot run."""
    import casadi as ca

    with legacy_numpy():
        blocks = [_block(problem, None)] + [_block(problem, r) for r in problem.repeats]
    shared = sum(v.size for v in problem.variables)
    total = shared + sum(r.count * r.width for r in problem.repeats)
    kind = ca.MX if problem.repeats else ca.SX
    x = kind.sym("x", total)
    p = kind.sym("p", len(problem.parameter_values()))
    empty = kind(0, 1)
    f, g, h = blocks[0].function(x[:shared], empty, p, empty)
    objective = dict(zip(blocks[0].objectives, ca.vertsplit(f) if f.numel() else [], strict=True))
    rows_g, rows_h = [g], [h]
    start = shared
    for r, block in zip(problem.repeats, blocks[1:], strict=True):
        stop = start + r.count * r.width
        own = ca.reshape(x[start:stop], r.width, r.count)
        data = ca.DM(np.array([np.asarray(v, float) for v in r.data.values()]))
        mapped = block.function.map(f"{r.name}_rows", "serial", r.count, [0, 2], [])
        f, g, h = mapped(x[:shared], own, p, data)
        for name, value in zip(block.objectives, ca.vertsplit(ca.sum2(f)), strict=True):
            objective[name] = objective.get(name, 0) + value
        rows_g.append(ca.vec(g))
        rows_h.append(ca.vec(h))
        start = stop
    outputs = [ca.vertcat(*objective.values()), ca.vertcat(*rows_g), ca.vertcat(*rows_h)]
    terms = ca.Function("terms", [x, p], outputs, ["x", "p"], ["f", "g", "h"])
    return Traced(terms, tuple(blocks))


def _block(problem: Problem, repeat: Repeat | None) -> Block:
    import casadi as ca

    shared = ca.SX.sym("x", sum(v.size for v in problem.variables))
    p = ca.SX.sym("p", len(problem.parameter_values()))
    own = ca.SX.sym("own", repeat.width if repeat else 0)
    data = ca.SX.sym("data", len(repeat.data) if repeat else 0)
    x = namespace(problem.variables, ca.vertsplit(shared) if shared.numel() else [])
    values = namespace(problem.parameters, ca.vertsplit(p) if p.numel() else [])
    where = f"{problem.name}.{repeat.name}" if repeat else problem.name
    try:
        if repeat is None:
            terms = problem.evaluate(x, values)
        else:
            x.__dict__.update(vars(namespace(repeat.variables, ca.vertsplit(own))))
            row = dict(zip(repeat.data, ca.vertsplit(data), strict=True))
            terms = repeat.evaluate(x, values, SimpleNamespace(**row))
        f, g, h = _columns(terms)
    except (TypeError, AttributeError, NotImplementedError, RuntimeError) as broken:
        raise SolveError(
            f"the text of {where} cannot be traced: {broken}. Use scalars, operators and the numpy "
            "functions casadi knows; no `if` on a quantity"
        ) from broken
    return Block(
        ca.Function("block", [shared, own, p, data], [f, g, h]), tuple(terms.minimise), repeat
    )


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
