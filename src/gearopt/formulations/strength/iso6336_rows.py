"""Rows of pairs by ISO 6336: their columns, and what is used of them under levels of load."""

import math
from collections.abc import Iterable
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from gearopt.formulations.strength.standard import Posed, table_of
from gearopt.formulations.strength.use.iso6336 import (
    IsoRow,
    IsoWay,
    iso_border,
    least_part,
    nominal_part,
    refused,
)
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.iso6336 import contact_factors, load_factors, running_in
from gearopt.physics.iso6336.accuracy import DIAMETERS, WIDTHS, slopes_1995
from gearopt.physics.iso6336.case import life_curve
from gearopt.physics.iso6336.curves import ROUNDING, Curve
from gearopt.physics.rating import Level, damage

if TYPE_CHECKING:
    from gearopt.formulations.strength.iso6336 import Iso6336

Columns = dict[str, Any]
AT_ENDS = "force", "pace", "speed", "pitch", "form", "deviation"  # of the torques
MODES = ("bending", 0), ("bending", 1), ("contact", 0), ("contact", 1)
MINER_POWERS = {"bending": 8.0, "contact": 6.0}  # of the load in Miner's sum, about
FAR = 1.05  # of what a level alone uses: more need not be known closely
PAST = 1.0 + 1e-13  # a jump of Miner's sum is passed by this factor


def way_of(standard: "Iso6336") -> IsoWay:
    """Return the numbers of a standard that `least_part` takes."""
    given, practice = standard.given, standard.practice
    names = IsoWay._fields[: IsoWay._fields.index("Z_BD0")]
    newer, ranged = practice.edition == "2019", practice.tolerances == "1995"
    modified = contact_factors.PROFILE_MODIFICATIONS[practice.profile_modification] ** 0.5
    slopes = [slopes_1995(grade) if ranged else np.zeros((1, 1)) for grade in practice.grades]
    first, second = (np.ascontiguousarray(each) for each in slopes)  # of one type to kernels
    numbers: dict[str, Any] = {name: float(given.get(name, math.nan)) for name in names}
    z_bd = given.get("Z_BD", (math.nan, math.nan))
    numbers |= {"Z_BD0": float(z_bd[0]), "Z_BD1": float(z_bd[1])}
    return IsoWay(
        **numbers,
        Y_beta=float(given.get("Y_beta", math.nan)),
        newer=newer,
        shared=newer and "Y_F" not in given,
        modified=modified if newer else 1.0,
        relieved=load_factors.HELIX_MODIFICATIONS[practice.helix_modification],
        light_ends=practice.helix_modification in load_factors.LIGHT_ENDS,
        wearing0=_wearing(standard.wearing[0]),
        wearing1=_wearing(standard.wearing[1]),
        any_load=bool(standard.rivals),
        grades=(float(practice.grades[0]), float(practice.grades[1])),
        ranged=ranged,
        slopes0=first,
        slopes1=second,
        diameters=np.array(DIAMETERS[1:-1]),
        widths=np.array(WIDTHS[1:-1] if ranged else ()),
    )


def _wearing(kinds: tuple[tuple[str, float], ...]) -> tuple[float, float, float]:
    """`IsoWay.wearing0` of families and sigma_Hlim [MPa]."""
    shares = {"tempered": 0.0, "cast": 0.0, "hard": 0.0}
    for family, limit in kinds:
        kind = running_in.kind(family)
        shares[kind] = max(shares[kind], 320.0 / limit if kind == "tempered" else 1.0)
    return shares["tempered"], shares["cast"], shares["hard"]


@dataclass(frozen=True)
class IsoRows:
    """Rows of pairs: columns by name, of all levels (n,), of each (levels, n).

    contact (eps_alpha), virtual (eps_alphan), singles (Z_B, Z_D of spur gears), overlap (the least
    eps_beta that is rated), axial pitch, stiffness c' from 100 N/mm on, tooth depth, both
    diameters; at both ends of the torques force (F_t K_A K_gamma), pace (omega z1 sqrt(m_red)),
    speed v, deviations after running-in (pitch f_pb, form f_falpha, the one of K_Halpha);
    bending K of the shaft, excess of both roots over the mesh [mm]; contact_used and bending_used
    of both gears: what is used at W = Z_eps = Z_BD = 1 and at W = f_eps = Y_beta = 1, b_F = b. Of
    several levels these are stresses (of contact squared) times the safety factors asked for;
    contact0_0 and so on are strengths at the knots of life curves, cycles0 and cycles1 least
    numbers of cycles, contact0_own and contact0_all strengths (squared, of contact) at these of the
    level and of all levels.
    """

    standard: "Iso6336"
    columns: Columns

    @np.errstate(invalid="ignore", divide="ignore", over="ignore")
    def used(self, low: Array, high: Array) -> Array:
        """Lower bound of the greatest part that is used: of load, so of S_H squared.

        Of several levels of load a number on the same side of 1.
        """
        at = self.row
        same = low is high and at.force0 is at.force1
        parts = least_part(at, self.standard.way, low, high, same)
        single = len(self.standard.loads) == 1
        most = np.maximum.reduce(parts) if single else self._spectrum(list(parts))
        return np.where(refused(at, high) | np.isnan(most), np.inf, most)

    @np.errstate(invalid="ignore", divide="ignore", over="ignore")
    def nominal(self, low: Array, high: Array) -> Array:
        """Least widths [mm] from low to high that the nominal load leaves at the first torque.

        Of several levels each has to be carried alone.
        """
        parts = nominal_part(self.row, self.standard.way, low, high)
        if len(self.standard.loads) > 1:
            parts = tuple(alone for alone, _ in self._ends(parts))
        most = np.maximum.reduce(parts)
        return np.where(refused(self.row, high) | np.isnan(most), np.inf, most)

    @cached_property
    def row(self) -> IsoRow:
        """The columns that all numbers of levels have."""
        return IsoRow(**{name: self.columns[name] for name in IsoRow._fields})

    def _spectrum(self, parts: list[Any]) -> Any:
        """Number above 1 where Miner's sum of a mode is; parts: of a mode the stresses (levels, n).

        Near 1 it is continuous, so that secants on it find where it is 1.
        """
        ends = self._ends(parts)
        most = np.maximum.reduce([np.where(every <= 1.0, every, alone) for alone, every in ends])
        for part, (alone, every), mode in zip(parts, ends, MODES, strict=True):
            some = np.flatnonzero((most <= FAR) & (every > np.maximum(most, 1.0)))
            if len(some):
                used = self._together(part[:, some], alone[some], every[some], mode, some)
                most[some] = np.maximum(most[some], used)
        return most

    def _ends(self, parts: Iterable[Any]) -> list[list[Any]]:
        """What each mode uses by the worst level alone, and by it with the cycles of all."""
        return [
            [np.max(part / self.columns[f"{name}{k}_{end}"], axis=0) for end in ("own", "all")]
            for part, (name, k) in zip(parts, MODES, strict=True)
        ]

    def _together(self, part: Any, alone: Any, every: Any, mode: tuple[str, int], some: Any) -> Any:
        """Number above 1 where Miner's sum of some rows is, from `alone` to `every`.

        A power of the sum, but where the sum jumps: a level breaks a tooth at once, or begins to
        count at the endless end of its curve.
        """
        (name, k), standard = mode, self.standard
        curve = life_curve(standard.materials[k], standard.practice, name == "contact")
        values = [self.columns[f"{name}{k}_{j}"][..., some] for j in range(len(curve.cycles))]
        power, square = MINER_POWERS[name], 2.0 if name == "contact" else 1.0
        stress, cycles = part ** (1.0 / square), self.columns[f"cycles{k}"][:, some]
        levels = Level(cycles, Curve(curve.cycles, tuple(values)), stress)
        total = damage([levels]).sum(axis=0) ** (1.0 / power)
        total = np.minimum(np.maximum(total, alone), every)
        ends = values[0] * (1.0 + ROUNDING), values[-1] * (1.0 - ROUNDING)
        for used in chain.from_iterable(part / end**square for end in ends):
            near = np.flatnonzero((used - 1.0) * (used - total) < 0.0)
            if len(near):
                counts = used[near] > 1.0
                growth = used[near] ** (-1.0 / square) * np.where(counts, 1.0 / PAST, PAST)
                above = damage([levels.take((..., near))], growth).sum(axis=0) > 1.0
                total[near] = np.where(above != counts, used[near], total[near])
        return total

    def border(self, width: Array) -> Array:
        """Return the next width at which a refusal ends, K_v has other laws, or f_Hbeta a step."""
        with np.errstate(invalid="ignore"):  # of spur gears
            return np.asarray(iso_border(self.row, self.standard.way, width))

    @property
    def posed(self) -> Posed | None:
        """Kernel and numbers of `widths.first_width`; None: of levels of load."""
        if len(self.standard.loads) > 1:
            return None
        table = table_of(self.row, len(self.row.force0))
        return "iso_widths", (table, self.standard.way, self.row.force0 is self.row.force1)

    def take(self, place: Any) -> "IsoRows":
        """Return some of the rows."""
        return IsoRows(self.standard, taken(self.columns, place))


def taken(columns: Columns, place: Any) -> Columns:
    """Return some rows of columns; equal ends stay one array."""
    made: dict[int, Any] = {}
    for value in columns.values():
        if id(value) not in made:
            made[id(value)] = value[..., place]
    return {name: made[id(value)] for name, value in columns.items()}
