"""Load limits of a gear pair at a torque and a speed: what a law is, and their common text.

A law gives indices (stresses, load factors) of a loaded pair, each with a limit that a stage sets.
Searches ask it for utilisations or narrowest face widths and know no formula.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

ALLOWANCE = 1e-12  # a utilisation this little above 1 is rounding, not a violation
HALVINGS = 50  # of a bisection over 14 units of log width: to rounding
NARROW = 1e-6  # of the widest face width: nothing narrower is considered


@dataclass(frozen=True)
class LimitedIndex:
    """The limit of one index: its name, which is also its key in a file, and its unit.

    words: what reports call it, by default its name. meaning: of the key, for the reference.
    example: a value as a file writes it.
    """

    name: str
    unit: str = "MPa"
    words: str = ""
    meaning: str = ""
    example: str = "1 MPa"

    @property
    def design_key(self) -> str:
        """Name of the index in a design, with its unit."""
        return f"{self.name}_{self.unit}"

    @property
    def label(self) -> str:
        """Name of the index in reports."""
        return self.words or self.name.replace("_", " ")


@dataclass(frozen=True)
class Law:
    """A strength law: indices of a loaded gear pair, none of which may exceed its limit.

    title: of its indices, in words; kind: what they are and are not, for readers of a result.
    limits: of the indices, in order. indices(pair, torque, speed): those of a `GearPair` at torque
    [N mm] and speed [rad/s] of its pinion, in the units of the limits; text on floats, arrays or
    casadi scalars. Where it is a posynomial, so is the continuous drive, and its minimum is global;
    else Ipopt takes it as it is.

    Promised of every law: an index falls as the face width grows, and at one power (torque times
    speed) it rises with the torque. proportional: for given teeth, helix angle and rack it is
    c T/(b m_n^2); for a given pinion diameter it does not fall as the teeth become more and
    smaller, and as the ratio u grows it falls no faster than 1 + 1/u: then narrowest widths and
    modules have closed forms, which are bisected otherwise. minimum_teeth: number of teeth of a
    pinion from which on the law and its promises hold. pressure_angle: whether an index depends on
    it. relaxed: of a law that is not a posynomial, a lower bound of its indices that is one, for
    proofs that a drive is impossible.
    """

    title: str
    limits: tuple[LimitedIndex, ...]
    indices: Callable[[GearPair, Any, Any], tuple[Any, ...]]
    proportional: bool = False
    kind: str = "index values, not a rating"
    pressure_angle: bool = False
    relaxed: "Law | None" = None
    minimum_teeth: int = 1

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the limits."""
        return tuple(limit.name for limit in self.limits)

    def utilisations(
        self, pair: GearPair, torque: Any, speed: Any, allowable: Sequence[Any]
    ) -> dict[str, Any]:
        """Return every index over its limit, by name; allowable: the limits."""
        found = self.indices(pair, torque, speed)
        return {n: i / a for n, i, a in zip(self.names, found, allowable, strict=True)}

    def largest_utilisation(
        self, pair: GearPair, torque: Any, speed: Any, allowable: Sequence[float]
    ) -> Array:
        """Largest utilisation; at unit width the narrowest width of a proportional law."""
        found = tuple(self.utilisations(pair, torque, speed, allowable).values())
        return np.asarray(np.maximum.reduce(np.broadcast_arrays(*found)))

    def minimum_width(
        self,
        pair: GearPair,
        torque: Any,
        speed: Any,
        allowable: Sequence[float],
        ends: tuple[Array, Array],
    ) -> Array:
        """Return the narrowest face width [mm] (n,) that carries, between two ends; inf: none.

        pair: of any face width; ends (n,): the narrowest and the widest.
        """

        def carries(width: Array) -> Any:
            loaded = pair.of_width(width)
            return self.largest_utilisation(loaded, torque, speed, allowable) <= 1.0 + ALLOWANCE

        narrowest, widest = np.maximum(ends[0], NARROW * ends[1]), ends[1]
        with np.errstate(all="ignore"):  # of widths of zero, where there is no choice
            found = np.where(carries(widest), widest, np.inf)
            low = narrowest
            for _ in range(HALVINGS if np.any(narrowest < widest) else 0):
                middle = np.sqrt(low * np.minimum(found, widest))
                good = carries(middle)
                low, found = np.where(good, low, middle), np.where(good, middle, found)
            return np.where(carries(narrowest), narrowest, found)


RATED = Law("ratings", (), lambda pair, torque, speed: (), kind="ratings")  # of stages with options
