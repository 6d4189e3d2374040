"""What the load gains over the total ratio, with the best and the given one."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Cell, Section, Table
from gearopt.report.servo_achieved import (
    DUTIES,
    LINE,
    achieved_table,
    best_words,
    note,
    train_words,
)
from gearopt.report.words import number

WITH_TRAIN = "with the chosen train's inertia"
TICKS = (1.0, 2.0, 5.0)  # of a decade
MARKS = (  # of what is judged beside the best ratio: colour and symbol
    ("chosen", "--series-3", "diamond"),
    ("given_train", "--series-8", "x"),
    ("given", "--series-4", "circle"),
)


def section(result: Result, measures: Measures) -> Section | None:
    """The curve of a duty, and what trains achieve; None where the file has none."""
    found = result.design.get("ratio")
    if not found:
        return None
    unit = measures.unit(found["unit"])
    ratios = found["curve"]["total_ratio"]
    values = [measures.of(v, found["unit"]) for v in found["curve"]["value"]]
    heads, columns = ["total ratio", f"{found['name']} [{unit}]"], [ratios, values]
    traces = [_line(found["name"], ratios, values, unit, "solid", "--series-1")]
    if with_train := found["curve"].get("value_with_train"):
        less = [None if v is None else measures.of(v, found["unit"]) for v in with_train]
        traces = [
            _line("no gears", ratios, values, unit, "solid", "--series-1", True),
            _line(WITH_TRAIN, ratios, less, unit, "dash", "--series-3", True),
        ]
        heads, columns = [*heads, f"{WITH_TRAIN} [{unit}]"], [*columns, less]
    traces.append(_mark("best", found, found, measures, "--series-2", "star", 14))
    for who, colour, symbol in MARKS:
        if one := found.get(who):
            name = who.replace("_", " ")
            traces.append(_mark(name, one, found, measures, colour, symbol, 10))
    plot = layout(
        axis("total ratio", type="log", tickvals=_ticks(ratios), tickformat="~g"),
        axis(f"{found['name']} [{unit}]"),
        360,
    )
    caption = f"{found['name'].capitalize()} over the total ratio, motor over load speed."
    words = best_words(found, measures)
    words.append(_flat(found))
    words += train_words(result.report, found, measures)
    table = Table("ratio curve", heads, list(zip(*columns, strict=True)), folded=True)
    tables = [*_achieved(found, measures), table]
    figures = (Figure(traces, plot, caption),)
    if len(tables) > 1:
        words.append(note(found))
    return Section("Total ratio", words=words, figures=figures, tables=tables)


def _achieved(found: Any, measures: Measures) -> list[Table]:
    """What the trains and ratios give, and what they ask of the motor; of older results none."""
    heads, rows = achieved_table(found, measures)
    if not rows:
        return []
    cells = [
        [name, *(Cell(v, f"{v:.3g}") if v is not None else None for v in values)]
        if name.endswith("[%]")
        else [name, *values]
        for name, *values in rows
    ]
    return [Table("motor and load", [head.replace(LINE, " ") for head in heads], cells)]


def _line(
    name: str,
    ratios: Any,
    values: Any,
    unit: str,
    dash: str,
    colour: str,
    named: bool = False,
) -> dict[str, Any]:
    """A curve; named: in the legend too."""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": ratios,
        "y": values,
        "hovertemplate": f"ratio %{{x:.5g}}: %{{y:.5g}} {unit}<extra></extra>",
        "line": {"color": colour, "width": 2.2, "simplify": False, "dash": dash},
        "showlegend": named,
    }


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
