"""The given numbers of a two-stage servo train, and the train of given sizes.

Stage 1 is at the motor, stage 2 at the load; gears 2 and 3 share a shaft. All gears are solid
discs, the last one may be a sector. Numbers at which a tie may occur are exact fractions.
"""

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.duty import ServoDuty
from gearopt.formulations.servo.split.bodies import TIP, Bodies, Pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.formulations.strength import Law
from gearopt.formulations.strength.laws.lewis import LEWIS
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Param
from gearopt.physics.backlash import output_error
from gearopt.physics.gears import GearPair, disc_inertia


@dataclass(frozen=True)
class ServoTrain:
    """A two-stage train from a motor to a load; lengths in mm, the rest in N, rad, MPa, t.

    ratio: total, within a relative tolerance. modules: those to choose from. pinion_teeth: minimum
    and maximum. max_wheel_teeth: None for no limit. face_width: of all gears. sector: part of a
    full disc that the last wheel is. output_torque: peak at the load [N mm], 0 for none beside that
    of the duty's motion, which the teeth carry too. bending: allowable Lewis stress [MPa]. bore:
    minimum reference diameter of gear 3. wheel_tips: largest tip diameters of gears 2 and 4. shaft:
    diameter and length of the middle one; None: its inertia is not counted. lost_motion: 2 j_t + 2
    delta_p of each stage [mm], so that its error at the wheel is that over the wheel's diameter;
    None: the error is not known. error: largest at the output [rad]. duty: what the train's inertia
    and ratio are judged by, if its goal is asked for. bodies: shafts, hub and motor that gears keep
    clear of; None: not checked. elastic: springs whose windup varies under a load torque, which is
    an error too; None: not counted.
    """

    ratio: Fraction
    tolerance: Fraction
    modules: tuple[Fraction, ...]
    pinion_teeth: tuple[int, int]
    max_wheel_teeth: int | None
    face_width: float
    density: float
    output_torque: float
    bending: float
    bore: Fraction
    wheel_tips: tuple[Fraction, Fraction]
    shaft: tuple[float, float] | None = None
    lost_motion: tuple[float, float] | None = None
    error: float = math.inf
    sector: float = 1.0
    duty: ServoDuty | None = None
    bodies: Bodies | None = None
    elastic: Springs | None = None

    def __post_init__(self) -> None:
        if not self.ratio > 0 or not 0 <= self.tolerance < 1:
            raise ValueError("a train needs a ratio > 0 and a tolerance from 0 to below 1")
        if not self.modules or min(self.modules) <= 0:
            raise ValueError("a train needs modules > 0 to choose from")
        if not 12 <= self.pinion_teeth[0] <= self.pinion_teeth[1]:
            raise ValueError("pinion_teeth: needs 12 (for the Lewis factor) <= minimum <= maximum")
        if not self.output_torque >= 0.0 or (self.duty is None and self.output_torque == 0.0):
            raise ValueError("a train without a duty needs an output_torque above 0")
        positive = (self.face_width, self.density, self.bending, self.error)
        lengths = (*(self.lost_motion or ()), *(self.shaft or ()), *self.wheel_tips, self.bore)
        if not all(value > 0 for value in (*positive, *lengths)):
            raise ValueError("widths, loads, allowances and limits of a train are positive")
        if not 0.0 < self.sector <= 1.0:
            raise ValueError("the sector is a part of a disc: above 0 and at most 1")
        if self.lost_motion is None and self.error < math.inf:
            raise ValueError("a maximum error needs lost_motion")

    @property
    def goals(self) -> tuple[str, ...]:
        """Return the objectives that are known of it."""
        error = ("error",) if self.lost_motion is not None else ()
        return ("inertia", "mass", *error, *((self.duty.goal,) if self.duty else ()))

    @property
    def wheel_teeth(self) -> int:
        """Return the maximum number of teeth of a wheel: as given, or as the tips allow."""
        left = max(self.wheel_tips) / min(self.modules) - TIP
        return max(int(left), 1) if self.max_wheel_teeth is None else self.max_wheel_teeth

    @property
    def ratios(self) -> tuple[Fraction, Fraction]:
        """Return the minimum and maximum total ratio."""
        return self.ratio * (1 - self.tolerance), self.ratio * (1 + self.tolerance)


def pairs(point: Iterable[Any], face_width: float = 1.0) -> Pairs:
    """Return the gear pairs of a point of `split.problem`, whose six numbers may be arrays.

    face_width [mm]; irrelevant where it is not given.
    """
    z1, z3, z2, z4, m1, m2 = point
    return (
        GearPair.of_teeth(m1, z1, z2, face_width),
        GearPair.of_teeth(m2, z3, z4, face_width),
    )


def train_inertia(density: Any, pairs: Pairs, shaft: tuple[Any, Any] | None, sector: Any) -> Any:
    """Return the inertia of gears and shaft [t mm2] seen at the motor.

    J_1 + (J_2 + J_3 + J_s)/n_1^2 + kappa J_4/(n_1 n_2)^2; shaft (diameter, length) [mm], ratios n,
    sector kappa, density [t/mm3]. Without a shaft J_s is left out.
    """
    pinion, middle, last = shaft_inertias(density, pairs, shaft, sector)
    return pinion + middle + last


def shaft_inertias(
    density: Any, pairs: Pairs, shaft: tuple[Any, Any] | None, sector: Any
) -> tuple[Any, Any, Any]:
    """Return the inertia [t mm2] of the gears of each shaft, seen at the motor."""
    first, second = pairs
    n1, n2 = first.ratio, second.ratio
    middle = first.wheel.inertia(density) + second.pinion.inertia(density)
    if shaft is not None:
        thick, long = shaft
        middle = middle + disc_inertia(density, long, thick)
    last = sector * second.wheel.inertia(density)
    return first.pinion.inertia(density), middle / n1**2, last / (n1 * n2) ** 2


def motion_torques(train: ServoTrain, pairs: Pairs) -> tuple[Any, Any] | None:
    """Return the peak torques [N mm] at both wheels in the duty's motion; None without a duty."""
    if train.duty is None:
        return None
    pinion, middle, last = shaft_inertias(train.density, pairs, train.shaft, train.sector)
    n1, n = pairs[0].ratio, pairs[0].ratio * pairs[1].ratio
    gears = pinion + middle + last
    first, second = (train.duty.carried_torque(n, gears, j) for j in (middle + last, last))
    return n1 * first, n * second


def pinion_torques(train: ServoTrain, pairs: Pairs) -> tuple[Any, Any]:
    """Return the torque [N mm] of both pinions, by output_torque or by the motion if larger."""
    n1, n2 = (pair.ratio for pair in pairs)
    asked: tuple[Any, Any] = train.output_torque / (n1 * n2), train.output_torque / n2
    moved = motion_torques(train, pairs)
    if moved is None:
        return asked
    return np.maximum(asked[0], moved[0] / n1), np.maximum(asked[1], moved[1] / n2)


def gear_mass(density: Any, pairs: Pairs, sector: Any) -> Any:
    """Return the mass [kg] of the four gears as discs, the last one as a sector of one.

    density [t/mm3].
    """
    stage_1, stage_2 = pairs
    first = stage_1.pinion.mass(density) + stage_1.wheel.mass(density)
    second = stage_2.pinion.mass(density) + sector * stage_2.wheel.mass(density)
    return 1000.0 * (first + second)


def train_error(lost_motion: tuple[Any, Any], pairs: Pairs, elastic: Springs | None = None) -> Any:
    """Return the error [rad] at the output: lost motion over wheel diameter, of stage 1 over n_2.

    lost_motion: 2 j_t + 2 delta_p of each stage [mm]. elastic: springs whose windup varies.
    """
    angles = tuple(
        lost / pair.wheel.reference_diameter for lost, pair in zip(lost_motion, pairs, strict=True)
    )
    error = output_error(angles, (pairs[1].ratio, 1.0))
    return error if elastic is None else error + sum(elastic.variations(pairs))


def objectives(train: ServoTrain, names: tuple[str, ...], pairs: Pairs) -> dict[str, Any]:
    """Return the named objectives of a train of one face width; ValueError for an unknown one."""
    if unknown := set(names) - set(train.goals):
        raise ValueError(f"no objective {unknown.pop()!r}; known: {', '.join(train.goals)}")
    inertia = train_inertia(train.density, pairs, train.shaft, train.sector)
    values = {"inertia": inertia, "mass": gear_mass(train.density, pairs, train.sector)}
    if train.lost_motion is not None:
        values["error"] = train_error(train.lost_motion, pairs, train.elastic)
    if train.duty is not None and train.duty.goal in names:
        values[train.duty.goal] = train.duty.value(pairs[0].ratio * pairs[1].ratio, inertia)
    return {name: values[name] for name in names}


def ratio_parameters(low: float, high: float) -> tuple[Param, ...]:
    """Return the ends of the total ratio, one where they are equal."""
    if low == high:
        return (Param("ratio", "", low, role="given"),)
    ends = (("ratio_low", low), ("ratio_high", high))
    return tuple(Param(name, "", value, role="given") for name, value in ends)


def ratio_rows(p: Any, tied: bool, ratio: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the rows of the total ratio: two limits, or one equality where they are tied."""
    if tied:
        return {}, {"ratio": ratio / p.ratio}
    return {"ratio_low": p.ratio_low / ratio, "ratio_high": ratio / p.ratio_high}, {}


def bending_stress(wheel_torque: Any, pair: GearPair, law: Law = LEWIS) -> Any:
    """Return the Lewis stress [MPa] at the pinion of a pair; wheel_torque [N mm].

    law: another of `lewis`, where teeth are no variables or are bounded.
    """
    (stress,) = law.indices(pair, wheel_torque / pair.ratio, 0.0)
    return stress
