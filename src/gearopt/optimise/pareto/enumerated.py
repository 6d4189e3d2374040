"""Fronts of problems of whole and listed variables alone, by going through all their points."""

import math
from collections.abc import Sequence

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.box import allowed_values
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.found import Found, Point, Step, sifted
from gearopt.optimise.pareto.front import Impossible
from gearopt.optimise.pareto.posed import VALUE, Limit, posed
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.terms import Array

MAX_POINTS = 20_000_000
FIRST, BLOCK = 2000, 100_000  # points that tell how long one takes; points at once after them
SECONDS, SHARE = 2.0, 0.3  # that all may take, and of a budget
SENTENCE = "Proof: all {count:,} points of the box were evaluated."
STOPPED = "Not proven: {done:,} of {count:,} points of the box were evaluated."


def front(
    problem: Problem | Conic, names: Sequence[str], caps: dict[str, float], clock: Clock
) -> Found | None:
    """Complete front of a problem with few points; None where they are too many, or continuous.

    caps: largest values of objectives that are of interest, by name. A value that is no number is
    no design. Points are judged as `violation` does, exact values among allowed ones.
    """
    every = _values(problem)
    count = math.prod(v.index(v[-1]) + 1 for v in every) if every else 0  # some have no len()
    if not 0 < count <= MAX_POINTS:
        return None
    sets = [np.asarray(values, float) for values in every]
    limits = {name: Limit.of(value, 0.0) for name, value in caps.items()}
    limited = posed(problem, names[:1] if isinstance(problem, Conic) else names, limits)
    x, values = np.empty((0, len(sets))), np.empty((0, len(names)))
    limited.batch(_points(sets, 0, 1))  # how the text is run is found once
    done, end, began = 0, min(FIRST, count), clock.seconds
    while done < count:
        points = _points(sets, done, end)
        some, of_some = _designs(limited, names, points)
        x, values = _unbeaten(np.vstack([x, some]), np.vstack([values, of_some]))
        if done == 0 and (clock.seconds - began) * count > clock.within(SECONDS) * end:
            return None
        clock.evaluations += end - done
        done, end = end, min(count, end + BLOCK)
        if not clock.tell():
            break
    return _found(x, values, caps, done, count, clock)


def _values(problem: Problem | Conic) -> list[Sequence[float]]:
    """Allowed values of every variable; [] where one is continuous or has infinitely many."""
    exact = isinstance(problem, Problem) and problem.exact_limits is not None
    if exact or not all(v.discrete for v, _ in problem.columns):
        return []
    try:
        return [allowed_values(problem, k) for k in range(len(problem.columns))]
    except SolveError:  # an integer without ends, a set of no value
        return []


def _points(sets: list[Array], start: int, end: int) -> Array:
    """Points (N, n) of the product of sets, in order, from one place to another."""
    places = np.unravel_index(np.arange(start, end), [len(s) for s in sets])
    return np.column_stack([s[k] for s, k in zip(sets, places, strict=True)])


def _designs(own: Problem | Conic, names: Sequence[str], points: Array) -> tuple[Array, Array]:
    """Those of points (N, n) that meet all limits, and their values (N, k)."""
    with np.errstate(all="ignore"):
        batch = own.batch(points)
        values = batch.F
        if isinstance(own, Conic):
            columns = [np.reshape(batch.report[f"{VALUE}_{name}"], -1) for name in names]
            values = np.column_stack(columns)
        met = (np.isfinite(batch.G) & (batch.G - 1.0 <= FEASIBLE)).all(axis=1)
        met &= (np.abs(batch.H - 1.0) <= FEASIBLE).all(axis=1)
    met &= np.isfinite(values).all(axis=1)
    return points[met], values[met]


def _unbeaten(x: Array, values: Array) -> tuple[Array, Array]:
    from moocore import is_nondominated

    kept = is_nondominated(values) if len(values) else np.zeros(0, bool)
    return x[kept], values[kept]


def _found(
    x: Array, values: Array, caps: dict[str, float], done: int, count: int, clock: Clock
) -> Found:
    """Front of the points that were gone through: all, or those before the run was stopped."""
    all_gone = done == count
    points = [
        Point(at, v, proven=all_gone, bound=float(v[0]) if all_gone else None)
        for at, v in zip(x, values, strict=True)
    ]
    kept, _ = sifted(points)
    sentence = SENTENCE if all_gone else STOPPED
    return Found(
        kept,
        complete=all_gone and bool(kept),
        skipped=() if kept else (Impossible(dict(caps), all_gone),),
        infeasible=all_gone and not kept,
        finished=all_gone,
        steps=(Step(clock.seconds, clock.evaluations, np.array([p.values for p in kept])),),
        proof={"method": "enumeration", "sentence": sentence.format(done=done, count=count)},
        evaluations=clock.evaluations,
        message="" if kept else "no design meets all limits",
    )
