"""The design problem for samplers: whole populations, interference looked for at some poses.

What lies between these poses stays hidden to the search. An answer is judged at all poses, by
`hidden`; `exchange` looks at all of them as it searches.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import (
    FREE,
    PRESSURE,
    VOLUME,
    Demand,
    free_variables,
    limits,
    squares,
)
from gearopt.formulations.strain_wave.exchange import CUTTING, STEP_DEG, design_of, exchange
from gearopt.formulations.strain_wave.sizing import COUNT
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms
from gearopt.physics.strain_wave.clearance import clearances, interference, poses
from gearopt.physics.strain_wave.conjugate import Flank, angle_at, contact, tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, angle_of_arc, neutral_curve
from gearopt.physics.strain_wave.tooth_motion import motion

SHARE = "load_share"
OBJECTIVES = {PRESSURE: "MPa", VOLUME: "mm3/(N m)", SHARE: ""}
GAP_UNIT = 0.05  # mm, of the limit on interference
SHARING_CLEARANCE = 5e-3  # mm: teeth within it count for the load share
WORST = 10.0  # utilisation of a design without a conjugate flank


@dataclass(frozen=True)
class Look:
    """Poses at which interference is looked for, and the rounding of a contact [mm].

    Poses every `step` degrees up to `reach` degrees from the major axis; points: of the flank.
    """

    step: float
    reach: float
    points: int
    rounding: float


COARSE_LOOK = Look(0.75, 85.0, 3, 2e-5)
WHOLE = Look(STEP_DEG, 89.9, COUNT, -CUTTING)


def problem(
    demand: Demand, start: Any, names: Sequence[str] = (PRESSURE,), look: Look = COARSE_LOOK
) -> Problem:
    """Pose objectives over the six free numbers, without derivatives; start (6,): the guess.

    names: pressure by equal sharing, volume per torque, and the share 1/N of the load of a tooth if
    the N teeth within SHARING_CLEARANCE carried alike.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        columns = [np.asarray(getattr(x, name), float) for name in FREE]
        shape = np.broadcast_shapes(*(c.shape for c in columns))
        rows = [np.broadcast_to(c, shape).reshape(-1, 1) for c in columns]
        used, goals = _assessed(demand, rows, names, look)
        goals = {name: _given(goals[name], shape) for name in names}
        return Terms(goals, {name: _given(v, shape) for name, v in used.items()})

    def exact(x: Array) -> dict[str, float]:
        return {
            "interference": 1.0 + (CUTTING - least_clearance(demand, x[: len(FREE)])) / GAP_UNIT
        }

    return Problem(
        "strain wave gearing, sampled",
        free_variables(demand, start),
        (),
        evaluate,
        vectorised=True,
        exact_limits=exact,
    )


@np.errstate(all="ignore")
def _assessed(
    demand: Demand, rows: Sequence[Array], names: Sequence[str], look: Look
) -> tuple[dict[str, Any], dict[str, Array]]:
    """Return limits and objectives (N,) of designs whose free numbers are columns (N, 1)."""
    wide = demand.gearing(dict(zip(FREE, rows, strict=True)))
    curve = neutral_curve(wide)
    first, last = tangents(wide)
    angles = angle_at(wide, curve, first + (last - first) * np.linspace(0.0, 1.0, COUNT))
    touching = contact(wide, motion(wide, curve, angles))
    known = (np.isfinite(touching.gap_curvature) & (touching.tangent > 0.0)).all(axis=1)
    thin = demand.gearing(dict(zip(FREE, (r[:, 0] for r in rows), strict=True)))
    line = NeutralCurve(
        curve.radius[:, 0], curve.wave, curve.first[:, 0], curve.second[:, 0], curve.wrap
    )
    each = [contact(thin, motion(thin, line, angles[:, k])) for k in range(COUNT)]
    used = limits(demand, thin, line, each)
    flank = Flank(wide, curve, touching, known)
    gap = clearances(flank, poses(look.step, look.reach), look.points).min(axis=1)
    used["interference"] = 1.0 - (gap + look.rounding) / GAP_UNIT
    used = {name: _limited(v, known) for name, v in used.items()}
    highest = np.max([np.where(known, s, np.nan) for s in squares(demand, thin, each)], axis=0)
    goals = {PRESSURE: np.sqrt(np.maximum(np.nan_to_num(highest, nan=1e8), 0.0))}
    if VOLUME in names:
        goals[VOLUME] = demand.specific_volume(thin)
    if SHARE in names:
        goals[SHARE] = _share(wide, curve, flank, known)
    return used, goals


def limited(demand: Demand, start: Any, name: str, most: Mapping[str, float]) -> Problem:
    """Pose one objective, PRESSURE or VOLUME, under limits on both, clear at all poses of WHOLE.

    Its method `exchange` solves the traced form with cuts; a point of it that is stationary there
    is one here, where its rows and objectives are the same.
    """
    both = problem(demand, start, (PRESSURE, VOLUME), WHOLE)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = both.evaluate(x, p)
        caps = {f"most_{n}": terms.minimise[n] / value for n, value in most.items()}
        return Terms({name: terms.minimise[name]}, {**terms.limits, **caps})

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Solve by exchange; the seed changes nothing."""
        clock = Clock(budget, watch)
        exchanged = exchange(demand, start, clock, minimise=name, most=most)
        if exchanged.result.status == "infeasible":
            return Outcome(None, infeasible=True, proof=exchanged.result.proof)
        if not exchanged.clear or exchanged.outcome.x is None:
            text = "teeth interfere" if exchanged.design else exchanged.result.message
            return Outcome(None, not clock.over, evaluations=clock.evaluations, message=text)
        x = exchanged.outcome.x[: len(FREE)]
        stationary = exchanged.result.status == "stationary"
        return Outcome(x, evaluations=clock.evaluations, stationary=stationary)

    return replace(both, evaluate=evaluate, methods={"exchange": run})


def _given(value: Any, shape: tuple[int, ...]) -> Any:
    """Return values (N,) in the shape of the text's variables."""
    return value.reshape(shape)[()]


def _limited(value: Any, known: Array) -> Any:
    """Return utilisations, WORST where a design has no conjugate flank; of several the largest."""
    if isinstance(value, tuple):
        value = np.max(value, axis=0)
    return np.where(known, np.nan_to_num(value, nan=WORST), WORST)


def _share(wide: StrainWave, curve: NeutralCurve, made: Flank, known: Array) -> Array:
    """Return 1/N of the N teeth within SHARING_CLEARANCE, by teeth at quarters of a pitch."""
    arc = made.contacts.motion.arc
    pitch = 2.0 * math.pi / float(wide.teeth)
    arcs = 0.5 * (arc[:, :1] + arc[:, -1:]) + np.linspace(-12.0, 12.0, 97) * pitch
    gaps = clearances(made, angle_of_arc(curve, arcs), COUNT)
    count = 0.25 * (gaps <= SHARING_CLEARANCE).sum(axis=1)
    return np.where(known & (count > 0.0), 1.0 / np.maximum(count, 0.25), 1.0)


def least_clearance(demand: Demand, numbers: Array) -> float:
    """Return the least clearance [mm] over all poses of a sampled design's free numbers (6,).

    Negative: the teeth cut each other between the poses that were looked at.
    """
    return interference(design_of(demand, numbers), STEP_DEG).gap
