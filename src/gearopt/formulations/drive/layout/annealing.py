"""Methods `sa` (link angles), `sa-polish` (the same, then Ipopt) and `sa-paper` (positions)."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gearopt.formulations.drive.layout.chain import Chain
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel
from gearopt.optimise.polish import KEPT, sampling
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

ANNEAL = "gearopt.formulations.drive.layout.anneal_kernel"
RANDOM = True
PACED = True  # the cooling is stretched over the evaluations it is given
COUNTS = {
    "sa": "layout measured",
    "sa-polish": "layout measured or Ipopt iteration",
    "sa-paper": "layout measured",
}
ANGLES = {"moves": "one angle, normal", "temperatures": (0.03, 3e-5), "penalty": 2.0}
POSITIONS = {
    "moves": "one shaft in the plane, normal",
    "temperatures": (0.24, 2.4e-4),
    "penalty": 2.0,
    "penalty of a centre distance": 6.0,
    "repaired": "what lacks at most 0.3 mm of centre distance",
}
SETTINGS = {  # by method
    "sa": ANGLES,
    "sa-polish": {**ANGLES, "polished by": "ipopt, from the best point", **KEPT},
    "sa-paper": POSITIONS,
}
PAPER_EVALUATIONS = 128_701  # where the budget names no evaluations: what the paper reports
SLICE = 20_000  # steps between two checks of clock and watcher: some milliseconds

LOOKS = 100  # parts of a run at least, after each of which its best is reported

Goes = Callable[[int, float], bool]


class Polished(NamedTuple):
    """A polished point, its value, Ipopt's iterations, and whether Ipopt came to its own end."""

    x: Array
    value: float
    evaluations: int
    finished: bool


Polish = Callable[[Array, Budget, Watch | None], Polished]


def anneal(
    chain: Chain, seed: int, steps: int, goes: Goes, free: bool = False, looks: int = 1
) -> tuple[Array, int]:
    """Anneal; return best value, arrangement and angles (N + 2,), inf if none is feasible; steps.

    free: positions instead of angles, the paper's way. goes(steps, best): whether to continue; it
    is asked after SLICE steps, and `looks` times at least.
    """
    kernels = kernel(ANNEAL)
    links = chain.link.size
    best, state = np.full(links + 2, np.inf), np.zeros(4)
    theta, y, z = np.zeros(links), np.zeros(links + 1), np.zeros(links + 1)
    size = min(SLICE, max(1, -(-steps // looks)))
    for start in range(0, steps, size):
        stop = min(steps, start + size)
        stream = (seed * 1_000_003 + start // size) % 2**32  # a stream for every slice
        if free:
            kernels.anneal_positions(chain, stream, start, stop, steps, y, z, state, best)
        else:
            kernels.anneal(chain, stream, start, stop, steps, theta, state, best)
        if not goes(stop, float(best[0])):
            return best, stop
    return best, steps


def ready(chain: Chain, watch: Watch | None, free: bool = False) -> bool:
    """Have the kernel compiled, on its first use on a machine; False if the watcher ended that."""
    law = kernel(ANNEAL)
    entry = law.anneal_positions if free else law.anneal
    return compiled(lambda: anneal(chain, 0, 1, lambda *_: True, free), (entry,), watch)


def point(chain: Chain, found: Array) -> Array | None:
    """Point of the problem from the numbers that `anneal` found."""
    if not np.isfinite(found[0]):
        return None
    return np.append(found[2:], found[1]) if chain.factor.size > 1 else found[2:].copy()


def method(chain: Chain, free: bool, polish: Polish | None = None) -> Any:
    """Return a run(problem, budget, seed, watch); polish: a local method that keeps the point."""

    def run(problem: Any, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        if not ready(chain, watch, free):
            return Outcome(None, False, message=UNREADY)
        clock = Clock(budget, watch)
        sampler, maximum = sampling(clock, polish is not None)

        def goes(steps: int, best: float) -> bool:
            sampler.evaluations, sampler.best = steps, best
            return sampler.tell()

        steps = PAPER_EVALUATIONS if maximum is None else max(1, maximum)
        layout, steps_run = anneal(chain, seed, steps, goes, free, LOOKS)
        x = point(chain, layout)
        message = "" if x is not None else "no feasible layout was visited"
        outcome = Outcome(x, steps_run == steps, evaluations=steps_run, message=message)
        if x is None or polish is None or sampler.refused:
            return outcome
        clock.evaluations, clock.best = steps_run, sampler.best
        last = polish(x, clock.left, clock.inner())
        finished = outcome.finished and last.finished
        return replace(
            outcome, x=last.x, finished=finished, evaluations=steps_run + last.evaluations
        )

    return run
