"""Fronts by one objective at a time: weighted sums by annealing, evolution polished by Ipopt."""

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto import evolution
from gearopt.optimise.pareto.found import Found, Point, Step, sifted
from gearopt.optimise.pareto.posed import Built, Limit, kept, posed, valued
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Watch
from gearopt.optimise.solvers import annealing
from gearopt.optimise.terms import Array, Terms

RUNS = 11  # weights along an edge between two objectives
SHARE = 0.5  # of a budget is for evolution, where Ipopt polishes
RANDOM = True
PACED = True  # every weight has an equal part of its evaluations
COUNTS = "point evaluated or Ipopt iteration"
SETTINGS = {
    "annealing": {"weights along an edge": RUNS, **annealing.SETTINGS},
    "hybrid": {"part of evolution": SHARE, **evolution.SETTINGS},
}
SUM = "weighted_sum"
ANNEALED = "Not proven: the best designs that annealing found for weighted sums of the objectives."
POLISHED = "Not proven: designs that evolution found, each improved by Ipopt."


def annealed(
    problem: Problem, points: int, budget: Budget, seed: int = 0, watch: Watch | None = None
) -> Found:
    """Return the best points of weighted sums, by annealing each.

    points: weights along an edge, 0: RUNS; a part of the budget is for each. The dents of a front
    have no weights.
    """
    clock, count = Clock(budget, watch), len(problem.rows.objectives)
    edge = max(2, min(RUNS, points or RUNS))
    rows = [w for w in product(range(edge), repeat=count) if sum(w) == edge - 1]
    corners = [w for w in rows if max(w) == edge - 1]
    weights = [*corners, *(w for w in rows if w not in corners)]
    tried: list[Point] = []
    steps: list[Step] = []
    scale = np.ones(count)
    for k, w in enumerate(weights):
        if clock.over:
            break
        if k == count and tried:
            width = np.ptp([p.values for p in tried], axis=0)
            scale = np.where(width > 0.0, width, 1.0)
        part = _part(clock, len(weights) - k)
        weighted_sum = weighed(problem, np.array(w, float) / scale)
        before = clock.evaluations
        result, outcome = run(weighted_sum, "annealing", part, seed, clock.inner(values=False))
        clock.evaluations = before + result.evaluations
        clock.tell()
        if result.value is not None and outcome.x is not None:
            tried.append(Point(outcome.x, valued(result, problem.rows.objectives)))
            values = np.array([p.values for p in sifted(tried)[0]])
            steps.append(Step(clock.seconds, clock.evaluations, values))
    return _found(tried, clock, steps, "weighted sums by annealing", ANNEALED)


def weighed(problem: Problem, weights: Array) -> Problem:
    """Return the problem that minimises a weighted sum of its objectives (k,)."""
    names = problem.rows.objectives
    several = posed(problem, names, {})

    def evaluate(x: Any, p: Any) -> Terms:
        terms = several.evaluate(x, p)
        total = sum(w * terms.minimise[n] for w, n in zip(weights.tolist(), names, strict=True))
        return replace(terms, minimise={SUM: total})

    assert isinstance(several, Problem)
    return replace(several, evaluate=evaluate, methods={})


def polished(
    problem: Problem, points: int, budget: Budget, seed: int = 0, watch: Watch | None = None
) -> Found:
    """Return points of evolution, of each the first objective minimised further by Ipopt.

    The other objectives stay as they are or fall, discrete variables are held.
    """
    clock = Clock(budget, watch)
    first = evolution.front(problem, points, _half(budget), seed, clock.inner(values=False))
    clock.evaluations = first.evaluations
    tried, steps = list(first.points), list(first.steps)
    built: Built = {}
    names = problem.rows.objectives
    for p in first.points:
        if clock.over:
            break
        limits = {n: Limit.of(float(v), 0.0) for n, v in zip(names[1:], p.values[1:], strict=True)}
        limited_problem = kept(built, problem, names[:1], limits)
        assert isinstance(limited_problem, Problem)
        before = clock.evaluations
        part = _part(clock, 1)
        result, outcome = run(
            limited_problem.holding(p.x).starting(p.x),
            "ipopt",
            part,
            seed,
            clock.inner(values=False),
        )
        clock.evaluations = before + result.evaluations
        clock.tell()
        if result.value is not None and outcome.x is not None:
            tried.append(Point(outcome.x, valued(result, names)))
            values = np.array([q.values for q in sifted(tried)[0]])
            steps.append(Step(clock.seconds, clock.evaluations, values))
    return _found(tried, clock, steps, "evolution and Ipopt", POLISHED)


def _half(budget: Budget) -> Budget:
    seconds, most = budget.seconds, budget.evaluations
    return replace(
        budget,
        seconds=None if seconds is None else SHARE * seconds,
        evaluations=None if most is None else int(SHARE * most),
    )


def _part(clock: Clock, runs: int) -> Budget:
    """Equal part of a clock's rest for so many runs."""
    left = clock.left
    return replace(
        left,
        seconds=None if left.seconds is None else left.seconds / runs,
        evaluations=None if left.evaluations is None else max(1, left.evaluations // runs),
    )


def _found(
    points: list[Point], clock: Clock, steps: list[Step], method: str, sentence: str
) -> Found:
    kept, beaten = sifted(points)
    return Found(
        kept,
        beaten=beaten,
        finished=not clock.stopped,
        steps=tuple(steps),
        proof={"method": method, "sentence": sentence},
        evaluations=clock.evaluations,
        message="" if kept else "no feasible design was found",
    )
