"""Global search for the least vibration: screened designs, local optima from the best of them.

Between the speeds that are judged resonances may hide; the exchange looks for them on a dense grid,
adds the worst, and solves again. `response_over_speed` is the design as a result holds it.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.dynamics import parts
from gearopt.formulations.dynamics.design import Chosen
from gearopt.formulations.dynamics.motions_over_speed import followed
from gearopt.formulations.dynamics.orbit.climbing import (
    JUDGE_HARMONICS,
    JUDGE_MARGIN,
    Climbed,
    climb,
    largest_multiplier,
    largest_multiplier_in_time,
    measure,
    posed,
)
from gearopt.formulations.dynamics.orbit.impossible import impossible
from gearopt.formulations.dynamics.orbit.orbit_text import reduced
from gearopt.formulations.dynamics.orbit.parting_text import size, worst_motions
from gearopt.formulations.dynamics.orbit.screening import apart, narrowed, screened
from gearopt.formulations.dynamics.orbit.task import (
    MICRO,
    Task,
    fourier_coefficients,
    measured,
    worst,
)
from gearopt.formulations.dynamics.orbit.task import parts as orbit_parts
from gearopt.formulations.dynamics.steady_motion import in_contact
from gearopt.frozen import dataclass
from gearopt.optimise.box import box
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair

RANDOM = True
COUNTS = "design measured or Ipopt iteration"
STARTS, PARTING = 4, 2  # of Ipopt: of a mesh in contact, and of one whose teeth may part
TRIED = 12  # screened designs that are simulated, of which PARTING are starts
DENSE, SIMULATED = 361, 121  # speeds of the judge of an exchange: in contact, and simulated
MAXIMUM_MARGIN = 1e-3  # by which the dense maximum may exceed that of another design met on the way
ROUNDS = 12  # of an exchange at most
SPREAD = 46  # equal steps of speed that are added once an exchange has ended, to look once more
AROUND = 0.05  # of the ranges: first moves of the screened designs as speeds are added
MORE, MOST = 4, 30  # harmonics added where the judge sees another motion; of a problem at most


def methods(task: Task) -> dict[str, Callable[..., Outcome]]:
    """Return the method `screened` of the problem of a task."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        if (never := impossible(task)) is not None:
            return never
        clock = Clock(budget, watch)
        ends = climbed(task, problem, starts(task, screened(task, clock, seed), clock), clock)
        message = "no start led to a design"
        outcome = ends[0].outcome if ends else Outcome(None, True, message=message)
        return replace(outcome, finished=not clock.stopped, evaluations=clock.evaluations)

    return {"screened": run}


def starts(task: Task, pool: Array, clock: Clock) -> Array:
    """Return the designs of a sorted pool (N, 5) from which local optima are looked for.

    Where the multiplier has a limit, those within it come first; where teeth may part, those that
    vibrate least when they are simulated.
    """
    space = box(reduced(task))
    if task.most_growth is not None:
        grown = np.array([largest_multiplier(task, point, clock) for point in pool])
        over = np.maximum(grown - task.most_growth, 0.0)
        pool = pool[np.argsort(over, kind="stable")]
    if task.backlash is None:
        return apart(space, pool, STARTS)
    tried, speeds = apart(space, pool, TRIED), np.array(task.speeds_rpm)
    values = [measure(task, point, speeds, clock).max() for point in tried]
    return tried[np.argsort(values, kind="stable")][:PARTING]


def climbed(task: Task, problem: Problem, points: Array, clock: Clock) -> list[Climbed]:
    """Return the local optima that designs (N, 5) lead to, the best first."""
    ends = []
    for point in points:
        summit = climb(task, problem, point, clock)
        if summit is not None:
            ends.append(summit)
            clock.best = min(summit.judged, clock.best)
        if not clock.tell():
            break
    return sorted(ends, key=lambda end: end.judged)


@dataclass(frozen=True)
class Exchanged:
    """The task with the speeds (and harmonics) that it took, its best design, and the rounds.

    rounds: of each its number of speeds, harmonics, objective and dense maximum [um]. met: the last
    dense maximum is within JUDGE_MARGIN of the objective.
    """

    task: Task
    best: Climbed
    rounds: tuple[dict[str, Any], ...]
    met: bool


def least(task: Task, clock: Clock, seed: int) -> Exchanged | None:
    """Return the design of least vibration at the speeds of a task; None where none was found."""
    points = starts(task, screened(task, clock, seed), clock)
    ends = climbed(task, posed(task), points, clock)
    return Exchanged(task, ends[0], (), False) if ends else None


def exchange(task: Task, clock: Clock, seed: int) -> Exchanged | None:
    """Solve, look at all speeds between the first and the last, add the worst, and solve again.

    Until the dense maximum is the objective within JUDGE_MARGIN, and no design that was met on the
    way has a lower one or no speed is left to add. None where no design was found.
    """
    grid = dense(task)
    rng, pool = np.random.default_rng(seed), screened(task, clock, seed)
    points, known, last = starts(task, pool, clock), list[tuple[float, Array]](), None
    rounds: list[dict[str, Any]] = []
    again = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], SPREAD)
    while True:
        clock.best = np.inf  # of another problem
        ends = climbed(task, posed(task), points, clock)
        if not ends:
            return last
        judged = [measure(task, end.point, grid, clock) for end in ends]
        known += [(float(d.max()), end.point) for d, end in zip(judged, ends, strict=True)]
        lowest, nearest = min(known, key=lambda one: one[0])
        best, highest = ends[0], float(judged[0].max())
        rounds.append(_round(task, best, highest))
        near = highest <= (1.0 + JUDGE_MARGIN) * best.objective
        met = near and highest <= (1.0 + MAXIMUM_MARGIN) * lowest
        peaks = _peaks(grid, judged[0], best.objective)
        wider = _wider(_finer(task, best.point, peaks), again if met else peaks[0])
        met |= near and wider == task  # there is no speed left to add
        last = Exchanged(task, best, tuple(rounds), met)
        if (met and not again.size) or wider == task or len(rounds) == ROUNDS or clock.over:
            return last
        task = wider
        again = np.empty(0) if met else again
        pool = narrowed(task, np.vstack([nearest, best.point, pool]), clock, rng, AROUND)
        points = np.vstack([nearest, best.point, starts(task, pool, clock)])


def dense(task: Task) -> Array:
    """Return the speeds [rpm] on which a design is judged; of simulations the task's among them."""
    ends = task.speeds_rpm[0], task.speeds_rpm[-1]
    if task.backlash is None:
        return np.linspace(*ends, DENSE)
    return np.union1d(np.linspace(*ends, SIMULATED), task.speeds_rpm)


def _round(task: Task, best: Climbed, highest: float) -> dict[str, Any]:
    return {
        "speeds": len(task.speeds_rpm),
        "harmonics": task.harmonics,
        "objective_um": best.objective,
        "dense_um": highest,
    }


def _peaks(grid: Array, judged: Array, objective: float) -> tuple[Array, Array]:
    """Return speeds and measures of the peaks above an objective, and of the highest of all."""
    padded = np.concatenate([[-np.inf], judged, [-np.inf]])
    peak = (judged >= padded[:-2]) & (judged >= padded[2:])
    peak &= judged > (1.0 + 0.5 * JUDGE_MARGIN) * objective
    peak[judged.argmax()] = True
    return grid[peak], judged[peak]


def _finer(task: Task, point: Array, peaks: tuple[Array, Array]) -> Task:
    """Return the task with more harmonics where the peaks need them."""
    speeds, fine = peaks
    if task.backlash is not None or not speeds.size or task.harmonics >= MOST:
        return task
    coarse = worst(task, point, speeds, task.harmonics)
    if np.all(np.abs(coarse - fine) <= 0.5 * JUDGE_MARGIN * fine):
        return task
    return replace(task, harmonics=min(MOST, task.harmonics + MORE))


def _wider(task: Task, speeds: Array) -> Task:
    """Return the task with more speeds [rpm]."""
    return replace(task, speeds_rpm=tuple(sorted({*task.speeds_rpm, *map(float, speeds)})))


SPEEDS_BEFORE = 91  # speeds of the pair before, between which its curve is straight


def response_over_speed(
    task: Task,
    values: Sequence[float],
    before: MovingPair,
    rounds: Sequence[dict[str, Any]],
    clock: Clock,
) -> Chosen:
    """Response of a design (5,) at all speeds, beside that of the pair before it.

    That pair is left out where the clock has stopped, the largest multiplier where it takes long.
    Of motions that rising and falling speeds lead to, the larger one.
    """
    point, speeds = np.array(values, float), dense(task)
    kb, ratio, ramp, width, rim = (float(v) for v in point)
    built = orbit_parts(task, kb, ratio, width, rim)
    response, highest, repeats = _motions(task, point, speeds)
    coarse = np.linspace(speeds[0], speeds[-1], SPEEDS_BEFORE)
    grown = largest_multiplier_in_time(task, point, clock)
    before_rms = np.full(SPEEDS_BEFORE, np.nan) if clock.stopped else _before(task, before, coarse)
    return Chosen(
        bearing_stiffness_N_per_mm=kb,
        contact_ratio=ratio,
        ramp=ramp,
        face_width_mm=width,
        rim=rim,
        mass_kg=1e3 * float(built.masses[0] + built.masses[1]),
        displacement_mm=task.load / kb,
        harmonics=task.harmonics,
        speed_rpm=parts.columns(task.speeds_rpm),
        rounds=tuple(_record(one) for one in rounds),
        dense_rpm=parts.columns(speeds),
        dense_mm=parts.columns(response / MICRO, 7),
        before_mm=parts.gaps(np.interp(speeds, coarse, before_rms), 7),
        dense_maximum_mm=float(response.max()) / MICRO,
        largest_multiplier=grown if math.isfinite(grown) else None,
        highest_mm=float(highest.max()) / MICRO,
        parting_speeds=int(np.sum(highest > 0.0)),
        longest_repeat=repeats,
    )


def _motions(task: Task, point: Array, speeds: Array) -> tuple[Array, Array, int]:
    """Return measure and largest delta [um] over speeds, and after how many periods they repeat.

    0: a motion that does not repeat soon.
    """
    if task.backlash is None:
        measure, highest = measured(
            task, fourier_coefficients(task, point[None], speeds, JUDGE_HARMONICS)
        )
        return measure[0], highest[0], 1
    motions = worst_motions(task, point, speeds, Clock())
    after = [motion.repeats for motion in motions]
    sizes = np.array([size(task, motion) for motion in motions])
    highest = MICRO * np.array([motion.highest for motion in motions])
    return sizes, highest, max(after) if min(after) > 0 else 0


def _before(task: Task, pair: MovingPair, speeds: Array) -> Array:
    """Return the measure [mm] of the pair of the file over speeds [rpm].

    Where teeth may part, of the larger of the motions that rising and falling speeds lead to.
    """
    frequencies = task.teeth * speeds / 60.0
    contacts = in_contact(pair, "line", frequencies, JUDGE_HARMONICS, Clock())
    ways = [followed(pair, "line", contacts, Clock())]
    if task.backlash is not None:
        ways.append(followed(pair, "line", contacts[::-1], Clock())[::-1])
    sizes = np.array([[size(task, motion) for motion in way] for way in ways])
    return np.asarray(sizes.max(axis=0) / MICRO)


def _record(one: dict[str, Any]) -> tuple[float, float, float, float]:
    speeds, harmonics, objective, highest = (float(v) for v in one.values())
    return speeds, harmonics, objective, highest
