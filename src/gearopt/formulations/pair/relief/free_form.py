"""The best relief of any shape: the depth removed at every sampled point of the path of contact.

The shape falls from the start of the path to its middle and rises from there to its end, and may
have to be convex on either side, as linear, parabolic and power reliefs are. The middle itself is
one of the points: the least value of all such shapes at the positions of the gears bounds that of
every convex relief of both tips that ends at the middle or before.

It is proven over all patterns of contact by branch and bound. With d = e_1 - e_2 at a position with
two pairs, the approach is e_2 plus a concave law of d with two kinks a load, where one of the pairs
loses contact. A node keeps each d in a range. Its linear program has the law's three planes above
each approach, and below it the secant over the range, which is the law itself once no kink is
inside. Bounds are computed from the program's multipliers.
"""

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var

# mm: positions that are one point; between them a shape changes by less than 1e-10 um
POSITION_TIE = 1e-11
UNIT = 1e-3  # mm: of rows of shape and contact


@dataclass(frozen=True)
class Shape:
    """Limits of a free relief: most [mm] anywhere; convex on either side of the middle or not.

    short: nothing is removed where a single pair carries. complete: no pair loses contact at any
    load.
    """

    most: float = 30e-3
    convex: bool = True
    short: bool = False
    complete: bool = False


@dataclass(frozen=True)
class Profile:
    """The sampled points of a path and where the pairs of a mesh are on it.

    points s (m,) [mm] in order, the middle of the path among them; place (p, n): number of the
    point of each contact, -1 without one.
    ValueError for contact ratios of 2 and more, of which a relief may end beyond a third pair.
    """

    mesh: Mesh
    shape: Shape

    def __post_init__(self) -> None:
        if self.mesh.cycle.positions.shape[1] > 2:
            raise ValueError("free shapes of relief are searched for contact ratios below 2")

    @cached_property
    def points(self) -> Array:
        """Positions s (m,) [mm]."""
        met = self.mesh.cycle.along(self.mesh.cycle.positions)
        met = np.sort(np.append(met, self._centre))
        return np.asarray(met[np.diff(met, prepend=-np.inf) > POSITION_TIE])

    @cached_property
    def place(self) -> Any:
        """Numbers of points (p, n), -1 of pairs that are not in contact."""
        there = self.mesh.cycle.present
        numbers = np.searchsorted(
            self.points, np.where(there, self.mesh.cycle.positions, 0.0) - POSITION_TIE
        )
        return np.where(there, numbers, -1)

    @cached_property
    def middle(self) -> int:
        """Number of the middle of the path among the points."""
        return int(np.abs(self.points - self._centre).argmin())

    @property
    def _centre(self) -> float:
        path = self.mesh.cycle.path
        return float(0.5 * (path.start + path.end))

    @cached_property
    def rows(self) -> Array:
        """Rows (r, m) of which every product with the removed depths is at most 0: the shape."""
        size, middle = len(self.points), self.middle
        steps = np.diff(np.eye(size), axis=0)  # rises from point to point
        steps[middle:] *= -1.0
        blocks = [steps]
        if self.shape.convex:
            slopes = np.diff(np.eye(size), axis=0) / np.diff(self.points)[:, None]
            bends = -np.diff(slopes, axis=0) * np.diff(self.points).max()
            at = np.arange(1, size - 1)
            blocks.append(bends[at != middle])
        return np.vstack(blocks)

    @cached_property
    def upper(self) -> Array:
        """Greatest amounts (m,) [mm]."""
        path, most = self.mesh.cycle.path, self.shape.most
        single = (self.points >= path.lowest_single - POSITION_TIE) & (
            self.points <= path.highest_single + POSITION_TIE
        )
        return np.where(single & self.shape.short, 0.0, most)

    def separations(self, removed: Any) -> Array:
        """Separations (..., p, n) [mm] of depths removed (..., m) [mm] at the points."""
        return np.where(self.place >= 0, np.asarray(removed)[..., self.place], np.inf)


def free_problem(mesh: Mesh, shape: Shape | None = None) -> Problem:
    """Pose the least peak-to-peak of all loads; variable `removed` (m,) [mm], method `exact`."""
    profile = Profile(mesh, shape or Shape())
    kept = profile.rows / UNIT

    def evaluate(x: Any, p: Any) -> Terms:
        removed = np.stack([np.asarray(v, float) for v in x.removed], axis=-1)
        apart = profile.separations(removed)
        shared = mesh.sharing(apart)
        defines: dict[str, Any] = {"shape": tuple(np.moveaxis(1.0 + removed @ kept.T, -1, 0))}
        if profile.shape.complete:
            gaps = np.where(np.isinf(shared.gaps), 0.0, shared.gaps)
            defines["open"] = 1.0 + gaps.max(axis=(-3, -2, -1)) / UNIT
        return Terms({"peak_to_peak": mesh.criteria(apart).peak_to_peak.max(axis=-1)}, {}, defines)

    upper = tuple(map(float, profile.upper))
    columns = (Var("removed", "mm", 0.0, upper, 0.0, len(upper)),)
    methods = {"exact": method(profile)}
    return Problem("free relief", columns, (), evaluate, methods=methods, vectorised=True)


MICRO = 1e3  # um a mm
ROUNDING = 1e-9  # um: taken off every bound
GAP = 1e-6  # relative; where no gap is asked for
TRIED = 4  # kinks that a node may be cut at, whose halves are bounded before one is taken
SECOND = 0.2  # of the better half's gain, beside the worse half's
PENALTY = 1e4  # of leaving a range, per um: so that every program has a solution
SLACK = 1e-9  # um: by which a range counts as one without a kink, and an approach as too low
TOLERANCES = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}

RANDOM = False
COUNTS = "linear program solved"
SETTINGS = {"gap": GAP}
SENTENCE = (
    "Proof: every pattern of contact was searched; bounds from multipliers of linear programs."
)
STOPPED = (
    "Proof of the lower bound: no pattern of contact has less; bounds by multipliers of linear "
    "programs."
)


@dataclass(frozen=True)
class Program:
    """The linear program of a profile in um, its rows that no node changes.

    Variables: removed e (m,), approaches (q, p) of uncoupled pairs, least approach (q,), peak t,
    and what the ranges are left by z. own (p, 2): compliances [um/N], NaN of absent pairs; double:
    numbers of positions with two pairs, in order of travel.
    """

    profile: Profile

    @cached_property
    def own(self) -> Array:
        """Compliances (p, n) [um/N] less the coupling."""
        mesh = self.profile.mesh
        return MICRO * np.where(mesh.cycle.present, mesh.compliances - mesh.coupling, np.nan)

    @cached_property
    def loads(self) -> Array:
        """Loads (q,) [N]."""
        return np.array(self.profile.mesh.loads)

    @cached_property
    def double(self) -> Any:
        """Positions with two pairs."""
        return np.flatnonzero((self.profile.place >= 0).all(axis=1))

    @cached_property
    def kinks(self) -> Array:
        """Values of d [um] at which the leaving and the entering pair lose contact, (q, 2, k)."""
        first, second = self.own[self.double].T
        return np.asarray(self.loads[:, None, None] * np.stack([-first, second]))

    @property
    def columns(self) -> tuple[int, int, int]:
        """Numbers of removed amounts, of approaches, of all variables."""
        points, states = len(self.profile.points), len(self.loads) * len(self.own)
        return points, states, points + states + len(self.loads) + 2

    def at(self, load: int, position: Any) -> Any:
        """Return the column of an approach."""
        return len(self.profile.points) + load * len(self.own) + position

    @cached_property
    def fixed(self) -> tuple[Array, Array]:
        """Rows and right-hand sides, at most, of shape, planes above approaches, and the band."""
        points, states, size = self.columns
        shape = np.zeros((len(self.profile.rows), size))
        shape[:, :points] = self.profile.rows
        rows, right = [shape], [np.zeros(len(shape))]
        for q, load in enumerate(self.loads):
            band = np.zeros((2 * len(self.own), size))
            for k, place in enumerate(self.profile.place):
                band[2 * k, [points + states + q, self.at(q, k)]] = 1.0, -1.0
                band[2 * k + 1, [self.at(q, k), points + states + q, size - 2]] = 1.0, -1.0, -1.0
                there = np.flatnonzero(place >= 0)
                for chosen in [there[:1], there[1:], there][: 2 * len(there) - 1]:
                    stiffness = 1.0 / self.own[k, chosen]
                    row = np.zeros(size)
                    row[self.at(q, k)] = 1.0
                    row[place[chosen]] = -stiffness / stiffness.sum()
                    rows.append(row[None])
                    right.append(np.array([load / stiffness.sum()]))
                if len(there) == 1:
                    rows.append(-rows[-1])
                    right.append(-right[-1])
            rows.append(band)
            right.append(np.zeros(len(band)))
        return np.vstack(rows), np.concatenate(right)

    def changing(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Return rows and right-hand sides of ranges of d (k,) and of secants over them."""
        size, count = self.columns[2], len(self.double)
        first, second = self.profile.place[self.double].T
        steps = np.arange(count)
        ranges = np.zeros((2, count, size))
        for sign, row in zip((-1.0, 1.0), ranges, strict=True):
            row[steps, first], row[steps, second], row[:, -1] = sign, -sign, -1.0
        rows, right = [*ranges], [-low, high]
        for q in range(len(self.loads)):
            ends = self.approach_above_second(q, low), self.approach_above_second(q, high)
            slope = (ends[1] - ends[0]) / np.where(high > low, high - low, 1.0)
            slope = np.clip(np.where(high > low, slope, 0.0), 0.0, 1.0)
            secant = np.zeros((count, size))
            secant[steps, self.at(q, self.double)] = -1.0
            secant[steps, first], secant[steps, second] = slope, 1.0 - slope
            secant[:, -1] = -1.0  # outside its range it may be above the law
            rows.append(secant)
            right.append(-np.minimum(ends[0] - slope * low, ends[1] - slope * high))
        return np.vstack(rows), np.concatenate(right)

    def value(self, removed: Array) -> float:
        """Exact value [um] of removed depths [um]."""
        mesh = self.profile.mesh
        criteria = mesh.criteria(self.profile.separations(removed / MICRO))
        return MICRO * float(criteria.peak_to_peak.max())

    def approach_above_second(self, load: int, ahead: Array) -> Array:
        """Return approach less e_2 [um] of two pairs with e_1 - e_2 = ahead (k,)."""
        first, second = self.own[self.double].T
        w = self.loads[load]
        both = (w * first * second + second * ahead) / (first + second)
        return np.asarray(np.minimum(both, np.minimum(w * second, w * first + ahead)))

    @cached_property
    def upper(self) -> Array:
        """Upper bounds of the variables; the lower ones are 0."""
        points, states, size = self.columns
        most = MICRO * self.profile.upper
        deep = float(np.nanmax(self.own) * self.loads.max() + most.max())
        return np.concatenate([most, np.full(size - points, deep)])

    @cached_property
    def cost(self) -> Array:
        """Costs: of the peak, and of leaving ranges."""
        costs = np.zeros(self.columns[2])
        costs[-2:] = 1.0, PENALTY
        return costs

    def solved(self, low: Array, high: Array) -> tuple[float, Array]:
        """Return a bound [um] of a node, from multipliers, and the program's point."""
        from scipy.optimize import linprog

        parts = zip(self.fixed, self.changing(low, high), strict=True)
        rows, right = (np.concatenate(part) for part in parts)
        bounds = np.stack([np.zeros_like(self.upper), self.upper], axis=1)
        options = {"bounds": bounds, "method": "highs-ds", "options": TOLERANCES}
        solution = linprog(self.cost, rows, right, **options)
        if solution.x is None:  # no bound is known, and nothing is removed
            return 0.0, np.zeros(len(self.cost))
        prices = np.minimum(solution.ineqlin.marginals, 0.0)
        left = self.cost - prices @ rows
        bound = float(prices @ right + np.minimum(left, 0.0) @ self.upper)
        return bound - ROUNDING, solution.x


@dataclass(frozen=True)
class Node:
    """Ranges of d (k,) [um] with a bound [um] and the point of their program."""

    low: Array
    high: Array
    bound: float
    point: Array


class _Search:
    """Branch and bound over ranges; it has state because the incumbent and the clock change."""

    def __init__(self, program: Program, clock: Clock):
        self.program, self.clock = program, clock
        self.best, self.removed = np.inf, np.zeros(program.columns[0])

    def node(self, low: Array, high: Array, least: float = 0.0) -> Node | None:
        """Return a node, its point noted; None where a range is empty."""
        if (low > high).any():
            return None
        bound, point = self.program.solved(low, high)
        removed = np.clip(point[: len(self.removed)], 0.0, self.program.upper[: len(self.removed)])
        if (value := self.program.value(removed)) < self.best:
            self.best, self.removed = value, removed
        self.clock.evaluations += 1
        return Node(low, high, max(bound, least), point)

    def cuts(self, node: Node) -> list[tuple[int, float]]:
        """Return positions and kinks [um] where approaches are too low, the worst first."""
        program, lacking = self.program, dict[tuple[int, float], float]()
        first, second = program.profile.place[program.double].T
        ahead = node.point[first] - node.point[second]
        for q in range(len(program.loads)):
            kinks = program.kinks[q]
            inside = (kinks > node.low + SLACK) & (kinks < node.high - SLACK)
            away = np.where(inside, np.abs(kinks - ahead), np.inf)
            lacks = program.approach_above_second(q, ahead) + node.point[second]
            lacks = np.maximum(lacks - node.point[program.at(q, program.double)], 0.0)
            for side in range(2):
                shortfall = np.where(inside[side] & (away[side] <= away[1 - side]), lacks, 0.0)
                if shortfall.max(initial=0.0) > SLACK:
                    half = int(np.searchsorted(shortfall.cumsum(), 0.5 * shortfall.sum()))
                    for k in (int(shortfall.argmax()), half):
                        lacking[k, float(kinks[side, k])] = float(shortfall[k])
        return sorted(lacking, key=lambda cut: -lacking[cut])[:TRIED]

    def halves(self, node: Node, cut: tuple[int, float]) -> list[Node]:
        """Nodes that a cut leaves: d falls along the travel, so one range narrows the others."""
        k, kink = cut
        low, high = node.low.copy(), node.high.copy()
        high[k:], low[: k + 1] = np.minimum(high[k:], kink), np.maximum(low[: k + 1], kink)
        both = self.node(node.low, high, node.bound), self.node(low, node.high, node.bound)
        return [half for half in both if half is not None]

    def divided(self, node: Node) -> list[Node] | None:
        """Return the halves at the best cut that is tried; None where nothing is left to cut."""
        tried = [self.halves(node, cut) for cut in self.cuts(node)]

        def gain(halves: list[Node]) -> float:
            bounds = sorted(min(half.bound, self.best) for half in halves)
            worse, better = [*bounds, self.best, self.best][:2]
            return worse + SECOND * better

        return max(tried, key=gain) if tried else None

    def run(self) -> tuple[float, bool]:
        """Return a bound [um], and whether the search came to its end."""
        program, gap = self.program, max(self.clock.budget.gap, GAP)
        kinks, most = program.kinks, MICRO * program.profile.shape.most
        inner = kinks[:, 0].max(axis=0), kinks[:, 1].min(axis=0)
        complete = self.node(*inner)
        wide = np.full(len(program.double), most)
        root = complete if program.profile.shape.complete else self.node(-wide, wide)
        assert complete is not None and root is not None
        floor = np.inf  # of nodes that no cut divides

        def goes_on(least: float, _: Node) -> bool:
            if least >= self.best * (1.0 - gap):
                return False
            self.clock.best, self.clock.bound = self.best / MICRO, min(least, floor) / MICRO
            return self.clock.tell()

        def branch(least: float, node: Node) -> Iterator[tuple[float, Node]]:
            nonlocal floor
            halves = self.divided(node)
            if halves is None:
                floor = min(floor, least)
            yield from ((half.bound, half) for half in halves or ())

        left = best_first([(root.bound, root)], goes_on, branch)
        return min(left.least, floor, self.best), not self.clock.stopped


def method(profile: Profile) -> Callable[..., Outcome]:
    """Return the method of `free_form.free_problem` that proves the least peak-to-peak."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Cut ranges at kinks until no node may hold a better relief; the seed changes nothing."""
        clock = Clock(budget, watch)
        searching = _Search(Program(profile), clock)
        bound, ended = searching.run()
        said = SENTENCE if ended else STOPPED
        proof = {"method": "patterns", "programs": clock.evaluations, "sentence": said}
        proof |= {"scope": profile.mesh.sampled}
        x, spent = searching.removed / MICRO, clock.evaluations
        return Outcome(x, ended, bound=max(bound, 0.0) / MICRO, proof=proof, evaluations=spent)

    return run
