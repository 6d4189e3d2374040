"""A servo train as its kernels read it: limits as whole numbers of teeth."""

import math
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from gearopt.formulations.servo.ratio.duty import ServoDuty
from gearopt.formulations.servo.servo_design import GOALS, MOTIONS
from gearopt.formulations.servo.split.bodies import LARGEST, TIP, minimum_teeth
from gearopt.formulations.servo.split.servo_train import ServoTrain
from gearopt.formulations.strength.laws.lewis import LEWIS
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair, disc_inertia, disc_mass


class Numbers(NamedTuple):
    """Limits as whole numbers of teeth, the rest as plain numbers.

    least, most (P + 1,): z2 z4 is between least[z1 z3] and most[z1 z3]. wheel: maximum number of
    teeth of a wheel. wheel_1, wheel_2, bored (K,), for each module: maximum numbers of teeth of
    wheel 1 and 2 by their tips, gear 3 at least by its diameter and around its shaft. clear_1,
    clear_2, stage_1 (K,): minimum numbers of teeth of gear 2, of gear 4, of gears 1 and 2 together;
    unit (K,), output: what keeps gear 2 clear of the output shaft (`bodies.MinimumTeeth`). low,
    high: total ratio. bore; tip: largest reference diameter of gear 4 [mm]. load: minimum d m [mm2]
    of gear 4, by the teeth of its pinion, under the output torque; tooth: the same under 1 N mm.
    disc_mass [kg/mm2] and disc_inertia [t/mm2]: per d^2 and per d^4. swing (Z,): of
    `Springs.swings`, by teeth. duty: see `duty_numbers`.
    """

    least: Any
    most: Any
    pinion: Any
    wheel: int
    wheel_1: Any
    wheel_2: Any
    bored: Any
    clear_1: Any
    clear_2: Any
    stage_1: Any
    unit: Any
    output: int
    module: Array
    lost: Array
    swing: Array
    error: float
    load: Array
    tooth: Array
    low: float
    high: float
    bore: float
    tip: float
    disc_mass: float
    disc_inertia: float
    shaft_inertia: float
    sector: float
    duty: Array


def duty_numbers(duty: ServoDuty | None) -> Array:
    """Return the motion (0 acceleration, 1 move, 2 swing, -1 none) and numbers: kernels' `duty`.

    Load and motor inertia [t mm2], torque less the motor's friction, load friction [N mm],
    efficiency, slope of the torque [N mm], angle [rad], speed limit [rad/s], friction of the motor
    [N mm], peak acceleration [rad/s2], largest rms torque [N mm].
    """
    if duty is None:
        return np.array([-1.0, *[0.0] * 11])
    drive = duty.drive
    loads = drive.load_inertia, drive.inertia, drive.net_torque, drive.load_friction
    motor = drive.efficiency, duty.slope, duty.angle, drive.speed_limit, drive.motor_friction
    most = drive.torque if duty.motion == "swing" and drive.torque else math.inf
    kind = list(MOTIONS).index(duty.motion)
    return np.array([kind, *loads, *motor, duty.peak_acceleration, most])


def posed(train: ServoTrain, goal: str) -> tuple[Numbers, int]:
    """Return a train and its goal as the kernels read them; a duty as goal adds its limits."""
    return numbers(train, bool(GOALS[goal].motion)), list(GOALS).index(goal)


def numbers(train: ServoTrain, moved: bool = False) -> Numbers:
    """Return the numbers of a train; every tie is decided here, in fractions.

    moved: the motor's speed limit holds too.
    """
    low, high = train.ratios
    if moved and train.duty is not None and train.duty.max_ratio is not None:
        high = min(high, train.duty.max_ratio)
    most, width, density = train.pinion_teeth[1], train.face_width, train.density
    known = np.maximum(np.arange(most + 1, dtype=float), train.pinion_teeth[0])
    pinions = GearPair.of_teeth(1.0, known, known, width)
    tooth = LEWIS.largest_utilisation(pinions, known, 0.0, (train.bending,))
    thick, long = train.shaft or (0.0, 0.0)
    return Numbers(
        least=-_floors(-low, most**2),
        most=_floors(high, most**2),
        pinion=np.array(train.pinion_teeth, np.int64),
        **_teeth(train),
        module=np.array([float(m) for m in train.modules]),
        lost=np.array(train.lost_motion or (0.0, 0.0)),
        swing=_swings(train),
        error=float(train.error),
        load=train.output_torque * tooth,
        tooth=tooth,
        low=float(low),
        high=float(high) * (1.0 + 1e-15),
        bore=float(train.bore),
        tip=float(train.wheel_tips[1]),
        disc_mass=1000.0 * float(disc_mass(density, width, 1.0)),
        disc_inertia=float(disc_inertia(density, width, 1.0)),
        shaft_inertia=float(disc_inertia(density, long, thick)),
        sector=float(train.sector),
        duty=duty_numbers(train.duty),
    )


def _swings(train: ServoTrain) -> Array:
    """Return the share of every gear in the error of meshes whose stiffness varies, by teeth."""
    teeth = np.arange(max(train.wheel_teeth, train.pinion_teeth[1]) + 1, dtype=float)
    if train.elastic is None:
        return 0.0 * teeth
    return train.elastic.swings(train.face_width, np.maximum(teeth, train.pinion_teeth[0]))


def _floors(ratio: Fraction, most: int) -> Any:
    """Return the whole part of a ratio times 0, 1 ... most, exactly."""
    above, below = ratio.numerator, ratio.denominator
    if max(abs(above) * most, below) < LARGEST:
        return above * np.arange(most + 1) // below
    return np.array([above * p // below for p in range(most + 1)], np.int64)


def _teeth(train: ServoTrain) -> dict[str, Any]:
    """Return the limits of numbers of teeth, by module."""
    tips = [[math.floor(tip / m - TIP) for m in train.modules] for tip in train.wheel_tips]
    wheel = train.wheel_teeth
    clear = minimum_teeth(train.bodies, train.modules, wheel)
    bored = [
        max(math.ceil(train.bore / m), around, train.pinion_teeth[0])
        for m, around in zip(train.modules, clear.pinion_2, strict=True)
    ]
    return {
        "wheel": wheel,
        "wheel_1": np.minimum(tips[0], wheel),
        "wheel_2": np.minimum(tips[1], wheel),
        "bored": np.array(bored),
        "clear_1": np.array(clear.wheel_1, np.int64),
        "clear_2": np.array(clear.wheel_2, np.int64),
        "stage_1": np.array(clear.stage_1, np.int64),
        "unit": np.array(clear.units, np.int64),
        "output": clear.output,
    }
