"""Whether a gearbox can be laid out at all."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.layout.annealing import anneal
from gearopt.formulations.layout.chain import chain, turns
from gearopt.formulations.layout.exact import DEEP, NODES
from gearopt.formulations.layout.faults import faults
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.layout.slabs import arrangements
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget, Watch

STEPS, STARTS = 5_000, 4  # short runs of annealing: most layouts that exist are found by these


def possible(box: Gearbox, seconds: float, watch: Watch | None = None) -> bool | None:
    """Whether there is a layout; None where that is not known in time.

    True with a layout in hand, False because distances clash or every cell of angles is excluded.
    """
    orders, clock = arrangements(box), Clock(Budget(seconds), watch)
    if faults(box):
        return False
    shape = chain(box, orders)

    def goes(steps: int, best: float) -> bool:
        return math.isinf(best)

    if any(np.isfinite(anneal(shape, k, STEPS, goes)[0][0]) for k in range(STARTS)):
        return True
    kernels: Any = kernel("gearopt.formulations.layout.branch_kernel")
    links = shape.link.size
    cells, bounds, theta = np.zeros((DEEP, 2, links)), np.zeros(DEEP), np.zeros(links)
    for m in range(len(orders)):
        cells[0, 0], cells[0, 1] = -math.pi, math.pi
        cells[0, :, 0] = turns(box)
        bounds[0], count, floor = 0.0, 1, math.inf
        while count:
            state = (count, math.inf, floor)
            count, best, floor, fresh, _ = kernels.branch(
                shape, m, cells, bounds, *state, 0.5, NODES, theta
            )
            clock.evaluations += fresh
            if math.isfinite(best):
                return True
            if not clock.tell():
                return None
        if math.isfinite(floor):  # a cell was left undecided
            return None
    return False
