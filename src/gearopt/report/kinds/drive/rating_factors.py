"""The factors of a rating as a table: values of every gear, sources, what is unverified."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.rating import DriveRating, RatingFactor
from gearopt.optimise.result import Result
from gearopt.report.kinds.drive.rating_symbols import SHORT, SHOWN_UNITS, greek
from gearopt.report.kinds.drive.rating_tables import names
from gearopt.report.kinds.drive.rating_words import rating_of, unverified
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Section, Table, cell
from gearopt.report.words import series_of

GIVEN = "given"  # source of a factor of the file
ABREAST = {"AGMA": 3, "ISO 6336": 2}  # stages whose factors fit side by side on a terminal


def factors(result: Result, measures: Measures) -> Section | None:
    """Return every factor with its source; None without a rating."""
    if (found := rating_of(result)) is None:
        return None
    tables = [_table(one, found.beside is not None, measures) for one in found.each]
    level = (
        " For a load spectrum the factors are those of the level with the largest stress."
        if found.levels
        else ""
    )
    words = [f"A single value applies to both gears.{level}"]
    words += map(measures.words, unverified(found))
    told: list[str | Table] = []
    for one in found.each:
        told += _factors_told(one, found.beside is not None, measures)
    told += words[1:]
    for table in tables:
        told += _remarks(table.rows)
    return Section("Factors", words=words, tables=tables, terminal=told)


def _symbols(found: DriveRating) -> list[list[RatingFactor]]:
    """Return the factors of a standard, those of one symbol together."""
    symbols: dict[str, list[RatingFactor]] = {}
    for factor in found.factors:
        symbols.setdefault(factor.symbol, []).append(factor)
    return list(symbols.values())


def _table(found: DriveRating, named: bool, measures: Measures) -> Table:
    """Return the factors of a standard, which is named beside another one."""
    heads = ["symbol", "factor", "unit", *names(found), "unverified", "source", "remark"]
    rows = [_factor_row(found, own, measures) for own in _symbols(found)]
    hidden = ["unit", "unverified"] + ([] if any(row[-1].value for row in rows) else ["remark"])
    return Table(
        f"factors by {found.by}" if named else "factors",
        heads,
        rows,
        caption=f"Factors by {found.by}" if named else "",
        csv_only=hidden,
        texts=("factor", "source", "remark"),
    )


def _remarks(rows: Sequence[Sequence[Any]]) -> list[str]:
    """Return what limits factors, for the terminal; what limits several once."""
    symbols: dict[str, list[str]] = {}
    for symbol, *_, remark in rows:
        if remark.value:
            symbols.setdefault(remark.text, []).append(greek(symbol.value))
    lines = [f"{series_of(own)}: {remark}." for remark, own in symbols.items()]
    return ["\n".join(lines)] if lines else []


def _factor_row(found: DriveRating, own: Sequence[RatingFactor], measures: Measures) -> list[Any]:
    """Return a factor of all stages: its values, where they are from, what limits them."""
    one = own[0]
    sign, symbol, remarks = (
        measures.unit(_unit(one)),
        greek(one.symbol),
        measures.words(_by_stage(found, own, "remark")),
    )
    return [
        Cell(one.symbol, f"{symbol} [{sign}]" if sign else symbol),
        Cell(one.name, greek(one.name)),
        sign,
        *(value for factor in own for value in _values(factor, measures)),
        ", ".join(str(factor.stage) for factor in own if not factor.verified),
        _by_stage(found, own, "source"),
        Cell(remarks, greek(remarks)),
    ]


def _unit(factor: RatingFactor) -> str:
    """Return the unit that a factor is shown in, as `Measures` calls it."""
    return SHOWN_UNITS.get(factor.symbol, factor.unit)


def _by_stage(found: DriveRating, own: Sequence[RatingFactor], key: str) -> str:
    """Return words of a factor in every stage; sources, and what is the same, once."""
    stages: dict[str, list[str]] = {}
    for factor in own:
        stages.setdefault(getattr(factor, key), []).append(str(factor.stage))
    if len(stages) == 1 or key == "source" and GIVEN not in stages:
        return "; ".join(dict.fromkeys(part for words in stages for part in words.split("; ")))
    return "; ".join(f"stage {series_of(k)}: {words}" for words, k in stages.items() if words)


def _values(factor: RatingFactor, measures: Measures) -> list[Cell]:
    """Return the values of pinion and wheel; of a factor of the mesh the page shows one."""
    first = cell(factor.pinion, _unit(factor), measures)
    if not factor.verified:
        first = replace(first, text=f"{first.text}\nunverified", short=first.text)
    if factor.wheel is None:
        return [first, replace(first, text="", short=None)]
    second = cell(factor.wheel, _unit(factor), measures)
    if not factor.verified:
        second = replace(second, text=f"{second.text}\nunverified", short=second.text)
    return [first, second]


def _factors_told(found: DriveRating, named: bool, measures: Measures) -> list[Table]:
    """Return the factors as the terminal shows them, of so many stages as fit side by side."""
    made, alone, abreast = [], len(found.meshes) == 1, ABREAST[found.by]
    of = SHORT[found.by] if named else ""
    for start in range(0, len(found.meshes), abreast):
        heads = [of, *[""] * alone, *names(found)[2 * start : 2 * (start + abreast)], ""]
        rows = []
        for own in _symbols(found):
            part = own[start : start + abreast]
            symbol, what = _factor_row(found, part, measures)[:2]
            values = [value for factor in part for value in _values(factor, measures)]
            rows.append([symbol, *[what] * alone, *values, _state(part)])
        made.append(Table("factors", heads, rows, left=1 + alone, wrap=0))
    return made


def _state(own: Sequence[RatingFactor]) -> str:
    """Return whether values of a factor are given or unverified."""
    unsure = not all(factor.verified for factor in own)
    given = all(factor.source == GIVEN for factor in own)
    return "unverified" if unsure else GIVEN if given else ""
