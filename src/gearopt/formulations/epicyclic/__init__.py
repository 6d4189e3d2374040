"""The teeth of a planetary train: nearest to a ratio, of least loss, or of the smallest ring."""

from typing import Any

import numpy as np

from gearopt.formulations.epicyclic.request import Request
from gearopt.formulations.epicyclic.search import best
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Terms, Var

RANDOM = False
COUNTS = "train looked at"
LEFT = "those that equal centre distances and a bound of the ratio leave"
PROVEN = f"Proof: trains were looked at one by one, {LEFT}: {{:,}}. Fractions decide their order."
NONE = f"Proof: trains were looked at one by one, {LEFT}: {{:,}}; none meets all limits."


def problem(request: Request) -> Problem:
    """The problem of a request; variables: teeth of every gear, by its name."""

    def evaluate(x: Any, _: Any) -> Terms:
        z = [np.rint(getattr(x, f"{name}_teeth")).astype(np.int64) for name in request.gears]
        return Terms({request.goal: request.goal_of(z)}, request.used(z))

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Look at every train that may be the best; the seed changes nothing."""
        known = best(request, Clock(budget, watch))
        x = None if known.key is None else np.array(known.key[2], float)
        proof = {"method": "exhausted", "arithmetic": "rational", "trains": known.looked}
        if not known.done:
            return Outcome(x, finished=False, evaluations=known.looked, message="stopped early")
        if x is None:
            proof["sentence"] = NONE.format(known.looked)
            given = [low for low, high in request.teeth if low == high]
            x = np.array(given, float) if len(given) == len(request.teeth) else None
            return Outcome(x, infeasible=True, proof=proof, evaluations=known.looked)
        proof["sentence"] = PROVEN.format(known.looked)
        return Outcome(x, bound=float(known.bound), proof=proof, evaluations=known.looked)

    teeth = tuple(
        Var(f"{name}_teeth", "", low, high, low, integer=True, key=f"teeth.{name}")
        for name, (low, high) in zip(request.gears, request.teeth, strict=True)
    )
    methods = {"exact": exact}
    return Problem("epicyclic", teeth, (), evaluate, methods=methods, vectorised=True)
