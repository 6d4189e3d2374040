"""`export`: the answer to a file, or a kept result, as other programs read it."""

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from gearopt.cli.app import MORE_OF_FILES, File, app, print_whole
from gearopt.cli.reporting import kept_design
from gearopt.cli.watching import watching
from gearopt.cli.writing import Written, check_html, write
from gearopt.errors import GearoptError
from gearopt.optimise.result import Budget, Result
from gearopt.report.words import SECONDS

FORMATS = {"dxf": "DXF", "csv": "CSV"}  # option and name


@app.command(rich_help_panel=MORE_OF_FILES)
def export(
    file: File,
    dxf: Annotated[
        bool, typer.Option("--dxf", help="Sections of all gears and meshes, and views, for CAD.")
    ] = False,
    csv: Annotated[
        bool,
        typer.Option(
            "--csv",
            help="Tables for makers: drawing data and places of shafts, relief to grind, flanks "
            "and cutting edge, motions over speed.",
        ),
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write this file; else it is printed.")
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=0.0, help="Stop solving after this time.")
    ] = SECONDS,
) -> None:
    """Write the gears of a file, or of its kept result, for CAD and other programs."""
    from gearopt.report.kinds import pages_of

    asked = [name for name, wanted in (("dxf", dxf), ("csv", csv)) if wanted]
    if len(asked) != 1:
        raise GearoptError(f"export writes one format: add one of {_options(FORMATS)}")
    check_html(out, file, option="--out", example=f"gears.{asked[0]}")
    known, result = _read(file)
    exports = pages_of(known).exports
    if (make := exports.get(asked[0])) is None:
        instead = f"there is {_options(exports)}" if exports else "solve FILE --html shows it"
        raise GearoptError(f"--{asked[0]}: no such file is made of kind {known}; {instead}")
    result = result or _answer(file, seconds)
    if not result.design:
        raise GearoptError(f"{file}: has no design to export ({result.status}: {result.message})")
    try:
        content = make(result).decode()
    except (ValueError, ImportError) as why:
        raise GearoptError(f"--{asked[0]}: {why}") from None
    if out is None:
        print_whole(content, end="")
        return
    write(Written("--out", out, content))
    print(f"{FORMATS[asked[0]]}: {out}", file=sys.stderr)


def _options(names: Iterable[str]) -> str:
    return " or ".join(f"--{name}" for name in names)


def _read(file: Path) -> tuple[str | None, Result | None]:
    """The kind of a file, and the result that it keeps, if it is no problem file."""
    from gearopt.api import load
    from gearopt.scenes.reading.load import kind_of

    if file.suffix != ".json":
        return kind_of(load(file)), None
    kept = kept_design(file, None)
    assert isinstance(kept, Result)
    return kept.scene, kept


def _answer(file: Path, seconds: float) -> Result:
    """The answer to a problem file, whose gears are rated where they are given."""
    from gearopt.api import load, rate, solve
    from gearopt.scenes.reading.load import kind_named, kind_of

    scene = load(file)
    if kind_named(kind_of(scene)).rate is not None and not getattr(scene, "to_size", True):
        return rate(file)
    with watching(seconds, quiet=False) as watch:
        return solve(file, budget=Budget(seconds), watch=watch)
