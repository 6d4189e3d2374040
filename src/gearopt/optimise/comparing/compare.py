"""Methods compared fairly: the same model, seeds and budget for all, every answer checked by us.

Equal evaluations: every run ends at the same number of what its method counts as one. Equal time:
every run ends at the same wall seconds. Start-up is measured before and belongs to neither.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from gearopt.errors import GearoptError, SolveError
from gearopt.optimise.certificate import Verdict
from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock, following, in_part, of_problem
from gearopt.optimise.comparing.comparison import Comparison, Group, Row, Run, sample
from gearopt.optimise.comparing.plan import Follow, Model, Plan, Progress
from gearopt.optimise.comparing.runs import (
    KINDS,
    PATIENCE,
    WARM,
    Entry,
    by_model,
    entered,
    warmed,
    work,
)
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.methods import run_method
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome
from gearopt.optimise.scale import zero_scale
from gearopt.optimise.solve import judge, method_of
from gearopt.optimise.terms import Array

T = TypeVar("T")
BOUND_SECONDS = 60.0
ROUNDING = 1e-9  # relative; a method's word that is better than the checked value by more is noted


def enter(method: str, model: Callable[[str], Model]) -> Entry:
    """Pose the problem to a method and warm it up: the first call less the same call again."""
    try:
        posed = model(method)
    except SolveError as refusal:
        return Entry(method, refused=str(refusal))
    problem = replace(posed.problem)
    solver = method_of(problem, method)
    return warmed(
        Entry(method, posed, problem),
        sys.modules.get(getattr(solver, "__module__", "")),
        lambda: run_method(solver, problem, method, WARM, 0, None),
    )


def attempt(entry: Entry, seed: int, budget: Budget, follow: Callable[[Event], bool]) -> Run | None:
    """Make one run; None where `follow` ended it. An error of the method is the run's message."""
    problem, method = entry.problem, entry.method
    assert problem is not None
    clock = Clock()
    stopped = False

    def continues(event: Event) -> bool:
        nonlocal stopped
        stopped = stopped or not follow(event)
        return not stopped

    followed, events = following(continues)
    unit = "" if entry.model is None else entry.model.unit
    watch = of_problem(in_part(followed, unit), problem)
    try:
        solver = method_of(problem, method)
        outcome = run_method(solver, problem, method, budget, seed, watch)
        seconds = clock.seconds
        verdict = judge(problem, method, outcome, GAP)
    except GearoptError as broken:
        seconds = clock.seconds
        outcome, verdict = Outcome(None), Verdict("failed", message=str(broken))
    if stopped:
        return None
    improvements = [e for e in events if e["best"] is not None]
    x = None if verdict.objective is None else outcome.x
    return clipped(
        Run(
            seed,
            verdict.status,
            verdict.objective,
            verdict.bound,
            verdict.certificate.get("feasibility"),
            outcome.evaluations,
            seconds,
            verdict.message,
            steps=tuple((e["seconds"], e["evaluations"], e["best"]) for e in improvements),
            scale=0.0 if x is None else _scale(problem, x, verdict),
        )
    )


def _scale(problem: Problem | Conic, x: Array, verdict: Verdict) -> float:
    """Scale of a gap of this point, if its objective is zero."""
    return verdict.certificate.get("scale") or zero_scale(problem, x)


def clipped(run: Run) -> Run:
    """Make no step better than the point that was checked, which ends the steps."""
    value = run.objective
    if value is None:
        return replace(run, steps=())
    clipped = any(best < value - ROUNDING * abs(value) for _, _, best in run.steps)
    steps = [(s, n, max(best, value)) for s, n, best in run.steps]
    if not steps or steps[-1][2] > value:
        steps.append((run.seconds, run.evaluations, value))
    firsts = [s for k, s in enumerate(steps) if k == 0 or s[2] < steps[k - 1][2]]
    return replace(run, steps=tuple(firsts), clipped=clipped)


def compare(
    methods: Sequence[str],
    model: Callable[[str], Model],
    plan: Plan | None = None,
    watch: Follow | None = None,
    bound_from: str | None = None,
) -> Comparison:
    """Run every method on the model it takes, by evaluations and by time, and judge all runs.

    model(method) -> Model, or SolveError where it has none. bound_from: a method that is run once
    beside the comparison, for BOUND_SECONDS at the most, to prove a bound. watch(progress) ends
    the comparison by returning False; the runs finished by then are reported, the one under way
    is dropped. SolveError where a method is unknown or none takes the problem.
    """
    import casadi  # noqa: F401  # every check needs it: its import is no method's start-up

    plan = plan or Plan()
    entries = entered(methods, lambda method: enter(method, model), watch)
    bound = None if bound_from is None else _bound(bound_from, model, watch)
    runs, message = work(entries, attempt, plan, watch)
    return compared(_groups(entries, runs, bound), entries, plan, message, bound_from=bound_from)


def compared(
    groups: tuple[Group, ...],
    entries: Sequence[Entry],
    plan: Plan,
    message: str,
    **names: Any,
) -> Comparison:
    """Groups with their data; message: "" where every run was made."""
    return Comparison(
        groups,
        tuple(range(plan.seeds)),
        {
            "evaluations": plan.evaluations,
            "seconds": plan.seconds,
            "patience_seconds": PATIENCE * plan.seconds,
        },
        {e.method: dict(e.settings) for e in entries if not e.refused},
        complete=not message,
        message=message,
        **names,
    )


def _bound(
    method: str, model: Callable[[str], Model], watch: Follow | None
) -> tuple[str, str, float] | None:
    """Return model, method, and the bound that one long run of the method proves."""
    posed = model(method)
    problem = replace(posed.problem)

    def continues(event: Event) -> bool:
        return watch is None or watch(Progress(0, 0, method, 0, 0.0, event)) is not False

    follow = of_problem(in_part(continues, posed.unit), problem)
    solver = method_of(problem, method)
    outcome = run_method(solver, problem, method, Budget(BOUND_SECONDS), 0, follow)
    bound = judge(problem, method, outcome, GAP).bound
    return None if bound is None else (problem.name, method, bound)


def _groups(
    entries: Sequence[Entry],
    runs: Mapping[tuple[str, str], list[Run]],
    bound: tuple[str, str, float] | None,
) -> tuple[Group, ...]:
    """Return one group per model."""
    return tuple(_group(n, found, runs, bound) for n, found in by_model(entries).items())


def _group(
    name: str,
    members: Sequence[Entry],
    runs: Mapping[tuple[str, str], list[Run]],
    bound: tuple[str, str, float] | None,
) -> Group:
    model = next(e.model for e in members if e.model is not None)
    runs_by_method = [
        (e.method, run) for e in members for kind in KINDS for run in runs.get((e.method, kind), [])
    ]
    bounds = [(run.bound, method) for method, run in runs_by_method if run.bound is not None]
    if bound is not None and bound[0] == name:
        bounds.append((bound[2], bound[1]))
    values = [(run.objective, run.scale) for _, run in runs_by_method if run.objective is not None]
    best, scale = min(values, default=(None, 0.0))
    highest, source = max(bounds, default=(None, ""), key=lambda b: b[0])
    reference = best if highest is None else highest
    return Group(
        name,
        model.words,
        model.problem.rows.objectives[0],
        model.unit,
        reference,
        highest is not None,
        source,
        best,
        tuple(row(e, of_kinds(runs, e), reference, scale) for e in members),
        scale,
    )


def of_kinds(runs: Mapping[tuple[str, str], list[T]], entry: Entry) -> list[list[T]]:
    """Runs of a method, by count and by time."""
    return [runs.get((entry.method, kind), []) for kind in KINDS]


def row(entry: Entry, runs: list[list[Run]], reference: float | None, scale: float) -> Row:
    """A method with its runs, by count and by time, beside a reference."""
    by_count, by_time = runs
    return Row(
        entry.method,
        entry.random,
        entry.counts,
        None if entry.refused else entry.start_up,
        entry.refused,
        sample(by_count, reference, scale, by_time=False),
        sample(by_time, reference, scale, by_time=True),
    )
