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
    Toothed,
    gear_mesh,
    mesh_trace,
    outline,
    rod,
    space,
    twist,
)
from gearopt.report.drawing.still import Rod, Texts, sizes_of, still, view
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure

POINTS = 20_000  # of all gears, about half a megabyte of a page
FLANKS = (8, 6, 4, 3, 2)  # points on a flank
TWIST = 0.05  # rad from section to section of a helical gear
PIN, MARGIN, PLATE = 0.35, 0.04, 0.12  # of a planet's root diameter; of the face width
COLOURS = {"sun": series(1), "planet": series(2), "ring": series(3), "carrier": "--metal"}
CAPTION = (
    f"{TURN} Teeth as the tools cut them, thinned by 3 % of half a pitch so that the flanks are "
    "seen apart. "
)
OF_CARRIER = {  # by whether the design has one
    False: "Carrier and pins are not of the design: they are drawn to show what turns together.",
    True: "One cheek of the carrier is drawn; pins are not of the design.",
}


def figure(
    stage: StageDesign, number: int, seen: GearSet, gears: tuple[Gear, ...], measures: Measures
) -> Figure:
    """Draw a stage (its number from 1); seen: where its gears are."""
    placed = _placed(stage, seen, gears)
    points = 4 * sum(abs(gear.gear.teeth) for _, gear in placed)
    flank = next((n for n in FLANKS if n * points < POINTS), FLANKS[-1])
    b, outer = stage.face_width_mm, 0.5 * (stage.ring_outside_diameter_mm or 0.0)
    pin = 0.5 * (stage.wheel_bore_mm or PIN * stage.wheel_root_diameter_mm)
    end, reach = -MARGIN * b, 0.5 * (stage.carrier_diameter_mm or 0.0)
    reach = reach or seen.distance + 2.0 * pin
    start = end - 0.5 * (stage.carrier_width_mm or 2.0 * (PLATE - MARGIN) * b)
    rods = [Rod(it.centre, pin, end, -end + b, "metal") for _, it in placed[1:-1]]
    bodies = [(name, gear_mesh(it, flank, TWIST)) for name, it in placed[:-1]]
    ring = placed[-1][1]  # its faces look towards the axis
    spots, faces = gear_mesh(ring, flank, TWIST, [(b, outer), (0.0, outer)])
    bodies.append(("ring", (spots, [(i, k, j) for i, j, k in faces])))
    bodies += [("carrier", rod(it.centre, pin, it.start, it.end)) for it in rods]
    bodies.append(("carrier", rod((0.0, 0.0), reach, start, end)))
    traces: list[dict[str, Any]] = []
    for name, mesh in bodies:
        first = not any(trace["name"] == name for trace in traces)
        traces.append(mesh_trace(mesh, name, COLOURS[name], name, showlegend=first))
    low, high = (0.0, -outer, -outer), (b, outer, outer)
    names = [(name, COLOURS[name]) for name in ("sun", "planet")]
    solids = [_solid(name, gear) for name, gear in placed[:-1]]
    solids += [replace(it, start=b) for it in rods]
    texts = Texts(sizes_of((low, high), "xyz", measures), names)
    drawn = still(solids, (low, high), view(), texts, f"stage {number} in space")
    without = replace(drawn, caption=f"{drawn.caption} Ring and plate of the carrier left out.")
    seen_whole = space((start, *low[1:]), high, measures, 560)
    words = f"Stage {number}. {CAPTION}{OF_CARRIER[bool(stage.carrier_width_mm)]}"
    return Figure(traces, seen_whole, words, without)


def _placed(
    stage: StageDesign, seen: GearSet, gears: tuple[Gear, ...]
) -> list[tuple[str, Toothed]]:
    """Sun, planets and ring with their helices, of hands that are in mesh."""
    b, (turned, ring_angle) = stage.face_width_mm, seen.fitted()
    sun, planet, ring = (
        Toothed(replace(gear, helix_angle=sign * gear.helix_angle), 0.0, b, (0.0, 0.0), at, 0.5 * b)
        for gear, sign, at in zip(gears, (1.0, -1.0, -1.0), (0.0, 0.0, ring_angle), strict=True)
    )
    at = [(seen.distance * math.cos(t), seen.distance * math.sin(t)) for t in seen.angles]
    around = [replace(planet, centre=c, phase=t) for c, t in zip(at, turned, strict=True)]
    return [("sun", sun), *(("planet", it) for it in around), ("ring", ring)]


def _solid(name: str, gear: Toothed) -> Rod:
    """A gear for the still, whose face is at its end."""
    turn = gear.phase + twist(gear.gear) * (gear.end - gear.middle)
    rim = tuple((angle + turn, r) for angle, r in outline(gear.gear, 3))
    tip = 0.5 * float(gear.gear.tip_diameter)
    return Rod(gear.centre, tip, gear.start, gear.end, "gear", COLOURS[name], name, rim)
