"""Tables on the terminal."""

from typing import Any

from rich.markup import escape
from rich.table import Table as Grid
from rich.text import Text

from gearopt.report.section import Cell, Table
from gearopt.report.words import REACHED, number


def columns(first: str, heads: list[str]) -> Grid:
    """A plain table of right-aligned columns beside a column of names."""
    return aligned([first, *heads])


def aligned(heads: list[str], left: int = 1, wrap: int = 1) -> Grid:
    """A plain table; left, wrap: columns that stand on the left, and that may break over lines."""
    table = Grid(*map(escape, heads), box=None, header_style="bold", pad_edge=False)
    for k, column in enumerate(table.columns):
        column.justify, column.no_wrap = "left" if k < left else "right", k >= wrap
    return table


def grid(table: Table) -> Grid:
    """A table of a section as the terminal shows it; without heads a list of names and values."""
    heads, rows = table.without(table.page_only)
    if any(heads):
        shown = aligned([table.short.get(head, head) for head in heads], table.left, table.wrap)
    else:
        shown = Grid.grid(padding=(0, 2))
    for row in rows:
        shown.add_row(*map(_cell, row))
    return shown


def _cell(value: Any) -> Text:
    if isinstance(value, Cell):
        full = value.share is not None and value.share > 1.0 - REACHED
        text = value.text if value.short is None else value.short
        return Text(text, style="bold" if full else "")
    return Text("" if value is None else number(value))
