"""`check`, `schema`, `new`: problem files without solving them."""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from gearopt.cli.app import MORE_OF_FILES, TO_BEGIN, TOOLS, Json, app, print_whole, told
from gearopt.cli.names import example_words, kind_words, problem_files
from gearopt.errors import GearoptError, SceneError

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
    """Read problem files and report their mistakes, without solving.

    Another file whose gears one takes is solved, as they must agree.
    """
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
