"""One method on one problem: posed, warmed up, run, timed by our clock, judged by our certificate.

A method's module says what must be known of it: RANDOM (another seed is another run), PACED (it
plans ahead for the evaluations it is given), COUNTS (what it counts as one), SETTINGS. COUNTS and
SETTINGS are by method where a module holds several. What a module leaves out is taken as random,
not paced, with steps of its own.
"""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from gearopt.errors import GearoptError, SolveError
from gearopt.optimise.certificate import Verdict
from gearopt.optimise.clock import Clock, following, in_part, of_problem
from gearopt.optimise.comparing.comparison import Run
from gearopt.optimise.conic.problem import Conic
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
            outcome: Outcome = run(problem, WARM, 0, None)
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
    """What a module declares of a method: the same of all its methods, or by their names."""
    by_name = isinstance(declared, Mapping) and method in declared
    return declared[method] if by_name else declared


def attempt(entry: Entry, seed: int, budget: Budget, told: Callable[[Event], bool]) -> Run | None:
    """One run; None where `told` ended it. What is wrong with an answer is the run's message."""
    problem, method = entry.problem, entry.method
    assert problem is not None
    clock = Clock()
    stopped = False

    def goes_on(event: Event) -> bool:
        nonlocal stopped
        stopped = stopped or not told(event)
        return not stopped

    followed, events = following(goes_on)
    unit = "" if entry.model is None else entry.model.unit
    watch = of_problem(in_part(followed, unit), problem)
    try:
        outcome = method_of(problem, method)(problem, budget, seed, watch)
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
    """What a gap of this point is measured by, if its objective is zero."""
    return verdict.certificate.get("scale") or zero_scale(problem, x)


def _clipped(run: Run) -> Run:
    """No step may be better than the point that was checked, and that point ends the steps."""
    value = run.objective
    if value is None:
        return replace(run, steps=())
    clipped = any(best < value - ROUNDING * abs(value) for _, _, best in run.steps)
    steps = [(s, n, max(best, value)) for s, n, best in run.steps]
    if not steps or steps[-1][2] > value:
        steps.append((run.seconds, run.evaluations, value))
    firsts = [s for k, s in enumerate(steps) if k == 0 or s[2] < steps[k - 1][2]]
    return replace(run, steps=tuple(firsts), clipped=clipped)
