"""The problem of the least vibration of teeth that may part: a collocated motion at every speed.

`worst_motions` simulates a design over rising and falling speeds, by which such motions are judged.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.simulate import fastest
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.formulations.dynamics.motions_over_speed import followed
from gearopt.formulations.dynamics.orbit.collocation import (
    TENS,
    Collocated,
    Moving,
    Piece,
    Timing,
    collocated,
    gauss,
    mesh_force,
)
from gearopt.formulations.dynamics.orbit.orbit_text import LARGEST, limits, parameters, shared
from gearopt.formulations.dynamics.orbit.task import MICRO, Parts, Task, pair_of, parts
from gearopt.formulations.dynamics.steady_motion import Motion, in_contact
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Param, Repeat, Terms, Var
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.physics.motion.stiffness_wave import PAIR_SHARE

POINTS = 3  # of Gauss in an element: order 6 where the motion is smooth
MIN_ELEMENTS = 2  # elements of a piece
WIDTHS = (0.1, 0.03, 0.01)  # over which contact begins, of F/k, one problem after the other
LARGEST_RATE = 1e5  # um, of velocities and accelerations in the problem's time: the end of a search


def guesses(task: Task) -> Array:
    """Return the guesses of the five variables, in the middle of their ranges, (5,)."""
    return np.array([float(np.ravel(v.guess)[0]) for v in shared(task)])


def rate(task: Task) -> float:
    """Return (k/m_e)^(1/2) [rad/s] in the middle of the ranges: the unit of the problem's time."""
    kb, ratio, _, width, rim = guesses(task)
    built = parts(task, kb, ratio, width, rim)
    return math.sqrt(built.mean / built.mesh_mass)


def static_deflection(task: Task) -> float:
    """Return the static deflection F/k [um] of the mesh in the middle of the ranges."""
    kb, ratio, _, width, rim = guesses(task)
    return float(MICRO * task.load / parts(task, kb, ratio, width, rim).mean)


def lengths(ratio: Any, ramp: Any) -> list[Any]:
    """Return the pieces of a mesh period: rise, two pairs, fall, one pair of teeth."""
    return [ramp, ratio - 1.0 - ramp, ramp, 2.0 - ratio - ramp]


def elements(task: Task) -> list[int]:
    """Return the elements of each piece, by its length in the middle of the ranges."""
    _, ratio, ramp, _, _ = guesses(task)
    shares = np.clip(lengths(ratio, ramp), 0.0, None)
    return [max(MIN_ELEMENTS, round(task.elements * s / shares.sum())) for s in shares]


def pieces(task: Task, ratio: Any, ramp: Any, single: Any) -> list[Piece]:
    """Return the pieces of all periods of a motion, each a share of the whole."""
    single_pair, two_pairs = single, (1.0 + PAIR_SHARE) * single
    ends = [
        (single_pair, two_pairs),
        (two_pairs, two_pairs),
        (two_pairs, single_pair),
        (single_pair, single_pair),
    ]
    of_a_period = []
    for length, count, (low, high) in zip(lengths(ratio, ramp), elements(task), ends, strict=True):

        def stiffness(share: float, low: Any = low, high: Any = high) -> Any:
            return low + share * (high - low)

        shares = [k / count for k in range(count + 1)]
        of_a_period.append(Piece(length / task.periods, shares, stiffness))
    return of_a_period * task.periods


def moving(task: Task, stiffness: Any, made: Parts, width: Any) -> Moving:
    """Return a design as the equations of motion need it."""
    assert task.backlash is not None
    held = zip(made.masses, made.bearing_damping, strict=True)
    axes = [(mass, stiffness, damping) for mass, damping in held]
    backlash = MICRO * task.backlash
    damping, drag = (0.0, made.mesh_damping) if task.always else (made.mesh_damping, 0.0)
    return Moving(made.mesh_mass, task.load, damping, backlash, width, axes, drag)


def problem(task: Task, methods: dict[str, Any] | None = None) -> Problem:
    """Return the problem with the motion at every speed in E elements of S points.

    minimise the largest measure over the speeds; rows of a speed: equations of motion at every
    point and ends of elements (equal), the mean (equal), the measure under the objective. Its
    parameter `width` [um] rounds the corner where teeth part.
    """
    top = Var(task.measure, "um", 1e-3, LARGEST, 20.0, log=True, search=True)

    def evaluate(x: Any, p: Any) -> Terms:
        return Terms({task.measure: getattr(x, task.measure)}, limits(task, x, p))

    def motion(x: Any, p: Any, row: Any) -> Terms:
        built = parts(task, x.bearing_stiffness, x.contact_ratio, x.face_width, x.rim)
        collocated_motion = collocated(
            moving(task, x.bearing_stiffness, built, p.width),
            pieces(task, x.contact_ratio, x.ramp, built.single),
            POINTS,
            x,
            Timing(row.period, rate(task)),
        )
        mean = sum(
            w * d for w, d in zip(collocated_motion.weights, collocated_motion.delta, strict=True)
        )
        equal = {
            name: tuple(1.0 + r for r in rows) for name, rows in collocated_motion.rows.items()
        }
        equal["mean"] = (1.0 + (mean - x.mean) / TENS,)
        return Terms({}, {}, judged(task, x, collocated_motion), equal)

    omega = 2.0 * math.pi * task.teeth / 60.0 * np.array(task.speeds_rpm)
    rows = {"period": 2.0 * math.pi * task.periods * rate(task) / omega}
    corner = Param("width", "um", WIDTHS[-1] * static_deflection(task))
    given = (*parameters(task), corner)
    repeat = Repeat("speed", _of_a_speed(task), rows, motion)
    return Problem("orbit", (*shared(task), top), given, evaluate, (repeat,), methods or {})


def _of_a_speed(task: Task) -> tuple[Var, ...]:
    """Return the variables of a speed: the mean, and the motion in its elements."""
    count, wide = 3 * sum(elements(task)) * task.periods, (-LARGEST, LARGEST)
    variables = [
        Var("mean", "um", *wide, -15.0, search=True),
        Var("places", "um", *wide, 0.0, count, search=True),
        Var("speeds", "um", -LARGEST_RATE, LARGEST_RATE, 0.0, count, search=True),
        Var("bends", "um", -LARGEST_RATE, LARGEST_RATE, 0.0, count * POINTS, search=True),
    ]
    if task.measure == "peak_to_peak":
        variables += [Var("lowest", "um", *wide, -20.0, search=True)]
        variables += [Var("highest", "um", *wide, -10.0, search=True)]
    return tuple(variables)


def rounded(task: Task, problem: Problem, width: float) -> Problem:
    """Return the problem with the corner rounded over a width in units of F/k."""
    return problem.at(width=width * static_deflection(task))


def judged(task: Task, x: Any, found: Collocated) -> dict[str, Any]:
    """Return the rows that hold a speed's measure under the objective."""
    if task.measure == "rms":
        each = zip(found.weights, found.delta, strict=True)
        return {"worst": sum(w * (d - x.mean) ** 2 for w, d in each) / x.rms**2}
    return {
        "worst": 1.0 + (x.highest - x.lowest - x.peak_to_peak) / TENS,
        "above": tuple(1.0 + (d - x.highest) / TENS for d in found.delta),
        "below": tuple(1.0 + (x.lowest - d) / TENS for d in found.delta),
    }


def start(task: Task, whole: Problem, point: Array, motions: Sequence[Motion]) -> Array:
    """Return the point of the whole problem of a design (5,) and its motions, one a speed."""
    kb, ratio, ramp, width, rim = (float(v) for v in point)
    built = parts(task, kb, ratio, width, rim)
    cut = pieces(task, ratio, ramp, built.single)
    law = moving(task, kb, built, float(np.ravel(whole.parameters[-1].value)[0]))
    pairs = [pair_of(task, point, speed) for speed in task.speeds_rpm]
    rows = [_row(task, *each, cut, law) for each in zip(pairs, motions, strict=True)]
    low, high, _ = whole.bounds()
    value = max(size(task, motion) for motion in motions)
    return np.asarray(np.clip(np.concatenate([point, [value], *rows]), low, high))


def _row(task: Task, pair: MovingPair, motion: Motion, cut: Sequence[Piece], law: Moving) -> Array:
    """Return the variables of a speed whose motion is simulated from its state."""
    unit, begun = rate(task), 0.0
    begins, places, k, weights = [], [], [], []
    for piece in cut:
        for low, high in pairwise(piece.ends):
            begins.append(begun + max(piece.length, 0.0) * low)
            for c, weight in zip(*gauss(POINTS)[:2], strict=True):
                at = low + c * (high - low)
                places.append(begun + max(piece.length, 0.0) * at)
                k.append(piece.stiffness(at))
                weights.append(max(piece.length, 0.0) * (high - low) * weight)
        begun += max(piece.length, 0.0)
    marks, back = np.unique([0.0, *begins, *places], return_inverse=True)
    states = MICRO * marched(pair, task.periods * marks, motion.state)[back[1:]]
    first, inner = states[: len(begins)], states[len(begins) :]
    force = mesh_force(law, np.array(k), inner[:, 1], inner[:, 4])
    bends = np.zeros((len(inner), 3))
    for i, sign, (mass, held, damped) in zip((0, 2), (1.0, -1.0), law.axes, strict=True):
        bends[:, i] = (sign * force - held * inner[:, i] - damped * inner[:, 3 + i]) / mass
    bends[:, 1] = bends[:, 2] - bends[:, 0] - (law.load * MICRO + force) / law.mesh_mass
    blocks: list[Any] = [[weights @ inner[:, 1]], first[:, :3].ravel()]
    blocks += [first[:, 3:].ravel() / unit, bends.ravel() / unit**2]
    if task.measure == "peak_to_peak":
        blocks.append([inner[:, 1].min(), inner[:, 1].max()])
    return np.concatenate(blocks)


HARMONICS = 20  # of motions in contact, and of the first guess of those that part
STEPS_PER_PERIOD = 12.0  # in a period of the fastest mode: 1e-6 of a motion


def worst_motions(task: Task, point: Array, speeds_rpm: Array, clock: Clock) -> list[Motion]:
    """Return at every speed the larger of the motions that rising and falling speeds lead to.

    None at all where the clock stops; what is simulated does not count as evaluations.
    """
    pair = pair_of(task, point, float(speeds_rpm[0]))
    frequencies = task.teeth * np.asarray(speeds_rpm) / 60.0
    unlimited = Clock(replace(clock.left, evaluations=None), lambda event: clock.tell())
    contacts = in_contact(pair, "line", frequencies, HARMONICS, unlimited)
    rising = followed(pair, "line", contacts, unlimited)
    falling = followed(pair, "line", contacts[::-1], unlimited)[::-1]
    if min(len(rising), len(falling)) < len(speeds_rpm):
        return []
    return [
        max(two, key=lambda motion: size(task, motion)) for two in zip(rising, falling, strict=True)
    ]


def size(task: Task, motion: Motion) -> float:
    """Return the measure of a motion [um]; infinite of one that grows for ever."""
    if motion.grows:
        return math.inf
    return MICRO * (motion.rms if task.measure == "rms" else motion.highest - motion.least)


def marched(pair: MovingPair, periods: Array, state: Array) -> Array:
    """Return states (outputs, 6) of a pair on the line of action after so many mesh periods."""
    times = timeline(pair, np.asarray(periods) / pair.mesh_frequency)
    return march(pair, "line", times, "rk8", fastest(pair, "line") / STEPS_PER_PERIOD, state).states
