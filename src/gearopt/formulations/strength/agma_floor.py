"""Lower bounds of the load capacity used by AGMA 2001, as posynomials over a box of designs.

K_v is one as it is. K_m is bounded by its branches with chords, 1/I and 1/J by geometric series in
the inverse numbers of teeth, life factors and C_H by their chords in logarithms.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strength.standard import MODES, Box
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.agma import factors
from gearopt.physics.agma.batch import safeties
from gearopt.physics.agma.bending import (
    bending_factor,
    critical_theta,
    loaded_tooth,
)
from gearopt.physics.agma.life import cycles_of
from gearopt.physics.agma.mesh import mean_curvatures, mesh_of
from gearopt.physics.agma.rating_factors import SURFACE_HARD_KINDS, life_curves, unknown_hardness
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.geometry.tooth import base_helix_angle

LATTICE = 400  # numbers of teeth at which a factor is computed, evenly in their inverses
SERIES = 8  # terms of a geometric series
MARGIN = 1e-9  # relative; rounding of a factor
BARE = {"I": 1.0, "J": (1.0, 1.0), "K_v": 1.0, "K_m": 1.0, "K_s": (1.0, 1.0), "K_B": (1.0, 1.0)}
BARE |= {"Y_N": (1.0, 1.0), "Z_N": (1.0, 1.0), "C_H": (1.0, 1.0)}


@dataclass(frozen=True)
class Line:
    """The upper bound constant - slope/z of a factor of z teeth, slope >= 0."""

    constant: float
    slope: float

    def inverse(self, teeth: Any) -> Any:
        """Return a posynomial below 1/(constant - slope/z): the head of its geometric series."""
        if self.slope == 0.0:
            return 1.0 / self.constant
        part = self.slope / self.constant / teeth
        return sum((part**k for k in range(1, SERIES + 1)), 1.0) / self.constant


@dataclass(frozen=True)
class Monomial:
    """The upper bound factor x^exponent of a factor of x."""

    factor: float
    exponent: float

    def at(self, value: Any) -> Any:
        """The upper bound factor x^exponent at a value of x."""
        return self.factor * value**self.exponent if self.exponent else self.factor


@dataclass(frozen=True)
class AgmaFloor:
    """Lower bounds of the capacity used by bending and contact of pinion and wheel.

    unit: what is used at T = d = b = m_t = 1 and all factors 1, of loads, at safety factors of 1.
    spreads: K_m >= a + b x + c max(w/(10 d), 0.05), rows of (a, b per mm, c). pitting(z1, u),
    bending(z): posynomials below 1/I, 1/J. lives: Y_N, Z_N of both by their cycles; hard: C_H by u.
    """

    standard: Any
    choice: str
    unit: tuple[float, float, float, float]
    spreads: tuple[tuple[float, float, float], ...]
    pitting: Callable[[Any, Any], Any]
    bending: tuple[Line, Line]
    sharing: Callable[[Any, Any], Any]
    lives: tuple[tuple[Monomial, Monomial], tuple[Monomial, Monomial]]
    hard: Monomial

    def utilisations(self, pair: GearPair, torque: Any, speed: Any, safety: Any) -> dict[str, Any]:
        """Return the bounds, of loads, at required safety factors (S_F, S_H), by name of branch."""
        standard, given = self.standard, self.standard.given
        load, d, b = standard.loads[0], pair.pinion.reference_diameter, pair.face_width
        z, u = pair.pinion_teeth, pair.ratio
        shared = torque / (d * b)
        if "K_v" not in given:
            velocity = 0.5 * load.speed * speed * d
            exponent, offset = factors.dynamic_curve(standard.practice.quality)
            root = (velocity / factors.FEET_PER_MINUTE) ** 0.5  # text of cvxpy, too
            shared = shared * (1.0 + root / offset) ** exponent
        rpm = load.speed * speed * (30.0 / math.pi)
        contacts = standard.operation.contacts
        own = zip((rpm, rpm / u), contacts, strict=True)
        cycles = [cycles_of(load.hours, n, count) for n, count in own]
        found = []
        for k, teeth in enumerate((z, z * u)):
            form = 1.0 if "J" in given else self.bending[k].inverse(teeth) * self.sharing(z, u)
            used = shared * self.unit[k] * safety[0] * form / (d / z)
            found.append(used / self.lives[0][k].at(cycles[k]))
        for k in (0, 1):
            form = 1.0 if "I" in given else self.pitting(z, u)
            used = shared * self.unit[2 + k] * safety[1] ** 2 * form / d
            strong = self.lives[1][k].at(cycles[k]) * (self.hard.at(u) if k else 1.0)
            found.append(used / strong**2)
        spreads = self._spreads(b, d)
        rows = zip(MODES, found, strict=True)
        return {f"{n}_{i}": u * k for n, u in rows for i, k in enumerate(spreads, 1)}

    def _spreads(self, width: Any, diameter: Any) -> list[Any]:
        """Return the bounds of K_m, which a solver takes one by one: their largest has kinks."""
        if not self.spreads:
            return [1.0]
        slender = width / (10.0 * diameter), 0.05
        bases = [a + b * width if b else a for a, b, _ in self.spreads]
        slopes = [c for _, _, c in self.spreads]
        return [a + c * s for a, c in zip(bases, slopes, strict=True) for s in slender]

    def limits(self, pair: GearPair) -> dict[str, Any]:
        """Return the limits that keep to the regime."""
        if self.choice == "low":
            return {"overlap_ratio_high": pair.overlap_ratio}
        if self.choice == "conventional":
            return {"overlap_ratio_low": 1.0 / pair.overlap_ratio}
        return {}


def agma_floor(standard: Any, box: Box, choice: str) -> AgmaFloor | None:
    """Return the bounds of a standard over a box in a regime.

    None where centre distances are not those of reference circles: then there is none.
    """
    if not box.toothing.on_reference:
        return None
    geometry = _geometry(standard, box, choice)
    least = box.toothing.pair(1.0, box.teeth[0], box.teeth[0] * box.ratio[0], 1.0)
    case = standard.case(least, 1.0, box.speed[1], {})
    return AgmaFloor(
        standard,
        choice,
        _unit(standard, least),
        _spreads(standard, box.widest),
        *geometry,
        (_lives(case, box, False), _lives(case, box, True)),
        _hard(case, box.ratio),
    )


def _unit(standard: Any, pair: GearPair) -> tuple[float, float, float, float]:
    made = safeties(standard.case(pair, 1.0, 1.0, BARE), 1.0, (1.0, 1.0))
    d, width = pair.pinion.reference_diameter, pair.face_width
    module = d / pair.pinion_teeth
    first, second = (width * d * module / s for s in made[:2])
    third, fourth = (width * d**2 / s**2 for s in made[2:])
    return float(first), float(second), float(third), float(fourth)


def _spreads(standard: Any, widest: float) -> tuple[tuple[float, float, float], ...]:
    """Return the lower bounds of K_m for widths up to the widest one [mm]."""
    practice = standard.practice
    if "K_m" in standard.given:
        return ()
    leads, mounted = 0.8 if practice.crowned else 1.0, 0.8 if practice.adjusted else 1.0
    offset = 1.0 if practice.offset < 0.175 else 1.1
    a, b, c = factors.ALIGNMENT[practice.curve]
    top, most = widest / factors.INCH, factors.WIDEST / factors.INCH
    reach = min(top, most)
    held = 0.0 if math.isinf(top) else reach / top  # beyond `most` the factor is constant
    rise = leads * mounted * (b + c * reach) * held
    rows = [(1.0 + leads * (mounted * a - 0.025 * offset), rise / factors.INCH, leads * offset)]
    if 1.0 < top <= most:
        ends = (f * factors.INCH for f in (17.0, reach))
        extra = [float(factors.proportion_factor(end, 1e9)) - 0.025 for end in ends]
        slope = 0.0125 if reach <= 17.0 else min(extra[0] / 16.0, extra[1] / (reach - 1.0), 0.0125)
        added = leads * offset * max(slope, 0.0)
        rows.append((rows[0][0] - added, (rise + added) / factors.INCH, leads * offset))
    return tuple(rows)


def _lives(case: Any, box: Box, contact: bool) -> tuple[Monomial, Monomial]:
    """Return upper bounds of Y_N or Z_N of both gears by their cycles."""
    if ("Z_N" if contact else "Y_N") in case.given:
        return Monomial(1.0, 0.0), Monomial(1.0, 0.0)
    load, found = case.operation.hours, []
    share = case.operation.pinion_speed / box.speed[1]
    for k, curve in enumerate(life_curves(case, contact)):
        slow, fast = box.ratio[1] if k else 1.0, box.ratio[0] if k else 1.0
        rpm = [share * box.speed[0] / slow, share * box.speed[1] / fast]
        low, high = (cycles_of(load, n * 30.0 / math.pi, case.operation.contacts[k]) for n in rpm)
        found.append(_chord(curve.factor, low, high, not curve.least and low >= curve.shortest))
    return found[0], found[1]


def _chord(law: Callable[[Any], Any], low: float, high: float, convex: bool) -> Monomial:
    """Return an upper bound of a law: its chord where it is convex in logarithms, else its most."""
    ends = float(law(low)), float(law(high))
    if not convex or high <= low * (1.0 + MARGIN):
        return Monomial(max(ends) * (1.0 + MARGIN), 0.0)
    exponent = math.log(ends[1] / ends[0]) / math.log(high / low)
    return Monomial(ends[0] * low**-exponent * (1.0 + MARGIN), exponent)


def _hard(case: Any, ratio: tuple[float, float]) -> Monomial:
    """Return an upper bound of C_H of the wheel by the ratio."""
    pinion, wheel = case.steels
    plain = wheel.kind != "through-hardened" or unknown_hardness(pinion) or unknown_hardness(wheel)
    if "C_H" in case.given or plain:
        return Monomial(1.0, 0.0)
    if pinion.kind in SURFACE_HARD_KINDS:
        return Monomial(float(factors.surface_hardened_factor(pinion.finish, wheel.hardness)), 0.0)

    def law(u: Any) -> Any:
        return factors.hardness_ratio_factor(pinion.hardness, wheel.hardness, u)

    return _chord(law, *ratio, ratio[1] <= factors.LARGEST_RATIO)


def _geometry(standard: Any, box: Box, choice: str) -> tuple[Any, tuple[Line, Line], Any]:
    """Return pitting, bending and sharing of an `AgmaFloor`."""
    tooth = box.toothing
    wheels = box.teeth[0] * box.ratio[0], box.teeth[1] * box.ratio[1]
    pinion, wheel = _lattice(box.teeth), _lattice(wheels)
    first = tooth.pair(1.0, pinion, wheels[1], 1.0)
    path = contact_path(first)
    lack = np.asarray(-path.lowest_single / path.curvatures[0])  # sigma = -s_B/(T1 C)
    helical = bool(tooth.helix_angle)
    if not helical:
        forms = (
            _bare(standard, choice, first),
            _bare(standard, choice, _turned(tooth.pair(1.0, box.teeth[1], wheel, 1.0))),
        )
        return (
            _spur(first, pinion, lack, box.ratio),
            (
                _line(pinion, forms[0]),
                _line(wheel, forms[1]),
            ),
            _one,
        )
    second = tooth.pair(1.0, box.teeth[1], wheel, 1.0)
    cosine = float(np.cos(base_helix_angle(first.pinion)))
    lines = [
        _line(pinion, _part(first, 0) / cosine),
        _line(wheel, _part(second, 1) / cosine),
    ]
    share = _shared(lines, box)
    forms = _bare(standard, choice, first), _bare(standard, choice, _turned(second))
    mean = 1.0 + max(0.0, _mean(first))
    bare = float(np.tan(first.working_angle) * np.cos(first.working_angle) ** 2 / 2.0)
    if choice == "low":
        most = max(1.0, sum(line.constant for line in lines)) * mean
        gain = np.sqrt(np.maximum(1.0, most / np.clip(1.0 - lack, 1e-3, None)))
        worst = float(gain.max())
        bending = _line(pinion, forms[0], gain), _line(wheel, forms[1] * worst)
        sharing: Callable[[Any, Any], Any] = _one
    else:
        bending, sharing = (_line(pinion, forms[0]), _line(wheel, forms[1])), share

    def pitting(z: Any, u: Any) -> Any:
        return (1.0 + 1.0 / u) * share(z, u) / (bare * mean)

    return pitting, bending, sharing


def _one(z: Any, u: Any) -> Any:
    return 1.0


def _shared(lines: list[Line], box: Box) -> Callable[[Any, Any], Any]:
    """Return a posynomial below 1/max(1, eps_alpha/cos(beta_b)), by z1 and u."""
    constant = sum(line.constant for line in lines)
    fewest = box.teeth[0], box.teeth[0] * box.ratio[0]
    least = constant - sum(line.slope / z for line, z in zip(lines, fewest, strict=True))
    if least < 1.0:
        return lambda z, u: 1.0 / max(1.0, constant)

    def law(z: Any, u: Any) -> Any:
        part = (lines[0].slope + lines[1].slope / u) / constant / z
        return sum((part**k for k in range(1, SERIES + 1)), 1.0) / constant

    return law


def _part(pair: GearPair, member: int) -> Array:
    """Part of a member's addendum in the transverse contact ratio."""
    path = contact_path(pair)
    return np.asarray((-path.start if member else path.end) / path.base_pitch)


def _mean(pair: GearPair) -> float:
    """Return how far the mean of the working flank lies beyond the pitch point, over T1 C."""
    path = contact_path(pair)
    return float(np.max((mean_curvatures(pair, path)[0] - path.curvatures[0]) / path.curvatures[0]))


def _turned(pair: GearPair) -> GearPair:
    return GearPair(pair.wheel, pair.pinion)


def _spur(pair: GearPair, teeth: Array, lack: Array, ratio: tuple[float, float]) -> Any:
    """Return a posynomial below 1/I: (1/I_c) (1/(1 - sigma) + 1/(u + sigma)), I_c at the pitch."""
    bare = float(np.tan(pair.working_angle) * np.cos(pair.working_angle) ** 2 / 2.0)
    least = float(np.min(teeth * lack))
    most = max(0.0, float(np.max(lack)))
    series = Line(1.0, max(0.0, least))
    scale = 1.0 / (1.0 - min(0.0, float(np.min(lack))))

    def pitting(z: Any, u: Any) -> Any:
        return (series.inverse(z) * scale + 1.0 / (u * (1.0 + most / ratio[0]))) / bare

    return pitting


def _lattice(ends: tuple[float, float]) -> Array:
    """Return numbers of teeth (n,) between two ends, even in their inverses, rising."""
    return np.asarray(1.0 / np.linspace(1.0 / ends[0], 1.0 / ends[1], LATTICE))


def _line(teeth: Array, values: Array, gain: Array | float = 1.0) -> Line:
    """Return a line above the product of `values`, which rise with the teeth, and a falling gain.

    Between two numbers of teeth the values are at most those at the larger one, the gain and
    slope/z at most those at the smaller one.
    """
    values, gain = (np.broadcast_to(x, teeth.shape) for x in (values, gain))
    product = values * gain
    if teeth[-1] <= teeth[0] * (1.0 + MARGIN):
        return Line(float(np.max(product)) * (1.0 + MARGIN), 0.0)
    slope = max(0.0, float((product[-1] - product[0]) / (1.0 / teeth[0] - 1.0 / teeth[-1])))
    above = values[1:] * gain[:-1] + slope / teeth[:-1]
    return Line(float(max(above.max(), product[0] + slope / teeth[0])) * (1.0 + MARGIN), slope)


def _bare(standard: Any, choice: str, pair: GearPair) -> Array:
    """Return J of the first member of pairs with C_psi = m_N = 1."""
    mesh = replace(mesh_of(pair, choice, smooth=True), sharing=1.0, overlap_factor=1.0)
    tooth = loaded_tooth(mesh, standard.practice.load)
    return np.asarray(bending_factor(tooth, critical_theta(tooth)).value)
