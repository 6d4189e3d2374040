"""The integer problem: whole teeth and modules of a two-stage servo train."""

import math
from typing import Any

from gearopt.formulations.servo.split import exact
from gearopt.formulations.servo.split.bodies import rows
from gearopt.formulations.servo.split.servo_train import (
    ServoTrain,
    bending_stress,
    objectives,
    pairs,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var


def problem(train: ServoTrain, *goals: str) -> Problem:
    """Least inertia [t mm2] at the motor, mass [kg] or error [rad] of a train, or that of its duty.

    goals: of `ServoTrain.goals`, by default inertia; several for a front (`nsga2`). The limits of
    the duty stand where its goal does: the motor then moves the load. Variables, of both
    stages: pinion_teeth, wheel_teeth, module [mm]. With one goal, `exact` looks at every train that
    can be the best, `enumeration` at all of them and counts the feasible ones.
    """
    goals = goals or ("inertia",)
    low, high = (float(r) for r in train.ratios)

    def evaluate(x: Any, p: Any) -> Terms:
        first, second = both = pairs((*x.pinion_teeth, *x.wheel_teeth, *x.module), train.face_width)
        ratios = (first.ratio, second.ratio)
        bounded = () if math.isinf(train.error) else ("error",)
        found = objectives(train, (*goals, *bounded), both)
        torques = train.output_torque / second.ratio, train.output_torque
        stress = [bending_stress(torque, p) for torque, p in zip(torques, both, strict=True)]
        tips = [pair.wheel.tip_diameter for pair in both]
        limits = {name: found[name] / train.error for name in bounded} | {
            "ratio_low": low / (ratios[0] * ratios[1]),
            "ratio_high": ratios[0] * ratios[1] / high,
            "stage_ratio_low": tuple(1.0 / n for n in ratios),
            "bending_stress": tuple(s / train.bending for s in stress),
            "bore": float(train.bore) / second.pinion.reference_diameter,
            "wheel_tip": tuple(t / float(w) for t, w in zip(tips, train.wheel_tips, strict=True)),
        }
        if train.duty is not None and (goal := train.duty.goal) in goals:
            limits |= train.duty.limits(ratios[0] * ratios[1], found[goal])
        if train.bodies is not None:
            limits |= rows(train.bodies, both)
        return Terms({g: found[g] for g in goals}, limits)

    methods = {}
    if len(goals) == 1:
        methods = {
            "exact": exact.method(train, goals[0], whole=False),
            "enumeration": exact.method(train, goals[0], whole=True),
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
