"""Packings of cylinders: plans of every layer, a view in space, and where every cylinder is."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from html import escape

from gearopt.formulations.packing.design import (
    ContainerDesign,
    CylinderDesign,
    LayerDesign,
    PackingDesign,
    packing_design,
)
from gearopt.optimise.result import Result
from gearopt.report.design_tables import records, tables_of
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window, around, series
from gearopt.report.drawing.solid import (
    TURN,
    Point,
    edges,
    line_trace,
    mesh_trace,
    rod,
    space,
    upright,
)
from gearopt.report.drawing.still import Rod, Texts, sizes_of, still, view
from gearopt.report.kinds import Pages
from gearopt.report.kinds.generic import AFTER_DESIGN, CLOSING, OPENING, REQUEST
from gearopt.report.measures import METRIC, Measures
from gearopt.report.plots import Figure
from gearopt.report.section import Cell, Section, Table, shown
from gearopt.report.words import heading, number, parted
from gearopt.units import parse

WALL_TOLERANCE = 1e-6  # of the container: a cylinder so near to the clearance is at it
WIDE, HIGH = 640.0, 560.0  # largest drawing [px]


def plans(result: Result, measures: Measures) -> Section | None:
    """Draw a plan of every layer, all at one scale; None where there is no packing."""
    if not result.design:
        return None
    design = packing_design(result.design)
    window = Window(*_span(design.container), (52.0, 20.0, 48.0, 20.0))
    scale = window.scale(WIDE, HIGH)
    colours = _colours(design.cylinders)
    layers = design.layers
    plans = [_plan(design, layer, window, scale, colours, measures) for layer in layers]
    words = f"Layers are seen from above, drawn to one scale; dimensions in {measures.lengths}."
    if any(c.fixed for c in design.cylinders):
        words += " Cylinders whose place the file gives have a heavy outline."
    return Section("Packing", words=(words,), drawings=plans)


def _colours(cylinders: Sequence[CylinderDesign]) -> dict[float, str]:
    """One colour for every diameter, from the largest."""
    diameters = sorted({c.diameter_mm for c in cylinders}, reverse=True)
    return {d: series(k) for k, d in enumerate(diameters, 1)}


def _span(container: ContainerDesign) -> tuple[float, float, float, float]:
    """The ends of a container in x and y: left, right, front, back [mm]."""
    left, front = container.left_mm, container.front_mm
    width, depth = container.sides
    return left, left + width, front, front + depth


def words(cylinder: CylinderDesign, measures: Measures) -> str:
    """Describe a cylinder in a line."""
    diameter, height = (measures.of(v, "mm") for v in (cylinder.diameter_mm, cylinder.height_mm))
    x, y = (measures.length(v, 3) for v in (cylinder.x_mm, cylinder.y_mm))
    unit = measures.unit("mm")
    return (
        f"{cylinder.name}: diameter {diameter:.4g} {unit}, height {height:.4g} {unit}, "
        f"x {x} {unit}, y {y} {unit}"
    )


def _plan(
    design: PackingDesign,
    layer: LayerDesign,
    window: Window,
    scale: float,
    colours: Mapping[float, str],
    measures: Measures,
) -> Drawing:
    sheet, container = Sheet(window, scale), design.container
    left, right, front, back = _span(container)
    middle = (0.5 * (left + right), 0.5 * (front + back))
    if container.shape == "circle":
        sheet.circle(*middle, 0.5 * (right - left), "box")
        sheet.cross(*middle, 0.5 * (right - left))
    else:
        sheet.rectangle((left, front), (right, back), "box")
    on = [c for c in design.cylinders if c.layer == layer.layer]
    for it in on:
        style = "cylinder fixed" if it.fixed else "cylinder"
        place, colour = (it.x_mm, it.y_mm), colours[it.diameter_mm]
        sheet.circle(*place, 0.5 * it.diameter_mm, style, colour, words(it, measures))
        sheet.cross(*place, -0.5 * it.diameter_mm + 2.0 / scale)
    floor = sheet.at(0.0, front)[1]
    sign = "⌀ " if container.shape == "circle" else ""
    away = sheet.height - 18.0 - floor
    level = middle[1] if sign else front
    away += floor - sheet.at(0.0, level)[1]
    sheet.dimension((left, level), (right, level), away, f"{sign}{measures.length(right - left)}")
    if not sign:
        away = sheet.at(left, 0.0)[0] - 20.0
        sheet.dimension((left, front), (left, back), away, measures.length(back - front))
    for it in sorted(on, key=lambda c: -c.diameter_mm):
        _name(sheet, it, colours[it.diameter_mm])
    ends = " to ".join(measures.length(z) for z in (layer.from_mm, layer.to_mm))
    unit = measures.unit("mm")
    caption = f"Layer {layer.layer}, at a height z of {ends} {unit}; x to the right and y up."
    return sheet.drawing(f"layer {layer.layer}", caption)


def _name(sheet: Sheet, it: CylinderDesign, colour: str) -> None:
    centre, r = sheet.at(it.x_mm, it.y_mm), 0.5 * it.diameter_mm * sheet.scale
    half = Place(0, 0).half_width(it.name)
    inside = [Place(centre[0], centre[1] + s * r, 0.0) for s in (0.35, -0.35) if half < 0.9 * r]
    outside = around(centre, (r + half + 6, r + half + 24), r, 20.0)
    sheet.label(it.name, inside or outside, "name", colour)


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Fill of the container, and number of cylinders at its walls, in words."""
    if not result.design:
        return ""
    design = packing_design(result.design)
    box, count = design.container, len(design.cylinders)
    full = sum(0.25 * math.pi * c.diameter_mm**2 * c.height_mm for c in design.cylinders)
    share = f"{100.0 * full / box.volume_mm3:.0f} %"
    wall = parse(str(result.asked.get("container", {}).get("wall", "0 mm")), "length").value
    at_walls = sum(_at_wall(c, box, wall) for c in design.cylinders)
    all_ = "all" if at_walls == count else f"{at_walls} of the"
    where = "are at the minimum clearance to the walls" if wall else "touch the walls"
    fill = f"together the {count} fill {share} of the container's volume"
    return f"{all_} {count} cylinders {where}; {fill}"


def _at_wall(cylinder: CylinderDesign, box: ContainerDesign, wall: float) -> bool:
    """Whether a cylinder is as near to a wall as the clearance [mm] lets it."""
    left, right, front, back = _span(box)
    r, near = 0.5 * cylinder.diameter_mm, wall + WALL_TOLERANCE * max(box.sides)
    if box.shape == "circle":
        middle = 0.5 * (left + right), 0.5 * (front + back)
        return 0.5 * (right - left) - math.dist(middle, (cylinder.x_mm, cylinder.y_mm)) - r < near
    free = (
        cylinder.x_mm - left,
        right - cylinder.x_mm,
        cylinder.y_mm - front,
        back - cylinder.y_mm,
    )
    return min(free) - r < near


def solid(result: Result, measures: Measures) -> Section | None:
    """Draw the packing in space; None where there is none."""
    if not result.design:
        return None
    design = packing_design(result.design)
    left, right, front, back = _span(design.container)
    corners = (left, front, 0.0), (right, back, design.container.height_mm)
    colours, seen = _colours(design.cylinders), set()
    traces = [line_trace(_outline(design.container), "container", "--ink", 3.0)]
    for it in sorted(design.cylinders, key=lambda c: -c.diameter_mm):
        d = it.diameter_mm
        mesh = upright(rod((it.x_mm, it.y_mm), d / 2, it.from_mm, it.to_mm))
        group = f"diameter {measures.of(d, 'mm'):.4g} {measures.unit('mm')}"
        first = d not in seen
        seen.add(d)
        name = escape(words(it, measures))
        traces.append(mesh_trace(mesh, name, colours[d], group, showlegend=first))
    turned = space(*corners, measures, 520)
    figure = Figure(traces, turned, TURN, _picture(design, colours, measures))
    return Section("In three dimensions", figures=(figure,))


def _picture(design: PackingDesign, colours: Mapping[float, str], measures: Measures) -> Drawing:
    """Draw what the view in space begins with, for print: a, b and c are z, x and y."""
    left, right, front, back = _span(design.container)
    room = (0.0, left, front), (design.container.height_mm, right, back)
    unit, seen = measures.unit("mm"), view("zxy")
    bodies = [
        Rod(
            (it.x_mm, it.y_mm),
            0.5 * it.diameter_mm,
            it.from_mm,
            it.to_mm,
            "gear",
            colours[it.diameter_mm],
            words(it, measures),
        )
        for it in design.cylinders
    ]
    legend = [(f"⌀ {measures.of(d, 'mm'):.4g} {unit}", colour) for d, colour in colours.items()]
    texts = Texts(sizes_of(room, "zxy", measures), legend)
    return still(bodies, room, seen, texts, "the packing in space")


def _outline(container: ContainerDesign) -> list[Point | None]:
    left, right, front, back = _span(container)
    height = container.height_mm
    if container.shape != "circle":
        return edges((left, front, 0.0), (right, back, height))
    r, x, y = 0.5 * (right - left), 0.5 * (left + right), 0.5 * (front + back)
    ring = [
        (x + r * math.cos(k * math.pi / 36), y + r * math.sin(k * math.pi / 36)) for k in range(73)
    ]
    corners: list[Point | None] = [(u, v, 0.0) for u, v in ring]
    corners += [None, *[(u, v, height) for u, v in ring]]
    for u, v in ring[:72:18]:
        corners += [None, (u, v, 0.0), (u, v, height)]
    return corners


def places(result: Result, measures: Measures) -> Section | None:
    """Container, layers and cylinders; on the terminal cylinders first."""
    if not result.design:
        return None
    design = packing_design(result.design)
    sizes = tables_of("container", result.design["container"], measures)
    layers = records("layers", result.design["layers"], measures)
    cylinders = _cylinders(design, measures)
    known = result.value is not None
    short = (cylinders, _container(design, sizes[0], measures)) if known else ()
    return Section("Design", tables=(*sizes, layers, cylinders), terminal=short)


def _cylinders(design: PackingDesign, measures: Measures) -> Table:
    """One row per cylinder, on the terminal to a micrometre."""
    keys = [f.name for f in fields(CylinderDesign)]
    rows = []
    for cylinder in design.cylinders:
        row = [_cell(key, getattr(cylinder, key), measures) for key in keys]
        mark = " (fixed)" if cylinder.fixed else ""
        rows.append([Cell(cylinder.name, cylinder.name, short=cylinder.name + mark), *row[1:]])
    heads = [heading(key, measures) for key in keys]
    return Table("cylinders", heads, rows, "cylinders", page_only=("fixed",), short={"name": ""})


def _cell(key: str, value: float, measures: Measures) -> Cell:
    if unit := parted(key)[1]:
        size = measures.of(value, unit)
        return Cell(size, shown(size).text, short=measures.length(value, 3))
    return shown(value)


def _container(design: PackingDesign, sizes: Table, measures: Measures) -> Table:
    """The container, its corner where that is not the origin, and its layers."""
    corner = [heading(key, measures) for key in ("left_mm", "front_mm")]
    at_origin = design.container.left_mm == 0.0 == design.container.front_mm
    rows = [
        [f"container {name}", value]
        for name, value in sizes.rows
        if not (at_origin and name in corner)
    ]
    for layer in design.layers if len(design.layers) > 1 else ():
        start, end = (number(measures.of(v, "mm")) for v in (layer.from_mm, layer.to_mm))
        words = f"layer {layer.layer}, from the floor [{measures.unit('mm')}]"
        rows.append([words, f"{start} to {end}"])
    return Table("container and layers", ("", ""), rows)


PAGES = Pages(
    sections=(*OPENING, plans, solid, places, *REQUEST, *CLOSING),
    terminal=(places, *AFTER_DESIGN),
    binding_limit=binding_limit,
)
