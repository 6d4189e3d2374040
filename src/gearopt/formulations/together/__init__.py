"""Sizes and layout at once: teeth, modules, face widths and link angles of the smallest gearbox.

The same limits as `teeth` and `layout` together, and a proven bound: no train, in no layout, has a
box that is smaller than the answer by more than its gap.
"""

import math
from fractions import Fraction
from functools import cache
from typing import Any

from gearopt.formulations import teeth
from gearopt.formulations.gear_train import FaceWidth, Stage, Train
from gearopt.formulations.layout.gearbox import Gearbox, Shaft
from gearopt.formulations.layout.slabs import Arrangement
from gearopt.formulations.strength.k_factor import K_FACTOR
from gearopt.formulations.teeth.search import search as sizing
from gearopt.formulations.together.continuous import angles_of, continuous
from gearopt.formulations.together.search import MARGINS, Search, keep, lay, prepare, prove
from gearopt.formulations.together.tables import Make, numbers
from gearopt.formulations.together.text import laid_out, pairs, point, slabs_of, text
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

__all__ = ["GAP", "angles_of", "continuous", "laid_out", "pairs", "problem", "ready"]

Start = tuple[tuple[GearPair, ...], Arrangement, Array]
GAP = 1e-3  # proven where the budget asks for none
FIRST = 40  # best sizings that are laid out before the search
SLACK = 1e-6  # relative: margins are this much below the gap asked for, for rounding

RANDOM = False
COUNTS = "tooth pair or cell of angles bounded"
SETTINGS = {"margins": MARGINS, "sizings laid out first": FIRST}


def problem(train: Train, make: Make, start: Start | None = None) -> Problem:
    """The problem of a drive and its gearbox; `exact` finds the smallest box with its bound.

    make(pairs) -> Gearbox of these gear pairs; shaft k may grow with the torque T1 u_1 ... u_k that
    it carries, and nothing else depends on the pairs. The objective is the
    gearbox's. Variables are those of `text.text`. start: a layout known before, which is kept
    unless a better one is found: gear pairs, arrangement and link angles.
    """
    box = numbers(train, make)[1]

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Depth-first passes with narrowing margins; the seed is that of first layouts."""
        ready()
        return _searched(Search(train, make, Clock(budget, watch), seed), start)

    return text(train, make, box, {"exact": exact})


@cache
def ready() -> None:
    """Have every kernel compiled, once on a machine, before a clock runs: by a tiny drive."""
    one = FaceWidth(Fraction(1), Fraction(1))
    stage = Stage((2.0, 48.0), one, (Fraction(2), Fraction(3)), (20, 22))
    train = Train(3e4, Fraction(9), Fraction(1, 50), (stage, stage), law=K_FACTOR)

    def make(pairs: tuple[GearPair, ...]) -> Gearbox:
        return Gearbox(pairs, (Shaft(5.0), Shaft(8.0), Shaft(12.0)))

    _searched(Search(train, make, Clock(Budget(gap=0.01)), 0), None)


def _searched(search: Search, start: Start | None) -> Outcome:
    drive, box = numbers(search.train, search.make)
    if start is not None:
        keep(search, *start)
    possible = _first(search)
    clock = search.clock
    wanted = (clock.budget.gap or GAP) * (1.0 - SLACK)
    margins = [m for m in MARGINS if m > wanted] + [wanted]
    while possible and margins and not clock.stopped:
        work = prepare(search, drive, box, wanted)
        while work is not None and margins and prove(search, work, margins[0]):
            clock.bound = max(clock.bound, search.value * (1.0 - margins.pop(0)))
            possible = search.best is not None
            if not possible:
                break
    return _outcome(search, slabs_of(box), possible)


def _first(search: Search) -> bool:
    """Lay out the best sizings; False if there is no train at all."""
    progress = sizing(search.train, FIRST, Budget(), search.clock.inner(values=False))
    for _, one in progress.found[:FIRST]:
        if search.clock.stopped:
            break
        lay(search, teeth.best_pairs(search.train, one), MARGINS[3])
    return bool(progress.found) or progress.clock.stopped


def _outcome(search: Search, known: tuple[Any, ...], possible: bool) -> Outcome:
    clock, stages = search.clock, len(search.train.stages)
    stopped = clock.stopped
    method = "branch and bound, stopped early" if stopped else "exhausted"
    proof = {
        "method": method,
        "arithmetic": "ratios, teeth and steps rational; boxes double, bounds with an allowance",
        "nodes": {f"{stages - k}": n for k, n in sorted(search.made.items())},
        "nodes_with_a_layout": {f"{stages - k}": n for k, n in sorted(search.left.items())},
        "trains_laid_out": search.trains,
        "sentence": f"Proof: {sum(search.made.values()):,} trains and parts of trains bounded, "
        f"{search.trains:,} laid out in full ({method}).",
    }
    if search.best is None:
        return Outcome(
            None,
            not stopped,
            infeasible=not stopped and not possible,
            proof=proof,
            evaluations=clock.evaluations,
            message="stopped before a layout was found" if stopped else "",
        )
    best = search.best
    x = point(search.train, best.pairs, known.index(best.slabs), len(known) > 1, best.angles)
    return Outcome(
        x,
        not stopped,
        bound=clock.bound if 0.0 < clock.bound < math.inf else None,
        proof=proof,
        evaluations=clock.evaluations,
    )
