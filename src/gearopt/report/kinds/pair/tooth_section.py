"""A tooth of each gear in its transverse section, to scale, with its dimensions."""

import math
from collections.abc import Sequence

from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS, Gear, GearPair
from gearopt.physics.geometry.contact import ContactPath, usable_path
from gearopt.physics.geometry.fillet import (
    fillet_end,
    fillet_point,
    form_diameter,
    half_angle,
    least_fillet_radius,
    profile,
    profile_angle,
)
from gearopt.physics.geometry.tooth import tip_thickness, transverse_thickness
from gearopt.report.drawing.mesh_view import carries_alone
from gearopt.report.drawing.sheet import (
    SERIES_OF_MEMBERS,
    SIZE,
    Drawing,
    Place,
    Point,
    Sheet,
    Window,
    series,
)
from gearopt.report.measures import Measures

WIDE = 400.0  # px of the tooth with its neighbours' flanks
SIDE, BELOW, ABOVE = (
    2.3,
    1.3,
    0.75,
)  # normal modules: beside the tooth, below its root, above its tip
MARGINS = (14.0, 104.0, 10.0, 10.0)  # px around it; names of circles stand on the right
FILLET, FLANK = 24, 30  # points of a tooth's side
ROW = 1.35 * SIZE  # px from a name to the next
REACH = 70.0  # px of the load line outside the tooth
TURN = 26.0  # px: radius of the arc of an angle


@dataclass(frozen=True)
class Flank:
    """The right flank of a tooth that stands on the y axis; origin on the gear's axis [mm]."""

    gear: Gear

    def at(self, radius: float) -> Point:
        """The point of the flank at a radius [mm]."""
        half = float(half_angle(self.gear, radius))
        return radius * math.sin(half), radius * math.cos(half)


def sections(pair: GearPair, measures: Measures) -> tuple[Drawing, Drawing]:
    """Draw a tooth of pinion and wheel at one scale, both loaded as one pair touches farthest out.

    Of gears of floats with at least 4 teeth.
    """
    path = usable_path(pair)
    first, second = (_drawing(pair, path, k, measures) for k in range(2))
    return first, second


def outermost(pair: GearPair, path: ContactPath) -> tuple[float, float]:
    """Radii of curvature [mm] where one pair of teeth touches farthest out on either flank.

    HPSTC on the pinion and LPSTC on the wheel; the tips where two pairs or more always touch.
    """
    single = carries_alone(pair, path)
    high, low = (path.highest_single, path.lowest_single) if single else (path.end, path.start)
    return float(path.radii_of_curvature(high)[0]), float(path.radii_of_curvature(low)[1])


def _drawing(pair: GearPair, path: ContactPath, k: int, measures: Measures) -> Drawing:
    """Draw one tooth of gear k (0: pinion, 1: wheel) in transverse section, with its load."""
    gear, m, member = pair.gears[k], float(pair.normal_module), MEMBERS[k]
    root, tip = 0.5 * float(gear.root_diameter), 0.5 * float(gear.tip_diameter)
    window = Window(-SIDE * m, SIDE * m, root - BELOW * m, tip + ABOVE * m, MARGINS)
    sheet = Sheet(window, WIDE / (2.0 * SIDE * m))
    _outline(sheet, gear, window, series(SERIES_OF_MEMBERS[k]), member)
    _circles(sheet, gear, window, measures)
    sheet.line((0.0, window.bottom), (0.0, window.top), "axis")
    _thickness(sheet, gear, measures)
    _pressure_angle(sheet, gear)
    _load(sheet, gear, outermost(pair, path)[k])
    _fillet(sheet, gear, measures)
    caption = f"Tooth of the {member}, z {gear.teeth:.6g}."
    return sheet.drawing(f"tooth of the {member}", caption, cut=True)


def _outline(sheet: Sheet, gear: Gear, window: Window, colour: str, title: str) -> None:
    """Draw the tooth and the flanks of its neighbours, down to the lower edge."""
    x, y = (list(map(float, v)) for v in profile(gear, FILLET, FLANK))
    polar = [(math.atan2(a, b), math.hypot(a, b)) for a, b in zip(x, y, strict=True)]
    rim = []
    for number in (-1, 0, 1):
        middle = number * 2.0 * math.pi / gear.teeth
        rim += [(middle - angle, r) for angle, r in polar]
        rim += [(middle + angle, r) for angle, r in reversed(polar)]
    points = [(r * math.sin(angle), r * math.cos(angle)) for angle, r in rim]
    points = [point for point in points if abs(point[0]) <= window.right]
    low = window.bottom - 0.2 * gear.normal_module
    ends = [(points[0][0], low), *points, (points[-1][0], low)]
    sheet.outline(ends, "tip", colour, title)


def _circles(sheet: Sheet, gear: Gear, window: Window, measures: Measures) -> None:
    """Draw tip, reference, base, form and root circle, named on the right from the top."""
    circles = [
        ("d_a", float(gear.tip_diameter), "extension"),
        ("d", float(gear.reference_diameter), "centres"),
        ("d_Ff", float(form_diameter(gear)), "far"),
        ("d_b", float(gear.base_diameter), "far"),
        ("d_f", float(gear.root_diameter), "extension"),
    ]
    named = []
    for name, diameter, style in circles:
        r = 0.5 * diameter
        half = math.asin(min(1.0, window.right / r))
        end = (r * math.sin(half), r * math.cos(half))
        if end[1] > window.bottom:
            ends = 0.5 * math.pi - half, 0.5 * math.pi + half
            sheet.slice((0.0, 0.0), r, ends, style, rim=True)
            named.append((sheet.at(*end), f"{name} {measures.length(diameter)}"))
    named.sort(key=lambda row: row[0][1])
    rows = _apart([y for (_, y), _ in named], sheet.height - MARGINS[2])
    for ((x, y), text), row in zip(named, rows, strict=True):
        start = x + 16.0
        sheet.tick((x, y), (start, row))
        sheet.label(text, [Place(start + Place(0, 0).half_width(text) + 2.0, row)], "size")


def _apart(wanted: Sequence[float], lowest: float) -> list[float]:
    """Heights [px] from the top at least ROW apart, near those that are wanted."""
    values: list[float] = []
    for y in wanted:
        values.append(max(y, values[-1] + ROW) if values else max(y, ROW))
    for k in range(len(values) - 1, -1, -1):
        values[k] = min(values[k], lowest - ROW * (len(values) - k))
    return values


def _thickness(sheet: Sheet, gear: Gear, measures: Measures) -> None:
    """Draw the thicknesses on reference and tip circle."""
    side = Flank(gear)
    d = float(gear.reference_diameter)
    x, y = side.at(0.5 * d)
    text = f"s {measures.length(float(transverse_thickness(gear, d)), 3)}"
    (left, level), (right, _) = sheet.at(-x, y), sheet.at(x, y)
    sheet.arrows((left, level), (right, level))
    middle, half = 0.5 * (left + right), Place(0, 0).half_width(text)
    spots = [Place(middle - half - 4.0, level + dy) for dy in (10.0, -10.0)]
    sheet.label(text, spots, "size")
    x, y = side.at(0.5 * float(gear.tip_diameter))
    away = 0.35 * ABOVE * float(gear.normal_module)
    sheet.line((-x, y), (-x, y + 1.4 * away), "extension")
    sheet.line((x, y), (x, y + 1.4 * away), "extension")
    sheet.arrows(sheet.at(-x, y + away), sheet.at(x, y + away))
    place = sheet.at(0.0, y + away)
    text = f"s_a {measures.length(float(tip_thickness(gear)), 3)}"
    sheet.label(text, [Place(place[0] + 1.0, place[1] - 10.0)], "size")


def _pressure_angle(sheet: Sheet, gear: Gear) -> None:
    """Draw the angle between radius and flank where the left flank meets the reference circle."""
    r = 0.5 * float(gear.reference_diameter)
    if r < 0.5 * float(gear.base_diameter):
        return
    x, y = Flank(gear).at(r)
    x, reach = -x, 1.25 * float(gear.normal_module)
    angle = float(profile_angle(gear, r))
    radial = math.atan2(y, x)
    flank = radial - angle  # leans to the tooth's middle
    for turn in (radial, flank):
        u, v = math.cos(turn), math.sin(turn)
        start = x - 0.2 * reach * u, y - 0.2 * reach * v
        sheet.line(start, (x + reach * u, y + reach * v), "extension")
    size = 0.8 * reach
    sheet.slice((x, y), size, (flank, radial), "leader", rim=True)
    text = f"α {math.degrees(angle):.2f}°"
    half = Place(0, 0).half_width(text)
    u, v = sheet.at(x + size * math.cos(radial), y + size * math.sin(radial))
    sheet.label(text, [Place(u - half - 4.0, v + dy) for dy in (0.0, -10.0, 10.0)], "size")


def _load(sheet: Sheet, gear: Gear, curvature: float) -> None:
    """Draw the force on the right flank where one pair touches farthest out, and its angle.

    The load line touches the base circle; it crosses the centre line at r_b/cos(alpha_L).
    """
    base = 0.5 * float(gear.base_diameter)
    radius = math.hypot(base, curvature)
    angle = math.atan2(curvature, base) - float(half_angle(gear, radius))
    x, y = Flank(gear).at(radius)
    crossing = base / math.cos(angle)
    along = math.cos(angle), math.sin(angle)  # out of the tooth
    start, end = sheet.at(x, y), sheet.at(0.0, crossing)
    outside = (start[0] + REACH * along[0], start[1] - REACH * along[1])
    sheet.arrow(outside, start, "gap")
    sheet.line((x, y), (0.0, crossing), "gap")
    reach = 0.9 * math.dist(start, end) / sheet.scale
    sheet.line((0.0, crossing), (1.15 * x, crossing), "extension")
    turn = sorted((0.0, angle))
    sheet.slice((0.0, crossing), reach, (turn[0], turn[1]), "leader", rim=True)
    text = f"α_L {math.degrees(angle):.2f}°"
    half = Place(0, 0).half_width(text)
    spots = [
        Place(end[0] + half + dx, end[1] + dy, 0.0, abs(dy))
        for dx in (6.0, 12.0)
        for dy in (14.0, 20.0, 26.0)
    ]
    sheet.label(text, spots, "gap")
    sheet.label("F_n", [Place(outside[0] + 4.0, outside[1] + dy) for dy in (11.0, -11.0)], "gap")


def _fillet(sheet: Sheet, gear: Gear, measures: Measures) -> None:
    """Name the least radius of curvature of the fillet."""
    end = float(fillet_end(gear))
    point = fillet_point(gear, end + 0.75 * (0.5 * math.pi - end))
    at = sheet.at(-float(point.x), float(point.y))
    text = f"ρ_F {measures.length(float(least_fillet_radius(gear)), 3)}"
    half = Place(0, 0).half_width(text)
    spots = [
        Place(at[0] + dx, at[1] + dy, 0.0, 0.0, at)
        for dx in (half, 0.0, -20.0)
        for dy in (26.0, 36.0)
    ]
    sheet.label(text, spots, "size")
