"""`import` and `export`: gears from and for other programs."""

from pathlib import Path
from typing import Annotated

import typer

import gearopt
from gearopt.cli.app import MORE_OF_FILES, app, print_whole
from gearopt.cli.names import problem_files, result_files
from gearopt.cli.reporting import kept_design
from gearopt.cli.writing import Written, check_output, write
from gearopt.errors import GearoptError


@app.command("import", rich_help_panel=MORE_OF_FILES)
def import_(
    file: Annotated[
        Path,
        typer.Argument(
            help="A REXS file (.rexs, .rexsj, .rexsz), version 1.0 to 2.0.0.",
            show_default=False,
            autocompletion=result_files,
        ),
    ],
) -> None:
    """Print gears of a REXS file as a problem file: `gearopt import box.rexs > box.toml`.

    What has no place in it, and what it needs besides, stands in comments.
    """
    print_whole(gearopt.read_rexs(file), end="")


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
    step: Annotated[
        bool,
        typer.Option("--step", help="As STEP: gears as solids in mesh, shafts, bearings."),
    ] = False,
    csv: Annotated[
        bool,
        typer.Option(
            "--csv",
            help="As CSV: drawing data, places of shafts, relief to grind, flanks and cutting "
            "edge, motions over speed.",
        ),
    ] = False,
    rexs: Annotated[
        bool, typer.Option("--rexs", help="As REXS 2.0.0 (XML), which other gear programs read.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The file to write; by default printed.")
    ] = None,
) -> None:
    """Write the gears of an answer for other programs: `gearopt export my.toml --dxf -o my.dxf`.

    Gears that are all given are rated first, others found.
    """
    asked = {"dxf": dxf, "step": step, "csv": csv, "rexs": rexs}
    formats = [name for name, chosen in asked.items() if chosen]
    if len(formats) != 1:
        raise GearoptError(f"export {file}: name one format: --{', --'.join(asked)}")
    check_output(output, "-o", f"gears.{formats[0]}", file)
    what = kept_design(file, None) if file.suffix == ".json" else file
    assert not isinstance(what, gearopt.Front)  # it needs a design, which `kept_design` says
    data = gearopt.export(what, formats[0])
    if output is None:
        print_whole(data.decode(), end="")
    else:
        write(Written("-o", output, data))
