"""What all views of a layout share: where its walls are, the box, a dimension across, keep-outs."""

from collections.abc import Mapping
from typing import Any

from gearopt.report.pages.labels import SIZE, Place
from gearopt.report.pages.sheet import Sheet

Layout = Mapping[str, Any]


def walls(found: Layout, axis: str) -> tuple[float, float]:
    """Both ends of the box along an axis, mm."""
    box = found["box"]
    if axis == "x":
        return 0.0, box["length_mm"]
    low = box["left_mm"] if axis == "y" else box["bottom_mm"]
    return low, low + (box["width_mm"] if axis == "y" else box["height_mm"])


def box_lines(sheet: Sheet, found: Layout, across: str, upright: str) -> None:
    """The box, and in the front view how near to it a gear may come."""
    (left, right), (bottom, top) = walls(found, across), walls(found, upright)
    sheet.rectangle((left, bottom), (right, top), "box")
    wall = found["clearances"].get("wall_mm") or 0.0
    if wall and across == "y":
        sheet.rectangle((left + wall, bottom + wall), (right - wall, top - wall), "wall")


def across_dimension(sheet: Sheet, found: Layout, across: str, upright: str) -> None:
    """The box's dimension across, below all that is drawn."""
    (left, right), bottom = walls(found, across), walls(found, upright)[0]
    away = sheet.height - 18.0 - sheet.at(left, bottom)[1]
    sheet.dimension((left, bottom), (right, bottom), away, f"{right - left:.2f}")


def keep_out(sheet: Sheet, it: Layout, left: str, right: str, bottom: str, top: str) -> None:
    """A hatched rectangle between the named ends, with its name."""
    a, b = (it[left], it[bottom]), (it[right], it[top])
    sheet.rectangle(a, b, "obstacle", title=f"keep-out: {it['name']}")
    sheet.hatch(a, b)
    x, y = sheet.at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    half = sheet.scale * abs(b[1] - a[1]) / 2
    offsets = (0.0, 0.5 * half, -0.5 * half, half + SIZE, -half - SIZE)
    sheet.label(
        it["name"], [Place(x, y + dy, 0.0, 3.0 * k) for k, dy in enumerate(offsets)], "obstacle"
    )
