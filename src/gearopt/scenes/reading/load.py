"""From a TOML file to a scene: read, check, and say in one message what is wrong."""

import hashlib
import reprlib
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

import gearopt.scenes
from gearopt.errors import Fix, SceneError
from gearopt.scenes.reading.fields import Reads

FORMAT = 1


@dataclass(frozen=True)
class Loaded:
    """A scene with the file it came from and the hash of its bytes."""

    scene: BaseModel
    kind: str
    file: str
    sha256: str


def kinds() -> tuple[str, ...]:
    """The kinds of problem file: the modules of `gearopt.scenes`."""
    return tuple(sorted(m.name for m in iter_modules(gearopt.scenes.__path__) if not m.ispkg))


def scene_module(kind: str) -> Any:
    """The module of a kind."""
    return import_module(f"gearopt.scenes.{kind}")


def load(path: str | Path) -> Loaded:
    """Read a problem file; SceneError says where it is wrong and what to write instead."""
    file = str(path)
    try:
        data = Path(path).read_bytes()
    except IsADirectoryError:
        raise SceneError(file, "", "", "is a directory, not a file", _name_a_file(file)) from None
    except FileNotFoundError:
        raise SceneError(file, "", "", "there is no such file", _name_a_file(file)) from None
    except (OSError, ValueError) as reason:
        text = getattr(reason, "strerror", None) or str(reason)
        raise SceneError(file, "", "", f"cannot be read ({text})", _name_a_file(file)) from None
    kind, scene = read(data, file)
    return Loaded(scene, kind, file, hashlib.sha256(data).hexdigest())


def _name_a_file(file: str) -> str:
    near = get_close_matches(Path(file).name, [p.name for p in _beside(file)], n=1)
    found = f"Did you mean {Path(file).parent / near[0]}? " if near else ""
    return f"{found}`gearopt new drive` prints a file to start from"


def _beside(file: str) -> list[Path]:
    try:
        return sorted(Path(file).parent.glob("*.toml"))
    except (OSError, ValueError):
        return []


def read(data: bytes, file: str = "<text>") -> tuple[str, BaseModel]:
    """Kind and scene of the bytes of a problem file; `file` is the name used in messages."""
    content = _parse(data, file)
    if not content:
        raise SceneError(
            file,
            "",
            "",
            "is empty",
            "Start from what `gearopt new drive` prints",
            Fix("replace", "", "new drive"),
        )
    version = content.pop("gearopt", None)
    if version != FORMAT or isinstance(version, bool):
        rule = "names no format version" if version is None else "is not a known format version"
        raise _error(file, "gearopt", version, rule, FORMAT)
    kind = content.pop("kind", None)
    if not isinstance(kind, str) or kind not in kinds():
        known = ", ".join(f'"{k}"' for k in kinds())
        near = get_close_matches(str(kind)[:80], kinds(), n=1) or kinds()[:1]
        rule = "names no kind" if kind is None else f"is not a known kind (known: {known})"
        raise _error(file, "kind", kind, rule, near[0])
    own = [key for key in content if key.startswith("x-")]  # the user's tables
    for key in own:
        del content[key]
    model: type[BaseModel] = scene_module(kind).Scene
    try:
        return kind, model.model_validate(content)
    except ValidationError as wrong:
        raise _translate(file, model, content, wrong) from None


def _parse(data: bytes, file: str) -> dict[str, Any]:
    try:
        text = data.decode("utf-8-sig")  # Windows editors put a byte-order mark first
    except UnicodeDecodeError as wrong:
        raise SceneError(
            file, "", "", f"is not UTF-8 text (byte {wrong.start})", "Save it as UTF-8"
        ) from None
    try:
        return tomllib.loads(text, parse_float=Decimal)
    except RecursionError:
        raise SceneError(
            file,
            "",
            "",
            "is nested too deeply",
            "A problem file has tables of depth two at the most",
        ) from None
    except ValueError as wrong:  # TOMLDecodeError, and integers of thousands of digits
        raise SceneError(
            file,
            "",
            "",
            f"is not valid TOML: {wrong}",
            'Texts and quantities stand in quotes, as in power = "7.5 kW"',
        ) from None


def _translate(
    file: str, model: type[BaseModel], content: dict[str, Any], wrong: ValidationError
) -> SceneError:
    """The first error, unknown keys before all others (a typo also makes a key missing)."""
    errors = wrong.errors(include_url=False, include_input=False)
    first = next((e for e in errors if e["type"] == "extra_forbidden"), errors[0])
    context: dict[str, Any] = first.get("ctx", {})
    place = (*first["loc"], *context.get("at", ()))
    if first["type"] == "extra_forbidden":
        return _unknown(file, model, content, place)
    value, found = _lookup(content, place)
    key = _path(place)
    if first["type"] == "missing":
        return _error(file, key, None, "is missing", _example(model, place))
    if first["type"] != "gearopt":  # a table where a value should be, or the reverse
        return _error(file, key, value, f"is not right ({first['msg']})", _example(model, place))
    rule, write, action = context["rule"], context["write"], context["action"]
    shown = _short(value) if found else ""
    if action == "remove":
        return SceneError(file, key, shown, rule, "Remove it", Fix("remove", key))
    if action == "swap":
        other = _path((*place[:-1], write))
        return SceneError(
            file, key, shown, rule, f"Exchange {key} and {other}", Fix("swap", key, other)
        )
    return _error(file, key, value, rule, _example(model, place) if write is None else write)


def _unknown(
    file: str, model: type[BaseModel], content: dict[str, Any], place: tuple[Any, ...]
) -> SceneError:
    fields = _table_at(model, place[:-1]).model_fields
    parent, _ = _lookup(content, place[:-1])
    value, _ = _lookup(content, place)
    what = "unknown table" if isinstance(value, dict) else "unknown key"
    free = [f for f in fields if f not in parent]
    if near := get_close_matches(str(place[-1])[:80], free, n=1):
        return SceneError(
            file,
            _path(place),
            "",
            what,
            f"Did you mean {near[0]}?",
            Fix("rename", _path(place), near[0]),
        )
    own = " (tables of your own are named [x-...])" if len(place) == 1 else ""
    return SceneError(
        file,
        _path(place),
        "",
        f"{what}; known here: {', '.join(fields)}",
        f"Remove it{own}",
        Fix("remove", _path(place)),
    )


def _error(file: str, key: str, value: Any, rule: str, write: Any) -> SceneError:
    text = toml_text(write)
    return SceneError(
        file,
        key,
        "" if value is None else _short(value),
        rule,
        f"Write {key.rsplit('.', 1)[-1]} = {text}",
        Fix("set", key, text),
    )


def _short(value: Any) -> str:
    try:
        text = toml_text(value)
    except (RecursionError, TypeError, ValueError):
        text = reprlib.repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def toml_text(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        quoted = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in quoted) + '"'
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_text(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {toml_text(v)}" for k, v in value.items()) + "}"
    return str(value)


def _path(place: tuple[Any, ...]) -> str:
    text = ""
    for part in place:
        text += f"[{part + 1}]" if isinstance(part, int) else (f".{part}" if text else str(part))
    return text


def _lookup(content: Any, place: tuple[Any, ...]) -> tuple[Any, bool]:
    for part in place:
        if isinstance(content, dict) and part in content:
            content = content[part]
        elif isinstance(content, list) and isinstance(part, int) and part < len(content):
            content = content[part]
        else:
            return None, False
    return content, True


def _table_at(model: type[BaseModel], place: tuple[Any, ...]) -> type[BaseModel]:
    """The class of the table at a place."""
    for name in (part for part in place if isinstance(part, str)):
        inner = _table_of(model.model_fields[name].annotation)
        assert inner is not None, name
        model = inner
    return model


def _table_of(annotation: Any) -> type[BaseModel] | None:
    """The table class inside an annotation such as `tuple[Stage, ...] | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((t for a in get_args(annotation) if (t := _table_of(a))), None)


def _example(model: type[BaseModel], place: tuple[Any, ...]) -> Any:
    """A right value for a place: of a key its example, of a table its required keys."""
    names = [part for part in place if isinstance(part, str)]
    info = _table_at(model, tuple(names[:-1])).model_fields[names[-1]]
    reads = next((m for m in info.metadata if isinstance(m, Reads)), None)
    if reads is not None:
        return reads.example
    table = _table_of(info.annotation)
    assert table is not None, names
    required = {n: _example(table, (n,)) for n, f in table.model_fields.items() if f.is_required()}
    return (
        required
        if isinstance(place[-1], int) or get_origin(info.annotation) is not tuple
        else [required]
    )
