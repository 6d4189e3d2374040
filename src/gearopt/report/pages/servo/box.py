"""The train in its box, seen along the shafts: motor, first wheel, the sector and where it sweeps.

Both angles of a layout turn about axes along the shafts; the box is drawn about the middle of what
the train needs.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.labels import Place, around
from gearopt.report.pages.layout_front import centre_distance
from gearopt.report.pages.servo.sector import label_sector, sector
from gearopt.report.pages.sheet import Drawing, Point, Sheet, Window
from gearopt.report.section import Section
from gearopt.report.servo_words import box_words

WIDE, HIGH = 640.0, 760.0  # largest drawing [px]
FREE = (56.0, 56.0, 52.0, 52.0)  # px around it, for dimensions
FIRST, LAST = "--series-1", "--series-2"  # colours of both stages


@dataclass(frozen=True)
class Axes:
    """Where the shafts are, with the output at (0, 0), and what the train reaches; all in mm."""

    motor: Point
    middle: Point
    left: float
    right: float
    bottom: float
    top: float


def section(result: Result, measures: Measures) -> Section | None:
    """The drawing, and in words whether the train fits; None where no box is asked for."""
    box = result.design.get("box")
    if not box:
        return None
    words = [
        box_words(box, measures),
        f"Drawn to scale, dimensions in {measures.lengths}. Heavy: the box inside; thin dashed: "
        "the room that the train needs, which may be anywhere in it. Numbers in circles are "
        "shafts: 1 motor, 2 middle, 3 output. The last wheel is in a plane with pinion 2: motor "
        "and wheel 1 may lie over it, but not over the output shaft with its hub.",
    ]
    drawing = _drawing(box, result.design.get("train"), measures)
    return Section("In the box", words=words, drawings=(drawing,), half="train" in result.design)


def axes(box: Mapping[str, Any]) -> Axes:
    """Places of the shafts, and how far the train reaches to every side, as `servo_box` has it."""
    motor, output = (math.radians(box[f"{k}_angle_deg"]) for k in ("motor", "output"))
    a, b = box["links_mm"]
    r1, r2, r4 = box["radii_mm"]
    half = math.radians(box["half_sweep_deg"])
    middle = (b * math.cos(output), b * math.sin(output))
    first = (middle[0] + a * math.cos(motor), middle[1] + a * math.sin(motor))
    sides = []
    for turn in (0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi):
        ux, uy = math.cos(turn), math.sin(turn)
        off = abs((output - turn + math.pi) % (2.0 * math.pi) - math.pi)
        swept = r4 if off <= half else r4 * math.cos(off - half)
        discs = ((middle, r2), (first, r1))
        reach = [x * ux + y * uy + r for (x, y), r in discs]
        sides.append(max(swept, box["hub_mm"], *reach))
    right, top, left, bottom = sides
    return Axes(first, middle, -left, right, -bottom, top)


def _drawing(box: Mapping[str, Any], train: Any, measures: Measures) -> Drawing:
    at = axes(box)
    x, y = 0.5 * (at.left + at.right), 0.5 * (at.bottom + at.top)
    width, height = box["inner_width_mm"], box["inner_height_mm"]
    inner = (x - width / 2, y - height / 2), (x + width / 2, y + height / 2)
    window = Window(
        min(at.left, inner[0][0]),
        max(at.right, inner[1][0]),
        min(at.bottom, inner[0][1]),
        max(at.top, inner[1][1]),
        FREE,
    )
    sheet = Sheet(window, window.scale(WIDE, HIGH))
    sheet.rectangle(*inner, "box", title="box, inside")
    needed = (at.left, at.bottom), (at.right, at.top)
    sheet.rectangle(*needed, "wall", title="needed room")
    sector(sheet, box, train, LAST, measures)
    _discs(sheet, box, train, at, measures)
    _sizes(sheet, inner, needed, window, measures)
    a, b = box["links_mm"]
    centre_distance(sheet, at.motor, at.middle, f"a1 = {measures.length(a)}")
    centre_distance(sheet, at.middle, (0.0, 0.0), f"a2 = {measures.length(b)}")
    for number, place in enumerate((at.motor, at.middle, (0.0, 0.0)), 1):
        sheet.balloon(str(number), around(sheet.at(*place), (26.0, 36.0, 50.0, 66.0), 0.0))
    for name, place, radius, colour in (
        ("motor", at.motor, box["motor_mm"], ""),
        ("hub", (0.0, 0.0), box["hub_mm"], ""),
        ("wheel 1", at.middle, wheel_1(box, train), FIRST),
    ):
        _name(sheet, name, place, radius, colour)
    discs = [(at.motor, box["radii_mm"][0]), (at.middle, box["radii_mm"][1])]
    label_sector(sheet, box, LAST, discs)
    caption = "Along the shafts" + ("; a mirror image fits as well." if box["fits"] else ".")
    return sheet.drawing("the train in its box", caption)


def _discs(sheet: Sheet, box: Mapping[str, Any], train: Any, at: Axes, measures: Measures) -> None:
    """Wheel 1, motor, hub and middle shaft, and the pinions on the first two shafts."""
    unit, hub = measures.unit("mm"), box["hub_mm"]

    def circle(place: Point, radius: float, style: str, told: str, colour: str = "") -> None:
        title = f"{told}: radius {measures.length(radius)} {unit}"
        sheet.circle(*place, radius, style, colour, title)

    circle(at.middle, wheel_1(box, train), "tip", "wheel 1", FIRST)
    circle(at.motor, box["motor_mm"], "motor", "motor")
    if hub > 0.0:
        circle((0.0, 0.0), hub, "shaft", "output shaft with hub")
    for stage, place, colour in zip(
        (train or {}).get("stages", ()), (at.motor, at.middle), (FIRST, LAST), strict=False
    ):
        tip = 0.5 * stage["pinion_tip_diameter_mm"]
        circle(place, tip, "tip", f"pinion, z {stage['pinion_teeth']}, tip", colour)
    if box["shaft_mm"] > 0.0:
        circle(at.middle, box["shaft_mm"], "shaft", "shaft between the stages")
    for place, radius in zip(
        (at.motor, at.middle, (0.0, 0.0)), (*box["radii_mm"][:2], hub), strict=True
    ):
        sheet.cross(*place, radius)


def wheel_1(box: Mapping[str, Any], train: Any) -> float:
    """Tip radius of wheel 1 [mm]; pinion 2 may be the larger one on its shaft."""
    if not train:
        return float(box["radii_mm"][1])
    return 0.5 * float(train["stages"][0]["wheel_tip_diameter_mm"])


def _sizes(
    sheet: Sheet,
    inner: tuple[Point, Point],
    needed: tuple[Point, Point],
    window: Window,
    measures: Measures,
) -> None:
    """Of the box below and on the left, of the needed room above and on the right."""
    (x0, y0), (x1, y1) = inner
    below = sheet.height - 20.0 - sheet.at(0.0, y0)[1]
    sheet.dimension((x0, y0), (x1, y0), below, measures.length(x1 - x0))
    sheet.dimension((x0, y0), (x0, y1), sheet.at(x0, 0.0)[0] - 22.0, measures.length(y1 - y0))
    (x0, y0), (x1, y1) = needed
    above = 30.0 - sheet.at(0.0, y1)[1]
    sheet.dimension((x0, y1), (x1, y1), above, measures.length(x1 - x0))
    right = sheet.at(x1, 0.0)[0] - (sheet.width - 22.0)
    sheet.dimension((x1, y0), (x1, y1), right, measures.length(y1 - y0))


def _name(sheet: Sheet, name: str, at: Point, radius: float, colour: str) -> None:
    """A name inside its disc, or outside with a line to it."""
    centre, r = sheet.at(*at), radius * sheet.scale
    half = Place(0, 0).half_width(name)
    inside = around(centre, [share * r for share in (0.55, 0.7) if share * r > 18.0])
    inside = [p for p in inside if math.dist((p.x, p.y), centre) + 0.8 * half < r]
    outside = around(centre, (r + half + 6.0, r + half + 22.0), r, 20.0)
    sheet.label(name, inside + outside, "name" if colour else "obstacle", colour)
