"""What every number of the file costs."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.result_words import objective
from gearopt.report.section import Cell, Section, Table

ALIKE = 0.02  # of slopes from below and above that are shown as one; relative to those above 1
FLAT = 0.5e-4  # slope that would be shown as 0.0000
NOTHING = 1e-9  # relative: no change
BOTH = ("number in the file", "now")
TERMINAL_ONLY = ("+1 % brings", "re-solved", "brings")
PAGE_ONLY = ("brings, %", "+1 % brings, %")
HEADS = (*BOTH, *TERMINAL_ONLY[:2], "eased by", TERMINAL_ONLY[2], *PAGE_ONLY)


def section(result: Result, measures: Measures) -> Section | None:
    """Slopes and prices of the numbers of the file; None where none were asked for."""
    found = result.report.get("prices")
    return of_influences(found, result) if found and result.value is not None else None


def of_influences(found: Mapping[str, Any], result: Result) -> Section:
    """What every number does to the objective, and what that means.

    found: influences, message and basis, see `optimise.explaining.explanation`.
    """
    rows = [_row(one) for one in found["influences"]]
    table = Table("prices", HEADS, rows, page_only=PAGE_ONLY, terminal_only=TERMINAL_ONLY, wrap=0)
    words, tables = influence_words(found, result), (table,) if rows else ()
    told = (*tables, "\n".join(words))
    return Section("What each limit costs", words=words, tables=tables, half=True, terminal=told)


def _row(one: Mapping[str, Any]) -> list[Any]:
    """Of a number: key, value, slopes, easing and its price; then these two as a page has them."""
    slope, both, brings = _percent(one["sensitivity"]), _sides(one["resolved"]), price(one["price"])
    change = None if one["price"] is None else 100.0 * clean(one["price"])
    return [
        *(one["key"], one["value"], slope, both, one["step"], brings),
        *(Cell(change, brings), Cell(_slope(one), slope or both)),
    ]


def _slope(influence: Mapping[str, Any]) -> Any:
    """By multipliers; without them by solving again, from below and above where they differ."""
    slope = influence["sensitivity"]
    if slope is not None:
        return clean(slope)
    below, above = influence["resolved"]
    if below is None or above is None:
        return above if below is None else below
    return clean(0.5 * (below + above)) if alike(below, above) else [below, above]


def influence_words(found: Mapping[str, Any], result: Result) -> list[str]:
    """What the columns mean, and what is missing."""
    name = objective(result)[0]
    lines = [found["message"][0].upper() + found["message"][1:] + "."] if found["message"] else []
    if not found["influences"]:
        return lines or ["No number of the file was looked at."]
    slope = f"What +1 % brings: slope of the {name} (d ln objective / d ln number)"
    if any(i["sensitivity"] is not None for i in found["influences"]):
        return [*lines, f"{slope}{found.get('basis', '')}."]
    return [*lines, f"{slope}, by solving again."]


def clean(change: float) -> float:
    """A change without the noise of solvers."""
    return 0.0 if abs(change) < NOTHING else change


def alike(below: float, above: float) -> bool:
    """Whether slopes from both sides are shown as one."""
    return abs(above - below) < ALIKE * max(1.0, abs(below), abs(above))


def price(change: float | None) -> str:
    """A relative change of the objective."""
    if change is None:
        return ""
    return "none" if abs(change) < NOTHING else f"{change:+.3%}"


def _percent(slope: float | None) -> str:
    if slope is None:
        return ""
    return "0" if abs(slope) < FLAT else f"{slope:+.4f} %"


def _sides(resolved: Sequence[float | None]) -> str:
    """One number where both sides agree, both where a limit is about to bind."""
    below, above = resolved
    if below is None or above is None:
        return _percent(above if below is None else below)
    if alike(below, above):
        return _percent(0.5 * (below + above))
    return f"{_percent(below)} | {_percent(above)}"
