"""Shafts, hub and motor of a servo train, and which gears they must keep clear of.

Along the shafts there are three planes: the motor, stage 1, stage 2. The motor's shaft ends at gear
1; the middle shaft and the output shaft, which the hub surrounds, pass through all three. What
shares a plane must not overlap:

motor plane: motor and middle shaft (`motor`), motor and output shaft (by the links' angles:
`servo_box`). Stage 1: gear 2 around the middle shaft (`shaft[1]`), gear 2 and output shaft
(`output_shaft`), which leaves gear 1 room too. Stage 2: gear 3 around the middle shaft
(`shaft[2]`), gear 4 around the output shaft (`hub`), which leaves gear 3 room too.
"""

from fractions import Fraction
from math import ceil, lcm
from typing import Any

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.physics.gears import ISO_53_A, GearPair

Pairs = tuple[GearPair, GearPair]  # stage 1 at the motor, stage 2 at the load

# Of a diameter beyond and below the reference circle, in modules.
TIP, ROOT = (2 * Fraction(part) for part in (ISO_53_A.addendum, ISO_53_A.dedendum))
TIGHT = 1.0 + 1e-9  # a tie is no overlap
LARGEST = 2**61  # of whole numbers that are added in 64 bits


@dataclass(frozen=True)
class Bodies:
    """Diameters [mm] of bodies beside the gears, exactly; 0 where one is not known.

    shaft: between the stages. output_shaft: with its hub. motor: its body.
    """

    shaft: Fraction = Fraction(0)
    output_shaft: Fraction = Fraction(0)
    motor: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        if not min(self.shaft, self.output_shaft, self.motor) >= 0:
            raise ValueError("diameters of shafts, hub and motor are not below zero")


def rows(bodies: Bodies, pairs: Pairs) -> dict[str, Any]:
    """Limits of real gears: needed room over the room that there is."""
    shaft, output, motor = (float(d) for d in (bodies.shaft, bodies.output_shaft, bodies.motor))
    first, second = pairs
    d1, d2, d3, d4 = (gear.reference_diameter for pair in pairs for gear in pair.gears)
    limits: dict[str, Any] = {
        "output_shaft": (first.wheel.tip_diameter + output) / (d3 + d4),
        "hub": output / second.wheel.root_diameter,
        "shaft": (shaft / first.wheel.root_diameter, shaft / second.pinion.root_diameter),
    }
    if motor > 0.0:
        limits["motor"] = (motor + shaft) / (d1 + d2)
    return limits


def broken(bodies: Bodies, pairs: Pairs) -> list[str]:
    """Return names of the `rows` that a train breaks; a tie is no overlap."""
    values = {name: v if isinstance(v, tuple) else (v,) for name, v in rows(bodies, pairs).items()}
    return [name for name, parts in values.items() if not all(0.0 <= v <= TIGHT for v in parts)]


def clear_rows(shaft: Any, output: Any, motor: Any, pairs: Pairs) -> dict[str, Any]:
    """Return `rows` relaxed to posynomials of real gears; valid where both ratios are >= 1.

    A sum of reference diameters is at most twice that of the wheel. None: not known.
    """
    first, second = pairs
    m1, m2, root = first.normal_module, second.normal_module, float(ROOT)
    _, d2, d3, d4 = (gear.reference_diameter for pair in pairs for gear in pair.gears)
    beside = first.wheel.tip_diameter if output is None else first.wheel.tip_diameter + output
    limits: dict[str, Any] = {"output_shaft": beside / (2.0 * d4)}
    if output is not None:
        limits["hub"] = (output + root * m2) / d4
    if shaft is not None:
        limits["shaft"] = ((shaft + root * m1) / d2, (shaft + root * m2) / d3)
    if motor is not None:
        limits["motor"] = (motor if shaft is None else motor + shaft) / (2.0 * d2)
    return limits


@dataclass(frozen=True)
class MinimumTeeth:
    """The limits of `rows` in whole numbers, by module of the stage.

    wheel_1, pinion_2, wheel_2: minimum numbers of teeth. stage_1: minimum z1 + z2. Gear 2 keeps
    clear of the output shaft where units[i] (z2 + 2) + output <= units[j] (z3 + z4).
    """

    wheel_1: list[int]
    pinion_2: list[int]
    wheel_2: list[int]
    stage_1: list[int]
    units: list[int]
    output: int


def minimum_teeth(bodies: Bodies | None, modules: tuple[Fraction, ...], wheel: int) -> MinimumTeeth:
    """Return these limits, decided in fractions; no limits without bodies.

    wheel: maximum number of teeth of a wheel. SolveError where 64 bits do not hold the whole
    numbers.
    """
    none = [0] * len(modules)
    if bodies is None:
        return MinimumTeeth(none, none, none, none, none, 0)
    unit = Fraction(1, lcm(*(m.denominator for m in modules)))
    # Whole units on both sides: a shaft of a part of one more needs that one.
    units, output = [int(m / unit) for m in modules], ceil(bodies.output_shaft / unit)
    if max(units) * (wheel + 2) + output > LARGEST:
        raise SolveError("modules cannot be compared exactly: write them with fewer digits")
    beside = bodies.motor + bodies.shaft
    return MinimumTeeth(
        wheel_1=_around(bodies.shaft, modules),
        pinion_2=_around(bodies.shaft, modules),
        wheel_2=_around(bodies.output_shaft, modules),
        stage_1=[-(-beside // m) for m in modules] if bodies.motor > 0 else none,
        units=units,
        output=output,
    )


def _around(diameter: Fraction, modules: tuple[Fraction, ...]) -> list[int]:
    """Return the minimum number of teeth of a gear whose root circle is not inside a shaft."""
    return [-(-(diameter / m + ROOT) // 1) for m in modules]
