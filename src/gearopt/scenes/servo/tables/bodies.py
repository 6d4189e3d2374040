"""Shafts, hub, motor and sector of a servo axis: how large they are, and what they must be."""

import math
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction

from gearopt import units
from gearopt.formulations.servo.split import Bodies
from gearopt.formulations.servo.split.bodies import ROOT
from gearopt.scenes.reading.fields import refuse
from gearopt.scenes.servo.tables.mesh import Mesh
from gearopt.scenes.servo.tables.motion import Duty
from gearopt.scenes.servo.tables.trains import Shaft, Space, Train
from gearopt.units import Quantity

TURN = units.parse("360 deg", "angle")
DIGITS = 12  # of a number that is to be written
TURNED = {"move": ("angle", 1), "swing": ("amplitude", 2)}  # key of the duty, times how often


def bodies(train: Train, shaft: Shaft | None, space: Space | None) -> Bodies:
    """Diameters that gears keep clear of; the output shaft is no thinner than the middle one."""
    thick = shaft.diameter.exact[0] if shaft is not None else Fraction(0)
    output = train.output_shaft_diameter
    outer = space.hub_diameter if space is not None else output
    return Bodies(
        shaft=thick,
        output_shaft=thick if outer is None else outer.exact[0],
        motor=space.motor_diameter.exact[0] if space is not None else Fraction(0),
    )


def half_sweep(train: Train, space: Space) -> float:
    """Angle [rad] that the last wheel sweeps to either side of its mesh line."""
    if space.swept_angle is None:
        return min(2.0 * math.pi * float(train.sector), math.pi)
    return min(0.5 * space.swept_angle.value, math.pi)


def check_shafts(
    train: Train, shaft: Shaft | None, space: Space | None, meshes: tuple[Mesh, ...]
) -> None:
    """Shafts are not thicker than the gears around them; refusals are placed below the file."""
    output = train.output_shaft_diameter
    if space is not None and output is not None and space.hub_diameter.value < output.value:
        rule = f"is below the {output} of output_shaft_diameter in [train], which it surrounds"
        raise refuse(rule, str(output), ("space", "hub_diameter"))
    if shaft is None:
        return
    thick, module = shaft.diameter, min(train.modules)
    least = thick.exact[0] + ROOT * module
    if train.second_pinion_diameter.exact[0] < least:
        rule = (
            f"is too small around a shaft of {thick}: even with the smallest module, "
            f"{float(module):g} mm, the root circle is {float(ROOT):g} modules smaller"
        )
        write = _above(least, train.second_pinion_diameter)
        raise refuse(rule, write, ("train", "second_pinion_diameter"))
    for k, key in ((0, "wheel_teeth"), (1, "pinion_teeth")):
        if not meshes or not meshes[k].given:
            continue
        module_, teeth = meshes[k].module, getattr(meshes[k], key)
        assert module_ is not None
        around = math.ceil(thick.exact[0] / module_.exact[0] + ROOT)
        if teeth < around:
            root = float((teeth - ROOT) * module_.exact[0])
            rule = f"makes a root circle of {root:g} mm, thinner than the shaft of {thick} in it"
            raise refuse(rule, around, ("mesh", k, key))


def check_sector(train: Train, space: Space | None, duty: Duty | None) -> None:
    """The last wheel's sector covers its travel, and its sweep both; placed below the file."""
    own, turned = train.sector, Fraction(0)
    if duty is not None and duty.motion in TURNED:
        name, times = TURNED[duty.motion]
        turned = times * _turns(getattr(duty, name))
        if own < min(turned, Fraction(1)):
            rule = f"is smaller than the {_degrees(turned)} that the load turns by [duty]: the "
            _refuse_sector(rule + "wheel's teeth would leave the pinion", turned)
    if space is None or space.swept_angle is None:
        return
    swept = _turns(space.swept_angle)
    if swept < own:
        rule = f"is below the {_degrees(own)} of the last wheel itself, sector in [train]"
        raise refuse(rule, _degrees(own), ("space", "swept_angle"))
    if 2 * own < swept and own < 1:
        rule = (
            f"is smaller than the travel of {_degrees(swept - own)} that swept_angle = "
            f'"{space.swept_angle}" leaves it: the '
        )
        _refuse_sector(rule + "wheel's teeth would leave the pinion", swept / 2)
    if own < 1 and swept < min(own + turned, Fraction(1)):
        rule = (
            f"is below the {_degrees(own)} of the wheel's sector and the {_degrees(turned)} that "
            "the load turns by [duty] together"
        )
        write = _degrees(min(own + turned, Fraction(1)))
        raise refuse(rule, write, ("space", "swept_angle"))


def _refuse_sector(rule: str, part: Fraction) -> None:
    write = f"{_decimal(100 * min(part, Fraction(1)))} %"
    raise refuse(rule, write, ("train", "sector"))


def _turns(angle: Quantity) -> Fraction:
    return units.quotient(angle, TURN)


def _degrees(part: Fraction) -> str:
    """Part of a turn as an angle, rounded up where it must be."""
    return f"{_decimal(360 * part)} deg"


def _above(length: Fraction, like: Quantity) -> str:
    """A length [mm] in the unit of another one, rounded up where it must be."""
    return f"{_decimal(length / units.UNITS['length'][like.unit][0])} {like.unit}"


def _decimal(value: Fraction) -> str:
    context = Context(prec=DIGITS, rounding=ROUND_CEILING)
    found = context.divide(Decimal(value.numerator), Decimal(value.denominator))
    return f"{found.normalize():f}"
