"""How the teeth of one lobe share the torque: a quadratic program with clearances and a rim.

Minimise 1/2 P'(I/K + S) P + g'P over loads P >= 0 [N] with L'P = M. The price of the equilibrium is
the windup theta [rad]: (P/K + S P + g)_i = L_i theta of teeth that carry, at least of the others.
With a rigid rim and equal arms it is `physics.load_sharing.share`; without clearances it is the
paper's equal sharing P = M/(L N).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var
from gearopt.physics.load_sharing import CONTACT
from gearopt.physics.strain_wave.clearance import tooth_arcs, tooth_clearances
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup, rim_compliance

RANDOM = False
COUNTS = "set of loaded teeth"
REACH = 0.25 * np.pi  # rad of the wave on either side of the arc of contact: teeth that may carry
SHARE_SPAN = 2.0  # of a share's box, as in `sharing`
RIGID = 1e-13  # of the rim's greatest compliance: a pair of teeth that counts as rigid
SLACK = 1e-12  # of the largest separation or deflection: a tooth that is open by less touches


@dataclass(frozen=True)
class Teeth:
    """Teeth of one lobe: number from the middle of the arc of contact, angle phi [rad], gap g [mm].

    compliance (n, n) [mm/N]: of pairs and rim; arm L = r_b [mm] of all. Teeth outside their spaces
    are left out.
    """

    numbers: Array
    arcs: Array
    gaps: Array
    compliance: Array
    arm: float


@dataclass(frozen=True)
class Loads:
    """Loads (n,) [N], windup [rad] and the gaps (n,) [mm] that remain under load."""

    forces: Array
    windup: float
    gaps: Array

    @property
    def carrying(self) -> int:
        """Number of teeth that carry more than CONTACT of the sum."""
        return int((self.forces > CONTACT * self.forces.sum()).sum())

    @property
    def effective(self) -> float:
        """Number of teeth that would carry the largest load if all carried the same."""
        return float(self.forces.sum() / self.forces.max())


def teeth_of(flank: Flank, pair_stiffness: float, rim: tuple[Cup, float] | None = None) -> Teeth:
    """Return the teeth that may carry, of a pair stiffness K [N/mm]; rim: cup and width b [mm].

    rim None: rigid.
    """
    return teeth_turned(flank, pair_stiffness, rim, (0.0,))[0]


def teeth_turned(
    flank: Flank, pair_stiffness: float, rim: tuple[Cup, float] | None, shifts: Sequence[float]
) -> list[Teeth]:
    """Return the teeth as `teeth_of`, at turns of the wave generator of -1/2 to 1/2 pitch."""
    most = round(REACH * float(flank.gearing.teeth) / (2.0 * np.pi))
    number = np.arange(-most, most + 1)
    arcs = np.array([tooth_arcs(flank, number, shift) for shift in shifts])
    inside = np.abs(arcs) < 0.5 * np.pi
    gaps = np.full(arcs.shape, np.inf)
    gaps[inside] = tooth_clearances(flank, arcs[inside])
    arm = float(flank.gearing.base_radius)
    teeth = []
    for arc, gap in zip(arcs, gaps, strict=True):
        near = np.isfinite(gap)
        compliance = compliance_of(flank.gearing, number[near], pair_stiffness, rim)
        touching = np.maximum(gap[near], 0.0)  # what touches is within rounding of 0
        teeth.append(Teeth(number[near], arc[near], touching, compliance, arm))
    return teeth


def compliance_of(
    gearing: StrainWave, numbers: Array, pair_stiffness: float, rim: tuple[Cup, float] | None
) -> Array:
    """Return the compliance (n, n) [mm/N] of teeth by their numbers, I/K + S; rim as above.

    1/K is RIGID of S at least: of less, rounding leaves a matrix that is not positive definite.
    """
    pairs, every = 1.0 / pair_stiffness, np.eye(len(numbers))
    if rim is None:
        return pairs * every
    behind: Array = rim_compliance(gearing, *rim, numbers)
    return behind + max(pairs, RIGID * float(behind.max(initial=0.0))) * every


def shared(compliance: Any, gaps: Any, arms: Any, moment: float) -> Loads:
    """Return the loads by an active set; compliance (n, n) symmetric positive definite.

    gaps g (n,) >= 0 [mm], arms L (n,) > 0 [mm], moment M > 0 [N mm] of one lobe. Begins with all
    teeth and drops those that would pull until none does; then takes in the tooth that lies deepest
    and goes as far towards the solution of the closed set as loads stay positive, dropping those
    that reach 0. The energy falls with every set, so none comes again (Lawson and Hanson's argument
    for least squares).
    """
    matrix, gap, arm = (np.asarray(v, float) for v in (compliance, gaps, arms))
    closed, aim = _begun(matrix, gap, arm, moment)
    forces = np.zeros(len(gap))
    forces[closed] = aim
    while True:
        windup, forces, closed = _towards(matrix, gap, arm, moment, forces, closed)
        left = matrix @ forces + gap - windup * arm
        left[closed] = 0.0
        worst = int(left.argmin())
        if left[worst] >= -SLACK * np.abs(windup * arm).max():
            return Loads(forces, windup, np.maximum(left, 0.0))
        closed[worst] = True


def _begun(matrix: Array, gap: Array, arm: Array, moment: float) -> tuple[Any, Any]:
    """Teeth that all push if they alone touch, and their loads."""
    closed = np.ones(len(gap), bool)
    while closed.any():
        at = np.flatnonzero(closed)
        _, aim = _solved(matrix, gap, arm, moment, at)
        if (aim > 0.0).all():
            return closed, aim
        closed[at[~(aim > 0.0)]] = False
    first = int((gap / arm).argmin())  # gaps so large that rounding left none
    closed[first] = True
    return closed, moment / arm[first]


def _towards(
    matrix: Array, gap: Array, arm: Array, moment: float, forces: Array, closed: Any
) -> tuple[float, Array, Any]:
    """Return windup, loads and set after steps to the solution of a set, all loads positive."""
    while True:
        at = np.flatnonzero(closed)
        windup, aim = _solved(matrix, gap, arm, moment, at)
        if (aim > 0.0).all():
            loads = np.zeros_like(forces)
            loads[at] = aim
            return windup, loads, closed
        falls = np.flatnonzero(aim <= 0.0)
        here = forces[at]
        share = here[falls] / np.maximum(here[falls] - aim[falls], np.finfo(float).tiny)
        step = share.min()
        forces = forces.copy()
        forces[at] = np.maximum(here + step * (aim - here), 0.0)
        out = at[falls[share <= step]]
        forces[out], closed = 0.0, closed.copy()
        closed[out] = False


def _solved(matrix: Array, gap: Array, arm: Array, moment: float, at: Any) -> tuple[float, Array]:
    """Windup and loads of teeth `at` that touch, which may pull; one alone carries all."""
    if len(at) == 1:
        load = moment / arm[at]
        return float((matrix[at[0], at] @ load + gap[at[0]]) / arm[at[0]]), load
    sides = np.stack([arm[at], gap[at]], axis=1)
    by_arm, by_gap = np.linalg.solve(matrix[np.ix_(at, at)], sides).T
    windup = float((moment + arm[at] @ by_gap) / (arm[at] @ by_arm))
    return windup, windup * by_arm - by_gap


def problem(compliance: Any, gaps: Any, arms: Any, moment: float) -> Problem:
    """Pose the sharing over shares f = P L_max/M; minimise the energy over M/L_max [mm].

    `active-set` solves it exactly; `qp` and others may. The price of `equilibrium` is the windup
    times L_max [mm], that of `pull[i]` minus the gap that is left [mm].
    """
    matrix, gap, arm = (np.asarray(v, float) for v in (compliance, gaps, arms))
    count, longest = len(gap), float(arm.max())
    load, lever = moment / longest, arm / longest

    def evaluate(x: Any, p: Any) -> Terms:
        f = [v + 0.0 for v in x.f]
        square = sum(
            float(matrix[i, j]) * f[i] * f[j]
            for i in range(count)
            for j in range(count)
            if matrix[i, j] != 0.0
        )
        energy = 0.5 * load * square + sum(float(g) * v for g, v in zip(gap, f, strict=True))
        whole = sum(float(a) * v for a, v in zip(lever, f, strict=True))
        pull = tuple(1.0 - v for v in f)
        return Terms({"energy": energy}, {"pull": pull}, equal={"equilibrium": whole})

    def active_set(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Solve by `shared`; the certificate makes the bound from its own multipliers."""
        clock = Clock(budget, watch)
        solution = shared(matrix, gap, arm, moment)
        clock.evaluations = 1
        x = solution.forces / load
        clock.best = float(problem.batch(x[None]).F[0, 0])
        return Outcome(x, clock.tell(), evaluations=1)

    return Problem(
        "load of the teeth", _variables(count), (), evaluate, methods={"active-set": active_set}
    )


def conic(compliance: Any, gaps: Any, arms: Any, moment: float) -> Conic:
    """Pose the sharing of the torque for `conic`, by a triangular root of the compliance."""
    matrix, gap, arm = (np.asarray(v, float) for v in (compliance, gaps, arms))
    count, longest = len(gap), float(arm.max())
    root = np.linalg.cholesky(matrix * (moment / longest)).T

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        f = cp.reshape(x.f, (count,), order="C")
        energy = 0.5 * cp.sum_squares(root @ f) + gap @ f
        whole = (arm / longest) @ f
        return Terms({"energy": energy}, {"pull": 1.0 - f}, equal={"equilibrium": whole})

    return Conic("load of the teeth", _variables(count), (), evaluate)


def _variables(count: int) -> tuple[Var, ...]:
    return (Var("f", "", -SHARE_SPAN, SHARE_SPAN, 1.0 / count, count),)
