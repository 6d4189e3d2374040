"""The numbers of a layout's tables that a remedy may move, how far, and its switches."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.moves import SET, Move
from gearopt.scenes.explaining.numbers import Number, Path, at, numbers, put
from gearopt.scenes.reading.toml_writing import dotted
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
SPAN = 10.0  # mm that a place moves for a factor of e, so that it is found to hundredths
GRID = 1e-2  # mm; what is proposed is a multiple of it, within the tolerance of a place
LEFT = 0.01  # part of a keep-out that is left of it
SCALE = math.e**6  # farthest factor of a move whose size is a part of its own farthest


@dataclass(frozen=True)
class BoxMove:
    """A move of a number of the layout, or a switch.

    path: what it changes; limit: how far it goes, in words. reach: length of all links [mm] by
    which a distance is measured, 0 where it moves by a factor. point: of a place that is a point,
    the move of the whole of it; the range is widened while the distance is sought.
    """

    path: Path
    move: Move
    limit: str
    reach: float = 0.0
    point: Move | None = None

    @property
    def key(self) -> str:
        """Return its place as messages write it."""
        return self.move.switch[0] if self.move.switch else dotted(self.path)

    def change(self, factor: float) -> float:
        """Return how much is changed, relative."""
        if self.move.switch is not None:
            return 1.0
        return SPAN * math.log(factor) / self.reach if self.reach else factor - 1.0

    @property
    def scaled(self) -> Move:
        """Return the move with a factor up to SCALE: of two moves the same part of each."""
        move = self.move
        if move.switch is not None:
            return move

        def write(now: Any, factor: float, own: Move) -> Any:
            return move.write(now, self.unscaled(factor), own)

        return replace(move, far=SCALE, write=write)

    def unscaled(self, size: float) -> float:
        """Return the factor of the move that is scaled to a size."""
        if self.move.switch is not None:
            return SET
        part = min(math.log(size) / math.log(SCALE), 1.0)  # a switch beside it may go farther
        return float(self.move.far**part)


def box_moves(scene: Scene, pairs: tuple[GearPair, ...]) -> tuple[BoxMove, ...]:
    """Return every move of one number of [layout], [[place]] and [[keep_out]]."""
    reach = sum(pair.centre_distance for pair in pairs)
    moves = [m for n in numbers(scene) for m in _factors(n)]
    farthest = REACHES * reach
    for table, ways, what in (
        ("place", ((0, -1), (1, 1)), "an end of a place"),
        ("keep_out", ((0, 1), (1, -1)), "a side of a keep-out inwards"),
    ):
        for k, table_row in enumerate(getattr(scene, table)):
            for axis in ("y", "z", "x") if table == "keep_out" else ("y", "z"):
                ends = getattr(table_row, axis)
                if ends is None:
                    continue
                inside = (1.0 - LEFT) * (ends[1].value - ends[0].value)
                far = min(inside, farthest) if table == "keep_out" else farthest
                part = f" (and {100.0 * (1.0 - LEFT):g} % of its width)" * (table == "keep_out")
                limit = f"{what} by up to {farthest:.0f} mm{part}"
                for end, way in ways if far > 0.0 else ():
                    point = table == "place" and ends[0] == ends[1]
                    moves.append(_shift((table, k, axis), end, way, far, limit, reach, point))
    return tuple(moves)


def limits_of(tried: tuple[BoxMove, ...]) -> tuple[str, ...]:
    """Return how far moves go, each said once."""
    return tuple(dict.fromkeys(move.limit for move in tried))


def _factors(number: Number) -> Iterator[BoxMove]:
    """Yield the moves of a length or stress by a factor."""
    value, path = number.value, number.path
    inside = path[0] in ("layout", "place") and isinstance(value, Quantity)
    named = str(next(p for p in reversed(path) if isinstance(p, str)))
    for table, way in ((LARGER, 1), (SMALLER, -1)):
        if inside and value.number and (farthest := table.get(named)):
            up = f"{named} up to {farthest:g} times"
            limit = up if way > 0 else f"{named} down to 1/{farthest:g}"
            yield BoxMove(path, Move(path, way, family=named, far=farthest), limit)


def _shift(
    path: Path, end: int, way: int, farthest: float, limit: str, reach: float, point: bool
) -> BoxMove:
    """Return the move of an end of a range by a distance."""
    move = Move(
        path,
        way,
        family=str(path[-1]),
        far=math.exp(farthest / SPAN),
        write=partial(_end_moved, end),
        back=partial(_end_back, end, way),
        factor=_by_distance,
    )
    whole = replace(move, write=partial(_point_moved, end)) if point else None
    return BoxMove(path, move, limit, reach, whole)


def _end_moved(end: int, now: Any, factor: float, move: Move) -> Any:
    new = _shifted(now[end], move.way * SPAN * math.log(factor), True)
    return (new, now[1]) if end == 0 else (now[0], new)


def _point_moved(end: int, now: Any, factor: float, move: Move) -> Any:
    return (_end_moved(end, now, factor, move)[end],) * 2


def _end_back(end: int, way: int, now: Any, before: Any, part: float) -> Any:
    """Return a range with the end that moved a little nearer to where it was."""
    back = max(part * abs(now[end].value), 2.0 * GRID)
    nearer = _shifted(now[end], -way * back)
    if now[0] == now[1]:
        return nearer, nearer
    return (nearer, now[1]) if end == 0 else (now[0], nearer)


def _by_distance(before: Any, after: Any) -> float:
    return math.inf


def _shifted(value: Quantity, distance: float, rounded: bool = False) -> Quantity:
    """Return a length moved by a distance [mm]; rounded: to GRID, away from where it was."""
    unit = UNITS["length"][value.unit][0]
    number = value.number + Fraction(distance) / unit
    if rounded and distance:
        grid = Fraction(10) ** math.floor(math.log10(GRID / unit))
        away = math.ceil if distance > 0 else math.floor
        number = away(number / grid) * grid
    return replace(value, number=number)


def switches(scene: Scene) -> tuple[BoxMove, ...]:
    """Return every place or keep-out left out, slabs left free, no split line, partial span."""
    table = scene.layout
    assert table is not None
    moves = []
    for field in ("place", "keep_out"):
        for k, table_row in enumerate(getattr(scene, field)):
            called = (
                f"that of shaft {table_row.shaft}" if field == "place" else table_row.name or "it"
            )
            limit = f"a {field.replace('_', '-')} left out"
            without = partial(_without, table_row)
            moves.append(_switch((field, k), without, (f"{field}[{k + 1}]", called, ""), limit))
    if table.slabs is not None:
        was = str([list(slab) for slab in table.slabs])
        texts = ("layout.slabs", was, '"best"')
        moves.append(_switch(("layout", "slabs"), lambda now: None, texts, "slabs left free"))
    if table.split_line is not None:
        texts = ("layout.split_line", str(list(table.split_line)), "")
        moves.append(_switch(("layout", "split_line"), lambda now: None, texts, "no split line"))
    if table.span == "full":
        texts = ("layout.span", '"full"', '"partial"')
        moves.append(_switch(("layout", "span"), lambda now: "partial", texts, "partial span"))
    return tuple(moves)


def _without(table: Any, tables: Any) -> Any:
    """Return a list of tables without one, wherever it stands."""
    return tuple(one for one in tables if one is not table)


def _switch(path: Path, value: Any, texts: tuple[str, str, str], limit: str) -> BoxMove:
    """Return a switch: value(now) is set; texts: its key, what stands there, what to write."""
    place = path[:-1] if isinstance(path[-1], int) else path
    what = str(next(p for p in reversed(path) if isinstance(p, str)))

    def write(now: Any, factor: float, move: Move) -> Any:
        return value(now) if factor > 1.0 else now

    return BoxMove(path, Move(place, 1, family=what, write=write, switch=texts), limit)


def switched(scene: Scene, switch: BoxMove) -> Any:
    """Return the scene with a switch set; not checked against the file's rules."""
    move = switch.move
    return put(scene, move.path, move.write(at(scene, move.path), SET, move))
