"""Mistakes of a file as a SceneError: where, the rule, and what to write instead."""

import re
import tomllib
from collections.abc import Iterator
from decimal import Decimal
from importlib import import_module
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from gearopt.errors import Fix, SceneError
from gearopt.scenes.reading.absent import absent, option, plain
from gearopt.scenes.reading.called import called
from gearopt.scenes.reading.fields import Reads
from gearopt.scenes.reading.near import near
from gearopt.scenes.reading.not_yet import nearest
from gearopt.scenes.reading.toml_writing import cut, dotted, short, toml_text

OTHER_NAME, OTHER_TABLE = "has another name here", "belongs in another table"
RANGE = {"from", "to", "step", "series"}  # keys of a range
LISTED = 20  # keys of a table at most that the message on an unknown one names


def wrong_value(
    file: str, key: str, value: Any, rule: str, write: Any, sample: bool = False
) -> SceneError:
    """Return the error for a key with a wrong value (None: it is missing), with what to write.

    sample: `write` is one right value of many, not what the user meant.
    """
    shown = "" if value is None else short(value)
    fix = Fix("set", key, toml_text(write))
    return SceneError(file, key, shown, rule, _instruction(key, write, sample), fix)


def _instruction(key: str, write: Any, sample: bool) -> str:
    name = key.rsplit(".", 1)[-1]
    if isinstance(write, dict):
        return f"Write a table {_title(key)} with {_pairs(write)}"
    if isinstance(write, list) and write and isinstance(write[0], dict):
        return f"Write tables [[{name}]], such as one with {_pairs(write[0])}"
    return f"Write{', for example,' if sample else ''} {name} = {short(write, 200)}"


def _title(key: str) -> str:
    """The title of the table at a key: `[[stage]]` of stage[1], `[stage.ring]` of stage[1].ring."""
    name = re.sub(r"\[\d+\]", "", key)
    return f"[[{name}]]" if key.endswith("]") else f"[{name}]"


def _pairs(table: dict[str, Any]) -> str:
    return ", ".join(f"{k} = {short(v)}" for k, v in table.items())


def wrong_name(file: str, key: str, name: str) -> SceneError:
    """Return the error for a key whose name is misspelt."""
    return SceneError(
        file, cut(key, 80), "", "unknown key", f"Did you mean {name}?", Fix("rename", key, name)
    )


def translate(
    file: str, kind: str, model: type[BaseModel], content: dict[str, Any], wrong: ValidationError
) -> list[SceneError]:
    """Return all mistakes in the file's order; a key that is missing for a typo is not one."""
    mistakes = []
    for error in wrong.errors(include_url=False, include_input=False):
        place = (*error["loc"], *error.get("ctx", {}).get("at", ()))
        mistakes.append((place, error, _mistake(file, kind, model, content, place, error)))
    renamed = {
        (*place[:-1], mistake.fix.value)
        for place, _, mistake in mistakes
        if mistake.fix is not None and mistake.fix.action == "rename"
    }

    def follows(place: tuple[Any, ...], error: Any) -> bool:
        instead = (*place[:-1], error.get("ctx", {}).get("instead"))
        return instead in renamed or (error["type"] == "missing" and place in renamed)

    real = [m for m in mistakes if not follows(m[0], m[1])]
    return [mistake for *_, mistake in sorted(real, key=lambda m: _order(content, m[0]))]


def _order(content: Any, place: tuple[Any, ...]) -> list[int]:
    """Return where a place stands in a file; what is missing stands at the end of its table."""
    positions: list[int] = []
    for part in place:
        if isinstance(content, dict):
            positions.append(list(content).index(part) if part in content else len(content))
            content = content.get(part)
        elif isinstance(content, list) and isinstance(part, int):
            positions.append(part)
            content = content[part] if part < len(content) else None
    return positions


def _mistake(
    file: str,
    kind: str,
    model: type[BaseModel],
    content: dict[str, Any],
    place: tuple[Any, ...],
    error: Any,
) -> SceneError:
    """Return one error of pydantic as ours."""
    context: dict[str, Any] = error.get("ctx", {})
    if error["type"] == "extra_forbidden":
        return _unknown(file, kind, model, content, place)
    value, present = lookup(content, place)
    key = dotted(place)
    if error["type"] == "missing":
        return wrong_value(file, key, None, "is missing", example_of(model, place), sample=True)
    if error["type"] != "gearopt":
        return _no_table(file, model, content, place)
    if name := _near_name(model, content, place):  # [[stages]] for [[stage]]
        return wrong_name(file, key, name)
    rule, write, action = context["rule"], context["write"], context["action"]
    shown = short(value) if present else ""
    if action == "remove":
        return SceneError(file, key, shown, rule, "Remove it", Fix("remove", key))
    if action == "tell":
        return SceneError(file, key, shown, rule, write)
    if action == "swap":
        other = dotted((*place[:-1], write))
        return SceneError(
            file, key, shown, rule, f"Exchange {key} and {other}", Fix("swap", key, other)
        )
    sample = write is None or action == "sample"
    write = example_of(model, place) if write is None else write
    return wrong_value(file, key, value, rule, write, sample)


def _no_table(
    file: str, model: type[BaseModel], content: dict[str, Any], place: tuple[Any, ...]
) -> SceneError:
    """Return the error for another value where a table, or a list of tables, belongs."""
    name, (value, _) = (
        next(p for p in reversed(place) if isinstance(p, str)),
        lookup(content, place),
    )
    if meant := _near_name(model, content, place):  # planet = 3 for planets = 3
        above, key = _title(dotted(place[:-1])) if place[:-1] else "the file", dotted(place)
        rule = f"{above} has no key {name}, but a table of that name"
        way, fix = f"Write {meant} = {short(value, 200)}", Fix("rename", key, meant)
        return SceneError(file, key, short(value), rule, way, fix)
    many = isinstance(place[-1], str) and _is_many(model, place)
    rule = f"is not a list of tables [[{name}]]" if many else "is not a table"
    write = example_of(model, place)
    if _fits(value, _table_at(model, place)):  # [stage] for [[stage]], or [[duty]] for [duty]
        write = [value] if many else value[0] if len(value) == 1 else write
    try:
        return wrong_value(file, dotted(place), value, rule, write)
    except RecursionError:
        return wrong_value(file, dotted(place), value, rule, example_of(model, place))


def _unknown(
    file: str,
    kind: str,
    model: type[BaseModel],
    content: dict[str, Any],
    place: tuple[Any, ...],
) -> SceneError:
    """Return the error for an unknown key: what it may mean, where it belongs, or what is known."""
    value, _ = lookup(content, place)
    name, key, shown = str(place[-1]), dotted(place), cut(dotted(place), 80)
    above = next((part for part in reversed(place[:-1]) if isinstance(part, str)), "")
    there = called(kind, f"{above}.{name}")
    if there is None and (way := nearest(kind, name)):
        return SceneError(file, shown, short(value), "is not a key here", way)
    if there := there or called(kind, name):
        rule = OTHER_TABLE if there.split(",")[0] == name else OTHER_NAME
        return SceneError(file, shown, short(value), rule, f"Write {there}")
    if given := option(name):
        rule = "is an option of the command, not a key of the file"
        way = f"Remove it and run `gearopt solve FILE {given}`"
        return SceneError(file, shown, short(value), rule, way, Fix("remove", key))
    if lacking := absent(name):
        return SceneError(file, shown, short(value), lacking, "Remove it", Fix("remove", key))
    first = _first(value)
    what = "unknown table" if isinstance(first, dict) and not _is_range(first) else "unknown key"
    meant = _near_name(model, content, place)
    if homes := _homes(model, name, value if meant else None):
        rule = f"{what} here; it belongs {' or '.join(homes)}"
        return SceneError(file, shown, "", rule, "Move it or remove it", Fix("remove", key))
    if meant:
        return SceneError(
            file, shown, "", what, f"Did you mean {meant}?", Fix("rename", key, meant)
        )
    if there := _other_spelling(model, name):
        return SceneError(file, shown, short(value), OTHER_NAME, f"Write {there}")
    taken = _near_name(model, content, place, taken=True)
    if taken is not None:
        rule = f"{what} beside {taken}, which may be meant"
        return SceneError(file, shown, short(value), rule, "Remove it", Fix("remove", key))
    known = list(_table_at(model, place[:-1]).model_fields)
    rule = f"{what}; known here: {', '.join(known[:LISTED])}"
    if len(known) > LISTED:
        rule += f" and {len(known) - LISTED} more (`gearopt schema {kind} --table`)"
    hint = " (tables of your own are named [x-...])" if len(place) == 1 else ""
    return SceneError(file, shown, "", rule, f"Remove it{hint}", Fix("remove", key))


def _homes(model: type[BaseModel], name: str, value: Any = None) -> list[str]:
    """Return the places where a key of this name is known; value: that it takes, None: any."""
    places = [("at the top of the file", model)]
    places += [(f"in {title}", table) for title, table in tables(model)]
    return [
        words
        for words, table in places
        if name in table.model_fields
        and (value is None or _fits(value, table_of(table.model_fields[name].annotation)))
    ]


def _other_spelling(model: type[BaseModel], name: str) -> str | None:
    """Return the key that differs from a name in case and separators alone, and its tables."""
    homes: dict[str, list[str]] = {}
    for title, table in tables(model):
        for key in table.model_fields:
            if plain(key) == plain(name):
                homes.setdefault(key, []).append(title)
    return next((f"{key}, in {' or '.join(titles)}" for key, titles in homes.items()), None)


def tables(model: type[BaseModel], above: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """Yield the title of every table of a file, nested ones after theirs, and its class."""
    for name, info in model.model_fields.items():
        if table := table_of(info.annotation):
            many = get_origin(info.annotation) is tuple
            yield (f"[[{name}]]" if many else f"[{above}{name}]"), table
            yield from tables(table, f"{above}{name}.")


def _near_name(
    model: type[BaseModel], content: dict[str, Any], place: tuple[Any, ...], taken: bool = False
) -> str | None:
    """Return a name close to the last of a place that takes the table or value there.

    taken: whether the name is one that the table has already, or one that it lacks.
    """
    value, present = lookup(content, place)
    parent, _ = lookup(content, place[:-1])
    fields = _table_at(model, place[:-1]).model_fields
    fitting = [f for f in fields if _fits(value, table_of(fields[f].annotation))]
    if not present or isinstance(place[-1], int) or place[-1] in fitting:
        return None
    return near(place[-1], [f for f in fitting if (f in parent) == taken])


def _fits(value: Any, table: type[BaseModel] | None) -> bool:
    """Return whether a value may be meant for this table or list of tables (None: a plain key)."""
    first = _first(value)
    if table is None or not isinstance(first, dict):
        return table is None and (not isinstance(first, dict) or _is_range(first))
    return not first or not table.model_fields.keys().isdisjoint(first)


def _is_range(value: Any) -> bool:
    """Whether a value is a range of a key, such as { from = 0, to = 1 }, and no table."""
    return isinstance(value, dict) and bool(value) and value.keys() <= RANGE


def _first(value: Any) -> Any:
    return value[0] if isinstance(value, list) and value else value


def _is_many(model: type[BaseModel], place: tuple[Any, ...]) -> bool:
    info = _table_at(model, place[:-1]).model_fields[place[-1]]
    return get_origin(info.annotation) is tuple


def lookup(content: Any, place: tuple[Any, ...]) -> tuple[Any, bool]:
    """Value at a place of the content of a file, and whether there is one."""
    for part in place:
        if isinstance(content, dict) and part in content:
            content = content[part]
        elif isinstance(content, list) and isinstance(part, int) and part < len(content):
            content = content[part]
        else:
            return None, False
    return content, True


def _table_at(model: type[BaseModel], place: tuple[Any, ...]) -> type[BaseModel]:
    """Return the class of the table at a place."""
    for name in (part for part in place if isinstance(part, str)):
        inner = table_of(model.model_fields[name].annotation)
        assert inner is not None, name
        model = inner
    return model


def table_of(annotation: Any) -> type[BaseModel] | None:
    """Return the table class inside an annotation such as `tuple[Stage, ...] | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((t for a in get_args(annotation) if (t := table_of(a))), None)


def example_of(model: type[BaseModel], place: tuple[Any, ...]) -> Any:
    """Return a right value for a place: the example of a key, or a table of the example file."""
    names = [part for part in place if isinstance(part, str)]
    info = _table_at(model, tuple(names[:-1])).model_fields[names[-1]]
    reads = next((m for m in info.metadata if isinstance(m, Reads)), None)
    if reads is not None:
        return reads.example
    table = table_of(info.annotation)
    assert table is not None, names
    kind = import_module(".".join(model.__module__.split(".")[:3])).KIND  # of gearopt.scenes.NAME
    texts = [example.text for example in kind.examples.values()]
    at = tuple(0 if isinstance(part, int) else part for part in place)
    each = (lookup(tomllib.loads(text, parse_float=Decimal), at) for text in texts)
    shown, present = next((one for one in each if one[1]), (None, False))
    required = {
        n: example_of(table, (n,)) for n, f in table.model_fields.items() if f.is_required()
    }
    first = next(iter(table.model_fields))
    return shown if present else required or {first: example_of(table, (first,))}
