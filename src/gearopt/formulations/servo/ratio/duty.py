"""The motion of a load with the motor that drives it: values of every ratio and gear inertia."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.formulations.servo.ratio.acceleration import acceleration
from gearopt.formulations.servo.ratio.drive import FAINT, Drive
from gearopt.formulations.servo.ratio.move import least_move_time
from gearopt.formulations.servo.ratio.swing import swing
from gearopt.formulations.servo.servo_design import MOTIONS
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.physics.servo_drive import (
    load_acceleration,
    load_deceleration,
    mean_ramp,
    rms_torque,
    shortest_move_time,
    torque_slope,
)


@dataclass(frozen=True)
class ServoDuty:
    """A motion of the load and the drive that makes it; angles in rad, speeds in rad/s.

    motion: acceleration, at load_speed; move, through angle from rest to rest; swing, as
    amplitude sin(angular_frequency t). max_ratio: that the motor's speed limit allows, exactly;
    None where it allows any.
    """

    drive: Drive
    motion: str
    load_speed: float = 0.0
    angle: float = 0.0
    amplitude: float = 0.0
    angular_frequency: float = 0.0
    max_ratio: Fraction | None = None

    @property
    def goal(self) -> str:
        """Name of the `Goal` that is minimised."""
        return MOTIONS[self.motion].name

    @property
    def speed(self) -> float:
        """Return the speed of the load [rad/s] at which the motor must keep to its limit."""
        if self.motion == "swing":
            return self.amplitude * self.angular_frequency
        return self.load_speed

    @property
    def slope(self) -> float:
        """Return the torque [N mm] that the motor loses per unit of ratio at the load's speed."""
        slope: float = torque_slope(self.drive.torque, self.speed, self.drive.no_load_speed)
        return slope if self.motion == "acceleration" else 0.0

    @property
    def peak_acceleration(self) -> float:
        """Return the largest acceleration of a swing [rad/s2]."""
        return self.amplitude * self.angular_frequency**2

    def with_gears(self, inertia: Any) -> "ServoDuty":
        """Return the duty of a train with this inertia [t mm2] at the motor."""
        return replace(self, drive=replace(self.drive, gear_inertia=inertia))

    def problem(self) -> Problem:
        """Return the problem of the best ratio."""
        if self.motion == "move":
            return least_move_time(self.drive, self.angle)
        if self.motion == "swing":
            return swing(self.drive, self.amplitude, self.angular_frequency)
        return acceleration(self.drive, self.load_speed)

    def acceleration(self, ratio: Any, gears: Any = 0.0) -> Any:
        """Return the load's acceleration [rad/s2] at its speed; at most 0 where it does not move.

        gears: inertia of the train at the motor [t mm2], beside that of the drive.
        """
        drive = self.drive
        inertia = drive.inertia + gears
        numbers = (
            drive.load_inertia,
            inertia,
            drive.net_torque,
            drive.load_friction,
            drive.efficiency,
        )
        return load_acceleration(ratio, *numbers, self.slope)

    def deceleration(self, ratio: Any, gears: Any = 0.0) -> Any:
        """Return the load's deceleration [rad/s2] while the motor brakes; gears: see above."""
        drive = self.drive
        inertias = drive.load_inertia, drive.inertia + gears
        return load_deceleration(ratio, *inertias, drive.braking_torque, drive.load_friction)

    def value(self, ratio: Any, gears: Any = 0.0) -> Any:
        """Objective [s2/rad, s or N mm]; very large where the load does not move."""
        drive = self.drive
        if self.motion == "swing":
            inertias = drive.load_inertia, drive.inertia + gears
            frictions = drive.load_friction, drive.motor_friction
            return rms_torque(ratio, *inertias, self.peak_acceleration, *frictions)
        # no ratio gives 1/FAINT times less than the torque on the load alone
        slowest = FAINT * drive.torque / max(drive.load_inertia, drive.inertia)
        rate = np.maximum(self.acceleration(ratio, gears), slowest)
        if self.motion == "acceleration":
            return 1.0 / rate
        ramp = mean_ramp(rate, self.deceleration(ratio, gears))
        return shortest_move_time(self.angle, drive.speed_limit / ratio, ramp)

    def carried_torque(self, ratio: Any, gears: Any, beyond: Any) -> Any:
        """Return the peak torque [N mm] through a mesh, seen at the motor.

        (J_L a + F_L)/(eta N) + J N a, a the largest acceleration, J = beyond what turns after the
        mesh [t mm2, at the motor]; of a move the braking torque (J_L d - F_L)/N + J N d where that
        is larger. A motor that falls in speed has most torque at standstill; where the load does
        not move, all of it loads the teeth. gears: inertia of the train, seen at the motor.
        """
        drive = self.drive
        load, friction, eta = drive.load_inertia, drive.load_friction, drive.efficiency
        if self.motion == "swing":
            peak = self.peak_acceleration
            return (load * peak + friction) / ratio + beyond * ratio * peak
        inertia = drive.inertia + gears
        ramp = load_acceleration(ratio, load, inertia, drive.net_torque, friction, eta)
        ramp = np.maximum(ramp, 0.0)
        starting = (load * ramp + friction) / (eta * ratio) + beyond * ratio * ramp
        starting = np.minimum(starting, drive.net_torque)
        if self.motion != "move":
            return starting
        ramp = self.deceleration(ratio, gears)
        braking = (load * ramp - friction) / ratio + beyond * ratio * ramp
        return np.maximum(starting, braking)

    @property
    def minimum_load_torque(self) -> float:
        """Return a torque at the load [N mm] that every train must carry; 0 where none is known."""
        if self.motion != "swing":
            return 0.0
        return self.drive.load_inertia * self.peak_acceleration + self.drive.load_friction

    def limits(self, ratio: Any, value: Any) -> dict[str, Any]:
        """Return the utilisations of the motor at a ratio; value: that of the duty there.

        friction_torque: torque that friction takes over that which the motor has at its speed.
        """
        drive, used = self.drive, {}
        if self.motion != "swing":
            lost = drive.load_friction / (drive.efficiency * ratio) + self.slope * ratio
            used["friction_torque"] = (drive.motor_friction + lost) / drive.torque
        elif drive.torque:
            used["motor_torque"] = value / drive.torque
        if self.speed and math.isfinite(drive.speed_limit):
            used["motor_speed"] = ratio * self.speed / drive.speed_limit
        return used
