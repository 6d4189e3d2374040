"""[planetary]: a planetary stage that is given as the gearhead of a servo axis."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.drive.planetary import HELD, Cutting
from gearopt.formulations.servo.gearhead import Deviations, Gearhead
from gearopt.physics.gears import ISO_53_A
from gearopt.scenes.reading.allowances import allowances
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.scenes.servo.tables.mesh import opening
from gearopt.units import Quantity

GEARS = ("sun", "planet", "ring")
LENGTH = quantity("length", "8 mm")
Small = Annotated[Quantity | None, quantity("length", "0.01 mm", zero=True)]
Allowance = Annotated[Quantity | tuple[Quantity, Quantity] | None, allowances("0.02 mm")]
Shift = Annotated[Fraction | None, number(0.2, -2, 2, zero=True)]
TEETH = whole(21, 5, 1000)


def _key(description: str) -> Any:
    return Field(None, description=description)


def _thickness(gear: str) -> Any:
    return _key(
        f"Maximum deviation of the tooth thickness of {gear} below nominal; or both "
        'allowances, as "-0.02/-0.05 mm"'
    )


class Planetary(Table):
    """A planetary stage between motor and load, which is given; needs [duty], in place of [train].

    Lost motion is known where one of its deviations is given.
    """

    sun_teeth: Annotated[int, TEETH] = Field(description="Number of teeth of the sun")
    planet_teeth: Annotated[int, TEETH] = Field(description="Number of teeth of a planet")
    ring_teeth: Annotated[int, TEETH] = Field(description="Number of teeth of the ring")
    planets: Annotated[int, whole(3, 1, 12)] = Field(
        3, description="Number of planets, equally spaced"
    )
    fixed: Annotated[str, choice(*HELD)] = Field(
        HELD[0],
        description="Member that stands still: ring (the sun drives the carrier, 1 + z_r/z_s), "
        "carrier (the sun drives the ring, z_r/z_s) or sun (the ring drives the carrier, "
        "1 + z_s/z_r)",
    )
    module: Annotated[Quantity, quantity("module", "0.5 mm")] = Field(description="Normal module")
    face_width: Annotated[Quantity, LENGTH] = Field(description="Face width of all gears")
    helix_angle: Annotated[Quantity | None, quantity("angle", "15 deg", limit="45 deg")] = _key(
        "Helix angle of the sun; spur gears without it"
    )
    pressure_angle: Annotated[Quantity, quantity("angle", "20 deg", limit="45 deg")] = Field(
        default_factory=lambda: units.parse("20 deg", "angle"),
        description="Normal pressure angle",
        json_schema_extra={"default": "20 deg"},
    )
    sun_shift: Shift = _key("Profile shift of the sun; by default by the rule of planetary stages")
    planet_shift: Shift = _key("Profile shift of the planets; by default by the same rule")
    ring_shift: Shift = _key(
        "Profile shift of the ring, positive towards its centre; by default without backlash"
    )
    density: Annotated[Quantity, quantity("density", "7.85 g/cm^3")] = Field(
        description="Density of the gears"
    )
    sun_bore: Annotated[Quantity | None, LENGTH] = _key("Bore of the sun; solid without it")
    planet_bore: Annotated[Quantity | None, LENGTH] = _key("Bore of a planet; solid without it")
    ring_outside_diameter: Annotated[Quantity | None, quantity("length", "60 mm")] = _key(
        "Outside diameter of the ring; by default 3.5 modules around its roots"
    )
    carrier_inertia: Annotated[Quantity | None, quantity("inertia", "2e-5 kg m^2")] = _key(
        "Inertia of the carrier about its axis, with pins, bearings and output shaft, without "
        "planets; not counted without it"
    )
    friction: Annotated[Fraction | None, number(0.06, 0, Fraction(3, 10))] = _key(
        "Coefficient of friction of the teeth, from which the efficiency of the meshes follows; "
        "efficiency of [load] is then that of all else"
    )
    load_torque: Annotated[Quantity | None, quantity("torque", "10 N m")] = _key(
        "Torque at the output under which the stage winds up; below 100 N/mm teeth are softer"
    )
    pin_stiffness: Annotated[Quantity | None, quantity("stiffness", "50 N/um")] = _key(
        "Stiffness of a planet's pin with its bearing, the same in all directions; rigid without it"
    )
    sun_thickness: Allowance = _thickness("the sun")
    planet_thickness: Allowance = _thickness("the planets")
    ring_thickness: Allowance = _thickness("the ring")
    pin_radius: Allowance = _key(
        'Maximum deviation of the planets\' axes outwards; or both allowances, as "±0.01 mm"'
    )
    pin_position: Small = _key("Maximum deviation of a pin along its circle, to either side")
    pin_clearance: Small = _key("Maximum clearance of a planet's bearing, on the diameter")

    @model_validator(mode="after")
    def _fits(self) -> "Planetary":
        sun, planet, ring, n = self.sun_teeth, self.planet_teeth, self.ring_teeth, self.planets
        if (sun + ring) % n:
            near = min(
                (k for k in range(1, ring + n) if not (sun + k) % n), key=lambda k: abs(k - ring)
            )
            rule = f"makes z_s + z_r = {sun + ring}, no multiple of the {n} planets"
            raise refuse(rule, near, ("ring_teeth",))
        if abs(ring - sun - 2 * planet) > 4:
            rule = f"is not near {sun + 2 * planet}, z_s + 2 z_p: the planets do not meet the ring"
            raise refuse(rule, sun + 2 * planet, ("ring_teeth",), "sample")
        gearhead = self.gearhead()
        if not gearhead.neighbours > 0.0:
            raise refuse("makes neighbours touch", n - 1, ("planets",), "sample")
        if not gearhead.runs:
            rule = "does not go together with the other teeth and shifts: the gears interfere"
            raise refuse(rule, sun + 2 * planet, ("ring_teeth",), "sample")
        outside, root = self.ring_outside_diameter, -gearhead.gearset().ring.root_diameter
        if outside is not None and outside.value <= root:
            raise refuse(
                f"is not outside the root circle of {root:.4g} mm", at=("ring_outside_diameter",)
            )
        for gear, body in zip(
            GEARS, (gearhead.gearset().sun, gearhead.gearset().planet), strict=False
        ):
            bore = getattr(self, f"{gear}_bore")
            if bore is not None and bore.value >= body.root_diameter:
                rule = f"is not inside the root circle of {body.root_diameter:.4g} mm"
                raise refuse(rule, at=(f"{gear}_bore",))
        return self

    @property
    def deviations(self) -> Deviations | None:
        """Allowances of thickness and place; None where none is given."""
        names = [f"{gear}_thickness" for gear in GEARS]
        known = (*names, "pin_radius", "pin_position", "pin_clearance")
        if all(getattr(self, name) is None for name in known):
            return None
        sun, planet, ring = (opening(getattr(self, name)) for name in names)
        position, clearance = self.pin_position, self.pin_clearance
        return Deviations(
            ((-sun[1], -sun[0]), (-planet[1], -planet[0]), (-ring[1], -ring[0])),
            opening(self.pin_radius, thinner=False),
            position.value if position else 0.0,
            clearance.value if clearance else 0.0,
        )

    def gearhead(self) -> Gearhead:
        """The stage in plain numbers."""
        rack = replace(ISO_53_A, pressure_angle=self.pressure_angle.value)
        shifts = [getattr(self, f"{gear}_shift") for gear in GEARS]
        x = [None if shift is None else float(shift) for shift in shifts]
        angle, outside, torque, pin = (
            self.helix_angle,
            self.ring_outside_diameter,
            self.load_torque,
            self.pin_stiffness,
        )
        return Gearhead(
            self.module.value,
            self.face_width.value,
            (self.sun_teeth, self.planet_teeth, self.ring_teeth),
            self.planets,
            self.fixed,
            Cutting(
                angle.value if angle else 0.0,
                (rack, rack, rack),
                shifts=(x[0], x[1], x[2]),
                outside=outside.value if outside else None,
            ),
            self.density.value,
            (_value(self.sun_bore), _value(self.planet_bore)),
            _value(self.carrier_inertia),
            None if self.friction is None else float(self.friction),
            torque.value if torque else None,
            pin.value if pin else math.inf,
            self.deviations,
        )


def _value(given: Quantity | None) -> float:
    return given.value if given is not None else 0.0
