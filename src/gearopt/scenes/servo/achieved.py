"""What an axis achieves with a train, chosen or given, or at a ratio: by the duty of its file."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gearopt.formulations.servo.ratio import ServoDuty
from gearopt.scenes.servo.gears import KG_M2, described, given_gears
from gearopt.scenes.servo.scene import Scene

NAMES = {  # of the value that a duty is judged by, its unit, and as a key
    "acceleration": ("load acceleration", "rad/s²", "load_acceleration_rad_per_s2"),
    "move": ("move time", "s", "move_time_s"),
    "swing": ("rms torque", "Nm", "rms_torque_Nm"),
}
RPM = 30.0 / math.pi  # of a rad/s
TIE = 1e-12  # relative: a motor that is used to the full is not overloaded by rounding


@dataclass(frozen=True)
class Candidate:
    """A total ratio that is judged, and the inertia of its train at the motor [t mm2].

    where: the beginning of a sentence about it. inertia: None for a bare ratio.
    """

    where: str
    ratio: float
    inertia: float | None = None


def candidates(scene: Scene, chosen: Mapping[str, Any] | None) -> dict[str, Candidate]:
    """The ratio of [duty], the chosen train as `design` has it, and the given one beside it."""
    found = {}
    if scene.duty is not None and scene.duty.ratio is not None:
        asked = float(scene.duty.ratio)
        found["given"] = Candidate(f"At the given ratio of {asked:g}", asked)
    trains = {"chosen": chosen if scene.train else None}
    if scene.train is not None and (gears := given_gears(scene)) is not None:
        trains["given_train"] = described(scene, gears)
    for who, train in trains.items():
        if train is not None:
            where = f"With the {who.removesuffix('_train')} train, of ratio {train['ratio']:.6g},"
            found[who] = Candidate(where, train["ratio"], train["inertia_kg_m2"] / KG_M2)
    return found


def judged(duty: ServoDuty, ratio: Any) -> Any:
    """What a duty is judged by, at ratios: rad/s2, s or N m; NaN where the load does not move."""
    import numpy as np

    n = np.asarray(ratio, float)
    value = duty.value(n)
    if duty.motion == "swing":
        return 1e-3 * value
    value = np.where(duty.acceleration(n) > 0.0, value, np.nan)
    return 1.0 / value if duty.motion == "acceleration" else value


def achieved(bare: ServoDuty, one: Candidate, best: float) -> dict[str, Any] | None:
    """What a candidate gives, beside the best value of all; None where the motor fails."""
    if why_not(bare, one):
        return None
    duty, ratio = bare.with_gears(one.inertia or 0.0), one.ratio
    value = float(judged(duty, ratio))
    less = 1.0 - value / best if duty.motion == "acceleration" else value / best - 1.0
    found = {"total_ratio": ratio, "value": value, "loss_percent": 100.0 * less}
    if one.inertia is not None:
        found["gear_inertia_kg_m2"] = KG_M2 * one.inertia
    found["inertia_ratio"] = duty.drive.load_inertia / ratio**2 / duty.drive.inertia
    return found | _speeds(duty, ratio) | _torques(duty, ratio, value)


def _speeds(duty: ServoDuty, ratio: float) -> dict[str, float]:
    """Largest speed of the motor, and how far it uses its limit; nothing at standstill."""
    speed, axis = duty.speed, duty.drive
    if duty.motion == "move":
        peak = math.sqrt(float(duty.acceleration(ratio)) * duty.angle)
        speed = min(peak, axis.speed_limit / ratio)
    if not speed:
        return {}
    found = {"motor_speed_rpm": RPM * ratio * speed}
    top = min(axis.speed_limit, axis.no_load_speed)
    if math.isfinite(top):
        found["motor_speed_used_percent"] = 100.0 * ratio * speed / top
    return found


def _torques(duty: ServoDuty, ratio: float, value: float) -> dict[str, float]:
    """What the motor's torque is spent on while it accelerates; of a swing, rms and peak."""
    axis = duty.drive
    to_load = axis.load_inertia / (axis.efficiency * ratio)
    friction = axis.motor_friction + axis.load_friction / (axis.efficiency * ratio)
    if duty.motion == "swing":
        peak = duty.peak_acceleration * (to_load + ratio * axis.inertia) + friction
        found = {"peak_motor_torque_Nm": 1e-3 * peak}
        if axis.torque:
            found["motor_torque_used_percent"] = 1e5 * value / axis.torque
        return found
    speeding, there = float(duty.acceleration(ratio)), axis.torque - duty.slope * ratio
    gears = {"gears": speeding * ratio * axis.gear_inertia} if axis.gear_inertia else {}
    rotor = speeding * ratio * axis.motor_inertia
    parts = {"load": speeding * to_load, "rotor": rotor, **gears, "friction": friction}
    shares = {f"torque_to_{name}_percent": 100.0 * part / there for name, part in parts.items()}
    return {"motor_torque_used_percent": 100.0 * sum(parts.values()) / there} | shares


def why_not(bare: ServoDuty, one: Candidate) -> str:
    """Why the motor does not do its duty with a candidate; empty where it does."""
    duty, ratio, axis = bare.with_gears(one.inertia or 0.0), one.ratio, bare.drive
    if ratio > axis.ratios(duty.speed)[1] * (1.0 + TIE):
        return (
            f"{one.where} the motor would turn at {ratio * duty.speed:.6g} rad/s, above its limit "
            f"of {axis.speed_limit:.6g} rad/s."
        )
    there = float(judged(duty, ratio))
    if not math.isfinite(there):
        return f"{one.where} the load does not move."
    if duty.motion == "swing" and 0.0 < axis.torque * (1.0 + TIE) < 1e3 * there:
        return (
            f"{one.where} the motor would need an rms torque of {there:.6g} N m, above its "
            f"{1e-3 * axis.torque:.6g} N m."
        )
    return ""
