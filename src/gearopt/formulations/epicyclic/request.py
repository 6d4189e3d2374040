"""What is asked of the teeth of a planetary train, and how far numbers of teeth meet it.

Lengths are in modules of the first step; planets of both steps have one centre distance. Teeth are
columns of whole numbers, of rings positive, in the order of the gears of an arrangement.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
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
FIRST = {SIMPLE: 3, STEPPED: 2, WOLFROM: 3, COUPLED: 3}  # gears that are chosen first
ERROR, LOSS, RING = "ratio_error", "loss", "ring_teeth"  # objectives
TOLERANCE, EFFICIENCY, ASSEMBLY = "ratio_tolerance", "minimum_efficiency", "assembly"
NEIGHBOURS, DIFFERENCE, COAXIAL = "neighbours", "ring_minus_planet", "coaxial"
LIMITS = (TOLERANCE, EFFICIENCY, ASSEMBLY, NEIGHBOURS, DIFFERENCE, COAXIAL)
ADDENDUM = 1  # module, of all gears
NO_RATIO = np.inf  # error of a train whose input or output cannot turn
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

    def parts(self, z: Columns) -> list[tuple[Any, Any]]:
        """Teeth ratio r = b/a of every set as (a, b) in whole numbers."""
        if self.arrangement == SIMPLE:
            return [(z[0], z[2])]
        if self.arrangement == STEPPED:
            return [(z[0] * z[2], z[1] * z[3])]
        if self.arrangement == WOLFROM:
            return [(z[0], z[2]), (z[0] * z[3], z[1] * z[4])]
        return [(z[0], z[2]), (z[3], z[5])]

    def ratio_parts(self, z: Columns) -> tuple[Any, Any]:
        """Numerator and denominator of the ratio of input over output speed."""
        return willis.ratio_parts(self.use, self.parts(z))

    def error(self, z: Columns) -> Any:
        """|i/u - 1| in doubles; infinite where input or output cannot turn, 0 if none is asked."""
        above, below = self.ratio_parts(z)
        off: Any = 0.0
        if self.ratio is not None:
            with np.errstate(all="ignore"):
                rest = above * float(self.ratio.denominator) - below * float(self.ratio.numerator)
                off = abs(rest / (below * float(self.ratio.numerator)))
        return choose((above == 0) | (below == 0), NO_RATIO, off)

    def eta(self, z: Columns) -> Any:
        """Efficiency in doubles; 0 of a train that locks itself or has no ratio."""
        parts = [(1.0 * a, 1.0 * b) for a, b in self.parts(z)]
        losses = [(float(sun), float(ring)) for sun, ring in self.losses]
        return willis.efficiency(self.use, parts, losses)

    def exact_ratio(self, teeth: Sequence[int]) -> Fraction | None:
        """Ratio of one train; None where input or output cannot turn."""
        above, below = self.ratio_parts([*map(int, teeth)])
        return Fraction(above, below) if above and below else None

    def exact_eta(self, teeth: Sequence[int]) -> Fraction:
        """Efficiency of one train that has a ratio; 0 where it locks itself."""
        parts = [(Fraction(a), Fraction(b)) for a, b in self.parts([*map(int, teeth)])]
        return Fraction(willis.efficiency(self.use, parts, self.losses))

    def rings(self, z: Columns) -> list[tuple[Any, Any, Any]]:
        """Of every ring: its teeth, those of its planet, and z_s + z_p in its own module."""
        if self.arrangement == SIMPLE:
            return [(z[2], z[1], z[0] + z[1])]
        if self.arrangement == STEPPED:
            return [(z[3], z[2], (z[0] + z[1]) / self._step)]
        if self.arrangement == WOLFROM:
            return [(z[2], z[1], z[0] + z[1]), (z[4], z[3], (z[0] + z[1]) / self._step)]
        return [(z[2], z[1], z[0] + z[1]), (z[5], z[4], z[3] + z[4])]

    @property
    def _step(self) -> Any:
        """The ratio of modules, a whole number where it is 1."""
        return 1 if self.modules == 1 else float(self.modules)

    def places(self, z: Columns) -> list[Any]:
        """Places of planets in a turn, of each set of planets."""
        if self.arrangement == SIMPLE:
            return [assembly.places(*z)]
        if self.arrangement == STEPPED:
            return [assembly.places(z[0], z[1], z[3], z[2])]
        if self.arrangement == WOLFROM:
            return [assembly.places_of_two_rings(*z)]
        return [assembly.places(*z[:3]), assembly.places(*z[3:])]

    def gaps(self, z: Columns) -> list[Any]:
        """Gap between tip circles of neighbours, of each set of planets [modules]."""
        gaps = []
        for k, (n, count) in enumerate(zip(self.planets, self.places(z), strict=True)):
            spacing = 1.0 / n if self.equal else assembly.least_spacing(count, n)
            sun, planet = z[3 * k], z[3 * k + 1]
            tips = planet + 2.0 * ADDENDUM
            if self.arrangement in (STEPPED, WOLFROM):
                second = z[2 if self.arrangement == STEPPED else 3]
                tips = np.maximum(tips, (second + 2.0 * ADDENDUM) * float(self.modules))
            gaps.append(assembly.neighbour_gap(0.5 * (sun + planet), tips, spacing))
        return gaps

    def used(self, z: Columns) -> dict[str, Any]:
        """Utilisation of every limit that is asked, at most 1 where it is met."""
        used: dict[str, Any] = {}
        if self.tolerance is not None:
            used[TOLERANCE] = self.error(z) / float(self.tolerance)
        if self.efficiency is not None:
            with np.errstate(divide="ignore"):
                used[EFFICIENCY] = float(self.efficiency) / self.eta(z)
        rings, clearance = self.rings(z), float(self.clearance)
        if self.equal:
            rest = [p % n / n for p, n in zip(self.places(z), self.planets, strict=True)]
            used[ASSEMBLY] = 1.0 + _most(rest)
        lack = [
            choose(assembly.wide_enough(gap, clearance), 0.0, clearance - gap)
            for gap in self.gaps(z)
        ]
        used[NEIGHBOURS] = 1.0 + _most(lack)
        used[DIFFERENCE] = _most([self.difference / np.maximum(r - p, 0.5) for r, p, _ in rings])
        apart = [np.maximum(abs(r - p - c) - self.coaxial - 1e-9, 0.0) for r, p, c in rings]
        used[COAXIAL] = 1.0 + _most(apart)
        return {name: value for name, value in used.items() if name not in self.without}

    def goal_of(self, z: Columns) -> Any:
        """Objective in doubles; infinite where input or output cannot turn."""
        error = self.error(z)
        if self.goal == ERROR:
            return error
        if self.goal == LOSS:
            goal = 1.0 - self.eta(z)
        else:
            goal = 1.0 * _most([ring for ring, _, _ in self.rings(z)])
        return choose(error < NO_RATIO, goal, NO_RATIO)

    def key(self, teeth: Sequence[int]) -> tuple[Any, int, tuple[int, ...]] | None:
        """Objective, all teeth and teeth of a train, exactly; None where it breaks a limit.

        The limits of whole numbers and of the gap are as `used` has them.
        """
        ratio, asked = self.exact_ratio(teeth), self.ratio
        if ratio is None:
            return None
        error = abs(ratio / asked - 1) if asked else Fraction(0)
        least = None if EFFICIENCY in self.without else self.efficiency
        eta = Fraction(1) if least is None and self.goal != LOSS else self.exact_eta(teeth)
        if TOLERANCE not in self.without and self.tolerance is not None and error > self.tolerance:
            return None
        if least is not None and eta < least:
            return None
        rings = [ring for ring, _, _ in self.rings(teeth)]
        goal = {ERROR: error, LOSS: 1 - eta, RING: max(rings)}[self.goal]
        return goal, sum(teeth), tuple(int(z) for z in teeth)


def _most(values: Sequence[Any]) -> Any:
    most = values[0]
    for value in values[1:]:
        most = np.maximum(most, value)
    return most


def named(request: Request, teeth: Sequence[int]) -> Mapping[str, int]:
    """Teeth by the names of the gears."""
    return dict(zip(request.gears, teeth, strict=True))
