"""Designs that interfere nowhere, by exchange: solve, look at every pose, add the poses that cut.

Bounds over the ranges of a design prove that no gearing in them meets a limit; numbers at the ends
of their ranges are named, with the value that a wider range would give.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import FREE, OUTSIDE_BASE, PRESSURE, TIP_GAP, Demand
from gearopt.formulations.strain_wave.impossible import Nearest, nearest
from gearopt.formulations.strain_wave.sizing import COUNT, NO_LIMITS, Passage, problem, tip_leaves
from gearopt.frozen import dataclass
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock
from gearopt.optimise.dual import multipliers
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Result, Watch
from gearopt.optimise.stationarity import evaluated
from gearopt.optimise.terms import Array
from gearopt.physics.strain_wave.clearance import Least, least_gaps
from gearopt.physics.strain_wave.conjugate import Flank, flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve

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
    exchanged = _searched(demand, numbers, clock, gap, minimise, most)
    if exchanged.design is not None or exchanged.result.status != "failed" or most:
        return exchanged
    near = nearest(demand, numbers, clock)
    if near is not None and near.excess <= 0.0:
        return _searched(demand, near.numbers, clock, gap, minimise, most)
    return replace(exchanged, nearest=near)


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
        gearing = design_of(demand, numbers)
        least = least_gaps(gearing, STEP_DEG)
        rounds.append(Round(result.value, len(passages), least[0].gap, outcome.evaluations))
        last = Exchanged(
            result, outcome, posed, gearing, least[0].gap, tuple(rounds), passages=passages
        )
        new = _cutting(least, passages)
        if not new or len(rounds) == ROUNDS or not clock.tell():
            return last
        passages = (*passages, *new)


def design_of(demand: Demand, numbers: Sequence[float] | Array) -> Flank:
    """Gearing and flank of the free numbers (6,)."""
    return _flank(demand.gearing(dict(zip(FREE, map(float, numbers), strict=True))))


@lru_cache(maxsize=4)  # the parts of a description ask for the same
def _flank(gearing: StrainWave) -> Flank:
    return flank(gearing, POINTS)


def _cutting(least: Sequence[Least], known: Sequence[Passage]) -> tuple[Passage, ...]:
    """Return the worst passage of a point of the flank at which teeth cut, where it is new."""
    for least_gap in least:
        if least_gap.gap < CUTTING and least_gap.passing and least_gap.point is not None:
            new = Passage(
                round(least_gap.point * (COUNT - 1)), least_gap.angle > 0.0, least_gap.angle
            )
            return () if new in known else (new,)
    return ()


def stretched(made: Flank, deflection: float) -> Flank:
    """Return the same teeth and blank on a wave generator of another deflection w."""
    gearing = replace(made.gearing, deflection=deflection, neutral=made.gearing.neutral_radius)
    return replace(made, gearing=gearing, curve=neutral_curve(gearing))


WIDER = 0.1  # of a range, by which it is thought to be wider
AT_END = 1e-6  # of a range, within which its end counts as reached


@dataclass(frozen=True, kw_only=True)
class RangeEnd:
    """A number at an end of its range, in its own unit; least: whether that is the lower end.

    gain: how much less the objective would be if the range reached WIDER of its width further, to
    first order; None where no multipliers are known.
    """

    name: str
    value: float
    least: bool
    gain: float | None = None


def ends_of(
    ranges: Mapping[str, tuple[float, float]], numbers: Array, slopes: Mapping[str, float]
) -> tuple[RangeEnd, ...]:
    """Return the numbers (6,) in the order of FREE that are at ends of ranges, greatest gain first.

    slopes: d objective/d number with the limits held, as `slopes_of` has them; may be empty.
    """
    ends = []
    for name, value in zip(FREE, map(float, numbers), strict=True):
        low, high = ranges[name]
        width = high - low
        if not width:
            continue
        for end, sign in ((low, 1.0), (high, -1.0)):
            if abs(value - end) <= AT_END * width:
                gain = sign * slopes[name] * WIDER * width if name in slopes else None
                ends.append(RangeEnd(name=name, value=end, least=sign > 0.0, gain=gain))
    return tuple(sorted(ends, key=lambda e: -(e.gain or 0.0)))


def slopes_of(problem: Problem, x: Array) -> dict[str, float]:
    """Return d objective/d number of a stationary point, limits held: the prices of its ranges.

    Slopes of the Lagrangian, whose multipliers are computed from the point's gradients. Empty where
    there are none.
    """
    shape = form(problem)
    low, high, y = (shape.to_y(v) for v in (*problem.bounds()[:2], x))
    prices = multipliers(shape, y, problem.parameter_values(), low, high)
    if prices is None:
        return {}
    point = evaluated(problem, shape, y, low, high, *prices)
    unit = shape.objective(point.f) if shape.log_objective else 1.0
    names = [variable.name for variable, _ in problem.columns]
    each = zip(names, shape.logarithmic, x, point.gradient, strict=True)
    return {n: float(unit * g / (v if log else 1.0)) for n, log, v, g in each if n in FREE}


RISE = (
    1.4  # of the deflection: slope of the neutral curve within 0.3 rad of the major axis, at most
)
Ends = Mapping[str, float]


def proof(demand: Demand) -> dict[str, Any] | None:
    """Return the proof that no gearing in the ranges meets some limit; None where none is known.

    By lower bounds of utilisations over the whole box: Lemma 72.
    """
    over = {names: used for names, used in least_used(demand).items() if used > 1.0 + FEASIBLE}
    if not over:
        return None
    names = min(over, key=lambda n: (len(n), -over[n]))
    words = f"{names[0].replace('_', ' ')} of at least {100.0 * over[names]:.4g} % of its limit"
    held = f" that keeps the {names[1].replace('_', ' ')}" if len(names) > 1 else ""
    sentence = f"Proof: every gearing in the ranges{held} has a {words}, by bounds over the ranges."
    return {"method": "bounds", "conflict": list(names), "sentence": sentence}


def least_used(demand: Demand) -> dict[tuple[str, ...], float]:
    """Return lower bounds of the utilisation of limits over the ranges, where the others are met.

    By limits in the conflict, the used one first: those that are monotone in every number at their
    best corner; fatigue of the rim and ratcheting with the largest root radius that the ranges, or
    outer radius and ranges, allow.
    """
    low, high = ({n: ends[k] for n, ends in demand.ranges.items()} for k in (0, 1))
    teeth, clear = 0.5 * (demand.teeth + 2.0), demand.clearance
    root = low["module"] * (teeth + low["profile_shift"] + low["addendum"] + clear)
    base = teeth * math.cos(high["pressure_angle"])
    largest = high["module"] * (teeth + high["profile_shift"] + high["addendum"] + clear)
    inside = min(largest, demand.outer_radius - demand.shell)
    return {
        ("outer_radius",): (root + demand.shell) / demand.outer_radius,
        ("minor_axis",): (TIP_GAP + 2.0 * low["addendum"]) / (2.0 * high["deflection"]),
        ("base_circle",): OUTSIDE_BASE * base / (teeth + high["profile_shift"] - low["addendum"]),
        ("rim_fatigue",): _fatigue(demand, low, high, largest),
        ("rim_fatigue", "outer_radius"): _fatigue(demand, low, high, inside),
        ("ratcheting",): _ratcheting(demand, low, high, largest),
        ("ratcheting", "outer_radius"): _ratcheting(demand, low, high, inside),
    }


def _fatigue(demand: Demand, low: Ends, high: Ends, root: float) -> float:
    """Return the least use of the rim's fatigue strength by shear alone, inside a root radius."""
    teeth = 2.0 * low["addendum"] + low["deflection"] + 2.0 * demand.clearance
    radius = root - low["module"] * teeth - 0.5 * low["rim"]
    if radius <= 0.0:
        return math.inf
    wall = demand.duty.cup.wall * high["rim"]
    shear = demand.notch * demand.duty.torque / (2.0 * math.pi * radius**2 * wall)
    return demand.safety * shear / demand.shear_limit


def _ratcheting(demand: Demand, low: Ends, high: Ends, root: float) -> float:
    """Return the least use of the torque at which teeth ratchet, inside a root radius [mm].

    By the least angle between flank and axis of the tooth at its tip. 0 where that is not positive.
    """
    half, clear = 0.5 * (demand.teeth + 2.0), demand.clearance
    above = low["profile_shift"] + low["addendum"]
    least = low["module"] * (half + low["profile_shift"] - high["addendum"] - clear)
    neutral = least - low["module"] * high["deflection"] - 0.5 * high["rim"]
    if neutral <= 0.0:
        return 0.0
    inner = math.cos(low["pressure_angle"]) * half / (half + above)  # r_b/r_w
    pressure = math.acos(min(inner, 1.0))
    lean = RISE * high["deflection"] * low["module"] / neutral
    angle = pressure - math.pi / demand.teeth - lean
    if angle <= 0.0:
        return 0.0
    module = min(high["module"], root / (half + above + clear))
    beyond = min(ends["module"] * (above + clear) for ends in (low, high))
    base = min(high["module"] * half, root - beyond)  # shifts may be negative
    arm = base * math.cos(low["pressure_angle"])
    most = 4.0 * arm * demand.radial_stiffness * high["addendum"] * module / math.tan(angle)
    return demand.ratchet_factor * demand.duty.torque / most
