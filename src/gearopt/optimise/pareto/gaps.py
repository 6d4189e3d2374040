"""Gaps between neighbours along a front of two objectives, where to step, what steps leave open.

A step finds the least first objective f of designs whose second one, g, is at most a limit. Below a
limit whose step is proven to lead back to the neighbour of smaller g nothing is left: from there on
the gap is open. A step without a proof leaves its gap open at both sides of its limit.
"""

import math
from collections.abc import Sequence

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.certified import GAP
from gearopt.optimise.pareto.found import Point
from gearopt.optimise.pareto.measures import unbeaten
from gearopt.optimise.terms import Array

POINT_TIE = 1e-6  # of the range of an objective: designs that are nearer count as one
TRIALS = 3  # steps without a result after which a gap is left open
SAMPLES = 65  # of a curve between two neighbours


@dataclass(frozen=True)
class Tried:
    """A step: its limit of g, the least f found under it (None: no design), and a bound of f there.

    bound: inf where no design meets the limit, -inf where nothing is proven.
    """

    most: float
    least: float | None
    bound: float = -math.inf


@dataclass(frozen=True)
class Strip:
    """The designs with g between two limits: their f is at least `bound`.

    missing: how much of f no proof covers, from the bound to the least f of points whose g is at
    most `high`, in the range of f. worse: how much worse than any of these designs the best point
    for it is, at most, in the objective in which it is more so, in the ranges; inf: not known.
    """

    low: float
    high: float
    bound: float
    missing: float
    worse: float


@dataclass(frozen=True)
class Gap:
    """Two neighbours, left of smaller g; a design between them needs more g than `floor`.

    refused: limits above it whose steps proved nothing.
    """

    left: Point
    right: Point
    floor: float
    refused: tuple[float, ...] = ()

    @property
    def top(self) -> float:
        """Return g of the right neighbour."""
        return float(self.right.values[1])

    @property
    def shut(self) -> bool:
        """Return whether nothing lies between the neighbours."""
        return self.floor >= self.top

    @property
    def whole(self) -> bool:
        """Return whether no step has narrowed it."""
        return bool(self.floor <= self.left.values[1])

    @property
    def area(self) -> float:
        """Return the area of f and g that it leaves open."""
        height = abs(float(self.left.values[0] - self.right.values[0]))
        return height * (self.top - self.floor)

    def limit(self, at: float) -> float:
        """Return the limit of a step at a part of its open way; away from those refused."""
        ends = np.sort([self.floor, self.top, *self.refused])
        k = int(np.diff(ends).argmax())
        part = 0.5 if self.refused else at
        return float(ends[k] + part * (ends[k + 1] - ends[k]))


def ranked(points: Sequence[Point]) -> list[Point]:
    """Return the points that none beats in the first two objectives, by the second."""
    kept = unbeaten(np.array([p.values[:2] for p in points])) if points else ()
    return [points[k] for k in kept[::-1]]


def gaps(points: Sequence[Point], tried: Sequence[Tried], ranges: Array) -> list[Gap]:
    """Return the gaps of a front, some of them shut; ranges (2,): of the objectives."""
    near_f, near_g = POINT_TIE * ranges[:2]
    line, every = ranked(points), []
    for left, right in zip(line, line[1:], strict=False):
        f, low, top = float(left.values[0]), float(left.values[1]), float(right.values[1])
        within = [t for t in tried if low + near_g < t.most < top]
        back = f - near_f - 2.0 * GAP * abs(f)
        floor = max((t.most for t in within if t.bound >= back), default=low)
        refused = tuple(t.most for t in within if t.most > floor)
        every.append(Gap(left, right, top if top - floor <= near_g else floor, refused))
    return every


def met(left: Point, right: Point) -> Array:
    """Return where tangents of two neighbours meet, as parts of the way between them (2,).

    The middle where they are not known, or meet outside of the box.
    """
    (f0, g0), (f1, g1) = left.values[:2], right.values[:2]
    if left.slopes is None or right.slopes is None or f0 == f1 or g0 == g1:
        return np.full(2, 0.5)
    s0, s1 = (float(p.slopes[0]) * (g1 - g0) / (f1 - f0) for p in (left, right))  # type: ignore
    at = 0.0 if math.isinf(s0) else (1.0 - s1) / (s0 - s1) if s0 != s1 else 0.5
    place = np.array([1.0 if math.isinf(s0) else s0 * at, at])
    return place if ((place >= 0.0) & (place <= 1.0)).all() else np.full(2, 0.5)


def spread(open_: Sequence[Gap], count: int) -> list[float]:
    """Return limits at which so many more points miss least of the hypervolume, the best first.

    Points of a curve f(g) miss least where their density goes as (-df/dg)^(1/2): Auger, Bader,
    Brockhoff, Zitzler, Theory of the hypervolume indicator, FOGA 2009. Between neighbours the curve
    is taken as the parabola that their tangents make; where a step has narrowed the gap, as a line.
    """
    t = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    ways, lengths = [], []
    for gap in open_:
        middle = met(gap.left, gap.right) if gap.whole else np.full(2, 0.5)
        way = 2.0 * t * (1.0 - t) * middle + t**2
        step = np.sqrt(np.abs(np.diff(way, axis=0)).prod(axis=1))
        ways.append((np.append(0.0, np.cumsum(step)), way[:, 1]))
        lengths.append(ways[-1][0][-1] * math.sqrt(gap.area))
    parts = np.ones(len(open_))
    for _ in range(count if len(open_) else 0):  # a gap of n parts misses length^2/(2 n)
        parts[(np.array(lengths) ** 2 / (parts * (parts + 1.0))).argmax()] += 1.0
    limits = [
        gap.floor + float(np.interp(k / n * s[-1], s, g)) * (gap.top - gap.floor)
        for gap, (s, g), n in zip(open_, ways, parts, strict=True)
        for k in range(1, int(n))
    ]
    return [limits[k] for k in sorted(range(len(limits)), key=lambda k: f"{k:016b}"[::-1])]


def curve_error(points: Sequence[Point], logarithmic: bool) -> float:
    """Return the largest distance between tangents and chords, in the ranges of the objectives.

    points: by the first objective, of a convex problem; logarithmic: of one convex in logarithms.
    """
    values = np.array([p.values for p in points])
    slopes = np.array([p.slopes[0] for p in points if p.slopes is not None])
    if logarithmic:
        slopes = slopes * values[:, 1] / values[:, 0]
        values = np.log(values)
    width = np.ptp(values, axis=0)
    if not (width > 0.0).all():
        return 0.0
    f, g = ((values - values.min(axis=0)) / width).T
    slopes = slopes * width[1] / width[0]
    worst = 0.0
    for k in range(len(points) - 1):  # by the first objective: the second falls
        df, dg = f[k + 1] - f[k], g[k + 1] - g[k]
        meet = _meet(df, dg, float(slopes[k]), float(slopes[k + 1]))
        worst = max(worst, abs(meet[0] * dg - meet[1] * df) / math.hypot(df, dg))
    return worst


def strips(
    tried: Sequence[Tried], least: float, most: float, values: Array, ranges: Array
) -> list[Strip]:
    """Strips of all designs by their g, between the limits of steps (Lemma 66).

    least: bound of g of all designs; most: the largest g of interest. values (N, k): of points.
    """
    every, low = list[Strip](), least
    limits = sorted({t.most for t in tried} | {most})
    for high in (e for e in limits if low < e <= most):
        bound = max((t.bound for t in tried if t.most >= high), default=-math.inf)
        under = values[values[:, 1] <= high + POINT_TIE * ranges[1], 0].min(initial=math.inf)
        missing = 0.0 if bound == math.inf else max(0.0, float(under - bound) / ranges[0])
        worse = np.maximum((values[:, 0] - bound) / ranges[0], (values[:, 1] - low) / ranges[1])
        nearest = 0.0 if bound == math.inf else float(worse.min(initial=math.inf))
        every.append(Strip(low, high, bound, missing, max(0.0, nearest)))
        low = high
    return every


def _meet(df: float, dg: float, first: float, second: float) -> tuple[float, float]:
    """Return where the tangents of (0, 0) and (df, dg) meet: f = first g, f = df + second (g - dg).

    The corner of their box where they meet outside of it, as roundings let them.
    """
    parallel = math.isinf(second) or first == second  # of a straight front: anywhere on it
    at = dg if parallel else (df - second * dg) / (first - second)
    at = min(max(at, min(0.0, dg)), max(0.0, dg))
    return first * at, at
