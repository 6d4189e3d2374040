"""Remedies of an impossible drive that ratings limit: each number of the file alone."""

from collections.abc import Callable

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import THERE
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.explaining.handles import Handle
from gearopt.scenes.drive.explaining.influences import eases
from gearopt.scenes.drive.explaining.movable import next_module
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.default import alone
from gearopt.scenes.explaining.numbers import Number, apart, moved, numbers, written
from gearopt.scenes.reading.toml import toml_text

DUTY = ("duty", "power")


def remedies(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Remedies:
    """Return each number of the file that alone makes the drive possible, smallest changes first.

    status(scene): of a changed drive, solved.
    """
    found = [_own_materials(scene, clock, status)]
    for number in sorted(numbers(scene), key=_slow):
        given = number.path == DUTY
        way = -1 if given else eases(scene, number)
        if way and not clock.over:
            if scene.teeth is not None and "module" in number.path:
                found.append(_module(scene, number, way, clock, status))
            else:
                found.append(alone(scene, number, _handle(number, way, given), clock, status))
    known = sorted((r for r in found if r), key=lambda r: (r.kind == "less", r.factor))
    words = "the numbers of the file were moved one by one, not together"
    late = "the budget ended before all remedies were tried"
    return Remedies((), tuple(known), late if clock.over else words)


def _own_materials(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Remedy | None:
    """Return materials of every stage's own in place of the same for all, where they suffice."""
    if not scene.gears.same_materials or clock.over:
        return None
    gears = scene.gears.model_copy(update={"same_materials": False})
    if status(scene.model_copy(update={"gears": gears})) not in THERE:
        return None
    change = Change("gears.same_materials", "true", "false", 1.0)
    return Remedy("choice", "same_materials", (change,), 1.0, None, {"with": "feasible"})


def _module(
    scene: Scene, number: Number, way: int, clock: Clock, status: Callable[[Scene], str]
) -> Remedy | None:
    """Return the nearest module of [teeth] as the end of a range that takes, None if none does."""
    before, value = "infeasible", next_module(scene, number.value, way)
    while value is not None and not clock.over:
        other = moved(scene, number.path, value)
        found = "undecided" if other is None else status(other)
        if found in THERE:
            was, write = (toml_text(written(v, number.path)) for v in (number.value, value))
            change = Change(number.key, was, write, apart(number.value, value))
            verified = {"with": "feasible", "with_less": before}
            return Remedy("alone", number.key, (change,), change.factor, None, verified)
        before, value = found, next_module(scene, value, way)
    return None


def _slow(number: Number) -> bool:
    """Return whether a number widens ranges of teeth, which takes longest: those come last."""
    return any(str(step).endswith("_teeth") for step in number.path)


def _handle(number: Number, direction: int, given: bool) -> Handle:
    return Handle(number.key, "parameter", 0, 0.0, direction, key=number.key, given=given)
