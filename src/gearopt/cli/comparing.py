"""`compare`: methods side by side, on the same model, seeds and budget."""

from collections.abc import Callable
from typing import Annotated

import typer
from rich.console import Console

from gearopt.cli.app import File, Html, Json, app, console, print_whole
from gearopt.cli.watching import following, reached
from gearopt.cli.writing import check_html, write
from gearopt.optimise.comparing.compare import EVALUATIONS, SECONDS, SEEDS, Progress
from gearopt.optimise.comparing.comparison import Comparison


@app.command()
def compare(
    file: File,
    methods: Annotated[
        str | None,
        typer.Option(
            help="Methods by name, with commas between; docs/methods.md lists all. By default a "
            "choice for the kind of the file."
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Runs of every random method.")] = SEEDS,
    evaluations: Annotated[
        int, typer.Option(min=1, help="Evaluations of a run, where these are held equal.")
    ] = EVALUATIONS,
    seconds: Annotated[
        float, typer.Option(min=0.01, help="Time of a run, where that is held equal.")
    ] = SECONDS,
    bound_from: Annotated[
        str | None,
        typer.Option(help="A method that is run once, up to a minute, to prove a bound."),
    ] = None,
    html: Html = None,
    as_json: Json = False,
) -> None:
    """Compare methods by their gap to what is proven. Ctrl-C reports the runs that are finished."""
    from gearopt.api import compare as compare_file

    check_html(html, file)
    named = None
    if methods is not None:
        named = [name.strip() for name in methods.split(",") if name.strip()]
    with following(_words, quiet=as_json) as watch:
        found = compare_file(
            file,
            named,
            seeds=seeds,
            evaluations=evaluations,
            seconds=seconds,
            bound_from=bound_from,
            watch=watch if as_json else _announced(watch),
        )
    try:
        if html is not None:
            from gearopt.report.pages.comparison import page

            write("--html", html, page(found))
    finally:  # what took long to find is shown even where no page can be written
        _show(found, as_json)
    if html is not None and not as_json:
        print(f"\nPage: {html}")


def _show(found: Comparison, as_json: bool) -> None:
    if as_json:
        print_whole(found.to_json())
        return
    from gearopt.report.terminal import show_comparison

    show_comparison(found, console())


def _announced(watch: Callable[[Progress], bool]) -> Callable[[Progress], bool]:
    """The watcher, which says first how long all will take."""
    told = False

    def announcing(progress: Progress) -> bool:
        nonlocal told
        if progress.total and not told:
            told = True
            words = f"{progress.total} runs, about {_time(progress.left)}"
            Console(stderr=True, highlight=False).print(words, style="dim")
        return watch(progress)

    return announcing


def _words(now: Progress) -> str:
    if not now.total:
        return f"a bound from {now.method}"
    parts = [f"run {now.done + 1} of {now.total}: {now.method}, seed {now.seed}"]
    parts += [] if now.event is None else reached(now.event)
    return ", ".join([*parts, f"about {_time(now.left)} left"])


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
