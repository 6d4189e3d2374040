"""COBYQA of scipy: a local method without derivatives, by quadratic models of the points so far.

For texts that are only evaluated, such as a simulation. It works in the unit box of a sampler, with
limits as constraints; a point that has no value counts as the highest one so far.
"""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.box import Box, box
from gearopt.optimise.clock import Clock
from gearopt.optimise.evaluation import quiet
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Watch
from gearopt.optimise.terms import Array

FIRST, LAST = 0.1, 1e-8  # radius of its trust region, in a box of width 1
EVALUATIONS_PER_VARIABLE = 200  # where the budget names no end
MARGIN = 0.5 * FEASIBLE  # by which limits are held, so that rounding exceeds none
WORST = 1e30  # what an objective without a value counts as before any is known

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = False
COUNTS = "point evaluated"
SETTINGS = {"trust region": (FIRST, LAST)}


class _Over(Exception):
    """Budget or watcher ended the run; scipy lets it pass."""


class _Run:
    """The points of one run; it has state because scipy asks for terms of a point one by one.

    best, value, excess: the best point so far, its objective and largest violation.
    """

    def __init__(self, problem: Problem, space: Box, free: Any, unit: Array, clock: Clock):
        self.problem, self.space, self.free, self.clock = problem, space, free, clock
        self.unit, self.at, self.f, self.rows = unit, np.empty(0), np.nan, np.empty(0)
        self.best, self.value, self.excess = unit, np.inf, np.inf
        self.highest = -np.inf

    def see(self, u: Array) -> "_Run":
        """Evaluate a point (free variables, in the unit box), unless it is the last one."""
        if np.array_equal(u, self.at):
            return self
        if not self.clock.tell():
            raise _Over
        self.unit = self.unit.copy()
        self.unit[self.free] = u
        with np.errstate(all="ignore"):
            batch = self.problem.batch(self.space.points(self.unit[None]))
        f, rows = float(batch.F[0, 0]), np.concatenate([batch.G[0] - 1.0, batch.H[0] - 1.0])
        excess = float(max([0.0, *(batch.G[0] - 1.0), *np.abs(batch.H[0] - 1.0)]))
        self.at, self.rows = u.copy(), np.clip(np.nan_to_num(rows, nan=WORST), -WORST, WORST)
        self.clock.evaluations += 1
        if np.isfinite(f) and not np.isnan(rows).any():
            self.highest, self.f = max(self.highest, f), f
            if (max(excess, FEASIBLE), f) < (max(self.excess, FEASIBLE), self.value):
                self.best, self.value, self.excess = self.unit, f, excess
            if excess <= FEASIBLE:
                self.clock.best = min(self.clock.best, f)
        else:
            self.f = self.highest if np.isfinite(self.highest) else WORST
        return self


def run(
    problem: Problem, budget: Budget, seed: int, watch: Watch | None, start: Array | None = None
) -> Outcome:
    """Improve the guess (or the natural point `start`); SolveError for discrete variables."""
    clock, space = Clock(budget, watch), box(problem)
    lower, upper, guess = problem.bounds()
    for (variable, name), low, high in zip(problem.columns, lower, upper, strict=True):
        if variable.discrete and low < high:
            raise SolveError(f"cobyqa takes continuous variables only; {name} is discrete")
    free = np.flatnonzero(lower < upper)
    unit = space.unit(np.clip(guess if start is None else start, lower, upper)[None])[0]
    following = _Run(problem, space, free, unit, clock)
    try:
        _improve(following, budget.evaluations or EVALUATIONS_PER_VARIABLE * (len(free) + 1))
    except _Over:
        pass
    finished = not clock.stopped
    if not following.excess <= FEASIBLE:
        words = (
            "no point meets all limits; the smallest relative violation of the limits reached is "
            f"{100.0 * following.excess:.3g} %"
        )
        return Outcome(None, finished, evaluations=clock.evaluations, message=words)
    best = space.points(following.best[None])[0]
    return Outcome(best, finished, evaluations=clock.evaluations)


def _improve(following: _Run, most: int) -> None:
    """Run COBYQA from the first point, `most` evaluations."""
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    free = following.free
    following.see(following.unit[free])
    if not len(free):
        return
    inequal = np.arange(len(following.rows)) < len(following.problem.rows.inequalities)
    ends = np.where(inequal, -np.inf, 0.0), np.where(inequal, -MARGIN, 0.0)
    rows = NonlinearConstraint(lambda u: following.see(u).rows, *ends)
    with quiet():
        minimize(
            lambda u: following.see(u).f,
            following.unit[free],
            method="COBYQA",
            bounds=Bounds(np.zeros(len(free)), np.ones(len(free))),
            constraints=[rows] if len(inequal) else [],
            options={"maxfev": most, "initial_tr_radius": FIRST, "final_tr_radius": LAST},
        )
