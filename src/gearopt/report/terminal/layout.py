"""A layout on the terminal: the box, where the shafts are, and what nearly touches."""

from collections.abc import Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from gearopt.report.words import columns, number

NARROWEST = 3  # gaps that are named


def layout(found: Mapping[str, Any]) -> RenderableType:
    """Box, shafts and narrowest gaps of `design["layout"]`."""
    box = found["box"]
    sides = " x ".join(f"{box[f'{s}_mm']:.2f}" for s in ("width", "height", "length"))
    parts: list[RenderableType] = [
        Text(f"box {sides} mm (width, height, length), {number(box['volume_mm3'])} mm³"),
        "",
    ]
    table = columns("", [f"shaft {s['shaft']}" for s in found["shafts"]])
    rows = {"right of the input y": "y_mm", "above the input z": "z_mm", "diameter": "diameter_mm"}
    for words, key in rows.items():
        table.add_row(
            Text(f"{words} [mm]"),
            *[f"{s[key]:.2f}".replace("-0.00", "0.00") for s in found["shafts"]],
        )
    parts.append(table)
    slabs = ", ".join(" and ".join(str(s) for s in slab) for slab in found["slabs"])
    parts += ["", Text(f"Stages along the shafts: {slabs}.")]
    for gap in found["gaps"][:NARROWEST]:
        first, last = gap["between"]
        words = f"{first} to {last}: {gap['gap_mm']:.2f} mm clear, {gap['needed_mm']:g} mm needed"
        parts.append(Text(words))
    return Group(*parts)
