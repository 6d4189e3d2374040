"""Where the position error comes from: every source at its limit, one after the other."""

from collections.abc import Mapping
from html import escape
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.sheet import series
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Section, Table
from gearopt.report.servo_words import (
    arc_minutes,
    degrees,
    error_limit,
    error_words,
    kind_words,
)

ROW = 23.0  # px of a source
REST = 120.0  # px of legend and axis
ROOM = 1.04  # of the longest bar


def section(result: Result, measures: Measures) -> Section | None:
    """The budget of errors; None where the file has none."""
    found = result.design.get("errors")
    if not found:
        return None
    limit = error_limit(result.design, result.limits)
    total = sum(e["error_deg"] for e in found)
    names = _names([e["source"] for e in found])
    order = [f"total {degrees(total)}", *reversed(names)]  # from below
    traces = _steps(found, names, measures)
    traces.append(
        {
            "type": "bar",
            "orientation": "h",
            "name": "total",
            "y": [order[0]],
            "x": [total],
            "hovertemplate": f"total {degrees(total)}, {arc_minutes(total)}<extra></extra>",
            "marker": {"color": "--series-8"},
            "showlegend": False,
        }
    )
    shapes = [] if limit is None else [_limit(limit)]
    across = axis("error at the output [°]", range=[0.0, ROOM * max(total, limit or 0.0)])
    up = axis("", type="category", categoryorder="array", categoryarray=order, ticks="")
    up["showgrid"] = False
    plot = layout(
        across, up, round(REST + ROW * len(order)), barmode="overlay", bargap=0.25, shapes=shapes
    )
    caption = "Each bar begins where the last one ends: the worst case, all at once."
    words = (*error_words(found, limit), *_by_kind(found, total))
    return Section(
        "Where the error comes from",
        words=words,
        figures=(Figure(traces, plot, caption),),
        tables=(_table(found, total, measures),),
    )


def _table(found: Any, total: float, measures: Measures) -> Table:
    """Every source, as the bars show it."""
    heads = ["source", "kind", "stage", f"tolerance [{measures.unit('um')}]"]
    heads += ["error at the output [°]", "of the sum, %"]
    rows = [
        [
            e["source"],
            kind_words(e["kind"]),
            e["stage"],
            None if e.get("tolerance_mm") is None else measures.of(e["tolerance_mm"], "um"),
            e["error_deg"],
            100.0 * e["error_deg"] / total if total else None,
        ]
        for e in found
    ]
    return Table("errors", heads, rows, folded=True)


def _names(sources: list[str]) -> list[str]:
    """Names of the bars: spaces without width tell equal ones apart, on which a plot adds up."""
    return [escape(name) + "\u200b" * sources[:k].count(name) for k, name in enumerate(sources)]


def _steps(found: Any, names: list[str], measures: Measures) -> list[dict[str, Any]]:
    """A trace for every kind in every stage, so that the legend names it."""
    starts = [sum(e["error_deg"] for e in found[:k]) for k in range(len(found))]
    groups: dict[tuple[str, Any], list[int]] = {}
    for k, e in enumerate(found):
        groups.setdefault((e["kind"], e["stage"]), []).append(k)
    return [
        {
            "type": "bar",
            "orientation": "h",
            "name": escape(kind_words(kind)) + ("" if stage is None else f", stage {stage}"),
            "y": [names[k] for k in rows],
            "x": [found[k]["error_deg"] for k in rows],
            "base": [starts[k] for k in rows],
            "text": [_told(found[k], measures) for k in rows],
            "textposition": "none",
            "hovertemplate": "%{text}<extra></extra>",
            "marker": {"color": series(place)},
        }
        for place, ((kind, stage), rows) in enumerate(groups.items(), 1)
    ]


def _told(one: Mapping[str, Any], measures: Measures) -> str:
    words = f"{escape(one['source'])}: {degrees(one['error_deg'])}, {arc_minutes(one['error_deg'])}"
    if one.get("tolerance_mm") is not None:
        tolerance = f"{measures.of(one['tolerance_mm'], 'um'):.4g} {measures.unit('um')}"
        words += f", tolerance {tolerance}"
    return words


def _limit(limit: float) -> dict[str, Any]:
    """The limit as a line over all bars."""
    return {
        "type": "line",
        "yref": "paper",
        "x0": limit,
        "x1": limit,
        "y0": 0,
        "y1": 1,
        "line": {"color": "--warn", "width": 2.0, "dash": "dash"},
        "name": f"limit {degrees(limit)}",
        "showlegend": True,
    }


def _by_kind(found: Any, total: float) -> tuple[str, ...]:
    """How much each kind has of the sum."""
    sums: dict[str, float] = {}
    for e in found:
        sums[e["kind"]] = sums.get(e["kind"], 0.0) + e["error_deg"]
    if len(sums) < 2 or not total:
        return ()
    parts = (f"{kind_words(k)} {degrees(v)} ({100.0 * v / total:.1f} %)" for k, v in sums.items())
    return (f"By kind: {', '.join(parts)}.",)
