"""Dataclasses, of which the plain frozen ones load in a quarter of the time.

The library compiles seven functions for a frozen class, which takes 0.6 ms; a command loads some
120 classes before its first word. Here one is compiled for each, `__init__`; comparing, hashing,
printing and refusing changes are functions that all classes share. What is a field, its default and
its order is the library's word, and so is every class that is not plain: mutable or ordered, with
methods of its own in place of these, derived from another class, or with an `InitVar`.
"""

import dataclasses
import sys
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, InitVar, fields
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, Generic

FACTORY = type("Factory", (), {"__repr__": lambda self: "<factory>"})()  # as default in a signature
OWN = {"__eq__", "__hash__", "__init__", "__setattr__", "__delattr__"}  # methods of another meaning

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, frozen=False, **options):
        """`dataclasses.dataclass`; plain frozen classes have methods of `Shared`."""
        if cls is None:
            return lambda cls: dataclass(cls, frozen=frozen, **options)
        if not (frozen and options.keys() <= {"kw_only"} and _is_plain(cls)):
            return dataclasses.dataclass(cls, frozen=frozen, **options)
        printed = cls.__dict__.get("__repr__", METHODS["__repr__"])
        dataclasses.dataclass(cls, init=False, repr=False, eq=False, **options)
        for option in ("init", "repr", "eq", "frozen"):
            setattr(cls.__dataclass_params__, option, True)
        compared = [f.name for f in fields(cls) if f.compare]
        hashed = [f.name for f in fields(cls) if (f.compare if f.hash is None else f.hash)]
        shown = [f.name for f in fields(cls) if f.repr]
        cls.__values__ = _values(compared), _values(hashed), shown
        for name, method in (METHODS | {"__init__": _init(cls), "__repr__": printed}).items():
            setattr(cls, name, method)
        return cls


def _is_plain(cls: type) -> bool:
    """Whether a class has a docstring, no base, no method of OWN, and fields of usual names."""
    if not cls.__doc__ or set(cls.__bases__) - {object, Generic} or OWN & cls.__dict__.keys():
        return False
    hints = cls.__dict__.get("__annotations__", {})
    usual = all(name != "self" and name[0] != "_" for name in hints)
    return usual and not any(
        "InitVar" in hint if isinstance(hint, str) else InitVar in (hint, type(hint))
        for hint in hints.values()
    )


def _init(cls: type) -> Callable[..., None]:
    """`__init__` of a class with the fields of the library."""
    parameters: dict[bool, list[str]] = {False: ["self"], True: []}  # by whether given by name
    hints: dict[bool, dict[str, Any]] = {False: {}, True: {}}
    lines = ["pass"]
    known: dict[str, Any] = {"_put": object.__setattr__, "_FACTORY": FACTORY}
    for each in fields(cls):
        name = each.name
        fresh = each.default_factory is not MISSING
        if fresh:
            known[f"_fresh_{name}"] = each.default_factory
        if each.init:
            given, default = name, "=_FACTORY" if fresh else ""
            if each.default is not MISSING:
                known[f"_default_{name}"], default = each.default, f"=_default_{name}"
            by_name = bool(each.kw_only)
            if not default and not by_name and "=" in parameters[False][-1]:
                raise TypeError(f"non-default argument {name!r} follows default argument")
            parameters[by_name].append(name + default)
            hints[by_name][name] = each.type
            if fresh:
                given = f"_fresh_{name}() if {name} is _FACTORY else {name}"
            lines.append(f"_put(self, {name!r}, {given})")
        elif fresh:
            lines.append(f"_put(self, {name!r}, _fresh_{name}())")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    named = ["*", *parameters[True]] if parameters[True] else []
    head = f"def __init__({', '.join(parameters[False] + named)}):"
    text = "\n  ".join((f"def make({', '.join(known)}):\n {head}", *lines)) + "\n return __init__"
    module, names = sys.modules.get(cls.__module__), dict[str, Any]()
    exec(text, module.__dict__ if module else {}, names)
    init: Callable[..., None] = names["make"](**known)
    init.__module__, init.__qualname__ = cls.__module__, f"{cls.__qualname__}.__init__"
    init.__annotations__ = hints[False] | hints[True] | {"return": None}
    return init


def _values(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that returns the values of some fields of an object."""
    if len(names) > 1:
        return attrgetter(*names)
    get = attrgetter(*names) if names else None
    return lambda value: () if get is None else (get(value),)


class Shared:
    """Methods of all plain frozen classes.

    __values__: what is compared and what is hashed of an object, and the names that are printed.
    """

    __values__: tuple[Callable[[Any], Any], Callable[[Any], Any], list[str]]
    __dataclass_fields__: dict[str, Field[Any]]

    def __eq__(self, other: Any) -> Any:
        if other.__class__ is not self.__class__:
            return NotImplemented
        values = self.__values__[0]
        return values(self) == values(other)

    def __hash__(self) -> int:
        return hash(self.__values__[1](self))

    @recursive_repr()
    def __repr__(self) -> str:
        values = ", ".join([f"{name}={getattr(self, name)!r}" for name in self.__values__[2]])
        return f"{self.__class__.__qualname__}({values})"

    def __setattr__(self, name: str, value: object) -> None:
        if Shared._is_frozen(self, name):
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        object.__setattr__(self, name, value)

    def __delattr__(self, name: str) -> None:
        if Shared._is_frozen(self, name):
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        object.__delattr__(self, name)

    def _is_frozen(self, name: str) -> bool:
        """Whether an attribute may not change: any of such a class, of a derived one a field."""
        return "__dataclass_params__" in vars(self.__class__) or name in self.__dataclass_fields__


METHODS = {name: vars(Shared)[name] for name in ("__repr__", *sorted(OWN - {"__init__"}))}
