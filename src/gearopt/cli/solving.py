"""`solve`: the best design of a problem file."""

from typing import Annotated

import typer

from gearopt.cli.app import File, Json, app, console, exit_code, title
from gearopt.cli.watching import watching
from gearopt.optimise.result import Budget


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
        int,
        typer.Option(
            min=1, max=1000, help="Show so many of the best distinct trains, in proven order."
        ),
    ] = 1,
    seconds: Annotated[float, typer.Option(min=0.0, help="Stop after this time.")] = 60.0,
    gap: Annotated[
        float | None,
        typer.Option(min=0.0, max=1.0, help="Stop when this relative gap to the bound is reached."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of random methods.")] = 0,
    as_json: Json = False,
) -> None:
    """Find the best design and prove how good it is. Ctrl-C keeps the best found so far."""
    from gearopt.api import solve as solve_file

    with watching(seconds, quiet=as_json) as watch:
        result = solve_file(
            file, method, budget=Budget(seconds), seed=seed, watch=watch, gap=gap, top=top
        )
    if as_json:
        print(result.to_json())
    else:
        from gearopt.report.terminal.result import show

        show(result, title(file), console())
    raise typer.Exit(exit_code(result))
