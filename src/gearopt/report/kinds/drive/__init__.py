"""Drives of cylindrical gears, laid out or not: drawings, stages, processes, next best trains."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.drive.layout.layout_design import LayoutDesign
from gearopt.optimise.result import Result
from gearopt.report.answer import asked, assumptions, limits, summary
from gearopt.report.design_tables import (
    ratio_text,
    ratio_tile,
    teeth_head,
    teeth_heads,
    trains,
)
from gearopt.report.drawing import layout_views, mesh_view, train_views
from gearopt.report.drawing.bodies import layout_of
from gearopt.report.drawing.impossible_views import section as impossible
from gearopt.report.explained import remedies
from gearopt.report.exports import drawn, gears, listed, solids
from gearopt.report.headline import of_limits
from gearopt.report.kinds import Pages
from gearopt.report.kinds.drive import (
    drawing_tables,
    impossible_layout,
    layout_solid,
    planetary,
    rating_gears,
    rating_tables,
    rating_words,
)
from gearopt.report.kinds.generic import AFTER_DESIGN, CLOSING, REQUEST
from gearopt.report.measures import METRIC, Measures, gap_percent, rounded
from gearopt.report.section import Cell, Section, Table, Tile, cell
from gearopt.report.words import (
    MODULE,
    REACHED,
    RULED,
    VERDICTS,
    amount,
    grouped,
    heading,
    limit_words,
    number,
    objective,
    parted,
    series_of,
    violation_words,
)
from gearopt.scenes.drive.rexs.writing import rexs

DRAWN = ("layout", "bearings", "clearances", "motor")  # tables of a layout
WALL_TOLERANCE = 1e-6  # of the box: a gear so near to a wall's clearance is at it
STAGED = {  # tables of a layout: keys that the table of stages or the box shows
    "shafts": ("from_mm", "to_mm"),
    "gears": (
        *("stage", "member", "teeth", "normal_module_mm", "reference_diameter_mm"),
        *("tip_diameter_mm", "root_diameter_mm", "helix_angle_deg"),
        *("pressure_angle_deg", "profile_shift", "tip_alteration", "thickness_allowance_mm"),
        *("addendum", "tool_addendum", "tool_tip_radius", "tool_protuberance", "hand"),
    ),
    "gaps": ("axes_mm",),
    "obstacles": ("from_mm", "to_mm"),
}
NO_TABLE = "this drive has no CSV to export; tables [drawing] and [layout] ask for one each"
OF_STAGE = {"ratio": "ratio u", "centre_distance_mm": "a", "face_width_mm": "b"}
OF_DRIVE = ("ratio", "ratio_error_percent", "gear_volume_mm3")


def _with_gears(result: Result) -> tuple[Result, str]:
    """The result, or the gears of a box that has no design; their heading."""
    gears = next((part for part in result.parts if part.name == "gears" and part.design), None)
    if result.design or gears is None:
        return result, ""
    return replace(gears, scene=result.scene), "Gears to be laid out"


def gears_first(result: Result, measures: Measures) -> Section | None:
    """The gears that were sized first and cannot be laid out, for the terminal."""
    shown, heading = _with_gears(result)
    if not heading or (sized := rating_tables.design(shown, measures)) is None:
        return None
    return replace(sized, terminal=(f"{heading}:", *sized.terminal))


def numbers(result: Result, measures: Measures) -> Section | None:
    """All tables of the design; of a layout what its stages and drawings do not show."""
    result, sized = _with_gears(result)
    if (whole := rating_tables.design(result, measures)) is None:
        return None
    if result.design.get("rating"):
        rest = [rating_tables.beside(table, result, measures) for table in whole.tables]
        whole = replace(
            whole, tables=rest, half=len(result.design["stages"]) <= rating_tables.ABREAST
        )
    shown = [
        replace(t, csv_only=[heading(key, measures) for key in STAGED.get(t.name, ())])
        if t.name in STAGED
        else replace(t, folded=t.name in DRAWN)
        for t in whole.tables
    ]
    named = sized or whole.heading
    return replace(whole, heading=named, tables=sorted(shown, key=lambda t: t.folded))


def limits_shown_as_gaps(result: Result) -> set[str]:
    """The limits of a layout that its table of gaps shows in mm."""
    gaps = result.design.get("layout", {}).get("gaps", ())
    return {" to ".join(gap["between"]).replace(" ", "_") for gap in gaps}


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Gears and gaps that decide the box of a layout; nothing without one, where limits say it."""
    if result.value is None or (layout := layout_of(result)) is None:
        return ""
    gaps = limits_shown_as_gaps(result)
    full = [n for n in gaps if result.limits.get(n, 0.0) >= 1.0 - REACHED]
    walls, apart = _at_walls(layout), any(part.name == "gears" for part in result.parts)
    first = "the gears were sized first" if apart else "gears and box were chosen at once"
    words = [first, *([f"{series_of(walls)} reach the wall clearance"] if walls else [])]
    words += [f"{series_of(list(map(limit_words, full)))} at the minimum clearance"] if full else []
    return "; ".join(words if apart else [*words, of_limits(result, gaps)])


def _at_walls(layout: LayoutDesign) -> list[str]:
    """The gears that reach to the clearance of a wall, seen along the shafts."""
    places, box, wall = {s.shaft: s for s in layout.shafts}, layout.box, layout.clearances.wall_mm
    near = WALL_TOLERANCE * max(box.sides)
    sides = {"y": (box.left_mm, box.width_mm), "z": (box.bottom_mm, box.height_mm)}
    names = []
    for gear in layout.gears:
        for axis_, (start, size) in sides.items():
            at, r = getattr(places[gear.shaft], f"{axis_}_mm"), 0.5 * gear.tip_diameter_mm
            free = min(at - r - start, start + size - at - r) - wall
            if free < near and gear.name not in names:
                names.append(gear.name)
    return names


def places(result: Result, measures: Measures) -> Section | None:
    """Box, shafts and gaps; None where there is no layout."""
    if result.value is None or (layout := layout_of(result)) is None:
        return None
    unit = measures.unit("mm")
    sides = " x ".join(map(measures.length, layout.box.sides))
    rows = [
        [f"{words} [{unit}]", *(cell(v, "mm", measures) for v in values)]
        for words, values in (
            ("y, right of the input", [s.y_mm for s in layout.shafts]),
            ("z, above the input", [s.z_mm for s in layout.shafts]),
            ("diameter", [s.diameter_mm for s in layout.shafts]),
        )
    ]
    table = Table("places of shafts", ["", *(f"shaft {s.shaft}" for s in layout.shafts)], rows)
    slabs = ", ".join(" and ".join(map(str, slab)) for slab in layout.slabs)
    heads = ("gap", unit, f"minimum, {unit}")
    gaps = [
        [" to ".join(g.between), *(cell(v, "mm", measures) for v in (g.gap_mm, g.needed_mm))]
        for g in layout.gaps
    ]
    size = f"Box {sides} {unit} (width, height, length). Stages along the shafts: {slabs}."
    return Section("Layout", terminal=(size, table, Table("gaps", heads, gaps)))


def processes(result: Result, measures: Measures) -> Section | None:
    """The designs as columns; None where the file asks for no process.

    The first column is the result itself, or the gears that its layout is of.
    """
    best = next((part for part in result.parts if part.name == "gears"), result)
    ruled = [part for part in best.parts if part.name in RULED]
    if best.value is None or not ruled:
        return None
    missing = [_missing(part) for part in ruled if part.value is None]
    designs = [best, *(part for part in ruled if part.design)]
    heads = ["", best.method, *(part.name for part in designs[1:])]
    rows = [*_stages(designs, measures), *_totals(designs, best.bound, measures)]
    rows += rating_words.least_safeties(designs)
    words = (
        "Processes follow design rules, without a search; limits and bound are those of the drive."
    )
    stages = len(best.design["stages"])
    table = Table(
        "processes and optimum",
        heads,
        rows,
        across=True,
        csv_only=[*_labels(stages, *teeth_heads(measures)), best.method],
        read_only=_labels(stages, teeth_head(measures)),
    )
    shown: list[str | Table] = [table, *missing] if result.value is not None else []
    names = ["optimum" if best.method == "exact" else best.method, *heads[2:]]
    trains = {name: design.design["stages"] for name, design in zip(names, designs, strict=True)}
    drawings = train_views.beside(trains, measures) if len(designs) > 1 else ()
    return Section(
        "Processes and optimum",
        (),
        (words, *missing),
        drawings,
        tables=(table,),
        appendix=True,
        terminal=shown,
    )


def _stages(designs: Sequence[Result], measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for k in range(len(designs[0].design["stages"])):
        stages = [design.design["stages"][k] for design in designs]
        gears = [
            (measures.of_module(s[MODULE]), s["pinion_teeth"], s["wheel_teeth"]) for s in stages
        ]
        teeth = [f"{number(m)}, {number(a)}/{number(b)}" for m, a, b in gears]
        rows.append([f"stage {k + 1}: {teeth_head(measures)}", *teeth])
        for label, each in zip(teeth_heads(measures), zip(*gears, strict=True), strict=True):
            rows.append([f"stage {k + 1}: {label}", *each])
        for key, label in OF_STAGE.items():
            unit = parted(key)[1]
            sign = f" [{measures.unit(unit)}]" if unit else ""
            values = (cell(s[key], unit, measures) for s in stages)
            rows.append([f"stage {k + 1}: {label}{sign}", *values])
    return rows


def _labels(stages: int, *labels: str) -> list[str]:
    return [f"stage {k}: {label}" for k in range(1, stages + 1) for label in labels]


def _totals(designs: Sequence[Result], bound: float | None, measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for key in OF_DRIVE:
        values = [cell(design.design[key], parted(key)[1], measures) for design in designs]
        if key == "ratio":
            errors = (design.design["ratio_error_percent"] for design in designs)
            both = zip(values, errors, strict=True)
            values = [replace(shown, text=ratio_text(shown.value, error)) for shown, error in both]
        rows.append([heading(key, measures), *values])
    name, unit = objective(designs[0])
    if name != "gear volume":
        shown = (cell(design.value, unit, measures) for design in designs)
        rows.append([f"{name} [{measures.unit(unit)}]", *shown])
    if bound is not None and bound > 0.0:
        over = (cell(_over(design, bound), "percent", measures) for design in designs)
        rows.append(["above the bound [%]", *over])
    return rows


def _over(result: Result, bound: float) -> float | None:
    """Excess of a design over the bound [%]; None where it breaks a limit."""
    return None if result.value is None else max(100.0 * (result.value / bound - 1.0), 0.0)


def _missing(part: Result) -> str:
    """Say why a process has no design that counts, and which limit is violated."""
    shown = "The design" if part.design else "No design"
    return f"{shown} by {part.name}: {violation_words(part.message)}".rstrip(". ") + "."


def counts(result: Result, measures: Measures) -> Section | None:
    """Every number of stages that was solved; None where the file gives one."""
    gears = (part for part in result.parts if part.name == "gears")
    counted = next(
        (candidate for candidate in (result, *gears) if candidate.report.get("counts")), None
    )
    if counted is None:
        return None
    rows, (name, unit) = counted.report["counts"], objective(counted)
    sign = f"\n[{measures.unit(unit)}]" if unit else ""
    most = max(len(row["ratios"]) for row in rows)
    heads: tuple[str, ...] = teeth_heads(measures)
    single = [f"{words} {k}" for k in range(1, most + 1) for words in ("ratio", *heads)]
    long = (f"{name}{sign}", "above the best,\n%", f"bound{sign}", "gap,\n%")
    names = {head.replace("\n", " "): head for head in long}
    read = ("ratio of each stage", teeth_head(measures))
    typed = "types" in rows[0]
    heads = ("types" if typed else "stages", "status", *names, *read, "seconds", *single)
    cells = [[*_count(row, counted, measures), *_each(row, most, measures)] for row in rows]
    table = Table(
        "types of stages" if typed else "numbers of stages",
        heads,
        cells,
        page_only=(*[*names][2:], read[1]),
        csv_only=single,
        read_only=read,
        short=names,
        left=2,
        wrap=9,
    )
    words = [
        f"Impossible with {row.get('types') or _number(row['stages'])}: "
        f"{series_of(grouped(row['conflict']))} cannot be met"
        f"{' together' * (len(row['conflict']) > 1)}."
        for row in rows
        if row["conflict"]
    ]
    shown = (table, "\n".join(words)) if words else (table,)
    title = "Types of the stages" if typed else "Number of stages"
    return Section(title, words=words, tables=(table,), appendix=True, terminal=shown)


def _number(stages: int) -> str:
    return f"{stages} {'stage' if stages == 1 else 'stages'}"


def _count(row: Mapping[str, Any], best: Result, measures: Measures) -> list[Any]:
    """Number, status, objective and bound of a number of stages."""
    unit, value, bound, gap = objective(best)[1], row["objective"], row["bound"], row["gap"]
    more = None if value is None or not best.value else 100.0 * (value / best.value - 1.0)
    beyond = row["status"] == "limit" and None not in (bound, best.value) and bound > best.value
    return [
        row.get("types", row["stages"]),
        "not better, by its bound" if beyond else VERDICTS[row["status"]][0],
        cell(value, unit, measures),
        None if more is None else Cell(more, f"{more:.2f}"),
        None if bound is None else Cell(measures.of(bound, unit), measures.number(bound, unit, -1)),
        None if gap is None else Cell(100.0 * gap, gap_percent(gap).rstrip(" %")),
    ]


def _each(row: Mapping[str, Any], most: int, measures: Measures) -> list[Any]:
    """Ratios, gears and seconds of a number of stages; then each ratio and gear alone."""
    modules = map(measures.of_module, row["modules_mm"])
    gears = list(zip(row["ratios"], modules, row["teeth"], strict=True))
    teeth = "; ".join(f"{number(m)}, {'/'.join(map(number, each))}" for _, m, each in gears)
    single = [value for u, m, (a, b, *_) in gears for value in (u, m, a, b)]
    return [
        "  ".join(f"{u:.3f}" for u, *_ in gears),
        teeth,
        Cell(row["seconds"], f"{row['seconds']:.2g}"),
        *single,
        *[None] * (4 * (most - len(gears))),
    ]


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Ratio, torque, mass and box as key figures."""
    if not result.design:
        return []
    design = drive_design(result.design)
    torque = amount(design.output_torque_Nm, "Nm", measures)
    figures = [
        ratio_tile(design.ratio, design.ratio_error_percent),
        Tile("output torque", torque),
    ]
    if objective(result)[0] != "mass":
        figures.append(Tile("mass of the gears", amount(design.mass_kg, "kg", measures)))
    if design.layout is not None:
        sides = " x ".join(measures.length(side, 1) for side in design.layout.box.sides)
        size = f"{sides} {measures.unit('mm')}"
        figures.append(Tile("box", size, "width, height, length"))
    return [*figures, *rating_words.tiles(result, measures)]


def sentences_on_parts(result: Result, measures: Measures) -> list[str]:
    """Compare with other optima: real-valued sizes, or gears first and then the layout."""
    sentences = []
    if result.status == "infeasible" and "least_violation" in result.proof:
        sentences.append("This holds even with real-valued teeth and modules.")
    for part in result.parts:
        alike = part.objective.get("name") == result.objective.get("name")
        if part.name in ("sizing", "apart") and alike and result.status == "optimal":
            sentences += _other_way(result, part)
        if part.name == "sizing" and result.status == "limit" and result.value is None:
            sentences += _instead(part, measures)
    return sentences


def _other_way(result: Result, part: Result) -> list[str]:
    if part.value is None or result.value is None:
        return []
    more, name = percent_more(result.value, part.value), objective(result)[0]
    if part.name == "apart":
        other = "if the gears are sized first and laid out afterwards"
        return [f"The {name} is {more} % smaller than {other}."]
    other = "with real-valued ones"
    return [f"With whole teeth and standard modules the {name} is {more} % larger than {other}."]


def percent_more(value: float, other: float) -> str:
    """Difference of two values in per cent."""
    return rounded(abs(100.0 * (value / other - 1.0)), 3)


def _instead(part: Result, measures: Measures) -> list[str]:
    """Report the design with real-valued teeth where the run has none with whole teeth."""
    name, unit = objective(part)
    if part.value is None or part.bound is None:
        return []
    least = amount(part.bound, unit, measures, part.value)
    return [
        f"With real-valued teeth and modules a {name} of {amount(part.value, unit, measures)} is "
        f"feasible; with whole teeth no design is below {least}."
    ]


def _in_one_line(result: Result, measures: Measures) -> Section | None:
    """Draw the gears; None where they are laid out."""
    asks = "A [layout] table in the file places the gears in the smallest box."
    shown, sized = _with_gears(result)
    stages = shown.design.get("stages", ())
    not_laid = any(
        stage.get("idler") or stage.get("driver") == "wheel" or "type" in stage for stage in stages
    )
    hint = "" if sized or not_laid or result.status == "evaluated" else asks
    if (drawn := train_views.section(shown, measures)) is None:
        return None
    named = f"{sized}, all shafts in one plane" if sized else drawn.heading
    return replace(drawn, heading=named, hint=hint)


DRAWINGS = (layout_views.section, layout_solid.section, _in_one_line, planetary.turning)
CAPACITIES = rating_gears.gears, rating_gears.static
RATINGS = (
    *(rating_gears.gears, rating_tables.forces, rating_gears.factors),
    *(rating_gears.levels, rating_gears.static, mesh_view.section, rating_tables.teeth),
    drawing_tables.section,
)
PAGES_OF_GIVEN = Pages(
    sections=(
        *(summary, asked, *RATINGS[:2], *DRAWINGS, *RATINGS[2:]),
        *(planetary.loads, numbers, assumptions),
    ),
    terminal=(*CAPACITIES, planetary.loads, rating_gears.factors, rating_tables.forces)
    + (drawing_tables.section,),
    tiles=rating_words.tiles,
    binding_limit=rating_words.binding_limit,
    figures=rating_words.figures,
    warns=rating_words.warns,
)
PAGES = Pages(
    sections=(
        *(summary, remedies, impossible, impossible_layout.section),
        *DRAWINGS,
        asked,
        numbers,
        planetary.loads,
        *RATINGS,
        processes,
        counts,
        *REQUEST,
        trains,
        *CLOSING,
    ),
    terminal=(
        rating_tables.design,
        planetary.loads,
        gears_first,
        places,
        counts,
        limits,
        *CAPACITIES,
        drawing_tables.section,
        trains,
        processes,
        *AFTER_DESIGN,
    ),
    tiles=tiles,
    sentences_on_parts=sentences_on_parts,
    elsewhere=limits_shown_as_gaps,
    binding_limit=binding_limit,
    warns=rating_words.warns,
    whole="drive",
    exports={
        "dxf": drawn(layout_views.section, train_views.section, also=gears),
        "step": solids,
        "csv": listed(places, drawing_tables.section, lacking=NO_TABLE),
        "rexs": rexs,
    },
    pages_of_given=PAGES_OF_GIVEN,
)
