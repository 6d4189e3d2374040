"""A still of bodies in space as SVG: seen from where the view that turns begins, without WebGL.

Rods and blocks, whose axes are all parallel, are drawn from the farthest to the nearest in parallel
projection. A place is (a, b, c): a along the rods, b and c across them.
"""

import math
from collections.abc import Sequence

from gearopt.frozen import dataclass
from gearopt.report.drawing.sheet import SIZE, Drawing, Place, Point, Sheet, Window, around
from gearopt.report.drawing.solid import EYE
from gearopt.report.measures import Measures

Spot = tuple[float, float, float]
WIDE, HIGH = 600.0, 400.0  # largest still [px]
SIDE, BELOW, ABOVE = 24.0, 30.0, 28.0  # px around it, for texts
MIN_WIDTH, ROW = (
    300.0,
    16.0,
)  # px: smallest width, for names above; from one row of them to the next
SIZE_OFFSET = 6.0  # px from an edge to its size
RIM = 0.9  # of the farthest edge's distance from the middle: as far out sizes may be written
TOOTH_SPACING = 2.4  # px from tooth to tooth, below which teeth are not drawn
TOUCH = 1e-6  # mm by which bodies that touch may overlap


def dot(a: Spot, other: Spot) -> float:
    """The scalar product."""
    return a[0] * other[0] + a[1] * other[1] + a[2] * other[2]


@dataclass(frozen=True)
class View:
    """Unit vectors to the right, upwards and to the eye, in (a, b, c)."""

    right: Spot
    up: Spot
    eye: Spot

    def at(self, place: Spot) -> Point:
        """A place as the picture has it [mm], upwards positive."""
        return dot(self.right, place), dot(self.up, place)


def view(axes: str = "xyz") -> View:
    """The first view of `solid.EYE`; axes: which of x, y and z are a, b and c."""
    size = math.hypot(*EYE)
    x, y, z = (v / size for v in EYE)
    flat = math.hypot(x, y)
    vectors = (-y / flat, x / flat, 0.0), (-z * x / flat, -z * y / flat, flat), (x, y, z)
    a, b, c = ("xyz".index(axis) for axis in axes)
    right, up, eye = ((v[a], v[b], v[c]) for v in vectors)
    return View(right, up, eye)


@dataclass(frozen=True)
class Rod:
    """A cylinder along a; outline: angle [rad] and radius of a face that is not round."""

    centre: Point
    radius: float
    start: float
    end: float
    style: str
    colour: str = ""
    title: str = ""
    outline: tuple[Point, ...] = ()

    @property
    def corners(self) -> tuple[Spot, Spot]:
        """Two corners of the block around it."""
        (b, c), r = self.centre, self.radius
        return (self.start, b - r, c - r), (self.end, b + r, c + r)

    def nearest(self, b: float, c: float) -> Point:
        """The middle of its cross-section."""
        return self.centre


@dataclass(frozen=True)
class Block:
    """A box between two corners."""

    low: Spot
    high: Spot
    style: str
    title: str = ""

    @property
    def corners(self) -> tuple[Spot, Spot]:
        """Its two corners."""
        return self.low, self.high

    @property
    def start(self) -> float:
        """Its first end along a."""
        return self.low[0]

    @property
    def end(self) -> float:
        """Its last end along a."""
        return self.high[0]

    def nearest(self, b: float, c: float) -> Point:
        """The point of its cross-section that is nearest to (b, c)."""
        (_, b0, c0), (_, b1, c1) = self.low, self.high
        return min(max(b, b0), b1), min(max(c, c0), c1)


Body = Rod | Block


@dataclass(frozen=True)
class Texts:
    """Sizes of the box along a, b and c; coloured names above; short texts in circles at places."""

    sizes: tuple[str, str, str]
    legend: Sequence[tuple[str, str]]
    balloons: Sequence[tuple[Spot, str]] = ()


def sizes_of(room: tuple[Spot, Spot], names: str, measures: Measures) -> tuple[str, str, str]:
    """The sizes of a box along a, b and c, with the names of these axes."""
    unit = measures.unit("mm")
    a, b, c = (
        f"{name} {measures.length(high - low, 1)} {unit}"
        for name, low, high in zip(names, *room, strict=True)
    )
    return a, b, c


def hides(one: Body, other: Body, seen: View) -> bool:
    """Whether `one` may hide a part of `other`: it is on the eye's side of a plane between.

    Two bodies are apart along a, or across; where they are neither, their middles decide.
    """
    if one.start >= other.end - TOUCH:
        return seen.eye[0] > 0.0
    if other.start >= one.end - TOUCH:
        return seen.eye[0] < 0.0
    here, there = _middle(one), _middle(other)
    b, c = other.nearest(here[1], here[2])
    u, v = one.nearest(b, c)
    b, c = other.nearest(u, v)
    off = seen.eye[1] * (u - b) + seen.eye[2] * (v - c)
    if abs(off) < TOUCH:
        off = dot(seen.eye, here) - dot(seen.eye, there)
    return off > 0.0


def covers(rod: Rod, spot: Spot, seen: View) -> bool:
    """Whether a rod is between a place and the eye."""
    a, b, c = seen.eye
    first, last = sorted((end - spot[0]) / a for end in (rod.start, rod.end))
    first = max(first, TOUCH)
    if last <= first:
        return False
    u, v = rod.centre[0] - spot[1], rod.centre[1] - spot[2]
    nearest = min(max((u * b + v * c) / (b * b + c * c), first), last)
    return math.hypot(u - nearest * b, v - nearest * c) < rod.radius - TOUCH


def _middle(body: Body) -> Spot:
    low, high = body.corners
    a, b, c = (0.5 * (p + q) for p, q in zip(low, high, strict=True))
    return a, b, c


def in_order(bodies: Sequence[Body], seen: View) -> list[Body]:
    """Bodies such that each comes before those that hide it, the farthest first.

    Where bodies hide each other in a ring, the farthest of them comes first.
    """
    boxes = [_on_screen(body, seen) for body in bodies]
    count = range(len(bodies))
    after: dict[int, set[int]] = {
        i: {
            j
            for j in count
            if i != j and _overlap(boxes[i], boxes[j]) and hides(bodies[i], bodies[j], seen)
        }
        for i in count
    }
    depth = [dot(seen.eye, _middle(body)) for body in bodies]
    order: list[Body] = []
    while after:
        ready = [i for i, behind in after.items() if not behind] or list(after)
        first = min(ready, key=lambda i: depth[i])
        order.append(bodies[first])
        del after[first]
        for behind in after.values():
            behind.discard(first)
    return order


def _on_screen(body: Body, seen: View) -> tuple[float, float, float, float]:
    spots = [seen.at(corner) for corner in _corners(*body.corners)]
    (us, vs) = zip(*spots, strict=True)
    return min(us), max(us), min(vs), max(vs)


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(one[k] < other[k + 1] - TOUCH and other[k] < one[k + 1] - TOUCH for k in (0, 2))


def _corners(low: Spot, high: Spot) -> list[Spot]:
    return [
        (a, b, c) for a in (low[0], high[0]) for b in (low[1], high[1]) for c in (low[2], high[2])
    ]


def still(
    bodies: Sequence[Body],
    room: tuple[Spot, Spot],
    seen: View,
    texts: Texts,
    name: str,
) -> Drawing:
    """Draw bodies within a box of lines, whose farthest edges are behind them."""
    spots = _corners(*room)
    for body in bodies:
        spots += _corners(*body.corners)
    us, vs = zip(*map(seen.at, spots), strict=True)
    wide, tall = max(us) - min(us), max(vs) - min(vs)
    right = SIDE + max(2.0 * Place(0.0, 0.0).half_width(text) for text in texts.sizes)
    scale = min((WIDE - SIDE - right) / wide, (HIGH - BELOW - ABOVE) / tall)
    left = max(SIDE, MIN_WIDTH - scale * wide - right)
    names = _rows(texts.legend, left + scale * wide + right)
    free = left, right, BELOW, ABOVE + ROW * max((row for _, row, *_ in names), default=0)
    sheet = Sheet(Window(min(us), max(us), min(vs), max(vs), free), scale)
    back, front = edges(*room, seen)
    for start, end in back:
        sheet.line(seen.at(start), seen.at(end), "far")
    for body in in_order(bodies, seen):
        if isinstance(body, Rod):
            _rod(sheet, body, seen)
        else:
            _block(sheet, body, seen)
    for start, end in front:
        sheet.line(seen.at(start), seen.at(end), "near")
    for x, row, text, colour in names:
        sheet.label(text, [Place(x, 12.0 + ROW * row)], "name", colour)
    for spot, text in texts.balloons:
        if not any(covers(body, spot, seen) for body in bodies if isinstance(body, Rod)):
            sheet.balloon(text, around(sheet.at(*seen.at(spot)), (0.0, 20.0, 30.0), 0.0))
    outside(sheet, room, seen, texts.sizes)
    return sheet.drawing(name, "Drawn to scale in parallel projection.")


def _rows(legend: Sequence[tuple[str, str]], width: float) -> list[tuple[float, int, str, str]]:
    """Names with their places across [px] and rows, from the left."""
    placed, x, row = [], 12.0, 0
    for text, colour in legend:
        half = Place(0.0, 0.0).half_width(text)
        if x + 2.0 * half > width and x > 12.0:
            x, row = 12.0, row + 1
        placed.append((x + half, row, text, colour))
        x += 2.0 * half + 12.0
    return placed


def outside(sheet: Sheet, room: tuple[Spot, Spot], seen: View, texts: Sequence[str]) -> None:
    """Write a text of every axis of a box outside of it, beside an edge at the rim."""
    x0, y0 = sheet.at(*seen.at(_middle(Block(*room, ""))))
    low, high = room
    for k, text in enumerate(texts):
        half, places = Place(0.0, 0.0).half_width(text), []
        for start in (s for s in _corners(low, high) if s[k] == low[k]):
            end = tuple(high[n] if n == k else start[n] for n in range(3))
            (x1, y1), (x2, y2) = (
                sheet.at(*seen.at(start)),
                sheet.at(*seen.at((end[0], end[1], end[2]))),
            )
            x, y, long = 0.5 * (x1 + x2), 0.5 * (y1 + y2), math.dist((x1, y1), (x2, y2))
            nx, ny = (y1 - y2) / long, (x2 - x1) / long  # across the edge
            sign = math.copysign(1.0, nx * (x - x0) + ny * (y - y0))
            reach = SIZE_OFFSET + half * abs(nx) + 0.5 * SIZE * abs(ny)
            off = abs(nx * (x - x0) + ny * (y - y0))
            spot = Place(x + sign * reach * nx, y + sign * reach * ny)
            places.append((off, spot))
        farthest = max(off for off, _ in places)
        sheet.label(text, [spot for off, spot in places if off >= RIM * farthest], "size")


def edges(low: Spot, high: Spot, seen: View) -> tuple[list[tuple[Spot, Spot]], ...]:
    """The edges of a box that meet its farthest corner, and the others."""
    far = tuple(p if e > 0.0 else q for p, q, e in zip(low, high, seen.eye, strict=True))
    corners = _corners(low, high)
    pairs = [
        (one, other)
        for k, one in enumerate(corners)
        for other in corners[:k]
        if sum(p != q for p, q in zip(one, other, strict=True)) == 1
    ]
    return [p for p in pairs if far in p], [p for p in pairs if far not in p]


def _rod(sheet: Sheet, rod: Rod, seen: View) -> None:
    """Draw side and near face: half ellipses whose long axes are across the axis, or teeth."""
    near, far = (rod.end, rod.start) if seen.eye[0] > 0.0 else (rod.start, rod.end)
    r = sheet.scale * rod.radius
    if rod.outline and 2.0 * math.pi * r / max(1, len(rod.outline) / 4) > TOOTH_SPACING:
        side, face = _toothed(sheet, rod, (near, far), seen)
    else:
        side, face = _round(sheet, rod, (near, far), seen)
    sheet.shape(side, f"side {rod.style}", rod.colour, rod.title)
    sheet.shape(face, f"face {rod.style}", rod.colour, rod.title)


def _round(sheet: Sheet, rod: Rod, ends: Point, seen: View) -> tuple[str, str]:
    """Side and near face of a cylinder as paths; ends: the near and the far one."""
    (x0, y0), (x1, y1) = (sheet.at(*seen.at((a, *rod.centre))) for a in ends)
    flat, r = math.hypot(seen.right[0], seen.up[0]), sheet.scale * rod.radius
    px, py = -seen.up[0] / flat * r, -seen.right[0] / flat * r  # along the long axis
    arc = f"A {r:.1f} {r * abs(seen.eye[0]):.1f} {math.degrees(math.atan2(py, px)):.1f} 0"
    sweep = int(-py * (x1 - x0) + px * (y1 - y0) > 0.0)
    side = (
        f"M {x0 + px:.1f} {y0 + py:.1f} L {x1 + px:.1f} {y1 + py:.1f} "
        f"{arc} {sweep} {x1 - px:.1f} {y1 - py:.1f} L {x0 - px:.1f} {y0 - py:.1f} "
        f"{arc} {1 - sweep} {x0 + px:.1f} {y0 + py:.1f} Z"
    )
    face = (
        f"M {x0 + px:.1f} {y0 + py:.1f} {arc} 1 {x0 - px:.1f} {y0 - py:.1f} "
        f"{arc} 1 {x0 + px:.1f} {y0 + py:.1f} Z"
    )
    return side, face


def _toothed(sheet: Sheet, rod: Rod, ends: Point, seen: View) -> tuple[str, str]:
    """Flanks and lands that face the eye, and the near face, as paths.

    ends: the near and the far one. The angles of the outline rise.
    """
    b, c = rod.centre
    rim = [(b + r * math.cos(t), c + r * math.sin(t)) for t, r in rod.outline]
    near, far = ([sheet.at(*seen.at((a, *spot))) for spot in rim] for a in ends)
    _, eye_b, eye_c = seen.eye
    faces = [
        eye_b * (v1 - v0) - eye_c * (u1 - u0) > 0.0
        for (u0, v0), (u1, v1) in zip(rim, [*rim[1:], rim[0]], strict=True)
    ]
    side, count = "", len(rim)
    hidden = faces.index(False)
    start = None
    for k in range(hidden, hidden + count + 1):
        if faces[k % count] and start is None:
            start = k
        elif not faces[k % count] and start is not None:
            facing = [n % count for n in range(start, k + 1)]
            side += _steps([*(near[n] for n in facing), *(far[n] for n in reversed(facing))])
            start = None
    return side, _steps(near)


def _steps(spots: Sequence[Point]) -> str:
    """A closed path of short steps [0.1 px]."""
    path, last = "", (0, 0)
    for k, (x, y) in enumerate(spots):
        at = round(10.0 * x), round(10.0 * y)
        path += f"{'l' if k else 'M'}{(at[0] - last[0]) / 10:g} {(at[1] - last[1]) / 10:g}"
        last = at
    return path + "Z"


def _block(sheet: Sheet, block: Block, seen: View) -> None:
    """Draw the three faces that the eye sees."""
    low, high = block.corners
    for k in range(3):
        end = high[k] if seen.eye[k] > 0.0 else low[k]
        i, j = (n for n in range(3) if n != k)
        spots = []
        for p, q in ((low[i], low[j]), (high[i], low[j]), (high[i], high[j]), (low[i], high[j])):
            place = [end, end, end]
            place[i], place[j] = p, q
            spots.append(sheet.at(*seen.at((place[0], place[1], place[2]))))
        path = " L ".join(f"{x:.1f} {y:.1f}" for x, y in spots)
        sheet.shape(f"M {path} Z", block.style, "", block.title)
