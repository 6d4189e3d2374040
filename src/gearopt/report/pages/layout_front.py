"""A layout seen along its shafts: circles, centre distances, the narrowest gap."""

import math
from collections.abc import Mapping
from dataclasses import replace

from gearopt.formulations.layout.layout_design import GearDesign, LayoutDesign
from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import (
    Disc,
    Turning,
    gear_disc,
    keep_outs,
    meaning,
    motor,
    nearest,
)
from gearopt.report.pages.labels import SIZE, Place, around
from gearopt.report.pages.layout_marks import (
    across_dimension,
    box_lines,
    keep_out,
    walls,
)
from gearopt.report.pages.sheet import Drawing, Point, Sheet, Window, series


def front_view(found: LayoutDesign, window: Window, scale: float, measures: Measures) -> Drawing:
    """Along the shafts, y to the right and z up."""
    sheet = Sheet(window, scale)
    box_lines(sheet, found, "y", "z")
    if told := motor(found):
        sheet.circle(0.0, 0.0, told[0], "motor", title="motor")
    for it in keep_outs(found):
        keep_out(sheet, it, "y", "z")
    places = {s.shaft: (s.y_mm, s.z_mm) for s in found.shafts}
    gear_circles(sheet, found, places, measures)
    for shaft in found.shafts:
        y, z = places[shaft.shaft]
        size = f"{measures.length(shaft.diameter_mm)} {measures.unit('mm')}"
        title = f"shaft {shaft.shaft}: diameter {size}"
        sheet.circle(y, z, 0.5 * shaft.diameter_mm, "shaft", title=title)
        sheet.cross(y, z, 0.5 * shaft.diameter_mm)
    _split(sheet, found, places)
    across_dimension(sheet, found, "y", "z", measures)
    left, (bottom, top) = walls(found, "y")[0], walls(found, "z")
    away = sheet.at(left, 0.0)[0] - 20.0
    sheet.dimension((left, bottom), (left, top), away, measures.length(top - bottom))
    _centre_distances(sheet, found, places, measures)
    _narrowest(sheet, found, measures)
    for number, (y, z) in places.items():
        sheet.balloon(str(number), around(sheet.at(y, z), (26.0, 36.0, 50.0), 0.0))
    gear_names(sheet, found)
    caption = (
        f"Front view along the shafts, y to the right and z up, from the end x = "
        f"{measures.length(found.box.length_mm, 1)}: each gear is drawn over those behind it."
    )
    return sheet.drawing("front view", caption)


def gear_circles(
    sheet: Sheet,
    found: Turning,
    places: Mapping[int, tuple[float, float]],
    measures: Measures,
) -> None:
    """Tip and reference circle of every gear, those behind first; places: (y, z) of the shafts."""
    gears = sorted(found.gears, key=lambda g: (g.from_mm, -g.tip_diameter_mm))
    for gear in gears:
        y, z = places[gear.shaft]
        colour, title = series(gear.stage), meaning(gear, measures)
        sheet.circle(y, z, 0.5 * gear.tip_diameter_mm, "tip", colour, title)
        sheet.circle(y, z, 0.5 * gear.reference_diameter_mm, "reference", colour)


def gear_names(sheet: Sheet, found: Turning) -> None:
    """The name of every gear, the largest first."""
    for gear in sorted(found.gears, key=lambda g: -g.tip_diameter_mm):
        _name(sheet, found, gear)


def _split(sheet: Sheet, found: LayoutDesign, places: Mapping[int, tuple[float, float]]) -> None:
    """The plane in which the housing is parted: through its shafts, level where there is one."""
    on = [places[k] for k in found.split]
    if not on:
        return
    left, right = walls(found, "y")
    (y0, z0), (y1, z1) = min(on), max(on)
    slope = (z1 - z0) / (y1 - y0) if y1 - y0 > 1e-9 else 0.0
    ends = [(y, z0 + slope * (y - y0)) for y in (left, right)]
    sheet.line(ends[0], ends[1], "split")
    spots = [ends[0][0] + share * (right - left) for share in (0.1, 0.9, 0.3, 0.7)]
    points = [sheet.at(y, z0 + slope * (y - y0)) for y in spots]
    sheet.label("split", [Place(x, v + s * 9.0) for x, v in points for s in (-1, 1)], "split")


def _centre_distances(
    sheet: Sheet,
    found: LayoutDesign,
    places: Mapping[int, tuple[float, float]],
    measures: Measures,
) -> None:
    """Between the shafts of every stage, along the line of centres."""
    for a, b, stage in _meshes(found):
        text = f"a{stage} = {measures.length(math.dist(places[a], places[b]))}"
        centre_distance(sheet, places[a], places[b], text)


def centre_distance(sheet: Sheet, a: Point, b: Point, text: str) -> None:
    """A line of centres between two axes [mm], with its text along it."""
    sheet.line(a, b, "centres")
    start, end = sheet.at(*a), sheet.at(*b)
    angle = math.degrees(math.atan2(end[1] - start[1], end[0] - start[0]))
    angle = (angle + 90.0) % 180.0 - 90.0  # never upside down
    nx, ny = -math.sin(math.radians(angle)), math.cos(math.radians(angle))
    spots = []
    for k, share in enumerate((0.5, 0.42, 0.58, 0.35, 0.65, 0.28, 0.72)):
        x, y = (s + share * (e - s) for s, e in zip(start, end, strict=True))
        spots += [
            Place(x + side * 9.0 * nx, y + side * 9.0 * ny, angle, 2.0 * k) for side in (-1, 1)
        ]
    sheet.label(text, spots, "size")


def _meshes(found: LayoutDesign) -> list[tuple[int, int, int]]:
    """Shaft of the pinion, shaft of the wheel, stage."""
    on = {(g.stage, g.member): g.shaft for g in found.gears}
    stages = sorted({g.stage for g in found.gears})
    return [
        (on[s, "pinion"], on[s, "wheel"], s)
        for s in stages
        if (s, "pinion") in on and (s, "wheel") in on
    ]


def _narrowest(sheet: Sheet, found: LayoutDesign, measures: Measures) -> None:
    """The narrowest gap between two bodies, with its value."""
    if not found.gaps:
        return
    gap = found.gaps[0]
    ends = nearest(found, *gap.between)
    if ends is None:
        return
    start, end = sheet.at(*ends[0][1:]), sheet.at(*ends[1][1:])
    sheet.arrows(start, end, "gap")
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    text = f"gap {measures.length(gap.gap_mm)}"
    sheet.label(text, around(middle, (44.0, 60.0, 80.0), 4.0), "gap")


def _name(sheet: Sheet, found: Turning, gear: GearDesign) -> None:
    """The gear's name where it is alone inside it, else outside with a line to it."""
    own, others = gear_disc(found, gear), [g for g in found.gears if g.name != gear.name]
    discs = [gear_disc(found, g) for g in others]
    centre, r = sheet.at(*own.centre), own.radius * sheet.scale
    half = Place(0, 0).half_width(gear.name)
    inside = around(centre, [share * r for share in (0.6, 0.75, 0.45) if share * r > 24.0])
    inside = [p for p in inside if math.dist((p.x, p.y), centre) + 0.8 * half < r]
    shared = [sum(_within(sheet, p, one) for one in discs) for p in inside]
    alone = [replace(p, cost=p.cost + 8.0 * n) for p, n in zip(inside, shared, strict=True)]
    outside = around(centre, (r + half + 6, r + half + 20, r + half + 40), r, 20.0)
    outside = [p for p in outside if abs(p.x - centre[0]) > 1.0]  # no leader on a centre line
    sheet.label(gear.name, alone + outside, "name", series(gear.stage))


def _within(sheet: Sheet, spot: Place, one: Disc) -> bool:
    return math.dist(sheet.at(*one.centre), (spot.x, spot.y)) < one.radius * sheet.scale + SIZE
