"""The given motor, its gears and its load, and the rows that all duties share."""

import math
from dataclasses import fields, replace
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Var

SEARCH_SPAN = 1e6  # factor between natural scales and the ends of the search: they never bind
FAINT = 1e-30  # of the largest acceleration: what is slower counts as not moving

_UNITS = {"inertia": "t mm2", "torque": "N mm", "friction": "N mm"} | dict.fromkeys(
    ("limit", "speed"), "rad/s"
)
_KEYS = {  # names of numbers as a problem file has them
    **{name: f"motor.{name}" for name in ("torque", "no_load_speed", "speed_limit")},
    **{"motor_inertia": "motor.inertia", "motor_friction": "motor.friction"},
    **{"load_inertia": "load.inertia", "load_friction": "load.friction"},
    "efficiency": "load.efficiency",
}
_ROLES = {"torque": "limit", "speed_limit": "limit", "load_inertia": "given"}


@dataclass(frozen=True)
class Drive:
    """A motor, a gear train and a load; inertias [t mm2], torques [N mm], speeds [rad/s].

    gear_inertia: of the train, seen at the motor. torque: of the motor at standstill, falling to 0
    at no_load_speed. Frictions are Coulomb torques, each at its own shaft. efficiency: of the train
    while the motor drives. ratio: minimum and maximum (inf: none) total ratio, motor over load
    speed.
    """

    load_inertia: float
    motor_inertia: float
    torque: float = 0.0
    load_friction: float = 0.0
    motor_friction: float = 0.0
    gear_inertia: float = 0.0
    efficiency: float = 1.0
    no_load_speed: float = math.inf
    speed_limit: float = math.inf
    ratio: tuple[float, float] = (1.0, math.inf)

    def __post_init__(self) -> None:
        numbers = [getattr(self, f.name) for f in fields(self) if f.name != "ratio"]
        if not all(value >= 0.0 for value in numbers):
            raise ValueError("a drive has no negative inertia, torque, friction or speed")
        if not 0.0 < self.efficiency <= 1.0:
            raise ValueError(f"efficiency {self.efficiency!r} is not above 0 and at most 1")
        if self.load_inertia + self.inertia == 0.0:
            raise ValueError("a drive without any inertia has no finite acceleration")
        if not 0.0 < self.ratio[0] <= self.ratio[1] or self.ratio[0] == math.inf:
            raise ValueError(
                f"ratio {self.ratio!r}: needs 0 < minimum <= maximum, the minimum finite"
            )

    @property
    def inertia(self) -> float:
        """Return the inertia of motor and gears [t mm2] at the motor."""
        return self.motor_inertia + self.gear_inertia

    @property
    def net_torque(self) -> float:
        """Return the torque [N mm] at standstill that the motor's friction leaves."""
        return self.torque - self.motor_friction

    @property
    def braking_torque(self) -> float:
        """Return the torque [N mm] of the motor and its friction, which both brake."""
        return self.torque + self.motor_friction

    def needs(self, **numbers: float) -> None:
        """Raise ValueError where a number that a duty needs is not positive and finite."""
        for name, value in numbers.items():
            if not 0.0 < value < math.inf:
                raise ValueError(f"{name} = {value!r}: this duty needs a positive number")

    def ratios(self, load_speed: float = 0.0) -> tuple[float, float]:
        """Return the minimum and maximum ratio, within the motor's speed limit at a load speed."""
        return self.ratio[0], min(self.ratio[1], quotient(self.speed_limit, load_speed))

    def parameters(self, *unused: str) -> tuple[Param, ...]:
        """Return the drive's positive, finite numbers, without those that a duty has no use for.

        What is 0 or infinite has no place in a text.
        """
        names = [f.name for f in fields(self) if f.name not in ("ratio", *unused)]
        values = {n: getattr(self, n) for n in names if 0.0 < getattr(self, n) < math.inf}
        low, high = self.ratio
        values["ratio" if low == high else "ratio_low"] = low
        if low < high < math.inf:
            values["ratio_high"] = high
        return tuple(
            Param(n, _UNITS.get(n.split("_")[-1], ""), v, key=_KEYS.get(n, ""), role=_role(n))
            for n, v in values.items()
        )

    def of(self, values: dict[str, float]) -> "Drive":
        """Return the drive with other values of its `parameters`."""
        given = values.get("ratio")
        low, high = values.get("ratio_low", given), values.get("ratio_high", given or math.inf)
        numbers: dict[str, Any] = {f.name: values[f.name] for f in fields(self) if f.name in values}
        return replace(self, **numbers | {"ratio": (low, high)})

    def ratio_variable(self, scales: tuple[float, ...], free: bool) -> Var:
        """Return the variable of the total ratio; free: nothing holds it from above.

        scales: ratios at which something of the duty changes, infinite and zero ones not counted.
        """
        known = [float(s) for s in (*scales, *self.ratio) if 0.0 < s < math.inf]
        high = math.inf if free else SEARCH_SPAN * max(known)
        middle = math.exp(sum(map(math.log, known)) / len(known))
        guess = max(self.ratio[0], min(self.ratio[1], middle))
        return Var("ratio", "", min(known) / SEARCH_SPAN, high, guess, log=True, search=True)

    def torque_needed(self, p: Any, ratio: Any, acceleration: Any) -> Any:
        """Return the text of the motor's torque while it accelerates the load, no falling line."""
        inertia = inertia_at_motor(self, p, ratio, p.efficiency)
        return friction_torque(self, p, ratio, p.efficiency) + acceleration * inertia

    def ratio_rows(self, p: Any, ratio: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the text of the user's ratios: limits, or an equality where there is only one."""
        if self.ratio[0] == self.ratio[1]:
            return {}, {"ratio": ratio / p.ratio}
        limits = {"ratio_low": p.ratio_low / ratio}
        if self.ratio[1] < math.inf:
            limits["ratio_high"] = ratio / p.ratio_high
        return limits, {}


def friction_torque(drive: Drive, p: Any, ratio: Any, efficiency: Any) -> Any:
    """Return the text of the motor torque lost to friction: F_M + F_L/(eta N) [N mm]."""
    torque = p.motor_friction if drive.motor_friction else 0.0
    if drive.load_friction:
        torque = torque + p.load_friction / (efficiency * ratio)
    return torque


def inertia_at_motor(drive: Drive, p: Any, ratio: Any, efficiency: Any) -> Any:
    """Return the text of motor torque per load acceleration: J_L/(eta N) + N J [t mm2]."""
    inertia = p.load_inertia / (efficiency * ratio) if drive.load_inertia else 0.0
    for name in ("motor_inertia", "gear_inertia"):
        if getattr(drive, name):
            inertia = inertia + getattr(p, name) * ratio
    return inertia


def present(problem: Problem) -> dict[str, float]:
    """Return the present values of a problem's parameters, all of size 1."""
    names = [q.name for q in problem.parameters]
    return dict(zip(names, map(float, problem.parameter_values()), strict=True))


def quotient(a: float, b: float) -> float:
    """Return the quotient a/b of numbers >= 0; infinite where b is 0."""
    return a / b if b > 0.0 else math.inf


def _role(name: str) -> str:
    return "limit" if name.startswith("ratio") else _ROLES.get(name, "data")
