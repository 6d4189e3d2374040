"""The numbers of a design as tables: its stages, and whatever lists and groups it holds."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.section import Section
from gearopt.report.pages.table import Cell, Table, percent
from gearopt.report.result_words import EXACT, PAGE_ROWS, ranked, stage_rows, train_rows
from gearopt.report.words import heading, parted


def section(result: Result, measures: Measures) -> Section | None:
    """All tables of the design; None without one, and for kinds whose sections tell its numbers."""
    design = dict(result.design)
    if not design or result.scene == "servo":
        return None
    tables = []
    if stages := design.pop("stages", []):
        heads = ["", *(f"stage {k}" for k in range(1, len(stages) + 1))]
        rows = [[label, *values] for label, values in stage_rows(stages, measures, PAGE_ROWS)]
        tables.append(Table("stages", heads, rows))
        tables += _shares(stages, measures)
    return Section("Design", tables=[*tables, *_tables("", design, measures)])


def _shares(stages: Sequence[Mapping[str, Any]], measures: Measures) -> list[Table]:
    """Volume and mass by stage; nothing to share out for one stage."""
    if len(stages) < 2:
        return []
    volumes = [s["gear_volume_mm3"] for s in stages]
    heads = ["", f"volume [{measures.unit('cm3')}]", "share, %"]
    columns = [
        [measures.of(v, "cm3") for v in volumes],
        [percent(v / sum(volumes)) for v in volumes],
    ]
    if all("mass_kg" in s for s in stages):
        heads.append(f"mass [{measures.unit('kg')}]")
        columns.append([measures.of(s["mass_kg"], "kg") for s in stages])
    rows = [[f"stage {k}", *cells] for k, cells in enumerate(zip(*columns, strict=True), 1)]
    return [Table("volume and mass", heads, rows)]


def trains(result: Result, measures: Measures) -> Section | None:
    """The best distinct trains in proven order; None where only one was asked for."""
    if (best := ranked(result)) is None:
        return None
    found = best.report["trains"]
    heads, rows = train_rows(found, best, measures)
    heads = (*heads[:2], "more, %", *heads[2:])
    least = found[0]["objective"]
    more = [100.0 * (train["objective"] / least - 1.0) for train in found]
    cells = [
        (
            rank,
            value,
            Cell(extra, f"{extra:.2f}"),
            Cell(ratio, f"{ratio:.4f}"),
            teeth,
            Cell([measures.of(s["centre_distance_mm"], "mm") for s in one["stages"]], centres),
        )
        for (rank, value, ratio, teeth, centres), extra, one in zip(rows, more, found, strict=True)
    ]
    table = Table("best trains", [head.replace("\n", " ") for head in heads], cells)
    words = (
        "Distinct choices of teeth, each with its best modules and widths: nothing better than the "
        "last one is left out."
    )
    whole = best.proof.get("method") == "exhausted" and (best.gap or 0.0) <= EXACT
    words = words if whole else "The best of the trains that were found; others may be better."
    return Section("Next best trains", words=(words,), tables=(table,))


def _tables(name: str, group: Mapping[str, Any], measures: Measures) -> list[Table]:
    """A table of the single values, then one for every list of records and every group."""
    found, single = [], []
    for key, value in group.items():
        if isinstance(value, Mapping):
            found += _tables(heading(key, measures), value, measures)
        elif _records(value):
            found.append(_list(heading(key, measures), value, measures))
        elif value is not None and value != []:
            single.append((heading(key, measures), _converted(key, value, measures)))
    return ([Table(name or "totals", ("", ""), single, name)] if single else []) + found


def _records(value: Any) -> bool:
    return isinstance(value, Sequence) and bool(value) and isinstance(value[0], Mapping)


def _list(name: str, rows: Sequence[Mapping[str, Any]], measures: Measures) -> Table:
    keys = list(dict.fromkeys(key for row in rows for key in row))
    cells = [[_converted(key, row.get(key), measures) for key in keys] for row in rows]
    return Table(name, [heading(key, measures) for key in keys], cells, name)


def _converted(key: str, value: Any, measures: Measures) -> Any:
    """A value of a design in the unit that is shown."""
    unit = parted(key, measures)[1]
    if unit and isinstance(value, list):
        return [measures.of(v, unit) for v in value]
    return measures.of(value, unit) if unit and value is not None else value
