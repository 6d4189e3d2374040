"""The continuous relaxation of the integer problem: a geometric program, hence a proven bound."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from gearopt.formulations.servo.split.bodies import Pairs, clear_rows
from gearopt.formulations.servo.split.servo_train import (
    ServoTrain,
    bending_stress,
    objectives,
    ratio_parameters,
    ratio_rows,
)
from gearopt.formulations.strength.laws.lewis import lewis
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.gears import GearPair, disc_inertia

TIPS = ("train.wheel_tip_diameters[1]", "train.wheel_tip_diameters[2]")  # in a problem file
SECOND = "train.second_pinion_diameter"
SEARCH_SPAN = 1e3  # factor between the lengths of a train and the ends of the search


def relaxation(train: ServoTrain, goal: str = "inertia") -> Problem:
    """Minimise a goal over real-valued teeth and modules: a lower bound for whole teeth.

    Variables, of both stages: pinion_diameter [mm], ratio, module [mm]; those of the duty's own
    problem where its goal is asked for. The form factor of either pinion is that of the maximum
    number of teeth, which no pinion exceeds; `clear_rows` relax what gears keep clear of. Meshes
    whose windup is an error are as stiff as with any teeth.
    """
    if train.elastic is not None:
        train = replace(train, elastic=train.elastic.stiffest())
    low, high = (float(r) for r in train.ratios)
    moved = _duty_problem(train, goal)

    def evaluate(x: Any, p: Any) -> Terms:
        return _terms(train, goal, moved, x, p)

    tips = tuple(float(t) for t in train.wheel_tips)
    error = (Param("error", "rad", train.error, key="accuracy.error", role="limit"),)
    stress = Param("bending_stress", "MPa", train.bending, key="train.bending_stress", role="limit")
    parameters = (
        *(error if math.isfinite(train.error) else ()),
        *((stress,) if _torque(train) > 0.0 else ()),
        *ratio_parameters(low, high),
        Param("second_pinion_diameter", "mm", float(train.bore), key=SECOND, role="limit"),
        Param("wheel_tip_diameter", "mm", tips, 2, TIPS, "limit"),
    )
    variables = _variables(train)
    if moved is not None:
        known = {q.name for q in parameters} | {"gear_inertia"}
        parameters += tuple(q for q in moved.parameters if q.name not in known)
        variables += tuple(v for v in moved.variables if v.name != "ratio")
    return Problem("split relaxation", variables, parameters, evaluate)


def _duty_problem(train: ServoTrain, goal: str) -> Problem | None:
    """Return the duty's own problem for trains of these ratios; None where it is not the goal.

    The gears' inertia is a number there, which any train exceeds and the text below replaces.
    """
    if train.duty is None or goal != train.duty.goal:
        return None
    smallest = disc_inertia(train.density, train.face_width, _size(train)[0])
    drive = replace(train.duty.drive, gear_inertia=float(smallest), ratio=(1.0, math.inf))
    return replace(train.duty, drive=drive).problem()


def _terms(train: ServoTrain, goal: str, moved: Problem | None, x: Any, p: Any) -> Terms:
    n1, n2 = x.ratio
    first, second = (
        GearPair.of_diameter(m, d / m, d, n, train.face_width)
        for m, d, n in zip(x.module, x.pinion_diameter, x.ratio, strict=True)
    )
    both = first, second
    bounded = ("error",) if math.isfinite(train.error) else ()
    plain = (goal,) if moved is None else ("inertia",)
    worth = objectives(train, (*plain, *bounded), both)
    limits, equal = ratio_rows(p, train.tolerance == 0, n1 * n2)
    limits |= {name: worth[name] / p.error for name in bounded}
    limits |= _limits(train, both, x, p)
    if (known := train.bodies) is not None:
        shaft, output, motor = (
            float(d) or None for d in (known.shaft, known.output_shaft, known.motor)
        )
        limits |= clear_rows(shaft, output, motor, both)
    if moved is None:
        return Terms({goal: worth[goal]}, limits, equal=equal)
    numbers = SimpleNamespace(**vars(p) | {"gear_inertia": worth["inertia"], "ratio_low": 1.0})
    duty = moved.evaluate(SimpleNamespace(**vars(x) | {"ratio": n1 * n2}), numbers)
    limits |= {name: v for name, v in duty.limits.items() if name != "ratio_low"}
    return Terms(duty.minimise, limits, duty.defines, equal)


def _limits(train: ServoTrain, both: Pairs, x: Any, p: Any) -> dict[str, Any]:
    """Return the limits of either stage: stress, diameters, numbers of teeth and modules."""
    law, ends = lewis(float(train.pinion_teeth[1])), _modules(train)
    torque = _torque(train)
    torques = torque / x.ratio[1], torque
    low, high = train.pinion_teeth
    sizes = list(zip(x.pinion_diameter, x.module, strict=True))
    limits = {
        "stage_ratio_low": tuple(1.0 / n for n in x.ratio),
        "second_pinion_diameter_low": p.second_pinion_diameter / x.pinion_diameter[1],
        "wheel_tip_diameter": tuple(
            pair.wheel.tip_diameter / t for pair, t in zip(both, p.wheel_tip_diameter, strict=True)
        ),
        "pinion_teeth_low": tuple(low * m / d for d, m in sizes),
        "pinion_teeth_high": tuple(d / (high * m) for d, m in sizes),
        "module_low": tuple(ends[0] / m for m in x.module),
        "module_high": tuple(m / ends[1] for m in x.module),
    }
    if torque > 0.0:
        limits["bending_stress"] = tuple(
            bending_stress(t, pair, law) / p.bending_stress
            for t, pair in zip(torques, both, strict=True)
        )
    if (most := train.max_wheel_teeth) is not None:
        wheels = [pair.wheel.reference_diameter for pair in both]
        limits["wheel_teeth_high"] = tuple(
            d / (most * m) for d, m in zip(wheels, x.module, strict=True)
        )
    return limits


def _torque(train: ServoTrain) -> float:
    """Return a torque at the output [N mm] that all trains carry."""
    moved = 0.0 if train.duty is None else train.duty.minimum_load_torque
    return max(train.output_torque, moved)


def _modules(train: ServoTrain) -> tuple[float, float]:
    return float(min(train.modules)), float(max(train.modules))


def _size(train: ServoTrain) -> tuple[float, float]:
    """Return the reference diameter of the smallest pinion, and the largest tip of a wheel [mm]."""
    return train.pinion_teeth[0] * _modules(train)[0], float(max(train.wheel_tips))


def _variables(train: ServoTrain) -> tuple[Var, ...]:
    ends, guess = _modules(train), float(train.bore)
    size = (*_size(train), guess)
    least, most = min(size) / SEARCH_SPAN, max(size) * SEARCH_SPAN
    even = float(train.ratio) ** 0.5
    return (
        Var("pinion_diameter", "mm", least, most, guess, 2, log=True, search=True),
        Var("ratio", "", 1.0 / SEARCH_SPAN, even**2 * SEARCH_SPAN, even, 2, log=True, search=True),
        Var(
            "module",
            "mm",
            ends[0] / SEARCH_SPAN,
            ends[1] * SEARCH_SPAN,
            ends[0],
            2,
            log=True,
            search=True,
        ),
    )
