"""From a TOML file to a scene: read, find its kind, check, and name all mistakes at once."""

import hashlib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import field, replace
from decimal import Decimal, InvalidOperation
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from traceback import extract_tb
from types import NoneType
from typing import Any, get_origin

from pydantic import BaseModel, ValidationError

import gearopt.scenes
from gearopt.errors import Fix, SceneError, SolveError, together
from gearopt.frozen import dataclass
from gearopt.scenes.kind import Kind
from gearopt.scenes.reading.absent import absent_kind
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.called import kind_called
from gearopt.scenes.reading.changes import as_written, changed
from gearopt.scenes.reading.fields import Opened
from gearopt.scenes.reading.file_bytes import LARGEST_FILE, first_bytes
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.mistakes import translate, wrong_name, wrong_value
from gearopt.scenes.reading.near import near
from gearopt.scenes.reading.toml_writing import cut, dotted, short
from gearopt.units import SYSTEMS

FORMAT = 1
HEAD = ("gearopt", "kind", "units")  # keys of every file
FORMATS = {  # beginnings of files of other formats
    r"\s*<(\?xml[\s\S]*?>\s*(<!--[\s\S]*?-->\s*)*<)?model\b": "a REXS model (XML)",
    r"\s*<": "XML or HTML",
    r"\s*\{": "JSON",
}
LIBRARIES = ("site-packages", "importlib", "<")  # in names of files
NOT_TOML = "Write the gears into a file in TOML: `gearopt new drive` prints one to start from"
OF_REXS = "Make one of it: `gearopt import FILE > drive.toml`"
TABLES = "<tables>"  # from Python, in messages
DEEPEST_KEY = r"(?:[\w-]\s*\.\s*){6000}"  # tomllib's time grows with the square: 1 s at 5000


@dataclass(frozen=True)
class Loaded:
    """A scene with its tables as they were read, and where they came from.

    file, sha256: of the bytes of its file, None of tables from Python. changes: what was changed in
    its tables, by key.
    """

    scene: BaseModel
    kind: str
    asked: dict[str, Any]
    file: str | None = None
    sha256: str | None = None
    changes: dict[str, Any] = field(default_factory=dict)


def kind_named(name: str) -> Kind[Any]:
    """Return a kind of problem file; SolveError names one that cannot be imported."""
    try:
        kind: Kind[Any] = import_module(f"{gearopt.scenes.__name__}.{name}").KIND
    except (ImportError, SyntaxError, NameError, AttributeError, TypeError) as reason:
        there = _place_of(reason)
        raise SolveError(f"kind {name!r} cannot be imported: {reason}{there}") from reason
    return kind


def _place_of(reason: BaseException) -> str:
    """Return the file and line of an error within gearopt or a kind, not in what these import."""
    frames = extract_tb(reason.__traceback__)[1:]
    inside = [f for f in frames if not any(word in f.filename for word in LIBRARIES)]
    return f" ({Path(inside[-1].filename).name}, line {inside[-1].lineno})" if inside else ""


def examples() -> dict[str, str]:
    """Return problem files to start from: one of each kind, and others that kinds have by name."""
    listed = [kind_named(name).examples for name in kinds()]
    first_of_kinds = [dict([next(iter(of_kind.items()))]) for of_kind in listed]
    return {
        name: each.text for of_kind in (*first_of_kinds, *listed) for name, each in of_kind.items()
    }


def kind_of(scene: BaseModel) -> str:
    """Return the kind of a scene, by the room that its class stands in."""
    return type(scene).__module__.removeprefix(f"{gearopt.scenes.__name__}.").split(".")[0]


def _likely(content: dict[str, Any], called: str | None) -> str:
    """Return the kind that knows most of a file's tables; one that is not importable, none.

    called: the kind that it is called, which counts where several know as many.
    """

    def known(kind: str) -> tuple[int, bool]:
        try:
            tables = kind_named(kind).scene.model_fields.keys()
        except SolveError:
            return -1, False
        return len(content.keys() & tables), kind == called

    return max(kinds(), key=known)


def load(
    what: str | Path | Mapping[str, Any],
    changes: Mapping[str, Any] | None = None,
    ask: Ask | None = None,
) -> Loaded:
    """Read a problem file, or its tables; SceneError says where it is wrong and what to write.

    changes: other values by key, see `changes.changed`. ask: as of `Opened`.
    """
    changes = changes or {}
    if isinstance(what, Mapping):
        file = digest = None
        name, folder = TABLES, Path(TABLES)
        content = _from_python(what, name)
    else:
        file = name = str(what)
        data = _bytes(what)
        digest, folder = hashlib.sha256(data).hexdigest(), Path(what)
        content = _parse(data, file)
    name += " (changed)" if changes else ""
    try:
        content = changed(content, changes, name) if changes else content
        asked, edits = _tables_read(content), bare(as_written(changes))
    except RecursionError:
        raise _too_deep(name) from None
    kind, scene = _scene(content, name, Opened((folder.resolve(),), ask))
    return Loaded(scene, kind, asked, file, digest, edits)


def units_of(file: Path) -> str:
    """System of units that a problem file asks for; metric where it cannot be read so far."""
    try:
        asked = _parse(_bytes(file), str(file)).get("units")
    except SceneError:  # told once the file is read as a whole
        return SYSTEMS[0]
    return asked if asked in SYSTEMS else SYSTEMS[0]


def _bytes(path: str | Path) -> bytes:
    """Bytes of a file, one beyond the limit at most; SceneError says why not."""
    file = str(path)
    try:
        return first_bytes(path, LARGEST_FILE)
    except IsADirectoryError:
        raise SceneError(file, "", "", "is a directory, not a file", _name_a_file(path)) from None
    except FileNotFoundError:
        raise SceneError(file, "", "", "there is no such file", _name_a_file(path)) from None
    except (OSError, ValueError) as reason:
        text = getattr(reason, "strerror", None) or str(reason)
        remedy = "Check the name and the permissions"
        raise SceneError(file, "", "", f"cannot be read ({text})", remedy) from None


def _from_python(tables: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return tables as the text of a file would have given them."""
    try:
        return dict(as_written(tables))
    except RecursionError:
        raise _too_deep(name) from None


def _tables_read(content: dict[str, Any]) -> dict[str, Any]:
    """Tables of a file, as JSON holds them, without the user's own."""
    return {k: bare(v) for k, v in content.items() if not k.startswith("x-")}


def bare(value: Any) -> Any:
    """Return a value of a file as JSON holds it; a file that is an input by its name."""
    if isinstance(value, dict):
        return {key: bare(v) for key, v in value.items()}
    if isinstance(value, list):
        return [bare(v) for v in value]
    if isinstance(value, Decimal):
        return float(value)
    return value if isinstance(value, str | int | NoneType) else str(value)


def _name_a_file(path: str | Path) -> str:
    """Return a remedy for a path where no file is: a file within or beside it, if there is one."""
    folder = Path(path) if Path(path).is_dir() else Path(path).parent
    try:
        names = sorted(p.name for p in folder.glob("*.toml") if p.is_file())
    except OSError:
        names = []
    close = names[:1] if folder == Path(path) else get_close_matches(Path(path).name, names, n=1)
    suggestion = f"Did you mean {folder / close[0]}? " if close else ""
    return f"{suggestion}`gearopt new drive` prints a file to start from"


def read(
    data: bytes | Mapping[str, Any], file: str = "<text>", by: Opened | None = None
) -> tuple[str, BaseModel]:
    """Return the kind and scene of a problem file; SceneError names all mistakes.

    data: its bytes, or its tables. file: its name in messages. by: the files by way of which this
    one was named as an input. What depends on several tables is checked once each is right.
    """
    by = by or Opened(())
    content = _parse(data, file) if isinstance(data, bytes) else _from_python(data, file)
    return _scene(content, file, replace(by, files=(*by.files, Path(file).resolve())))


def _scene(content: dict[str, Any], file: str, opened: Opened) -> tuple[str, BaseModel]:
    """Return the kind and scene of the tables of a file; opened: the files being read."""
    if not content:
        remedy = "Start from what `gearopt new drive` prints"
        raise SceneError(file, "", "", "is empty", remedy, Fix("replace", "", "new drive"))
    kind, errors = _head(content, file)
    content = {k: v for k, v in content.items() if not k.startswith("x-")}  # the user's tables
    if kind:
        model: type[BaseModel] = kind_named(kind).scene
        try:
            scene = model.model_validate(content, context=opened)
        except ValidationError as wrong:
            errors += translate(file, kind, model, content, wrong)
    if errors:
        raise together(errors) from None
    return kind, scene


def _head(content: dict[str, Any], file: str) -> tuple[str, list[SceneError]]:
    """Take the keys of every file; return the kind to read it as ("": none), and mistakes."""
    errors: list[SceneError] = []
    version = _pop(content, "gearopt", file, errors)
    if not errors and (version != FORMAT or isinstance(version, bool)):
        rule = "is missing" if version is None else f"is not the format version {FORMAT}"
        errors.append(wrong_value(file, "gearopt", version, rule, FORMAT))
    system = _pop(content, "units", file, errors)
    if system is not None and system not in SYSTEMS:
        known = " or ".join(f'"{name}"' for name in SYSTEMS)
        close = (near(system, SYSTEMS) if isinstance(system, str) else None) or SYSTEMS[0]
        errors.append(wrong_value(file, "units", system, f"is not {known}", close))
    kind = _pop(content, "kind", file, errors)
    if isinstance(kind, str) and kind in kinds():
        return kind, errors
    name = kind if isinstance(kind, str) else ""
    meant = near(name, kinds())
    if not meant and (lacking := absent_kind(name)):
        errors.append(SceneError(file, "kind", short(name), lacking, _kinds_in_words()))
        return "", errors
    likely = meant or _likely(content, kind_called(name))
    known = f"is not a known kind (known: {', '.join(kinds())})"
    rule = "is missing" if kind is None else known
    sure = meant or not content.keys().isdisjoint(kind_named(likely).scene.model_fields)
    guessed = not sure and kind_called(name) is None
    wrong = wrong_value(file, "kind", kind, rule, likely, sample=guessed)
    shown = [e for e in kind_named(likely).examples if e != likely and e in name.lower()]
    if shown:
        remedy = f"{wrong.remedy}; gearopt new {shown[0]} prints a file to start from"
        wrong = SceneError(file, "kind", short(name), rule, remedy)
    errors.append(wrong)
    return likely if sure else "", errors


def _kinds_in_words() -> str:
    """Return the kinds of problem file with a few words on each."""
    abouts = {kind: next(iter(kind_named(kind).examples.values())).about for kind in kinds()}
    return f"The kinds are {', '.join(f'{kind} ({words})' for kind, words in abouts.items())}"


def _too_deep(file: str) -> SceneError:
    remedy = "A problem file has tables of at most two levels"
    return SceneError(file, "", "", "is nested too deeply", remedy)


def _pop(content: dict[str, Any], name: str, file: str, errors: list[SceneError]) -> Any:
    """Return the value of a key of every file, None where it is missing; note a misspelt one."""
    values = [key for key, value in content.items() if not isinstance(value, dict | list)]
    if name not in content and (written := near(name, values)):
        errors.append(wrong_name(file, dotted((written,)), name))
        name = written
    return content.pop(name, None)


def _parse(data: bytes, file: str) -> dict[str, Any]:
    if len(data) > LARGEST_FILE:
        rule = f"is larger than a problem file, which has at most {LARGEST_FILE:,} bytes"
        raise SceneError(file, "", "", rule, _name_a_file(file))
    try:
        text = data.decode("utf-8-sig")  # Windows editors put a byte-order mark first
    except UnicodeDecodeError as wrong:
        line = data.count(b"\n", 0, wrong.start) + 1
        rule = f"is not UTF-8 text (byte {wrong.start + 1}, in line {line})"
        raise SceneError(file, "", "", rule, "Save it with the encoding UTF-8") from None
    if "\0" in text:
        rule = "has a NUL byte, as UTF-16 text and binary files have"
        raise SceneError(file, "", "", rule, "Save it with the encoding UTF-8")
    if form := next(
        (name for begin, name in FORMATS.items() if re.match(begin, text[:2000])), None
    ):
        remedy = OF_REXS if "REXS" in form else NOT_TOML
        raise SceneError(file, "", "", f"is {form}, not a problem file", remedy)
    if re.search(DEEPEST_KEY, text):
        raise _too_deep(file)
    try:
        return tomllib.loads(text, parse_float=_decimal)
    except RecursionError:
        raise _too_deep(file) from None
    except tomllib.TOMLDecodeError as wrong:
        rule, remedy = _syntax(str(wrong))
        remedy = _several(text, str(wrong)) or _comma(text, str(wrong)) or remedy
        raise SceneError(file, "", "", rule, remedy) from None
    except ValueError:  # the limit of Python itself; no position is known
        rule = "has a whole number of thousands of digits"
        raise SceneError(file, "", "", rule, "Write a number of sensible size") from None


def _decimal(text: str) -> Decimal:
    """Return a float exactly as written; infinite where Decimal refuses its exponent."""
    try:
        return Decimal(text)
    except InvalidOperation:
        return Decimal("inf")


def _several(text: str, message: str) -> str:
    """Return the remedy where the line of the message has [name], as other tables have too."""
    at = re.search(r"\(at line (\d+)", message)
    lines = text.splitlines()
    if at is None or not (header := re.match(r"\s*\[([\w-]+)\]", lines[int(at[1]) - 1])):
        return ""
    name = header[1]
    if len(re.findall(rf"(?m)^\s*\[+{re.escape(name)}\]", text)) < 2:
        return ""
    double = any(
        get_origin(kind_named(kind).scene.model_fields[name].annotation) is tuple
        for kind in kinds()
        if name in kind_named(kind).scene.model_fields
    )
    return f"Each of several tables [[{name}]] has double brackets" if double else ""


def _comma(text: str, message: str) -> str:
    """Return the remedy where the line of the message has a number with a decimal comma."""
    at = re.search(r"\(at line (\d+)", message)
    line = text.splitlines()[int(at[1]) - 1] if at else ""
    assignment = re.match(r"\s*[\w.-]+\s*=\s*([+-]?[0-9]+),([0-9]+)", line)
    return f"The decimal sign is a point: {assignment[1]}.{assignment[2]}" if assignment else ""


_SYNTAX = {  # part of the parser's message -> remedy
    r"overwrite|twice|[Dd]uplicate|redefine|mutate": "Every key and table stands once; remove one",
    r"Unterminated|Unclosed|Expected ']|Illegal character '\\n'": "Close the quote or bracket",
    r"[Ii]llegal character|invalid character": "Remove that character or write it as \\uXXXX",
    r"Unescaped|hex value|Escaped": "In a quoted text a backslash is written twice",
}
_TUPLE = re.compile(r"\('(.*?)',?\)")  # the name of a table, as the parser's messages print it
_QUOTES = 'Texts and quantities stand in quotes, as in power = "7.5 kW"'


def _syntax(message: str) -> tuple[str, str]:
    """Return rule and remedy for a TOML message: `Invalid value (at line 6, column 8)`."""
    what, at, where = message.rpartition(" (at ")
    what = _TUPLE.sub(lambda found: "[" + found[1].replace("', '", ".") + "]", what)
    remedy = next((r for pattern, r in _SYNTAX.items() if re.search(pattern, what)), _QUOTES)
    return f"is not valid TOML: {cut(what, 150)}{at}{where}", remedy
