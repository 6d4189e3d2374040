"""The objectives of a servo axis, and the problem of several of them at once."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.servo.servo_design import GOALS, ServoDesign
from gearopt.formulations.servo.train_front import front_problem
from gearopt.optimise.pareto.front import Objective
from gearopt.optimise.pareto.pareto import EPSILON, EXACT
from gearopt.optimise.pareto.several import Several
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.train_part import described, of_point


def objectives(scene: Scene) -> dict[str, str]:
    """Return what a front of the axis may minimise: name and unit."""
    if scene.train is None:
        return {}
    return {name: GOALS[name].shown for name in scene.servo_train().goals}


def several(scene: Scene, names: Sequence[str], method: str | None) -> Several:
    """Return the problem of a front; SolveError where a method does not fit it."""
    listed = tuple(Objective(name, unit) for name, unit in objectives(scene).items())
    listed = tuple(
        sorted((o for o in listed if o.name in names), key=lambda o: names.index(o.name))
    )
    choice = scene.choice()
    if method == EPSILON:
        raise SolveError(
            f"{EPSILON} is for real-valued sizes; a servo train's teeth are whole: "
            f"leave the method out, or write {EXACT}"
        )
    if choice.room is not None and method not in (None, EXACT):
        raise SolveError(f"a box that is required is kept by {EXACT} alone, not by {method}")
    return Several(front_problem(choice, names), listed, lambda x: _train(scene, x))


def _train(scene: Scene, x: Array) -> Mapping[str, Any]:
    gears, springs = of_point(scene, x), scene.springs
    stiffness = None if springs is None else springs.design(gears)
    found: Mapping[str, Any] = untyped(
        ServoDesign(train=described(scene, gears), stiffness=stiffness)
    )
    return found
