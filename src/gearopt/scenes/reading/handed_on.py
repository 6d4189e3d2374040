"""A file that takes its gears from the answer of another: their tables laid below its own.

What both give must agree; what the file leaves out follows. Its scene counts as set what the file
itself holds, so that its content is read again, and explained, without what follows.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any, cast

from pydantic import BaseModel, ValidationError, ValidationInfo, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from gearopt.frozen import dataclass
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.changes import set_at
from gearopt.scenes.reading.fields import Opened, Reads, Table, refuse
from gearopt.scenes.reading.linked_files import Input
from gearopt.scenes.reading.mistakes import lookup, table_of
from gearopt.scenes.reading.toml_writing import short
from gearopt.units import OFFSETS, Quantity

SAME = 1e-3  # relative, of numbers that are one: digits of a file
STAGE = ("gears", "stage")
Place = tuple[Any, ...]


@dataclass(frozen=True)
class HandedOn:
    """What the design of a file gives to one that takes its gears.

    of: what the gears are, in words. tables: as a file holds them. follows: by place what is known
    of them, as readers return it; None: they have none. own: whether another place is the taking
    file's own. spread: the places that a key of all gears speaks of.
    """

    of: str
    tables: dict[str, Any]
    follows: Mapping[Place, Any]
    own: Callable[[Place], bool]
    spread: Callable[[Place], Iterable[Place]] = lambda place: (place,)


Hand = Callable[[Input, int | None, Ask], HandedOn]


def takes(hand: Hand) -> Any:
    """The validator of scenes that may take their gears from another file; it is the outermost."""

    def taken(cls: type[BaseModel], data: Any, handler: Any, info: ValidationInfo) -> Any:
        return _with_gears(cls, data, handler, info.context, hand)

    outermost: Any = model_validator(mode="wrap")
    return outermost(classmethod(taken))


def _with_gears(
    model: type[BaseModel], data: Any, handler: Callable[[Any], Any], context: Any, hand: Hand
) -> Any:
    """Read the tables of a file with the gears that it takes from another, if it takes any."""
    gears = data.get("gears") if isinstance(data, dict) else None
    if not isinstance(gears, dict) or gears.keys().isdisjoint(("from", "stage")):
        return handler(data)
    table = table_of(model.model_fields["gears"].annotation)
    assert table is not None
    unknown = [(("gears", key), "extra_forbidden") for key in gears.keys() - table.model_fields]
    if "from" not in gears:
        rule = "is that of another file's gears, and no key `from` names one"
        refused = refuse(rule, at=STAGE, action="remove", instead="from")
        raise _together(model, [((), refused), *unknown])
    ask = context.ask if isinstance(context, Opened) and context.ask else Ask()
    named, number = (_read(table, key, gears.get(key), context) for key in ("from", "stage"))
    if misread := [(("gears", key), why) for key, why in (*named[1], *number[1])]:
        raise _together(model, misread)
    source = named[0].answered(ask)
    try:
        handed = hand(source, number[0], ask)
    except PydanticCustomError as refused:
        raise _together(model, [((), refused), *unknown]) from None
    mine = [*_leaves(model, data, ())]
    if others := [*_contradictions(model, mine, handed)]:
        raise _together(model, others)
    tables = _laid(handed, mine)
    tables["gears"] = tables.get("gears", {}) | {"from": source}
    try:
        scene = handler(tables)
    except ValidationError as wrong:
        raise _of_handed(model, wrong, handed, tables, data) from None
    for name in type(scene).model_fields:
        _only(getattr(scene, name), data.get(name))
    return scene


def _read(
    table: type[BaseModel], key: str, value: Any, context: Any = None
) -> tuple[Any, list[tuple[str, PydanticCustomError]]]:
    """Value of a key through its reader, None of none; and its mistake with its key, if any."""
    reads = next((m for m in table.model_fields[key].metadata if isinstance(m, Reads)), None)
    if reads is None:  # a table
        return value, []
    more = (context,) if reads.opens else ()
    try:
        return (None if value is None else reads.reader(value, reads.example, *more)), []
    except PydanticCustomError as wrong:
        return None, [(key, wrong)]


def _together(
    model: type[BaseModel], errors: Iterable[tuple[Place, PydanticCustomError | str]]
) -> ValidationError:
    """One error of several, each at its place."""
    rows = [InitErrorDetails(type=why, loc=place, input=None) for place, why in errors]
    return ValidationError.from_exception_data(model.__name__, rows)


def _leaves(model: type[BaseModel], data: Any, place: Place) -> Iterator[tuple[Any, Place, Any]]:
    """Yield every key of the tables of a file: the class of its table, its place, its value."""
    for key, value in data.items():
        info = model.model_fields.get(key)
        table = table_of(info.annotation) if info else None
        inside = [((*place, key), value)]
        if table and isinstance(value, list) and all(isinstance(item, dict) for item in value):
            inside = [((*place, key, k), item) for k, item in enumerate(value)]
        for at, item in inside:
            if table and isinstance(item, dict) and item:
                yield from _leaves(table, item, at)
            else:
                yield model, at, item


def _contradictions(
    model: type[BaseModel], mine: Iterable[tuple[Any, Place, Any]], handed: HandedOn
) -> Iterator[tuple[Place, PydanticCustomError]]:
    """Yield what a file says otherwise than the design whose gears it takes."""
    for table, place, value in mine:
        name = place[-1]
        if place[:-1] == ("gears",) and name in ("from", "stage"):
            continue
        known = [at for at in handed.spread(place) if at in handed.follows]
        if not known and (handed.own(place) or value == {} or name not in table.model_fields):
            continue
        opens = isinstance(next((handed.follows[at] for at in known), None), Input)
        said, wrong = (value, []) if opens or not known else _read(table, name, value)
        if wrong:
            yield place, wrong[0][1]
            continue
        apart = next((at for at in known if not same(said, handed.follows[at])), None)
        if apart is None and known:
            continue
        held = None if apart is None else handed.follows[apart]
        there = "it is not given there" if held is None else f"it is {text_of(held, said)} there"
        rule = f"contradicts {handed.of}, whose gears this file takes: {there}"
        yield place, refuse(rule, action="remove")


def same(said: Any, known: Any) -> bool:
    """Whether two values of a key are one: numbers up to digits, words and counts exactly."""
    if isinstance(said, tuple) and isinstance(known, tuple):
        return len(said) == len(known) and all(map(same, said, known))
    if isinstance(said, tuple) and said and said[0] == said[-1]:
        return same(said[0], known)
    if isinstance(known, Input):
        return bool(said == known or said == known.file)
    if isinstance(said, bool | int | str) or isinstance(known, bool | str | None):
        return bool(said == known)
    try:
        ends = [float(getattr(value, "value", value)) for value in (said, known)]
    except (TypeError, ValueError):
        return bool(said == known)
    return math.isclose(*ends, rel_tol=SAME, abs_tol=1e-12)


def text_of(value: Any, like: Any) -> str:
    """A value as a message has it; of a quantity in the unit of another one."""
    if isinstance(value, Quantity):
        if not isinstance(like, Quantity) or like.unit in OFFSETS or like.reciprocal:
            return str(value)
        return f"{value.value / replace(like, number=Fraction(1)).value:.6g} {like.unit}"
    if isinstance(value, tuple):
        return ", ".join(dict.fromkeys(text_of(part, like) for part in value))
    if isinstance(value, str | bool | int | Input):
        return short(value.file if isinstance(value, Input) else value)
    return f"{float(value):.6g}"


def _laid(handed: HandedOn, mine: Iterable[tuple[Any, Place, Any]]) -> dict[str, Any]:
    """The tables handed on, with what the file has beside them."""
    for _, place, value in mine:
        known = any(at in handed.follows for at in handed.spread(place))
        if not known and not (value == {} and lookup(handed.tables, place)[1]):
            set_at(handed.tables, place, value, str(place[-1]), "")
    return handed.tables


def _of_handed(
    model: type[BaseModel], wrong: ValidationError, handed: HandedOn, tables: Any, data: Any
) -> ValidationError:
    """The mistakes of a file, in which those of the tables handed on name the design they are of.

    They are told at the key that names the gears: the file has none of theirs.
    """
    rows = []
    at = STAGE if lookup(data, STAGE)[1] else ("gears", "from")
    for error in wrong.errors(include_url=False):
        context, loc = error.get("ctx", {}), error["loc"]
        place, reason = (*loc, *context.get("at", ())), cast(Any, error["type"])
        if reason == "gearopt":
            reason = refuse(
                *(context[name] for name in ("rule", "write", "at", "action", "instead"))
            )
            if lookup(tables, place)[1] and not lookup(data, place)[1]:
                key = ".".join(step for step in place if isinstance(step, str))
                rule = f"takes {handed.of}, whose {key} {context['rule']}"
                write = "Change the file that it is taken from, or take other gears"
                reason, loc = refuse(rule, write, action="tell"), at
        rows.append(InitErrorDetails(type=reason, loc=loc, input=error["input"], ctx=context))
    return ValidationError.from_exception_data(model.__name__, rows)


def _only(held: Any, data: Any) -> None:
    """Let tables count as set what the file itself has in them; what follows is stated, too."""
    if isinstance(held, tuple):
        each = data if isinstance(data, list) else []
        for k, row in enumerate(held):
            _only(row, each[k] if k < len(each) else None)
    if isinstance(held, BaseModel):
        content = data if isinstance(data, dict) else {}
        for name in type(held).model_fields:
            _only(getattr(held, name), content.get(name))
        if isinstance(held, Table):
            held._followed = frozenset(held.model_fields_set)
        object.__setattr__(held, "__pydantic_fields_set__", {*content} & {*type(held).model_fields})


def every(table: BaseModel, place: Place) -> Iterator[tuple[Place, Any]]:
    """Yield place and value of every key of a table, and of those inside it."""
    for name in type(table).model_fields:
        held = getattr(table, name)
        if isinstance(held, BaseModel):
            yield from every(held, (*place, name))
        else:
            yield (*place, name), held
