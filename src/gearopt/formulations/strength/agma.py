"""AGMA 2001 as a standard of rated stages: at one power a slower, stronger torque is the worse one.

The load grows with the torque T, K_v falls no faster than T^-0.5, what life factors give grows no
faster than T^0.148. All else is constant for a given pair and width.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from gearopt.formulations.strength import agma_smooth
from gearopt.formulations.strength.agma_cells import needed
from gearopt.formulations.strength.agma_floor import AgmaFloor, agma_floor
from gearopt.formulations.strength.cells import Cells
from gearopt.formulations.strength.standard import Box, Load, Posed, Smooth, table_of
from gearopt.formulations.strength.use.agma import (
    AgmaRow,
    AgmaWay,
    agma_border,
    agma_nominal,
    agma_use,
)
from gearopt.formulations.strength.virtual import Strength, may_be_best
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.agma import factors
from gearopt.physics.agma.batch import (
    MODES,
    rate_rows,
    safeties,
    spectrum_rows,
    spectrum_safeties,
)
from gearopt.physics.agma.rating_factors import (
    Case,
    Practice,
    Steel,
    computed,
    life_curves,
)
from gearopt.physics.agma.table import FactorTable, factor_table
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import Operation

BARE = {"I": 1.0, "J": (1.0, 1.0), "K_m": 1.0, "K_s": (1.0, 1.0)}  # of rows, for `agma_use`
UNIT = GearPair.of_teeth(1.0, 20.0, 20.0, 1.0)  # on which strengths of steels do not depend


@dataclass(frozen=True)
class Agma:
    """The rating of stages made in one way by AGMA 2001.

    operation: its overload, temperature, reliability and contacts count. blanks: of pinion and
    wheel, for K_B. given: as of `agma.rating.rate`. rivals: other ways of making them; of all of
    them `rows` then has every strength at its best.
    """

    loads: tuple[Load, ...]
    operation: Operation
    steels: tuple[Steel, Steel]
    practice: Practice
    blanks: tuple[Blank, Blank] = (SOLID, SOLID)
    given: Mapping[str, Any] = field(default_factory=dict)
    suffix: str = ""
    monotone: bool = True
    rivals: tuple["Agma", ...] = ()

    def case(
        self, pair: GearPair, torque: Any, speed: Any, given: Mapping[str, Any], level: int = 0
    ) -> Case:
        """Case of a level of load with the given factors."""
        operation = self.loads[level].of(self.operation, torque, speed)
        return Case(pair, operation, self.steels, self._practice(pair), {**given, **self.given})

    def _practice(self, pair: GearPair) -> Practice:
        rows = zip(self.blanks, pair.gears, strict=True)
        first, second = (blank.backup(gear) for blank, gear in rows)
        return replace(self.practice, backup=(first, second))

    def safeties(self, pair: GearPair, torque: Any, speed: Any) -> tuple[Any, Any, Any, Any]:
        """Return S_F1, S_F2, S_H1, S_H2; NaN where AGMA 908 refuses the pair."""
        operations = [load.of(self.operation, torque, speed) for load in self.loads]
        made = self.steels, self._practice(pair), self.given
        if len(operations) == 1:
            ratings = rate_rows(pair, operations[0], *made)
        else:
            ratings = spectrum_rows(pair, operations, *made)
        return (*ratings.bending, *ratings.contact)

    def root_balance(self, pair: GearPair, speed: Any) -> Any:
        """Return S_F1/S_F2 of pairs (n,) under the first load, whatever the torque.

        Of helical gears that of an overlap ratio above 1, K_s of b = d1. speed [rad/s] of the
        pinion, by which the life factors count.
        """
        table = self.prepared(pair)
        bending = table.low[1:] if table.spur else table.high[1:]
        wide = pair.of_width(pair.pinion.reference_diameter)
        safety = safeties(self.case(wide, 1.0, speed, {"K_m": 1.0}), 1.0, bending)
        return safety[0] / safety[1]

    def choices(self, helical: bool) -> tuple[str, ...]:
        """Return the regimes of which one is fixed beforehand in the smooth form."""
        return agma_smooth.REGIMES[helical]

    def smooth(
        self, pair: GearPair, torque: Any, speed: Any, choice: str, unknown: dict[str, Any]
    ) -> Smooth:
        """Return the rating in a regime, without branches; unknown: by name of `unknowns`."""
        return agma_smooth.smooth(self, pair, torque, speed, choice, unknown)

    @property
    def unknowns(self) -> dict[str, tuple[float, float, bool]]:
        """Return the ends of the unknowns of the smooth form, and whether they are log."""
        angle = 0.01, 0.5 * np.pi, False
        return dict(zip(agma_smooth.UNKNOWNS, (angle, angle, (1.0, 100.0, True)), strict=True))

    def guess(self, pair: GearPair, choice: str) -> dict[str, float]:
        """Return the unknowns of a pair of floats in a regime."""
        return agma_smooth.guess(self, pair, choice)

    def refined(self, pair: GearPair, choice: str) -> tuple[str, ...]:
        """Return choices near a pair of floats that are closer to the exact rating."""
        return agma_smooth.branches(pair, choice)

    def floor(self, box: Box, choice: str) -> AgmaFloor | None:
        """Lower bounds of the used load capacity, as posynomials; None where there are none."""
        return agma_floor(self, box, choice)

    @property
    def thinnest_ring(self) -> float:
        """s_R/m_n up to which no ring is rated: K_B takes every rim."""
        return 0.0

    @property
    def steps(self) -> dict[str, tuple[float, ...]]:
        """Sizes [mm] at which a rating jumps, by name of `Cells`: none."""
        return {}

    def needed(self, cells: Cells, safety: tuple[float, float]) -> tuple[Any, Any]:
        """Return the least d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending."""
        return needed(self, cells, safety)

    def best_with(self, rivals: Sequence[Self]) -> Self | None:
        """Return the virtual way with every strength at its best; None: they differ in more."""
        alike = all(replace(rival, steels=self.steels) == self for rival in rivals)
        return replace(self, rivals=tuple(rivals)) if alike else None

    @cached_property
    def strongest_ways(self) -> tuple["Agma", ...]:
        """Return ways of which one is the strongest in every mode."""
        if not self.rivals:
            return (self,)
        every = [replace(self, rivals=()), *self.rivals]
        every.sort(key=lambda way: way.steels[0] != way.steels[1])
        chosen: dict[int, Agma] = {}
        for contact, k in MODES:
            for n in may_be_best([way._strength_of(k, contact) for way in every]):
                chosen[n] = every[n]
        return tuple(chosen.values())

    def _strength_of(self, k: int, contact: bool) -> Strength:
        """Strength of a gear, to compare with that of rivals."""
        case = Case(UNIT, self.operation, self.steels, self.practice, self.given)
        curve, base = life_curves(case, contact)[k], computed(case, "s_ac" if contact else "s_at")
        stress = base.value[k] if isinstance(base.value, tuple) else base.value
        if not contact:
            return Strength(curve, (), stress)
        law = computed(case, "C_p").value, curve
        if k == 0 or self.steels[1].kind != "through-hardened" or "C_H" in self.given:
            return Strength(law, (), stress)
        return Strength(law, self.steels, stress, factors.LARGEST_HARDNESS_RATIO)

    @cached_property
    def way(self) -> AgmaWay:
        """Return the numbers of it that `agma_use` takes."""
        made, given = self.practice, self.given
        shares = 0.8 if made.crowned else 1.0, 1.0 if made.offset < 0.175 else 1.1
        return AgmaWay(
            1.0 if "I" in given else math.nan,
            1.0 if "J" in given else math.nan,
            1.0 if "K_m" in given else math.nan,
            made.size and "K_s" not in given,
            factors.ALIGNMENT[made.curve],
            (*shares, 0.8 if made.adjusted else 1.0),
        )

    def like(self, other: Any) -> bool:
        """Return whether `prepared` of another standard is the same."""
        return isinstance(other, Agma) and other.practice.load == self.practice.load

    def prepared(self, pair: GearPair) -> FactorTable:
        """Return the geometry factors of pairs (n,) whatever their width."""
        return factor_table(pair, self.practice.load)

    def rows(
        self,
        prepared: FactorTable,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
    ) -> "AgmaRows":
        """Return rows at the smaller torque, which is the least loaded one."""
        return self._rows(prepared, pair, torque[0], speed[0], safety, BARE)

    def nominal(
        self,
        prepared: FactorTable,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
        widths: tuple[Array, Array],
    ) -> Array:
        """Least widths [mm] over the torque [N mm] without K_v; lives at the slow end."""
        given = {**BARE, "K_v": 1.0}
        rows = self._rows(prepared, pair, torque[1], speed[1], safety, given)
        with np.errstate(invalid="ignore"):
            most = np.asarray(agma_nominal(rows.row, self.way, *widths) / torque[1])
        return np.where(np.isnan(most), np.inf, most)

    def _rows(
        self,
        prepared: FactorTable,
        pair: GearPair,
        torque: Array,
        speed: Array,
        safety: tuple[float, float],
        given: Mapping[str, Any],
    ) -> "AgmaRows":
        """Rows at a torque and speed, with given factors."""
        unit = pair.of_width(1.0)
        places = range(len(self.loads))
        every = []
        for way in self.strongest_ways:
            cases = [way.case(unit, torque, speed, given, place) for place in places]
            if len(cases) == 1:
                every.append(safeties(cases[0], 1.0, (1.0, 1.0)))
            else:
                every.append(spectrum_safeties(cases, 1.0, (1.0, 1.0)))
        best = [np.maximum.reduce(values) for values in zip(*every, strict=True)]
        used = [safety[0] / best[0], safety[0] / best[1]]
        used += [(safety[1] / best[2]) ** 2, (safety[1] / best[3]) ** 2]
        lengths = [
            gear.reference_diameter / gear.teeth * factors.lewis_form(gear.teeth) ** 0.5
            for gear in pair.gears
        ]
        columns = (*used, pair.working_diameters[0], *lengths)
        return AgmaRows(self, prepared, table_of(columns, len(torque)))


@dataclass(frozen=True)
class AgmaRows:
    """Rows of pairs (n,).

    columns (7, n): what is used at K_m = K_s = b = I = J = 1 by bending and by contact of pinion
    and wheel; working pitch diameter of the pinion [mm]; transverse module times the root of the
    Lewis form factor of both [mm].
    """

    standard: Agma
    table: FactorTable
    columns: Array

    @np.errstate(invalid="ignore")  # of spur gears among others, of no overlap
    def used(self, low: Array, high: Array) -> Array:
        """Lower bound of the greatest part that is used: of load, so of S_H squared."""
        return np.asarray(agma_use(self.row, self.standard.way, low, high, low is high))

    @cached_property
    def row(self) -> AgmaRow:
        """The numbers of the pairs."""
        at = self.table
        kind = at.contact, at.axial, at.cosine
        return AgmaRow(at.low, at.slope, at.high, *kind, *self.columns)

    def border(self, width: Array) -> Array:
        """Return the width of m_F = 1 for those up to it."""
        return np.asarray(agma_border(self.row, self.standard.way, width))

    @property
    def posed(self) -> Posed:
        """Kernel and numbers of `widths.first_width`."""
        at = self.row
        numbers = *at.low, at.slope, *at.high, *at[3:6], *self.columns
        return "agma_widths", (table_of(numbers, self.columns.shape[1]), self.standard.way, True)

    def take(self, place: Any) -> "AgmaRows":
        """Return some of the rows."""
        return AgmaRows(self.standard, self.table.take(place), self.columns[:, place])
