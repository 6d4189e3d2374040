"""The exact methods: every train looked at, or only those that can be the best."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.duty import UNITS
from gearopt.formulations.servo.split.numbers import Numbers, numbers
from gearopt.formulations.servo.split.servo_train import OBJECTIVES, ServoTrain
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

RANDOM = False
COUNTS = "choice of teeth and modules"
STEPS = 2_000, 1_000_000  # of the kernel between two looks at the budget: at first, at the most
ROUNDING = 1e-12  # of an objective, between the kernel's text and the problem's
FLAT = 1e-11  # of a duty's: along a row of wheel teeth rounding may hide a better train
NO_TEETH = "no teeth and modules meet all limits"
KERNEL = "gearopt.formulations.servo.split.teeth_kernel"
DUTY = "gearopt.formulations.servo.split.duty_kernel"


def method(train: ServoTrain, goal: str, whole: bool) -> Any:
    """A run(problem, budget, seed, watch) for the best train; whole: every train is looked at."""

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """All first stages in turn, by the kernel; the seed changes nothing."""
        given, aim = numbers(train, goal in UNITS), (*OBJECTIVES, *UNITS).index(goal)
        code = kernel(DUTY if goal in UNITS and not whole else KERNEL)
        look = code.every if whole else code.useful
        found, count = np.zeros(6, np.int64), kernel(KERNEL).first_stages(given)[0]
        look(given, aim, 0, 0, math.inf, found)  # compiled before the clock starts
        clock, best, feasible = Clock(budget, watch), math.inf, 0
        first, (steps, most) = 0, STEPS
        while first < count:
            best, more, good, first = look(given, aim, first, steps, best, found)
            feasible, steps = feasible + good, min(2 * steps, most)
            clock.evaluations, clock.best = clock.evaluations + more, best
            if first < count and not clock.tell():
                break
        looked = clock.evaluations
        proof = _proof(looked, feasible if whole else None, first == count)
        if goal in UNITS and best > given.duty[-1] * (1.0 + ROUNDING):  # of a swing, rms torque
            best = math.inf
        slack = FLAT if goal in UNITS else ROUNDING
        return _outcome(given, found, best, looked, proof, first == count, slack)

    return run


def _proof(looked: int, feasible: int | None, done: bool) -> dict[str, Any]:
    found: dict[str, Any] = {
        "method": "exhausted" if done else "enumeration, stopped early",
        "arithmetic": "ratios and diameters in whole numbers; the rest in double",
        "trains_looked_at": looked,
    }
    return found if feasible is None else {**found, "feasible_trains": feasible}


def sentence(proof: Mapping[str, Any], infeasible: bool) -> str:
    """Return what a reader is told of an enumeration, by the counts of its proof."""
    apart = " and ".join(proof.get("not_counted", ()))
    but = f" but {apart}" if apart else ""
    feasible = proof.get("feasible_trains")
    counted = "" if feasible is None else f", {feasible:,} meet all limits{but}"
    rest = "meets all limits" if infeasible else "can be better"
    return (
        f"Proof: {proof['trains_looked_at']:,} choices of teeth and modules looked at{counted}; "
        f"no other {rest}."
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
        return Outcome(x, finished=False, evaluations=looked, message="stopped before the end")
    proof["sentence"] = sentence(proof, x is None)
    if x is None:
        return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=NO_TEETH)
    return Outcome(x, bound=best * (1.0 - slack), proof=proof, evaluations=looked)


def point(given: Numbers, row: Any) -> Array:
    """The point of a kernel's row: pinion teeth, wheel teeth, modules, of both stages."""
    z1, z2, z3, z4, i, j = (int(v) for v in row)
    return np.array([z1, z3, z2, z4, given.module[i], given.module[j]], float)
