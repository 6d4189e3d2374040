"""Whole teeth of a servo train: every train evaluated against the pruned search, beside the bound.

The train is that of Youn's gimbal drive with assumed limits, as in problems/servo_gimbal.toml and
problems/servo_gimbal_light.toml; 62,054 and 247,948 of its 6,326,052 trains are feasible.
"""

import math
from fractions import Fraction
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.servo import split
from gearopt.formulations.servo.servo_design import GOALS, OBJECTIVES
from gearopt.formulations.servo.split import ServoTrain
from gearopt.optimise.solve import solve
from gearopt.physics.backlash import radial_backlash

ERRORS = (0.1082, 0.12)  # degrees
METHODS = ("enumeration", "exact")
RADIAL, PITCH = (0.0512, 0.0649), (0.029, 0.033)  # mm, sums of tables 2 and 3 of the paper


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, ms, trains evaluated, feasible ones, gap to the bound.

    above_bound_percent: how far the optimum is above the bound with real-valued teeth and modules.
    """
    rows = []
    for error in ERRORS:
        train = train_of(error)
        for goal in OBJECTIVES:
            bound = solve(split.relaxation(train, goal)).bound
            assert bound is not None
            name = f"minimum {goal}, {error:g} deg"
            rows += [_row(name, train, goal, method, bound, repeat) for method in METHODS]
    return rows


def train_of(error: float) -> ServoTrain:
    """Return the gimbal's train with a maximum error [deg]."""
    lost = [
        2.0 * (radial_backlash(r, math.radians(20.0)) + p)
        for r, p in zip(RADIAL, PITCH, strict=True)
    ]
    return ServoTrain(
        ratio=Fraction(48),
        tolerance=Fraction(1, 100),
        modules=tuple(Fraction(m, 10) for m in (3, 4, 5, 6, 8, 10)),
        pinion_teeth=(16, 60),
        max_wheel_teeth=300,
        face_width=6.0,
        density=7.75e-9,
        output_torque=2400.0,
        bending=150.0,
        bore=Fraction(23, 2),
        wheel_tips=(Fraction(80), Fraction(106)),
        shaft=(8.0, 50.0),
        lost_motion=(float(lost[0]), float(lost[1])),
        error=math.radians(error),
        sector=0.25,
    )


def _row(
    case: str, train: ServoTrain, goal: str, method: str, bound: float, repeat: int
) -> dict[str, Any]:
    problem = split.problem(train, goal)
    result, times = timed(lambda: solve(problem, method), repeat)
    return {
        "case": case,
        "method": method,
        **times,
        "trains_looked_at": result.proof["trains_looked_at"],
        "feasible_trains": result.proof.get("feasible_trains"),
        "objective": result.value,
        "unit": GOALS[goal].unit,
        "status": result.status,
        "above_bound_percent": None
        if result.value is None
        else 100.0 * (result.value / bound - 1.0),
    }
