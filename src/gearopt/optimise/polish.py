"""The last step of a sampler: a local method from its best points, their discrete variables held.

Ipopt; for texts without derivatives that are run point by point, COBYQA, with most of the budget.

A sampler meets an equality or a limit only as nearly as its last steps are short; a local method
meets them to rounding. From the best point so reached, one discrete variable is moved to its next
value up or down, and solved again, as long as that helps. A part of the budget is kept for all
this, and what it takes counts. Ipopt may leave for a worse local optimum, so the best of the
sampler's point and these is the answer.
"""

import math
from dataclasses import replace

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.box import allowed_values, box
from gearopt.optimise.clock import Clock
from gearopt.optimise.deadline import until
from gearopt.optimise.evaluation import elementwise
from gearopt.optimise.failures import current
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome
from gearopt.optimise.scale import violation
from gearopt.optimise.solvers import cobyqa, ipopt
from gearopt.optimise.terms import Array

SHARE, MOST = 0.1, 500  # of a budget is kept; evaluations at the most
BLIND = 0.7  # of a budget is kept where the text has no derivatives
BLIND_PER_VARIABLE = 150  # evaluations at the most, where it has none
BLIND_VARIABLES = 30  # at the most: COBYQA's models grow with their square
APART = 0.2  # of the box: nearer starts lead to the same place
TRACED = 0.3  # of a budget at the most is for a tape; the sampler needs none
STARTS = 5  # points of the sampler to polish, of different discrete values
RUNS = 60  # of Ipopt at the most
ITERATIONS = 2000  # of all runs at the most, where the budget names no evaluations
KEPT = {"kept for it": f"{SHARE:.0%} of the budget, at most {MOST} evaluations"}
SETTINGS = {
    "polished by": "ipopt, discrete variables held; then with one at its next value",
    "points polished": f"{STARTS}, by at most {RUNS} runs and {ITERATIONS} iterations",
    **KEPT,
}


@dataclass(frozen=True)
class Polish:
    """A sampler's last step, and the clock of the whole run.

    skipped: why there is none, None where there is; "" goes unsaid. blind: the text has no
    derivatives, and why.
    """

    problem: Problem
    clock: Clock
    skipped: str | None
    blind: str = ""

    def sampling(self) -> tuple[Clock, int | None]:
        """Return the clock of the sampling, and the evaluations at which it ends (`sampling`)."""
        variables = len(self.problem.columns) if self.blind else 0
        clock, most = sampling(self.clock, self.skipped is None, variables)
        if clock.budget.seconds is not None:
            current().end = clock.start + clock.budget.seconds
        return clock, most


def sampling(clock: Clock, polished: bool, blind: int = 0) -> tuple[Clock, int | None]:
    """Return the clock of the sampling in a run, and the evaluations at which it ends.

    polished: a polish follows, for which a part of the run's budget is kept. blind: the number of
    variables of a text without derivatives.
    """
    seconds, most = clock.budget.seconds, clock.budget.evaluations
    if polished:
        share, kept = (BLIND, BLIND_PER_VARIABLE * (blind + 1)) if blind else (SHARE, MOST)
        seconds = None if seconds is None else (1.0 - share) * seconds
        most = None if most is None else most - min(kept, int(share * most))
    return Clock(Budget(seconds), clock.watch, clock.start), most


def prepared(problem: Problem, clock: Clock) -> Polish:
    """Return the polish of a run: the text is traced here, within a part of its budget."""
    left = clock.left.seconds
    with until(None if left is None else TRACED * left):
        return _prepared(problem, clock)


def _prepared(problem: Problem, clock: Clock) -> Polish:
    """Return the polish of a run, which traces the text."""
    lower, upper, guess = problem.bounds()
    variables = [v for v, _ in problem.columns]
    free = [not v.discrete and a < b for v, a, b in zip(variables, lower, upper, strict=True)]
    if not any(free) or len(problem.rows.objectives) > 1:
        return Polish(problem, clock, "")
    try:
        form(problem.holding(guess))
    except SolveError as refusal:
        together = problem.vectorised or elementwise(problem, None)
        if together or sum(free) > BLIND_VARIABLES:  # where a point costs as much as a population
            return Polish(problem, clock, f"not polished: {refusal}")
        return Polish(problem, clock, None, f"polished by cobyqa: {refusal}")
    return Polish(problem, clock, None)


def polished(polish: Polish, sampled: Outcome, starts: Array) -> Outcome:
    """Return the sampler's outcome, or a better one of a local method from `starts` (N, n).

    starts: in order of promise; the first of each choice of discrete values counts, and the
    sampler's own point. The iterations that are planned are its own end; clock and watcher are not.
    """
    problem, most = polish.problem, polish.clock.budget.evaluations
    if polish.skipped is not None:
        return replace(sampled, message=sampled.message or polish.skipped)
    if polish.clock.budget.seconds is not None:
        current().end = polish.clock.start + polish.clock.budget.seconds
    sampled = replace(sampled, message=sampled.message or polish.blind)
    best, least, done = sampled, _value(problem, sampled.x), True
    planned = ITERATIONS if most is None else most - sampled.evaluations
    spent = runs = 0
    polish.clock.evaluations, polish.clock.best = sampled.evaluations, least
    waiting, tried = _chosen(polish, sampled.x, starts), set[tuple[float, ...]]()
    while waiting and done and runs < RUNS and spent < planned:
        start = waiting.pop(0)
        tried.add(_choice(problem, start))
        outcome = _solved(polish, start, planned - spent)
        runs, spent = runs + 1, spent + outcome.evaluations
        polish.clock.evaluations = sampled.evaluations + spent
        done = outcome.finished or spent >= planned
        value = _value(problem, outcome.x)
        if value < least:
            best, least = replace(outcome, message=polish.blind), value
        if not waiting and best.x is not None:
            waiting = [x for x in _beside(problem, best.x) if _choice(problem, x) not in tried]
    return replace(
        best,
        finished=sampled.finished and done,
        evaluations=sampled.evaluations + spent,
        infeasible=False,
    )


def _choice(problem: Problem, x: Array) -> tuple[float, ...]:
    """Return the discrete values of a point."""
    return tuple(float(a) for a, (v, _) in zip(x, problem.columns, strict=True) if v.discrete)


def _chosen(polish: Polish, best: Array | None, starts: Array) -> list[Array]:
    """Return the best point, and the starts that differ from one another in a discrete value.

    Without derivatives the best point comes first, and starts far from one another count, too.
    """
    problem, every = polish.problem, [] if best is None else [best]
    if polish.blind:
        space, apart = box(problem), list[Array]()
        for x in [*every, *starts]:
            unit, choice = space.unit(x[None])[0], _choice(problem, x)
            near = (np.abs(space.unit(y[None])[0] - unit).max() <= APART for y in apart)
            if not any(
                _choice(problem, y) == choice and n for y, n in zip(apart, near, strict=True)
            ):
                apart.append(x)
        return apart[:STARTS]
    firsts: dict[tuple[float, ...], Array] = {}
    for x in starts:
        firsts.setdefault(_choice(problem, x), x)
    return [*list(firsts.values())[:STARTS], *every]


def _beside(problem: Problem, x: Array) -> list[Array]:
    """Return the points with one discrete variable at its next value up or down."""
    neighbours = []
    for k in np.flatnonzero([v.discrete for v, _ in problem.columns]):
        given = allowed_values(problem, int(k))
        value = int(x[k]) if isinstance(given, range) else float(x[k])  # of floats all are asked
        at = given.index(value)
        for place in (at - 1, at + 1):
            if 0 <= place <= given.index(given[-1]):
                neighbours.append(x.copy())
                neighbours[-1][k] = given[place]
    return neighbours


def _solved(polish: Polish, start: Array, most: int) -> Outcome:
    """Run the local method from a start, `most` steps; nothing, unfinished, without time left."""
    left = replace(polish.clock.left, evaluations=most)
    if left.seconds == 0.0:
        return Outcome(None, finished=False)
    held = polish.problem.holding(start)
    method = cobyqa if polish.blind else ipopt
    outcome: Outcome = method.run(held, left, 0, polish.clock.inner(), start=start)
    return outcome


def _value(problem: Problem, x: Array | None) -> float:
    """Return the objective of a point by the certificate's measure; inf: not feasible."""
    if x is None:
        return math.inf
    with np.errstate(all="ignore"):
        batch = problem.batch(x[None])
        excess, _ = violation(problem, x, batch)
    value = float(batch.F[0, 0])
    return value if excess <= FEASIBLE and math.isfinite(value) else math.inf
