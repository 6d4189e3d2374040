"""A strain wave gearing's file as a whole, and what it asks of the formulations."""

import math

from pydantic import Field, model_validator

from gearopt.formulations.strain_wave.cutter_report import CONJUGATE, USUAL, Cutter
from gearopt.formulations.strain_wave.demand import FREE, Demand, Duty
from gearopt.formulations.strain_wave.design import INVOLUTE
from gearopt.formulations.strain_wave.swept_report import HALF_LOCUS, Law
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup
from gearopt.scenes.reading.fields import ProblemFile, refuse
from gearopt.scenes.strain_wave.law_faults import Fault, contact_fault, law_fault
from gearopt.scenes.strain_wave.tables import (
    MODULES,
    OUTPUT,
    RANGES,
    RIMS,
    WaveCutter,
    WaveDuty,
    WaveGears,
    WaveGenerator,
    WaveLimits,
    WaveMaterial,
    WaveSharing,
    WaveTeeth,
)
from gearopt.units import Quantity

STEEL = 206e3  # MPa
STEELS = (0.9, 1.1)  # times STEEL: moduli of which a steel's fatigue limits are assumed
STEEL_LIMITS = (400.0, 230.0)  # MPa: fatigue limits of the rim in bending and shear, assumed
PAIR = 1e4  # N/mm per mm of face width: a stiffness of 10 N/(mm um), of steel, assumed
RATCHET = 300.0  # N/mm per mm of face width, of steel, assumed
USED = 3.5  # modules that shift, addendum and clearance of a usual gearing add to its diameter
START = {
    "profile_shift": 0.9,
    "pressure_angle": math.radians(20.0),
    "deflection": 1.0,
    "addendum": 0.6,
}
CONVEX, CONCAVE, TANGENT = 1.37, 1.57, 0.1  # modules: of a design in the literature
START_RIM = 8.0 / 900.0  # of the outer diameter


class Scene(ProblemFile):
    """A strain wave gearing."""

    duty: WaveDuty
    gears: WaveGears = Field(default_factory=WaveGears)
    teeth: WaveTeeth = Field(default_factory=WaveTeeth)
    wave_generator: WaveGenerator = Field(default_factory=WaveGenerator)
    material: WaveMaterial = Field(default_factory=WaveMaterial)
    sharing: WaveSharing = Field(default_factory=WaveSharing)
    design: WaveLimits = Field(default_factory=WaveLimits)
    cutter: WaveCutter | None = None

    @property
    def has_free_sizes(self) -> bool:
        """Whether the file leaves some of the six numbers open, to be chosen within limits."""
        return self.involute and any(getattr(self.gears, name) is None for name in FREE)

    @property
    def involute(self) -> bool:
        """Whether the circular spline has involute teeth."""
        return self.teeth.law == INVOLUTE

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        if self.has_free_sizes and self.duty.outer_diameter is None:
            left = next(name for name in FREE if getattr(self.gears, name) is None)
            rule = f"is missing: [gears] leaves {left} open, and what is chosen must fit into it"
            raise refuse(rule, at=("duty", "outer_diameter"), action="sample")
        if (
            not self.has_free_sizes
            and self.duty.outer_diameter is None
            and self.gears.face_width is None
        ):
            rule = "is missing: without it or an outer diameter the face width is unknown"
            raise refuse(rule, at=("gears", "face_width"), action="sample")
        for name in FREE:
            if getattr(self.gears, name) is not None and getattr(self.design, name) is not None:
                rule = f"changes nothing: [gears] gives {name}"
                raise refuse(rule, at=("design", name), action="remove")
        return self

    @model_validator(mode="after")
    def _with_fatigue_limits(self) -> "Scene":
        """Refuse a material other than steel without the fatigue limits that something asks."""
        names = ("bending_limit", "shear_limit")
        asks = self.has_free_sizes or "safety" in self.design.model_fields_set
        asks = asks or any(getattr(self.material, name) is not None for name in names)
        for name in names if asks and not self.steel else ():
            if getattr(self.material, name) is None:
                rule = f"is missing: {1e-3 * self.modulus:.4g} GPa is no steel, whose is assumed"
                write = "Write the fatigue limit of the material"
                raise refuse(rule, write, ("material", name), "tell")
        return self

    @model_validator(mode="after")
    def _with_a_bore(self) -> "Scene":
        if any(getattr(self.gears, name) is None for name in FREE):
            return self
        gearing = self.gearing()
        bore = 2.0 * gearing.neutral_radius - gearing.rim
        if bore <= 0.0:
            rule = f"is too thick: the flexspline would have a bore of {bore:.4g} mm"
            raise refuse(rule, f"{0.01 * gearing.module * gearing.teeth:.3g} mm", ("gears", "rim"))
        return self

    @model_validator(mode="after")
    def _given_by_law(self) -> "Scene":
        """Refuse what a law of teeth cannot do, each with its key."""
        if self.has_free_sizes:
            return self
        if self.involute:
            return self._made(contact_fault(self.gearing()))
        for name in FREE:
            of_half_locus = name == "pressure_angle" and self.teeth.law == HALF_LOCUS
            if of_half_locus and getattr(self.gears, name) is not None:
                rule = f'changes nothing: law = "{HALF_LOCUS}" has its own angles'
                raise refuse(rule, at=("gears", name), action="remove")
            if getattr(self.design, name) is not None:
                rule = f'changes nothing: law = "{self.teeth.law}" has no search'
                raise refuse(rule, at=("design", name), action="remove")
            if not of_half_locus and getattr(self.gears, name) is None:
                rule = f'is missing: gears are chosen with law = "{INVOLUTE}" alone'
                raise refuse(rule, at=("gears", name), action="sample")
        if self.cutter is not None and self.cutter.generation != CONJUGATE:
            rule = f'needs law = "{INVOLUTE}", whose flank a straight edge comes near'
            raise refuse(rule, CONJUGATE, ("cutter", "generation"))
        for name in ("tool_angle", "least_radius"):
            if self.cutter is not None and getattr(self.cutter, name) is not None:
                rule = f'changes nothing: no simple edge is fitted for law = "{self.teeth.law}"'
                raise refuse(rule, at=("cutter", name), action="remove")
        return self._made(law_fault(self.gearing(), self.law()))

    def _made(self, fault: Fault | None) -> "Scene":
        """Return the scene; refuse a gearing whose teeth have a fault."""
        if fault:
            rule, at, write = fault
            raise refuse(rule, write, at, "set" if write else "sample")
        return self

    @property
    def usual_module(self) -> float:
        """Module [mm] that a usual gearing of the outer diameter has."""
        assert self.duty.outer_diameter is not None
        inside = self.duty.outer_diameter.value - 2.0 * self.shell
        return inside / (2.0 * self.duty.ratio + 2.0 + USED)

    @property
    def shell(self) -> float:
        """Thickness outside the circular spline's roots [mm]."""
        if self.gears.shell is not None:
            return self.gears.shell.value
        if self.duty.outer_diameter is not None:
            return self.duty.outer_diameter.value / 30.0
        assert self.gears.module is not None
        return 6.0 * self.gears.module.value

    @property
    def modulus(self) -> float:
        """Modulus of elasticity E [MPa]."""
        return _or(self.material.elastic_modulus, STEEL)

    @property
    def steel(self) -> bool:
        """Whether the material is as stiff as steel, whose fatigue limits are assumed."""
        return STEELS[0] <= self.modulus / STEEL <= STEELS[1]

    @property
    def pair_stiffness(self) -> float:
        """Stiffness of two teeth in contact [N/mm]; what is assumed is in proportion to E."""
        usual = PAIR * self.face_width * self.modulus / STEEL
        return 1.0 / _or(self.sharing.pair_compliance, 1.0 / usual)

    @property
    def radial_stiffness(self) -> float:
        """Stiffness of the flexspline against ratcheting [N/mm], assumed in proportion to E."""
        usual = RATCHET * self.face_width * self.modulus / STEEL
        return 1.0 / _or(self.design.radial_compliance, 1.0 / usual)

    @property
    def face_width(self) -> float:
        """Face width b [mm]."""
        if self.gears.face_width is not None:
            return self.gears.face_width.value
        assert self.duty.outer_diameter is not None
        return self.duty.outer_diameter.value / 9.0

    def law(self) -> Law:
        """Return how teeth that are no involutes are made."""
        assert self.gears.module is not None
        m, teeth = self.gears.module.value, self.teeth
        radii = _or(teeth.convex_radius, CONVEX * m), _or(teeth.concave_radius, CONCAVE * m)
        thick, tangent = _or(teeth.thickness, 0.5 * math.pi * m), _or(teeth.tangent, TANGENT * m)
        return Law(teeth.law, thick, radii, tangent)

    def gearing(self) -> StrainWave:
        """Return the gearing that is given, or that at which a search begins."""
        return self.demand().gearing(dict(zip(FREE, self.start(), strict=True)))

    def loads(self) -> Duty:
        """Return torque, width, materials and elasticity."""
        modulus, poisson, width = self.modulus, float(self.material.poisson_ratio), self.face_width
        asked = self.sharing
        length = _or(asked.cup_length, 3.0 * width)
        cup = Cup(float(asked.wall_over_rim), length, modulus, poisson)
        return Duty(
            self.duty.torque.value,
            width,
            (modulus, modulus),
            (poisson, poisson),
            self.pair_stiffness,
            cup,
            asked.rim == "elastic",
            1.0 if asked.torque_of == OUTPUT else 1.0 + 1.0 / self.duty.ratio,
        )

    def demand(self) -> Demand:
        """Return the demand on the gearing, and the ranges of the numbers that are chosen."""
        asked, diameter = self.design, self.duty.outer_diameter
        wrap = self.wave_generator.wrap_angle
        usual = STEEL_LIMITS if self.steel else (math.inf, math.inf)
        return Demand(
            teeth=2 * self.duty.ratio,
            duty=self.loads(),
            ranges=self.ranges(),
            outer_radius=math.inf if diameter is None else 0.5 * diameter.value,
            shell=self.shell,
            wave=self.wave_generator.shape,
            wrap=math.radians(30.0) if wrap is None else wrap.value,
            clearance=float(self.gears.clearance),
            bending_limit=_or(self.material.bending_limit, usual[0]),
            shear_limit=_or(self.material.shear_limit, usual[1]),
            safety=float(asked.safety),
            notch=float(asked.notch),
            radial_stiffness=self.radial_stiffness,
            ratchet_factor=float(asked.ratcheting),
            pairs=float(asked.pairs),
            keys={name: f"design.{name}" for name in FREE if getattr(self.gears, name) is None},
        )

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Return the ranges of the six numbers; ends that are equal where one is given."""
        ranges = {}
        for name in FREE:
            given, asked = getattr(self.gears, name), getattr(self.design, name)
            if given is not None:
                ranges[name] = (_value(given), _value(given))
            elif asked is not None:
                ranges[name] = (_value(asked[0]), _value(asked[1]))
            else:
                ranges[name] = self._usual(name)
        return ranges

    def _usual(self, name: str) -> tuple[float, float]:
        """Return the range of a number of which the file says nothing."""
        if name in ("module", "rim"):
            assert self.duty.outer_diameter is not None
            unit = self.usual_module if name == "module" else self.duty.outer_diameter.value
            low, high = MODULES if name == "module" else RIMS
            return low * unit, high * unit
        low, high = RANGES[name]
        return (math.radians(low), math.radians(high)) if name == "pressure_angle" else (low, high)

    def start(self) -> list[float]:
        """Return the numbers at which the search begins, in the order of FREE."""
        ranges = self.ranges()
        usual = dict(START)
        if self.has_free_sizes:
            assert self.duty.outer_diameter is not None
            rim = START_RIM * self.duty.outer_diameter.value
            usual |= {"module": self.usual_module, "rim": rim}
        return [
            min(max(usual.get(name, low), low), high)
            for name, (low, high) in ((name, ranges[name]) for name in FREE)
        ]

    def tool(self) -> Cutter | None:
        """Return the cutter that is asked for."""
        if self.cutter is None:
            return None
        pitch = self.cutter.pitch_diameter
        return Cutter(
            self.cutter.teeth or 0,
            0.0 if pitch is None else 0.5 * pitch.value,
            _or(self.cutter.tool_angle, USUAL if self.cutter.generation == CONJUGATE else 0.0),
            _or(self.cutter.least_radius, 0.0),
            self.involute,
            self.cutter.generation,
            _or(self.cutter.tip_relief, 0.0),
        )


def _or(given: Quantity | None, usual: float) -> float:
    return usual if given is None else given.value


def _value(given: object) -> float:
    return given.value if isinstance(given, Quantity) else float(given)  # type: ignore[arg-type]
