"""A packing on the terminal: the container, its layers, and where every cylinder is."""

from collections.abc import Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gearopt.report.measures import METRIC, Measures
from gearopt.report.words import columns, heading, number, parted

COLUMNS = ("x_mm", "y_mm", "diameter_mm", "height_mm", "layer", "from_mm", "to_mm")


def design(found: Mapping[str, Any], measures: Measures = METRIC) -> RenderableType:
    """Cylinders one a line, then the container and its layers."""
    table = columns("", [heading(key, measures) for key in COLUMNS])
    for one in found["cylinders"]:
        mark = " (fixed)" if one["fixed"] else ""
        table.add_row(Text(one["name"] + mark), *[_length(one[key], measures) for key in COLUMNS])
    sizes = Table.grid(padding=(0, 2))
    container = dict(found["container"])
    if container["left_mm"] == 0.0 == container["front_mm"]:
        del container["left_mm"], container["front_mm"]
    for key, value in container.items():
        shown = measures.of(value, unit) if (unit := parted(key)[1]) else value
        sizes.add_row(Text(f"container {heading(key, measures)}"), number(shown))
    if len(found["layers"]) > 1:
        for layer in found["layers"]:
            start, end = (number(measures.of(layer[k], "mm")) for k in ("from_mm", "to_mm"))
            words = f"layer {layer['layer']}, from the floor [{measures.unit('mm')}]"
            sizes.add_row(Text(words), f"{start} to {end}")
    return Group(table, "", sizes)


def _length(value: Any, measures: Measures) -> str:
    """A layer as it is, a length to a micrometre."""
    return str(value) if isinstance(value, int) else measures.length(value, 3)
