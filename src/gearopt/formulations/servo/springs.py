"""How stiff a servo train is at its output: meshes and shaft in series, motor locked."""

import math
from dataclasses import dataclass
from typing import Any

from gearopt.formulations.servo.servo_design import Spring, StiffnessDesign
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.physics.gears import GearPair
from gearopt.physics.stiffness import (
    lewis_form_factor,
    line_stiffness,
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    tooth_factor,
)

NAMES = ("mesh of stage 2", "shaft between the stages", "mesh of stage 1")


@dataclass(frozen=True)
class Springs:
    """What is given of meshes and shaft between the stages; lengths in mm, moduli in MPa.

    shaft: diameter and length. line_stiffness: of a mesh; None where it follows from the gears'
    youngs_modulus and teeth. load_inertia [t mm2] and load_torque [N mm]: None for none. least:
    stiffness that the output must have [N mm/rad], None where none is asked for.
    """

    shear_modulus: float
    shaft: tuple[float, float]
    line_stiffness: float | None = None
    youngs_modulus: float = math.nan
    load_inertia: float | None = None
    load_torque: float | None = None
    least: float | None = None

    def compliances(self, pairs: Pairs) -> tuple[Any, Any, Any]:
        """Return compliances [rad/(N mm)] at the output, in the order of NAMES."""
        first, second = pairs
        twist = shaft_compliance(self.shear_modulus, *self.shaft)
        return (
            self._mesh(second),
            twist / second.ratio**2,
            self._mesh(first) / second.ratio**2,
        )

    def _mesh(self, pair: GearPair) -> Any:
        """Return the compliance [rad/(N mm)] of a mesh, its line stiffness given or by Lewis."""
        stiffness: Any = self.line_stiffness
        if self.line_stiffness is None:
            one, two = (tooth_factor(lewis_form_factor(g.teeth) / math.pi) for g in pair.gears)
            stiffness = line_stiffness(self.youngs_modulus, one, self.youngs_modulus, two)
        return mesh_compliance(stiffness, pair.face_width, pair.wheel.reference_diameter)

    def output_stiffness(self, pairs: Pairs) -> Any:
        """Return the stiffness at the output [N mm/rad]."""
        return 1.0 / output_compliance(self.compliances(pairs), (1.0, 1.0, 1.0))

    def design(self, pairs: Pairs) -> StiffnessDesign:
        """Return stiffness, frequency and wind-up of a train, with the share of every spring."""
        parts = [float(c) for c in self.compliances(pairs)]
        total = math.fsum(parts)
        inertia, torque = self.load_inertia, self.load_torque
        return StiffnessDesign(
            output_Nm_per_rad=1e-3 / total,
            springs=tuple(
                Spring(name, part / total, 1e-3 / part)
                for name, part in zip(NAMES, parts, strict=True)
            ),
            frequency_Hz=None if inertia is None else float(locked_frequency(1.0 / total, inertia)),
            windup_deg=None if torque is None else math.degrees(torque * total),
        )
