"""Where the named bodies of a layout are, and where two of them come closest, seen along x."""

import math
import re
from dataclasses import replace

from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.drive.layout.layout_design import (
    BearingDesign,
    GearDesign,
    KeepOutDesign,
    LayoutDesign,
    ShaftDesign,
)
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.report.drawing.sheet import Point
from gearopt.report.measures import Measures
from gearopt.report.words import module_words

Corner = tuple[float, float, float]  # x, y, z
KEEP_OUT_REACH = 0.12  # of the box's larger side: keep-outs are drawn so far beyond box and motor


@dataclass(frozen=True, kw_only=True)
class RingDesign(GearDesign):
    """A ring, its diameters above 0."""

    outside_diameter_mm: float


@dataclass(frozen=True)
class Plate:
    """A plate across a shaft that carries planets or a ring: its radius and ends along x [mm].

    sized: whether it is of the design.
    """

    stage: int
    shaft: int
    reach: float
    start: float
    end: float
    sized: bool = False


@dataclass(frozen=True)
class Bodies:
    """Shafts with their gears and bearings, and which stages stand side by side.

    Pins of planets are shafts whose numbers are below 0. plates: of carriers and rings.
    """

    shafts: tuple[ShaftDesign, ...]
    gears: tuple[GearDesign, ...]
    slabs: tuple[tuple[int, ...], ...]
    bearings: tuple[BearingDesign, ...] = ()
    plates: tuple[Plate, ...] = ()


def widest(gear: GearDesign) -> float:
    """The largest diameter of a gear [mm]."""
    return gear.outside_diameter_mm if isinstance(gear, RingDesign) else gear.tip_diameter_mm


Turning = Bodies | LayoutDesign  # what has shafts and gears


def layout_of(result: Result) -> LayoutDesign | None:
    """The layout of a drive, None where its gears are not laid out."""
    return drive_design(result.design).layout if result.design else None


def box_corners(layout: LayoutDesign) -> tuple[Corner, Corner]:
    """Two corners of the box."""
    box = layout.box
    y, z = box.left_mm, box.bottom_mm
    return (0.0, y, z), (box.length_mm, y + box.width_mm, z + box.height_mm)


def along(ends: tuple[Corner, Corner], axis: str) -> tuple[float, float]:
    """The ends of two corners along x, y or z."""
    k = "xyz".index(axis)
    return ends[0][k], ends[1][k]


def motor(layout: LayoutDesign) -> tuple[float, float, float] | None:
    """Radius, start and end of the motor, which is drawn as long as it is wide."""
    if layout.motor is None:
        return None
    size = layout.motor.diameter_mm
    start = layout.box.length_mm if _leaves_far(layout) else -size
    return 0.5 * size, start, start + size


def _leaves_far(layout: LayoutDesign) -> bool:
    """Whether the input shaft, else the output shaft, goes from a ring's disc to the far wall."""
    shafts, rings = layout.shafts, {g.stage: g for g in layout.gears if g.member == "ring"}
    for shaft, stage in ((shafts[0], 1), (shafts[-1], len(shafts) - 1)):
        if stage in rings:
            return bool(shaft.from_mm >= rings[stage].to_mm)
    return False


def sides(it: KeepOutDesign, axis: str) -> tuple[float, float]:
    """Both ends of a keep-out along x, y or z [mm]."""
    if axis == "x":
        return it.from_mm, it.to_mm
    return (it.left_mm, it.right_mm) if axis == "y" else (it.bottom_mm, it.top_mm)


def cropped_keep_outs(layout: LayoutDesign) -> list[KeepOutDesign]:
    """The keep-outs near the box, cut off where they reach far beyond it."""
    low, high = _with_motor(layout)
    room = KEEP_OUT_REACH * max(b - a for a, b in zip(low[1:], high[1:], strict=True))
    near = []
    for it in layout.obstacles:
        cut = replace(
            it,
            from_mm=max(it.from_mm, low[0] - room),
            to_mm=min(it.to_mm, high[0] + room),
            left_mm=max(it.left_mm, low[1] - room),
            right_mm=min(it.right_mm, high[1] + room),
            bottom_mm=max(it.bottom_mm, low[2] - room),
            top_mm=min(it.top_mm, high[2] + room),
        )
        if all(start < end for start, end in (sides(cut, axis) for axis in "xyz")):
            near.append(cut)
    return near


def drawn_corners(layout: LayoutDesign) -> tuple[Corner, Corner]:
    """Two corners of all that is drawn."""
    low, high = (list(corner) for corner in _with_motor(layout))
    for it in cropped_keep_outs(layout):
        for k, axis in enumerate("xyz"):
            start, end = sides(it, axis)
            low[k], high[k] = min(low[k], start), max(high[k], end)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _with_motor(layout: LayoutDesign) -> tuple[Corner, Corner]:
    low, high = box_corners(layout)
    if (place := motor(layout)) is None:
        return low, high
    r, start, end = place
    low = (min(low[0], start), min(low[1], -r), min(low[2], -r))
    return low, (max(high[0], end), max(high[1], r), max(high[2], r))


@dataclass(frozen=True)
class Disc:
    """A round body: centre (y, z), radius, ends along x [mm]."""

    centre: Point
    radius: float
    start: float
    end: float


def meaning(gear: GearDesign, measures: Measures) -> str:
    """Describe a gear in a line, as drawings do where the pointer rests."""
    unit = measures.unit("mm")
    if gear.member == "ring":
        return (
            f"{gear.name}: outside diameter {measures.length(gear.tip_diameter_mm)} {unit}, "
            f"b {measures.length(gear.to_mm - gear.from_mm)} {unit}"
        )
    module = module_words(gear.normal_module_mm, measures)
    shift = ""
    if gear.profile_shift:
        shift = f"profile shift coefficient {gear.profile_shift:.4g}, "
    return (
        f"{gear.name}: {gear.teeth:.6g} teeth, {module}, {shift}"
        f"d {measures.length(gear.reference_diameter_mm)} {unit}, "
        f"d_a {measures.length(gear.tip_diameter_mm)} {unit}, "
        f"b {measures.length(gear.to_mm - gear.from_mm)} {unit}"
    )


def gear_disc(train: Turning, gear: GearDesign) -> Disc:
    """The tip circle of a gear."""
    shaft = next(s for s in train.shafts if s.shaft == gear.shaft)
    return Disc((shaft.y_mm, shaft.z_mm), 0.5 * gear.tip_diameter_mm, gear.from_mm, gear.to_mm)


def disc(layout: LayoutDesign, name: str, beside: KeepOutDesign | None = None) -> Disc | None:
    """A gear (its tip circle), shaft, bearing or the motor by name; None for others.

    "shaft 2 with its gears" is the largest body there of those that a keep-out stands beside.
    """
    if name == "motor" and (place := motor(layout)) is not None:
        return Disc((0.0, 0.0), *place)
    match = re.fullmatch(r"(?:bearing of )?shaft (\d+)( with its gears)?", name)
    number = int(match[1]) if match else None
    for gear in layout.gears:
        number = gear.shaft if gear.name == name else number
    shaft = next((s for s in layout.shafts if s.shaft == number), None)
    if shaft is None:
        return None
    centre = shaft.y_mm, shaft.z_mm
    bodies: list[tuple[str, ShaftDesign | BearingDesign]] = [(f"shaft {number}", shaft)]
    bodies += [(f"bearing of shaft {number}", b) for b in layout.bearings if b.shaft == number]
    discs = [(label, Disc(centre, 0.5 * b.diameter_mm, b.from_mm, b.to_mm)) for label, b in bodies]
    discs += [(g.name, gear_disc(layout, g)) for g in layout.gears if g.shaft == number]
    if match and match[2]:
        meant = [body for _, body in discs if beside is None or _overlap(body, beside)]
    else:
        meant = [body for label, body in discs if label == name]
    return max(meant, key=lambda body: body.radius, default=None)


def _overlap(a: Disc, b: KeepOutDesign) -> bool:
    return min(a.end, b.to_mm) > max(a.start, b.from_mm)


def nearest(layout: LayoutDesign, text: str, other: str) -> tuple[Corner, Corner] | None:
    """The ends of the gap between two bodies, of one x; None where one is not found."""
    boxes = {it.name: it for it in layout.obstacles}
    if text in boxes:
        swapped = nearest(layout, other, text) if other not in boxes else None
        return None if swapped is None else (swapped[1], swapped[0])
    box = boxes.get(other)
    a = disc(layout, text, box)
    if a is None:
        return None
    if box is not None:
        y = min(max(a.centre[0], box.left_mm), box.right_mm)
        z = min(max(a.centre[1], box.bottom_mm), box.top_mm)
        b: Disc | None = Disc((y, z), 0.0, box.from_mm, box.to_mm)
    else:
        b = disc(layout, other)
    if b is None or (apart := math.dist(a.centre, b.centre)) < 1e-9:
        return None
    uy, uz = ((v - u) / apart for u, v in zip(a.centre, b.centre, strict=True))
    x = 0.5 * (max(a.start, b.start) + min(a.end, b.end))
    start = (x, a.centre[0] + a.radius * uy, a.centre[1] + a.radius * uz)
    return start, (x, b.centre[0] - b.radius * uy, b.centre[1] - b.radius * uz)
