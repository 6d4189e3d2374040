"""How many stages, and how a total ratio is split among them: the bare inertia and mass.

All pinions alike, all gears solid discs of one width: no limits but the ratio. It shows what
the integer problem is up against: inertia wants ratios that rise towards the load and many stages,
mass wants them equal. `staged`: total ratio and its split at once, where the gears' own inertia
counts.
"""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import acceleration
from gearopt.formulations.servo.ratio.drive import Drive
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import CLOSED_FORM, Budget, Outcome, Result, Watch
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Param, Terms, Var, each

RANDOM = False
COUNTS = "split evaluated"
SEARCH_SPAN = 1e3  # factor between a total ratio and the upper end of the search for a stage's
NEWTON = 100  # steps at most: from above the root of a convex function they fall to it


def core(ratio: float, stages: int, goal: str = "inertia") -> Problem:
    """Minimise train inertia or mass, in those of one pinion, over the stage ratios.

    inertia: sum_i (1 + n_i^2)/prod_{j<i} n_j^2, seen at the motor. mass: sum_i (1 + n_i^2).
    Variable: ratio, one per stage, each at least 1. ratio: the total one, > 1. `exact` is a closed
    form, for mass and for up to two stages.
    """
    if goal not in ("inertia", "mass"):
        raise ValueError(f"no goal {goal!r}; inertia or mass")
    if not ratio > 1.0 or stages < 1:
        raise ValueError("a split needs a ratio above 1 and at least one stage")

    def evaluate(x: Any, p: Any) -> Terms:
        ratios = each(x.ratio)
        mass = sum(1.0 + n**2 for n in ratios)
        index = inertia_index(ratios) if goal == "inertia" else mass
        return Terms({goal: index}, equal={"ratio": math.prod(ratios) / p.total})

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return equal ratios for mass; for inertia of two stages the root of a cubic."""
        total = float(problem.parameter_values()[0])
        x = np.full(stages, total ** (1.0 / stages))
        if goal == "inertia" and stages == 2:
            first = first_ratio(total)
            x = np.array([first, total / first])
        value = float(problem.batch(x[None]).F[0, 0])
        proof = {"method": "closed form", "arithmetic": "double", "sentence": CLOSED_FORM}
        return Outcome(x, bound=value * (1.0 - 1e-14), proof=proof, evaluations=1)

    closed = goal == "mass" or stages <= 2
    even = ratio ** (1.0 / stages)
    variable = Var("ratio", "", 1.0, SEARCH_SPAN * ratio, even, stages, log=True)
    total = Param("total", "", ratio, role="given")
    methods = {"exact": exact} if closed else {}
    return Problem("split core", (variable,), (total,), evaluate, methods=methods)


def inertia_index(ratios: tuple[Any, ...]) -> Any:
    """Return the inertia sum_i (1 + n_i^2)/prod_{j<i} n_j^2 at the motor, in that of a pinion."""
    index, through = 0.0, 1.0
    for n in ratios:
        index = index + (1.0 + n**2) / through**2
        through = through * n
    return index


def stage_counts(ratio: float, maximum: int = 4, goal: str = "inertia") -> tuple[Result, ...]:
    """Return the best split into 1, 2 ... `maximum` stages, each certified."""
    return tuple(solve(core(ratio, k, goal)) for k in range(1, maximum + 1))


def first_ratio(ratio: float, scale: float = 1.0) -> float:
    """Return the ratio n_1 of the first of two stages of minimum inertia.

    x^3 - rho x - 2 rho N^2 = 0 with x = n_1^2; ratio N > 1; scale rho > 0: inertia of the second
    pinion, and scale of its wheel, in terms of the first. About (sqrt(2 rho) N)^(1/3).
    """
    if not ratio > 1.0 or not scale > 0.0:
        raise ValueError("a split needs a ratio above 1 and a positive scale")
    x = (2.0 * scale * ratio**2) ** (1.0 / 3.0) + scale**0.5  # above the root
    for _ in range(NEWTON):
        step = (x**3 - scale * x - 2.0 * scale * ratio**2) / (3.0 * x**2 - scale)
        if not step > 1e-16 * x:
            break
        x -= step
    return min(max(math.sqrt(x), 1.0), ratio)


def lightest_stage_ratio() -> float:
    """Return the ratio n of all stages at minimum mass, their number free: n^2 ln n^2 = n^2 + 1."""
    x = 4.0
    for _ in range(NEWTON):
        step = (x * math.log(x) - x - 1.0) / math.log(x)
        if not abs(step) > 1e-16 * x:
            break
        x -= step
    return math.sqrt(x)


def staged(drive: Drive, pinion_inertia: float, stages: int, load_speed: float = 0.0) -> Problem:
    """Minimise 1/a [s2/rad] over the ratios of all stages; see `acceleration`.

    The gears add J_p sum_i (1 + n_i^2)/prod_{j<i} n_j^2 to the motor's inertia: solid discs of one
    width, pinions of pinion_inertia J_p [t mm2] > 0 each. Variables: stage_ratio, at least 1 each,
    and acceleration. A posynomial, so that Ipopt's answer comes with its bound.
    """
    drive.needs(pinion_inertia=pinion_inertia, stages=stages)
    plain = acceleration(drive, load_speed)
    lightest = replace(
        drive, gear_inertia=drive.gear_inertia + pinion_inertia
    )  # any train adds more
    ratio, ramp = acceleration(lightest, load_speed).variables

    def evaluate(x: Any, p: Any) -> Terms:
        ratios = each(x.stage_ratio)
        total = math.prod(ratios)
        terms = plain.evaluate(SimpleNamespace(ratio=total, acceleration=x.acceleration), p)
        gears = p.pinion_inertia * inertia_index(ratios) * total * x.acceleration / p.torque
        limits = dict(terms.limits) | {"motor_torque": terms.limits["motor_torque"] + gears}
        limits["stage_ratio_low"] = tuple(1.0 / n for n in ratios)
        return Terms(terms.minimise, limits, equal=terms.equal)

    guess = max(1.0, float(np.max(ratio.guess)) ** (1.0 / stages))
    each_ratio = Var(
        "stage_ratio", "", ratio.lower, ratio.upper, guess, stages, log=True, search=True
    )
    parameters = (*plain.parameters, Param("pinion_inertia", "t mm2", pinion_inertia))
    return Problem("ratio and split", (each_ratio, ramp), parameters, evaluate)
