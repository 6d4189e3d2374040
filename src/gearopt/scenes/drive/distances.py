"""Centre distances: those a stage may have, and those of all stages that go together."""

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from gearopt.physics.gears import transverse_pressure_angle
from gearopt.physics.geometry.profile_shift import SUMS
from gearopt.scenes.drive.driving import largest_ratio
from gearopt.scenes.drive.tables.drive import Limits, StageTable
from gearopt.scenes.reading.fields import refuse

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

MAX_ROWS = 20_000  # rows of centre distances of all stages

Row = tuple[Fraction, ...]


def reach(scene: "Scene", own: StageTable) -> tuple[float, float]:
    """Ends of the centre distances [mm] that teeth of a stage may have, whatever their shifts.

    By base circles that touch, and y <= x1 + x2 <= 2 modules.
    """
    modules, limits = scene.modules(own), scene.limits
    fewest, most = own.pinion_teeth or limits.pinion_teeth
    wheels = own.wheel_teeth or limits.wheel_teeth or (1, None)
    ratios = own.stage_ratio or limits.stage_ratio or (Fraction(1), None)
    top = largest_ratio(scene.duty)
    top = top if ratios[1] is None else min(top, ratios[1])
    teeth = fewest * (1 + ratios[0]), most * (1 + top)
    if wheels[1] is not None:
        teeth = teeth[0], min(teeth[1], Fraction(most + wheels[1]))
    helices = [angle.value for angle in scene.helix_angles(own)]
    normal = (own.pressure_angle or scene.gears.pressure_angle).value
    base = math.cos(transverse_pressure_angle(normal, max(helices)))
    low = 0.5 * base * float(min(modules) * teeth[0]) / math.cos(min(helices))
    high = 0.5 * float(max(modules) * teeth[1]) / math.cos(max(helices))
    return low, high + SUMS[1] * float(max(modules))


def joint_limits(limits: Limits) -> list[str]:
    """The limits that bind centre distances of all stages together."""
    return [n for n in ("sum_of_centre_distances", "coaxial") if getattr(limits, n)]


def rows_together(
    limits: Limits, lists: Sequence[Sequence[Fraction]], lacks: str
) -> tuple[tuple[float, ...], ...]:
    """Rows of centre distances [mm] that go together.

    lists: the distances that each stage chooses from, none: it is given none. lacks: what the file
    lacks to choose at all. SceneError where no row goes together.
    """
    place = ("limits", joint_limits(limits)[0])
    if lacks or not all(lists):
        rule = f"needs {lacks or 'a centre_distance to choose from in every [[stage]]'}"
        raise refuse(rule, at=place, action="remove")
    if limits.coaxial and len(lists) != 2:
        raise refuse("needs two stages", at=("limits", "coaxial"), action="remove")
    if math.prod(map(len, lists)) > MAX_ROWS:
        rule = f"has above {MAX_ROWS:,} rows of distances to look at: give shorter lists"
        raise refuse(rule, at=place, action="tell")
    rows = sorted(itertools.product(*lists))
    if limits.coaxial:
        rows = [row for row in rows if row[0] == row[1]]
        if not rows:
            rule = "is asked of stages that have no centre_distance in common"
            raise refuse(rule, at=("limits", "coaxial"), action="remove")
    return tuple(tuple(map(float, row)) for row in _of_sum(limits, rows))


def _of_sum(limits: Limits, rows: list[Row]) -> list[Row]:
    """The rows of the sum that is asked for."""
    span = limits.sum_of_centre_distances
    if span is None:
        return rows
    low, high = (end.exact[0] for end in span)
    excess = {row: max(low - sum(row), sum(row) - high) for row in rows}
    nearest = min(rows, key=lambda row: (excess[row], row))
    if excess[nearest] > 0:
        rule, place = "is the sum of no distances of the stages", "sum_of_centre_distances"
        raise refuse(rule, str(span[0].of(Fraction(sum(nearest)))), ("limits", place), "sample")
    return [row for row in rows if excess[row] <= 0]
