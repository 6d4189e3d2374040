"""The front of several objectives of a problem, by a method, judged and measured."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto import enumerated, epsilon, evolution, scalarised
from gearopt.optimise.pareto.found import Found, Point, sifted
from gearopt.optimise.pareto.front import Front
from gearopt.optimise.pareto.judged import judged, united
from gearopt.optimise.pareto.objectives import EPSILON, EXACT, Limiting, Tradeoff
from gearopt.optimise.pareto.posed import Limit, posed
from gearopt.optimise.problem import Batch, Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Watch
from gearopt.optimise.scale import violation
from gearopt.optimise.spatial.columns_of_text import columns

NSGA, ANNEALING, HYBRID = "nsga2", "annealing", "hybrid"
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
    else epsilon constraints; nsga2 of discrete variables whose text has no relaxation, and of a
    text that is declared vectorised, which no solver traces. points: sought, where a method has a
    choice. limiting: how the kind of problem limits objectives. SolveError where the method does
    not fit the problem.
    """
    budget, chosen = budget or Budget(), method or default_method(problem, limiting)
    whole = all(v.discrete for v, _ in problem.columns) if limiting is None else limiting.whole
    count = points or (0 if whole and len(names) == 2 else POINTS[len(names)])
    if chosen == EPSILON:
        clock = Clock(budget, watch)
        few = enumerated.front(problem, names, dict(most), clock) if limiting is None else None
        if few is not None:
            return few
        budget = clock.left
        return epsilon.front(problem, names, dict(most), count, budget, watch, limiting=limiting)
    if isinstance(problem, Conic):
        raise SolveError(f"{chosen} takes a Problem; the front of a Conic is for {EPSILON}")
    limited = {name: Limit.of(float(value), 0.0) for name, value in most.items()}
    limited_problem = posed(problem, names, limited)
    assert isinstance(limited_problem, Problem)
    if chosen == EXACT and EXACT in limited_problem.methods:
        return _checked(
            limited_problem, limited_problem.methods[EXACT](limited_problem, budget, seed, watch)
        )
    if chosen not in SAMPLERS:
        known = [m for m in METHODS if m != EXACT or EXACT in limited_problem.methods]
        raise SolveError(f"no method {chosen!r} for a front; methods: {', '.join(known)}")
    return SAMPLERS[chosen](limited_problem, points or 0, budget, seed, watch)


def default_method(problem: Problem | Conic, limiting: Limiting | None = None) -> str:
    """Return the method that is run where none is named."""
    if limiting is not None:
        return EPSILON
    if EXACT in problem.methods:
        return EXACT
    if not isinstance(problem, Problem):
        return EPSILON
    if any(v.discrete for v, _ in problem.columns):
        return EPSILON if _relaxed(problem) else NSGA
    return NSGA if problem.vectorised else EPSILON


def _relaxed(problem: Problem) -> bool:
    """Whether spatial branch and bound takes a problem."""
    single = posed(problem, problem.rows.objectives[:1], {})
    assert isinstance(single, Problem)
    try:
        columns(single)
    except SolveError:
        return False
    return True


def compared_methods(problem: Problem | Conic, limiting: Limiting | None = None) -> tuple[str, ...]:
    """Return the methods that are compared where none are named."""
    if isinstance(problem, Conic):
        return (EPSILON,)
    first = default_method(problem, limiting)
    return (first, *(method for method in SAMPLERS if method != first))


def _checked(problem: Problem, outcome: Outcome) -> Found:
    """Return the front of an exact algorithm, each point checked by the problem's own text."""
    kept, beaten = sifted([] if outcome.x is None else _feasible(problem, outcome))
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


def _feasible(problem: Problem, outcome: Outcome) -> list[Point]:
    """Points of an exact algorithm with their values; SolveError where one violates a limit."""
    x = np.array([outcome.x, *outcome.others])
    batch = problem.batch(x)
    for k, point in enumerate(x):
        alone = Batch(batch.F[k : k + 1], batch.G[k : k + 1], batch.H[k : k + 1], {})
        excess, worst = violation(problem, point, alone)
        if excess > FEASIBLE:
            raise SolveError(f"{problem.name}: a design of the front violates {worst}")
    return [Point(*both, proven=outcome.finished) for both in zip(x, batch.F, strict=True)]


def solved(
    trade: Tradeoff,
    most: Mapping[str, float],
    method: str | None,
    points: int | None,
    weights: Mapping[str, float] | None,
    budget: Budget,
    seed: int,
    watch: Watch | None,
    **names: Any,
) -> Front:
    """Return the front of posed objectives, judged and measured; names: fields of a `Front`."""
    if trade.others:
        given: dict[str, Any] = {
            "most": most,
            "method": method,
            "points": points,
            "weights": weights,
        }
        given |= {"seed": seed, "watch": watch, **names}
        return united(_each(trade, given, Clock(budget)), weights)
    clock, listed = Clock(), [one.name for one in trade.objectives]
    for name in (*most, *(weights or ())):
        if name not in listed:
            raise SolveError(f"{name} is none of the objectives of this front: {', '.join(listed)}")
    chosen = method or default_method(trade.problem, trade.limiting)
    watch = in_part(watch, trade.objectives[0].unit, "front")
    designs = found(
        trade.problem, listed, most, chosen, points, budget, seed, watch, trade.limiting
    )
    shown = [replace(one, most=most.get(one.name)) for one in trade.objectives]
    front = judged(trade.problem, designs, shown, chosen, clock, weights, trade.drawn, **names)
    proof = {**front.proof, "scope": trade.scope} if trade.scope else front.proof
    return replace(front, seed=seed, proof=proof)


def _each(trade: Tradeoff, given: Mapping[str, Any], clock: Clock) -> list[Front]:
    """Front of each of several problems, in equal shares of the time that is left."""
    every, fronts = (replace(trade, others=()), *trade.others), list[Front]()
    for k, posed_trade in enumerate(every):
        left = clock.left
        if left.seconds is not None:
            left = replace(left, seconds=left.seconds / (len(every) - k))
        front = solved(posed_trade, budget=left, **given)
        words = str(front.proof.get("sentence", "")).removeprefix("Proof: ")
        words = f"{posed_trade.part}: {words}" if posed_trade.part else words
        fronts.append(replace(front, proof={**front.proof, "sentence": words}))
        clock.evaluations += fronts[-1].evaluations
    return fronts
