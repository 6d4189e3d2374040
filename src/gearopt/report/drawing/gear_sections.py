"""Whole gears in transverse section, alone and in mesh, to the micrometre: for CAD, not for pages.

The outlines are those of `mesh_view`, all the way round, of arcs through three points each.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from gearopt.formulations.drive.design import DriveDesign, StageDesign
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.report.drawing.mesh_view import action, axes, tooth
from gearopt.report.drawing.sheet import Drawing, Place, Point, Sheet, Window, series
from gearopt.report.drawing.stage_gears import meshes
from gearopt.report.drawing.train_views import circles
from gearopt.report.measures import Measures

POINTS = 65  # of a fillet, and of a flank: arcs are within 0.1 um of flanks of module 21
FREE = (24.0, 110.0, 48.0, 24.0)  # px around a gear, whose circles are named on the right
ACROSS = 640.0  # px of a drawing


def sections(design: DriveDesign, measures: Measures) -> Iterator[Drawing]:
    """Yield a section of every gear and of every mesh of whole teeth."""
    for k, stage in enumerate(design.stages, 1):
        for pair, names in meshes(stage):
            if not all(float(gear.teeth).is_integer() for gear in pair.gears):
                continue
            drawn = {n: g for n, g in zip(names, pair.gears, strict=True)}
            for name, gear in drawn.items():
                idle = stage.idler and gear is pair.pinion
                if not idle and (name, stage.type) != ("planet", "planetary") or name == names[1]:
                    yield _gear(gear, f"{name} {k}", stage, measures)
            yield _mesh(pair, f"{' and '.join(names)}, stage {k}", stage, measures)


def outline(gear: Gear, at: float) -> tuple[list[Point], list[float]]:
    """The closed outline [mm] of a gear about its axis, and the bulges of its arcs (see `Mark`).

    at: as of `tooth`. Tips and roots are arcs of their circles.
    """
    every, bulges = list[Point](), list[float]()
    for number in range(abs(round(float(gear.teeth)))):
        rim = tooth(gear, at, number, POINTS)
        half = len(rim) // 2
        for side in (rim[:half], rim[half:]):
            every += side[::2]
            bulges += [*_bulges(np.array(side)).tolist(), 0.0]  # the last: of a tip or a root
    for k in range(POINTS - 1, len(every), POINTS):
        bulges[k] = _about_axis(every[k], every[(k + 1) % len(every)])
    return every, bulges


def _bulges(side: Any) -> Any:
    """Bulges tan(a/4) of the arcs through every three points of a side of a tooth."""
    first, second = side[1:-1:2] - side[:-2:2], side[2::2] - side[1:-1:2]
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.tan(0.5 * np.arctan2(cross, (first * second).sum(axis=1)))


def _about_axis(start: Point, end: Point) -> float:
    """Bulge of an arc about the axis."""
    cross = start[0] * end[1] - start[1] * end[0]
    return math.tan(0.25 * math.atan2(cross, start[0] * end[0] + start[1] * end[1]))


def _gear(gear: Gear, name: str, stage: StageDesign, measures: Measures) -> Drawing:
    """Draw a whole gear with its circles and its diameter."""
    held: Mapping[str, Any] = vars(stage)
    member = {"sun": "pinion", "planet": "wheel"}.get(name.split()[0], name.split()[0])
    member = "wheel" if member == "ring" and stage.type == "internal" else member
    ring = gear.teeth < 0
    bodies = [outside(gear, stage)] if ring else circles(held, member)
    r = 0.5 * max(abs(float(gear.tip_diameter)), *bodies, 0.0)
    sheet = Sheet(window := Window(-r, r, -r, r, FREE), window.scale(ACROSS, ACROSS))
    points, bulges = outline(gear, -abs(0.5 * float(gear.reference_diameter)))
    sheet.outline(points, "tip", series(1), name, bulges)
    for diameter in bodies:
        sheet.circle(0.0, 0.0, 0.5 * diameter, "body")
    named = {"d_a": gear.tip_diameter, "d": gear.reference_diameter, "d_b": gear.base_diameter}
    named |= {"d_Ff": form_diameter(gear), "d_f": gear.root_diameter}
    for row, (sign, value) in enumerate(named.items()):
        d = abs(float(value))
        sheet.circle(0.0, 0.0, 0.5 * d, "reference" if sign == "d" else "far")
        place = Place(sheet.width - 0.5 * FREE[1], 40.0 + 18.0 * row)
        sheet.label(f"{sign} {measures.length(d, 3)}", [place], "size")
    sheet.cross(0.0, 0.0, r)
    size = r if ring else 0.5 * float(gear.tip_diameter)
    sheet.dimension((-size, 0.0), (size, 0.0), sheet.scale * r + 24.0, f"⌀ {2.0 * size:.3f}")
    return sheet.drawing(name, f"{name}: z {abs(gear.teeth):g}, transverse section")


def outside(ring: Gear, stage: StageDesign) -> float:
    """Outside diameter of a ring [mm]."""
    return stage.ring_outside_diameter_mm or -float(ring.outside)


def _mesh(pair: GearPair, name: str, stage: StageDesign, measures: Measures) -> Drawing:
    """Draw two whole gears in mesh with their pitch circles and the line of action."""
    first, second = axes(pair)
    radii = [0.5 * abs(float(g.tip_diameter)) for g in pair.gears]
    if pair.wheel.teeth < 0:
        radii[1] = 0.5 * outside(pair.wheel, stage)
    ends = first - radii[0], second - radii[1], first + radii[0], second + radii[1]
    window = Window(-max(radii), max(radii), min(ends), max(ends), (60.0, 24.0, 24.0, 24.0))
    sheet = Sheet(window, window.scale(ACROSS, ACROSS))
    for k, (gear, at, d) in enumerate(
        zip(pair.gears, (first, second), pair.working_diameters, strict=True)
    ):
        points, bulges = outline(gear, at)
        sheet.outline([(x, y + at) for x, y in points], "tip", series(k + 1), name, bulges)
        sheet.circle(0.0, at, 0.5 * abs(float(d)), "reference")
        sheet.cross(0.0, at, radii[k])
        if gear.teeth < 0:
            sheet.circle(0.0, at, radii[k], "body")
    action(sheet, pair, contact_path(pair))
    text = measures.length(abs(float(pair.centre_distance)), 3)
    sheet.dimension((0.0, first), (0.0, second), sheet.scale * max(radii) + 24.0, text)
    return sheet.drawing(name, f"{name}, in mesh")
