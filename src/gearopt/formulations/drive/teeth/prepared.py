"""What standards take of the teeth of a table, made in blocks when rows first ask for them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import field, fields
from typing import Any

import numpy as np

from gearopt.formulations.drive.teeth.columns import Index
from gearopt.frozen import dataclass

BLOCK = 4000  # shapes of teeth that are made at once
Tick = Callable[[], float]
CALL = 700  # shapes that take as long as what is the same for any number of them


def _go_on() -> float:
    return math.inf


@dataclass
class Prepared:
    """Data of shapes of teeth (count,); it has state, as it keeps what was made.

    make: data of some shapes, a dataclass of arrays, tuples of arrays and numbers. apart: shapes
    that were last made without the others of their blocks, and their data; spent: on such shapes,
    in shapes.
    """

    count: int
    make: Callable[[Index], Any]
    blocks: dict[int, Any] = field(default_factory=dict)
    every: Any = None
    apart: tuple[Index, Any] | None = None
    spent: int = 0

    def take(self, shapes: Index, tick: Tick = _go_on) -> Any:
        """Data of the shapes numbered `shapes`, in their order, made when first asked for.

        tick: called before a block is made; what it raises ends the work.
        """
        if self.every is None:
            if (few := self._few(shapes)) is not None:
                return few
            wanted, row = np.unique(shapes // BLOCK, return_inverse=True)
            last = -(-self.count // BLOCK)
            if len(wanted) <= last // 2:
                few = self._joined(wanted if len(wanted) else np.zeros(1, np.int64), tick)
                return few.take(row * BLOCK + shapes % BLOCK)
            self.every = self._joined(np.arange(last), tick)
        return self.every.take(shapes)

    def part(self, place: Index) -> "Part":
        """Data of the shapes at places: shape k of it is shape `place[k]` of this."""
        return Part(self, place)

    def _few(self, shapes: Index) -> Any:
        """Data of shapes that are few of the blocks that are still to be made; None: of many.

        Altogether no more is spent on them than on these blocks.
        """
        blocks = np.unique(shapes // BLOCK).tolist()
        lacking = sum(self._size(number) for number in blocks if number not in self.blocks)
        if not lacking:
            return None
        different, row = np.unique(shapes, return_inverse=True)
        if self.apart is None or not np.array_equal(self.apart[0], different):
            spent = self.spent + len(different) + CALL
            if 2 * spent >= lacking:
                return None
            self.apart, self.spent = (different, self.make(different)), spent
        return self.apart[1].take(row)

    def _joined(self, numbers: Index, tick: Tick) -> Any:
        for number in numbers.tolist():
            if number not in self.blocks:
                tick()
                first = number * BLOCK
                self.blocks[number] = self.make(np.arange(first, first + self._size(number)))
        sizes = [self._size(number) for number in numbers.tolist()]
        return joined([self.blocks[number] for number in numbers.tolist()], sizes)

    def _size(self, number: int) -> int:
        """Number of shapes of a block."""
        return min(BLOCK, self.count - number * BLOCK)


@dataclass(frozen=True)
class Part:
    """Data of the shapes at some places of others."""

    whole: Prepared
    place: Index

    def take(self, shapes: Index, tick: Tick = _go_on) -> Any:
        """Data of the shapes numbered `shapes`, as of `Prepared.take`."""
        return self.whole.take(self.place[shapes], tick)

    def part(self, place: Index) -> "Part":
        """Data of the shapes at places: shape k of it is shape `place[k]` of this."""
        return Part(self.whole, self.place[place])


def joined(tables: Sequence[Any], sizes: Sequence[int]) -> Any:
    """One table of all rows of several, which have so many each; equal numbers stay one."""
    first = tables[0]
    if len(tables) == 1:
        return first
    if isinstance(first, tuple):
        return tuple(joined(columns, sizes) for columns in zip(*tables, strict=True))
    if hasattr(first, "take") and not isinstance(first, np.ndarray | np.generic):
        names = [each.name for each in fields(first)]
        return type(first)(*(joined([getattr(t, n) for t in tables], sizes) for n in names))
    if all(np.ndim(value) == 0 and value == first for value in tables):
        return first
    rows = zip(tables, sizes, strict=True)
    return np.concatenate([np.broadcast_to(value, size) for value, size in rows])
