"""[motor], [load] and [duty]: what a servo axis moves, and how."""

import math
from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.servo.ratio import Drive, ServoDuty
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, speed_ratio
from gearopt.units import Quantity

FRICTION = quantity("torque", "0.003 N m", zero=True)
NONE = units.parse("0 N m", "torque")
NEEDS = {"acceleration": (), "move": ("angle",), "swing": ("amplitude", "frequency")}
OWN = {"load_speed": "acceleration", "angle": "move", "amplitude": "swing", "frequency": "swing"}


class Motor(Table):
    """The motor, at its own shaft; with [load] and [duty] the best total ratio is computed."""

    inertia: Annotated[Quantity, quantity("inertia", "8.6e-6 kg m^2")] = Field(
        description="Rotor inertia, with all that turns with the motor's shaft"
    )
    torque: Annotated[Quantity | None, quantity("torque", "0.05 N m")] = Field(
        None,
        description="Torque at standstill; the same up to speed_limit without no_load_speed; of a "
        "swing the maximum rms torque",
    )
    friction: Annotated[Quantity, FRICTION] = Field(
        NONE, description="Coulomb friction torque", json_schema_extra={"default": "0 N m"}
    )
    no_load_speed: Annotated[Quantity | None, quantity("speed", "8000 rpm")] = Field(
        None,
        description="Speed at which the torque has fallen to zero, in a straight line; for an "
        "acceleration at load_speed",
    )
    speed_limit: Annotated[Quantity | None, quantity("speed", "800 rad/s")] = Field(
        None, description="Maximum speed of the motor"
    )


class Load(Table):
    """The load, at the output shaft."""

    inertia: Annotated[Quantity, quantity("inertia", "1.98e-2 kg m^2")] = Field(
        description="Inertia about the output shaft"
    )
    friction: Annotated[Quantity, FRICTION] = Field(
        NONE, description="Coulomb friction torque", json_schema_extra={"default": "0 N m"}
    )
    efficiency: Annotated[Fraction, number("90 %", 0, 1, percent=True)] = Field(
        default_factory=lambda: Fraction(1),
        description="Efficiency of the train while the motor drives",
        json_schema_extra={"default": "100 %"},
    )


class Duty(Table):
    """What the load does, and so what the total ratio is best for; needs [motor] and [load]."""

    motion: Annotated[str, choice(*NEEDS)] = Field(
        "acceleration",
        description="acceleration: the maximum, at standstill or at load_speed; move: through "
        "angle from rest to rest in minimum time; swing: a sine at minimum rms torque",
    )
    load_speed: Annotated[Quantity | None, quantity("speed", "5 rad/s")] = Field(
        None, description="Speed of the load at which it is accelerated; at rest without it"
    )
    angle: Annotated[Quantity | None, quantity("angle", "90 deg")] = Field(
        None, description="Angle of a move"
    )
    amplitude: Annotated[Quantity | None, quantity("angle", "20 deg")] = Field(
        None, description="Amplitude of a swing, to either side"
    )
    frequency: Annotated[Quantity | None, quantity("frequency", "2 Hz")] = Field(
        None, description="Frequency of a swing"
    )
    ratio: Annotated[Fraction | None, speed_ratio(48, 0)] = Field(
        None, description="A total ratio to compare with the best one, without any gears"
    )

    @model_validator(mode="after")
    def _complete(self) -> "Duty":
        for name in NEEDS[self.motion]:
            if getattr(self, name) is None:
                raise refuse(f'is missing: motion = "{self.motion}" needs it', at=(name,))
        for name, motion in OWN.items():
            if getattr(self, name) is not None and self.motion != motion:
                rule = f'is for motion = "{motion}", not for "{self.motion}"'
                raise refuse(rule, at=(name,), action="remove")
        return self

    def check(self, motor: Motor, load: Load) -> None:
        """Check that motor and load suit the motion; refusals are placed below the file."""
        if self.motion == "swing":
            if load.efficiency != 1:
                rule = "is below 1: a swing is computed for a train without losses"
                raise refuse(rule, 1, ("load", "efficiency"))
        elif motor.torque is None:
            raise refuse(f'is missing: motion = "{self.motion}" needs it', at=("motor", "torque"))
        if self.motion != "acceleration" and motor.no_load_speed is not None:
            rule = (
                f'conflicts with motion = "{self.motion}", which takes the torque up to speed_limit'
            )
            raise refuse(rule, at=("motor", "no_load_speed"), action="remove")
        if self.load_speed is None and motor.no_load_speed is not None:
            rule = "changes nothing without load_speed: at standstill the motor has all its torque"
            raise refuse(rule, at=("motor", "no_load_speed"), action="remove")


def servo_duty(duty: Duty, motor: Motor, load: Load) -> ServoDuty:
    """Return motion, motor and load as plain numbers, without gears."""
    free, limit = motor.no_load_speed, motor.speed_limit
    drive = Drive(
        load_inertia=load.inertia.value,
        motor_inertia=motor.inertia.value,
        torque=motor.torque.value if motor.torque else 0.0,
        load_friction=load.friction.value,
        motor_friction=motor.friction.value,
        efficiency=float(load.efficiency),
        no_load_speed=free.value if free else math.inf,
        speed_limit=limit.value if limit else math.inf,
    )
    numbers = {
        name: given.value
        for name in ("load_speed", "angle", "amplitude")
        if (given := getattr(duty, name)) is not None
    }
    turns = 2.0 * math.pi * duty.frequency.value if duty.frequency else 0.0
    most = _max_ratio(duty, motor)
    return ServoDuty(drive, duty.motion, **numbers, angular_frequency=turns, max_ratio=most)


def _max_ratio(duty: Duty, motor: Motor) -> Fraction | None:
    """Return the ratio at which the motor turns at its limit; exact where pi cancels."""
    if motor.speed_limit is None:
        return None
    if duty.load_speed is not None:
        return units.quotient(motor.speed_limit, duty.load_speed)
    if duty.amplitude is None or duty.frequency is None:
        return None
    (angle, power), (limit, other) = duty.amplitude.exact, motor.speed_limit.exact
    rational = limit / (2 * angle * duty.frequency.exact[0])
    power = other - power - 1  # the speed is 2 pi times amplitude and frequency
    return rational if power == 0 else Fraction(float(rational) * math.pi**power)
