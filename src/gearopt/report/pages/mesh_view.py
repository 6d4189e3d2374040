"""The teeth of each stage in mesh, as their tools cut them: a transverse section to scale."""

import math
from collections.abc import Iterator

from gearopt.formulations.design import drive_design
from gearopt.optimise.result import Result
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.geometry.contact import ContactPath, contact_path
from gearopt.physics.geometry.fillet import half_angle, profile
from gearopt.report.measures import Measures
from gearopt.report.pages.sheet import Drawing, Place, Point, Sheet, Window, series
from gearopt.report.section import Section

WIDE, HIGH = 560.0, 340.0  # px of a drawing, at most
ALONG, ACROSS = 4.6, 0.9  # normal modules: to either side of the pitch point, below the roots
FILLET, FLANK = 8, 13  # points of a tooth's side
DOT = 2.6  # px: radius of a point of contact
WORDS = (
    "Transverse sections of the teeth as their tools cut them, touching at the pitch point C; the "
    "pinion, below, turns clockwise and drives. Dash-dotted: working pitch circles. The line of "
    "action from A to E is that of contact; from B to D one pair of teeth carries alone."
)


def section(result: Result, measures: Measures) -> Section | None:
    """Draw the mesh of every stage of a rating; None without one, or of teeth of no whole number.

    Stages whose contact is none are left out.
    """
    if not result.design.get("rating"):
        return None
    stages = drive_design(result.design).stages
    drawn = [_mesh(stage.pair, k, len(stages)) for k, stage in enumerate(stages, 1)]
    found = tuple(one for one in drawn if one is not None)
    return Section("Teeth in mesh", words=(WORDS,), drawings=found) if found else None


def _mesh(pair: GearPair, stage: int, stages: int) -> Drawing | None:
    """Draw a pair with its pitch point in the middle; None where its teeth are not whole."""
    path = contact_path(pair)
    if not all(float(g.teeth).is_integer() for g in pair.gears) or not path.length > 0.0:
        return None
    first, second = (0.5 * float(d) for d in pair.working_diameters)
    m, roots = pair.normal_module, [0.5 * float(g.root_diameter) for g in pair.gears]
    window = Window(
        -ALONG * m,
        ALONG * m,
        roots[0] - first - ACROSS * m,
        second - roots[1] + ACROSS * m,
        (8.0, 8.0, 8.0, 8.0),
    )
    sheet = Sheet(window, window.scale(WIDE, HIGH))
    for name, gear, r, sign in (
        ("pinion", pair.pinion, first, 1.0),
        ("wheel", pair.wheel, second, -1.0),
    ):
        outline = _outline(sheet, gear, r, sign, window)
        sheet.shape(outline, "tip", series(stage), f"{name} {stage}" if stages > 1 else name)
        half = math.asin(min(1.0, ALONG * m / r))
        middle = 0.5 * math.pi * sign
        ends = middle - half, middle + half
        sheet.slice((0.0, -sign * r), r, ends, "reference", series(stage), rim=True)
    _action(sheet, pair, path)
    caption = f"Stage {stage}." if stages > 1 else ""
    return sheet.drawing(f"teeth of stage {stage} in mesh", caption, cut=True)


def _outline(sheet: Sheet, gear: Gear, r: float, sign: float, window: Window) -> str:
    """Return the path of the teeth near the pitch point, one flank through it.

    r: working pitch radius [mm]; sign: 1 for the pinion, whose axis is below, -1 for the wheel.
    """
    lowest = r - abs(window.bottom if sign > 0.0 else window.top)  # radius at the drawing's edge
    reach = math.asin(min(1.0, window.right / lowest)) if lowest > 0.0 else 0.5 * math.pi
    rim = [_at(angle, radius, r, sign) for angle, radius in _rim(gear, r, sign, reach)]
    points = [(0.0, -sign * r), *rim]
    return "M " + " L ".join(f"{x:.1f} {y:.1f}" for x, y in (sheet.at(*p) for p in points)) + " Z"


def _rim(gear: Gear, r: float, sign: float, reach: float) -> Iterator[tuple[float, float]]:
    """Yield polar points (angle from the line of centres, radius) of the teeth, left to right.

    reach: angle [rad] up to which teeth are seen; the sector ends beyond.
    """
    points = zip(*profile(gear, FILLET, FLANK), strict=True)  # from the root to the tip
    side = [(math.atan2(x, y), math.hypot(x, y)) for x, y in points]
    pitch = 2.0 * math.pi / gear.teeth
    start = -sign * float(half_angle(gear, r))  # its flank at the pitch point touches the mate's
    count = min(math.ceil(reach / pitch) + 1, int(gear.teeth) // 2)
    for tooth in range(-count, count + 1):
        middle = start + tooth * pitch
        yield from ((middle - angle, radius) for angle, radius in side)
        yield from ((middle + angle, radius) for angle, radius in reversed(side))


def _at(angle: float, radius: float, r: float, sign: float) -> Point:
    """Return a polar point of a gear in the drawing, whose origin is the pitch point [mm]."""
    return radius * math.sin(angle), sign * (radius * math.cos(angle) - r)


def _action(sheet: Sheet, pair: GearPair, path: ContactPath) -> None:
    """Draw the line of action with the points A to E; B and D where one pair carries alone."""
    working = float(pair.working_angle)
    places = {"A": path.start, "E": path.end, "C": 0.0}
    if 1.0 < float(path.transverse_ratio) < 2.0:
        places |= {"B": path.lowest_single, "D": path.highest_single}

    def at(s: float) -> Point:
        return float(s) * math.cos(working), float(s) * math.sin(working)

    sheet.line(at(path.start), at(path.end), "size")
    for name, s in places.items():
        x, y = sheet.at(*at(s))
        sheet.circle(*at(s), DOT / sheet.scale, "tip", "--ink")
        away = ((-11.0, -11.0), (11.0, 11.0), (0.0, -14.0), (0.0, 14.0), (12.0, -9.0), (-12.0, 9.0))
        sheet.label(name, [Place(x + dx, y + dy) for dx, dy in away], "size")
