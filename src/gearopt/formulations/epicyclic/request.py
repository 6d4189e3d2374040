"""What is asked of the teeth of a planetary train, and how far numbers of teeth meet it.

Lengths are in modules of the first step; planets of both steps have one centre distance. Teeth are
columns of whole numbers, of rings positive, in the order of the gears of an arrangement.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose
from gearopt.physics.planetary import assembly, willis
from gearopt.physics.planetary.willis import Use

SIMPLE, STEPPED, WOLFROM, COUPLED = "simple", "stepped", "wolfrom", "coupled"
GEARS = {  # of every arrangement
    SIMPLE: ("sun", "planet", "ring"),
    STEPPED: ("sun", "planet1", "planet2", "ring"),
    WOLFROM: ("sun", "planet1", "ring1", "planet2", "ring2"),
    COUPLED: ("sun1", "planet1", "ring1", "sun2", "planet2", "ring2"),
}
SETS = {  # places in GEARS of the sun, its planet, the ring's planet and the ring of every set
    SIMPLE: ((0, 1, 1, 2),),
    STEPPED: ((0, 1, 2, 3),),
    WOLFROM: ((0, 1, 1, 2), (0, 1, 3, 4)),
    COUPLED: ((0, 1, 1, 2), (3, 4, 4, 5)),
}
FIRST = {SIMPLE: 3, STEPPED: 2, WOLFROM: 3, COUPLED: 3}  # gears that are chosen first
ERROR, LOSS, RING = "ratio_error", "loss", "ring_teeth"  # objectives
TOLERANCE, EFFICIENCY, ASSEMBLY = "ratio_tolerance", "minimum_efficiency", "assembly"
NEIGHBOURS, DIFFERENCE = "neighbour_clearance", "ring_minus_planet"
COAXIAL = "equal_centre_distances"
ADDENDUM = 1.0  # module, of all gears
Columns = Sequence[Any]


@dataclass(frozen=True)
class Request:
    """A train whose teeth are sought.

    teeth: range of every gear. planets: how many, of each set of planets. losses: efficiencies of
    sun's and ring's mesh of each set of `use`. ratio, tolerance (relative), efficiency: None where
    nothing is asked. difference: least z_r - z_p of a ring and its planet. clearance: least gap
    between tip circles of neighbours [modules]. coaxial: teeth by which z_s + z_p and z_r - z_p may
    differ, which profile shifts then make up for. equal: whether planets are spaced equally.
    modules: that of the second step over that of the first. without: limits that are left out.
    """

    arrangement: str
    use: Use
    teeth: tuple[tuple[int, int], ...]
    planets: tuple[int, ...]
    losses: tuple[tuple[Fraction, Fraction], ...]
    goal: str
    ratio: Fraction | None = None
    tolerance: Fraction | None = None
    efficiency: Fraction | None = None
    difference: int = 10
    clearance: Fraction = Fraction(1, 2)
    coaxial: int = 0
    equal: bool = True
    modules: Fraction = Fraction(1)
    without: tuple[str, ...] = ()

    @property
    def gears(self) -> tuple[str, ...]:
        """Names of the gears."""
        return GEARS[self.arrangement]

    def sets(self, z: Columns) -> list[tuple[Any, ...]]:
        """Teeth of sun, its planet, the ring's planet and ring of every set."""
        return [tuple(z[k] for k in places) for places in SETS[self.arrangement]]

    def module(self, k: int) -> float:
        """Module of the k-th gear over that of the first."""
        second = {STEPPED: 2, WOLFROM: 3}.get(self.arrangement, len(self.gears))
        return float(self.modules) if k >= second else 1.0

    def ratio_parts(self, z: Columns) -> tuple[Any, Any]:
        """The ratio as whole numbers."""
        return willis.ratio_parts(self.use, willis.set_teeth(self.sets(z)))

    def error(self, z: Columns) -> Any:
        """|i/u - 1| in doubles; infinite where input or output cannot turn, 0 if none is asked."""
        above, below = self.ratio_parts(z)
        off: Any = 0.0
        if self.ratio is not None:
            with np.errstate(all="ignore"):
                u, v = float(self.ratio.numerator), float(self.ratio.denominator)
                off = abs((above * v - below * u) / (below * u))
        return choose((above == 0) | (below == 0), np.inf, off)

    def eta(self, z: Columns) -> Any:
        """Efficiency in doubles; 0 of a train that locks itself or has no ratio."""
        parts = [(1.0 * a, 1.0 * b) for a, b in willis.set_teeth(self.sets(z))]
        losses = [(float(sun), float(ring)) for sun, ring in self.losses]
        return willis.efficiency(self.use, parts, losses)

    def exact_ratio(self, teeth: Sequence[int]) -> Fraction | None:
        """Ratio of one train; None where input or output cannot turn."""
        above, below = self.ratio_parts(teeth)
        return Fraction(above, below) if above and below else None

    def exact_eta(self, teeth: Sequence[int]) -> Fraction:
        """Efficiency of one train that has a ratio; 0 where it locks itself."""
        return willis.flow(self.use, self.sets(teeth), self.losses).efficiency

    def places(self, z: Columns) -> list[Any]:
        """Places of planets in a turn, of each carrier; where they fit both rings, of two."""
        counts = [assembly.places(*teeth) for teeth in self.sets(z)]
        return [np.gcd(*counts)] if self.arrangement == WOLFROM else counts

    def neighbours(self, z: Columns) -> list[tuple[Any, Any]]:
        """Distance of neighbours' axes and tip diameter of planets [modules], of each carrier."""
        known = []
        for k, (n, count) in enumerate(zip(self.planets, self.places(z), strict=True)):
            spacing = 1.0 / n if self.equal else assembly.least_spacing(count, n)
            apart = assembly.neighbour_distance(0.5 * (z[3 * k] + z[3 * k + 1]), spacing)
            here = self.sets(z) if self.arrangement != COUPLED else [self.sets(z)[k]]
            tips = z[3 * k + 1] + 2.0 * ADDENDUM
            for _, _, second, _ in here:
                tips = np.maximum(tips, (second + 2.0 * ADDENDUM) * self.module(3))
            known.append((apart, tips))
        return known

    def apart(self, z: Columns) -> Any:
        """Teeth by which z_s + z_p and z_r - z_p of one module differ, the most of all sets."""
        ends = (place[3] for place in SETS[self.arrangement])
        sums = [
            abs(r - q - (s + p) / self.module(k))
            for k, (s, p, q, r) in zip(ends, self.sets(z), strict=True)
        ]
        return reduce(np.maximum, sums)

    def used(self, z: Columns) -> dict[str, Any]:
        """Utilisation of every limit that is asked, at most 1 where it is met."""
        used: dict[str, Any] = {}
        if self.tolerance is not None:
            used[TOLERANCE] = self.error(z) / float(self.tolerance)
        if self.efficiency is not None:
            with np.errstate(divide="ignore"):
                used[EFFICIENCY] = float(self.efficiency) / self.eta(z)
        if self.equal:
            rest = [p % n / n for p, n in zip(self.places(z), self.planets, strict=True)]
            used[ASSEMBLY] = _beyond(reduce(np.maximum, rest), 0.0)
        gap = float(self.clearance) - assembly.SAME
        used[NEIGHBOURS] = reduce(
            np.maximum, [(tips + gap) / np.maximum(a, 1e-9) for a, tips in self.neighbours(z)]
        )
        least = reduce(np.minimum, [r - q for _, _, q, r in self.sets(z)])
        used[DIFFERENCE] = self.difference / np.maximum(least, 0.5)
        used[COAXIAL] = _beyond(self.apart(z), self.coaxial + assembly.SAME)
        return {name: value for name, value in used.items() if name not in self.without}

    def goal_of(self, z: Columns) -> Any:
        """Objective in doubles; infinite where input or output cannot turn."""
        error = self.error(z)
        if self.goal == ERROR:
            return error
        largest = reduce(np.maximum, [r for *_, r in self.sets(z)])
        goal = 1.0 - self.eta(z) if self.goal == LOSS else 1.0 * largest
        return choose(error < np.inf, goal, np.inf)

    def key(self, teeth: Sequence[int]) -> tuple[Any, int, tuple[int, ...]] | None:
        """Objective, all teeth and teeth of a train, exactly; None where it breaks a limit.

        The limits of whole numbers and of the gap are as `used` has them.
        """
        ratio, asked = self.exact_ratio(teeth), self.ratio
        if ratio is None:
            return None
        error = abs(ratio / asked - 1) if asked else Fraction(0)
        most = None if TOLERANCE in self.without else self.tolerance
        least = None if EFFICIENCY in self.without else self.efficiency
        eta = Fraction(1) if least is None and self.goal != LOSS else self.exact_eta(teeth)
        if (most is not None and error > most) or (least is not None and eta < least):
            return None
        ring = max(r for *_, r in self.sets(teeth))
        return {ERROR: error, LOSS: 1 - eta, RING: ring}[self.goal], sum(teeth), tuple(teeth)


def _beyond(value: Any, limit: float) -> Any:
    """Utilisation of a limit that is met or not: 0, or more than 1."""
    return choose(value > limit, 1.0 + value - limit, 0.0)
