"""The ratio at which a motor accelerates its load most, at standstill or at a load speed.

`convex_bound` bounds any law that is convex in log-log from its values beside a point: where it is
not lower one step to the left and one to the right, secants through the steps bound the rest.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.drive import FAINT, SEARCH_SPAN, Drive, present, quotient
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import CLOSED_FORM, Budget, Outcome, Watch
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.servo_drive import load_acceleration, torque_slope

RANDOM = False
COUNTS = "ratio evaluated"
ROOT = "Proof: the optimum as a root of the slope, and a lower bound that follows from convexity."
STANDING = 1e-12  # of the torque that friction leaves, where rounding decides whether it moves


def acceleration(drive: Drive, load_speed: float = 0.0) -> Problem:
    """Minimise 1/a, a the acceleration of the load [rad/s2] at load_speed [rad/s].

    Variables: ratio, acceleration. `exact` is the closed form. Source: Youn, eqs. (3) to (6).
    """
    drive.needs(torque=drive.torque)
    if not 0.0 <= load_speed < math.inf:
        raise ValueError(f"load_speed = {load_speed!r}: needs a number >= 0, or positive")
    line, capped = (load_speed > 0.0 and math.isfinite(s) for s in _speeds(drive))

    def evaluate(x: Any, p: Any) -> Terms:
        needed = drive.torque_needed(p, x.ratio, x.acceleration) / p.torque
        if line:
            needed = needed + x.ratio * p.load_speed / p.no_load_speed
        limits = {"motor_torque": needed}
        if capped:
            limits["motor_speed"] = x.ratio * p.load_speed / p.speed_limit
        ends, equal = drive.ratio_rows(p, x.ratio)
        return Terms({"inverse_acceleration": 1.0 / x.acceleration}, limits | ends, equal=equal)

    free = math.isinf(_stationary(drive, load_speed)) and math.isinf(drive.ratios(load_speed)[1])
    scales = (*ratio_scales(drive), *(quotient(s, load_speed) for s in _speeds(drive)))
    ratio = drive.ratio_variable(scales, free)
    variables = (ratio, acceleration_variable(drive, float(np.max(ratio.upper))))

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return the closed form; budget and seed change nothing."""
        values = present(problem)
        return _exact(drive.of(values), values.get("load_speed", 0.0))

    if line or capped:
        parameters = (
            Param("load_speed", "rad/s", load_speed, key="duty.load_speed", role="given"),
            *drive.parameters(),
        )
    else:
        parameters = drive.parameters("no_load_speed", "speed_limit")
    return Problem("ratio", variables, parameters, evaluate, methods={"exact": exact})


def _speeds(drive: Drive) -> tuple[float, float]:
    return drive.no_load_speed, drive.speed_limit


def ratio_scales(drive: Drive) -> tuple[float, float]:
    """Return the ratios of equal inertias and of a torque that just overcomes load friction."""
    match = math.sqrt(quotient(drive.load_inertia, drive.inertia))
    return match, quotient(drive.load_friction, drive.efficiency * drive.net_torque)


def acceleration_variable(drive: Drive, largest_ratio: float) -> Var:
    """Return the variable of the load's acceleration [rad/s2] up to the largest ratio."""
    product = math.sqrt(drive.load_inertia) * math.sqrt(drive.inertia)
    most = drive.torque * quotient(1.0, product)
    if drive.load_inertia:
        most = min(most, drive.torque * largest_ratio / drive.load_inertia)
    if drive.inertia:
        most = min(most, drive.torque * SEARCH_SPAN / (drive.inertia * drive.ratio[0]))
    low = FAINT * most if 0.0 < most < math.inf else FAINT
    high = most if most > 0.0 else 1.0
    guess = 0.1 * high if high < math.inf else 1.0
    return Var("acceleration", "rad/s2", low, high, guess, log=True, search=True)


def best_ratio(drive: Drive, load_speed: float = 0.0) -> tuple[float, float]:
    """Return the ratio of maximum acceleration, and that acceleration [rad/s2]: closed form.

    N^2 - 2 c N - q = 0, c = F_L/(eta T) - b J_L/(eta T J), q = J_L/(eta J), J of motor and gears,
    then held within the drive's ratios, as 1/a is convex in log N. Where nothing moves, the
    acceleration is 0 or negative; the ratio is infinite where no largest acceleration exists.
    """
    low, high = drive.ratios(load_speed)
    ratio = min(max(_stationary(drive, load_speed), low), high)
    return ratio, law_of(drive, load_speed, ratio) if ratio < math.inf else math.inf


def _stationary(drive: Drive, load_speed: float) -> float:
    """Return the positive root, multiplied out by J: no cancellation, no quotient by J."""
    torque, inertia, eta = drive.net_torque, drive.inertia, drive.efficiency
    if torque <= 0.0:
        return drive.ratio[0]
    slope = torque_slope(drive.torque, load_speed, drive.no_load_speed)
    linear = (drive.load_friction * inertia - slope * drive.load_inertia) / (eta * torque)
    product = math.sqrt(drive.load_inertia / eta) * math.sqrt(inertia)
    size = math.hypot(linear, product)
    if linear < 0.0:
        return float(drive.load_inertia / (eta * (size - linear)))
    return quotient(linear + size, inertia)


def law_of(drive: Drive, load_speed: float, ratio: float) -> float:
    """Return the acceleration [rad/s2] of the drive's load at a load speed [rad/s] and ratio."""
    slope = torque_slope(drive.torque, load_speed, drive.no_load_speed)
    rate: float = load_acceleration(
        ratio,
        drive.load_inertia,
        drive.inertia,
        drive.net_torque,
        drive.load_friction,
        drive.efficiency,
        slope,
    )
    return rate


def _exact(drive: Drive, load_speed: float) -> Outcome:
    """Return the ratio of maximum acceleration in closed form, bounded by convexity alone."""
    low, high = drive.ratios(load_speed)
    if low > high:
        return impossible(f"the motor's speed limit allows a ratio of at most {high:.6g}")
    ratio, best = best_ratio(drive, load_speed)
    if math.isinf(ratio):
        return unbounded_outcome(
            "acceleration", "a motor inertia, a maximum ratio or a speed limit"
        )
    if reason := standstill(drive, load_speed, ratio, best):
        return impossible(reason)

    def inverse(n: float) -> float:
        law = law_of(drive, load_speed, n)
        return 1.0 / law if law > 0.0 else math.inf

    bound = convex_bound(inverse, ratio, low, high, min(1.0, best / unopposed(drive, ratio)))
    return Outcome(np.array([ratio, best]), bound=bound, proof=proof(), evaluations=6)


def standstill(drive: Drive, load_speed: float, ratio: float, best: float) -> str:
    """Say why the load does not move at its best ratio; empty where it does."""
    if drive.net_torque <= 0.0:
        return "the motor's own friction takes all its torque"
    if best > STANDING * unopposed(drive, ratio):
        return ""
    slope = torque_slope(drive.torque, load_speed, drive.no_load_speed)
    torque, friction = drive.efficiency * drive.net_torque**2, 4.0 * slope * drive.load_friction
    why = f"at the best ratio, {ratio:.6g}, the acceleration is {best:.3g} rad/s2"
    if torque <= friction * (1.0 + STANDING):
        why += ": the falling torque never exceeds the load's friction"
    return why


def unopposed(drive: Drive, ratio: float) -> float:
    """Return the acceleration [rad/s2] at a ratio without friction and falling line."""
    rate: float = load_acceleration(
        ratio, drive.load_inertia, drive.inertia, drive.net_torque, 0.0, drive.efficiency
    )
    return rate


def proof(root: bool = False) -> dict[str, Any]:
    """Return how a closed form, or a root of the slope, is proven: by the law and convexity."""
    method, words = ("root of the slope", ROOT) if root else ("closed form", CLOSED_FORM)
    return {
        "method": method,
        "arithmetic": "double",
        "bound": "log-log convexity",
        "sentence": words,
    }


def impossible(reason: str) -> Outcome:
    """Outcome for a drive that cannot meet its duty."""
    reasons = proof() | {"reason": reason, "sentence": f"Proof: {reason}."}
    return Outcome(None, infeasible=True, proof=reasons, message=reason, evaluations=1)


def unbounded_outcome(what: str, remedy: str) -> Outcome:
    """Return an outcome for a duty without a best ratio."""
    text = f"unbounded: the larger the ratio, the better the {what}; give {remedy}"
    return Outcome(None, message=text, evaluations=1)


STEP = 1e-5  # of the logarithm: the bound is below the value by half the curvature times 1e-10
DOUBT = 1e-14  # relative rounding of a law


def convex_bound(
    law: Callable[[float], float],
    at: float,
    low: float,
    high: float,
    room: float = 1.0,
    share: float = 1.0,
) -> float | None:
    """Return a lower bound of law > 0 on [low, high]; None where the point is no minimum.

    law: convex in log-log on its domain, infinite or NaN outside; at: the point. room: its relative
    distance from the end of the domain, at most 1, which makes steps as much shorter; what vanishes
    there, and is rounded as much more, has a share in the law.
    """

    def rise(steps: float) -> float:
        """Return log(law/value) some steps beside the point; infinite outside the domain."""
        there = law(at * math.exp(steps * STEP * room))
        return math.log(there / value) if 0.0 < there < math.inf else math.inf

    def side(sign: float, width: float) -> float:
        """Return the minimum rise on one side within a factor `width`; -inf: not known."""
        if width <= 1.0:
            return math.inf
        back, near, far = (rise(sign * k) for k in (-1.0, 1.0, 2.0))
        if near < 0.0 and math.log(width) > STEP * room:
            return -math.inf
        lines = (-back, min(2.0 * near - far, near))  # the least of each secant on one step
        return max((s for s in lines if math.isfinite(s)), default=-math.inf)

    value = law(at)
    if not 0.0 < value < math.inf or at * math.exp(STEP * room) <= at:
        return None  # also where rounding swallows a step: it would show nothing
    least = min(side(-1.0, at / low), side(1.0, high / at))
    if least == -math.inf:
        return None
    return value * math.exp(min(least, 0.0) - 4.0 * DOUBT * (1.0 + share / room))
