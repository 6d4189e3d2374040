"""Remedies of an impossible drive that ratings limit: each number of the file alone."""

from collections.abc import Callable

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedies
from gearopt.optimise.explaining.handles import Handle
from gearopt.scenes.drive.explaining.influences import eases
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.default import alone
from gearopt.scenes.explaining.numbers import Number, numbers

DUTY = ("duty", "power")


def remedies(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Remedies:
    """Return each number of the file that alone makes the drive possible, smallest changes first.

    status(scene): of a changed drive, solved.
    """
    found = []
    for number in sorted(numbers(scene), key=_slow):
        given = number.path == DUTY
        way = -1 if given else eases(scene, number)
        if way and not clock.over:
            found.append(alone(scene, number, _handle(number, way, given), clock, status))
    known = sorted((r for r in found if r), key=lambda r: (r.kind == "less", r.factor))
    words = "the numbers of the file were moved one by one, not together"
    late = "the budget ended before all remedies were tried"
    return Remedies((), tuple(known), late if clock.over else words)


def _slow(number: Number) -> bool:
    """Return whether a number widens ranges of teeth, which takes longest: those come last."""
    return any(str(step).endswith("_teeth") for step in number.path)


def _handle(number: Number, direction: int, given: bool) -> Handle:
    return Handle(number.key, "parameter", 0, 0.0, direction, key=number.key, given=given)
