"""Methods `sa` (link angles), `sa-polish` (the same, then Ipopt) and `sa-paper` (positions)."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.layout.chain import Chain
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Array

RANDOM = True
PACED = True  # the cooling is stretched over the evaluations it is given
COUNTS = "layout measured"
SETTINGS = {"moves": "one angle, normal", "temperatures": (0.03, 3e-5), "penalty": 2.0}
STEPS = 128_701  # where the budget names no evaluations: what the paper reports
SLICE = 20_000  # steps between two looks at clock and watcher: some milliseconds

Goes = Callable[[int, float], bool]


def anneal(
    chain: Chain, seed: int, steps: int, goes: Goes, free: bool = False
) -> tuple[Array, int]:
    """Anneal; best value, arrangement and angles (N + 2,), inf if none is feasible, and steps made.

    free: positions instead of angles, the paper's way. goes(steps, best): whether to go on.
    """
    kernels = kernel("gearopt.formulations.layout.anneal_kernel")
    links = chain.link.size
    found, state = np.full(links + 2, np.inf), np.zeros(4)
    theta, y, z = np.zeros(links), np.zeros(links + 1), np.zeros(links + 1)
    for start in range(0, steps, SLICE):
        stop = min(steps, start + SLICE)
        own = (seed * 1_000_003 + start // SLICE) % 2**32  # a stream for every slice
        if free:
            kernels.anneal_positions(chain, own, start, stop, steps, y, z, state, found)
        else:
            kernels.anneal(chain, own, start, stop, steps, theta, state, found)
        if not goes(stop, float(found[0])):
            return found, stop
    return found, steps


def point(chain: Chain, found: Array) -> Array | None:
    """The problem's point of what `anneal` found."""
    if not np.isfinite(found[0]):
        return None
    return np.append(found[2:], found[1]) if chain.factor.size > 1 else found[2:].copy()


def method(chain: Chain, free: bool, polish: Callable[[Array], Array] | None = None) -> Any:
    """A run(problem, budget, seed, watch); polish(point): a local method that keeps the point."""

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        clock = time.perf_counter()

        def goes(steps: int, best: float) -> bool:
            seconds = time.perf_counter() - clock
            event = Event(seconds, steps, best if np.isfinite(best) else None)
            late = budget.seconds is not None and seconds > budget.seconds
            return not late and (watch is None or watch(event) is not False)

        steps = budget.evaluations or STEPS
        found, made = anneal(chain, seed, steps, goes, free)
        x = point(chain, found)
        message = "" if x is not None else "no feasible layout was visited"
        if x is not None and polish is not None:
            x = polish(x)
        return Outcome(x, made == steps, evaluations=made, message=message)

    return run
