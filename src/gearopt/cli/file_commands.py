"""`check`, `schema`, `new`: problem files without solving them; `doctor`, `bench`: this machine."""

import json
import platform
import sys
from collections.abc import Callable
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from gearopt.cli.app import MORE_OF_FILES, TO_BEGIN, TOOLS, Json, app, console, print_whole, told
from gearopt.cli.names import bench_words, example_words, kind_words, problem_files
from gearopt.errors import GearoptError, SceneError
from gearopt.optimise.clock import Clock

Kind = Annotated[
    str, typer.Argument(help="A kind of problem file: {kinds}.", autocompletion=kind_words)
]


@app.command(rich_help_panel=MORE_OF_FILES)
def check(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Problem files (TOML).", show_default=False, autocompletion=problem_files
        ),
    ],
    as_json: Json = False,
) -> None:
    """Read problem files and report their mistakes, without solving."""
    from gearopt.scenes.reading.load import load

    reports: list[dict[str, Any]] = []
    for file in files:
        try:
            loaded = load(file)
        except SceneError as wrong:
            errors = [_plain(error) for error in wrong.errors]
            reports.append({"file": str(file), "valid": False, **errors[0], "errors": errors})
            if not as_json:
                print(told(wrong), file=sys.stderr)
        else:
            reports.append({"file": str(file), "valid": True, "kind": loaded.kind})
            if not as_json:
                print(f"{file}: a valid {loaded.kind} file")
    if as_json:
        print_whole(json.dumps(reports, indent=2))
    raise typer.Exit(0 if all(f["valid"] for f in reports) else 2)


def _plain(error: SceneError) -> dict[str, Any]:
    """Return one mistake of a file as JSON holds it."""
    fix = None if error.fix is None else asdict(error.fix)
    names = ("key", "value", "rule", "remedy")
    return {name: getattr(error, name) for name in names} | {"fix": fix}


@app.command(rich_help_panel=TOOLS)
def schema(
    kind: Kind = "drive",
    table: Annotated[
        bool, typer.Option("--table", help="Print tables of all keys in Markdown instead.")
    ] = False,
) -> None:
    """Print the JSON schema of a kind of problem file, for editors."""
    from gearopt.scenes.reading.json_schema import json_schema, reference

    if table:
        print_whole(reference(_known(kind)), end="")
    else:
        print_whole(json.dumps(json_schema(_known(kind)), indent=2))


@app.command(rich_help_panel=TO_BEGIN)
def new(
    name: Annotated[
        str,
        typer.Argument(
            metavar="KIND",
            help="What to start from: {examples}.",
            autocompletion=example_words,
        ),
    ] = "drive",
) -> None:
    """Print a problem file to start from: `gearopt new drive > my.toml`."""
    from gearopt.scenes.reading.load import examples

    known = examples()
    if name not in known:
        raise GearoptError(f"no problem file {name!r} to start from: {', '.join(known)}")
    print_whole(known[name], end="")


def _known(kind: str) -> str:
    from gearopt.scenes.reading.kinds import kinds

    if kind not in kinds():
        raise GearoptError(f"no kind {kind!r} of problem file; kinds: {', '.join(kinds())}")
    return kind


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
