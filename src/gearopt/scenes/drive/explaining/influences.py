"""What every number of a drive's file does to its objective."""

import math
from collections.abc import Iterator
from typing import Any

from gearopt.formulations import sizing
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import slopes
from gearopt.optimise.explaining.explanation import Influence
from gearopt.optimise.explaining.repair import value_within
from gearopt.optimise.explaining.sensitivity import sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.terms import Array
from gearopt.physics.gears import MODULES
from gearopt.scenes.drive.explaining.cures import next_module
from gearopt.scenes.drive.explaining.levers import FIELDS
from gearopt.scenes.drive.explaining.numbers import Number, eased, moved, numbers, times
from gearopt.scenes.drive.scene import Scene

STEPS = (-1e-5, 1e-5)  # of ln input: how parameters follow from the numbers of the file
EASE = 0.01  # the step whose price is told; one for teeth, the next one for modules


def influences(
    scene: Scene, result: Result, ideal: Array | None, clock: Clock, solved: Any
) -> Iterator[Influence]:
    """What every number of the file does to the objective.

    Sensitivities are those of real-valued sizes (at the point `ideal` of their problem; None: none
    known); prices are of the drive as it is: solved(scene) -> objective, or None.
    """
    scene = _spelt(scene)
    base = sizing.problem(scene.train())
    slope = None if ideal is None else sensitivities(base, ideal)
    value = None if ideal is None else float(base.batch(ideal[None]).F[0, 0])
    for number in numbers(scene):
        if clock.over:
            return
        if number.path[:2] == ("teeth", "modules") and _is_series(scene):
            continue

        def resolved(factor: float, number: Number = number) -> float | None:
            other = moved(scene, number.path, times(number.value, factor))
            return None if other is None else value_within(clock, sizing.problem(other.train()))

        own: float | None = None
        both: tuple[float | None, float | None] = (None, None)
        if slope is not None and value is not None and _smooth(scene, number):
            own, both = _chained(scene, number, base, slope), slopes(value, resolved)
        step, price = _price(scene, number, result, solved)
        if clock.over:  # the row may be half done
            return
        yield Influence(number.key, number.text, own, both, step, price)


def _smooth(scene: Scene, number: Number) -> bool:
    """Whether a small relative change of a number means anything.

    Zero has none, and of a series the next module counts.
    """
    in_series = scene.teeth is not None and _is_range(number) and "module" in number.path
    return bool(getattr(number.value, "number", number.value)) and not in_series


def _spelt(scene: Scene) -> Scene:
    """The scene with the load limits that a preset sets written out."""
    limits = scene.limits
    if limits.preset is None:
        return scene
    loads = {name: limits.load(name) for name in ("k_factor", "unit_load")}
    return scene.model_copy(update={"limits": limits.model_copy(update={"preset": None, **loads})})


def _is_range(number: Number) -> bool:
    return isinstance(number.path[-1], int)


def _is_series(scene: Scene) -> bool:
    return scene.teeth is not None and scene.teeth.modules in MODULES.values()


def _chained(scene: Scene, number: Number, base: Problem, slope: Any) -> float | None:
    """D ln objective / d ln number, through the parameters and given sizes that follow from it.

    None where the rules of the file allow one side alone: there multipliers are not unique.
    """
    import numpy as np

    below, above = (moved(scene, number.path, times(number.value, math.exp(s))) for s in STEPS)
    if below is None or above is None:
        return None
    ends = [sizing.problem(other.train()) for other in (below, above)]
    width = STEPS[1] - STEPS[0]
    lower, upper, _ = base.bounds()
    given = lower == upper
    with np.errstate(invalid="ignore", divide="ignore"):
        values = [np.log(e.parameter_values()) for e in ends]
        rates = np.nan_to_num((values[1] - values[0]) / width)
        sizes = [np.where(given, e.bounds()[0], 1.0) for e in ends]
        moves = np.log(sizes[1] / sizes[0]) / width
    return float(slope.parameters @ rates + slope.columns @ moves) + 0.0


def _price(scene: Scene, number: Number, result: Result, solved: Any) -> tuple[str, float | None]:
    """The step that eases a limit of the file, and what it brings; "" for what is no limit."""
    direction = _eases(number)
    if direction == 0 or result.value is None:
        return "", None
    value: Any
    if scene.teeth is not None and "module" in number.path:
        value = next_module(scene, number.value, direction)
        step = f"to {value}"
    elif isinstance(number.value, int):
        value, step = number.value + direction, f"{direction:+d}"
    else:
        value = eased(number.value, 1.0 + EASE, direction)
        step = f"{direction * EASE:+.0%}"
    other = None if value is None else moved(scene, number.path, value)
    if other is None:
        return "", None
    found = solved(other)
    return step, None if found is None else (found - result.value) / abs(result.value)


def _eases(number: Number) -> int:
    """+1 or -1: the direction that eases a limit of the file; 0 for what is no limit."""
    path = number.path
    if path == ("duty", "ratio_tolerance"):
        return 1 if number.value else 0
    end = path[-1] if isinstance(path[-1], int) else None
    field = path[-2] if end is not None else path[-1]
    for name, place in FIELDS.items():
        if place == (field, end) and path[0] in ("limits", "stage", "gears"):
            ranged = end is not None or name in ("k_factor", "unit_load", "wheel_diameter")
            return 0 if not ranged else (-1 if end == 0 else 1)
    return 0
