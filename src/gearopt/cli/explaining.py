"""`explain`: why an answer is what it is, or what would make a request possible."""

from typing import Annotated

import typer

from gearopt.cli.app import File, Json, app, console, exit_code, print_whole
from gearopt.cli.watching import watching
from gearopt.optimise.result import Budget


@app.command()
def explain(
    file: File,
    seconds: Annotated[float, typer.Option(min=0.0, help="Stop after this time.")] = 60.0,
    as_json: Json = False,
) -> None:
    """Say what each number of the file costs; for an impossible request, what to write instead."""
    from dataclasses import asdict, replace

    from gearopt.api import explain as explain_file

    with watching(seconds, quiet=as_json) as watch:
        found = explain_file(file, budget=Budget(seconds), watch=watch)
    if as_json:
        print_whole(found.to_json())
    elif found.result.value is None:
        from gearopt.report.terminal import show as show_result

        ways = {k: getattr(found, k) for k in ("conflict", "message")}
        ways |= {"remedies": [asdict(r) for r in found.remedies]}
        told = found.conflict or found.remedies or found.message != found.result.message
        if found.result.status != "infeasible" or not told:  # the proof says why, once
            ways = {}
        report = found.result.report | ({"ways_out": ways} if ways else {})
        show_result(replace(found.result, report=report), console())
    else:
        from gearopt.report.terminal import show_explanation

        show_explanation(found, console())
    raise typer.Exit(exit_code(found.result))
