"""What the numbers of a file cost, in words and cells, as the terminal and the page show it."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.result_words import objective

ALIKE = 0.02  # of slopes from below and above that are shown as one
FLAT = 0.5e-4  # slope that would be shown as 0.0000
NOTHING = 1e-9  # relative: no change


def influence_rows(found: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Of every number: key, value, slope by multipliers and by re-solving, easing and its price.

    found: influences as dicts, see `optimise.explaining.explanation.Influence`.
    """
    return [
        (
            i["key"],
            i["value"],
            _percent(i["sensitivity"]),
            _sides(i["resolved"]),
            i["step"],
            price(i["price"]),
        )
        for i in found
    ]


def influence_words(found: Mapping[str, Any], result: Result) -> list[str]:
    """What the columns mean, and what is missing."""
    name = objective(result)[0]
    lines = [found["message"][0].upper() + found["message"][1:] + "."] if found["message"] else []
    if not found["influences"]:
        return lines or ["No number of the file was looked at."]
    words = f"What +1 % brings: slope of the {name} (d ln objective / d ln number)"
    if any(i["sensitivity"] is not None for i in found["influences"]):
        words += (
            " with real-valued teeth and modules, by multipliers, checked by solving again. "
            "What easing a limit brings: the drive itself solved again."
        )
    else:
        words += ", by solving again."
    return [*lines, words]


def clean(change: float) -> float:
    """A change without the noise of solvers."""
    return 0.0 if abs(change) < NOTHING else change


def alike(below: float, above: float) -> bool:
    """Whether slopes from both sides are shown as one."""
    return abs(above - below) < ALIKE


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
