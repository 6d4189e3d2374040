"""Tables from Python, and changes of a file's tables by the keys that `explain` writes."""

import re
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from numbers import Integral, Real
from os import PathLike, fspath
from typing import Any

from gearopt.errors import SceneError
from gearopt.scenes.reading.allowances import texts_of
from gearopt.scenes.reading.near import near
from gearopt.scenes.reading.toml_writing import cut, dotted, exact
from gearopt.units import parse

Place = tuple[str | int, ...]
_STEP = r"\.([\w-]+)|\[0*([1-9][0-9]{0,5})\]"  # places are counted from 1


def as_written(value: Any) -> Any:
    """Return a value from Python as a file holds it: every float as the decimal that it prints.

    Numbers and arrays of numpy, fractions and paths are taken too; readers judge what is no value.
    """
    if isinstance(value, Mapping):
        return {str(k): as_written(v) for k, v in value.items()}
    if isinstance(value, list | tuple) or bool(getattr(value, "ndim", None)):
        return [as_written(v) for v in value]
    if type(value).__name__ in ("bool", "bool_"):  # numpy's has no part in the tower of numbers
        return bool(value)
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Fraction):
        return exact(value)
    if isinstance(value, Real):
        return Decimal(str(value))
    return fspath(value) if isinstance(value, PathLike) else value


def changed(content: Mapping[str, Any], changes: Mapping[str, Any], file: str) -> dict[str, Any]:
    """Return the tables of a file with other values at some keys; those given are not touched.

    changes: {key: value}, as in "duty.power" or "stage[2].module", counted from 1 in the file as it
    is. A key that the file lacks is added; None removes it. SceneError for what is no key, what
    leads nowhere and what is not there to be removed; values are for the readers of the kind.
    """
    copy: dict[str, Any] = _copy(dict(content))
    places = [(key, _place(key, file), value) for key, value in changes.items()]
    for key, place, value in places:
        if value is not None:
            set_at(copy, place, as_written(value), key, file)
    gone = [(key, place) for key, place, value in places if value is None]
    holders = [(_holder(copy, place, key, file), place[-1]) for key, place in gone]
    for here, step in sorted(holders, key=lambda one: str(one[1]).zfill(6), reverse=True):
        del here[step]
    return copy


def _place(key: Any, file: str) -> Place:
    """Return the place that a key names: ("stage", 1, "module") of `stage[2].module`."""
    text = f".{key}"
    if not isinstance(key, str) or not re.fullmatch(rf"\.[\w-]+({_STEP})*", text):
        rule = "is not a key of a file"
        remedy = "Write table.key, or table[2].key for the second [[table]], counted from 1"
        raise SceneError(file, cut(str(key), 80), "", rule, remedy)
    return tuple(int(index) - 1 if index else name for name, index in re.findall(_STEP, text))


def set_at(content: dict[str, Any], place: Place, value: Any, key: str, file: str) -> None:
    """Put a value at a place; tables that are not there are begun, and lists go on by one."""
    here: Any = content
    for k, step in enumerate(place):
        _check(here, place[: k + 1], key, file)
        last = k + 1 == len(place)
        if isinstance(here, list) and step == len(here):
            here.append({})
        elif not last and isinstance(here, dict) and step not in here:
            here[step] = _new_tables(here, str(step)) if isinstance(place[k + 1], int) else {}
        if last:
            here[step] = value
        elif isinstance(place[k + 1], int) and isinstance(here[step], str):
            here[step] = _two(here[step])
        here = here[step]


def _two(text: str) -> list[Any] | str:
    """Return two allowances in one text as the list of the lower and the upper one."""
    ends = texts_of(text)
    return text if ends is None else sorted(ends, key=lambda end: parse(end, "length").value)


def _new_tables(table: Mapping[str, Any], name: str) -> list[Any]:
    """Return the tables [[name]] that a file leaves out, as many as its key `names` counts."""
    count = table.get(f"{name}s")
    return [{} for _ in range(count)] if isinstance(count, int) and 0 < count < 1000 else []


def _check(here: Any, place: Place, key: str, file: str) -> None:
    """Raise SceneError where the last step of a place cannot be taken."""
    step, above = place[-1], dotted(place[:-1])
    if isinstance(here, dict) and isinstance(step, str):
        return
    if isinstance(here, list) and isinstance(step, int) and step <= len(here):
        return
    if isinstance(here, list):
        rule = f"{above} has {len(here)} {'entry' if len(here) == 1 else 'entries'}"
        rest = "" if isinstance(step, int) or step.isdigit() else f".{step}"
        remedy = f"Write {above}[1]{rest}, ... or {above}[{len(here) + 1}]{rest} for one more"
    else:
        rule = f"{above} is not a {'list' if isinstance(step, int) else 'table'}"
        remedy = f"Change {above} itself"
    raise SceneError(file, cut(key, 80), "", rule, remedy)


def _holder(content: dict[str, Any], place: Place, key: str, file: str) -> Any:
    """Return the table or list that holds what is to be removed; SceneError where nothing is."""
    here: Any = content
    for k, step in enumerate(place):
        _check(here, place[: k + 1], key, file)
        if step == len(here) if isinstance(step, int) else step not in here:
            close = near(str(step), here) if isinstance(here, dict) else None
            meant = close and dotted((*place[:k], close, *place[k + 1 :]))
            remedy = f"Did you mean {meant}?" if meant else "Leave it out of the changes"
            raise SceneError(
                file, cut(key, 80), "", "is not in the file and cannot be removed", remedy
            )
        if k + 1 < len(place):
            here = here[step]
    return here


def _copy(value: Any) -> Any:
    """Return a value whose tables and lists are its own."""
    if isinstance(value, dict):
        return {key: _copy(v) for key, v in value.items()}
    return [_copy(v) for v in value] if isinstance(value, list) else value
