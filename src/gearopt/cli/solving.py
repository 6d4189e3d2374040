"""`solve`: the best design of a problem file."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from gearopt.cli.app import File, Html, Json, app, check_html, console, exit_code, title, write_html
from gearopt.cli.watching import watching
from gearopt.optimise.result import Budget

SECONDS = 60.0


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
    seconds: Annotated[float, typer.Option(min=0.0, help="Stop after this time.")] = SECONDS,
    gap: Annotated[
        float | None,
        typer.Option(min=0.0, max=1.0, help="Stop when this relative gap to the bound is reached."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of random methods.")] = 0,
    html: Html = None,
    as_json: Json = False,
) -> None:
    """Find the best design and prove how good it is. Ctrl-C keeps the best found so far."""
    from gearopt.api import solve as solve_file

    check_html(html)
    with watching(seconds, quiet=as_json) as watch:
        result = solve_file(
            file, method, budget=Budget(seconds), seed=seed, watch=watch, gap=gap, top=top
        )
    if as_json:
        print(result.to_json())
    else:
        from gearopt.report.terminal.result import show

        show(result, title(file), console())
    if html is not None:
        from gearopt.report.pages.result import page

        command = _again(file, html, method=method, top=top, seconds=seconds, gap=gap, seed=seed)
        write_html(html, page(result, title(file), command))
        if not as_json:
            print(f"\nPage: {html}")
    raise typer.Exit(exit_code(result))


def _again(file: Path, html: Path, **options: float | str | None) -> str:
    """The command that makes a page again; options that are the defaults are left out."""
    words = ["gearopt", "solve", str(file)]
    defaults = {"method": None, "top": 1, "seconds": SECONDS, "gap": None, "seed": 0}
    for name, value in options.items():
        if value != defaults[name]:
            words += [f"--{name}", f"{value:.12g}" if isinstance(value, float) else str(value)]
    return shlex.join([*words, "--html", str(html)])
