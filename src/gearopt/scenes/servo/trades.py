"""The objectives of a servo axis, and the problem of several of them at once."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.servo.front import front_problem
from gearopt.formulations.servo.servo_design import GOALS, ServoDesign
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.tolerance import conic, grades
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.objectives import EPSILON, EXACT, Objective, Tradeoff, impossible
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo import tolerances as tolerance_part
from gearopt.scenes.servo.axis_steps import described, given_gears, of_point
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import BudgetTable

COST, ERROR = "cost", "error"


def objectives(scene: Scene) -> dict[str, str]:
    """Objectives of a front of the axis: name and unit.

    Of a train what it is judged by; of tolerances of given gears cost and error, by the rule of the
    budget, or of each budget where there are several.
    """
    if scene.train is not None:
        return {name: GOALS[name].shown for name in scene.servo_train().goals}
    if scene.tolerances is None:
        return {}
    return {COST: "", **dict.fromkeys(_errors(scene).values(), "deg")}


def traded(scene: Scene, names: Sequence[str], ask: Ask) -> Tradeoff:
    """Return the problem of a front; SolveError where a method does not fit it."""
    units, method = objectives(scene), ask.method
    listed = tuple(Objective(name, units[name]) for name in names)
    if scene.train is not None:
        return Tradeoff(_trains(scene, names, method), listed, _shown_train(scene))
    gears = given_gears(scene)
    assert gears is not None
    return Tradeoff(_tolerances(scene, gears, names, method), listed, _allotted(scene, gears))


def _trains(scene: Scene, names: Sequence[str], method: str | None) -> Problem:
    choice = scene.choice()
    if method == EPSILON:
        raise SolveError(
            f"{EPSILON} is for real-valued sizes; a servo train's teeth are whole: leave the "
            f"method out, or write {EXACT}"
        )
    if choice.room is not None and method not in (None, EXACT):
        raise SolveError(f"a box that is required is kept by {EXACT} alone, not by {method}")
    return front_problem(choice, names)


def _shown_train(scene: Scene) -> Callable[[Array], Mapping[str, Any]]:
    """Return how the train of a point is shown, with its stiffness."""
    train, sources, springs = scene.servo_train(), scene.sources, scene.springs

    def shown(x: Array) -> Mapping[str, Any]:
        gears = of_point(scene, x, train)
        stiffness = None if springs is None else springs.design(gears)
        shown_train = described(scene, gears, train, sources)
        design: Mapping[str, Any] = untyped(ServoDesign(train=shown_train, stiffness=stiffness))
        return design

    return shown


def _errors(scene: Scene) -> dict[str, str]:
    """Return the objective of every budget, by its rule."""
    rules = [b.rule for b in scene.budget] or [BudgetTable().rule]
    return {rule: ERROR if len(rules) == 1 else f"{rule}_{ERROR}" for rule in rules}


def _tolerances(
    scene: Scene, gears: Pairs, names: Sequence[str], method: str | None
) -> Problem | Conic:
    """Return cost and errors of tolerances: cones, or grades; the limits of the budgets hold."""
    table, lost = scene.tolerances, tolerance_part.start(scene, gears)
    assert table is not None
    if (none := tolerance_part.spent(scene, gears)) is not None:
        return impossible("tolerance", names, none)
    if table.grades is not None:
        if method == EPSILON:
            raise SolveError(f"{EPSILON} is for real-valued tolerances; grades are for {EXACT}")
        return grades.problem(tolerance_part.grades(scene, gears), names, lost)
    stack = tolerance_part.stack(scene, gears)
    if not stack.exponent.all():
        raise SolveError(
            "a cost of exponent 0 grows with the logarithm, which cones do not have: write an "
            "exponent above 0 in [tolerances] and every [[cost]]"
        )
    if not stack.least.all():
        raise SolveError(
            "the error has no least value where tolerances may be as small as one likes: write "
            "least_factor = 0.25 in [tolerances], or another part of the old ones"
        )
    return conic.several(stack, {v: k for k, v in _errors(scene).items()}, names, lost)


def _allotted(scene: Scene, gears: Pairs) -> Callable[[Array], Mapping[str, Any]]:
    """Return how the tolerances of a point are shown, each beside the old one, with the gears."""
    train: Mapping[str, Any] = untyped(ServoDesign(train=described(scene, gears)))
    if tolerance_part.spent(scene, gears):
        return lambda _: train  # there is no point
    listed = tolerance_part.listed(scene, tolerance_part.stack(scene, gears))
    before = tolerance_part.old(scene)

    def shown(x: Array) -> Mapping[str, Any]:
        return {**train, "tolerances": untyped(listed(tolerance_part.widths(scene, x, before)))}

    return shown
