"""`doctor`, `bench`: whether the solvers work on this machine, and how fast."""

import json
import platform
from collections.abc import Callable
from importlib import import_module
from typing import Annotated, Any

import typer

from gearopt.cli.app import TOOLS, Json, app, console, print_whole
from gearopt.cli.names import bench_words
from gearopt.errors import GearoptError
from gearopt.optimise.clock import Clock


@app.command(rich_help_panel=TOOLS)
def doctor(as_json: Json = False) -> None:
    """Show versions, and whether the solvers work on this machine."""
    packages = (
        "gearopt",
        "numpy",
        "casadi",
        "cvxpy",
        "pymoo",
        "pyscipopt",
        "scikit-fem",
        "pydantic",
        "typer",
    )
    facts: dict[str, str] = {"python": platform.python_version(), "machine": platform.platform()}
    facts |= {name: _version(name) for name in packages}
    checks = {"exact": _works("exact"), "ipopt": _works("ipopt")}
    facts |= {f"{name} works": word for name, word in checks.items()}
    if as_json:
        print_whole(json.dumps(facts, indent=2))
    else:
        for name, text in facts.items():
            print(f"{name:14} {text}")
    raise typer.Exit(0 if all(w.startswith("yes") for w in checks.values()) else 1)


def _version(name: str) -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"


def _works(method: str) -> str:
    """Solve the example file by a method; the check is the certificate's."""
    from gearopt.scenes.reading.ask import Ask
    from gearopt.scenes.reading.load import kind_named, read

    drive = kind_named("drive")
    clock = Clock()
    try:
        _, scene = read(drive.example.text.encode())
        result = drive.solve(scene, Ask(method))
    except Exception as broken:  # a doctor reports what is broken, whatever it is
        return f"no: {type(broken).__name__}: {broken}"
    word = "yes" if result.status == "optimal" else f"no: {result.status} {result.message}"
    return f"{word} ({1000 * clock.seconds:.0f} ms)"


@app.command(rich_help_panel=TOOLS)
def bench(
    name: Annotated[
        str, typer.Argument(help="A bench: {benches}.", autocompletion=bench_words)
    ] = "drive",
    repeat: Annotated[int, typer.Option(min=1, help="Runs to take the median of.")] = 7,
    as_json: Json = False,
) -> None:
    """Measure speed beside error on cases with known optima."""
    from gearopt.bench import names

    if name not in names():
        raise GearoptError(f"no bench {name!r}; benches: {', '.join(names())}")
    measure: Callable[[int], list[dict[str, Any]]] = import_module(f"gearopt.bench.{name}").run
    rows = measure(repeat)
    if as_json:
        print_whole(json.dumps(rows, indent=2))
        return
    from gearopt.report.section import Table
    from gearopt.report.terminal import grid
    from gearopt.report.words import heading

    cells, wide = [list(row.values()) for row in rows], len(rows[0])
    table, screen = Table(name, [heading(key) for key in rows[0]], cells, wrap=wide), console()
    screen.print(grid(table, screen.width))
