"""The certainty of the points that epsilon constraints found, in numbers and in words."""

from typing import TYPE_CHECKING

import numpy as np

from gearopt.optimise.pareto.found import Found, Point, sifted
from gearopt.optimise.pareto.gaps import CLOSE, boxed_error, curve_error
from gearopt.optimise.solve import GAP

if TYPE_CHECKING:
    from gearopt.optimise.pareto.epsilon import Line, Run

NAMED = 3  # gaps left open, by their places
STAIRS = (
    "Proof: exhausted searches, one per design, each for a smaller {name} than the design before; "
    "the last search found no design."
)
SHUT = (
    "Proof: between two neighbours, searches under limits on the {name} end at the one of smaller "
    "{name}. Designs nearer than {close:g} of the ranges of the objectives count as one."
)


def concluded(run: "Run", complete: bool = False) -> Found:
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


def _sentence(run: "Run", points: tuple[Point, ...], complete: bool) -> str:
    """Sentence on the proof of the points."""
    if complete and points:
        return (STAIRS if not run.lines else SHUT).format(name=run.names[1], close=CLOSE)
    count = sum(p.proven for p in points)
    if not count:
        starts = len(run.sample or ())
        many = f", also from {starts:,} points of evolution" if starts else ""
        return f"Not proven: every point is the best one found under its limits{many}."
    which = "Every point" if count == len(points) else f"{count} of {len(points)} points"
    verb = "is" if count == len(points) else "are"
    by = f"by more than {GAP:g} of its first objective"
    return f"{which} {verb} proven: no design dominates it {by}."


def _left_open(run: "Run") -> str:
    """Return where steps between two neighbours had no result."""
    parts = [gap for line in run.lines for gap in line.open if gap.refused]
    if not parts:
        return ""
    name = run.names[1].replace("_", " ")
    places = ", ".join(f"{gap.floor:.6g} to {gap.top:.6g}" for gap in parts[:NAMED])
    more = f" and {len(parts) - NAMED} others" if len(parts) > NAMED else ""
    what = "part of the front is" if len(parts) == 1 else "parts of the front are"
    return f"{len(parts)} {what} open, where steps had no result: {name} {places}{more}"


def _error(run: "Run", points: tuple[Point, ...], line: "Line") -> float | None:
    """Return the error of a front of proven points: of tangents where it is convex, else of gaps.

    None of a single point.
    """
    if len(points) < 2:
        return None
    convex = run.limiting is None and not run.discrete
    if convex and all(p.slopes is not None for p in points):
        return curve_error(points, run.logarithmic)
    return boxed_error(line.gaps, np.ptp([p.values for p in points], axis=0)) + run.blur
