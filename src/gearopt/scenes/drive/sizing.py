"""The gears of a drive: real-valued sizes with a dual bound, whole teeth proven by exhaustion."""

import math
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive.processes import ProcessOne, ProcessTwo, methods
from gearopt.formulations.drive.teeth import load_front
from gearopt.formulations.drive.train import EXTREMES, MASSES, Train
from gearopt.frozen import dataclass
from gearopt.optimise.certificate import least, reconcile
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.counts import best_count
from gearopt.scenes.drive.driving import may_drive, trains
from gearopt.scenes.drive.notes import with_notes
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.without import without
from gearopt.scenes.plan import Step, carried_out
from gearopt.scenes.reading.ask import Ask

SMOOTH = "smooth"  # of real-valued sizes that ratings limit
CONTINUOUS = ("ipopt", "gp", "multistart", SMOOTH)  # methods that take no whole teeth
BOTH_SIDES = (
    "Proof: drives that reduce the speed and drives that increase it were searched in turn; the "
    "least bound counts."
)
BOUND_SECONDS, BOUND_SHARE = 2.0, 0.3  # s, and share of all, kept for the bound of rated drives


@dataclass(frozen=True)
class Drive:
    """A drive with one number of stages as its file states it, in plain numbers.

    solid: with solid gears, whose limits are the same, where webs make real-valued sizes slow; else
    None. one_load: ratings limit it under one load, with no materials to choose from. one, two:
    what the design processes are given.
    """

    scene: Scene
    train: Train
    solid: Train | None
    one_load: bool
    one: ProcessOne | None
    two: ProcessTwo | None


def drive_of(scene: Scene, driver: str = "") -> Drive:
    """The drive that a file with one number of stages states; driver: as of `Scene.train`."""
    train, process_one, process_two = scene.train(driver), scene.process_one, scene.process_two
    webs_alone = train.hollow and not train.rated  # limits are those of solid gears, masses are not
    return Drive(
        scene,
        train,
        without(scene, "webs").train(driver) if webs_alone else None,
        scene.rated_real,
        process_one.inputs() if process_one else None,
        process_two.inputs() if process_two else None,
    )


def bare_drive(scene: Scene) -> Drive:
    """The drive that a file states, without its layout."""
    return drive_of(without(scene, "layout"))


def steps(scene: Scene, ask: Ask, own: bool = True) -> tuple[Step[Scene], ...]:
    """Steps to the gears of a drive, without their layout; own: as of `Step`."""
    sizes: Step[Scene]
    if scene.several:
        sizes = Step(of_best_count, own=own)
    elif len(may_drive(scene)) > 1:
        sizes = Step(of_both_sides, own=own)
    elif takes_real_values(scene, ask.method if own else None):
        sizes = Step(of_real_values, bare_drive, own)
    else:
        sizes = Step(of_whole_teeth, bare_drive, own)
    return sizes, Step(noted, own=own, always=True)


def sized(scene: Scene, ask: Ask) -> Result:
    """Gears of a drive, with the best number of stages where the file leaves it open."""
    return carried_out(steps(scene, ask), scene, ask)


def noted(scene: Scene, ask: Ask, gears: Result | None) -> Result:
    """Gears with what a reader should know of them: presets, teeth that are not standard, flaws."""
    assert gears is not None
    return with_notes(scene, gears, not takes_real_values(scene, ask.method))


def of_best_count(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Gears of a drive with the best number of stages of its range."""
    return best_count(without(scene, "layout"), ask, ideal_of_count, of_count)


def ideal_of_count(scene: Scene, ask: Ask) -> Result:
    """Real-valued gears of a drive with one number of stages."""
    each = [ideal(train, ask) for train in trains(scene)]
    return least(each, ask.gap) if len(each) > 1 else each[0]


def of_count(scene: Scene, ask: Ask, real: Result | None = None) -> Result:
    """Gears of a drive with one number of stages; real: the real-valued ones, where known."""
    if len(may_drive(scene)) > 1:
        return of_both_sides(scene, ask, None)
    if takes_real_values(scene, ask.method):
        return of_real_values(drive_of(scene), ask, None)
    return of_whole_teeth(drive_of(scene), ask, real)


def of_both_sides(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The best gears of a drive whose ratio may be above 1 and below: each is sized in turn."""
    clock, results, left = Clock(ask.budget, ask.watch), [], ask.budget.seconds
    sized = of_real_values if takes_real_values(scene, ask.method) else of_whole_teeth
    for driver, share in zip(may_drive(scene), (0.5, 1.0), strict=True):
        budget = replace(clock.left, seconds=left and clock.within(share * left))
        asked = replace(ask, budget=budget, watch=clock.inner(values=False))
        results.append(sized(drive_of(scene, driver), asked, None))
    best = least(results, ask.gap)
    sentence = str(best.proof.get("sentence", "")).removeprefix("Proof: ")
    proof = best.proof | ({"sentence": f"{BOTH_SIDES} {sentence}"} if sentence else {})
    if best.status == "infeasible":  # either side by its own limits
        named = (name for result in results for name in result.proof.get("conflict", ()))
        proof["conflict"] = [*dict.fromkeys(named)]
    every = [train for r in results for train in r.report.get("trains", ())]
    alike = {repr(train["stages"]): train for train in every}  # of 1:1 both sides have the same
    listed = sorted(alike.values(), key=lambda train: float(train["objective"]))[: ask.top]
    report = best.report | ({"trains": listed} if listed and best.status == "optimal" else {})
    count = sum(result.evaluations for result in results)
    return replace(best, proof=proof, report=report, evaluations=count)


def of_real_values(drive: Drive, ask: Ask, known: Result | None) -> Result:
    """Gears with real-valued teeth and modules, by the method that is asked for."""
    result = _solved(drive.train, ask, continuous_sizing.problem(drive.train))
    return _checked(result) if drive.train.ranging else result


def _checked(result: Result) -> Result:
    """Answer with a bound over ranges of teeth, part of which is checked, not proven (Lemma 64)."""
    proof = result.proof | {"checked": "between helix angles and shifts, on random designs"}
    if sentence := proof.get("sentence"):
        proof["sentence"] = sentence.replace("Proof: ", "The bound, checked: ", 1)
    status = "feasible" if result.status == "optimal" else result.status
    return replace(result, status=status, proof=proof)


def of_whole_teeth(drive: Drive, ask: Ask, known: Result | None) -> Result:
    """Gears with whole teeth and standard modules.

    They carry the real-valued ones as a part: what whole teeth and standard modules cost, and a
    second, independent bound. known: the real-valued ones, where they are known.
    """
    train = drive.train
    if drive.solid is not None:
        possible = ideal(drive.solid, ask)
        ask = replace(ask, budget=ask.budget.less(possible.seconds))
        if possible.status == "infeasible":
            return replace(possible, name="drive")
    if _by_load_limits(train) is None:
        return _rated(drive, ask)
    real = known or ideal(train, ask)
    if real.status == "infeasible":  # then no whole teeth do either
        return replace(real, name="drive")
    ask = replace(ask, budget=ask.budget.less(0.0 if known else real.seconds))
    floor = -math.inf if real.bound is None else real.bound
    whole = _solved(train, ask, whole_teeth(drive, ask.top, floor))
    if whole.status == "limit" and whole.value is None:  # the continuous bound holds all the same
        whole = replace(whole, bound=real.bound)
    return reconcile(replace(whole, parts=(replace(real, name="sizing"),)), real, ask.gap)


def _rated(drive: Drive, ask: Ask) -> Result:
    """Whole teeth of a drive that ratings alone limit.

    Of a search that ends with its seconds, real-valued sizes are a part, and their bound holds: a
    share of the seconds is kept for them.
    """
    train, whole, seconds = drive.train, whole_teeth(drive, ask.top), ask.budget.seconds
    bounded = drive.one_load and not drive.scene.objective.extreme
    if seconds is None or not bounded or ask.method not in (None, "exact"):
        return _solved(train, ask, whole)
    kept, clock = min(BOUND_SECONDS, BOUND_SHARE * seconds), Clock(ask.budget)
    result = _solved(train, replace(ask, budget=ask.budget.less(kept)), whole)
    if result.status != "limit" or clock.over:  # a first train takes what it takes
        return result
    alone = replace(
        sizing_text.exact_text(train), methods={SMOOTH: continuous_sizing.searched(train)}
    )
    real = _solved(train, Ask(None, Budget(kept), watch=ask.watch), alone)
    if result.value is None and real.status != "infeasible":
        result = replace(result, bound=real.bound)
    parts = (replace(real, name="sizing"),)
    return reconcile(replace(result, parts=parts), real, ask.gap)


def ideal(train: Train, ask: Ask) -> Result:
    """Gears with real-valued teeth and modules, whose bound is one of whole teeth.

    Of a drive that ratings limit, too, they are those of its load limits, whose bound holds.
    """
    by_loads = _by_load_limits(train)
    if by_loads is None:
        objective = {"name": train.objective, "value": None, "unit": train.unit}
        return Result("sizing", "limit", "", objective)
    asked = Ask(None, ask.budget, watch=ask.watch)
    return _solved(train, asked, continuous_sizing.problem(by_loads))


def _by_load_limits(train: Train) -> Train | None:
    """Drive with its load limits alone; None where it has none, prices, or webs.

    Those with webs take longer in real-valued sizes than in whole teeth.
    """
    if not train.law.limits or train.objective in MASSES and (train.rated or train.hollow):
        return None
    return replace(train, stages=tuple(replace(s, options=()) for s in train.stages))


def whole_teeth(drive: Drive, top: int = 1, floor: float = -math.inf) -> Problem:
    """Problem of whole teeth, with all methods that a drive has for it."""
    train = drive.train
    if drive.scene.objective.extreme:
        return load_front.limited(
            train, drive.scene.objective.extreme, {}, drive.scene.objective.extreme
        )
    problem = teeth.problem(train, top, floor)
    if not train.law.limits:
        return problem
    by_processes = methods(train, drive.one, drive.two)
    return replace(problem, methods={**problem.methods, **by_processes})


def takes_real_values(scene: Scene, method: str | None) -> bool:
    """Whether a method gets real-valued teeth; SolveError where it does not fit the file."""
    if scene.teeth is None and method in ("exact", *(n.replace("_", "-") for n in PROCESSES)):
        raise SolveError(f"the method {method} needs a [teeth] table in the file")
    continuous = scene.teeth is None or method in CONTINUOUS
    if continuous and scene.objective.extreme:
        raise SolveError(
            f"{method} takes real-valued teeth, which have no least {scene.objective.extreme}"
        )
    if continuous and scene.by_ratings and not scene.rated_real:
        raise SolveError(
            "load spectra, materials to choose from, several helix angles, given centre distances, "
            "ratios that may be below 1 and wider pinions are for whole teeth alone: write a table "
            "[teeth], and use a method of whole teeth"
        )
    if continuous and scene.by_ratings and method not in (None, SMOOTH):
        raise SolveError(f"{method} takes no real-valued gears that ratings limit; smooth does")
    return continuous


def _solved(train: Train, ask: Ask, problem: Problem) -> Result:
    """Answer to one formulation of the drive, in a drawing's words."""
    unit = EXTREMES.get(problem.rows.objectives[0], train.unit)
    watch = in_part(ask.watch, unit)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": unit})
    if result.value is None or outcome.x is None:
        return result
    from gearopt.formulations.drive.design import describe  # a design was found

    points, exact = (outcome.x, *outcome.others), problem.name == "teeth"
    if exact:
        gears = [teeth.gears(train, x) for x in points]
    else:
        gears = [(sizing_text.pairs(train, x), ()) for x in points]
    described = [describe(train, pairs, options) for pairs, options in gears]
    designs = [untyped(design) for design in described]
    values = [float(problem.batch(x[None]).F[0, 0]) for x in points]
    trains = [
        {"objective": value, "ratio": design["ratio"], "stages": design["stages"]}
        for value, design in zip(values, designs, strict=True)
    ]
    report: dict[str, Any] = {"trains": trains} if exact and ask.top > 1 else {}
    return replace(result, name="drive", design=designs[0], report=report)
