"""Sensitivities of the numbers of a file, and remedies for an impossible request."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import DIGITS, METRIC, Measures, rounded
from gearopt.report.section import Cell, Section, Table
from gearopt.report.words import edit, grouped, objective, sentence, series_of

ALIKE = 0.02  # of sensitivities from both sides shown as one; relative to those above 1
FLAT = 0.5e-4  # sensitivity that would be shown as 0.0000
STEEP = 1000.0  # sensitivity from which on 0.1 % changes the objective by more than its value
NO_CHANGE = 1e-9  # relative: no change
UNKNOWN = "not all known"  # of the other numbers: whether each needs a larger change
BOTH = ("number in the file", "value")
TERMINAL_ONLY_HEADS = ("sensitivity, %", "re-solved", "effect")
PAGE_ONLY_HEADS = ("effect, %", "sensitivity, % per %")
READ_ONLY_HEADS = PAGE_ONLY_HEADS[1:]
CSV_ONLY_HEADS = ("sensitivity", "sensitivity, re-solved below", "sensitivity, re-solved above")
HEADS = (
    *BOTH,
    *TERMINAL_ONLY_HEADS[:2],
    "relaxed by",
    TERMINAL_ONLY_HEADS[2],
    *PAGE_ONLY_HEADS,
    *CSV_ONLY_HEADS,
)
SLOPES = (
    *TERMINAL_ONLY_HEADS[:2],
    PAGE_ONLY_HEADS[1],
    *CSV_ONLY_HEADS,
)  # left out where none is shown
KINDS = {
    "least": "smallest change",
    "alone": "or this alone",
    "pair": "two changes together",
    "less": "or ask for less",
    "choice": "or choose",
}
REMEDY_HEADS = (
    "remedy (any one)",
    "write in the file",
    "instead of",
    "factor",
    "proven minimum",
)


def sensitivities(result: Result, measures: Measures) -> Section | None:
    """The sensitivities of the file's numbers; None if they are not asked for."""
    prices = result.report.get("prices")
    return of_influences(prices, result, measures) if prices and result.value is not None else None


def of_influences(
    prices: Mapping[str, Any], result: Result, measures: Measures = METRIC
) -> Section:
    """The effect of every number on the objective, and what the columns mean.

    prices: influences, message and basis, see `optimise.explaining.explanation`.
    """
    if not any(map(_is_known, prices["influences"])):
        prices = {**prices, "influences": []}
    rows = [_row(influence) for influence in prices["influences"]]
    steps = [k for k, head in enumerate(HEADS) if _sloped(prices) or head not in SLOPES]
    rows = [[row[k] for k in steps] for row in rows]
    idle = [influence["key"] for influence in prices["influences"] if _is_idle(influence)]
    bare = [i["key"] for i in prices["influences"] if _is_steep(i) and i["price"] is None]
    table = Table(
        "sensitivities",
        [HEADS[k] for k in steps],
        rows,
        page_only=PAGE_ONLY_HEADS,
        terminal_only=TERMINAL_ONLY_HEADS,
        csv_only=(*CSV_ONLY_HEADS, *idle, *bare),
        read_only=READ_ONLY_HEADS,
        wrap=0,
    )
    words = list(map(measures.words, influence_words(prices, result)))
    tables = (table,) if len(idle) + len(bare) < len(rows) else ()
    if idle:
        name = objective(result)[0]
        words.append(f"Small changes of these numbers do not change the {name}: {', '.join(idle)}.")
    terminal = (*tables, "\n".join(words))
    return Section(
        "Sensitivities", words=words, tables=tables, half=True, appendix=True, terminal=terminal
    )


def _is_known(influence: Mapping[str, Any]) -> bool:
    """Whether anything is known of what a number does."""
    values = influence["price"], influence["sensitivity"], *influence["resolved"]
    return any(value is not None for value in values)


def _sloped(prices: Mapping[str, Any]) -> bool:
    """Whether a sensitivity is shown of some number, by multipliers or by solving again."""
    shown = (i for i in prices["influences"] if not _is_steep(i))
    return any(s is not None for i in shown for s in (i["sensitivity"], *i["resolved"]))


def _is_idle(influence: Mapping[str, Any]) -> bool:
    """Whether a number changes nothing: not by 1 %, to either side, nor when it is eased."""
    slopes = [s for s in (influence["sensitivity"], *influence["resolved"]) if s is not None]
    flat = all(abs(s) < FLAT for s in slopes) and abs(influence["price"] or 0.0) < NO_CHANGE
    return _is_known(influence) and flat


def _is_steep(influence: Mapping[str, Any]) -> bool:
    """Whether the objective is so near zero beside what a number does to it that % say nothing."""
    slopes = (influence["sensitivity"], *influence["resolved"])
    return any(s is not None and abs(s) > STEEP for s in slopes)


def _row(influence: Mapping[str, Any]) -> list[Any]:
    """Values of HEADS of a number, in words and as plain numbers."""
    slope, both, effect = (
        _percent(influence["sensitivity"]),
        _sides(influence["resolved"]),
        price(influence["price"]),
    )
    if _is_steep(influence):
        slope = both = ""
    change = None if influence["price"] is None else 100.0 * clean(influence["price"])
    plain = [
        None if s is None else clean(s) for s in (influence["sensitivity"], *influence["resolved"])
    ]
    return [
        *(influence["key"], influence["value"], slope, both, influence["step"], effect),
        *(Cell(change, effect), slope or both, *plain),
    ]


def influence_words(prices: Mapping[str, Any], result: Result) -> list[str]:
    """Meaning of the columns, and what is missing."""
    name = objective(result)[0]
    lines = (
        [prices["message"][0].upper() + prices["message"][1:] + "."] if prices["message"] else []
    )
    if not prices["influences"]:
        return lines or ["No number of the file was examined."]
    lines += [] if all(map(_is_idle, prices["influences"])) else _meaning(prices, name)
    steep = [i["key"] for i in prices["influences"] if _is_steep(i)]
    if steep:
        lines.append(
            f"No sensitivity is given of {series_of(steep)}: 0.1 % of it changes the {name} by "
            "more than its whole value, so that a change in % says nothing."
        )
    if any("|" in _sides(i["resolved"]) for i in prices["influences"] if not _is_steep(i)):
        lines.append(
            "Of two values the first is for a smaller number, the second for a larger one."
        )
    return lines


def _meaning(prices: Mapping[str, Any], name: str) -> list[str]:
    """What sensitivities and effects are changes of."""
    if not _sloped(prices):
        return [f"An effect is the change of the {name} as one number takes a step, solved again."]
    slope = (
        f"Sensitivities are changes of the {name} in % per 1 % of the number, if it changes little "
        "(d ln / d ln)"
    )
    known = any(i["sensitivity"] is not None for i in prices["influences"])
    return [f"{slope}{prices.get('basis', '') if known else ', by solving again'}."]


def clean(change: float) -> float:
    """A change without the noise of solvers."""
    return 0.0 if abs(change) < NO_CHANGE else change


def alike(below: float, above: float) -> bool:
    """Whether sensitivities from both sides are shown as one."""
    return abs(above - below) < ALIKE * max(1.0, abs(below), abs(above))


def price(change: float | None) -> str:
    """A relative change of the objective in words."""
    if change is None:
        return ""
    return "none" if abs(change) < NO_CHANGE else f"{change:+.3%}"


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


def remedies(result: Result, measures: Measures) -> Section | None:
    """Remedies of an impossible request; None elsewhere."""
    ways_out: Mapping[str, Any] = result.report.get("ways_out") or {}
    if not ways_out or ways_out.get("untried"):
        return None
    rows, sure = remedy_words(ways_out)
    if not rows and not ways_out["conflict"] and ways_out["message"] in result.message:
        return None  # the first sentence says it
    bounded = any(way["bound"] is not None for way in ways_out["remedies"])
    hidden = () if bounded else REMEDY_HEADS[-1:]
    remedy = Table("remedies", REMEDY_HEADS, rows, words=True, left=3, csv_only=hidden)
    tables = [remedy] if rows else []
    if not rows and ways_out["message"] and ways_out["message"] in result.message:
        sure += " No remedy was found by relaxing limits."  # the message stands above
    sure = measures.words(sure)
    words = [] if rows else [sure]  # of remedies `proven` says it
    return Section("Remedies", words=words, tables=tables, terminal=[*tables, sure])


def remedy_words(report: Mapping[str, Any]) -> tuple[list[list[Any]], str]:
    """Rows of edits below REMEDY_HEADS, and how sure these are.

    report: conflict, remedies and message, as `explain` and `solve` have them.
    """
    conflict, ways, missing = report["conflict"], report["remedies"], sentence(report["message"])
    if not ways:
        return [], missing or "No remedy was found by relaxing limits."
    rows = [row for way in ways for row in _rows(way)]
    rows[0][0] = rows[0][0].removeprefix("or ")
    words = f"Each remedy was verified: a design exists with it{_less(ways)}."
    if any(way["verified"].get("others") == "need more" for way in ways):
        words += (
            " Smallest change that keeps the duty: any other limit or given size, changed alone, "
            "needs a larger one."
        )
    if any(way["verified"].get("nearer") == "infeasible" for way in ways):
        words += (
            " The ratio named is the nearest feasible one (of real-valued sizes to 0.1 % of its "
            "distance; within the tolerance around it others are feasible, too)."
        )
    if conflict and any(way["bound"] is not None for way in ways):
        words += " Proven minimum: no smaller factor suffices, even with real-valued sizes."
    return rows, f"{words} {missing}".rstrip()


def _less(ways: Sequence[Mapping[str, Any]]) -> str:
    """Knowledge about smaller changes, in words."""
    moved = [way for way in ways if way["kind"] != "choice"]
    doubtful = [
        way["changes"][0]["key"]
        for way in moved
        if way["verified"].get("with_less", "infeasible") != "infeasible"
    ]
    if len(doubtful) == len(moved):
        return "; whether less suffices is not known" if any(map(_doubtful, moved)) else ""
    doubtful += [w["changes"][0]["key"] for w in ways if w["verified"].get("nearer") == "undecided"]
    but = f" (not known of {', '.join(doubtful)})" if doubtful else ""
    short = [way["verified"]["rounded"] for way in moved if "rounded" in way["verified"]]
    cut = any(change.get("short") for way in moved for change in way["changes"])
    short += ["to the side that eases the limit"] if cut else []
    rounded = f", before they were rounded {short[0]}" if short else ""
    return f", and none with 0.1 % (or one tooth, module or value tried) less{rounded}{but}"


def _doubtful(way: Mapping[str, Any]) -> bool:
    """Whether it stayed undecided if less suffices."""
    return bool(way["verified"].get("with_less") == "undecided")


def _rows(way: Mapping[str, Any]) -> list[list[Any]]:
    """A row for every edit of a remedy; a factor that all of them have stands once."""
    alike = ", by one factor" if way["kind"] == "even" else ", one stage"
    label = KINDS.get(way["kind"])
    if label is None:
        label = f"{series_of(grouped(way['what'].split(', ')))}{alike}"
    if way["kind"] == "least" and (_doubtful(way) or way["verified"].get("others") == UNKNOWN):
        label = "smallest found"
    product = "product " if len(way["changes"]) > 1 and way["kind"] == "least" else ""
    rows: list[list[Any]] = []
    for k, change in enumerate(way["changes"]):
        same = k > 0 and change["factor"] == way["changes"][0]["factor"]
        rows.append(
            [
                label if k == 0 else "  and",
                edit(change),
                change["was"].strip('"'),
                "" if same else _factor(change["factor"]),
                _proven(way["bound"], product) if k == 0 and way["kind"] != "choice" else "",
            ]
        )
    return rows


def _factor(factor: float | None) -> Cell | str:
    """A factor; nothing where a number is shifted, or a switch is set."""
    if factor is None or factor == 1.0 or math.isinf(factor):
        return ""
    return Cell(factor, rounded(factor, DIGITS))


def _proven(bound: float | None, product: str) -> Cell | str:
    """The smallest factor that may suffice, rounded down so that it stays true."""
    return "" if bound is None else Cell(bound, f"{product}{rounded(bound, DIGITS, way=-1)}")
