"""Designs that interfere nowhere, by exchange: solve, look at every pose, add those that cut."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import FREE, PRESSURE, Demand, smooth_maximum
from gearopt.formulations.strain_wave.wave_design import CORNER, COUNT, NO_LIMITS, Cut, problem
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.solve import run
from gearopt.optimise.terms import Array
from gearopt.physics.strain_wave.clearance import (
    corner_clearance,
    interference,
    involute_gap,
    poses,
)
from gearopt.physics.strain_wave.conjugate import Flank, flank
from gearopt.physics.strain_wave.tooth_motion import motion

STEP_DEG = 0.05  # of the wave, at which every design is looked at
BLOCK_DEG = 4.0  # between the poses that are taken of those at which a point cuts, at first
FEW = 6  # rounds in which so few poses are taken: more may lead to another, worse design
PICKED = 12  # poses that are taken later, where few did not do
ROUNDS = 20
POINTS = 201  # of the flank that is verified
LOOKED_AT = (0, COUNT // 2, COUNT - 1)  # points of the flank that are taken as cuts
CUTTING = -1e-6  # mm: a clearance below it, 1 nm, asks for another round; contact itself has 0


@dataclass(frozen=True)
class Round:
    """Pressure [MPa], cuts so far, least clearance [mm] and iterations of one round."""

    pressure: float | None
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
        """Whether the design interferes at no pose of STEP_DEG, by more than 1 nm."""
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
    cuts: frozenset[Cut] = frozenset()
    rounds: list[Round] = []
    numbers = np.asarray(start, float)
    last: Exchanged | None = None
    while True:
        posed = problem(demand, numbers, tuple(sorted(cuts)), minimise, most)
        result, outcome = run(posed, "ipopt", clock.left, watch=clock.inner(values=False), gap=gap)
        clock.evaluations += outcome.evaluations
        if result.value is None or outcome.x is None:
            if last and result.status == "limit":
                return last
            return Exchanged(result, outcome, posed, None, -np.inf, tuple(rounds))
        numbers = outcome.x[: len(FREE)]
        made = design_of(demand, numbers)
        least = interference(made, STEP_DEG, POINTS).least
        rounds.append(Round(result.value, len(cuts), least, outcome.evaluations))
        new = _cutting(made, len(rounds) <= FEW) - cuts
        last = Exchanged(result, outcome, posed, made, least, tuple(rounds))
        if not new or len(rounds) == ROUNDS or not clock.tell():
            return last
        cuts |= new


def design_of(demand: Demand, numbers: Sequence[float] | Array) -> Flank:
    """Return gearing and flank of the free numbers (6,)."""
    return flank(demand.gearing(dict(zip(FREE, map(float, numbers), strict=True))), POINTS)


def _cutting(made: Flank, few: bool) -> set[Cut]:
    """Return poses at which points of the flank, or the corner, keep less than the least gap."""
    angles = poses(STEP_DEG)
    angles = angles[np.abs(angles) < np.radians(89.9)]
    at = motion(made.gearing, made.curve, angles)
    found: set[Cut] = set()
    tangent = made.contacts.tangent
    wanted = np.linspace(tangent[0], tangent[-1], COUNT)
    nearest = np.abs(tangent[:, None] - wanted).argmin(axis=0)
    for point in LOOKED_AT:
        k = nearest[point]
        gap, radius = involute_gap(made.gearing, at.placed(made.contacts.point[k]))
        room = smooth_maximum(gap, made.gearing.tip_radius - radius)
        found |= _taken(np.where(np.isnan(gap), np.inf, room), angles, point, few)
    return found | _taken(corner_clearance(made, at), angles, CORNER, few)


def _taken(room: Any, angles: Array, point: int, few: bool) -> set[Cut]:
    """Return of the poses that cut the worst, the first, the last, and some evenly between.

    few: one every BLOCK_DEG; else PICKED.
    """
    bad = np.flatnonzero(room < CUTTING)
    if not len(bad):
        return set()
    even = bad[np.rint(np.linspace(0, len(bad) - 1, PICKED)).astype(int)]
    every = (*bad[:: round(BLOCK_DEG / STEP_DEG)], bad[-1]) if few else even
    picked = {int(room.argmin()), *map(int, every)}
    return {Cut(float(angles[k]), point) for k in picked}


def stretched(made: Flank, deflection: float) -> Flank:
    """Return the same teeth and blank on a wave generator of another deflection w."""
    from gearopt.physics.strain_wave.neutral_curve import neutral_curve

    gearing = replace(made.gearing, deflection=deflection, neutral=made.gearing.neutral_radius)
    return replace(made, gearing=gearing, curve=neutral_curve(gearing))
