"""Why a request is impossible, and the smallest change of its limits that makes it possible.

Three answers, each proven by our own bound: the conflict (limits that exclude each other, each
of them needed for it), the smallest repair (product of factors over all limits) and, for every kind
of limit, the even repair (one factor for that kind alone).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.evaluation import evaluated
from gearopt.optimise.explaining.handles import LOWER, PARAM, REACH, ROW, UPPER, Handle, scale
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve_within
from gearopt.optimise.terms import Array, Repeat, Terms, Var, each, inequalities, namespace

CERTAIN = ("optimal", "stationary")
# relative: two repairs as small as each other; a factor below 1 + PRODUCT_TIE is none
PRODUCT_TIE = 1e-7
SLACK_TRIED = 1e-3  # a remedy this much smaller must be impossible
FARTHEST = 4.0  # factor to which whole numbers and modules are tried
# ratio of an impossible to a possible factor that ends a search
FACTOR_TOLERANCE = 1.0 + 0.5 * SLACK_TRIED


@dataclass(frozen=True)
class Repair:
    """Factors by which limits are relaxed so that a design exists.

    kind: "least" (the smallest product over all limits) or "even" (one factor for a family).
    factor: that product or that common factor; bound: no smaller one can do (None: not proven).
    moves: (handle, factor) of every limit that moves.
    """

    kind: str
    factor: float
    bound: float | None
    moves: tuple[tuple[Handle, float], ...]


def value_within(clock: Clock, problem: Problem, method: str = "ipopt") -> float | None:
    """Return the optimal value of a problem; None where it is not certain that it is one."""
    result = solve_within(clock, problem, method)
    return result.value if result.status in CERTAIN else None


def least(problem: Problem, movable: Sequence[Handle], clock: Clock) -> Repair | None:
    """Return the repair of the smallest product of factors, with as few moves as it allows.

    None where no factors within reach suffice, or the budget ended.
    """
    solution = least_factors(problem, [[h] for h in movable], clock)
    if solution is None:
        return None
    factors, value, bound = solution
    moves = tuple(
        (h, float(f)) for h, f in zip(movable, factors, strict=True) if f > 1.0 + PRODUCT_TIE
    )
    return Repair("least", value, bound, moves)


def least_factors(
    problem: Problem, groups: Sequence[Sequence[Handle]], clock: Clock
) -> tuple[Array, float, float | None] | None:
    """Return factors of groups of limits of the smallest product, that product, and its bound.

    As few factors are above 1 as that product allows; whole numbers are at whole values. None
    where no factors within reach suffice, or the budget ended.
    """
    form = elastic(problem, groups)
    result = solve_within(clock, form, "ipopt")
    if result.value is None or result.status not in CERTAIN:
        return None
    factors = np.atleast_1d(result.design["relaxation"])
    reach = np.array([min(h.reach for h in group) for group in groups])
    allowed = np.where(factors > 1.0 + PRODUCT_TIE, reach, 1.0)
    for k in np.argsort(factors, kind="stable"):
        if allowed[k] == 1.0 or clock.over:
            continue
        fewer = allowed.copy()
        fewer[k] = 1.0
        other = solve_within(clock, form.within("relaxation", 1.0, tuple(fewer)), "ipopt")
        if (
            other.status in CERTAIN
            and other.value is not None
            and other.value <= result.value * (1.0 + PRODUCT_TIE)
        ):
            allowed, factors = fewer, np.atleast_1d(other.design["relaxation"])
    firsts = [group[0] for group in groups]
    return _whole(form, firsts, factors, allowed, clock), result.value, result.bound


def _whole(
    form: Problem, movable: Sequence[Handle], factors: Array, allowed: Array, clock: Clock
) -> Array:
    """Return the factors with whole numbers at whole values, none easier than it must be.

    One after the other is moved to the next easier value and the others follow; then each is taken
    back one by one as long as a design exists.
    """
    low, high = np.ones(len(factors)), allowed.copy()

    def follow() -> Array | None:
        result = solve_within(clock, form.within("relaxation", tuple(low), tuple(high)), "ipopt")
        return None if result.value is None else np.atleast_1d(result.design["relaxation"])

    whole = [k for k, h in enumerate(movable) if h.whole and factors[k] > 1.0 + PRODUCT_TIE]
    for k in whole:
        low[k] = high[k] = movable[k].eased(float(factors[k]))
        after = follow()
        if after is None:
            return factors
        factors = after
    for k in whole:
        last = low[k]
        while (back := movable[k].one_back(last)) >= 1.0:
            low[k] = high[k] = back
            if (after := follow()) is None:
                break
            last, factors = back, after
        low[k] = high[k] = last
    return factors


def even(problem: Problem, family: Sequence[Handle], clock: Clock) -> Repair | None:
    """Return the repair of one common factor for a family of limits; None: it cannot suffice."""
    result = solve_within(clock, elastic(problem, [family]), "ipopt")
    if result.value is None or result.status not in CERTAIN:
        return None
    moves = tuple((h, result.value) for h in family)
    return Repair("even", result.value, result.bound, moves)


def impossible(
    problem: Problem,
    clock: Clock,
    movable: Sequence[Handle],
    limits: Sequence[Handle],
    together: Sequence[Sequence[Handle]] = (),
) -> tuple[tuple[Handle, ...], list[Repair]]:
    """Return the conflict of an impossible problem and its repairs: the smallest, then even ones.

    movable: what a repair may move; limits: what may be named in the conflict; together: further
    groups of limits to move alike.
    Limits are tried first; values that are given (a duty, a fixed size) move only where relaxing
    limits does not help. Even repairs of given values are listed beside, as ways to ask for less.
    """
    repairs: list[Repair] = []
    for allowed in ([h for h in movable if not h.given], list(movable)):
        best = least(problem, allowed, clock) if allowed else None
        if best is not None:
            break
    else:
        return (), []
    if not best.moves:  # it was possible all along
        return (), []
    given = [h for h in allowed if h.given]
    blamed = conflict(problem, [*limits, *given], clock)
    repairs.append(best)
    for family in (*families(movable).values(), *together):
        if clock.over:
            break
        alike = even(problem, family, clock)
        alone = alike is not None and len(family) == 1 and best.moves == alike.moves
        if alike is not None and not alone:
            repairs.append(alike)
    return blamed, repairs


def families(movable: Sequence[Handle]) -> dict[str, list[Handle]]:
    """Return handles by family, in their order; values that are given apart for up and down."""
    by_family: dict[str, list[Handle]] = {}
    for handle in movable:
        way = f" {handle.direction:+d}" if handle.given else ""
        by_family.setdefault(f"{handle.family}{way}", []).append(handle)
    return by_family


def conflict(problem: Problem, movable: Sequence[Handle], clock: Clock) -> tuple[Handle, ...]:
    """Return limits that are in conflict with all others dropped, each needed for it.

    A deletion filter: a limit that can be dropped without making a design possible is dropped for
    good; for each that stays, a design exists without it. Empty where that is not proven: time ran
    out, or the problem is not convex in logarithms.
    """
    form = elastic(problem, [[h] for h in movable])
    kept = list(range(len(movable)))
    needed: set[int] = set()
    first = _verdict(form, kept, movable, clock)
    if first.status != "infeasible":
        return ()
    kept = _blamed(first, kept, movable)
    while spare := [k for k in kept if k not in needed]:
        without = [k for k in kept if k != spare[0]]
        verdict = _verdict(form, without, movable, clock)
        if verdict.status == "infeasible":
            kept = _blamed(verdict, without, movable)
        elif verdict.value is not None:
            needed.add(spare[0])
        else:
            return ()
    return tuple(movable[k] for k in kept)


def any_resolves(
    problem: Problem, known: Sequence[Handle], blamed: Sequence[Handle], clock: Clock
) -> bool:
    """Return whether a design exists with any one of the limits in conflict dropped alone.

    known: all that may be dropped; the others are kept as they are. Each is tried, so False is also
    what is not known in time.
    """
    if len(blamed) < 2 or not set(blamed) <= set(known):
        return False
    form = elastic(problem, [[h] for h in known])
    rest = ([k for k, h in enumerate(known) if h != one] for one in blamed)
    return all(_verdict(form, kept, known, clock).value is not None for kept in rest)


def _verdict(form: Problem, kept: Sequence[int], movable: Sequence[Handle], clock: Clock) -> Result:
    """Solve with the kept limits as they are and all others dropped."""
    upper = np.full(len(movable), REACH)
    upper[list(kept)] = 1.0
    return solve_within(clock, form.within("relaxation", 1.0, tuple(upper)), "ipopt")


def _blamed(verdict: Result, kept: Sequence[int], movable: Sequence[Handle]) -> list[int]:
    """Return those of the kept limits that the proof of impossibility uses."""
    rows = set(verdict.proof.get("conflict", ()))
    return [k for k in kept if rows & set(movable[k].rows)] or list(kept)


_Place = tuple[str, int]  # kind and place of a handle


def elastic(problem: Problem, groups: Sequence[Sequence[Handle]]) -> Problem:
    """Return the elastic form of a problem: its limits may be relaxed, at the smallest product.

    Variable `relaxation`: a factor >= 1 for each group, shared by its handles and within the reach
    of all of them; a handle in several groups moves by the product of their factors, limits in no
    group stay as they are. Minimised is the product of the factors; the objective is left out.
    Where a problem is convex in logarithms, its elastic form is too. SolveError for discrete
    variables.
    """
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"limits are relaxed in continuous problems; {name} is discrete")
    owners: dict[_Place, list[int]] = {}
    for k, group in enumerate(groups):
        for h in group:
            owners.setdefault((h.kind, h.place), []).append(k)
    reach = tuple(min(h.reach for h in group) for group in groups)
    factor = Var("relaxation", "", 1.0, reach, 1.0, len(groups), log=True)
    relaxed = _Relaxed(problem, owners, {(h.kind, h.place): h for g in groups for h in g})
    return Problem(
        f"{problem.name}, relaxed",
        (*_wider(problem, list(owners)), factor),
        problem.parameters,
        relaxed.evaluate,
        tuple(replace(r, evaluate=partial(relaxed.repeated, r)) for r in problem.repeats),
    )


@dataclass(frozen=True)
class _Relaxed:
    """The texts of an elastic form; owners: the groups that a handle is in."""

    problem: Problem
    owners: Mapping[_Place, list[int]]
    handles: Mapping[_Place, Handle]

    def evaluate(self, x: Any, p: Any) -> Terms:
        """Return the terms of the problem's own text."""
        factors = self._factors(x)
        terms = evaluated(self.problem, None, x, self._parameters(factors, p), {})
        product = {"relaxation": math.prod(each(x.relaxation))}
        bounds = _bound_rows(self.problem, factors, x)
        return Terms(product, self._rows(factors, terms), defines=bounds, equal=terms.equal)

    def repeated(self, repeat: Repeat, x: Any, p: Any, row: Any) -> Terms:
        """Return the terms of one row of a repeat."""
        factors = self._factors(x)
        terms = evaluated(self.problem, repeat, x, self._parameters(factors, p), vars(row))
        return Terms({}, self._rows(factors, terms, f"{repeat.name}."), equal=terms.equal)

    def _factors(self, x: Any) -> dict[_Place, Any]:
        """Return the factor of every handle."""
        parts = each(x.relaxation)
        return {place: math.prod(parts[k] for k in own) for place, own in self.owners.items()}

    def _parameters(self, factors: Mapping[_Place, Any], p: Any) -> Any:
        scalars = [s for q in self.problem.parameters for s in each(getattr(p, q.name))]
        for (kind, place), factor in factors.items():
            if kind == PARAM:
                direction = self.handles[kind, place].direction
                scalars[place] = scalars[place] * factor**direction
        return namespace(self.problem.parameters, scalars)

    def _rows(
        self, factors: Mapping[_Place, Any], terms: Terms, prefix: str = ""
    ) -> dict[str, Any]:
        """Return all inequality rows, those with a factor of their own divided by it."""
        factors_of_rows = {
            h.name: factors[place] for place, h in self.handles.items() if h.kind == ROW
        }
        return {
            n: v / factors_of_rows[prefix + n] if prefix + n in factors_of_rows else v
            for n, v, _ in inequalities(terms)
        }


def _bound_rows(problem: Problem, factors: dict[tuple[str, int], Any], x: Any) -> dict[str, Any]:
    """Return bounds that may move, as rows <= 1."""
    lower, upper, _ = problem.bounds()
    flat_x = [s for v in problem.variables for s in each(getattr(x, v.name))]
    rows = {}
    for (kind, k), factor in factors.items():
        if kind not in (LOWER, UPPER):
            continue
        value = float(lower[k] if kind == LOWER else upper[k])
        here = flat_x[k]
        name = f"{problem.columns[k][1]} {kind}"
        if value > 0:
            rows[name] = value / (here * factor) if kind == LOWER else here / (value * factor)
        else:
            excess = value - here if kind == LOWER else here - value
            rows[name] = (1.0 + excess / scale(value)) / factor
    return rows


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
    variables = []
    start = 0
    for v in problem.variables:
        part = slice(start, start + v.size)
        ends = (tuple(map(float, a[part])) for a in (lower, upper))
        variables.append(replace(v, lower=next(ends), upper=next(ends)))
        start += v.size
    return tuple(variables)
