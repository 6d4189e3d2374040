"""The continuous problem on one box: solve, scale by the solution, solve again, keep the best.

The best point is that of the least cost among feasible ones, the best multipliers those of the
highest certified bound; they need not come from the same round.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gearopt.optimise.certificate import FARKAS
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.canonical import Canonical, shifted
from gearopt.optimise.conic.cone_bound import Leaf, emptiness, lagrangian
from gearopt.optimise.conic.interior import Point, interior, polished
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.conic.propagate import cutoff, propagate
from gearopt.optimise.conic.scaling import Scale, Scaled, after, equal, scaled
from gearopt.optimise.scale import gap
from gearopt.optimise.terms import Array

ROUNDS = 16
CLOSED = 1e-10  # a relative gap that no further round is spent on
ENOUGH = 1e-8  # with this one the second idle round is the last
PATIENCE = 4  # rounds without a better gap, once there is one
TIGHT = 1e-11  # a row violated by more is repaired; the certificate bears 1e-8
MARGIN = 1e-6  # of the strictly feasible point that a repair moves towards


@dataclass(frozen=True)
class Found:
    """The best of the rounds so far.

    x (k,): the user's point, value its cost, excess its largest violation. leaf: multipliers with
    the bound `least` that they prove, or a proof of emptiness (leaf.ray). z (n,): canonical point.
    """

    leaf: Leaf
    scale: Scale
    z: Array
    x: Array | None = None
    value: float = np.inf
    excess: float = np.inf
    least: float = -np.inf
    steps: int = 0
    words: str = ""

    @property
    def gap(self) -> float:
        """Relative distance of value and bound."""
        return gap(self.value, self.least)


def solved(problem: Conic, data: Canonical, clock: Clock) -> Found:
    """The continuous relaxation of the whole box, in as many scales as help.

    The clock is told between rounds.
    """
    start = Leaf(data.lower, data.upper, np.zeros(len(data.c)), None)
    best = Found(start, equal(data), start.x)
    scale, idle = best.scale, 0
    for _ in range(ROUNDS):
        before = best.gap
        best, z = _round(problem, data, scaled(data, scale), best, clock)
        if best.leaf.ray or best.gap <= CLOSED:
            break
        clock.evaluations, clock.best, clock.bound = best.steps, best.value, best.least
        if not clock.tell():
            break
        idle = idle + 1 if best.gap >= 0.5 * before else 0
        if idle > (1 if best.gap <= ENOUGH else PATIENCE) or not np.isfinite(z).all():
            break
        scale = after(data, scale, z)
    if best.x is not None and best.excess > TIGHT and not best.leaf.ray:
        best = _repaired(problem, data, best, clock)
    return best


def _round(
    problem: Conic, data: Canonical, one: Scaled, best: Found, clock: Clock
) -> tuple[Found, Array]:
    """One solve in one scale; the best so far, and the last canonical point, wrong as it may be."""
    point = interior(one, clock.left.seconds)
    best = replace(best, steps=best.steps + point.steps, words=point.words)
    z = one.scale.column * point.x
    if point.ray:
        leaf = replace(best.leaf, y=multipliers(one, point), ray=True)
        box = propagate(data, leaf.lower, leaf.upper)
        if box is None or emptiness(data, *box, leaf.x, _given(leaf)) > FARKAS:
            return replace(best, leaf=leaf), z
        return best, z
    for candidate in candidates(one, point):
        z = one.scale.column * candidate.x
        best = _better(problem, data, one, candidate, z, best)
    return best, z


def candidates(one: Scaled, point: Point) -> Iterator[Point]:
    """The interior point, then the one that Newton makes of it."""
    yield point
    if (sharper := polished(one, point)) is not None:
        yield sharper


def multipliers(one: Scaled, point: Point) -> Array:
    """Multipliers of the canonical rows (m,); those of bounds are left to the box."""
    found: Array = (one.back @ point.y) * one.scale.row / one.scale.cost
    return found


def _better(
    problem: Conic, data: Canonical, one: Scaled, point: Point, z: Array, best: Found
) -> Found:
    x = np.clip(z, best.leaf.lower, best.leaf.upper)[data.user]
    value, excess = judged(problem, x)
    if _rank(value, excess) < _rank(best.value, best.excess):
        best = replace(best, x=x, value=value, excess=excess, z=z, scale=one.scale)
    if best.x is None:
        return best
    box = propagate(data, best.leaf.lower, best.leaf.upper, cutoff(best.value))
    if box is None:
        return best
    y = multipliers(one, point)
    least = lagrangian(data, *box, z, y).least
    if least > best.least:
        best = replace(best, leaf=replace(best.leaf, x=z, y=y), least=least)
    return best


def _rank(value: float, excess: float) -> tuple[float, float]:
    """Points that need no repair by their cost, others by their violation."""
    return (0.0, value) if excess <= TIGHT else (max(excess, TIGHT), value)


def judged(problem: Conic, x: Array) -> tuple[float, float]:
    """Cost and largest violation of the rows at a user's point, inf where not a number."""
    batch = problem.batch(x[None])
    amounts = np.concatenate([batch.G[0] - 1.0, np.abs(batch.H[0] - 1.0), [0.0]])
    worst = float(np.nan_to_num(amounts, nan=np.inf).max())
    value = float(batch.F[0, 0])
    return (value, worst) if np.isfinite(value) else (np.inf, np.inf)


def _repaired(problem: Conic, data: Canonical, best: Found, clock: Clock) -> Found:
    """Move towards a point that meets every limit with a margin, just as far as needed.

    The rows are convex, so a step of excess/(excess + MARGIN) is enough but for rounding.
    """
    assert best.x is not None
    one = scaled(shifted(problem, data, MARGIN), best.scale)
    point = interior(one, clock.left.seconds)
    if not point.solved:
        return best
    inner = np.clip(one.scale.column * point.x, data.lower, data.upper)[data.user]
    step = best.excess / (best.excess + MARGIN)
    while step < 1.0:
        step = min(1.0, 1.5 * step)
        x = best.x + step * (inner - best.x)
        value, excess = judged(problem, x)
        if excess <= TIGHT:
            return replace(best, x=x, value=value, excess=excess)
    return best


def _given(leaf: Leaf) -> Array:
    assert leaf.y is not None
    return leaf.y
