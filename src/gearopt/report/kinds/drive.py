"""Drives of cylindrical gears, laid out or not: drawings, stages, processes, next best trains."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.formulations.design import drive_design
from gearopt.optimise.result import Result
from gearopt.report.answer import limits
from gearopt.report.design_tables import ratio_tile, tables, trains
from gearopt.report.kinds import Kind
from gearopt.report.kinds.generic import ASKED, FIRST, LAST, TOLD
from gearopt.report.measures import Measures
from gearopt.report.pages import impossible_layout, layout_solid, layout_views, train_views
from gearopt.report.pages.bodies import layout_of
from gearopt.report.section import Cell, Figure, Section, Table, Tile, axis, layout
from gearopt.report.words import (
    RULED,
    VERDICTS,
    amount,
    heading,
    limit_words,
    number,
    objective,
    parted,
)

NARROWEST = 3  # gaps that are named
OF_STAGE = {"ratio": "ratio u", "centre_distance_mm": "a", "face_width_mm": "b"}
OF_DRIVE = ("ratio", "ratio_error_percent", "gear_volume_mm3")
LINES = 6  # of equal area


def places(result: Result, measures: Measures) -> Section | None:
    """Return box, shafts and narrowest gaps; None where there is no layout."""
    if result.value is None or (found := layout_of(result)) is None:
        return None
    box, unit = found.box, measures.unit("mm")
    sides = " x ".join(map(measures.length, box.sides))
    volume = amount(box.volume_mm3, "mm3", measures)
    rows = [
        [f"{words} [{unit}]", *(Cell(v, measures.length(v)) for v in values)]
        for words, values in (
            ("y, right of the input", [s.y_mm for s in found.shafts]),
            ("z, above the input", [s.z_mm for s in found.shafts]),
            ("diameter", [s.diameter_mm for s in found.shafts]),
        )
    ]
    table = Table("places of shafts", ["", *(f"shaft {s.shaft}" for s in found.shafts)], rows)
    slabs = ", ".join(" and ".join(map(str, slab)) for slab in found.slabs)
    gaps = [
        f"Clearance of {' to '.join(gap.between)}: {measures.length(gap.gap_mm)} {unit} "
        f"(minimum {measures.of(gap.needed_mm, 'mm'):.4g} {unit})"
        for gap in found.gaps[:NARROWEST]
    ]
    last = "\n".join([f"Stages along the shafts: {slabs}.", *gaps])
    size = f"box {sides} {unit} (width, height, length), {volume}"
    return Section("Layout", terminal=(size, table, last))


def processes(result: Result, measures: Measures) -> Section | None:
    """Return the designs as columns; None where the file asks for no process.

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
    words = "The processes follow design rules, without a search; limits and bound are the same."
    table = Table("processes and optimum", heads, rows)
    shown: list[str | Table] = [table, *missing] if result.value is not None else []
    names = ["optimum" if best.method == "exact" else best.method, *heads[2:]]
    trains = {name: one.design["stages"] for name, one in zip(names, designs, strict=True)}
    drawings = train_views.beside(trains, measures) if len(designs) > 1 else ()
    return Section(
        "Processes and optimum", (), (words, *missing), drawings, tables=(table,), terminal=shown
    )


def _stages(designs: Sequence[Result], measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for k in range(len(designs[0].design["stages"])):
        stages = [one.design["stages"][k] for one in designs]
        teeth = [
            f"{number(s['normal_module_mm'])}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in stages
        ]
        rows.append([f"stage {k + 1}: m_n, z1/z2", *teeth])
        for key, label in OF_STAGE.items():
            unit = parted(key)[1]
            sign = f" [{measures.unit(unit)}]" if unit else ""
            values = (measures.of(s[key], unit) for s in stages)
            rows.append([f"stage {k + 1}: {label}{sign}", *values])
    return rows


def _totals(designs: Sequence[Result], bound: float | None, measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for key in OF_DRIVE:
        values = (measures.of(one.design[key], parted(key)[1]) for one in designs)
        rows.append([heading(key, measures), *values])
    name, unit = objective(designs[0])
    if name != "gear volume":
        shown = (None if one.value is None else measures.of(one.value, unit) for one in designs)
        rows.append([f"{name} [{measures.unit(unit)}]", *shown])
    if bound is not None and bound > 0.0:
        rows.append(["above the bound [%]", *(_over(one, bound) for one in designs)])
    return rows


def _over(one: Result, bound: float) -> float | None:
    """Return by how much a design exceeds the bound [%]; None where it breaks a limit."""
    return None if one.value is None else max(100.0 * (one.value / bound - 1.0), 0.0)


def _missing(part: Result) -> str:
    """Say why a process has no design that counts, and which limit is violated."""
    first, _, rest = part.message.partition(" ")
    shown = "The design" if part.design else "No design"
    return f"{shown} by {part.name}: {limit_words(first)} {rest}".rstrip(". ") + "."


def counts(result: Result, measures: Measures) -> Section | None:
    """Return every number of stages that was solved; None where the file gives one."""
    gears = (part for part in result.parts if part.name == "gears")
    found = next((one for one in (result, *gears) if one.report.get("counts")), None)
    if found is None:
        return None
    rows, (name, unit) = found.report["counts"], objective(found)
    sign = f"\n[{measures.unit(unit)}]" if unit else ""
    long = (f"{name}{sign}", "above the best,\n%", f"bound{sign}", "gap,\n%")
    names = {head.replace("\n", " "): head for head in long}
    heads = ("stages", "status", *names, "ratio of each stage", "m_n, z1/z2", "seconds")
    cells = [[*_count(row, found, measures), *_each(row)] for row in rows]
    hidden = (*[*names][2:], "m_n, z1/z2")
    table = Table("numbers of stages", heads, cells, page_only=hidden, short=names, left=2, wrap=9)
    words = [
        f"Impossible with {row['stages']} {'stage' if row['stages'] == 1 else 'stages'}: in "
        f"conflict are {', '.join(limit_words(n) for n in row['conflict'])}."
        for row in rows
        if row["conflict"]
    ]
    shown = (table, "\n".join(words)) if words else (table,)
    return Section("Number of stages", words=words, tables=(table,), terminal=shown)


def _count(row: Mapping[str, Any], best: Result, measures: Measures) -> list[Any]:
    """Return number, status, objective and bound of a number of stages."""
    unit, value, bound, gap = objective(best)[1], row["objective"], row["bound"], row["gap"]
    more = None if value is None or not best.value else 100.0 * (value / best.value - 1.0)
    beyond = row["status"] == "limit" and None not in (bound, best.value) and bound > best.value
    return [
        row["stages"],
        "not better, by its bound" if beyond else VERDICTS[row["status"]][0],
        None if value is None else measures.of(value, unit),
        None if more is None else Cell(more, f"{more:.2f}"),
        None if bound is None else measures.of(bound, unit),
        None if gap is None else Cell(100.0 * gap, f"{100.0 * gap:.3g}"),
    ]


def _each(row: Mapping[str, Any]) -> list[Any]:
    """Return ratios, gears and seconds of a number of stages."""
    ratios = row["ratios"]
    gears = zip(row["modules_mm"], row["teeth"], strict=True)
    teeth = "  ".join(f"{number(m)}, {number(a)}/{number(b)}" for m, (a, b) in gears)
    return [
        Cell(ratios, "  ".join(f"{u:.3f}" for u in ratios)),
        teeth,
        Cell(row["seconds"], f"{row['seconds']:.2g}"),
    ]


def trade_off(result: Result, measures: Measures) -> Section | None:
    """Plot the Pareto front of box width and height; None where the run computed none."""
    front = result.report.get("front") or []
    if not front:
        return None
    keys = ("width_mm", "height_mm", "volume_mm3")
    points = sorted([measures.of(p[key], parted(key)[1]) for key in keys] for p in front)
    unit, volume = measures.unit("mm"), measures.unit("mm3")
    widths, heights, volumes = zip(*points, strict=True)
    x0, x1 = _ends(widths)
    y0, y1 = _ends(heights)
    low, high = x0 * y0, x1 * y1
    areas = [low * (high / low) ** ((k + 0.5) / LINES) for k in range(LINES)]
    traces = [_equal(area, (x0, x1), (y0, y1), measures) for area in areas]
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "boxes",
            "x": widths,
            "y": heights,
            "text": [f"{number(v)} {volume}" for v in volumes],
            "hovertemplate": f"%{{x:.2f}} x %{{y:.2f}} {unit}, %{{text}}<extra></extra>",
            "marker": {"color": "--series-1", "size": 8},
            "showlegend": False,
        }
    )
    best = min(points, key=lambda p: p[2])
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "minimum volume",
            "x": [best[0]],
            "y": [best[1]],
            "hovertemplate": f"minimum volume: {number(best[2])} {volume}<extra></extra>",
            "marker": {"color": "--series-2", "size": 13, "symbol": "star"},
        }
    )
    plot = layout(
        axis(f"width [{unit}]", range=[x0, x1]), axis(f"height [{unit}]", range=[y0, y1]), 420
    )
    words = (
        f"Pareto front: {len(points)} boxes, none of them dominated in width and height. "
        "Dotted lines: equal area of the front face."
    )
    return Section("Width against height", figures=(Figure(traces, plot, words),))


def _ends(values: tuple[float, ...]) -> tuple[float, float]:
    room = 0.08 * (max(values) - min(values)) or 0.05 * max(values)
    return max(min(values) - room, 0.5 * min(values)), max(values) + room


def _equal(
    area: float, across: tuple[float, float], up: tuple[float, float], measures: Measures
) -> dict[str, Any]:
    """Return a line of equal area through the plot, named near its upper end."""
    start, end = max(across[0], area / up[1]), min(across[1], area / up[0])
    x = [start * (end / start) ** (k / 40) for k in range(41)]
    metric = measures.unit("mm2") == "mm²"
    shown, unit = (area / 100.0, "cm²") if metric else (area, measures.unit("mm2"))
    name = f"{shown:,.{0 if shown > 100.0 else 1}f} {unit}"
    return {
        "type": "scatter",
        "mode": "lines+text",
        "x": x,
        "y": [area / v for v in x],
        "text": [name if k == 2 else "" for k in range(41)],
        "textposition": "top right",
        "textfont": {"size": 11, "color": "--soft"},
        "line": {"color": "--axis", "width": 1, "dash": "dot"},
        "hoverinfo": "skip",
        "showlegend": False,
    }


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Return ratio, torque, mass and box as key figures."""
    if not result.design:
        return []
    design = drive_design(result.design)
    torque = amount(design.output_torque_Nm, "Nm", measures)
    found = [
        ratio_tile(design.ratio, design.ratio_error_percent),
        Tile("output torque", torque),
    ]
    if objective(result)[0] != "mass":
        found.append(Tile("mass of the gears", amount(design.mass_kg, "kg", measures)))
    if design.layout is not None:
        sides = " x ".join(measures.length(side, 1) for side in design.layout.box.sides)
        size = f"{sides} {measures.unit('mm')}"
        found.append(Tile("box", size, "width, height, length"))
    return found


def beside(result: Result, measures: Measures) -> list[str]:
    """Compare with other optima: real-valued sizes, or gears first and then the layout."""
    found = []
    if result.status == "infeasible" and "least_violation" in result.proof:
        found.append("This holds even with real-valued teeth and modules.")
    for part in result.parts:
        alike = part.objective["name"] == result.objective["name"]
        if part.name in ("sizing", "apart") and alike and result.status == "optimal":
            found += _other_way(result, part, measures)
        if part.name == "sizing" and result.status == "limit" and result.value is None:
            found += _instead(part, measures)
    return found


def _other_way(result: Result, part: Result, measures: Measures) -> list[str]:
    if part.value is None or result.value is None:
        return []
    more = 100 * (result.value / part.value - 1)
    value = amount(part.value, objective(result)[1], measures)
    if part.name == "apart":
        less = f"{-more:.2f}".replace("-0.00", "0.00")
        words = f"Gears optimised first, then the layout: {value}"
        return [f"{words} (optimised together: {less} % smaller)."]
    cost = f"{more:.2f}".replace("-0.00", "0.00")
    return [
        f"With real-valued teeth and modules: {value} "
        f"(whole teeth and standard modules add {cost} %)."
    ]


def _instead(part: Result, measures: Measures) -> list[str]:
    """Report the design with real-valued teeth where the run has none with whole teeth."""
    name, unit = objective(part)
    if part.value is None or part.bound is None:
        return []
    return [
        f"With real-valued teeth and modules a {name} of {amount(part.value, unit, measures)} is "
        f"feasible; with whole teeth no design is below {amount(part.bound, unit, measures)}."
    ]


def _in_one_line(result: Result, measures: Measures) -> Section | None:
    """Draw the gears; None where they are laid out."""
    hint = " A [layout] table in the file places the gears in the smallest box."
    return train_views.section(result, measures, hint)


KIND = Kind(
    sections=(
        *FIRST,
        impossible_layout.section,
        layout_views.section,
        layout_solid.section,
        _in_one_line,
        processes,
        counts,
        tables,
        *ASKED,
        trains,
        trade_off,
        *LAST,
    ),
    terminal=(
        tables,
        places,
        counts,
        limits,
        trains,
        processes,
        *TOLD,
    ),
    tiles=tiles,
    beside=beside,
    whole="drive",
)
