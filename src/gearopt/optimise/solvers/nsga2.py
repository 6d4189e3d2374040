"""NSGA-II of pymoo on whole populations (`Problem.batch`), integers and finite sets included.

One objective is searched like several: the answer is the best feasible individual in the first
objective, polished (`polish`); where there are several, the rest of the Pareto front comes with it,
and nothing is polished.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.optimise import polish
from gearopt.optimise.box import Box, box
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch

POPULATION = 100
GENERATIONS = 300  # where the budget names no evaluations; within seconds again, twice as many
EQUAL = 1e-6  # an equality counts as met within this, before the polish

RANDOM = True
PACED = True  # its generations are those that its evaluations pay for
COUNTS = "point evaluated or Ipopt iteration"
SETTINGS = {
    "population": POPULATION,
    "crossover and mutation": "simulated binary, polynomial; pymoo's defaults",
    "equalities within": EQUAL,
    **polish.SETTINGS,
}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Evolve a population of POPULATION; the best feasible one of the last is polished."""
    from pymoo.algorithms.moo.nsga2 import NSGA2

    clock, space = Clock(budget, watch), box(problem)
    last = polish.prepared(problem, clock)
    sampling, most = last.sampling()
    size = min(POPULATION, most or POPULATION)
    several = len(problem.rows.objectives) > 1
    timed = most is None and sampling.budget.seconds is not None and not several
    generations = GENERATIONS if most is None else most // size
    algorithm, evolved, spent = None, Outcome(None, False), 0
    while algorithm is None or (timed and not sampling.stopped):  # again until the seconds end
        algorithm = NSGA2(pop_size=size)
        ending = ("n_gen", max(1, generations))
        algorithm.setup(posed(problem, space), seed=seed, termination=ending)
        least = sampling.best
        while algorithm.has_next() and not sampling.stopped:
            algorithm.next()
            sampling.evaluations = spent + int(algorithm.evaluator.n_eval)
            best = min((float(one.F[0]) for one in algorithm.opt if one.feas), default=math.inf)
            sampling.best = min(sampling.best, best)
            sampling.tell()
        ended = not algorithm.has_next()
        if evolved.x is None or sampling.best < least:
            evolved = _front(algorithm, space, several, ended or evolved.finished)
        seed, size, spent = seed + 1, 2 * size, sampling.evaluations
    evolved = replace(evolved, evaluations=spent)
    everyone = sorted(algorithm.pop, key=lambda one: (float(one.CV[0]), float(one.F[0])))
    starts = space.points(np.array([one.X for one in everyone]))
    return polish.polished(last, evolved, starts) if not sampling.refused else evolved


def posed(problem: Problem, space: Box) -> Any:
    """Return our batch as pymoo asks for it: F, G <= 0, with equalities as a pair of bounds."""
    from pymoo.core.problem import Problem as PymooProblem

    rows = problem.rows

    class Batch(PymooProblem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(
                n_var=len(space.low),
                n_obj=len(rows.objectives),
                n_ieq_constr=len(rows.inequalities) + len(rows.equalities),
                xl=0.0,
                xu=1.0,
            )

        def _evaluate(self, unit: Any, out: dict[str, Any], *rest: Any, **more: Any) -> None:
            with np.errstate(all="ignore"):
                terms = problem.batch(space.points(unit))
            equal = np.abs(terms.H - 1.0) - EQUAL
            out["F"], out["G"] = (
                np.nan_to_num(values, nan=1e300, posinf=1e300, neginf=1e300)
                for values in (terms.F, np.hstack([terms.G - 1.0, equal]))
            )

    return Batch()


def _front(algorithm: Any, space: Box, several: bool, finished: bool) -> Outcome:
    """Return the best feasible individual of the first objective; of several, the others too."""
    good = [one for one in algorithm.opt if one.feas]
    if not good:
        return Outcome(None, finished, message="no feasible individual")
    front = sorted(good, key=lambda one: float(one.F[0]))
    points = [space.points(one.X[None])[0] for one in front]
    return Outcome(points[0], finished, others=tuple(points[1:]) if several else ())
