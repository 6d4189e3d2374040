"""The ratio at which a load makes a move from rest to rest in minimum time."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import (
    acceleration_variable,
    best_ratio,
    impossible,
    law_of,
    proof,
    ratio_scales,
    standstill,
    unbounded,
    unopposed,
)
from gearopt.formulations.servo.ratio.drive import BEYOND, FAINT, Drive, present, quotient
from gearopt.formulations.servo.ratio.secant_bound import convex_bound
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.servo_drive import move_time, shortest_move_time

RANDOM = False
COUNTS = "ratio evaluated"
HALVINGS = 200  # of a bracket of ratios: to the last place


def move(drive: Drive, angle: float) -> Problem:
    """Minimise the time [s] of a move of `angle` [rad]; the brake's ramp mirrors the start's.

    Variables: ratio, acceleration, and peak speed of the load. Below the motor's speed limit the
    best peak is sqrt(a angle), above it the limit: the time as a function of the ratio has two
    regimes, which the text need not tell apart. While the load brakes, friction helps, so the
    mirrored ramp needs less torque. The torque is the same up to the speed limit: ValueError for a
    drive with a no-load speed. `exact` is a closed form, or a root of a quartic with load friction.
    """
    drive.needs(torque=drive.torque, angle=angle)
    if math.isfinite(drive.no_load_speed):
        raise ValueError("a move takes the torque at the top speed, without a no_load_speed")

    def evaluate(x: Any, p: Any) -> Terms:
        limits = {"motor_torque": drive.torque_needed(p, x.ratio, x.acceleration) / p.torque}
        if drive.speed_limit < math.inf:
            limits["motor_speed"] = x.ratio * x.peak_speed / p.speed_limit
        ends, equal = drive.ratio_rows(p, x.ratio)
        time = move_time(p.angle, x.peak_speed, x.acceleration)
        return Terms({"move_time": time}, limits | ends, equal=equal)

    free = drive.inertia == 0.0 and math.isinf(min(drive.ratio[1], drive.speed_limit))
    scales = (*ratio_scales(drive), _cubic(drive, angle))
    ratio = drive.ratio_variable(scales, free)
    ramp = acceleration_variable(drive, float(np.max(ratio.upper)))
    variables = (ratio, ramp, _peak(ramp, angle))

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return the closed form, or root; budget and seed change nothing."""
        values = present(problem)
        return _exact(drive.of(values), values["angle"])

    parameters = (*drive.parameters(), Param("angle", "rad", angle, key="duty.angle", role="given"))
    return Problem("ratio", variables, parameters, evaluate, methods={"exact": exact})


def _peak(ramp: Var, angle: float) -> Var:
    most = float(np.max(ramp.upper))
    high = BEYOND * math.sqrt(most * angle)
    guess = math.sqrt(float(np.max(ramp.guess)) * angle)
    return Var("peak_speed", "rad/s", FAINT * guess, high, guess, log=True, search=True)


def _cubic(drive: Drive, angle: float) -> float:
    """Return the ratio (2 w^2 J_L/(eta Theta T))^(1/3) at the speed limit, without friction."""
    work = drive.efficiency * drive.net_torque * angle
    return float(quotient(2.0 * drive.speed_limit**2 * drive.load_inertia, work) ** (1.0 / 3.0))


def _limited(drive: Drive, angle: float) -> float:
    """Return the ratio of minimum time where the motor runs at its speed limit w.

    With load friction the root above F_L/(eta T) of the stationarity of Theta N/w + w/(N a(N)):
    (Theta/w^2) N^2 (eta T N - F)^2 - eta J F N^2 - 2 eta J_L T N + J_L F = 0.
    """
    friction, torque = drive.load_friction, drive.efficiency * drive.net_torque
    if friction == 0.0:
        return _cubic(drive, angle)
    weight, load = angle / drive.speed_limit**2, drive.load_inertia

    def rising(n: float) -> bool:
        needs = drive.efficiency * drive.inertia * friction * n * n + 2.0 * torque * load * n
        return weight * (n * (torque * n - friction)) ** 2 + load * friction > needs

    low = high = friction / torque
    while not rising(high):
        low, high = high, 2.0 * high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rising(middle) else (middle, high)
    return high


def _exact(drive: Drive, angle: float) -> Outcome:
    """Return the best of the two regimes; the bound follows from convexity alone."""
    low, high = drive.ratio
    ratio, best = best_ratio(drive)
    if math.isinf(ratio) and math.isinf(drive.speed_limit):
        return unbounded("time", "a motor inertia, a maximum ratio or a speed limit")
    if math.isfinite(ratio) and (reason := standstill(drive, 0.0, ratio, best)):
        return impossible(reason)
    if math.isinf(ratio) or best * angle > (drive.speed_limit / ratio) ** 2:
        ratio = min(max(_limited(drive, angle), low), high)
        if reason := standstill(drive, 0.0, ratio, law_of(drive, 0.0, ratio)):
            return impossible(reason)

    def time(n: float) -> float:
        ramp = law_of(drive, 0.0, n)
        if not ramp > 0.0:
            return math.inf
        return float(shortest_move_time(angle, drive.speed_limit / n, ramp))

    ramp = law_of(drive, 0.0, ratio)
    peak = min(math.sqrt(ramp * angle), drive.speed_limit / ratio)
    room = min(1.0, ramp / unopposed(drive, ratio))
    bound = convex_bound(time, ratio, low, high, room, peak / ramp / time(ratio))
    return Outcome(np.array([ratio, ramp, peak]), bound=bound, proof=proof(), evaluations=6)
