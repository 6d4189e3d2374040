"""`materials`: the steels and irons that problem files may name."""

import json
from dataclasses import asdict
from typing import Annotated

import typer

from gearopt.cli.app import TO_BEGIN, Json, app, console, print_whole
from gearopt.errors import GearoptError
from gearopt.physics import steels
from gearopt.physics.steels import Steel

COLUMNS = ("steel", "ISO 6336-5", "AGMA 2001", "hardness", "R_m/R_e", "source")
WORDS = (
    "R_m and R_e [MPa] are those of a bar of 16 mm. Rows of fewer than two sources are unverified. "
    "Class, quality and grade are those usual for the treatment, which no source prints beside a "
    "steel (unverified): the supplier's certificate decides."
)


@app.command(rich_help_panel=TO_BEGIN)
def materials(
    name: Annotated[
        str, typer.Argument(help="A steel by name or number; all without one.", show_default=False)
    ] = "",
    as_json: Json = False,
) -> None:
    """List the steels and irons that `steel = "..."` may name, with classes and sources."""
    rows = steels.named(name) if name else steels.steels()
    if not rows:
        close = steels.near(name)
        hint = f"; near: {', '.join(close)}" if close else ""
        if steels.is_plastic(name):
            hint = ": it is a plastic, and VDI 2736 is not supported; ratings are of metals"
        raise GearoptError(f"no steel {name!r} is known by name{hint}")
    if as_json:
        each = [asdict(row) | {"verified": row.verified} for row in rows]
        print_whole(json.dumps(each, indent=2))
        return
    _print(rows)


def _print(rows: tuple[Steel, ...]) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for column in COLUMNS:
        table.add_column(column, no_wrap=True)
    table.add_column("also", overflow="fold")
    for row in rows:
        table.add_row(*_cells(row))
    screen = console()
    screen.print(table)
    used = [letter for letter in steels.SOURCES if any(letter in row.sources for row in rows)]
    sources = (f"{letter}: {steels.SOURCES[letter]}." for letter in used)
    screen.print(" ".join((WORDS, *sources, "No letter: from memory.")))


def _cells(row: Steel) -> tuple[str, ...]:
    low, high = row.hardness
    strengths = [f"{value:g}" for value in (row.tensile, row.yield_strength) if value is not None]
    return (
        row.name,
        f"{row.iso_material} {row.iso_quality}" if row.iso_material else "-",
        f"{row.treatment} {row.grade}" if row.treatment else "-",
        f"{low:g}-{high:g} {row.unit}",
        "/".join(strengths),
        row.sources,
        ", ".join(dict.fromkeys((*row.names[1:], *row.numbers, *filter(None, [row.us])))),
    )
