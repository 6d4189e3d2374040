"""A planetary stage in three dimensions: sun, planets, ring with their teeth, a plain carrier."""

import math
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.design import StageDesign
from gearopt.physics.gears import Gear
from gearopt.report.drawing.planetary_view import GearSet
from gearopt.report.drawing.sheet import series
from gearopt.report.drawing.solid import (
    TURN,
    Mesh,
    Toothed,
    gear_mesh,
    mesh_trace,
    outline,
    rod,
    space,
)
from gearopt.report.drawing.still import Rod, Texts, sizes_of, still, view
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure

POINTS = 20_000  # of all gears, about half a megabyte of a page
FLANKS = (8, 6, 4, 3, 2)  # points on a flank
TWIST = 0.05  # rad from section to section of a helical gear
PIN, PLATE = 0.35, 0.08  # of a planet's root diameter, of the face width: as they are drawn
MARGIN = 0.04  # of the face width, between gears and plate
NAMES = ("sun", "planet", "ring")
CAPTION = (
    f"{TURN} Teeth as the tools cut them, thinned by 3 % of half a pitch so that the flanks are "
    "seen apart. Carrier and pins are not of the design: they are drawn to show what turns "
    "together."
)


def figure(
    stage: StageDesign, number: int, seen: GearSet, gears: tuple[Gear, ...], measures: Measures
) -> Figure:
    """Draw a stage (its number from 1); seen: where its gears are."""
    placed = _placed(stage, seen, gears)
    points = 4 * sum(abs(gear.gear.teeth) for _, gear in placed)
    flank = next((n for n in FLANKS if n * points < POINTS), FLANKS[-1])
    traces: list[dict[str, Any]] = []
    for name, gear in placed:
        mesh = _ring(stage, gear, flank) if name == "ring" else gear_mesh(gear, flank, TWIST)
        traces.append(_trace(mesh, f"{name}: z {abs(gear.gear.teeth):g}", name, traces))
    b, outer = stage.face_width_mm, 0.5 * (stage.ring_outside_diameter_mm or 0.0)
    pins = [Rod(gear.centre, *pin, "metal") for _, gear in placed[1:-1] for pin in [_pin(stage)]]
    start, end = b * (1.0 + MARGIN), b * (1.0 + MARGIN + PLATE)
    plate = rod((0.0, 0.0), seen.distance + 2.0 * pins[0].radius, start, end)
    for mesh in (plate, *(rod(pin.centre, pin.radius, pin.start, pin.end) for pin in pins)):
        traces.append(_trace(mesh, "carrier", "carrier", traces))
    solids = [_solid(name, gear) for name, gear in placed if name != "ring"]
    low, high = (-MARGIN * b, -outer, -outer), (end, outer, outer)
    legend = [(name, _colour(name)) for name in NAMES[:2]]
    texts = Texts(sizes_of((low, high), "xyz", measures), legend)
    ends = [replace(pin, start=b) for pin in pins]
    drawn = still([*solids, *ends], (low, high), view(), texts, f"stage {number} in space")
    without = replace(drawn, caption=f"{drawn.caption} Ring and plate of the carrier left out.")
    return Figure(traces, space(low, high, measures, 560), f"Stage {number}. {CAPTION}", without)


def _placed(
    stage: StageDesign, seen: GearSet, gears: tuple[Gear, ...]
) -> list[tuple[str, Toothed]]:
    """Sun, planets and ring with their helices, of hands that are in mesh."""
    b, (turned, ring_angle) = stage.face_width_mm, seen.fitted()
    handed = [
        replace(gear, helix_angle=sign * gear.helix_angle)
        for gear, sign in zip(gears, (1.0, -1.0, -1.0), strict=True)
    ]
    sun, planet, ring = (
        Toothed(gear, 0.0, b, (0.0, 0.0), phase, 0.5 * b)
        for gear, phase in zip(handed, (0.0, 0.0, ring_angle), strict=True)
    )
    at = [(seen.distance * math.cos(t), seen.distance * math.sin(t)) for t in seen.angles]
    around = [replace(planet, centre=c, phase=t) for c, t in zip(at, turned, strict=True)]
    return [("sun", sun), *(("planet", it) for it in around), ("ring", ring)]


def _ring(stage: StageDesign, gear: Toothed, flank: int) -> Mesh:
    """The ring: its teeth inside, its rim around them; its faces look towards its axis."""
    outside = 0.5 * (stage.ring_outside_diameter_mm or 0.0)
    points, faces = gear_mesh(gear, flank, TWIST, [(gear.end, outside), (gear.start, outside)])
    return points, [(i, k, j) for i, j, k in faces]


def _pin(stage: StageDesign) -> tuple[float, float, float]:
    """Radius and ends [mm] of a pin as it is drawn."""
    b = stage.face_width_mm
    return 0.5 * PIN * stage.wheel_root_diameter_mm, -MARGIN * b, b * (1.0 + MARGIN)


def _colour(name: str) -> str:
    return series(1 + NAMES.index(name)) if name in NAMES else "--metal"


def _trace(mesh: Mesh, words: str, group: str, others: list[dict[str, Any]]) -> dict[str, Any]:
    first = not any(trace["name"] == group for trace in others)
    return mesh_trace(mesh, words, _colour(group), group, showlegend=first)


def _solid(name: str, gear: Toothed) -> Rod:
    rim = tuple((angle + gear.phase, r) for angle, r in outline(gear.gear, 3))
    tip, words = 0.5 * float(gear.gear.tip_diameter), f"{name}: z {gear.gear.teeth:g}"
    return Rod(gear.centre, tip, gear.start, gear.end, "gear", _colour(name), words, rim)
