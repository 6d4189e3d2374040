"""`check`, `schema` and `new`: problem files without solving them."""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from gearopt.cli.app import Json, app, print_whole
from gearopt.errors import GearoptError


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
        print_whole(json.dumps(found, indent=2))
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
        print_whole(reference(_known(kind)), end="")
    else:
        print_whole(json.dumps(json_schema(_known(kind)), indent=2))


@app.command()
def new(kind: Annotated[str, typer.Argument(help="A kind of problem file.")] = "drive") -> None:
    """Print a problem file to start from: `gearopt new drive > my.toml`."""
    from gearopt.scenes.reading.load import scene_module

    print_whole(scene_module(_known(kind)).EXAMPLE, end="")


def _known(kind: str) -> str:
    from gearopt.scenes.reading.load import kinds

    if kind not in kinds():
        raise GearoptError(f"no kind {kind!r} of problem file; kinds: {', '.join(kinds())}")
    return kind
