"""The numbers of a file that a remedy may move, and the file with some of them moved."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from gearopt.frozen import dataclass
from gearopt.optimise.explaining.explanation import Change
from gearopt.optimise.explaining.handles import REACH, Handle
from gearopt.scenes.explaining.numbers import (
    Path,
    allowed,
    apart,
    at,
    cut,
    eased,
    put,
    taken_back,
    written,
)
from gearopt.scenes.reading.toml_writing import dotted, toml_text
from gearopt.units import Quantity

T = TypeVar("T")
SET = 2.0  # a factor above 1, at which a switch is set
LIMIT, SIZE, DUTY = "limit", "size", "duty"  # roles; a size is given, a duty is what is asked for


def _eased(now: Any, factor: float, move: "Move") -> Any:
    return eased(now, factor, move.way)


@dataclass(frozen=True)
class Move:
    """A number of a file, moved one way by a factor >= 1.

    path: its place. way: +1 up, -1 down. role: LIMIT, SIZE (given) or DUTY (asks for less). family:
    the limits it sets, in a remedy's words; its key by default. steps: factors of all its values,
    the nearest first, of a number that takes steps. far: the largest factor that is tried.
    far_first: more of it is never harder, nor its farthest harder to solve. power: of it that
    utilisations go with, about. handles: what of a relaxed form it moves. inherits(scene, path):
    what holds there; write(now, factor, move): what to write; back(now, before, part): the same a
    little less; text(value, path): what a file holds; factor(before, after): how far it moved.
    listed: its values are of a list, so that none is rounded. together(now, factor, move): of steps
    that may be added to each other, what holds all steps up to one. switch: of what is set, not
    moved: its key, what stands there, and what to write.
    """

    path: Path
    way: int
    role: str = LIMIT
    family: str = ""
    steps: tuple[float, ...] = ()
    far: float = REACH
    far_first: bool = True
    power: float = 1.0
    handles: tuple[Handle, ...] = ()
    inherits: Callable[[Any, Path], Any] = at
    write: Callable[[Any, float, "Move"], Any] = _eased
    back: Callable[[Any, Any, float], Any] = taken_back
    text: Callable[[Any, Path], Any] = written
    listed: bool = False
    switch: tuple[str, str, str] | None = None
    factor: Callable[[Any, Any], float] = apart
    together: Callable[[Any, float, "Move"], Any] | None = None

    def to_values(self, now: Any, values: Sequence[Any]) -> "Move":
        """Return the move of a number that takes steps: to one of some values, near ones first."""
        known = {apart(now, value): value for value in values}
        return replace(self, steps=tuple(known), write=lambda now, f, move: known[f], listed=True)

    def to_choices(
        self, now: Any, factors: Sequence[float], values: Sequence[Any], every: Sequence[Any]
    ) -> "Move":
        """Return the move of what is chosen from to one of some values, near ones first.

        factors: of the values; every: what holds all values up to each.
        """
        known, upto = (dict(zip(factors, held, strict=True)) for held in (values, every))

        def factor(before: Any, after: Any) -> float:
            return next((f for f, value in known.items() if value == after), 1.0)

        return replace(
            self,
            steps=tuple(known),
            write=lambda now, f, move: known[f],
            together=lambda now, f, move: upto[f],
            listed=True,
            factor=factor,
        )

    @property
    def words(self) -> str:
        """Name of the number that moves, in a remedy's words."""
        return self.family or dotted(self.path)


Moves = tuple[tuple[Move, float], ...]


@dataclass(frozen=True)
class Edited:
    """A changed scene, and the edits that lead to it, one of each place that moves.

    moved: the scene before its switches, whose places are those of the file.
    """

    scene: Any
    changes: tuple[Change, ...]
    places: tuple[Move, ...]
    moved: Any


def with_values(scene: T, values: Mapping[Path, Any]) -> tuple[tuple[Change, ...], T]:
    """A scene with other values at some places, and its changes."""
    changes, other = [], scene
    for path, value in values.items():
        old, write = (
            "" if v is None else toml_text(written(v, path)) for v in (at(scene, path), value)
        )
        changes.append(Change(dotted(path), old, write, 1.0))
        other = put(other, path, value)
    return tuple(changes), other


def with_each(
    scene: T, path: Path, values: Iterable[Any]
) -> Iterator[tuple[tuple[Change, ...], T]]:
    """Yield scenes with another value at a place, in the order of the values."""
    return (with_values(scene, {path: value}) for value in values)


def edited(scene: Any, moves: Moves) -> Edited | None:
    """Return a scene whose numbers were moved by factors; None where its file's rules refuse it.

    moves: a number that others inherit before them. Switches are set last.
    """
    new, places = scene, dict[tuple[Any, ...], Move]()
    for move, factor in moves:
        places.setdefault((move.path, move.switch), move)
        if move.switch is None:
            value = move.write(move.inherits(new, move.path), factor, move)
            if value is None:
                return None
            new = put(new, move.path, value)
    there = changed(scene, new, tuple(places.values()))
    return there if allowed(there.scene) else None


def changed(scene: Any, new: Any, places: Sequence[Move]) -> Edited:
    """Return the edits that lead from a scene to another, which differs at some places."""
    changes = []
    for move in places:
        if move.switch is not None:
            changes.append(Change(*move.switch, 1.0))
            continue
        was, now = (move.inherits(one, move.path) for one in (scene, new))
        old, write = (toml_text(move.text(value, move.path)) for value in (was, now))
        changes.append(Change(dotted(move.path), old, write, move.factor(was, now)))
    return Edited(_switched(new, places), tuple(changes), tuple(places), new)


def _switched(scene: Any, places: Sequence[Move]) -> Any:
    """Return the scene with the switches among some places set."""
    for move in places:
        if move.switch is not None:
            scene = put(scene, move.path, move.write(at(scene, move.path), SET, move))
    return scene


def less(scene: Any, there: Edited, part: float, only: int | None = None) -> Any:
    """Return the edited scene with all changes, or one, taken back by a part of their size.

    Whole numbers go back by one. None where the rules of the file refuse that.
    """
    new = there.moved
    for k, move in enumerate(there.places):
        if move.switch is None and (only is None or k == only):
            before, now = (move.inherits(one, move.path) for one in (scene, new))
            new = put(new, move.path, move.back(now, before, part))
    new = _switched(new, there.places)
    return new if allowed(new) else None


def shorter(scene: Any, there: Edited, digits: int) -> Edited | None:
    """Edits with every moved number of so few digits, rounded away from its old value.

    None where none is shorter.
    """
    new, changes = there.moved, []
    for move, change in zip(there.places, there.changes, strict=True):
        if move.switch is not None:
            changes.append(change)
            continue
        before, now = (move.inherits(one, move.path) for one in (scene, there.moved))
        value = now if move.listed else _short(before, now, move.way, digits)
        text = toml_text(move.text(value, move.path))
        changes.append(replace(change, short="" if text == change.write else text))
        new = put(new, move.path, value)
    final = _switched(new, there.places)
    if not any(change.short for change in changes) or not allowed(final):
        return None
    return Edited(final, tuple(changes), there.places, new)


def _short(before: Any, now: Any, way: int, digits: int) -> Any:
    """Return a quantity or fraction of few digits that relaxes the limit; whole numbers stay."""
    if isinstance(now, tuple):
        old = before if isinstance(before, tuple) else (before, before)
        return tuple(_short(b, n, way, digits) for b, n in zip(old, now, strict=True))
    if now == before or isinstance(now, int):
        return now
    reciprocal = isinstance(now, Quantity) and now.reciprocal
    return cut(now, -way if reciprocal else way, digits)
