"""Dataclasses, of which the frozen ones load in a quarter of the time.

The library compiles seven functions for a frozen class, which takes 0.6 ms; a command loads some
120 classes before its first word. Here one is compiled for each, `__init__`; comparing, hashing,
printing and refusing changes are functions that all classes share. What is a field, its default and
its order is the library's word, and so is all of a class that is mutable, ordered or compares in
its own way.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, fields
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

FACTORY = type("Factory", (), {"__repr__": lambda self: "<factory>"})()  # as default in a signature
OWN = {"__eq__", "__hash__", "__init__", "__setattr__", "__delattr__"}  # methods of another meaning

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, frozen=False, **options):
        """`dataclasses.dataclass`; InitVar is not for frozen classes."""
        if cls is None:
            return lambda cls: dataclass(cls, frozen=frozen, **options)
        if not frozen or options.keys() - {"kw_only"} or OWN & cls.__dict__.keys():
            return dataclasses.dataclass(cls, frozen=frozen, **options)
        printed = "__repr__" in cls.__dict__
        dataclasses.dataclass(cls, init=False, repr=False, eq=False, **options)
        cls.__init__ = _init(cls)
        cls.__setattr__, cls.__delattr__ = _no_change, _no_removal
        cls.__eq__, cls.__hash__ = _equal, _hash
        cls.__values_compared__ = staticmethod(_values([f.name for f in fields(cls) if f.compare]))
        hashed = [f.name for f in fields(cls) if (f.compare if f.hash is None else f.hash)]
        cls.__values_hashed__ = staticmethod(_values(hashed))
        if not printed:
            cls.__repr__ = _printed
        return cls


def _init(cls: type) -> Callable[..., None]:
    """`__init__` of a class with the fields of the library."""
    parameters: dict[bool, list[str]] = {False: ["self"], True: []}  # by whether given by name
    lines = ["pass"]
    known: dict[str, Any] = {"put": object.__setattr__, "FACTORY": FACTORY}
    for each in fields(cls):
        name = each.name
        fresh = each.default_factory is not MISSING
        if fresh:
            known[f"fresh_{name}"] = each.default_factory
        if each.init:
            given, default = name, "=FACTORY" if fresh else ""
            if each.default is not MISSING:
                known[f"default_{name}"], default = each.default, f"=default_{name}"
            parameters[bool(each.kw_only)].append(name + default)
            if fresh:
                given = f"fresh_{name}() if {name} is FACTORY else {name}"
            lines.append(f"put(self, {name!r}, {given})")
        elif fresh:
            lines.append(f"put(self, {name!r}, fresh_{name}())")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    named = ["*", *parameters[True]] if parameters[True] else []
    head = f"def __init__({', '.join(parameters[False] + named)}):"
    exec("\n ".join((head, *lines)), known)
    init: Callable[..., None] = known["__init__"]
    init.__module__, init.__qualname__ = cls.__module__, f"{cls.__qualname__}.__init__"
    init.__annotations__ = {f.name: f.type for f in fields(cls) if f.init} | {"return": None}
    return init


def _values(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that returns the values of some fields of an object."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda value: tuple(getattr(value, name) for name in names)


def _equal(self: Any, other: Any) -> Any:
    if other.__class__ is not self.__class__:
        return NotImplemented
    return self.__values_compared__(self) == self.__values_compared__(other)


def _hash(self: Any) -> int:
    return hash(self.__values_hashed__(self))


@recursive_repr()
def _printed(self: Any) -> str:
    shown: list[Field[Any]] = [f for f in fields(self) if f.repr]
    values = ", ".join(f"{f.name}={getattr(self, f.name)!r}" for f in shown)
    return f"{self.__class__.__qualname__}({values})"


def _no_change(self: object, name: str, value: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _no_removal(self: object, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")
