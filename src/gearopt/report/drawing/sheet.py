"""Technical drawings to scale as inline SVG: shapes in mm, dimensions, labels that keep clear.

An SVG of our own, not a plot: equal scale by construction, crisp in print, a few kilobytes, and
coloured by the classes of drawing.css in light and dark.
"""

import math
import sys
from array import array
from base64 import b64encode
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field
from html import escape
from itertools import pairwise

from gearopt.frozen import dataclass

SIZE = 12.0  # of a text, px; drawing.css has the same
LETTER = 0.56  # mean width of a letter over the size, sans serif
CELL = 5.0  # of the grid that counts ink, px
ARROW = (9.0, 2.6)  # length and half width of an arrow head, px
HATCH = 9.0  # between the lines of a hatch, px
MAX_POINTS = 1_000_000  # points or lines of one mark: more than any drawing has room for
COLOURS = 8  # --series-1 ... in frame.css, distinct for the colour-blind
SERIES_OF_MEMBERS = (1, 4)  # the colours of pinion and wheel among them
Point = tuple[float, float]
SHEET = 660.0  # px of an A4 sheet that a single drawing or plot may take
ACROSS = 680.0  # px across an A4 sheet inside its margins: 180 mm
GUTTER = 18.0  # px between drawings, as in drawing.css
TALL = 330.0  # px of a sheet that drawings may take, where their text stays legible
LEGIBLE = 0.57  # of a text of 12 px: 5.1 pt on paper
LARGER = 1.2  # to which drawings may grow so that their scale is a usual one
PX = 25.4 / 96.0  # mm on paper, by definition of CSS
PARTS = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0)
STEPS = [part * ten for ten in (1.0, 10.0, 100.0) for part in PARTS]
SCALES = {f"{n:g}:1": n for n in STEPS} | {f"1:{n:g}": 1.0 / n for n in STEPS}  # on paper


@dataclass(frozen=True)
class Place:
    """The centre of a text [px], its angle [deg, clockwise], and what it costs beforehand.

    leader: what the text names, where a thin line shall lead there.
    """

    x: float
    y: float
    angle: float = 0.0
    cost: float = 0.0
    leader: tuple[float, float] | None = None

    def half_width(self, text: str) -> float:
        """Half the width of the text [px]."""
        return 0.5 * LETTER * SIZE * len(text) + 2.0

    def spots(self, text: str) -> Iterator[tuple[float, float]]:
        """Points along the middle of the text and a little beyond, half a size apart."""
        reach = max(0.0, self.half_width(text) - 0.2 * SIZE) if len(text) > 2 else 0.0
        turn = math.radians(self.angle)
        count = math.ceil(2.0 * reach / (0.5 * SIZE))
        for k in range(count + 1):
            along = reach * (2.0 * k / count - 1.0) if count else 0.0
            yield self.x + along * math.cos(turn), self.y + along * math.sin(turn)


@dataclass
class Ink:
    """Ink of a drawing by cells, and its texts: filled while the drawing is made."""

    width: float
    height: float
    cells: Counter[tuple[int, int]] = field(default_factory=Counter)
    texts: list[tuple[float, float, float]] = field(default_factory=list)  # x, y, reach
    _counted: dict[tuple[int, int], int] = field(default_factory=dict)

    def add(self, points: Iterable[tuple[float, float]]) -> None:
        """Add lines, as points along them."""
        self.cells.update((int(x // CELL), int(y // CELL)) for x, y in points)
        self._counted.clear()

    def near(self, place: Place, text: str, reach: float) -> list[tuple[float, float, float]]:
        """Texts that any letter of a text at a place may touch."""
        wide = place.half_width(text) + reach
        return [
            (u, v, r)
            for u, v, r in self.texts
            if abs(u - place.x) < wide + r and abs(v - place.y) < wide + r
        ]

    def cost(
        self, x: float, y: float, reach: float, texts: Iterable[tuple[float, float, float]]
    ) -> float:
        """The cost of a letter here: texts and the edge weigh far more than lines."""
        lines = self._lines(int(x // CELL), int(y // CELL))
        met = 0
        for u, v, r in texts:
            if abs(u - x) < reach + r and abs(v - y) < reach + r:
                met += 1
        edge = 0.6 * SIZE
        outside = not (edge <= x <= self.width - edge and edge <= y <= self.height - edge)
        return min(lines, 6) + 100.0 * met + 120.0 * outside

    def _lines(self, column: int, row: int) -> int:
        """Lines in a cell and beside it: the height of a letter."""
        lines = self._counted.get((column, row))
        if lines is None:
            lines = sum(
                self.cells.get((column + i, row + j), 0) for i in (-1, 0, 1) for j in (-1, 0, 1)
            )
            self._counted[column, row] = lines
        return lines


def best(text: str, places: Sequence[Place], ink: Ink, reach: float = 0.58 * SIZE) -> Place:
    """The place of lowest cost for the text, which clears what is drawn by reach [px]."""
    cheapest, lowest = places[0], math.inf
    for place in places:
        if place.cost >= lowest:
            continue  # no letter costs less than nothing
        inked, texts = 0.0, ink.near(place, text, reach)
        for x, y in place.spots(text):
            inked += ink.cost(x, y, reach, texts)
            if place.cost + inked >= lowest:
                break
        else:
            cheapest, lowest = place, place.cost + inked
    ink.texts += ((x, y, reach) for x, y in cheapest.spots(text))
    return cheapest


def around(
    centre: tuple[float, float],
    radii: Sequence[float],
    leader: float | None = None,
    cost: float = 0.0,
) -> list[Place]:
    """Places on circles about a centre [px], nearest first.

    leader: a line leads to the centre, or to the circle of this radius, from places outside it.
    """
    places = []
    for k, r in enumerate(radii):
        for step in range(24):
            turn = 2.0 * math.pi * step / 24 - 0.5 * math.pi
            ux, uy = math.cos(turn), math.sin(turn)
            x, y = centre[0] + r * ux, centre[1] + r * uy
            to = None
            if leader is not None and r > leader:
                to = (centre[0] + leader * ux, centre[1] + leader * uy)
            places.append(Place(x, y, 0.0, cost + 4.0 * k, to))
    return places


@dataclass(frozen=True)
class Mark:
    """A mark of a drawing as other formats take it: to scale [mm], not rounded.

    form: "circle" (its centre; size: radius), "arc" (ends: angles [rad], anticlockwise), "line",
    "outline" (closed; bulges: tan(a/4) of the arc of angle a from each point to the next, 0 of a
    straight line; none: all straight), "text" (its centre, size: height, ends: angle [rad]) or
    "dimension" (both points, then one of the dimension line). style: as of drawing.css.
    """

    form: str
    points: tuple[Point, ...]
    style: str
    size: float = 0.0
    ends: Point = (0.0, 0.0)
    text: str = ""
    bulges: tuple[float, ...] = ()


@dataclass(frozen=True)
class Drawing:
    """An SVG (all text in it is escaped), its size at full scale [px], and its caption.

    true: it never shrinks, so that its scale holds: it is scrolled on a narrow screen, and printed
    on a sheet of its own where it is wider than paper. marks: the same for other formats, within a
    frame of lower left and upper right corner [mm].
    """

    svg: str
    width: float
    height: float
    caption: str
    true: bool = False
    marks: tuple[Mark, ...] = ()
    frame: tuple[Point, Point] = ((0.0, 0.0), (0.0, 0.0))


@dataclass(frozen=True)
class Window:
    """Extent of a drawing: ends of both axes [mm], and what is kept free around them [px]."""

    left: float
    right: float
    bottom: float
    top: float
    free: tuple[float, float, float, float] = (24.0, 24.0, 24.0, 24.0)  # left, right, bottom, top

    def scale(self, width: float, height: float) -> float:
        """The largest scale [px/mm] that fits into so many px."""
        left, right, bottom, top = self.free
        across = (width - left - right) / (self.right - self.left)
        return min(across, (height - bottom - top) / (self.top - self.bottom))


class Sheet:
    """A drawing under way: it keeps what is drawn, because labels are placed where little is."""

    def __init__(self, window: Window, scale: float) -> None:
        left, right, bottom, top = window.free
        self.scale = scale
        self.width = left + right + scale * (window.right - window.left)
        self.height = bottom + top + scale * (window.top - window.bottom)
        self._origin = (left - scale * window.left, top + scale * window.top)
        self._marks: list[str] = []
        self._labels: list[str] = []
        self._ink = Ink(self.width, self.height)
        self._record: list[Mark] = []

    def at(self, x: float, y: float) -> Point:
        """A point [mm] in px, y downwards."""
        return self._origin[0] + self.scale * x, self._origin[1] - self.scale * y

    def _mm(self, x: float, y: float) -> Point:
        """A point [px] in mm."""
        return (x - self._origin[0]) / self.scale, (self._origin[1] - y) / self.scale

    def circle(
        self, x: float, y: float, r: float, style: str, colour: str = "", title: str = ""
    ) -> None:
        """Draw a circle [mm]."""
        cx, cy = self.at(x, y)
        size = self.scale * r
        self._add("circle", f'cx="{cx:.2f}" cy="{cy:.2f}" r="{size:.2f}"', style, colour, title)
        self._record.append(Mark("circle", ((x, y),), style, r))
        count = _count(size, 8)
        turns = (2.0 * math.pi * k / count for k in range(count))
        self._ink.add((cx + size * math.cos(t), cy + size * math.sin(t)) for t in turns)

    def ring(
        self, x: float, y: float, radii: Point, style: str, colour: str = "", title: str = ""
    ) -> None:
        """Draw what is between two circles [mm], the larger one first."""
        (cx, cy), path = self.at(x, y), ""
        for sweep, radius in enumerate(radii):
            r = self.scale * radius
            half = f"A {r:.2f} {r:.2f} 0 0 {sweep}"
            path += f"M {cx - r:.2f} {cy:.2f} {half} {cx + r:.2f} {cy:.2f} "
            path += f"{half} {cx - r:.2f} {cy:.2f} Z "
            self._record.append(Mark("circle", ((x, y),), style, radius))
        self.shape(path.strip(), style, colour, title)

    def rectangle(
        self, a: Point, b: Point, style: str, colour: str = "", title: str = "", round_: float = 0
    ) -> None:
        """Draw a rectangle between two corners [mm]."""
        (x0, y0), (x1, y1) = self.at(*a), self.at(*b)
        x, y, width, height = min(x0, x1), min(y0, y1), abs(x1 - x0), abs(y1 - y0)
        where = f'x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}"'
        self._add("rect", f'{where} rx="{round_:g}"', style, colour, title)
        ends = ((x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y))
        for start, end in pairwise(ends):
            self._ink.add(_along(start, end))
        corners = a, (b[0], a[1]), b, (a[0], b[1])
        self._record.append(Mark("outline", corners, style))

    def slice(
        self,
        at: Point,
        r: float,
        ends: Point,
        style: str,
        colour: str = "",
        title: str = "",
        rim: bool = False,
    ) -> None:
        """Draw a slice of a disc about a point [mm], from one angle to a larger one [rad].

        rim: only its arc.
        """
        start, end = ends
        if end - start >= 2.0 * math.pi - 1e-9:
            self.circle(*at, r, style, colour, title)
            return
        (cx, cy), size = self.at(*at), self.scale * r
        count = _count(size * (end - start) / 4.0, 8)
        turns = (start + (end - start) * k / count for k in range(count + 1))
        arc = [(cx + size * math.cos(t), cy - size * math.sin(t)) for t in turns]
        (x0, y0), (x1, y1) = arc[0], arc[-1]
        first = f"M {x0:.2f} {y0:.2f}" if rim else f"M {cx:.2f} {cy:.2f} L {x0:.2f} {y0:.2f}"
        path = f"{first} A {size:.2f} {size:.2f} 0 {int(end - start > math.pi)} 0 {x1:.2f} {y1:.2f}"
        self._add("path", f'd="{path}{"" if rim else " Z"}"', style, colour, title)
        self._ink.add(arc)
        self._record.append(Mark("arc", (at,), style, r, ends))
        for corner in () if rim else (arc[0], arc[-1]):
            self._ink.add(_along((cx, cy), corner))
            self._record.append(Mark("line", (at, self._mm(*corner)), style))

    def shape(self, path: str, style: str, colour: str = "", title: str = "") -> None:
        """Draw an SVG path [px], over which labels may be written."""
        self._add("path", f'd="{path}"', style, colour, title)

    def outline(
        self,
        points: Sequence[Point],
        style: str,
        colour: str = "",
        title: str = "",
        bulges: Sequence[float] = (),
    ) -> None:
        """Draw a closed outline through points [mm]; bulges of its arcs: as of a `Mark`."""
        path = " L ".join(f"{x:.2f} {y:.2f}" for x, y in (self.at(*p) for p in points))
        self.shape(f"M {path} Z", style, colour, title)
        self._record.append(Mark("outline", tuple(points), style, bulges=tuple(bulges)))

    def line(self, a: Point, b: Point, style: str, colour: str = "") -> None:
        """Draw a line [mm]."""
        self._stroke(self.at(*a), self.at(*b), style, colour)

    def cross(self, x: float, y: float, r: float) -> None:
        """Draw the cross of an axis, a little larger than a circle of radius r [mm]."""
        (cx, cy), reach = self.at(x, y), self.scale * r + 6.0
        self._stroke((cx - reach, cy), (cx + reach, cy), "axis")
        self._stroke((cx, cy - reach), (cx, cy + reach), "axis")

    def hatch(self, a: Point, b: Point) -> None:
        """Draw lines at 45 degrees that fill a rectangle [mm]."""
        (x0, y0), (x1, y1) = self.at(*a), self.at(*b)
        left, right, top, bottom = min(x0, x1), max(x0, x1), min(y0, y1), max(y0, y1)
        start = left + top + HATCH / 2
        for k in range(_count(math.ceil((right + bottom - start) / HATCH), 0)):
            total = start + k * HATCH  # x + y along a line
            from_x, to_x = max(left, total - bottom), min(right, total - top)
            self._stroke((from_x, total - from_x), (to_x, total - to_x), "hatch")

    def dimension(self, a: Point, b: Point, away: float, text: str) -> None:
        """Draw a dimension between points [mm] on a level or upright line, `away` px from it.

        away > 0: below a level line, left of an upright one.
        """
        (x0, y0), (x1, y1), kept = self.at(*a), self.at(*b), len(self._record)
        upright = abs(x1 - x0) < abs(y1 - y0)
        dx, dy = (-away, 0.0) if upright else (0.0, away)
        past = 1.0 + 5.0 / abs(away)
        for x, y in ((x0, y0), (x1, y1)):
            self._stroke((x + 0.1 * dx, y + 0.1 * dy), (x + past * dx, y + past * dy), "extension")
        start, end = (x0 + dx, y0 + dy), (x1 + dx, y1 + dy)
        self.arrows(start, end)
        x, y = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
        self.label(text, [Place(x - 9.0, y, -90.0) if upright else Place(x, y - 9.0)], "size")
        self._record[kept:] = [
            Mark("dimension", (a, b, self._mm(*start)), "size", SIZE / self.scale, text=text)
        ]

    def tick(self, start: Point, end: Point) -> None:
        """Draw a thin line [px], as those that lead from a body to its dimension."""
        self._stroke(start, end, "extension")

    def arrows(self, start: Point, end: Point, style: str = "size") -> None:
        """Draw a line with two heads [px]; outside, pointing inwards, where there is no room."""
        length = math.dist(start, end) or 1.0
        ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
        inside = length > 2.5 * ARROW[0]
        if inside:
            self._stroke(start, end, style)
        for point, sign in ((start, 1.0), (end, -1.0)):
            s = sign if inside else -sign
            bx, by = self._head(point, (ux, uy), s, style)
            if not inside:
                self._stroke((bx, by), (bx + s * 6.0 * ux, by + s * 6.0 * uy), style)

    def arrow(self, start: Point, end: Point, style: str) -> None:
        """Draw a line with a head at its end [px]."""
        length = math.dist(start, end) or 1.0
        along = (end[0] - start[0]) / length, (end[1] - start[1]) / length
        self._stroke(start, self._head(end, along, -1.0, style), style)

    def _head(self, tip: Point, along: Point, sign: float, style: str) -> Point:
        """Draw the head of an arrow and return its base; sign 1: that lies along a unit vector."""
        (x, y), (ux, uy) = tip, along
        bx, by = x + sign * ARROW[0] * ux, y + sign * ARROW[0] * uy
        nx, ny = -uy * ARROW[1], ux * ARROW[1]
        corners = f"{x:.2f},{y:.2f} {bx + nx:.2f},{by + ny:.2f} {bx - nx:.2f},{by - ny:.2f}"
        self._add("polygon", f'points="{corners}"', f"{style} head")
        each = ((x, y), (bx + nx, by + ny), (bx - nx, by - ny))
        self._record.append(Mark("outline", tuple(self._mm(*p) for p in each), style))
        return bx, by

    def label(self, text: str, places: Sequence[Place], style: str, colour: str = "") -> None:
        """Write a text centred at the place, of several, where it meets least."""
        place = best(text, places, self._ink)
        if place.leader is not None:
            self._leader(text, place, style)
        x, y = place.x, place.y
        turned = f' transform="rotate({place.angle:.2f} {x:.2f} {y:.2f})"' if place.angle else ""
        where = f'x="{x:.2f}" y="{y:.2f}"{turned}{_colour(colour)}'
        self._labels.append(f'<text class="{style}" {where}>{escape(text)}</text>')
        self._write(text, place)

    def _write(self, text: str, place: Place) -> None:
        """Record a text."""
        ends, size = (math.radians(-place.angle), 0.0), SIZE / self.scale
        self._record.append(Mark("text", (self._mm(place.x, place.y),), "", size, ends, text))

    def balloon(self, text: str, places: Sequence[Place]) -> None:
        """Write a short text in a circle."""
        place = best(text, places, self._ink, 0.85 * SIZE)
        if place.leader is not None:
            self._leader(text, place, "balloon")
        where = f'cx="{place.x:.2f}" cy="{place.y:.2f}" r="{SIZE * 0.8:.1f}"'
        self._labels.append(f'<circle class="balloon" {where}/>')
        where = f'x="{place.x:.2f}" y="{place.y:.2f}"'
        self._labels.append(f'<text class="balloon" {where}>{escape(text)}</text>')
        self._write(text, place)
        at = self._mm(place.x, place.y)
        self._record.append(Mark("circle", (at,), "balloon", 0.8 * SIZE / self.scale))

    def drawing(
        self, name: str, caption: str, cut: bool = False, behind: str = "", front: str = ""
    ) -> Drawing:
        """The drawing as SVG; cut: what reaches beyond its edges is not seen.

        behind, front: SVG of bodies that move behind all marks, or in front of them.
        """
        box = ('class="cut" ' if cut else "") + f'viewBox="0 0 {self.width:.3f} {self.height:.3f}"'
        marks = "\n".join(filter(None, (behind, *self._marks, *self._labels, front)))
        svg = f'<svg {box} role="img" aria-label="{escape(name)}">\n{marks}\n</svg>'
        frame = self._mm(0.0, self.height), self._mm(self.width, 0.0)
        record = tuple(self._record)
        return Drawing(svg, self.width, self.height, caption, marks=record, frame=frame)

    def _leader(self, text: str, place: Place, style: str) -> None:
        """Draw a thin line from what a label names to the label's edge."""
        assert place.leader is not None
        x, y = place.leader
        reach = (SIZE, SIZE) if style == "balloon" else (place.half_width(text), SIZE * 0.6)
        dx, dy = place.x - x, place.y - y
        share = min(1.0, *(r / abs(d) for r, d in zip(reach, (dx, dy), strict=True) if d))
        if share < 1.0:
            self._stroke((x, y), (x + (1 - share) * dx, y + (1 - share) * dy), "leader")

    def _stroke(self, start: Point, end: Point, style: str, colour: str = "") -> None:
        ends = f'x1="{start[0]:.2f}" y1="{start[1]:.2f}" x2="{end[0]:.2f}" y2="{end[1]:.2f}"'
        self._add("line", ends, style, colour)
        self._record.append(Mark("line", (self._mm(*start), self._mm(*end)), style))
        if style != "hatch":
            self._ink.add(_along(start, end))

    def _add(self, tag: str, ends: str, style: str, colour: str = "", title: str = "") -> None:
        inner = f"<title>{escape(title)}</title>" if title else ""
        self._marks.append(f'<{tag} class="{style}"{_colour(colour)} {ends}>{inner}</{tag}>')


def _colour(name: str) -> str:
    """The colour of a mark, which drawing.css knows as --c."""
    return f' style="--c: var({name})"' if name else ""


def _count(wanted: float, minimum: int) -> int:
    """A number of points or lines; ValueError where a drawing has no room for so many."""
    if not wanted <= MAX_POINTS:
        raise ValueError(f"a drawing of {wanted:.0e} points: a size is far from the others")
    return max(minimum, int(wanted))


def _along(start: Point, end: Point) -> Iterable[Point]:
    count = _count(math.dist(start, end) / 4.0, 1)
    for k in range(count + 1):
        share = k / count
        yield start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def series(k: int) -> str:
    """The colour of the k-th of a series, from 1; after eight they begin again."""
    return f"--series-{(k - 1) % COLOURS + 1}"


@dataclass(frozen=True)
class Row:
    """Drawings that stand side by side where there is room, and shrink alike.

    to_scale: they show bodies at one scale, which is named on paper.
    """

    drawings: Sequence[Drawing]
    to_scale: bool = False

    @property
    def widest(self) -> float:
        """The width of the widest drawing [px]; all shrink with it, to keep one scale."""
        return max(drawing.width for drawing in self.drawings)

    @property
    def sheet(self) -> float:
        """Width of an A4 sheet that a drawing may take [px]."""
        return SHEET

    @property
    def printed(self) -> float:
        """Factor by which the drawings shrink in print."""
        return self._on_paper[0]

    @property
    def scale(self) -> str:
        """The scale that this gives, as 1:2.5; "" where there is none."""
        return self._on_paper[1]

    @property
    def _on_paper(self) -> tuple[float, str]:
        """Factor of print and scale: the largest usual one at which the text stays legible."""
        wanted, most = self._fitting
        if not self.to_scale:
            return wanted, ""
        (left, _), (right, _) = self.drawings[0].frame  # mm
        full = PX * self.drawings[0].width / (right - left)  # the scale without shrinking
        largest = full * min(most, LARGER * wanted, ACROSS / self.widest)
        size, name = max((size, name) for name, size in SCALES.items() if size <= largest)
        return (size / full, name) if size >= LEGIBLE * full else (wanted, "")

    @property
    def _fitting(self) -> tuple[float, float]:
        """Factor by which all stand side by side, or two, and the largest that lets them.

        The first leaves room on the sheet for other things, but text stays legible.
        """
        low = max(TALL / max(drawing.height for drawing in self.drawings), LEGIBLE)
        for some in (self.drawings, self.drawings[:2]):
            wide = sum(drawing.width + GUTTER for drawing in some) - GUTTER
            if (share := ACROSS / wide) > LEGIBLE:
                return min(1.0, share, low), min(1.0, share)
        return min(1.0, low), 1.0


def packed(kind: str, values: Iterable[float]) -> dict[str, str]:
    """Numbers in base64, little-endian: f = 32-bit floats, I = unsigned integers."""
    data = array(kind, values)
    if kind == "I" and max(data, default=0) < 2**16:
        data = array("H", data)
    if sys.byteorder == "big":
        data.byteswap()
    word = {"f": "f4", "I": "u4", "H": "u2"}[data.typecode]
    return {"dtype": word, "bdata": b64encode(data.tobytes()).decode("ascii")}
