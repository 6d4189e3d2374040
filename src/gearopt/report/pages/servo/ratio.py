"""What the load gains over the total ratio, with the best and the given one."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.frame import Figure, axis, layout
from gearopt.report.pages.section import Section
from gearopt.report.pages.table import Table
from gearopt.report.servo_beside import with_train_words
from gearopt.report.servo_words import DUTIES, ratio_words
from gearopt.report.words import number

TICKS = (1.0, 2.0, 5.0)  # of a decade


def section(result: Result, measures: Measures) -> Section | None:
    """The curve of a duty; None where the file has none."""
    found = result.design.get("ratio")
    if result.scene != "servo" or not found:
        return None
    unit = measures.unit(found["unit"])
    ratios = found["curve"]["total_ratio"]
    values = [measures.of(v, found["unit"]) for v in found["curve"]["value"]]
    curve = {
        "type": "scatter",
        "mode": "lines",
        "name": found["name"],
        "x": ratios,
        "y": values,
        "hovertemplate": f"ratio %{{x:.5g}}: %{{y:.5g}} {unit}<extra></extra>",
        "line": {"color": "--series-1", "width": 2.2, "simplify": False},
        "showlegend": False,
    }
    traces = [curve, _mark("best", found, found, measures, "--series-2", "star", 14)]
    if given := found.get("given"):
        traces.append(_mark("given", given, found, measures, "--series-4", "circle", 10))
    plot = layout(
        axis("total ratio", type="log", tickvals=_ticks(ratios), tickformat="~g"),
        axis(f"{found['name']} [{unit}]"),
        360,
    )
    caption = f"{found['name'].capitalize()} over the total ratio, motor over load speed."
    words = ratio_words(found, measures)
    words.append(_flat(found))
    words += with_train_words(result.report, found, measures)
    heads = ["total ratio", f"{found['name']} [{unit}]"]
    table = Table("ratio curve", heads, list(zip(ratios, values, strict=True)), folded=True)
    figures = (Figure(traces, plot, caption),)
    return Section("Total ratio", words=words, figures=figures, tables=(table,))


def _mark(
    name: str, at: Any, found: Any, measures: Measures, colour: str, symbol: str, size: int
) -> dict[str, Any]:
    """A ratio with its value, which its name in the legend tells too."""
    value = measures.of(at["value"], found["unit"])
    unit = measures.unit(found["unit"])
    told = f"{name} {number(float(at['total_ratio']))}: {number(float(value))} {unit}"
    return {
        "type": "scatter",
        "mode": "markers",
        "name": told,
        "x": [at["total_ratio"]],
        "y": [value],
        "hovertemplate": f"{told}<extra></extra>",
        "marker": {"color": colour, "size": size, "symbol": symbol},
    }


def _ticks(ratios: list[float]) -> list[float]:
    """1, 2, 5, 10, ... within the curve."""
    decades = (10.0**k for k in range(-6, 13))
    marks = [tick * decade for decade in decades for tick in TICKS]
    return [mark for mark in marks if ratios[0] <= mark <= ratios[-1]]


def _flat(found: Any) -> str:
    """Between which ratios the value is within one per cent of the best."""
    best, most = found["value"], DUTIES.get(found["duty"]) == "Largest"
    limit = best / 1.01 if most else best * 1.01
    pairs = zip(found["curve"]["total_ratio"], found["curve"]["value"], strict=True)
    near = [n for n, v in pairs if (v >= limit if most else v <= limit)]
    return (
        f"The optimum is flat: from {number(round(near[0], 1))} to {number(round(near[-1], 1))} "
        "the value is within 1 % of the best."
    )
