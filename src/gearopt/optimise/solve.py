"""`solve`: run a method on a problem and certify its outcome."""

import math
from collections import Counter
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
from gearopt.optimise.maximised import as_asked
from gearopt.optimise.own_methods import back_ends, run_method
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Result, Watch, versions
from gearopt.optimise.scale import violation
from gearopt.optimise.terms import Array, Var

LIBRARIES = {Problem: ("casadi",), Conic: ("cvxpy", "clarabel")}  # what an answer rests on
PRICED = ("optimal", "stationary")  # of other points multipliers mean nothing
FOLLOWING = ("ipopt", "multistart", "cobyqa")  # they go on from a saddle or a maximum
DESCENTS = 10  # from saddle to saddle, at most
GAP = 1e-6  # relative; what `optimal` means unless the caller says otherwise


def solve(
    problem: Problem | Conic,
    method: str | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float = GAP,
) -> Result:
    """Return the certified answer of one method to one problem.

    method: a name of `problem.methods` or of a back end in `optimise/solvers`; by default the
    problem's own exact algorithm, else ipopt for a Problem and conic for a Conic. gap: relative gap
    to our bound that is called optimal. SolveError where the method does not fit the problem, or
    the problem has several objectives. Not thread-safe (`gearopt.solve` is).
    """
    one_objective(problem.name, problem.rows.objectives)
    return run(problem, method, budget, seed, watch, gap)[0]


def run(
    problem: Problem | Conic,
    method: str | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float = GAP,
) -> tuple[Result, Outcome]:
    """Solve like `solve`, and return the method's raw outcome beside the result.

    Of several objectives the first counts; the outcome's other points are the rest of the Pareto
    front.
    """
    name = method or default_method(problem)
    clock = Clock()
    follow = of_problem(watch, problem)
    call = method_of(problem, name)
    seconds = (budget or Budget()).seconds
    with until(seconds), counting(seconds) as points:
        outcome = run_method(call, problem, name, budget or Budget(), seed, follow)
        points.end = None
        verdict = judge(problem, name, outcome, gap)
        if verdict.lower is not None and name in FOLLOWING and name not in problem.methods:
            left = Clock(budget or Budget(), follow, clock.start)
            outcome, verdict = _followed(left, problem, name, outcome, verdict, gap)
    if points.failed:
        words = filter(None, [verdict.message.rstrip("."), str(points)])
        verdict = replace(verdict, message=". ".join(words))
    return _result(problem, name, outcome, verdict, clock.seconds, seed), outcome


def _followed(
    clock: Clock, problem: Any, name: str, outcome: Outcome, verdict: Verdict, gap: float
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
        judged = judge(problem, name, further, gap)
        if judged.objective is None or not judged.objective < verdict.objective:
            break
        outcome, verdict = further, judged
    return outcome, verdict


def evaluate(problem: Problem | Conic, point: Mapping[str, Any] | Array) -> Result:
    """Evaluate a problem's text at a point: objective, report, utilisation of every limit.

    Nothing is minimised; `Result.feasible` says whether the point meets all limits, its message
    what it exceeds most. point: values by name of the variable (a list for one of size above 1), a
    `Result.design`, or all in order (n,). ValueError where a value is missing, unknown, or not a
    number.
    """
    clock, x = Clock(), _given(problem, point)
    batch = problem.batch(x[None])
    excess, worst = violation(problem, x, batch)
    value = float(batch.F[0, 0])
    verdict = Verdict(
        "evaluated",
        value if math.isfinite(value) else None,
        certificate={"feasibility": excess},
        message="" if excess <= FEASIBLE else f"{worst} is violated by {excess:.3g}",
    )
    outcome = Outcome(x, evaluations=1)
    return as_asked(_result(problem, "evaluation", outcome, verdict, clock.seconds, 0))


def _given(problem: Problem | Conic, point: Mapping[str, Any] | Array) -> Array:
    """Return the point (n,) of values by name."""
    if isinstance(point, Mapping):
        heads = {_head(v, name): _key(v, name) for v, name in problem.columns}
        named = {
            name: point[key if key in point else name]
            for name, key in heads.items()
            if key in point or name in point
        }
        odd = sorted(set(point) - set(heads) - set(heads.values()))
        if odd or (left := [name for name in heads if name not in named]):
            what = f"unknown {odd[0]}" if odd else f"missing {left[0]}"
            raise ValueError(f"{problem.name}: {what}; variables: {', '.join(heads)}")
        sizes = Counter(_head(v, name) for v, name in problem.columns)
        parts = [_values(problem.name, name, named[name], n) for name, n in sizes.items()]
        point = np.concatenate(parts)
    x = np.asarray(point, float)
    if x.shape != (len(problem.columns),) or np.isnan(x).any():
        raise ValueError(f"{problem.name}: needs {len(problem.columns)} numbers, not {x.tolist()}")
    return x


def _values(problem: str, name: str, value: Any, count: int) -> Array:
    """Return the values of one variable (count,); ValueError names it where they are none."""
    try:
        found = np.ravel(np.asarray(value, float))
    except (TypeError, ValueError):
        found = np.empty(0)
    if len(found) != count or np.isnan(found).any():
        sort = "a number" if count == 1 else f"{count} numbers"
        raise ValueError(f"{problem}: {name}={value!r}: write {sort}")
    return found


def solve_within(clock: Clock, problem: Problem | Conic, method: str | None = None) -> Result:
    """Solve within the rest of a clock; a run that is stopped ends the rest too."""
    result = solve(problem, method, clock.left, watch=clock.watch)
    clock.stopped = clock.stopped or result.status == "limit"
    return result


def default_method(problem: Problem | Conic) -> str:
    """Return the method that is run where none is named."""
    return next(iter(problem.methods), "conic" if isinstance(problem, Conic) else "ipopt")


def judge(problem: Problem | Conic, method: str, outcome: Outcome, gap: float) -> Verdict:
    """Verdict on a method's outcome, by the certificate of the problem's kind."""
    if isinstance(problem, Conic):
        from gearopt.optimise.conic import certificate as conic

        return conic.certify(problem, outcome, gap)
    return certify(problem, outcome, gap, exact=method in problem.methods)


def method_of(problem: Problem | Conic, name: str) -> Callable[..., Outcome]:
    """Return the `run` of a method for a problem; SolveError lists the methods there are."""
    if name in problem.methods:
        return problem.methods[name]
    if name in back_ends():
        if (name == "conic") != isinstance(problem, Conic):
            takes = "a Conic (cvxpy text)" if name == "conic" else "a Problem (numpy text)"
            kind = type(problem).__name__
            raise SolveError(f"{name} takes {takes}; {problem.name} is a {kind}")
        if isinstance(problem, Problem):
            check_discrete(problem)
        run: Callable[..., Outcome] = import_module(f"gearopt.optimise.solvers.{name}").run
        return run
    conic_only = isinstance(problem, Conic)
    known = [*problem.methods, *(n for n in back_ends() if (n == "conic") == conic_only)]
    close = get_close_matches(name, known, 1)
    meant = f" (did you mean {close[0]}?)" if close else ""
    raise SolveError(f"no method {name!r}{meant}; methods: {', '.join(known)}")


def _result(
    problem: Problem | Conic,
    method: str,
    outcome: Outcome,
    verdict: Verdict,
    seconds: float,
    seed: int,
) -> Result:
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
        versions=versions("numpy", *LIBRARIES[type(problem)]),
    )


def design(problem: Problem | Conic, x: Array) -> dict[str, Any]:
    """Return every variable by name and unit (`face_width_mm`); lists for blocks."""
    found: dict[str, Any] = {}
    for (variable, name), value in zip(problem.columns, x, strict=True):
        key = _key(variable, name)
        number: Any = round(float(value)) if variable.integer else float(value)
        if variable.size > 1:
            found.setdefault(key, []).append(number)
        else:
            found[key] = number
    return found


def _head(variable: Var, name: str) -> str:
    """Return the name of the variable that a column is of."""
    return name.rsplit("[", 1)[0] if variable.size > 1 else name


def _key(variable: Var, name: str) -> str:
    """Return the key in a design of the variable that a column is of."""
    head = _head(variable, name)
    return f"{head}_{variable.unit}" if variable.unit else head


def limits(problem: Problem | Conic, x: Array) -> dict[str, float]:
    """Return utilisation of every user limit at a point."""
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
    """Return the problem's report terms at a point; lists for the rows of a repeat."""
    values = problem.batch(x[None]).report
    return {
        name: np.asarray(v).reshape(-1).tolist() if np.size(v) > 1 else float(np.ravel(v)[0])
        for name, v in values.items()
    }
