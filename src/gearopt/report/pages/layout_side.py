"""A layout seen across its shafts: gears as rectangles, bearings, motor, face widths."""

from collections.abc import Mapping

from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import ENDS, Layout, keep_outs, motor
from gearopt.report.pages.labels import SIZE, Place
from gearopt.report.pages.layout_marks import (
    across_dimension,
    box_lines,
    keep_out,
    walls,
)
from gearopt.report.pages.section import meaning, series
from gearopt.report.pages.sheet import Drawing, Sheet, Window

LEVEL = 32.0  # px from the upper edge: where face widths stand


def side_view(
    found: Layout, window: Window, scale: float, axis: str, measures: Measures
) -> Drawing:
    """Along x to the right and z (from the side) or y (from above) up."""
    sheet = Sheet(window, scale)
    box_lines(sheet, found, "x", axis)
    for it in keep_outs(found):
        aside = any(
            it[start] >= high or it[end] <= low
            for (start, end), (low, high) in (
                (ENDS["xyz".index(a)], walls(found, a)) for a in ("x", axis)
            )
        )
        keep_out(sheet, it, "x", axis, hatched=aside)
    _motor(sheet, found, measures)
    depth = "y_mm" if axis == "z" else "z_mm"
    shafts = sorted(found["shafts"], key=lambda s: s[depth], reverse=axis == "z")
    for shaft in shafts:  # the farthest first
        _shaft(sheet, found, shaft, axis, measures)
    heights = {s["shaft"]: s[f"{axis}_mm"] for s in shafts}
    across_dimension(sheet, found, "x", axis, measures)
    top = walls(found, axis)[1]
    face_widths(sheet, found, {gear["stage"]: top for gear in found["gears"]}, measures)
    right = sheet.at(walls(found, "x")[1], 0.0)[0]
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
        side_name(sheet, gear, heights[gear["shaft"]], gear["name"])
    if axis == "z":
        return sheet.drawing("side view", "Side view, x to the right and z up.")
    return sheet.drawing("top view", "Top view, x to the right and y up.")


def _shaft(sheet: Sheet, found: Layout, shaft: Layout, axis: str, measures: Measures) -> None:
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
    gears_on(sheet, found, shaft, height, measures)


def gears_on(sheet: Sheet, found: Layout, shaft: Layout, height: float, measures: Measures) -> None:
    """The gears of a shaft as rectangles, and its centre line."""
    for gear in found["gears"]:
        if gear["shaft"] == shaft["shaft"]:
            half = 0.5 * gear["tip_diameter_mm"]
            a, b = (gear["from_mm"], height - half), (gear["to_mm"], height + half)
            sheet.rectangle(a, b, "tip", series(gear["stage"]), meaning(gear, measures))
            for z in (-0.5, 0.5):
                level = height + z * gear["reference_diameter_mm"]
                sheet.line((a[0], level), (b[0], level), "reference", series(gear["stage"]))
    past = 6.0 / sheet.scale
    sheet.line((shaft["from_mm"] - past, height), (shaft["to_mm"] + past, height), "axis")


def _motor(sheet: Sheet, found: Layout, measures: Measures) -> None:
    if (told := motor(found)) is None:
        return
    r, start, end = told
    sheet.rectangle((start, -r), (end, r), "motor", title="motor", round_=6.0)
    sheet.line((start, 0.0), (end, 0.0), "axis")
    x, y = sheet.at((start + end) / 2, 0.0)
    wide, long = (f"{measures.of(v, 'mm'):.4g}" for v in (2 * r, end - start))
    text = f"motor ⌀ {wide}" + (f" x {long}" if "length_mm" in found["motor"] else "")
    sheet.label(text, [Place(x, y - 12.0), Place(x, y + 12.0)], "obstacle")


def face_widths(sheet: Sheet, found: Layout, tops: Mapping[int, float], measures: Measures) -> None:
    """Face widths above all that is drawn; tops: where the lines to them begin, by stage [mm]."""
    wheels = {g["stage"]: g for g in found["gears"] if g["member"] == "wheel"}
    for slab in found["slabs"]:
        for stage in slab:
            if stage not in wheels:
                continue
            a, b = ((wheels[stage][key], tops[stage]) for key in ("from_mm", "to_mm"))
            (x0, wall), (x1, _) = sheet.at(*a), sheet.at(*b)
            for x in (x0, x1):
                sheet.tick((x, wall), (x, LEVEL - 4.0))
            sheet.arrows((x0, LEVEL), (x1, LEVEL))
            wide = wheels[stage]["to_mm"] - wheels[stage]["from_mm"]
            text = f"b{stage} {measures.length(wide, 1)}"
            levels = [Place((x0 + x1) / 2, LEVEL - up, 0.0, up / 10) for up in (9.0, 24.0)]
            sheet.label(text, levels, "size")


def side_name(sheet: Sheet, gear: Layout, height: float, text: str) -> None:
    """What a gear is called in its rectangle, level or upright, else beside it."""
    r = 0.5 * gear["tip_diameter_mm"] * sheet.scale
    wide = (gear["to_mm"] - gear["from_mm"]) * sheet.scale
    x, y = sheet.at(0.5 * (gear["from_mm"] + gear["to_mm"]), height)
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
    sheet.label(text, places, "name", series(gear["stage"]))
