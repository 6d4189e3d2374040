"""The tables of a strain wave gearing: duty, gears, wave generator, material, sharing, design."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt.formulations.strain_wave.cutter_report import CONJUGATE, DEFORMED, MODIFIED
from gearopt.formulations.strain_wave.design import INVOLUTE
from gearopt.formulations.strain_wave.swept_report import DOUBLE_ARC, HALF_LOCUS
from gearopt.physics.strain_wave.gearing import WAVES
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.scenes.reading.lists import span
from gearopt.units import Quantity

RANGES = {  # of what a design may choose, beside modules of the size asked for
    "profile_shift": (0.0, 2.0),
    "pressure_angle": (15.0, 30.0),
    "deflection": (0.97, 1.25),
    "addendum": (0.4, 0.9),
}
LEAST_ADDENDUM = Fraction(1, 20)  # modules; shorter teeth do not reach each other
SPLINE, OUTPUT = "circular spline", "output"  # where the torque that the teeth carry is taken
MODULES = (0.8, 1.1)  # of the module that fits the outer diameter
RIMS = (4.0 / 900.0, 14.0 / 900.0)  # of the outer diameter


class WaveDuty(Table):
    """What the gearing must do; the circular spline is at rest."""

    torque: Annotated[Quantity, quantity("torque", "100 N m")] = Field(
        description="Torque at the output, the flexspline"
    )
    ratio: Annotated[int, whole(80, 30, 320)] = Field(
        description="Reduction: half the teeth of the flexspline"
    )
    outer_diameter: Annotated[Quantity | None, quantity("length", "90 mm")] = Field(
        None, description="Maximum outer diameter; needed where gears are chosen"
    )


class WaveGears(Table):
    """Sizes of the gearing; the six that are left out are chosen."""

    module: Annotated[Quantity | None, quantity("module", "0.5 mm")] = Field(
        None, description="Module of both gears"
    )
    pressure_angle: Annotated[Quantity | None, quantity("angle", "20 deg", "40 deg")] = Field(
        None, description="Pressure angle of the circular spline"
    )
    profile_shift: Annotated[Fraction | None, number(0.9, -2, 5, zero=True)] = Field(
        None, description="Profile shift of the circular spline in modules"
    )
    addendum: Annotated[Fraction | None, number(0.6, LEAST_ADDENDUM, 2)] = Field(
        None, description="Half the working depth of the circular spline in modules"
    )
    deflection: Annotated[Fraction | None, number(1, 0, 2)] = Field(
        None, description="Largest radial deflection of the flexspline in modules"
    )
    rim: Annotated[Quantity | None, quantity("length", "0.8 mm")] = Field(
        None, description="Thickness of the flexspline below its teeth"
    )
    clearance: Annotated[Fraction, number(0.25, 0, 1)] = Field(
        Fraction(1, 4),
        description="Bottom clearance in modules",
        json_schema_extra={"default": 0.25},
    )
    face_width: Annotated[Quantity | None, quantity("length", "10 mm")] = Field(
        None, description="Face width; by default 1/9 of the outer diameter"
    )
    shell: Annotated[Quantity | None, quantity("length", "3 mm")] = Field(
        None,
        description="Thickness of the circular spline outside its roots; by default 1/30 of the "
        "outer diameter, of given gears six modules",
    )


class WaveTeeth(Table):
    """How the teeth are made. Laws but the involute are of the flexspline, and of given gears."""

    law: Annotated[str, choice(INVOLUTE, DOUBLE_ARC, HALF_LOCUS)] = Field(
        INVOLUTE,
        description="Law of the teeth: involutes of the circular spline, double circular arcs of "
        "the flexspline, or half the locus of its motion; the other gear's teeth follow",
    )
    thickness: Annotated[Quantity | None, quantity("length", "0.8 mm")] = Field(
        None,
        description="Thickness of the flexspline's teeth at half their height, of arcs and locus; "
        "by default half the pitch",
    )
    convex_radius: Annotated[Quantity | None, quantity("length", "0.7 mm")] = Field(
        None, description="Radius of the arc at the tip of double arcs; by default 1.37 modules"
    )
    concave_radius: Annotated[Quantity | None, quantity("length", "0.8 mm")] = Field(
        None, description="Radius of the arc at the root of double arcs; by default 1.57 modules"
    )
    tangent: Annotated[Quantity | None, quantity("length", "0.05 mm", zero=True)] = Field(
        None,
        description="Length of the common tangent of double arcs; by default a tenth of the module",
    )

    @model_validator(mode="after")
    def _of_the_law(self) -> "WaveTeeth":
        arcs = ("convex_radius", "concave_radius", "tangent")
        idle = {INVOLUTE: ("thickness", *arcs), HALF_LOCUS: arcs, DOUBLE_ARC: ()}[self.law]
        for name in idle:
            if getattr(self, name) is not None:
                rule = f'changes nothing: law = "{self.law}" needs no {name}'
                raise refuse(rule, at=(name,), action="remove")
        return self


class WaveGenerator(Table):
    """The wave generator: the neutral curve that it gives the flexspline."""

    shape: Annotated[str, choice(*WAVES)] = Field(
        "cosine", description="Neutral curve: cos 2 phi, an ellipse, or over two discs"
    )
    wrap_angle: Annotated[Quantity | None, quantity("angle", "30 deg", "80 deg")] = Field(
        None, description="Half the angle over which each disc carries, of discs; by default 30 deg"
    )

    @model_validator(mode="after")
    def _of_discs(self) -> "WaveGenerator":
        if self.wrap_angle is not None and self.shape != "discs":
            rule = f'changes nothing: shape = "{self.shape}" has no discs'
            raise refuse(rule, at=("wrap_angle",), action="remove")
        return self


class WaveMaterial(Table):
    """Material of flexspline and circular spline; fatigue limits are assumed where left out."""

    elastic_modulus: Annotated[Quantity | None, quantity("stress", "206 GPa")] = Field(
        None, description="Modulus of elasticity; by default 206 GPa"
    )
    poisson_ratio: Annotated[Fraction, number(0.3, 0, Fraction(49, 100), zero=True)] = Field(
        Fraction(3, 10), description="Poisson's ratio", json_schema_extra={"default": 0.3}
    )
    bending_limit: Annotated[Quantity | None, quantity("stress", "400 MPa")] = Field(
        None, description="Fatigue limit of the rim in alternating bending; by default 400 MPa"
    )
    shear_limit: Annotated[Quantity | None, quantity("stress", "230 MPa")] = Field(
        None, description="Fatigue limit of the rim in shear; by default 230 MPa"
    )


class WaveSharing(Table):
    """How the teeth share the load."""

    torque_of: Annotated[str, choice(SPLINE, OUTPUT)] = Field(
        SPLINE,
        description="Torque that the teeth carry: that of the circular spline, 1 + "
        "1/ratio times the output's, or the output's, as Jun and Oh have it",
    )
    rim: Annotated[str, choice("rigid", "elastic")] = Field(
        "rigid", description="Whether the rim yields to the loads of its teeth"
    )
    pair_compliance: Annotated[Quantity | None, quantity("compliance", "10 um/kN")] = Field(
        None,
        description="Compliance of two teeth in contact; by default that of 10 N/(mm um) over the "
        "face width",
    )
    wall_over_rim: Annotated[Fraction, number(0.6, 0, 1)] = Field(
        Fraction(3, 5),
        description="Thickness of the cup's wall over that of the rim",
        json_schema_extra={"default": 0.6},
    )
    cup_length: Annotated[Quantity | None, quantity("length", "30 mm")] = Field(
        None, description="Length of the cup; by default three face widths"
    )


class WaveLimits(Table):
    """Ranges and limits of what is chosen. Strength data are assumed where left out."""

    module: Annotated[
        tuple[Quantity, Quantity] | None, span(quantity("module", "0.5 mm"), ["0.4 mm", "0.56 mm"])
    ] = Field(None, description="Range of the module")
    pressure_angle: Annotated[
        tuple[Quantity, Quantity] | None,
        span(quantity("angle", "20 deg", "40 deg"), ["15 deg", "30 deg"]),
    ] = Field(None, description="Range of the pressure angle; by default 15 to 30 deg")
    profile_shift: Annotated[
        tuple[Fraction, Fraction] | None, span(number(0.9, -2, 5, zero=True), [0, 2])
    ] = Field(None, description="Range of the profile shift; by default 0 to 2")
    addendum: Annotated[
        tuple[Fraction, Fraction] | None, span(number(0.6, LEAST_ADDENDUM, 2), [0.4, 0.9])
    ] = Field(None, description="Range of the addendum; by default 0.4 to 0.9")
    deflection: Annotated[tuple[Fraction, Fraction] | None, span(number(1, 0, 2), [0.97, 1.25])] = (
        Field(None, description="Range of the deflection; by default 0.97 to 1.25")
    )
    rim: Annotated[
        tuple[Quantity, Quantity] | None, span(quantity("length", "0.8 mm"), ["0.4 mm", "1.4 mm"])
    ] = Field(None, description="Range of the rim")
    pairs: Annotated[Fraction, number(1, 0, 5)] = Field(
        Fraction(1),
        description="Minimum mean number of conjugate pairs",
        json_schema_extra={"default": 1},
    )
    safety: Annotated[Fraction, number(1.5, 0, 10)] = Field(
        Fraction(3, 2),
        description="Safety against fatigue of the rim",
        json_schema_extra={"default": 1.5},
    )
    notch: Annotated[Fraction, number(1.6, 1, 5)] = Field(
        Fraction(8, 5),
        description="Notch factor of the teeth on the rim",
        json_schema_extra={"default": 1.6},
    )
    ratcheting: Annotated[Fraction, number(3, 0, 20)] = Field(
        Fraction(3),
        description="Minimum ratio of the ratcheting torque to the torque of the duty",
        json_schema_extra={"default": 3},
    )
    radial_compliance: Annotated[Quantity | None, quantity("compliance", "333 um/kN")] = Field(
        None,
        description="Compliance of the flexspline against ratcheting; by default that of 300 N/mm "
        "per mm of face width",
    )


class WaveCutter(Table):
    """The cutter of the flexspline."""

    generation: Annotated[str, choice(CONJUGATE, DEFORMED, MODIFIED)] = Field(
        CONJUGATE,
        description="How the flexspline is cut: by a conjugate edge, by a straight-sided hob on "
        "the deformed blank, or by one on the round blank, as a modified involute",
    )
    teeth: Annotated[int | None, whole(40, 4, 400)] = Field(
        None, description="Teeth of a pinion-type cutter; without them a rack, as of a hob"
    )
    pitch_diameter: Annotated[Quantity | None, quantity("length", "80 mm")] = Field(
        None, description="Pitch diameter of the blank as it rolls; by default module times teeth"
    )
    tool_angle: Annotated[Quantity | None, quantity("angle", "20 deg", "40 deg")] = Field(
        None,
        description="Angle of a straight-sided hob, by default the pressure angle; or of a "
        "straight tool to hold against the best edge, by default 20 deg",
    )
    tip_relief: Annotated[Quantity | None, quantity("length", "10 um", "0.1 mm")] = Field(
        None,
        description="Relief of a modified involute at its tip, which grows as a parabola from its "
        "root; by default none",
    )
    least_radius: Annotated[Quantity | None, quantity("length", "500 mm", "100 m")] = Field(
        None, description="Minimum radius of an arc that replaces the edge; by default any"
    )
    scale: Annotated[Fraction | None, number(100, 1, 1000)] = Field(
        None,
        description="Scale of the drawing; by default the largest of 1, 2, 5, 10 ... at which two "
        "teeth fit on a sheet of A4",
    )
    grid: Annotated[Quantity | None, quantity("length", "0.1 mm")] = Field(
        None, description="Grid of the drawing; by default 0.05 mm"
    )

    @model_validator(mode="after")
    def _of_the_generation(self) -> "WaveCutter":
        rolls = "teeth", "pitch_diameter", "least_radius"
        idle = {CONJUGATE: ("tip_relief",), DEFORMED: (*rolls, "tip_relief"), MODIFIED: rolls}
        for name in idle[self.generation]:
            if getattr(self, name) is not None:
                rule = f'changes nothing: generation = "{self.generation}" needs no {name}'
                raise refuse(rule, at=(name,), action="remove")
        return self
