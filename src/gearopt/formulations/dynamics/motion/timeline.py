"""Times of a motion: intervals between outputs and kinks of the stiffness."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair

TIME_TIE = 1e-9  # of a period: two times that are meant to be one


@dataclass(frozen=True)
class Timeline:
    """Intervals in which the stiffness is straight: starts and lengths [s], k0 and k1 [N/mm].

    asked (outputs,): the interval at whose end each output stands; -1: the start.
    """

    starts: Array
    lengths: Array
    k0: Array
    k1: Array
    asked: NDArray[np.int64]

    def divided(self, parts: NDArray[np.int64]) -> "Timeline":
        """Return the timeline with each interval cut into so many equal parts."""
        first = np.cumsum(parts) - parts
        share = (np.arange(parts.sum()) - np.repeat(first, parts)) / np.repeat(parts, parts)
        starts, lengths = np.repeat(self.starts, parts), np.repeat(self.lengths, parts)
        k0, rise = np.repeat(self.k0, parts), np.repeat(self.k1 - self.k0, parts)
        ahead = share + 1.0 / np.repeat(parts, parts)
        asked = np.append(0, np.cumsum(parts))[self.asked + 1] - 1
        return Timeline(
            starts + share * lengths,
            lengths / np.repeat(parts, parts),
            k0 + share * rise,
            k0 + ahead * rise,
            asked,
        )

    def between(self, first: int, last: int) -> tuple[Array, Array, Array, Array]:
        """Return starts, lengths, k0 and k1 of the intervals from first to last - 1."""
        part = slice(first, last)
        return self.starts[part], self.lengths[part], self.k0[part], self.k1[part]

    def counts(self, longest: float) -> NDArray[np.int64]:
        """Return how many equal steps of at most `longest` [s] each interval takes."""
        return np.maximum(1, np.ceil(self.lengths / longest - TIME_TIE)).astype(np.int64)

    @cached_property
    def end(self) -> float:
        """Time of the last interval's end [s]."""
        return float(self.starts[-1] + self.lengths[-1])


def timeline(pair: MovingPair, times: Array, aligned: bool = True) -> Timeline:
    """Return the intervals of a motion with outputs at `times` [s], rising from its start.

    aligned: intervals end at the kinks of the stiffness, as they must for a method to keep its
    order; else each spans two outputs, its stiffness taken as the line between its ends.
    """
    times = np.asarray(times, float)
    frequency, wave = pair.mesh_frequency, pair.wave
    marks = times
    if aligned and frequency > 0.0 and len(wave.edges) > 1:
        first, last = int(times[0] * frequency) - 1, int(times[-1] * frequency) + 2
        kinks = (np.arange(first, last)[:, None] + wave.edges).ravel() / frequency
        kinks = kinks[(kinks > times[0]) & (kinks < times[-1])]
        near = np.searchsorted(times, kinks)
        gap = np.minimum(kinks - times[near - 1], times[np.minimum(near, len(times) - 1)] - kinks)
        marks = np.sort(np.concatenate([times, kinks[gap * frequency > TIME_TIE]]))
    starts, lengths = marks[:-1], np.diff(marks)
    inside = (starts + TIME_TIE / max(frequency, 1e-300)) * frequency
    ends = (marks[1:] - TIME_TIE / max(frequency, 1e-300)) * frequency
    asked = np.searchsorted(marks, times) - 1
    return Timeline(starts, lengths, wave.straight(inside), wave.straight(ends, True), asked)
