"""Fronts of continuous problems by epsilon constraints: one objective is minimised, others limited.

The ends of the front come first. A few more follow where the tangents of two neighbours meet, in
the largest box first; the others are spread so that the least hypervolume is missing. Where every
point is proven and the problem convex, tangents are below the front and chords above it, which
gives its error.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.form import form
from gearopt.optimise.pareto.found import Found, Point, Skipped, Step, sifted
from gearopt.optimise.pareto.posed import MOST, Built, Limit, kept, scale, valued
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result, Watch
from gearopt.optimise.solve import GAP
from gearopt.optimise.solve import run as solve_raw
from gearopt.optimise.terms import Array

SLACK = 1e-7  # relative, of the first end's objective while the others are minimised
RANDOM = False
COUNTS = "Ipopt iteration, or solve of a Conic"
SETTINGS = {"of three objectives": "slices at even limits of the third"}
STEP = 1e-8  # relative, from one of finitely many designs to the next
CORNER = 0.1  # part of a chord next to its ends where none of the first limits is put
FIRST = 5  # points at least before others are spread by them
SAMPLES = 65  # of a curve between two neighbours

LAST = (
    "Proof: exhausted searches, one per design, each for a smaller {name} than the design before; "
    "the last search found no design."
)

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
class _Run:
    """The problems of a front, the points found so far, and the clock; it has state to fill."""

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
    logarithmic: bool = True
    none: Result | None = None


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
    own = _Run(problem, tuple(names), caps, Clock(budget, watch), method, limiting)
    if limiting is not None and limiting.whole and len(names) == 2:
        return _found(own, _stairs(own, points))
    ends = _ends(own, own.names, own.caps)
    if ends is None:
        return _found(own)
    if len(names) == 2:
        _between(own, ends, points, own.caps)
    else:
        _slices(own, ends, points)
    return _found(own)


def _limitable(limiting: Limiting, names: Sequence[str]) -> None:
    """Raise SolveError for objectives that cannot be limited."""
    for name in names:
        if name not in limiting.names:
            raise SolveError(
                f"{name} cannot be limited, only {', '.join(limiting.names)}: name it first, "
                "without a largest value"
            )


def _ends(run: _Run, names: tuple[str, ...], caps: Caps) -> list[Point] | None:
    """Return the points of the least value of objectives under caps; None where there is none."""
    ends: list[Point] = []
    for k, name in enumerate(names):
        first = _solved(run, name, dict(caps), ends[-1].x if ends else None)
        if first is None:
            run.points += ends if run.clock.stopped else []
            return None
        fixed = run.limiting is None or name in run.limiting.names
        for other in (*names[:k], *names[k + 1 :]) if fixed else ():
            at = first.values[k]
            held = {name: float(at + SLACK * abs(at))}
            again = _solved(run, other, _least(caps, held), first.x)
            first = again if again is not None else first
        ends.append(first)
    if len(names) == len(run.names):
        values = np.array([p.values for p in ends])
        run.widths = dict(zip(run.names, np.ptp(values, axis=0).tolist(), strict=True))
    sides = np.zeros(1), np.full(1, -math.inf)  # of the box of two ends: tangents of its front
    framed = [replace(p, slopes=s) for p, s in zip(ends, sides, strict=False)]
    framed = framed if run.limiting is None else ends
    for p in framed if len(run.names) == 2 else ends:
        _keep(run, p)
    return framed if len(names) == 2 else ends


def _stairs(run: _Run, points: int) -> bool:
    """Add designs by steps just below the last one; return whether the last step has none."""
    (first, second), held = run.names, dict(run.caps)
    while not run.clock.over and (not points or len(run.points) < points):
        made = _solved(run, first, held)
        if made is None or not made.proven:
            return made is None and run.skipped[-1].proven
        _keep(run, made)
        held[second] = float(made.values[1]) * (1.0 - STEP)
    return False


def _keep(run: _Run, point: Point) -> None:
    """Add a point, and note how the front has grown."""
    run.points.append(point)
    values = np.array([p.values for p in sifted(run.points)[0]])
    run.steps.append(Step(run.clock.seconds, run.clock.evaluations, values))


def _least(caps: Caps, held: Caps) -> Caps:
    return {n: min(caps.get(n, math.inf), held.get(n, math.inf)) for n in {**caps, **held}}


def _between(run: _Run, ends: list[Point], points: int, caps: Caps) -> None:
    """Add points of a front of the first two objectives between its ends.

    A few where tangents meet in the largest boxes, the others spread; without tangents all are in
    the largest boxes.
    """
    found, closed = list(ends), set[tuple[float, float]]()
    whole = math.prod(run.widths[name] or 1.0 for name in run.names[:2])
    few = points if run.limiting is not None else min(points, max(FIRST, points // 4))
    while len(found) < few and not run.clock.over:
        pairs = [p for p in _pairs(found) if _place(p) not in closed]
        if not pairs or max(map(_box, pairs)) <= SLACK * whole:
            return
        pair = max(pairs, key=_box)
        at = float(_met(*pair)[1])
        closed.add(_place(pair))
        found += _added(run, min(max(at, CORNER), 1.0 - CORNER), pair, caps)
    for at, pair in _spread(_pairs(found), points - len(found)):
        if _place(pair) not in closed:
            made, low = _added(run, at, pair, caps), float(pair[0].values[1])
            if not made or made[0].values[1] <= low + SLACK * abs(low):
                closed.add(_place(pair))  # nothing lies between them


Pair = tuple[Point, Point]


def _pairs(points: list[Point]) -> list[Pair]:
    """Return neighbours along a front, by the second objective."""
    ranked = sorted(points, key=lambda p: float(p.values[1]))
    return list(zip(ranked, ranked[1:], strict=False))


def _added(run: _Run, at: float, pair: Pair, caps: Caps) -> list[Point]:
    """Add the point whose second objective is at a part of the way between two others."""
    g0, g1 = (float(p.values[1]) for p in pair)
    held = {run.names[1]: g0 + at * (g1 - g0)}
    made = _solved(run, run.names[0], _least(caps, held), pair[1].x)
    if made is None:
        return []
    _keep(run, made)
    return [made]


def _place(pair: Pair) -> tuple[float, float]:
    return float(pair[0].values[1]), float(pair[1].values[1])


def _box(pair: Pair) -> float:
    """Return the area between two neighbours that their points leave open."""
    return float(np.prod(np.abs(pair[0].values - pair[1].values)[:2]))


def _met(left: Point, right: Point) -> Array:
    """Return where tangents of two neighbours meet, as parts of the way between them (2,).

    The middle where they are not known, or meet outside of the box.
    """
    (f0, g0), (f1, g1) = left.values[:2], right.values[:2]
    if left.slopes is None or right.slopes is None or f0 == f1 or g0 == g1:
        return np.full(2, 0.5)
    s0, s1 = (float(p.slopes[0]) * (g1 - g0) / (f1 - f0) for p in (left, right))  # type: ignore
    at = 0.0 if math.isinf(s0) else (1.0 - s1) / (s0 - s1) if s0 != s1 else 0.5
    met = np.array([1.0 if math.isinf(s0) else s0 * at, at])
    return met if ((met >= 0.0) & (met <= 1.0)).all() else np.full(2, 0.5)


def _spread(pairs: list[Pair], count: int) -> list[tuple[float, Pair]]:
    """Return where so many more points miss least of the hypervolume, the first most of it.

    Parts of the way between two neighbours, and these. Points of a curve f(g) miss least where
    their density goes as (-df/dg)^(1/2): Auger, Bader, Brockhoff, Zitzler, Theory of the
    hypervolume indicator, FOGA 2009. Between neighbours the curve is taken as the parabola that
    their tangents make.
    """
    t = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    ways, lengths = [], []
    for left, right in pairs:
        way = 2.0 * t * (1.0 - t) * _met(left, right) + t**2
        step = np.sqrt(np.abs(np.diff(way, axis=0)).prod(axis=1))
        ways.append((np.append(0.0, np.cumsum(step)), way[:, 1]))
        lengths.append(ways[-1][0][-1] * math.sqrt(_box((left, right))))
    parts = np.ones(len(pairs))
    for _ in range(count if pairs else 0):  # a gap of n parts misses length^2/(2 n)
        parts[(np.array(lengths) ** 2 / (parts * (parts + 1.0))).argmax()] += 1.0
    found = [
        (float(np.interp(k / n * s[-1], s, g)), pair)
        for pair, (s, g), n in zip(pairs, ways, parts, strict=True)
        for k in range(1, int(n))
    ]
    return [found[k] for k in sorted(range(len(found)), key=lambda k: f"{k:016b}"[::-1])]


def _slices(run: _Run, ends: list[Point], points: int) -> None:
    """Add fronts of the first two objectives at even limits of the third."""
    third, values = run.names[2], np.array([p.values[2] for p in ends])
    count = max(2, round(math.sqrt(points)))
    least = float(values.min())
    for level in np.linspace(values.max(), least + SLACK * abs(least), count):
        caps = _least(run.caps, {third: float(level)})
        own = None if run.clock.over else _ends(run, run.names[:2], caps)
        if own is not None:
            _between(run, own, points // count, caps)


def _solved(run: _Run, name: str, most: Caps, near: Array | None = None) -> Point | None:
    """Return the point of least value of one objective under limits on others; None: none found."""
    if run.clock.stopped:
        return None
    at = _posed(run, name, most, near)
    before = run.clock.evaluations
    result, outcome = solve_raw(at, run.method, run.clock.left, watch=run.clock.inner(values=False))
    run.clock.evaluations = before + result.evaluations
    run.clock.tell()
    if result.value is None or outcome.x is None:
        run.skipped.append(Skipped(most, result.status == "infeasible"))
        run.none = run.none or result
        return None
    values = _values(run, result, outcome.x)
    slopes = None
    rows = [f"{MOST}_{n}" for n in run.names[1:]]
    if name == run.names[0] and all(row in result.multipliers for row in rows):
        scales = [scale(at, n) for n in run.names[1:]]
        slopes = np.array([result.multipliers[r] / s for r, s in zip(rows, scales, strict=True)])
    proven = result.status == "optimal"
    if isinstance(at, Problem) and proven and run.limiting is None:
        shape = form(at)
        run.logarithmic = run.logarithmic and shape.convex and shape.log_objective
    else:
        run.logarithmic = False
    return Point(outcome.x, values, proven, result.bound if proven else None, slopes)


def _posed(run: _Run, name: str, most: Caps, near: Array | None) -> Problem | Conic:
    if run.limiting is not None:
        return run.limiting.problem(name, most)
    limits = {n: Limit.of(value, run.widths.get(n, 0.0)) for n, value in most.items()}
    at = kept(run.built, run.problem, (name,), limits)
    if near is not None and isinstance(at, Problem) and not at.repeats:
        at = at.starting(near)
    return at


def _values(run: _Run, result: Result, x: Array) -> Array:
    """Return the values of all objectives at the point of a result."""
    if run.limiting is None:
        return valued(result, run.names)
    rows, values = run.problem.rows.objectives, run.problem.batch(x[None]).F[0]
    return np.array([values[rows.index(name)] for name in run.names])


def _found(run: _Run, complete: bool = False) -> Found:
    """Return the front of all points, with its error where it is proven."""
    points, beaten = sifted(run.points)
    all_proven = bool(points) and all(p.proven for p in points)
    two = len(run.names) == 2
    error = _error(points, run.logarithmic) if all_proven and two and len(points) > 1 else None
    said = LAST.format(name=run.names[1]) if complete and points else _sentence(points)
    proof = {"method": "epsilon constraints", "sentence": said}
    none = None if points else run.none
    return Found(
        points,
        complete=complete and bool(points),
        error=None if complete else error,
        beaten=beaten,
        skipped=tuple(run.skipped[:-1] if complete else run.skipped),
        infeasible=not points and bool(run.skipped) and run.skipped[0].proven,
        finished=not run.clock.stopped,
        steps=tuple(run.steps),
        proof=proof if none is None else none.proof,
        evaluations=run.clock.evaluations,
        message="" if none is None else none.message or "no design meets all limits",
    )


def _sentence(points: tuple[Point, ...]) -> str:
    """Return what is proven of the points."""
    count = sum(p.proven for p in points)
    if not count:
        return "Not proven: every point is the best one found under its limits."
    which = "Every point" if count == len(points) else f"{count} of {len(points)} points"
    verb = "is" if count == len(points) else "are"
    by = f"by more than {GAP:g} of its first objective"
    return f"{which} {verb} proven: no design dominates it {by}."


def _error(points: tuple[Point, ...], logarithmic: bool) -> float:
    """Return the largest distance between tangents and chords, in the ranges of the objectives.

    In logarithms where the problem is convex in them. Where a tangent is missing, that from chords
    to the corners of boxes: between two proven points no other is below both of them.
    """
    values = np.array([p.values for p in points])
    if any(p.slopes is None for p in points):
        return _boxed(values)
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


def _boxed(values: Array) -> float:
    """Return the largest distance from the chord of two neighbours to a corner of their box."""
    width = np.ptp(values, axis=0)
    sides = np.abs(np.diff(values, axis=0)) / np.where(width > 0.0, width, 1.0)
    length = np.hypot(*sides.T)
    return float((sides.prod(axis=1) / np.where(length > 0.0, length, 1.0)).max(initial=0.0))


def _meet(df: float, dg: float, first: float, second: float) -> tuple[float, float]:
    """Return where the tangents of (0, 0) and (df, dg) meet: f = first g, f = df + second (g - dg).

    The corner of their box where they meet outside of it, as roundings let them.
    """
    if math.isinf(second):
        at = dg
    elif first == second:
        return 0.0, dg
    else:
        at = (df - second * dg) / (first - second)
    at = min(max(at, min(0.0, dg)), max(0.0, dg))
    return first * at, at
