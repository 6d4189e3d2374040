"""The page of a comparison: verdicts, tables, anytime curves, final gaps, how it was measured."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.comparing.comparison import Comparison, Group, Run, Sample
from gearopt.report import comparison as words
from gearopt.report.drawing.sheet import COLOURS
from gearopt.report.measures import METRIC
from gearopt.report.pages.frame import render
from gearopt.report.plots import Figure, axis, layout
from gearopt.report.section import Table

KNOWN = ("exact", "ipopt", "annealing", "nsga2", "scip", "gp", "multistart")
SMALLEST = 1e-9  # gaps below it are drawn as none
HIGHEST = 10.0  # the curves' beginnings may lie above the plot, where no final gap does
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x", "star", "pentagon")
ZERO = "0"  # tick of the floor


def page(comparison: Comparison, html: str = "comparison.html") -> str:
    """One self-contained HTML page; html: where the command writes it that makes it again."""
    colour = colours([row.method for group in comparison.groups for row in group.rows])
    rows = [row for group in comparison.groups for row in group.rows if not row.refused]
    samples = [s for row in rows for s in (row.equal_evaluations, row.equal_time) if s]
    clipped = sum(run.clipped for sample in samples for run in sample.runs)
    return render(
        "comparison.html",
        f"{comparison.title}: methods compared",
        _subtitle(comparison),
        {"gearopt": comparison.gearopt, **comparison.versions},
        words.command(comparison, html),
        {"report": comparison.head},
        comparison=comparison,
        blocks=[_block(comparison, group, colour) for group in comparison.groups],
        columns=words.columns(comparison),
        colours=colour,
        methods=[(row, words.settings(comparison.settings[row.method])) for row in rows],
        fairness=words.FAIRNESS,
        clipped=f" (it was so in {words.counted(clipped, 'run')})" if clipped else "",
    )


HEADS = (
    *("model", "method", "held equal", "seed", "status", "objective", "bound", "unit"),
    *("gap, %", "relative violation", "evaluations", "seconds"),
)


def tables(comparison: Comparison) -> dict[str, str]:
    """The CSV of every run by the name of its file."""
    rows = [
        (*place, run.seed, run.status, *_of(group, run), 100.0 * run.gap if run.gap else run.gap)
        + (run.violation, run.evaluations, run.seconds)
        for group in comparison.groups
        for row in group.rows
        for kind, sample in (("evaluations", row.equal_evaluations), ("time", row.equal_time))
        if sample is not None
        for place in [(words.heading(comparison, group), row.method, kind)]
        for run in sample.runs
    ]
    return {"runs.csv": Table("runs", HEADS, rows).csv()}


def _of(group: Group, run: Run) -> tuple[float | None, float | None, str]:
    """Objective and bound of a run in the unit that is shown, and that unit."""
    unit = words.unit_of(group)
    value, bound = (None if v is None else METRIC.of(v, unit) for v in (run.objective, run.bound))
    return value, bound, METRIC.unit(unit)


def colours(methods: list[str]) -> dict[str, str]:
    """The colour of every method: of a known one its own, on every page, else a free one."""
    taken = {name: KNOWN.index(name) + 1 for name in methods if name in KNOWN}
    free = [k for k in range(COLOURS, 0, -1) if k not in taken.values()] or [COLOURS]
    others = (name for name in dict.fromkeys(methods) if name not in KNOWN)
    taken |= {name: free[k % len(free)] for k, name in enumerate(others)}
    return {name: f"--series-{k}" for name, k in taken.items()}


def _subtitle(comparison: Comparison) -> str:
    methods = ", ".join(row.method for group in comparison.groups for row in group.rows)
    budget = comparison.budget
    return (
        f"{methods}; {words.counted(len(comparison.seeds), 'seed')} for random methods; "
        f"{budget['evaluations']:,} evaluations or {budget['seconds']:g} s per run"
    )


def _block(comparison: Comparison, group: Group, colour: dict[str, str]) -> dict[str, Any]:
    """Values of a group for the template."""
    sides = []
    floor, worst, top = span(group)
    for field, heading, budget in words.kinds(comparison):
        samples = {row.method: getattr(row, field) for row in group.rows if getattr(row, field)}
        if not samples:
            continue
        figures = []
        if group.reference is not None:
            figures = [anytime(samples, colour, floor, top, by_time=field == "equal_time")]
        if worst > SMALLEST:
            figures.append(final(samples, colour, floor, worst))
        rows = [(method, words.cells(comparison, sample)) for method, sample in samples.items()]
        late = [words.ended(comparison, row) for row in group.rows if field == "equal_evaluations"]
        side = {"heading": heading, "budget": budget, "rows": rows, "figures": figures}
        sides.append(side | {"ended": "; ".join(filter(None, late))})
    return {
        "heading": words.heading(comparison, group),
        "reference": words.reference(group, comparison.scene),
        "verdicts": [(row.method, words.verdict(group, row)) for row in group.rows],
        "sides": sides,
    }


def span(group: Group) -> tuple[float, float, float]:
    """The ends of the axes of gaps, the same for all plots of a group, relative.

    Where a gap of zero is drawn: a decade below the smallest nonzero gap. The largest final gap.
    The top of the curves, whose beginnings may lie above the plot.
    """
    seen: list[float | None] = []
    final = [0.0]
    for row in group.rows:
        for sample in (row.equal_evaluations, row.equal_time):
            if sample is not None:
                seen += [run.gap for run in sample.runs] + list(sample.curve.median)
                final += [run.gap for run in sample.runs if run.gap is not None]
    smallest = min((gap for gap in seen if gap is not None and gap > SMALLEST), default=1e-2)
    bottom = float(10.0 ** (math.floor(math.log10(min(smallest, 1e-2))) - 1))
    highest = max([10.0 * bottom, *(gap for gap in seen if gap is not None)])
    return bottom, max(final), min(highest, max(HIGHEST, *final))


def anytime(
    samples: Mapping[str, Sample],
    colours: Mapping[str, str],
    floor: float,
    top: float,
    by_time: bool,
) -> Figure:
    """Plot the median gap so far and the band of its quartiles, both axes logarithmic."""
    data: list[dict[str, Any]] = []
    for method, sample in samples.items():
        curve, colour = sample.curve, colours[method]
        known = [k for k, gap in enumerate(curve.median) if gap is not None]
        if not known:
            continue
        x = [max(curve.spent[k], 1e-6 if by_time else 1.0) for k in known]
        median = [_drawn(curve.median[k], floor) for k in known]
        if len(sample.runs) > 1:
            data += _band(x, known, sample, colour, floor, max(median))
        data += _line(method, x, median, colour, " s" if by_time else "")
    across = [v for trace in data for v in trace["x"]]
    plot = layout(_spent(across, by_time), _gaps(floor, top))
    caption = (
        f"Gap so far against {'time' if by_time else 'evaluations'}: line, median of the seeds; "
        "band, their quartiles; a curve begins where half of the seeds have a feasible point and "
        f"ends with the run. {_marked(floor)}"
    )
    return Figure(data, plot, caption)


def _line(
    method: str, x: Sequence[float], median: Sequence[float], colour: str, unit: str
) -> list[dict[str, Any]]:
    """Draw the curve, and the mark at its end that also stands in the legend."""
    look: dict[str, Any] = {"type": "scatter", "name": method, "legendgroup": method}
    line = {"color": colour, "width": 2.2, "shape": "hv"}
    y = [100.0 * v for v in median]
    words = f"%{{y:.3g}} % at %{{x:.3g}}{unit}"
    curve = {"mode": "lines", "x": x, "y": y, "showlegend": False, "hovertemplate": words}
    marker = {"color": colour, "symbol": _symbol(colour), "size": 9}
    end = {"mode": "lines+markers", "x": x[-1:], "y": y[-1:], "marker": marker}
    return [look | curve | {"line": line}, look | end | {"line": line, "hovertemplate": words}]


def _band(
    x: Sequence[float],
    known: Sequence[int],
    sample: Sample,
    colour: str,
    floor: float,
    top: float,
) -> list[dict[str, Any]]:
    """Draw the quartiles; one that has no feasible point yet is at the curve's top."""
    look = {"type": "scatter", "mode": "lines", "x": x, "showlegend": False, "hoverinfo": "skip"}
    line = {"color": colour, "width": 0, "shape": "hv"}
    low = [100.0 * _drawn(sample.curve.low[k], floor) for k in known]
    high = [sample.curve.high[k] for k in known]
    worse = [100.0 * (top if v is None else _drawn(v, floor)) for v in high]
    return [
        look | {"y": worse, "line": line},
        look | {"y": low, "line": line, "fill": "tonexty", "fillcolor": f"{colour}/0.16"},
    ]


def final(
    samples: Mapping[str, Sample], colours: Mapping[str, str], floor: float, top: float
) -> Figure:
    """Plot every seed's final gap, with a box of median and quartiles."""
    data: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    for method, sample in samples.items():
        colour = colours[method]
        gaps = [_drawn(run.gap, floor) for run in sample.runs if run.gap is not None]
        if sample.summary.without:
            text = f"{sample.summary.without} of {sample.summary.seeds}<br>no feasible point"
            notes.append(_note(method, text))
        data.append(
            {
                "type": "box",
                "name": method,
                "x": [method] * len(gaps),
                "y": [100.0 * gap for gap in gaps],
                "boxpoints": "all",
                "jitter": 0.6 if len(gaps) > 1 else 0,
                "pointpos": 0,
                "marker": {
                    "color": f"{colour}/0.75",
                    "size": 6 if len(gaps) > 1 else 9,
                    "symbol": _symbol(colour),
                },
                "line": {"color": colour, "width": 1.6},
                "fillcolor": f"{colour}/0.10",
                "showlegend": False,
                "hoveron": "points",
                "hovertemplate": "%{y:.3g} %<extra>" + method + "</extra>",
            }
        )
    categories = {"categoryorder": "array", "categoryarray": list(samples), "ticks": ""}
    kind = {"type": "category", "range": [-0.5, len(samples) - 0.5]} | categories
    plot = layout(axis("", **kind), _gaps(floor, top), 320, annotations=notes)
    caption = (
        "Final gap of every seed that has a point; box, their median and quartiles. "
        f"{_marked(floor)}"
    )
    return Figure(data, plot, caption)


def _note(method: str, text: str) -> dict[str, Any]:
    place = {"xref": "x", "x": method, "yref": "paper", "y": 1.0, "yanchor": "top"}
    return {**place, "text": text, "showarrow": False, "font": {"size": 11, "color": "--warn"}}


def _drawn(gap: float | None, floor: float) -> float:
    return floor if gap is None or gap < floor else gap


def _symbol(colour: str) -> str:
    return SYMBOLS[int(colour.rsplit("-", 1)[1]) - 1]


def _marked(floor: float) -> str:
    below = f"{100 * floor:g}".replace("e-0", "e-")
    return f"The lowest line, marked {ZERO}, is a gap below {below} %."


def _spent(values: Sequence[float], by_time: bool) -> dict[str, Any]:
    """The logarithmic axis of what was spent."""
    low = math.floor(math.log10(min(values, default=1.0)))
    high = max(low + 1.0, math.log10(max(values, default=10.0)))
    ticks = range(low, math.floor(high) + 1)
    if by_time:
        names = [f"{10.0**k:g} s" if k > -3 else f"{10.0 ** (k + 3):g} ms" for k in ticks]
    else:
        names = [f"{10**k:,}" for k in ticks]
    ends = {"range": [low - 0.05, high + 0.1], "tickvals": [10.0**k for k in ticks]}
    words = "wall time" if by_time else "evaluations"
    return axis(words, type="log", ticktext=names, **ends)


def _gaps(floor: float, top: float) -> dict[str, Any]:
    """The logarithmic axis of gaps in percent, with its floor."""
    low, high = round(math.log10(100 * floor)), math.ceil(math.log10(100 * top) + 0.05)
    ticks = list(range(low, high + 1, max(1, (high - low) // 7)))
    words = [ZERO] + [f"{10.0**k:,g}" if -4 < k < 5 else f"10<sup>{k}</sup>" for k in ticks[1:]]
    ends = {"range": [low - 0.15, high], "tickvals": [10.0**k for k in ticks], "ticktext": words}
    return axis("gap [%]", type="log", **ends)
