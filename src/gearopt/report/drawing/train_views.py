"""A train without a layout, drawn to scale with all its shafts in one line, or folded."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields, replace
from itertools import pairwise
from typing import Any

from gearopt.formulations.drive.layout.layout_design import GearDesign, ShaftDesign
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.physics.gears import MEMBERS
from gearopt.report.drawing.bodies import Bodies, meaning
from gearopt.report.drawing.layout_views import (
    LEVEL,
    face_widths,
    gear_circles,
    gear_names,
    gears_on,
    side_name,
)
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window, series
from gearopt.report.measures import Measures
from gearopt.report.section import Section
from gearopt.report.words import number

WIDE = 640.0  # widest drawing [px], as those of a layout
BESIDE = 340.0  # px of the longest of several trains: three stand beside each other
EDGE = 20.0  # px kept free left and right of the front view
PITCH = 76.0  # px from stage to stage along the shafts, at least: its face width and module fit
STAGE_GAP = 16.0  # px between the gears of two stages, at least
ROWS, ROW = 3, 15.0  # of centre distances that do not fit above their line; px between them
LOW, NAMES = 100.0, 46.0  # px: circles of radii below the one leave names the other above, below
CHAIN = 30.0  # px from the lowest circle to the dimensions of the centre distances
MODULES = 26.0  # px from the face widths up to the modules: two lines that keep apart
SIDE = (24.0, 44.0, 24.0, 60.0)  # px kept free around the side view
MAX_STAGES = 100  # in one line; a drive has six at most


@dataclass(frozen=True)
class DrawnStage:
    """Dimensions of a stage that are drawn, by the keys of a result."""

    normal_module_mm: float
    pinion_teeth: float
    wheel_teeth: float
    face_width_mm: float
    pinion_diameter_mm: float
    wheel_diameter_mm: float
    pinion_tip_diameter_mm: float
    wheel_tip_diameter_mm: float
    centre_distance_mm: float
    pinion_face_width_mm: float | None = None
    wheel_face_width_mm: float | None = None
    driver: str = "pinion"
    idler: bool = False  # the pinion is the wheel of the stage before

    @property
    def members(self) -> tuple[str, ...]:
        """The gear that drives and the one that is driven."""
        return MEMBERS if self.driver == "pinion" else MEMBERS[::-1]

    def width(self, member: str) -> float:
        """Face width [mm] of a gear."""
        return getattr(self, f"{member}_face_width_mm") or self.face_width_mm


def section(result: Result, measures: Measures, hint: str = "") -> Section | None:
    """Draw both views at one scale; None without gears or where they are laid out.

    hint: what a file may ask for beside.
    """
    drawn = views(result.design.get("stages", ()), measures)
    if not drawn or result.design.get("layout"):
        return None
    name, sign, unit = measures.module
    webs = [circles(s, m) for s in result.design["stages"] for m in MEMBERS]
    inside = ", thin ones the insides of rims, hubs and bores" if any(webs) else ""
    folded, single = is_folded(_picked(result.design["stages"])), len(result.design["stages"]) == 1
    lie = ", the output in line with the input, as both stages have one distance" * folded
    gaps = ", and the gaps between the stages are only as wide as the labels need" * (not single)
    unfolded = "not of this drawing but of all shafts in one line, " if folded else "that "
    total = f"{unfolded}over reference circles"
    plural = f"modules {sign} in {unit}" if unit == "mm" else f"{name}es {sign} in {unit}"
    words = (
        f"{'Both' if single else 'All'} shafts are drawn in one plane{lie}: their positions are "
        f"not optimised{gaps}.{hint}",
        f"Drawn to one scale; dimensions in {measures.lengths}: centre distances, length over "
        f"tip circles (the total length of the design is {total}), face widths b; {plural}; teeth "
        f"z. Solid lines are tip circles, dash-dotted ones reference circles{inside}; numbers in "
        "circles name the shafts, which are not drawn.",
    )
    return Section("Gears with all shafts in one plane", words=words, drawings=drawn)


def beside(
    designs: Mapping[str, Sequence[Mapping[str, Any]]], measures: Measures
) -> tuple[Drawing, ...]:
    """Draw trains along their shafts, all at one scale; designs: stages by what they are called."""
    rows = {name: _in_plane(_picked(stages))[0] for name, stages in designs.items()}
    ends = [_ends(train) for train in rows.values()]
    scale = (BESIDE - 2.0 * EDGE) / max(right - left for left, right in ends)

    def title(gear: GearDesign) -> str:
        return meaning(gear, measures)

    return tuple(
        replace(
            view_along_shafts(train, scale, measures.length, title), caption=f"{name.capitalize()}."
        )
        for name, train in rows.items()
    )


def _picked(stages: Sequence[Mapping[str, Any]]) -> Sequence[DrawnStage]:
    """Sizes of stages that are drawn; KeyError where one is not known."""
    names = [f.name for f in fields(DrawnStage)]
    picked = [{n: stage[n] for n in names if n in stage} for stage in stages]
    drawn: Sequence[DrawnStage] = typed(tuple[DrawnStage, ...], picked, "stages")
    return drawn


def is_drawn(stages: Sequence[Mapping[str, Any]]) -> bool:
    """Whether there are stages, and all sizes that are drawn of them."""
    keys = [f.name for f in fields(DrawnStage) if f.default is MISSING]
    plain = all(stage.get("type", "parallel") == "parallel" for stage in stages)
    return bool(stages) and plain and all(key in stage for stage in stages for key in keys)


def views(stages: Sequence[Mapping[str, Any]], measures: Measures) -> tuple[Drawing, ...]:
    """Draw a train along its shafts and across them; nothing where a size is not known."""
    if not is_drawn(stages):
        return ()
    train, scale = _in_plane(_picked(stages))
    inner = {g.name: circles(stages[g.stage - 1], g.member) for g in train.gears}
    front = view_along_shafts(train, scale, measures.length, lambda g: meaning(g, measures), inner)
    return front, _side(train, scale, measures)


def circles(stage: Mapping[str, Any], member: str) -> list[float]:
    """The diameters [mm] inside the rim, of the hub and of the bore, of what a gear has."""
    diameters = [stage.get(f"{member}_{name}_mm") for name in ("hub_diameter", "bore")]
    if stage.get(f"{member}_web_thickness_mm") is not None:
        rim: float = stage[f"{member}_rim_thickness_mm"]
        diameters = [stage[f"{member}_root_diameter_mm"] - 2.0 * rim, *diameters]
    return [diameter for diameter in diameters if diameter is not None]


def is_folded(stages: Sequence[DrawnStage]) -> bool:
    """Whether the output is drawn in line with the input: two stages of one centre distance."""
    distances = [stage.centre_distance_mm for stage in stages]
    return len(distances) == 2 and not stages[1].idler and math.isclose(*distances)


def _in_plane(stages: Sequence[DrawnStage]) -> tuple[Bodies, float]:
    """Shafts and gears in one plane, folded where they may be; and the scale [px/mm]."""
    return in_one_line(stages, is_folded(stages))


def in_one_line(stages: Sequence[DrawnStage], folded: bool = False) -> tuple[Bodies, float]:
    """Shafts and gears with every shaft at z = 0; and the scale [px/mm].

    folded: the second of two stages runs back. Diameters of shafts are 0: they are not known.
    ValueError for stages that cannot be drawn: more than MAX_STAGES, or of no finite size.
    """
    if len(stages) > MAX_STAGES:
        raise ValueError(f"{len(stages):,} stages cannot be drawn")
    axes = [0.0]
    for stage in stages:
        axes.append(axes[-1] + stage.centre_distance_mm)
    if folded:
        axes[2] = axes[0]
    rims = [
        (axes[k + end], 0.5 * getattr(stage, f"{member}_tip_diameter_mm"))
        for k, stage in enumerate(stages)
        for end, member in enumerate(stage.members)
    ]
    long = max(y + r for y, r in rims) - min(y - r for y, r in rims)
    scale = (WIDE - 2.0 * EDGE) / long  # no wheel is higher than the row is long
    if not 0.0 < scale < math.inf:
        raise ValueError(f"stages {long:g} mm long cannot be drawn")
    wide = [max(map(stage.width, MEMBERS)) for stage in stages]
    apart = [0.0 if stage.idler else width for stage, width in zip(stages, wide, strict=True)]
    scale, starts = _along(apart, scale)
    idlers = [k for k, stage in enumerate(stages, 1) if stage.idler]  # their shafts
    for k in idlers:
        starts[k - 1], wide[k - 1] = starts[k - 2], wide[k - 2]
    gears = [
        GearDesign(
            name=f"{'idler' if shaft in idlers else member} {k}",
            stage=k,
            member=member,
            shaft=shaft,
            teeth=getattr(stage, f"{member}_teeth"),
            normal_module_mm=stage.normal_module_mm,
            reference_diameter_mm=getattr(stage, f"{member}_diameter_mm"),
            tip_diameter_mm=getattr(stage, f"{member}_tip_diameter_mm"),
            root_diameter_mm=0.0,
            helix_angle_deg=0.0,
            from_mm=start + 0.5 * (wide[k - 1] - stage.width(member)),
            to_mm=start + 0.5 * (wide[k - 1] + stage.width(member)),
        )
        for k, (stage, start) in enumerate(zip(stages, starts, strict=True), 1)
        for shaft, member in list(enumerate(stage.members, k))[stage.idler :]
    ]
    shafts = []
    for k, y in enumerate(axes, 1):
        on = [g for g in gears if g.shaft == k]
        start, end = min(g.from_mm for g in on), max(g.to_mm for g in on)
        shafts.append(
            ShaftDesign(shaft=k, y_mm=y, z_mm=0.0, diameter_mm=0.0, from_mm=start, to_mm=end)
        )
    slabs = tuple((k,) for k, stage in enumerate(stages, 1) if not stage.idler)
    return Bodies(tuple(shafts), tuple(gears), slabs), scale


def _along(widths: Sequence[float], scale: float) -> tuple[float, list[float]]:
    """Start of each stage along the shafts [mm], and a scale at which all fit."""
    while True:
        rooms = [max(PITCH, scale * b + STAGE_GAP) for b in widths]
        if sum(rooms) <= WIDE - SIDE[0] - SIDE[1] or max(rooms) <= PITCH:  # no room to save
            break
        scale *= 0.98
    ends = [sum(rooms[:k]) for k in range(len(rooms))]
    middles = [(end + 0.5 * room) / scale for end, room in zip(ends, rooms, strict=True)]
    return scale, [middle - 0.5 * b for middle, b in zip(middles, widths, strict=True)]


def _ends(train: Bodies) -> tuple[float, float]:
    """The ends of the row of gears, over tip circles [mm]."""
    places = {s.shaft: s.y_mm for s in train.shafts}
    rims = [(places[g.shaft], 0.5 * g.tip_diameter_mm) for g in train.gears]
    return min(y - r for y, r in rims), max(y + r for y, r in rims)


def view_along_shafts(
    train: Bodies,
    scale: float,
    length: Callable[[float], str],
    title: Callable[[GearDesign], str],
    inner: Mapping[str, Sequence[float]] | None = None,
) -> Drawing:
    """Draw the view along the shafts: circles in a row, centre distances and length below.

    length: a length as it is written. title: what a gear says where the pointer rests. inner:
    diameters [mm] of circles inside the teeth, by the name of a gear.
    """
    left, right = _ends(train)
    high = max(0.5 * g.tip_diameter_mm for g in train.gears)
    if scale * high < LOW:
        high += NAMES / scale
    axes = sorted({s.y_mm for s in train.shafts})
    texts = [length(b - a) for a, b in pairwise(axes)]
    narrow = sum(
        scale * (b - a) < _room(text) for (a, b), text in zip(pairwise(axes), texts, strict=True)
    )
    below = CHAIN + min(narrow, ROWS) * ROW + 46.0
    sheet = Sheet(Window(left, right, -high, high, (EDGE, EDGE, below, 44.0)), scale)
    places = {s.shaft: (s.y_mm, 0.0) for s in train.shafts}
    gear_circles(sheet, train, places, title)
    for gear in train.gears:
        for diameter in (inner or {}).get(gear.name, ()):
            sheet.circle(*places[gear.shaft], 0.5 * diameter, "body", series(gear.stage))
    level = sheet.at(0.0, -high)[1] + CHAIN
    for y in axes:
        x = sheet.at(y, 0.0)[0]
        sheet.line((y, high + 16.0 / scale), (y, -high), "axis")
        sheet.tick((x, level - CHAIN), (x, level + 5.0))
        ways = (0.0, -12.0, 12.0, -24.0, 24.0)
        spots = [Place(x + dx, 16.0, 0.0, abs(dx), (x, 28.0)) for dx in ways]
        for shaft in (s for s in train.shafts if s.y_mm == y):
            sheet.balloon(str(shaft.shaft), spots)
    sheet.line((left - 6.0 / scale, 0.0), (right + 6.0 / scale, 0.0), "axis")
    away = sheet.height - 18.0 - sheet.at(0.0, -high)[1]
    sheet.dimension((left, -high), (right, -high), away, length(right - left))
    for (a, b), text in reversed(list(zip(pairwise(axes), texts, strict=True))):
        _distance(sheet, sheet.at(a, 0.0)[0], sheet.at(b, 0.0)[0], level, text)
    gear_names(sheet, train)
    return sheet.drawing("front view", "Front view, along the shafts.")


def _distance(sheet: Sheet, start: float, end: float, level: float, text: str) -> None:
    """Draw a centre distance between two px, its text above the line or in a row below."""
    sheet.arrows((start, level), (end, level))
    middle = 0.5 * (start + end)
    if _room(text) <= end - start:
        sheet.label(text, [Place(middle, level - 9.0)], "size")
        return
    rows = [
        Place(middle + dx, level + 14.0 + row * ROW, 0.0, 3.0 * row + abs(dx) / 4, (middle, level))
        for row in range(ROWS)
        for dx in (0.0, -10.0, 10.0, -20.0, 20.0, -30.0, 30.0)
    ]
    sheet.label(text, rows, "size")


def _room(text: str) -> float:
    """The length of a dimension line [px] that a text fits above."""
    return 2.0 * Place(0, 0).half_width(text) + 4.0


def _side(train: Bodies, scale: float, measures: Measures) -> Drawing:
    """Draw the view across the shafts: gears as rectangles, with face width and module."""
    (left, right), shafts = _ends(train), train.shafts
    places = {s.shaft: s.y_mm for s in shafts}
    long = sum(max(PITCH, scale * b + STAGE_GAP) for b in _widths(train)) / scale
    sheet = Sheet(Window(0.0, long, left, right, SIDE), scale)
    tops: dict[int, float] = {}
    for shaft in shafts:
        gears_on(sheet, train, shaft, shaft.y_mm, measures)
    for gear in train.gears:
        top = places[gear.shaft] + 0.5 * gear.tip_diameter_mm
        tops[gear.stage] = max(top, tops.get(gear.stage, top))
    for gear in (g for g in train.gears if g.member == "wheel" and (g.stage,) in train.slabs):
        x = sheet.at(0.5 * (gear.from_mm + gear.to_mm), 0.0)[0]
        module = measures.of_module(gear.normal_module_mm)
        sheet.label(f"{measures.module[1]} {number(module)}", [Place(x, LEVEL - MODULES)], "size")
    face_widths(sheet, train, tops, measures)
    for shaft in shafts:
        folded = any(s.y_mm == shaft.y_mm and s.shaft > shaft.shaft for s in shafts)
        end, beside = (shaft.from_mm, -20.0) if folded else (shaft.to_mm, 20.0)
        x, y = sheet.at(end, shaft.y_mm)
        spots = [Place(x + beside, y + dy, 0.0, abs(dy), (x, y)) for dy in (0.0, -14.0, 14.0)]
        sheet.balloon(str(shaft.shaft), spots)
    for gear in sorted(train.gears, key=lambda g: -g.tip_diameter_mm):
        side_name(sheet, gear, places[gear.shaft], f"z {number(gear.teeth)}")
    return sheet.drawing("side view", "Side view, across the shafts.")


def _widths(train: Bodies) -> list[float]:
    return [max(g.to_mm - g.from_mm for g in train.gears if g.stage == k) for (k,) in train.slabs]
