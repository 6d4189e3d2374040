"""A gearbox layout in three dimensions: toothed gears in mesh, shafts, housing, keep-outs."""

import math
from collections.abc import Mapping
from dataclasses import replace
from html import escape
from typing import Any

from gearopt.formulations.drive.layout.layout_design import GearDesign, LayoutDesign, ShaftDesign
from gearopt.optimise.result import Result
from gearopt.physics.gears import ISO_53_A
from gearopt.report.drawing.bodies import (
    box_corners,
    cropped_keep_outs,
    drawn_corners,
    layout_of,
    meaning,
    motor,
    nearest,
    sides,
)
from gearopt.report.drawing.sheet import Drawing, series
from gearopt.report.drawing.solid import (
    TURN,
    Mesh,
    Toothed,
    block,
    drawn_teeth,
    edges,
    gear_mesh,
    line_trace,
    mesh_trace,
    outline,
    rod,
    space,
    twist,
    undrawn,
)
from gearopt.report.drawing.still import Block, Body, Rod, Texts, sizes_of, still, view
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure
from gearopt.report.section import Section

# triangles of all gears together, for a page that turns smoothly without a GPU
MAX_TRIANGLES = 50_000
DETAIL = ((3, 0.12), (3, 0.3), (2, 0.6), (2, 10.0))  # points on a flank, twist a section [rad]
FLUSH = 0.003  # of the box: a shaft is drawn so much longer, to be seen where it ends in a face
CAPTION = (
    f"{TURN} Tooth numbers, diameters and helix angles are those of the design; teeth are "
    "cut by {}. Clearances, hidden at first: the space that other "
    "shafts leave around each gear, the limit inside the walls, and the smallest gap."
)

OWN_RACKS = "their own racks, with the profile shifts of the design"
ROUNDED = "Teeth are real numbers here: of each gear the nearest whole number is drawn."


def section(result: Result, measures: Measures) -> Section | None:
    """Draw the gearbox in space; None where there is no layout."""
    if (layout := layout_of(result)) is None:
        return None
    if why := undrawn(gear.teeth for gear in layout.gears if gear.member != "ring"):
        return Section("In three dimensions", words=(why,))
    seen = space(*drawn_corners(layout), measures)
    whole = all(gear.teeth == drawn_teeth(gear.teeth) for gear in layout.gears)
    words = CAPTION.format("the rack of ISO 53, profile A" if _standard(layout) else OWN_RACKS)
    words = words if whole else f"{words} {ROUNDED}"
    figure = Figure(_traces(layout, measures), seen, words, picture(layout, measures))
    return Section("In three dimensions", figures=(figure,), appendix=True)


def _standard(layout: LayoutDesign) -> bool:
    """Whether all teeth are unshifted ones of ISO 53, profile A."""
    gears = [gear.gear for gear in layout.gears]
    return all(g.rack == ISO_53_A and g.profile_shift == g.tip_alteration == 0.0 for g in gears)


def picture(layout: LayoutDesign, measures: Measures) -> Drawing:
    """Draw what the view in space begins with, its teeth in mesh, for print."""
    places = {s.shaft: (s.y_mm, s.z_mm) for s in layout.shafts}
    bodies: list[Body] = [_picture_of(layout, gear, places, measures) for gear in layout.gears]
    for it in layout.bearings:
        r, title = 0.5 * it.diameter_mm, f"bearing of shaft {it.shaft}"
        bodies.append(Rod(places[it.shaft], r, it.from_mm, it.to_mm, "metal", title=title))
    for shaft in layout.shafts:
        r, title = 0.5 * shaft.diameter_mm, f"shaft {shaft.shaft}"
        for start, end in _bare(layout, shaft):
            bodies.append(Rod(places[shaft.shaft], r, start, end, "metal", title=title))
    if place := motor(layout):
        bodies.append(Rod((0.0, 0.0), *place, "metal", title="motor"))
    for out in cropped_keep_outs(layout):
        low, high = zip(*(sides(out, axis) for axis in "xyz"), strict=True)
        bodies.append(Block(low, high, "blocked", out.name))
    legend = [(f"stage {k}", series(k)) for k in sorted({g.stage for g in layout.gears})]
    past = FLUSH * layout.box.length_mm
    ends = [((s.to_mm + past, s.y_mm, s.z_mm), str(s.shaft)) for s in layout.shafts]
    corners = box_corners(layout)
    texts = Texts(sizes_of(corners, "xyz", measures), legend, ends)
    return still(bodies, corners, view(), texts, "the gearbox in space")


def _picture_of(
    layout: LayoutDesign,
    gear: GearDesign,
    places: Mapping[int, tuple[float, float]],
    measures: Measures,
) -> Rod:
    """A gear with its teeth, as they are at its face on the side of the output; a ring's disc."""
    if gear.member == "ring":
        r, words, colour = 0.5 * gear.tip_diameter_mm, meaning(gear, measures), series(gear.stage)
        return Rod(places[gear.shaft], r, gear.from_mm, gear.to_mm, "gear", colour, words)
    solid, r = _toothed(layout, gear, places), 0.5 * gear.tip_diameter_mm
    turn = solid.phase + twist(solid.gear) * (gear.to_mm - solid.middle)
    rim = tuple((angle + turn, at) for angle, at in outline(solid.gear, 2))
    words, colour = meaning(gear, measures), series(gear.stage)
    return Rod(solid.centre, r, gear.from_mm, gear.to_mm, "gear", colour, words, rim)


def _bare(layout: LayoutDesign, shaft: ShaftDesign) -> list[tuple[float, float]]:
    """The parts of a shaft between what sits on it."""
    on = [(g.from_mm, g.to_mm) for g in layout.gears if g.shaft == shaft.shaft]
    on += [(b.from_mm, b.to_mm) for b in layout.bearings if b.shaft == shaft.shaft]
    past = FLUSH * layout.box.length_mm
    parts, start = [], shaft.from_mm - past
    for low, high in [*sorted(on), (shaft.to_mm + past, math.inf)]:
        if low > start:
            parts.append((start, low))
        start = max(start, high)
    return parts


def _traces(layout: LayoutDesign, measures: Measures) -> list[dict[str, Any]]:
    places = {s.shaft: (s.y_mm, s.z_mm) for s in layout.shafts}
    traces, unit = _gears(layout, places, measures), measures.unit("mm")
    for k, shaft in enumerate(layout.shafts):
        past = FLUSH * layout.box.length_mm
        span = shaft.from_mm - past, shaft.to_mm + past
        mesh = rod(places[shaft.shaft], shaft.diameter_mm / 2, *span)
        words = f"shaft {shaft.shaft}: diameter {measures.length(shaft.diameter_mm)} {unit}"
        traces.append(mesh_trace(mesh, words, "--metal", "shafts", showlegend=k == 0))
    bores = {s.shaft: s.diameter_mm / 2 for s in layout.shafts}
    for k, it in enumerate(layout.bearings):
        mesh = rod(places[it.shaft], it.diameter_mm / 2, it.from_mm, it.to_mm, bores[it.shaft])
        words = f"bearing of shaft {it.shaft}"
        traces.append(mesh_trace(mesh, words, "--soft", "bearings", showlegend=k == 0))
    traces += _housing(layout, measures)
    return traces + _clearances(layout, places)


def _gears(
    layout: LayoutDesign, places: Mapping[int, tuple[float, float]], measures: Measures
) -> list[dict[str, Any]]:
    discs = [gear for gear in layout.gears if gear.member == "ring"]
    gears = [gear for gear in layout.gears if gear.member != "ring"]
    for flank, step in DETAIL:
        meshes = [gear_mesh(_toothed(layout, gear, places), flank, step) for gear in gears]
        if sum(len(faces) for _, faces in meshes) <= MAX_TRIANGLES:
            break
    seen: set[int] = set()
    traces = []
    meshes += [rod(places[g.shaft], 0.5 * g.tip_diameter_mm, g.from_mm, g.to_mm) for g in discs]
    for gear, mesh in zip((*gears, *discs), meshes, strict=True):
        stage = gear.stage
        first, colour = stage not in seen, series(stage)
        seen.add(stage)
        words = escape(meaning(gear, measures))
        traces.append(mesh_trace(mesh, words, colour, f"stage {stage}", showlegend=first))
    return traces


def _toothed(
    layout: LayoutDesign, gear: GearDesign, places: Mapping[int, tuple[float, float]]
) -> Toothed:
    """The gear turned so that it meshes with its mate.

    At the middle of the stage the pinion has a tooth on the line of centres and the wheel a gap.
    The hands of a pair are opposite; those of the two gears on a shaft are equal, so that their
    axial forces are opposite, unless they are given.
    """
    pair = {g.member: g for g in layout.gears if g.stage == gear.stage}
    wheel = gear.member == "wheel"
    mate = pair.get("pinion" if wheel else "wheel", gear)
    here, there = places[gear.shaft], places[mate.shaft]
    phase = math.atan2(there[1] - here[1], there[0] - here[0])
    middle = sum(g.from_mm + g.to_mm for g in pair.values()) / (2.0 * len(pair))
    right = gear.hand == "right" if gear.hand else (gear.stage % 2 == 1) != wheel
    teeth = gear.gear
    return Toothed(
        replace(teeth, helix_angle=teeth.helix_angle if right else -teeth.helix_angle),
        gear.from_mm,
        gear.to_mm,
        here,
        phase + (math.pi / drawn_teeth(gear.teeth) if wheel else 0.0),
        middle,
    )


def _housing(layout: LayoutDesign, measures: Measures) -> list[dict[str, Any]]:
    """Draw walls as lines, the motor, keep-outs."""
    box = layout.box
    low, high = box_corners(layout)
    size = " x ".join(map(measures.length, box.sides))
    traces = [line_trace(edges(low, high), f"box {size} {measures.unit('mm')}", "--ink", 3.0)]
    if place := motor(layout):
        mesh = rod((0.0, 0.0), *place)
        traces.append(mesh_trace(mesh, "motor", "--axis", "motor", opacity=0.6, showlegend=True))
    for k, it in enumerate(cropped_keep_outs(layout)):
        ends = (it.from_mm, it.left_mm, it.bottom_mm), (it.to_mm, it.right_mm, it.top_mm)
        look = {"opacity": 0.35, "showlegend": k == 0}
        traces.append(mesh_trace(block(*ends), escape(it.name), "--warn", "keep-outs", **look))
        traces.append(line_trace(edges(*ends), "keep-outs", "--warn", 2.0, showlegend=False))
    return traces


def _clearances(
    layout: LayoutDesign, places: Mapping[int, tuple[float, float]]
) -> list[dict[str, Any]]:
    """Draw clearances, the limit inside the walls and the smallest gap; hidden at first."""
    room = layout.clearances
    hidden: dict[str, Any] = {"visible": "legendonly", "legendgroup": "clearances"}
    wall, axial = room.wall_mm, room.axial_mm
    low, high = box_corners(layout)
    low = (low[0] + axial, low[1] + wall, low[2] + wall)
    high = (high[0] - axial, high[1] - wall, high[2] - wall)
    traces = [line_trace(edges(low, high), "clearances", "--accent", 2.0, **hidden)]
    hidden |= {"showlegend": False}
    for gear in layout.gears:
        r = gear.tip_diameter_mm / 2 + room.gear_to_shaft_mm
        mesh: Mesh = rod(places[gear.shaft], r, gear.from_mm, gear.to_mm)
        look = hidden | {"opacity": 0.18, "hoverinfo": "skip", "hovertemplate": ""}
        traces.append(mesh_trace(mesh, "", "--accent", "clearances", **look))
    for gap in layout.gaps[:1]:
        if (ends := nearest(layout, *gap.between)) is not None:
            traces.append(line_trace(list(ends), "clearances", "--warn", 8.0, **hidden))
    return traces
