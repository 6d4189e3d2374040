"""A result on the terminal: the sections of its kind, in words and tables."""

from collections.abc import Sequence
from typing import Any

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.table import Table as Grid
from rich.text import Text

from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.result import Result
from gearopt.report.kinds import kind_of
from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages.prices import of_influences
from gearopt.report.result_words import goal, leading, title, verdict
from gearopt.report.section import Table
from gearopt.report.terminal.table import grid
from gearopt.report.words import VERDICTS, amount, heading, limit_words, number


def show(result: Result, console: Console, measures: Measures = METRIC) -> None:
    """Print a result."""
    words, colour = verdict(result)
    console.print(Text.assemble((title(result), "bold"), ": ", (words, f"bold {colour}")))
    _print(leading(result), console)
    for make in kind_of(result).terminal:
        if (section := make(result, measures)) is not None:
            _print(section.terminal, console)


def show_explanation(explanation: Explanation, console: Console) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    name, unit, reached, _, _ = goal(result)
    words, colour = VERDICTS[result.status]
    value = amount(reached, unit)
    console.print(
        Text.assemble((title(result), "bold"), f": {name} {value}, ", (words, f"bold {colour}"))
    )
    full = ", ".join(limit_words(n) for n in explanation.binding)
    console.print(Text(f"Used to the full: {full}." if full else "No limit is used to the full."))
    _print(of_influences(explanation.prices, result).terminal, console)


def _print(blocks: Sequence[Any], console: Console) -> None:
    """Print sentences and tables with a blank line before each."""
    for block in blocks:
        console.print()
        console.print(_shown(block))


def _shown(block: Any) -> RenderableType:
    if isinstance(block, str):
        return Text(block)
    return grid(block) if isinstance(block, Table) else block


def rows_table(rows: list[dict[str, Any]]) -> RenderableType:
    """Rows of a bench as a table."""
    heads = [escape(heading(k)) for k in rows[0]]
    table = Grid(*heads, box=None, header_style="bold", pad_edge=False)
    for row in rows:
        table.add_row(*["" if v is None else number(v) for v in row.values()])
    return table
