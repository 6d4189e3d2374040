"""The gears of a drive: real-valued sizes with a dual bound, whole teeth proven by exhaustion."""

import math
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing, sizing_text, teeth
from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.processes import methods
from gearopt.formulations.drive.train import MASSES, Train
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.counts import best_count
from gearopt.scenes.drive.notes import notes
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.tables.blanks import body_flaws
from gearopt.scenes.drive.without import without
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.reading.ask import Ask

WEAKER = " Its contact ratio is less than the one given, its root is weaker."
SMOOTH = "smooth"  # of real-valued sizes that ratings limit
CONTINUOUS = ("ipopt", "gp", "multistart", SMOOTH)  # methods that take no whole teeth
BOUND_SECONDS, BOUND_SHARE = 2.0, 0.3  # s, and share of all, kept for the bound of rated drives


def sized(scene: Scene, ask: Ask) -> Result:
    """Gears of a drive, with the best number of stages where the file leaves it open.

    Whole teeth where [teeth] is given, else real-valued sizes. The former carry the latter as a
    part: what whole teeth and standard modules cost, and a second, independent bound.
    """
    if scene.several:
        return best_count(scene, ask, real_valued, of_count)
    return of_count(scene, ask)


def of_count(scene: Scene, ask: Ask, ideal: Result | None = None) -> Result:
    """Gears of a drive with one number of stages.

    ideal: those with real-valued sizes, where they are known.
    """
    train = scene.train()
    if takes_real_values(scene, ask.method):
        return _solved(scene, train, ask, sizing.problem(train))
    if train.hollow and not train.rated:  # limits are those of solid gears, masses are not
        possible = real_valued(without(scene, "webs"), ask)
        ask = replace(ask, budget=ask.budget.less(possible.seconds))
        if possible.status == "infeasible":
            return replace(possible, name="drive")
    if _by_load_limits(train) is None:
        return _rated(scene, train, ask)
    known, ideal = ideal is not None, ideal or real_valued(scene, ask)
    if ideal.status == "infeasible":  # then no whole teeth do either
        return replace(ideal, name="drive")
    ask = replace(ask, budget=ask.budget.less(0.0 if known else ideal.seconds))
    floor = -math.inf if ideal.bound is None else ideal.bound
    whole = _solved(scene, train, ask, whole_teeth(scene, train, ask.top, floor))
    if whole.status == "limit" and whole.value is None:  # the continuous bound holds all the same
        whole = replace(whole, bound=ideal.bound)
    return reconcile(replace(whole, parts=(replace(ideal, name="sizing"),)), ideal, ask.gap)


def _rated(scene: Scene, train: Train, ask: Ask) -> Result:
    """Whole teeth of a drive that ratings alone limit.

    Of a search that ends with its seconds, real-valued sizes are a part, and their bound holds: a
    share of the seconds is kept for them.
    """
    whole, seconds = whole_teeth(scene, train, ask.top), ask.budget.seconds
    if seconds is None or not scene.rated_real or ask.method not in (None, "exact"):
        return _solved(scene, train, ask, whole)
    kept, clock = min(BOUND_SECONDS, BOUND_SHARE * seconds), Clock(ask.budget)
    result = _solved(scene, train, replace(ask, budget=ask.budget.less(kept)), whole)
    if result.status != "limit" or clock.over:  # a first train takes what it takes
        return result
    alone = replace(sizing_text.exact_text(train), methods={SMOOTH: sizing.searched(train)})
    ideal = _solved(scene, train, Ask(None, Budget(kept), watch=ask.watch), alone)
    if result.value is None and ideal.status != "infeasible":
        result = replace(result, bound=ideal.bound)
    parts = (replace(ideal, name="sizing"),)
    return reconcile(replace(result, parts=parts), ideal, ask.gap)


def real_valued(scene: Scene, ask: Ask) -> Result:
    """Gears with real-valued teeth and modules.

    Of a drive that ratings limit, too, they are those of its load limits, whose bound holds.
    """
    train = scene.train()
    by_loads = _by_load_limits(train)
    if by_loads is None:
        objective = {"name": train.objective, "value": None, "unit": train.unit}
        return Result("sizing", "limit", "", objective)
    asked = Ask(None, ask.budget, watch=ask.watch)
    return _solved(without(scene, "layout"), train, asked, sizing.problem(by_loads))


def _by_load_limits(train: Train) -> Train | None:
    """Drive with its load limits alone; None where it has none, prices, or webs.

    Those with webs take longer in real-valued sizes than in whole teeth.
    """
    if not train.law.limits or train.objective in MASSES and (train.rated or train.hollow):
        return None
    return replace(train, stages=tuple(replace(s, options=()) for s in train.stages))


def whole_teeth(scene: Scene, train: Train, top: int = 1, floor: float = -math.inf) -> Problem:
    """Problem of whole teeth, with all methods that a drive has for it."""
    problem = teeth.problem(train, top, floor)
    if not train.law.limits:
        return problem
    one, two = scene.process_one, scene.process_two
    return replace(
        problem,
        methods={
            **problem.methods,
            **methods(train, one.inputs() if one else None, two.inputs() if two else None),
        },
    )


def takes_real_values(scene: Scene, method: str | None) -> bool:
    """Whether a method gets real-valued teeth; SolveError where it does not fit the file."""
    if scene.teeth is None and method in ("exact", *(n.replace("_", "-") for n in PROCESSES)):
        raise SolveError(f"the method {method} needs a [teeth] table in the file")
    continuous = scene.teeth is None or method in CONTINUOUS
    if continuous and scene.by_ratings and not scene.rated_real:
        raise SolveError(
            "load spectra and materials to choose from are for whole teeth alone: write a table "
            "[teeth], and use a method of whole teeth"
        )
    if continuous and scene.by_ratings and method not in (None, SMOOTH):
        raise SolveError(f"{method} takes no real-valued gears that ratings limit; smooth does")
    return continuous


def _solved(scene: Scene, train: Train, ask: Ask, problem: Problem) -> Result:
    """Answer to one formulation of the drive, in a drawing's words."""
    exact = problem.name == "teeth"
    formulation = teeth if exact else sizing_text
    watch = in_part(ask.watch, train.unit)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": train.unit})
    if result.value is None or outcome.x is None:
        return result
    points = (outcome.x, *outcome.others)
    gears = [formulation.pairs(train, x) for x in points]
    options = [teeth.options(train, x) if exact and train.several_options else () for x in points]
    designs = [untyped(describe(train, *both)) for both in zip(gears, options, strict=True)]
    values = [float(problem.batch(x[None]).F[0, 0]) for x in points]
    trains = [
        {"objective": value, "ratio": design["ratio"], "stages": design["stages"]}
        for value, design in zip(values, designs, strict=True)
    ]
    report: dict[str, Any] = {"trains": trains} if exact and ask.top > 1 else {}
    bodies = [f.sentence for f in body_flaws([stage.blanks for stage in train.stages], gears[0])]
    if remarks := [*notes(scene, exact), *bodies, *tooth_warnings(gears[0], WEAKER)]:
        report["notes"] = remarks
    return replace(result, name="drive", design=designs[0], report=report)
