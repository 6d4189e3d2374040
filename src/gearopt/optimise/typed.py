"""Dataclasses from plain JSON data and back, each value held to the type its field declares."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache, partial
from types import NoneType, UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from gearopt.frozen import dataclass

SINGLE = frozenset((float, int, str, bool, NoneType))  # classes of plain values
INLINE = {"inline": True}  # metadata of a mapping whose keys stand among those of its dataclass
T = TypeVar("T")
NUMBERS: dict[Any, tuple[type, ...]] = {
    float: (int, float),
    int: (int,),
    str: (str,),
    bool: (bool,),
}


@dataclass(frozen=True)
class Shown:
    """How tables show a field of a design: `Annotated[float, Shown("module", "sizes")]`.

    label: what it is called. table: the one that lists it, where its class has several. unit: as
    `report.measures` names it; None: that at the end of the field's name. form: a format of the
    number, as ".3f"; "": the digits that are read; "share": per cent of a whole, with a bar; "4": a
    length with so many decimals at most.
    """

    label: str
    table: str = ""
    unit: str | None = None
    form: str = ""


def typed(kind: Any, data: Any, where: str = "") -> Any:
    """Return a value of a type from plain data; ValueError names the place that differs.

    kind: a dataclass, a tuple, a mapping, a plain type, any of them or None.
    """
    return _reader(kind)(data, where)


def held(kind: type[T], data: Mapping[str, Any], name: str) -> T | None:
    """The part of a name that plain data hold, as a value of a type; None without it."""
    part: T | None = typed(kind, data[name], name) if data.get(name) else None
    return part


@cache
def _reader(kind: Any) -> Callable[[Any, str], Any]:
    """Value of a type from plain data and the name of its place: what `typed` asks."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return lambda data, where: data
    if origin is UnionType:
        some = _reader(next(k for k in inner if k is not NoneType))
        may_lack = NoneType in inner
        return lambda data, where: None if data is None and may_lack else some(data, where)
    if is_dataclass(kind):
        return partial(_filled, kind)
    if origin is tuple:
        return partial(_several if inner[-1] is Ellipsis else _each, inner)
    if origin is not None and issubclass(origin, Mapping):
        of_value = _reader(inner[1])
        return lambda data, where: {
            k: of_value(v, f"{where}.{k}") for k, v in _mapping(data, where).items()
        }
    return partial(_plain, kind)


def _plain(kind: type, data: Any, where: str) -> Any:
    """A number, a truth or a word."""
    if not isinstance(data, NUMBERS[kind]) or (isinstance(data, bool) and kind is not bool):
        raise ValueError(f"has a value in {where} that is not a {kind.__name__}")
    return data


def _several(inner: tuple[Any, ...], data: Any, where: str) -> tuple[Any, ...]:
    """Any number of values of one type."""
    held = _list(data, where)
    if set(map(type, held)) <= set(NUMBERS.get(inner[0], ())):
        return tuple(held)
    of_value = _reader(inner[0])
    return tuple(of_value(v, f"{where}[{n + 1}]") for n, v in enumerate(held))


def _each(inner: tuple[Any, ...], data: Any, where: str) -> tuple[Any, ...]:
    """Values of a type each."""
    held = _list(data, where)
    if len(inner) != len(held):
        raise ValueError(f"holds {len(held)} values in {where}, not {len(inner)}")
    return tuple(_reader(inner[n])(v, f"{where}[{n + 1}]") for n, v in enumerate(held))


def untyped(value: Any) -> Any:
    """Return plain data of dataclasses, for `typed`, without fields that hold their default."""
    if value.__class__ in SINGLE:
        return value
    if is_dataclass(value) and not isinstance(value, type):
        data: dict[str, Any] = {}
        for name, default, inline in _written(value.__class__):
            if (held := getattr(value, name)) != default:
                data |= untyped(held) if inline else {name: untyped(held)}
        return data
    if isinstance(value, Mapping):
        return {k: untyped(v) for k, v in value.items()}
    return [untyped(v) for v in value] if isinstance(value, list | tuple) else value


def _filled(kind: Any, data: Any, where: str) -> Any:
    """A dataclass with all its fields and no other."""
    (readers, needed, inlined), held = _declared(kind), _mapping(data, where)
    for inline in inlined:
        others = {k: v for k, v in held.items() if k not in readers}
        held = {k: v for k, v in held.items() if k in readers} | {inline: others}
    if not held.keys() <= readers.keys():
        unknown = ", ".join(sorted(set(held) - set(readers)))
        raise ValueError(f"has unknown keys in {where or 'it'}: {unknown}")
    if not needed <= held.keys():
        missing = ", ".join(sorted(needed - set(held)))
        raise ValueError(f"lacks keys in {where or 'it'}: {missing}")
    head = f"{where}." if where else ""
    return kind(**{k: readers[k](v, f"{head}{k}") for k, v in held.items()})


@cache
def _written(kind: type) -> tuple[tuple[str, Any, bool], ...]:
    """Names of a dataclass's fields, their defaults, and which are inline."""
    return tuple((f.name, f.default, bool(f.metadata)) for f in fields(kind))


@cache
def _declared(
    kind: Any,
) -> tuple[Mapping[str, Callable[[Any, str], Any]], frozenset[str], tuple[str, ...]]:
    """Readers of a dataclass's fields; fields without a default; those with metadata."""
    needed = frozenset(f.name for f in fields(kind) if f.default is f.default_factory is MISSING)
    readers = {name: _reader(hint) for name, hint in get_type_hints(kind).items()}
    return readers, needed, tuple(f.name for f in fields(kind) if f.metadata)


def _mapping(data: Any, where: str) -> Mapping[str, Any]:
    if not isinstance(data, Mapping):
        raise ValueError(f"has a value in {where or 'it'} that is not a dict of keys")
    return data


def _list(data: Any, where: str) -> list[Any] | tuple[Any, ...]:
    if not isinstance(data, list | tuple):
        raise ValueError(f"has a value in {where} that is not a list")
    return data
