"""Limits of any text that exclude each other: what branch and bound says when some are left out.

A deletion filter, as of `repair.conflict`, whose verdicts need no convexity: whole and listed
variables stay as they are.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.evaluation import evaluated
from gearopt.optimise.explaining.handles import LOWER, REACH, UPPER, scale
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import PROVER, solve_within
from gearopt.optimise.terms import Repeat, Terms, flat, inequalities

VERDICTS = {"infeasible": False, "optimal": True, "stationary": True, "feasible": True}
NEAR = 4.0  # times its size a bound is moved first, before REACH
BOUNDS = "bounds of variables"  # named where time was too short to try each
COLUMNS = 60  # of problems with more variables no bound is left out


@dataclass(frozen=True)
class Exclusion:
    """Names of limits that exclude each other; unsure: those that may not be needed for it."""

    names: tuple[str, ...] = ()
    unsure: tuple[str, ...] = ()


def exclusion(problem: Problem, clock: Clock) -> Exclusion:
    """Limits of an impossible problem that exclude each other, all others dropped.

    Rows of a repeat are one limit. Bounds are tried after the rows; a variable that is above 0
    stays there.
    """
    limits = _limits(problem)
    rows = _needed(limits, lambda spare, _: eased(problem, spare, anywhere=True), (REACH,), clock)
    rest = eased(problem, [n for n in limits if n not in rows.names], anywhere=True)
    ends = _ends(problem)

    def wider(spare: Sequence[str], by: float) -> Problem:
        return _wider(rest, [ends[name] for name in spare], by)

    bounds = Exclusion()
    if len(problem.columns) <= COLUMNS:
        bounds = _needed(list(ends), wider, (NEAR, REACH), clock)
    if ends and (clock.over or len(problem.columns) > COLUMNS):
        bounds = Exclusion((BOUNDS,), (BOUNDS,))
    return Exclusion((*rows.names, *bounds.names), (*rows.unsure, *bounds.unsure))


def _needed(
    names: Sequence[str],
    without: Callable[[Sequence[str], float], Problem],
    factors: Sequence[float],
    clock: Clock,
) -> Exclusion:
    """Names that cannot be left out, all at once or one after the other.

    without(spare, by): the problem without some of them, or with these moved by a factor; the
    factors are tried until a design is possible.
    """
    if not names or possible(without(names, REACH), clock) is False:
        return Exclusion()
    needed, spare, unsure = list(names), list[str](), list[str]()
    for name in names:
        answer = None
        for by in factors:
            if answer := possible(without([*spare, name], by), clock):
                break
        if answer is False:
            spare.append(name)
            needed.remove(name)
        elif answer is None:
            unsure.append(name)
    return Exclusion(tuple(needed), tuple(unsure))


def named(result: Result, known: Exclusion) -> Result:
    """An impossible answer that names the limits which exclude each other, if there are any."""
    if not known.names:
        return result
    message = f"no design meets these together: {', '.join(known.names)}"
    proof = result.proof | {"conflict": list(known.names)}
    if known.unsure:
        proof |= {"unsure": list(known.unsure)}
    return replace(result, proof=proof, message=message)


def each_resolves(problem: Problem, known: Exclusion, clock: Clock) -> bool:
    """Whether a design exists with any one of the excluding limits left out, all others kept."""
    ends = _ends(problem)

    def without(name: str) -> Problem:
        if name in ends:
            return _wider(problem, [ends[name]], REACH)
        return eased(problem, [name], anywhere=True)

    return (
        len(known.names) > 1
        and not known.unsure
        and all(possible(without(n), clock) for n in known.names)
    )


def possible(problem: Problem, clock: Clock) -> bool | None:
    """Whether a problem has a design, by branch and bound; None where that is not known."""
    if clock.over:
        return None
    return VERDICTS.get(solve_within(clock, problem, PROVER).status)


def _limits(problem: Problem) -> list[str]:
    """Names of the limits and equal rows: of all rows of a repeat one, of a block each."""
    rows = [row.name for row in problem.rows.inequalities if row.kind == "limits"]
    repeated = tuple(f"{r.name}." for r in problem.repeats)
    return list(
        dict.fromkeys(
            name.rsplit("[", 1)[0] if repeated and name.startswith(repeated) else name
            for name in (*rows, *problem.rows.equalities)
        )
    )


def _ends(problem: Problem) -> dict[str, tuple[str, int]]:
    """Kind and column of every finite bound, by its name; listed values are no bounds."""
    return {
        f"{name} {kind.split()[0]}": (kind, k)
        for k, (variable, name) in enumerate(problem.columns)
        for kind, values in zip((LOWER, UPPER), problem.bounds()[:2], strict=True)
        if variable.values is None and math.isfinite(values[k])
    }


def _wider(problem: Problem, ends: Sequence[tuple[str, int]], by: float) -> Problem:
    """The problem with bounds moved so many times as far out; what is above 0 stays there."""
    lower, upper = (end.copy() for end in problem.bounds()[:2])
    for kind, k in ends:
        if kind == UPPER:
            upper[k] += by * scale(upper[k])
        else:
            lower[k] = lower[k] / by if lower[k] > 0.0 else lower[k] - by * scale(lower[k])
    return problem.bounded(lower, upper)


def eased(
    problem: Problem, factors: Mapping[str, float] | Sequence[str], anywhere: bool = False
) -> Problem:
    """The problem with limits divided by factors, or without those that are named alone.

    anywhere: any design will do, so that nothing is minimised.
    """
    known = factors if isinstance(factors, Mapping) else dict.fromkeys(factors, math.inf)
    text = _Eased(problem, known, anywhere)
    repeats = tuple(replace(r, evaluate=partial(text.repeated, r)) for r in problem.repeats)
    return replace(problem, evaluate=text.evaluate, repeats=repeats, methods={}, exact_limits=None)


@dataclass(frozen=True)
class _Eased:
    """Texts of a problem whose limits are divided by factors; infinite ones leave them out."""

    problem: Problem
    factors: Mapping[str, float]
    anywhere: bool

    def evaluate(self, x: Any, p: Any) -> Terms:
        """Terms of the problem's own text."""
        terms = evaluated(self.problem, None, x, p, {})
        return self._kept(terms, {"any": 0.0} if self.anywhere else terms.minimise, "")

    def repeated(self, repeat: Repeat, x: Any, p: Any, row: Any) -> Terms:
        """Terms of one row of a repeat."""
        terms = evaluated(self.problem, repeat, x, p, vars(row))
        return self._kept(terms, {} if self.anywhere else terms.minimise, f"{repeat.name}.")

    def _kept(self, terms: Terms, objective: Mapping[str, Any], prefix: str) -> Terms:
        of = {name: self.factors.get(prefix + name, 1.0) for name, _, _ in inequalities(terms)}
        limits = {
            n: v if of[n] == 1.0 else v / of[n]
            for n, v, _ in inequalities(terms)
            if of[n] < math.inf
        }
        equal = {n: v for n, v in flat(terms.equal) if prefix + n not in self.factors}
        return Terms(objective, limits, equal=equal)
