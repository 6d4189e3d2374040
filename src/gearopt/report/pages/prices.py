"""What every number of the file costs."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.influence_words import alike, clean, influence_rows, influence_words
from gearopt.report.measures import Measures
from gearopt.report.pages.section import Section
from gearopt.report.pages.table import Cell, Table

HEADS = ("number in the file", "now", "eased by", "brings, %", "+1 % brings, %")


def section(result: Result, measures: Measures) -> Section | None:
    """Slopes and prices of the numbers of the file; None where none were asked for."""
    found = result.report.get("prices")
    if not found or result.value is None:
        return None
    influences = found["influences"]
    rows = [
        (key, now, step, Cell(_percent(raw["price"]), brings), Cell(_slope(raw), slope or both))
        for (key, now, slope, both, step, brings), raw in zip(
            influence_rows(influences), influences, strict=True
        )
    ]
    tables = (Table("prices", HEADS, rows),) if rows else ()
    words = influence_words(found, result)
    return Section("What each limit costs", words=words, tables=tables, half=True)


def _percent(change: float | None) -> float | None:
    return None if change is None else 100.0 * clean(change)


def _slope(influence: Mapping[str, Any]) -> Any:
    """By multipliers; without them by solving again, from below and above where they differ."""
    slope = influence["sensitivity"]
    if slope is not None:
        return clean(slope)
    below, above = influence["resolved"]
    if below is None or above is None:
        return above if below is None else below
    return clean(0.5 * (below + above)) if alike(below, above) else [below, above]
