"""kind = "drive": a multi-stage drive of cylindrical gears of minimum volume, mass or length.

With a [teeth] table the answer has whole teeth and standard modules and is proven by exhaustion;
without one, or by the method ipopt, sizes are continuous and proven by a dual bound.
"""

import math
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing, sizing_text, teeth
from gearopt.formulations.drive.shares import MASSES
from gearopt.formulations.drive.train import Train
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.clock import Clock, in_part, of_others, tell_known
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import GAP, run
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.counts import best_count
from gearopt.scenes.drive.notes import assumptions, notes
from gearopt.scenes.drive.rating.cut_short import bounded
from gearopt.scenes.drive.rating.limits import check_safe, rated_afterwards
from gearopt.scenes.drive.rating.rated import rate, with_rating
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.tables.blanks import BlankKeys, body_flaws
from gearopt.scenes.drive.tables.rating import MATERIAL, GivenTable
from gearopt.scenes.drive.trades import advice, objectives, several, to_choose
from gearopt.scenes.explaining.default import of_report
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.reading.ask import Ask, unseeded

WEAKER = " Its contact ratio is less than the one given, its root is weaker."
METHODS = ("exact", "process-one", "process-two", "sa", "sa-polish", "sa-paper", "smooth")
ANY_DESIGN_GAP = 1e9  # gap of a design that need not be the best
SMOOTH = "smooth"  # of real-valued sizes that ratings limit
CONTINUOUS = ("ipopt", "gp", "multistart", SMOOTH)  # methods that take no whole teeth


def solve(scene: Scene, ask: Ask) -> Result:
    """Size the drive: exactly where [teeth] is given, else continuously.

    The exact answer carries the continuous one as a part: what whole teeth and standard modules
    cost, and a second, independent bound. With [process_one] or [process_two] the designs by those
    rules are parts as well. What the design takes for granted is in its report.
    """
    result = _solved(_to_size(scene), ask)
    result = replace(result, report=result.report | {"assumptions": assumptions(scene)})
    result = with_rating(scene, result)
    check_safe(scene, result)
    return rated_afterwards(scene, result)


def _to_size(scene: Scene) -> Scene:
    """Return the drive; SolveError for one that can only be rated."""
    to_choose(scene)
    return scene


def _solved(scene: Scene, ask: Ask) -> Result:
    """Return the drive, laid out where the file asks for it; else remedies where there is none."""
    together = scene.layout is not None and scene.layout.together
    if scene.several and together:
        return _with_ways_out(scene, ask, best_count(scene, ask, _real, _boxed))
    if scene.layout is not None:
        from gearopt.scenes.drive.box.at_once import at_once
        from gearopt.scenes.drive.box.lay_out import lay_out

        sized = _solved(bare(scene), replace(ask, method=None))
        if sized.value is None:
            return sized
        scene = _unruled(_chosen(scene, sized))
        return (at_once if together else lay_out)(scene, ask, sized)
    result = best_count(scene, ask, _real, _answer) if scene.several else _answer(scene, ask)
    if result.status != "infeasible":
        return _with_processes(scene, ask, result)
    return _with_ways_out(scene, ask, result)


def _real(scene: Scene, ask: Ask) -> Result:
    """Return the drive with real-valued teeth and modules, without its layout.

    Of a drive that ratings limit, too, it is that of its load limits, whose bound holds.
    """
    train = _without_ratings(scene.train())
    if train is None:
        objective = {"name": scene.objective.minimise, "value": None, "unit": scene.train().unit}
        return Result("sizing", "limit", "", objective)
    return _sized(bare(scene), train, Ask(None, ask.budget, watch=ask.watch), sizing.problem(train))


def _without_ratings(train: Train) -> Train | None:
    """Return a drive with its load limits alone; None where it has none, prices, or webs.

    Those with webs take longer in real-valued sizes than in whole teeth.
    """
    if not train.law.limits or train.objective in MASSES and (train.rated or train.hollow):
        return None
    return replace(train, stages=tuple(replace(s, options=()) for s in train.stages))


def _boxed(scene: Scene, ask: Ask, ideal: Result) -> Result:
    """Return gears and box at once of a drive with one number of stages."""
    from gearopt.scenes.drive.box.at_once import at_once

    sized = _answer(bare(scene), replace(ask, method=None), ideal)
    if sized.value is None:  # a bound of the gears is none of the box
        return replace(sized, bound=None)
    return at_once(_unruled(scene), replace(ask, budget=ask.budget.less(sized.seconds)), sized)


def _chosen(scene: Scene, result: Result) -> Scene:
    """Return the drive with the number of stages of its design."""
    return scene.held(len(result.design["stages"])) if scene.several else scene


def _with_ways_out(scene: Scene, ask: Ask, result: Result) -> Result:
    """Return an impossible result with its remedies, those of a box where it has them already."""
    if result.status != "infeasible" or "ways_out" in result.report:
        return result
    from gearopt.scenes.drive.explaining.rated import conflict_soon

    tell_known(ask.watch, result)
    clock, rated = _others(ask, result.seconds), scene.by_ratings
    ways = conflict_soon(bare(scene), clock) if rated else asdict(_ways_out(scene, clock))
    return replace(result, report=result.report | {"ways_out": ways}) if ways else result


def _ways_out(scene: Scene, clock: Clock) -> Remedies:
    if scene.by_ratings:
        from gearopt.scenes.drive.explaining.rated import remedies

        return remedies(bare(scene), clock, lambda other: _status(other, clock))
    from gearopt.scenes.drive.explaining.counts import remedies_of_counts

    return remedies_of_counts(solid(scene), _unruled(bare(solid(scene))), clock)


def _status(scene: Scene, clock: Clock) -> str:
    """Return whether a drive that ratings limit is possible, in what is left of the time."""
    ask = Ask(budget=replace(clock.left, gap=ANY_DESIGN_GAP), watch=clock.watch)
    found = best_count(scene, ask, _real, _answer) if scene.several else _answer(scene, ask)
    return found.status if found.value is None else "feasible"


def explain(scene: Scene, ask: Ask, result: Result | None = None) -> Explanation:
    """Return the sensitivities of the drive, or what would make it possible, in its numbers."""
    scene = _unruled(_to_size(scene))
    scene = scene if scene.by_ratings else unrated(scene)
    if result is not None:
        return _explained(scene, ask, result, _others(ask))
    if scene.layout is not None:
        result = _solved(scene, ask)
        if result.status == "infeasible":
            return of_report(result)
        return _explained(scene, ask, result, _others(ask, result.seconds))
    clock = _others(ask)
    result = (
        best_count(scene, ask.half, _real, _answer) if scene.several else _answer(scene, ask.half)
    )
    if result.status == "infeasible":
        tell_known(ask.watch, result)
        return Explanation(result, **vars(_ways_out(scene, clock)), seconds=clock.seconds)
    if result.value is None:
        return Explanation(result, message="no design was found in time", seconds=clock.seconds)
    return _explained(scene, ask, result, clock)


def _others(ask: Ask, spent: float = 0.0) -> Clock:
    """Return the clock of changed problems, for what is left after so many seconds."""
    return Clock(ask.budget.less(spent), of_others(ask.watch))


def _explained(scene: Scene, ask: Ask, result: Result, clock: Clock) -> Explanation:
    """Return what every number of the file does to a design that was found; stages are held."""
    if scene.several:
        count = len(result.design["stages"])
        found = _explained(scene.held(count), ask, result, clock)
        words = f"the number of stages is held at {count}"
        return replace(found, message="; ".join(filter(None, (found.message, words))))
    if scene.layout is not None:
        from gearopt.scenes.drive.explaining.box_remedies import explained as box_explained

        return box_explained(scene, result, clock)
    from gearopt.scenes.drive.explaining.influences import explained

    return explained(scene, result, clock, lambda other: _answer(other, _exactly(ask, clock)))


def _exactly(ask: Ask, clock: Clock) -> Ask:
    """Return what is asked of a drive that is compared with another: one train, to the end."""
    return replace(ask, budget=replace(clock.left, gap=0.0), watch=clock.watch, gap=GAP, top=1)


def bare(scene: Scene) -> Scene:
    """Return the drive without its layout: what is sized."""
    return scene.model_copy(update={"layout": None, "place": (), "keep_out": ()})


def _unruled(scene: Scene) -> Scene:
    """Return the drive without its design processes, which change nothing of what is best."""
    return scene.model_copy(update=dict.fromkeys(PROCESSES))


def unrated(scene: Scene) -> Scene:
    """Return the drive without what only its rating asks for: numbers that size nothing."""
    if scene.rating is None:
        return scene
    bare = _without(scene, MATERIAL)
    stages = tuple(stage.model_copy(update={"given": GivenTable()}) for stage in bare.stage)
    return bare.model_copy(update={"rating": None, "load": (), "stage": stages})


def solid(scene: Scene) -> Scene:
    """Return the drive with solid gears: the same limits, where no ratings limit it."""
    return scene if scene.by_ratings else _without(scene, tuple(BlankKeys.model_fields))


def _without(scene: Scene, keys: tuple[str, ...]) -> Scene:
    """Return the drive without these keys of all gears and of each."""
    none: dict[str, Any] = dict.fromkeys(keys)
    stages = [
        stage.model_copy(
            update={m: getattr(stage, m).model_copy(update=none) for m in ("pinion", "wheel")}
        )
        for stage in scene.stage
    ]
    gears = scene.gears.model_copy(update=none)
    return scene.model_copy(update={"gears": gears, "stage": tuple(stages)})


def _answer(scene: Scene, ask: Ask, ideal: Result | None = None) -> Result:
    """Return the sized drive; ideal: the one with real-valued sizes, where it is known."""
    train = scene.train()
    if _continuous(scene, ask.method):
        return _sized(scene, train, ask, sizing.problem(train))
    if train.hollow and not train.rated:  # limits are those of solid gears, masses are not
        possible = _real(solid(scene), ask)
        ask = replace(ask, budget=ask.budget.less(possible.seconds))
        if possible.status == "infeasible":
            return replace(possible, name="drive")
    if _without_ratings(train) is None:
        whole, sized = _discrete(scene, train, ask.top), partial(_sized, scene, train)
        return bounded(train, ask, whole, sized, scene.rated_real)
    known, ideal = ideal is not None, ideal or _real(scene, ask)
    if ideal.status == "infeasible":  # then no whole teeth do either
        return replace(ideal, name="drive")
    ask = replace(ask, budget=ask.budget.less(0.0 if known else ideal.seconds))
    floor = -math.inf if ideal.bound is None else ideal.bound
    found = _sized(scene, train, ask, _discrete(scene, train, ask.top, floor))
    if found.status == "limit" and found.value is None:  # the continuous bound holds all the same
        found = replace(found, bound=ideal.bound)
    return reconcile(replace(found, parts=(replace(ideal, name="sizing"),)), ideal, ask.gap)


def _discrete(scene: Scene, train: Train, top: int = 1, floor: float = -math.inf) -> Problem:
    """Return the problem of whole teeth, with all methods that a drive has for it."""
    problem = teeth.problem(train, top, floor)
    if not train.law.limits:
        return problem
    return replace(problem, methods={**problem.methods, **scene.processes()})


def _with_processes(scene: Scene, ask: Ask, best: Result) -> Result:
    """Return the exact answer with the designs of the processes as parts, under its bound."""
    asked = [name for name in PROCESSES if getattr(scene, name) is not None]
    if not asked or ask.method not in (None, "exact"):
        return best
    train = scene.train()
    problem = _discrete(scene, train)
    parts, remarks = [], list(best.report.get("notes", []))
    for name in asked:
        words, method = name.replace("_", " "), name.replace("_", "-")
        try:
            watch = in_part(ask.watch, train.unit, words)
            part, outcome = run(problem, method, ask.budget, ask.seed, watch, ask.gap)
        except SolveError as reason:
            remarks.append(f"There is no design by {words}: {reason}.")
            continue
        made = {} if outcome.x is None else untyped(scene.design(teeth.pairs(train, outcome.x)))
        part = replace(part, objective=part.objective | {"unit": train.unit}, design=made)
        part = with_rating(scene, reconcile(replace(part, name=words), best, ask.gap))
        parts.append(part)
    return replace(best, parts=(*best.parts, *parts), report=best.report | {"notes": remarks})


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    found, boxed = {}, scene.layout is not None
    if scene.teeth is None:
        found["top"] = "next best answers are listed of whole teeth, which a table [teeth] asks for"
    elif not boxed and method not in (None, "exact"):
        found["top"] = f"{method} finds one answer; exact lists the next best ones"
    return found if boxed else found | unseeded(method)


def compared(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    if scene.layout is None:
        asked = (name.replace("_", "-") for name in PROCESSES if getattr(scene, name) is not None)
        real = ("ipopt",) if not scene.by_ratings else (SMOOTH,) * scene.rated_real
        return ("exact", *asked, *real, "annealing", "nsga2")
    if scene.layout.together:
        return ("exact",) if scene.by_ratings else ("exact", "ipopt")
    return ("exact", "sa", "sa-polish", "multistart", "nsga2")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem that a method solves for this drive; SolveError where it has none.

    With a [layout] that is the layout of the gears that are best without it.
    """
    if _to_size(scene).several:
        return _of_best_count(scene, method)
    if scene.layout is not None:
        from gearopt.scenes.drive.box import at_once, lay_out

        sized = solve(bare(scene), Ask())
        if not scene.layout.together:
            return lay_out.posed(scene, method, sized)
        if sized.value is None:
            raise SolveError("there are no gears to lay out: gearopt explain shows why")
        return at_once.posed(scene, method, lay_out.lay_out(scene, Ask(), sized))
    train = scene.train()
    if _continuous(scene, method):
        return Model(sizing.problem(train), "Real-valued teeth and modules", train.unit)
    return Model(_discrete(scene, train), "Whole teeth and standard modules", train.unit)


def _of_best_count(scene: Scene, method: str) -> Model:
    """Return the problem of a method with the number of stages that is best, the same for all."""
    best = solve(scene, Ask())
    if best.value is None:
        raise SolveError("there is no drive to compare: gearopt explain shows why")
    found = posed(_chosen(scene, best), method)
    return replace(found, words=f"{found.words}, {len(best.design['stages'])} stages (the best)")


def _continuous(scene: Scene, method: str | None) -> bool:
    """Return whether a method gets real-valued teeth."""
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


def _sized(scene: Scene, train: Train, ask: Ask, problem: Problem) -> Result:
    """Solve one formulation of the drive and put its answer in a drawing's words."""
    exact = problem.name == "teeth"
    formulation = teeth if exact else sizing_text
    watch = in_part(ask.watch, train.unit)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": train.unit})
    if result.value is None or outcome.x is None:
        return result
    points = (outcome.x, *outcome.others)
    gears = [formulation.pairs(train, x) for x in points]
    chosen = [teeth.options(train, x) if exact and train.several_options else () for x in points]
    designs = [untyped(scene.design(*made)) for made in zip(gears, chosen, strict=True)]
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


ABOUT = {  # files in examples, that of the kind first
    "drive": "a multi-stage drive of cylindrical gears of minimum volume, mass or length",
    "rating": "gears that are given, rated by AGMA or ISO 6336",
    "sizing": "a drive of least volume that is safe by its rating",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    solve=solve,
    posed=posed,
    compared=compared,
    methods=METHODS,
    explain=explain,
    assumptions=assumptions,
    trades=Trades(objectives, several, advice),
    rate=rate,
    idle=idle,
)
