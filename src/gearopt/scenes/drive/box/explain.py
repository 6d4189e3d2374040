"""What the numbers of a layout cost: the box solved again with each a little smaller and larger."""

from collections.abc import Iterator
from dataclasses import replace

from gearopt.formulations import layout
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import slopes
from gearopt.optimise.explaining.explanation import Explanation, Influence
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.box.lay_out import pairs_of
from gearopt.scenes.drive.box.ways import gearbox_of
from gearopt.scenes.drive.explaining.numbers import Number, numbers, put, times
from gearopt.scenes.drive.scene import Scene
from gearopt.units import Quantity

COARSE = 0.01  # gap of the proof behind a slope: the polished layout is far better than that
SAME = 1e-7  # relative, of boxes that are equal


def explained(scene: Scene, result: Result, clock: Clock) -> Explanation:
    """The answer of a layout with the slope of the box over every number of its tables."""
    if result.status not in CERTAIN or result.value is None:
        return Explanation(result, message="slopes need a proven layout", seconds=clock.seconds)
    gears = next((p for p in result.parts if p.name == "gears"), result)
    found = tuple(_influences(scene, pairs_of(scene, gears), result.value, clock))
    late = ", and time ran out" if clock.over else ""
    used = tuple(n for n, v in result.limits.items() if v > 1.0 - SAME)
    return Explanation(
        result,
        binding=used,
        influences=found,
        message=f"slopes are those of the box around these gears{late}",
        seconds=result.seconds + clock.seconds,
    )


def _influences(
    scene: Scene, pairs: tuple[GearPair, ...], value: float, clock: Clock
) -> Iterator[Influence]:
    for number in numbers(scene):
        tables = ("layout", "place", "keep_out")
        if number.path[0] not in tables or not isinstance(number.value, Quantity):
            continue
        if not number.value.number:  # of nothing there is no per cent
            continue

        def resolved(factor: float, number: Number = number) -> float | None:
            box = gearbox_of(put(scene, number.path, times(number.value, factor)), pairs)
            if box is None or layout.faults(box):
                return None
            left = replace(clock.left, gap=COARSE)
            return solve(layout.problem(box), None, left, watch=clock.watch, gap=COARSE).value

        both = slopes(value, resolved)
        if clock.over:
            return
        yield Influence(number.key, number.text, None, both)
