"""What all views of a layout share: where its walls are, the box, a dimension across, keep-outs."""

from gearopt.formulations.layout.layout_design import KeepOutDesign, LayoutDesign
from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import along, box_corners, sides
from gearopt.report.pages.labels import SIZE, Place
from gearopt.report.pages.sheet import Sheet


def walls(found: LayoutDesign, axis: str) -> tuple[float, float]:
    """Both ends of the box along an axis, mm."""
    return along(box_corners(found), axis)


def box_lines(sheet: Sheet, found: LayoutDesign, across: str, upright: str) -> None:
    """The box, and in the front view how near to it a gear may come."""
    (left, right), (bottom, top) = walls(found, across), walls(found, upright)
    sheet.rectangle((left, bottom), (right, top), "box")
    wall = found.clearances.wall_mm
    if wall and across == "y":
        sheet.rectangle((left + wall, bottom + wall), (right - wall, top - wall), "wall")


def across_dimension(
    sheet: Sheet, found: LayoutDesign, across: str, upright: str, measures: Measures
) -> None:
    """The box's dimension across, below all that is drawn."""
    (left, right), bottom = walls(found, across), walls(found, upright)[0]
    away = sheet.height - 18.0 - sheet.at(left, bottom)[1]
    sheet.dimension((left, bottom), (right, bottom), away, measures.length(right - left))


def keep_out(
    sheet: Sheet, it: KeepOutDesign, across: str, upright: str, hatched: bool = True
) -> None:
    """A rectangle with its name; only its outline where what is behind it must be seen."""
    a, b = zip(sides(it, across), sides(it, upright), strict=True)
    title = f"keep-out: {it.name}"
    if not hatched:
        sheet.rectangle(a, b, "obstacle before", title=title)
        return
    sheet.rectangle(a, b, "obstacle", title=title)
    sheet.hatch(a, b)
    x, y = sheet.at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    half = sheet.scale * abs(b[1] - a[1]) / 2
    offsets = (0.0, 0.5 * half, -0.5 * half, half + SIZE, -half - SIZE)
    places = [Place(x, y + dy, 0.0, 3.0 * k) for k, dy in enumerate(offsets)]
    sheet.label(it.name, places, "obstacle")
