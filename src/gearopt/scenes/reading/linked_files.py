"""Another file as an input of a problem file: a kept result, or a problem file solved first."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from gearopt.errors import SceneError
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import Opened, Reads, refuse
from gearopt.scenes.reading.file_bytes import LARGEST_FILE, LARGEST_KEPT, first_bytes
from gearopt.scenes.reading.load import kind_named
from gearopt.scenes.reading.load import read as read_scene


@dataclass(frozen=True)
class Input:
    """A file that another one names: `what` is the result kept in it, or its scene.

    file: as it is named; sha256: of its bytes.
    """

    file: str
    sha256: str
    kind: str
    what: Result | BaseModel

    def __str__(self) -> str:
        return self.file

    def result(self, ask: Ask) -> Result:
        """Return the result with its design; SceneError where solving the file finds none."""
        if isinstance(self.what, Result):
            return self.what
        default = replace(ask, method=None, top=1)
        result = kind_named(self.kind).solve(self.what, default)
        if result.design:
            return result
        rule = f"its design is an input here, and it has none ({result.status}: {result.message})"
        raise SceneError(self.file, "", "", rule, f"See what `gearopt solve {self.file}` says")


def result_of(kind: str) -> Reads:
    """Read the name of a file of a kind, or of its kept result; from the folder of the file."""
    remedy = (
        f"Name a problem file of kind {kind}, or the file of what `gearopt solve FILE --json` "
        "printed of one"
    )

    def wrong(rule: str) -> Exception:
        return refuse(rule, remedy, action="tell")

    def read(value: Any, example: Any, opened: Opened | None) -> Input:
        if isinstance(value, Input):
            return value
        if not isinstance(value, str):
            raise refuse("is not the name of a file in quotes")
        before = () if opened is None else opened.files
        path = before[-1].parent / value if before else Path(value)
        if path.resolve() in before:
            raise wrong("is a file that needs this one as its input")
        kept = path.suffix == ".json"
        try:
            data = first_bytes(path, LARGEST_KEPT if kept else LARGEST_FILE)
        except (OSError, ValueError):
            raise wrong("is not a file that can be read") from None
        what: Result | BaseModel
        if kept:
            what = result = _kept(data, wrong)
            file_kind = result.scene or "a problem of one's own"
        else:
            file_kind, what = read_scene(data, str(path), before)
        if file_kind != kind:
            raise wrong(f"is of kind {file_kind}, not {kind}")
        return Input(value, hashlib.sha256(data).hexdigest(), kind, what)

    return Reads(read, f"{kind}.json", {"type": "string"}, opens=True)


def _kept(data: bytes, wrong: Any) -> Result:
    if len(data) > LARGEST_KEPT:
        raise wrong(f"is larger than a kept result, which has at most {LARGEST_KEPT:,} bytes")
    try:
        result = Result.from_json(data.decode("utf-8-sig"))
    except (UnicodeDecodeError, json.JSONDecodeError):
        raise wrong("is not JSON") from None
    except ValueError as reason:
        raise wrong(str(reason)) from None
    if not result.design:
        raise wrong(f"holds a result without a design ({result.status})")
    return result


def inputs_of(scene: Any) -> dict[str, str]:
    """Return the files that a scene names, with the hash of the bytes of each."""
    if isinstance(scene, Input):
        return {scene.file: scene.sha256}
    parts = [v for _, v in scene] if isinstance(scene, BaseModel) else scene
    if not isinstance(parts, list | tuple):
        return {}
    return {file: sha256 for part in parts for file, sha256 in inputs_of(part).items()}
