"""A method's front, measured, certified and picked from; one front of several problems.

Several are those of which a design solves any: numbers of stages.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.optimise.certified import design, limits_of
from gearopt.optimise.clock import Clock
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.found import Found, Point
from gearopt.optimise.pareto.front import Front, FrontPoint, Growth
from gearopt.optimise.pareto.measures import hypervolume, picks, reference, unbeaten
from gearopt.optimise.pareto.objectives import Objective
from gearopt.optimise.pareto.posed import posed
from gearopt.optimise.problem import Problem
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
    single = posed(problem, [objectives[0].name], {}) if isinstance(problem, Conic) else problem
    shown = drawn or (lambda x: design(single, x))
    used = limits_of(single, np.array([p.x for p in made.points])) if made.points else []
    points = tuple(_point(p, shown(p.x), u) for p, u in zip(made.points, used, strict=True))
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
        epsilon=made.epsilon,
        picks=tuple(picks(values, [o.name for o in objectives], weights)),
        beaten=tuple(tuple(map(float, row)) for row in made.beaten),
        impossible=made.skipped,
        unknown=tuple((_finite(low), _finite(high)) for low, high in made.unknown),
        corner=tuple(map(float, corner)),
        hypervolume=whole,
        growth=_growth(made, corner),
        proof=dict(made.proof),
        message=made.message,
        evaluations=made.evaluations,
        seconds=clock.seconds,
        **names,
    )


def _finite(end: float) -> float | None:
    return float(end) if np.isfinite(end) else None


def status(made: Found) -> str:
    """Status of a front, by its proof."""
    if made.infeasible:
        return "infeasible"
    if made.complete:
        return "complete"
    if not made.finished:
        return "limit"
    return "proven" if made.points and all(p.proven for p in made.points) else "not proven"


def _point(point: Point, design: Mapping[str, Any], used: Mapping[str, float]) -> FrontPoint:
    slopes = None
    if point.slopes is not None:
        slopes = tuple(float(s) if np.isfinite(s) else None for s in point.slopes)
    return FrontPoint(
        tuple(map(float, point.values)),
        point.proven,
        point.bound,
        slopes,
        design,
        used,
    )


def _growth(made: Found, corner: Array) -> tuple[Growth, ...]:
    """Return the hypervolume wherever it grew."""
    growth: list[Growth] = []
    for step in made.steps:
        volume = hypervolume(step.values, corner) if len(corner) and len(step.values) else 0.0
        if not growth or volume > growth[-1].hypervolume:
            growth.append(Growth(step.seconds, step.evaluations, volume))
    return tuple(growth)


CERTAIN = ("complete", "infeasible")


def united(fronts: Sequence[Front], weights: Mapping[str, float] | None) -> Front:
    """Return the designs of fronts that none of any of them beats; of equal ones the first.

    The fronts have the same objectives. It is complete where all of them are, or are proven to be
    empty; what is proven of single points of a front says nothing of the others.
    """
    every = [point for front in fronts for point in front.points]
    values = np.array([p.values for p in every]).reshape(-1, len(fronts[0].objectives))
    kept = unbeaten(values).tolist()
    done = all(front.status in CERTAIN for front in fronts)
    points = tuple(every[k] if done else replace(every[k], proven=False) for k in kept)
    corner = reference(values[kept]) if kept else np.empty(0)
    whole = hypervolume(values[kept], corner) if kept else None
    seconds, spent = (sum(getattr(f, n) for f in fronts) for n in ("seconds", "evaluations"))
    lost = tuple(every[k].values for k in range(len(every)) if k not in set(kept))
    said = " ".join(str(front.proof.get("sentence", "")) for front in fronts)
    said = f"{'Proof. ' * done}{said}"
    return replace(
        fronts[0],
        status=_united_status(fronts, done, bool(kept)),
        points=points,
        error=None,
        epsilon=None,
        picks=tuple(picks(values[kept], fronts[0].names, weights)),
        beaten=sum((front.beaten for front in fronts), lost),
        impossible=sum((front.impossible for front in fronts), ()),
        unknown=(),
        corner=tuple(map(float, corner)),
        hypervolume=whole,
        growth=() if whole is None else (Growth(seconds, spent, whole),),
        proof={**fronts[0].proof, "sentence": said},
        message="" if kept else next((f.message for f in fronts if f.message), ""),
        evaluations=spent,
        seconds=seconds,
    )


def _united_status(fronts: Sequence[Front], done: bool, some: bool) -> str:
    if done:
        return "complete" if some else "infeasible"
    return "limit" if any(front.status == "limit" for front in fronts) else "not proven"
