"""The numbers of a design as tables: its stages, and whatever lists and groups it holds."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.pages.section import Section, Table
from gearopt.report.result_words import stage_rows, train_rows
from gearopt.report.words import heading, number


def section(result: Result) -> Section | None:
    """All tables of the design; None without a design."""
    design = dict(result.design)
    if not design:
        return None
    tables = []
    if stages := design.pop("stages", []):
        heads = ["", *(f"stage {k}" for k in range(1, len(stages) + 1))]
        tables.append(Table(heads, [[label, *cells] for label, cells in stage_rows(stages)]))
    return Section("Design", tables=[*tables, *_tables("", design)])


def trains(result: Result) -> Section | None:
    """The best distinct trains in proven order; None where only one was asked for."""
    found = result.report.get("trains") or []
    if not found:
        return None
    heads, rows = train_rows(found, result)
    return Section(
        "Best trains", tables=(Table([head.replace("\n", " ") for head in heads], rows),)
    )


def _tables(name: str, group: Mapping[str, Any]) -> list[Table]:
    """A table of the single values, then one for every list of records and every group."""
    found, single = [], []
    for key, value in group.items():
        if isinstance(value, Mapping):
            found += _tables(heading(key), value)
        elif _records(value):
            found.append(_list(heading(key), value))
        elif value is not None and value != []:
            single.append((heading(key), _cell(value)))
    return ([Table(("", ""), single, name)] if single else []) + found


def _records(value: Any) -> bool:
    return isinstance(value, Sequence) and bool(value) and isinstance(value[0], Mapping)


def _list(name: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    keys = list(dict.fromkeys(key for row in rows for key in row))
    return Table(
        [heading(key) for key in keys],
        [[_cell(row.get(key)) for key in keys] for row in rows],
        name,
    )


def _cell(value: Any) -> str:
    """A value as it is read; the items of a list with commas between."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return ", ".join(_cell(v) for v in value)
    if isinstance(value, float):
        return number(round(value, 6) + 0.0)  # no minus before a zero
    return number(value)
