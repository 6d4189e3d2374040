"""Life curves of parts 2 and 3: strength over the number of load cycles, straight in log-log.

Numbers of cycles and strengths are floats or arrays.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass

LONGEST_LIFE = 1e10  # cycles; the curves are flat beyond
# Source: ISO 6336-2:2006, table 2, and 6336-3:2006, table 1; gfsReboucas/Drivetrain has those of
# pitting, hanslhansl/din3990 (DIN 3990-11) has knees and static values of both
# at LONGEST_LIFE; 1 for the best material, manufacture and lubrication, and experience
LOWEST = 0.85
ROUNDING = 1e-12  # of the logarithm of a strength, at both ends of a curve
PITTING = {
    **dict.fromkeys(("St", "V", "GTS", "GGG", "Eh", "IF"), ((1e5, 1.6), (5e7, 1.0))),
    **dict.fromkeys(("GG", "GGG ferritic", "NT", "NV"), ((1e5, 1.3), (2e6, 1.0))),
    "NV nitrocarburised": ((1e5, 1.1), (2e6, 1.0)),
}
LIMITED_PITTING = ((6e5, 1.6), (1e7, 1.3), (1e9, 1.0))  # of St, V, GTS, GGG, Eh, IF
BENDING = {
    **dict.fromkeys(("St", "V", "GTS", "GGG"), ((1e4, 2.5), (3e6, 1.0))),
    **dict.fromkeys(("Eh", "IF"), ((1e3, 2.5), (3e6, 1.0))),
    **dict.fromkeys(("GG", "GGG ferritic", "NT", "NV"), ((1e3, 1.6), (3e6, 1.0))),
    "NV nitrocarburised": ((1e3, 1.1), (3e6, 1.0)),
}


@dataclass(frozen=True)
class Curve:
    """A strength over cycles: knots, straight between them in log-log, flat outside.

    cycles: floats, ascending; values: of one shape each, not rising.
    """

    cycles: tuple[float, ...]
    values: tuple[Any, ...]

    def factor(self, cycles: Any) -> Any:
        """Return the strength at a number of cycles."""
        at, logs, knots = np.log(np.maximum(cycles, self.cycles[0])), self._logs, self._knots
        log_strength = logs[0]
        for k in range(len(knots) - 1):
            share = (at - knots[k]) / (knots[k + 1] - knots[k])
            part = np.minimum(np.maximum(share, 0.0), 1.0)
            log_strength = log_strength + (logs[k + 1] - logs[k]) * part
        return np.exp(log_strength)

    def take(self, place: Any) -> "Curve":
        """Return the curves of some rows of arrays."""
        return Curve(self.cycles, tuple(v[place] if np.ndim(v) else v for v in self.values))

    @cached_property
    def _logs(self) -> list[Any]:
        """Logarithms of the values."""
        return [np.log(each) for each in self.values]

    @cached_property
    def _knots(self) -> list[Any]:
        """Logarithms of the numbers of cycles."""
        return [np.log(each) for each in self.cycles]

    def life(self, value: Any) -> Any:
        """Return the number of cycles at which a strength is reached; the inverse of `factor`.

        0 above the static strength, infinite below that of the last knot.
        """
        logs = self._logs
        with np.errstate(divide="ignore", invalid="ignore"):
            at = np.log(value)
            found = np.log(self.cycles[0]) + 0.0 * logs[0]
            for k in range(len(logs) - 1):
                span = np.log(self.cycles[k + 1] / self.cycles[k])
                drop = np.maximum(logs[k] - logs[k + 1], 1e-300)
                found = found + span * np.clip((logs[k] - at) / drop, 0.0, 1.0)
        above = at > logs[0] + ROUNDING
        below = at < logs[-1] - ROUNDING
        return np.where(above, 0.0, np.where(below, np.inf, np.exp(found)))[()]


def life_factor(knots: Sequence[tuple[float, float]], lowest: float = LOWEST) -> Curve:
    """Return the curve of Z_NT or Y_NT: knots, then straight to `lowest` at 1e10 cycles."""
    cycles = (*(n for n, _ in knots), LONGEST_LIFE)
    return Curve(cycles, (*(value for _, value in knots), lowest))


def pitting_curve(family: str, limited: bool = False, lowest: float = LOWEST) -> Curve:
    """Return the curve of Z_NT of a family of materials (`materials.FAMILIES`).

    limited: limited pitting is permitted; it changes that of St, V, GTS, GGG, Eh and IF.
    Source: ISO 6336-2:2006, table 2.
    """
    knots = PITTING[family]
    return life_factor(LIMITED_PITTING if limited and knots[0][1] == 1.6 else knots, lowest)


def bending_curve(family: str, lowest: float = LOWEST) -> Curve:
    """Return the curve of Y_NT of a family of materials. Source: ISO 6336-3:2006, table 1."""
    return life_factor(BENDING[family], lowest)


def reference_share(curve: Curve, cycles: Any) -> Any:
    """Return how far a number of cycles is from static (0) to reference strength (1), in log-log.

    Other factors of strength, which are one for static and one for reference strength, follow it:
    static^(1 - t) reference^t, so that the strength is straight between the two in log-log, as
    parts 2 and 3 interpolate. curve: that of the life factor, whose reference value is 1.
    """
    return share_of_life(curve, curve.factor(cycles))


def share_of_life(curve: Curve, life: Any) -> Any:
    """`reference_share` at the cycles of a life factor."""
    return np.clip(1.0 - np.log(life) / np.log(curve.values[0]), 0.0, 1.0)
