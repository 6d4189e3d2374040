"""Performance of a servo axis over its total ratio: in sentences, as a curve, in a table."""

from collections.abc import Sequence
from typing import Any

from gearopt.formulations.servo.servo_design import MOTIONS, Achieved, RatioDesign, ServoReport
from gearopt.optimise.result import Result
from gearopt.report.kinds.servo.words import design_of, report_of
from gearopt.report.measures import METRIC, Measures
from gearopt.report.plots import Figure, axis, layout, lines, points
from gearopt.report.section import Section, Table, cell, side_by_side
from gearopt.report.words import amount, number

MAXIMISED = "acceleration"  # the duty whose value is made largest
COLUMNS = {  # field of a `RatioDesign`: the head of its column, in two lines on the terminal
    "best": "best ratio,\nwithout gears",
    "best_with_train": "best ratio,\nsame inertia",
    "chosen": "chosen\ntrain",
    "given_train": "given\ntrain",
    "given": "given ratio,\nwithout gears",
}
NOTE = (
    "Inertias are referred to the motor shaft; their ratio is that of the load to rotor plus train."
)
SPEEDING = " Torques are in per cent of the motor's torque while the load accelerates."
BRAKING = " The motor also brakes with its full torque, and friction helps: the two ramps differ."
WITH_TRAIN = "with the chosen train's inertia"
TICKS = (1.0, 2.0, 5.0)  # of a decade
MARKS = (  # of what is judged beside the best ratio: colour and symbol
    ("chosen", "--series-3", "diamond"),
    ("given_train", "--series-8", "x"),
    ("given", "--series-4", "circle"),
)


def section(result: Result, measures: Measures) -> Section | None:
    """Show the curve of a duty, and what trains achieve; None where the file has none."""
    ratio = design_of(result).ratio
    if ratio is None:
        return None
    curve, known = _curve(ratio, measures), ratio.best is not None
    words = [_flat(ratio), *bound_words(report_of(result), ratio, measures)]
    achieved = [_achieved(ratio, measures)] if known else []
    motion = (SPEEDING if ratio.duty != "swing" else "") + (BRAKING if ratio.duty == "move" else "")
    note = [NOTE + motion] if known else []
    sentences = words if known else [*best_words(ratio, measures), *words]
    return Section(
        "Total ratio",
        words=[*words, *note],
        figures=(_figure(ratio, curve, measures),),
        tables=(*achieved, curve),
        terminal=("\n".join(sentences), *achieved, *note),
    )


def best_words(optimum: RatioDesign, measures: Measures = METRIC) -> list[str]:
    """The best total ratio, and the loss of the given one."""
    best = "Maximum" if optimum.duty == MAXIMISED else "Minimum"
    without = ", if gears had no inertia" if optimum.chosen else ""
    words = [
        f"{best} {optimum.name}: {amount(optimum.value, optimum.unit, measures)} at a total ratio "
        f"of {number(optimum.total_ratio)}{without}."
    ]
    if optimum.given:
        ratio = number(optimum.given.total_ratio)
        words.append(
            f"At the given ratio of {ratio} it is {_value(optimum.given, optimum, measures)}."
        )
    return words


def bound_words(report: ServoReport, ratio: RatioDesign, measures: Measures) -> list[str]:
    """Bound that not even real-valued gears exceed; nothing where it is not known."""
    bound = report.figures.get(f"real_valued_bound_{MOTIONS[ratio.duty].key}")
    if bound is None:
        return []
    better, most = (
        "more" if ratio.duty == MAXIMISED else "less",
        amount(bound, ratio.unit, measures),
    )
    reached = ratio.chosen and amount(ratio.chosen.value, ratio.unit, measures) == most
    than = "" if reached else f" than {most}"
    return [f"Not even real-valued teeth and modules within the limits give {better}{than}."]


def _value(achieved: Achieved, ratio: RatioDesign, measures: Measures) -> str:
    """A value with how far it is from the best."""
    less = "less" if (ratio.duty == MAXIMISED) == (achieved.loss_percent >= 0.0) else "more"
    value = amount(achieved.value, ratio.unit, measures)
    return f"{value}, {abs(achieved.loss_percent):.3g} % {less}"


def _achieved(ratio: RatioDesign, measures: Measures) -> Table:
    """Speeds, torques and inertias of the axis, a column for every train and ratio."""
    columns = {who: held for who in COLUMNS if (held := getattr(ratio, who)) is not None}
    trains = [*columns.values()]
    value = f"{ratio.name} [{measures.unit(ratio.unit)}]" if ratio.unit else ratio.name
    rows = [
        ["total ratio", *(cell(train.total_ratio, "", measures) for train in trains)],
        [value, *(cell(train.value, ratio.unit, measures) for train in trains)],
        *side_by_side(trains, measures),
    ]
    short = {"": "\nmotor and load"} | {
        COLUMNS[who].replace("\n", " "): COLUMNS[who] for who in columns
    }
    return Table("motor and load", list(short), rows, short=short, across=True)


def _curve(ratio: RatioDesign, measures: Measures) -> Table:
    """The value over the ratio, without gears and with the chosen train."""
    unit = measures.unit(ratio.unit)
    heads = ["total ratio", f"{ratio.name} [{unit}]"]
    columns: list[Sequence[Any]] = [ratio.curve.total_ratio]
    columns.append([measures.of(v, ratio.unit) for v in ratio.curve.value])
    if less := ratio.curve.value_with_train:
        heads.append(f"{WITH_TRAIN} [{unit}]")
        columns.append([None if v is None else measures.of(v, ratio.unit) for v in less])
    return Table("ratio curve", heads, list(zip(*columns, strict=True)), folded=True)


def _figure(ratio: RatioDesign, curve: Table, measures: Measures) -> Figure:
    """Draw the curves, the best ratio, and what else is judged."""
    ratios, *values = (list(column) for column in zip(*curve.rows, strict=True))
    unit = measures.unit(ratio.unit)
    curves = [(ratio.name, "solid", "--series-1", False)]
    if len(values) > 1:
        curves = [
            ("without gears", "solid", "--series-1", True),
            (WITH_TRAIN, "dash", "--series-3", True),
        ]
    hover = f"ratio %{{x:.5g}}: %{{y:.5g}} {unit}<extra></extra>"
    traces = [
        lines(ratios, column, "", name=name, hover=hover, showlegend=named)
        | {"line": {"color": colour, "width": 2.2, "simplify": False, "dash": dash}}
        for (name, dash, colour, named), column in zip(curves, values, strict=True)
    ]
    at = ratio.total_ratio, measures.of(ratio.value, ratio.unit)
    traces.append(_mark("best", *at, unit, "--series-2", "star", 14))
    for who, colour, symbol in MARKS:
        if (achieved := getattr(ratio, who)) is not None:
            at = achieved.total_ratio, measures.of(achieved.value, ratio.unit)
            traces.append(_mark(who.replace("_", " "), *at, unit, colour, symbol, 10))
    plot = layout(
        axis("total ratio", type="log", tickvals=_ticks(ratios), tickformat="~g"),
        axis(f"{ratio.name} [{unit}]"),
        360,
    )
    caption = f"{ratio.name.capitalize()} over the total ratio, motor over load speed."
    return Figure(traces, plot, caption)


def _mark(
    name: str, ratio: float, value: float, unit: str, colour: str, symbol: str, size: int
) -> dict[str, Any]:
    """Mark a ratio with its value, which its name in the legend shows too."""
    label = f"{name} {number(ratio)}: {number(float(value))} {unit}"
    marker = {"color": colour, "size": size, "symbol": symbol}
    return points([ratio], [value], label, marker, f"{label}<extra></extra>")


def _ticks(ratios: list[float]) -> list[float]:
    """1, 2, 5, 10, ... within the curve."""
    decades = (10.0**k for k in range(-6, 13))
    marks = [tick * decade for decade in decades for tick in TICKS]
    return [mark for mark in marks if ratios[0] <= mark <= ratios[-1]]


def _flat(ratio: RatioDesign) -> str:
    """Say between which ratios the value is within one per cent of the best."""
    most = ratio.duty == MAXIMISED
    limit = ratio.value / 1.01 if most else ratio.value * 1.01
    pairs = zip(ratio.curve.total_ratio, ratio.curve.value, strict=True)
    near = [n for n, v in pairs if (v >= limit if most else v <= limit)]
    return (
        f"The optimum is flat: total ratios from {number(round(near[0], 1))} to "
        f"{number(round(near[-1], 1))} are within 1 % of the best {ratio.name}."
    )
