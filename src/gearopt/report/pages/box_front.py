"""The Pareto front of width and height of a box, as a plot."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Figure, Section, axis, layout
from gearopt.report.words import amount

LINES = 6  # of equal area


def section(result: Result, measures: Measures) -> Section | None:
    """Plot the Pareto front of box width and height; None where the run computed none."""
    front = result.report.get("front") or []
    if not front:
        return None
    points = sorted(
        (*(measures.of(p[key], "mm") for key in ("width_mm", "height_mm")), p["volume_mm3"])
        for p in front
    )
    unit = measures.unit("mm")
    widths, heights, volumes = zip(*points, strict=True)
    x0, x1 = _ends(widths)
    y0, y1 = _ends(heights)
    low, high = x0 * y0, x1 * y1
    areas = [low * (high / low) ** ((k + 0.5) / LINES) for k in range(LINES)]
    traces = [_equal(area, (x0, x1), (y0, y1), measures) for area in areas]
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "boxes",
            "x": widths,
            "y": heights,
            "text": [amount(v, "mm3", measures) for v in volumes],
            "hovertemplate": f"%{{x:.2f}} x %{{y:.2f}} {unit}, %{{text}}<extra></extra>",
            "marker": {"color": "--series-1", "size": 8},
            "showlegend": False,
        }
    )
    best = min(points, key=lambda p: p[2])
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "minimum volume",
            "x": [best[0]],
            "y": [best[1]],
            "hovertemplate": f"minimum volume: {amount(best[2], 'mm3', measures)}<extra></extra>",
            "marker": {"color": "--series-2", "size": 13, "symbol": "star"},
        }
    )
    plot = layout(
        axis(f"width [{unit}]", range=[x0, x1]), axis(f"height [{unit}]", range=[y0, y1]), 420
    )
    words = (
        f"Pareto front: {len(points)} boxes, none of them dominated in width and height. "
        "Dotted lines: equal area of the front face."
    )
    return Section("Width against height", figures=(Figure(traces, plot, words),))


def _ends(values: tuple[float, ...]) -> tuple[float, float]:
    room = 0.08 * (max(values) - min(values)) or 0.05 * max(values)
    return max(min(values) - room, 0.5 * min(values)), max(values) + room


def _equal(
    area: float, across: tuple[float, float], up: tuple[float, float], measures: Measures
) -> dict[str, Any]:
    """Return a line of equal area through the plot, named near its upper end."""
    start, end = max(across[0], area / up[1]), min(across[1], area / up[0])
    x = [start * (end / start) ** (k / 40) for k in range(41)]
    name = measures.amount(area / measures.of(1.0, "mm") ** 2, "mm2")
    return {
        "type": "scatter",
        "mode": "lines+text",
        "x": x,
        "y": [area / v for v in x],
        "text": [name if k == 2 else "" for k in range(41)],
        "textposition": "top right",
        "textfont": {"size": 11, "color": "--soft"},
        "line": {"color": "--axis", "width": 1, "dash": "dot"},
        "hoverinfo": "skip",
        "showlegend": False,
    }
