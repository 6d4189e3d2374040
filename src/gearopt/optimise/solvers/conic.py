"""Linear, quadratic and second-order cone problems, mixed-integer ones too.

Clarabel on data that we scale, point and multipliers sharpened by Newton's method. A relaxation is
solved, scaled by its solution, solved again, and the best kept: the point of the lowest cost among
feasible ones, the multipliers of the highest certified bound; they need not come from the same
round.

Where variables are discrete, best-first branch and bound over certified relaxations: a node narrows
the range of one discrete column between two neighbouring allowed values; the canonical data stay,
only bounds move. Every closed node is a leaf with multipliers: the list of leaves is the claim, and
is judged again by the certificate.
"""

from collections.abc import Iterator
from dataclasses import field, replace

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.certificate import FARKAS
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.canonical import Canonical, canonical, shifted
from gearopt.optimise.conic.cone_bound import Leaf, cutoff, emptiness, lagrangian, propagate
from gearopt.optimise.conic.interior import (
    TOLERANCES,
    Equilibration,
    Point,
    Scaled,
    after,
    equal,
    interior,
    polished,
    scaled,
)
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.scale import gap, zero_scale
from gearopt.optimise.terms import Array

ROUNDS = 16
CLOSED = 1e-10  # a relative gap that no further round is spent on
IDLE_TOLERANCE = 1e-8  # with this one the second idle round is the last
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
    scale: Equilibration
    z: Array
    x: Array | None = None
    value: float = np.inf
    excess: float = np.inf
    least: float = -np.inf
    steps: int = 0
    words: str = ""

    @property
    def gap(self) -> float:
        """Return relative distance of value and bound."""
        return gap(self.value, self.least)


def solved(problem: Conic, data: Canonical, clock: Clock) -> Found:
    """Solve the continuous relaxation of the whole box, in as many scales as help.

    The clock reports between rounds.
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
        if idle > (1 if best.gap <= IDLE_TOLERANCE else PATIENCE) or not np.isfinite(z).all():
            break
        scale = after(data, scale, z)
    if best.x is not None and best.excess > TIGHT and not best.leaf.ray:
        best = _repaired(problem, data, best, clock)
    return best


def _round(
    problem: Conic, data: Canonical, one: Scaled, best: Found, clock: Clock
) -> tuple[Found, Array]:
    """Solve once in one scale; return the best so far, and the last canonical point."""
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
    """Return the interior point, then the one that Newton makes of it."""
    yield point
    if (sharper := polished(one, point)) is not None:
        yield sharper


def multipliers(one: Scaled, point: Point) -> Array:
    """Return multipliers of the canonical rows (m,); those of bounds are left to the box."""
    y: Array = (one.back @ point.y) * one.scale.row / one.scale.cost
    return y


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
    """Rank points that need no repair by their cost, others by their violation."""
    return (0.0, value) if excess <= TIGHT else (max(excess, TIGHT), value)


def judged(problem: Conic, x: Array) -> tuple[float, float]:
    """Return cost and largest violation of the rows at a user's point, inf: not a number."""
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
    tightened = scaled(shifted(problem, data, MARGIN), best.scale)
    point = interior(tightened, clock.left.seconds)
    if not point.solved:
        return best
    inner = np.clip(tightened.scale.column * point.x, data.lower, data.upper)[data.user]
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


NODES = 20_000  # where the budget names no evaluations
WHOLE = 1e-6  # a discrete column this close to an allowed value (relative to the gap) takes it
SLACK = 1e-9  # feasibility asked of a design that is kept; the certificate bears 1e-8


@dataclass
class _Search:
    """Incumbent and leaves of the search; it has state because nodes share the best design.

    clock: counts relaxations solved. x: best design so far; scale: the cost's own there. leaves:
    closed nodes.
    """

    problem: Conic
    data: Canonical
    one: Scaled
    clock: Clock
    x: Array | None = None
    scale: float = 0.0
    leaves: list[Leaf] = field(default_factory=list)

    @property
    def value(self) -> float:
        """Return the cost of the best design, inf without one."""
        return self.clock.best


def branch(problem: Conic, data: Canonical, root: Found, clock: Clock) -> Outcome:
    """Search until every leaf is closed within the budget's gap of the best design."""
    if root.leaf.ray:
        return Outcome(None, infeasible=True, leaves=(root.leaf,), evaluations=1)
    search = _Search(problem, data, scaled(data, root.scale), clock)
    if clock.budget.evaluations is None:
        clock.budget = replace(clock.budget, evaluations=NODES)
    if problem.start is not None:
        _begin(search, root.z, problem.start)
    first, least = _closed(search, root.leaf.lower, root.leaf.upper)
    if root.leaf.y is not None and root.least > least:
        first, least = root.leaf, root.least

    def halves(bound: float, leaf: Leaf) -> list[tuple[Array, Array]]:
        done = gap(search.value, bound, search.scale) <= max(clock.budget.gap, SLACK)
        return [] if done else _halves(data, leaf)

    def goes_on(bound: float, leaf: Leaf) -> bool:
        if not halves(bound, leaf):
            return True  # it is closed, which takes no time
        clock.bound = bound
        return clock.tell()

    def children(bound: float, leaf: Leaf) -> Iterator[tuple[float, Leaf]]:
        parts = halves(bound, leaf)
        if not parts:
            search.leaves.append(leaf)
        for lower, upper in parts:
            child, least = _closed(search, lower, upper)
            yield max(least, bound), _inherited(child, leaf)

    left = best_first([(least, first)], goes_on, children)
    search.leaves += [leaf for _, _, leaf in left.waiting]
    finished = not left.waiting
    return Outcome(
        search.x,
        finished,
        infeasible=search.x is None and finished,
        leaves=tuple(search.leaves),
        evaluations=clock.evaluations,
        message="" if finished else "branch and bound stopped early",
    )


def _begin(search: _Search, z: Array, start: Array) -> None:
    """Take the user's design (n,), and the best one of its discrete values."""
    data, known = search.data, z.copy()
    known[data.user] = start
    _take(search, known)
    if len(data.user) > len(data.allowed):
        _fixed(search, known, data.lower, data.upper)


def _inherited(child: Leaf, parent: Leaf) -> Leaf:
    """Give a child whose own multipliers failed its parent's."""
    return replace(child, x=parent.x, y=parent.y, ray=parent.ray) if child.y is None else child


def _closed(search: _Search, lower: Array, upper: Array) -> tuple[Leaf, float]:
    """Solve a node's relaxation: return its leaf with the best multipliers, and their bound."""
    data = search.data
    leaf, bound = Leaf(lower, upper, np.zeros(len(lower)), None), -np.inf
    box = propagate(data, lower, upper, cutoff(search.value))
    if box is None:
        return leaf, np.inf
    search.clock.evaluations += 1
    ends = [
        np.where(np.isin(np.arange(len(lower)), list(data.allowed)), box[k], (lower, upper)[k])
        for k in (0, 1)
    ]
    node = search.one.within(*ends)
    point = interior(node, search.clock.left.seconds)
    if point.ray:
        y = multipliers(node, point)
        empty = emptiness(data, *box, leaf.x, y) > 0.0
        return (replace(leaf, y=y, ray=True), np.inf) if empty else (leaf, bound)
    for candidate in candidates(node, point):
        z, y = node.scale.column * candidate.x, multipliers(node, candidate)
        if not np.isfinite(z).all():
            continue
        _keep(search, z, lower, upper)
        worst = _worst(search, z)
        narrow = propagate(data, lower, upper, worst)
        if narrow is None and np.isfinite(search.value):
            return replace(leaf, x=z, y=y), np.inf
        least = worst if narrow is None else min(lagrangian(data, *narrow, z, y).least, worst)
        if least > bound or leaf.y is None:
            leaf, bound = replace(leaf, x=z, y=y), least
    return leaf, bound


def _worst(search: _Search, z: Array) -> float:
    """Return the cost above which a node needs no bound: of the best design, or relaxed."""
    if np.isfinite(search.value):
        return cutoff(search.value)
    value, excess = judged(
        search.problem, np.clip(z, search.data.lower, search.data.upper)[search.data.user]
    )
    return cutoff(value) if excess <= 1e-6 else np.inf


def _keep(search: _Search, z: Array, lower: Array, upper: Array) -> None:
    """Take the relaxed point as a design, discrete columns at their nearest allowed values."""
    data = search.data
    rounded, moved = z.copy(), 0.0
    for column, allowed in data.allowed.items():
        nearest = allowed[np.abs(allowed - z[column]).argmin()]
        moved = max(moved, abs(nearest - z[column]))
        rounded[column] = nearest
    continuous = len(data.user) > len(data.allowed)
    if continuous and moved > 0.0 and (moved < WHOLE or search.x is None):
        _fixed(search, rounded, lower, upper)
    else:
        _take(search, rounded)


def _fixed(search: _Search, rounded: Array, lower: Array, upper: Array) -> None:
    """Solve for the continuous columns with the discrete ones fixed."""
    low, high = search.data.lower.copy(), search.data.upper.copy()
    for column in search.data.allowed:
        low[column] = high[column] = rounded[column]
    if propagate(search.data, low, high, search.value) is None:
        return
    fixed = search.one.within(low, high)
    point = interior(fixed, search.clock.left.seconds)
    search.clock.evaluations += 1
    if point.ray:
        return
    for candidate in candidates(fixed, point):
        _take(search, np.clip(fixed.scale.column * candidate.x, low, high))


def _take(search: _Search, z: Array) -> None:
    x = np.clip(z, search.data.lower, search.data.upper)[search.data.user]
    value, excess = judged(search.problem, x)
    if excess <= SLACK and value < search.value:
        search.x, search.clock.best = x, value
        search.scale = zero_scale(search.problem, x)


def _halves(data: Canonical, leaf: Leaf) -> list[tuple[Array, Array]]:
    """Return the two parts of a node, cut where its point is farthest from allowed values."""
    cut, worst = None, -1.0
    for column, allowed in data.allowed.items():
        here = allowed[(allowed >= leaf.lower[column]) & (allowed <= leaf.upper[column])]
        if len(here) < 2:
            continue
        at = min(max(leaf.x[column], here[0]), here[-1])
        k = min(max(int(np.searchsorted(here, at, "right")) - 1, 0), len(here) - 2)
        share = (at - here[k]) / (here[k + 1] - here[k])
        distance = min(share, 1.0 - share)
        if distance > worst:
            cut, worst = (column, here[k], here[k + 1]), distance
    if cut is None:
        return []
    column, below, above = cut
    low, high = leaf.lower.copy(), leaf.upper.copy()
    low[column], high[column] = above, below
    return [(leaf.lower, high), (low, leaf.upper)]


RANDOM = False
COUNTS = "Clarabel iteration; relaxation solved, where variables are discrete"
SETTINGS = {"solver": "Clarabel", "tolerances": TOLERANCES}


def run(problem: Conic, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a conic problem; SolveError where cvxpy's rules do not find it convex."""
    clock = Clock(budget, watch)
    if not clock.tell():
        return Outcome(None, finished=False, message="stopped before it began")
    data = canonical(problem)
    if data.allowed:  # its evaluations are relaxations
        clock.budget = replace(budget, evaluations=None)
    best = solved(problem, replace(data, allowed={}), clock)
    if data.allowed and not clock.stopped:
        return branch(problem, data, best, Clock(budget, watch, clock.start))
    return Outcome(
        best.x,
        finished=not clock.stopped,
        infeasible=best.leaf.ray,
        leaves=(best.leaf,),
        evaluations=best.steps,
        message="" if best.gap <= 1e-6 or best.words == "Solved" else f"Clarabel: {best.words}",
    )
