"""Exact motions of a design whose teeth part and meet, simulated over rising and falling speeds."""

import math
from dataclasses import replace

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.simulate import fastest
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.formulations.dynamics.motions_over_speed import followed
from gearopt.formulations.dynamics.orbit.task import MICRO, Task, pair_of
from gearopt.formulations.dynamics.steady_motion import Motion, in_contact
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair

HARMONICS = 20  # of motions in contact, and of the first guess of those that part
STEPS_PER_PERIOD = 12.0  # in a period of the fastest mode: 1e-6 of a motion


def worst_motions(task: Task, point: Array, speeds_rpm: Array, clock: Clock) -> list[Motion]:
    """Return at every speed the larger of the motions that rising and falling speeds lead to.

    None at all where the clock stops; what is simulated does not count as evaluations.
    """
    pair = pair_of(task, point, float(speeds_rpm[0]))
    frequencies = task.teeth * np.asarray(speeds_rpm) / 60.0
    own = Clock(replace(clock.left, evaluations=None), lambda event: clock.tell())
    contacts = in_contact(pair, "line", frequencies, HARMONICS, own)
    rising = followed(pair, "line", contacts, own)
    falling = followed(pair, "line", contacts[::-1], own)[::-1]
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
