"""A layout in words: the box, where the shafts are, and what nearly touches."""

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.bodies import layout_of
from gearopt.report.section import Cell, Section, Table
from gearopt.report.words import amount

NARROWEST = 3  # gaps that are named


def section(result: Result, measures: Measures) -> Section | None:
    """Box, shafts and narrowest gaps; None where there is no layout."""
    if result.value is None or (found := layout_of(result)) is None:
        return None
    box, unit = found.box, measures.unit("mm")
    sides = " x ".join(map(measures.length, (box.width_mm, box.height_mm, box.length_mm)))
    volume = amount(box.volume_mm3, "mm3", measures)
    rows = [
        [f"{words} [{unit}]", *(Cell(v, measures.length(v)) for v in values)]
        for words, values in (
            ("right of the input y", [s.y_mm for s in found.shafts]),
            ("above the input z", [s.z_mm for s in found.shafts]),
            ("diameter", [s.diameter_mm for s in found.shafts]),
        )
    ]
    table = Table("places of shafts", ["", *(f"shaft {s.shaft}" for s in found.shafts)], rows)
    slabs = ", ".join(" and ".join(map(str, slab)) for slab in found.slabs)
    gaps = [
        f"{' to '.join(gap.between)}: {measures.length(gap.gap_mm)} {unit} clear, "
        f"{measures.of(gap.needed_mm, 'mm'):.4g} {unit} needed"
        for gap in found.gaps[:NARROWEST]
    ]
    last = "\n".join([f"Stages along the shafts: {slabs}.", *gaps])
    size = f"box {sides} {unit} (width, height, length), {volume}"
    return Section("Layout", terminal=(size, table, last))
