"""The typer application that the commands register with, and what they share."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

import gearopt
from gearopt.cli.names import problem_files, system_words
from gearopt.cli.watching import unbroken
from gearopt.errors import GearoptError
from gearopt.optimise.result import Result
from gearopt.report.screen import Screen, harmless

if TYPE_CHECKING:
    from gearopt.optimise.pareto.front import Front

HELP = "\n\n".join(
    (
        "Design gear drives, and prove that no better design is possible.",
        "A text file says what is needed: power, speeds, limits. gearopt finds the smallest or "
        "lightest gears that do it, and proves how much smaller any other design could be: "
        "usually not at all. It does so for drives of up to six stages and the box around them, "
        "for spur pairs and the contact of their teeth, for servo axes, for compound trains of "
        "a given ratio, and for packings of cylinders. Given gears are rated by AGMA and ISO 6336.",
        "Begin with three commands: [bold]new[/] prints a file to start from, [bold]solve[/] finds "
        "the best design for it, and [bold]explain[/] says how much each number of it matters.",
        "Examples:",
        "[bold]gearopt new drive > my.toml[/]               a file with comments, to be edited\n"
        "[bold]gearopt solve my.toml[/]                     the best gears, with the proof\n"
        "[bold]gearopt solve my.toml --html page.html[/]    the same as a page with drawings\n"
        "[bold]gearopt explain my.toml[/]                   what would change it, and how much\n"
        "[bold]gearopt new rating > pair.toml[/]            a given pair of gears\n"
        "[bold]gearopt rate pair.toml[/]                    its stresses, safety and life",
    )
)
TO_BEGIN, MORE_OF_FILES, TOOLS = "To begin with", "Further commands", "For editors and machines"

app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False, rich_markup_mode="rich")

EXIT = {"optimal": 0, "stationary": 0, "feasible": 0, "infeasible": 3, "failed": 4}

File = Annotated[
    Path,
    typer.Argument(help="A problem file (TOML).", show_default=False, autocompletion=problem_files),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Units = Annotated[
    str | None,
    typer.Option(
        help="Units to show: metric, or inch (in, psi, lb, diametral pitch); by default those of "
        "the key units of the file, else metric.",
        autocompletion=system_words,
    ),
]
Csv = Annotated[
    Path | None, typer.Option("--csv", help="Write every table as a CSV file into this folder.")
]
Html = Annotated[
    Path | None,
    typer.Option("--html", help="Write a page that any browser shows, without a network."),
]
Pdf = Annotated[
    Path | None,
    typer.Option(
        "--pdf", help="Write the page as PDF, by Chromium, Chrome or Edge if one is installed."
    ),
]

Most = Annotated[
    list[str] | None,
    typer.Option(
        help="NAME=NUMBER: largest value of interest of an objective, in mm, mm3 or kg; may be "
        "repeated."
    ),
]


def _print_version(wanted: bool) -> None:
    if wanted:
        print(gearopt.__version__)
        raise typer.Exit()


@app.callback(help=HELP)
def options(
    shown: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Read the options that stand before a command."""


def exit_code(result: Result) -> int:
    """Return exit code of a result."""
    if result.status == "limit":
        return 4 if result.value is None and not result.given else 0
    if result.status == "evaluated":  # a rating of gears that fit answers its question, safe or not
        rating = result.design.get("rating")
        return 3 if not result.feasible and (not rating or rating.get("misfits")) else 0
    return EXIT[result.status]


def front_code(front: "Front") -> int:
    """Return exit code of a Pareto front: without a design that of an impossible or open result."""
    if front.status == "infeasible":
        return EXIT[front.status]
    return 0 if front.points else EXIT["failed"]


def told(wrong: GearoptError) -> str:
    """Return a line for every mistake that an error names."""
    return "\n".join(f"gearopt: {harmless(line)}" for line in str(wrong).splitlines())


def print_whole(text: str, end: str = "\n") -> None:
    """Print all of what a file may be made of, even if Ctrl-C comes."""
    with unbroken():
        print(text, end=end, flush=True)


def console() -> Console:
    """Return the terminal; wide where it is a pipe."""
    terminal = Screen(highlight=False)
    return terminal if terminal.is_terminal else Screen(highlight=False, width=110)


def numbers(option: str, pairs: list[str]) -> dict[str, float]:
    """Return numbers by name; GearoptError for what is none."""
    values = {}
    for pair in pairs:
        name, _, text = pair.partition("=")
        try:
            values[name.strip()] = float(text)
        except ValueError:
            example = f"{name.strip() or 'gear_volume'}=8.5e6"
            raise GearoptError(f"{option} {pair}: is not NAME=NUMBER, such as {example}") from None
    return values
