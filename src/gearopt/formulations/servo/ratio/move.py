"""The ratio at which a load makes a move from rest to rest in minimum time.

The motor speeds the load up and brakes it with all its torque. Friction opposes the one and helps
the other, so the ramps are not alike; losses of the train while it brakes are not counted.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import (
    acceleration_variable,
    best_ratio,
    convex_bound,
    impossible,
    law_of,
    proof,
    ratio_scales,
    standstill,
    unbounded_outcome,
    unopposed,
)
from gearopt.formulations.servo.ratio.drive import (
    FAINT,
    SEARCH_SPAN,
    Drive,
    friction_torque,
    inertia_at_motor,
    present,
    quotient,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.servo_drive import (
    load_deceleration,
    mean_ramp,
    move_time,
    shortest_move_time,
)

RANDOM = False
COUNTS = "ratio evaluated"
HALVINGS = 200  # of a bracket of ratios: to the last place


def least_move_time(drive: Drive, angle: float) -> Problem:
    """Minimise the time [s] of a move of `angle` [rad]: full torque, top speed, full braking.

    Variables: ratio, acceleration (`mean_ramp` of both ramps) and peak speed of the load, with
    friction the factor 1/(1 - share of the torque that it takes). Below the motor's speed limit the
    best peak is sqrt(a angle), above it the limit: the time as a function of the ratio has two
    regimes, which the text need not tell apart. The torque is the same up to the speed limit:
    ValueError for a drive with a no-load speed. `exact` is the root of the slope of the time.
    """
    drive.needs(torque=drive.torque, angle=angle)
    if math.isfinite(drive.no_load_speed):
        raise ValueError("a move takes the torque at the top speed, without a no_load_speed")
    rubs = drive.motor_friction > 0.0 or drive.load_friction > 0.0

    def evaluate(x: Any, p: Any) -> Terms:
        half, share = _ramps(drive, p, x.ratio, x.friction_factor if rubs else None)
        limits = {"motor_torque": x.acceleration * half}
        if drive.speed_limit < math.inf:
            limits["motor_speed"] = x.ratio * x.peak_speed / p.speed_limit
        ends, equal = drive.ratio_rows(p, x.ratio)
        time = move_time(p.angle, x.peak_speed, x.acceleration)
        defines = {"friction": 1.0 / x.friction_factor + share} if rubs else {}
        return Terms({"move_time": time}, limits | ends, defines, equal)

    free = drive.inertia == 0.0 and math.isinf(min(drive.ratio[1], drive.speed_limit))
    scales = (*ratio_scales(drive), _cubic(drive, angle))
    ratio = drive.ratio_variable(scales, free)
    ramp = acceleration_variable(drive, float(np.max(ratio.upper)))
    factor = Var("friction_factor", "", 1.0, SEARCH_SPAN, 2.0, log=True, search=True)
    variables = (ratio, ramp, _peak(ramp, angle), *((factor,) if rubs else ()))

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return the root; budget and seed change nothing."""
        values = present(problem)
        efficiency = 1.0 / (1.0 + values.get("loss", 0.0))
        return _least_time_ratio(
            replace(drive.of(values), efficiency=efficiency), values["angle"], rubs
        )

    loss = Param("loss", "", 1.0 / drive.efficiency - 1.0)  # of torque, in a part of what is left
    turn = Param("angle", "rad", angle, key="duty.angle", role="given")
    lossy = (loss,) if drive.efficiency < 1.0 else ()
    parameters = (*drive.parameters("efficiency"), *lossy, turn)
    return Problem("ratio", variables, parameters, evaluate, methods={"exact": exact})


def _ramps(drive: Drive, p: Any, ratio: Any, factor: Any) -> tuple[Any, Any]:
    """Return the mean of 1/a and 1/d [s2/rad], and the share Q of the torque that friction takes.

    a = (T - f')/i', d = (T + f)/i at the motor, i and f inertia and friction, with losses i' and
    f'. With the factor y = 1/(1 - Q), 1 - Q = (1 - f'/T)(1 + f/T),
    1/a + 1/d = (i (1 + y f f'/T^2) + y (i' + (i' - i) f/T))/T, a posynomial. factor None: no
    friction.
    """
    inertia, lossy = inertia_at_motor(drive, p, ratio, 1.0), drive.efficiency < 1.0
    heavier = p.load_inertia * p.loss / ratio if lossy and drive.load_inertia else 0.0
    if factor is None:
        return (inertia + 0.5 * heavier) / p.torque, None
    friction = friction_torque(drive, p, ratio, 1.0) / p.torque
    more = p.load_friction * p.loss / ratio / p.torque if lossy and drive.load_friction else 0.0
    both = friction * (friction + more)
    doubled = inertia * (1.0 + factor * both) + factor * inertia
    if lossy and drive.load_inertia:
        doubled = doubled + factor * heavier * (1.0 + friction)
    return 0.5 * doubled / p.torque, both + more


def _peak(ramp: Var, angle: float) -> Var:
    most = float(np.max(ramp.upper))
    high = SEARCH_SPAN * math.sqrt(most * angle)
    guess = math.sqrt(float(np.max(ramp.guess)) * angle)
    return Var("peak_speed", "rad/s", FAINT * guess, high, guess, log=True, search=True)


def _cubic(drive: Drive, angle: float) -> float:
    """Return the ratio (2 w^2 J_L/(eta Theta T))^(1/3) at the speed limit, without friction."""
    work = drive.efficiency * drive.net_torque * angle
    return float(quotient(2.0 * drive.speed_limit**2 * drive.load_inertia, work) ** (1.0 / 3.0))


def _best(drive: Drive, angle: float) -> float:
    """Return the ratio of minimum time, where the slope of the time has its root.

    With S = 1/a + 1/d, the time is sqrt(2 Theta S) where the peak speed is below the limit w/N, and
    there Theta N/w + w S/(2 N). Where the load does not move the slope counts as negative.
    """
    low, high = drive.ratio
    starting, braking, load = drive.net_torque, drive.braking_torque, drive.load_friction
    eta, limit = drive.efficiency, drive.speed_limit

    def rises(n: float) -> bool:
        """Whether the time rises with the ratio."""
        left, held = n * starting - load / eta, n * braking + load
        if not left > 0.0:
            return False
        grown = n * n * drive.inertia
        first, last = drive.load_inertia / eta + grown, drive.load_inertia + grown
        both = first / left + last / held
        slope = (2.0 * grown - first * starting * n / left) / left
        slope += (2.0 * grown - last * braking * n / held) / held  # d both/d log N
        if 2.0 * angle * n * n <= limit**2 * both:
            return slope > 0.0
        return 2.0 * angle * n * n + limit**2 * (slope - both) > 0.0

    if rises(low):
        return low
    below, above = low, 2.0 * low
    while above < high and not rises(above):
        below, above = above, 2.0 * above
    above = min(above, high)
    for _ in range(HALVINGS):
        middle = 0.5 * (below + above)
        below, above = (below, middle) if rises(middle) else (middle, above)
    return above


def _least_time_ratio(drive: Drive, angle: float, rubs: bool) -> Outcome:
    """Return the ratio of minimum time as a root, bounded by convexity. rubs: with friction."""
    ratio, best = best_ratio(drive)
    if math.isinf(ratio) and math.isinf(drive.speed_limit):
        return unbounded_outcome("time", "a motor inertia, a maximum ratio or a speed limit")
    if math.isfinite(ratio) and (reason := standstill(drive, 0.0, ratio, best)):
        return impossible(reason)
    ratio = _best(drive, angle)
    if reason := standstill(drive, 0.0, ratio, law_of(drive, 0.0, ratio)):
        return impossible(reason)

    def ramp(n: float) -> float:
        """Return the mean of both ramps; 0 where the load does not move."""
        start = law_of(drive, 0.0, n)
        numbers = drive.load_inertia, drive.inertia, drive.braking_torque, drive.load_friction
        return float(mean_ramp(start, load_deceleration(n, *numbers))) if start > 0.0 else 0.0

    def time(n: float) -> float:
        if not ramp(n) > 0.0:
            return math.inf
        return float(shortest_move_time(angle, drive.speed_limit / n, ramp(n)))

    mean, start = ramp(ratio), law_of(drive, 0.0, ratio)
    peak = min(math.sqrt(mean * angle), drive.speed_limit / ratio)
    room = min(1.0, start / unopposed(drive, ratio))
    bound = convex_bound(time, ratio, *drive.ratio, room, peak / mean / time(ratio))
    starting, braking = drive.net_torque, drive.braking_torque
    rest = 1.0 - drive.load_friction / (drive.efficiency * ratio * starting)
    rest *= starting / drive.torque * (braking + drive.load_friction / ratio) / drive.torque
    factor = [1.0 / rest] if rubs else []
    x = np.array([ratio, mean, peak, *factor])
    return Outcome(x, bound=bound, proof=proof(root=True), evaluations=6)
