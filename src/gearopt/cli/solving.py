"""`solve`: the best design of a problem file."""

from typing import Annotated

import typer

from gearopt.cli.app import Csv, File, Html, Json, Units, app, console, exit_code, print_whole
from gearopt.cli.reporting import SECONDS, TOP_ON_PAGE, Files, checked, written
from gearopt.cli.watching import watching
from gearopt.optimise.result import Budget, Result


@app.command()
def solve(
    file: File,
    method: Annotated[
        str | None,
        typer.Option(
            help="By default, for a drive, exact where the file has a \\[teeth] table, else ipopt; "
            "for a packing hop; docs/methods.md lists all."
        ),
    ] = None,
    top: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            help="Show so many of the best distinct trains, in proven order; by default 1, on a "
            "page 10.",
        ),
    ] = None,
    prices: Annotated[
        bool,
        typer.Option("--prices", help="Say too what every number costs, as a page always does."),
    ] = False,
    seconds: Annotated[float, typer.Option(min=0.0, help="Stop after this time.")] = SECONDS,
    gap: Annotated[
        float | None,
        typer.Option(min=0.0, max=1.0, help="Stop when this relative gap to the bound is reached."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of random methods.")] = 0,
    html: Html = None,
    csv: Csv = None,
    units: Units = "metric",
    as_json: Json = False,
) -> None:
    """Find the best design and prove how good it is. Ctrl-C keeps the best found so far."""
    from gearopt.api import solve as solve_file

    files = checked(html, csv, units, file)
    full = html is not None or csv is not None
    with watching(seconds, quiet=as_json) as watch:
        result = solve_file(
            file,
            method,
            budget=Budget(seconds),
            seed=seed,
            watch=watch,
            gap=gap,
            top=top or (TOP_ON_PAGE if full else 1),
            prices=prices or full,
        )
    lines: list[str] = []
    try:
        lines = written(result, files)
    finally:  # what took long to find is shown even where no file can be written
        _show(result, files, lines, as_json)
    raise typer.Exit(exit_code(result))


def _show(result: Result, files: Files, lines: list[str], as_json: bool) -> None:
    if as_json:
        print_whole(result.to_json())
        return
    from gearopt.report.terminal import show

    show(result, console(), files.measures)
    for line in lines:
        print(line)
