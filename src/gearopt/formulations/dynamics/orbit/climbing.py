"""From a design to a local optimum of its problem, of a mesh in contact or of one that parts.

In contact a motion is a harmonic balance, which a `Problem` holds to rounding. Where teeth may part
it is collocated; the design is then simulated over rising and falling speeds, and what it does
there counts.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gearopt.formulations.dynamics.motion.stability import largest, ready
from gearopt.formulations.dynamics.orbit import orbit_text, parting_text
from gearopt.formulations.dynamics.orbit.orbit_text import PEAKS, Cut, with_cuts
from gearopt.formulations.dynamics.orbit.parting_text import size, worst_motions
from gearopt.formulations.dynamics.orbit.task import Task, pair_of, worst
from gearopt.optimise.certificate import certify
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import linear

JUDGE_MARGIN = 0.01  # of an objective, by which what is judged more closely may exceed it
JUDGE_HARMONICS = 40  # harmonics of the judge of a mesh in contact
AGAIN = 3  # runs from the motions that a design really has
SPARE_SECONDS = 0.5  # for the multipliers of a design once the budget is spent
SPEEDS_CHECKED = 91  # speeds at which the multipliers of a design are looked at
STEP = 1e-4  # of a range: differences of the largest multiplier
REACH, SHORTEST = 0.25, 1e-5  # of the ranges: steps within a limit of the multiplier
WORTH = 1.25  # of the best objective so far: designs up to there are led on within the limit
CORRECTED = 3  # approximations of one step
GAIN = 1e-5  # of the objective: less is none
WITHIN = 1e-5  # by which the largest multiplier may exceed its limit


class Climbed(NamedTuple):
    """A local optimum: its problem, its outcome there, and the objective [um].

    judged [um]: the measure at the speeds of the task by the exact motions.
    """

    problem: Problem
    outcome: Outcome
    objective: float
    judged: float

    @property
    def point(self) -> Array:
        """The design (5,)."""
        return self.whole[:5]

    @property
    def whole(self) -> Array:
        """The point of the problem: the design with its motions."""
        return _point(self.outcome)


def posed(task: Task, methods: dict[str, Any] | None = None) -> Problem:
    """Return the problem of a task: with collocated motions where teeth may part."""
    solvers = {"screened": _guess} if methods is None else methods
    if task.backlash is None:
        return orbit_text.problem(task, solvers)
    return parting_text.problem(task, solvers)


def begun(task: Task, point: Sequence[float]) -> Problem:
    """Return the problem of a mesh in contact whose guess is a design (5,) with its own motions."""
    whole = posed(task, {})
    return whole.starting(orbit_text.start(task, whole, np.clip(point, *task.box())))


def _guess(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """The guess as it is, a point of a search, to be certified."""
    return Outcome(problem.bounds()[2], evaluations=1)


def climb(task: Task, problem: Problem, point: Array, clock: Clock) -> Climbed | None:
    """Return the local optimum that a design (5,) leads to; None where none was found."""
    if task.backlash is not None:
        return _parting(task, problem, point, clock)
    in_contact = _contact(task, problem, point, clock)
    if in_contact is None or task.most_growth is None:
        return in_contact
    return _steadied(task, problem, in_contact, clock) or _as_it_is(task, problem, point, clock)


def measure(task: Task, point: Array, speeds_rpm: Array, clock: Clock) -> Array:
    """Return the measure [um] of a design at speeds (K,): simulated where teeth may part.

    Infinite where the clock stops.
    """
    if task.backlash is None:
        return worst(task, point, speeds_rpm, JUDGE_HARMONICS)
    motions = worst_motions(task, point, speeds_rpm, clock)
    return np.array([size(task, m) for m in motions] or [np.inf] * len(speeds_rpm))


def _ipopt(problem: Problem, start: Array, clock: Clock) -> tuple[float, Outcome] | None:
    outcome = ipopt.run(problem, clock.left, 0, clock.inner(False), start=start)
    value = _value(problem, outcome)
    return None if value is None else (value, outcome)


def _value(problem: Problem, found: Outcome) -> float | None:
    """Return the objective [um] of a point within the limits, without multipliers; else None."""
    plain = replace(found, bound=None, proof=None, stationary=False)
    return certify(problem, plain, 0.0, exact=True).objective


def _contact(task: Task, problem: Problem, point: Array, clock: Clock) -> Climbed | None:
    if clock.over:
        return _with_its_motions(task, problem, point)
    optimum = _ipopt(problem, orbit_text.start(task, problem, point), clock)
    return optimum and Climbed(problem, optimum[1], optimum[0], optimum[0])


def _steadied(task: Task, problem: Problem, found: Climbed, clock: Clock) -> Climbed | None:
    """Return the optimum within the limit of the multiplier; None where none was found.

    The largest multiplier is no text of the problem. Where a design exceeds the limit, linear
    approximations there become rows of the problem beside those before, which is solved again.
    """
    cuts = list[Cut]()
    while largest_multiplier(task, found.point, clock) > _most(task) + WITHIN:
        cuts += _tangents(task, found.point, clock)[:1]
        optimum = None
        if len(cuts) <= PEAKS and not clock.over:
            optimum = _contact(task, with_cuts(problem, cuts), found.point, clock)
        if optimum is None:
            return None
        found = optimum
    worth = found.objective < WORTH * clock.best
    return _improved(task, problem, found, clock) if cuts and worth else found


def _improved(task: Task, problem: Problem, best: Climbed, clock: Clock) -> Climbed:
    """Return the best design that steps within the limit of the multiplier lead to.

    A step is the optimum under the linear approximations at the design, for all speeds at which its
    multiplier is near the limit, in a region that shrinks where they fail. The design's problem has
    those at the design itself, without a region.
    """
    low, high = task.box()
    units, reach = np.eye(5) / (high - low), REACH
    while reach > SHORTEST and not clock.over:
        region = [
            (sign * unit, reach + sign * float(unit @ best.point))
            for unit in units
            for sign in (1.0, -1.0)
        ]
        stepped: Climbed | None = best
        for _ in range(CORRECTED):  # a step that ends beyond the limit is taken again from there
            assert stepped is not None
            rows = [*_tangents(task, stepped.point, clock), *region]
            if clock.over:
                return best
            stepped = _contact(task, with_cuts(problem, rows), stepped.point, clock)
            if (
                stepped is None
                or largest_multiplier(task, stepped.point, clock) <= _most(task) + WITHIN
            ):
                break
        within = (
            stepped is not None
            and largest_multiplier(task, stepped.point, clock) <= _most(task) + WITHIN
        )
        if stepped is not None and within and stepped.objective < (1.0 - GAIN) * best.objective:
            best = stepped
        else:
            reach /= 4.0
    rows = _tangents(task, best.point, clock)
    return best if clock.over else best._replace(problem=with_cuts(problem, rows))


def _tangents(task: Task, point: Array, clock: Clock) -> list[Cut]:
    """Return linear approximations of the limit on the multiplier at a design.

    Of the speeds at which it has its highest peaks, the highest first. None where the clock is
    over.
    """
    multipliers, slopes = _multipliers(task, point, clock), multiplier_slopes(task, point, clock)
    if clock.over:
        return []
    padded = np.concatenate([[-np.inf], multipliers, [-np.inf]])
    peaks = np.flatnonzero((multipliers >= padded[:-2]) & (multipliers > padded[2:]))
    highest = peaks[np.argsort(-multipliers[peaks], kind="stable")][:PEAKS]
    rooms = _most(task) - multipliers[highest]
    rooms = np.where(np.abs(rooms) <= WITHIN, np.maximum(rooms, 0.0), rooms)
    return [
        (slopes[:, k], float(room + slopes[:, k] @ point))
        for k, room in zip(highest, rooms, strict=True)
    ]


def _most(task: Task) -> float:
    assert task.most_growth is not None
    return task.most_growth


def _as_it_is(task: Task, problem: Problem, point: Array, clock: Clock) -> Climbed | None:
    """Return a design with its own motions, where it is within the limit of the multiplier."""
    assert task.most_growth is not None
    if largest_multiplier_in_time(task, point, clock) > task.most_growth + WITHIN:
        return None
    return _with_its_motions(task, problem, point)


def _with_its_motions(task: Task, problem: Problem, point: Array) -> Climbed | None:
    """Return a design as it is, where it is within the limits of the problem."""
    outcome = Outcome(orbit_text.start(task, problem, point), evaluations=1)
    value = _value(problem, outcome)
    return None if value is None else Climbed(problem, outcome, value, value)


def largest_multiplier_in_time(task: Task, point: Array, clock: Clock) -> float:
    """Return `largest_multiplier`, with SPARE_SECONDS where less is left of a clock."""
    pair, left = pair_of(task, point, task.speeds_rpm[0]), clock.left.seconds
    ready(linear(pair, "line"), pair.wave, Clock(watch=clock.watch))
    seconds = None if left is None else max(left, SPARE_SECONDS)
    return largest_multiplier(task, point, Clock(Budget(seconds)))


def largest_multiplier(task: Task, point: Array, clock: Clock | None = None) -> float:
    """Return the largest Floquet multiplier of a design in contact over all speeds.

    Infinite where the clock stops.
    """
    return float(_multipliers(task, point, clock).max())


def _multipliers(task: Task, point: Array, clock: Clock | None) -> Array:
    speeds = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], SPEEDS_CHECKED)
    pair = pair_of(task, point, float(speeds[0]))
    magnitudes = largest(linear(pair, "line"), pair.wave, task.teeth * speeds / 60.0, clock)
    return np.pad(magnitudes, (0, SPEEDS_CHECKED - len(magnitudes)), constant_values=np.inf)


def multiplier_slopes(task: Task, point: Array, clock: Clock | None = None) -> Array:
    """Return derivatives of the multipliers (5, SPEEDS_CHECKED) by the design, into the ranges.

    NaN where the clock stops.
    """
    low, high = task.box()
    step = STEP * (high - low)
    step = np.where(point + step > high, -step, step)
    each = [_multipliers(task, point + one, clock) for one in (0.0 * step, *np.diag(step))]
    with np.errstate(invalid="ignore"):
        moved = np.array(each[1:]) - each[0]
    return np.asarray(moved / np.where(step, step, np.inf)[:, None])


def _parting(task: Task, problem: Problem, point: Array, clock: Clock) -> Climbed | None:
    """Return the optimum of collocated motions that a design leads to, the least simulated one.

    The corner where teeth part is rounded less and less. Where the design then has a larger motion
    than the one that was followed, the problem is solved again from that.
    """
    best: Climbed | None = None
    speeds = np.array(task.speeds_rpm)
    motions = worst_motions(task, point, speeds, clock)
    for _ in range(AGAIN if motions else 0):
        start, optimum = parting_text.start(task, problem, point, motions), None
        for width in parting_text.WIDTHS:
            optimum = _ipopt(parting_text.rounded(task, problem, width), start, clock)
            if optimum is None or clock.over:
                break
            start = _point(optimum[1])
        if optimum is None:
            break
        point = _point(optimum[1])[:5]
        motions = worst_motions(task, point, speeds, clock)
        judged = max((size(task, motion) for motion in motions), default=np.inf)
        if best is None or judged < best.judged:
            best = Climbed(problem, optimum[1], optimum[0], judged)
        if judged <= (1.0 + JUDGE_MARGIN) * optimum[0] or clock.over:
            break
    return best


def _point(found: Outcome) -> Array:
    assert found.x is not None
    return found.x
