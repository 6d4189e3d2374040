"""Methods compared fairly: the same model, seeds and budget for all, every answer checked by us.

Equal evaluations: every run ends at the same number of what its method counts as one. Equal time:
every run ends at the same wall seconds. Start-up is measured before and belongs to neither.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from gearopt.errors import SolveError
from gearopt.optimise.clock import in_part, of_problem
from gearopt.optimise.comparing.comparison import Comparison, Group, Row, Run, sample
from gearopt.optimise.comparing.trial import Entry, Model, attempt, enter
from gearopt.optimise.result import Budget, Event
from gearopt.optimise.solve import GAP, judge, method_of

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

    def __post_init__(self) -> None:
        if self.evaluations < 1 or not self.seconds > 0 or self.seeds < 1:
            raise ValueError("needs evaluations >= 1, seconds > 0 and seeds >= 1")


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
        raise SolveError("; ".join(e.refused for e in entries) or "no method was named")
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
    """Name of the model, the method, and the bound that one long run of a method proves for it."""
    posed = model(method)
    problem = replace(posed.problem)

    def told(event: Event) -> bool:
        return watch is None or watch(Progress(0, 0, method, 0, 0.0, event)) is not False

    follow = of_problem(in_part(told, posed.unit), problem)
    outcome = method_of(problem, method)(problem, Budget(BOUND_SECONDS), 0, follow)
    bound = judge(problem, method, outcome, GAP).bound
    return None if bound is None else (problem.name, method, bound)


def _work(
    jobs: Sequence[_Job], plan: Plan, watch: Follow | None, runs: dict[tuple[str, str], list[Run]]
) -> int:
    """Make the runs in turn, so that a drift of the machine meets all methods alike; how many."""
    expected = {(j.entry.method, j.kind): _expected(j, plan) for j in jobs}
    for done, job in enumerate(jobs):
        left = sum(expected[j.entry.method, j.kind] for j in jobs[done:])
        now = Progress(done, len(jobs), job.entry.method, job.seed, left)

        def told(event: Event | None, now: Progress = now) -> bool:
            return watch is None or watch(replace(now, event=event)) is not False

        before = runs.get((job.entry.method, KINDS[0]), [])
        run = attempt(job.entry, job.seed, _budget(job, plan, before), told) if told(None) else None
        if run is None:
            return done
        runs.setdefault((job.entry.method, job.kind), []).append(run)
        expected[job.entry.method, job.kind] = run.seconds
    return len(jobs)


def _expected(job: _Job, plan: Plan) -> float:
    """A guess of the seconds of a run, from its warm-up; runs that are made correct it."""
    entry = job.entry
    if entry.finished and not entry.paced:
        return entry.seconds
    if job.kind == KINDS[1]:
        return plan.seconds
    seconds = entry.seconds * plan.evaluations / max(entry.evaluations, 1)
    return min(seconds, (PATIENCE if entry.paced else 1.0) * plan.seconds)


def _budget(job: _Job, plan: Plan, before: Sequence[Run]) -> Budget:
    """A method that plans ahead is told how many evaluations its time will allow."""
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
    """One group a model; a method without a model stands in the first one, with its reason."""
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
