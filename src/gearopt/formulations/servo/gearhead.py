"""A planetary stage that is given as the gearhead of a servo axis, seen at motor and load."""

import math
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.planetary import Cutting, Planets
from gearopt.formulations.servo.servo_design import KG_M2, GearheadDesign, Spring, StiffnessDesign
from gearopt.frozen import dataclass
from gearopt.physics.planetary.gearhead import (
    SINKS,
    Gearset,
    balance,
    compliances,
    inertias,
    lost_motion,
    masses,
    planet_play,
)
from gearopt.physics.stiffness import locked_frequency

SPRINGS = ("meshes of sun and planets", "meshes of planets and ring", "pins of the planets")
Ends = tuple[float, float]


@dataclass(frozen=True)
class Deviations:
    """Allowances of a stage, lower and upper [mm].

    thickness A_sn of sun, planets and ring: below 0 thinner. outwards: of the planets' axes from
    the sun's. position: of a pin along its circle, to either side. clearance: of the planets'
    bearings, on the diameter, at most.
    """

    thickness: tuple[Ends, Ends, Ends]
    outwards: Ends = (0.0, 0.0)
    position: float = 0.0
    clearance: float = 0.0


@dataclass(frozen=True)
class Gearhead:
    """A planetary stage: module and face width [mm], teeth of sun, planet and ring, their cutting.

    density [t/mm3]; bores of sun and planets [mm]; carrier: its inertia [t mm2]; friction mu of the
    teeth, None: not known; torque [N mm] at the output, None for none; pin: stiffness [N/mm];
    deviations: None where there are none.
    """

    module: float
    face_width: float
    teeth: tuple[int, int, int]
    planets: int
    held: str
    cutting: Cutting
    density: float
    bores: Ends = (0.0, 0.0)
    carrier: float = 0.0
    friction: float | None = None
    torque: float | None = None
    pin: float = math.inf
    deviations: Deviations | None = None

    def gearset(self, allowances: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Gearset:
        """Its gears, with thickness allowances [mm]."""
        sun, planet, ring = (float(z) for z in self.teeth)
        cutting = replace(self.cutting, allowances=allowances)
        gears = cutting.gears(self.module, (sun, planet, ring), self.face_width)
        return Gearset(*gears, self.planets, self.held)

    @property
    def ratio(self) -> float:
        """Speed of the motor over that of the load, without sign."""
        return float(1 / abs(self.gearset().speeds()[SINKS[self.held]]))

    @property
    def efficiency(self) -> float:
        """Of the meshes while the motor drives; 1 where no friction is known."""
        return (
            1.0 if not self.friction else float(balance(self.gearset(), self.friction).efficiency)
        )

    @property
    def inertia(self) -> float:
        """Inertia at the motor [t mm2]."""
        return math.fsum(self._inertias.values())

    @property
    def _inertias(self) -> dict[str, float]:
        parts = inertias(self.gearset(), self.density, self.bores, self.carrier)
        return {name: float(part) for name, part in parts.items()}

    @property
    def neighbours(self) -> float:
        """Gap between the tips of neighbouring planets [mm]; infinite of one."""
        gears = self.gearset()
        half = math.sin(math.pi / self.planets)
        gap = 2.0 * gears.distance * half - gears.planet.tip_diameter
        return math.inf if self.planets == 1 else float(gap)

    @property
    def runs(self) -> bool:
        """Whether its gears have room for each other, and mesh without interference."""
        sun, planet, ring = self.teeth
        way = Planets(
            self.cutting, self.planets, fewer=ring - sun - 2 * planet, clearance=-math.inf
        )
        return bool(way.room(way.pair(self.module, float(sun), float(ring), self.face_width)))

    def lost_motions(self) -> Ends | None:
        """Least and largest angle [rad] at the output between both flanks; None: not known.

        The least has one planet with the least backlash, and two pins off their places to opposite
        sides; the largest, all planets with the largest.
        """
        if (given := self.deviations) is None:
            return None
        thick = tuple(high for _, high in given.thickness)
        thin = tuple(low for low, _ in given.thickness)
        tight, loose = (self.gearset((a[0], a[1], a[2])) for a in (thick, thin))
        least = min(float(planet_play(tight, out)) for out in given.outwards)
        most = max(float(planet_play(loose, out)) for out in given.outwards)
        apart = 2.0 * given.position if self.planets > 1 else 0.0
        return (
            float(lost_motion(tight, least, 0.0, apart)),
            float(lost_motion(loose, most, given.clearance)),
        )

    def stiffness(self, load_inertia: float) -> StiffnessDesign:
        """Stiffness at the output, motor locked; load_inertia [t mm2]."""
        parts = [float(c) for c in compliances(self.gearset(), self.torque, self.pin)]
        total = math.fsum(parts)
        return StiffnessDesign(
            output_Nm_per_rad=1e-3 / total,
            springs=tuple(
                Spring(name, part / total, 1e-3 / part)
                for name, part in zip(SPRINGS, parts, strict=True)
                if part
            ),
            frequency_Hz=float(locked_frequency(1.0 / total, load_inertia)),
            windup_deg=None if self.torque is None else math.degrees(self.torque * total),
        )

    def design(self) -> GearheadDesign:
        """The stage as a result has it."""
        gears, lost = self.gearset(), self.lost_motions()
        parts: dict[str, Any] = {
            f"{name}_inertia_kg_m2": KG_M2 * part for name, part in self._inertias.items()
        }
        losses: dict[str, Any] = {}
        if self.friction is not None:
            flow = balance(gears, self.friction)
            rolling = max(float(abs(mesh.rolling)) for mesh in flow.meshes)
            losses = {"efficiency": float(flow.efficiency), "rolling_power": rolling}
        play = (None, None) if lost is None else tuple(math.degrees(angle) for angle in lost)
        mass = math.fsum(float(m) for m in masses(gears, self.density, self.bores).values())
        return GearheadDesign(
            planets=self.planets,
            held=self.held,
            **dict(zip(("sun_teeth", "planet_teeth", "ring_teeth"), self.teeth, strict=True)),
            normal_module_mm=self.module,
            ratio=self.ratio,
            centre_distance_mm=float(gears.distance),
            ring_outside_diameter_mm=float(-gears.ring.outside),
            mass_kg=1e3 * mass,
            inertia_kg_m2=KG_M2 * self.inertia,
            **parts,
            **losses,
            least_lost_motion_deg=play[0],
            lost_motion_deg=play[1],
        )
