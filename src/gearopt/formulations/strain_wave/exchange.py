"""Designs that interfere nowhere, by exchange: solve, look at every pose, add what cuts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.box_bounds import proof
from gearopt.formulations.strain_wave.demand import FREE, PRESSURE, Demand
from gearopt.formulations.strain_wave.design import (
    COUNT,
    NO_LIMITS,
    Passage,
    problem,
    tip_leaves,
)
from gearopt.formulations.strain_wave.impossible import Nearest, nearest
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result, Watch
from gearopt.optimise.solve import run
from gearopt.optimise.terms import Array
from gearopt.physics.strain_wave.clearance import Least, least_gaps
from gearopt.physics.strain_wave.conjugate import Flank, flank

STEP_DEG = 0.05  # of the wave, at which every design is looked at, and between: see `least_gaps`
ROUNDS = 10
POINTS = 201  # of the flank
CUTTING = -1e-6  # mm: a clearance below it, 1 nm, asks for another round; contact itself has 0


@dataclass(frozen=True)
class Round:
    """Objective, passages held, least clearance [mm] and iterations of one round."""

    pressure: float
    cuts: int
    gap: float
    iterations: int


@dataclass(frozen=True)
class Exchanged:
    """The last round's answer, its problem, and the design: None where no point was found.

    nearest: of a request that nothing meets, the design of the least excess. passages: those that
    the problem holds clear.
    """

    result: Result
    outcome: Outcome
    problem: Problem
    design: Flank | None
    gap: float = -np.inf
    rounds: tuple[Round, ...] = ()
    nearest: Nearest | None = None
    passages: tuple[Passage, ...] = ()

    @property
    def clear(self) -> bool:
        """Whether the design interferes at no pose, by more than 1 nm."""
        return self.design is not None and self.gap >= CUTTING


def exchange(
    demand: Demand,
    start: Any,
    clock: Clock,
    gap: float = 1e-6,
    minimise: str = PRESSURE,
    most: Mapping[str, float] = NO_LIMITS,
) -> Exchanged:
    """Return the design of least pressure by equal sharing that interferes at no pose.

    start (6,): numbers in the order of FREE. minimise: PRESSURE or VOLUME, with the largest values
    `most` of these. Every round begins at the last design. Its bound, if any, and its status are
    those of the problem of the last round; of the one before where the budget ends in a round.
    Ranges that are proven impossible are not searched. A search that finds nothing is repeated from
    the design of the least excess, if that meets all limits.
    """
    numbers = np.asarray(start, float)
    if why := proof(demand):
        return _impossible(demand, numbers, why, clock)
    found = _searched(demand, numbers, clock, gap, minimise, most)
    if found.design is not None or found.result.status != "failed" or most:
        return found
    near = nearest(demand, numbers, clock)
    if near is not None and near.excess <= 0.0:
        return _searched(demand, near.numbers, clock, gap, minimise, most)
    return replace(found, nearest=near)


def _impossible(demand: Demand, start: Array, why: Mapping[str, Any], clock: Clock) -> Exchanged:
    """Return the answer to ranges that a bound excludes."""

    def bounds(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        return Outcome(None, infeasible=True, proof=why, message=str(why["sentence"]))

    posed = replace(problem(demand, start), methods={"bounds": bounds})
    result, outcome = run(posed, "bounds")
    return Exchanged(result, outcome, posed, None, nearest=nearest(demand, start, clock))


def _searched(
    demand: Demand,
    numbers: Array,
    clock: Clock,
    gap: float,
    minimise: str,
    most: Mapping[str, float],
) -> Exchanged:
    """Return the design of least objective near a start: rounds until nothing cuts."""
    passages = tip_leaves(demand, numbers)
    rounds: list[Round] = []
    last: Exchanged | None = None
    while True:
        posed = problem(demand, numbers, passages, minimise, most)
        result, outcome = run(posed, "ipopt", clock.left, watch=clock.inner(values=False), gap=gap)
        clock.evaluations += outcome.evaluations
        if result.value is None or outcome.x is None:
            if last and result.status == "limit":
                return last
            return Exchanged(result, outcome, posed, None, rounds=tuple(rounds))
        numbers = outcome.x[: len(FREE)]
        made = design_of(demand, numbers)
        least = least_gaps(made, STEP_DEG)
        rounds.append(Round(result.value, len(passages), least[0].gap, outcome.evaluations))
        last = Exchanged(
            result, outcome, posed, made, least[0].gap, tuple(rounds), passages=passages
        )
        new = _cutting(least, passages)
        if not new or len(rounds) == ROUNDS or not clock.tell():
            return last
        passages = (*passages, *new)


def design_of(demand: Demand, numbers: Sequence[float] | Array) -> Flank:
    """Return gearing and flank of the free numbers (6,)."""
    return flank(demand.gearing(dict(zip(FREE, map(float, numbers), strict=True))), POINTS)


def _cutting(least: Sequence[Least], known: Sequence[Passage]) -> tuple[Passage, ...]:
    """Return the worst passage of a point of the flank at which teeth cut, where it is new."""
    for one in least:
        if one.gap < CUTTING and one.passing and one.point is not None:
            new = Passage(round(one.point * (COUNT - 1)), one.angle > 0.0, one.angle)
            return () if new in known else (new,)
    return ()


def stretched(made: Flank, deflection: float) -> Flank:
    """Return the same teeth and blank on a wave generator of another deflection w."""
    from gearopt.physics.strain_wave.neutral_curve import neutral_curve

    gearing = replace(made.gearing, deflection=deflection, neutral=made.gearing.neutral_radius)
    return replace(made, gearing=gearing, curve=neutral_curve(gearing))
