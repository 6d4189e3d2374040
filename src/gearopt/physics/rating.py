"""Common parts of ratings by any standard: operation, factors, results, Miner's sum.

A rating is of floats; tuples are of pinion and wheel.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS

ROOT_STEPS = 200  # of a root, at most
ROUNDING = 2e-16  # of its logarithm


@dataclass(frozen=True)
class Operation:
    """Operation of the pair: power [N mm/s], pinion_speed [rad/s], hours of life.

    overload K_o of AGMA, K_A of ISO; temperature [degrees C] and reliability R, which AGMA asks;
    contacts: load cycles a revolution of pinion and wheel.
    """

    power: Any
    pinion_speed: Any
    hours: Any
    overload: Any = 1.0
    temperature_C: float = 60.0
    reliability: float = 0.99
    contacts: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True)
class Factor:
    """A factor by its symbol: its value, or those of pinion and wheel; where it is from.

    unit: "" of plain numbers. verified: whether two sources have it; remark: what limits it, or "".
    """

    symbol: str
    value: float | tuple[float, float]
    clause: str
    unit: str = ""
    verified: bool = True
    remark: str = ""


@dataclass(frozen=True)
class Rating:
    """The rating of a pair; tuples are of pinion and wheel.

    factors by symbol; tangential load [N], W_t of AGMA at the working pitch circle, F_t of ISO at
    the reference circle; speed v [mm/s] there; stresses [MPa]; safety factors of bending S_F and of
    contact S_H (of stress; S_H^2 is of load); cycles asked for; lives [cycles] at which S_F and S_H
    are 1 (a given life factor scales its curve), infinite below the curves of ISO; power [N mm/s]
    at which the least of all safety factors is 1, with the same factors of load; governs: member
    and mode.
    """

    factors: dict[str, Factor]
    load: float
    speed: float
    bending_stress: tuple[float, float]
    contact_stress: tuple[float, float]
    bending_safety: tuple[float, float]
    contact_safety: tuple[float, float]
    cycles: tuple[float, float]
    bending_life: tuple[float, float]
    contact_life: tuple[float, float]
    power: float
    governs: tuple[str, str]

    @property
    def unverified(self) -> tuple[str, ...]:
        """Symbols of the factors that a single source or memory alone has."""
        return tuple(name for name, factor in self.factors.items() if not factor.verified)


@dataclass(frozen=True)
class Ratings:
    """Safety factors of rows: S_F and S_H (of stress) of pinion and wheel.

    refusal: indices of the `REFUSALS` of the standard; safety factors are NaN where it is not 0.
    """

    bending: tuple[Any, Any]
    contact: tuple[Any, Any]
    refusal: Any


@dataclass(frozen=True)
class Spectrum:
    """The rating of a load spectrum; tuples are of pinion and wheel.

    levels: the rating of each level alone, at its own number of cycles. damage: Miner's sums of
    bending and contact, infinite where a level breaks a tooth at once. safety factors S_F and S_H
    by which all stresses may grow until the sum is 1.
    """

    levels: tuple[Rating, ...]
    bending_damage: tuple[float, float]
    contact_damage: tuple[float, float]
    bending_safety: tuple[float, float]
    contact_safety: tuple[float, float]


def check_symbols(given: Iterable[str], known: Sequence[str]) -> None:
    """Refuse a factor that is given by a symbol that is not known, by ValueError."""
    if unknown := sorted(set(given) - set(known)):
        raise ValueError(f"no factor {unknown[0]!r}; known: {', '.join(known)}")


def governing(bending: Sequence[float], contact: Sequence[float]) -> tuple[float, tuple[str, str]]:
    """Return the least safety factor of load, min(S_F, S_H^2), and whose it is: member and mode."""
    modes = [(bending[k], MEMBERS[k], "bending") for k in (0, 1)]
    modes += [(contact[k] ** 2, MEMBERS[k], "contact") for k in (0, 1)]
    least, member, mode = min(modes)
    return least, (member, mode)


class LifeCurve(Protocol):
    """A strength over cycles and its inverse."""

    def factor(self, cycles: Any) -> Any:
        """Return the strength at a number of cycles."""

    def life(self, factor: Any) -> Any:
        """Return the number of cycles at which a strength is reached: 0 above all of them."""

    def take(self, place: Any) -> "LifeCurve":
        """Return that of some rows of arrays."""


@dataclass(frozen=True)
class Level:
    """A level of load: its cycles, the curve of strength there, its stress in the curve's unit.

    Floats or arrays.
    """

    cycles: Any
    curve: LifeCurve
    stress: Any

    def take(self, place: Any) -> "Level":
        """Return that of some rows of arrays."""
        cycles, stress = (x[place] if np.ndim(x) else x for x in (self.cycles, self.stress))
        return Level(cycles, self.curve.take(place), stress)


def check_numbers(operation: Operation, overload: str, given: Mapping[str, Any]) -> None:
    """Refuse numbers without which no stress or no safety factor is one.

    overload: name of that factor in the standard; given: factors that have to be above 0.
    """
    asked = {
        "power": operation.power,
        "pinion speed": operation.pinion_speed,
        overload: operation.overload,
    }
    asked |= {name: min(np.ravel(value)) for name, value in given.items()}
    for name, value in asked.items():
        if not 0.0 < value < math.inf:
            idle = "; a level without load does no damage: leave it out" if name == "power" else ""
            raise ValueError(f"{name} is {value:g}, and has to be above 0{idle}")
    if not operation.hours >= 0.0:
        raise ValueError(f"the life is {operation.hours:g} h: it cannot be below 0")


def miner_sum(cycles: Iterable[Any], lives: Iterable[Any]) -> Any:
    """Return Miner's sum of n_i/N_i: 1 at the end of life; infinite where a life is 0.

    cycles n_i of each level, lives N_i at its stress. A level without cycles adds nothing.
    Source: Palmgren and Miner; AGMA 2001 and ISO 6336-6 refer to it.
    """
    rows = [(np.asarray(n), np.asarray(life)) for n, life in zip(cycles, lives, strict=True)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return sum(np.where(n > 0.0, n / life, 0.0)[()] for n, life in rows)


def damage(levels: Sequence[Level], growth: Any = 1.0) -> Any:
    """Return Miner's sum of levels whose stresses grow by a factor; floats or arrays."""
    lives = [level.curve.life(growth * level.stress) for level in levels]
    return miner_sum([level.cycles for level in levels], lives)


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def safety_ends(levels: Sequence[Level]) -> tuple[Any, Any]:
    """Numbers between which the safety factor of a spectrum lies, of floats or arrays.

    Above: no level may reach its strength at its own cycles; below: none reaches that at the
    cycles of all.
    """
    loaded = [~(np.less_equal(x.cycles, 0.0) | np.less_equal(x.stress, 0.0)) for x in levels]
    total = sum(np.where(on, x.cycles, 0.0) for on, x in zip(loaded, levels, strict=True))
    ends = []
    for cycles in ([total] * len(levels), [x.cycles for x in levels]):
        factors = [
            np.where(on, x.curve.factor(n) / x.stress, np.inf)
            for on, x, n in zip(loaded, levels, cycles, strict=True)
        ]
        ends.append(np.minimum.reduce(np.broadcast_arrays(*factors)))
    low, high = np.broadcast_arrays(*ends)
    return low, high


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def spectrum_safety(levels: Sequence[Level]) -> Any:
    """Return the factor by which all stresses of a spectrum may grow until Miner's sum is 1.

    Of floats or arrays. One level gives strength at its cycles over stress. Curves are flat below
    their shortest life, so that a level may at most reach the strength there. Infinite without
    load.
    """
    low, high = safety_ends(levels)
    safety, some = np.array(high), low < high
    root = _root([x.take(some) for x in levels], low[some], high[some])
    safety[some] = np.clip(root, low[some], high[some])
    return safety[()]


def _root(levels: Sequence[Level], low: Any, high: Any) -> Any:
    """Return where Miner's sum is 1 or jumps past it, between low and high (n,).

    high where it stays below.
    Source: T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145-149.
    """
    root, place = np.array(high), np.arange(len(high))
    a, b, share = np.log(high), np.log(low), np.full(len(high), 0.5)
    fa, fb = (np.log(damage(levels, np.exp(x))) for x in (a, b))
    done = fa <= 0.0
    for _ in range(ROOT_STEPS):
        if (keep := ~done).sum() < len(done):
            place, levels = place[keep], [x.take(keep) for x in levels]
            a, b, fa, fb, share = (v[keep] for v in (a, b, fa, fb, share))
        if not len(place):
            break
        x = a + share * (b - a)
        f = np.log(damage(levels, np.exp(x)))
        same = np.sign(f) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, f
        least = ROUNDING * (1.0 + np.abs(a)) / np.abs(b - a)
        done = ~(least < 0.5) | (fa == 0.0)
        root[place] = np.exp(np.where(fa <= 0.0, a, b))
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        share = fa / (fb - fa) * fc / (fb - fc)
        share = share + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        curved = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi) & np.isfinite(share)
        share = np.clip(np.where(curved, share, 0.5), least, 1.0 - least)
    return root
