"""What to write instead in a file that asks for the impossible: each number alone, tried."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import THERE
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.handles import Handle, handles
from gearopt.optimise.explaining.repair import BEYOND, TAKEN_BACK, conflict, least_value
from gearopt.optimise.problem import Problem
from gearopt.scenes.explaining.numbers import Number, eased, moved, numbers, times, written
from gearopt.scenes.reading.toml import toml_text
from gearopt.units import Quantity


@dataclass(frozen=True)
class Remedies:
    """conflict: names of limits that cannot hold together; remedies; message: what is missing."""

    conflict: tuple[str, ...] = ()
    remedies: tuple[Remedy, ...] = ()
    message: str = ""


def remedies(scene: Any, problem: Problem, clock: Clock, status: Callable[[Any], str]) -> Remedies:
    """The conflict of an impossible file, and each of its numbers that alone makes it possible.

    problem: what is solved for the file; its handles say by their keys which numbers are limits or
    given, and which way is easier. status(scene): of a changed file, solved. A remedy is told only
    if the file with it, read anew, has a design.
    """
    known = handles(problem)
    found = [r for n, h in _keyed(scene, known) if (r := _alone(scene, n, h, clock, status))]
    own = sorted((r for r in found if r.kind != "less"), key=lambda r: r.factor)
    if own:
        tried = "not all known" if clock.over else "need more"
        least = replace(own[0], kind="least", verified={**own[0].verified, "others": tried})
        own = [least, *own[1:]]
    late = "time ran out before all ways out were tried" if clock.over else ""
    return Remedies(
        _conflict(problem, known, clock),
        (*own, *(r for r in found if r.kind == "less")),
        late,
    )


def _conflict(problem: Problem, known: Sequence[Handle], clock: Clock) -> tuple[str, ...]:
    """Limits that cannot hold together; with what is given where limits alone can."""
    if any(variable.discrete for variable, _ in problem.columns):
        return ()
    limits = [h for h in known if not h.given]
    return tuple(
        h.name for h in conflict(problem, limits, clock) or conflict(problem, known, clock)
    )


def _keyed(scene: Any, known: Sequence[Handle]) -> Iterator[tuple[Number, Handle]]:
    """The numbers of a file that handles name, once each way."""
    places = {n.key: n for n in numbers(scene, defaults=True)}
    named = {(h.key, h.direction): h for h in known if h.key in places}
    for (key, _), handle in named.items():
        yield places[key], handle


def _alone(
    scene: Any, number: Number, handle: Handle, clock: Clock, status: Callable[[Any], str]
) -> Remedy | None:
    """A number moved alone as little as that takes; None where it does not help."""
    way = handle.direction
    words: dict[str, bool] = dict.fromkeys(THERE, True) | {"infeasible": False}

    def at(factor: float, back: float = 0.0) -> Any:
        value = eased(number.value, factor, way)
        return moved(scene, number.path, taken_back(value, number.value, back) if back else value)

    def tried(factor: float, back: float = 0.0) -> str:
        other = None if clock.over else at(factor, back)
        return "undecided" if other is None else status(other)

    def works(factor: float, back: float = 0.0) -> bool | None:
        return words.get(tried(factor, back))

    wider = [f for f in BEYOND if at(f) is not None]
    if not getattr(number.value, "number", number.value) or not wider:
        return None
    least = least_value(1.0, tuple(wider), works)
    if least is None:
        return None
    value = eased(number.value, least, way)
    was, write = (toml_text(written(v, number.path)) for v in (number.value, value))
    change = Change(number.key, was, write, apart(number.value, value))
    verified = {"with": tried(least), "with_less": tried(least, TAKEN_BACK)}
    verified = {k: "feasible" if w in THERE else w for k, w in verified.items()}
    kind, what = "less" if handle.given else "alone", number.key
    return Remedy(kind, what, (change,), change.factor, None, verified)


def taken_back(now: Any, before: Any, part: float) -> Any:
    """A value moved back by a part of its size; integers by one."""
    if isinstance(now, tuple):
        old = before if isinstance(before, tuple) else (before, before)
        return tuple(taken_back(a, b, part) for a, b in zip(now, old, strict=True))
    number, target = (v.number if isinstance(v, Quantity) else v for v in (now, before))
    if number == target:
        return now
    if isinstance(now, int):
        return now + (1 if target > number else -1)
    return times(now, 1.0 - part if number > target else 1.0 + part)


def apart(before: Any, after: Any) -> float:
    """How far two values are apart, as a factor >= 1; of ranges, the product of both ends'.

    Ends that were equal and are equal are one number.
    """
    if isinstance(before, tuple):
        if before[0] == before[1] and after[0] == after[1]:
            return apart(before[0], after[0])
        return math.prod(apart(a, b) for a, b in zip(before, after, strict=True))
    a, b = (float(v.number if isinstance(v, Quantity) else v) for v in (before, after))
    return max(a, b) / min(a, b) if min(a, b) > 0.0 else math.inf
