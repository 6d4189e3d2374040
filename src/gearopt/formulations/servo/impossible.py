"""Why a servo train is impossible: limits in conflict, a ratio too narrow, bodies in the way."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.servo import split
from gearopt.formulations.servo.split import Bodies, ServoTrain
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.handles import handles
from gearopt.optimise.explaining.repair import conflict
from gearopt.optimise.solve import solve_within

WIDER = tuple(Fraction(1, 10**k) for k in range(6, 0, -1))  # ratio tolerances that are tried
FAINT = 1e-9  # N mm, a torque that loads no tooth


def status(train: ServoTrain, clock: Clock) -> str:
    """Return the status of a train in any box, whatever its duty."""
    return "limit" if clock.over else solve_within(clock, split.problem(train)).status


def by_motion(train: ServoTrain, clock: Clock) -> bool:
    """Return whether a train is impossible only as its teeth carry the duty's motion."""
    if train.duty is None:
        return False
    still = replace(train, duty=None, output_torque=train.output_torque or FAINT)
    return status(train, clock) == "infeasible" and status(still, clock) == "optimal"


def in_conflict(train: ServoTrain, clock: Clock, goal: str = "") -> tuple[str, ...]:
    """Return limits in conflict for real-valued teeth and modules, each needed for it."""
    known = "error" if train.lost_motion is not None else "inertia"
    relaxed = split.relaxation(train, goal or known)
    if solve_within(clock, relaxed).status != "infeasible":
        return ()
    return tuple(handle.name for handle in conflict(relaxed, handles(relaxed), clock))


def nearest(train: ServoTrain, clock: Clock, goal: str = "") -> dict[str, float]:
    """Return the utilisations of real-valued teeth and modules that violate the limits least.

    Nothing where they meet all limits.
    """
    known = "error" if train.lost_motion is not None else "inertia"
    result = solve_within(clock, split.relaxation(train, goal or known))
    return dict(result.report.get("nearest", {}))


def minimum_error(train: ServoTrain, clock: Clock) -> float | None:
    """Return a bound of the error [rad] of real-valued teeth and modules; None without one."""
    relaxed = split.relaxation(replace(train, error=math.pi), "error")
    return solve_within(clock, relaxed).bound


def with_wider_ratio(train: ServoTrain, clock: Clock) -> ServoTrain | None:
    """Return the train with the smallest tolerance of `WIDER` that whole teeth meet, or None."""
    for tolerance in WIDER:
        other = replace(train, tolerance=tolerance)
        if tolerance > train.tolerance and status(other, clock) == "optimal":
            return other
    return None


def in_the_way(train: ServoTrain, clock: Clock) -> Bodies | None:
    """Return the bodies that leave no train room, those of diameter 0 being none of them.

    None where a train is possible with all of them, or impossible without any.
    """
    if train.bodies is None or status(train, clock) != "infeasible":
        return None
    if status(replace(train, bodies=None), clock) != "optimal":
        return None
    blamed = train.bodies
    for name in ("shaft", "motor", "output_shaft"):
        none: dict[str, Any] = {name: Fraction(0)}
        thinner = replace(blamed, **none)
        if status(replace(train, bodies=thinner), clock) == "infeasible":
            blamed = thinner
    return blamed
