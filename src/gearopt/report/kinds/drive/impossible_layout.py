"""A layout that is impossible, drawn with its first remedy and what was asked over it."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.formulations.drive.layout.layout_design import KeepOutDesign, LayoutDesign
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.drawing.bodies import cropped_keep_outs, sides
from gearopt.report.drawing.layout_views import (
    HIGH,
    WIDE,
    front_view,
    side_view,
    walls,
    window_of,
)
from gearopt.report.drawing.sheet import Place, Sheet, around
from gearopt.report.measures import Measures
from gearopt.report.section import Section
from gearopt.report.words import edit

REACHED = 1e-6  # relative: a side that exceeds what is asked by less does not


@dataclass(frozen=True, kw_only=True)
class NearestLayout:
    """The layout with its first remedy, as a result holds it; fields are its keys."""

    layout: LayoutDesign
    keep_outs: tuple[KeepOutDesign, ...]
    motor_mm: float | None
    largest_mm: tuple[float | None, float | None, float | None]


def section(result: Result, measures: Measures) -> Section | None:
    """Draw the views that show what is asked and not kept; None where no layout is near."""
    data: Mapping[str, Any] = result.report.get("nearest_layout") or {}
    if not data:
        return None
    near: NearestLayout = typed(NearestLayout, data, "nearest_layout")
    layout = near.layout
    every = replace(layout, obstacles=(*layout.obstacles, *near.keep_outs))
    front, side = (window_of(every, axis) for axis in ("", "z"))
    scale = min(front.scale(WIDE, HIGH), side.scale(WIDE, HIGH))
    views = (
        front_view(layout, front, scale, measures, partial(_front, near, measures)),
        side_view(layout, side, scale, "z", measures, partial(_side, near, measures)),
    )
    first = result.report["ways_out"]["remedies"][0]["changes"]
    hatched = "; hatched boxes are keep-outs" if layout.obstacles else ""
    words = (
        f"Drawn with {' and '.join(map(edit, first))}; dashed, in brown: what was asked. One "
        f"scale; dimensions in {measures.lengths}{hatched}.",
    )
    return Section("Nearest layout", words=words, drawings=views)


def _over(near: NearestLayout) -> tuple[float | None, ...]:
    """The largest width, height and length that are asked, where they are exceeded."""
    return tuple(
        most if most is not None and there > most * (1.0 + REACHED) else None
        for most, there in zip(near.largest_mm, near.layout.box.sides, strict=True)
    )


def _front(near: NearestLayout, measures: Measures, sheet: Sheet) -> None:
    """Draw keep-outs, motor and sides of the box as they are asked, seen from front."""
    layout = near.layout
    for it in cropped_keep_outs(replace(layout, obstacles=near.keep_outs)):
        (y0, y1), (z0, z1) = sides(it, "y"), sides(it, "z")
        sheet.rectangle((y0, z0), (y1, z1), "asked", title=f"asked: keep-out {it.name}")
        x, y = sheet.at(0.5 * (y0 + y1), 0.5 * (z0 + z1))
        places = [Place(x + dx, y + dy) for dy in (0.0, -16.0, 16.0) for dx in (0.0, -60.0, 60.0)]
        sheet.label(f"asked: {it.name}", places, "gap")
    if near.motor_mm is not None:
        r = 0.5 * near.motor_mm
        sheet.circle(0.0, 0.0, r, "asked", title="asked: motor")
        sheet.label("asked: motor", around(sheet.at(0.0, 0.0), (sheet.scale * r + 12.0,)), "gap")
    wide, tall, _ = _over(near)
    if wide is None and tall is None:
        return
    (y0, y1), (z0, z1) = (walls(layout, axis) for axis in "yz")
    y1 = y1 if wide is None else y0 + wide
    z1 = z1 if tall is None else z0 + tall
    sheet.rectangle((y0, z0), (y1, z1), "asked", title="asked: box")
    sizes = (
        f"{name} {measures.length(v, 1)}" for name, v in (("width", wide), ("height", tall)) if v
    )
    x, y = sheet.at(0.5 * (y0 + y1), z1)
    places = [Place(x, y + dy, 0.0, abs(dy)) for dy in (-9.0, 12.0, 24.0, 40.0)]
    sheet.label(f"asked: {', '.join(sizes)}", places, "gap")


def _side(near: NearestLayout, measures: Measures, sheet: Sheet) -> None:
    """Draw the length of the box as it is asked, seen from the side."""
    *_, long = _over(near)
    if long is None:
        return
    low, high = walls(near.layout, "z")
    sheet.rectangle((0.0, low), (long, high), "asked", title="asked: length of the box")
    x, y = sheet.at(long, 0.5 * (low + high))
    places = [Place(x + dx, y, -90.0) for dx in (9.0, -9.0)]
    sheet.label(f"asked: {measures.length(long, 1)}", places, "gap")
