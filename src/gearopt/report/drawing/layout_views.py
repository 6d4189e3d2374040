"""A gearbox layout as a technical drawing: along the shafts, from the side, from above."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from gearopt.formulations.drive.layout.layout_design import (
    GearDesign,
    KeepOutDesign,
    LayoutDesign,
    ShaftDesign,
)
from gearopt.optimise.result import Result
from gearopt.report.drawing.bodies import (
    Disc,
    RingDesign,
    Turning,
    along,
    box_corners,
    cropped_keep_outs,
    drawn_corners,
    gear_disc,
    layout_of,
    meaning,
    motor,
    nearest,
    sides,
    widest,
)
from gearopt.report.drawing.sheet import SIZE, Drawing, Place, Point, Sheet, Window, around, series
from gearopt.report.measures import Measures
from gearopt.report.section import Section

WIDE, HIGH = 640.0, 780.0  # largest drawing [px]: two side by side, or one on a printed page
BESIDE = 400.0  # px of the widest of several front views that stand beside each other
LEVEL = 32.0  # px from the upper edge: where face widths stand


Over = Callable[[Sheet], None]  # draws more over a view


def section(result: Result, measures: Measures) -> Section | None:
    """Draw the views of a layout, all at one scale; None where there is no layout."""
    if (layout := layout_of(result)) is None:
        return None
    windows = [window_of(layout, axis) for axis in ("", "z", "y")]
    scale = min(window.scale(WIDE, HIGH) for window in windows)
    words = [
        f"Drawn to one scale; dimensions in {measures.lengths}. The axis of shaft 1, the input, "
        f"is y = z = 0; shaft {len(layout.shafts)} is the output. Dash-dotted circles are "
        "reference circles, solid ones tip circles; numbers in circles are shafts. The thin dashed "
        "line marks the wall clearance."
    ]
    if layout.obstacles:
        words.append("Hatched boxes are keep-outs; those that reach far out are cut off.")
    if layout.motor:
        words.append("No length of the motor was given: it is drawn as long as it is wide.")
    views = (
        front_view(layout, windows[0], scale, measures),
        side_view(layout, windows[1], scale, "z", measures),
        side_view(layout, windows[2], scale, "y", measures),
    )
    return Section("Layout", words=words, drawings=views, to_scale=True)


def beside(designs: Mapping[str, LayoutDesign], measures: Measures) -> tuple[Drawing, ...]:
    """Draw the front views of layouts, all at one scale; designs: by what they are called."""
    windows = {name: window_of(layout, "") for name, layout in designs.items()}
    scale = min(window.scale(BESIDE, HIGH) for window in windows.values())
    return tuple(
        replace(front_view(layout, windows[name], scale, measures), caption=f"{name.capitalize()}.")
        for name, layout in designs.items()
    )


def window_of(layout: LayoutDesign, axis: str) -> Window:
    """The window of the front view, or of the view with this upright axis."""
    ends = drawn_corners(layout)
    (bottom, top), (left, right) = along(ends, axis or "z"), along(ends, "x" if axis else "y")
    free = (20.0, 44.0, 48.0, 44.0) if axis else (52.0, 20.0, 48.0, 44.0)
    return Window(left, right, bottom, top, free)


def walls(layout: LayoutDesign, axis: str) -> tuple[float, float]:
    """Both ends of the box along an axis [mm]."""
    return along(box_corners(layout), axis)


def box_lines(sheet: Sheet, layout: LayoutDesign, across: str, upright: str) -> None:
    """Draw the box, and in the front view the wall clearance."""
    (left, right), (bottom, top) = walls(layout, across), walls(layout, upright)
    sheet.rectangle((left, bottom), (right, top), "box")
    wall = layout.clearances.wall_mm
    if wall and across == "y":
        sheet.rectangle((left + wall, bottom + wall), (right - wall, top - wall), "wall")


def across_dimension(
    sheet: Sheet, layout: LayoutDesign, across: str, upright: str, measures: Measures
) -> None:
    """Draw the box's dimension across, below all that is drawn."""
    (left, right), bottom = walls(layout, across), walls(layout, upright)[0]
    away = sheet.height - 18.0 - sheet.at(left, bottom)[1]
    sheet.dimension((left, bottom), (right, bottom), away, measures.length(right - left))


def keep_out(
    sheet: Sheet, it: KeepOutDesign, across: str, upright: str, hatched: bool = True
) -> None:
    """Draw a rectangle with its name; only its outline where what is behind it must be seen."""
    a, b = zip(sides(it, across), sides(it, upright), strict=True)
    title = f"keep-out: {it.name}"
    if not hatched:
        sheet.rectangle(a, b, "obstacle before", title=title)
        return
    sheet.rectangle(a, b, "obstacle", title=title)
    sheet.hatch(a, b)
    x, y = sheet.at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    half = sheet.scale * abs(b[1] - a[1]) / 2
    offsets = (0.0, 0.5 * half, -0.5 * half, half + SIZE, -half - SIZE)
    places = [Place(x, y + dy, 0.0, 3.0 * k) for k, dy in enumerate(offsets)]
    sheet.label(it.name, places, "obstacle")


def front_view(
    layout: LayoutDesign,
    window: Window,
    scale: float,
    measures: Measures,
    over: Over | None = None,
) -> Drawing:
    """Draw the view along the shafts, y to the right and z up; over: what is drawn over it."""
    sheet = Sheet(window, scale)
    box_lines(sheet, layout, "y", "z")
    if place := motor(layout):
        sheet.circle(0.0, 0.0, place[0], "motor", title="motor")
    for it in cropped_keep_outs(layout):
        keep_out(sheet, it, "y", "z")
    places = {s.shaft: (s.y_mm, s.z_mm) for s in layout.shafts}
    gear_circles(sheet, layout, places, lambda gear: meaning(gear, measures))
    for shaft in layout.shafts:
        y, z = places[shaft.shaft]
        size = f"{measures.length(shaft.diameter_mm)} {measures.unit('mm')}"
        title = f"shaft {shaft.shaft}: diameter {size}"
        sheet.circle(y, z, 0.5 * shaft.diameter_mm, "shaft", title=title)
        sheet.cross(y, z, 0.5 * shaft.diameter_mm)
    _split(sheet, layout, places)
    across_dimension(sheet, layout, "y", "z", measures)
    left, (bottom, top) = walls(layout, "y")[0], walls(layout, "z")
    away = sheet.at(left, 0.0)[0] - 20.0
    sheet.dimension((left, bottom), (left, top), away, measures.length(top - bottom))
    _centre_distances(sheet, layout, places, measures)
    _narrowest(sheet, layout, measures)
    for number, (y, z) in places.items():
        sheet.balloon(str(number), around(sheet.at(y, z), (26.0, 36.0, 50.0), 0.0))
    gear_names(sheet, layout)
    if over is not None:
        over(sheet)
    caption = (
        "Front view along the shafts, y to the right and z up, from the end of largest x: "
        "each gear is drawn over those behind it."
    )
    return sheet.drawing("front view", caption)


def gear_circles(
    sheet: Sheet,
    train: Turning,
    places: Mapping[int, tuple[float, float]],
    title: Callable[[GearDesign], str],
) -> None:
    """Draw the tip and reference circles, those behind first; places: (y, z) of the shafts.

    title: what a gear says where the pointer rests.
    """
    gears = sorted(train.gears, key=lambda g: (g.from_mm, -g.tip_diameter_mm))
    for gear in gears:
        y, z = places[gear.shaft]
        colour = series(gear.stage)
        if isinstance(gear, RingDesign):
            radii = 0.5 * gear.outside_diameter_mm, 0.5 * gear.tip_diameter_mm
            sheet.ring(y, z, radii, "tip", colour, title(gear))
        else:
            sheet.circle(y, z, 0.5 * gear.tip_diameter_mm, "tip", colour, title(gear))
        sheet.circle(y, z, 0.5 * gear.reference_diameter_mm, "reference", colour)


def gear_names(sheet: Sheet, train: Turning) -> None:
    """Write the name of every gear, the largest first; of planets one is named."""
    named = {gear.name: gear for gear in reversed(train.gears)}
    for gear in sorted([*named.values()][::-1], key=lambda g: -g.tip_diameter_mm):
        _name(sheet, train, gear)


def _split(sheet: Sheet, layout: LayoutDesign, places: Mapping[int, tuple[float, float]]) -> None:
    """Draw the split line of the housing: through its shafts, level where there is one."""
    on = [places[k] for k in layout.split]
    if not on:
        return
    left, right = walls(layout, "y")
    (y0, z0), (y1, z1) = min(on), max(on)
    slope = (z1 - z0) / (y1 - y0) if y1 - y0 > 1e-9 else 0.0
    ends = [(y, z0 + slope * (y - y0)) for y in (left, right)]
    sheet.line(ends[0], ends[1], "split")
    spots = [ends[0][0] + share * (right - left) for share in (0.1, 0.9, 0.3, 0.7)]
    points = [sheet.at(y, z0 + slope * (y - y0)) for y in spots]
    sheet.label("split", [Place(x, v + s * 9.0) for x, v in points for s in (-1, 1)], "split")


def _centre_distances(
    sheet: Sheet,
    layout: LayoutDesign,
    places: Mapping[int, tuple[float, float]],
    measures: Measures,
) -> None:
    """Draw the centre distance of every stage, along the line of centres."""
    for stage in sorted({gear.stage for gear in layout.gears}):
        ends = [places[gear.shaft] for gear in layout.gears if gear.stage == stage]
        if len(ends) == 2:
            text = f"a{stage} = {measures.length(math.dist(*ends))}"
            centre_distance(sheet, ends[0], ends[1], text)


def centre_distance(sheet: Sheet, a: Point, b: Point, text: str) -> None:
    """Draw a line of centres between two axes [mm], with its text along it."""
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


def _narrowest(sheet: Sheet, layout: LayoutDesign, measures: Measures) -> None:
    """Draw the smallest gap between two bodies, with its value."""
    gap = next(iter(layout.gaps), None)
    if gap is None or (ends := nearest(layout, *gap.between)) is None:
        return
    start, end = sheet.at(*ends[0][1:]), sheet.at(*ends[1][1:])
    sheet.arrows(start, end, "gap")
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    text = f"gap {measures.length(gap.gap_mm)}"
    sheet.label(text, around(middle, (44.0, 60.0, 80.0), 4.0), "gap")


def _name(sheet: Sheet, train: Turning, gear: GearDesign) -> None:
    """Write the gear's name where it is alone inside it, else outside with a line to it."""
    disc, others = gear_disc(train, gear), [g for g in train.gears if g.name != gear.name]
    discs = [gear_disc(train, g) for g in others]
    centre, r = sheet.at(*disc.centre), 0.5 * widest(gear) * sheet.scale
    half = Place(0, 0).half_width(gear.name)
    inside = around(centre, [share * r for share in (0.6, 0.75, 0.45) if share * r > 24.0])
    ring = isinstance(gear, RingDesign)
    inside = [p for p in inside if math.dist((p.x, p.y), centre) + 0.8 * half < r and not ring]
    shared = [sum(_within(sheet, p, body) for body in discs) for p in inside]
    alone = [replace(p, cost=p.cost + 8.0 * n) for p, n in zip(inside, shared, strict=True)]
    outside = around(centre, (r + half + 6, r + half + 20, r + half + 40), r, 20.0)
    outside = [p for p in outside if abs(p.x - centre[0]) > 1.0]  # no leader on a centre line
    sheet.label(gear.name, alone + outside, "name", series(gear.stage))


def _within(sheet: Sheet, spot: Place, body: Disc) -> bool:
    return math.dist(sheet.at(*body.centre), (spot.x, spot.y)) < body.radius * sheet.scale + SIZE


def side_view(
    layout: LayoutDesign,
    window: Window,
    scale: float,
    axis: str,
    measures: Measures,
    over: Over | None = None,
) -> Drawing:
    """Draw the view along x to the right and z (from the side) or y (from above) up.

    over: what is drawn over it.
    """
    sheet = Sheet(window, scale)
    box_lines(sheet, layout, "x", axis)
    for it in cropped_keep_outs(layout):
        aside = any(
            start >= high or end <= low
            for (start, end), (low, high) in ((sides(it, a), walls(layout, a)) for a in ("x", axis))
        )
        keep_out(sheet, it, "x", axis, hatched=aside)
    _motor(sheet, layout, measures)
    above = axis == "y"
    heights = {s.shaft: s.y_mm if above else s.z_mm for s in layout.shafts}
    far = sorted(layout.shafts, key=lambda s: s.z_mm if above else s.y_mm, reverse=not above)
    for shaft in far:
        _shaft(sheet, layout, shaft, heights[shaft.shaft], measures)
    across_dimension(sheet, layout, "x", axis, measures)
    top = walls(layout, axis)[1]
    face_widths(sheet, layout, {gear.stage: top for gear in layout.gears}, measures)
    right = sheet.at(walls(layout, "x")[1], 0.0)[0]
    for shaft in layout.shafts:
        x = sheet.at(shaft.to_mm, 0.0)[0]
        y = sheet.at(0.0, heights[shaft.shaft])[1]
        spots = [
            Place(right + dx, y + dy, 0.0, abs(dx - 18.0) + abs(dy), (x, y))
            for dx in (18.0, 34.0)
            for dy in (0.0, -12.0, 12.0, -24.0, 24.0, -36.0, 36.0)
        ]
        sheet.balloon(str(shaft.shaft), spots)
    for gear in sorted(layout.gears, key=lambda g: -g.tip_diameter_mm):
        side_name(sheet, gear, heights[gear.shaft], gear.name + own_width(layout, gear, measures))
    if over is not None:
        over(sheet)
    if axis == "z":
        return sheet.drawing("side view", "Side view, x to the right and z up.")
    return sheet.drawing("top view", "Top view, x to the right and y up.")


def _shaft(
    sheet: Sheet, layout: LayoutDesign, shaft: ShaftDesign, height: float, measures: Measures
) -> None:
    """Draw a shaft with what sits on it, as rectangles."""
    r = 0.5 * shaft.diameter_mm
    start, end = shaft.from_mm, shaft.to_mm
    sheet.rectangle((start, height - r), (end, height + r), "shaft")
    for it in layout.bearings:
        if it.shaft == shaft.shaft:
            half = 0.5 * it.diameter_mm
            a, b = (it.from_mm, height - half), (it.to_mm, height + half)
            sheet.rectangle(a, b, "bearing", title=f"bearing of shaft {shaft.shaft}")
            sheet.line(a, b, "bearing")
            sheet.line((a[0], b[1]), (b[0], a[1]), "bearing")
    gears_on(sheet, layout, shaft, height, measures)


def gears_on(
    sheet: Sheet, train: Turning, shaft: ShaftDesign, height: float, measures: Measures
) -> None:
    """Draw the gears of a shaft as rectangles, and its centre line."""
    for gear in train.gears:
        if gear.shaft == shaft.shaft:
            half, inner = 0.5 * widest(gear), 0.5 * gear.tip_diameter_mm
            cuts = [(-half, half)]
            if isinstance(gear, RingDesign):
                cuts = [(-half, -inner), (inner, half)]
            for low, high in cuts:
                a, b = (gear.from_mm, height + low), (gear.to_mm, height + high)
                sheet.rectangle(a, b, "tip", series(gear.stage), meaning(gear, measures))
                if isinstance(gear, RingDesign):
                    sheet.hatch(a, b)
            for z in (-0.5, 0.5):
                level = height + z * gear.reference_diameter_mm
                sheet.line((a[0], level), (b[0], level), "reference", series(gear.stage))
    past = 6.0 / sheet.scale
    sheet.line((shaft.from_mm - past, height), (shaft.to_mm + past, height), "axis")


def _motor(sheet: Sheet, layout: LayoutDesign, measures: Measures) -> None:
    if (place := motor(layout)) is None:
        return
    r, start, end = place
    sheet.rectangle((start, -r), (end, r), "motor", title="motor", round_=6.0)
    sheet.line((start, 0.0), (end, 0.0), "axis")
    x, y = sheet.at((start + end) / 2, 0.0)
    wide = f"{measures.of(2 * r, 'mm'):.4g}"
    sheet.label(f"motor ⌀ {wide}", [Place(x, y - 12.0), Place(x, y + 12.0)], "obstacle")


def face_widths(
    sheet: Sheet, train: Turning, tops: Mapping[int, float], measures: Measures
) -> None:
    """Draw face widths above all that is drawn; tops: where their lines begin, by stage [mm]."""
    for stage, wheel in _dimensioned(train).items():
        (x0, wall), (x1, _) = (sheet.at(x, tops[stage]) for x in (wheel.from_mm, wheel.to_mm))
        for x in (x0, x1):
            sheet.tick((x, wall), (x, LEVEL - 4.0))
        sheet.arrows((x0, LEVEL), (x1, LEVEL))
        text = f"b{stage} {measures.length(wheel.to_mm - wheel.from_mm, 1)}"
        levels = [Place((x0 + x1) / 2, LEVEL - up, 0.0, up / 10) for up in (9.0, 24.0)]
        sheet.label(text, levels, "size")


def _dimensioned(train: Turning) -> dict[int, GearDesign]:
    """The gear of each stage whose face width is dimensioned; none of those behind an idler."""
    wheels = {g.stage: g for g in train.gears if g.member in ("wheel", "ring")}
    return {k: wheels[k] for slab in train.slabs for k in slab if k in wheels}


def own_width(train: Turning, gear: GearDesign, measures: Measures) -> str:
    """The face width of a gear behind its name, where it is not the one that is dimensioned."""
    wheel, wide = _dimensioned(train).get(gear.stage), gear.to_mm - gear.from_mm
    alike = wheel is not None and math.isclose(wheel.to_mm - wheel.from_mm, wide)
    return "" if alike else f", b {measures.length(wide, 1)}"


def side_name(sheet: Sheet, gear: GearDesign, height: float, text: str) -> None:
    """Write the name of a gear in its rectangle, level or upright, else beside it.

    Of a ring in the upper half of its section.
    """
    r = 0.5 * gear.tip_diameter_mm * sheet.scale
    if isinstance(gear, RingDesign):
        height += 0.25 * (gear.outside_diameter_mm + gear.tip_diameter_mm)
        r = 0.25 * (gear.outside_diameter_mm - gear.tip_diameter_mm) * sheet.scale
    wide = (gear.to_mm - gear.from_mm) * sheet.scale
    x, y = sheet.at(0.5 * (gear.from_mm + gear.to_mm), height)
    half = Place(0, 0).half_width(text)
    shares = (0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75)
    places = []
    if wide > 2.0 * half:
        places += [Place(x, y + s * r) for s in shares if abs(s) * r + SIZE / 2 < r]
    if wide > SIZE:
        places += [Place(x, y + s * r, -90.0, 4.0) for s in shares if abs(s) * r + half < r + 6.0]
    for side in (-1, 1):
        for dy in (0.0, -16.0, 16.0, -32.0, 32.0, -r - 14.0, r + 14.0):
            u = x + side * (wide / 2 + half + 8.0)
            edge = (x + side * wide / 2, y + max(-0.7 * r, min(0.7 * r, dy)))
            places.append(Place(u, y + dy, 0.0, 20.0 + abs(dy) / 8, edge))
    sheet.label(text, places, "name", series(gear.stage))
