"""The total ratio of a servo axis: the best one, how flat its optimum is, a given one beside it."""

import math
from dataclasses import replace
from typing import Any

from gearopt.formulations.ratio import acceleration, move, swing
from gearopt.formulations.ratio.drive import Drive
from gearopt.optimise.problem import Problem
from gearopt.optimise.progress import in_part
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.physics.servo_drive import (
    largest_acceleration,
    load_acceleration,
    rms_torque,
    shortest_move_time,
    torque_slope,
)
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.tables.servo import Scene
from gearopt.scenes.tables.servo_motion import Duty, drive

NAMES = {  # of the value that a duty is judged by, its unit, and as a key
    "acceleration": ("load acceleration", "rad/s²", "load_acceleration_rad_per_s2"),
    "move": ("move time", "s", "move_time_s"),
    "swing": ("rms torque", "N m", "rms_torque_Nm"),
}
UNITS = {"acceleration": (1.0, "s2/rad"), "move": (1.0, "s"), "swing": (1e-3, "Nm")}
POINTS = 200  # of the curve
REACH = 5.0  # of the curve, to either side of the best ratio


def problem(duty: Duty, axis: Drive) -> Problem:
    """The problem of a duty."""
    if duty.motion == "move":
        assert duty.angle is not None
        return move(axis, duty.angle.value)
    if duty.motion == "swing":
        assert duty.amplitude is not None
        return swing(axis, duty.amplitude.value, _angular(duty))
    return acceleration(axis, duty.load_speed.value if duty.load_speed else 0.0)


def _angular(duty: Duty) -> float:
    assert duty.frequency is not None
    return 2.0 * math.pi * duty.frequency.value


def speed(duty: Duty) -> float:
    """Speed of the load [rad/s] at which the motor must keep to its limit."""
    if duty.motion == "swing":
        assert duty.amplitude is not None
        return duty.amplitude.value * _angular(duty)
    return duty.load_speed.value if duty.load_speed else 0.0


def value(duty: Duty, axis: Drive, ratio: Any) -> Any:
    """What a duty is judged by, at ratios: rad/s2, s or N m; NaN where the load does not move."""
    import numpy as np

    n = np.asarray(ratio, float)
    if duty.motion == "swing":
        assert duty.amplitude is not None
        peak = duty.amplitude.value * _angular(duty) ** 2
        own = axis.load_inertia, axis.inertia, peak, axis.load_friction, axis.motor_friction
        return 1e-3 * rms_torque(n, *own)
    slope = torque_slope(axis.torque, speed(duty), axis.no_load_speed)
    own = axis.load_inertia, axis.inertia, axis.net_torque, axis.load_friction, axis.efficiency
    found = load_acceleration(n, *own, slope)
    found = np.where(found > 0.0, found, np.nan)
    if duty.motion == "acceleration":
        return found
    assert duty.angle is not None
    return shortest_move_time(duty.angle.value, axis.speed_limit / n, found)


def ratio_part(scene: Scene, ask: Ask) -> tuple[Result, dict[str, Any], dict[str, Any]]:
    """The certified best ratio, its part of the design, and its part of the report."""
    duty, motor, load = scene.duty, scene.motor, scene.load
    assert duty is not None and motor is not None and load is not None
    axis = drive(motor, load)
    factor, unit = UNITS[duty.motion]
    watch = in_part(ask.watch, unit, factor=factor)
    result, outcome = run(problem(duty, axis), ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = converted(result, duty)
    if result.value is None or outcome.x is None:
        return result, {}, {}
    best = float(outcome.x[0])
    name, unit, key = NAMES[duty.motion]
    reached = float(value(duty, axis, best))
    design = {
        "duty": duty.motion,
        "total_ratio": best,
        "value": reached,
        "name": name,
        "unit": unit,
        "given": _given(scene, axis, reached),
        "curve": _curve(duty, axis, best),
    }
    report = {"best_total_ratio": best, f"best_{key}": reached} | _landmarks(scene, axis)
    if (given := design["given"]) is not None:
        report[f"given_{key}"] = given["value"]  # type: ignore[index]
    return replace(result, design={"ratio": design}), design, report


def _landmarks(scene: Scene, axis: Drive) -> dict[str, float]:
    """The ratio of equal inertias, and what less friction would give at standstill.

    Losses of the train count: J_L/eta in the place of J_L, as a = T/(2 sqrt(J_L J_M/eta)) at
    N = sqrt(J_L/(eta J_M)).
    """
    duty, load = scene.duty, axis.load_inertia / axis.efficiency
    assert duty is not None
    if load == 0.0:
        return {}
    found = {"matched_inertia_ratio": math.sqrt(load / axis.motor_inertia)}
    if duty.motion == "swing" or duty.load_speed is not None:
        return found
    inertias = load, axis.motor_inertia
    return found | {
        "frictionless_load_acceleration_rad_per_s2": largest_acceleration(*inertias, axis.torque),
        "load_acceleration_without_load_friction_rad_per_s2": largest_acceleration(
            *inertias, axis.net_torque
        ),
    }


def with_train(scene: Scene, gear_inertia: float) -> dict[str, Any]:
    """The best ratio where the train's own inertia [t mm2] at the motor is counted too."""
    duty, motor, load = scene.duty, scene.motor, scene.load
    assert duty is not None and motor is not None and load is not None
    axis = drive(motor, load, gear_inertia)
    result, outcome = run(problem(duty, axis))
    if result.value is None or outcome.x is None:
        return {}
    best = float(outcome.x[0])
    key = NAMES[duty.motion][2]
    return {
        "best_total_ratio_with_train": best,
        f"best_{key}_with_train": float(value(duty, axis, best)),
    }


def converted(result: Result, duty: Duty) -> Result:
    """The result of a duty in plain units: 1/a in s2/rad, time in s, torque in N m."""
    return scaled(result, *UNITS[duty.motion])


def scaled(result: Result, factor: float, unit: str) -> Result:
    """A result whose objective and bound are shown in another unit."""
    found = None if result.value is None else factor * result.value
    bound = None if result.bound is None else factor * result.bound
    return replace(result, objective=result.objective | {"value": found, "unit": unit}, bound=bound)


def _asked(scene: Scene) -> float | None:
    """The total ratio that the file gives."""
    assert scene.duty is not None
    if scene.duty.ratio is not None:
        return float(scene.duty.ratio)
    return None if scene.train is None else float(scene.train.ratios[0])


def no_given(scene: Scene) -> str:
    """Why the ratio of the file has no value; empty where it has one, or is not given."""
    duty, motor, load = scene.duty, scene.motor, scene.load
    if duty is None or (asked := _asked(scene)) is None:
        return ""
    assert motor is not None and load is not None
    axis = drive(motor, load)
    if asked > axis.ratios(speed(duty))[1]:
        return (
            f"At the given ratio of {asked:g} the motor would turn at {asked * speed(duty):.6g} "
            f"rad/s, above its limit of {axis.speed_limit:.6g} rad/s."
        )
    there = float(value(duty, axis, asked))
    if not math.isfinite(there):
        return f"At the given ratio of {asked:g} the load does not move."
    if duty.motion == "swing" and 0.0 < axis.torque < 1e3 * there:
        return (
            f"At the given ratio of {asked:g} the motor would need an rms torque of {there:.6g} "
            f"N m, above its {1e-3 * axis.torque:.6g} N m."
        )
    return ""


def _given(scene: Scene, axis: Drive, best: float) -> dict[str, Any] | None:
    """The ratio of the file beside the best one; None where it gives none that can be."""
    duty, asked = scene.duty, _asked(scene)
    assert duty is not None
    if asked is None or no_given(scene):
        return None
    there = float(value(duty, axis, asked))
    more = duty.motion == "acceleration"
    loss = 100.0 * (1.0 - there / best if more else there / best - 1.0)
    return {"total_ratio": asked, "value": there, "loss_percent": loss}


def _curve(duty: Duty, axis: Drive, best: float) -> dict[str, list[float]]:
    """The value about the best ratio, where the load moves and the motor's speed allows it."""
    import numpy as np

    low, high = axis.ratios(speed(duty))
    ratios = np.geomspace(max(best / REACH, low), min(best * REACH, high), POINTS)
    ratios = np.unique(np.append(ratios, best))
    values = value(duty, axis, ratios)
    moves = np.isfinite(values)
    return {"total_ratio": ratios[moves].tolist(), "value": values[moves].tolist()}
