"""Methods compared by the fronts they find: how much hypervolume is missing, and how far they are.

The reference is the proven front: all designs of an exact search, or points of epsilon constraints.
Where it is not proven complete, whatever any run found is added to it. The objective of such a
comparison is the part of its hypervolume that the points of a run lack, so that its gap is to zero.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.errors import GearoptError, SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.comparing.compare import BOUND_SECONDS, clipped, compared, of_kinds, row
from gearopt.optimise.comparing.comparison import POINTS, Comparison, Group, Run
from gearopt.optimise.comparing.plan import Follow, Model, Plan, Progress
from gearopt.optimise.comparing.runs import (
    KINDS,
    WARM,
    Entry,
    Runs,
    by_model,
    entered,
    warmed,
    work,
)
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto import epsilon
from gearopt.optimise.pareto.found import Found, Step
from gearopt.optimise.pareto.judged import status
from gearopt.optimise.pareto.measures import hypervolume, igd, reference, unbeaten
from gearopt.optimise.pareto.objectives import EPSILON, Limiting
from gearopt.optimise.pareto.posed import posed
from gearopt.optimise.pareto.tradeoff import METHODS, NSGA, SAMPLERS, default_method, found
from gearopt.optimise.problem import Batch, Problem
from gearopt.optimise.result import Budget, Event
from gearopt.optimise.scale import violation
from gearopt.optimise.terms import Array

MISSING = "missing_hypervolume"
REFERENCE_POINTS = {2: 600, 3: 400}  # points of a reference that is not of all designs


@dataclass(frozen=True)
class Goal:
    """Two or three objectives by name, their largest values, and how they are limited."""

    names: tuple[str, ...]
    most: Mapping[str, float]
    limiting: Limiting | None = None

    def front(self, problem: Problem | Conic, method: str, *given: Any, **named: Any) -> Found:
        """Pareto front of these objectives by a method; other arguments as of `tradeoff.found`."""
        named["limiting"] = self.limiting
        return found(problem, self.names, self.most, method, *given, **named)


@dataclass(frozen=True)
class Trial:
    """One run and its points: values (N, k), and how they grew."""

    run: Run
    values: Array
    steps: tuple[Step, ...]

    @property
    def seconds(self) -> float:
        """Return seconds of the method alone."""
        return self.run.seconds

    @property
    def evaluations(self) -> int:
        """Number of evaluations, in the method's own count."""
        return self.run.evaluations


def compare_fronts(
    methods: Sequence[str],
    model: Callable[[str], Model],
    names: Sequence[str],
    most: Mapping[str, float] | None = None,
    plan: Plan | None = None,
    watch: Follow | None = None,
    bound_from: str | None = None,
    limiting: Limiting | None = None,
) -> Comparison:
    """Run methods of fronts by evaluations and by time, and hold them against a reference.

    names: two or three objectives; most: their largest values of interest. bound_from: the method
    of the reference front, by default the one that proves most; it has BOUND_SECONDS.
    limiting: how the kind of problem limits objectives. Else as `compare`.
    """
    import casadi  # noqa: F401  # every check needs it: its import is no method's start-up

    plan, goal = plan or Plan(), Goal(tuple(names), dict(most or {}), limiting)
    entries = entered(methods, lambda method: _enter(method, model, goal), watch)
    models = {e.model.problem.name: e.model for e in entries if e.model is not None}
    known = {name: _standard(one, goal, watch, bound_from) for name, one in models.items()}

    def attempt(
        entry: Entry, seed: int, budget: Budget, follow: Callable[[Event], bool]
    ) -> Trial | None:
        return _attempt(entry, goal, seed, budget, follow)

    runs, message = work(entries, attempt, plan, watch)
    groups = tuple(
        _group(models[name], known[name], len(names), members, runs)
        for name, members in by_model(entries).items()
    )
    about = {"bound_from": bound_from, "objectives": goal.names, "most": goal.most}
    return compared(groups, entries, plan, message, **about)


def _enter(method: str, model: Callable[[str], Model], goal: Goal) -> Entry:
    """Pose the problem to a method and warm it up."""
    if method not in METHODS:
        raise SolveError(f"no method {method!r} for a front; methods: {', '.join(METHODS)}")
    try:
        posed_model = model(method)
    except SolveError as refusal:
        return Entry(method, refused=str(refusal))
    problem = replace(posed_model.problem)
    solver = {EPSILON: epsilon.front, **SAMPLERS, **problem.methods}.get(method)
    return warmed(
        Entry(method, posed_model, problem),
        sys.modules.get(getattr(solver, "__module__", "")),
        lambda: goal.front(problem, method, budget=WARM),
    )


def _attempt(
    entry: Entry, goal: Goal, seed: int, budget: Budget, follow: Callable[[Event], bool]
) -> Trial | None:
    """Make one run; None where `follow` ended it. An error of the method is the run's message."""
    assert entry.problem is not None
    clock, ended = Clock(), False

    def continues(event: Event) -> bool:
        nonlocal ended
        ended = ended or not follow(event)
        return not ended

    try:
        front = found(
            entry.problem, goal.names, goal.most, entry.method, None, budget, seed, continues
        )
    except GearoptError as broken:
        front = Found((), finished=False, message=str(broken))
    seconds = clock.seconds
    if ended:
        return None
    problem = entry.problem
    if isinstance(problem, Conic):
        problem = posed(problem, goal.names[:1], {})
    worst = _violation(problem, front)
    attempted = Run(
        seed, status(front), None, None, worst, front.evaluations, seconds, front.message
    )
    return Trial(attempted, front.values, front.steps)


def _violation(problem: Problem | Conic, made: Found) -> float | None:
    """Return the largest violation of any limit at the points; None without one."""
    if not made.points:
        return None
    points = np.array([p.x for p in made.points])
    batch = problem.batch(points)
    each = (
        Batch(batch.F[k : k + 1], batch.G[k : k + 1], batch.H[k : k + 1], {})
        for k in range(len(points))
    )
    return max(0.0, *(violation(problem, x, b)[0] for x, b in zip(points, each, strict=True)))


def _standard(
    model: Model, goal: Goal, watch: Follow | None, method: str | None
) -> tuple[str, Found] | None:
    """Method of the reference front and its findings; None where nothing proves one."""
    problem = replace(model.problem)
    chosen = method or default_method(problem, goal.limiting)
    if chosen == NSGA:
        return None

    def continues(event: Event) -> bool:
        return watch is None or watch(Progress(0, 0, chosen, 0, 0.0, event)) is not False

    follow = in_part(continues, model.unit, problem.name)
    whole = goal.limiting is not None and goal.limiting.whole
    points = None if whole else REFERENCE_POINTS[len(goal.names)]
    return chosen, goal.front(problem, chosen, points, Budget(BOUND_SECONDS), watch=follow)


def _group(
    model: Model,
    standard: tuple[str, Found] | None,
    count: int,
    members: Sequence[Entry],
    runs: Runs[Trial],
) -> Group:
    """Return the methods of one model with their runs, judged by its reference front."""
    trials = [t for e in members for kind in KINDS for t in runs.get((e.method, kind), [])]
    method, reference_front = standard or ("", Found(()))
    others = [] if reference_front.complete else [t.values for t in trials]  # may beat it
    every = [v for v in (reference_front.values, *others) if len(v)]
    values = np.vstack(every or [np.empty((0, count))])
    values = values[unbeaten(values)]
    corner = reference(values) if len(values) else np.empty(0)
    largest = hypervolume(values, corner) if len(values) else 0.0

    def judged(trial: Trial) -> Run:
        if not len(trial.values):
            return trial.run
        missing = _missing(trial.values, corner, largest)
        steps = tuple(
            (s.seconds, s.evaluations, _missing(s.values, corner, largest))
            for s in _thin(trial.steps)
        )
        distance = igd(trial.values, values)
        return clipped(replace(trial.run, objective=missing, steps=steps, distance=distance))

    known = 0.0 if len(values) else None
    judged_runs = ([[judged(t) for t in part] for part in of_kinds(runs, e)] for e in members)
    rows = tuple(row(e, each, known, 0.0) for e, each in zip(members, judged_runs, strict=True))
    samples = [s for r in rows for s in (r.equal_evaluations, r.equal_time) if s]
    missing = [r.objective for s in samples for r in s.runs if r.objective is not None]
    best = min(missing, default=None)
    proven = status(reference_front) in ("complete", "proven")
    return Group(
        model.problem.name,
        model.words,
        MISSING,
        "",
        0.0 if len(values) else None,
        proven,
        method if proven else "",
        best,
        rows,
        front=_words(method, reference_front, len(values)),
    )


def _missing(values: Array, corner: Array, whole: float) -> float:
    """Return the part of a hypervolume that points (N, k) lack."""
    return min(1.0, max(0.0, 1.0 - hypervolume(values, corner) / whole)) if len(values) else 1.0


def _thin(steps: Sequence[Step]) -> list[Step]:
    """Return at most about POINTS steps, the last one included."""
    every = max(1, len(steps) // POINTS)
    return [*steps[::-1][::every][::-1]]


def _words(method: str, made: Found, count: int) -> str:
    """Sentence on the reference front."""
    start = "Gaps are the part of the hypervolume (of what a front dominates) that is missing"
    designs = f"{count} design" + ("" if count == 1 else "s")
    if not count:
        return "No method found a feasible point: there is no front."
    if made.complete:
        return f"{start}, relative to the complete Pareto front of {designs}, proven ({method})."
    if status(made) == "proven":
        error = "" if made.error is None else f", which leave an error of {made.error:.1g} between"
        proven = f"{len(made.points)} of them each proven ({method}){error}"
        return f"{start}, relative to {designs}, {proven}."
    return f"{start}, relative to the best {designs} found: of this front nothing is proven."
