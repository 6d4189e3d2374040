"""Another file as an input of a problem file: a kept result, or a problem file solved first."""

import hashlib
import json
from dataclasses import field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast

from pydantic import BaseModel, Field, create_model

from gearopt.errors import SceneError
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result, plain
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import Opened, Reads, Table, refuse, whole
from gearopt.scenes.reading.file_bytes import LARGEST_FILE, LARGEST_KEPT, first_bytes
from gearopt.scenes.reading.load import kind_named
from gearopt.scenes.reading.load import read as read_scene


@dataclass(frozen=True)
class Input:
    """A file that another one names: `what` is the result kept in it, or its scene.

    file: as it is named; sha256: of its bytes; path: where it is; solved: the result of its scene,
    once it is known.
    """

    file: str
    sha256: str
    kind: str
    what: Result | BaseModel = field(hash=False)
    path: Path = Path()
    solved: Result | None = field(default=None, hash=False)

    def __str__(self) -> str:
        return self.file

    @property
    def scene(self) -> BaseModel:
        """The scene of the file; of a kept result that of the tables it answers."""
        if isinstance(self.what, BaseModel):
            return self.what
        return read_scene(self.what.asked, str(self.path))[1]

    def answered(self, ask: Ask) -> "Input":
        """The file with its result, which is not sought again."""
        return replace(self, solved=self.result(ask))

    def result(self, ask: Ask) -> Result:
        """Return the result with its design; SceneError where solving the file finds none."""
        known = self.what if isinstance(self.what, Result) else self.solved
        if known is not None:
            return self._with_design(known)
        assert isinstance(self.what, BaseModel)
        inputs = inputs_of(self.what)
        key = str((self.path, self.sha256, inputs, ask.budget, ask.gap, ask.seed))
        if key not in _SOLVED:
            default, kind = replace(ask, method=None, top=1), kind_named(self.kind)
            rated = kind.rate is not None and not getattr(self.what, "to_size", True)
            answer = kind.rate if rated and kind.rate else kind.solve
            result = answer(self.what, default)
            report = plain(result.report | ({"inputs": inputs} if inputs else {}))
            result = replace(result, report=report, design=plain(result.design))
            if result.status == "limit":
                return self._with_design(result)
            _SOLVED[key] = result
            for old in list(_SOLVED)[:-MOST_SOLVED]:
                del _SOLVED[old]
        return self._with_design(_SOLVED[key])

    def _with_design(self, result: Result) -> Result:
        if result.design:
            return result
        rule = f"its design is an input here, and it has none ({result.status}: {result.message})"
        raise SceneError(self.file, "", "", rule, f"See what `gearopt solve {self.file}` says")


def result_of(*kinds: str) -> Reads:
    """Read the name of a file of a kind, or of its kept result; from the folder of the file."""
    known = " or ".join(kinds)
    remedy = (
        f"Name a problem file of kind {known}, or the file of what `gearopt solve FILE --json` "
        "printed of one"
    )

    def wrong(rule: str) -> Exception:
        return refuse(rule, remedy, action="tell")

    def read(value: Any, example: Any, opened: Opened | None) -> Input:
        if isinstance(value, Input) and value.kind in kinds:
            return value
        if isinstance(value, Input):
            raise wrong(f"is of kind {value.kind}, not {known}")
        if not isinstance(value, str):
            raise refuse("is not the name of a file in quotes")
        before = () if opened is None else opened.files
        path = before[-1].parent / value if before else Path(value)
        if path.resolve() in before:
            raise wrong("is a file that needs this one as its input")
        kept = path.suffix == ".json"
        try:
            data = first_bytes(path, LARGEST_KEPT if kept else LARGEST_FILE)
        except FileNotFoundError:
            others = (p.name for p in path.parent.glob("*.*") if p.resolve() not in before)
            there = get_close_matches(path.name, others, 1, ALIKE)
            meant = f'Did you mean "{there[0]}", which stands beside it? ' if there else ""
            raise refuse("does not exist", meant + remedy, action="tell") from None
        except (OSError, ValueError):
            raise wrong("is not a file that can be read") from None
        what: Result | BaseModel
        if kept:
            what = result = _kept(data, wrong)
            file_kind = result.scene or "a problem of one's own"
        else:
            file_kind, what = read_scene(data, str(path), opened)
        if file_kind not in kinds:
            raise wrong(f"is of kind {file_kind}, not {known}")
        return Input(value, hashlib.sha256(data).hexdigest(), file_kind, what, path.resolve())

    return Reads(read, f"{kinds[0]}.json", {"type": "string"}, opens=True)


_SOLVED: dict[str, Result] = {}  # of files by their bytes, for the next one that asks
MOST_SOLVED = 8  # results that are kept

LinkKeys = create_model(
    "LinkKeys",
    __base__=Table,
    **cast(
        Any,
        {
            "from": (
                Annotated[Input | None, result_of("drive", "pair")],
                Field(
                    None,
                    description="File whose answer has the gears, or its kept result: their sizes, "
                    "materials, loads and rating follow, and what is given besides must agree",
                ),
            ),
            "stage": (
                Annotated[int | None, whole(2, 1, 6)],
                Field(None, description="Stage of that file, from 1; needed where it has several"),
            ),
        },
    ),
)
ALIKE = 0.8  # of the letters of the names of a missing file and of one beside it
T = TypeVar("T", bound=Table)


def takes_gears(table: type[T]) -> type[T]:
    """Return a table with the keys of a file that its gears are taken from as its first ones.

    They are no attributes by these names: `from` is a word of Python.
    """
    inside = {"__module__": table.__module__, "__doc__": table.__doc__}
    metaclass: Any = type(table)
    return cast(type[T], metaclass(table.__name__, (table, LinkKeys), inside))


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


def stopped_early(scene: Any) -> list[str]:
    """A sentence on the file whose gears a scene takes, where it was not solved to its end."""
    source = getattr(getattr(scene, "gears", None), "from", None)
    if source is None or source.result(Ask()).status != "limit":
        return []
    gears = f"The gears are those that {source.file} had when its time ended"
    return [f"{gears}: with more time there may be better ones."]


def inputs_of(scene: Any) -> dict[str, str]:
    """Return the files that a scene names, and those that these name, each with its hash."""
    if isinstance(scene, Input):
        beyond = inputs_of(scene.what) if isinstance(scene.what, BaseModel) else {}
        return {scene.file: scene.sha256} | beyond
    parts = [v for _, v in scene] if isinstance(scene, BaseModel) else scene
    if not isinstance(parts, list | tuple):
        return {}
    return {file: sha256 for part in parts for file, sha256 in inputs_of(part).items()}
