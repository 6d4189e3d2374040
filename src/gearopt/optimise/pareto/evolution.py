"""Fronts by evolution, NSGA-II or for three objectives NSGA-III of pymoo; nothing is proven."""

import math
from typing import Any

import numpy as np

from gearopt.optimise.box import box
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.found import Found, Point, Step, sifted
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Watch
from gearopt.optimise.scale import violation
from gearopt.optimise.solvers.nsga2 import GENERATIONS, POPULATION, posed
from gearopt.optimise.terms import Array

PARTITIONS = 12  # of the reference directions of NSGA-III: 91 of three objectives
RANDOM = True
PACED = True  # its generations are those that its evaluations pay for
COUNTS = "point evaluated"
SETTINGS = {
    "population": POPULATION,
    "reference directions of three objectives": f"Das and Dennis, {PARTITIONS} parts",
    "crossover and mutation": "simulated binary, polynomial; pymoo's defaults",
}
SENTENCE = "Not proven: the best designs that evolution found."


def front(
    problem: Problem, points: int, budget: Budget, seed: int = 0, watch: Watch | None = None
) -> Found:
    """Return the unbeaten individuals of all generations; points: size of the population."""
    clock, space = Clock(budget, watch), box(problem)
    size = max(4, points or POPULATION)
    most = budget.evaluations
    generations = GENERATIONS if most is None else max(1, most // size)
    algorithm = _algorithm(len(problem.rows.objectives), size)
    algorithm.setup(posed(problem, space), seed=seed, termination=("n_gen", generations))
    kept: list[Point] = []
    beaten = np.empty((0, len(problem.rows.objectives)))
    steps: list[Step] = []
    while algorithm.has_next() and not clock.stopped:
        algorithm.next()
        clock.evaluations = int(algorithm.evaluator.n_eval)
        good = [one for one in algorithm.pop if one.feas]
        units = np.array([one.X for one in good]).reshape(len(good), len(space.low))
        fresh = [
            Point(x, np.array(one.F, float))
            for x, one in zip(space.points(units), good, strict=True)
        ]
        chosen, beaten = sifted([*kept, *fresh])
        kept = list(chosen)
        values = np.array([p.values for p in kept]).reshape(len(kept), beaten.shape[-1] or 0)
        steps.append(Step(clock.seconds, clock.evaluations, values))
        clock.best = min((float(p.values[0]) for p in kept), default=math.inf)
        clock.tell()
    front_points = _checked(problem, kept)
    proof = {"method": "evolution", "sentence": SENTENCE}
    message = "" if front_points else "no feasible individual"
    ended = not algorithm.has_next()
    return Found(
        front_points,
        beaten=beaten,
        finished=ended,
        steps=tuple(steps),
        proof=proof,
        evaluations=clock.evaluations,
        message=message,
    )


def _algorithm(objectives: int, size: int) -> Any:
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.util.ref_dirs import get_reference_directions

    if objectives == 2:
        return NSGA2(pop_size=size)
    directions = get_reference_directions("das-dennis", objectives, n_partitions=PARTITIONS)
    return NSGA3(directions, pop_size=max(size, len(directions)))


def _checked(problem: Problem, points: list[Point]) -> tuple[Point, ...]:
    """Return the points that meet all limits by our own check."""
    return tuple(p for p in points if _excess(problem, p.x) <= FEASIBLE)


def _excess(problem: Problem, x: Array) -> float:
    return violation(problem, x, problem.batch(x[None]))[0]
