"""COBYQA of scipy: a local method without derivatives, by quadratic models of the points so far.

For texts that are only evaluated, such as a simulation. It works in the unit box of a sampler, with
limits as constraints; a point that has no value counts as the highest one so far. Where it ends
before its budget does, it begins again from its best point, with a new model.
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
AGAIN = 3  # runs at most, each from the best point of those before
GAINED = 1e-6  # of the objective: a run that gains less is the last
MARGIN = 0.5 * FEASIBLE  # by which limits are held, so that rounding exceeds none
WORST = 1e30  # what an objective without a value counts as before any is known

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = False
COUNTS = "point evaluated"
SETTINGS = {"trust region": (FIRST, LAST), "runs": AGAIN}


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

    def see(self, u: Array) -> None:
        """Evaluate a point (free variables, in the unit box), unless it is the last one."""
        if np.array_equal(u, self.at):
            return
        if not self.clock.tell():
            raise _Over
        self.unit = self.unit.copy()
        self.unit[self.free] = u
        with np.errstate(all="ignore"):
            batch = self.problem.batch(self.space.points(self.unit[None]))
        f, count = float(batch.F[0, 0]), batch.G.shape[1]
        rows = np.concatenate([batch.G[0] - 1.0, batch.H[0] - 1.0])
        excess = float(max([0.0, *rows[:count], *np.abs(rows[count:])]))
        self.at, self.rows = u.copy(), np.clip(np.nan_to_num(rows, nan=WORST), -WORST, WORST)
        self.clock.evaluations += 1
        if np.isfinite(f) and not np.isnan(rows).any():
            self.highest, self.f = max(self.highest, f), f
            if max(excess, FEASIBLE) < max(self.excess, FEASIBLE) or (
                excess <= max(self.excess, FEASIBLE) and f < self.value
            ):
                self.best, self.value, self.excess = self.unit, f, excess
            if excess <= FEASIBLE:
                self.clock.best = min(self.clock.best, f)
        else:
            self.f = self.highest if np.isfinite(self.highest) else WORST


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
        words = f"no point meets all limits; the least violation is {following.excess:.3g}"
        return Outcome(None, finished, evaluations=clock.evaluations, message=words)
    best = space.points(following.best[None])[0]
    return Outcome(best, finished, evaluations=clock.evaluations)


def _improve(following: _Run, most: int) -> None:
    """Run COBYQA until it gains nothing more, within `most` evaluations."""
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    free = following.free
    following.see(following.unit[free])
    if not len(free):
        return
    count = len(following.problem.rows.inequalities)
    ends = np.where(np.arange(len(following.rows)) < count, -np.inf, 0.0)

    def objective(u: Array) -> float:
        following.see(u)
        return following.f

    def rows(u: Array) -> Array:
        following.see(u)
        return following.rows

    tops = np.where(np.isinf(ends), -MARGIN, 0.0)
    limits = [NonlinearConstraint(rows, ends, tops)] if len(ends) else []
    radius = FIRST
    for _ in range(AGAIN):
        before, left = following.value, most - following.clock.evaluations
        if left <= len(free) + 2:
            return
        with quiet():
            minimize(
                objective,
                following.best[free],
                method="COBYQA",
                bounds=Bounds(np.zeros(len(free)), np.ones(len(free))),
                constraints=limits,
                options={
                    "maxfev": left,
                    "initial_tr_radius": radius,
                    "final_tr_radius": LAST,
                },
            )
        if not following.value < before - GAINED * abs(before) and np.isfinite(before):
            return
        radius = max(0.1 * radius, 100.0 * LAST)
