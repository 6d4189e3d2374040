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
    """Return the problem of the least relaxation: minimise the product of the factors.

    Variable `relaxation`: a factor >= 1 for each group, shared by its handles and within the reach
    of all of them; a handle in several groups moves by the product of their factors, limits in no
    group stay as they are. The objective is left out. SolveError for discrete variables.
    """
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"limits are relaxed in continuous problems; {name} is discrete")
    owners: dict[tuple[str, int], list[int]] = {}
    for k, group in enumerate(groups):
        for h in group:
            owners.setdefault((h.kind, h.place), []).append(k)
    reach = tuple(min(h.reach for h in group) for group in groups)
    factor = Var("relaxation", "", 1.0, reach, 1.0, len(groups), log=True)
    direction = {(h.kind, h.place): h.direction for group in groups for h in group}
    rows = {h.name: (h.kind, h.place) for group in groups for h in group if h.kind == ROW}

    def parts(x: Any) -> tuple[Any, ...]:
        return x.relaxation if isinstance(x.relaxation, tuple) else (x.relaxation,)

    def factors(x: Any) -> dict[tuple[str, int], Any]:
        """Return the factor of every handle."""
        found = {}
        for which, own in owners.items():
            found[which] = parts(x)[own[0]]
            for k in own[1:]:
                found[which] = found[which] * parts(x)[k]
        return found

    def parameters(x: Any, p: Any) -> Any:
        scalars = [s for q in problem.parameters for s in _tuple(getattr(p, q.name))]
        for (kind, place), f in factors(x).items():
            if kind == PARAM:
                scalars[place] = scalars[place] * f ** direction[kind, place]
        return namespace(problem.parameters, scalars)

    def hardened(x: Any, terms: Terms, prefix: str = "") -> dict[str, Any]:
        """Return all inequality rows, those with a factor of their own divided by it."""
        own, found = factors(x), {}
        for name, value in flat(terms.limits) + flat(terms.defines):
            which = rows.get(prefix + name)
            found[name] = value if which is None else value / own[which]
        return found

    def evaluate(x: Any, p: Any) -> Terms:
        terms = problem.evaluate(x, parameters(x, p))
        product: Any = 1.0
        for f in parts(x):
            product = product * f
        bounds = _bound_rows(problem, factors(x), x)
        return Terms({"relaxation": product}, hardened(x, terms), defines=bounds, equal=terms.equal)

    def repeated(r: Repeat) -> Callable[[Any, Any, Any], Terms]:
        def text(x: Any, p: Any, row: Any) -> Terms:
            terms = r.evaluate(x, parameters(x, p), row)
            return Terms({}, hardened(x, terms, f"{r.name}."), equal=terms.equal)

        return text

    return Problem(
        f"{problem.name}, relaxed",
        (*_wider(problem, list(owners)), factor),
        problem.parameters,
        evaluate,
        tuple(replace(r, evaluate=repeated(r)) for r in problem.repeats),
    )


def _tuple(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def _bound_rows(problem: Problem, factors: dict[tuple[str, int], Any], x: Any) -> dict[str, Any]:
    """Return bounds that may move, as rows <= 1."""
    lower, upper, _ = problem.bounds()
    flat_x = [s for v in problem.variables for s in _tuple(getattr(x, v.name))]
    found = {}
    for (kind, k), factor in factors.items():
        if kind not in (LOWER, UPPER):
            continue
        value = float(lower[k] if kind == LOWER else upper[k])
        here = flat_x[k]
        name = f"{problem.columns[k][1]} {kind}"
        if value > 0:
            found[name] = value / (here * factor) if kind == LOWER else here / (value * factor)
        else:
            excess = value - here if kind == LOWER else here - value
            found[name] = (1.0 + excess / scale(value)) / factor
    return found


def _wider(problem: Problem, movable: Sequence[tuple[str, int]]) -> tuple[Var, ...]:
    """Return the variables, with room where their bounds may move."""
    lower, upper, _ = (a.copy() for a in problem.bounds())
    for kind, k in movable:
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
