"""The methods that find the front of a problem with several objectives."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from gearopt.errors import SolveError
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto import epsilon, evolution, scalarised
from gearopt.optimise.pareto.epsilon import Limiting
from gearopt.optimise.pareto.found import Found, Point, sifted
from gearopt.optimise.pareto.posed import Limit, posed
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Watch
from gearopt.optimise.scale import violation

EXACT, EPSILON, NSGA, ANNEALING, HYBRID = "exact", "epsilon", "nsga2", "annealing", "hybrid"
SAMPLERS: Mapping[str, Callable[..., Found]] = {
    NSGA: evolution.front,
    ANNEALING: scalarised.annealed,
    HYBRID: scalarised.polished,
}
METHODS = (EXACT, EPSILON, *SAMPLERS)
RANDOM = tuple(SAMPLERS)
POINTS = {2: 60, 3: 400}  # of a front, by its number of objectives


def found(
    problem: Problem | Conic,
    names: Sequence[str],
    most: Mapping[str, float],
    method: str | None = None,
    points: int | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    limiting: Limiting | None = None,
) -> Found:
    """Front of some objectives of a problem by a method.

    names: two or three objectives, the first minimised where others are limited. most: largest
    values of interest, by name. method: one of METHODS; by default the problem's own exact one,
    else epsilon constraints; nsga2 of discrete variables, and of a text that is declared
    vectorised, which no solver traces. points: sought, where a method has a choice. limiting: how
    the kind of problem limits objectives. SolveError where the method does
    not fit the problem.
    """
    budget, chosen = budget or Budget(), method or default(problem, limiting)
    whole = limiting is not None and limiting.whole
    count = points or (0 if whole else POINTS[len(names)])
    if chosen == EPSILON:
        return epsilon.front(problem, names, dict(most), count, budget, watch, limiting=limiting)
    if isinstance(problem, Conic):
        raise SolveError(f"{chosen} takes a Problem; the front of a Conic is for {EPSILON}")
    limited = {name: Limit.of(float(value), 0.0) for name, value in most.items()}
    own = posed(problem, names, limited)
    assert isinstance(own, Problem)
    if chosen == EXACT and EXACT in own.methods:
        return _checked(own, own.methods[EXACT](own, budget, seed, watch))
    if chosen not in SAMPLERS:
        known = [m for m in METHODS if m != EXACT or EXACT in own.methods]
        raise SolveError(f"no method {chosen!r} for a front; methods: {', '.join(known)}")
    return SAMPLERS[chosen](own, points or 0, budget, seed, watch)


def default(problem: Problem | Conic, limiting: Limiting | None = None) -> str:
    """Return the method that is run where none is named."""
    if limiting is not None:
        return EPSILON
    if EXACT in problem.methods:
        return EXACT
    if not isinstance(problem, Problem):
        return EPSILON
    untraced = problem.vectorised or any(v.discrete for v, _ in problem.columns)
    return NSGA if untraced else EPSILON


def traders(problem: Problem | Conic, limiting: Limiting | None = None) -> tuple[str, ...]:
    """Return the methods that are compared where none are named."""
    if isinstance(problem, Conic):
        return (EPSILON,)
    first = default(problem, limiting)
    return (first, *(method for method in SAMPLERS if method != first))


def _checked(problem: Problem, outcome: Any) -> Found:
    """Return the front of an exact algorithm, each point checked by the problem's own text."""
    every = () if outcome.x is None else (outcome.x, *outcome.others)
    points = []
    for x in every:
        batch = problem.batch(x[None])
        excess, worst = violation(problem, x, batch)
        if excess > FEASIBLE:
            raise SolveError(f"{problem.name}: a design of the front violates {worst}")
        points.append(Point(x, batch.F[0], proven=outcome.finished))
    kept, beaten = sifted(points)
    return Found(
        kept,
        complete=outcome.finished and bool(kept),
        beaten=beaten,
        infeasible=outcome.infeasible,
        finished=outcome.finished,
        proof=dict(outcome.proof or {}),
        evaluations=outcome.evaluations,
        message=outcome.message,
    )
