"""`export`: gears for other programs."""

from pathlib import Path
from typing import Annotated

import typer

import gearopt
from gearopt.cli.app import MORE_OF_FILES, app, print_whole
from gearopt.cli.names import problem_files
from gearopt.cli.reporting import kept_design
from gearopt.cli.writing import Written, check_output, write
from gearopt.errors import GearoptError


@app.command(rich_help_panel=MORE_OF_FILES)
def export(
    file: Annotated[
        Path,
        typer.Argument(
            help="A problem file (TOML), or a kept result (JSON).",
            show_default=False,
            autocompletion=problem_files,
        ),
    ],
    dxf: Annotated[
        bool,
        typer.Option("--dxf", help="As DXF: whole gears, meshes and views, with dimensions."),
    ] = False,
    csv: Annotated[
        bool,
        typer.Option(
            "--csv",
            help="As CSV: drawing data, places of shafts, relief to grind, flanks and cutting "
            "edge, motions over speed.",
        ),
    ] = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The file to write; by default printed.")
    ] = None,
) -> None:
    """Write the gears of an answer for other programs: `gearopt export my.toml --dxf -o my.dxf`.

    Gears that are all given are rated first, others found.
    """
    formats = [name for name, asked in {"dxf": dxf, "csv": csv}.items() if asked]
    if len(formats) != 1:
        raise GearoptError(f"export {file}: name one format, as in --dxf")
    check_output(output, "-o", f"gears.{formats[0]}", file)
    what = kept_design(file, None) if file.suffix == ".json" else file
    assert not isinstance(what, gearopt.Front)  # it needs a design, which `kept_design` says
    text = gearopt.export(what, formats[0]).decode()
    if output is None:
        print_whole(text, end="")
    else:
        write(Written("-o", output, text))
