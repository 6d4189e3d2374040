"""Points of a run at which a text, run point by point, raised: they have no value and are counted.

Where a run's seconds end among the points of one population, the others are left out.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from gearopt.frozen import dataclass


@dataclass
class Points:
    """The points of a run so far; it has state because they are counted as they come.

    end: when its seconds end (`time.perf_counter`), None: never. skipped: points that came later.
    first: the first failure in words.
    """

    end: float | None = None
    count: int = 0
    failed: int = 0
    skipped: int = 0
    first: str = ""

    @property
    def late(self) -> bool:
        """Return whether no time is left for another point."""
        return self.end is not None and time.perf_counter() >= self.end

    def note(self, failure: str) -> None:
        """Count a point, and its failure in words ("": it has a value)."""
        self.count += 1
        if failure:
            self.failed, self.first = self.failed + 1, self.first or failure

    def __str__(self) -> str:
        if not self.failed:
            return ""
        return f"{self.failed} of {self.count} points failed: {self.first}"


_POINTS: ContextVar[Points | None] = ContextVar("points of the run", default=None)


@contextmanager
def counting(seconds: float | None) -> Iterator[Points]:
    """Count the points of a run of so many seconds from now (None: without an end)."""
    points = Points(None if seconds is None else time.perf_counter() + seconds)
    token = _POINTS.set(points)
    try:
        yield points
    finally:
        _POINTS.reset(token)


def current() -> Points:
    """Return the points of the run that is under way; a count that nobody reads outside of one."""
    return _POINTS.get() or Points()
