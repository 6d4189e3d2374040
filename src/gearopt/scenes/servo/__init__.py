"""kind = "servo": a motor, a two-stage gear train and a load that must be moved and placed.

Tables switch parts on: the best total ratio, the teeth and modules of the train, its stiffness and
box, the tolerances that its accuracy asks for. Each is a certified result; the first that a file
asks for of train, ratio and tolerances is the answer, the others are its parts.
"""

from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.servo.choice import train_problem
from gearopt.formulations.servo.impossible import nearest
from gearopt.formulations.servo.servo_design import (
    GOALS,
    OBJECTIVES,
    ServoDesign,
    ServoReport,
    train_figures,
)
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import disc_mass
from gearopt.scenes.explaining.explanations import explained
from gearopt.scenes.explaining.possible import Verdict, of_status
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask, unseeded
from gearopt.scenes.servo.explain import moves
from gearopt.scenes.servo.explain import remedies as of_train
from gearopt.scenes.servo.notes import assumptions, notes
from gearopt.scenes.servo.reach import some_train
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tolerances import by_every_rule, named, old, tolerance_part
from gearopt.scenes.servo.tolerances import problem as tolerance_problem
from gearopt.scenes.servo.trades import objectives, traded
from gearopt.scenes.servo.train import (
    Found,
    backlashes,
    beside,
    box_part,
    described,
    errors,
    given_gears,
    lightest_part,
    neighbours,
    ratio_part,
    train_part,
)

METHODS = ("exact", "enumeration")  # its own
COUNTS = {"combinations": "trains_looked_at", "feasible_trains": "feasible_trains"}


def axis(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Every part of the file; the answer is the train, else the ratio, else the tolerances.

    A method that is asked for is that of the answer; parts are solved by their own.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    gears, found = given_gears(scene), Found()
    if scene.train is not None:
        gears, found = _trained(scene, ask, clock)
    if scene.duty is not None:
        found += ratio_part(scene, found.design.train, _part(ask, clock, found))
    if gears is not None:
        found += _geared(scene, _part(ask, clock, found), gears)
    if scene.lightest is not None:
        found += lightest_part(scene, _part(ask, clock, found))
    found += Found(report=_key_figures(scene, found))
    answer, *parts = found.results
    texts: dict[str, Any] = {"assumptions": assumptions(scene)}
    if said := notes(scene, found.results, found.design, found.report):
        texts["notes"] = said
    if answer.status == "infeasible" and scene.train is not None:
        if violated := nearest(scene.servo_train(), clock):
            texts["nearest"] = violated
    return replace(
        answer,
        design=untyped(found.design),
        report=found.report.to_dict() | texts,
        parts=tuple(parts),
        seconds=clock.seconds,
    )


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies:
    """Remedies of a train that is impossible.

    A changed file that is not decided does not cost the conflict.
    """
    try:
        return of_train(scene, clock, result.message)
    except SolveError as reason:
        conflict = tuple(result.proof.get("conflict", ()))
        return Remedies(conflict, message=f"no remedy is known: {reason}")


def _part(ask: Ask, clock: Clock, found: Found) -> Ask:
    """Return what is asked of the next part: the method if it is the first, and the time left."""
    method = None if found.results else ask.method
    return replace(ask, method=method, budget=clock.left)


def _trained(scene: Scene, ask: Ask, clock: Clock) -> tuple[Pairs | None, Found]:
    """Solve the train; add what is known beside it and the trains of its Pareto front."""
    result, gears = train_part(scene, ask)
    report = beside(scene, gears)
    counts = {k: result.proof[v] for k, v in COUNTS.items() if "feasible_trains" in result.proof}
    report |= ServoReport(figures=counts)
    if gears is None:
        return None, Found((result,), report=report)
    report |= ServoReport(trains=neighbours(scene, clock))
    return gears, Found((result,), ServoDesign(train=described(scene, gears)), report)


def _geared(scene: Scene, ask: Ask, gears: Pairs) -> Found:
    """Compute what follows from chosen or given gears: errors, stiffness, box, tolerances."""
    rows, springs = errors(scene, gears), scene.springs
    sums = {
        f"{kind}_deg": sum(row.error_deg for row in rows if row.kind == kind)
        for kind in ("backlash", "pitch")
        if rows
    }
    design = ServoDesign(
        train=described(scene, gears),
        errors=rows,
        backlash=backlashes(scene),
        stiffness=None if springs is None else springs.design(gears),
    )
    found = Found((), design, ServoReport(figures=sums))
    if scene.space is not None:
        found += box_part(scene, gears, ask)
    if scene.tolerances is not None:
        found += tolerance_part(scene, gears, ask)
    return found


def _key_figures(scene: Scene, found: Found) -> ServoReport:
    """Return chosen and given train, minimum values and room by the names of docs/servo.md."""
    design, figures = found.design, {}
    for one in found.report.trains or ():
        if one.best_of in OBJECTIVES:
            key = GOALS[one.best_of].key
            figures[f"least_{key}"] = getattr(one, key)
    if design.box is not None:
        figures["needed_width_mm"] = design.box.needed_width_mm
        figures["needed_height_mm"] = design.box.needed_height_mm
    if scene.train is not None and design.train is not None:
        chosen = train_figures(design.train, design.stiffness)
        figures |= {f"chosen_{key}": value for key, value in chosen.items()}
    if (gears := given_gears(scene)) is None:
        return ServoReport(figures=figures)
    springs = scene.springs
    train = described(scene, gears)
    stiffness = None if springs is None else springs.design(gears)
    figures |= {f"given_{key}": v for key, v in train_figures(train, stiffness).items()}
    if scene.sources:
        figures |= by_every_rule(scene, gears, old(scene), "given")
    if scene.lightest is not None and springs is not None and train.mass_kg is not None:
        thick, long = springs.shaft
        shaft = 1000.0 * float(disc_mass(scene.servo_train().density, long, thick))
        figures["given_mass_with_shaft_kg"] = train.mass_kg + shaft
    return ServoReport(given_train=train, given_stiffness=stiffness, figures=figures)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Whether a file has a train that meets all limits; without one, an answer."""
    if scene.train is not None:
        return Verdict(some_train(scene, clock) is not None)
    return of_status(KIND.solve(scene, Ask(budget=clock.left, watch=clock.watch)).status)


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Sensitivities of the answer to every number."""
    clock = Clock(ask.budget, of_others(ask.watch))

    def answer(other: Scene) -> Result:
        return axis(other, replace(ask, budget=clock.left, watch=clock.watch), None)

    found = explained(scene, result, clock, answer, lambda other: _posed(other, boxed=True)[0])
    if scene.train is None and scene.duty is None:
        found = replace(found, conflict=tuple(named(n, scene.sources) for n in found.conflict))
    return found


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    found = {"top": "the trains of the Pareto front are listed as they are"}
    if scene.train is None:
        found["top"] = "without [train] there are no trains to list"
    return found | unseeded(method)


def compared(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    if scene.train is not None:
        return ("exact", "annealing", "nsga2")
    if scene.duty is None and scene.tolerances is not None and scene.tolerances.grades is not None:
        return ("exact", "annealing", "nsga2")
    return ("exact", "ipopt", "gp")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem of the answer; a train's without its box, which is no row of it."""
    return Model(*_posed(scene, boxed=False))


def _posed(scene: Scene, boxed: bool) -> tuple[Problem, str, str]:
    """Return the problem of the answer, what it is called, and the unit of its objective."""
    if scene.train is not None:
        problem = train_problem(scene.choice(boxed=boxed))
        return problem, "Whole teeth and modules, without a box", GOALS[scene.train.goal].shown
    if (duty := scene.servo_duty()) is not None:
        return duty.problem(), "Total ratio", GOALS[duty.goal].unit
    gears = given_gears(scene)
    assert gears is not None
    return tolerance_problem(scene, gears), "Tolerances of given gears", ""


ABOUT = {  # files in examples, that of the kind first
    "servo": "a motor, a two-stage gear train and a load that must be moved and placed",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=one_step(axis),
    posed=posed,
    compared=compared,
    methods=METHODS,
    possible=possible,
    moves=moves,
    remedies=remedies,
    remedied=lambda scene: scene.train is not None,
    influences=influences,
    assumptions=assumptions,
    trades=Trades(objectives, traded),
    idle=idle,
)
