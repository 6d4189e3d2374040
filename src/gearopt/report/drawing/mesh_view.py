"""The teeth of each stage in mesh, as their tools cut them: a transverse section to scale."""

import math

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.optimise.result import Result
from gearopt.physics.gears import MEMBERS, Gear, GearPair, signed
from gearopt.physics.geometry.contact import ContactPath, contact_path
from gearopt.physics.geometry.fillet import half_angle, profile
from gearopt.report.drawing.sheet import Drawing, Place, Point, Sheet, Window, series
from gearopt.report.drawing.stage_gears import meshes
from gearopt.report.measures import Measures, rounded
from gearopt.report.section import Section
from gearopt.report.words import sentence

WIDE, HIGH = 550.0, 340.0  # px of a drawing, at most: two stand side by side on paper
ALONG, ACROSS = 4.6, 0.9  # normal modules: to either side of the pitch point, below the roots
FILLET, FLANK = 8, 13  # points of a tooth's side
DOT = 2.6  # px: radius of a point of contact
WORDS = (
    "Transverse sections of the teeth as their tools cut them, touching at the pitch point C; the "
    "{names}, below, {turns}. Dash-dotted: working pitch circles. The line of action from A to E "
    "is that of contact"
)
TURNS = {"pinion": "turns clockwise and drives", "wheel": "turns anticlockwise and is driven"}
ALONE = "; from B to D one pair of spur teeth carries alone"
HELICAL = (
    " in this section. Helical teeth touch along slanting lines: other sections are in contact at "
    "other moments, so that more pairs of teeth touch than one section shows"
)
SEVERAL = " Each mesh is drawn as seen from the end from which its lower gear turns so."
ROUNDING = 1e-9  # of a contact ratio: so near to a whole number it is that


def section(result: Result, measures: Measures) -> Section | None:
    """Draw the mesh of every stage of a rating; None without one, or of teeth of no whole number.

    Meshes whose contact is none are left out.
    """
    if not result.design.get("rating"):
        return None
    stages = drive_design(result.design).stages
    rows = [(k, *mesh) for k, stage in enumerate(stages, 1) for mesh in meshes(stage)]
    drawn = [(pair, _mesh(pair, k, names, len(stages))) for k, pair, names in rows]
    shown = [(pair, drawing) for pair, drawing in drawn if drawing is not None]
    if not shown:
        return None
    helical = HELICAL * any(pair.pinion.helix_angle for pair, _ in shown)
    alone = ALONE * any(carries_alone(pair, contact_path(pair)) for pair, _ in shown)
    below = "pinion" if all(names[0] == "pinion" for *_, names in rows) else "gear named first"
    turns = " or ".join(dict.fromkeys(TURNS[_driver(stage)] for stage in stages))
    return Section(
        "Teeth in mesh",
        words=(
            f"{WORDS.format(names=below, turns=turns)}{helical}{alone}.{SEVERAL * (len(rows) > 1)}",
        ),
        drawings=tuple(drawing for _, drawing in shown),
        appendix=True,
    )


def _driver(stage: StageDesign) -> str:
    """The gear that drives against the carrier: a ring that drives past a held sun drives it."""
    swapped = {"pinion": "wheel", "wheel": "pinion"}
    return swapped[stage.driver] if stage.fixed == "sun" else stage.driver


def carries_alone(pair: GearPair, path: ContactPath) -> bool:
    """Whether one pair of teeth carries alone on a part of its path, not all of it.

    Only of spur gears is that so along the whole face width.
    """
    return not pair.pinion.helix_angle and bool(1.0 < path.transverse_ratio < 2.0)


def _touching(pair: GearPair) -> str:
    """Least and most pairs of helical teeth that touch at once, of the total contact ratio."""
    ratio = float(pair.transverse_contact_ratio + pair.overlap_ratio)
    low, high = math.floor(ratio + ROUNDING), math.ceil(ratio - ROUNDING)
    pairs = f"{low} pairs" if low == high else f"{low} or {high} pairs"
    return f"total contact ratio {rounded(ratio, 4)}: {pairs} of teeth touch at once"


def _mesh(pair: GearPair, stage: int, names: tuple[str, str], stages: int) -> Drawing | None:
    """Draw a pair with its pitch point in the middle; None where its teeth are not whole."""
    path = contact_path(pair)
    if not all(float(g.teeth).is_integer() for g in pair.gears) or not path.length > 0.0:
        return None
    sheet = sheet_of(pair, (8.0, 8.0, 8.0, 8.0))
    for name, gear, at in zip(names, pair.gears, axes(pair), strict=True):
        rim = [(x, y + at) for x, y in sector(gear, at)]
        sheet.outline(rim, "tip", series(stage), f"{name} {stage}" if stages > 1 else name)
        pitch_circle(sheet, at, pair.normal_module, series(stage))
    action(sheet, pair, path)
    caption = [f"Stage {stage}"] if stages > 1 else []
    caption += [" and ".join(names)] if names != MEMBERS else []
    caption += [_touching(pair)] if pair.pinion.helix_angle else []
    of = "" if names == MEMBERS else f", {' and '.join(names)}"
    name = f"teeth of stage {stage} in mesh{of}"
    return sheet.drawing(name, sentence("; ".join(caption)), cut=True)


def sheet_of(pair: GearPair, free: tuple[float, float, float, float], larger: float = 1.0) -> Sheet:
    """An empty sheet about the pitch point, from root circle to root circle.

    free: px around it. larger: than one of WIDE x HIGH px.
    """
    m, roots = pair.normal_module, [0.5 * float(g.root_diameter) for g in pair.gears]
    first, second = axes(pair)
    low, high = first + roots[0] - ACROSS * m, second - roots[1] + ACROSS * m
    window = Window(-ALONG * m, ALONG * m, low, high, free)
    return Sheet(window, window.scale(larger * WIDE, larger * HIGH))


def axes(pair: GearPair) -> Point:
    """Y [mm] of both axes from the pitch point: the pinion's below it, the wheel's above."""
    first, second = (0.5 * float(d) for d in pair.working_diameters)
    return -first, second


def pitch_circle(sheet: Sheet, at: float, module: float, colour: str) -> None:
    """Draw the working pitch circle of the gear whose axis is at y = at, near the pitch point."""
    half = math.asin(min(1.0, ALONG * module / abs(at)))
    middle = -math.copysign(0.5 * math.pi, at)
    sheet.slice((0.0, at), abs(at), (middle - half, middle + half), "reference", colour, rim=True)


def sector(gear: Gear, at: float, turned: int = 0) -> list[Point]:
    """The outline [mm] about its axis of the teeth that a sheet may show, and of the axis.

    Of a ring that of its teeth and of a rim beyond the sheet. at: y of the axis from the pitch
    point [mm], below 0 for the pinion and a ring. One flank passes the pitch point, at which the
    pinion drives to the right. turned: pitches that it turns to either side.
    """
    module, teeth = gear.normal_module, abs(gear.teeth)
    lowest = min(abs(0.5 * float(d)) for d in (gear.root_diameter, gear.tip_diameter))
    lowest -= ACROSS * module
    seen = ALONG * module / lowest if lowest > 0.0 else 1.0
    reach = math.asin(min(1.0, seen)) * teeth / (2.0 * math.pi)  # pitches
    count = min(math.ceil(reach) + 1 + turned, int(teeth) // 2)
    rim = [point for number in range(-count, count + 1) for point in tooth(gear, at, number)]
    if gear.teeth > 0.0:
        return [(0.0, 0.0), *rim]
    beyond = 1.0 + 2.0 * ALONG * module / lowest
    return [*rim, *((beyond * x, beyond * y) for x, y in reversed(rim))]


def tooth(gear: Gear, at: float, number: int, fine: int = 0) -> list[Point]:
    """The outline [mm] about its axis of one tooth, as `sector` has it, left to right.

    number: 0 has the flank through the pitch point, 1 is the next one to the right, and so on.
    fine: points of a fillet, and of a flank at even angles of roll.
    """
    sign = -math.copysign(1.0, at)
    sides = profile(gear, fine, fine, rolled=True) if fine else profile(gear, FILLET, FLANK)
    flank = zip(*sides, strict=True)  # from the root to the tip
    side = [(math.atan2(x, abs(y)), math.hypot(x, y)) for x, y in flank]
    half = float(half_angle(gear, signed(abs(at), gear.teeth)))
    middle = number * 2.0 * math.pi / abs(gear.teeth) - sign * half
    rim = [(middle - angle, r) for angle, r in side]
    rim += [(middle + angle, r) for angle, r in reversed(side)]
    return [(r * math.sin(angle), sign * r * math.cos(angle)) for angle, r in rim]


def action(sheet: Sheet, pair: GearPair, path: ContactPath) -> None:
    """Draw the line of action with the points A to E; B and D of `carries_alone`."""
    places = {"A": path.start, "E": path.end, "C": 0.0}
    if carries_alone(pair, path):
        places |= {"B": path.lowest_single, "D": path.highest_single}
    sheet.line(on_action(pair, path.start), on_action(pair, path.end), "size")
    for name, s in places.items():
        x, y = sheet.at(*on_action(pair, s))
        sheet.circle(*on_action(pair, s), DOT / sheet.scale, "tip", "--ink")
        away = ((-11.0, -11.0), (11.0, 11.0), (0.0, -14.0), (0.0, 14.0), (12.0, -9.0), (-12.0, 9.0))
        sheet.label(name, [Place(x + dx, y + dy) for dx, dy in away], "size")


def on_action(pair: GearPair, position: float) -> Point:
    """The point [mm] of the line of action at a position s [mm] from the pitch point."""
    angle, s = float(pair.working_angle), float(position)
    return s * math.cos(angle), s * math.sin(angle)
