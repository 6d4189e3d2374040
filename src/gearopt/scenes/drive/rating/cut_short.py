"""A search in whole teeth that its seconds cut short, with the bound of real-valued sizes."""

from collections.abc import Callable
from dataclasses import replace

from gearopt.formulations.drive import sizing, sizing_text
from gearopt.formulations.drive.train import Train
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.scenes.reading.ask import Ask

KEPT, SHARE = 2.0, 0.3  # seconds, and share of all, that are kept for the bound


def bounded(
    train: Train, ask: Ask, whole: Problem, sized: Callable[[Ask, Problem], Result], real: bool
) -> Result:
    """Return a drive that ratings alone limit, in whole teeth.

    Of a search that ends with its seconds, real-valued sizes are a part, and their bound holds: a
    share of the seconds is kept for them. whole: its problem; sized: solves a problem of the drive;
    real: whether the drive may have real-valued sizes.
    """
    seconds = ask.budget.seconds
    if seconds is None or not real or ask.method not in (None, "exact"):
        return sized(ask, whole)
    kept, clock = min(KEPT, SHARE * seconds), Clock(ask.budget)
    found = sized(replace(ask, budget=ask.budget.less(kept)), whole)
    if found.status != "limit" or clock.over:  # a first train takes what it takes
        return found
    alone = replace(sizing_text.exact_text(train), methods={"smooth": sizing.searched(train)})
    ideal = sized(Ask(None, Budget(kept), watch=ask.watch), alone)
    if found.value is None and ideal.status != "infeasible":
        found = replace(found, bound=ideal.bound)
    parts = (replace(ideal, name="sizing"),)
    return reconcile(replace(found, parts=parts), ideal, ask.gap)
