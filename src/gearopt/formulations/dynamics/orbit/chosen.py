"""The design of least vibration as a result holds it, over a dense grid of speeds."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.dynamics import parts
from gearopt.formulations.dynamics.design import Chosen
from gearopt.formulations.dynamics.motions_over_speed import followed
from gearopt.formulations.dynamics.orbit.climbing import JUDGE_HARMONICS, growth
from gearopt.formulations.dynamics.orbit.least_vibration import dense
from gearopt.formulations.dynamics.orbit.settled import size, worst_motions
from gearopt.formulations.dynamics.orbit.task import MICRO, Task, measured, series
from gearopt.formulations.dynamics.orbit.task import parts as orbit_parts
from gearopt.formulations.dynamics.steady_motion import in_contact
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair

SPEEDS_BEFORE = 91  # speeds of the pair before, between which its curve is straight


def chosen(
    task: Task, values: Sequence[float], before: MovingPair | None, rounds: Sequence[dict[str, Any]]
) -> Chosen:
    """Return what is to be known of a design (5,) over all speeds, beside the pair before it.

    before: None where there is no time left for it.
    Of motions that rising and falling speeds lead to, the larger one.
    """
    point, speeds = np.array(values, float), dense(task)
    kb, ratio, ramp, width, rim = (float(v) for v in point)
    made = orbit_parts(task, kb, ratio, width, rim)
    found, highest, repeats = _motions(task, point, speeds)
    coarse = np.linspace(speeds[0], speeds[-1], SPEEDS_BEFORE)
    told = np.full(SPEEDS_BEFORE, np.nan) if before is None else _before(task, before, coarse)
    return Chosen(
        bearing_stiffness_N_per_mm=kb,
        contact_ratio=ratio,
        ramp=ramp,
        face_width_mm=width,
        rim=rim,
        mass_kg=1e3 * float(made.masses[0] + made.masses[1]),
        displacement_mm=task.load / kb,
        harmonics=task.harmonics,
        speed_rpm=parts.columns(task.speeds_rpm),
        rounds=tuple(_round(one) for one in rounds),
        dense_rpm=parts.columns(speeds),
        dense_mm=parts.columns(found / MICRO, 7),
        before_mm=parts.gaps(np.interp(speeds, coarse, told), 7),
        dense_maximum_mm=float(found.max()) / MICRO,
        largest_multiplier=growth(task, point),
        highest_mm=float(highest.max()) / MICRO,
        parting_speeds=int(np.sum(highest > 0.0)),
        longest_repeat=repeats,
    )


def _motions(task: Task, point: Array, speeds: Array) -> tuple[Array, Array, int]:
    """Return measure and largest delta [um] over speeds, and after how many periods they repeat.

    0: a motion that does not repeat soon.
    """
    if task.backlash is None:
        measure, highest = measured(task, series(task, point[None], speeds, JUDGE_HARMONICS))
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


def _round(one: dict[str, Any]) -> tuple[float, float, float, float]:
    speeds, harmonics, objective, highest = (float(v) for v in one.values())
    return speeds, harmonics, objective, highest
