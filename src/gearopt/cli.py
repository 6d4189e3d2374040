"""The command line. Exit codes: 0 solved, 2 bad input, 3 proven infeasible, 4 nothing found."""

import json
import platform
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from gearopt.errors import GearoptError
from gearopt.optimise.result import Budget, Event, Result, Watch

app = typer.Typer(
    help="Size gear drives to a proven optimum.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)

EXIT = {"optimal": 0, "stationary": 0, "feasible": 0, "infeasible": 3, "failed": 4}

File = Annotated[Path, typer.Argument(help="A problem file (TOML).", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]


def run() -> None:
    """Run a command; errors on purpose become one message and exit code 2."""
    try:
        app()
    except GearoptError as wrong:
        print(f"gearopt: {wrong}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # `gearopt ... | head`
        sys.stderr.close()
        sys.exit(0)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(version("gearopt"))
        raise typer.Exit()


@app.callback()
def options(
    shown: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Size gear drives to a proven optimum."""


@app.command()
def solve(
    file: File,
    method: Annotated[
        str | None,
        typer.Option(
            help="By default exact where the file has a \\[teeth] table, else ipopt; "
            "docs/methods.md lists all."
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

    with _watching(seconds, quiet=as_json) as watch:
        result = solve_file(
            file, method, budget=Budget(seconds), seed=seed, watch=watch, gap=gap, top=top
        )
    if as_json:
        print(result.to_json())
    else:
        from gearopt.report.terminal import show

        show(result, _title(file), _console())
    raise typer.Exit(_exit_code(result))


def _exit_code(result: Result) -> int:
    if result.status == "limit":
        return 4 if result.value is None else 0
    return EXIT[result.status]


def _title(file: Path) -> str:
    from gearopt.api import load

    title: str = getattr(load(file), "title", "") or file.name
    return title


def _console() -> Console:
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=110)


@contextmanager
def _watching(seconds: float, quiet: bool) -> Iterator[Watch]:
    """A watcher that ends the run at Ctrl-C (the second one kills) and shows long work."""
    stopped = False

    def stop(number: int, frame: Any) -> None:
        nonlocal stopped
        stopped = True
        signal.signal(signal.SIGINT, before)

    before = signal.signal(signal.SIGINT, stop)
    screen = Console(stderr=True, highlight=False)
    status = screen.status("") if screen.is_terminal and not quiet else None
    started, shown = time.perf_counter(), 0.0

    def watch(event: Event) -> bool:
        nonlocal shown
        now = time.perf_counter() - started
        if status is not None and now > 0.5 and now > shown + 0.2:
            shown = now
            status.start()
            status.update(_progress(event, seconds - now))
        return not stopped

    try:
        yield watch
    finally:
        if status is not None:
            status.stop()
        signal.signal(signal.SIGINT, before)


def _progress(event: Event, left: float) -> str:
    parts = [f"{event.evaluations:,} evaluations"]
    if event.best is not None:
        parts.append(f"best {event.best:,.6g}")
        if event.bound is not None:
            parts.append(f"gap {100 * (1 - event.bound / event.best):.2g} %")
    return ", ".join([*parts, f"{max(left, 0.0):.0f} s left"])


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="Problem files (TOML).", show_default=False)],
    as_json: Json = False,
) -> None:
    """Read problem files and say what is wrong with them, without solving."""
    from gearopt.errors import SceneError
    from gearopt.scenes.reading.load import load

    found: list[dict[str, Any]] = []
    for file in files:
        try:
            loaded = load(file)
        except SceneError as wrong:
            found.append(
                {
                    "file": str(file),
                    "valid": False,
                    "key": wrong.key,
                    "value": wrong.value,
                    "rule": wrong.rule,
                    "fix": None if wrong.fix is None else asdict(wrong.fix),
                    "remedy": wrong.remedy,
                }
            )
            if not as_json:
                print(f"gearopt: {wrong}", file=sys.stderr)
        else:
            found.append({"file": str(file), "valid": True, "kind": loaded.kind})
            if not as_json:
                print(f"{file}: a valid {loaded.kind} file")
    if as_json:
        print(json.dumps(found, indent=2))
    raise typer.Exit(0 if all(f["valid"] for f in found) else 2)


@app.command()
def schema(
    kind: Annotated[str, typer.Argument(help="A kind of problem file.")] = "drive",
    table: Annotated[
        bool, typer.Option("--table", help="Print tables of all keys in Markdown instead.")
    ] = False,
) -> None:
    """Print the JSON schema of a kind of problem file, for editors."""
    from gearopt.scenes.reading.schema import json_schema, reference

    if table:
        print(reference(_known(kind)), end="")
    else:
        print(json.dumps(json_schema(_known(kind)), indent=2))


@app.command()
def new(kind: Annotated[str, typer.Argument(help="A kind of problem file.")] = "drive") -> None:
    """Print a problem file to start from: `gearopt new drive > my.toml`."""
    from gearopt.scenes.reading.load import scene_module

    print(scene_module(_known(kind)).EXAMPLE, end="")


def _known(kind: str) -> str:
    from gearopt.scenes.reading.load import kinds

    if kind not in kinds():
        raise GearoptError(f"no kind {kind!r} of problem file; kinds: {', '.join(kinds())}")
    return kind


@app.command()
def doctor(as_json: Json = False) -> None:
    """Show versions, and whether the solvers work on this machine."""
    packages = ("gearopt", "numpy", "casadi", "cvxpy", "pymoo", "pyscipopt", "pydantic", "typer")
    found: dict[str, str] = {"python": platform.python_version(), "machine": platform.platform()}
    found |= {name: _version(name) for name in packages}
    checks = {"exact": _works("exact"), "ipopt": _works("ipopt")}
    found |= {f"{name} works": word for name, word in checks.items()}
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        for name, text in found.items():
            print(f"{name:14} {text}")
    raise typer.Exit(0 if all(w.startswith("yes") for w in checks.values()) else 1)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"


def _works(method: str) -> str:
    """Solve the example file by a method; the check is the certificate's."""
    from gearopt.scenes.reading.ask import Ask
    from gearopt.scenes.reading.load import read, scene_module

    module = scene_module("drive")
    start = time.perf_counter()
    try:
        _, scene = read(module.EXAMPLE.encode())
        result: Result = module.solve(scene, Ask(method))
    except Exception as broken:  # a doctor reports what is broken, whatever it is
        return f"no: {type(broken).__name__}: {broken}"
    word = "yes" if result.status == "optimal" else f"no: {result.status} {result.message}"
    return f"{word} ({1000 * (time.perf_counter() - start):.0f} ms)"


@app.command()
def bench(
    name: Annotated[str, typer.Argument(help="A bench; drive is the first.")] = "drive",
    repeat: Annotated[int, typer.Option(min=1, help="Runs to take the median of.")] = 7,
    as_json: Json = False,
) -> None:
    """Measure speed beside error on cases with known optima."""
    from importlib import import_module

    from gearopt.bench import names

    if name not in names():
        raise GearoptError(f"no bench {name!r}; benches: {', '.join(names())}")
    measure: Callable[[int], list[dict[str, Any]]] = import_module(f"gearopt.bench.{name}").run
    rows = measure(repeat)
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    from gearopt.report.terminal import rows_table

    _console().print(rows_table(rows))
