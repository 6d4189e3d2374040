"""Stills of the plots of a Pareto front as SVG: for paper, and where no script runs."""

from collections.abc import Sequence

from gearopt.report.drawing.number_line import even_ticks
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window, around
from gearopt.report.drawing.still import edges, outside, view
from gearopt.report.pages.front_values import Drawn, Span

WIDE, HIGH = 620.0, 340.0  # px of a plot inside its axes
LEFT, BELOW, EDGE = 74.0, 46.0, 16.0  # px around it
CUBE = 330.0  # px of the view in space
DOT = 2.6  # px, radius of a design
TICK_SPACING = 60.0  # px from one tick to the next, at least


def scatter(
    found: Drawn, i: int, k: int, ends: tuple[Span, Span], corners: Sequence[Span], caption: str
) -> Drawing:
    """Draw two objectives against each other as the plot does."""
    free = (LEFT, EDGE, BELOW, EDGE)
    sheet = Sheet(Window(0.0, WIDE, 0.0, HIGH, free), 1.0)

    def at(x: float, y: float) -> tuple[float, float]:
        (x0, x1), (y0, y1) = ends
        return WIDE * (x - x0) / (x1 - x0), HIGH * (y - y0) / (y1 - y0)

    _frame(sheet, ends, (found.heads[i], found.heads[k]))
    if len(found.heads) == 2 and len(found.points) > 1:
        _line(sheet, [sheet.at(*at(*values)) for values in found.points], found.curve)
    for values in found.beaten:
        sheet.circle(*at(values[i], values[k]), DOT, "beaten")
    for corner in corners:
        spot = (min(v, end[1]) for v, end in zip(corner, ends, strict=True))
        _cross(sheet, *at(*spot))
    for values in found.points:
        sheet.circle(*at(values[i], values[k]), DOT, "design")
    for place, words in sorted(found.picks.items()):
        x, y = at(found.points[place][i], found.points[place][k])
        sheet.circle(x, y, 2.0 * DOT, "picked", "--series-2")
        sheet.label(words, around(sheet.at(x, y), (22.0, 34.0, 48.0), 6.0), "name")
    return sheet.drawing(caption, caption)


def _frame(sheet: Sheet, ends: tuple[Span, Span], heads: tuple[str, str]) -> None:
    """Draw both axes with round numbers and what they are."""
    sheet.line((0.0, 0.0), (WIDE, 0.0), "axes")
    sheet.line((0.0, 0.0), (0.0, HIGH), "axes")
    (x0, x1), (y0, y1) = ends
    for value in even_ticks(x0, x1):
        x, _ = sheet.at(WIDE * (value - x0) / (x1 - x0), 0.0)
        sheet.tick((x, EDGE + HIGH), (x, EDGE + HIGH + 5.0))
        sheet.label(f"{value:,.6g}", [Place(x, EDGE + HIGH + 14.0)], "size")
    for value in even_ticks(y0, y1):
        _, y = sheet.at(0.0, HIGH * (value - y0) / (y1 - y0))
        sheet.tick((LEFT - 5.0, y), (LEFT, y))
        text = f"{value:,.6g}"
        sheet.label(text, [Place(LEFT - 6.0 - Place(0, 0).half_width(text), y)], "size")
    sheet.label(heads[0], [Place(LEFT + 0.5 * WIDE, EDGE + HIGH + 34.0)], "plain")
    sheet.label(heads[1], [Place(12.0, EDGE + 0.5 * HIGH, -90.0)], "plain")


def _line(sheet: Sheet, spots: Sequence[tuple[float, float]], curve: bool) -> None:
    """Draw chords of a curve, or the steps of single designs [px]."""
    (x, y), *others = spots
    steps = " ".join(f"L {x:.1f} {y:.1f}" if curve else f"H {x:.1f} V {y:.1f}" for x, y in others)
    sheet.shape(f"M {x:.1f} {y:.1f} {steps}", "lines")


def _cross(sheet: Sheet, x: float, y: float) -> None:
    for turn in (-1.0, 1.0):
        sheet.line((x - 4.0, y - 4.0 * turn), (x + 4.0, y + 4.0 * turn), "without")


def in_space(found: Drawn) -> Drawing:
    """Draw three objectives in a cube, seen from where the view that turns begins."""
    spans = [found.span(k) for k in range(3)]
    seen, room = view(), ((0.0, 0.0, 0.0), (CUBE, CUBE, CUBE))

    def at(values: Sequence[float]) -> tuple[float, float]:
        x, y, z = (CUBE * (v - a) / (b - a) for v, (a, b) in zip(values, spans, strict=True))
        return seen.at((x, y, z))

    ends = (0.0, CUBE)
    us, vs = zip(*(seen.at((x, y, z)) for x in ends for y in ends for z in ends), strict=True)
    side = 2.0 * max(Place(0.0, 0.0).half_width(name) for name in found.heads) + EDGE
    window = Window(min(us), max(us), min(vs), max(vs), (side, side, BELOW, EDGE))
    sheet = Sheet(window, 1.0)
    for pair in (pair for some in edges(*room, seen) for pair in some):
        sheet.line(seen.at(pair[0]), seen.at(pair[1]), "far")
    for style, rows in (("beaten", found.beaten), ("design", found.points)):
        for values in rows:
            sheet.circle(*at(values), DOT, style)
    for place, words in sorted(found.picks.items()):
        x, y = at(found.points[place])
        sheet.circle(x, y, 2.0 * DOT, "picked", "--series-2")
        sheet.label(words, around(sheet.at(x, y), (22.0, 34.0, 48.0), 6.0), "name")
    outside(sheet, room, seen, found.heads)
    caption = "The three objectives in space, in parallel projection."
    return sheet.drawing("front in space", caption)


def lines(
    heads: Sequence[str],
    ends: Sequence[tuple[str, str]],
    rows: Sequence[Sequence[float]],
    picks: Sequence[int],
    caption: str,
) -> Drawing:
    """Draw every design as a line across parallel axes; rows: shares of every axis, 0 to 1."""
    count = len(heads)
    pitch = WIDE / max(1, count - 1)
    sheet = Sheet(Window(0.0, WIDE, 0.0, HIGH, (LEFT, LEFT, 24.0, 74.0)), 1.0)
    for k, row in enumerate(rows):
        if k not in picks:
            _path(sheet, row, pitch, "lines")
    for k in picks:
        _path(sheet, rows[k], pitch, "lines chosen")
    for k, (name, (low, high)) in enumerate(zip(heads, ends, strict=True)):
        sheet.line((k * pitch, 0.0), (k * pitch, HIGH), "axes")
        x, bottom = sheet.at(k * pitch, 0.0)
        top = bottom - HIGH
        sheet.label(low, [Place(x, bottom + 12.0)], "size")
        sheet.label(high, [Place(x, top - 9.0)], "size")
        for n, word in enumerate(reversed(_parts(name))):
            sheet.label(word, [Place(x, top - 25.0 - 14.0 * n)], "plain")
    return sheet.drawing("parallel coordinates", caption.partition(" Filters")[0])


def _parts(name: str) -> list[str]:
    """Return the lines of the name of an axis: "stage 1", "teeth z1"."""
    stage, _, rest = name.rpartition(": ")
    words, _, unit = rest.partition(" [")
    return [part for part in (stage, words, f"[{unit}" if unit else "") if part]


def _path(sheet: Sheet, row: Sequence[float], pitch: float, style: str) -> None:
    spots = (sheet.at(k * pitch, HIGH * share) for k, share in enumerate(row))
    sheet.shape("M " + " L ".join(f"{x:.1f} {y:.1f}" for x, y in spots), style)
