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
    ServoReport,
    train_figures,
)
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.physics.gears import disc_mass
from gearopt.scenes.explaining.explanations import explained
from gearopt.scenes.explaining.possible import Verdict, of_status
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import Run, Step
from gearopt.scenes.reading.ask import Ask, unseeded
from gearopt.scenes.servo.axis_steps import (
    added,
    described,
    design_of,
    given_gears,
    with_box,
    with_errors,
    with_gearhead,
    with_lightest,
    with_other_trains,
    with_ratio,
    with_train,
)
from gearopt.scenes.servo.explain import moves
from gearopt.scenes.servo.explain import remedies as of_train
from gearopt.scenes.servo.notes import assumptions, notes
from gearopt.scenes.servo.reach import some_train
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tolerances import by_every_rule, named, old, with_tolerances
from gearopt.scenes.servo.tolerances import problem as tolerance_problem
from gearopt.scenes.servo.trades import objectives, traded

METHODS = ("exact", "enumeration")  # its own


def steps(scene: Scene, ask: Ask) -> tuple[Step[Scene], ...]:
    """Every part that the file asks for, the answer first: it takes the method that is asked for.

    The train, its box, the ratio, the tolerances and the lightest train; then what follows.
    """
    asked: dict[Run, Any] = {
        with_train: scene.train,
        with_other_trains: scene.train,
        with_ratio: scene.duty,
        with_box: scene.space,
        with_tolerances: scene.tolerances,
        with_lightest: scene.lightest,
    }
    first, *others = (part for part, table in asked.items() if table is not None)
    others += [with_errors, with_key_figures, with_notes]
    others += [with_gearhead] if scene.planetary is not None else []
    others += [with_nearest] if scene.train is not None else []
    return Step(first), *(Step(part, own=False, always=True) for part in others)


def with_notes(scene: Scene, ask: Ask, axis: Result | None) -> Result:
    """The axis with assumptions and notes."""
    assert axis is not None
    texts: dict[str, Any] = {"assumptions": assumptions(scene)}
    report = ServoReport.from_dict(axis.report)
    if said := notes(scene, (axis, *axis.parts), design_of(axis), report):
        texts["notes"] = said
    return replace(axis, report=axis.report | texts)


def with_nearest(scene: Scene, ask: Ask, axis: Result | None) -> Result:
    """The axis with what every limit uses where an impossible train exceeds them least."""
    assert axis is not None
    if axis.status != "infeasible":
        return axis
    used = nearest(scene.servo_train(), Clock(ask.budget, of_others(ask.watch)))
    return replace(axis, report=axis.report | ({"nearest": used} if used else {}))


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies:
    """Remedies of a train that is impossible.

    A changed file that is not decided does not cost the conflict.
    """
    try:
        return of_train(scene, clock, result.message)
    except SolveError as reason:
        conflict = tuple(result.proof.get("conflict", ()))
        return Remedies(conflict, message=f"no remedy is known: {reason}")


def with_key_figures(scene: Scene, ask: Ask, axis: Result | None) -> Result:
    """The axis with chosen and given train, minimum values and room, by names of docs/servo.md."""
    assert axis is not None
    design, figures = design_of(axis), {}
    for train in ServoReport.from_dict(axis.report).trains or ():
        if train.best_of in OBJECTIVES:
            key = GOALS[train.best_of].key
            figures[f"least_{key}"] = getattr(train, key)
    if design.box is not None:
        figures["needed_width_mm"] = design.box.needed_width_mm
        figures["needed_height_mm"] = design.box.needed_height_mm
    if scene.train is not None and design.train is not None:
        chosen = train_figures(design.train, design.stiffness)
        figures |= {f"chosen_{key}": value for key, value in chosen.items()}
    if (gears := given_gears(scene)) is None:
        return added(axis, None, report=ServoReport(figures=figures))
    springs = scene.springs
    given = described(scene, gears)
    stiffness = None if springs is None else springs.design(gears)
    figures |= {f"given_{key}": v for key, v in train_figures(given, stiffness).items()}
    if scene.sources:
        figures |= by_every_rule(scene, gears, old(scene), "given")
    if scene.lightest is not None and springs is not None and given.mass_kg is not None:
        thick, long = springs.shaft
        shaft = 1000.0 * float(disc_mass(scene.servo_train().density, long, thick))
        figures["given_mass_with_shaft_kg"] = given.mass_kg + shaft
    report = ServoReport(given_train=given, given_stiffness=stiffness, figures=figures)
    return added(axis, None, report=report)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Whether a file has a train that meets all limits; without one, an answer."""
    if scene.train is not None:
        return Verdict(some_train(scene, clock) is not None)
    return of_status(KIND.solve(scene, Ask(budget=clock.left, watch=clock.watch)).status)


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Sensitivities of the answer to every number."""
    clock = Clock(ask.budget, of_others(ask.watch))

    def answer(other: Scene) -> Result:
        return KIND.solve(other, replace(ask, budget=clock.left, watch=clock.watch))

    explanation = explained(
        scene, result, clock, answer, lambda other: _posed(other, boxed=True)[0]
    )
    if scene.train is None and scene.duty is None:
        explanation = replace(
            explanation, conflict=tuple(named(n, scene.sources) for n in explanation.conflict)
        )
    return explanation


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    unused = {"top": "the trains of the Pareto front are listed as they are"}
    if scene.train is None:
        unused["top"] = "without [train] there are no trains to list"
    return unused | unseeded(method)


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
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
    steps=steps,
    posed=posed,
    methods_to_compare=methods_to_compare,
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
