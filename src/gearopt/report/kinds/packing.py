"""Packings of cylinders: plans of every layer, a view in space, and where every cylinder is."""

from dataclasses import fields

from gearopt.formulations.packing.design import CylinderDesign, PackingDesign, packing_design
from gearopt.optimise.result import Result
from gearopt.report.kinds import Kind
from gearopt.report.kinds.generic import ASKED, FIRST, LAST, TOLD
from gearopt.report.measures import Measures
from gearopt.report.pages import packing_solid, packing_views
from gearopt.report.pages.design_tables import records, tables_of
from gearopt.report.section import Cell, Section, Table, shown
from gearopt.report.words import heading, number, parted


def places(result: Result, measures: Measures) -> Section | None:
    """Container, layers and cylinders; cylinders and then the rest on the terminal."""
    if not result.design:
        return None
    design = packing_design(result.design)
    sizes = tables_of("container", result.design["container"], measures)
    layers = records("layers", result.design["layers"], measures)
    cylinders = _cylinders(design, measures)
    told = (cylinders, _container(design, sizes[0], measures)) if result.value is not None else ()
    return Section("Design", tables=(*sizes, layers, cylinders), terminal=told)


def _cylinders(design: PackingDesign, measures: Measures) -> Table:
    """A cylinder a line, on the terminal to a micrometre."""
    keys = [f.name for f in fields(CylinderDesign)]
    rows = []
    for one in design.cylinders:
        row = [_cell(key, getattr(one, key), measures) for key in keys]
        mark = " (fixed)" if one.fixed else ""
        rows.append([Cell(one.name, one.name, short=one.name + mark), *row[1:]])
    heads = [heading(key, measures) for key in keys]
    return Table("cylinders", heads, rows, "cylinders", page_only=("fixed",), short={"name": ""})


def _cell(key: str, value: float, measures: Measures) -> Cell:
    if unit := parted(key)[1]:
        told = measures.of(value, unit)
        return Cell(told, shown(told).text, short=measures.length(value, 3))
    return shown(value)


def _container(design: PackingDesign, sizes: Table, measures: Measures) -> Table:
    """The container, its corner where that is not the origin, and its layers."""
    corner = [heading(key, measures) for key in ("left_mm", "front_mm")]
    at_origin = design.container.left_mm == 0.0 == design.container.front_mm
    rows = [
        [f"container {name}", number(value)]
        for name, value in sizes.rows
        if not (at_origin and name in corner)
    ]
    for layer in design.layers if len(design.layers) > 1 else ():
        start, end = (number(measures.of(v, "mm")) for v in (layer.from_mm, layer.to_mm))
        words = f"layer {layer.layer}, from the floor [{measures.unit('mm')}]"
        rows.append([words, f"{start} to {end}"])
    return Table("container and layers", ("", ""), rows)


KIND = Kind(
    sections=(*FIRST, packing_views.section, packing_solid.section, places, *ASKED, *LAST),
    terminal=(places, *TOLD),
)
