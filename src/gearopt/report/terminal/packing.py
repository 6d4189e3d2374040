"""A packing on the terminal: the container, its layers, and where every cylinder is."""

from collections.abc import Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gearopt.report.words import columns, heading, number

COLUMNS = ("x_mm", "y_mm", "diameter_mm", "height_mm", "layer", "from_mm", "to_mm")


def design(found: Mapping[str, Any]) -> RenderableType:
    """Cylinders one a line, then the container and its layers."""
    table = columns("", [heading(key) for key in COLUMNS])
    for one in found["cylinders"]:
        mark = " (fixed)" if one["fixed"] else ""
        table.add_row(Text(one["name"] + mark), *[_length(one[key]) for key in COLUMNS])
    sizes = Table.grid(padding=(0, 2))
    container = dict(found["container"])
    if container["left_mm"] == 0.0 == container["front_mm"]:
        del container["left_mm"], container["front_mm"]
    for key, value in container.items():
        sizes.add_row(Text(f"container {heading(key)}"), number(value))
    if len(found["layers"]) > 1:
        for layer in found["layers"]:
            ends = f"{number(layer['from_mm'])} to {number(layer['to_mm'])}"
            sizes.add_row(Text(f"layer {layer['layer']}, from the floor [mm]"), ends)
    return Group(table, "", sizes)


def _length(value: Any) -> str:
    """A layer as it is, a length to a micrometre."""
    return str(value) if isinstance(value, int) else f"{value:,.3f}"
