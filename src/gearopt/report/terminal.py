"""The terminal: sections of a result, explanations and comparisons, in words and tables."""

import math
from collections.abc import Iterator, Sequence

from rich.console import Console, JustifyMethod
from rich.containers import Renderables
from rich.markup import escape
from rich.table import Table as Grid
from rich.text import Text

from gearopt.optimise.comparing.comparison import Comparison, Group
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.pareto.front import Front
from gearopt.optimise.result import Result
from gearopt.report import comparison as words
from gearopt.report import front
from gearopt.report.answer import assumed, decided, warnings_of
from gearopt.report.explained import of_influences
from gearopt.report.kinds import pages_of_result
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import ROWS_ON_TERMINAL, Cell, Table
from gearopt.report.words import (
    REACHED,
    amount,
    effort,
    goal,
    leading,
    title,
    verdict,
)

LABEL = 20  # columns of the terminal that the first column of a table of words has at least
CELL = 18  # columns of the terminal from which on texts side by side break, where room is short
COLUMN_GAP = 2  # columns of the terminal between those of a table
INDENT = "  "


def grid(table: Table, width: int) -> Grid | Renderables:
    """A section's table for the terminal; without heads a list of names and values.

    width: columns of the terminal. Of a table of words in which the first column has too little
    room, its text stands above that of the second. What a table lists side by side, without room
    for the names of its rows, stands in groups, one below the other.
    """
    heads, rows = table.on_terminal
    if table.words and _narrow(table, width):
        return _stacked(table, width)
    if table.across and any(heads) and _narrow(table, width):
        return Renderables(_groups(table, width))
    if any(heads):
        shown = Grid(*map(escape, heads), box=None, header_style="bold", pad_edge=False)
        for k, column in enumerate(shown.columns):
            column.justify = "left" if k < table.left else "right"
            column.no_wrap = k >= table.wrap
    else:
        shown = Grid.grid(padding=(0, 2))
    for row in rows:
        shown.add_row(*map(_text, row))
    return shown


def _narrow(table: Table, width: int) -> bool:
    """Whether a table's first column would have less than LABEL columns, and needs more."""
    first, *others = (max(map(len, column)) for column in _columns(table))
    return width - sum(COLUMN_GAP + other for other in others) < min(first, LABEL)


def _groups(table: Table, width: int) -> Iterator[Grid | str]:
    """Yield parts of what a table lists side by side, whose texts break from CELL columns on."""
    heads, rows = table.on_terminal
    label, *others = _columns(table)
    wide = max(min(CELL, max(map(len, column))) for column in others)
    most = max(1, (width - min(LABEL, max(map(len, label)))) // (COLUMN_GAP + wide))
    size = math.ceil(len(others) / math.ceil(len(others) / most))
    for start in range(1, len(heads), size):
        if start > 1:
            yield ""
        kept = slice(start, start + size)
        shown = Grid(box=None, header_style="bold", pad_edge=False)
        shown.add_column(escape(heads[0]))
        for head in heads[kept]:
            shown.add_column(escape(head), justify="right", max_width=CELL, overflow="fold")
        for row in rows:
            shown.add_row(*map(_text, (row[0], *row[kept])))
        yield shown


def _columns(table: Table) -> list[list[str]]:
    """Head and texts of every column."""
    heads, rows = table.on_terminal
    return [[head, *(row[k].text for row in rows)] for k, head in enumerate(heads)]


def _stacked(table: Table, width: int) -> Grid:
    """A table whose first column stands above the second one, which is never cut.

    The second one breaks where the others, of which those on the left break, leave no room for it.
    A row that continues the one before, by a first cell that is indented, has one line.
    """
    (first, second, *heads), rows = table.on_terminal
    _, widest, *others = _columns(table)
    room = width - len(INDENT) - max(map(len, widest))
    for k, column in enumerate(others, 2):
        pieces = " ".join(column).split() if k < table.left else column
        room -= COLUMN_GAP + max(map(len, pieces))
    shown = Grid(box=None, header_style="bold", pad_edge=False)
    both = f"{escape(first)}\n{INDENT}{escape(second)}"
    shown.add_column(both, no_wrap=room >= 0, overflow="fold")
    for k, head in enumerate(heads, 2):
        breaks = k < table.left
        side: JustifyMethod = "left" if breaks else "right"
        shown.add_column(escape(head), justify=side, no_wrap=not breaks, vertical="bottom")
    for label, value, *more in rows:
        above = "" if label.text.startswith(" ") else f"{label.text}\n"
        shown.add_row(Text(f"{above}{INDENT}{value.text}"), *map(_text, more))
    return shown


def _text(cell: Cell) -> Text:
    full = cell.share is not None and cell.share > 1.0 - REACHED
    return Text(cell.text if cell.short is None else cell.short, style="bold" if full else "")


def show(
    result: Result, console: Console, measures: Measures = METRIC, explained: bool = False
) -> None:
    """Print a result; explained: by a command that writes no page."""
    words, colour = verdict(result)
    name, unit, value, _, _ = goal(result)
    known = "" if value is None or "achieved" in result.report else amount(value, unit, measures)
    reached = f"{name} {known}, " if known else ""
    console.print(Text.assemble((title(result), "bold"), f": {reached}", (words, f"bold {colour}")))
    console.print(Text(decided(result, measures)))
    yellow = [Text(line, style="yellow") for line in warnings_of(result, measures)]
    _print([*map(measures.words, leading(result)), *yellow], console)
    for make in pages_of_result(result).terminal:
        if (section := make(result, measures)) is not None:
            _print(section.terminal, console)
    for sentence in assumed(result, *["--json lists"] * explained):
        console.print(Text(sentence, style="dim"))


def show_explanation(
    explanation: Explanation, console: Console, measures: Measures = METRIC
) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    name, unit, reached, _, _ = goal(result)
    words, colour = verdict(result)
    value = amount(reached, unit, measures)
    console.print(
        Text.assemble((title(result), "bold"), f": {name} {value}, ", (words, f"bold {colour}"))
    )
    console.print(Text(decided(result, measures)))
    _print(of_influences(explanation.prices, result, measures).terminal, console)


def _print(blocks: Sequence[str | Text | Table], console: Console) -> None:
    """Print sentences and tables with a blank line before each."""
    for block in blocks:
        console.print()
        console.print(
            grid(block, console.width) if isinstance(block, Table) else Text.assemble(block)
        )


def show_comparison(comparison: Comparison, console: Console) -> None:
    """Print a comparison."""
    console.print(Text.assemble((comparison.title, "bold"), ": methods compared"))
    if comparison.message:
        console.print(
            Text(comparison.message[0].upper() + comparison.message[1:] + ".", style="yellow")
        )
    if len(comparison.groups) > 1:
        console.print(
            "Methods of different models answer different questions: compare within a model."
        )
    for group in comparison.groups:
        _group(comparison, group, console)
    console.print()
    for row in (row for group in comparison.groups for row in group.rows if not row.refused):
        kind = (
            words.counted(len(comparison.seeds), "seed") if row.random else "deterministic, one run"
        )
        settings = words.settings(comparison.settings[row.method])
        line = (
            f"{row.method}: {kind}; evaluation = {row.counts}; "
            f"start-up {row.start_up_seconds:.2g} s; {settings}"
        )
        console.print(Text(line, style="dim"), no_wrap=True, overflow="ellipsis")
    console.print(
        Text(f"{comparison.machine['cpus']} cores. {words.command(comparison)}", style="dim")
    )


def _group(comparison: Comparison, group: Group, console: Console) -> None:
    console.print()
    console.print(Text(words.heading(comparison, group), style="bold"))
    console.print(Text(words.reference(group, comparison.scene)))
    for row in group.rows:
        console.print(Text(f"- {row.method}: {words.verdict(group, row)}"))
    for field, name, budget in words.kinds(comparison):
        heads = [f"{head}\n{unit}" for head, unit, _ in words.columns(comparison)]
        samples = ((row.method, getattr(row, field)) for row in group.rows)
        rows = [
            (method, *words.cells(comparison, sample))
            for method, sample in samples
            if sample is not None
        ]
        if rows:
            console.print()
            console.print(Text(f"{name}: {budget}", style="bold"))
            table = Table(name, ("method", *heads), rows, wrap=1 + len(heads))
            console.print(grid(table, console.width))
    for row in group.rows:
        if late := words.ended(comparison, row):
            console.print(Text(f"Equal evaluations: {late}.", style="yellow"))


def show_front(pareto: Front, console: Console, measures: Measures = METRIC) -> None:
    """Print a Pareto front."""
    said, colour = front.verdict(pareto)
    console.print(Text.assemble((front.title(pareto), "bold"), ": ", (said, f"bold {colour}")))
    for line in front.decided(pareto, measures):
        console.print(Text(line))
    if pareto.points:
        console.print()
        console.print(grid(front.table(pareto, measures, ROWS_ON_TERMINAL), console.width))
        hidden = len(pareto.points) - ROWS_ON_TERMINAL
        if hidden > 0:
            console.print(Text("Some of the designs; --csv, --html and --json hold all.", "dim"))
        if rating := front.rating_command(pareto):
            console.print(
                Text(f"Full rating of a design: write --json > front.json, then {rating}", "dim")
            )
    for line in front.picked(pareto, measures):
        console.print()
        console.print(Text(line))
    console.print()
    if pareto.status == "infeasible" and pareto.file and not pareto.options.get("most"):
        console.print(Text(f"What to write instead: gearopt explain {pareto.file}\n"))
    spent = effort(pareto.method, pareto.evaluations, pareto.seconds)
    console.print(Text(spent, style="dim"))
