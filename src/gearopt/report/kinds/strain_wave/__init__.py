"""A strain wave gearing: it runs, how near its teeth come, what they carry, and its cutter."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from gearopt.formulations.strain_wave.cutter_report import CONJUGATE, CutterDesign
from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.formulations.strain_wave.exchange import CUTTING
from gearopt.formulations.strain_wave.shift import STEP_DEG
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.answer import asked, assumptions, limits, summary
from gearopt.report.drawing.sheet import Drawing, series
from gearopt.report.exports import drawn, listed
from gearopt.report.headline import exceeded, of_limits
from gearopt.report.kinds import Pages
from gearopt.report.kinds.generic import AFTER_DESIGN, CLOSING, OPENING, REQUEST
from gearopt.report.kinds.strain_wave import hob, tables
from gearopt.report.kinds.strain_wave.cutter import breadth, drawing, of_flanks, usual_scale
from gearopt.report.kinds.strain_wave.motion import running
from gearopt.report.measures import METRIC, Measures
from gearopt.report.plots import Figure, axis, band, layout, lines, upright
from gearopt.report.section import ROWS_ON_TERMINAL, Section, Tile
from gearopt.report.words import amount, micrometres, number, series_of

RUNS = "strain wave gearing"  # the animation that plots follow
ANGLE = "angle of the tooth on the wave [°]"
NEAR_DEG = 25.0  # of the wave, that the plot of clearances shows at least on either side
WIDEST = 1e4  # mm of a cutter's drawing
ROUNDING = 1e-6  # µm of a flank: less is that of the computation
BEYOND_DEG = 10.0  # and beyond the last contact


def design_of(result: Result) -> WaveDesign | None:
    """The gearing of a result; None without one."""
    if not result.design:
        return None
    gearing: WaveDesign = typed(WaveDesign, result.design, "design")
    return gearing


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Pressure, teeth that carry, clearance and size as key figures."""
    if (design := design_of(result)) is None:
        return []
    equal = amount(design.equal_pressure_MPa, "MPa", measures)
    touching = design.least_clearance_mm >= CUTTING
    least = max(0.0, design.least_clearance_mm) if touching else design.least_clearance_mm
    return [
        Tile(
            "contact pressure, load shared",
            amount(design.shared_pressure_MPa, "MPa", measures),
            f"{equal} if the conjugate pairs alone carried",
        ),
        Tile(
            "teeth that carry",
            f"{design.carrying_teeth} per lobe",
            f"equivalent to {number(design.effective_teeth)} equally loaded; "
            f"{number(design.pairs_in_contact)} are conjugate",
        ),
        Tile(
            "least clearance over the wave",
            amount(least, "um", measures),
            "where conjugate flanks touch" if touching else "interference",
        ),
        Tile(
            "outer diameter",
            amount(design.outer_diameter_mm, "mm", measures),
            f"module {amount(design.module_mm, 'mm', measures)}",
        ),
    ]


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Limits that a given gearing exceeds, and its loads; else the teeth and what decides."""
    if (design := design_of(result)) is None:
        return ""
    if result.value is None and design.least_clearance_mm < CUTTING:
        return ""
    if result.value is None:
        pressure = amount(design.shared_pressure_MPa, "MPa", measures)
        carry = "1 tooth per lobe carries the load"
        if design.carrying_teeth > 1:
            carry = f"{design.carrying_teeth} teeth per lobe carry the load"
        loads = f"{carry}, with a contact pressure of up to {pressure}"
        return "; ".join(filter(None, (exceeded(result), loads)))
    module, outer = (
        amount(size, "mm", measures) for size in (design.module_mm, design.outer_diameter_mm)
    )
    sizes = (
        f"{design.flexspline_teeth} and {design.circular_spline_teeth} teeth of module {module} "
        f"carry {amount(design.torque_Nm, 'Nm', measures)} in {outer}"
    )
    ends = [end.name.replace("_", " ") for end in design.range_ends]
    rest = f"; at ends of their ranges: {series_of(ends)}" if ends else ""
    return f"{sizes}; {of_limits(result)}{rest}"


def warns(result: Result, measures: Measures = METRIC) -> Sequence[str]:
    """Warnings: teeth that interfere, a cutter with a cusp."""
    if (design := design_of(result)) is None:
        return ()
    warnings = []
    if design.least_clearance_mm < CUTTING:
        overlap = micrometres(-design.least_clearance_mm, measures)
        teeth = "teeth"
        if design.cutter and design.cutter.forms:
            teeth = "conjugate teeth, but not those that the hob cuts,"
        warnings.append(
            f"Interference: {teeth} overlap by {overlap}, at "
            f"{design.least_clearance_at_deg:.3g}° from the major axis: loads and contact "
            "pressures are not valid."
        )
    if design.cutter and not design.cutter.regular:
        warnings.append(_cutter_words(design.cutter, measures)[0])
    return warnings


def moving(result: Result, measures: Measures) -> Section | None:
    """Show the gearing running, and clearances and loads over the wave."""
    if (design := design_of(result)) is None:
        return None
    loaded = max(design.load_N) > 0.0  # teeth absurdly stiff carry what is rounding of the torque
    return Section(
        "Teeth in mesh",
        words=(
            "Conjugate flanks touch without load. Other pairs come close; elastic deformation "
            "brings them into contact.",
        ),
        animations=[running(design, RUNS, measures)] if loaded else [],
        figures=[_clearances(design, measures), *([_loads(design, measures)] if loaded else [])],
        tables=[
            *(tables.within(design, measures), tables.teeth(design, measures)),
            *tables.over_wave(design, measures),
        ],
    )


def loaded_teeth(result: Result, measures: Measures) -> Section | None:
    """Teeth in mesh on the terminal: a table, evenly thinned where it is long."""
    if (design := design_of(result)) is None:
        return None
    whole = tables.teeth(design, measures)
    step = -(-len(whole.rows) // ROWS_ON_TERMINAL)
    rows = [
        row for row, tooth in zip(whole.rows, design.teeth, strict=True) if not tooth.tooth % step
    ]
    words = ("Some of the teeth; --csv, --html and --json hold all.",) if step > 1 else ()
    return Section("Teeth in mesh", terminal=(replace(whole, rows=rows), *words))


def _line(x: Sequence[float], y: Any, name: str, colour: int) -> dict[str, Any]:
    return lines(x, y, series(colour), name=name, hover="%{y:.4g}")


def _clearances(gearing: WaveDesign, measures: Measures) -> Figure:
    """Plot the clearance of a tooth near the arc of contact."""
    factor, unit = measures.of(1.0, "um"), measures.unit("um")
    each = [("clearance", gearing.wave_angle_deg, gearing.wave_clearance_mm, 1)]
    if (tool := gearing.cutter) and tool.forms:
        each.append(("clearance of the teeth as cut", tool.cut_wave_deg, tool.cut_clearance_mm, 4))
    most = max(NEAR_DEG, gearing.touching_deg[-1][1] + BEYOND_DEG)
    curves = []
    for name, angles, gaps, colour in each:
        near = [
            (a, factor * c) for a, c in zip(angles, gaps, strict=True) if -NEAR_DEG <= a <= most
        ]
        x, y = zip(*near, strict=True)
        curves.append(_line(x, y, name, colour))
    plot = layout(axis(ANGLE), axis(f"clearance [{unit}]"), hovermode="x")
    plot["shapes"] = [band(*ends) for ends in gearing.touching_deg]
    plot["margin"] |= {"t": 34} if len(each) > 1 else {}
    caption = "Least clearance of a tooth by its place on the wave; shaded: conjugate flanks touch."
    return Figure(curves, plot, caption, follows=RUNS)


def _loads(gearing: WaveDesign, measures: Measures) -> Figure:
    """Plot load and pressure of a tooth on its way over the wave."""
    force = measures.of(1.0, "N")
    load = [force * v for v in gearing.load_N]
    plot = layout(
        axis(ANGLE), axis(f"load [{measures.unit('N')}]", rangemode="tozero"), hovermode="x"
    )
    carrying = [a for a, v in zip(gearing.load_angle_deg, gearing.load_N, strict=True) if v > 0.0]
    room = 0.3 * (carrying[-1] - carrying[0])
    plot["xaxis"] |= {"range": [carrying[0] - room, carrying[-1] + room]}
    caption = "Load of a tooth at the duty's torque on its way over the wave."
    return Figure([_line(gearing.load_angle_deg, load, "load", 1)], plot, caption, follows=RUNS)


def shift(result: Result, measures: Measures) -> Section | None:
    """Plot the pressure against the profile shift, as the search of the paper had it."""
    design = design_of(result)
    if design is None or len(design.shifts) < 2:
        return None
    factor, x = measures.of(1.0, "MPa"), [r.profile_shift for r in design.shifts]
    curves = [
        _line(x, [factor * r.equal_MPa for r in design.shifts], "conjugate pairs", 1),
        _line(x, [factor * r.whole_MPa for r in design.shifts], "whole pairs", 2),
        _line(x, [factor * r.shared_MPa for r in design.shifts], "load shared", 4),
    ]
    plot = layout(
        axis("profile shift, modules"),
        axis(f"largest contact pressure [{measures.unit('MPa')}]", rangemode="tozero"),
        hovermode="x",
    )
    plot["margin"] |= {"t": 34}
    plot["shapes"] = [upright(design.profile_shift, layer="above")]
    caption = "Contact pressure against profile shift, all else unchanged; dotted: this gearing. "
    caption += "Whole pairs: the whole number of pairs that always touch carries the load."
    return Section(
        "Contact pressure against profile shift",
        words=_ends_of_shift(design),
        figures=[Figure(curves, plot, caption)],
        tables=[tables.shifts(design, measures)],
    )


def _ends_of_shift(gearing: WaveDesign) -> list[str]:
    """Limits that end a search over the profile shift."""
    words = _trend(gearing)
    if gearing.shift_of_one_pair is not None:
        words.append(
            f"One conjugate pair always touches up to a shift of {gearing.shift_of_one_pair:.3f}."
        )
    if gearing.largest_addendum is not None:
        words.append(
            f"With an addendum above about {gearing.largest_addendum:.2f} modules teeth would "
            f"interfere, with all other sizes unchanged (sought at steps of {STEP_DEG:g}° of the "
            "wave generator)."
        )
    return words


def _trend(gearing: WaveDesign) -> list[str]:
    """That every contact pressure falls, or rises, with the shift; nothing where it is not so."""
    rows = sorted(gearing.shifts, key=lambda row: row.profile_shift)
    steps = [
        getattr(after, name) - getattr(before, name)
        for before, after in pairwise(rows)
        for name in ("equal_MPa", "whole_MPa", "shared_MPa")
    ]
    for way, verb in ((-1.0, "falls"), (1.0, "rises")):
        if steps and all(way * step > 0.0 for step in steps):
            return [f"Over the shifts shown every contact pressure {verb} as the shift grows."]
    return []


def cutter(result: Result, measures: Measures) -> Section | None:
    """Draw the cutter's edge on a grid, with straight and circular edges that may replace it."""
    design = design_of(result)
    if design is None or (tool := design.cutter) is None:
        return None
    words = _cutter_words(tool, measures)
    if not tool.regular:
        return Section("Cutter of the flexspline", words=words, terminal=words)
    shown, pitch = result.report["cutter_drawing"], math.pi * design.module_mm
    grid = shown["grid_mm"]
    scale = shown["scale"] or usual_scale(tool, pitch, grid)
    edges = [tables.edges(tool, measures)] if tool.straight_deg else []
    if tool.forms:
        edges = hob.tables(tool, measures)
    drawings = [hob.mesh(design, tool, measures)] if tool.forms else []
    if (width := scale * breadth(tool, pitch, grid)) > WIDEST:
        wide = amount(width, "mm", measures)
        words = (*words, f"No drawing: at {scale:g}:1 it would be {wide} wide.")
    else:
        drawings.append(drawing(tool, pitch, scale, grid, measures))
    return Section(
        "Cutter of the flexspline",
        words=words,
        drawings=drawings,
        tables=[*edges, tables.edge_points(tool, measures)],
        terminal=(words[0], *edges[:1]),
    )


def _cutter_words(tool: CutterDesign, measures: Measures) -> tuple[str, ...]:
    if tool.generation != CONJUGATE:
        return hob.words(tool, measures)
    if not tool.regular:
        return (f"No such cutter: its edge would have a cusp. {_least(tool)}",)
    return (
        f"{_tool(tool)} that rolls on a pitch radius of "
        f"{amount(tool.pitch_radius_mm, 'mm', measures)} generates the flank {_generates(tool)}; "
        f"its edge has no cusp. {_least(tool)}",
    )


def _tool(tool: CutterDesign) -> str:
    return f"A pinion-type cutter of {tool.teeth} teeth" if tool.teeth else "A rack (as of a hob)"


def _generates(tool: CutterDesign) -> str:
    """How near the flank that the cutter generates comes to that of the design, in words."""
    off = 1e3 * tool.round_trip_mm
    return "to rounding" if off < ROUNDING else f"to within {off:.0e} µm"


def _least(tool: CutterDesign) -> str:
    """Smallest pinion-type cutter on the same pitch circle of the blank, in words."""
    if tool.least_teeth is None:
        return (
            "On this pitch circle of the blank the edge of every pinion-type cutter of up to 60 "
            "teeth has a cusp: another [cutter] pitch_diameter may do."
        )
    edge = "On this pitch circle the edge of a pinion-type cutter has no cusp"
    return f"{edge} from {tool.least_teeth} teeth on."


def flanks(result: Result) -> Iterator[Drawing]:
    """Yield the drawings of both flanks."""
    if (design := design_of(result)) is not None:
        yield from of_flanks(design)


def numbers(result: Result, measures: Measures) -> Section | None:
    """The gearing in numbers, its flank, and other deflections."""
    if (design := design_of(result)) is None:
        return None
    shown = tables.sizes(design, measures), tables.loads(design, measures)
    others = [tables.deflections(design, measures)] if design.deflections else []
    return Section(
        "Sizes and flanks",
        tables=[
            *(*shown, *others),
            *tables.points(design, measures),
        ],
        terminal=shown,
    )


def search(result: Result, measures: Measures) -> Section | None:
    """The rounds of a search; None without one."""
    design = design_of(result)
    if design is None or not design.rounds:
        return None
    words = (
        "Each round adds a limit where the flank of the last design cut the tip circle of the "
        "circular spline; then all positions of the wave are checked again.",
    )
    return Section("Search", words=words, tables=[tables.rounds(design, measures)], half=True)


OWN_SECTIONS = (moving, cutter, shift, numbers)
PAGES_OF_GIVEN = Pages(
    sections=(summary, *OWN_SECTIONS, limits, asked, assumptions),
    terminal=(numbers, loaded_teeth, cutter, limits, summary),
    tiles=tiles,
    binding_limit=binding_limit,
    warns=warns,
    whole="gearing",
)
PAGES = replace(
    PAGES_OF_GIVEN,
    sections=(*OPENING, *OWN_SECTIONS, *REQUEST, search, *CLOSING),
    terminal=(numbers, loaded_teeth, cutter, limits, *AFTER_DESIGN),
    exports={
        "dxf": drawn(cutter, also=flanks),
        "csv": listed(numbers, cutter, lacking="there are no flanks to export", ending="flank"),
    },
    pages_of_given=PAGES_OF_GIVEN,
)
