"""Fronts of a drive of whole teeth against the largest utilisation of its load limits.

The utilisation is a maximum over the stages and does not add up, so the front is made of epsilon
steps: at a utilisation u the load limits are u times as large, or the safety factors that are asked
for 1/u times, and the search for the best train is exhausted.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth.progress import TIE
from gearopt.formulations.drive.train import Train
from gearopt.formulations.strength.standard import MODES
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Terms

UTILISATION = "utilisation"
LAST_IS_LEAST = (
    "Proof: complete searches at smaller and smaller utilisations; the last one found no design."
)
OBJECTIVE_TOO_LARGE = (
    "the best train of this utilisation is beyond the largest value of its objective"
)
# relative: between a utilisation that a train has and one that none has
UTILISATION_TOLERANCE = 4e-7


def problem(train: Train, names: tuple[str, ...]) -> Problem:
    """Return the problem of a drive with several objectives, the utilisation among them."""
    own = tuple(name for name in names if name != UTILISATION)
    base, limited = teeth.problem(replace(train, objective=own[0], others=own[1:])), _loads(train)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = base.evaluate(x, p)
        loads = [v for name, v in terms.limits.items() if name.partition("[")[0] in limited]
        worth = {**terms.minimise, UTILISATION: _largest(loads)}
        return replace(terms, minimise={name: worth[name] for name in names})

    return replace(base, evaluate=evaluate, methods={}, relaxed=None)


def _loads(train: Train) -> set[str]:
    """Return the names of the limits on loads: of the law, and of ratings."""
    rated = {one.suffix for stage in train.stages for o in stage.options for one in o.standards}
    return {*train.law.names, *(f"{mode}{suffix}" for mode in MODES for suffix in rated)}


def discrete(train: Train) -> bool:
    """Return whether the drive has a finite number of designs: no face width is free."""
    faces = [stage.face_width for stage in train.stages]
    return all(f.tied or f.step is not None or f.fixed is not None for f in faces)


def _largest(values: list[Any]) -> Any:
    found = values[0]
    for value in values[1:]:
        found = np.maximum(found, value)
    return found


def limited(train: Train, name: str, most: Mapping[str, float]) -> Problem:
    """Return the problem of one objective under limits on others; its `exact` proves it.

    The train's objective and the utilisation may be limited: what the best train of a utilisation
    exceeds, every train of it does.
    """
    own = problem(train, (train.objective, UTILISATION))
    used, largest = min(1.0, most.get(UTILISATION, 1.0)), most.get(train.objective, math.inf)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = own.evaluate(x, p)
        return replace(terms, minimise={name: terms.minimise[name]})

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Find the best train, or halve the range of utilisations; the seed changes nothing."""
        if name == UTILISATION:
            return _least(train, own, used, largest, Clock(budget, watch))
        return _best(train, own, used, largest, budget, watch)

    return replace(own, evaluate=evaluate, methods={"exact": exact})


def carrying(train: Train, used: float) -> Train:
    """The drive with load limits times a factor above 0 and up to 1."""
    stages = [replace(s, allowable=tuple(used * a for a in s.allowable)) for s in train.stages]
    bending, contact = train.safety
    return replace(train, stages=tuple(stages), safety=(bending / used, contact / used))


def _best(
    train: Train, own: Problem, used: float, largest: float, budget: Budget, watch: Watch | None
) -> Outcome:
    """Return the best train of a utilisation; none where its objective exceeds the largest."""
    one = teeth.problem(replace(carrying(train, used), others=()))
    outcome: Outcome = one.methods["exact"](one, budget, 0, watch)
    if outcome.x is None or own.batch(outcome.x[None]).F[0, 0] <= largest * (1.0 + TIE):
        return outcome
    return replace(
        outcome, x=None, bound=None, infeasible=outcome.finished, message=OBJECTIVE_TOO_LARGE
    )


def _least(train: Train, own: Problem, high: float, largest: float, clock: Clock) -> Outcome:
    """Return a train of the least utilisation, proven within UTILISATION_TOLERANCE.

    high: utilisation at most; largest: of the train's objective.
    """
    low, best, tried = 0.0, None, high
    while best is None or high > low * (1.0 + UTILISATION_TOLERANCE):
        found = _best(train, own, tried, largest, clock.left, clock.inner(values=False))
        clock.evaluations += found.evaluations
        if found.x is not None:
            best = found.x
            high = min(tried, float(own.batch(best[None]).F[0, 1]))
        elif found.infeasible and best is None:
            return replace(found, evaluations=clock.evaluations)
        elif found.infeasible:
            low = tried
        if not clock.tell() or not found.finished:
            bound, proof = (low, _none_up_to(low)) if low else (None, None)
            return Outcome(best, False, bound=bound, proof=proof, evaluations=clock.evaluations)
        tried = math.sqrt(low * high) if low else 0.5 * high
    proof = {"method": "exhausted", "sentence": LAST_IS_LEAST}
    return Outcome(best, bound=low, proof=proof, evaluations=clock.evaluations)


def _none_up_to(used: float) -> dict[str, Any]:
    """Proof that no design has a utilisation, of a search for the least that was stopped."""
    words = f"Proof: a complete search found no design of a utilisation up to {100.0 * used:.4g} %."
    return {"method": "exhausted, stopped early", "sentence": words}
