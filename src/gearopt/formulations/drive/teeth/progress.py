"""The best trains and the effort of a search so far, and when it must stop."""

import math
from collections.abc import Iterator
from dataclasses import field
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array

TIE = 1e-12  # trains whose objectives differ by less are ties: the fewest teeth are kept
MOST_TIES = 100  # trains of the least objective that are kept
MARGIN = 1e-11  # a node is dropped only when its bound exceeds the best by this, so ties survive

Teeth = tuple[tuple[int, int], ...]


class SearchEnded(Exception):
    """Budget or watcher ended a search between two of its steps."""


@dataclass
class Progress:
    """Best trains and effort of a search; it has state because the search fills it.

    found: (objective, teeth) of the best trains; wanted: how many of them. floor: a bound on the
    objective known from elsewhere; lower: that of this search, once it covers all trains (whole);
    quick: one that is in part checked, not proven, and ends no search (Lemma 84).
    beside: a bound on the trains of drives that are searched in turn with the present one.
    clock: counts tooth pairs sized.
    enough: the budget's gap is reached. patience: seconds after the budget's until which the
    watcher alone ends what is under way, whatever its evaluations. begun: drive and
    tables of a first look at all of them, and their bound.
    """

    wanted: int
    clock: Clock
    floor: float = -math.inf
    found: list[tuple[float, Teeth]] = field(default_factory=list)
    lower: float = -math.inf
    quick: float = -math.inf
    beside: float = math.inf
    whole: bool = False
    compared: int = 0
    nodes: int = 0
    enough: bool = False
    patience: float = -math.inf
    begun: tuple[Any, list[Any], Any] = (None, [], None)

    @property
    def bound(self) -> float:
        """The best lower bound known so far."""
        return max(self.proven, self.quick)

    @property
    def proven(self) -> float:
        """The best bound of which every part is proven."""
        return max(self.lower, self.floor)

    @property
    def threshold(self) -> float:
        """Nodes with a bound above it are of no use."""
        if len(self.found) < self.wanted:
            return math.inf
        value = self.found[self.wanted - 1][0]
        return value * (1.0 + MARGIN if self.wanted == 1 else 1.0 - TIE)

    def add(self, totals: Array, trains: Iterator[Teeth]) -> None:
        """Keep the wanted best (and, for a single one, its ties, of many those of few teeth)."""
        least = {teeth: value for value, teeth in self.found}
        for value, teeth in zip(totals, trains, strict=True):
            known = least.get(teeth, math.inf)
            least[teeth] = float(value) if value < known * (1.0 - TIE) else known
        best = sorted((value, teeth) for teeth, value in least.items())
        if self.wanted == 1:
            ties = [f for f in best if f[0] <= best[0][0] * (1.0 + TIE)]
            few = sorted(ties, key=lambda f: (sum(map(sum, f[1])), f[1]))[:MOST_TIES]
            self.found = ties if len(ties) <= MOST_TIES else sorted({ties[0], *few})
        else:
            self.found = best[: self.wanted]

    def raise_lower(self, bound: float) -> None:
        """Raise the bound to the lowest open one of a search, if that search covers all trains."""
        if self.whole:
            best = self.found[0][0] if self.found else math.inf
            self.lower = max(self.lower, min(bound, self.beside, best))

    def tick(self) -> float:
        """Seconds left; SearchEnded is raised where budget and watcher stop the search."""
        if not self.continues() and (self.clock.refused or self.late >= self.patience):
            raise SearchEnded
        return -self.late

    @property
    def late(self) -> float:
        """Seconds since those of the budget were over; negative before."""
        seconds = self.clock.budget.seconds
        return -math.inf if seconds is None else self.clock.seconds - seconds

    def continues(self) -> bool:
        """Return whether budget and watcher let the search continue."""
        clock, gap = self.clock, self.clock.budget.gap
        clock.bound = self.bound
        if self.found:
            clock.best = self.found[0][0]
            close = clock.best - self.proven <= gap * clock.best
            self.enough = close and gap > 0.0 and self.wanted == 1
        return clock.tell() and not self.enough
