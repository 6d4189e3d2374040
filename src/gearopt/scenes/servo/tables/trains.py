"""[train], [shaft], [stiffness], [lightest] and [space]: a two-stage servo train and its limits."""

import math
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split import Bodies
from gearopt.formulations.servo.split.bodies import ROOT
from gearopt.scenes.reading.fields import (
    Table,
    choice,
    number,
    quantity,
    refuse,
    speed_ratio,
    truth,
    whole,
)
from gearopt.scenes.reading.lists import several, span
from gearopt.scenes.reading.module_series import series
from gearopt.scenes.servo.tables.mesh import Mesh
from gearopt.scenes.servo.tables.motion import Duty
from gearopt.units import Quantity

TURN = units.parse("360 deg", "angle")
DIGITS = 12  # of a number that is to be written
TURNED = {"move": ("angle", 1), "swing": ("amplitude", 2)}  # key of the duty, times how often
LENGTH = quantity("length", "6 mm")
AIMS = {goal.label.replace(" ", "_"): goal for goal in GOALS.values()}  # by the word of a file


class Train(Table):
    """Two stages of spur gears whose teeth and modules are chosen."""

    ratio: Annotated[tuple[Fraction, Fraction], span(speed_ratio(48, 1), 48, single=True)] = Field(
        description="Total ratio, motor over load speed; or a range [minimum, maximum]"
    )
    ratio_tolerance: Annotated[
        Fraction | None, number("1 %", 0, Fraction(1, 2), percent=True, zero=True)
    ] = Field(
        None,
        description="Allowed relative deviation of a single ratio",
        json_schema_extra={"default": "1 %"},
    )
    modules: Annotated[
        tuple[Quantity, ...], series(quantity("module", "0.5 mm", limit="50 mm"))
    ] = Field(description="Modules to choose from: a series or a list, also of 1/in")
    pinion_teeth: Annotated[tuple[int, int], span(whole(16, 12, 200), [16, 60])] = Field(
        description="Minimum and maximum number of teeth of both pinions"
    )
    wheel_teeth: Annotated[int | None, whole(300, 12, 1000)] = Field(
        None, description="Maximum number of teeth of a wheel"
    )
    face_width: Annotated[Quantity, LENGTH] = Field(description="Face width of all gears")
    density: Annotated[Quantity, quantity("density", "7.75 g/cm^3")] = Field(
        description="Density of gears and shaft (the mass of a train is that of its gears)"
    )
    sector: Annotated[Fraction, number("25 %", 0, 1, percent=True)] = Field(
        default_factory=lambda: Fraction(1),
        description="Part of a full disc that the last wheel is",
        json_schema_extra={"default": "100 %"},
    )
    second_pinion_diameter: Annotated[Quantity, quantity("length", "11.5 mm")] = Field(
        description="Minimum reference diameter of the second pinion, around its shaft"
    )
    output_shaft_diameter: Annotated[Quantity | None, quantity("length", "10 mm")] = Field(
        None,
        description="Diameter of the output shaft, which the first wheel keeps clear of; by "
        "default hub_diameter of [space], without it the diameter of [shaft]",
    )
    wheel_tip_diameters: Annotated[
        tuple[Quantity, ...],
        several(quantity("length", "80 mm"), ["80 mm", "106 mm"], in_order=True),
    ] = Field(description="Maximum tip diameters of the wheels of stage 1 and 2")
    output_torque: Annotated[Quantity | None, quantity("torque", "2.4 N m")] = Field(
        None,
        description="Peak torque at the output; with [duty] the teeth also carry what the motion "
        "puts on them, and it may be left out",
    )
    bending_stress: Annotated[Quantity, quantity("stress", "150 MPa")] = Field(
        description="Allowed bending stress after Lewis, without any factor"
    )
    minimise: Annotated[str, choice(*AIMS, means={"weight": "mass"})] = Field(
        "inertia",
        description="inertia (of the train at the motor), mass (or weight) or error; move_time or "
        "rms_torque of [duty], with ratio and train chosen together",
    )
    maximise: Annotated[str | None, choice("acceleration")] = Field(
        None,
        description="Instead of minimise: acceleration of [duty], with ratio and train chosen "
        "together",
    )

    @model_validator(mode="after")
    def _complete(self) -> "Train":
        if self.maximise is not None and "minimise" in self.model_fields_set:
            raise refuse("conflicts with maximise", at=("minimise",), action="remove")
        low, high = self.ratio
        if low != high and self.ratio_tolerance is not None:
            rule = "conflicts with a range of ratios"
            raise refuse(rule, at=("ratio_tolerance",), action="remove")
        if len(self.wheel_tip_diameters) != 2:
            texts = [str(q) for q in (*self.wheel_tip_diameters, *self.wheel_tip_diameters)]
            rule = "does not name both wheels, of stage 1 and of stage 2"
            raise refuse(rule, texts[:2], ("wheel_tip_diameters",), "sample")
        return self

    @property
    def aim(self) -> str:
        """Return the objective as the file calls it."""
        return self.maximise or self.minimise

    @property
    def goal(self) -> str:
        """Objective that is minimised, of a `ServoTrain`."""
        return AIMS[self.aim].name

    @property
    def ratios(self) -> tuple[Fraction, Fraction]:
        """Return the middle of the allowed total ratios, and the relative tolerance about it."""
        low, high = self.ratio
        if low == high:
            tolerance = self.ratio_tolerance
            return low, Fraction(1, 100) if tolerance is None else tolerance
        return (low + high) / 2, (high - low) / (high + low)


class Shaft(Table):
    """The shaft between the stages, solid and round; needs [train]."""

    diameter: Annotated[Quantity, quantity("length", "8 mm")] = Field(description="Diameter")
    length: Annotated[Quantity, quantity("length", "50 mm")] = Field(
        description="Length between the gears, which is twisted and whose inertia counts"
    )


class Stiffness(Table):
    """Stiffness of meshes and shaft at the output, motor locked; needs [train] and [shaft]."""

    shear_modulus: Annotated[Quantity, quantity("stress", "79 GPa")] = Field(
        description="Shear modulus of the shaft"
    )
    line_stiffness: Annotated[Quantity | None, quantity("stress", "10300 MPa")] = Field(
        None, description="Stiffness of a mesh per face width (or give youngs_modulus)"
    )
    youngs_modulus: Annotated[Quantity | None, quantity("stress", "206 GPa")] = Field(
        None, description="Young's modulus of the gears: a mesh's stiffness then follows from teeth"
    )
    mesh_variation: Annotated[Fraction | None, number("50 %", 0, 1, percent=True)] = Field(
        None,
        description="Variation of the stiffness of a mesh while teeth pass through it, largest "
        "less smallest over the mean, which the keys above then give: limits hold where it is "
        "smallest, and the windup by load_torque that varies is an error",
    )
    frequency: Annotated[Quantity | None, quantity("frequency", "200 Hz")] = Field(
        None, description="Minimum natural frequency of the load, motor locked; needs [load]"
    )
    load_torque: Annotated[Quantity | None, quantity("torque", "4.3 kgf cm")] = Field(
        None, description="Torque at the output under which the train winds up"
    )
    windup: Annotated[Quantity | None, quantity("angle", "0.001 deg", limit="90 deg")] = Field(
        None, description="Maximum windup; needs load_torque"
    )

    @model_validator(mode="after")
    def _complete(self) -> "Stiffness":
        if self.line_stiffness is None and self.youngs_modulus is None:
            rule = "is missing (or give youngs_modulus)"
            raise refuse(rule, "10300 MPa", ("line_stiffness",), "sample")
        if self.line_stiffness is not None and self.youngs_modulus is not None:
            raise refuse("conflicts with line_stiffness", at=("youngs_modulus",), action="remove")
        if self.windup is not None and self.load_torque is None:
            raise refuse("is missing beside windup", at=("load_torque",))
        return self


class Lightest(Table):
    """The lightest train of real-valued sizes that is stiff enough; needs [stiffness].

    Modules are the first one of [train]; face widths and the shaft's diameter are free.
    """

    face_width: Annotated[Quantity, quantity("length", "2 mm")] = Field(
        description="Smallest face width that either stage may have"
    )
    shaft_diameter: Annotated[Quantity, quantity("length", "3 mm")] = Field(
        description="Minimum diameter of the shaft between the stages"
    )
    shaft_wall: Annotated[Quantity, quantity("length", "3.5 mm", zero=True)] = Field(
        description="Minimum difference of the second pinion's reference diameter and the shaft's"
    )
    inertia: Annotated[Quantity, quantity("inertia", "8e-7 kg m^2")] = Field(
        description="Maximum inertia of the train at the motor"
    )


class Space(Table):
    """A box that the train lies in, seen along its shafts; needs [train]."""

    width: Annotated[Quantity, quantity("length", "80 mm")] = Field(description="Inner width")
    height: Annotated[Quantity, quantity("length", "130 mm")] = Field(description="Inner height")
    motor_diameter: Annotated[Quantity, quantity("length", "24 mm")] = Field(
        description="Diameter of the motor, which both other shafts keep clear of"
    )
    hub_diameter: Annotated[Quantity, quantity("length", "16 mm", zero=True)] = Field(
        description="Diameter of the output shaft with its hub, over its whole length; motor and "
        "gears keep clear of it"
    )
    swept_angle: Annotated[Quantity | None, quantity("angle", "180 deg", limit="360 deg")] = Field(
        None,
        description="Angle swept by the last wheel, its sector and its travel together; by "
        "default twice its sector, as far as its teeth reach, at most 360 deg",
    )
    required: Annotated[bool, truth()] = Field(
        True,
        description="true: only trains that fit are chosen; false: the best train, even if it "
        "does not fit",
    )


def bodies(train: Train, shaft: Shaft | None, space: Space | None) -> Bodies:
    """Return diameters that gears keep clear of; the output shaft is at least the middle one's."""
    thick = shaft.diameter.exact[0] if shaft is not None else Fraction(0)
    output = train.output_shaft_diameter
    outer = space.hub_diameter if space is not None else output
    return Bodies(
        shaft=thick,
        output_shaft=thick if outer is None else outer.exact[0],
        motor=space.motor_diameter.exact[0] if space is not None else Fraction(0),
    )


def half_sweep(train: Train, space: Space) -> float:
    """Return the angle [rad] that the last wheel sweeps to either side of its mesh line."""
    if space.swept_angle is None:
        return min(2.0 * math.pi * float(train.sector), math.pi)
    return min(0.5 * space.swept_angle.value, math.pi)


def check_shafts(
    train: Train, shaft: Shaft | None, space: Space | None, meshes: tuple[Mesh, ...]
) -> None:
    """Check that shafts fit into their gears; refusals are placed below the file."""
    output = train.output_shaft_diameter
    if space is not None and output is not None and space.hub_diameter.value < output.value:
        rule = f"is below the {output} of output_shaft_diameter in [train], which it surrounds"
        raise refuse(rule, str(output), ("space", "hub_diameter"))
    if shaft is None:
        return
    thick, module = shaft.diameter, min(m.exact[0] for m in train.modules)
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
    """Check that sector and sweep of the last wheel cover its travel; placed below the file."""
    sector, turned = train.sector, Fraction(0)
    if duty is not None and duty.motion in TURNED:
        name, times = TURNED[duty.motion]
        turned = times * _turns(getattr(duty, name))
        if sector < min(turned, Fraction(1)):
            rule = f"is smaller than the {_degrees(turned)} that the load turns by [duty]: the "
            _refuse_sector(rule + "wheel's teeth would leave the pinion", turned)
    if space is None or space.swept_angle is None:
        return
    swept = _turns(space.swept_angle)
    if swept < sector:
        rule = f"is below the {_degrees(sector)} of the last wheel itself, sector in [train]"
        raise refuse(rule, _degrees(sector), ("space", "swept_angle"))
    if 2 * sector < swept and sector < 1:
        rule = (
            f"is smaller than the travel of {_degrees(swept - sector)} that swept_angle = "
            f'"{space.swept_angle}" leaves it: the '
        )
        _refuse_sector(rule + "wheel's teeth would leave the pinion", swept / 2)
    if sector < 1 and swept < min(sector + turned, Fraction(1)):
        rule = (
            f"is below the {_degrees(sector)} of the wheel's sector and the {_degrees(turned)} "
            "that the load turns by [duty] together"
        )
        write = _degrees(min(sector + turned, Fraction(1)))
        raise refuse(rule, write, ("space", "swept_angle"))


def _refuse_sector(rule: str, part: Fraction) -> None:
    write = f"{_decimal(100 * min(part, Fraction(1)))} %"
    raise refuse(rule, write, ("train", "sector"))


def _turns(angle: Quantity) -> Fraction:
    return units.quotient(angle, TURN)


def _degrees(part: Fraction) -> str:
    """Return part of a turn as an angle, rounded up where it must be."""
    return f"{_decimal(360 * part)} deg"


def _above(length: Fraction, like: Quantity) -> str:
    """Return a length [mm] in the unit of another one, rounded up where it must be."""
    return f"{_decimal(length / units.UNITS['length'][like.unit][0])} {like.unit}"


def _decimal(value: Fraction) -> str:
    context = Context(prec=DIGITS, rounding=ROUND_CEILING)
    quotient = context.divide(Decimal(value.numerator), Decimal(value.denominator))
    return f"{quotient.normalize():f}"
