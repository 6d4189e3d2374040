"""The runs of a comparison: methods warmed up, each run by evaluations and by time, in turn.

A method's module says what must be known of it: RANDOM (another seed is another run), PACED (it
plans ahead for the evaluations it is given), COUNTS (what it counts as one), SETTINGS. Each is by
method where a module holds several. What a module leaves out is taken as random, not paced, with
steps of its own.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, Protocol, TypeVar

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.plan import Follow, Model, Plan, Progress
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.found import Found
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome

WARM = Budget(seconds=1.0, evaluations=256)  # two generations, eight moves of every chain
PATIENCE = 10.0  # times the seconds: the end of a run by evaluations whose evaluations are slow
KINDS = ("equal_evaluations", "equal_time")


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


def entered(
    methods: Sequence[str], enter: Callable[[str], Entry], watch: Follow | None
) -> list[Entry]:
    """Return the entry of every method; SolveError where none takes the problem.

    watch is told of each before its start-up, as run 0 of 0; to stop there is to make no run.
    """
    entries = []
    for method in dict.fromkeys(methods):
        if watch is not None:
            watch(Progress(0, 0, method, 0, 0.0))
        entries.append(enter(method))
    if not any(not e.refused for e in entries):
        raise SolveError(
            "; ".join(dict.fromkeys(e.refused for e in entries)) or "no method was named"
        )
    return entries


def warmed(entry: Entry, module: Any, run: Callable[[], Outcome | Found]) -> Entry:
    """Entry with the declarations of its method's module, after two short runs."""
    entry = replace(
        entry,
        random=_own(entry.method, getattr(module, "RANDOM", True)),
        paced=_own(entry.method, getattr(module, "PACED", False)),
        counts=_own(entry.method, getattr(module, "COUNTS", "step of its own")),
        settings=_own(entry.method, getattr(module, "SETTINGS", {})),
    )
    times = []
    try:
        for _ in range(2):
            clock = Clock()
            outcome = run()
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
    """Declaration of a module for a method: the same for all of them, or by name."""
    by_name = isinstance(declared, Mapping) and method in declared
    return declared[method] if by_name else declared


@dataclass(frozen=True)
class Job:
    """One run to be made: by evaluations or by time."""

    entry: Entry
    seed: int
    kind: str


class Made(Protocol):
    """Time and evaluations of a run, all that planning needs."""

    @property
    def seconds(self) -> float:
        """Seconds of the method alone."""

    @property
    def evaluations(self) -> int:
        """Number of evaluations, in the method's own count."""


M = TypeVar("M", bound=Made)
Runs = dict[tuple[str, str], list[M]]  # by method and what is equal
Attempt = Callable[[Entry, int, Budget, Callable[[Event], bool]], M | None]


def work(
    entries: Sequence[Entry], make: Attempt[M], plan: Plan, watch: Follow | None
) -> tuple[Runs[M], str]:
    """Make all runs in turn, so that a drift of the machine meets all methods.

    make: one run, None where it was ended. Returned with a message where some were not made.
    """
    jobs = [
        Job(entry, seed, kind)
        for seed in range(plan.seeds)
        for entry in entries
        for kind in KINDS
        if not entry.refused and (seed == 0 or entry.random)
    ]
    runs: Runs[M] = {}
    expected = {(j.entry.method, j.kind): _expected(j, plan) for j in jobs}
    for done, job in enumerate(jobs):
        left = sum(expected[j.entry.method, j.kind] for j in jobs[done:])
        now = Progress(done, len(jobs), job.entry.method, job.seed, left)

        def follow(event: Event | None, now: Progress = now) -> bool:
            return watch is None or watch(replace(now, event=event)) is not False

        before = runs.get((job.entry.method, KINDS[0]), [])
        budget = _budget(job, plan, before)
        attempt = make(job.entry, job.seed, budget, follow) if follow(None) else None
        if attempt is None:
            return runs, f"stopped after {done} of {len(jobs)} runs; the others were not made"
        runs.setdefault((job.entry.method, job.kind), []).append(attempt)
        expected[job.entry.method, job.kind] = attempt.seconds
    return runs, ""


def _expected(job: Job, plan: Plan) -> float:
    """Estimate the seconds of a run from its warm-up and the runs made so far."""
    entry = job.entry
    if entry.finished and not entry.paced:
        return entry.seconds
    if job.kind == KINDS[1]:
        return plan.seconds
    seconds = entry.seconds * plan.evaluations / max(entry.evaluations, 1)
    return min(seconds, (PATIENCE if entry.paced else 1.0) * plan.seconds)


def _budget(job: Job, plan: Plan, before: Sequence[Made]) -> Budget:
    """Return the budget of a run, with evaluations for a method that plans ahead."""
    if job.kind == KINDS[0]:
        return Budget(PATIENCE * plan.seconds, plan.evaluations)
    if not job.entry.paced or not before:
        return Budget(plan.seconds)
    speed = before[-1].evaluations / max(before[-1].seconds, 1e-6)
    return Budget(plan.seconds, max(1, round(speed * plan.seconds)))


def by_model(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    """Return the entries of every model by its name; one without a model is in the first."""
    names = list(dict.fromkeys(e.model.problem.name for e in entries if e.model is not None))
    entries_by_model: dict[str, list[Entry]] = {name: [] for name in names}
    for e in entries:
        entries_by_model[names[0] if e.model is None else e.model.problem.name].append(e)
    return entries_by_model
