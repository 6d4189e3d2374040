"""A method's front, measured, certified and picked from."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.found import Found, Point
from gearopt.optimise.pareto.front import Front, FrontPoint, Growth, Impossible, Objective
from gearopt.optimise.pareto.measures import hypervolume, reference
from gearopt.optimise.pareto.pick import picks
from gearopt.optimise.pareto.posed import posed
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import design, limits
from gearopt.optimise.terms import Array


def judged(
    problem: Problem | Conic,
    made: Found,
    objectives: Sequence[Objective],
    method: str,
    clock: Clock,
    weights: Mapping[str, float] | None = None,
    drawn: Callable[[Array], Mapping[str, Any]] | None = None,
    **names: Any,
) -> Front:
    """Front of a method's findings, measured, with the designs that rules pick.

    drawn: the design of a point as a kind of file shows it; by default variables by name.
    """
    one = posed(problem, [objectives[0].name], {}) if isinstance(problem, Conic) else problem
    shown = drawn or (lambda x: design(one, x))
    points = tuple(_point(one, p, shown) for p in made.points)
    values = made.values
    corner = reference(values) if len(values) else np.empty(0)
    whole = hypervolume(values, corner) if len(values) else None
    return Front(
        name=problem.name,
        status=status(made),
        method=method,
        objectives=tuple(objectives),
        points=points,
        error=made.error,
        picks=tuple(picks(values, [o.name for o in objectives], weights)),
        beaten=tuple(tuple(map(float, row)) for row in made.beaten),
        impossible=tuple(Impossible(dict(s.limits), s.proven) for s in made.skipped),
        corner=tuple(map(float, corner)),
        hypervolume=whole,
        growth=_growth(made, corner),
        proof=dict(made.proof),
        message=made.message,
        evaluations=made.evaluations,
        seconds=clock.seconds,
        **names,
    )


def status(made: Found) -> str:
    """Status of a front, by its proof."""
    if made.infeasible:
        return "infeasible"
    if made.complete:
        return "complete"
    if not made.finished:
        return "limit"
    return "proven" if made.points and all(p.proven for p in made.points) else "not proven"


def _point(
    problem: Problem | Conic, point: Point, drawn: Callable[[Array], Mapping[str, Any]]
) -> FrontPoint:
    slopes = None
    if point.slopes is not None:
        slopes = tuple(float(s) if np.isfinite(s) else None for s in point.slopes)
    return FrontPoint(
        tuple(map(float, point.values)),
        point.proven,
        point.bound,
        slopes,
        drawn(point.x),
        limits(problem, point.x),
    )


def _growth(made: Found, corner: Array) -> tuple[Growth, ...]:
    """Return the hypervolume wherever it grew."""
    found: list[Growth] = []
    for step in made.steps:
        volume = hypervolume(step.values, corner) if len(corner) and len(step.values) else 0.0
        if not found or volume > found[-1].hypervolume:
            found.append(Growth(step.seconds, step.evaluations, volume))
    return tuple(found)
