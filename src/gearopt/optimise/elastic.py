"""The elastic form of a problem: its limits may be relaxed by factors, and the factors cost.

A limit is relaxed where the user wrote it: in its parameter (so that a safety factor that enters
squared is answered by the number to write), in a bound of a variable, and only where neither exists
in the row itself. Everything stays in the contract, so a repair is solved and proven like any
other problem: where the problem is convex in logarithms, its elastic form is too.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Repeat, Terms, Var, flat, namespace, spread

REACH = 1e6  # the largest factor by which a limit may be relaxed; finite, for the dual bound
PARAM, ROW, LOWER, UPPER = "parameter", "row", "lower bound", "upper bound"


@dataclass(frozen=True)
class Handle:
    """One number of the user that may be relaxed.

    name: of the limit as reported. kind: parameter, row, lower bound or upper bound; place: its
    index among parameter values, inequality rows or columns. value, unit, key: what stands there
    now. direction: +1 where a larger value is easier, -1 where a smaller one is. rows: names of
    the rows it governs. given: a value that the user fixed, no limit. reach: the largest factor by
    which it may move. whole: it is written as an integer.
    """

    name: str
    kind: str
    place: int
    value: float
    direction: int
    unit: str = ""
    key: str = ""
    rows: tuple[str, ...] = ()
    given: bool = False
    reach: float = REACH
    whole: bool = False

    @property
    def family(self) -> str:
        """What the limits of all stages or components have in common: the name before [k]."""
        return self.name.split("[")[0]

    def relaxed(self, factor: float) -> float:
        """The value to write for a factor >= 1."""
        if self.kind in (LOWER, UPPER) and self.value <= 0:
            return self.value + self.direction * (factor - 1.0) * _scale(self.value)
        return self.value * factor**self.direction

    def eased(self, factor: float) -> float:
        """The factor that is asked for a needed one: of a whole number, that of the next easier."""
        if not self.whole:
            return factor
        number = self.relaxed(factor)
        near = round(number)
        if abs(number - near) > 1e-6 * abs(number):
            near = math.ceil(number) if self.direction > 0 else math.floor(number)
        return float((near / self.value) ** self.direction)

    def one_back(self, factor: float) -> float:
        """The factor of the next harder whole number."""
        return float(
            ((round(self.relaxed(factor)) - self.direction) / self.value) ** self.direction
        )


def handles(problem: Problem) -> tuple[Handle, ...]:
    """Every number that a repair may move: limits first, then values that are given."""
    found, governed = _parameters(problem)
    for k, row in enumerate(problem.rows.inequalities):
        if row.kind == "limits" and k not in governed:
            found.append(Handle(row.name, ROW, k, 1.0, 1, rows=(row.name,)))
    found += _bounds(problem)
    return tuple(sorted(found, key=lambda h: h.given))


def _parameters(problem: Problem) -> tuple[list[Handle], set[int]]:
    """Parameters that may move, and the rows they govern."""
    slopes, elsewhere = _slopes(problem)
    rows = problem.rows.inequalities
    found: list[Handle] = []
    governed: set[int] = set()
    start = 0
    for parameter in problem.parameters:
        roles = np.broadcast_to(np.asarray(parameter.role), (parameter.size,))
        values = spread(parameter.value, parameter.size)
        for k, (role, value) in enumerate(zip(roles, values, strict=True)):
            place = start + k
            touched = np.flatnonzero(slopes[:, place])
            signs = {int(s) for s in np.sign(slopes[touched, place])}
            only = all(rows[r].kind == "limits" for r in touched) and not elsewhere[place]
            movable = only and len(signs) == 1 and value > 0 and math.isfinite(value)
            if role == "data" or not movable:
                continue
            names = tuple(rows[r].name for r in touched)
            label = parameter.name if parameter.size == 1 else f"{parameter.name}[{k + 1}]"
            name = names[0] if len(names) == 1 else label
            sign = -signs.pop()
            found.append(
                Handle(
                    name,
                    PARAM,
                    place,
                    value,
                    sign,
                    parameter.unit,
                    parameter.key,
                    names,
                    role == "given",
                )
            )
            governed |= set(touched.tolist())
        start += parameter.size
    return found, governed


def _slopes(problem: Problem) -> tuple[Array, Array]:
    """D rows/d parameters at the guess, and which parameters act on objective or equalities."""
    import casadi as ca

    x, p, (f, g, h) = _symbols(problem)
    inside = ca.Function("slopes", [x, p], [ca.jacobian(g, p)])
    slopes = np.array(inside(problem.bounds()[2], problem.parameter_values()), float)
    other = ca.which_depends(ca.vertcat(f, h), p, 1, False) if p.numel() else []
    shaped = slopes.reshape(g.numel(), p.numel())
    return np.nan_to_num(shaped), np.array(other, bool)


def effective(problem: Problem) -> Array:
    """Which parameter components (np,) the text uses at all."""
    import casadi as ca

    x, p, outputs = _symbols(problem)
    used = ca.which_depends(ca.vertcat(*outputs), p, 1, False) if p.numel() else []
    return np.array(used, bool)


def _symbols(problem: Problem) -> tuple[Any, Any, Any]:
    """Symbols of point and parameters, and the terms f, g, h of them."""
    terms = problem.traced().terms
    x, p = terms.sx_in() if terms.is_a("SXFunction") else terms.mx_in()
    return x, p, terms(x, p)


def _bounds(problem: Problem) -> list[Handle]:
    """Bounds that the user wrote, and values that are given by equal ones."""
    import casadi as ca

    lower, upper, _ = problem.bounds()
    x, _, outputs = _symbols(problem)
    used = ca.which_depends(ca.vertcat(*outputs), x, 1, False)
    found = []
    for k, (variable, name) in enumerate(problem.columns):
        given = lower[k] == upper[k]
        if not used[k] or (variable.search and not given):
            continue
        for kind, value, sign in ((LOWER, lower[k], -1), (UPPER, upper[k], 1)):
            if math.isfinite(value):
                word = name if given else f"{name} {kind.split()[0]}"
                found.append(Handle(word, kind, k, float(value), sign, variable.unit, given=given))
    return found


def elastic(problem: Problem, groups: Sequence[Sequence[Handle]]) -> Problem:
    """The problem of the least relaxation: minimise the product of the factors.

    Variable `relaxation`: a factor >= 1 for each group, shared by its handles and within the reach
    of all of them; limits in no group stay as they are. The objective is left out. SolveError for
    discrete variables and for bounds of a repeat's own variables.
    """
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"limits are relaxed in continuous problems; {name} is discrete")
    shared = sum(v.size for v in problem.variables)
    owner = {(h.kind, h.place): k for k, group in enumerate(groups) for h in group}
    if any(kind in (LOWER, UPPER) and place >= shared for kind, place in owner):
        raise SolveError("bounds of variables within a repeat cannot be relaxed")
    reach = tuple(min(h.reach for h in group) for group in groups)
    factor = Var("relaxation", "", 1.0, reach, 1.0, len(groups), log=True)
    names = [row.name for row in problem.rows.inequalities]
    direction = {(h.kind, h.place): h.direction for group in groups for h in group}
    rows = {names[place]: k for (kind, place), k in owner.items() if kind == ROW}

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
            k = _owner(rows, prefix + name)
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


def _owner(rows: dict[str, int], name: str) -> int | None:
    """The factor of a row; rows of a repeat share that of their first."""
    return rows.get(name, rows.get(f"{name}[1]"))


def _scale(value: float) -> float:
    return max(abs(value), 1.0)


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
            found[name] = (1.0 + excess / _scale(value)) / factor
    return found


def _wider(problem: Problem, owner: dict[tuple[str, int], int]) -> tuple[Var, ...]:
    """The variables, with room where their bounds may move."""
    lower, upper, _ = (a.copy() for a in problem.bounds())
    for kind, k in owner:
        if kind == LOWER:
            value = lower[k]
            lower[k] = value / REACH if value > 0 else value - REACH * _scale(value)
        if kind == UPPER:
            value = upper[k]
            upper[k] = value * REACH if value > 0 else value + REACH * _scale(value)
    found = []
    start = 0
    for v in problem.variables:
        part = slice(start, start + v.size)
        ends = (tuple(map(float, a[part])) for a in (lower, upper))
        found.append(replace(v, lower=next(ends), upper=next(ends)))
        start += v.size
    return tuple(found)
