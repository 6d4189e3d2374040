"""Packing: cylinders with upright axes in layers, in the smallest container.

`problem` is the packing for samplers, with two methods of its own (`hop`, `sa`) that add the
computed bound; `packing_text.smooth` is the same packing for gradient methods.
"""

from dataclasses import replace
from typing import Any

from gearopt.formulations.packing import hop, sa
from gearopt.formulations.packing.container_bound import Bound, bound
from gearopt.formulations.packing.packing_text import direct
from gearopt.formulations.packing.plan import Plan
from gearopt.formulations.packing.sa import Spent
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome

CERTAIN = 1e-6  # relative gap to the bound within which a packing counts as proven


def problem(plan: Plan, loose: bool = True) -> Problem:
    """Return the packing of a plan: places of the free cylinders [mm] and their free layers.

    loose: methods also claim a bound that does not prove their packing. A comparison must not, as
    it measures gaps to the best bound: a distant one hides the differences between methods.
    """

    def floor(packing: Problem, spent: Spent) -> Bound:
        lower: Bound = packing.memo.get("bound") or bound(plan, spent.late())
        if lower.complete:
            packing.memo["bound"] = lower
        return lower

    def finish(outcome: Outcome, spent: Spent, floor: Bound) -> Outcome:
        near = spent.clock.best - floor.value <= CERTAIN * spent.clock.best
        if not loose and not near:
            return outcome
        return replace(outcome, bound=floor.value, proof=proof(floor, near))

    methods = {"hop": hop.method(plan, floor, finish), "sa": sa.method(plan, floor, finish)}
    return direct(plan, **methods)


def proof(floor: Bound, near: bool = False) -> dict[str, Any]:
    """Return how a bound was proven, for a result; near: it proves the packing as it is."""
    method = "subdivision" if floor.choices else "volume"
    ways = f"each of the {floor.choices:,} ways" if floor.choices > 1 else "the one way"
    words = (
        f"Lower bound: for {ways} to assign the cylinders to layers, the plan area that discs, "
        "pairs and triples of them need in any order was bounded by subdivision of the width."
    )
    if not floor.complete and not near:
        words += " Stopped early: the bound is weaker than it could be."
    if floor.complete and not floor.choices:
        words = "Lower bound: the volume of the cylinders, and the widest with the highest of them."
    return {
        "method": method if floor.complete else f"{method}, stopped early",
        "arithmetic": "double, with a rounding allowance",
        "ways_to_share_out": floor.choices,
        "sentence": words,
    }
