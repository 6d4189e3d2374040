"""What the numbers of a layout cost: the box solved again with each a little smaller and larger."""

from dataclasses import replace

from gearopt.formulations import layout
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import STEP
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.scenes.drive.box.lay_out import pairs_of
from gearopt.scenes.drive.box.ways import gearbox_of
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.influences import Basis, influences, smooth
from gearopt.scenes.explaining.numbers import numbers
from gearopt.units import Quantity

COARSE = 0.01  # gap of the proof behind a slope: the polished layout is far better than that
SAME = 1e-7  # relative, of boxes that are equal
TABLES = ("layout", "place", "keep_out")


def explained(scene: Scene, result: Result, clock: Clock) -> Explanation:
    """The answer of a layout with the slope of the box over every number of its tables."""
    if result.status not in CERTAIN or result.value is None:
        return Explanation(result, message="slopes need a proven layout", seconds=clock.seconds)
    pairs = pairs_of(scene, next((p for p in result.parts if p.name == "gears"), result))

    def solved(other: Scene) -> float | None:
        box = gearbox_of(other, pairs)
        if box is None or layout.faults(box):
            return None
        left = replace(clock.left, gap=COARSE)
        return solve(layout.problem(box), None, left, watch=clock.watch, gap=COARSE).value

    wanted = [
        n
        for n in numbers(scene)
        if n.path[0] in TABLES and isinstance(n.value, Quantity) and smooth(n)
    ]
    found = tuple(influences(scene, Basis(result.value, solved, step=STEP), clock, wanted))
    late = ", and time ran out" if clock.over else ""
    return Explanation(
        result,
        binding=tuple(n for n, v in result.limits.items() if v > 1.0 - SAME),
        influences=found,
        message=f"slopes are those of the box around these gears{late}",
        seconds=result.seconds + clock.seconds,
    )
