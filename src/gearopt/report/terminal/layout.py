"""A layout on the terminal: the box, where the shafts are, and what nearly touches."""

from collections.abc import Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from gearopt.report.measures import METRIC, Measures
from gearopt.report.words import amount, columns

NARROWEST = 3  # gaps that are named


def layout(found: Mapping[str, Any], measures: Measures = METRIC) -> RenderableType:
    """Box, shafts and narrowest gaps of `design["layout"]`."""
    box = found["box"]
    unit = measures.unit("mm")
    sides = " x ".join(measures.length(box[f"{s}_mm"]) for s in ("width", "height", "length"))
    volume = amount(box["volume_mm3"], "mm3", measures)
    parts: list[RenderableType] = [
        Text(f"box {sides} {unit} (width, height, length), {volume}"),
        "",
    ]
    table = columns("", [f"shaft {s['shaft']}" for s in found["shafts"]])
    rows = {"right of the input y": "y_mm", "above the input z": "z_mm", "diameter": "diameter_mm"}
    for words, key in rows.items():
        table.add_row(
            Text(f"{words} [{unit}]"),
            *[measures.length(s[key]) for s in found["shafts"]],
        )
    parts.append(table)
    slabs = ", ".join(" and ".join(str(s) for s in slab) for slab in found["slabs"])
    parts += ["", Text(f"Stages along the shafts: {slabs}.")]
    for gap in found["gaps"][:NARROWEST]:
        first, last = gap["between"]
        there, needed = measures.length(gap["gap_mm"]), measures.of(gap["needed_mm"], "mm")
        words = f"{first} to {last}: {there} {unit} clear, {needed:.4g} {unit} needed"
        parts.append(Text(words))
    return Group(*parts)
