"""A method run on a problem of numpy text, its outcome certified, and the result in words.

`solve` takes problems of cvxpy text, too.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.box import check_discrete
from gearopt.optimise.certificate import Verdict, certify
from gearopt.optimise.clock import Clock, of_problem
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.deadline import until
from gearopt.optimise.failures import counting
from gearopt.optimise.methods import back_ends, run_method
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result, Watch, versions
from gearopt.optimise.terms import Array, Var

LIBRARIES = ("casadi",)  # what an answer rests on
PRICED = ("optimal", "stationary")  # of other points multipliers mean nothing
FOLLOWING = ("ipopt", "multistart", "cobyqa")  # they go on from a saddle or a maximum
DESCENTS = 10  # from saddle to saddle, at most
GAP = 1e-6  # relative; what `optimal` means unless the caller says otherwise


def run(
    problem: Problem,
    method: str | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float = GAP,
) -> tuple[Result, Outcome]:
    """Certified answer of one method to one problem, and the method's raw outcome.

    method: a name of `problem.methods` or of a back end in `optimise/solvers`; by default the
    problem's own exact algorithm, else ipopt. gap: relative gap to our bound that is called
    optimal. Of several objectives the first counts; the outcome's other points are the rest of the
    Pareto front. SolveError where the method does not fit the problem.
    """
    name, budget = method or default_method(problem), budget or Budget()
    clock, follow = Clock(), of_problem(watch, problem)
    call = method_of(problem, name)
    with until(budget.seconds), counting(budget.seconds) as points:
        outcome = run_method(call, problem, name, budget, seed, follow)
        points.end = None
        outcome = replace(outcome, evaluations=max(outcome.evaluations - points.skipped, 0))
        verdict = certify(problem, outcome, gap, exact=name in problem.methods)
        if verdict.lower is not None and name in FOLLOWING and name not in problem.methods:
            left = Clock(budget, follow, clock.start)
            outcome, verdict = _followed(left, problem, outcome, verdict, gap)
    if points.failed:
        words = filter(None, [verdict.message.rstrip("."), str(points)])
        verdict = replace(verdict, message=". ".join(words))
    return result_of(problem, name, outcome, verdict, clock.seconds, seed, LIBRARIES), outcome


def _followed(
    clock: Clock, problem: Problem, outcome: Outcome, verdict: Verdict, gap: float
) -> tuple[Outcome, Verdict]:
    """Go on by ipopt from where the objective falls beside a point, as long as it gets lower."""
    ipopt = import_module("gearopt.optimise.solvers.ipopt")
    clock.evaluations = outcome.evaluations
    for _ in range(DESCENTS):
        if verdict.lower is None or verdict.objective is None or not clock.tell():
            break
        spent = clock.evaluations
        further = ipopt.run(problem, clock.left, 0, clock.inner(), start=verdict.lower)
        spent += further.evaluations
        further, outcome = (replace(o, evaluations=spent) for o in (further, outcome))
        judged = certify(problem, further, gap)
        if judged.objective is None or not judged.objective < verdict.objective:
            break
        outcome, verdict = further, judged
    return outcome, verdict


def default_method(problem: Problem) -> str:
    """Method that is run where none is named."""
    return next(iter(problem.methods), "ipopt")


def method_of(problem: Problem, name: str) -> Callable[..., Outcome]:
    """`run` of a method for a problem; SolveError lists the methods there are."""
    if name in problem.methods:
        return problem.methods[name]
    if name == "conic":
        raise SolveError(f"conic takes a Conic (cvxpy text); {problem.name} is a Problem")
    if name not in back_ends():
        raise unknown_method(name, [*problem.methods, *(n for n in back_ends() if n != "conic")])
    check_discrete(problem)
    call: Callable[..., Outcome] = import_module(f"gearopt.optimise.solvers.{name}").run
    return call


def unknown_method(name: str, known: list[str]) -> SolveError:
    """Error of a method that is none of those that a problem has."""
    close = get_close_matches(name, known, 1)
    meant = f" (did you mean {close[0]}?)" if close else ""
    return SolveError(f"no method {name!r}{meant}; methods: {', '.join(known)}")


def result_of(
    problem: Problem | Conic,
    method: str,
    outcome: Outcome,
    verdict: Verdict,
    seconds: float,
    seed: int,
    libraries: tuple[str, ...],
) -> Result:
    """Result of a verdict; libraries: what it rests on beside numpy."""
    solved = verdict.objective is not None or verdict.status == "evaluated"
    point = outcome.x if solved else None
    texts = {} if point is None else report(problem, point)
    if verdict.status == "infeasible" and outcome.x is not None and isinstance(problem, Problem):
        texts = {"nearest": limits(problem, outcome.x)}
    return Result(
        name=problem.name,
        status=verdict.status,
        method=method,
        objective={"name": problem.rows.objectives[0], "value": verdict.objective},
        bound=verdict.bound,
        gap=verdict.gap,
        proof=dict(verdict.proof),
        certificate=dict(verdict.certificate),
        design={} if point is None else design(problem, point),
        limits={} if point is None else limits(problem, point),
        multipliers=dict(verdict.multipliers) if verdict.status in PRICED else {},
        report=texts,
        message=verdict.message,
        evaluations=outcome.evaluations,
        seconds=seconds,
        seed=seed,
        versions=versions("numpy", *libraries),
    )


def design(problem: Problem | Conic, x: Array) -> dict[str, Any]:
    """Every variable by name and unit (`face_width_mm`); lists for blocks."""
    values: dict[str, Any] = {}
    for (variable, name), value in zip(problem.columns, x, strict=True):
        key = key_of(variable, name)
        number: Any = round(float(value)) if variable.integer else float(value)
        if variable.size > 1:
            values.setdefault(key, []).append(number)
        else:
            values[key] = number
    return values


def point_of(values: Mapping[str, Any]) -> Array:
    """Point (n,) of values by name, all of them in order, as `design` gives them."""
    return np.concatenate([np.ravel(np.asarray(v, float)) for v in values.values()])


def head_of(variable: Var, name: str) -> str:
    """Name of the variable that a column is of."""
    return name.rsplit("[", 1)[0] if variable.size > 1 else name


def key_of(variable: Var, name: str) -> str:
    """Key in a design of the variable that a column is of."""
    head = head_of(variable, name)
    return f"{head}_{variable.unit}" if variable.unit else head


def limits(problem: Problem | Conic, x: Array) -> dict[str, float]:
    """Utilisation of every user limit at a point."""
    return limits_of(problem, x[None])[0]


def limits_of(problem: Problem | Conic, points: Array) -> list[dict[str, float]]:
    """Utilisations of every user limit at points (N, n)."""
    kept = [
        (k, row.name) for k, row in enumerate(problem.rows.inequalities) if row.kind == "limits"
    ]
    used = [{name: row[k] for k, name in kept} for row in problem.batch(points).G.tolist()]
    exact = None if isinstance(problem, Conic) else problem.exact_limits
    return (
        used if exact is None else [u | dict(exact(x)) for u, x in zip(used, points, strict=True)]
    )


def report(problem: Problem | Conic, x: Array) -> dict[str, Any]:
    """The problem's report terms at a point; lists for the rows of a repeat."""
    values = problem.batch(x[None]).report
    return {
        name: np.asarray(v).reshape(-1).tolist() if np.size(v) > 1 else float(np.ravel(v)[0])
        for name, v in values.items()
    }
