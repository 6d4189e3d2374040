"""The best train that is stiff enough and fits its box: a search in rounds, without a list.

A round looks at the trains with an objective between two values, and so keeps boxes of poor trains
from being judged at all.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.servo.servo_box import DEEP
from gearopt.formulations.servo.split.numbers import posed
from gearopt.formulations.servo.split.servo_train import ServoTrain
from gearopt.formulations.servo.split.teeth import point
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

KERNEL = "gearopt.formulations.servo.choice_kernel"
TEETH = "gearopt.formulations.servo.split.teeth_kernel"
FIRST_MARGIN = 1e-3  # by which the trains of the first round are worse than the best one, at most
WIDER = 8.0  # from one round to the next
LAST_ROUND = 10.0  # times the best one: the last round has no end
KERNEL_STEPS = 2_000, 2_000_000  # of the kernel between two checks of the clock: at first, maximum


class Kept(NamedTuple):
    """What a train keeps beside the limits of `split.problem`, as the kernel reads it.

    spring (5,): line stiffness of a mesh (0: by Lewis) and Young's modulus [MPa], face width [mm],
    compliance of the shaft [rad/(N mm)], minimum stiffness of the output [N mm/rad] (0: none). box:
    numbers of a `ServoBox` whose radii and links the kernel writes, its sides with the tie; boxed:
    whether there is one; motor: its radius [mm].
    """

    spring: Array
    box: Any
    boxed: bool
    motor: float


class Work(NamedTuple):
    """Where a search is.

    known, parts (first stages,): promises, nan where not computed, and the open parts of the
    quarter as bits, -1 where not known. at (4,): first stage, module and pinion teeth of the second
    one to go on from (-1: not entered), parts open to that module. cells, angles: of one box. found
    (6,): z1, z2, z3, z4 and module indices of the best train; ends (3,): objectives above the
    first, up to the second, and the least one found.
    """

    known: Array
    parts: Any
    at: Any
    cells: Array
    angles: Array
    found: Any
    ends: Array


def best_kept(
    train: ServoTrain, goal: str, kept: Kept, best: float, clock: Clock, some: bool = False
) -> Array | None:
    """Return the best train that keeps all, as a point of `split.problem`; None where none does.

    best: the minimum objective of all trains, > 0, about which the rounds of a box begin; inf: one
    round. some: any train that keeps all will do. TimeoutError, with a train as argument if one is
    known, when the clock stops it; SolveError where a box is not decided.
    """
    (given, aim), look = posed(train, goal), kernel(KERNEL).best_kept
    stages = kernel(TEETH).first_stages(given)[0]
    work = Work(
        known=np.full(stages, math.nan),
        parts=np.full(stages, -1),
        at=np.array([stages, -1, -1, 0]),
        cells=np.zeros((DEEP, 2)),
        angles=np.zeros(2),
        found=np.zeros(6, np.int64),
        ends=np.array([-math.inf, math.inf, math.inf]),
    )
    look(given, aim, kept, work, 0)  # compiled before the clock starts
    above, step = -math.inf, FIRST_MARGIN
    while True:
        most = best * (1.0 + step) if kept.boxed and step < LAST_ROUND else math.inf
        work.at[:], work.ends[:] = (0, -1, -1, 0), (above, most, math.inf)
        steps = KERNEL_STEPS[0]
        while work.at[0] < stages:
            looked, undecided = look(given, aim, kept, work, steps)
            if undecided:
                raise SolveError("whether a train fits its box is not decided by intervals")
            if some and math.isfinite(work.ends[2]):
                break
            clock.evaluations, steps = clock.evaluations + looked, min(2 * steps, KERNEL_STEPS[1])
            if not clock.tell() and work.at[0] < stages:
                there = math.isfinite(work.ends[2])
                raise TimeoutError(point(given, work.found) if there else None)
        if math.isfinite(work.ends[2]):
            return point(given, work.found)
        if math.isinf(most):
            return None
        above, step = most, WIDER * step
