"""kind = "packing": cylinders with parallel axes in the smallest container, in one or more layers.

Places are searched by annealing and Ipopt; the bound is computed, and proves the packing where it
is met.
"""

import math
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations import packing
from gearopt.formulations.packing import text
from gearopt.formulations.packing.container_bound import bound
from gearopt.formulations.packing.design import describe
from gearopt.formulations.packing.plan import Plan
from gearopt.formulations.packing.state import lateness, ready
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.comparing.trial import Model
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.solve import run
from gearopt.optimise.typed import untyped
from gearopt.scenes.packing.scene import EXAMPLE, Scene
from gearopt.scenes.reading.ask import Ask

__all__ = ["EXAMPLE", "Scene", "compared", "explain", "model", "solve"]
SMOOTH = ("ipopt", "multistart")  # methods that need derivatives
MOMENT = 0.1  # seconds for a bound after a run that has spent all of its time
ASSUMED = (
    "Cylinders are rigid, upright and of their nominal size; they may touch each other and walls."
)
UNPROVEN = "Best known, not proven: a smaller packing may exist, but none below the bound."


def solve(scene: Scene, ask: Ask) -> Result:
    """Pack the cylinders; a method that brings no bound is held against the same one."""
    plan = scene.plan()
    problem = _problem(plan, ask.method)
    watch = in_part(ask.watch, plan.unit())
    if ask.method in (None, *problem.methods):
        ready()
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": plan.unit()})
    if result.value is None or outcome.x is None:
        return result
    if result.bound is None:
        result = _bounded(plan, result, replace(ask, watch=watch))
    report = {"assumptions": [ASSUMED]}
    if result.status != "optimal":
        report["notes"] = [UNPROVEN]
    found = text.places(plan, problem, outcome.x)
    return replace(result, design=untyped(describe(plan, found)), report=report)


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
    """A packing has no load limits to explain: SolveError says what to do instead."""
    raise SolveError("explain is for drives; `gearopt solve` says how good a packing is proven")


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
