"""The edge of a cutter at a large scale on a grid, as a toolmaker plots it."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import CutterDesign
from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.report.drawing.sheet import SHEET, Drawing, Place, Sheet, Window, series
from gearopt.report.measures import Measures

Frame = tuple[float, float, float, float]
PX_PER_MM = 96.0 / 25.4  # of a screen and of paper as browsers print it
MARGINS = (46.0, 16.0, 34.0, 16.0)  # px around the edge
MAX_LINES = 60  # of the grid across and upwards at most: coarser ones are taken beyond
SIDE_MARGIN = 0.06  # of the width of two teeth, that is free beside them
LINES_PER_NUMBER = (
    1,
    2,
    4,
    10,
    20,
    40,
    100,
    200,
)  # lines of the grid from one with a number to the next
NUMBER_SPACING = 60.0  # px between numbers at least
GRID_MULTIPLES = tuple(s * 10.0**k for k in range(12) for s in (1.0, 2.0, 5.0))  # times the grid


def drawing(
    tool: CutterDesign, pitch: float, scale: float, grid: float, measures: Measures
) -> Drawing:
    """Draw two teeth of a cutter at a scale on a grid [mm], with the straight edge instead.

    pitch [mm] of a rack. x is upwards, away from the blank; y to the right, 0 in the middle of a
    space for a tooth of the blank. On paper at full size the scale is true.
    """
    edge, teeth = np.c_[tool.x_mm, tool.y_mm], _teeth(tool, pitch)
    ends, step = _frame(teeth, grid)
    sheet = Sheet(Window(*ends, MARGINS), scale * PX_PER_MM)
    _grid(sheet, ends, step, measures)
    for tooth in teeth:
        sheet.outline([(u, v) for u, v in tooth.tolist()], "tip", series(1), "tooth of the cutter")
    if tool.straight_deg:
        _straight(sheet, tool, SIDE_MARGIN * (ends[1] - ends[0]))
    for v, u in edge[::5].tolist():
        sheet.circle(u, v, 2.0 / sheet.scale, "design")
    name = f"pinion-type cutter of {tool.teeth} teeth" if tool.teeth else "rack"
    caption = (
        f"Active part of two teeth of a {name} at {scale:g}:1, grid {measures.length(step, 3)} "
        f"{measures.lengths}; every fifth point of the CSV is marked."
    )
    if tool.straight_deg:
        caption += f" Dashed: the straight edge of least deviation, {tool.straight_deg:.3f}°."
    return replace(sheet.drawing("cutting edge", caption), true=True)


def of_flanks(design: WaveDesign) -> Iterator[Drawing]:
    """Yield a tooth of the flexspline, and a space of the circular spline: for CAD."""
    for name, across, up in (
        ("tooth of the flexspline", design.tooth_half_mm, design.tooth_height_mm),
        ("space of the circular spline", design.space_across_mm, design.space_out_mm),
    ):
        right = list(zip(across, up, strict=True))
        wide = max(across)
        sheet = Sheet(window := Window(-wide, wide, min(up), max(up)), window.scale(SHEET, SHEET))
        sheet.outline([*right, *((-x, y) for x, y in reversed(right))], "tip", title=name)
        sheet.line((0.0, min(up)), (0.0, max(up)), "axis")
        yield sheet.drawing(name, name)


def usual_scale(tool: CutterDesign, pitch: float, grid: float) -> float:
    """The largest of 1, 2, 5, 10 ... to 5000 at which two teeth fit on a sheet of A4."""
    width = breadth(tool, pitch, grid)
    room = (SHEET - MARGINS[0] - MARGINS[1]) / PX_PER_MM
    scales = (s * 10.0**k for k in range(4) for s in (1.0, 2.0, 5.0))
    return max((s for s in scales if s * width <= room), default=1.0)


def breadth(tool: CutterDesign, pitch: float, grid: float) -> float:
    """Width [mm] of what a drawing shows, before its scale."""
    (left, right, _, _), _ = _frame(_teeth(tool, pitch), grid)
    return right - left


def _teeth(tool: CutterDesign, pitch: float) -> list[Any]:
    """The outlines of two teeth: y across, x upwards."""
    edge = np.c_[tool.x_mm, tool.y_mm]
    tooth = np.vstack([edge, _mirrored(tool, edge, pitch)[::-1]])
    return [tooth[:, ::-1], (tooth * (1.0, -1.0))[:, ::-1]]


def _frame(teeth: list[Any], grid: float) -> tuple[Frame, float]:
    """The ends of what is shown, left, right, bottom and top, on lines of a grid; its step.

    The step is the grid [mm], or a multiple of it where there would be more than MAX_LINES.
    """
    x, y = np.vstack(teeth).T
    room = SIDE_MARGIN * float(np.ptp(x))
    span = max(np.ptp(x), np.ptp(y)) + 2 * room
    step = next((s * grid for s in GRID_MULTIPLES if span < MAX_LINES * s * grid), span)
    low = [float(np.floor((v.min() - room) / step) * step) for v in (x, y)]
    high = [float(np.ceil((v.max() + room) / step) * step) for v in (x, y)]
    return (low[0], high[0], low[1], high[1]), step


def _mirrored(tool: CutterDesign, edge: Any, pitch: float) -> Any:
    """The edge on the other side of the cutter's tooth."""
    if not tool.teeth:
        return edge * (1.0, -1.0) + (0.0, pitch)
    z = edge[:, 0] + 1j * edge[:, 1]
    axis = math.pi - math.pi / tool.teeth
    other = np.conj(z) * np.exp(2j * axis)
    return np.c_[other.real, other.imag]


def _straight(sheet: Sheet, tool: CutterDesign, room: float) -> None:
    """Draw the straight edge of least deviation over the exact one."""
    x, y = np.array(tool.x_mm), np.array(tool.y_mm)
    slope = -math.tan(math.radians(tool.straight_deg))
    offset = 0.5 * float((y - slope * x).min() + (y - slope * x).max())
    first, last = float(x.min()) - room, float(x.max()) + room
    sheet.line((slope * first + offset, first), (slope * last + offset, last), "far")


def _grid(sheet: Sheet, ends: Frame, step: float, measures: Measures) -> None:
    """Draw the grid with its coordinates."""
    left, right, bottom, top = ends
    across = np.arange(round(left / step), round(right / step) + 1) * step
    up = np.arange(round(bottom / step), round(top / step) + 1) * step
    every = next(
        (n for n in LINES_PER_NUMBER if n * sheet.scale * step >= NUMBER_SPACING),
        LINES_PER_NUMBER[-1],
    )
    for v in map(float, across):
        named = round(v / step) % every == 0
        sheet.line((v, bottom), (v, top), "extension" if named else "grid")
        if named:
            u, w = sheet.at(v, bottom)
            sheet.label(measures.length(v, 3), [Place(u, w + 14.0)], "size")
    for v in map(float, up):
        named = round(v / step) % every == 0
        sheet.line((left, v), (right, v), "extension" if named else "grid")
        if named:
            u, w = sheet.at(left, v)
            sheet.label(measures.length(v, 3), [Place(u - 24.0, w)], "size")
