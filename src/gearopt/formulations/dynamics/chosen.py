"""The design of least vibration as a result holds it, over a dense grid of speeds."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.dynamics import dynamics_parts as parts
from gearopt.formulations.dynamics.dynamics_design import Chosen
from gearopt.formulations.dynamics.motions_over_speed import in_contact
from gearopt.formulations.orbit.orbit_search import DENSE, FINE, growth
from gearopt.formulations.orbit.task import MICRO, Task, measured, series, worst
from gearopt.formulations.orbit.task import parts as orbit_parts
from gearopt.optimise.clock import Clock
from gearopt.physics.motion.moving_pair import MovingPair

COARSE = 91  # speeds of the pair before, between which its curve is straight


def chosen(
    task: Task, values: Sequence[float], before: MovingPair, rounds: Sequence[dict[str, Any]]
) -> Chosen:
    """Return what is to be known of a design (5,) over all speeds, beside the pair before it."""
    point = np.array(values, float)
    speeds = np.linspace(task.speeds_rpm[0], task.speeds_rpm[-1], DENSE)
    kb, ratio, ramp, width, rim = (float(v) for v in point)
    made = orbit_parts(task, kb, ratio, width, rim)
    dense = worst(task, point, speeds, FINE)
    _, highest = measured(task, series(task, point[None], speeds, FINE))
    coarse = np.linspace(speeds[0], speeds[-1], COARSE)
    old = in_contact(before, "line", task.teeth * coarse / 60.0, FINE, Clock())
    told = [o.series.rms if task.measure == "rms" else np.ptp(o.series.extremes) for o in old]
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
        dense_mm=parts.columns(dense / MICRO, 7),
        before_mm=parts.columns(np.interp(speeds, coarse, told), 7),
        dense_maximum_mm=float(dense.max()) / MICRO,
        largest_multiplier=growth(task, point),
        highest_mm=float(highest.max()) / MICRO,
    )


def _round(one: dict[str, Any]) -> tuple[float, float, float, float]:
    speeds, harmonics, objective, dense = (float(v) for v in one.values())
    return speeds, harmonics, objective, dense
