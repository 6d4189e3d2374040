"""Designs that interfere nowhere, by exchange: solve, look at every pose, add what cuts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import FREE, PRESSURE, Demand
from gearopt.formulations.strain_wave.wave_design import COUNT, NO_LIMITS, Passage, problem
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.solve import run
from gearopt.optimise.terms import Array
from gearopt.physics.strain_wave.clearance import Least, least_gaps
from gearopt.physics.strain_wave.conjugate import Flank, flank

STEP_DEG = 0.05  # of the wave, at which every design is looked at, and between: see `least_gaps`
FIRST_DEG = 1.0  # of the wave, at which the first design's passage is looked for
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
    """The last round's answer, its problem, and the design: None where no point was found."""

    result: Result
    outcome: Outcome
    problem: Problem
    design: Flank | None
    gap: float
    rounds: tuple[Round, ...]

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
    """
    passages = _tip_leaves(demand, start)
    rounds: list[Round] = []
    numbers = np.asarray(start, float)
    last: Exchanged | None = None
    while True:
        posed = problem(demand, numbers, passages, minimise, most)
        result, outcome = run(posed, "ipopt", clock.left, watch=clock.inner(values=False), gap=gap)
        clock.evaluations += outcome.evaluations
        if result.value is None or outcome.x is None:
            if last and result.status == "limit":
                return last
            return Exchanged(result, outcome, posed, None, -np.inf, tuple(rounds))
        numbers = outcome.x[: len(FREE)]
        made = design_of(demand, numbers)
        least = least_gaps(made, STEP_DEG)
        rounds.append(Round(result.value, len(passages), least[0].gap, outcome.evaluations))
        last = Exchanged(result, outcome, posed, made, least[0].gap, tuple(rounds))
        new = _cutting(least, passages)
        if not new or len(rounds) == ROUNDS or not clock.tell():
            return last
        passages = (*passages, *new)


def design_of(demand: Demand, numbers: Sequence[float] | Array) -> Flank:
    """Return gearing and flank of the free numbers (6,)."""
    return flank(demand.gearing(dict(zip(FREE, map(float, numbers), strict=True))), POINTS)


def _tip_leaves(demand: Demand, start: Any) -> tuple[Passage, ...]:
    """Return where the flank's tip passes the tip circle as its tooth leaves, in the first design.

    There teeth come nearest but for their contact; of a start without a flank it is a guess.
    """
    made = design_of(demand, start)
    known = least_gaps(made, FIRST_DEG, 2) if made.complete.all() else []
    angles = [one.angle for one in known if one.passing and one.point == 1.0 and one.angle > 0.0]
    return (Passage(COUNT - 1, True, angles[0] if angles else 1.0),)


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
