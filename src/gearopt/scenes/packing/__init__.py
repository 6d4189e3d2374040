"""kind = "packing": cylinders with parallel axes in the smallest container, in one or more layers.

Places are searched by annealing and Ipopt; the bound is computed, and proves the packing where it
is met.
"""

import math
from dataclasses import replace

from gearopt.formulations import packing
from gearopt.formulations.packing import text
from gearopt.formulations.packing.container_bound import bound
from gearopt.formulations.packing.design import describe
from gearopt.formulations.packing.plan import Places, Plan
from gearopt.formulations.packing.sa import lateness, ready
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.comparing.compare import Model
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.solve import run, solve_within
from gearopt.optimise.typed import untyped
from gearopt.scenes.explaining.default import at_point, eases, priced
from gearopt.scenes.packing.scene import EXAMPLE, Scene
from gearopt.scenes.reading.ask import Ask

__all__ = ["EXAMPLE", "Scene", "compared", "explain", "model", "solve"]
SMOOTH = ("ipopt", "multistart")  # methods that need derivatives
MOMENT = 0.1  # seconds for a bound after a run that has spent all of its time
ASSUMED = (
    "Cylinders are rigid, upright and of their nominal size; they may touch each other and walls."
)
UNTRIED = (
    "the packing is followed as its numbers change; whole numbers are not tried, because it is not "
    "proven to be the best"
)
UNPROVEN = "Best known, not proven: a smaller packing may exist, but none below the bound."


def solve(scene: Scene, ask: Ask) -> Result:
    """Pack the cylinders; a method that brings no bound is held against the same one."""
    return _solved(scene, ask)[0]


def _solved(scene: Scene, ask: Ask) -> tuple[Result, Places | None]:
    """The result with the places of its cylinders."""
    plan = scene.plan()
    problem = _problem(plan, ask.method)
    watch = in_part(ask.watch, plan.unit())
    if ask.method in (None, *problem.methods):
        ready()
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": plan.unit()})
    if result.value is None or outcome.x is None:
        return result, None
    if result.bound is None:
        result = _bounded(plan, result, replace(ask, watch=watch))
    report = {"assumptions": [ASSUMED]}
    if result.status != "optimal":
        report["notes"] = [UNPROVEN]
    found = text.places(plan, problem, outcome.x)
    return replace(result, design=untyped(describe(plan, found)), report=report), found


def _bounded(plan: Plan, result: Result, ask: Ask) -> Result:
    """A result with the computed bound of its plan, in what is left of the time, or MOMENT."""
    left = ask.budget.less(result.seconds).seconds
    clock = Clock(Budget(), ask.watch)
    clock.evaluations, clock.best = result.evaluations, result.value or math.inf
    floor = bound(plan, lateness(clock, None if left is None else max(left, MOMENT)))
    relaxation = replace(result, objective={"value": None}, bound=floor.value)
    relaxation = replace(relaxation, status="feasible", proof=packing.proof(floor))
    return reconcile(result, relaxation, ask.gap)


def explain(scene: Scene, ask: Ask) -> Explanation:
    """What every number of the file does to the packing: slopes with its layers and contacts held.

    Solved again from the packing itself, which is followed; whole numbers are packed anew.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    result, found = _solved(scene, ask.half)
    if result.value is None or found is None:
        return Explanation(result, message="no packing was found in time", seconds=clock.seconds)
    layers, x = found.layer, text.start(scene.plan(), found)

    def posed(other: Scene) -> Problem:
        return text.smooth(other.plan(), layers).starting(x)

    def packed(other: Scene) -> float | None:
        if result.status not in CERTAIN:  # a difference to what is not the best means nothing
            return None
        new = solve(other, replace(ask, budget=clock.left, watch=clock.watch))
        return new.value if new.status in CERTAIN else None

    def followed(other: Scene) -> float | None:
        return solve_within(clock, posed(other), "ipopt").value

    basis = at_point(result.value, followed, posed, scene, x)
    told = "" if result.status in CERTAIN else UNTRIED
    return priced(scene, result, clock, basis, packed, told, eases(posed(scene)))


def compared(scene: Scene) -> tuple[str, ...]:
    """The methods of a comparison that names none."""
    return ("hop", "sa", "multistart", "annealing", "nsga2")


def model(scene: Scene, method: str) -> Model:
    """The problem that a method solves for this packing, without a bound that proves nothing."""
    plan = scene.plan()
    words = "Places and layers" if plan.lifted else "Places"
    return Model(_problem(plan, method, loose=False), words, plan.unit())


def _problem(plan: Plan, method: str | None, loose: bool = True) -> Problem:
    if method in SMOOTH:
        return text.smooth(plan)
    return packing.problem(plan, loose)
