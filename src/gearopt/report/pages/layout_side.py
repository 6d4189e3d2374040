"""A layout seen across its shafts: gears as rectangles, bearings, motor, face widths."""

from collections.abc import Mapping

from gearopt.formulations.layout.layout_design import GearDesign, LayoutDesign, ShaftDesign
from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import Turning, keep_outs, meaning, motor, sides
from gearopt.report.pages.labels import SIZE, Place
from gearopt.report.pages.layout_marks import (
    across_dimension,
    box_lines,
    keep_out,
    walls,
)
from gearopt.report.pages.sheet import Drawing, Sheet, Window, series

LEVEL = 32.0  # px from the upper edge: where face widths stand


def side_view(
    found: LayoutDesign, window: Window, scale: float, axis: str, measures: Measures
) -> Drawing:
    """Along x to the right and z (from the side) or y (from above) up."""
    sheet = Sheet(window, scale)
    box_lines(sheet, found, "x", axis)
    for it in keep_outs(found):
        aside = any(
            start >= high or end <= low
            for (start, end), (low, high) in ((sides(it, a), walls(found, a)) for a in ("x", axis))
        )
        keep_out(sheet, it, "x", axis, hatched=aside)
    _motor(sheet, found, measures)
    above = axis == "y"
    heights = {s.shaft: s.y_mm if above else s.z_mm for s in found.shafts}
    far = sorted(found.shafts, key=lambda s: s.z_mm if above else s.y_mm, reverse=not above)
    for shaft in far:
        _shaft(sheet, found, shaft, heights[shaft.shaft], measures)
    across_dimension(sheet, found, "x", axis, measures)
    top = walls(found, axis)[1]
    face_widths(sheet, found, {gear.stage: top for gear in found.gears}, measures)
    right = sheet.at(walls(found, "x")[1], 0.0)[0]
    for shaft in found.shafts:
        x = sheet.at(shaft.to_mm, 0.0)[0]
        y = sheet.at(0.0, heights[shaft.shaft])[1]
        spots = [
            Place(right + dx, y + dy, 0.0, abs(dx - 18.0) + abs(dy), (x, y))
            for dx in (18.0, 34.0)
            for dy in (0.0, -12.0, 12.0, -24.0, 24.0, -36.0, 36.0)
        ]
        sheet.balloon(str(shaft.shaft), spots)
    for gear in sorted(found.gears, key=lambda g: -g.tip_diameter_mm):
        side_name(sheet, gear, heights[gear.shaft], gear.name)
    if axis == "z":
        return sheet.drawing("side view", "Side view, x to the right and z up.")
    return sheet.drawing("top view", "Top view, x to the right and y up.")


def _shaft(
    sheet: Sheet, found: LayoutDesign, shaft: ShaftDesign, height: float, measures: Measures
) -> None:
    """A shaft with what sits on it, as rectangles."""
    r = 0.5 * shaft.diameter_mm
    start, end = shaft.from_mm, shaft.to_mm
    sheet.rectangle((start, height - r), (end, height + r), "shaft")
    for it in found.bearings:
        if it.shaft == shaft.shaft:
            half = 0.5 * it.diameter_mm
            a, b = (it.from_mm, height - half), (it.to_mm, height + half)
            sheet.rectangle(a, b, "bearing", title=f"bearing of shaft {shaft.shaft}")
            sheet.line(a, b, "bearing")
            sheet.line((a[0], b[1]), (b[0], a[1]), "bearing")
    gears_on(sheet, found, shaft, height, measures)


def gears_on(
    sheet: Sheet, found: Turning, shaft: ShaftDesign, height: float, measures: Measures
) -> None:
    """The gears of a shaft as rectangles, and its centre line."""
    for gear in found.gears:
        if gear.shaft == shaft.shaft:
            half = 0.5 * gear.tip_diameter_mm
            a, b = (gear.from_mm, height - half), (gear.to_mm, height + half)
            sheet.rectangle(a, b, "tip", series(gear.stage), meaning(gear, measures))
            for z in (-0.5, 0.5):
                level = height + z * gear.reference_diameter_mm
                sheet.line((a[0], level), (b[0], level), "reference", series(gear.stage))
    past = 6.0 / sheet.scale
    sheet.line((shaft.from_mm - past, height), (shaft.to_mm + past, height), "axis")


def _motor(sheet: Sheet, found: LayoutDesign, measures: Measures) -> None:
    if (told := motor(found)) is None:
        return
    r, start, end = told
    sheet.rectangle((start, -r), (end, r), "motor", title="motor", round_=6.0)
    sheet.line((start, 0.0), (end, 0.0), "axis")
    x, y = sheet.at((start + end) / 2, 0.0)
    wide = f"{measures.of(2 * r, 'mm'):.4g}"
    sheet.label(f"motor ⌀ {wide}", [Place(x, y - 12.0), Place(x, y + 12.0)], "obstacle")


def face_widths(
    sheet: Sheet, found: Turning, tops: Mapping[int, float], measures: Measures
) -> None:
    """Face widths above all that is drawn; tops: where the lines to them begin, by stage [mm]."""
    wheels = {g.stage: g for g in found.gears if g.member == "wheel"}
    for slab in found.slabs:
        for stage in slab:
            if stage not in wheels:
                continue
            (x0, wall), (x1, _) = (
                sheet.at(x, tops[stage]) for x in (wheels[stage].from_mm, wheels[stage].to_mm)
            )
            for x in (x0, x1):
                sheet.tick((x, wall), (x, LEVEL - 4.0))
            sheet.arrows((x0, LEVEL), (x1, LEVEL))
            wide = wheels[stage].to_mm - wheels[stage].from_mm
            text = f"b{stage} {measures.length(wide, 1)}"
            levels = [Place((x0 + x1) / 2, LEVEL - up, 0.0, up / 10) for up in (9.0, 24.0)]
            sheet.label(text, levels, "size")


def side_name(sheet: Sheet, gear: GearDesign, height: float, text: str) -> None:
    """What a gear is called in its rectangle, level or upright, else beside it."""
    r = 0.5 * gear.tip_diameter_mm * sheet.scale
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
