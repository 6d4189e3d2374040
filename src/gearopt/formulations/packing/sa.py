"""Simulated annealing of packings: the kernel in slices of time, and `sa`, one long run of it.

`hop` anneals shortly between its local solutions.
"""

import math
from collections.abc import Callable
from dataclasses import field
from functools import cache
from typing import Any

import numpy as np

from gearopt.formulations.packing.container_bound import Bound, Late
from gearopt.formulations.packing.packing_text import point
from gearopt.formulations.packing.plan import Places, Plan, row
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.packing.anneal_kernel"
SLICE = 100_000  # moves times cylinders of one call: some hundredths of a second
LOOKS = 100  # parts of a long annealing run, after each of which its best so far is reported
SHARE = 0.2  # of the seconds of a run may go into its bound
LOOK = 0.05  # seconds between two questions to the watcher while the bound is computed
CODES = {"rectangle": 0, "square": 1, "circle": 2}
MOVES = 300_000  # for each cylinder, where the budget names no evaluations
HOT, COLD = 0.3, 1e-6  # temperatures, in units of the objective's logarithm

RANDOM = True
PACED = True  # the cooling is stretched over the evaluations it is given
COUNTS = "annealing move"
SETTINGS = {"temperatures": (HOT, COLD), "moves per cylinder, by default": MOVES}


@dataclass
class Spent:
    """Effort and best packing of a search; it has state because the search fills it.

    clock: has the count of moves, the best objective and its lower bound. x: the best
    point of `direct`.
    """

    clock: Clock
    x: Array = field(default_factory=lambda: np.empty(0))

    def keep(self, value: float, x: Array) -> None:
        """Remember a packing that meets all limits, if it is the best."""
        if value < self.clock.best:
            self.clock.best, self.x = value, x

    def late(self) -> Late:
        """Return the test whether the bound has used its share of time or the search is over."""
        seconds = self.clock.budget.seconds
        return lateness(self.clock, None if seconds is None else SHARE * seconds)

    def close(self, gap: float) -> bool:
        """Return whether the best value is within a relative gap of the bound."""
        best, gap = self.clock.best, max(gap, self.clock.budget.gap)
        return best - self.clock.bound <= gap * abs(best)


def lateness(clock: Clock, seconds: float | None) -> Late:
    """Return the test whether a clock is past some seconds or, asked every LOOK s, is over."""
    last, over = -math.inf, False

    def late() -> bool:
        nonlocal last, over
        now = clock.seconds
        over = over or (seconds is not None and now > seconds)
        if not over and now - last > LOOK:
            last, over = now, not clock.tell()
        return over

    return late


Floor = Callable[[Problem, Spent], Bound]
Finish = Callable[[Outcome, Spent, Bound], Outcome]  # the outcome with bound and proof


def ready(watch: Watch | None = None) -> bool:
    """Have the kernel compiled before a clock runs; False if the watcher ended that."""
    return compiled(_one_disc, (kernel(KERNEL).anneal,), watch)


@cache
def _one_disc() -> None:
    """Call the kernel for no move of a disc."""
    x, y, radius, height = np.zeros(1), np.zeros(1), np.ones(1), np.ones(1)
    layer, free = np.ones(1, np.int64), np.zeros(1, np.int64)
    plain = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    best = np.append(np.zeros(5), np.inf)
    kernel(KERNEL).anneal(
        0, 0, 1, 1, 1.0, 0.1, x, y, layer, np.zeros(2), radius, height, free, plain, best
    )


def numbers(plan: Plan, max_layers: int) -> Array:
    """Return the scalars of the kernel, for up to max_layers layers."""
    code = 3 if plan.width is not None else CODES[plan.shape]
    volume = float(plan.objective == "volume")
    anchored, minimum = float(bool(plan.fixed)), plan.filled if plan.filled > 1 else 0
    return np.array(
        [plan.gap, plan.wall, plan.width or 0.0, code, volume, minimum, max_layers, anchored]
    )


def held(plan: Plan) -> Any:
    """Fixed properties of each cylinder: 1 its place, 2 its layer."""
    free_layers = set(plan.free_layers)
    return np.array(
        [(c.at is not None) + 2 * (k not in free_layers) for k, c in enumerate(plan.cylinders)],
        dtype=np.int64,
    )


def scattered(plan: Plan, max_layers: int, rng: np.random.Generator) -> Places:
    """Place the free cylinders at random in max_layers layers on 4/pi times their discs' area."""
    first = row(plan)
    area = 4.0 * float(((plan.radius + 0.5 * plan.gap) ** 2).sum()) / max_layers
    across, low, near = math.sqrt(area), 0.0, 0.0
    along = across
    if plan.fixed:
        low, high, near, far = plan.held_box
        across, along = max(across, high - low), max(along, far - near)
    if plan.width is not None:
        across, along = min(across, plan.width), area / min(across, plan.width)
    x, y, layer = first.x.copy(), first.y.copy(), first.layer.copy()
    free, free_layers = list(plan.free), list(plan.free_layers)
    x[free] = low + across * rng.random(len(free))
    y[free] = near + along * rng.random(len(free))
    layer[free_layers] = rng.integers(1, max_layers + 1, len(free_layers))
    centre = np.zeros(2)
    if plan.shape == "circle":
        middle = np.array([low + 0.5 * across, near + 0.5 * along])
        if plan.fixed:
            centre = middle
        else:
            x, y = x - middle[0], y - middle[1]
    return Places(x, y, layer, centre)


def anneal(
    plan: Plan,
    problem: Problem,
    begin: Places,
    max_layers: int,
    moves: int,
    temperatures: tuple[float, float],
    rng: np.random.Generator,
    spent: Spent,
    looks: int = 1,
) -> Places:
    """Anneal from a packing and return the last state; keep the best feasible one in `spent`.

    max_layers: of this run. moves: of the whole run, which the budget may stop early.
    looks: parts of it, after each of which the best is reported.
    """
    anneal_slice = kernel(KERNEL).anneal
    n = len(plan.radius)
    x, y, layer, centre = begin.copied()
    best = np.append(np.zeros(3 * n + 2), np.inf)
    size = max(1, min(SLICE // n, -(-moves // looks)))
    done, best_value = 0, spent.clock.best
    while done < moves:
        last = min(moves, done + size)
        seed = int(rng.integers(2**31))
        anneal_slice(
            seed, done, last, moves, *temperatures, x, y, layer, centre,
            plan.radius, plan.height, held(plan), numbers(plan, max_layers), best,
        )  # fmt: skip
        spent.clock.evaluations += last - done
        done = last
        if best[-1] < best_value:
            levels, best_value = best[2 * n : 3 * n].astype(np.int64), float(best[-1])
            best_point = point(plan, Places(best[:n], best[n : 2 * n], levels, best[3 * n : -1]))
            spent.keep(float(problem.batch(best_point[None]).F[0, 0]), best_point)
        if done < moves and not spent.clock.tell():
            break
    return Places(x, y, layer, centre)


def begun(plan: Plan, problem: Problem, clock: Clock, floor: Floor) -> tuple[Spent, Bound]:
    """A search that knows the packing of all cylinders in a row, and the bound of all."""
    spent, first = Spent(clock), point(plan, row(plan))
    spent.keep(float(problem.batch(first[None]).F[0, 0]), first)
    lower = floor(problem, spent)
    clock.bound = lower.value
    return spent, lower


def method(plan: Plan, floor: Floor, finish: Finish) -> Any:
    """Return the run of `sa` for a plan; `finish` adds bound and proof."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Anneal once; keep the best feasible state, or else all cylinders in a row."""
        if not ready(watch):
            return Outcome(None, False, message=UNREADY)
        clock, rng = Clock(budget, watch), np.random.default_rng(seed)
        spent, lower = begun(plan, problem, clock, floor)
        asked = budget.evaluations
        moves = MOVES * len(plan.radius) if asked is None else asked
        begin = scattered(plan, plan.max_layers, rng)
        if clock.tell():
            anneal(plan, problem, begin, plan.max_layers, moves, (HOT, COLD), rng, spent, LOOKS)
        outcome = Outcome(spent.x, not clock.stopped, evaluations=clock.evaluations)
        return finish(outcome, spent, lower)

    return run
