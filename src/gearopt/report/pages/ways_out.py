"""Ways out of an impossible request: why it is one, and what to write instead."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table
from gearopt.report.words import edit, limit_words

KINDS = {
    "least": "least change",
    "alone": "or this alone",
    "pair": "two together",
    "less": "or ask for less",
    "choice": "or choose",
}
REMEDY_HEADS = (
    "ways out, one is enough",
    "write in the file",
    "instead of",
    "factor",
    "proven least",
)


def section(result: Result, measures: Measures) -> Section | None:
    """Why nothing meets the limits, and what to write instead; None elsewhere."""
    found: Mapping[str, Any] = result.report.get("ways_out") or {}
    if not found:
        return None
    why, rows, tried = remedy_words(found)
    if not found["conflict"] and result.message not in ("", found["message"]):
        why.insert(0, result.message)
    tables = [Table("ways out", REMEDY_HEADS, rows, words=True, left=3)] if rows else []
    told = (*why, *tables, *tried)
    return Section("Ways out", words=[*why, *tried], tables=tables, terminal=told)


def remedy_words(
    found: Mapping[str, Any],
) -> tuple[list[str], list[tuple[str, ...]], list[str]]:
    """Why it is impossible, rows of edits below REMEDY_HEADS, and how sure these are.

    found: conflict, remedies and message, as `explain` and `solve` have them.
    """
    why = []
    conflict, ways, late = found["conflict"], found["remedies"], found["message"]
    if conflict:
        names = ", ".join(limit_words(n) for n in conflict)
        why.append(
            f"These cannot hold together, and none of them is to spare: {names}."
            if len(conflict) > 1
            else f"This limit cannot be kept, even if all others are dropped: {names}."
        )
    late = f"{late[0].upper()}{late[1:]}." if late else ""
    if not ways:
        return [*why, late or "No way out was found by moving limits."], [], []
    rows = [row for way in ways for row in _rows(way)]
    words = f"Each was tried: a design exists with it{_less(ways)}."
    if any(way["verified"].get("others") == "need more" for way in ways):
        words += (
            " Least change: what is asked for is kept, and no other limit and no given size does "
            "with less, moved alone."
        )
    if any(way["verified"].get("nearer") == "infeasible" for way in ways):
        words += (
            " The ratio to choose is the nearest that the limits reach (within the tolerance "
            "around it others do too)."
        )
    if conflict and any(way["bound"] is not None for way in ways):
        words += " Proven least: no smaller factor does, even with real-valued teeth and modules."
    return why, rows, [f"{words} {late}".rstrip()]


def _less(ways: Sequence[Mapping[str, Any]]) -> str:
    """What is known of smaller changes."""
    moved = [way for way in ways if way["kind"] != "choice"]
    doubtful = [
        way["changes"][0]["key"]
        for way in moved
        if way["verified"].get("with_less", "infeasible") != "infeasible"
    ]
    if len(doubtful) == len(moved):
        return "; whether less does is not known" if any(map(_doubtful, moved)) else ""
    doubtful += [w["changes"][0]["key"] for w in ways if w["verified"].get("nearer") == "undecided"]
    but = f" (not known of {', '.join(doubtful)})" if doubtful else ""
    return f", and none with 0.1 % (or one tooth or module) less{but}"


def _doubtful(way: Mapping[str, Any]) -> bool:
    """Whether it stayed undecided if less would do."""
    return bool(way["verified"].get("with_less") == "undecided")


def _rows(way: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """A row for every edit of a way out."""
    alike = ", all alike" if way["kind"] == "even" else ", one stage"
    label = KINDS.get(way["kind"], f"{way['what'].replace('_', ' ')}{alike}")
    if way["kind"] == "least" and _doubtful(way):
        label = "least found"
    product = "product " if len(way["changes"]) > 1 and way["kind"] == "least" else ""
    rows: list[tuple[str, ...]] = []
    for k, change in enumerate(way["changes"]):
        proven = k == 0 and way["kind"] != "choice" and way["bound"] is not None
        rows.append(
            (
                label if k == 0 else "  and",
                edit(change),
                change["was"].strip('"'),
                _factor(change["factor"]),
                f"{product}{way['bound']:.4f}" if proven else "",
            )
        )
    return rows


def _factor(factor: float | None) -> str:
    """A factor; nothing where a number is shifted, or a switch is set."""
    return "" if factor is None or factor == 1.0 or math.isinf(factor) else f"{factor:.4f}"
