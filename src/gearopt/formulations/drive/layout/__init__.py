"""The layout of a gearbox: where the shafts go, so that the box around the gears is smallest.

Centre distances are given, so a layout is one angle per link and the order of the slabs along the
shafts; distances are never penalised, because links are exact.
"""

import math
from functools import cache
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.drive.gearbox import Gearbox, Shaft
from gearopt.formulations.drive.layout import annealing, exact
from gearopt.formulations.drive.layout.chain import Chain, chain, turns
from gearopt.formulations.drive.layout.layout_text import direct, positions, sides, smooth
from gearopt.formulations.drive.layout.slabs import Arrangement, arrangements
from gearopt.optimise.box import violation
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

GRADIENT = ("ipopt", "multistart")  # methods that take the smooth text
POLISH_TOLERANCE = 1e-9  # what a polished layout may violate


def problem(
    box: Gearbox, method: str | None = None, orders: tuple[Arrangement, ...] = ()
) -> Problem:
    """Return the layout problem of a gearbox in the form for a method (by default `exact`).

    orders: arrangements to choose from; by default those of the box.
    Variables are those of `layout_text.direct` or `.smooth`. SolveError where the arrangement of
    slabs is open and the method cannot choose one.
    """
    orders = orders or arrangements(box)
    if method in (*GRADIENT, "sa-paper") and len(orders) > 1:
        known = "; ".join(str([list(s) for s in _counted(a)]) for a in orders[:4])
        raise SolveError(f"{method} takes one order of slabs, and {len(orders)} compete: {known}")
    if method in GRADIENT:
        return smooth(box, orders[0])
    goals = (box.objective, "width", "height") if method == "nsga2" else ()
    return direct(box, orders, _methods(box, orders), tuple(dict.fromkeys(goals)))


def ready(watch: Watch | None = None) -> bool:
    """Have the kernels compiled before a clock runs; False if the watcher ended that."""
    pair, shaft = GearPair.of_teeth(1.0, 6, 14, 5.0), Shaft(1.0)
    tiny = Gearbox((pair, pair), (shaft, shaft, shaft))
    return exact.ready(chain(tiny, arrangements(tiny)), watch)


def _counted(one: Arrangement) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(s + 1 for s in slab) for slab in one.slabs)


def _methods(box: Gearbox, orders: tuple[Arrangement, ...]) -> dict[str, Any]:
    shape = chain(box, orders)
    texts = cache(lambda m: smooth(box, orders[m]))
    plain = direct(box, orders, {})

    def polished(
        x: Array, budget: Budget | None = None, watch: Watch | None = None
    ) -> annealing.Polished:
        """A point no worse than x, by Ipopt from there, its value (inf: not feasible), the cost."""
        m = round(x[-1]) if len(orders) > 1 else 0
        return _polish(plain, texts(m), shape, x, budget or Budget(), watch)

    solvers: dict[str, Any] = {
        "exact": exact.method(shape, turns(box), lambda x: polished(x)[:2]),
        "sa": annealing.method(shape, free=False),
        "sa-polish": annealing.method(shape, free=False, polish=polished),
    }
    return solvers | ({} if len(orders) > 1 else {"sa-paper": annealing.method(shape, free=True)})


def _polish(
    plain: Problem, text: Problem, shape: Chain, x: Array, budget: Budget, watch: Watch | None
) -> annealing.Polished:
    """Polish a layout by Ipopt: a point no worse than x, its value (inf: not feasible), cost."""
    links = shape.link.size
    value, lack = (float(v[0]) for v in violation(plain, x[None]))
    box = sides(shape, *positions(shape, tuple(x[:links])))
    start = np.concatenate([x[:links], [box[n] for n in ("left", "bottom", "width", "height")]])
    if shape.longest:
        start = np.append(start, value)
    value = value if lack <= POLISH_TOLERANCE else math.inf
    ended = ipopt.run(text, budget, 0, watch, start=start)
    kept = annealing.Polished(x, value, ended.evaluations, ended.finished)
    if ended.x is None:
        return kept
    turned = np.remainder(ended.x[:links] + np.pi, 2 * np.pi) - np.pi
    moved = np.concatenate([turned, x[links:]])
    volume, excess = (float(v[0]) for v in violation(plain, moved[None]))
    better = excess <= POLISH_TOLERANCE and volume < value
    return kept._replace(x=moved, value=volume) if better else kept
