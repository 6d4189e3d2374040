"""Pictures of an impossible request: limits in conflict, and how far numbers must move."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.drawing.number_line import WIDE, Guide, Span, number_line
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window
from gearopt.report.measures import DIGITS, Measures, rounded
from gearopt.report.section import Section
from gearopt.report.words import limit_words, of_problem_file, share

BAR, ROW = 13.0, 24.0  # px: of a bar, and from one to the next
ABOVE, BELOW, RIGHT = 30.0, 12.0, 66.0  # px around the bars; their values stand on the right
MAX_BARS = 16  # bars


def section(result: Result, measures: Measures) -> Section | None:
    """Draw what is in conflict and what would do; None where nothing is known of either."""
    if result.status != "infeasible":
        return None
    ways: Mapping[str, Any] = result.report.get("ways_out") or {}
    drawn = [conflict(result, ways.get("conflict", ())), remedies(ways.get("remedies", ()))]
    drawings = [drawing for drawing in drawn if drawing is not None]
    return Section("Asked and possible", drawings=drawings) if drawings else None


def conflict(result: Result, known: Sequence[str]) -> Drawing | None:
    """Draw the utilisation of the limits in conflict where their largest excess is smallest.

    known: names of limits in conflict, where the proof names none.
    """
    nearest: Mapping[str, float] = result.report.get("nearest") or {}
    names = [n for n in result.proof.get("conflict") or known if n in nearest]
    rows = sorted((name for name in names if nearest[name] > 0.0), key=_order)[:MAX_BARS]
    if not rows or max(nearest[name] for name in rows) <= 1.0:
        return None
    words = [limit_words(name, of_problem_file(result)) for name in rows]
    left = 12.0 + max(2.0 * Place(0.0, 0.0).half_width(text) for text in words)
    tall = ABOVE + ROW * len(rows) + BELOW
    sheet = Sheet(Window(0.0, WIDE, 0.0, tall, (0.0, 0.0, 0.0, 0.0)), 1.0)
    unit = (WIDE - left - RIGHT) / max(nearest[name] for name in rows)
    for k, (name, text) in enumerate(zip(rows, words, strict=True)):
        y = tall - ABOVE - ROW * (k + 0.5)
        used, half = nearest[name], 0.5 * BAR
        for start, end, style in ((0.0, min(1.0, used), "range"), (1.0, used, "excess")):
            if end > start:
                corners = (left + unit * start, y - half), (left + unit * end, y + half)
                sheet.rectangle(*corners, style)
        level, value = tall - y, f"{share(used)} %"
        size = Place(0.0, 0.0).half_width(text)
        sheet.label(text, [Place(left - 8.0 - size, level)], "plain")
        size = Place(0.0, 0.0).half_width(value)
        sheet.label(value, [Place(left + unit * used + 6.0 + size, level)], "name")
    x = left + unit
    sheet.line((x, tall - ABOVE + 6.0), (x, BELOW - 4.0), "gap")
    sheet.label("limit, 100 %", [Place(x, 12.0)], "gap")
    caption = (
        "Utilisation of the limits in conflict at the design whose largest excess is smallest"
        f"{', with real-valued teeth and modules' if result.scene in ('drive', 'servo') else ''}: "
        "whichever of them is lowered, another one rises."
    )
    return sheet.drawing("limits in conflict", caption)


def _order(name: str) -> tuple[str, str]:
    """The stage of a limit, then its name, to sort by; those of no stage come last."""
    stem, _, index = name.rstrip("]").partition("[")
    return index or "~", stem


def remedies(ways: Sequence[Mapping[str, Any]]) -> Drawing | None:
    """Draw how far each number that helps alone must move; None where there is none."""
    rows = []
    for way in ways:
        change = way["changes"][0]
        factor = change["factor"]
        if len(way["changes"]) > 1 or not factor or not 1.0 < factor < math.inf:
            continue
        was = change["was"].strip('"')
        write = (change.get("short") or change["write"]).strip('"')
        blocked = None if way["bound"] is None else min(way["bound"], factor)
        name = f"{change['key']}: {was} → {write}"
        ends = "", f"× {rounded(factor, DIGITS)}"
        rows.append(Span(name, 1.0, factor, ends, blocked, reached=True))
    if not rows:
        return None
    proven = any(row.blocked is not None for row in rows)
    caption = "Factor by which one number of the file must change; at a dot a design exists" + (
        ", in the orange range none does, proven even with real-valued sizes." if proven else "."
    )
    guides = (Guide(1.0, "asked", "gap"),)
    return number_line(rows, guides, "asked and what is enough", caption, "×")
