"""A train without a layout, drawn to scale with all its shafts in one line, or folded."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields, replace
from itertools import pairwise
from typing import Any

from gearopt.formulations.drive.layout.layout_design import GearDesign, ShaftDesign
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.physics.gears import MEMBERS
from gearopt.report.drawing.bodies import Bodies, Plate, meaning, widest
from gearopt.report.drawing.drawn_stage import PINS, DrawnStage
from gearopt.report.drawing.layout_views import (
    LEVEL,
    face_widths,
    gear_circles,
    gear_names,
    gears_on,
    own_width,
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
SET = 400.0  # px of the largest ring, at most
NOT_SIZED = (
    " Rings are hatched where they are cut; of the planets those are seen whose axes lie in the "
    "plane of the shafts. {}ins of carriers, and plates that hold rings, are not of the design: "
    "they show what turns with which shaft."
)


def section(result: Result, measures: Measures) -> Section | None:
    """Draw both views at one scale; None without gears or where they are laid out."""
    drawn = views(result.design.get("stages", ()), measures)
    if not drawn or result.design.get("layout"):
        return None
    name, sign, unit = measures.module
    webs = [circles(s, m) for s in result.design["stages"] for m in MEMBERS]
    inside = ", thin ones the insides of rims, hubs and bores" if any(webs) else ""
    picked = _picked(result.design["stages"])
    folded, single = is_folded(picked), len(picked) == 1
    plates = "P" if all(s.carrier_width_mm for s in picked if s.is_set) else "Plates and p"
    rings = any(stage.type != "parallel" for stage in picked)
    lie = ", the output in line with the input, as both stages have one distance" * folded
    gaps = ", and the gaps between the stages are only as wide as the labels need" * (not single)
    unfolded = "not of this drawing but of all shafts in one line, " if folded else "that "
    total = f" (the total length of the design is {unfolded}over reference circles)"
    total = ", outside diameters of rings" if rings else total
    plural = f"modules {sign} in {unit}" if unit == "mm" else f"{name}es {sign} in {unit}"
    plane = f"shafts are drawn in one plane{lie}: their positions are not optimised{gaps}."
    of_one_axis = single and picked[0].is_set
    words = (
        *([] if of_one_axis else [f"{'Both' if single else 'All'} {plane}"]),
        f"Drawn to one scale; dimensions in {measures.lengths}: centre distances, length over "
        f"tip circles{total}, face widths b; {plural}; teeth z. Solid lines are tip circles, "
        f"dash-dotted ones reference circles{inside}; numbers in circles name the shafts, which "
        f"are not drawn.{NOT_SIZED.format(plates) * rings}",
    )
    heading = "Gears on their axis" if of_one_axis else "Gears with all shafts in one plane"
    return Section(heading, words=words, drawings=drawn, to_scale=True)


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
    of_rings = all(
        s.get("type", "parallel") == "parallel" or s.get("ring_outside_diameter_mm") for s in stages
    )
    return bool(stages) and of_rings and all(key in stage for stage in stages for key in keys)


def views(stages: Sequence[Mapping[str, Any]], measures: Measures) -> tuple[Drawing, ...]:
    """Draw a train along its shafts and across them; nothing where a size is not known."""
    if not is_drawn(stages):
        return ()
    picked = _picked(stages)
    train, scale = _in_plane(picked)
    inner = {g.name: circles(stages[g.stage - 1], g.member) for g in train.gears}
    fronts = []
    for numbers in _seen_together(picked):
        part = _part(train, numbers)
        front = view_along_shafts(
            part, scale, measures.length, lambda g: meaning(g, measures), inner
        )
        if len(numbers) < len(stages) or picked[numbers[0] - 1].is_set:
            front = replace(front, caption=_caption(picked, numbers))
        fronts.append(front)
    return *fronts, _side(train, scale, measures)


def bodies(stages: Sequence[Mapping[str, Any]]) -> Bodies | None:
    """Shafts and gears of a train as it is drawn; None where a size is not known."""
    return _in_plane(_picked(stages))[0] if is_drawn(stages) else None


def _seen_together(stages: Sequence[DrawnStage]) -> list[list[int]]:
    """Numbers of stages, from 1, that one view along the shafts shows: each set alone."""
    groups: list[list[int]] = []
    for k, stage in enumerate(stages, 1):
        if not groups or stage.is_set or stages[k - 2].is_set:
            groups.append([])
        groups[-1].append(k)
    return groups


def _part(train: Bodies, numbers: Sequence[int]) -> Bodies:
    """What belongs to some stages."""
    gears = tuple(g for g in train.gears if g.stage in numbers)
    plates = tuple(p for p in train.plates if p.stage in numbers)
    on = {gear.shaft for gear in gears} | {plate.shaft for plate in plates}
    shafts = tuple(s for s in train.shafts if s.shaft in on)
    return replace(train, shafts=shafts, gears=gears, plates=plates)


def _caption(stages: Sequence[DrawnStage], numbers: Sequence[int]) -> str:
    """What a view of some stages of several shows."""
    named = f"Stage {numbers[0]}" if len(numbers) == 1 else f"Stages {numbers[0]} to {numbers[-1]}"
    stage = stages[numbers[0] - 1]
    words = f"; {stage.planets} planets, the {stage.fixed} is held" if stage.is_set else ""
    return f"{named}, front view along the shafts{words}."


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
    plain = len(stages) == 2 and not stages[1].idler
    return plain and not any(s.is_set for s in stages) and math.isclose(*distances)


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
        axes.append(axes[-1] + stage.offset)
    if folded:
        axes[2] = axes[0]
    rims = [
        (axes[k + end], 0.5 * diameter)
        for k, stage in enumerate(stages)
        for end, diameter in enumerate(stage.largest)
    ]
    long = max(y + r for y, r in rims) - min(y - r for y, r in rims)
    scale = (WIDE - 2.0 * EDGE) / long  # no wheel is higher than the row is long
    sets = [stage.largest[0] for stage in stages if stage.is_set]
    scale = min(scale, SET / max(sets)) if sets else scale
    if not 0.0 < scale < math.inf:
        raise ValueError(f"stages {long:g} mm long cannot be drawn")
    wide = [stage.room for stage in stages]
    apart = [0.0 if stage.idler else width for stage, width in zip(stages, wide, strict=True)]
    scale, starts = _along(apart, scale)
    idlers = [k for k, stage in enumerate(stages, 1) if stage.idler]  # their shafts
    for k in idlers:
        starts[k - 1], wide[k - 1] = starts[k - 2], wide[k - 2]
    gears: list[GearDesign] = []
    pins: list[ShaftDesign] = []
    plates: list[Plate] = []
    for k, (stage, start) in enumerate(zip(stages, starts, strict=True), 1):
        middle = start + 0.5 * wide[k - 1]
        gears += stage.gears(k, middle, idlers)
        pins += stage.pins(k, middle, axes[k - 1])
        plates += stage.plates(k, middle, scale)
    shafts = []
    for k, y in enumerate(axes, 1):
        on = [(g.from_mm, g.to_mm) for g in gears if g.shaft == k]
        on += [(p.start, p.end) for p in plates if p.shaft == k]
        start, end = min(a for a, _ in on), max(b for _, b in on)
        shafts.append(
            ShaftDesign(shaft=k, y_mm=y, z_mm=0.0, diameter_mm=0.0, from_mm=start, to_mm=end)
        )
    slabs = tuple((k,) for k, stage in enumerate(stages, 1) if not stage.idler)
    return Bodies((*shafts, *pins), tuple(gears), slabs, plates=tuple(plates)), scale


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
    """The ends of the row of gears, over tip circles and rings [mm]."""
    places = {s.shaft: s.y_mm for s in train.shafts}
    rims = [(places[g.shaft], 0.5 * widest(g)) for g in train.gears]
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
    high = max(0.5 * widest(g) for g in train.gears)
    if scale * high < LOW:
        high += NAMES / scale
    shafts = [s for s in train.shafts if s.shaft > 0]
    axes = sorted({s.y_mm for s in shafts})
    texts = [length(b - a) for a, b in pairwise(axes)]
    narrow = sum(
        scale * (b - a) < _room(text) for (a, b), text in zip(pairwise(axes), texts, strict=True)
    )
    below = CHAIN + min(narrow, ROWS) * ROW + 46.0
    sheet = Sheet(Window(left, right, -high, high, (EDGE, EDGE, below, 44.0)), scale)
    places = {s.shaft: (s.y_mm, s.z_mm) for s in train.shafts}
    gear_circles(sheet, train, places, title)
    for gear in train.gears:
        for diameter in (inner or {}).get(gear.name, ()):
            sheet.circle(*places[gear.shaft], 0.5 * diameter, "body", series(gear.stage))
    pins = [s for s in train.shafts if s.shaft < 0]
    for sun in (gear for gear in train.gears if gear.name.startswith("sun ")):
        at, pin = places[sun.shaft], next(s for s in pins if -s.shaft // PINS == sun.stage)
        sheet.circle(*at, math.dist(at, (pin.y_mm, pin.z_mm)), "centres")
    for pin in pins:
        sheet.circle(pin.y_mm, pin.z_mm, 0.5 * pin.diameter_mm, "shaft", title="pin")
        sheet.cross(pin.y_mm, pin.z_mm, 0.5 * pin.diameter_mm)
    level = sheet.at(0.0, -high)[1] + CHAIN
    for y in axes:
        x = sheet.at(y, 0.0)[0]
        sheet.line((y, high + 16.0 / scale), (y, -high), "axis")
        sheet.tick((x, level - CHAIN), (x, level + 5.0))
        ways = (0.0, -12.0, 12.0, -24.0, 24.0)
        spots = [Place(x + dx, 16.0, 0.0, abs(dx), (x, 28.0)) for dx in ways]
        for shaft in (s for s in shafts if s.y_mm == y):
            sheet.balloon(str(shaft.shaft), spots)
    sheet.line((left - 6.0 / scale, 0.0), (right + 6.0 / scale, 0.0), "axis")
    away = sheet.height - 18.0 - sheet.at(0.0, -high)[1]
    sign = "⌀ " if len(axes) == 1 else ""
    sheet.dimension((left, -high), (right, -high), away, f"{sign}{length(right - left)}")
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
    (left, right), shafts = _ends(train), [s for s in train.shafts if s.z_mm == 0.0]
    places = {s.shaft: s.y_mm for s in shafts}
    long = sum(max(PITCH, scale * b + STAGE_GAP) for b in _widths(train)) / scale
    sheet = Sheet(Window(0.0, long, left, right, SIDE), scale)
    tops: dict[int, float] = {}
    for plate in train.plates:
        y = places[plate.shaft]
        a, b = (plate.start, y - plate.reach), (plate.end, y + plate.reach)
        sheet.rectangle(a, b, "shaft", title=f"plate of stage {plate.stage}")
    for shaft in shafts:
        gears_on(sheet, train, shaft, shaft.y_mm, measures)
        if shaft.shaft < 0:
            half = 0.5 * shaft.diameter_mm
            a, b = (shaft.from_mm, shaft.y_mm - half), (shaft.to_mm, shaft.y_mm + half)
            sheet.rectangle(a, b, "shaft", title="pin")
    seen = [gear for gear in train.gears if gear.shaft in places]
    for gear in seen:
        top = places[gear.shaft] + 0.5 * widest(gear)
        tops[gear.stage] = max(top, tops.get(gear.stage, top))
    wheels = {g.stage: g for g in seen if g.member != "pinion" and (g.stage,) in train.slabs}
    for gear in wheels.values():
        x = sheet.at(0.5 * (gear.from_mm + gear.to_mm), 0.0)[0]
        module = measures.of_module(gear.normal_module_mm)
        sheet.label(f"{measures.module[1]} {number(module)}", [Place(x, LEVEL - MODULES)], "size")
    face_widths(sheet, train, tops, measures)
    for shaft in (s for s in shafts if s.shaft > 0):
        _numbered(sheet, train, shaft)
    for gear in sorted(seen, key=lambda g: -g.tip_diameter_mm):
        called = "" if gear.member in MEMBERS and not train.plates else f"{gear.name.split()[0]} "
        text = f"{called}z {number(gear.teeth)}{own_width(train, gear, measures)}"
        side_name(sheet, gear, places[gear.shaft], text)
    return sheet.drawing("side view", "Side view, across the shafts.")


def _numbered(sheet: Sheet, train: Bodies, shaft: ShaftDesign) -> None:
    """Write the number of a shaft at its end, or between the stages where others are in line."""
    k, sets = shaft.shaft, {-pin.shaft // PINS for pin in train.shafts if pin.shaft < 0}
    others = [s for s in train.shafts if s.y_mm == shaft.y_mm and s.shaft > 0 and s != shaft]
    folded = any(s.shaft > k for s in others)
    end, beside = (shaft.from_mm, -20.0) if folded else (shaft.to_mm, 20.0)
    if others and sets & {k - 1, k}:
        before = max((g.to_mm for g in train.gears if g.stage == k - 1), default=None)
        after = min((g.from_mm for g in train.gears if g.stage == k), default=None)
        if before is not None and after is not None:
            end, beside = 0.5 * (before + after), 0.0
    x, y = sheet.at(end, shaft.y_mm)
    ways = [(dy, (x, y) if beside or dy else None) for dy in (0.0, -14.0, 14.0)]
    spots = [Place(x + beside, y + dy, 0.0, abs(dy), leader) for dy, leader in ways]
    sheet.balloon(str(shaft.shaft), spots)


def _widths(train: Bodies) -> list[float]:
    wide = []
    for (k,) in train.slabs:
        ends = [(g.from_mm, g.to_mm) for g in train.gears if g.stage == k]
        ends += [(p.start, p.end) for p in train.plates if p.stage == k and p.sized]
        wide.append(max(b for _, b in ends) - min(a for a, _ in ends))
    return wide
