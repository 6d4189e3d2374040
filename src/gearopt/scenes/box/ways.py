"""Ways out of an impossible layout, as edits of its file that were tried before they are told."""

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

from gearopt.formulations.layout.possible import possible
from gearopt.formulations.train import Sizes
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.repair import Clock
from gearopt.scenes.explaining.numbers import Number, eased, numbers, put, times
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.tables.drive import Scene
from gearopt.units import Quantity

LARGER = ("shaft_stress", "width", "largest_width", "largest_height", "largest_length", "tolerance")
FARTHEST = 1e3  # factor by which a number is moved at most
CLOSE = 1.0 + 1e-4  # ratio of an impossible factor to a possible one that ends a search
SECONDS = 2.0  # at most, for one question whether a layout is possible

Possible = Callable[[Scene], bool | None]


def ways(scene: Scene, sizes: Sizes, ask: Ask) -> dict[str, Any]:
    """Each number or switch of the layout that alone makes these gears possible to lay out."""
    clock = Clock(ask.budget, ask.watch)

    def tried(other: Scene) -> bool | None:
        left = clock.left.seconds
        if clock.over:
            return None
        seconds = SECONDS if left is None else min(SECONDS, left)
        return possible(other.gearbox(sizes), seconds, ask.watch)

    found = [r for n in _numbers(scene) if (r := _moved(scene, n, tried)) is not None]
    found.sort(key=lambda r: r.factor)
    found += _choices(scene, tried)
    late = "time ran out before all ways out were tried" if clock.over else ""
    return {"conflict": [], "remedies": [asdict(r) for r in found], "message": late}


def _numbers(scene: Scene) -> Iterator[Number]:
    """The lengths and stresses of the layout that one may move."""
    for number in numbers(scene):
        inside = number.path[0] in ("layout", "place") and isinstance(number.value, Quantity)
        named = str(next(p for p in reversed(number.path) if isinstance(p, str)))
        if inside and named not in ("y", "z") and number.value.number:
            yield number


def _moved(scene: Scene, number: Number, tried: Possible) -> Remedy | None:
    """The least change of one number; None where none does, or it is not known in time."""
    named = str(next(p for p in reversed(number.path) if isinstance(p, str)))
    sign = 1 if named in LARGER else -1

    def works(factor: float) -> bool | None:
        return tried(put(scene, number.path, times(number.value, factor**sign)))

    if not works(FARTHEST):
        return None
    low, high = 1.0, FARTHEST
    while high > low * CLOSE:
        middle = math.sqrt(low * high)
        fits = works(middle)
        if fits is None:
            return None
        low, high = (low, middle) if fits else (middle, high)
    value = eased(number.value, high, sign)
    if not tried(put(scene, number.path, value)):
        return None
    change = Change(number.key, number.text, f'"{value}"', high)
    verified = {"with": "feasible", "with_less": "infeasible"}
    return Remedy("least", named, (change,), high, low, verified)


def _called(table: Any) -> str:
    """A place or keep-out in a word or two."""
    return f"that of shaft {table.shaft}" if hasattr(table, "shaft") else table.name or "it"


def _choices(scene: Scene, tried: Possible) -> Iterator[Remedy]:
    """Switches of the layout that suffice alone."""
    table = scene.layout
    assert table is not None
    switches: list[tuple[str, str, str, Any]] = []
    if table.slabs is not None:
        switches.append(("slabs", str([list(s) for s in table.slabs]), '"best"', None))
    if table.span == "full":
        switches.append(("span", '"full"', '"partial"', "partial"))
    for field in ("place", "keep_out"):
        tables = getattr(scene, field)
        for k, one in enumerate(tables):
            if tried(scene.model_copy(update={field: tables[:k] + tables[k + 1 :]})):
                change = Change(f"{field}[{k + 1}]", _called(one), "", 1.0)
                yield Remedy("choice", field, (change,), 1.0, None, {"with": "feasible"})
    for field, was, write, value in switches:
        other = scene.model_copy(update={"layout": table.model_copy(update={field: value})})
        if tried(other):
            change = Change(f"layout.{field}", was, write, 1.0)
            yield Remedy("choice", field, (change,), 1.0, None, {"with": "feasible"})
