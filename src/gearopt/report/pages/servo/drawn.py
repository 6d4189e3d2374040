"""What drawn deviations make of the error: how it spreads, its quantile, the yield."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Section, Table
from gearopt.report.servo_words import degrees, drawn_words


def section(result: Result, measures: Measures) -> Section | None:
    """The histogram of the draws; None without draws."""
    found = result.design.get("drawn")
    if not found:
        return None
    counts = found["histogram"]["counts"]
    traces = [_bars(found["histogram"], found["count"]), *_lines(found, 1.05 * max(counts))]
    plot = layout(
        axis("error at the output [°]"),
        axis("drawn trains", range=[0, 1.08 * max(counts)]),
        380,
        bargap=0.0,
        shapes=_interval(found),
    )
    caption = (
        f"{found['count']:,} trains drawn with every deviation at random within its tolerance "
        f"(seed {found['seed']}); the band is the interval of the quantile."
    )
    words = [*drawn_words(found), _normal(found)]
    return Section(
        "Drawn errors",
        words=words,
        figures=(Figure(traces, plot, caption),),
        tables=(_table(found["histogram"]),),
        half="stiffness" in result.design,
    )


def _table(histogram: Mapping[str, Any]) -> Table:
    """The bars: between which errors, and how many trains were drawn there."""
    ends = pairwise(histogram["edges_deg"])
    rows = [[a, b, n] for (a, b), n in zip(ends, histogram["counts"], strict=True)]
    return Table("drawn errors", ["from [°]", "to [°]", "drawn trains"], rows, folded=True)


def _bars(histogram: Mapping[str, Any], count: int) -> dict[str, Any]:
    ends = list(pairwise(histogram["edges_deg"]))
    told = [
        f"{a:.4f} to {b:.4f}°: {n:,} ({100.0 * n / count:.3g} %)"
        for (a, b), n in zip(ends, histogram["counts"], strict=True)
    ]
    return {
        "type": "bar",
        "name": "drawn",
        "x": [0.5 * (a + b) for a, b in ends],
        "width": [b - a for a, b in ends],
        "y": histogram["counts"],
        "text": told,
        "textposition": "none",
        "hovertemplate": "%{text}<extra></extra>",
        "marker": {"color": "--series-1/0.55", "line": {"color": "--series-1", "width": 0.6}},
        "showlegend": False,
    }


def _lines(found: Mapping[str, Any], top: float) -> list[dict[str, Any]]:
    """Mean, quantile and limit as upright lines, with their values in the legend."""
    quantile = f"{100.0 * found['probability']:g} % quantile"
    marks = (
        ("mean", "mean_deg", "--series-4", "dot"),
        (quantile, "quantile_deg", "--series-5", "solid"),
        ("limit", "limit_deg", "--warn", "dash"),
    )
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": f"{name} {degrees(found[key])}",
            "x": [found[key], found[key]],
            "y": [0.0, top],
            "hovertemplate": f"{name} {degrees(found[key])}<extra></extra>",
            "line": {"color": colour, "width": 2.0, "dash": dash},
        }
        for name, key, colour, dash in marks
    ]


def _interval(found: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The interval of the quantile as a band; nothing where the draws were too few."""
    ends = found["quantile_low_deg"], found["quantile_high_deg"]
    if None in ends:
        return []
    band = {"type": "rect", "yref": "paper", "y0": 0, "y1": 1, "layer": "below"}
    return [
        band | {"x0": ends[0], "x1": ends[1], "fillcolor": "--series-5/0.2", "line": {"width": 0}}
    ]


def _normal(found: Mapping[str, Any]) -> str:
    """Mean and standard deviation, and the worst case that no draw reaches."""
    return (
        f"Mean {degrees(found['mean_deg'])}, standard deviation {degrees(found['sd_deg'])}; all "
        f"tolerances at their limits at once would be {degrees(found['worst_case_deg'])}."
    )
