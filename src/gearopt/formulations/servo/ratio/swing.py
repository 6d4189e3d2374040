"""The ratio at which a load swings as A sin(w t) at minimum rms torque of the motor."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import (
    convex_bound,
    impossible,
    proof,
    unbounded_outcome,
)
from gearopt.formulations.servo.ratio.drive import Drive, friction_torque, inertia_at_motor, present
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Param, Terms
from gearopt.physics.servo_drive import rms_torque

RANDOM = False
COUNTS = "ratio evaluated"
HALVINGS = 200  # of a bracket of ratios: to the last place


def swing(drive: Drive, amplitude: float, angular_frequency: float) -> Problem:
    """Minimise the motor's rms torque [N mm] for A sin(w t) at the load; Coulomb friction.

    amplitude A [rad], angular_frequency w [rad/s] > 0. Variable: ratio. ValueError for a train with
    losses: then power flows both ways and the friction model of `rms_torque` does not hold. A drive
    with a torque gives no larger rms torque. `exact` is the root of a quartic. Source: derived from
    Youn, eq. (1).
    """
    drive.needs(amplitude=amplitude, angular_frequency=angular_frequency)
    if drive.efficiency != 1.0:
        raise ValueError("the rms torque is that of a train without losses: efficiency 1")

    def evaluate(x: Any, p: Any) -> Terms:
        speed = p.amplitude * p.angular_frequency
        inertia = speed * p.angular_frequency * inertia_at_motor(drive, p, x.ratio, 1.0)
        square = inertia**2 / 2.0
        if drive.load_friction or drive.motor_friction:
            square = square + friction_torque(drive, p, x.ratio, 1.0) ** 2
        limits, equal = drive.ratio_rows(p, x.ratio)
        if drive.speed_limit < math.inf:
            limits["motor_speed"] = x.ratio * speed / p.speed_limit
        if drive.torque:
            limits["motor_torque"] = square**0.5 / p.torque
        return Terms({"rms_torque": square**0.5}, limits, equal=equal)

    ratio = _stationary(drive, amplitude * angular_frequency**2)
    most = drive.ratios(amplitude * angular_frequency)[1]
    variable = drive.ratio_variable((ratio, most), math.isinf(ratio) and math.isinf(most))
    of_swing = (
        Param("amplitude", "rad", amplitude, key="duty.amplitude", role="given"),
        Param("angular_frequency", "rad/s", angular_frequency, key="duty.frequency", role="given"),
    )

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return the root; budget and seed change nothing."""
        values = present(problem)
        return _exact(drive.of(values), values["amplitude"], values["angular_frequency"])

    parameters = (*drive.parameters("no_load_speed", "efficiency"), *of_swing)
    return Problem("ratio", (variable,), parameters, evaluate, methods={"exact": exact})


def _stationary(drive: Drive, peak: float) -> float:
    """Return the positive root of P^2 J^2 N^4 - 2 F_L F_M N = P^2 J_L^2 + 2 F_L^2, P = A w^2.

    It is the only one; for F_M = 0 it is ((J_L/J)^2 + 2 F_L^2/(J P)^2)^(1/4).
    """
    inertia, load, friction = drive.inertia, drive.load_inertia, drive.load_friction
    if inertia == 0.0:
        return math.inf
    offset = math.hypot(load / inertia, math.sqrt(2.0) * friction / (inertia * peak))
    mixed = 2.0 * friction * drive.motor_friction / (inertia * peak) ** 2
    low = math.sqrt(offset)
    high = low + float(mixed ** (1.0 / 3.0))  # there N^4 > offset^2 + mixed N
    for _ in range(HALVINGS if mixed else 0):
        middle = 0.5 * (low + high)
        above = middle * (middle**3 - mixed) > offset**2
        low, high = (low, middle) if above else (middle, high)
    return high


def _exact(drive: Drive, amplitude: float, angular_frequency: float) -> Outcome:
    peak = amplitude * angular_frequency**2
    low, high = drive.ratios(amplitude * angular_frequency)
    if low > high:
        return impossible(f"the motor's speed limit allows a ratio of at most {high:.6g}")
    ratio = min(max(_stationary(drive, peak), low), high)
    if math.isinf(ratio):
        return unbounded_outcome("rms torque", "a motor inertia, a maximum ratio or a speed limit")

    def law(n: float) -> float:
        numbers = drive.load_inertia, drive.inertia, peak
        return float(rms_torque(n, *numbers, drive.load_friction, drive.motor_friction))

    bound = convex_bound(law, ratio, low, high)
    if bound is not None and 0.0 < drive.torque < bound:
        return impossible(
            f"at the best ratio, {ratio:.6g}, the rms torque is {1e-3 * law(ratio):.6g} N m, above "
            f"the motor's {1e-3 * drive.torque:.6g} N m"
        )
    return Outcome(np.array([ratio]), bound=bound, proof=proof(root=True), evaluations=6)
