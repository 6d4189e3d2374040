"""Drawings as DXF, in millimetres: the marks of their sheets, side by side, in layers."""

import io
import math
from collections.abc import Iterable
from typing import Any

from gearopt.report.drawing.sheet import LETTER, SIZE, Drawing, Mark

EXTRA = "a DXF needs ezdxf: pip install 'gearopt[dxf]'"
LAYERS = {  # colour by number of AutoCAD, line type
    "teeth": (7, "CONTINUOUS"),
    "circles": (3, "CONTINUOUS"),
    "bodies": (8, "CONTINUOUS"),
    "axes": (1, "CENTER"),
    "dimensions": (5, "CONTINUOUS"),
    "text": (2, "CONTINUOUS"),
}
DIMENSIONS = ("size", "extension", "leader", "gap", "size head")  # styles of lines
AXES = ("axis", "centres")
APART = 0.05  # of the widest drawing, between two
FONT = "gearopt"


def dxf(drawings: Iterable[Drawing]) -> bytes:
    """The drawings side by side; ImportError without ezdxf, ValueError where there is none."""
    shown = [drawing for drawing in drawings if drawing.marks]
    if not shown:
        raise ValueError("there is nothing to draw: no gears of whole teeth, no layout")
    try:
        import ezdxf
    except ImportError as missing:
        raise ImportError(EXTRA) from missing
    document = ezdxf.new("R2010", setup=True, units=ezdxf.units.MM)
    document.styles.add(FONT, font="arial.ttf")
    for name, (colour, linetype) in LAYERS.items():
        document.layers.add(name, color=colour, linetype=linetype)
    room = APART * max(d.frame[1][0] - d.frame[0][0] for d in shown)
    space, x = document.modelspace(), 0.0
    for drawing in shown:
        (left, bottom), (right, _) = drawing.frame
        for mark in drawing.marks:
            _draw(space, mark, (x - left, -bottom))
        size = SIZE / drawing.width * (right - left)
        _text(space, drawing.caption, (x, -2.0 * size), size, "TOP_LEFT")
        x += max(right - left, 1.3 * LETTER * size * len(drawing.caption)) + room
    text = io.StringIO()
    document.write(text)
    return text.getvalue().encode()


def layer(mark: Mark) -> str:
    """The layer of a mark: text and dimensions, axes, outlines of teeth, circles, other bodies."""
    if mark.form in ("text", "dimension"):
        return {"text": "text", "dimension": "dimensions"}[mark.form]
    if mark.style in DIMENSIONS:
        return "dimensions"
    if mark.style in AXES and mark.form == "line":
        return "axes"
    if mark.form in ("circle", "arc"):
        return "circles"
    return "teeth" if mark.style == "tip" and len(mark.points) > 4 else "bodies"


def _draw(space: Any, mark: Mark, by: tuple[float, float]) -> None:
    """Add a mark to the space, moved by some mm."""
    look = {"layer": layer(mark)}
    if mark.style in ("reference", "centres"):
        look["linetype"] = "CENTER"
    points = [(x + by[0], y + by[1]) for x, y in mark.points]
    if mark.form == "circle":
        space.add_circle(points[0], mark.size, dxfattribs=look)
    elif mark.form == "arc":
        space.add_arc(points[0], mark.size, *map(math.degrees, mark.ends), dxfattribs=look)
    elif mark.form == "line":
        space.add_line(*points, dxfattribs=look)
    elif mark.form == "outline":
        bulges = mark.bulges or (0.0,) * len(points)
        rows = [(x, y, bulge) for (x, y), bulge in zip(points, bulges, strict=True)]
        space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs=look)
    elif mark.form == "text":
        _text(space, mark.text, points[0], mark.size, "MIDDLE_CENTER", mark.ends[0])
    else:
        _dimension(space, mark, points)


def _text(
    space: Any, text: str, at: tuple[float, float], size: float, align: str, turn: float = 0.0
) -> None:
    """Add a text; align: a name of ezdxf's TextEntityAlignment."""
    from ezdxf.enums import TextEntityAlignment

    look = {"layer": "text", "style": FONT, "rotation": math.degrees(turn)}
    entity = space.add_text(text, height=size, dxfattribs=look)
    entity.set_placement(at, align=TextEntityAlignment[align])


def _dimension(space: Any, mark: Mark, points: list[tuple[float, float]]) -> None:
    """Add a dimension between two points, level or upright, that measures them."""
    a, b, base = points
    upright = abs(b[0] - a[0]) < abs(b[1] - a[1])
    size = mark.size
    look = {"dimtxt": size, "dimasz": 0.75 * size, "dimexe": 0.4 * size, "dimexo": 0.2 * size}
    style = look | {"dimgap": 0.3 * size, "dimtxsty": FONT, "dimlfac": 1.0}
    space.add_linear_dim(
        base=base,
        p1=a,
        p2=b,
        angle=90.0 if upright else 0.0,
        text=mark.text.replace("⌀", "%%c"),
        override=style,
        dxfattribs={"layer": "dimensions"},
    ).render()
