"""Best-first branch and bound: of all open nodes the one of the least bound is branched next."""

import heapq
import math
from collections.abc import Callable, Iterable
from dataclasses import field
from typing import Generic, TypeVar

from gearopt.frozen import dataclass

Node = TypeVar("Node")


@dataclass
class Open(Generic[Node]):
    """Nodes that wait, by bound, of equal bounds the first come first; a search adds and takes."""

    waiting: list[tuple[float, int, Node]] = field(default_factory=list)
    count: int = 0

    @property
    def least(self) -> float:
        """Least bound of the open nodes, inf where none is left."""
        return self.waiting[0][0] if self.waiting else math.inf

    def add(self, nodes: Iterable[tuple[float, Node]]) -> None:
        """Add nodes with their bounds, each as it comes."""
        for bound, node in nodes:
            heapq.heappush(self.waiting, (bound, self.count, node))
            self.count += 1


def best_first(
    roots: Iterable[tuple[float, Node]],
    goes_on: Callable[[float, Node], bool],
    branch: Callable[[float, Node], Iterable[tuple[float, Node]]],
) -> Open[Node]:
    """Nodes that a search leaves open: those from which on `goes_on` refused, or none.

    goes_on(bound, node): asked of the node of the least bound, before it is taken; the place for
    the incumbent and the budget, as no open node has a lower bound. branch(bound, node): children
    with their bounds, kept as they come, so that it may dive between them; what it knows of
    incumbents and leaves is its own.
    """
    left: Open[Node] = Open()
    left.add(roots)
    while left.waiting and goes_on(left.least, left.waiting[0][2]):
        bound, _, node = heapq.heappop(left.waiting)
        left.add(branch(bound, node))
    return left


def ending(whole: bool) -> str:
    """End of a sentence on the parts that a search has examined; whole: all of them."""
    return "none is left to examine" if whole else "stopped before all were examined"
