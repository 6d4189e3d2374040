"""A packing of cylinders seen from above, layer by layer, to scale."""

from collections.abc import Mapping, Sequence

from gearopt.formulations.packing.design import (
    ContainerDesign,
    CylinderDesign,
    LayerDesign,
    PackingDesign,
    packing_design,
)
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.labels import Place, around
from gearopt.report.pages.sheet import Drawing, Sheet, Window, series
from gearopt.report.section import Section

WIDE, HIGH = 640.0, 560.0  # largest drawing [px]


def section(result: Result, measures: Measures) -> Section | None:
    """A plan of every layer, all at one scale; None where there is no packing."""
    if not result.design:
        return None
    design = packing_design(result.design)
    window = _window(design.container)
    scale = window.scale(WIDE, HIGH)
    colours = sizes(design.cylinders)
    layers = design.layers
    plans = [_plan(design, layer, window, scale, colours, measures) for layer in layers]
    words = f"Seen from above, drawn to one scale; dimensions in {measures.lengths}."
    if any(c.fixed for c in design.cylinders):
        words += " Cylinders whose place the file gives have a heavy outline."
    return Section("Packing", words=(words,), drawings=plans)


def sizes(cylinders: Sequence[CylinderDesign]) -> dict[float, str]:
    """One colour for every diameter, from the largest."""
    found = sorted({c.diameter_mm for c in cylinders}, reverse=True)
    return {d: series(k) for k, d in enumerate(found, 1)}


def span(container: ContainerDesign) -> tuple[float, float, float, float]:
    """Ends of a container in x and y: left, right, front, back [mm]."""
    left, front = container.left_mm, container.front_mm
    width, depth = container.sides
    return left, left + width, front, front + depth


def words(cylinder: CylinderDesign, measures: Measures) -> str:
    """A cylinder in a line."""
    diameter, height = (measures.of(v, "mm") for v in (cylinder.diameter_mm, cylinder.height_mm))
    x, y = (measures.length(v, 3) for v in (cylinder.x_mm, cylinder.y_mm))
    unit = measures.unit("mm")
    return (
        f"{cylinder.name}: diameter {diameter:.4g} {unit}, height {height:.4g} {unit}, x {x}, y {y}"
    )


def _window(container: ContainerDesign) -> Window:
    return Window(*span(container), (52.0, 20.0, 48.0, 20.0))


def _plan(
    design: PackingDesign,
    layer: LayerDesign,
    window: Window,
    scale: float,
    colours: Mapping[float, str],
    measures: Measures,
) -> Drawing:
    sheet, container = Sheet(window, scale), design.container
    left, right, front, back = span(container)
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
    start, end = (f"{measures.of(v, 'mm'):.4g}" for v in (layer.from_mm, layer.to_mm))
    ends = f"{start} to {end} {measures.unit('mm')}"
    caption = f"Layer {layer.layer}, from {ends}, x to the right and y up."
    return sheet.drawing(f"layer {layer.layer}", caption)


def _name(sheet: Sheet, it: CylinderDesign, colour: str) -> None:
    centre, r = sheet.at(it.x_mm, it.y_mm), 0.5 * it.diameter_mm * sheet.scale
    half = Place(0, 0).half_width(it.name)
    inside = [Place(centre[0], centre[1] + s * r, 0.0) for s in (0.35, -0.35) if half < 0.9 * r]
    outside = around(centre, (r + half + 6, r + half + 24), r, 20.0)
    sheet.label(it.name, inside or outside, "name", colour)
