"""Bodies in three dimensions as plotly traces: toothed gears, cylinders, boxes of lines.

Coordinates are (x, y, z) in mm, x along the shafts. A mesh is a list of points and a list of
triangles of their numbers.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from gearopt.frozen import dataclass
from gearopt.physics.blanks import Body
from gearopt.physics.gears import Gear, Rack
from gearopt.physics.geometry.fillet import profile
from gearopt.report.drawing.sheet import packed
from gearopt.report.measures import Measures
from gearopt.report.plots import LOOK

Point = tuple[float, float, float]
Face = tuple[int, int, int]
Mesh = tuple[list[Point], list[Face]]

BACKLASH = 0.03  # of a pitch, so that flanks in mesh are seen apart
MAX_TEETH, MAX_MESH_POINTS = 10_000, 2_000_000  # of a gear that is drawn
ROUND = 48  # sides of a cylinder
TICKS = 5  # of an axis, about
EYE = (0.55, -0.75, 0.37)  # direction of the first view: from the output end, the left, above
EYE_DISTANCE = 1.28  # diagonals between the eye and the middle, so that all is inside the picture
TURN = "Drag to rotate, scroll to zoom, click a name in the legend to hide or show it."
LIGHT = {
    "ambient": 0.6,
    "diffuse": 0.8,
    "specular": 0.12,
    "roughness": 0.7,
    "fresnel": 0.05,
    "facenormalsepsilon": 0,  # plotly's own, 1e-6, takes the normals of small triangles for none
    "vertexnormalsepsilon": 0,
}


@dataclass(frozen=True)
class Toothed:
    """A gear, its helix angle signed by its hand, from start to end along x [mm].

    centre: (y, z) of its axis. phase: direction of the middle of a tooth at x = middle [rad].
    """

    gear: Gear
    start: float
    end: float
    centre: tuple[float, float]
    phase: float = 0.0
    middle: float = 0.0


def gear_mesh(
    placed: Toothed, flank: int, step: float, inside: Sequence[tuple[float, float]] = ()
) -> Mesh:
    """A helical gear with the teeth of its rack.

    flank: points on a flank, as of `outline`. step: largest twist between two sections [rad].
    inside: rings (x, radius) [mm] that its body has below the teeth, from the end to the start
    (`rings_of`); without them both faces are closed.
    """
    gear, start, end = placed.gear, placed.start, placed.end
    rim = outline(gear, flank)
    rate = twist(gear)
    sections = 1 + max(1, math.ceil(abs(rate) * (end - start) / step))
    if sections * len(rim) > MAX_MESH_POINTS:
        raise ValueError(f"a gear of {gear.teeth:g} teeth that is drawn in {sections:.0e} sections")
    points: list[Point] = []
    y, z = placed.centre
    for k in range(sections):
        x = start + (end - start) * k / (sections - 1)
        turn = placed.phase + rate * (x - placed.middle)
        for angle, r in rim:
            at = angle + turn
            points.append((x, y + r * math.cos(at), z + r * math.sin(at)))
    around, last = len(rim), len(points) - len(rim)
    if inside:
        spots = [(x, r, placed.phase + angle) for x, r in inside for angle, _ in rim]
        points += [(x, y + r * math.cos(t), z + r * math.sin(t)) for x, r, t in spots]
        points += points[:around]
        return points, _skin(around, sections + len(inside) + 1)
    faces = _skin(around, sections)
    middle = len(points)
    points += [(start, y, z), (end, y, z)]
    for k in range(around):  # a fan over each face
        n = (k + 1) % around
        faces += [(middle, n, k), (middle + 1, last + k, last + n)]
    return points, faces


def rings_of(body: Body, gear: Gear, start: float, end: float) -> list[tuple[float, float]]:
    """Return the contour of a gear's body below its teeth as rings (x, radius) [mm].

    From the face at `end` over rim, web, hub and bore (radius 0 without one) to the face at
    `start`, symmetric about the middle of the face width. A body without rim or web is solid;
    without a hub the web reaches bore or axis.
    """
    bore = 0.5 * (body.bore or 0.0)
    half = [(end, bore)]
    if body.web_thickness is not None and body.rim_thickness is not None:
        rim = 0.5 * float(gear.root_diameter) - body.rim_thickness
        web = 0.5 * (start + end + body.web_thickness)
        hub = 0.5 * (body.hub_diameter or 0.0)
        at_hub = [(web, hub), (end, hub), (end, bore)] if hub else [(web, bore)]
        half = [(end, rim), (web, rim), *at_hub]
    return half + [(start + end - x, r) for x, r in reversed(half)]


def twist(gear: Gear) -> float:
    """The angle by which teeth turn along the axis [rad/mm]."""
    return float(2.0 * math.tan(gear.helix_angle) / abs(gear.reference_diameter))


def outline(gear: Gear, flank: int, backlash: float = BACKLASH) -> list[tuple[float, float]]:
    """(angle, radius) once round the gear or in the ring, a tooth in the middle of angle 0.

    flank: points from root circle to tip circle, at least 2: of the fillet and the involute, with
    2 a straight flank from root to tip. Thinner by a backlash, a part of half a pitch.
    """
    teeth = drawn_teeth(abs(gear.teeth))
    whole = _of_whole_teeth(gear, math.copysign(teeth, gear.teeth))
    x, y = (list(map(float, v)) for v in profile(whole, *_shares(flank)))
    side = [(math.atan2(a, abs(b)), math.hypot(a, b)) for a, b in zip(x, y, strict=True)]
    if flank == 2:
        side = [(side[1][0], side[0][1]), side[-1]]
    half = math.pi / teeth
    least, most = 0.05 * half, (1.0 - backlash) * half  # of pointed teeth and pointed tools
    side = [(min(max(angle - half * backlash, least), most), at) for angle, at in side]
    tooth = [(-angle, at) for angle, at in side] + side[::-1]
    pitch = 2.0 * math.pi / teeth
    return [(k * pitch + angle, at) for k in range(teeth) for angle, at in tooth]


def _shares(flank: int) -> tuple[int, int]:
    """Points of the fillet and of the involute, which share one."""
    on_fillet = max(2, flank // 2)
    return on_fillet, max(2, flank + 1 - on_fillet)


def _of_whole_teeth(gear: Gear, teeth: float) -> Gear:
    """The gear with a whole number of teeth in the same circles."""
    scale = gear.teeth / teeth
    rack = gear.rack
    heights = (rack.addendum, rack.dedendum, rack.tip_radius, rack.protuberance)
    drawn = Rack(rack.pressure_angle, *(height / scale for height in heights))
    return replace(
        gear,
        normal_module=gear.normal_module * scale,
        teeth=teeth,
        rack=drawn,
        profile_shift=gear.profile_shift / scale,
        tip_alteration=gear.tip_alteration / scale,
    )


def drawn_teeth(teeth: float) -> int:
    """The nearest whole number of teeth; ValueError for too few or too many."""
    if not 1 <= round(teeth) <= MAX_TEETH:
        raise ValueError(f"a gear of {teeth:g} teeth")
    return round(teeth)


def undrawn(gears: Iterable[float]) -> str:
    """Why gears of so many teeth are not drawn, a sentence; "" where they are."""
    if (most := max(gears)) <= MAX_TEETH:
        return ""
    return f"Not drawn: a gear has {most:,.0f} teeth, and teeth are drawn of up to {MAX_TEETH:,}."


def _skin(around: int, sections: int) -> list[Face]:
    """Triangles between rings of points that follow each other."""
    faces = []
    for ring in range(sections - 1):
        a = ring * around
        for k in range(around):
            n = (k + 1) % around
            faces += [(a + k, a + n, a + around + n), (a + k, a + around + n, a + around + k)]
    return faces


def rod(
    centre: tuple[float, float], radius: float, start: float, end: float, bore: float = 0.0
) -> Mesh:
    """A cylinder along x, with a bore of a radius through it or none [mm]."""
    turns = [2.0 * math.pi * k / ROUND for k in range(ROUND)]
    y, z = centre
    rings = ((start, bore), (start, radius), (end, radius), (end, bore), (start, bore))
    points = [(x, y + r * math.cos(t), z + r * math.sin(t)) for x, r in rings for t in turns]
    return points, _skin(ROUND, len(rings))


def upright(mesh: Mesh) -> Mesh:
    """A body along x turned to stand along z: (x, y, z) becomes (y, z, x)."""
    points, faces = mesh
    return [(y, z, x) for x, y, z in points], faces


def block(low: Point, high: Point) -> Mesh:
    """A box between two corners."""
    points = [
        (x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])
    ]
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return points, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def mesh_trace(mesh: Mesh, name: str, colour: str, group: str, **more: Any) -> dict[str, Any]:
    """A mesh for plotly, its numbers packed; shown and hidden with its group."""
    points, faces = mesh
    axes = {axis: packed("f", [p[k] for p in points]) for k, axis in enumerate("xyz")}
    corners = {corner: packed("I", [f[k] for f in faces]) for k, corner in enumerate("ijk")}
    look = {
        "type": "mesh3d",
        "name": group,
        "color": colour,
        "legendgroup": group,
        "flatshading": True,
        "lighting": LIGHT,
        "lightposition": {"x": 5000.0, "y": -6000.0, "z": 8000.0},
        "hovertemplate": f"{name}<extra></extra>",
    }
    return look | axes | corners | more


def line_trace(
    points: list[Point | None], name: str, colour: str, width: float, **more: Any
) -> dict[str, Any]:
    """Lines in space; None lifts the pen."""
    axes = {axis: [None if p is None else p[k] for p in points] for k, axis in enumerate("xyz")}
    look = {
        "type": "scatter3d",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        "line": {"color": colour, "width": width},
        "hoverinfo": "skip",
    }
    return look | axes | more


def edges(low: Point, high: Point) -> list[Point | None]:
    """The twelve edges of a box as lines."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    path: list[Point | None] = []
    for x in (x0, x1):
        path += [(x, y0, z0), (x, y1, z0), (x, y1, z1), (x, y0, z1), (x, y0, z0), None]
    for y in (y0, y1):
        for z in (z0, z1):
            path += [(x0, y, z), (x1, y, z), None]
    return path


def space(low: Point, high: Point, measures: Measures, height: int = 640) -> dict[str, Any]:
    """The layout of a plot in space, in the page's look, one scale on all axes.

    low, high: corners of all that is drawn, seen whole at first. Plotly measures where the eye is
    in the cube root of their volume.
    """
    size = [b - a for a, b in zip(low, high, strict=True)]
    away = EYE_DISTANCE * math.hypot(*size) / math.prod(size) ** (1 / 3)
    eye = {axis: away * share for axis, share in zip("xyz", EYE, strict=True)}
    ax = {
        "showbackground": False,
        "gridcolor": "--grid",
        "linecolor": "--axis",
        "zerolinecolor": "--grid",
        "tickfont": {"size": 11, "color": "--soft"},
        "showspikes": False,
    }
    scene: dict[str, Any] = {"aspectmode": "data", "dragmode": "orbit"}
    scene["camera"] = {"eye": eye, "center": {"x": 0.0, "y": 0.0, "z": -0.2}}  # axes are below
    for a, start, end in zip("xyz", low, high, strict=True):
        title = {"text": f"{a} [{measures.unit('mm')}]", "font": {"size": 12}}
        scene[f"{a}axis"] = ax | {"title": title} | _ticks(start, end, measures)
    return LOOK | {
        "height": height,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "legend": {"orientation": "h", "x": 0, "y": 1.0, "yanchor": "bottom"},
        "scene": scene,
        "uirevision": "kept",  # the reader's view survives a change from light to dark
    }


def _ticks(start: float, end: float, measures: Measures) -> dict[str, Any]:
    """Ticks of an axis in mm that are round in another unit."""
    unit = measures.of(1.0, "mm")
    if unit == 1.0:
        return {}
    rough = unit * (end - start) / TICKS
    size = 10.0 ** math.floor(math.log10(rough))
    step = min((k * size for k in (1.0, 2.0, 5.0, 10.0)), key=lambda s: abs(s - rough))
    first, last = math.ceil(unit * start / step), math.floor(unit * end / step)
    values = [k * step for k in range(first, last + 1)]
    return {"tickvals": [v / unit for v in values], "ticktext": [f"{v:.6g}" for v in values]}
