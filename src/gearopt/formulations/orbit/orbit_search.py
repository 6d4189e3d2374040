"""Global search for the least vibration: screening, Ipopt from the best, and exchange of speeds.

The problem has many local optima, all of which Ipopt calls solved: designs drawn at random are
ranked by their motions first, and the best of them are starts. Between the speeds that are judged
resonances may hide; the exchange looks for them on a dense grid and adds the worst.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.formulations.motion.stability import largest
from gearopt.formulations.orbit.orbit_text import LOGARITHMIC, problem, reduced, start
from gearopt.formulations.orbit.task import VARIABLES, Task, measured, pair_of, series, worst
from gearopt.optimise.box import violation
from gearopt.optimise.certificate import certify
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import linear

RANDOM = True
COUNTS = "design measured or Ipopt iteration"
SCREENED, STARTS = 2000, 12  # designs drawn; of which so many are starts of Ipopt
SETTINGS = {"designs screened": SCREENED, "starts": STARTS, "local method": "ipopt"}
CHUNK = 250  # designs measured at once: some 50 ms
DENSE, FINE = 361, 40  # speeds and harmonics of the judge of an exchange
NEAR = 0.01  # of the objective, by which the dense maximum may exceed it
SAME = 1e-3  # by which the dense maximum may exceed that of another design met on the way
ROUNDS, AGAIN = 12, 3  # of an exchange at most; starts of either sort after its first round
JITTER = 0.02  # relative, of starts around the best design met
SPREAD = 46  # equal steps of speed that are added once an exchange has ended, to look once more
MORE, MOST = 4, 30  # harmonics added where the judge sees another motion; of a problem at most
GROWTHS = 91  # speeds at which the multipliers of a design are looked at
PENALTY = 5.0  # times the violation, added to the logarithm of the measure


def methods(task: Task) -> dict[str, Callable[..., Outcome]]:
    """Return the method `screened` of the problem of a task."""

    def run(posed: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        clock = Clock(budget, watch)
        sampled = sample(task, clock, seed)
        ends = climbed(task, posed, ranked(task, sampled)[:STARTS], clock)
        return _told(ends[0][1] if ends else None, clock)

    return {"screened": run}


def _told(best: Outcome | None, clock: Clock) -> Outcome:
    """Return the outcome of a whole run."""
    found = best or Outcome(None, True, message="no start led to a design")
    return replace(found, finished=not clock.stopped, evaluations=clock.evaluations)


@dataclass(frozen=True)
class Sample:
    """Designs (N, 5), their measure at the speeds of a task (N, K) [um], and their excess (N,)."""

    points: Array
    values: Array
    excess: Array


def sample(task: Task, clock: Clock, seed: int) -> Sample:
    """Return SCREENED random designs of the box with their measures, or as many as time allows."""
    low, high = task.box()
    log = np.array([name in LOGARITHMIC for name in VARIABLES])
    ends = [np.where(log, np.log(np.where(log, e, 1.0)), e) for e in (low, high)]
    rng = np.random.default_rng(seed)
    drawn = ends[0] + rng.random((SCREENED, 5)) * (ends[1] - ends[0])
    points = np.where(log, np.exp(np.where(log, drawn, 0.0)), drawn)
    found: list[Array] = []
    for first in range(0, SCREENED, CHUNK):
        found.append(measures(task, points[first : first + CHUNK]))
        clock.evaluations += CHUNK
        if not clock.tell():
            break
    values = np.concatenate(found)
    points = points[: len(values)]
    return Sample(points, values, violation(reduced(task), points)[1])


def measures(task: Task, points: Array) -> Array:
    """Return the measures [um] of designs (N, 5) at the speeds of a task, (N, K)."""
    return measured(task, series(task, points, np.array(task.speeds_rpm), task.harmonics))[0]


def ranked(task: Task, found: Sample) -> Array:
    """Return the designs of a sample, the most promising first."""
    merit = np.log(found.values.max(axis=1)) + PENALTY * found.excess
    return found.points[np.argsort(merit, kind="stable")]


def steady(task: Task, point: Array) -> bool:
    """Return whether a design meets the limit of its multipliers, if there is one.

    A limit without derivatives: designs at which Ipopt ends and that exceed it are left out.
    """
    return task.most_growth is None or growth(task, point) <= task.most_growth


def growth(task: Task, point: Array) -> float:
    """Return the largest Floquet multiplier of a design over all speeds."""
    speeds = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], GROWTHS)
    pair = pair_of(task, point, float(speeds[0]))
    return float(np.max(largest(linear(pair, "line"), pair.wave, task.teeth * speeds / 60.0)))


def climbed(task: Task, posed: Problem, starts: Array, clock: Clock) -> list[tuple[float, Outcome]]:
    """Return value and outcome of Ipopt from designs (N, 5) and their own motions, if feasible.

    The best first; without those whose motion is not `steady`.
    """
    ends = []
    for point in starts:
        whole = start(task, posed, point)
        found = ipopt.run(posed, clock.left, 0, clock.inner(), start=whole)
        clock.evaluations += found.evaluations
        verdict = certify(posed, found, 0.0)
        if verdict.objective is not None and steady(task, _design(found)):
            ends.append((verdict.objective, found))
            clock.best = min(verdict.objective, clock.best)
        if not clock.tell():
            break
    return sorted(ends, key=lambda end: end[0])


@dataclass(frozen=True)
class Exchanged:
    """The task with the speeds (and harmonics) that it took, its design (5,), and the rounds.

    rounds: of each its number of speeds, harmonics, objective and dense maximum [um]: over DENSE
    speeds with FINE harmonics. met: the last is within NEAR of its objective.
    """

    task: Task
    point: Array
    rounds: tuple[dict[str, Any], ...]
    met: bool


def exchange(task: Task, clock: Clock, seed: int) -> Exchanged | None:
    """Solve, look at all speeds between the first and the last, add the worst, and solve again.

    Until the dense maximum is the objective within NEAR, and no design that was met on the way has
    a lower one. None where no design was found.
    """
    grid = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], DENSE)
    rng, pool = np.random.default_rng(seed), sample(task, clock, seed)
    rounds: list[dict[str, Any]] = []
    starts, known, last = ranked(task, pool)[:STARTS], list[tuple[float, Array]](), None
    again = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], SPREAD)
    while True:
        clock.best = np.inf  # of another problem
        ends = climbed(task, problem(task), starts, clock)
        if not ends:
            return last
        objective, point = ends[0][0], _design(ends[0][1])
        judged = [worst(task, _design(o), grid, FINE) for _, o in ends]
        known += [(float(d.max()), _design(o)) for d, (_, o) in zip(judged, ends, strict=True)]
        least, lowest = min(known, key=lambda one: one[0])
        highest = float(judged[0].max())
        rounds.append(
            {
                "speeds": len(task.speeds_rpm),
                "harmonics": task.harmonics,
                "objective_um": objective,
                "dense_um": highest,
            }
        )
        met = highest <= min((1.0 + NEAR) * objective, (1.0 + SAME) * least)
        last = Exchanged(task, point, tuple(rounds), met)
        if (met and not again.size) or len(rounds) == ROUNDS or clock.stopped:
            return last
        peaks = _peaks(grid, judged[0], objective)
        task = _finer(task, point, peaks)
        added = again if met else np.array([n for n, _ in peaks])
        again = np.empty(0) if met else again
        task, pool = _wider(task, pool, point, added)
        low, high = task.box()
        jitter = lowest * (1.0 + JITTER * rng.standard_normal((AGAIN, 5)))
        near = np.concatenate([[lowest, point], np.clip(jitter, low, high)])
        starts = np.concatenate([near, ranked(task, pool)[:AGAIN]])


def _design(found: Outcome) -> Array:
    assert found.x is not None
    return found.x[:5]


def _peaks(grid: Array, dense: Array, objective: float) -> list[tuple[float, float]]:
    """Return speeds and measures of the peaks above an objective."""
    padded = np.concatenate([[-np.inf], dense, [-np.inf]])
    peak = (dense >= padded[:-2]) & (dense >= padded[2:]) & (dense > (1.0 + 0.5 * NEAR) * objective)
    return [(float(n), float(v)) for n, v in zip(grid[peak], dense[peak], strict=True)]


def _finer(task: Task, point: Array, peaks: list[tuple[float, float]]) -> Task:
    """Return the task with more harmonics where the peaks need them."""
    if not peaks or task.harmonics >= MOST:
        return task
    speeds, fine = np.array(peaks).T
    coarse = worst(task, point, speeds, task.harmonics)
    if np.all(np.abs(coarse - fine) <= 0.5 * NEAR * fine):
        return task
    return replace(task, harmonics=min(MOST, task.harmonics + MORE))


def _wider(task: Task, pool: Sample, point: Array, speeds: Array) -> tuple[Task, Sample]:
    """Return the task with more speeds, and the pool with a design more, measured at them."""
    added = [float(n) for n in speeds if n not in task.speeds_rpm]
    points = np.concatenate([pool.points, point[None]])
    values = np.concatenate([pool.values, measures(task, point[None])])
    if added:
        values = np.hstack([values, measures(replace(task, speeds_rpm=tuple(added)), points)])
    whole = np.array([*task.speeds_rpm, *added])
    order = np.argsort(whole, kind="stable")
    made = replace(task, speeds_rpm=tuple(float(n) for n in whole[order]))
    return made, Sample(points, values[:, order], np.append(pool.excess, 0.0))
