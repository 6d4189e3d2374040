"""A spur pair in three dimensions: involute, fillet and body of both gears, in mesh, on shafts."""

import math
from typing import Any

from gearopt.physics.blanks import Body
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.report.drawing.sheet import SERIES_OF_MEMBERS, series
from gearopt.report.drawing.solid import (
    TURN,
    Toothed,
    gear_mesh,
    mesh_trace,
    outline,
    rings_of,
    rod,
    space,
)
from gearopt.report.drawing.still import Rod, Texts, sizes_of, still, view
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure

POINTS = 20_000  # of both gears together, about half a megabyte of a page
FLANKS = (12, 10, 8, 6, 4, 3, 2)  # points on a flank
SHAFT_BEYOND = 0.25  # face widths that a shaft is seen beyond its gear
FLAT = 1e-3  # mm: thickness of a circle on a face in the still
CAPTION = (
    f"{TURN} Involute and fillet as the tools cut them, thinned by 3 % of half a pitch so that the "
    "flanks are seen apart."
)


def figure(pair: GearPair, bodies: tuple[Body, Body], measures: Measures) -> Figure:
    """Draw a spur pair of whole teeth, the pinion's axis being x and the wheel's beside it."""
    width, centres = float(pair.face_width), (0.0, float(pair.centre_distance))
    phases = 0.0, math.pi + math.pi / pair.wheel_teeth  # a tooth of the pinion in a gap
    placed = [
        Toothed(gear, 0.0, width, (y, 0.0), phase)
        for gear, y, phase in zip(pair.gears, centres, phases, strict=True)
    ]
    rows = list(zip(MEMBERS, placed, bodies, strict=True))
    flank = _points_per_flank(pair, bodies)
    traces = [_trace(*row, flank) for row in rows]
    for member, gear, body in (row for row in rows if row[2].bore):
        mesh = rod(gear.centre, 0.5 * (body.bore or 0.0), *_shaft(width))
        look = {"showlegend": not any(t["name"] == "shafts" for t in traces)}
        traces.append(mesh_trace(mesh, f"shaft of the {member}", "--metal", "shafts", **look))
    tips = [0.5 * float(gear.tip_diameter) for gear in pair.gears]
    start, end = _shaft(width) if any(body.bore for body in bodies) else (0.0, width)
    low, high = (start, -tips[0], -max(tips)), (end, centres[1] + tips[1], max(tips))
    solids = [solid for row in rows for solid in _solids(*row)]
    texts = Texts(sizes_of((low, high), "xyz", measures), [(m, _colour(m)) for m in MEMBERS])
    drawn = still(solids, (low, high), view(), texts, "the pair in space")
    words = f"{CAPTION} Shafts are as thick as the bores." if start < 0.0 else CAPTION
    return Figure(traces, space(low, high, measures, 560), words, drawn)


def _colour(member: str) -> str:
    return series(SERIES_OF_MEMBERS[MEMBERS.index(member)])


def _shaft(width: float) -> tuple[float, float]:
    """The ends of a shaft [mm]."""
    return -SHAFT_BEYOND * width, (1.0 + SHAFT_BEYOND) * width


def _points_per_flank(pair: GearPair, bodies: tuple[Body, Body]) -> int:
    """Return the number of points on a flank: the most with both gears together below POINTS."""
    rings = [2 + len(rings_of(b, g, 0.0, 1.0)) for b, g in zip(bodies, pair.gears, strict=True)]
    sides = sum(2 * gear.teeth * n for gear, n in zip(pair.gears, rings, strict=True))
    return next((flank for flank in FLANKS if flank * sides < POINTS), FLANKS[-1])


def _trace(member: str, gear: Toothed, body: Body, flank: int) -> dict[str, Any]:
    inside = rings_of(body, gear.gear, gear.start, gear.end)
    mesh = gear_mesh(gear, flank, math.inf, inside)
    return mesh_trace(mesh, _words(member, gear), _colour(member), member, showlegend=True)


def _words(member: str, gear: Toothed) -> str:
    return f"{member}: z {gear.gear.teeth:.6g}"


def _solids(member: str, gear: Toothed, body: Body) -> list[Rod]:
    """A gear and the ends of its shaft for the still; circles where rim and hub end."""
    rim = tuple((angle + gear.phase, r) for angle, r in outline(gear.gear, 4))
    tip, (start, end) = 0.5 * float(gear.gear.tip_diameter), _shaft(gear.end)
    look = "gear", _colour(member), _words(member, gear)
    rods = [Rod(gear.centre, tip, gear.start, gear.end, *look, rim)]
    face = gear.end
    if body.web_thickness is not None and body.rim_thickness is not None:
        inside = float(gear.gear.root_diameter) - 2.0 * body.rim_thickness
        for diameter in filter(None, (inside, body.hub_diameter)):
            rods.append(Rod(gear.centre, 0.5 * diameter, face, face + FLAT, *look))
            face += FLAT
    for ends in ((start, gear.start), (face, end)) if body.bore else ():
        r, title = 0.5 * (body.bore or 0.0), f"shaft of the {member}"
        rods.append(Rod(gear.centre, r, *ends, "metal", title=title))
    return rods
