"""A gearbox layout as a technical drawing: along the shafts, from the side, from above."""

from gearopt.formulations.layout.layout_design import LayoutDesign
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import along, drawn_corners, layout_of
from gearopt.report.pages.layout_front import front_view
from gearopt.report.pages.layout_side import side_view
from gearopt.report.pages.sheet import Window
from gearopt.report.section import Section

WIDE, HIGH = 640.0, 780.0  # largest drawing [px]: two side by side, or one on a printed page


def section(result: Result, measures: Measures) -> Section | None:
    """The views of a layout, all at one scale; None where there is no layout."""
    if (found := layout_of(result)) is None:
        return None
    windows = [_window(found, axis) for axis in ("", "z", "y")]
    scale = min(window.scale(WIDE, HIGH) for window in windows)
    words = [
        f"Drawn to one scale; dimensions in {measures.lengths}. The axis of shaft 1, the input, "
        f"is y = z = 0; shaft {len(found.shafts)} is the output. Dash-dotted circles are "
        "reference circles, solid ones tip circles; numbers in circles are shafts. The thin dashed "
        "line is as far from the wall as every gear has to stay."
    ]
    if found.obstacles:
        words.append("Hatched boxes must stay free; those that reach far out are cut off.")
    if found.motor:
        words.append("No length of the motor was given: it is drawn as long as it is wide.")
    views = (
        front_view(found, windows[0], scale, measures),
        side_view(found, windows[1], scale, "z", measures),
        side_view(found, windows[2], scale, "y", measures),
    )
    return Section("Layout", words=words, drawings=views)


def _window(found: LayoutDesign, axis: str) -> Window:
    """Of the front view, or of the view whose upright axis is given, with all that is drawn."""
    ends = drawn_corners(found)
    (bottom, top), (left, right) = along(ends, axis or "z"), along(ends, "x" if axis else "y")
    free = (20.0, 44.0, 48.0, 44.0) if axis else (52.0, 20.0, 48.0, 44.0)
    return Window(left, right, bottom, top, free)
