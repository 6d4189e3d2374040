"""Ratings as limits: ways of making the gears of a stage, and the standards that rate them.

A stage may choose between options, each of one material a gear, accuracy and so on. An option is
rated by one standard or two; a standard gives safety factors of any pair, and rows of pairs whose
face widths are sought (`widths`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from gearopt.formulations.strength.cells import Cells
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import Operation

MODES = ("pinion_bending", "wheel_bending", "pinion_contact", "wheel_contact")
Posed = tuple[str, tuple[Any, ...]]
MIDWAY = "The ratings take each pinion midway between its bearings"
REFUSED = 1e9  # utilisation of pairs that a standard refuses to rate


@dataclass(frozen=True)
class Load:
    """One level of a drive's duty: power and input speed over the full ones, hours."""

    hours: float
    power: float = 1.0
    speed: float = 1.0

    def of(self, operation: Operation, torque: Any, speed: Any) -> Operation:
        """Operation of a pair at this level; torque [N mm] and speed [rad/s] of full load."""
        power = self.power * torque * speed
        return replace(operation, power=power, pinion_speed=self.speed * speed, hours=self.hours)


def together(loads: Sequence[Load]) -> Load:
    """One level, or all levels as columns (levels, 1) of numbers."""
    if len(loads) == 1:
        return loads[0]
    table = np.array([(load.hours, load.power, load.speed) for load in loads], float)
    return Load(*table.T[:, :, None])


def under_each_load(standard: Any) -> tuple[Any, ...]:
    """A standard, with its rivals, under each of its loads alone."""
    return tuple(
        replace(
            standard,
            loads=(load,),
            rivals=tuple(replace(r, loads=(load,)) for r in standard.rivals),
        )
        for load in standard.loads
    )


def table_of(columns: Sequence[Any], count: int) -> Array:
    """Return a table of columns (n,) or numbers."""
    table = np.empty((len(columns), count))
    for place, column in enumerate(columns):
        table[place] = column
    return table


class Rows(Protocol):
    """Gear pairs (n,) at torques, whose face widths are sought."""

    def used(self, low: Array, high: Array) -> Array:
        """Bound of the part of the load capacity used at widths from low to high.

        Load over what gives the safety factors asked for: above 1 no width between them carries.
        Where both are one, at most 1 where it carries and there alone; exact but under several
        levels of load. low, high (n,) [mm], with no `border` between them.
        """

    def border(self, width: Array) -> Array:
        """Return the next width [mm] above which another law holds; inf: none."""

    @property
    def posed(self) -> "Posed | None":
        """Name of the kernel that finds first widths, and the numbers it takes; None: none."""

    def take(self, place: Any) -> "Rows":
        """Return some of the rows."""


class Standard(Protocol):
    """A standard that rates a pair made in one way; frozen, so that equal stages are equal."""

    @property
    def suffix(self) -> str:
        """Ending of the names of its limits, "" or "_iso"."""

    @property
    def monotone(self) -> bool:
        """Whether at one power the used capacity rises with the torque, for every width."""

    def safeties(self, pair: GearPair, torque: Any, speed: Any) -> tuple[Any, Any, Any, Any]:
        """Return S_F1, S_F2, S_H1, S_H2 (of stress); NaN where the standard refuses the pair.

        They are over what the standard asks beyond the stage. torque [N mm] and speed [rad/s] of
        the pinion; arrays of one shape or floats.
        """

    def root_balance(self, pair: GearPair, speed: Any) -> Any:
        """Return S_F1/S_F2 of pairs (n,); speed [rad/s] of the pinion."""

    @property
    def unknowns(self) -> dict[str, tuple[float, float, bool]]:
        """Return the ends of the unknowns of `smooth` by name, and whether they are log."""

    def choices(self, helical: bool) -> tuple[str, ...]:
        """Regimes of which `smooth` needs one fixed beforehand."""

    def refined(self, pair: GearPair, choice: str) -> tuple[str, ...]:
        """Return choices near a pair of floats that are closer to the exact rating."""

    def guess(self, pair: GearPair, choice: str) -> dict[str, float]:
        """Return the unknowns of a pair of floats."""

    def smooth(
        self, pair: GearPair, torque: Any, speed: Any, choice: str, unknown: dict[str, Any]
    ) -> "Smooth":
        """Return the rating without branches, of casadi scalars or floats."""

    @property
    def steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes [mm] at which a rating may jump, by name of `Cells`."""

    def needed(self, cells: Cells, safety: tuple[float, float]) -> tuple[Any, Any]:
        """Return the least d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending [1/MPa].

        Of any design in a cell that has S_F and S_H; exact where the cell is a point.
        """

    def floor(self, box: "Box", choice: str) -> "Floor | None":
        """Lower bounds of the used capacity over a box; None where there are none."""

    def best_with(self, rivals: Sequence[Any]) -> "Standard | None":
        """Return a virtual way of making the gears whose `rows` use no more than those of any way.

        rivals: the other ways; None where there is none.
        """

    def like(self, other: Any) -> bool:
        """Whether `prepared` of another standard returns the same."""

    def prepared(self, pair: GearPair) -> Any:
        """Numbers of pairs (n,) that `rows` takes, of any load and width."""

    def rows(
        self,
        prepared: Any,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
    ) -> Rows:
        """Return rows of pairs at torques between two ends, at the power of the first.

        speed: at the two ends, the first of which is the faster one.
        """

    def nominal(
        self,
        prepared: Any,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
        widths: tuple[Array, Array],
    ) -> Array:
        """Return the least face widths over the torque [mm/(N mm)] by nominal stresses.

        No width between two ends [mm] carries a torque between the ends of `rows` below this times
        the torque; inf: none carries any.
        """


@dataclass(frozen=True)
class Option:
    """One way of making the gears of a stage: its standards, and its name among others.

    Of pinion and wheel: densities [t/mm3], or None for that of the drive; prices of a kilogram,
    heat treatment included, and the parts of them that are its; prices of a metre of teeth cut;
    names of materials. idler: teeth of a gear between them, 0: none. planets: how planets or a
    ring make a stage of it (`formulations.drive.planetary`), None: it is a pair; then what is of
    pinion and wheel is of sun, planets and ring, or of pinion and ring.
    """

    standards: tuple[Standard, ...]
    words: str = ""
    densities: tuple[float | None, ...] = (None, None)
    prices: tuple[float, ...] = (1.0, 1.0)
    treatment_prices: tuple[float, ...] = (0.0, 0.0)
    cutting_prices: tuple[float, ...] = (0.0, 0.0)
    materials: tuple[str, ...] = ("", "")
    idler: int = 0
    planets: Any = None

    def meshes(self, pair: GearPair) -> tuple[GearPair, ...]:
        """The pairs in mesh: two where an idler or planets are between pinion and wheel."""
        if self.planets is not None:
            meshes: tuple[GearPair, ...] = self.planets.meshes(pair)
            return meshes
        ends: tuple[Any, Any] = self.standards[0], self.standards[-1]
        return tuple(one.mesh(pair) for one in ends) if self.idler else (pair,)

    def cutting(self, pair: GearPair) -> Any:
        """Cost of cutting the teeth of a pair: a metre of them is z b = 1000 mm, b of each."""
        rows = zip(self.cutting_prices, pair.gears, strict=True)
        return sum(1e-3 * price * gear.teeth * gear.width for price, gear in rows if price)

    def cheapest_with(self, rivals: Sequence["Option"], density: float | None) -> "Option":
        """Return a virtual option as light and as cheap as the best of all, rated as this one.

        rivals: the others; density: of gears without one of their own.
        """
        densities, prices, cutting = [], [], []
        for k in range(len(self.densities)):
            heavy = [rho for way in (self, *rivals) if (rho := way.densities[k] or density)]
            densities.append(min(heavy, default=None))
            prices.append(min(way.prices[k] for way in (self, *rivals)))
            cutting.append(min(way.cutting_prices[k] for way in (self, *rivals)))
        return replace(
            self,
            densities=tuple(densities),
            prices=tuple(prices),
            cutting_prices=tuple(cutting),
            idler=min(way.idler for way in (self, *rivals)),
            planets=self.planets and self.planets.lightest_with(way.planets for way in rivals),
        )

    def strongest_with(self, rivals: Sequence["Option"]) -> "Option | None":
        """Return this option, but rated as a virtual one that uses no more than any; or None."""
        rated = zip(*(way.standards for way in (self, *rivals)), strict=True)
        best = tuple(first.best_with(rest) for first, *rest in rated)
        return None if None in best else replace(self, standards=best)

    def utilisations(
        self, pair: GearPair, torque: Any, speed: Any, safety: Sequence[Any]
    ) -> dict[str, Any]:
        """Return required over actual safety factors by name; safety: S_F and S_H asked for."""
        found = {}
        asked = safety[0], safety[0], safety[1], safety[1]
        for standard in self.standards:
            made = standard.safeties(pair, torque, speed)
            for mode, wanted, actual in zip(MODES, asked, made, strict=True):
                with np.errstate(divide="ignore", invalid="ignore"):
                    used = wanted / np.asarray(actual)
                found[f"{mode}{standard.suffix}"] = np.where(used < REFUSED, used, REFUSED)[()]
        return found


@dataclass(frozen=True)
class IndexRows:
    """Rows of a proportional law beside ratings: narrowest widths (n,) [mm]."""

    widths: Array

    def used(self, low: Array, high: Array) -> Array:
        """Lower bound of the part of the load capacity used at widths up to the larger one."""
        return np.asarray(self.widths / high)

    def border(self, width: Array) -> Array:
        """Width [mm] above which another law holds: inf, for a proportional law has none."""
        return np.full(len(width), np.inf)

    @property
    def posed(self) -> None:
        """No kernel: the first step leads to the width."""

    def take(self, place: Any) -> "IndexRows":
        """Return some of the rows."""
        return IndexRows(self.widths[place])


@dataclass(frozen=True)
class Box:
    """Ranges of the designs that a bound has to hold for.

    teeth: least and most of the pinion; ratio: least and most; speed [rad/s] of the pinion, least
    and most; widest: largest face width [mm], inf: unknown; toothing: of the gears.
    """

    teeth: tuple[float, float]
    ratio: tuple[float, float]
    speed: tuple[float, float]
    widest: float
    toothing: Any


class Floor(Protocol):
    """Lower bounds of the used load capacity, as posynomials."""

    def utilisations(self, pair: GearPair, torque: Any, speed: Any, safety: Any) -> dict[str, Any]:
        """Return the bounds by name, at required safety factors (S_F, S_H)."""

    def limits(self, pair: GearPair) -> dict[str, Any]:
        """Limits that keep to the regime chosen beforehand."""


@dataclass(frozen=True)
class Smooth:
    """A rating without branches, as terms of a problem.

    safeties: S_F1, S_F2, S_H1, S_H2; limits: rows by name that keep to what was chosen beforehand;
    defines and equal: rows of the unknowns.
    """

    safeties: tuple[Any, Any, Any, Any]
    limits: dict[str, Any]
    defines: dict[str, Any]
    equal: dict[str, Any]
