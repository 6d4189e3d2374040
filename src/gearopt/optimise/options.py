"""Options of a call held to their sort: the wrong one by name, and its remedy."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from functools import wraps
from inspect import signature
from numbers import Integral
from threading import RLock
from typing import Any, ParamSpec, TypeVar

from gearopt.optimise.result import Budget, is_number

P = ParamSpec("P")
R = TypeVar("R")
BUDGET = "a Budget, such as budget=Budget(seconds=10)"


def _whole(value: Any, minimum: int) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and int(value) >= minimum


def _numbers(value: Any) -> bool:
    return isinstance(value, Mapping) and all(is_number(v) for v in value.values())


SORTS: dict[str, tuple[Callable[[Any], bool], str]] = {  # of options: what each is, in words
    "method": (lambda v: isinstance(v, str), 'the name of a method, such as method="ipopt"'),
    "budget": (lambda v: isinstance(v, Budget), BUDGET),
    "seed": (lambda v: _whole(v, 0), "a whole number of at least 0"),
    "watch": (callable, "a function of an Event that returns whether to go on"),
    "gap": (lambda v: is_number(v) and v >= 0, "a number of at least 0, such as gap=0.01 for 1 %"),
    "top": (lambda v: _whole(v, 1), "a whole number of at least 1"),
    "prices": (lambda v: isinstance(v, bool | float) and v >= 0.0, "True, False or a share"),
    "remedies": (lambda v: isinstance(v, bool), "True or False"),
    "workers": (lambda v: _whole(v, 1), "a whole number of processes, of at least 1"),
    "seeds": (lambda v: _whole(v, 1), "a whole number of at least 1: so many seeds, from 0"),
    "evaluations": (lambda v: _whole(v, 1), "a whole number of at least 1"),
    "seconds": (lambda v: is_number(v) and v > 0, "a number above 0"),
    "bound_from": (lambda v: isinstance(v, str), 'the name of a method, such as "exact"'),
    "points": (lambda v: _whole(v, 2), "a whole number of at least 2"),
    "most": (_numbers, 'numbers by name, such as most={"mass": 40}'),
    "weights": (_numbers, 'numbers by name, such as weights={"mass": 1, "cost": 2}'),
    "start": (lambda v: isinstance(v, Mapping), 'values by name, such as start={"x": 1.0}'),
}
NONE = (
    "method",
    "budget",
    "watch",
    "gap",
    "bound_from",
    "start",
    "points",
    "most",
    "weights",
)  # options that may be None


def check(**options: Any) -> None:
    """Raise ValueError for the first option of another sort than it has, with its remedy."""
    for name, value in options.items():
        right, words = SORTS[name]
        if not (value is None and name in NONE) and not right(value):
            raise ValueError(f"{name}={value!r}: {name} is {words}"[:300])


def named(call: Callable[P, R]) -> Callable[P, R]:
    """Return a function that answers an unknown option with the ones it has: TypeError."""
    known = list(signature(call).parameters)

    @wraps(call)
    def checked(*args: P.args, **options: P.kwargs) -> R:
        if odd := [name for name in options if name not in known]:
            raise TypeError(f"{call.__name__} has no option {odd[0]}{_meant(odd[0], known)}")
        return call(*args, **options)

    return checked


_TURN = RLock()  # casadi's symbols and numba's first calls are of one thread at a time


def in_turn(call: Callable[P, R]) -> Callable[P, R]:
    """Return a `named` function of which one thread runs one at a time."""

    @wraps(call)
    def alone(*args: P.args, **options: P.kwargs) -> R:
        with _TURN:
            return call(*args, **options)

    return named(alone)


def _meant(name: str, known: list[str]) -> str:
    """Options that an unknown one may mean, and the options there are."""
    if name in ("seconds", "evaluations", "time", "timeout", "time_limit") and "budget" in known:
        spent = "evaluations" if name == "evaluations" else "seconds"
        return f": write budget=Budget({spent}=...)"
    close = get_close_matches(name, known, n=1)
    meant = f": did you mean {close[0]}?" if close else ""
    return f"{meant or ':'} options: {', '.join(known[1:])}"
