"""The integer problem: whole teeth and modules of a two-stage servo train, by exhaustion.

`enumeration` evaluates every train, `exact` only those that can be the best. `feasible` and
`trains` list trains as points of `problem`, (trains, 6); their `check` is called several times a
second and may raise, to stop.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split.bodies import rows
from gearopt.formulations.servo.split.numbers import Numbers, posed
from gearopt.formulations.servo.split.servo_train import (
    ServoTrain,
    bending_stress,
    objectives,
    pairs,
    pinion_torques,
)
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var

RANDOM = False
COUNTS = "choice of teeth and modules"
KERNEL_STEPS = 2_000, 1_000_000  # of the kernel between two checks of the budget: at first, maximum
ROUNDING = 1e-12  # of an objective, between the kernel's text and the problem's
FLAT = 1e-11  # of a duty's: along a row of wheel teeth rounding may hide a better train
NO_TEETH = "no teeth and modules meet all limits"
KERNEL = "gearopt.formulations.servo.split.teeth_kernel"
DUTY = "gearopt.formulations.servo.split.duty_kernel"


def problem(train: ServoTrain, *goals: str) -> Problem:
    """Minimise inertia [t mm2] at the motor, mass [kg], error [rad] or the goal of the duty.

    goals: of `ServoTrain.goals`, by default inertia; several for a Pareto front (`nsga2`). The
    limits of the duty stand where its goal does: the motor then moves the load. Variables, of both
    stages: pinion_teeth, wheel_teeth, module [mm]. With one goal, `exact` evaluates every train
    that can be the best, `enumeration` at all of them and counts the feasible ones.
    """
    goals = goals or ("inertia",)
    low, high = (float(r) for r in train.ratios)

    def evaluate(x: Any, p: Any) -> Terms:
        first, second = both = pairs((*x.pinion_teeth, *x.wheel_teeth, *x.module), train.face_width)
        ratios = (first.ratio, second.ratio)
        bounded = () if math.isinf(train.error) else ("error",)
        values = objectives(train, (*goals, *bounded), both)
        tips = [pair.wheel.tip_diameter for pair in both]
        limits = {name: values[name] / train.error for name in bounded} | {
            "ratio_low": low / (ratios[0] * ratios[1]),
            "ratio_high": ratios[0] * ratios[1] / high,
            "stage_ratio_low": tuple(1.0 / n for n in ratios),
            "bending_stress": tuple(
                bending_stress(torque * pair.ratio, pair) / train.bending
                for torque, pair in zip(pinion_torques(train, both), both, strict=True)
            ),
            "second_pinion_diameter_low": float(train.bore) / second.pinion.reference_diameter,
            "wheel_tip_diameter": tuple(
                t / float(w) for t, w in zip(tips, train.wheel_tips, strict=True)
            ),
        }
        if train.duty is not None and (goal := train.duty.goal) in goals:
            limits |= train.duty.limits(ratios[0] * ratios[1], values[goal])
        if train.bodies is not None:
            limits |= rows(train.bodies, both)
        return Terms({g: values[g] for g in goals}, limits)

    methods = {}
    if len(goals) == 1:
        methods = {
            "exact": method(train, goals[0], whole=False),
            "enumeration": method(train, goals[0], whole=True),
        }
    return Problem("split", _variables(train), (), evaluate, methods=methods)


def _variables(train: ServoTrain) -> tuple[Var, ...]:
    low, high = train.pinion_teeth
    wheel = max(train.wheel_teeth, low)
    modules = tuple(sorted(float(m) for m in train.modules))
    return (
        Var("pinion_teeth", "", low, high, low, 2, integer=True, key="train.pinion_teeth"),
        Var("wheel_teeth", "", low, wheel, low, 2, integer=True, key=("", "train.wheel_teeth")),
        Var("module", "mm", modules[0], modules[-1], modules[0], 2, values=modules),
    )


def method(train: ServoTrain, goal: str, whole: bool) -> Any:
    """Return a run(problem, budget, seed, watch) for the best train; whole: of every train."""

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Evaluate all first stages in turn, by the kernel; the seed changes nothing."""
        (given, aim), moved = posed(train, goal), bool(GOALS[goal].motion)
        code = kernel(DUTY if moved and not whole else KERNEL)
        look = code.every if whole else code.useful
        teeth, count = np.zeros(6, np.int64), kernel(KERNEL).first_stages(given)[0]
        look(given, aim, 0, 0, math.inf, teeth)  # compiled before the clock starts
        clock, best, feasible = Clock(budget, watch), math.inf, 0
        first, (steps, most) = 0, KERNEL_STEPS
        while first < count:
            best, more, good, first = look(given, aim, first, steps, best, teeth)
            feasible, steps = feasible + good, min(2 * steps, most)
            clock.evaluations, clock.best = clock.evaluations + more, best
            if first < count and not clock.tell():
                break
        looked = clock.evaluations
        proof = exhaustion(looked, feasible if whole else None, first == count)
        if moved and best > given.duty[-1] * (1.0 + ROUNDING):  # of a swing, rms torque
            best = math.inf
        slack = FLAT if moved else ROUNDING
        return _outcome(given, teeth, best, looked, proof, first == count, slack)

    return run


def exhaustion(looked: int, feasible: int | None, done: bool) -> dict[str, Any]:
    """Return how an enumeration is proven, or how far it came; feasible: where counted."""
    proof: dict[str, Any] = {
        "method": "exhausted" if done else "enumeration, stopped early",
        "arithmetic": "ratios and diameters in whole numbers; the rest in double",
        "trains_looked_at": looked,
    }
    return proof if feasible is None else {**proof, "feasible_trains": feasible}


def sentence(proof: Mapping[str, Any], infeasible: bool) -> str:
    """Return the sentence of an enumeration, by the counts of its proof."""
    apart = " and ".join(proof.get("not_counted", ()))
    but = f" but {apart}" if apart else ""
    feasible = proof.get("feasible_trains")
    counted = "" if feasible is None else f", {feasible:,} meet all limits{but}"
    rest = "no choice meets all limits" if infeasible else "no other can be better"
    return (
        f"Proof: {proof['trains_looked_at']:,} choices of teeth and modules examined{counted}; "
        f"{rest}."
    )


def _outcome(
    given: Numbers,
    found: Any,
    best: float,
    looked: int,
    proof: dict[str, Any],
    done: bool,
    slack: float,
) -> Outcome:
    x = point(given, found) if math.isfinite(best) else None
    if not done:
        return Outcome(x, finished=False, evaluations=looked, message="stopped by the budget")
    proof["sentence"] = sentence(proof, x is None)
    if x is None:
        return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=NO_TEETH)
    return Outcome(x, bound=best * (1.0 - slack), proof=proof, evaluations=looked)


def point(given: Numbers, row: Any) -> Array:
    """Return the point of a kernel's row: pinion teeth, wheel teeth, modules, of both stages."""
    z1, z2, z3, z4, i, j = (int(v) for v in row)
    return np.array([z1, z3, z2, z4, given.module[i], given.module[j]], float)


LISTING_STEPS = 1_000_000  # of the kernel that lists trains, between two checks
FIRST_NOTES = 4096  # trains that it may note between two checks, at first


def unchecked() -> None:
    """Let a list of trains go on to its end."""


def feasible(
    train: ServoTrain,
    goal: str = "inertia",
    maximum: int = 0,
    check: Callable[[], None] = unchecked,
) -> Array | None:
    """Return all feasible trains; None for more than `maximum` above 0.

    A duty as goal adds its limits.
    """
    return _trains_between(*posed(train, goal), -math.inf, math.inf, maximum, check)


def trains(train: ServoTrain, error: float) -> Array:
    """Return all feasible trains with an error [rad] up to `error`, the minimum first."""
    listed = _trains_between(*posed(train, "error"), -math.inf, error, 0, unchecked)
    assert listed is not None
    return listed[problem(train, "error").batch(listed).F[:, 0].argsort(kind="stable")]


def _trains_between(
    given: Numbers, aim: int, above: float, maximum: float, limit: int, check: Callable[[], None]
) -> Array | None:
    """Return trains between two values; None where they are more than a limit above 0."""
    parts, total, first = [], 0, 0
    rows, count = np.empty((FIRST_NOTES, 6), np.int64), kernel(KERNEL).first_stages(given)[0]
    while first < count:
        check()
        good, last = kernel(DUTY).between(given, aim, first, LISTING_STEPS, above, maximum, rows)
        if good > len(rows):
            rows = np.empty((2 * good, 6), np.int64)
            continue
        parts.append(rows[:good].copy())
        total, first = total + good, last
        if 0 < limit < total:
            return None
    return points(given, np.concatenate([rows[:0], *parts]))


def points(given: Numbers, rows: Any) -> Array:
    """Return the points of a kernel's rows (N, 6): pinion and wheel teeth, modules."""
    z1, z2, z3, z4, i, j = rows.T
    return np.column_stack([z1, z3, z2, z4, given.module[i], given.module[j]]).astype(float)
