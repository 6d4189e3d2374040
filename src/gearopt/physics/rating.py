"""What ratings of gear pairs share by any standard: operation, factors, results, Miner's sum.

A rating is of floats; tuples are of pinion and wheel.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from gearopt.physics.gears import MEMBERS


@dataclass(frozen=True)
class Operation:
    """What the pair does: power [N mm/s], pinion_speed [rad/s], hours of life.

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


@dataclass(frozen=True)
class Level:
    """A level of load: its cycles, the curve of strength there, its stress in the curve's unit."""

    cycles: float
    curve: LifeCurve
    stress: float


def miner_sum(cycles: Iterable[Any], lives: Iterable[Any]) -> Any:
    """Return Miner's sum of n_i/N_i: 1 at the end of life; infinite where a life is 0.

    cycles n_i of each level, lives N_i at its stress. A level without cycles adds nothing.
    Source: Palmgren and Miner; AGMA 2001 and ISO 6336-6 refer to it.
    """
    rows = [(np.asarray(n), np.asarray(life)) for n, life in zip(cycles, lives, strict=True)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return sum(np.where(n > 0.0, n / life, 0.0)[()] for n, life in rows)


def damage(levels: Sequence[Level], growth: float = 1.0) -> float:
    """Return Miner's sum of levels whose stresses grow by a factor."""
    lives = [level.curve.life(growth * level.stress) for level in levels]
    return float(miner_sum([level.cycles for level in levels], lives))


def spectrum_safety(levels: Sequence[Level]) -> float:
    """Return the factor by which all stresses of a spectrum may grow until Miner's sum is 1.

    By halving; one level gives strength at its cycles over stress. Curves are flat below their
    shortest life, so that a level may at most reach the strength there. Infinite without load.
    """
    loaded = [level for level in levels if level.cycles > 0.0 and level.stress > 0.0]
    if not loaded:
        return float("inf")
    total = sum(level.cycles for level in loaded)
    high = min(float(level.curve.factor(level.cycles)) / level.stress for level in loaded)
    low = min(float(level.curve.factor(total)) / level.stress for level in loaded)
    if low == high:
        return high
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if damage(loaded, middle) <= 1.0 else (low, middle)
    return low
