"""`solve`: run a method on a problem of either kind of text and certify its outcome."""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from gearopt.optimise import certified
from gearopt.optimise.certificate import Verdict, certify
from gearopt.optimise.certified import GAP, head_of, key_of, result_of
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.maximised import as_asked
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Result, Watch
from gearopt.optimise.scale import broken, violation
from gearopt.optimise.terms import Array

PROVER = "spatial"
BOXES = 2000  # of a run of branch and bound within others, where the budget names no end


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
    answer: tuple[Result, Outcome] = _certifying(problem).run(
        problem, method, budget, seed, watch, gap
    )
    return answer


def _certifying(problem: Problem | Conic) -> Any:
    """The module `certified` of a kind of problem; that of cones is imported for the first one."""
    conic = isinstance(problem, Conic)
    return import_module("gearopt.optimise.conic.certified") if conic else certified


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
        message="" if excess <= FEASIBLE else broken(problem, x, excess, worst),
    )
    libraries = _certifying(problem).LIBRARIES
    outcome = Outcome(x, evaluations=1)
    seconds = clock.seconds
    return as_asked(result_of(problem, "evaluation", outcome, verdict, seconds, 0, libraries))


def _given(problem: Problem | Conic, point: Mapping[str, Any] | Array) -> Array:
    """Return the point (n,) of values by name."""
    if isinstance(point, Mapping):
        heads = {head_of(v, name): key_of(v, name) for v, name in problem.columns}
        named = {
            name: point[key if key in point else name]
            for name, key in heads.items()
            if key in point or name in point
        }
        odd = sorted(set(point) - set(heads) - set(heads.values()))
        if odd or (left := [name for name in heads if name not in named]):
            what = f"unknown {odd[0]}" if odd else f"missing {left[0]}"
            raise ValueError(f"{problem.name}: {what}; variables: {', '.join(heads)}")
        sizes = Counter(head_of(v, name) for v, name in problem.columns)
        parts = [_values(problem.name, name, named[name], n) for name, n in sizes.items()]
        point = np.concatenate(parts)
    x = np.asarray(point, float)
    if x.shape != (len(problem.columns),) or np.isnan(x).any():
        raise ValueError(f"{problem.name}: needs {len(problem.columns)} numbers, not {x.tolist()}")
    return x


def _values(problem: str, name: str, value: Any, count: int) -> Array:
    """Return the values of one variable (count,); ValueError names it if they are not numbers."""
    try:
        numbers = np.ravel(np.asarray(value, float))
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if len(numbers) != count or np.isnan(numbers).any():
        sort = "a number" if count == 1 else f"{count} numbers"
        raise ValueError(f"{problem}: {name}={value!r}: write {sort}")
    return numbers


def solve_within(clock: Clock, problem: Problem | Conic, method: str | None = None) -> Result:
    """Solve within the rest of a clock; a run that is stopped ends the rest too.

    Branch and bound takes BOXES at most, which end no rest.
    """
    budget = clock.left
    if capped := method == PROVER and budget.evaluations is None:
        budget = replace(budget, evaluations=BOXES)
    result = solve(problem, method, budget, watch=clock.watch)
    clock.stopped = clock.stopped or (result.status == "limit" and (clock.over or not capped))
    return result


def default_method(problem: Problem | Conic) -> str:
    """Return the method that is run where none is named."""
    if isinstance(problem, Conic):
        return str(_certifying(problem).METHOD)
    return certified.default_method(problem)


def judge(problem: Problem | Conic, method: str, outcome: Outcome, gap: float) -> Verdict:
    """Verdict on a method's outcome, by the certificate of the problem's kind."""
    if isinstance(problem, Conic):
        verdict: Verdict = _certifying(problem).certify(problem, outcome, gap)
        return verdict
    return certify(problem, outcome, gap, exact=method in problem.methods)


def method_of(problem: Problem | Conic, name: str) -> Callable[..., Outcome]:
    """Return the `run` of a method for a problem; SolveError lists the methods there are."""
    method: Callable[..., Outcome] = _certifying(problem).method_of(problem, name)
    return method
