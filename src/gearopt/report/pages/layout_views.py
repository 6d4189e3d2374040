"""A gearbox layout as a technical drawing: along the shafts, from the side, from above."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.pages.bodies import circle, nearest
from gearopt.report.pages.labels import SIZE, Place, around
from gearopt.report.pages.section import Section, meaning, series
from gearopt.report.pages.sheet import Drawing, Sheet, Window

WIDE, HIGH = 640.0, 780.0  # largest drawing [px]: two side by side, or one on a printed page
Layout = Mapping[str, Any]


def section(result: Result) -> Section | None:
    """The views of a layout, all at one scale; None where there is no layout."""
    found = result.design.get("layout")
    if not found:
        return None
    windows = [_window(found, axis) for axis in ("", "z", "y")]
    scale = min(window.scale(WIDE, HIGH) for window in windows)
    words = (
        f"Drawn to one scale; dimensions in mm. The axis of shaft 1, the input, is y = z = 0; "
        f"shaft {len(found['shafts'])} is the output. Dash-dotted circles are reference circles, "
        "solid ones tip circles; numbers in circles are shafts. The thin dashed line is as far "
        "from the wall as every gear has to stay."
    )
    views = (
        _front(found, windows[0], scale),
        _side(found, windows[1], scale, "z"),
        _side(found, windows[2], scale, "y"),
    )
    return Section("Layout", (words,), views)


def _ends(found: Layout, axis: str) -> tuple[float, float]:
    """Of the box along an axis, mm."""
    box = found["box"]
    if axis == "x":
        return 0.0, box["length_mm"]
    low = box["left_mm"] if axis == "y" else box["bottom_mm"]
    return low, low + (box["width_mm"] if axis == "y" else box["height_mm"])


def _window(found: Layout, axis: str) -> Window:
    """Of the front view, or of the view whose upright axis is given; the motor is inside."""
    motor = found["motor"]
    (bottom, top), (left, right) = _ends(found, axis or "z"), _ends(found, "x" if axis else "y")
    r = 0.5 * motor["diameter_mm"] if motor else 0.0
    bottom, top = min(bottom, -r), max(top, r)
    if not axis:
        return Window(min(left, -r), max(right, r), bottom, top, (52.0, 20.0, 48.0, 44.0))
    if motor and motor["at"] == "start":
        left -= motor["length_mm"]
    elif motor:
        right += motor["length_mm"]
    return Window(left, right, bottom, top, (20.0, 44.0, 48.0, 44.0))


def _front(found: Layout, window: Window, scale: float) -> Drawing:
    sheet = Sheet(window, scale)
    _box(sheet, found, "y", "z")
    if found["motor"]:
        sheet.circle(0.0, 0.0, 0.5 * found["motor"]["diameter_mm"], "motor", title="motor")
    for it in found["obstacles"]:
        _keep_out(sheet, it, "left_mm", "right_mm", "bottom_mm", "top_mm")
    places = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in found["shafts"]}
    gears = sorted(found["gears"], key=lambda g: (g["from_mm"], -g["tip_diameter_mm"]))
    for gear in gears:
        y, z = places[gear["shaft"]]
        sheet.circle(
            y, z, 0.5 * gear["tip_diameter_mm"], "tip", series(gear["stage"]), meaning(gear)
        )
        sheet.circle(y, z, 0.5 * gear["reference_diameter_mm"], "reference", series(gear["stage"]))
    for shaft in found["shafts"]:
        y, z = places[shaft["shaft"]]
        title = f"shaft {shaft['shaft']}: diameter {shaft['diameter_mm']:.2f} mm"
        sheet.circle(y, z, 0.5 * shaft["diameter_mm"], "shaft", title=title)
        sheet.cross(y, z, 0.5 * shaft["diameter_mm"])
    _split(sheet, found, places)
    _across(sheet, found, "y", "z")
    left, (bottom, top) = _ends(found, "y")[0], _ends(found, "z")
    away = sheet.at(left, 0.0)[0] - 20.0
    sheet.dimension((left, bottom), (left, top), away, f"{top - bottom:.2f}")
    _centre_distances(sheet, found, places)
    _narrowest(sheet, found)
    for number, (y, z) in places.items():
        sheet.balloon(str(number), around(sheet.at(y, z), (26.0, 36.0, 50.0), 0.0))
    for gear in sorted(found["gears"], key=lambda g: -g["tip_diameter_mm"]):
        _name(sheet, found, gear)
    caption = (
        f"Front view along the shafts, y to the right and z up, from the end x = "
        f"{found['box']['length_mm']:.1f}: each gear is drawn over those behind it."
    )
    return sheet.drawing("front view", caption)


def _box(sheet: Sheet, found: Layout, across: str, upright: str) -> None:
    (left, right), (bottom, top) = _ends(found, across), _ends(found, upright)
    sheet.rectangle((left, bottom), (right, top), "box")
    wall = found["clearances"].get("wall_mm") or 0.0
    if wall and across == "y":
        sheet.rectangle((left + wall, bottom + wall), (right - wall, top - wall), "wall")


def _across(sheet: Sheet, found: Layout, across: str, upright: str) -> None:
    """The box's dimension across, below all that is drawn."""
    (left, right), bottom = _ends(found, across), _ends(found, upright)[0]
    away = sheet.height - 18.0 - sheet.at(left, bottom)[1]
    sheet.dimension((left, bottom), (right, bottom), away, f"{right - left:.2f}")


def _keep_out(sheet: Sheet, it: Layout, left: str, right: str, bottom: str, top: str) -> None:
    a, b = (it[left], it[bottom]), (it[right], it[top])
    sheet.rectangle(a, b, "obstacle", title=f"keep-out: {it['name']}")
    sheet.hatch(a, b)
    x, y = sheet.at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    half = sheet.scale * abs(b[1] - a[1]) / 2
    offsets = (0.0, 0.5 * half, -0.5 * half, half + SIZE, -half - SIZE)
    sheet.label(
        it["name"], [Place(x, y + dy, 0.0, 3.0 * k) for k, dy in enumerate(offsets)], "obstacle"
    )


def _split(sheet: Sheet, found: Layout, places: Mapping[int, tuple[float, float]]) -> None:
    """The plane in which the housing is parted: through its shafts, level where there is one."""
    on = [places[k] for k in found["split"]]
    if not on:
        return
    left, right = _ends(found, "y")
    (y0, z0), (y1, z1) = min(on), max(on)
    slope = (z1 - z0) / (y1 - y0) if y1 - y0 > 1e-9 else 0.0
    ends = [(y, z0 + slope * (y - y0)) for y in (left, right)]
    sheet.line(ends[0], ends[1], "split")
    spots = [ends[0][0] + share * (right - left) for share in (0.1, 0.9, 0.3, 0.7)]
    points = [sheet.at(y, z0 + slope * (y - y0)) for y in spots]
    sheet.label("split", [Place(x, v + s * 9.0) for x, v in points for s in (-1, 1)], "split")


def _centre_distances(
    sheet: Sheet, found: Layout, places: Mapping[int, tuple[float, float]]
) -> None:
    """Between the shafts of every stage, along the line of centres."""
    for a, b, stage in _meshes(found):
        (y0, z0), (y1, z1) = places[a], places[b]
        sheet.line((y0, z0), (y1, z1), "centres")
        start, end = sheet.at(y0, z0), sheet.at(y1, z1)
        text = f"a{stage} = {math.dist(places[a], places[b]):.2f}"
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


def _meshes(found: Layout) -> list[tuple[int, int, int]]:
    """Shaft of the pinion, shaft of the wheel, stage."""
    on = {(g["stage"], g["member"]): g["shaft"] for g in found["gears"]}
    stages = sorted({g["stage"] for g in found["gears"]})
    return [
        (on[s, "pinion"], on[s, "wheel"], s)
        for s in stages
        if (s, "pinion") in on and (s, "wheel") in on
    ]


def _narrowest(sheet: Sheet, found: Layout) -> None:
    """The narrowest gap between two bodies, with its value."""
    if not found["gaps"]:
        return
    gap = found["gaps"][0]
    ends = nearest(found, *gap["between"])
    if ends is None:
        return
    start, end = sheet.at(*ends[0]), sheet.at(*ends[1])
    sheet.arrows(start, end, "gap")
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    text = f"gap {gap['gap_mm']:.2f}"
    sheet.label(text, around(middle, (44.0, 60.0, 80.0), 4.0), "gap")


def _name(sheet: Sheet, found: Layout, gear: Layout) -> None:
    """The gear's name where it is alone inside it, else outside with a line to it."""
    discs = [circle(found, g["name"]) for g in found["gears"] if g is not gear]
    (place, radius) = circle(found, gear["name"]) or ((0.0, 0.0), 0.0)
    centre, r = sheet.at(*place), radius * sheet.scale
    half = Place(0, 0).half_width(gear["name"])
    inside = around(centre, [share * r for share in (0.6, 0.75, 0.45) if share * r > 24.0])
    inside = [p for p in inside if math.dist((p.x, p.y), centre) + 0.8 * half < r]
    shared = [sum(_within(sheet, p, disc) for disc in discs if disc) for p in inside]
    alone = [replace(p, cost=p.cost + 8.0 * n) for p, n in zip(inside, shared, strict=True)]
    outside = around(centre, (r + half + 6, r + half + 20, r + half + 40), r, 20.0)
    sheet.label(gear["name"], alone + outside, "name", series(gear["stage"]))


def _within(sheet: Sheet, spot: Place, disc: tuple[tuple[float, float], float]) -> bool:
    return math.dist(sheet.at(*disc[0]), (spot.x, spot.y)) < disc[1] * sheet.scale + SIZE


def _side(found: Layout, window: Window, scale: float, axis: str) -> Drawing:
    """Along x to the right and z (from the side) or y (from above) up."""
    sheet = Sheet(window, scale)
    _box(sheet, found, "x", axis)
    low, high = ("bottom_mm", "top_mm") if axis == "z" else ("left_mm", "right_mm")
    for it in found["obstacles"]:
        _keep_out(sheet, it, "from_mm", "to_mm", low, high)
    _motor(sheet, found)
    depth = "y_mm" if axis == "z" else "z_mm"
    shafts = sorted(found["shafts"], key=lambda s: s[depth], reverse=axis == "z")
    for shaft in shafts:  # the farthest first
        _shaft(sheet, found, shaft, axis)
    heights = {s["shaft"]: s[f"{axis}_mm"] for s in shafts}
    _across(sheet, found, "x", axis)
    _widths(sheet, found, axis)
    right = sheet.at(_ends(found, "x")[1], 0.0)[0]
    for shaft in found["shafts"]:
        x = sheet.at(shaft["to_mm"], 0.0)[0]
        y = sheet.at(0.0, heights[shaft["shaft"]])[1]
        spots = [
            Place(right + dx, y + dy, 0.0, abs(dx - 18.0) + abs(dy), (x, y))
            for dx in (18.0, 34.0)
            for dy in (0.0, -12.0, 12.0, -24.0, 24.0, -36.0, 36.0)
        ]
        sheet.balloon(str(shaft["shaft"]), spots)
    for gear in sorted(found["gears"], key=lambda g: -g["tip_diameter_mm"]):
        _side_name(sheet, gear, heights[gear["shaft"]])
    if axis == "z":
        return sheet.drawing("side view", "Side view, x to the right and z up.")
    return sheet.drawing("top view", "Top view, x to the right and y up.")


def _shaft(sheet: Sheet, found: Layout, shaft: Layout, axis: str) -> None:
    """A shaft with what sits on it, as rectangles."""
    height, r = shaft[f"{axis}_mm"], 0.5 * shaft["diameter_mm"]
    start, end = shaft["from_mm"], shaft["to_mm"]
    sheet.rectangle((start, height - r), (end, height + r), "shaft")
    for it in found["bearings"]:
        if it["shaft"] == shaft["shaft"]:
            half = 0.5 * it["diameter_mm"]
            a, b = (it["from_mm"], height - half), (it["to_mm"], height + half)
            sheet.rectangle(a, b, "bearing", title=f"bearing of shaft {shaft['shaft']}")
            sheet.line(a, b, "bearing")
            sheet.line((a[0], b[1]), (b[0], a[1]), "bearing")
    for gear in found["gears"]:
        if gear["shaft"] == shaft["shaft"]:
            half = 0.5 * gear["tip_diameter_mm"]
            a, b = (gear["from_mm"], height - half), (gear["to_mm"], height + half)
            sheet.rectangle(a, b, "tip", series(gear["stage"]), meaning(gear))
            for z in (-0.5, 0.5):
                level = height + z * gear["reference_diameter_mm"]
                sheet.line((a[0], level), (b[0], level), "reference", series(gear["stage"]))
    past = 6.0 / sheet.scale
    sheet.line((start - past, height), (end + past, height), "axis")


def _motor(sheet: Sheet, found: Layout) -> None:
    motor = found["motor"]
    if not motor:
        return
    r, length = 0.5 * motor["diameter_mm"], motor["length_mm"]
    start = -length if motor["at"] == "start" else found["box"]["length_mm"]
    sheet.rectangle((start, -r), (start + length, r), "motor", title="motor", round_=6.0)
    sheet.line((start, 0.0), (start + length, 0.0), "axis")
    x, y = sheet.at(start + length / 2, 0.0)
    text = f"motor ⌀ {2 * r:g} x {length:g}"
    sheet.label(text, [Place(x, y - 12.0), Place(x, y + 12.0)], "obstacle")


def _widths(sheet: Sheet, found: Layout, axis: str) -> None:
    """Face widths above the box, slab after slab."""
    top = _ends(found, axis)[1]
    wheels = {g["stage"]: g for g in found["gears"] if g["member"] == "wheel"}
    for slab in found["slabs"]:
        for stage in slab:
            if stage not in wheels:
                continue
            a, b = ((wheels[stage][key], top) for key in ("from_mm", "to_mm"))
            (x0, y), (x1, _) = sheet.at(*a), sheet.at(*b)
            for x in (x0, x1):
                sheet.tick((x, y), (x, y - 16.0))
            sheet.arrows((x0, y - 12.0), (x1, y - 12.0))
            middle = ((x0 + x1) / 2, y - 12.0)
            text = f"b{stage} {wheels[stage]['to_mm'] - wheels[stage]['from_mm']:.1f}"
            levels = [Place(middle[0], y - dy, 0.0, dy / 10) for dy in (21.0, 36.0)]
            sheet.label(text, levels, "size")


def _side_name(sheet: Sheet, gear: Layout, height: float) -> None:
    """The name in its rectangle, level or upright, else beside it."""
    r = 0.5 * gear["tip_diameter_mm"] * sheet.scale
    wide = (gear["to_mm"] - gear["from_mm"]) * sheet.scale
    x, y = sheet.at(0.5 * (gear["from_mm"] + gear["to_mm"]), height)
    half = Place(0, 0).half_width(gear["name"])
    shares = (0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75)
    places = []
    if wide > 2.0 * half:
        places += [Place(x, y + s * r) for s in shares if abs(s) * r + SIZE / 2 < r]
    if wide > SIZE:
        places += [Place(x, y + s * r, -90.0, 4.0) for s in shares if abs(s) * r + half < r + 6.0]
    for side in (-1, 1):
        for dy in (0.0, -16.0, 16.0, -32.0, 32.0, -r - 14.0, r + 14.0):
            u = x + side * (wide / 2 + half + 8.0)
            edge = (x + side * wide / 2, y + max(-r, min(r, dy)))
            places.append(Place(u, y + dy, 0.0, 20.0 + abs(dy) / 8, edge))
    sheet.label(gear["name"], places, "name", series(gear["stage"]))
