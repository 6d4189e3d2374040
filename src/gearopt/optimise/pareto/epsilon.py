"""Fronts by epsilon constraints: one objective is minimised, others limited.

The ends of the front come first. A few more follow where the tangents of two neighbours meet, in
the largest gap first; the others are spread so that the least hypervolume is missing. Each step is
proven where it can be: by duals of a convex form, else by spatial branch and bound. What the bounds
of all steps leave open is the epsilon of the front; where every point is that of a convex problem,
tangents are below the front and chords above it, which gives its error. Steps that are not proven
start from points of evolution, too, so that no piece depends on the guess alone.
"""

import math
from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.form import form
from gearopt.optimise.own_problems import PROVEN
from gearopt.optimise.pareto import evolution
from gearopt.optimise.pareto.found import Found, Point, Step, sifted
from gearopt.optimise.pareto.front import Impossible
from gearopt.optimise.pareto.gaps import (
    POINT_TIE,
    TRIALS,
    Gap,
    Strip,
    Tried,
    curve_error,
    gaps,
    met,
    ranked,
    spread,
    strips,
)
from gearopt.optimise.pareto.objectives import Caps, Limiting
from gearopt.optimise.pareto.posed import (
    Built,
    Limit,
    kept,
    limit_of,
    posed,
    valued,
    violation_scale,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Result, Watch
from gearopt.optimise.solve import PROVER
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
BOXES, ALL_BOXES = 1000, 20_000  # of the prover: a step's, a front's, where no seconds are named
ITERATIONS = 300  # of ipopt in a step whose proof is another method's
ALL_POINTS = 10_000  # where their number is open
AHEAD = 10  # further steps at least that seconds are kept for: ends are worth more than a point
CLOSE = 2.0 * POINT_TIE  # an epsilon up to which a front is complete
OPEN = 0.02  # part of the range of the first objective: steps that miss more of it are named
SHARES = 3.0  # even shares of what is left that one step may take

SETTINGS = {
    "of three objectives": "slices at even limits of the third",
    "starts where nothing is proven": f"a neighbour, and {SAMPLED} evaluations of evolution",
}


@dataclass
class Run:
    """The problems of a front, the points found so far, and the clock; it has state to fill.

    sample: points that evolution found, which steps start from; None: it was not asked, as all
    steps are proven. wanted: points that are sought, 0: all. tried: steps by the objective that
    they minimise and by what they limit beside the other one. boxes: that the prover has spent.
    refused: why it takes no step of this problem. convex: so are all forms, as duals have proven;
    logarithmic: in logarithms.
    """

    problem: Problem | Conic
    names: tuple[str, ...]
    caps: Caps
    clock: Clock
    method: str | None
    limiting: Limiting | None = None
    wanted: int = 0
    built: Built = field(default_factory=dict)
    points: list[Point] = field(default_factory=list)
    skipped: list[Impossible] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    widths: dict[str, float] = field(default_factory=dict)
    lines: list["Line"] = field(default_factory=list)
    tried: dict[tuple[str, object], list[Tried]] = field(default_factory=dict)
    sample: tuple[Point, ...] | None = None
    boxes: int = 0
    refused: str = ""
    convex: bool = True
    logarithmic: bool = True
    none: Result | None = None

    @property
    def discrete(self) -> bool:
        """Return whether some variable is, so that the front may have jumps."""
        return any(v.discrete for v, _ in self.problem.columns)

    def steps_of(self, name: str, others: Caps) -> list[Tried]:
        """Steps that minimise one of the first two objectives under the same limits on others."""
        return self.tried.setdefault((name, tuple(sorted(others.items()))), [])

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
    state = Run(problem, tuple(names), caps, Clock(budget, watch), method, limiting, points)
    if limiting is not None and limiting.whole and len(names) == 2:
        return concluded(state, _stairs(state, points))
    ends = _ends(state, state.names, state.caps)
    if ends is None:
        return concluded(state)
    if len(names) == 2:
        _between(state, ends, points or ALL_POINTS, state.caps)
    else:
        _slices(state, ends, points)
    return concluded(state)


def _limitable(limiting: Limiting, names: Sequence[str]) -> None:
    """Raise SolveError for objectives that cannot be limited."""
    for name in names:
        if name not in limiting.names:
            raise SolveError(
                f"{name} cannot be limited, only {', '.join(limiting.names)}: name it first, "
                "without a largest value"
            )


def _ends(state: Run, names: tuple[str, ...], caps: Caps) -> list[Point] | None:
    """Return the points of the least value of objectives under caps; None where there is none."""
    ends: list[Point] = []
    least: list[float] = []
    for k, name in enumerate(names):
        first = _solved(state, name, dict(caps), ends[-1].x if ends else None)
        if first is None:
            state.points += ends if state.clock.stopped else []
            return None
        least.append(float(first.values[k]))
        ends.append(_end(state, names, k, caps, first, least[k] + SLACK * abs(least[k])))
    near = POINT_TIE * np.ptp([p.values for p in ends], axis=0)
    for k, at in enumerate(least):  # small differences of large values are told apart
        if SLACK * abs(at) > near[k]:
            most = at + max(float(near[k]), FEASIBLE * abs(at))
            ends[k] = _end(state, names, k, caps, ends[k], most)
    if len(names) == len(state.names):
        values = np.array([p.values for p in ends])
        state.widths = dict(zip(state.names, np.ptp(values, axis=0).tolist(), strict=True))
    sides = np.zeros(1), np.full(1, -math.inf)  # of the box of two ends: tangents of its front
    framed = [replace(p, slopes=s) for p, s in zip(ends, sides, strict=False)]
    framed = framed if state.limiting is None else ends
    for p in framed if len(state.names) == 2 else ends:
        _keep(state, p)
    return framed if len(names) == 2 else ends


def _end(
    state: Run, names: tuple[str, ...], k: int, caps: Caps, first: Point, most: float
) -> Point:
    """Return a point of the least others where objective k is at most a value; from a point."""
    if state.limiting is not None and names[k] not in state.limiting.names:
        return first
    for other in (*names[:k], *names[k + 1 :]):
        again = _solved(state, other, _least(caps, {names[k]: most}), first.x)
        first = again if again is not None else first
    return first


def _stairs(state: Run, points: int) -> bool:
    """Add designs by steps just below the last one; return whether the last step has none."""
    (first, second), held = state.names, dict(state.caps)
    while not state.clock.over and (not points or len(state.points) < points):
        point = _solved(state, first, held)
        if point is None or not point.proven:
            return point is None and state.skipped[-1].proven
        _keep(state, point)
        held[second] = float(point.values[1]) * (1.0 - STEP) or -STEP
    return False


def _keep(state: Run, point: Point) -> None:
    """Add a point, and note how the front has grown."""
    state.points.append(point)
    values = np.array([p.values for p in sifted(state.points)[0]])
    state.steps.append(Step(state.clock.seconds, state.clock.evaluations, values))


def _least(caps: Caps, held: Caps) -> Caps:
    return {n: min(caps.get(n, math.inf), held.get(n, math.inf)) for n in {**caps, **held}}


def _between(state: Run, ends: list[Point], points: int, caps: Caps) -> None:
    """Add points of a front of the first two objectives between its ends.

    A few are in the largest gaps, where tangents meet; of a convex front the others are spread.
    Gaps that steps find empty are narrowed until as many points are found, or all are shut or
    without results.
    """
    line = Line(
        state, caps, list(ends), np.array([state.widths[name] or 1.0 for name in state.names])
    )
    few = (
        points
        if state.limiting is not None or state.discrete
        else min(points, max(FIRST_POINTS, points // 4))
    )
    line.fill(few)
    if few < points:
        for most in spread(line.open, points - len(line.points)):
            line.step(most)
        line.fill(points)
    state.lines.append(line)
    if len(state.names) == 2 and state.limiting is None and state.clock.budget.seconds is not None:
        line.repeat()


@dataclass
class Line:
    """A front of two objectives under caps as its points are found; it has state to fill."""

    state: Run
    caps: Caps
    points: list[Point]
    ranges: Array

    @property
    def open(self) -> list[Gap]:
        """Return the gaps between the points that are not shut."""
        tried = self.state.steps_of(self.state.names[0], _but(self.caps, self.state.names[1]))
        return [gap for gap in gaps(self.points, tried, self.ranges) if not gap.shut]

    def fill(self, count: int) -> None:
        """Step into the largest gap until there are so many points, or no gap is left to try."""
        least = SLACK * math.prod(self.ranges[:2])
        for _ in range(TWICE * count):
            free = [g for g in self.open if g.area > least and len(g.refused) < TRIALS]
            if not free or len(self.points) >= count or self.state.clock.over:
                return
            gap = max(free, key=lambda g: g.area)
            at = met(gap.left, gap.right)[1] if gap.whole else 0.5
            shutting = self.state.discrete and not gap.whole and not gap.refused
            shut = gap.top - 0.5 * POINT_TIE * self.ranges[1]
            self.step(shut if shutting else gap.limit(min(max(float(at), CORNER), 1.0 - CORNER)))

    def step(self, most: float) -> None:
        """Add the point of least first objective below a limit of the second one, if it is new."""
        state, near = self.state, POINT_TIE * self.ranges
        gap = next((g for g in self.open if g.floor < most < g.top), None)
        if gap is None or state.clock.over:
            return
        point = _solved(
            state, state.names[0], _least(self.caps, {state.names[1]: most}), gap.right.x
        )
        if point is None or point.values[1] >= gap.top - 0.1 * near[1]:
            return
        if point.values[0] < gap.left.values[0] - near[0]:
            self._add(point)

    def repeat(self) -> None:
        """Take steps again whose bounds miss much, the worst first, in what is left of the time."""
        state = self.state
        left = [s for s in _strips(state, sifted(state.points)[0]) if s.missing > OPEN]
        for strip in sorted(left, key=lambda s: -s.missing):
            under = [p for p in ranked(self.points) if p.values[1] <= strip.high]
            if not under or state.clock.over:
                return
            most = {state.names[1]: strip.high} if strip.high < math.inf else {}
            point = _solved(state, state.names[0], _least(self.caps, most), under[-1].x)
            if (
                point is not None
                and point.values[0] < under[-1].values[0] - POINT_TIE * self.ranges[0]
            ):
                self._add(point)

    def _add(self, point: Point) -> None:
        self.points.append(point)
        _keep(self.state, point)


def _slices(state: Run, ends: list[Point], points: int) -> None:
    """Add fronts of the first two objectives at even limits of the third."""
    third, values = state.names[2], np.array([p.values[2] for p in ends])
    count = max(2, round(math.sqrt(points)))
    least = float(values.min())
    for level in np.linspace(values.max(), least + SLACK * abs(least), count):
        caps = _least(state.caps, {third: float(level)})
        plane_ends = None if state.clock.over else _ends(state, state.names[:2], caps)
        if plane_ends is not None:
            _between(state, plane_ends, points // count, caps)


def _solved(state: Run, name: str, most: Caps, near: Array | None = None) -> Point | None:
    """Return the point of least value of one objective under limits on others; None: none found.

    Where a step is not proven, the best point that evolution found within the limits is another
    start of a local method, and the better of both answers counts, with the bound of the first.
    """
    if state.clock.stopped:
        return None
    result, point = _attempt(state, name, most, near, state.method)
    place, problem = state.names.index(name), state.problem
    if result.status not in PROVEN and state.limiting is None and isinstance(problem, Problem):
        if state.sample is None:
            state.sample = _sampled(state, problem)
        start = state.started(name, most)
        if start is not None and not state.clock.over and not state.discrete:
            again, other = _attempt(state, name, most, start, state.method or "ipopt")
            if other is not None and (point is None or other.values[place] < point.values[place]):
                bound = again.bound if again.status == "optimal" else result.bound
                result, point = replace(again, bound=bound), other
    _noted(state, name, most, result, None if point is None else float(point.values[place]))
    if point is None:
        state.skipped.append(Impossible(dict(most), result.status == "infeasible"))
        state.none = state.none or result
    return point


def _noted(state: Run, name: str, most: Caps, result: Result, least: float | None) -> None:
    """Keep what a step proves, of the first two objectives."""
    if name in state.names[:2]:
        other = state.names[1 - state.names.index(name)]
        bound = -math.inf if result.bound is None else result.bound
        bound = math.inf if result.status == "infeasible" else bound
        steps = state.steps_of(name, _but(most, other))
        steps.append(Tried(most.get(other, math.inf), least, bound))


def _but(caps: Caps, name: str) -> Caps:
    return {n: value for n, value in caps.items() if n != name}


def _sampled(state: Run, problem: Problem) -> tuple[Point, ...]:
    """Points of a front that evolution finds within a part of the budget, as starts of steps."""
    clock = state.clock
    limits = {name: Limit.of(value, 0.0) for name, value in state.caps.items()}
    limited, left = posed(problem, state.names, limits), clock.left
    if problem.repeats or not isinstance(limited, Problem):
        return ()
    seconds = None if left.seconds is None else SHARE * left.seconds
    most = SAMPLED if left.evaluations is None else min(SAMPLED, int(SHARE * left.evaluations))
    before = clock.evaluations
    sample = evolution.front(limited, 0, Budget(seconds, most), 0, clock.inner(values=False))
    clock.evaluations = before + sample.evaluations
    return sample.points


def _attempt(
    state: Run, name: str, most: Caps, near: Array | None, method: str | None
) -> tuple[Result, Point | None]:
    """Return the result of one step from a start, and its point; method: None for the proof."""
    at = _posed(state, name, most, near)
    direct = method is not None or state.limiting is not None
    if direct or isinstance(at, Conic):
        result, outcome = _answered(state, at, method)
    else:
        result, outcome = _proven(state, at)
    state.clock.tell()
    if result.value is None or outcome.x is None:
        return result, None
    values = _values(state, result, outcome.x)
    slopes = None
    rows = [limit_of(n) for n in state.names[1:]]
    priced = name == state.names[0] and not state.discrete
    if priced and all(row in result.multipliers for row in rows):
        scales = [violation_scale(at, n) for n in state.names[1:]]
        slopes = np.array([result.multipliers[r] / s for r, s in zip(rows, scales, strict=True)])
    proven = result.status == "optimal"
    by_duals = isinstance(at, Conic) or result.proof.get("method") == "dual"
    state.convex = state.convex and proven and by_duals and state.limiting is None
    if isinstance(at, Problem) and state.convex:
        shape = form(at)
        state.logarithmic = state.logarithmic and shape.convex and shape.log_objective
    else:
        state.logarithmic = False
    bound = result.bound if name == state.names[0] else None
    return result, Point(outcome.x, values, proven, bound, slopes)


def _answered(
    state: Run, at: Problem | Conic, method: str | None, most: int | None = None
) -> tuple[Result, Outcome]:
    """Answer of a method to a step within its share of the seconds that are left."""
    clock, budget = state.clock, state.clock.left
    if budget.seconds is not None and state.limiting is None:
        ahead = max(AHEAD, state.wanted - len(state.points) if state.widths and state.wanted else 0)
        budget = replace(budget, seconds=min(1.0, SHARES / ahead) * budget.seconds)
    if most is not None and (budget.seconds is None or method != PROVER):
        budget = replace(budget, evaluations=min(most, budget.evaluations or most))
    before = clock.evaluations
    inner = clock.inner(values=False)
    result, outcome = solve_raw(at, method, budget, watch=inner)
    clock.evaluations = before + result.evaluations
    return result, outcome


def _proven(state: Run, at: Problem) -> tuple[Result, Outcome]:
    """Answer of ipopt where its duals prove it, else that of spatial branch and bound beside it.

    Where the text has no relaxation it is ipopt's; SolveError where there is no other one.
    """
    first = None
    if not state.discrete and (state.convex or state.refused):
        first = _answered(state, at, "ipopt", None if state.refused else ITERATIONS)
        if first[0].status in PROVEN or state.refused or state.clock.over:
            return first
        if first[0].value is not None and first[1].x is not None and not at.repeats:
            at = at.starting(first[1].x)
    boxes = min(BOXES, ALL_BOXES - state.boxes)
    if first is not None and boxes <= 0:
        return first
    try:
        second = _answered(state, at, PROVER, max(1, boxes))
    except SolveError as refusal:
        if state.discrete:
            raise
        state.refused = str(refusal)
        return first or _answered(state, at, "ipopt")
    state.boxes += second[0].evaluations
    return _better(first, second) if first is not None else second


def _better(
    first: tuple[Result, Outcome], second: tuple[Result, Outcome]
) -> tuple[Result, Outcome]:
    """The answer of less value, with the second one's bound."""
    (local, _), (proof, _) = first, second
    if proof.status in PROVEN or local.value is None:
        return second
    if proof.value is not None and proof.value <= local.value:
        return second
    return replace(local, bound=proof.bound), first[1]


def _posed(state: Run, name: str, most: Caps, near: Array | None) -> Problem | Conic:
    if state.limiting is not None:
        return state.limiting.problem(name, most)
    limits = {n: Limit.of(value, state.widths.get(n, 0.0)) for n, value in most.items()}
    at = kept(state.built, state.problem, (name,), limits)
    if near is not None and isinstance(at, Problem) and not at.repeats:
        at = at.starting(near)
    return at


def _values(state: Run, result: Result, x: Array) -> Array:
    """Return the values of all objectives at the point of a result."""
    if state.limiting is None:
        return valued(result, state.names)
    rows, values = state.problem.rows.objectives, state.problem.batch(x[None]).F[0]
    return np.array([values[rows.index(name)] for name in state.names])


STAIRS = (
    "Proof: complete searches, one per design, each for a smaller value of the second objective "
    "than that of the design before; the last search found no design."
)
SHUT = (
    "Proof: searches under limits on the second objective leave no design that is better than one "
    f"of these, in any objective, by more than {CLOSE:g} of the ranges of the objectives."
)


def concluded(state: Run, complete: bool = False) -> Found:
    """Return the front of all points, with what its steps prove of the designs between them."""
    points, beaten = sifted(state.points)
    left = [] if complete or len(state.names) > 2 or not points else _strips(state, points)
    epsilon = max((strip.worse for strip in left), default=math.inf)
    complete = complete or epsilon <= CLOSE
    bent = state.convex and not state.discrete and all(p.proven for p in points)
    curved = len(points) > 1 and bent and len(state.names) == 2 and not complete
    curved = curved and all(p.slopes is not None for p in points)
    none = None if points else state.none
    return Found(
        points,
        complete=complete and bool(points),
        error=curve_error(points, state.logarithmic) if curved else None,
        epsilon=epsilon if epsilon < 1.0 and not complete else None,
        beaten=beaten,
        skipped=tuple(state.skipped[:-1] if complete and not left else state.skipped),
        infeasible=not points and bool(state.skipped) and state.skipped[0].proven,
        finished=not state.clock.stopped,
        steps=tuple(state.steps),
        proof={
            "method": "epsilon constraints",
            "sentence": _sentence(state, points, complete, left),
        }
        if none is None
        else none.proof,
        evaluations=state.clock.evaluations,
        unknown=_left_open(state, left) if none is None else (),
        message=state.refused if none is None else none.message or NO_DESIGN,
    )


NO_DESIGN = "no design meets all limits"


def _strips(state: Run, points: tuple[Point, ...]) -> list[Strip]:
    """Gaps that the steps of a front of two objectives leave open."""
    (first, second), caps = state.names, state.caps
    values = np.array([p.values for p in points])
    width, size = np.ptp(values, axis=0), np.abs(values).max(axis=0)
    ranges = np.where(width > 0.0, width, np.where(size > 0.0, size, 1.0))
    ends = state.steps_of(second, _but(caps, first))
    held = caps.get(first, math.inf)
    least = max((t.bound for t in ends if t.most >= held), default=-math.inf)
    tried = state.steps_of(first, _but(caps, second))
    return strips(tried, least, caps.get(second, math.inf), values, ranges)


def _sentence(state: Run, points: tuple[Point, ...], complete: bool, left: list[Strip]) -> str:
    """Sentence on the proof of the points."""
    if complete and points:
        return SHUT if left else STAIRS
    count = sum(p.proven for p in points)
    if not count:
        starts = len(state.sample or ())
        many = f", also from {starts:,} points of evolution" if starts else ""
        found_points = "every point is the best one found under its limits"
        return f"Not proven: {found_points if points else 'no design was found'}{many}."
    which = "Every point" if count == len(points) else f"{count} of {len(points)} points"
    verb = "is" if count in (1, len(points)) else "are"
    by = f"by more than {GAP:g} of its first objective"
    return f"{which} {verb} proven: no design dominates it {by}."


def _left_open(state: Run, left: list[Strip]) -> tuple[tuple[float, float], ...]:
    """Pieces of the front that are not known: limits of the second objective between them."""
    known = any(math.isfinite(strip.worse) for strip in left)
    pieces = list[tuple[float, float]]()
    for strip in left:
        if strip.missing > OPEN or strip.low == -math.inf:
            joined = pieces and pieces[-1][1] == strip.low
            pieces.append((pieces.pop()[0] if joined else strip.low, strip.high))
    if not known:
        every = [gap for line in state.lines for gap in line.open if gap.refused]
        pieces = [(gap.floor, gap.top) for gap in every]
    return tuple(pieces)
