"""Drives of whole teeth of least extremes, and fronts against them.

An extreme is a maximum over the stages and does not add up: the largest utilisation of the load
limits, axial force, specific sliding or inverse contact ratio. So a front is made of epsilon steps,
and the least extreme is halved in on: at each the extreme is a limit, and the search for the best
train is exhausted. At a utilisation u the load limits are u times as large, or the safety factors
that are asked for 1/u times.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth.progress import TIE
from gearopt.formulations.drive.train import Train, axial_force
from gearopt.formulations.strength.standard import MODES
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Terms
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import largest_sliding
from gearopt.physics.loads import torque_ratios

UTILISATION = "utilisation"
OBJECTIVE_TOO_LARGE = (
    "the best train within this limit is beyond the largest value of its objective"
)
# relative: between an extreme that a train has and one that none has
UTILISATION_TOLERANCE = 4e-7

OF_STAGE: dict[str, Callable[[GearPair, Any], Any]] = {  # extremes of `EXTREMES`, at a torque
    "axial_force": axial_force,
    "specific_sliding": lambda pair, torque: largest_sliding(pair),
    "inverse_contact_ratio": lambda pair, torque: (
        1.0 / (pair.transverse_contact_ratio + pair.overlap_ratio)
    ),
}


def problem(train: Train, names: tuple[str, ...]) -> Problem:
    """Return the problem of a drive with several objectives, an extreme among them."""
    own = tuple(name for name in names if name != UTILISATION and name not in OF_STAGE)
    (extreme,) = set(names) - {*own}
    base, limited = teeth.problem(replace(train, objective=own[0], others=own[1:])), _loads(train)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = base.evaluate(x, p)
        if extreme == UTILISATION:
            values = [v for name, v in terms.limits.items() if name.partition("[")[0] in limited]
        else:
            pairs = teeth.pairs_of(train, x)
            ratios = torque_ratios([pair.ratio for pair in pairs], train.drivers)
            values = [
                OF_STAGE[extreme](pair, train.torque * at)
                for pair, (at, _) in zip(pairs, ratios, strict=True)
            ]
        worth = {**terms.minimise, extreme: _largest(values)}
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


def limited(
    train: Train, name: str, most: Mapping[str, float], extreme: str = UTILISATION
) -> Problem:
    """Return the problem of one objective under limits on others; its `exact` proves it.

    The train's objective and the extreme may be limited: what the best train up to an extreme
    exceeds, every train up to it does. Of trains of the least extreme the best one is taken.
    """
    own = problem(train, (train.objective, extreme))
    used, largest = most.get(extreme, math.inf), most.get(train.objective, math.inf)
    used = min(1.0, used) if extreme == UTILISATION else used

    def evaluate(x: Any, p: Any) -> Terms:
        terms = own.evaluate(x, p)
        return replace(terms, minimise={name: terms.minimise[name]})

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Find the best train, or halve the range of the extreme; the seed changes nothing."""
        if name == extreme:
            return _least(train, own, used, largest, Clock(budget, watch))
        return _best(train, own, used, largest, budget, watch)

    return replace(own, evaluate=evaluate, methods={"exact": exact})


def carrying(train: Train, used: float) -> Train:
    """The drive with load limits times a factor above 0 and up to 1."""
    stages = [replace(s, allowable=tuple(used * a for a in s.allowable)) for s in train.stages]
    bending, contact = train.safety
    return replace(train, stages=tuple(stages), safety=(bending / used, contact / used))


def up_to(train: Train, extreme: str, most: float) -> Train:
    """The drive whose stages have an extreme up to a value above 0."""
    if extreme == UTILISATION:
        return carrying(train, most)
    stages = (replace(s, **{extreme: min(getattr(s, extreme), most)}) for s in train.stages)
    return replace(train, stages=tuple(stages))


def _best(
    train: Train, own: Problem, used: float, largest: float, budget: Budget, watch: Watch | None
) -> Outcome:
    """Return the best train up to an extreme; none where its objective exceeds the largest."""
    one = teeth.problem(replace(up_to(train, own.rows.objectives[1], used), others=()))
    outcome: Outcome = one.methods["exact"](one, budget, 0, watch)
    if outcome.x is None or own.batch(outcome.x[None]).F[0, 0] <= largest * (1.0 + TIE):
        return outcome
    return replace(
        outcome, x=None, bound=None, infeasible=outcome.finished, message=OBJECTIVE_TOO_LARGE
    )


def _least(train: Train, own: Problem, high: float, largest: float, clock: Clock) -> Outcome:
    """Return a train of the least extreme, proven within UTILISATION_TOLERANCE.

    high: extreme at most; largest: of the train's objective.
    """
    low, best, tried, name = 0.0, None, high, own.rows.objectives[1].replace("_", " ")
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
            bound, proof = (low, _none_up_to(low, name)) if low else (None, None)
            return Outcome(best, False, bound=bound, proof=proof, evaluations=clock.evaluations)
        tried = math.sqrt(low * high) if low else 0.5 * high
    words = "the last one found no design" if low else "none is below 0"
    words = f"Proof: complete searches at smaller and smaller limits on the {name}; {words}."
    proof = {"method": "exhausted", "sentence": words}
    return Outcome(best, bound=low, proof=proof, evaluations=clock.evaluations)


def _none_up_to(most: float, name: str) -> dict[str, Any]:
    """Proof that no design has so little of an extreme, of a search that was stopped."""
    shown = f"{100.0 * most:.4g} %" if name == UTILISATION else f"{most:.4g}"
    words = f"Proof: a complete search found no design with {name} up to {shown}."
    return {"method": "exhausted, stopped early", "sentence": words}
