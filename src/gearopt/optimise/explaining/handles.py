"""Relaxable parts of a problem: parameters that are limits, bounds, and else rows.

A limit is relaxed where the user wrote it: in its parameter (so that a safety factor that enters
squared is answered by the number to write), in a bound of a variable, and only where neither exists
in the row itself.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, spread

REACH = 1e6  # the largest factor by which a limit may be relaxed; finite, for the dual bound
DIVIDES = 1e-12  # relative, to which a row falls as a number grows that it is divided by
POINTS = 8  # around the guess at which the direction of a parameter is sampled
DATA = ("", "data")  # roles of a parameter that stays as it is
PARAM, ROW, LOWER, UPPER = "parameter", "row", "lower bound", "upper bound"


@dataclass(frozen=True)
class Handle:
    """One number of the user that may be relaxed.

    name: of the limit as reported. kind: parameter, row, lower bound or upper bound; place: its
    index among parameter values, inequality rows or columns. value, unit, key: what stands there
    now. direction: +1 where a larger value is easier, -1 where a smaller one is. rows: names of
    the rows it governs. given: a value that the user fixed, no limit. reach: the largest factor by
    which it may move. whole: it is written as an integer. parameter: its name, of a row's number.
    shift: the unit in which it moves, of a number that moves by differences.
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
    parameter: str = ""
    shift: float = 0.0

    @property
    def family(self) -> str:
        """Return the name before [k], common to the limits of all stages or components."""
        return self.name.split("[")[0]

    @property
    def label(self) -> str:
        """Return where it is written: its key, else its parameter, else its name."""
        return self.key or self.parameter or self.name

    def relaxed(self, factor: float) -> float:
        """Return the value to write for a factor >= 1."""
        if self.shift:
            return self.value + self.direction * (factor - 1.0) * self.shift
        return self.value * factor**self.direction

    def factor(self, number: float) -> float:
        """The factor of a value to write, the inverse of `relaxed`."""
        if self.shift:
            return 1.0 + (number - self.value) * self.direction / self.shift
        return float((number / self.value) ** self.direction)

    def eased(self, factor: float) -> float:
        """Return the factor that is asked for a needed one: of a whole number the next easier."""
        if not self.whole:
            return factor
        number = self.relaxed(factor)
        near = round(number)
        if abs(number - near) > 1e-6 * abs(number):
            near = math.ceil(number) if self.direction > 0 else math.floor(number)
        return float((near / self.value) ** self.direction)

    def one_back(self, factor: float) -> float:
        """Return the factor of the next harder whole number."""
        return float(
            ((round(self.relaxed(factor)) - self.direction) / self.value) ** self.direction
        )


def handles(problem: Problem) -> tuple[Handle, ...]:
    """Return every number that a repair may move: limits first, then values that are given."""
    every, governed = _parameters(problem)
    rows_of_limit: dict[str, list[int]] = {}  # rows of a repeat are one limit
    for k, row in enumerate(problem.rows.inequalities):
        if row.kind == "limits" and k not in governed:
            rows_of_limit.setdefault(_limit(problem, row.name), []).append(k)
    for name, places in rows_of_limit.items():
        rows = tuple(problem.rows.inequalities[k].name for k in places)
        limit = Handle(name, ROW, places[0], 1.0, 1, rows=rows)
        number = problem.memo.get(("numbers", None), {}).get(name)
        if number is not None and not number.parameter and (number.value or number.scale):
            moves = number.value, number.sign
            limit = replace(limit, value=moves[0], direction=moves[1], shift=number.scale)
        every.append(limit)
    every += _bounds(problem)
    return tuple(sorted(every, key=lambda h: h.given))


def _limit(problem: Problem, row: str) -> str:
    """Return the name of the limit a row belongs to: without its number if it is a repeat's."""
    repeated = any(row.startswith(f"{r.name}.") for r in problem.repeats)
    return row.rsplit("[", 1)[0] if repeated else row


def _parameters(problem: Problem) -> tuple[list[Handle], set[int]]:
    """Return parameters that may move, and the rows they govern."""
    acts, signs, elsewhere, _ = _slopes(problem)
    rows = problem.rows.inequalities
    roles = [each_word(q.role, q.size) for q in problem.parameters]
    movers = np.array([role not in DATA for own in roles for role in own], bool)
    of_parameters: list[Handle] = []
    governed: set[int] = set()
    start = 0
    for parameter, roles_of in zip(problem.parameters, roles, strict=True):
        values = spread(parameter.value, parameter.size)
        keys = each_word(parameter.key, parameter.size)
        for k, (role, key, value) in enumerate(zip(roles_of, keys, values, strict=True)):
            place = start + k
            touched = np.flatnonzero(acts[:, place])
            ways = {int(s) for s in signs[touched, place]}
            only = all(rows[r].kind == "limits" for r in touched) and not elsewhere[place]
            movable = only and len(ways) == 1 and value > 0 and math.isfinite(value)
            if role in DATA or not movable:
                continue
            names = tuple(rows[r].name for r in touched)
            label = parameter.name if parameter.size == 1 else f"{parameter.name}[{k + 1}]"
            alone = len(names) == 1 and acts[touched[0]][movers].sum() == 1
            name = names[0] if alone else label
            sign = -ways.pop()
            unit, given = parameter.unit, role == "given"
            of_parameters.append(
                Handle(name, PARAM, place, value, sign, unit, key, names, given, parameter=label)
            )
            governed |= set(touched.tolist())
        start += parameter.size
    return of_parameters, governed


def with_limits_named(problem: Problem) -> Problem:
    """Give the role "limit" to parameters without a role that act on limits alone.

    Such is one that a limit is compared with, and one that divides all limits it acts on, where no
    other such parameter and none that may move stands in these. One that acts on the objective or
    an equality gets no role. The problem itself where every parameter has a role.
    """
    roles = [each_word(q.role, q.size) for q in problem.parameters]
    words = np.array([role for own in roles for role in own])
    if not (words == "").any():
        return problem
    parts: list[Any] = [part.astype(bool) for part in _slopes(problem)]
    acts, _, elsewhere, divides = parts
    limits = np.array([row.kind == "limits" for row in problem.rows.inequalities], bool)
    free = (words == "") & ~elsewhere & acts.any(axis=0)
    free &= np.array([limits[here].all() for here in acts.T], bool)
    compared = free & np.isin(_names(problem), list(_compared(problem)))
    dividing = free & np.array([by[here].all() for here, by in zip(acts.T, divides.T, strict=True)])
    movers = compared | (~np.isin(words, DATA))
    words = np.where(compared | _alone(acts, dividing & ~compared, movers), "limit", words)
    ends = np.cumsum([q.size for q in problem.parameters])[:-1]
    said = [tuple(map(str, part)) for part in np.split(words, ends)]
    parameters = (replace(q, role=w) for q, w in zip(problem.parameters, said, strict=True))
    return replace(problem, parameters=tuple(parameters))


def _alone(acts: Any, some: Any, movers: Any) -> Any:
    """Those of some parameters (np,) in whose rows no other of them and no mover stands."""
    crowded = acts[:, some | movers].sum(axis=1) > 1
    return some & ~acts[crowded].any(axis=0)


def _names(problem: Problem) -> list[str]:
    """Name of the parameter that every component is of."""
    return [q.name for q in problem.parameters for _ in range(q.size)]


def _compared(problem: Problem) -> set[str]:
    """Names of the parameters that limits are compared with, as they are."""
    return {number.parameter for number in problem.memo.get(("numbers", None), {}).values()}


def each_word(words: str | tuple[str, ...], size: int) -> tuple[str, ...]:
    """Return a word of a parameter for each of its components."""
    return tuple(map(str, np.broadcast_to(np.asarray(words), (size,))))


def _slopes(problem: Problem) -> tuple[Array, Array, Array, Array]:
    """How rows depend on parameters: acts, signs (ng, np), elsewhere (np,), divides (ng, np).

    acts: a parameter stands in the row; signs: the one sign of its derivative at points of the box,
    0 where it changes; elsewhere: it acts on the objective or an equality; divides: the row is
    divided by it, at these points.
    """
    import casadi as ca

    x, p, (f, g, h) = _symbols(problem)
    slopes = ca.jacobian(g, p)
    acts = np.array(ca.DM(slopes.sparsity(), 1.0), float).reshape(g.numel(), p.numel()) != 0
    at = ca.Function("slopes", [x, p], [slopes, g])
    lower, upper, guess = problem.bounds()
    logarithmic = np.array([v.log for v, _ in problem.columns])
    draw = np.random.default_rng(0)
    signs = np.zeros(acts.shape)
    mixed = np.zeros(acts.shape, bool)
    given = problem.parameter_values()
    numbers = np.where(np.isfinite(given), given, 0.0)  # a row is divided by no infinite number
    divides = acts & np.isfinite(given)
    for spread_ in (0.0, *[0.1] * POINTS):
        step = spread_ * draw.standard_normal(len(guess))
        point = np.where(logarithmic, guess * np.exp(step), guess + step * (1.0 + np.abs(guess)))
        values, used = (np.array(a, float) for a in at(np.clip(point, lower, upper), given))
        values = values.reshape(acts.shape)
        here = np.sign(np.nan_to_num(values))
        mixed |= (signs * here) < 0
        signs = np.where(signs == 0, here, signs)
        off = np.abs(values * numbers + used.reshape(-1, 1))
        divides &= ~(off > DIVIDES * np.abs(used.reshape(-1, 1)))
    other = ca.which_depends(ca.vertcat(f, h), p, 1, False) if p.numel() else []
    return acts, np.where(mixed, 0.0, signs), np.array(other, bool), divides


def effective(problem: Problem) -> Array:
    """Return which parameter components (np,) the text uses at all."""
    import casadi as ca

    x, p, outputs = _symbols(problem)
    used = ca.which_depends(ca.vertcat(*outputs), p, 1, False) if p.numel() else []
    return np.array(used, bool)


def _symbols(problem: Problem) -> tuple[Any, Any, Any]:
    """Return symbols of point and parameters, and the terms f, g, h of them."""
    terms = problem.traced().terms
    x, p = terms.sx_in() if terms.is_a("SXFunction") else terms.mx_in()
    return x, p, terms(x, p)


def _bounds(problem: Problem) -> list[Handle]:
    """Return bounds that the user wrote, and values that are given by equal ones."""
    import casadi as ca

    lower, upper, _ = problem.bounds()
    x, _, outputs = _symbols(problem)
    used = ca.which_depends(ca.vertcat(*outputs), x, 1, False)
    shared = sum(v.size for v in problem.variables)  # bounds within a repeat stay as they are
    bounds = []
    for k, (variable, name) in enumerate(problem.columns):
        given = lower[k] == upper[k]
        if not used[k] or (variable.search and not given) or k >= shared:
            continue
        for kind, value, sign in ((LOWER, lower[k], -1), (UPPER, upper[k], 1)):
            if math.isfinite(value):
                word = name if given else f"{name} {kind.split()[0]}"
                label = (f"{name} {kind}",)
                key = _end(variable.key, kind, given)
                shift = scale(value) if value <= 0.0 else 0.0
                bound = Handle(word, kind, k, float(value), sign, variable.unit, key, label, given)
                bounds.append(replace(bound, shift=shift))
    return bounds


def _end(key: str | tuple[str, str], kind: str, given: bool) -> str:
    """Return the place of a bound: its own, an end of its range, or one number."""
    if not isinstance(key, str):
        return key[0 if kind == LOWER else 1]
    return key if given or not key else f"{key}[{1 if kind == LOWER else 2}]"


def scale(value: float) -> float:
    """Return the unit in which a bound at or below zero moves."""
    return max(abs(value), 1.0)
