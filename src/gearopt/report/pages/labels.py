"""Where a label stands: of several places, the one where it covers least."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

SIZE = 12.0  # of a text, px; drawing.css has the same
LETTER = 0.56  # mean width of a letter over the size, sans serif
CELL = 5.0  # of the grid that counts ink, px


@dataclass(frozen=True)
class Place:
    """The centre of a text [px], its angle [deg, clockwise], and what it costs beforehand.

    leader: what the text names, where a thin line shall lead there.
    """

    x: float
    y: float
    angle: float = 0.0
    cost: float = 0.0
    leader: tuple[float, float] | None = None

    def half_width(self, text: str) -> float:
        """Of the text, px."""
        return 0.5 * LETTER * SIZE * len(text) + 2.0

    def spots(self, text: str) -> Iterator[tuple[float, float]]:
        """Points along the middle of the text and a little beyond, half a size apart."""
        reach = max(0.0, self.half_width(text) - 0.2 * SIZE) if len(text) > 2 else 0.0
        turn = math.radians(self.angle)
        count = math.ceil(2.0 * reach / (0.5 * SIZE))
        for k in range(count + 1):
            along = reach * (2.0 * k / count - 1.0) if count else 0.0
            yield self.x + along * math.cos(turn), self.y + along * math.sin(turn)


@dataclass
class Ink:
    """What is drawn so far, counted by cells, and the texts: filled while a drawing is made."""

    width: float
    height: float
    cells: Counter[tuple[int, int]] = field(default_factory=Counter)
    texts: list[tuple[float, float, float]] = field(default_factory=list)  # x, y, reach

    def add(self, points: Iterable[tuple[float, float]]) -> None:
        """Lines, as points along them."""
        self.cells.update((int(x // CELL), int(y // CELL)) for x, y in points)

    def cost(self, x: float, y: float, reach: float) -> float:
        """Of a letter here: other texts and the paper's edge weigh far more than lines."""
        column, row = int(x // CELL), int(y // CELL)
        lines = sum(
            self.cells.get((column + i, row + j), 0) for i in (-1, 0, 1) for j in (-1, 0, 1)
        )  # the height of a letter
        texts = sum(1 for u, v, r in self.texts if max(abs(u - x), abs(v - y)) < reach + r)
        edge = 0.6 * SIZE
        outside = not (edge <= x <= self.width - edge and edge <= y <= self.height - edge)
        return min(lines, 6) + 100.0 * texts + 120.0 * outside


def best(text: str, places: Sequence[Place], ink: Ink, reach: float = 0.58 * SIZE) -> Place:
    """The cheapest place; the text, with what is drawn within reach [px] of it, stands there."""
    found, least = places[0], math.inf
    for place in places:
        inked = 0.0
        for x, y in place.spots(text):
            inked += ink.cost(x, y, reach)
            if place.cost + inked >= least:
                break  # no letter costs less than nothing
        else:
            found, least = place, place.cost + inked
    ink.texts += ((x, y, reach) for x, y in found.spots(text))
    return found


def around(
    centre: tuple[float, float],
    radii: Sequence[float],
    leader: float | None = None,
    cost: float = 0.0,
) -> list[Place]:
    """Places on circles about a centre [px], nearest first.

    leader: a line leads to the centre, or to the circle of this radius, from places outside it.
    """
    found = []
    for k, r in enumerate(radii):
        for step in range(24):
            turn = 2.0 * math.pi * step / 24 - 0.5 * math.pi
            ux, uy = math.cos(turn), math.sin(turn)
            x, y = centre[0] + r * ux, centre[1] + r * uy
            to = None
            if leader is not None and r > leader:
                to = (centre[0] + leader * ux, centre[1] + leader * uy)
            found.append(Place(x, y, 0.0, cost + 4.0 * k, to))
    return found
