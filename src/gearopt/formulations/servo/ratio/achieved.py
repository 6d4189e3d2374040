"""The achievement of an axis at a ratio, with a train or without, beside the best: by its duty."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.duty import ServoDuty
from gearopt.formulations.servo.servo_design import KG_M2, Achieved, RatioCurve
from gearopt.frozen import dataclass
from gearopt.optimise.certified import run
from gearopt.physics.servo_drive import best_acceleration, mean_ramp

RPM = 30.0 / math.pi  # of a rad/s
TIE = 1e-12  # relative: a motor that is used to the full is not overloaded by rounding
POINTS = 200  # of the curve
REACH = 5.0  # of the curve, to either side of the best ratio


@dataclass(frozen=True)
class Candidate:
    """A total ratio that is judged, and the inertia of its train at the motor [t mm2].

    where: the beginning of a sentence about it. inertia: None for a bare ratio.
    """

    where: str
    ratio: float
    inertia: float | None = None


def judged(duty: ServoDuty, ratio: Any) -> Any:
    """Return the value of a duty at ratios: rad/s2, s or N m; NaN where the load does not move."""
    n = np.asarray(ratio, float)
    value = duty.value(n)
    if duty.motion == "swing":
        return 1e-3 * value
    value = np.where(duty.acceleration(n) > 0.0, value, np.nan)
    return 1.0 / value if duty.motion == "acceleration" else value


def achieved(bare: ServoDuty, one: Candidate, best: float) -> Achieved | None:
    """Achievement of a candidate beside the best value; None where the motor fails."""
    if why_not(bare, one):
        return None
    duty, ratio = bare.with_gears(one.inertia or 0.0), one.ratio
    value = float(judged(duty, ratio))
    less = 1.0 - value / best if duty.motion == "acceleration" else value / best - 1.0
    return Achieved(
        total_ratio=ratio,
        value=value,
        loss_percent=100.0 * less,
        inertia_ratio=duty.drive.load_inertia / ratio**2 / duty.drive.inertia,
        gear_inertia_kg_m2=None if one.inertia is None else KG_M2 * one.inertia,
        peak_load_torque_Nm=1e-3 * float(duty.carried_torque(ratio, 0.0, 0.0)) * ratio,
        **_speeds(duty, ratio),
        **_torques(duty, ratio, value),
    )


def _speeds(duty: ServoDuty, ratio: float) -> dict[str, float]:
    """Return the maximum motor speed, and how far it uses its limit; nothing at standstill."""
    speed, axis = duty.speed, duty.drive
    if duty.motion == "move":
        ramp = mean_ramp(float(duty.acceleration(ratio)), float(duty.deceleration(ratio)))
        peak = math.sqrt(ramp * duty.angle)
        speed = min(peak, axis.speed_limit / ratio)
    if not speed:
        return {}
    figures = {"motor_speed_rpm": RPM * ratio * speed}
    top = min(axis.speed_limit, axis.no_load_speed)
    if math.isfinite(top):
        figures["motor_speed_used_percent"] = 100.0 * ratio * speed / top
    return figures


def _torques(duty: ServoDuty, ratio: float, value: float) -> dict[str, float]:
    """Parts of the motor's torque while it accelerates; of a swing, at the peak."""
    axis = duty.drive
    to_load = axis.load_inertia / (axis.efficiency * ratio)
    friction = axis.motor_friction + axis.load_friction / (axis.efficiency * ratio)
    if duty.motion == "swing":
        peak = duty.peak_acceleration * (to_load + ratio * axis.inertia) + friction
        figures = {"peak_motor_torque_Nm": 1e-3 * peak}
        if axis.torque:
            figures["motor_torque_used_percent"] = 1e5 * value / axis.torque
        return figures
    speeding, there = float(duty.acceleration(ratio)), axis.torque - duty.slope * ratio
    gears = {"gears": speeding * ratio * axis.gear_inertia} if axis.gear_inertia else {}
    rotor = speeding * ratio * axis.motor_inertia
    parts = {"load": speeding * to_load, "rotor": rotor, **gears, "friction": friction}
    shares = {f"torque_to_{name}_percent": 100.0 * part / there for name, part in parts.items()}
    return {"motor_torque_used_percent": 100.0 * sum(parts.values()) / there} | shares


def why_not(bare: ServoDuty, one: Candidate) -> str:
    """Say why the motor does not do its duty with a candidate; empty where it does."""
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


def best_ratio_of(duty: ServoDuty) -> float | None:
    """Return the best ratio of a duty; None where nothing moves."""
    outcome = run(duty.problem())[1]
    return None if outcome.x is None else float(outcome.x[0])


def landmarks(duty: ServoDuty) -> dict[str, float]:
    """Ratio of equal inertias, and the gain of less friction at standstill.

    Losses of the train count: J_L/eta in the place of J_L, as a = T/(2 sqrt(J_L J_M/eta)) at
    N = sqrt(J_L/(eta J_M)).
    """
    axis = duty.drive
    load = axis.load_inertia / axis.efficiency
    if load == 0.0:
        return {}
    figures = {"matched_inertia_ratio": math.sqrt(load / axis.motor_inertia)}
    if duty.motion == "swing" or duty.load_speed:
        return figures
    inertias = load, axis.motor_inertia
    return figures | {
        "frictionless_load_acceleration_rad_per_s2": best_acceleration(*inertias, axis.torque),
        "load_acceleration_without_load_friction_rad_per_s2": best_acceleration(
            *inertias, axis.net_torque
        ),
    }


def values_about_best(duty: ServoDuty, best: float, gears: float | None) -> RatioCurve:
    """Return the value of a duty (as of `judged`) at ratios from best/REACH to best REACH.

    Within the ratios of the drive and the motor's speed limit; ratios at which the load does not
    move are left out. gears: inertia of a train at the motor [t mm2]; values with it stand beside,
    None where the load does not move then.
    """
    low, high = duty.drive.ratios(duty.speed)
    ratios = np.geomspace(max(best / REACH, low), min(best * REACH, high), POINTS)
    ratios = np.unique(np.append(ratios, best))
    values = judged(duty, ratios)
    moves = np.isfinite(values)
    less = [] if gears is None else judged(duty.with_gears(gears), ratios[moves]).tolist()
    return RatioCurve(
        tuple(ratios[moves].tolist()),
        tuple(values[moves].tolist()),
        tuple(v if math.isfinite(v) else None for v in less),
    )
