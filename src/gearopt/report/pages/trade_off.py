"""Width against height of the boxes of a front, with lines of equal area."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Section
from gearopt.report.words import number

LINES = 6  # of equal area


def section(result: Result, measures: Measures) -> Section | None:
    """The front of a run that looked for one; None without it."""
    front = result.report.get("front") or []
    if not front:
        return None
    points = sorted(
        (
            measures.of(p["width_mm"], "mm"),
            measures.of(p["height_mm"], "mm"),
            measures.of(p["volume_mm3"], "mm3"),
        )
        for p in front
    )
    unit, volume = measures.unit("mm"), measures.unit("mm3")
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
            "text": [f"{number(v)} {volume}" for v in volumes],
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
            "name": "least volume",
            "x": [best[0]],
            "y": [best[1]],
            "hovertemplate": f"least volume: {number(best[2])} {volume}<extra></extra>",
            "marker": {"color": "--series-2", "size": 13, "symbol": "star"},
        }
    )
    across, up = (
        axis(f"width [{unit}]", range=[x0, x1]),
        axis(f"height [{unit}]", range=[y0, y1]),
    )
    words = (
        f"Boxes of which none is better in both width and height ({len(points)}). "
        "Thin lines: equal area of the face."
    )
    return Section(
        "Width against height", figures=(Figure(traces, layout(across, up, 420), words),)
    )


def _ends(values: tuple[float, ...]) -> tuple[float, float]:
    room = 0.08 * (max(values) - min(values)) or 0.05 * max(values)
    return max(min(values) - room, 0.5 * min(values)), max(values) + room


def _equal(
    area: float, across: tuple[float, float], up: tuple[float, float], measures: Measures
) -> dict[str, Any]:
    """A line of equal area through the plot, named near its upper end."""
    start, end = max(across[0], area / up[1]), min(across[1], area / up[0])
    x = [start * (end / start) ** (k / 40) for k in range(41)]
    metric = measures.unit("mm2") == "mm²"
    shown, unit = (area / 100.0, "cm²") if metric else (area, measures.unit("mm2"))
    name = f"{shown:,.{0 if shown > 100.0 else 1}f} {unit}"
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
