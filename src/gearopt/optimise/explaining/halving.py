"""The least factor that suffices, between one that does not and one that does, by halving."""

import math
from collections.abc import Iterator
from typing import Protocol

from gearopt.frozen import dataclass

DOUBTS = 3  # factors that may stay undecided before a search ends at the smallest that is known
ROUGH = 1.02  # ratio of a refused to an allowed factor up to which logarithms are halved as such


class Ends(Protocol):
    """Two factors: `low` does not suffice (sure: proven), `high` does; doubts: undecided ones."""

    low: float
    high: float
    sure: bool
    doubts: int


@dataclass
class Bracket:
    """Two factors between which the least lies that suffices, as `Ends`; a search narrows them."""

    low: float
    high: float
    sure: bool = True
    doubts: int = 0


def between(low: float, high: float) -> float:
    """Factor between two: of far ones that of the geometric mean of their logarithms."""
    near, far = math.log(low), math.log(high)
    least = math.log(ROUGH)
    return math.exp(math.sqrt(max(near, least) * far) if far > 4.0 * least else 0.5 * (near + far))


def middles(known: Ends, close: float, doubts: int = DOUBTS) -> Iterator[float]:
    """Yield factors to try, each between the ends that `take` has left, until they are this close.

    So many may stay undecided.
    """
    known.doubts = 0
    while known.high > known.low * close and known.doubts < doubts:
        yield between(known.low, known.high)


def take(known: Ends, factor: float, answer: bool | None) -> None:
    """Narrow the ends by whether a factor suffices; an undecided one counts as too small."""
    known.doubts += answer is None
    if answer:
        known.high = factor
    else:
        known.low, known.sure = factor, answer is False
