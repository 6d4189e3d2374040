"""A problem of a user's own: where a method starts, which one is taken, how to prove more."""

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.deadline import until
from gearopt.optimise.explaining.exclusion import exclusion, named
from gearopt.optimise.failures import counting
from gearopt.optimise.maximised import as_asked
from gearopt.optimise.methods import back_ends
from gearopt.optimise.polish import TRACED
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import FEASIBLE, Budget, Event, Result, Watch
from gearopt.optimise.scale import gap as gap_of
from gearopt.optimise.solve import PROVER, default_method, run, solve
from gearopt.optimise.spatial.incumbent import LOCAL
from gearopt.optimise.tape import log_convex_in_logarithms
from gearopt.optimise.terms import Array

SAMPLER = "annealing"  # taken where variables are discrete and nothing is proven
PROVEN = ("optimal", "infeasible")
FIRST = 0.8  # of a budget is for the first method, where a second one follows
BOXES = 3000  # of the prover, where the budget names no end
NAMING = 5.0  # s at most to find the limits that exclude each other


def solve_own(
    problem: Problem | Conic,
    method: str | None,
    budget: Budget,
    seed: int,
    watch: Watch | None,
    gap: float,
    start: Mapping[str, Any] | None,
) -> Result:
    """Solve like `optimise.solve.solve`, from a start, by a method that takes the problem.

    Without a method named: by ipopt or by spatial branch and bound, else by a sampler. The message
    says where nothing is proven, and what would make the problem provable.
    ValueError for a start that is no point of the box, SolveError where the method takes none.
    """
    one_objective(problem.name, problem.rows.objectives)
    name = method or default_method(problem)
    posed = problem if start is None else _started(problem, name, start)
    if method is None and name == "ipopt" and isinstance(posed, Problem):
        answer = _by_default(posed, budget, seed, watch, gap)
    else:
        answer = _saying(solve(posed, name, budget, seed, watch, gap), problem)
    proven = answer.method == PROVER and answer.status == "infeasible"
    if proven and isinstance(posed, Problem):
        answer = _naming(posed, answer, budget, watch)
    return as_asked(answer)


def _naming(problem: Problem, result: Result, budget: Budget, watch: Watch | None) -> Result:
    """An impossible answer with the limits that exclude each other, where there is time."""
    left = budget.less(result.seconds, result.evaluations)
    clock = Clock(replace(left, seconds=Clock(left).within(NAMING)), of_others(watch))
    result = named(result, exclusion(problem, clock))
    seconds, evaluations = result.seconds + clock.seconds, result.evaluations + clock.evaluations
    return replace(result, seconds=seconds, evaluations=evaluations)


def _saying(result: Result, problem: Problem | Conic, *words: str) -> Result:
    """A result whose message holds further words, and what would make its problem provable."""
    every = filter(None, [result.message.rstrip("."), *words, _provable(problem, result)])
    return replace(result, message=". ".join(every))


def _by_default(
    problem: Problem, budget: Budget, seed: int, watch: Watch | None, gap: float
) -> Result:
    """Answer of the prover where it closes the gap, beside that of a local method or a sampler.

    ipopt comes first, as its proofs are free, the sampler last. Where the text has no relaxation,
    or the watcher stopped the first of the two, there is one answer. A text without derivatives is
    the sampler's alone.
    """
    refusals = list[Event]()

    def follow(event: Event) -> bool:
        goes_on = watch is None or watch(event) is not False
        if not goes_on:
            refusals.append(event)
        return goes_on

    discrete = [name for v, name in problem.columns if v.discrete]
    blind = _without_derivatives(problem, budget)
    order = [PROVER, SAMPLER] if discrete else ["ipopt", PROVER]
    order = [SAMPLER] if blind else order
    endless = budget.seconds is None and budget.evaluations is None
    results, words, left = list[Result](), list[str](), budget
    for name in order:
        share = left if name == order[-1] else _share(left)
        if name == PROVER and endless:
            share = replace(share, evaluations=BOXES)
        try:
            solved = _local if name == "ipopt" else solve
            results.append(solved(problem, name, share, seed, follow, gap))
        except SolveError as refused:
            if name != PROVER:
                raise
            words.append(str(refused))
            continue
        left = budget.less(sum(r.seconds for r in results), sum(r.evaluations for r in results))
        if results[-1].status in PROVEN or refusals or 0 in (left.seconds, left.evaluations):
            break
    problem.memo.pop(LOCAL, None)
    result = results[0] if len(results) == 1 else _joined(results[0], results[1], gap)
    words += _unproven(results, result, endless)
    if result.method == SAMPLER and result.bound is None:
        why = "the text has no derivatives" if blind else f"{discrete[0]} is discrete"
        words.append(f"{SAMPLER} was taken, because {why}, and proves nothing")
    if result.status == "limit" and endless:
        result = replace(result, status="limit" if refusals else "feasible")
    return _saying(result, problem, *words)


def _local(
    problem: Problem, method: str, budget: Budget, seed: int, watch: Watch, gap: float
) -> Result:
    """Answer of ipopt, whose point is left for the prover; proven where logarithms prove it."""
    result, outcome = run(problem, method, budget, seed, watch, gap)
    problem.memo[LOCAL] = outcome.x
    left = budget.less(result.seconds, result.evaluations)
    if result.status in (*PROVEN, "limit") or 0 in (left.seconds, left.evaluations):
        return result
    logged = _logged(problem)
    return (
        result
        if logged is None
        else _with_bound_in_logarithms(result, solve(logged, method, left, seed, watch, gap), gap)
    )


def _unproven(results: list[Result], result: Result, endless: bool) -> list[str]:
    """Why the prover, if it ran, closed no gap: where it ended, by its own word or its budget.

    endless: the user named no end, so that it was given one.
    """
    proofs = [r for r in results if r.method == PROVER]
    if not proofs or result.status in PROVEN:
        return []
    (of_boxes,) = proofs
    if of_boxes.message:
        return [of_boxes.message] if of_boxes.message not in result.message else []
    open_ = "" if result.gap is None else f", a gap of {result.gap:.2g} left"
    longer = ", and goes on with budget=Budget(seconds=60)" if endless else ""
    return [f"{PROVER} ended after {of_boxes.evaluations:,} boxes{open_}{longer}"]


def _logged(problem: Problem) -> Problem | None:
    """The problem with all variables declared log, where it then is a geometric program."""
    low, high, _ = problem.bounds()
    variables, repeats = problem.variables, problem.repeats
    if repeats or all(v.log for v in variables) or not ((low > 0.0) & np.isfinite(high)).all():
        return None
    logged = replace(problem, variables=tuple(replace(v, log=True) for v in variables))
    return logged if log_convex_in_logarithms(logged) else None


def _with_bound_in_logarithms(result: Result, logged: Result, gap: float) -> Result:
    """An answer with the bound of the same problem in logarithms, with the effort of both.

    The rows of the two may differ, so that the answer is kept where it does not gain from an
    excess of its own.
    """
    seconds, evaluations = result.seconds + logged.seconds, result.evaluations + logged.evaluations
    best = logged
    if logged.bound is not None and result.value is not None:
        if gap_of(result.value, logged.bound, 0.0) >= -FEASIBLE:
            best = reconcile(result, logged, gap)
    elif result.value is not None:
        best = result
    return replace(best, seconds=seconds, evaluations=evaluations)


def _without_derivatives(problem: Problem, budget: Budget) -> bool:
    """Return whether a text has no tape; SolveError where a sampler does not take it, either."""
    seconds = None if budget.seconds is None else TRACED * budget.seconds
    try:
        with until(seconds), counting(seconds):
            problem.traced()
    except SolveError:
        if not np.isfinite(problem.bounds()[:2]).all():
            raise
        return True
    return False


def _share(budget: Budget) -> Budget:
    """Part of a budget for the first of two methods, most of it."""
    seconds, evaluations = budget.seconds, budget.evaluations
    return replace(
        budget,
        seconds=None if seconds is None else FIRST * seconds,
        evaluations=None if evaluations is None else int(FIRST * evaluations),
    )


def _joined(first: Result, second: Result, gap: float) -> Result:
    """The better of two answers, with the bound of the one that has one, and the effort of both."""
    prover, other = (first, second) if first.method == PROVER else (second, first)
    if prover.status in PROVEN or other.value is None:
        best = prover
    elif prover.bound is not None and other.value < prover.bound:  # it gains from an excess
        best = prover
    elif prover.value is not None and prover.value < other.value - gap * abs(other.value):
        best = prover
    else:
        best = reconcile(other, prover, gap)
    evaluations = first.evaluations + second.evaluations
    return replace(best, seconds=first.seconds + second.seconds, evaluations=evaluations)


def _provable(problem: Problem | Conic, result: Result) -> str:
    """Declarations by which a problem without a bound is a geometric program; "" if there are none.

    That its terms are log-convex is read from the tape, as if every variable were log.
    """
    if isinstance(problem, Conic) or result.value is None or result.status == "optimal":
        return ""
    (low, high, _), variables = problem.bounds(), [v for v, _ in problem.columns]
    plain = list(dict.fromkeys(v.name for v in variables if not v.log))
    if any(v.discrete for v in variables) or (low < 0.0).any():
        return ""
    try:
        known = result.bound is not None
        if known or not plain or not log_convex_in_logarithms(problem):
            return ""
    except SolveError:  # no tape
        return ""
    more = {
        "a lower bound above 0": [
            n for (_, n), a in zip(problem.columns, low, strict=True) if not a
        ],
        "a finite upper bound": [
            n for (_, n), b in zip(problem.columns, high, strict=True) if np.isinf(b)
        ],
    }
    needs = "".join(f", {what} for {', '.join(names)}" for what, names in more.items() if names)
    steps = f"declare log=True for {', '.join(plain)}{needs}"
    return f"{steps}: then this is a geometric program, whose optimum is proven"


def _started(problem: Problem | Conic, method: str, start: Mapping[str, Any]) -> Problem | Conic:
    """Return the problem with a start as its guess; variables that it leaves out keep theirs."""
    if isinstance(problem, Conic):
        if not any(v.discrete for v, _ in problem.columns):
            raise SolveError(
                f"a start changes nothing: {problem.name} is convex and continuous, and {method} "
                "finds its optimum from anywhere; leave start out"
            )
        return problem.starting(_point(problem, start))
    known = [n for n in back_ends() if getattr(_module(n), "FROM_GUESS", False)]
    of_problem = method in problem.methods
    if not (of_problem or method in known):
        takes = f"; these do: {', '.join(known)}"
        raise SolveError(f"{method} takes no start{takes}; leave start out")
    return problem.starting(_point(problem, start))


def _module(name: str) -> Any:
    return import_module(f"gearopt.optimise.solvers.{name}")


def _point(problem: Problem | Conic, start: Mapping[str, Any]) -> Array:
    """Return the guess (n,) with the values of a start by name, as declared or as a design has it.

    ValueError names a value that is none, or lies outside the bounds or the values of its variable.
    """
    low, high, guess = problem.bounds()
    x, places = guess.copy(), _places(problem)
    for name, value in start.items():
        if name not in places:
            declared = dict.fromkeys(
                n.rsplit("[", 1)[0] if v.size > 1 else n for v, n in problem.columns
            )
            raise ValueError(f"start: no variable {name!r}; variables: {', '.join(declared)}")
        where = places[name]
        try:
            values = np.ravel(np.asarray(value, float))
        except (TypeError, ValueError):
            values = np.array([np.nan])
        if len(values) != len(where) or not np.isfinite(values).all():
            sort = "a number" if len(where) == 1 else f"{len(where)} numbers"
            raise ValueError(f"start: {name}={value!r}: write {sort}")
        x[where] = values
    for (variable, name), v, a, b in zip(problem.columns, x, low, high, strict=True):
        if not a <= v <= b:
            raise ValueError(f"start: {name}={v:g} lies outside its bounds {a:g} to {b:g}")
        if variable.values is not None and v not in variable.values:
            raise ValueError(f"start: {name}={v:g} is none of its values {variable.values}")
        if variable.values is None and variable.integer and v != round(v):
            raise ValueError(f"start: {name}={v:g} is not whole")
    return x


def _places(problem: Problem | Conic) -> dict[str, list[int]]:
    """Return the columns of every name: of a variable, of a key of a design, of one component."""
    places: dict[str, list[int]] = {}
    for k, (variable, name) in enumerate(problem.columns):
        head = name.rsplit("[", 1)[0] if variable.size > 1 else name
        for key in {head, f"{head}_{variable.unit}" if variable.unit else head, name}:
            places.setdefault(key, []).append(k)
    return places
