"""Total ratio and its split at once, where the gears' own inertia counts."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import acceleration
from gearopt.formulations.servo.ratio.drive import Drive
from gearopt.formulations.servo.split.core import inertia_index
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Terms, Var, each


def staged(drive: Drive, pinion_inertia: float, stages: int, load_speed: float = 0.0) -> Problem:
    """Minimise 1/a [s2/rad] over the ratios of all stages; see `acceleration`.

    The gears add J_p sum_i (1 + n_i^2)/prod_{j<i} n_j^2 to the motor's inertia: solid discs of one
    width, pinions of pinion_inertia J_p [t mm2] > 0 each. Variables: stage_ratio, at least 1 each,
    and acceleration. A posynomial, so that Ipopt's answer comes with its bound.
    """
    drive.needs(pinion_inertia=pinion_inertia, stages=stages)
    plain = acceleration(drive, load_speed)
    least = replace(drive, gear_inertia=drive.gear_inertia + pinion_inertia)  # any train adds more
    ratio, ramp = acceleration(least, load_speed).variables

    def evaluate(x: Any, p: Any) -> Terms:
        ratios = each(x.stage_ratio)
        total = math.prod(ratios)
        found = plain.evaluate(SimpleNamespace(ratio=total, acceleration=x.acceleration), p)
        gears = p.pinion_inertia * inertia_index(ratios) * total * x.acceleration / p.torque
        limits = dict(found.limits) | {"motor_torque": found.limits["motor_torque"] + gears}
        limits["stage_ratio_low"] = tuple(1.0 / n for n in ratios)
        return Terms(found.minimise, limits, equal=found.equal)

    guess = max(1.0, float(np.max(ratio.guess)) ** (1.0 / stages))
    each_ratio = Var(
        "stage_ratio", "", ratio.lower, ratio.upper, guess, stages, log=True, search=True
    )
    parameters = (*plain.parameters, Param("pinion_inertia", "t mm2", pinion_inertia))
    return Problem("ratio and split", (each_ratio, ramp), parameters, evaluate)
