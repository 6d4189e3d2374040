"""Elements of pages and terminal: sections of key figures, sentences, drawings, plots, tables.

A table is written once. What only one of the two shows of it is marked: columns and rows by name.
"""

import csv
import io
import re
from base64 import b64encode
from collections.abc import Collection, Mapping, Sequence
from dataclasses import field
from functools import cache
from typing import Any, get_type_hints

from rich.text import Text

from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown
from gearopt.report.drawing.player import Animation
from gearopt.report.drawing.sheet import Drawing, Row
from gearopt.report.measures import EXACT, Measures
from gearopt.report.plots import Figure
from gearopt.report.words import is_module, number, parted, share

# What spreadsheets take for formulas (wide signs in East Asian ones), unless it is a number.
FORMULA = re.compile(r"\s*[=+\-@\uff1d\uff0b\uff0d\uff20]|[\t\r\n]")
NUMBER = re.compile(r"[+-]?[0-9]*\.?[0-9]+([eE][+-]?[0-9]+)?")
ABSENT = "–"  # in place of a value that there is none of; a sentence gives the reason
ROWS_ON_TERMINAL = 24  # at most, of a list; the page and the CSV hold all
LONG_TABLE = 15  # rows; a longer table may break between rows when it is printed


@dataclass(frozen=True)
class Cell:
    """A value with a text of its own; share: a bar of so much of the cell is drawn behind it.

    short: the text on the terminal, where it is another one.
    """

    value: Any
    text: str
    share: float | None = None
    short: str | None = None


@dataclass(frozen=True)
class Table:
    """Rows of values or cells below heads, what it is called and what its CSV file is called.

    words: sentences, not numbers, that may break over lines. folded: a plot shows its values, so
    that the page holds its CSV only. page_only, terminal_only, csv_only: heads of the columns and
    labels (the first cells) of the rows that only one of them shows; the CSV holds those of the
    page, too, but for read_only. short: other heads on the terminal. left, wrap: how many columns
    stand on the left there, and how many may break over lines. texts: heads of columns of words,
    which stand on the left of the page. across: what it lists, as
    stages, stands side by side, each in a column. appendix: as of a `Section`.
    """

    name: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Any]]
    caption: str = ""
    words: bool = False
    folded: bool = False
    page_only: Collection[str] = ()
    terminal_only: Collection[str] = ()
    csv_only: Collection[str] = ()
    read_only: Collection[str] = ()
    short: Mapping[str, str] = field(default_factory=dict)
    left: int = 1
    wrap: int = 1
    texts: Collection[str] = ()
    across: bool = False
    appendix: bool = False

    def without(self, hidden: Collection[str]) -> tuple[list[str], list[list[Any]]]:
        """Heads and rows without the columns and rows of these names."""
        kept = [k for k, head in enumerate(self.heads) if head not in hidden]
        rows = [[row[k] for k in kept] for row in self.rows if _plain(row[0]) not in hidden]
        return [self.heads[k] for k in kept], rows

    @property
    def long(self) -> bool:
        """Whether it may not fit on a printed page."""
        return len(self.rows) > LONG_TABLE

    @property
    def stem(self) -> str:
        """The name as that of a file: "gaps [mm]" as "gaps-mm"."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")

    @property
    def on_page(self) -> tuple[list[str], list[list[Cell]]]:
        """Heads and cells as the page shows them."""
        heads, rows = self.without({*self.terminal_only, *self.csv_only})
        return heads, [[shown(value) for value in row] for row in rows]

    @property
    def on_terminal(self) -> tuple[list[str], list[list[Cell]]]:
        """Heads and cells as the terminal shows them."""
        heads, rows = self.without({*self.page_only, *self.csv_only})
        names = [self.short.get(head, head) for head in heads]
        return names, [[shown(value) for value in row] for row in rows]

    @property
    def values(self) -> tuple[list[str], list[list[Any]]]:
        """Heads and plain values in full precision, as the CSV has them."""
        heads, rows = self.without({*self.terminal_only, *self.read_only})
        return heads, [[v.value if isinstance(v, Cell) else v for v in row] for row in rows]

    @property
    def records(self) -> list[dict[str, Any]]:
        """A dict {column: value} for everything that the table lists.

        A list of names and values is one record; a column without a head is called name.
        """
        heads, rows = self.values
        if not any(heads):
            values = ([v for v in row[1:] if v not in (None, "")] for row in rows)
            cells = (v[0] if len(v) == 1 else v or None for v in values)
            return [dict(zip((str(row[0]) for row in rows), cells, strict=True))]
        columns = [head or "name" for head in heads]
        if self.across:
            columns, rows = (
                ["name", *(str(row[0]) for row in rows)],
                [[head, *cells] for head, *cells in zip(heads, *rows, strict=True)][1:],
            )
        return [dict(zip(columns, row, strict=True)) for row in rows]

    def csv(self) -> str:
        """Heads and values in full precision, as RFC 4180 has it."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        heads, rows = self.values
        if any(heads):
            writer.writerow(map(_csv, heads))
        writer.writerows(map(_csv, row) for row in rows)
        return text.getvalue()

    @property
    def link(self) -> str:
        """The CSV as an address that needs no network."""
        text = "\ufeff" + self.csv()  # the mark is for spreadsheets
        return "data:text/csv;charset=utf-8;base64," + b64encode(text.encode()).decode()


@dataclass(frozen=True)
class Tile:
    """A key figure: what it is called, its value with the unit, a remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A heading, then key figures, sentences, drawings at one scale, animations, plots, tables.

    half: two such sections stand side by side where the page is wide. folded: the page shows its
    heading, and the rest when asked; paper has all of it. appendix: what only a specialist
    checks, which is printed when the file asks for it. to_scale: its drawings are of bodies.
    hint: what a file may ask for, after the first sentence on a screen. terminal: the sentences and
    tables that the terminal shows of it, in its order. notes: sentences that come before all else,
    in a colour that is not missed.
    """

    heading: str
    tiles: Sequence[Tile] = ()
    words: Sequence[str] = ()
    drawings: Sequence[Drawing] = ()
    animations: Sequence[Animation] = ()
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    half: bool = False
    folded: bool = False
    appendix: bool = False
    to_scale: bool = False
    hint: str = ""
    terminal: Sequence[str | Text | Table] = ()
    notes: Sequence[str] = ()

    @property
    def plain(self) -> bool:
        """Whether it has sentences alone."""
        return not any((self.tiles, self.drawings, self.animations, self.figures, self.tables))

    @property
    def row(self) -> Row:
        """The drawings as they stand side by side."""
        return Row(self.drawings, self.to_scale)


def shown(value: Any) -> Cell:
    """A value as it is read."""
    if isinstance(value, Cell):
        return value
    if value is None:
        return Cell(value, "")
    if isinstance(value, bool):
        return Cell(value, "yes" if value else "no")
    return Cell(value, number(value))


def cell(value: Any, suffix: str, measures: Measures) -> Cell:
    """A value of a result in the unit that is shown, with the digits that are read."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return shown(value)
    if not suffix:
        return shown(value)
    return Cell(measures.of(value, suffix), measures.number(value, suffix))


@dataclass(frozen=True)
class ListedField:
    """A field of a design as a table lists it: its key, label, unit and format (see `Shown`)."""

    key: str
    label: str
    unit: str
    form: str

    def head(self, measures: Measures) -> str:
        """The label with the unit."""
        return f"{self.label} [{measures.unit(self.unit)}]" if self.unit else self.label

    def cell(self, value: Any, measures: Measures) -> Cell:
        """A value of the field as it is read; a length has decimals by its unit."""
        if self.form == "share":
            return percent(value)
        if self.key.endswith("face_width_mm") and value is not None and not self.form:
            return _not_narrower(value, measures)
        if not self.form or value is None:
            return cell(value, self.unit, measures)
        if self.form.isdigit():
            return Cell(measures.of(value, "mm"), measures.short_length(value, int(self.form)))
        if self.unit == "mm":
            return Cell(measures.of(value, "mm"), measures.length(value, int(self.form[1:-1])))
        size = measures.of(value, self.unit)
        return Cell(size, format(size, self.form))


def _not_narrower(width: float, measures: Measures) -> Cell:
    """A face width, rounded up where it is not exact, so that gears as shown carry as much."""
    size, text = measures.of(width, "mm"), measures.number(width, "mm")
    if float(text.replace(",", "")) < size * (1.0 - EXACT):
        text = measures.number(width, "mm", 1)
    return Cell(size, text)


def _unit(key: str) -> str:
    """The unit at the end of a field's name; a module is a length here, in inches, too."""
    return "mm" if is_module(key) else parted(key)[1]


@cache
def listed_fields(kind: type, table: str = "") -> tuple[ListedField, ...]:
    """The fields of a dataclass that a table lists, in their order."""
    return tuple(
        ListedField(key, said.label, _unit(key) if said.unit is None else said.unit, said.form)
        for key, hint in get_type_hints(kind, include_extras=True).items()
        for said in getattr(hint, "__metadata__", ())
        if isinstance(said, Shown) and said.table == table
    )


def names_and_values(
    design: Any,
    measures: Measures,
    table: str = "",
    values: Mapping[str, Any] | None = None,
    labels: Mapping[str, str] | None = None,
) -> list[list[Any]]:
    """A row for every field that a table lists and that is known.

    values, labels: what is shown instead of some fields' own, by key.
    """
    rows: list[list[Any]] = []
    for it in listed_fields(design.__class__, table):
        value = (values or {}).get(it.key, getattr(design, it.key))
        if value is not None:
            label = (labels or {}).get(it.key) or it.head(measures)
            rows.append([label, it.cell(value, measures)])
    return rows


def columns(design: Any, measures: Measures, name: str, **look: Any) -> Table:
    """A table of fields that hold columns, whose table has this name."""
    held = listed_fields(design.__class__, name)
    cells = [[it.cell(v, measures) for v in getattr(design, it.key)] for it in held]
    heads = [it.head(measures) for it in held]
    return Table(name, heads, list(zip(*cells, strict=True)), **look)


def records(
    rows: Sequence[Any], measures: Measures, table: str = ""
) -> tuple[list[str], list[Any]]:
    """Heads, and a row for every record, of the fields that a table lists."""
    held = listed_fields(rows[0].__class__, table) if rows else ()
    heads = [it.head(measures) for it in held]
    return heads, [[it.cell(getattr(row, it.key), measures) for it in held] for row in rows]


def side_by_side(items: Sequence[Any], measures: Measures, table: str = "") -> list[list[Any]]:
    """A row for every field that a table lists and some item has, a column for each item."""
    held = [
        (it, [getattr(item, it.key) for item in items])
        for it in listed_fields(items[0].__class__, table)
    ]
    return [
        [it.head(measures), *(it.cell(value, measures) for value in values)]
        for it, values in held
        if any(value is not None for value in values)
    ]


def percent(used: float | None) -> Cell:
    """A part of a whole in per cent, with its bar."""
    if used is None:
        return Cell(None, "")
    return Cell(100.0 * used, share(used), min(1.0, max(0.0, used)))


def _csv(value: Any) -> Any:
    """A value as CSV holds it: before a text that a spreadsheet would compute stands a '."""
    if value.__class__ is float:
        return value
    text = _plain(value)
    if not isinstance(text, str) or NUMBER.fullmatch(text) or not FORMULA.match(text):
        return text
    return f"'{text}"


def _plain(value: Any) -> Any:
    """A value as CSV holds it; TypeError for several in one cell."""
    if isinstance(value, Cell):
        return _plain(value.value)
    if isinstance(value, list | tuple):
        raise TypeError(f"a cell holds one value, not {value}")
    return "" if value is None else value
