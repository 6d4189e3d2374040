"""A REXS file as the text of a problem file: a drive whose gears are given."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gearopt.errors import SceneError
from gearopt.scenes.drive.rexs.files import read_model
from gearopt.scenes.drive.rexs.model import Model, Said
from gearopt.scenes.drive.rexs.tables import tables_of
from gearopt.scenes.reading.load import FORMAT, read
from gearopt.scenes.reading.toml_writing import cut, dotted, toml_tables

NOTHING = "# needed, and the REXS file does not say it"
RULES = 60  # characters of a name
LONGEST = 1000  # of a place, and of what is wrong there
VECTORS = ("u_axis_vector", "w_axis_vector", "reference_component_for_position")
WIDTH = 99  # characters of a line


def read_rexs(path: str | Path) -> str:
    """Text of a problem file of kind "drive" with the gears of a REXS file, to be rated.

    Versions 1.0 to 2.0.0, as XML, JSON or zip. Comments at its top list what has no place in a
    problem file, and what is needed besides stands in comments where it belongs. SceneError names
    component and attribute of what is wrong.
    """
    remarks: list[str] = []
    try:
        model = read_model(path)
        tables = tables_of(model, remarks)
        head = {"gearopt": FORMAT, "kind": "drive", **_titles(model, path)}
        _check(head | tables)
    except SceneError as error:
        key, rule = (cut(_line(text), LONGEST) for text in (error.key, error.rule))
        raise SceneError(str(path), key, error.value, rule, error.remedy) from None
    comments = [*remarks, *_unplaced(model)]
    if comments:
        about = f"{Path(path).name}, REXS {model.version}: what has no place here, or is changed"
        comments.insert(0, about)
    lines = [_comment(line) for line in comments]
    return "\n".join((*lines, "" * bool(lines), toml_tables(head | tables, _written)))


def _comment(line: str) -> str:
    """A line as a comment of several lines, without what no comment may hold."""
    return textwrap.fill(_line(line), WIDTH, initial_indent="# ", subsequent_indent="#   ")


def _line(text: str) -> str:
    """A text in one line, without characters that no line may hold."""
    return "".join(c if c.isprintable() else " " for c in text)


def _titles(model: Model, path: str | Path) -> dict[str, str]:
    units = model.of_type("gear_unit")
    title = units[0].word("model_name") or units[0].name if units else ""
    source = f"REXS {model.version}" + f" of {model.source}" * bool(model.source)
    names = {"title": cut(title or Path(path).stem, RULES), "source": source}
    return {key: " ".join(_line(value).split()) for key, value in names.items()}


def _written(value: Any) -> tuple[Any, str]:
    """A value of a table, and the comment instead of which it stands: "" for none."""
    if isinstance(value, Said):
        return value.value, NOTHING if value.needed else ""
    return value, ""


def _check(tables: dict[str, Any]) -> None:
    """Refuse what no problem file may say, at its place in the REXS file."""
    origins: dict[str, str] = {}
    try:
        read(_plain(tables, (), origins))
    except SceneError as error:
        place = error.key
        while place and place not in origins:
            place = place.rpartition(".")[0]
        origin = origins.get(place, "")
        key = f"{origin} ({error.key})" if origin else error.key
        raise SceneError(error.file, key, error.value, error.rule, error.remedy) from None


def _plain(value: Any, path: tuple[Any, ...], origins: dict[str, str]) -> Any:
    """Tables without the places of the REXS file that say their keys, which are noted."""
    if isinstance(value, Said):
        origins[dotted(path)] = value.origin
        value = value.value
    if isinstance(value, dict):
        return {k: _plain(v, (*path, k), origins) for k, v in value.items()}
    if isinstance(value, list):
        return [_plain(v, (*path, k), origins) for k, v in enumerate(value)]
    return value


def _unplaced(model: Model) -> Iterator[str]:
    """A line for every sort of component with attributes that were not asked for."""
    left: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for c in [c for part in (model.components, *model.cases) for c in part.values()]:
        if rest := tuple(n for n in c.attributes if n not in c.used and n not in VECTORS):
            numbers = left.setdefault((f"{'load cases, ' * bool(c.place)}{c.type}", rest), [])
            if str(c.id) not in numbers:
                numbers.append(str(c.id))
    for (kind, names), numbers in left.items():
        yield f"{kind} {', '.join(numbers)}: {', '.join(names)}"
