"""A result on the terminal: the design, its limits, and what is proven in words."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from gearopt.optimise.result import Result
from gearopt.report.measures import METRIC, Measures
from gearopt.report.proof_words import proof
from gearopt.report.result_words import (
    leading,
    limit_rows,
    ranked,
    stage_rows,
    title,
    train_rows,
    verdict,
)
from gearopt.report.side_by_side_words import side_by_side
from gearopt.report.terminal import packing, servo
from gearopt.report.terminal.explanation import influences, remedies
from gearopt.report.terminal.layout import layout
from gearopt.report.words import REACHED, columns, heading, number, parted, share


def show(result: Result, console: Console, measures: Measures = METRIC) -> None:
    """Print a result."""
    words, colour = verdict(result)
    console.print(Text.assemble((title(result), "bold"), ": ", (words, f"bold {colour}")))
    for block in [*map(Text, leading(result)), *_blocks(result, measures)]:
        console.print()
        console.print(block)


def _blocks(result: Result, measures: Measures) -> list[RenderableType]:
    blocks: list[RenderableType] = []
    if result.value is not None:
        blocks += _answer(result, measures)
        if (best := ranked(result)) is not None:
            blocks.append(_trains(best.report["trains"], best, measures))
        blocks += _processes(result, measures)
        if prices := result.report.get("prices"):
            blocks += influences(prices, result)
    if "ways_out" in result.report:
        ways = result.report["ways_out"]
        if not ways["conflict"] and result.message not in ("", ways["message"]):
            blocks.append(Text(result.message))
        blocks += remedies(result.report["ways_out"])
    blocks.append(Text("\n".join(proof(result, measures))))
    return blocks


def _answer(result: Result, measures: Measures) -> list[RenderableType]:
    """The design, in the words of its kind."""
    if result.scene == "packing":
        return [packing.design(result.design, measures)]
    if result.scene == "servo":
        limits = [_limits(result.limits, "whole")] if result.limits else []
        return [*servo.design(result, measures), *limits]
    blocks = [_design(result.design, measures)]
    if "layout" in result.design:
        blocks.append(layout(result.design["layout"], measures))
    return [*blocks, _limits(result.limits)] if result.limits else blocks


def _design(design: Mapping[str, Any], measures: Measures) -> RenderableType:
    """Stages side by side, then the totals."""
    parts: list[RenderableType] = []
    stages = design.get("stages", [])
    if stages:
        table = columns("", [f"stage {k}" for k in range(1, len(stages) + 1)])
        for label, values in stage_rows(stages, measures):
            table.add_row(Text(label), *map(number, values))
        parts += [table, ""]
    totals = Table.grid(padding=(0, 2))
    for key, value in design.items():
        records = isinstance(value, list) and any(isinstance(v, Mapping | list) for v in value)
        if not isinstance(value, Mapping) and not records:
            unit = parted(key, measures)[1]
            shown = measures.of(value, unit) if unit else value
            totals.add_row(Text(heading(key, measures)), number(shown))
    return Group(*parts, totals)


def _limits(limits: Mapping[str, float], whole: str = "drive") -> RenderableType:
    """Utilisation of every limit in percent, stages side by side."""
    count, rows = limit_rows(limits)
    stages = [f"stage {k}" for k in range(1, count + 1)]
    table = columns("limit used, %", [*stages, whole])
    for words, values in rows:
        table.add_row(words, *map(_percent, values))
    return table


def _percent(value: float | None) -> Text:
    if value is None:
        return Text("")
    return Text(share(value), style="bold" if value > 1.0 - REACHED else "")


def _trains(trains: list[Mapping[str, Any]], result: Result, measures: Measures) -> RenderableType:
    heads, rows = train_rows(trains, result, measures)
    table = Table(*heads, box=None, header_style="bold", pad_edge=False)
    for rank, value, ratio, teeth, distances in rows:
        table.add_row(str(rank), number(value), f"{ratio:.4f}", teeth, distances)
    return table


def _processes(result: Result, measures: Measures) -> list[RenderableType]:
    """The designs by rules beside the best one; nothing where the file asks for none."""
    heads, rows, missing = side_by_side(result, measures)
    if not rows:
        return []
    table = columns(heads[0], heads[1:])
    for label, *cells in rows:
        table.add_row(Text(label), *("" if v is None else number(v) for v in cells))
    return [table, *map(Text, missing)]


def rows_table(rows: list[dict[str, Any]]) -> RenderableType:
    """Rows of a bench as a table."""
    heads = [escape(heading(k)) for k in rows[0]]
    table = Table(*heads, box=None, header_style="bold", pad_edge=False)
    for row in rows:
        table.add_row(*["" if v is None else number(v) for v in row.values()])
    return table
