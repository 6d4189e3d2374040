"""What a result answers: the tables of its file, and the options of the run."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Section, Table

WORDS = ("title", "source")  # keys of a file that are sentences


def section(result: Result, measures: Measures) -> Section | None:
    """The file's tables as it has them; None where there was no file."""
    asked = {key: value for key, value in result.asked.items() if key not in WORDS}
    if not asked:
        return None
    source = result.asked.get("source")
    words = [f"Source: {source}."] if source else []
    single = {key: value for key, value in asked.items() if not _is_table(value)}
    tables = [_table(key, value) for key, value in asked.items() if _is_table(value)]
    if single:
        tables.insert(0, _table("", single))
    return Section("What was asked", words=words, tables=tables)


def _is_table(value: Any) -> bool:
    several = isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    return several or isinstance(value, Mapping)


def _table(key: str, value: Any) -> Table:
    """A table of the file, one column a table where the file has several of a name."""
    several = isinstance(value, list)
    columns: Sequence[Mapping[str, Any]] = value if several else (value,)
    names = list(dict.fromkeys(name for column in columns for name in column))
    heads = [f"[[{key}]]", *(str(k + 1) for k in range(len(columns)))]
    heads = heads if several else [f"[{key}]" if key else "", ""]
    rows = [[name, *(_ends(column.get(name)) for column in columns)] for name in names]
    return Table(f"asked {key}".strip(), heads, rows)


def _ends(value: Any) -> Any:
    """A value as the file writes it."""
    if isinstance(value, list):
        return Cell(value, f"[{', '.join(str(v) for v in value)}]")
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return Cell(value, f"{value:.15g}") if number else value
