"""Several objectives of a box at once, and each of them alone under limits on its sides.

Sides of a box do not add over stages, so a front is made of epsilon steps: each is a layout of its
own, with a largest width, height or length, proven by the search of `exact`.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.gearbox import OBJECTIVES, SIDES, Gearbox
from gearopt.formulations.drive.layout.layout_text import direct
from gearopt.formulations.drive.layout.slabs import Arrangement, arrangements
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch

GOALS = OBJECTIVES | SIDES


def problem(box: Gearbox, names: tuple[str, ...]) -> Problem:
    """Return the layout problem with several objectives of `GOALS`, for samplers."""
    return direct(box, arrangements(box), {}, names)


def limited(box: Gearbox, name: str, most: Mapping[str, float]) -> Problem:
    """Return the layout problem of one objective with largest sides [mm]; its `exact` proves it."""
    ends = zip(SIDES, box.largest, strict=True)
    largest = tuple(min(end, most.get(side, math.inf)) for side, end in ends)
    held = replace(box, largest=(largest[0], largest[1], largest[2]))
    orders = arrangements(box)
    if name != "length":
        return layout.problem(replace(held, objective=name), orders=orders)
    text = direct(held, orders, {}, (name,))
    return replace(text, methods={"exact": lambda *run: _shortest(held, orders, *run[1:])})


def _shortest(
    box: Gearbox,
    orders: tuple[Arrangement, ...],
    budget: Budget,
    seed: int,
    watch: Watch | None,
) -> Outcome:
    """Return the shortest arrangement of slabs that has a layout: shorter ones have none."""
    spent, outcome = 0, Outcome(None, infeasible=True)
    for length in sorted({one.length for one in orders}):
        held = replace(box, objective="height", largest=(*box.largest[:2], length))
        posed = layout.problem(held, orders=orders)
        outcome = posed.methods["exact"](posed, budget.less(0.0, spent), seed, watch)
        spent += outcome.evaluations
        if not outcome.infeasible:
            break
    bound: Any = length if outcome.x is not None and outcome.finished else None
    return replace(outcome, bound=bound, evaluations=spent)
