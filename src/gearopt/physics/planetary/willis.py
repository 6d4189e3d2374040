"""Speeds, torques and losses of one or two sets of sun, planets, ring and carrier in closed form.

Willis: n_s + r n_r = (1 + r) n_c, with r = z_r/z_s, of stepped planets z_p1 z_r/(z_s z_p2). Members
of two sets that turn together have one name. Two sets on the same planets are those of a Wolfrom
train (3K). Numbers may be floats, arrays or fractions; whole numbers stay whole. Source: R. Willis,
Principles of Mechanism (1841); losses by rolling power, as in Looman, Zahnradgetriebe, and Mueller,
Epicyclic Drive Trains. Tests hold it to the linear system of all meshes.
"""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import inf
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose

PLANETS = ("planets", "planets2")  # members: planets of the first and of the second set
ENDS = {  # of a set: the member that a motor drives and that of the load, by the one that is held
    "ring": ("sun", "carrier"),
    "sun": ("ring", "carrier"),
    "carrier": ("sun", "ring"),
}


@dataclass(frozen=True)
class Use:
    """Sets, each by the names of sun, ring and carrier, and which member does what.

    shared: both sets have the same planets.
    """

    sets: tuple[tuple[str, str, str], ...]
    source: str
    sink: str
    held: tuple[str, ...]
    shared: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """All members but the planets."""
        return tuple(dict.fromkeys(name for names in self.sets for name in names))

    @property
    def planets(self) -> tuple[str, ...]:
        """The planets of every set."""
        return PLANETS[:1] * len(self.sets) if self.shared else PLANETS[: len(self.sets)]

    @property
    def roles(self) -> dict[str, str]:
        """What each member but the planets does."""
        roles = dict.fromkeys(self.free, "free") | dict.fromkeys(self.held, "fixed")
        return roles | {self.source: "input", self.sink: "output"}

    @property
    def free(self) -> tuple[str, ...]:
        """Members without a torque from outside."""
        return tuple(n for n in self.names if n not in (self.source, self.sink, *self.held))


def simple_set(held: str, increasing: bool = False) -> Use:
    """One set whose sun, ring or carrier is held; increasing: the load's member drives."""
    source, sink = ENDS[held][::-1] if increasing else ENDS[held]
    return Use((("sun", "ring", "carrier"),), source, sink, (held,))


Teeth = Sequence[tuple[Any, Any]]  # (a, b) of every set, r = b/a


def set_teeth(sets: Sequence[tuple[Any, Any, Any, Any]]) -> list[tuple[Any, Any]]:
    """(a, b) of sets by teeth above 0 of sun, its planet, the ring's planet and ring."""
    return [(s * q, p * r) for s, p, q, r in sets]


def _rows(use: Use, teeth: Teeth) -> list[dict[str, Any]]:
    """The equation a n_s + b n_r - (a + b) n_c = 0 of every set, by member."""
    rows = []
    for names, (a, b) in zip(use.sets, teeth, strict=True):
        row: dict[str, Any] = dict.fromkeys(use.names, 0)
        for name, factor in zip(names, (a, b, -(a + b)), strict=True):
            row[name] = row[name] + factor
        rows.append(row)
    return rows


def _minor(use: Use, rows: list[dict[str, Any]], name: str, *other: str) -> Any:
    """Determinant of two members' columns; of one set its coefficient."""
    if len(use.sets) == 1:
        return rows[0][name]
    first, second = rows
    return first[name] * second[other[0]] - second[name] * first[other[0]]


def ratio_parts(use: Use, teeth: Teeth) -> tuple[Any, Any]:
    """Numerator and denominator of the ratio of input over output speed, whole of whole numbers.

    Cramer's rule; a denominator of 0 means that the output stands still, a numerator of 0 that the
    input cannot turn.
    """
    rows = _rows(use, teeth)
    return -_minor(use, rows, use.sink, *use.free), _minor(use, rows, use.source, *use.free)


def efficiency(use: Use, teeth: Teeth, losses: Sequence[tuple[Any, Any]]) -> Any:
    """Power given at the output over power taken at the input; 0: the train locks itself.

    losses: efficiency of the sun's and the ring's mesh of every set. A central gear j that drives
    in the frame of its carrier, T_j (n_j - n_c) > 0, gives its planets that power times the
    efficiency of its mesh; a driven one takes it divided by it. So torques are those of a train
    without losses whose r are r' = r eta_s^s eta_r^-t, s and t being 1 for gears that drive and -1
    for others, and eta = i(r')/i(r), where the powers that follow have these signs. If several ways
    do, the lowest efficiency counts. Where the ratio is no number eta is none.
    """
    known: Any = inf
    with np.errstate(all="ignore"):
        for way in _ways(use, teeth, losses):
            consistent: Any = way.efficiency > 0
            for sun, ring in way.powers:
                consistent = consistent & (sun >= 0) & (ring >= 0)
            known = choose(consistent & (way.efficiency < known), way.efficiency, known)
    return choose(known < inf, known, 0)


@dataclass(frozen=True)
class Way:
    """Gears that drive in every set, by signs (1: sun, or ring, drives), and what follows.

    forces: times `rows`, those of lossy sets: torques from outside, that of the input 1. powers of
    sun and ring in the frame of the carrier: below 0 where they do not agree with the signs.
    """

    drives: tuple[tuple[int, int], ...]
    efficiency: Any
    rows: list[dict[str, Any]]
    forces: list[Any]
    powers: list[tuple[Any, Any]]


def _ways(use: Use, teeth: Teeth, losses: Sequence[tuple[Any, Any]]) -> Iterator[Way]:
    """Every choice of the gears that drive."""
    above, below = ratio_parts(use, teeth)
    known = _speeds(use, teeth, above, below)
    slips = [known[sun] - known[carrier] for sun, _, carrier in use.sets]
    for drives in _signs(use):
        lossy = [
            (a, b * sun**s * ring**-t)
            for (a, b), (sun, ring), (s, t) in zip(teeth, losses, drives, strict=True)
        ]
        rows = _rows(use, lossy)
        over, under = (_minor(use, rows, name, *use.free) for name in (use.sink, use.source))
        if np.all(under == 0):
            continue
        forces = [1 / under]
        if len(rows) == 2:
            (x,) = use.free
            forces = [rows[1][x] / under, -rows[0][x] / under]
        of_suns = [force * row[0] for force, row in zip(forces, lossy, strict=True)]
        driving = [sum(of_suns)] * len(of_suns) if use.shared else of_suns
        powers = [
            (s * torque * slip, -t * force * row[1] * slip * a / b)
            for (s, t), torque, force, row, (a, b), slip in zip(
                drives, driving, forces, lossy, teeth, slips, strict=True
            )
        ]
        yield Way(drives, -over / under * below / above, rows, forces, powers)


def _speeds(use: Use, teeth: Teeth, above: Any, below: Any) -> dict[str, Any]:
    """Speeds of all members but the planets, that of the input 1; above, below: its ratio."""
    known: dict[str, Any] = dict.fromkeys(use.held, 0) | {use.source: 1, use.sink: below / above}
    for name in use.free:
        known[name] = _minor(use, _rows(use, teeth), use.sink, use.source) / above
    return known


def _signs(use: Use) -> Iterator[tuple[tuple[int, int], ...]]:
    """Suns and rings that may drive in the frame of their carriers: of planets not all or none."""
    count = len(use.sets)
    if not use.shared:
        for suns in product((1, -1), repeat=count):
            yield tuple((s, -s) for s in suns)
        return
    for sun, *rings in product((1, -1), repeat=1 + count):
        if len({sun, *rings}) > 1:
            yield tuple((sun, ring) for ring in rings)


@dataclass(frozen=True)
class MeshPower:
    """A mesh of all planets: rolling power that its driving gear gives, and what of it is lost."""

    gears: tuple[str, str]
    driver: str
    efficiency: Fraction
    rolling: Fraction
    lost: Fraction


@dataclass(frozen=True)
class Flow:
    """Speeds of all members, planets too, torques on them from outside, and meshes; input's: 1.

    Of a train that locks itself torques and meshes are empty and the efficiency is 0.
    """

    speeds: Mapping[str, Fraction]
    torques: Mapping[str, Fraction]
    meshes: tuple[MeshPower, ...]
    efficiency: Fraction


def flow(
    use: Use, sets: Sequence[tuple[int, int, int, int]], losses: Sequence[tuple[Fraction, Fraction]]
) -> Flow:
    """What flows in a train that has a ratio; sets: teeth as `set_teeth` takes them."""
    teeth = [(Fraction(a), Fraction(b)) for a, b in set_teeth(sets)]
    central = _speeds(use, teeth, *ratio_parts(use, teeth))
    speeds: dict[str, Fraction] = {}
    for (sun, ring, carrier), planets, (s, p, _, _) in zip(
        use.sets, use.planets, sets, strict=True
    ):
        moon = central[carrier] - Fraction(s, p) * (central[sun] - central[carrier])
        each = {n: Fraction(central[n]) for n in (sun, carrier, ring)}
        speeds |= {sun: each[sun], planets: moon} | each
    able = (
        way
        for way in _ways(use, teeth, losses)
        if way.efficiency > 0 and min(map(min, way.powers)) >= 0
    )
    way = min(able, key=lambda way: way.efficiency, default=None)
    if way is None:
        return Flow(speeds, {}, (), Fraction(0))
    torques = {
        name: sum((f * row[name] for f, row in zip(way.forces, way.rows, strict=True)), Fraction(0))
        for name in use.names
    }
    return Flow(speeds, torques, tuple(_meshes(use, losses, way)), way.efficiency)


def _meshes(use: Use, losses: Sequence[tuple[Fraction, Fraction]], way: Way) -> Iterator[MeshPower]:
    rows = zip(use.sets, use.planets, losses, way.drives, way.powers, strict=True)
    for k, ((sun, ring, _), planets, etas, signs, powers) in enumerate(rows):
        for j, gears in enumerate(((sun, planets), (planets, ring))):
            if use.shared and k and not j:
                continue  # the sun's mesh of both sets
            rolling = powers[j] if signs[j] > 0 else powers[j] / etas[j]
            central = signs[j] > 0 if rolling else not j
            driver = (sun, ring)[j] if central else planets
            yield MeshPower(gears, driver, etas[j], rolling, rolling * (1 - etas[j]))
