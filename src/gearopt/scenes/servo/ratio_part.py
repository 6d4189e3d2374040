"""The total ratio of a servo axis: the best one, and how flat its optimum is."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gearopt.formulations.servo.ratio import ServoDuty
from gearopt.optimise.clock import in_part
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.physics.servo_drive import largest_acceleration
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo.achieved import NAMES, Candidate, achieved, candidates, judged
from gearopt.scenes.servo.choice import SHOWN
from gearopt.scenes.servo.scene import Scene

POINTS = 200  # of the curve
REACH = 5.0  # of the curve, to either side of the best ratio


def ratio_part(
    scene: Scene, chosen: Mapping[str, Any] | None, ask: Ask
) -> tuple[Result, dict[str, Any], dict[str, Any]]:
    """The certified best ratio, its part of the design, and its part of the report.

    chosen: the train of the answer, once it is known; it and what is given are judged beside it.
    """
    duty = scene.servo_duty()
    assert duty is not None
    factor, shown = SHOWN[duty.goal]
    watch = in_part(ask.watch, shown, factor=factor)
    result, outcome = run(duty.problem(), ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = converted(result, duty)
    if result.value is None or outcome.x is None:
        return result, {}, {}
    best = float(outcome.x[0])
    name, unit, key = NAMES[duty.motion]
    reached = float(judged(duty, best))
    own, report = candidates(scene, chosen), {"best_total_ratio": best, f"best_{key}": reached}
    report |= _landmarks(duty)
    with_train = None if "chosen" not in own else own["chosen"].inertia
    if with_train is not None and (other := _best_ratio(duty.with_gears(with_train))) is not None:
        own["best_with_train"] = Candidate("", other, with_train)
        report["best_total_ratio_with_train"] = other
    beside = {who: achieved(duty, one, reached) for who, one in own.items()}
    for who, found in beside.items():
        stem, _, end = f"{who}_{key}".partition("_with_train_")
        if found is not None:
            report[f"{stem}_{end}_with_train" if end else stem] = found["value"]
    design: dict[str, Any] = {
        "duty": duty.motion,
        "total_ratio": best,
        "value": reached,
        "name": name,
        "unit": unit,
        "given": None,
        "best": achieved(duty, Candidate("", best), reached),
        "curve": _curve(duty, best, with_train),
    }
    design |= beside
    return replace(result, design={"ratio": design}), design, report


def _landmarks(duty: ServoDuty) -> dict[str, float]:
    """The ratio of equal inertias, and what less friction would give at standstill.

    Losses of the train count: J_L/eta in the place of J_L, as a = T/(2 sqrt(J_L J_M/eta)) at
    N = sqrt(J_L/(eta J_M)).
    """
    axis = duty.drive
    load = axis.load_inertia / axis.efficiency
    if load == 0.0:
        return {}
    found = {"matched_inertia_ratio": math.sqrt(load / axis.motor_inertia)}
    if duty.motion == "swing" or duty.load_speed:
        return found
    inertias = load, axis.motor_inertia
    return found | {
        "frictionless_load_acceleration_rad_per_s2": largest_acceleration(*inertias, axis.torque),
        "load_acceleration_without_load_friction_rad_per_s2": largest_acceleration(
            *inertias, axis.net_torque
        ),
    }


def _best_ratio(duty: ServoDuty) -> float | None:
    """The best ratio of a duty; None where nothing moves."""
    outcome = run(duty.problem())[1]
    return None if outcome.x is None else float(outcome.x[0])


def converted(result: Result, duty: ServoDuty) -> Result:
    """The result of a duty in plain units: 1/a in s2/rad, time in s, torque in N m."""
    if duty.motion == "swing":
        return scaled(result, 1e-3, "Nm")
    return scaled(result, 1.0, "s" if duty.motion == "move" else "s2/rad")


def scaled(result: Result, factor: float, unit: str) -> Result:
    """A result whose objective and bound are shown in another unit."""
    found = None if result.value is None else factor * result.value
    bound = None if result.bound is None else factor * result.bound
    return replace(result, objective=result.objective | {"value": found, "unit": unit}, bound=bound)


def _curve(duty: ServoDuty, best: float, gears: float | None) -> dict[str, list[float | None]]:
    """The value about the best ratio, where the load moves and the motor's speed allows it.

    gears: inertia of a train [t mm2]; what it leaves of the value stands there too.
    """
    import numpy as np

    low, high = duty.drive.ratios(duty.speed)
    ratios = np.geomspace(max(best / REACH, low), min(best * REACH, high), POINTS)
    ratios = np.unique(np.append(ratios, best))
    values = judged(duty, ratios)
    moves = np.isfinite(values)
    found = {"total_ratio": ratios[moves].tolist(), "value": values[moves].tolist()}
    if gears is not None:
        less = judged(duty.with_gears(gears), ratios[moves])
        found["value_with_train"] = [v if math.isfinite(v) else None for v in less.tolist()]
    return found
