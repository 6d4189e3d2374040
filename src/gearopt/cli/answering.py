"""`solve`, `explain`, `compare`: the best design, why it is what it is, methods side by side."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from gearopt.cli.app import (
    MORE_OF_FILES,
    TO_BEGIN,
    Csv,
    File,
    Html,
    Json,
    Most,
    Pdf,
    Units,
    app,
    console,
    exit_code,
    numbers,
    print_whole,
)
from gearopt.cli.names import method_lists, method_words
from gearopt.cli.reporting import answer, checked, compared, kept_design, written
from gearopt.cli.watching import following, reached, watching
from gearopt.errors import GearoptError
from gearopt.optimise.comparing.plan import EVALUATIONS, SEEDS, Progress
from gearopt.optimise.comparing.plan import SECONDS as EACH
from gearopt.optimise.result import Budget, Result
from gearopt.report.words import SECONDS, TOP_ON_PAGE
from gearopt.scenes.reading.load import units_of

PAGE_SHARE = 1.0  # of the time of an answer, at most, for the sensitivities of its page
Seconds = Annotated[float, typer.Option(min=0.0, help="Stop after this time.")]
Method = Annotated[
    str | None,
    typer.Option(
        help="By default, for a drive, exact where the file has a \\[teeth] table, else ipopt; "
        "for a packing hop (basin hopping). Methods: {methods}; docs/methods.md says more.",
        autocompletion=method_words,
    ),
]
Top = Annotated[
    int | None,
    typer.Option(
        min=1,
        max=1000,
        help="Number of best distinct trains to show, in proven order; by default 1, on a page 10.",
    ),
]
Prices = Annotated[
    bool,
    typer.Option(
        "--prices",
        help="Show sensitivities to every number of the file; a page has those that take no "
        "longer than the answer.",
    ),
]
Gap = Annotated[
    float | None,
    typer.Option(min=0.0, max=1.0, help="Stop when this relative gap to the bound is reached."),
]
Seed = Annotated[int, typer.Option(help="Seed of random methods.")]


@app.command(rich_help_panel=TO_BEGIN)
def solve(
    file: File,
    method: Method = None,
    top: Top = None,
    prices: Prices = False,
    seconds: Seconds = SECONDS,
    gap: Gap = None,
    seed: Seed = 0,
    html: Html = None,
    pdf: Pdf = None,
    csv: Csv = None,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Find the best design and prove how good it is. Ctrl-C keeps the best found so far."""
    from gearopt.api import idle_options
    from gearopt.api import solve as solve_file

    files = checked(html, pdf, csv, units or units_of(file), file)
    full = files.page is not None or csv is not None
    if not full:
        _metric(as_json, units)
    unusual = full or seed or (top or 1) > 1
    with watching(seconds, quiet=as_json, measures=files.measures) as watch:
        idle = idle_options(file, method, Budget(seconds), watch) if unusual else {}
        _refuse({"top": (top, 1), "seed": (seed, 0)}, idle)
        if top is None:
            top = TOP_ON_PAGE if full and "top" not in idle else 1
        result = solve_file(
            file,
            method=method,
            budget=Budget(seconds),
            seed=seed,
            watch=watch,
            gap=gap,
            top=top,
            prices=prices or (full and PAGE_SHARE),
        )
    lines: list[str] = []
    try:
        lines = [*_advice(result, file), *written(result, files)]
    finally:  # what took long to find is shown even where no file can be written
        answer(result, as_json, lines, files.measures)
    raise typer.Exit(exit_code(result))


def _advice(result: Result, file: Path) -> list[str]:
    """Command to run for remedies of an impossible file, where the answer has none."""
    ways = result.report.get("ways_out") or {}
    if result.status != "infeasible" or ways and not ways.get("untried"):
        return []
    return [f"\nWhat to write instead: gearopt explain {file}"]


def _metric(as_json: bool, units: str | None) -> None:
    """Raise GearoptError for units that were chosen for JSON alone."""
    if as_json and units not in (None, "metric"):
        raise GearoptError(f"--units {units} changes nothing of --json, which names its units")


def _refuse(given: Mapping[str, tuple[int | None, int]], idle: Mapping[str, str]) -> None:
    """Raise GearoptError for the first option that changes nothing; given: value and default."""
    for name, (value, usual) in given.items():
        if value not in (None, usual) and (why := idle.get(name)):
            raise GearoptError(f"--{name} {value} changes nothing here: {why}; leave it out")


@app.command(rich_help_panel=TO_BEGIN)
def rate(
    file: File,
    design: Annotated[
        int | None,
        typer.Option(help="Rate this design of a Pareto front, FILE of `gearopt pareto --json`."),
    ] = None,
    html: Html = None,
    pdf: Pdf = None,
    csv: Csv = None,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Rate given gears, or those of a kept result: stresses, safety factors, lives.

    Exit code 0, safe or not; 3 if unfit.
    """
    from gearopt.api import rate as rate_file

    files = checked(html, pdf, csv, units or units_of(file), file)
    if files.page is None and csv is None:
        _metric(as_json, units)
    if design is None and file.suffix != ".json":
        result = rate_file(file)
    else:
        result = rate_file(kept_design(file, design), design=design)
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        result = replace(result, file=str(file), file_sha256=digest)
    lines: list[str] = []
    try:
        lines = written(result, files)
    finally:
        answer(result, as_json, lines, files.measures)
    raise typer.Exit(exit_code(result))


@app.command(rich_help_panel=TO_BEGIN)
def explain(
    file: File,
    seconds: Seconds = 60.0,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Show sensitivities to each number of a file; of an impossible one, what to write instead."""
    from gearopt.api import explain as explain_file

    measures = checked(None, None, None, units or units_of(file), file).measures
    _metric(as_json, units)
    with watching(seconds, quiet=as_json, measures=measures) as watch:
        explanation = explain_file(file, budget=Budget(seconds), watch=watch)
    if as_json:
        print_whole(explanation.to_json())
    elif explanation.result.value is None:
        from gearopt.report.shown import answered
        from gearopt.report.terminal import show as show_result

        show_result(answered(explanation), console(), measures, explained=True)
    else:
        from gearopt.report.terminal import show_explanation

        show_explanation(explanation, console(), measures)
    raise typer.Exit(exit_code(explanation.result))


@app.command(rich_help_panel=MORE_OF_FILES)
def compare(
    file: File,
    objectives: Annotated[
        str | None,
        typer.Option(
            help="Two or three objectives separated by commas, such as gear_volume,mesh_loss: "
            "whole fronts are compared."
        ),
    ] = None,
    most: Most = None,
    methods: Annotated[
        str | None,
        typer.Option(
            help="Methods by name, separated by commas: {methods}. By default a choice for the "
            "kind of the file.",
            autocompletion=method_lists,
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Runs of every random method.")] = SEEDS,
    evaluations: Annotated[
        int,
        typer.Option(min=1, help="Evaluations per run, in the comparison at equal evaluations."),
    ] = EVALUATIONS,
    seconds: Annotated[
        float, typer.Option(min=0.01, help="Time per run, in the comparison at equal time.")
    ] = EACH,
    bound_from: Annotated[
        str | None,
        typer.Option(
            help="A method that is run once, up to a minute, to prove a bound.",
            autocompletion=method_words,
        ),
    ] = None,
    html: Html = None,
    pdf: Pdf = None,
    csv: Csv = None,
    as_json: Json = False,
) -> None:
    """Compare methods by their gap to the proven bound. Ctrl-C reports finished runs."""
    from gearopt.api import compare as compare_file

    files = checked(html, pdf, csv, "metric", file)
    named = [name.strip() for name in (methods or "").split(",") if name.strip()]
    with following(_words, quiet=as_json, kept=lambda now: now.done > 0) as watch:
        comparison = compare_file(
            file,
            objectives=objectives,
            most=numbers("--most", most) if most else None,
            methods=None if methods is None else named,
            seeds=seeds,
            evaluations=evaluations,
            seconds=seconds,
            bound_from=bound_from,
            watch=watch if as_json else _announced(watch),
        )
    lines: list[str] = []
    try:
        lines = compared(comparison, files)
    finally:  # what took long to find is shown even where no page can be written
        answer(comparison, as_json, lines)


def _announced(watch: Callable[[Progress], bool]) -> Callable[[Progress], bool]:
    """Return the watcher, which first prints how long all will take."""
    announced = False

    def announcing(progress: Progress) -> bool:
        nonlocal announced
        if progress.total and not announced:
            announced = True
            words = f"{progress.total} runs, about {_time(progress.left)}"
            Console(stderr=True, highlight=False).print(words, style="dim")
        return watch(progress)

    return announcing


def _words(now: Progress) -> str:
    if not now.total:
        return f"{'start-up of' if now.event is None else 'a bound from'} {now.method}"
    parts = [f"run {now.done + 1} of {now.total}: {now.method}, seed {now.seed}"]
    parts += [] if now.event is None else reached(now.event)
    return ", ".join([*parts, f"about {_time(now.left)} left"])


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
