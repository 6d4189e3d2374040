"""What was found and how sure it is: status, objective, bound, proof, limits, ways out."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.pages.section import Section, Table
from gearopt.report.result_words import limit_rows, objective, proof, verdict
from gearopt.report.words import edit, number


def summary(result: Result) -> Section:
    """Status, objective, bound and gap in a table; the proof and the notes in sentences."""
    name, unit = objective(result)
    rows = [("status", verdict(result)[0])]
    if result.value is not None:
        rows.append((name, f"{number(result.value)} {unit}".strip()))
    if result.bound is not None:
        rows.append(("bound", f"{number(result.bound)} {unit}".strip()))
    if result.gap is not None:
        rows.append(("gap", f"{100 * result.gap:.3g} %"))
    rows.append(("method", result.method))
    table = Table(("", ""), rows)
    return Section("Result", proof(result), tables=(table,))


def limits(result: Result) -> Section | None:
    """Utilisation of every limit; None without limits."""
    if not result.limits or result.value is None:
        return None
    stages, rows = limit_rows(result.limits)
    heads = ["limit used, %", *(f"stage {k}" for k in range(1, stages + 1)), "whole"]
    cells = [[words, *map(_percent, values)] for words, values in rows]
    return Section("Limits", ("At 100 a limit is reached.",), tables=(Table(heads, cells),))


def ways_out(result: Result) -> Section | None:
    """What to write instead, where nothing meets the limits; None elsewhere."""
    ways: Mapping[str, Any] = result.report.get("ways_out") or {}
    rows = [
        (
            " and ".join(edit(change) for change in way["changes"]),
            " and ".join(change["was"].strip('"') for change in way["changes"]),
        )
        for way in ways.get("remedies", ())
    ]
    if not rows:
        return None
    heads = ("write in the file", "instead of")
    words = "Changes of the file that make a design possible; one is enough."
    return Section("Ways out", (words,), tables=(Table(heads, rows, words=True),))


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.1f}"
