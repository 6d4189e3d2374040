"""Ranges and values on one logarithmic line: what is asked beside what is possible."""

import math
from collections.abc import Sequence

from gearopt.frozen import dataclass
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window

WIDE = 640.0  # px of the drawing
EDGE = 34.0  # px left and right of the line
ROW, BAR = 58.0, 11.0  # px: from a row to the next, and of a bar
BARE_ROW = 40.0  # px from a row without texts below it to the next
ABOVE, BELOW = 34.0, 36.0  # px: for the texts of guides, and for the axis
LEAST_SPREAD = 1.02  # of the largest value to the smallest, where they are alike
MARKS, FEW = (1.0, 2.0, 5.0), 6  # ticks of a decade; about so many of them
EVEN_TICKS_BELOW = 4.0  # of the largest to the smallest value: below it ticks are evenly apart


@dataclass(frozen=True)
class Span:
    """A bar between two positive values, its name above it and the texts of its ends below.

    blocked: up to this value from the start nothing is possible. reached: a dot marks the end.
    """

    name: str
    start: float
    end: float
    texts: tuple[str, str] = ("", "")
    blocked: float | None = None
    reached: bool = False


@dataclass(frozen=True)
class Guide:
    """A value that a line marks across all rows, its text above; style: of line and text."""

    value: float
    text: str
    style: str


@dataclass(frozen=True)
class Scale:
    """A logarithmic axis between two positive values; at(value): its place across [px]."""

    low: float
    high: float

    def at(self, value: float) -> float:
        """The place of a value [px]."""
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return EDGE + (WIDE - 2.0 * EDGE) * share


def number_line(
    rows: Sequence[Span], guides: Sequence[Guide], name: str, caption: str, sign: str = ""
) -> Drawing:
    """Draw spans below each other on one axis; sign: before the number of every tick."""
    values = [v for r in rows for v in (r.start, r.end)] + [g.value for g in guides]
    low, high = min(values), max(values)
    if high < low * LEAST_SPREAD:
        low, high = low / LEAST_SPREAD, high * LEAST_SPREAD
    pitch = ROW if any(any(row.texts) for row in rows) else BARE_ROW
    scale, tall = Scale(low, high), ABOVE + pitch * len(rows) + BELOW
    sheet = Sheet(Window(0.0, WIDE, 0.0, tall, (0.0, 0.0, 0.0, 0.0)), 1.0)
    level = tall - BELOW + 8.0
    sheet.tick((EDGE, level), (WIDE - EDGE, level))
    for value in ticks(low, high):
        x = scale.at(value)
        sheet.tick((x, level), (x, level + 5.0))
        sheet.label(f"{sign}{value:.6g}", [Place(x, level + 15.0)], "size")
    for guide in guides:
        x = scale.at(guide.value)
        sheet.line((x, tall - ABOVE + 6.0), (x, BELOW - 8.0), guide.style)
        sheet.label(guide.text, [_inside(x, y, guide.text) for y in (18.0, 8.0)], guide.style)
    for k, row in enumerate(rows):
        _row(sheet, row, ABOVE + pitch * (k + 0.5) + 8.0, scale)
    return sheet.drawing(name, caption)


def _row(sheet: Sheet, row: Span, level: float, scale: Scale) -> None:
    """Draw a bar about a level [px, downwards] with its texts."""
    start, end = scale.at(row.start), scale.at(row.end)
    middle = start if row.blocked is None else scale.at(row.blocked)
    for first, last, style in ((start, middle, "excess"), (middle, end, "range")):
        low, high = sorted((first, last))
        if high > low or (style == "range" and not row.reached):
            y = sheet.height - level
            sheet.rectangle((low, y - BAR / 2), (high, y + BAR / 2), style)
    if row.reached:
        sheet.circle(end, sheet.height - level, 0.5 * BAR, "enough")
    texts = zip((start, end), row.texts, strict=True)
    for x, text in texts if end != start else [(end, row.texts[1])]:
        if text:
            sheet.label(text, _near(x, level + 16.0, text), "name")
    left = min(start, end) + 6.0 + Place(0.0, 0.0).half_width(row.name)
    sheet.label(row.name, [_inside(left, level - 15.0, row.name)], "plain")


def _near(x: float, y: float, text: str) -> list[Place]:
    """Places for a text near a point [px], inside the drawing."""
    half = Place(0.0, 0.0).half_width(text)
    shifts = (0.0, -half, half, -0.5 * half, 0.5 * half, -2.0 * half, 2.0 * half)
    return [_inside(x + dx, y, text, abs(dx) / 20.0) for dx in shifts]


def _inside(x: float, y: float, text: str, cost: float = 0.0) -> Place:
    half = Place(0.0, 0.0).half_width(text) + 4.0
    return Place(min(max(x, half), WIDE - half), y, 0.0, cost)


def ticks(low: float, high: float) -> list[float]:
    """Round numbers from low to high, both above 0."""
    if high < EVEN_TICKS_BELOW * low:
        return even_ticks(low, high)
    decades = [10.0**k for k in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)]
    marks = MARKS if len(decades) < FEW else (1.0,)
    values = [m * d for d in decades for m in marks]
    values = [v for v in values if low * (1.0 - 1e-9) <= v <= high * (1.0 + 1e-9)]
    return values[:: math.ceil(len(values) / (2 * FEW))]


def even_ticks(low: float, high: float) -> list[float]:
    """Round numbers from low to a higher number, evenly apart."""
    rough = (high - low) / FEW
    size = 10.0 ** math.floor(math.log10(rough))
    step = min((k * size for k in (*MARKS, 10.0)), key=lambda s: abs(s - rough))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]
