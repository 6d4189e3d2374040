"""Whether any design of the ranges meets each limit: decided at one corner of them.

Mass rises with face width and rim, the displacement falls with the stiffness of the bearings, and
what a ramp asks of the contact ratio is least for the shortest ramp and a ratio next to 1.5.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.orbit.orbit_text import limits, parameters, shared
from gearopt.formulations.dynamics.orbit.task import VARIABLES, Task, solid
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Outcome
from gearopt.optimise.terms import Terms

MIDDLE = 1.5  # the contact ratio at which a ramp of 1/2 still fits
SENTENCE = (
    "Proof: where it is least, at a corner of the ranges, the limited quantity exceeds its limit."
)
WORDS = {
    "mass": "the mass of the narrowest gears with the lightest rims",
    "displacement": "the displacement of the axes on the stiffest bearings",
    "ramp": "the shortest ramp at the contact ratio that leaves most room for it",
}


def least_limits(task: Task) -> dict[str, float]:
    """Return the least that each limit is on the ranges of a task; the larger one of both ramps."""
    low, high = task.box()
    corner = [high[0], np.clip(MIDDLE, low[1], high[1]), low[2], low[3], low[4]]
    given = SimpleNamespace(**dict(zip(VARIABLES, corner, strict=True)))
    rows = limits(task, given, SimpleNamespace(**{p.name: p.value for p in parameters(task)}))
    ramp = max(rows["ramp_of_two_pairs"], rows["ramp_of_one_pair"])
    return {"mass": rows["mass"], "displacement": rows["displacement"], "ramp": ramp}


def impossible(task: Task) -> Outcome | None:
    """Return the proof that no design meets the limits; None where each can be met.

    They ask different variables, but for both ramps, which are met together: where each can be
    met, one design meets all of them.
    """
    over = {n: float(v) for n, v in least_limits(task).items() if v > 1.0 + FEASIBLE}
    if not over:
        return None
    excesses = [
        f"{WORDS[n]} is {v:.4g} times what is allowed" for n, v in over.items() if n != "ramp"
    ]
    excesses += [f"{WORDS['ramp']} is {over['ramp'] - 1.0:.4g} too long"] if "ramp" in over else []
    proof: dict[str, Any] = {"method": "corner", "conflict": list(over), "sentence": SENTENCE}
    proof |= {"arithmetic": "double", "least_violation": max(over.values()) - 1.0}
    return Outcome(None, infeasible=True, proof=proof, message="; ".join(excesses))


def limited(task: Task) -> Problem:
    """Return the problem of the least mass [t] under all limits but those of a motion."""

    def evaluate(x: Any, p: Any) -> Terms:
        return Terms({"mass_t": solid(task) * x.face_width * x.rim}, limits(task, x, p))

    return Problem("orbit", shared(task), parameters(task), evaluate)
