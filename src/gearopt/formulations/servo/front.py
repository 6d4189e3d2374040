"""All servo trains that no other beats in two or three objectives, by exhaustion.

A kernel goes through every first stage and lists the trains that no train of a sample of the front
so far beats; what it drops by lower bounds is beaten by one of the sample (`front_kernel`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.servo import split
from gearopt.formulations.servo.choice import Choice, binding, text, train_problem
from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split import teeth
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.pareto.measures import TIE, unbeaten
from gearopt.optimise.pareto.posed import caps
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

RANDOM = False
COUNTS = "choice of teeth and modules"
KERNEL = "gearopt.formulations.servo.front_kernel"
SAMPLE = 250  # trains of a front that others are held against
KERNEL_STEPS = 1_000_000  # of the kernel between two checks of the clock
# trains that wait for the next front, at most; before the first one
MAX_WAITING, FIRST_FRONT = 20_000, 50
SENTENCE = (
    "Proof: all choices of teeth and modules examined, in {count:,} first stages; no other train "
    "that meets all limits is Pareto-optimal."
)
NO_TRAIN_IN_RANGE = (
    "no train that meets all limits has objectives within the largest values of interest"
)


def front_problem(choice: Choice, goals: Sequence[str]) -> Problem:
    """Return the problem of a train with several objectives, in the units that are shown.

    goals: of `ServoTrain.goals`. `exact` proves the whole front; it keeps a box, which is no row.
    """
    base = split.problem(choice.train, *goals)

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return every train that none beats; the seed changes nothing."""
        clock = Clock(budget, watch)
        first = _end(choice, _ordered(goals)[0], clock)
        if first.x is None:
            return first
        points, worth = front(choice, goals, clock, first.x[None])
        factors, known = [GOALS[name].factor for name in goals], caps(problem)
        limits = np.array([known.get(name, np.inf) for name in goals])
        inside = (worth * factors <= limits * (1.0 + TIE)).all(axis=1)
        return _outcome(choice, points[inside], clock)

    variables, methods = base.variables, {"exact": exact}
    return Problem("trains", variables, (), text(choice, base), methods=methods)


def _ordered(goals: Sequence[str]) -> list[str]:
    """Return objectives, that of a motion first: its limits hold for all trains."""
    return sorted(goals, key=lambda name: not GOALS[name].motion)


def _end(choice: Choice, goal: str, clock: Clock) -> Outcome:
    """Return the best train by one objective, or the proof that there is none."""
    if (bound := binding(choice.backlash)) is not None:
        return bound
    posed = train_problem(replace(choice, goal=goal))
    outcome: Outcome = posed.methods["exact"](posed, clock.left, 0, clock.inner(values=False))
    clock.evaluations += outcome.evaluations
    return outcome


def _outcome(choice: Choice, points: Array, clock: Clock) -> Outcome:
    looked, done = clock.evaluations, not clock.stopped
    x, others = (points[0], tuple(points[1:])) if len(points) else (None, ())
    if not done:
        said = "stopped by the budget: trains may be missing"
        return Outcome(x, others=others, finished=False, evaluations=looked, message=said)
    stages = kernel(teeth.KERNEL).first_stages(split.posed(choice.train, choice.goal)[0])[0]
    proof = {"method": "exhausted", "sentence": SENTENCE.format(count=int(stages))}
    if x is None:
        return Outcome(
            None, infeasible=True, proof=proof, evaluations=looked, message=NO_TRAIN_IN_RANGE
        )
    return Outcome(x, others=others, proof=proof, evaluations=looked)


def front(
    choice: Choice, goals: Sequence[str], clock: Clock, known: Array | None = None
) -> tuple[Array, Array]:
    """Return points and objectives, `goals`, of the Pareto front of trains, by the first of them.

    known (n, 6): trains that meet all limits, to begin with. `clock.stopped`: trains are missing.
    Trains are listed in parts, without those that a sample of the front so far beats.
    """
    ranked, look = _ordered(goals), kernel(KERNEL).unbeaten
    posed, (given, _) = split.problem(choice.train, *ranked), split.posed(choice.train, ranked[0])
    aims, spring = np.array([list(GOALS).index(g) for g in ranked]), choice.kept.spring
    longest = int(given.wheel_2.max()) + 1
    rows = np.empty((max(MAX_WAITING, 2 * longest), 6), np.int64)
    at, end = np.array([0, -1, -1]), kernel(teeth.KERNEL).first_stages(given)[0]
    best, worth, duty = np.empty((0, 6)), np.empty((0, len(goals))), np.zeros(1)
    if known is not None:
        best, worth = known, posed.batch(known).F
    count, sample = 0, worth
    while at[0] < end and clock.tell():
        if not count:
            sample = _sample(worth)
        count += look(given, aims, spring, sample, at, duty, rows[count:], KERNEL_STEPS)
        if at[0] < end and count < min(FIRST_FRONT + len(best), len(rows) - longest):
            continue
        points, count = split.points(given, rows[:count]), 0
        best, worth = _unbeaten_points(choice, posed, best, worth, points, clock)
    columns = [ranked.index(name) for name in goals]
    order = np.argsort(worth[:, columns[0]], kind="stable")
    return best[order], worth[order][:, columns]


def _unbeaten_points(
    choice: Choice, posed: Problem, best: Array, worth: Array, found: Array, clock: Clock
) -> tuple[Array, Array]:
    """Unbeaten points of a front and of other trains that fit the box."""
    if not len(found):
        return best, worth
    values = posed.batch(found).F
    if choice.room is not None:
        fits = _fitting_trains(choice, worth, found, values, clock)
        found, values = found[fits], values[fits]
    best, worth = np.vstack([best, found]), np.vstack([worth, values])
    kept = unbeaten(worth)
    return best[kept], worth[kept]


def _fitting_trains(
    choice: Choice, worth: Array, found: Array, values: Array, clock: Clock
) -> list[int]:
    """Return which trains fit the box; those beaten by one that fits, or by a front, may miss.

    Whatever beats a train comes before it, so each is judged once.
    """
    known, fits = worth, []
    for k in np.lexsort(values.T[::-1]).tolist():
        if (known < values[k] * (1.0 - TIE)).all(axis=1).any():
            continue
        if not clock.tell():
            break
        if choice.keeps(found[k]):
            known = np.vstack([known, values[k]])
            fits.append(k)
    return fits


def _sample(worth: Array) -> Any:
    """Return some trains of a front that beat as many others as possible."""
    rows = np.linspace(0, len(worth) - 1, min(SAMPLE, len(worth))).round().astype(int)
    return np.ascontiguousarray(worth[rows])
