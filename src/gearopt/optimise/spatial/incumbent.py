"""The best point of a search: judged by the text itself, sought by Ipopt with whole values held."""

import math
from dataclasses import field

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.box import allowed_values
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget
from gearopt.optimise.scale import unit, violation, zero_scale
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array

ITERATIONS = 200  # of Ipopt from one point
LOCAL = "what Ipopt reached from the guess"  # in the memo of a problem
SPARE = 0.9  # of the gap that is asked for; the rest is for rounding


@dataclass
class Incumbent:
    """The best feasible point so far, and the cutoff it gives; it has state because it improves.

    gap: relative, as the contract measures it, that is enough.
    """

    problem: Problem
    clock: Clock
    gap: float
    x: Array | None = None
    value: float = math.inf
    cutoff: float = math.inf
    tried: set[bytes] = field(default_factory=set)

    def judge(self, x: Array) -> float:
        """Value of a point by the text, inf where it is not feasible; kept where it is the best."""
        with np.errstate(all="ignore"):
            batch = self.problem.batch(x[None])
            excess, _ = violation(self.problem, x, batch)
        value = float(batch.F[0, 0])
        if not (excess <= FEASIBLE and math.isfinite(value)):
            return math.inf
        if value < self.value:
            self.x, self.value, self.clock.best = x.copy(), value, value
            enough = SPARE * self.gap * unit(value, zero_scale(self.problem, x))
            self.cutoff = value - enough
        return value

    def begin(self, guess: Array) -> None:
        """Judge the guess and what Ipopt reached from it, which a caller may have left as LOCAL."""
        known = self.problem.memo.get(LOCAL)
        if known is None:
            self.seek(guess)
        else:
            self.judge(np.clip(guess, *self.problem.bounds()[:2]))
            self.judge(known)

    def seek(self, x: Array) -> None:
        """Judge a point with its whole values rounded, and where Ipopt comes from there."""
        problem = self.problem
        lower, upper, _ = problem.bounds()
        x = np.clip(x, lower, upper)
        for j, (variable, _) in enumerate(problem.columns):
            if variable.values is not None:
                values = np.array(allowed_values(problem, j))
                x[j] = values[np.abs(values - x[j]).argmin()]
            elif variable.integer:
                x[j] = round(x[j])
        discrete = np.array([v.discrete for v, _ in problem.columns])
        if x.tobytes() in self.tried:
            return
        self.tried.add(x.tobytes())
        self.judge(x)
        if discrete.all():
            return
        try:
            effort = Budget(self.clock.left.seconds, ITERATIONS)
            outcome = ipopt.run(problem.holding(x), effort, 0, None, start=x)
        except SolveError:  # no derivatives at this text
            return
        if outcome.x is not None:
            self.judge(outcome.x)
