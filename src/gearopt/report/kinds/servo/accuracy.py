"""The accuracy of a servo axis: sources of its error, tolerances, and what draws of them give."""

import math
from collections.abc import Sequence
from html import escape
from itertools import pairwise
from typing import Any

from gearopt.formulations.servo.servo_design import (
    Allocation,
    BudgetUse,
    DrawnErrors,
    ErrorSource,
    Histogram,
    ToleranceRow,
)
from gearopt.optimise.result import Result
from gearopt.report.drawing.sheet import series
from gearopt.report.kinds.servo.words import (
    ARCMIN,
    OLD,
    aged,
    arc_minutes,
    degrees,
    design_of,
    error_limit,
    limit_line,
)
from gearopt.report.measures import Measures
from gearopt.report.plots import TEXT, Figure, axis, band, bars, layout, lines
from gearopt.report.section import Cell, Section, Table, percent, records
from gearopt.report.words import number, share

ROW = 23.0  # px of a source
LEGEND_AND_AXIS = 120.0  # px of legend and axis
AXIS_MARGIN = 1.04  # of the longest bar
END_TOLERANCE = 1e-6  # relative: a tolerance as near to an end of its range stands at it
LONGEST_BAR = 0.999  # of a cell: a full bar would mark a limit that is reached
RULES = {
    "worst_case": "worst case",
    "rss": "root sum of squares",
    "mean_plus_sd": "mean + {kappa} sd",
}


def errors(result: Result, measures: Measures) -> Section | None:
    """Show every source at its limit, one after the other; None where the file has none."""
    design = design_of(result)
    sources, limit = design.errors, error_limit(design, result.limits)
    if not sources:
        return None
    total = sum(e.error_deg for e in sources)
    names = _names([e.source for e in sources])
    order = [f"total {degrees(total)}", *reversed(names)]  # from below
    traces = _steps(sources, names, measures)
    hover = f"total {degrees(total)}, {arc_minutes(total)}<extra></extra>"
    marker = {"color": "--series-8"}
    traces.append(bars([total], [order[0]], marker, hover, name="total", showlegend=False))
    shapes = [] if limit is None else [limit_line("limit", limit, "y", 2.0)]
    across = axis("error at the output [°]", range=[0.0, AXIS_MARGIN * max(total, limit or 0.0)])
    up = axis("", type="category", categoryorder="array", categoryarray=order, ticks="")
    up["showgrid"] = False
    high = round(LEGEND_AND_AXIS + ROW * len(order))
    plot = layout(across, up, high, barmode="overlay", bargap=0.25, shapes=shapes)
    of = aged(design)
    caption = (
        f"Each bar begins where the last one ends: the worst case, all at their limits at once{of}."
    )
    backlash = [Table("backlash", *records(design.backlash, measures))] if design.backlash else []
    words, table = _error_words(total, limit, of), _error_table(sources, total, of, measures)
    tables = (table, *backlash)
    return Section(
        "Where the error comes from",
        words=[*words, *_by_kind(sources, total)],
        figures=(Figure(traces, plot, caption),),
        tables=tables,
        terminal=(*tables, *words),
    )


def _error_words(total: float, limit: float | None, of: str) -> list[str]:
    """Sum of all sources [deg] where no limit shows it, and its excess over the limit.

    of: their tolerances, in words.
    """
    if limit is None:
        return [f"All sources at their limits add up to {arc_minutes(total)} at the output{of}."]
    if total <= limit * (1.0 + 1e-9):
        return []
    return [f"All sources at their limits exceed the limit by {degrees(total - limit)}{of}."]


def _error_table(
    sources: Sequence[ErrorSource], total: float, of: str, measures: Measures
) -> Table:
    """Every source, and on the terminal their sum; of: their tolerances, in words."""
    heads = ["source", "kind", "stage", f"{'old ' if of else ''}tolerance [{measures.unit('um')}]"]
    short = {
        "source": "error, old tolerances" if of else "error at the output",
        "stage": "where",
        "error at the output [°]": "°",
        "of the sum, %": "%",
    }

    def row(name: str, kind: str, error: float, *place: Any) -> list[Any]:
        share = 100.0 * error / total if total else None
        angle = Cell(error, number(error), short=f"{error:.5f}")
        arc = Cell(ARCMIN * error, f"{ARCMIN * error:.3f}")
        return [name, kind, *place, angle, arc, Cell(share, "", short=f"{share or 0.0:.1f}")]

    rows = []
    for e in sources:
        size = None if e.tolerance_mm is None else measures.of(e.tolerance_mm, "um")
        place = Cell(e.stage, number(e.stage), short=f"stage {e.stage}")
        width = Cell(size, "" if size is None else f"{size:.2f}")
        rows.append(row(e.source, e.kind, e.error_deg, place, width))
    rows.append(row("sum", "", total, "", ""))
    heads += ["error at the output [°]", "'", "of the sum, %"]
    return Table("errors", heads, rows, folded=True, terminal_only=("'", "sum"), short=short)


def _names(sources: list[str]) -> list[str]:
    """Names of bars: spaces without width tell equal ones apart, which a plot would add."""
    return [escape(name) + "\u200b" * sources[:k].count(name) for k, name in enumerate(sources)]


def _steps(
    sources: Sequence[ErrorSource], names: list[str], measures: Measures
) -> list[dict[str, Any]]:
    """A trace for every kind in every stage, so that the legend names it."""
    starts = [sum(e.error_deg for e in sources[:k]) for k in range(len(sources))]
    groups: dict[tuple[str, int], list[int]] = {}
    for k, e in enumerate(sources):
        groups.setdefault((e.kind, e.stage), []).append(k)
    return [
        bars(
            [sources[k].error_deg for k in rows],
            [names[k] for k in rows],
            {"color": series(place)},
            TEXT,
            name=f"{escape(kind)}, stage {stage}",
            base=[starts[k] for k in rows],
            text=[_hover_text(sources[k], measures) for k in rows],
            textposition="none",
        )
        for place, ((kind, stage), rows) in enumerate(groups.items(), 1)
    ]


def _hover_text(source: ErrorSource, measures: Measures) -> str:
    text = f"{escape(source.source)}: {degrees(source.error_deg)}, {arc_minutes(source.error_deg)}"
    if source.tolerance_mm is None:
        return text
    return f"{text}, tolerance {measures.of(source.tolerance_mm, 'um'):.4g} {measures.unit('um')}"


def _by_kind(sources: Sequence[ErrorSource], total: float) -> tuple[str, ...]:
    """Say how much each kind has of the sum."""
    sums: dict[str, float] = {}
    for e in sources:
        sums[e.kind] = sums.get(e.kind, 0.0) + e.error_deg
    if len(sums) < 2 or not total:
        return ()
    parts = (f"{kind} {degrees(v)} ({100.0 * v / total:.1f} %)" for kind, v in sums.items())
    return (f"By kind: {', '.join(parts)}.",)


def tolerances(result: Result, measures: Measures) -> Section | None:
    """Show the tolerances before and after with their cost; None where the file has none."""
    design = design_of(result)
    rows, cost = design.tolerances, design.allocation
    if not rows or cost is None:
        return None
    unit = measures.unit("um")
    heads = ["tolerance", "stage", "kind", f"old [{unit}]", f"new [{unit}]", "new/old"]
    heads += ["of the new error, %", "cost, old", "cost, new"]
    total = sum(r.sensitivity_deg_per_mm * r.new_mm for r in rows)
    highest = max(max(r.old_cost, r.new_cost) for r in rows)
    table = Table(
        "tolerances",
        heads,
        [*(_row(r, total, highest, measures) for r in rows), _sums(rows)],
        page_only=("stage", "kind", "of the new error, %"),
        short={"cost, old": "cost", "cost, new": "new cost"},
    )
    words = _cost_words(cost, None if design.train is None else design.train.error_deg)
    ends = (
        "Share of the new error: sensitivity times new tolerance over the sum of these. Min and "
        "max: the new tolerance is the minimum or the maximum that the file allows."
    )
    terminal = (table, "\n".join(words))
    return Section("Tolerances", words=[*words, ends], tables=(table,), terminal=terminal)


def _cost_words(allocation: Allocation, error: float | None) -> list[str]:
    """Say how the cost changes, and what the budgets are; error: of the train [deg]."""
    change = round(100.0 * (allocation.cost / allocation.old_cost - 1.0), 1)
    changed = f"{'rises' if change > 0.0 else 'falls'} by {abs(change):.1f} %"
    limits = (
        f"{_rule(b)}, limit equal to the error {OLD}"
        if error is not None and degrees(b.limit_deg) == degrees(error)
        else f"{_rule(b)} {degrees(b.limit_deg)}"
        for b in allocation.budgets
    )
    cost = f"The cost {changed if change else 'is unchanged'}."
    return [f"{cost} Budgets: {', '.join(limits)}."]


def _rule(budget: BudgetUse) -> str:
    kappa = "" if budget.kappa is None else number(budget.kappa)
    return RULES[budget.rule].format(kappa=kappa)


def _row(row: ToleranceRow, total: float, highest: float, measures: Measures) -> list[Any]:
    old, new = (measures.of(t, "um") for t in (row.old_mm, row.new_mm))
    ratio = row.new_mm / row.old_mm
    return [
        row.name,
        row.stage,
        row.kind,
        Cell(old, f"{old:.2f}"),
        Cell(new, f"{_end(row)} {new:.2f}".strip(), short=f"{new:.2f}"),
        Cell(ratio, f"{ratio:.3f}"),
        percent(row.sensitivity_deg_per_mm * row.new_mm / total if total else None),
        *(_cost(cost, highest) for cost in (row.old_cost, row.new_cost)),
    ]


def _end(row: ToleranceRow) -> str:
    """Whether a new tolerance is the minimum or the maximum allowed."""
    for name, end in (("min", row.lower_mm), ("max", row.upper_mm)):
        if end and abs(row.new_mm / end - 1.0) < END_TOLERANCE:
            return name
    return ""


def _cost(cost: float, highest: float) -> Cell:
    """A cost with its bar; all bars of the table have one scale."""
    share = LONGEST_BAR * max(0.0, cost) / highest if highest > 0.0 else None
    return Cell(cost, f"{cost:.3f}", share)


def _sums(rows: Sequence[ToleranceRow]) -> list[Any]:
    """The last row: sums of shares and costs; tolerances of unlike parts have none."""
    costs = sum(r.old_cost for r in rows), sum(r.new_cost for r in rows)
    summed = (Cell(cost, f"{cost:.3f}") for cost in costs)
    return ["sum", None, "", "", "", "", Cell(100.0, "100.0"), *summed]


def drawn(result: Result, measures: Measures) -> Section | None:
    """Errors of deviations drawn at random; None without draws."""
    design = design_of(result)
    draws = design.drawn
    if draws is None:
        return None
    most = max(draws.histogram.counts)
    plot = layout(
        axis("error at the output [°]"),
        axis("Monte Carlo trains", range=[0, 1.08 * most]),
        380,
        bargap=0.0,
        shapes=_interval(draws),
    )
    caption = (
        f"{draws.count:,} Monte Carlo trains with every deviation at random within its tolerance "
        f"(seed {draws.seed}); the band is the interval of the quantile."
    )
    worst = share(draws.worst_case_deg / draws.limit_deg)
    normal = (
        f"Mean {degrees(draws.mean_deg)}, standard deviation {degrees(draws.sd_deg)}; all "
        f"tolerances at their limits at once would be {worst} % of the limit."
    )
    budgets = () if design.allocation is None else design.allocation.budgets
    said = any(budget.limit_deg == draws.limit_deg for budget in budgets)
    words, bins = _drawn_words(draws, said), _bins(draws.histogram)
    heads = ("from [°]", "to [°]", "Monte Carlo trains")
    traces = [_bars(bins, draws.count), *_lines(draws, 1.05 * most)]
    return Section(
        "Monte Carlo errors",
        words=[*words, normal],
        figures=(Figure(traces, plot, caption),),
        tables=(Table("Monte Carlo errors", heads, bins, folded=True),),
        half=design.stiffness is not None,
        terminal=("\n".join(words),),
    )


def _drawn_words(draws: DrawnErrors, said: bool) -> list[str]:
    """Yield and quantile with their intervals; said: the limit is known."""
    sure = f"{100.0 * draws.confidence:g} %"
    low = f"{math.floor(1e6 * draws.yield_low) / 1e4:.4f}"  # outwards, to hold what is said
    high = f"{math.ceil(1e6 * draws.yield_high) / 1e4:.4f}"
    share, ends = f"{100.0 * draws.probability:g} %", _ends(draws)
    limit = "" if said else f" of {degrees(draws.limit_deg)}"
    kept = f"{100.0 * draws.yield_share:.4f} % of the Monte Carlo trains keep the limit{limit}"
    words = [f"{kept}; with {sure} confidence the yield lies between {low} and {high} %."]
    if draws.worst_case_deg <= draws.limit_deg * (1.0 + 1e-9):
        words = [
            f"The worst case keeps the limit{limit}, and so does every train: the yield is 100 %."
        ]
    between = " (too few draws for an interval with this confidence)"
    if ends:
        interval = f"between {' and '.join(map(degrees, ends))}"
        between = f" (this quantile lies {interval} with {sure} confidence)"
    most = f"have an error of at most {degrees(draws.quantile_deg)}"
    quantile = f"{share} of the Monte Carlo trains {most}{between}"
    words.append(f"{quantile}; the largest error drawn is {degrees(draws.largest_deg)}.")
    return words


def _ends(draws: DrawnErrors) -> tuple[float, ...]:
    """The interval of the quantile; nothing where the draws were too few."""
    low, high = draws.quantile_low_deg, draws.quantile_high_deg
    return () if low is None or high is None else (low, high)


def _bins(histogram: Histogram) -> list[tuple[float, float, int]]:
    """Counts of drawn trains, each between two errors."""
    ends = pairwise(histogram.edges_deg)
    return [(a, b, n) for (a, b), n in zip(ends, histogram.counts, strict=True)]


def _bars(bins: list[tuple[float, float, int]], count: int) -> dict[str, Any]:
    texts = [f"{a:.4f} to {b:.4f}°: {n:,} ({100.0 * n / count:.3g} %)" for a, b, n in bins]
    middles = [0.5 * (a + b) for a, b, _ in bins]
    edge = {"color": "--series-1/0.55", "line": {"color": "--series-1", "width": 0.6}}
    wide, heights = [b - a for a, b, _ in bins], [n for *_, n in bins]
    trace = bars(middles, heights, edge, TEXT, orientation="v", width=wide, name="drawn")
    return trace | {"text": texts, "textposition": "none", "showlegend": False}


def _lines(draws: DrawnErrors, top: float) -> list[dict[str, Any]]:
    """Mean, quantile and limit as upright lines, with their values in the legend."""
    marks = (
        ("mean", draws.mean_deg, "--series-4", "dot"),
        (f"{100.0 * draws.probability:g} % quantile", draws.quantile_deg, "--series-5", "solid"),
        ("limit", draws.limit_deg, "--warn", "dash"),
    )
    named = [(f"{name} {degrees(at)}", at, colour, dash) for name, at, colour, dash in marks]
    return [
        lines([at, at], [0.0, top], colour, 2.0, dash, hover=f"{text}<extra></extra>", name=text)
        for text, at, colour, dash in named
    ]


def _interval(draws: DrawnErrors) -> list[dict[str, Any]]:
    """The interval of the quantile as a band."""
    return [band(ends[0], ends[1], "--series-5/0.2")] if (ends := _ends(draws)) else []
