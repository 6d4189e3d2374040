"""[planetary]: a planetary stage that is given as the gearhead of a servo axis."""

import math
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearopt.formulations.drive.planetary import Cutting, Planets
from gearopt.formulations.servo.gearhead import described, lost_motions, stiffness_of
from gearopt.formulations.servo.servo_design import GearheadDesign, StiffnessDesign
from gearopt.physics.planetary.gearhead import Gearset, planet_play
from gearopt.physics.planetary.willis import ENDS
from gearopt.scenes.reading.allowances import allowances
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.scenes.servo.tables.mesh import opening
from gearopt.units import Quantity

GEARS, OUTSIDE = ("sun", "planet", "ring"), "ring_outside_diameter"
TIGHT = 1e-6  # modules: play below zero that is rounding
Length = Annotated[Quantity | None, quantity("length", "8 mm")]
Small = Annotated[Quantity | None, quantity("length", "0.01 mm", zero=True)]
Allowance = Annotated[Quantity | tuple[Quantity, Quantity] | None, allowances("0.02 mm")]
Shift = Annotated[Fraction | None, number(0.2, -2, 2, zero=True)]
Teeth = Annotated[int, whole(21, 5, 1000)]
THINNER = 'Maximum deviation of its tooth thickness below nominal; or both, as "-0.02/-0.05 mm": '


def _key(description: str, default: Any = None) -> Any:
    return Field(default, description=description)


class Planetary(Table):
    """A planetary stage in place of [train], which is given; needs [duty].

    Lost motion is known where one of its deviations is given.
    """

    sun_teeth: Teeth = Field(description="Number of teeth of the sun")
    planet_teeth: Teeth = Field(description="Number of teeth of a planet")
    ring_teeth: Teeth = Field(description="Number of teeth of the ring")
    planets: Annotated[int, whole(3, 1, 12)] = _key("Number of planets, equally spaced", 3)
    fixed: Annotated[str, choice(*ENDS)] = _key(
        "Member that stands still: ring (sun drives carrier, 1 + z_r/z_s), carrier (sun drives "
        "ring, z_r/z_s) or sun (ring drives carrier, 1 + z_s/z_r)",
        "ring",
    )
    module: Annotated[Quantity, quantity("module", "0.5 mm")] = Field(description="Normal module")
    face_width: Annotated[Quantity, quantity("length", "8 mm")] = Field(description="Face width")
    helix_angle: Annotated[Quantity | None, quantity("angle", "15 deg", limit="45 deg")] = _key(
        "Helix angle; spur gears without it"
    )
    sun_shift: Shift = _key("Profile shift of the sun; by default by the rule of planetary stages")
    planet_shift: Shift = _key("Profile shift of the planets; by default by the same rule")
    ring_shift: Shift = _key(
        "Profile shift of the ring, positive towards its centre; by default without backlash"
    )
    density: Annotated[Quantity, quantity("density", "7.85 g/cm^3")] = Field(
        description="Density of the gears"
    )
    sun_bore: Length = _key("Bore of the sun; solid without it")
    planet_bore: Length = _key("Bore of a planet; solid without it")
    ring_outside_diameter: Length = _key(
        "Outside diameter of the ring; by default 3.5 modules around its roots"
    )
    carrier_inertia: Annotated[Quantity | None, quantity("inertia", "2e-5 kg m^2")] = _key(
        "Inertia of the carrier with pins, without planets; not counted without it"
    )
    friction: Annotated[Fraction | None, number(0.06, 0, Fraction(3, 10))] = _key(
        "Coefficient of friction of the teeth, from which the efficiency of the meshes follows; "
        "efficiency of [load] is then that of all else"
    )
    load_torque: Annotated[Quantity | None, quantity("torque", "10 N m")] = _key(
        "Torque at the output under which the stage winds up; below 100 N/mm teeth are softer"
    )
    pin_stiffness: Annotated[Quantity | None, quantity("stiffness", "50 N/um")] = _key(
        "Stiffness of a pin with its bearing, alike in all directions; rigid without it"
    )
    sun_thickness: Allowance = _key(f"{THINNER}the sun")
    planet_thickness: Allowance = _key(f"{THINNER}a planet")
    ring_thickness: Allowance = _key(f"{THINNER}the ring")
    pin_radius: Allowance = _key('Maximum deviation of pins outwards; or both, as "±0.01 mm"')
    pin_position: Small = _key("Maximum deviation of pins along their circle, to either side")
    pin_clearance: Small = _key("Maximum clearance of a planet's bearing, on the diameter")

    @model_validator(mode="after")
    def _fits(self) -> "Planetary":
        if not self._assembles:
            self._refuse_teeth()
        gears = self.gearset()
        if planet_play(gears) < -TIGHT * gears.sun.normal_module:
            rule = "makes teeth of the ring, or of planets, thicker than the gaps for them"
            raise refuse(rule, at=("ring_shift",), action="remove")
        sides = (gears.sun, "sun_bore"), (gears.planet, "planet_bore"), (gears.ring, OUTSIDE)
        for gear, name in sides:
            given, root = getattr(self, name), abs(gear.root_diameter)
            if given is not None and (given.value - root) * gear.teeth >= 0.0:
                rule = f"is on the wrong side of the root circle of {root:.4g} mm"
                raise refuse(rule, f"{root * (0.7 if gear.teeth > 0 else 1.2):.3g} mm", (name,))
        return self

    @property
    def _assembles(self) -> bool:
        """Whether equally spaced planets have room, and gears do not interfere."""
        sun, ring, width = self.sun_teeth, self.ring_teeth, self.face_width.value
        less = ring - sun - 2 * self.planet_teeth
        way = Planets(self._cutting(), self.planets, fewer=less, clearance=0.0)
        pair = way.pair(self.module.value, float(sun), float(ring), width)
        return bool((sun + ring) % self.planets == 0 and ring > sun and way.room(pair))

    def _refuse_teeth(self) -> None:
        """Name one number with which planets can be assembled, or a shift to leave out."""
        total, usual = self.sun_teeth + self.ring_teeth, self.sun_teeth + 2 * self.planet_teeth
        rule = "leaves no room for the planets, or gears that interfere"
        if total % self.planets:
            rule = f"makes z_s + z_r = {total}, no multiple of the {self.planets} planets"
        near = sorted(range(usual - 6, usual + 7), key=lambda ring: abs(ring - usual))
        ways = [("ring_teeth", ring) for ring in near]
        ways += [("planets", n) for n in reversed(range(1, self.planets))]
        ways += [("planet_teeth", (self.ring_teeth - self.sun_teeth) // 2)]
        for name, other in ways:
            if self.model_copy(update={name: other})._assembles:
                raise refuse(rule, other, (name,))
        for name in (f"{gear}_shift" for gear in reversed(GEARS)):
            if getattr(self, name) is not None:
                raise refuse(rule, at=(name,), action="remove")
        advice = "Write more teeth of planet and ring, or fewer planets"
        raise refuse(rule, advice, ("planet_teeth",), "tell")

    def _cutting(self, *thickness: float) -> Cutting:
        x = [None if (s := getattr(self, f"{gear}_shift")) is None else float(s) for gear in GEARS]
        sun, planet, ring = thickness or (0.0, 0.0, 0.0)
        return Cutting(
            _value(self.helix_angle),
            shifts=(x[0], x[1], x[2]),
            outside=_value(self.ring_outside_diameter) or None,
            allowances=(sun, planet, ring),
        )

    def gearset(self, *thickness: float) -> Gearset:
        """The gears, with thickness allowances [mm]."""
        sun, planet, ring = (float(getattr(self, f"{gear}_teeth")) for gear in GEARS)
        sizes = self.module.value, (sun, planet, ring), self.face_width.value
        return Gearset(*self._cutting(*thickness).gears(*sizes), self.planets, self.fixed)

    def design(self) -> GearheadDesign:
        """The stage as a result has it."""
        thickness, lost = [getattr(self, f"{gear}_thickness") for gear in GEARS], {}
        places = self.pin_position, self.pin_clearance
        if any(given is not None for given in (*thickness, self.pin_radius, *places)):
            ends = zip(*(opening(given) for given in thickness), strict=True)
            thick, thin = (self.gearset(*(-thinner for thinner in each)) for each in ends)
            out = opening(self.pin_radius, thinner=False)
            lost = lost_motions(thick, thin, out, *(_value(given) for given in places))
        bores = _value(self.sun_bore), _value(self.planet_bore)
        bodies = self.density.value, bores, _value(self.carrier_inertia)
        friction = None if self.friction is None else float(self.friction)
        return described(self.gearset(), friction, *bodies, **lost)

    def springs(self, load_inertia: float) -> StiffnessDesign:
        """Its stiffness; load_inertia [t mm2]."""
        torque, pin = _value(self.load_torque) or None, _value(self.pin_stiffness) or math.inf
        return stiffness_of(self.gearset(), torque, pin, load_inertia)


def _value(given: Quantity | None) -> float:
    return given.value if given is not None else 0.0
