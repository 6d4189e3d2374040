"""How stiff the train of a servo axis is, and the train in its box, seen along the shafts.

Both angles of a layout turn about axes along the shafts; the box is drawn about the middle of what
the train needs.
"""

import math
from collections.abc import Sequence
from html import escape

from rich.text import Text

from gearopt.formulations.servo.servo_design import (
    BoxDesign,
    Spring,
    StiffnessDesign,
    TrainDesign,
)
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.report.drawing.layout_views import centre_distance
from gearopt.report.drawing.sheet import Drawing, Place, Point, Sheet, Window, around
from gearopt.report.kinds.servo.words import arc_minutes, degrees, design_of, report_of
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, bars, layout
from gearopt.report.section import Section, Table, Tile, records
from gearopt.report.words import amount, number

ROW, AXIS_HEIGHT = 44.0, 70.0  # px of a spring, and of the axis
WIDE, HIGH = 640.0, 760.0  # largest drawing [px]
MARGINS = (56.0, 56.0, 52.0, 52.0)  # px around it, for dimensions
COLOUR_1, COLOUR_2 = "--series-1", "--series-2"  # colours of both stages
FULL_SWEEP = 180.0  # deg to either side of the mesh line
OUTPUT = (0.0, 0.0)  # where the output shaft is drawn

Disc = tuple[Point, float]


def stiffness(result: Result, measures: Measures) -> Section | None:
    """Show springs in series, the softest first; None where the file asks for no stiffness."""
    design = design_of(result)
    chain = design.stiffness
    if chain is None:
        return None
    tiles = []
    if chain.windup_deg is not None:
        tiles.append(Tile("windup", degrees(chain.windup_deg), arc_minutes(chain.windup_deg)))
    if (varied := chain.windup_variation_deg) is not None:
        tiles.append(Tile("windup over a mesh, varies by", degrees(varied), arc_minutes(varied)))
    springs = sorted(chain.springs, key=lambda s: s.compliance_share)
    table, words = _springs(springs[::-1], measures), _stiffness_words(chain, measures)
    return Section(
        "Stiffness",
        tiles,
        figures=(_bars(springs, measures),),
        tables=(table,),
        half=design.drawn is not None,
        terminal=(table, *([] if report_of(result).given_stiffness else [words])),
    )


def _bars(springs: Sequence[Spring], measures: Measures) -> Figure:
    """Draw the share of every spring."""
    shares = [100.0 * s.compliance_share for s in springs]
    labels = [
        f"{escape(s.name)}: {share:.2f} %, alone "
        f"{amount(s.referred_Nm_per_rad, 'Nm_per_rad', measures)} at the output"
        for s, share in zip(springs, shares, strict=True)
    ]
    trace = bars(
        shares,
        [escape(s.name) for s in springs],
        {"color": "--series-1"},
        "%{customdata}<extra></extra>",
        customdata=labels,
        text=[f"{share:.1f} %" for share in shares],
        textposition="outside",
        cliponaxis=False,
    )
    plot = layout(
        axis("share of the compliance [%]", range=[0.0, 1.18 * max(shares)]),
        axis("", ticks=""),
        round(AXIS_HEIGHT + ROW * len(springs)),
        bargap=0.35,
        showlegend=False,
    )
    caption = "Share of every spring in the compliance seen at the output, the softest at the top."
    return Figure([trace], plot, caption)


def _springs(springs: Sequence[Spring], measures: Measures) -> Table:
    """The springs as a table."""
    heads, rows = records(springs, measures)
    alone = f"alone [{measures.unit('Nm_per_rad')}]"
    short = {heads[1]: "share of compliance, %", heads[2]: alone}
    return Table("springs", heads, rows, short=short)


def _stiffness_words(chain: StiffnessDesign, measures: Measures) -> str:
    """Say output stiffness, frequency and windup."""
    words = f"Seen at the output: {amount(chain.output_Nm_per_rad, 'Nm_per_rad', measures)}"
    if chain.frequency_Hz is not None:
        words += f"; the load swings at {number(chain.frequency_Hz)} Hz, motor locked"
    if chain.windup_deg is not None:
        words += f"; windup {degrees(chain.windup_deg)} ({arc_minutes(chain.windup_deg)})"
    if chain.windup_variation_deg is not None:
        words += f", of which {degrees(chain.windup_variation_deg)} come and go over a mesh"
    return f"{words}."


@dataclass(frozen=True)
class Axes:
    """Where the shafts are, with the output at OUTPUT, and what the train reaches; all in mm."""

    motor: Point
    middle: Point
    left: float
    right: float
    bottom: float
    top: float


def box(result: Result, measures: Measures) -> Section | None:
    """Draw the train in its box, and say whether it fits; None where no box is asked for."""
    design = design_of(result)
    fit, train = design.box, design.train
    if fit is None:
        return None
    words = (
        _box_words(fit, measures),
        f"Drawn to scale, dimensions in {measures.lengths}. Heavy: the box inside; thin dashed: "
        "the room that the train needs, which may be anywhere in it. Numbers in circles are "
        "shafts: 1 motor, 2 middle, 3 output. The last wheel is in a plane with pinion 2: motor "
        "and wheel 1 may lie over it, but not over the output shaft with its hub.",
    )
    angles = (
        f"from the output shaft to wheel 1 {degrees(fit.output_angle_deg)}, from wheel 1 to the "
        f"motor {degrees(fit.motor_angle_deg)}"
    )
    terminal = Text.assemble(
        (words[0], "" if fit.fits else "yellow"),
        f"\nAngles of the lines of centres, from the width: {angles}.",
    )
    drawing = _drawing(fit, train, measures)
    half = train is not None
    return Section(
        "Train and box", words=words, drawings=(drawing,), half=half, terminal=(terminal,)
    )


def _box_words(fit: BoxDesign, measures: Measures) -> str:
    """Say whether the train fits into its box, and what it needs."""
    verb = "fits" if fit.fits else "does not fit"
    inner = _size(fit.inner_width_mm, fit.inner_height_mm, measures)
    words = f"The train {verb}: it needs {needed_size(fit, measures)}, the box is {inner} inside."
    over = [
        f"{measures.length(needed - inside)} {measures.unit('mm')} in {side}"
        for side, needed, inside in (
            ("width", fit.needed_width_mm, fit.inner_width_mm),
            ("height", fit.needed_height_mm, fit.inner_height_mm),
        )
        if needed > inside and not fit.fits  # a box that is met exactly fits
    ]
    return f"{words} Too large by {' and '.join(over)}." if over else words


def needed_size(fit: BoxDesign, measures: Measures) -> str:
    """Width x height of the room that the train needs."""
    return _size(fit.needed_width_mm, fit.needed_height_mm, measures)


def _size(width: float, height: float, measures: Measures) -> str:
    return f"{measures.length(width)} x {measures.length(height)} {measures.unit('mm')}"


def axes(fit: BoxDesign) -> Axes:
    """Places of the shafts, and how far the train reaches to every side."""
    motor, output = math.radians(fit.motor_angle_deg), math.radians(fit.output_angle_deg)
    (a, b), (r1, r2, r4) = fit.links_mm, fit.radii_mm
    half = math.radians(fit.half_sweep_deg)
    middle = (b * math.cos(output), b * math.sin(output))
    first = (middle[0] + a * math.cos(motor), middle[1] + a * math.sin(motor))
    sides = []
    for turn in (0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi):
        ux, uy = math.cos(turn), math.sin(turn)
        off = abs((output - turn + math.pi) % (2.0 * math.pi) - math.pi)
        swept = r4 if off <= half else r4 * math.cos(off - half)
        reach = [x * ux + y * uy + r for (x, y), r in ((middle, r2), (first, r1))]
        sides.append(max(swept, fit.hub_mm, *reach))
    right, top, left, bottom = sides
    return Axes(first, middle, -left, right, -bottom, top)


def _drawing(fit: BoxDesign, train: TrainDesign | None, measures: Measures) -> Drawing:
    at = axes(fit)
    x, y = 0.5 * (at.left + at.right), 0.5 * (at.bottom + at.top)
    width, height = fit.inner_width_mm, fit.inner_height_mm
    inner = (x - width / 2, y - height / 2), (x + width / 2, y + height / 2)
    window = Window(
        min(at.left, inner[0][0]),
        max(at.right, inner[1][0]),
        min(at.bottom, inner[0][1]),
        max(at.top, inner[1][1]),
        MARGINS,
    )
    sheet = Sheet(window, window.scale(WIDE, HIGH))
    sheet.rectangle(*inner, "box", title="box, inside")
    needed = (at.left, at.bottom), (at.right, at.top)
    sheet.rectangle(*needed, "wall", title="needed room")
    _sector(sheet, fit, train, measures)
    wheel_1 = fit.radii_mm[1]  # pinion 2 may be the larger one on its shaft
    if train is not None:
        wheel_1 = 0.5 * train.stages[0].wheel_tip_diameter_mm
    _discs(sheet, fit, train, at, wheel_1, measures)
    _sizes(sheet, inner, needed, measures)
    a, b = fit.links_mm
    centre_distance(sheet, at.motor, at.middle, f"a1 = {measures.length(a)}")
    centre_distance(sheet, at.middle, OUTPUT, f"a2 = {measures.length(b)}")
    for k, place in enumerate((at.motor, at.middle, OUTPUT), 1):
        sheet.balloon(str(k), around(sheet.at(*place), (26.0, 36.0, 50.0, 66.0), 0.0))
    _write_name(sheet, "motor", at.motor, fit.motor_mm, "")
    _write_name(sheet, "hub", OUTPUT, fit.hub_mm, "")
    _write_name(sheet, "wheel 1", at.middle, wheel_1, COLOUR_1)
    discs = [(at.motor, fit.radii_mm[0]), (at.middle, fit.radii_mm[1])]
    _label_sector(sheet, fit, discs)
    caption = "Along the shafts" + ("; a mirror image fits as well." if fit.fits else ".")
    return sheet.drawing("the train in its box", caption)


def _discs(
    sheet: Sheet,
    fit: BoxDesign,
    train: TrainDesign | None,
    at: Axes,
    wheel_1: float,
    measures: Measures,
) -> None:
    """Draw wheel 1, motor, hub and middle shaft, and the pinions on the first two shafts."""

    def circle(place: Point, radius: float, style: str, label: str, colour: str = "") -> None:
        title = f"{label}: radius {measures.length(radius)} {measures.unit('mm')}"
        sheet.circle(*place, radius, style, colour, title)

    circle(at.middle, wheel_1, "tip", "wheel 1", COLOUR_1)
    circle(at.motor, fit.motor_mm, "motor", "motor")
    if fit.hub_mm > 0.0:
        circle(OUTPUT, fit.hub_mm, "shaft", "output shaft with hub")
    stages = () if train is None else train.stages
    marks = ((at.motor, COLOUR_1), (at.middle, COLOUR_2))
    for stage, (place, colour) in zip(stages, marks, strict=False):
        tip = 0.5 * stage.pinion_tip_diameter_mm
        circle(place, tip, "tip", f"pinion, z {stage.pinion_teeth}, tip", colour)
    if fit.shaft_mm > 0.0:
        circle(at.middle, fit.shaft_mm, "shaft", "shaft between the stages")
    radii = (*fit.radii_mm[:2], fit.hub_mm)
    for place, radius in zip((at.motor, at.middle, OUTPUT), radii, strict=True):
        sheet.cross(*place, radius)


def _sizes(
    sheet: Sheet, inner: tuple[Point, Point], needed: tuple[Point, Point], measures: Measures
) -> None:
    """Draw sizes of the box below and on the left, of the needed room above and on the right."""
    (x0, y0), (x1, y1) = inner
    below = sheet.height - 20.0 - sheet.at(0.0, y0)[1]
    sheet.dimension((x0, y0), (x1, y0), below, measures.length(x1 - x0))
    sheet.dimension((x0, y0), (x0, y1), sheet.at(x0, 0.0)[0] - 22.0, measures.length(y1 - y0))
    (x0, y0), (x1, y1) = needed
    above = 30.0 - sheet.at(0.0, y1)[1]
    sheet.dimension((x0, y1), (x1, y1), above, measures.length(x1 - x0))
    right = sheet.at(x1, 0.0)[0] - (sheet.width - 22.0)
    sheet.dimension((x1, y0), (x1, y1), right, measures.length(y1 - y0))


def _write_name(sheet: Sheet, name: str, at: Point, radius: float, colour: str) -> None:
    """Write a name inside its disc, or outside with a line to it."""
    centre, r = sheet.at(*at), radius * sheet.scale
    half = Place(0, 0).half_width(name)
    inside = around(centre, [share * r for share in (0.55, 0.7) if share * r > 18.0])
    inside = [p for p in inside if math.dist((p.x, p.y), centre) + 0.8 * half < r]
    outside = around(centre, (r + half + 6.0, r + half + 22.0), r, 20.0)
    sheet.label(name, inside + outside, "name" if colour else "obstacle", colour)


def _sector(sheet: Sheet, fit: BoxDesign, train: TrainDesign | None, measures: Measures) -> None:
    """Draw the swept area, and the sector in the middle of its travel where its size is known."""
    radius, half = fit.radii_mm[2], fit.half_sweep_deg
    size = f"radius {measures.length(radius)} {measures.unit('mm')}"
    label = f"swept area of the last wheel: {size}, ±{number(half)}°"
    style = "swept" if half < FULL_SWEEP else "tip"
    sheet.slice(OUTPUT, radius, _ends(fit, half), style, COLOUR_2, label)
    if train is None:
        return
    half_sector, stage = min(FULL_SWEEP * train.sector, half), train.stages[-1]
    label = f"wheel 2, z {stage.wheel_teeth}: {size}, sector of {number(2.0 * half_sector)}°"
    if half_sector < FULL_SWEEP:
        sheet.slice(OUTPUT, radius, _ends(fit, half_sector), "tip", COLOUR_2, label)
    reference = 0.5 * stage.wheel_diameter_mm
    sheet.slice(OUTPUT, reference, _ends(fit, half_sector), "reference", COLOUR_2, rim=True)


def _label_sector(sheet: Sheet, fit: BoxDesign, discs: Sequence[Disc]) -> None:
    """Name the last wheel and its sweep, where no disc (centre, radius) is."""
    half = fit.half_sweep_deg
    sheet.label("wheel 2", _on_rays(sheet, fit, 0.5 * min(half, 60.0), discs), "name", COLOUR_2)
    if half < FULL_SWEEP:
        rays = _on_rays(sheet, fit, 0.85 * half, discs)
        sheet.label(f"sweep ±{number(half)}°", rays, "name", COLOUR_2)


def _on_rays(sheet: Sheet, box: BoxDesign, off: float, discs: Sequence[Disc]) -> list[Place]:
    """Places some degrees to either side of the mesh line, from the rim inwards."""
    places = []
    for k, share in enumerate((0.8, 0.7, 0.6, 0.5, 0.42)):
        for side in (-1.0, 1.0):
            for more in (1.0, 0.8, 0.6):
                turn = math.radians(box.output_angle_deg + side * more * off)
                r = share * box.radii_mm[2]
                spot = r * math.cos(turn), r * math.sin(turn)
                inside = sum(math.dist(spot, centre) < size for centre, size in discs)
                places.append(Place(*sheet.at(*spot), 0.0, 0.5 * k + 20.0 * inside))
    return places


def _ends(fit: BoxDesign, half: float) -> tuple[float, float]:
    """Angles [rad] so many degrees to either side of the mesh line."""
    middle = fit.output_angle_deg
    return math.radians(middle - half), math.radians(middle + half)
