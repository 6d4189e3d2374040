"""Fronts by epsilon constraints: one objective is minimised, others limited.

The ends of the front come first. A few more follow where the tangents of two neighbours meet, in
the largest gap first; the others are spread so that the least hypervolume is missing. Where every
point is proven and the problem convex, tangents are below the front and chords above it, which
gives its error. Where steps are not proven they start from points of evolution, too, so that no
piece of the front depends on the guess alone; of what is discrete, gaps are shut by proven steps.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.form import form
from gearopt.optimise.pareto import evolution
from gearopt.optimise.pareto.found import Found, Point, Skipped, Step, sifted
from gearopt.optimise.pareto.gaps import (
    POINT_TIE,
    TRIALS,
    Gap,
    Tried,
    boxed_error,
    curve_error,
    gaps,
    met,
    spread,
)
from gearopt.optimise.pareto.posed import (
    LIMIT_PREFIX,
    Built,
    Limit,
    kept,
    posed,
    valued,
    violation_scale,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Result, Watch
from gearopt.optimise.solve import run as solve_raw
from gearopt.optimise.terms import Array

SLACK = 1e-7  # relative, of the first end's objective while the others are minimised
RANDOM = False
COUNTS = "Ipopt iteration, or solve of a Conic"
STEP = 1e-8  # relative, from one of finitely many designs to the next
SAMPLED = 2000  # evaluations of evolution, where a step is not proven
SHARE = 0.3  # of a budget at most, for it
TWICE = 2  # steps at most for each point that is sought
CORNER = 0.1  # part of a chord next to its ends where none of the first limits is put
FIRST_POINTS = 5  # points at least before others are spread by them

SETTINGS = {
    "of three objectives": "slices at even limits of the third",
    "starts where nothing is proven": f"a neighbour, and {SAMPLED} evaluations of evolution",
}

Caps = dict[str, float]  # largest values of objectives that the user states


@dataclass(frozen=True)
class Limiting:
    """How a kind of problem poses one objective under limits on others, for a method of its own.

    problem(name, most): minimise one objective, others at most as large; variables are those of the
    whole problem. names: objectives that may be limited. whole: there are finitely many designs, so
    that steps from one to the next end where there is none.
    """

    problem: Callable[[str, Caps], Problem]
    names: tuple[str, ...]
    whole: bool = False


@dataclass
class Run:
    """The problems of a front, the points found so far, and the clock; it has state to fill.

    sample: points that evolution found, which steps start from; None: it was not asked, as all
    steps are proven. sure: the ends are proven. blur: what feasibility alone leaves open of an
    objective, in parts of its range, where that is more than POINT_TIE.
    """

    problem: Problem | Conic
    names: tuple[str, ...]
    caps: Caps
    clock: Clock
    method: str | None
    limiting: "Limiting | None" = None
    built: Built = field(default_factory=dict)
    points: list[Point] = field(default_factory=list)
    skipped: list[Skipped] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    widths: dict[str, float] = field(default_factory=dict)
    lines: list["Line"] = field(default_factory=list)
    sample: tuple[Point, ...] | None = None
    logarithmic: bool = True
    sure: bool = True
    blur: float = 0.0
    none: Result | None = None

    @property
    def discrete(self) -> bool:
        """Return whether some variable is, so that the front may have jumps."""
        return any(v.discrete for v, _ in self.problem.columns)

    def within(self, most: Caps) -> list[Point]:
        """Return the points of evolution within limits on objectives."""
        places = {self.names.index(name): value for name, value in most.items()}
        sample = self.sample or ()
        return [p for p in sample if all(p.values[k] <= v for k, v in places.items())]

    def started(self, name: str, most: Caps) -> Array | None:
        """Return the best point of evolution for one objective under limits on others."""
        place, inside = self.names.index(name), self.within(most)
        return min(inside, key=lambda p: float(p.values[place])).x if inside else None


def front(
    problem: Problem | Conic,
    names: Sequence[str],
    caps: Caps,
    points: int,
    budget: Budget,
    watch: Watch | None = None,
    method: str | None = None,
    limiting: Limiting | None = None,
) -> Found:
    """Return points of the front of a continuous problem, or of one that `limiting` poses.

    names: its objectives, of which the first is minimised under limits on the others. caps: largest
    values that are of interest. points: how many are sought; of three objectives in slices, whose
    fronts are of the first two. method: that solves each, by default the usual one.
    """
    if limiting is not None:
        _limitable(limiting, (*names[1:], *caps))
    own = Run(problem, tuple(names), caps, Clock(budget, watch), method, limiting)
    if limiting is not None and limiting.whole and len(names) == 2:
        return concluded(own, _stairs(own, points))
    ends = _ends(own, own.names, own.caps)
    if ends is None:
        return concluded(own)
    if len(names) == 2:
        _between(own, ends, points, own.caps)
    else:
        _slices(own, ends, points)
    return concluded(own)


def _limitable(limiting: Limiting, names: Sequence[str]) -> None:
    """Raise SolveError for objectives that cannot be limited."""
    for name in names:
        if name not in limiting.names:
            raise SolveError(
                f"{name} cannot be limited, only {', '.join(limiting.names)}: name it first, "
                "without a largest value"
            )


def _ends(run: Run, names: tuple[str, ...], caps: Caps) -> list[Point] | None:
    """Return the points of the least value of objectives under caps; None where there is none."""
    ends: list[Point] = []
    least: list[float] = []
    for k, name in enumerate(names):
        first = _solved(run, name, dict(caps), ends[-1].x if ends else None)
        if first is None:
            run.points += ends if run.clock.stopped else []
            return None
        run.sure = run.sure and first.proven
        least.append(float(first.values[k]))
        ends.append(_end(run, names, k, caps, first, least[k] + SLACK * abs(least[k])))
    near = POINT_TIE * np.ptp([p.values for p in ends], axis=0)
    for k, at in enumerate(least):  # small differences of large values are told apart
        if SLACK * abs(at) > near[k]:
            most = at + max(float(near[k]), FEASIBLE * abs(at))
            ends[k] = _end(run, names, k, caps, ends[k], most)
    for at, width in zip(least, np.ptp([p.values for p in ends], axis=0), strict=False):
        blur = 2.0 * FEASIBLE * abs(at)
        run.blur = max(run.blur, blur / width if blur > POINT_TIE * width > 0.0 else 0.0)
    if len(names) == len(run.names):
        values = np.array([p.values for p in ends])
        run.widths = dict(zip(run.names, np.ptp(values, axis=0).tolist(), strict=True))
    sides = np.zeros(1), np.full(1, -math.inf)  # of the box of two ends: tangents of its front
    framed = [replace(p, slopes=s) for p, s in zip(ends, sides, strict=False)]
    framed = framed if run.limiting is None else ends
    for p in framed if len(run.names) == 2 else ends:
        _keep(run, p)
    return framed if len(names) == 2 else ends


def _end(run: Run, names: tuple[str, ...], k: int, caps: Caps, first: Point, most: float) -> Point:
    """Return a point of the least others where objective k is at most a value; from a point."""
    if run.limiting is not None and names[k] not in run.limiting.names:
        return first
    for other in (*names[:k], *names[k + 1 :]):
        again = _solved(run, other, _least(caps, {names[k]: most}), first.x)
        run.sure = run.sure and again is not None and again.proven
        first = again if again is not None else first
    return first


def _stairs(run: Run, points: int) -> bool:
    """Add designs by steps just below the last one; return whether the last step has none."""
    (first, second), held = run.names, dict(run.caps)
    while not run.clock.over and (not points or len(run.points) < points):
        made = _solved(run, first, held)
        if made is None or not made.proven:
            return made is None and run.skipped[-1].proven
        _keep(run, made)
        held[second] = float(made.values[1]) * (1.0 - STEP)
    return False


def _keep(run: Run, point: Point) -> None:
    """Add a point, and note how the front has grown."""
    run.points.append(point)
    values = np.array([p.values for p in sifted(run.points)[0]])
    run.steps.append(Step(run.clock.seconds, run.clock.evaluations, values))


def _least(caps: Caps, held: Caps) -> Caps:
    return {n: min(caps.get(n, math.inf), held.get(n, math.inf)) for n in {**caps, **held}}


def _between(run: Run, ends: list[Point], points: int, caps: Caps) -> None:
    """Add points of a front of the first two objectives between its ends.

    A few are in the largest gaps, where tangents meet; of a convex front the others are spread.
    Gaps that steps find empty are narrowed until as many points are found, or all are shut or
    without results.
    """
    line = Line(run, caps, list(ends), np.array([run.widths[name] or 1.0 for name in run.names]))
    few = (
        points
        if run.limiting is not None or run.discrete
        else min(points, max(FIRST_POINTS, points // 4))
    )
    line.fill(few)
    for most in spread(line.open, points - len(line.points)):
        line.step(most)
    line.fill(points)
    run.lines.append(line)


def _tight(point: Point, near: float) -> bool:
    """Return whether a point is proven to so much of its first objective."""
    return point.bound is not None and bool(point.values[0] - point.bound <= near)


@dataclass
class Line:
    """A front of two objectives under caps as its points are found; it has state to fill."""

    run: Run
    caps: Caps
    points: list[Point]
    ranges: Array
    tried: list[Tried] = field(default_factory=list)

    @property
    def gaps(self) -> list[Gap]:
        """Return the gaps between the points."""
        return gaps(self.points, self.tried, self.ranges)

    @property
    def open(self) -> list[Gap]:
        """Return the gaps that are not shut."""
        return [gap for gap in self.gaps if not gap.shut]

    def fill(self, count: int) -> None:
        """Step into the largest gap until there are so many points, or no gap is left to try."""
        least = SLACK * math.prod(self.ranges[:2])
        for _ in range(TWICE * count):
            free = [g for g in self.open if g.area > least and len(g.refused) < TRIALS]
            if not free or len(self.points) >= count or self.run.clock.over:
                return
            gap = max(free, key=lambda g: g.area)
            at = met(gap.left, gap.right)[1] if gap.whole else 0.5
            shutting = self.run.discrete and not gap.whole and not gap.refused
            shut = gap.top - 0.5 * POINT_TIE * self.ranges[1]
            self.step(shut if shutting else gap.limit(min(max(float(at), CORNER), 1.0 - CORNER)))

    def step(self, most: float) -> None:
        """Add the point of least first objective below a limit of the second one, if it is new."""
        run, near = self.run, POINT_TIE * self.ranges
        gap = next((g for g in self.open if g.floor < most < g.top), None)
        if gap is None or run.clock.over:
            return
        point = _solved(run, run.names[0], _least(self.caps, {run.names[1]: most}), gap.right.x)
        f = float(gap.left.values[0])
        back = point is not None and point.values[1] >= gap.top - 0.1 * near[1]
        if point is None or back or point.values[0] > f + near[0]:
            self.tried.append(Tried(most, None, False))
            return
        proven = _tight(point, near[0])
        if point.values[0] >= f - near[0]:
            self.tried.append(Tried(most, f, proven))
            return
        self.tried.append(Tried(most, float(point.values[0]), proven))
        self.points.append(point)
        _keep(run, point)


def _slices(run: Run, ends: list[Point], points: int) -> None:
    """Add fronts of the first two objectives at even limits of the third."""
    third, values = run.names[2], np.array([p.values[2] for p in ends])
    count = max(2, round(math.sqrt(points)))
    least = float(values.min())
    for level in np.linspace(values.max(), least + SLACK * abs(least), count):
        caps = _least(run.caps, {third: float(level)})
        own = None if run.clock.over else _ends(run, run.names[:2], caps)
        if own is not None:
            _between(run, own, points // count, caps)


def _solved(run: Run, name: str, most: Caps, near: Array | None = None) -> Point | None:
    """Return the point of least value of one objective under limits on others; None: none found.

    Where a step is not proven, the best point that evolution found within the limits is another
    start, and the better of both answers counts.
    """
    if run.clock.stopped:
        return None
    result, point = _attempt(run, name, most, near)
    unsure = result.status not in ("optimal", "infeasible")
    if unsure and run.limiting is None and isinstance(run.problem, Problem):
        if run.sample is None:
            run.sample = _sampled(run, run.problem)
        start, place = run.started(name, most), run.names.index(name)
        if start is not None and not run.clock.over:
            _, other = _attempt(run, name, most, start)
            if point is None or (other is not None and other.values[place] < point.values[place]):
                point = other
    if point is None:
        run.skipped.append(Skipped(most, result.status == "infeasible"))
        run.none = run.none or result
    return point


def _sampled(run: Run, problem: Problem) -> tuple[Point, ...]:
    """Points of a front that evolution finds within a part of the budget, as starts of steps."""
    clock = run.clock
    limits = {name: Limit.of(value, 0.0) for name, value in run.caps.items()}
    own, left = posed(problem, run.names, limits), clock.left
    if problem.repeats or not isinstance(own, Problem):
        return ()
    seconds = None if left.seconds is None else SHARE * left.seconds
    most = SAMPLED if left.evaluations is None else min(SAMPLED, int(SHARE * left.evaluations))
    before = clock.evaluations
    sample = evolution.front(own, 0, Budget(seconds, most), 0, clock.inner(values=False))
    clock.evaluations = before + sample.evaluations
    return sample.points


def _attempt(run: Run, name: str, most: Caps, near: Array | None) -> tuple[Result, Point | None]:
    """Return the result of one step from a start, and its point."""
    at = _posed(run, name, most, near)
    before = run.clock.evaluations
    result, outcome = solve_raw(at, run.method, run.clock.left, watch=run.clock.inner(values=False))
    run.clock.evaluations = before + result.evaluations
    run.clock.tell()
    if result.value is None or outcome.x is None:
        return result, None
    values = _values(run, result, outcome.x)
    slopes = None
    rows = [f"{LIMIT_PREFIX}_{n}" for n in run.names[1:]]
    priced = name == run.names[0] and not run.discrete
    if priced and all(row in result.multipliers for row in rows):
        scales = [violation_scale(at, n) for n in run.names[1:]]
        slopes = np.array([result.multipliers[r] / s for r, s in zip(rows, scales, strict=True)])
    proven = result.status == "optimal"
    if isinstance(at, Problem) and proven and run.limiting is None:
        shape = form(at)
        run.logarithmic = run.logarithmic and shape.convex and shape.log_objective
    else:
        run.logarithmic = False
    return result, Point(outcome.x, values, proven, result.bound if proven else None, slopes)


def _posed(run: Run, name: str, most: Caps, near: Array | None) -> Problem | Conic:
    if run.limiting is not None:
        return run.limiting.problem(name, most)
    limits = {n: Limit.of(value, run.widths.get(n, 0.0)) for n, value in most.items()}
    at = kept(run.built, run.problem, (name,), limits)
    if near is not None and isinstance(at, Problem) and not at.repeats:
        at = at.starting(near)
    return at


def _values(run: Run, result: Result, x: Array) -> Array:
    """Return the values of all objectives at the point of a result."""
    if run.limiting is None:
        return valued(result, run.names)
    rows, values = run.problem.rows.objectives, run.problem.batch(x[None]).F[0]
    return np.array([values[rows.index(name)] for name in run.names])


NAMED = 3  # gaps left open, by their places
STAIRS = (
    "Proof: exhausted searches, one per design, each for a smaller {name} than the design before; "
    "the last search found no design."
)
SHUT = (
    "Proof: between two neighbours, searches under limits on the {name} end at the one of smaller "
    "{name}. Designs nearer than {close:g} of the ranges of the objectives count as one."
)


def concluded(run: Run, complete: bool = False) -> Found:
    """Return the front of all points, with its error where it is proven."""
    points, beaten = sifted(run.points)
    all_proven = bool(points) and all(p.proven for p in points)
    line = run.lines[0] if len(run.names) == 2 and run.lines else None
    if line is not None and all_proven:
        complete = run.sure and not run.blur and not line.open and all(t.proven for t in line.tried)
    error = _error(run, points, line) if all_proven and line and not complete else None
    none = None if points else run.none
    return Found(
        points,
        complete=complete and bool(points),
        error=error,
        beaten=beaten,
        skipped=tuple(run.skipped[:-1] if complete and line is None else run.skipped),
        infeasible=not points and bool(run.skipped) and run.skipped[0].proven,
        finished=not run.clock.stopped,
        steps=tuple(run.steps),
        proof={"method": "epsilon constraints", "sentence": _sentence(run, points, complete)}
        if none is None
        else none.proof,
        evaluations=run.clock.evaluations,
        message=_left_open(run) if none is None else none.message or "no design meets all limits",
    )


def _sentence(run: Run, points: tuple[Point, ...], complete: bool) -> str:
    """Sentence on the proof of the points."""
    if complete and points:
        return (STAIRS if not run.lines else SHUT).format(name=run.names[1], close=POINT_TIE)
    count = sum(p.proven for p in points)
    if not count:
        starts = len(run.sample or ())
        many = f", also from {starts:,} points of evolution" if starts else ""
        return f"Not proven: every point is the best one found under its limits{many}."
    which = "Every point" if count == len(points) else f"{count} of {len(points)} points"
    verb = "is" if count == len(points) else "are"
    by = f"by more than {GAP:g} of its first objective"
    return f"{which} {verb} proven: no design dominates it {by}."


def _left_open(run: Run) -> str:
    """Return where steps between two neighbours had no result."""
    parts = [gap for line in run.lines for gap in line.open if gap.refused]
    if not parts:
        return ""
    name = run.names[1].replace("_", " ")
    places = ", ".join(f"{gap.floor:.6g} to {gap.top:.6g}" for gap in parts[:NAMED])
    more = f" and {len(parts) - NAMED} others" if len(parts) > NAMED else ""
    what = "part of the front is" if len(parts) == 1 else "parts of the front are"
    return f"{len(parts)} {what} open, where steps had no result: {name} {places}{more}"


def _error(run: Run, points: tuple[Point, ...], line: Line) -> float | None:
    """Return the error of a front of proven points: of tangents where it is convex, else of gaps.

    None of a single point.
    """
    if len(points) < 2:
        return None
    convex = run.limiting is None and not run.discrete
    if convex and all(p.slopes is not None for p in points):
        return curve_error(points, run.logarithmic)
    return boxed_error(line.gaps, np.ptp([p.values for p in points], axis=0)) + run.blur
