"""The factors of a rating as a table: values of every gear, sources, what is unverified."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.rating import DriveRating, RatingFactor
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.rating_tables import names
from gearopt.report.rating_words import rating_of, unverified
from gearopt.report.section import Cell, Section, Table, cell
from gearopt.report.words import series_of

GIVEN = "given"  # source of a factor of the file
ABREAST = 3  # stages whose factors fit beside each other on a terminal


def factors(result: Result, measures: Measures) -> Section | None:
    """Return every factor with its source; None without a rating."""
    if (found := rating_of(result)) is None:
        return None
    symbols: dict[str, list[RatingFactor]] = {}
    for factor in found.factors:
        symbols.setdefault(factor.symbol, []).append(factor)
    heads = ["symbol", "factor", "unit", *names(found), "unverified", "source", "remark"]
    rows = [_factor_row(found, own, measures) for own in symbols.values()]
    hidden = ["unit", "unverified"] + ([] if any(row[-1] for row in rows) else ["remark"])
    table = Table("factors", heads, rows, csv_only=hidden, texts=("factor", "source", "remark"))
    level = (
        " Of a load spectrum factors are those of the level of largest stress."
        if found.levels
        else ""
    )
    words = [f"A value below a pinion alone holds for its wheel, too.{level}"]
    words += map(measures.words, unverified(found))
    told: list[str | Table] = [*_factors_told(found, list(symbols.values()), measures)]
    told += [*words[1:], *_remarks(rows)]
    return Section("Factors", words=words, tables=(table,), terminal=told)


def _remarks(rows: Sequence[Sequence[Any]]) -> list[str]:
    """Return what limits factors, for the terminal; what limits several once."""
    symbols: dict[str, list[str]] = {}
    for symbol, *_, remark in rows:
        if remark:
            symbols.setdefault(remark, []).append(symbol.value)
    lines = [f"{series_of(own)}: {remark}." for remark, own in symbols.items()]
    return ["\n".join(lines)] if lines else []


def _factor_row(found: DriveRating, own: Sequence[RatingFactor], measures: Measures) -> list[Any]:
    """Return a factor of all stages: its values, where they are from, what limits them."""
    one, remarks = own[0], _by_stage(found, own, "remark")
    sign = measures.unit(one.unit)
    return [
        Cell(one.symbol, f"{one.symbol} [{sign}]" if sign else one.symbol),
        one.name,
        sign,
        *(value for factor in own for value in _values(factor, measures)),
        ", ".join(str(factor.stage) for factor in own if not factor.verified),
        _by_stage(found, own, "source"),
        measures.words(remarks),
    ]


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
    first = cell(factor.pinion, factor.unit, measures)
    if not factor.verified:
        first = replace(first, text=f"{first.text}\nunverified", short=first.text)
    if factor.wheel is None:
        return [first, replace(first, text="", short=None)]
    second = cell(factor.wheel, factor.unit, measures)
    if not factor.verified:
        second = replace(second, text=f"{second.text}\nunverified", short=second.text)
    return [first, second]


def _factors_told(
    found: DriveRating, symbols: Sequence[Sequence[RatingFactor]], measures: Measures
) -> list[Table]:
    """Return the factors as the terminal shows them, of so many stages as fit side by side."""
    made, alone = [], len(found.meshes) == 1
    for start in range(0, len(found.meshes), ABREAST):
        heads = ["", *[""] * alone, *names(found)[2 * start : 2 * (start + ABREAST)], ""]
        rows = []
        for own in symbols:
            part = own[start : start + ABREAST]
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
