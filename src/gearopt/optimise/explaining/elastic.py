"""The elastic form of a problem: its limits may be relaxed by factors, and the factors cost.

Everything stays in the contract, so a repair is solved and proven like any other problem: where the
problem is convex in logarithms, its elastic form is too.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.optimise.explaining.handles import LOWER, PARAM, REACH, ROW, UPPER, Handle, scale
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Repeat, Terms, Var, flat, namespace


def elastic(problem: Problem, groups: Sequence[Sequence[Handle]]) -> Problem:
    """The problem of the least relaxation: minimise the product of the factors.

    Variable `relaxation`: a factor >= 1 for each group, shared by its handles and within the reach
    of all of them; limits in no group stay as they are. The objective is left out. SolveError for
    discrete variables.
    """
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"limits are relaxed in continuous problems; {name} is discrete")
    owner = {(h.kind, h.place): k for k, group in enumerate(groups) for h in group}
    reach = tuple(min(h.reach for h in group) for group in groups)
    factor = Var("relaxation", "", 1.0, reach, 1.0, len(groups), log=True)
    direction = {(h.kind, h.place): h.direction for group in groups for h in group}
    rows = {h.name: k for k, group in enumerate(groups) for h in group if h.kind == ROW}

    def parts(x: Any) -> tuple[Any, ...]:
        return x.relaxation if isinstance(x.relaxation, tuple) else (x.relaxation,)

    def parameters(x: Any, p: Any) -> Any:
        scalars = [s for q in problem.parameters for s in _tuple(getattr(p, q.name))]
        for (kind, place), k in owner.items():
            if kind == PARAM:
                scalars[place] = scalars[place] * parts(x)[k] ** direction[kind, place]
        return namespace(problem.parameters, scalars)

    def hardened(x: Any, terms: Terms, prefix: str = "") -> dict[str, Any]:
        """All inequality rows, those with a factor of their own divided by it."""
        factors = parts(x)
        found = {}
        for name, value in flat(terms.limits) + flat(terms.defines):
            k = rows.get(prefix + name)
            found[name] = value if k is None else value / factors[k]
        return found

    def evaluate(x: Any, p: Any) -> Terms:
        terms = problem.evaluate(x, parameters(x, p))
        product: Any = 1.0
        for f in parts(x):
            product = product * f
        bounds = _bound_rows(problem, owner, x, parts(x))
        return Terms({"relaxation": product}, hardened(x, terms), defines=bounds, equal=terms.equal)

    def repeated(r: Repeat) -> Callable[[Any, Any, Any], Terms]:
        def text(x: Any, p: Any, row: Any) -> Terms:
            terms = r.evaluate(x, parameters(x, p), row)
            return Terms({}, hardened(x, terms, f"{r.name}."), equal=terms.equal)

        return text

    return Problem(
        f"{problem.name}, relaxed",
        (*_wider(problem, owner), factor),
        problem.parameters,
        evaluate,
        tuple(replace(r, evaluate=repeated(r)) for r in problem.repeats),
    )


def _tuple(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def _bound_rows(
    problem: Problem, owner: dict[tuple[str, int], int], x: Any, factors: tuple[Any, ...]
) -> dict[str, Any]:
    """Bounds that may move, as rows <= 1."""
    lower, upper, _ = problem.bounds()
    flat_x = [s for v in problem.variables for s in _tuple(getattr(x, v.name))]
    found = {}
    for (kind, k), group in owner.items():
        if kind not in (LOWER, UPPER):
            continue
        value = float(lower[k] if kind == LOWER else upper[k])
        here, factor = flat_x[k], factors[group]
        name = f"{problem.columns[k][1]} {kind}"
        if value > 0:
            found[name] = value / (here * factor) if kind == LOWER else here / (value * factor)
        else:
            excess = value - here if kind == LOWER else here - value
            found[name] = (1.0 + excess / scale(value)) / factor
    return found


def _wider(problem: Problem, owner: dict[tuple[str, int], int]) -> tuple[Var, ...]:
    """The variables, with room where their bounds may move."""
    lower, upper, _ = (a.copy() for a in problem.bounds())
    for kind, k in owner:
        if kind == LOWER:
            value = lower[k]
            lower[k] = value / REACH if value > 0 else value - REACH * scale(value)
        if kind == UPPER:
            value = upper[k]
            upper[k] = value * REACH if value > 0 else value + REACH * scale(value)
    found = []
    start = 0
    for v in problem.variables:
        part = slice(start, start + v.size)
        ends = (tuple(map(float, a[part])) for a in (lower, upper))
        found.append(replace(v, lower=next(ends), upper=next(ends)))
        start += v.size
    return tuple(found)
