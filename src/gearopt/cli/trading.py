"""`pareto`: the designs that no other beats in two or three objectives, and one to pick."""

from typing import Annotated

import typer

from gearopt.cli.app import (
    TO_BEGIN,
    Csv,
    File,
    Html,
    Json,
    Most,
    Pdf,
    Units,
    app,
    front_code,
    numbers,
)
from gearopt.cli.reporting import answer, checked, traded
from gearopt.cli.watching import watching
from gearopt.optimise.result import Budget
from gearopt.report.words import SECONDS
from gearopt.scenes.reading.load import units_of


@app.command(rich_help_panel=TO_BEGIN)
def pareto(
    file: File,
    objectives: Annotated[
        str | None,
        typer.Option(
            help="Two or three objectives separated by commas, such as gear_volume,mesh_loss; "
            "the first is minimised where others are limited. Without it the objectives are "
            "listed.",
        ),
    ] = None,
    most: Most = None,
    method: Annotated[
        str | None,
        typer.Option(
            help="exact, epsilon, nsga2, annealing or hybrid; by default the one that proves most."
        ),
    ] = None,
    points: Annotated[
        int | None,
        typer.Option(min=2, max=10_000, help="Number of points, where the method leaves it open."),
    ] = None,
    weights: Annotated[
        str | None,
        typer.Option(
            help="NAME=NUMBER separated by commas: weights by which one more design is picked."
        ),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.0, help="Stop after this time.")] = SECONDS,
    seed: Annotated[int, typer.Option(help="Seed of random methods.")] = 0,
    html: Html = None,
    pdf: Pdf = None,
    csv: Csv = None,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Find the Pareto front of two or three objectives. Ctrl-C keeps the designs found so far."""
    from gearopt.api import pareto as pareto_of

    files = checked(html, pdf, csv, units or units_of(file), file)
    with watching(seconds, quiet=as_json, measures=files.measures) as watch:
        front = pareto_of(
            file,
            objectives=objectives,
            most=numbers("--most", most or []),
            method=method,
            points=points,
            weights=numbers("--weights", weights.split(",")) if weights else None,
            budget=Budget(seconds),
            seed=seed,
            watch=watch,
        )
    lines: list[str] = []
    try:
        lines = traded(front, files)
    finally:  # what took long to find is shown even where no file can be written
        answer(front, as_json, lines, files.measures)
    raise typer.Exit(front_code(front))
