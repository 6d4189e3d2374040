"""Problems made of one with several objectives: one is minimised, others are limited."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.evaluation import same_way
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.tape import same_kinds
from gearopt.optimise.terms import Array, Param, Terms

NO_IDENTIFIER = re.compile(r"\W")
LIMIT_PREFIX = "most"  # most_cost: the largest cost that is allowed
SCALE = "scale"  # scale_cost: what its excess is measured by
VALUE = "value"  # value_cost: the cost of a point, whatever is minimised


@dataclass(frozen=True)
class Limit:
    """The largest value of an objective, and the scale of its violation (above 0).

    Where they are equal the row is a quotient, which keeps a posynomial what it is.
    """

    most: float
    scale: float

    @classmethod
    def of(cls, most: float, width: float) -> "Limit":
        """Return a limit of an objective that changes by so much along a front."""
        return cls(most, most if most > 0.0 else max(width, abs(most)) or 1.0)


def limit_of(name: str) -> str:
    """The row, and the parameter, that limit an objective; names are made identifiers."""
    return f"{LIMIT_PREFIX}_{NO_IDENTIFIER.sub('_', name)}"


def scale_of(name: str) -> str:
    """The parameter by which the row of a limited objective is scaled."""
    return f"{SCALE}_{NO_IDENTIFIER.sub('_', name)}"


def posed(
    problem: Problem | Conic, minimise: Sequence[str], limits: Mapping[str, Limit]
) -> Problem | Conic:
    """Return the problem with some of its objectives, others limited; `moved` changes the limits.

    A row `most_NAME` is the utilisation of a limit, a report term `value_NAME` the value of every
    objective. Algorithms of the problem's own are kept where several are minimised: they read names
    and limits from the problem (`caps`).
    """
    conic = isinstance(problem, Conic)
    quotient = {name: limit.most == limit.scale for name, limit in limits.items()}
    fixed = {name: limit.scale for name, limit in limits.items()} if conic else {}

    def evaluate(x: Any, p: Any) -> Terms:
        terms = problem.text(x, p)
        rows = {
            limit_of(name): _row(terms.minimise[name], p, name, whole, fixed.get(name))
            for name, whole in quotient.items()
        }
        kept = {name: terms.minimise[name] for name in minimise}
        shown = {f"{VALUE}_{name}": value for name, value in terms.minimise.items()}
        return replace(
            terms,
            minimise=kept,
            limits={**terms.limits, **rows},
            report={**terms.report, **shown},
        )

    parameters = [Param(limit_of(name), "", 1.0) for name in limits]
    parameters += [
        Param(scale_of(name), "", limit.scale)
        for name, limit in limits.items()
        if conic or not quotient[name]
    ]
    every = (*problem.parameters, *parameters)
    limited: Problem | Conic
    if isinstance(problem, Conic):
        limited = Conic(problem.name, problem.variables, every, evaluate)
    else:
        limited = Problem(
            problem.name,
            problem.variables,
            every,
            evaluate,
            problem.repeats,
            methods=problem.methods if len(minimise) > 1 else {},
            vectorised=problem.vectorised,
            exact_limits=problem.exact_limits,
        )
    return moved(limited, limits)


Built = dict[tuple[str, ...], "Problem | Conic"]


def kept(
    built: Built, problem: Problem | Conic, minimise: Sequence[str], limits: Mapping[str, Limit]
) -> Problem | Conic:
    """`posed` from problems that were built before, or built now and kept."""
    key = (*minimise, *(f"{n} {one.most == one.scale}" for n, one in sorted(limits.items())))
    if key not in built:
        built[key] = posed(problem, minimise, limits)
    first, now = built[key], moved(built[key], limits)
    if isinstance(now, Problem) and isinstance(first, Problem):
        same_way(now, first)
        if all(limit.most == limit.scale for limit in limits.values()):  # factors of quotients
            same_kinds(now, first)
    return now


def moved(problem: Problem | Conic, limits: Mapping[str, Limit]) -> Problem | Conic:
    """A problem of `posed` with other limits of the same kind; its traces are kept.

    The scales of a Conic are constants of its text, and stay.
    """
    known, values = _numbers(problem), {}
    for name, limit in limits.items():
        values[limit_of(name)] = limit.most
        if isinstance(problem, Conic):
            values[limit_of(name)] = limit.most / known[scale_of(name)]
        elif scale_of(name) in known:
            values[scale_of(name)] = limit.scale
    at: Problem | Conic = problem.at(**values)
    return at


def violation_scale(problem: Problem | Conic, name: str) -> float:
    """Scale of the violation of an objective's limit."""
    known = _numbers(problem)
    return known.get(scale_of(name), known[limit_of(name)])


def _numbers(problem: Problem | Conic) -> dict[str, float]:
    return {q.name: float(np.ravel(q.value)[0]) for q in problem.parameters}


def caps(problem: Problem) -> dict[str, float]:
    """Return the largest values of objectives that `posed` was given, by name."""
    known = _numbers(problem)
    limited = {name: known.get(limit_of(name)) for name in problem.rows.objectives}
    return {name: most for name, most in limited.items() if most is not None}


def valued(result: Result, names: Sequence[str]) -> Array:
    """Return the values (k,) of objectives at the point of a result of `posed`."""
    return np.array([float(result.report[f"{VALUE}_{name}"]) for name in names])


def _row(value: Any, p: Any, name: str, quotient: bool, fixed: float | None) -> Any:
    """Return the utilisation of a limit; fixed: its scale in cvxpy text, a constant there."""
    most = getattr(p, limit_of(name))
    if fixed is not None:
        return 1.0 + value * (1.0 / fixed) - most
    return value / most if quotient else 1.0 + (value - most) / getattr(p, scale_of(name))
