"""What of a layout's tables one may change to make it possible, and how far."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import (
    Number,
    Path,
    at,
    eased,
    numbers,
    put,
    times,
    written,
)
from gearopt.scenes.reading.toml import dotted, toml_text
from gearopt.units import UNITS, Quantity

# The largest factor by which a number is moved: beyond it another concept is asked for, not another
# number. A shaft 1.5 times thinner carries 3.4 times the torsional stress.
LARGER = {
    "shaft_stress": 3.0,
    "width": 10.0,
    "largest_width": 10.0,
    "largest_height": 10.0,
    "largest_length": 10.0,
    "tolerance": 10.0,
}
SMALLER = {
    "shaft_diameters": 1.5,
    "bearing_diameters": 1.5,
    "bearing_widths": 2.0,
    "motor_diameter": 2.0,
    "width": 10.0,
    "gear_clearance": 10.0,
    "shaft_clearance": 10.0,
    "wall_clearance": 10.0,
    "axial_clearance": 10.0,
}
REACHES = 2.0  # a place or a keep-out moves so many times the length of all links at most
FACTOR_TOLERANCE = 1e-4  # relative accuracy of a factor that is found
PLACE_TOLERANCE = 1e-3  # mm; accuracy of a place that is found
GRID = 1e-2  # mm; what is proposed is a multiple of it, within the tolerance of a place
# part of a number by which a proposal is taken back to see that it is the smallest
SLACK_TRIED = 1e-3
LEFT = 0.01  # part of a keep-out that is left of it


@dataclass(frozen=True)
class Without:
    """For a value: the list of tables without this one, wherever it stands."""

    table: Any


@dataclass(frozen=True)
class Edit:
    """One change of the file, its size from 0 (none) to 1 (the farthest that is proposed).

    path: its place. searched(size): the value with which to search; monotone, a larger size never
    makes less possible. proposed(size): what to write then, the best first. back(value): a proposal
    taken back a little. change(size): how much is changed, relative. steps: halvings of the
    size that find it accurately; 0 for a switch. limit: how far it is moved, in words. texts: of a
    switch its key, what stands there and what to write.
    """

    path: Path
    searched: Callable[[float], Any]
    proposed: Callable[[float], tuple[Any, ...]]
    back: Callable[[Any], Any]
    change: Callable[[float], float]
    steps: int
    limit: str
    texts: tuple[str, str, str] | None = None

    @property
    def what(self) -> str:
        """Return the key that moves, without its table."""
        return str(next(p for p in reversed(self.path) if isinstance(p, str)))

    def put(self, scene: Scene, value: Any) -> Scene:
        """Return the scene with a value at the place of this edit."""
        path = self.path
        if isinstance(value, Without):
            path = path[:-1]
            value = tuple(one for one in at(scene, path) if one is not value.table)
        found: Scene = put(scene, path, value)
        return found

    def key(self) -> str:
        """Return its place as messages write it."""
        return self.texts[0] if self.texts else dotted(self.path)

    def was(self, scene: Scene) -> str:
        """Return what stands there, as the file writes it."""
        if self.texts:
            return self.texts[1]
        return toml_text(written(at(scene, self.path), self.path)).strip('"')

    def write(self, value: Any) -> str:
        """Return a value as the file writes it."""
        return self.texts[2] if self.texts else toml_text(written(value, self.path))


def edits(scene: Scene, pairs: tuple[GearPair, ...]) -> tuple[Edit, ...]:
    """Return every edit of one number of [layout], [[place]] and [[keep_out]]."""
    reach = sum(pair.centre_distance for pair in pairs)
    found = [m for n in numbers(scene) for m in _factors(n)]
    for k, place in enumerate(scene.place):
        for axis in ("y", "z"):
            if (ends := getattr(place, axis)) is not None:
                found += _wider(("place", k, axis), ends, REACHES * reach, reach)
    for k, keep in enumerate(scene.keep_out):
        for axis in ("y", "z", "x"):
            if (ends := getattr(keep, axis)) is not None:
                width = (1.0 - LEFT) * (ends[1].value - ends[0].value)
                found += _narrower(("keep_out", k, axis), ends, min(width, REACHES * reach), reach)
    return tuple(found)


def limits_of(tried: tuple[Edit, ...]) -> tuple[str, ...]:
    """Return how far moves go, each said once."""
    return tuple(dict.fromkeys(edit.limit for edit in tried))


def _factors(number: Number) -> Iterator[Edit]:
    """Yield the moves of a length or stress by a factor."""
    value, path = number.value, number.path
    inside = path[0] in ("layout", "place") and isinstance(value, Quantity)
    named = str(next(p for p in reversed(path) if isinstance(p, str)))
    for table, sign in ((LARGER, 1), (SMALLER, -1)):
        if inside and value.number and (farthest := table.get(named)):
            yield _factor(path, value, farthest, sign, named)


def _factor(path: Path, value: Quantity, farthest: float, sign: int, named: str) -> Edit:
    return Edit(
        path,
        lambda size: times(value, farthest ** (sign * size)),
        lambda size: (eased(value, farthest**size, sign),),
        lambda new: times(new, 1.0 - sign * SLACK_TRIED),
        lambda size: farthest**size - 1.0,
        math.ceil(math.log2(math.log(farthest) / FACTOR_TOLERANCE)),
        f"{named} up to {farthest:g} times" if sign > 0 else f"{named} down to 1/{farthest:g}",
    )


def _wider(
    path: Path, ends: tuple[Quantity, Quantity], farthest: float, reach: float
) -> Iterator[Edit]:
    """Yield the moves of a place: its range is widened at either end, a point is moved there."""
    point = ends[0] == ends[1]
    for end, sign in ((0, -1), (1, 1)):

        def proposed(size: float, end: int = end, sign: int = sign) -> tuple[Any, ...]:
            new = _shifted(ends[end], sign * farthest * size, True)
            wide = _with(ends, end, new)
            return ((new, new), wide) if point else (wide,)

        def searched(size: float, end: int = end, sign: int = sign) -> Any:
            return _with(ends, end, _shifted(ends[end], sign * farthest * size))

        yield _shift(path, ends, (searched, proposed), end, -sign, farthest, reach)


def _narrower(
    path: Path, ends: tuple[Quantity, Quantity], farthest: float, reach: float
) -> Iterator[Edit]:
    """Yield the moves of a side of a keep-out, inwards."""
    for end, sign in ((0, 1), (1, -1)) if farthest > 0.0 else ():

        def searched(size: float, end: int = end, sign: int = sign) -> Any:
            return _with(ends, end, _shifted(ends[end], sign * farthest * size))

        def proposed(size: float, end: int = end, sign: int = sign) -> tuple[Any, ...]:
            return (_with(ends, end, _shifted(ends[end], sign * farthest * size, True)),)

        yield _shift(path, ends, (searched, proposed), end, -sign, farthest, reach)


def _shift(
    path: Path,
    ends: tuple[Quantity, Quantity],
    values: tuple[Callable[[float], Any], Callable[[float], tuple[Any, ...]]],
    end: int,
    home: int,
    farthest: float,
    reach: float,
) -> Edit:
    """Return the edit of one end by a distance; home: the direction back to where it was."""

    def back(new: Any) -> Any:
        part = max(SLACK_TRIED * abs(new[end].value), 2.0 * GRID)
        nearer = _shifted(new[end], home * part)
        return (nearer, nearer) if new[0] == new[1] else _with(ends, end, nearer)

    steps = math.ceil(math.log2(max(farthest / PLACE_TOLERANCE, 2.0)))
    what, part = "an end of a place", ""
    if path[0] == "keep_out":
        part = f" (and {100.0 * (1.0 - LEFT):g} % of its width)"
        what = "a side of a keep-out inwards"
    limit = f"{what} by up to {REACHES * reach:.0f} mm{part}"
    return Edit(path, *values, back, lambda size: farthest * size / reach, steps, limit)


def _with(ends: tuple[Quantity, Quantity], end: int, new: Quantity) -> tuple[Quantity, Quantity]:
    return (new, ends[1]) if end == 0 else (ends[0], new)


def _shifted(value: Quantity, distance: float, rounded: bool = False) -> Quantity:
    """Return a length moved by a distance [mm]; rounded: to GRID, away from where it was."""
    unit = UNITS["length"][value.unit][0]
    number = value.number + Fraction(distance) / unit
    if rounded:
        grid = Fraction(10) ** math.floor(math.log10(GRID / unit))
        away = math.ceil if distance > 0 else math.floor
        number = away(number / grid) * grid
    return replace(value, number=number)


def switches(scene: Scene) -> tuple[Edit, ...]:
    """Return every place or keep-out left out, slabs left free, no split line, partial span."""
    table = scene.layout
    assert table is not None
    found = []
    for field in ("place", "keep_out"):
        tables = getattr(scene, field)
        for k, one in enumerate(tables):
            called = f"that of shaft {one.shaft}" if field == "place" else one.name or "it"
            texts = (f"{field}[{k + 1}]", called, "")
            limit = f"a {field.replace('_', '-')} left out"
            found.append(_switch((field, k), Without(one), texts, limit))
    if table.slabs is not None:
        was = str([list(slab) for slab in table.slabs])
        found.append(
            _switch(("layout", "slabs"), None, ("layout.slabs", was, '"best"'), "slabs left free")
        )
    if table.split_line is not None:
        texts = ("layout.split_line", str(list(table.split_line)), "")
        found.append(_switch(("layout", "split_line"), None, texts, "no split line"))
    if table.span == "full":
        texts = ("layout.span", '"full"', '"partial"')
        found.append(_switch(("layout", "span"), "partial", texts, "partial span"))
    return tuple(found)


def _switch(path: Path, value: Any, texts: tuple[str, str, str], limit: str) -> Edit:
    return Edit(
        path,
        lambda size: value,
        lambda size: (value,),
        lambda new: new,
        lambda size: 1.0,
        0,
        limit,
        texts,
    )
