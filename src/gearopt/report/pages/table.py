"""A table of a page: values as they are, so that its CSV is exact, and how they are shown."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from gearopt.report.words import number, share

LONG = 24  # rows; a longer table may break between rows when it is printed


@dataclass(frozen=True)
class Cell:
    """A value with a text of its own; share: a bar of so much of the cell is drawn behind it."""

    value: Any
    text: str
    share: float | None = None


@dataclass(frozen=True)
class Table:
    """Rows of values or cells below heads, what it is called and what its CSV file is called.

    words: sentences, not numbers, that may break over lines. folded: a plot shows its values, so
    that the page holds its CSV only.
    """

    name: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Any]]
    caption: str = ""
    words: bool = False
    folded: bool = False

    @property
    def long(self) -> bool:
        """Whether it may not fit on a printed page."""
        return len(self.rows) > LONG

    @property
    def stem(self) -> str:
        """Its name as that of a file: "gaps [mm]" as "gaps-mm"."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")

    @property
    def shown(self) -> list[list[Cell]]:
        """Every value as it is read."""
        return [[shown(value) for value in row] for row in self.rows]

    def csv(self) -> str:
        """Heads and values in full precision, as RFC 4180 has it."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        if any(self.heads):
            writer.writerow(self.heads)
        writer.writerows([_plain(value) for value in row] for row in self.rows)
        return text.getvalue()

    @property
    def link(self) -> str:
        """The CSV as an address that needs no network."""
        return "data:text/csv;charset=utf-8," + quote("\ufeff" + self.csv())  # for spreadsheets


def shown(value: Any) -> Cell:
    """A value as it is read; the items of a list with commas between."""
    if isinstance(value, Cell):
        return value
    if value is None:
        return Cell(value, "")
    if isinstance(value, bool):
        return Cell(value, "yes" if value else "no")
    if isinstance(value, list | tuple):
        return Cell(value, ", ".join(shown(v).text for v in value))
    if isinstance(value, float):
        return Cell(value, number(round(value, 6) + 0.0))  # no minus before a zero
    return Cell(value, number(value))


def percent(used: float | None) -> Cell:
    """A part of a whole in per cent, with its bar."""
    if used is None:
        return Cell(None, "")
    return Cell(100.0 * used, share(used), min(1.0, max(0.0, used)))


def _plain(value: Any) -> Any:
    """A value as CSV holds it."""
    if isinstance(value, Cell):
        return _plain(value.value)
    if isinstance(value, list | tuple):
        return "; ".join(str(_plain(v)) for v in value)
    return "" if value is None else value
