"""Plots over the path of contact with its zones, which follow the animation of the pair in mesh."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.geometry.contact import ContactPath
from gearopt.physics.mesh_cycle import NARROW, break_points
from gearopt.report.drawing.sheet import series
from gearopt.report.kinds.pair.mesh_motion import Carried
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, band, layout, upright
from gearopt.report.plots import lines as curve

HEIGHT = 340  # px
AXIS_MARGIN = 0.03  # of the path that is seen beyond its ends
LETTER_SPACING = 0.03  # of the path: letters of points that are closer stand as one
LETTERS = {"SAP": "A", "LPSTC": "B", "HPSTC": "D", "EAP": "E"}  # as drawings name them
DASHES = ("dash", "dot")  # of lines across


@dataclass(frozen=True)
class Line:
    """A curve over the path, in shown units: values (N,) of the mesh, or (N, K) of pairs of teeth.

    Those of pairs may be a column (M,) that one pair meets, as `Carried.along` gives it.
    colour: of the series, from 1. dash: as plotly has it. name: "" stands in no legend. width: px.
    """

    values: Any
    name: str
    colour: int
    dash: str = "solid"
    width: float = 2.0


def over_path(
    carried: Carried,
    path: ContactPath,
    lines: Sequence[Line],
    head: str,
    caption: str,
    measures: Measures,
    follows: str = "",
    level: Sequence[tuple[str, float]] = (),
) -> Figure:
    """Plot what pairs meet on their path, both sides of points where pairs come and go.

    head: name and unit of the values. follows: the animation whose moment is marked. level:
    names and values of lines across, at most two.
    """
    x = carried.along(carried.positions) * measures.of(1.0, "mm")
    traces = [_trace(line, x, carried) for line in lines]
    unit, (low, high) = measures.unit("mm"), (x[0], x[-1])
    for (name, value), dash in zip(level, DASHES, strict=False):
        ends = [float(low), float(high)], [value, value]
        traces.append(curve(*ends, "--soft", 1.4, dash, name=name, hoverinfo="skip"))
    room = AXIS_MARGIN * (high - low)
    shapes, notes = zones(path, measures)
    plot = layout(
        axis(f"position s on the line of action [{unit}]", range=[low - room, high + room]),
        axis(head, rangemode="tozero"),
        HEIGHT,
        shapes=shapes,
        annotations=notes,
        hovermode="x",
    )
    named = [trace for trace in traces if trace["name"]]
    plot["margin"] |= {"t": 44 if len(named) > 1 else 24}
    plot["legend"] |= {"y": 1.08}
    return Figure(traces, plot, caption, follows=follows)


def zone_words(path: ContactPath, relieved: bool = False) -> str:
    """Meaning of the letters and the shading of `over_path`."""
    without = "without relief " * relieved
    alone = f"B to D, shaded: {without}one pair of teeth carries alone"
    fewest = f"shaded: {without}the fewest pairs of teeth carry"
    shaded = alone if path.transverse_ratio < 2.0 else fewest
    return f"A to E: path of contact; {shaded}; C: pitch point."


def _trace(line: Line, x: Any, carried: Carried) -> dict[str, Any]:
    values = np.asarray(line.values)
    if len(values) == len(carried.travels):
        wide = np.broadcast_to(values.T, carried.positions.T.shape).T
        values = carried.along(wide)
    places, heights = [round(float(v), 5) for v in x], [float(f"{v:.6g}") for v in values]
    colour, named = series(line.colour), bool(line.name)
    trace = curve(places, heights, colour, line.width, line.dash, hover="%{y:.4g}")
    return trace | {"name": line.name, "showlegend": named}


def zones(
    path: ContactPath, measures: Measures
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Shapes and names of the points of the path, and where the fewest pairs touch."""
    ratio, pitch = float(path.transverse_ratio), float(path.base_pitch)
    whole = int(ratio + NARROW)
    unit = measures.of(1.0, "mm")
    shapes: list[dict[str, Any]] = []
    for k in range(whole):
        ends = [float(path.end) - (whole - k) * pitch, float(path.start) + (k + 1) * pitch]
        shapes.append(band(unit * ends[0], unit * ends[1]))
    points = {LETTERS.get(name, ""): s for name, s in break_points(path).items()}
    points |= {"C": 0.0} if path.start < 0.0 < path.end else {}
    notes: list[dict[str, Any]] = []
    last = -np.inf
    for name, s in sorted(points.items(), key=lambda row: row[1]):
        shapes.append(upright(unit * s))
        if s - last < LETTER_SPACING * float(path.length):
            notes[-1]["text"] += f" {name}"
            continue
        last = s
        place = {"x": unit * s, "y": 1.0, "yref": "paper", "yanchor": "bottom", "text": name}
        notes.append(place | {"showarrow": False, "font": {"size": 12, "color": "--soft"}})
    return shapes, notes
