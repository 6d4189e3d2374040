"""Methods compared fairly: the same model, seeds and budget for all, every answer checked by us.

Equal evaluations: every run ends at the same number of what its method counts as one. Equal time:
every run ends at the same wall seconds. Start-up is measured before and belongs to neither.

A method's module says what must be known of it: RANDOM (another seed is another run), PACED (it
plans ahead for the evaluations it is given), COUNTS (what it counts as one), SETTINGS. COUNTS and
SETTINGS are by method where a module holds several. What a module leaves out is taken as random,
not paced, with steps of its own.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from gearopt.errors import GearoptError, SolveError
from gearopt.optimise.certificate import Verdict
from gearopt.optimise.clock import Clock, following, in_part, of_problem
from gearopt.optimise.comparing.comparison import Comparison, Group, Row, Run, sample
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.own_methods import run_method
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome
from gearopt.optimise.scale import zero_scale
from gearopt.optimise.solve import GAP, judge, method_of
from gearopt.optimise.terms import Array

WARM = Budget(seconds=1.0, evaluations=256)  # two generations, eight moves of every chain
ROUNDING = 1e-9  # relative; a method's word that is better than the checked value by more is noted


@dataclass(frozen=True)
class Model:
    """A problem with what a reader calls it, and the unit of its objective."""

    problem: Problem | Conic
    words: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Entry:
    """A method with its own fresh copy of its model's problem, warmed up.

    start_up: seconds of the first short call less those of the same call again. seconds,
    evaluations, finished: of the latter. refused: why it cannot take the problem.
    """

    method: str
    model: Model | None = None
    problem: Problem | Conic | None = None
    random: bool = True
    paced: bool = False
    counts: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    start_up: float = 0.0
    seconds: float = 0.0
    evaluations: int = 0
    finished: bool = False
    refused: str = ""


def enter(method: str, model: Callable[[str], Model]) -> Entry:
    """Pose the problem to a method and warm it up: the first call less the same call again."""
    try:
        posed = model(method)
    except SolveError as refusal:
        return Entry(method, refused=str(refusal))
    problem = replace(posed.problem)
    run = method_of(problem, method)
    module = sys.modules.get(getattr(run, "__module__", ""))
    entry = Entry(
        method,
        posed,
        problem,
        getattr(module, "RANDOM", True),
        getattr(module, "PACED", False),
        _own(method, getattr(module, "COUNTS", "step of its own")),
        _own(method, getattr(module, "SETTINGS", {})),
    )
    times = []
    try:
        for _ in range(2):
            clock = Clock()
            outcome = run_method(run, problem, method, WARM, 0, None)
            times.append(clock.seconds)
    except SolveError as refusal:
        return replace(entry, refused=str(refusal))
    return replace(
        entry,
        start_up=max(0.0, times[0] - times[1]),
        seconds=times[1],
        evaluations=outcome.evaluations,
        finished=outcome.finished,
    )


def _own(method: str, declared: Any) -> Any:
    """Return what a module declares of a method: the same for all of them, or by name."""
    by_name = isinstance(declared, Mapping) and method in declared
    return declared[method] if by_name else declared


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
        run = method_of(problem, method)
        outcome = run_method(run, problem, method, budget, seed, watch)
        seconds = clock.seconds
        verdict = judge(problem, method, outcome, GAP)
    except GearoptError as broken:
        seconds = clock.seconds
        outcome, verdict = Outcome(None), Verdict("failed", message=str(broken))
    if stopped:
        return None
    found = [e for e in events if e["best"] is not None]
    x = None if verdict.objective is None else outcome.x
    return _clipped(
        Run(
            seed,
            verdict.status,
            verdict.objective,
            verdict.bound,
            verdict.certificate.get("feasibility"),
            outcome.evaluations,
            seconds,
            verdict.message,
            steps=tuple((e["seconds"], e["evaluations"], e["best"]) for e in found),
            scale=0.0 if x is None else _scale(problem, x, verdict),
        )
    )


def _scale(problem: Problem | Conic, x: Array, verdict: Verdict) -> float:
    """Return what a gap of this point is measured by, if its objective is zero."""
    return verdict.certificate.get("scale") or zero_scale(problem, x)


def _clipped(run: Run) -> Run:
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


EVALUATIONS, SECONDS, SEEDS = 20_000, 2.0, 25
PATIENCE = 10.0  # times the seconds: the end of a run by evaluations whose evaluations are slow
BOUND_SECONDS = 60.0
KINDS = ("equal_evaluations", "equal_time")


@dataclass(frozen=True)
class Plan:
    """The budget of every run, and the number of seeds of random methods."""

    evaluations: int = EVALUATIONS
    seconds: float = SECONDS
    seeds: int = SEEDS


@dataclass(frozen=True)
class Progress:
    """Where a comparison is: runs done and in all, the present one, and the time left [s]."""

    done: int
    total: int
    method: str
    seed: int
    left: float
    event: Event | None = None


Follow = Callable[[Progress], bool]


@dataclass(frozen=True)
class _Job:
    """One run to be made: by evaluations or by time."""

    entry: Entry
    seed: int
    kind: str


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
    entries = [enter(method, model) for method in dict.fromkeys(methods)]
    if not any(not e.refused for e in entries):
        raise SolveError(
            "; ".join(dict.fromkeys(e.refused for e in entries)) or "no method was named"
        )
    runs: dict[tuple[str, str], list[Run]] = {}
    bound = None if bound_from is None else _bound(bound_from, model, watch)
    jobs = [
        _Job(entry, seed, kind)
        for seed in range(plan.seeds)
        for entry in entries
        for kind in KINDS
        if not entry.refused and (seed == 0 or entry.random)
    ]
    done = _work(jobs, plan, watch, runs)
    message = ""
    if done < len(jobs):
        message = f"stopped after {done} of {len(jobs)} runs; the others were not made"
    return Comparison(
        _groups(entries, runs, bound),
        tuple(range(plan.seeds)),
        {
            "evaluations": plan.evaluations,
            "seconds": plan.seconds,
            "patience_seconds": PATIENCE * plan.seconds,
        },
        {e.method: dict(e.settings) for e in entries if not e.refused},
        bound_from=bound_from,
        complete=not message,
        message=message,
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
    run = method_of(problem, method)
    outcome = run_method(run, problem, method, Budget(BOUND_SECONDS), 0, follow)
    bound = judge(problem, method, outcome, GAP).bound
    return None if bound is None else (problem.name, method, bound)


def _work(
    jobs: Sequence[_Job], plan: Plan, watch: Follow | None, runs: dict[tuple[str, str], list[Run]]
) -> int:
    """Make the runs in turn, so that a drift of the machine meets all methods; return how many."""
    expected = {(j.entry.method, j.kind): _expected(j, plan) for j in jobs}
    for done, job in enumerate(jobs):
        left = sum(expected[j.entry.method, j.kind] for j in jobs[done:])
        now = Progress(done, len(jobs), job.entry.method, job.seed, left)

        def follow(event: Event | None, now: Progress = now) -> bool:
            return watch is None or watch(replace(now, event=event)) is not False

        before = runs.get((job.entry.method, KINDS[0]), [])
        run = (
            attempt(job.entry, job.seed, _budget(job, plan, before), follow)
            if follow(None)
            else None
        )
        if run is None:
            return done
        runs.setdefault((job.entry.method, job.kind), []).append(run)
        expected[job.entry.method, job.kind] = run.seconds
    return len(jobs)


def _expected(job: _Job, plan: Plan) -> float:
    """Estimate the seconds of a run from its warm-up and the runs made so far."""
    entry = job.entry
    if entry.finished and not entry.paced:
        return entry.seconds
    if job.kind == KINDS[1]:
        return plan.seconds
    seconds = entry.seconds * plan.evaluations / max(entry.evaluations, 1)
    return min(seconds, (PATIENCE if entry.paced else 1.0) * plan.seconds)


def _budget(job: _Job, plan: Plan, before: Sequence[Run]) -> Budget:
    """Return the budget of a run, with evaluations for a method that plans ahead."""
    if job.kind == KINDS[0]:
        return Budget(PATIENCE * plan.seconds, plan.evaluations)
    if not job.entry.paced or not before:
        return Budget(plan.seconds)
    speed = before[-1].evaluations / max(before[-1].seconds, 1e-6)
    return Budget(plan.seconds, max(1, round(speed * plan.seconds)))


def _groups(
    entries: Sequence[Entry],
    runs: Mapping[tuple[str, str], list[Run]],
    bound: tuple[str, str, float] | None,
) -> tuple[Group, ...]:
    """Return one group per model; a method without a model stands in the first one."""
    names = list(dict.fromkeys(e.model.problem.name for e in entries if e.model is not None))
    groups = []
    for name in names:
        members = [
            e
            for e in entries
            if (e.model.problem.name == name if e.model is not None else name == names[0])
        ]
        groups.append(_group(name, members, runs, bound))
    return tuple(groups)


def _group(
    name: str,
    members: Sequence[Entry],
    runs: Mapping[tuple[str, str], list[Run]],
    bound: tuple[str, str, float] | None,
) -> Group:
    model = next(e.model for e in members if e.model is not None)
    own = [
        (e.method, run) for e in members for kind in KINDS for run in runs.get((e.method, kind), [])
    ]
    bounds = [(run.bound, method) for method, run in own if run.bound is not None]
    if bound is not None and bound[0] == name:
        bounds.append((bound[2], bound[1]))
    values = [(run.objective, run.scale) for _, run in own if run.objective is not None]
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
        tuple(_row(e, runs, reference, scale) for e in members),
        scale,
    )


def _row(
    entry: Entry,
    runs: Mapping[tuple[str, str], list[Run]],
    reference: float | None,
    scale: float,
) -> Row:
    by_count, by_time = (runs.get((entry.method, kind), []) for kind in KINDS)
    return Row(
        entry.method,
        entry.random,
        entry.counts,
        None if entry.refused else entry.start_up,
        entry.refused,
        sample(by_count, reference, scale, by_time=False),
        sample(by_time, reference, scale, by_time=True),
    )
