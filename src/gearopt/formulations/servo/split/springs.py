"""Meshes and middle shaft of a servo train as springs in series, motor locked.

The stiffness of a mesh may vary over a mesh: limits on the train hold where it is softest, and the
windup that comes and goes with it is an error of the output.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.servo.servo_design import Spring, StiffnessDesign
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.physics.stiffness import (
    lewis_form_factor,
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    specific_pair_stiffness,
    tooth_factor,
    windup_variation,
)

SPRINGS = ("mesh of stage 2", "shaft between the stages", "mesh of stage 1")
LARGEST_FORM_FACTOR = 0.154  # of Lewis on the circular pitch, which teeth come near to


@dataclass(frozen=True)
class Springs:
    """Given meshes and shaft between the stages; lengths in mm, moduli in MPa.

    shaft: diameter and length. line_stiffness: of a mesh, its mean; None where it follows from the
    gears' youngs_modulus and teeth. load_inertia [t mm2] and load_torque [N mm]: None for none.
    minimum: stiffness of the output [N mm/rad], None where none is required. variation: of the
    stiffness of a mesh while teeth pass through it, largest less smallest over the mean.
    """

    shear_modulus: float
    shaft: tuple[float, float]
    line_stiffness: float | None = None
    youngs_modulus: float = math.nan
    load_inertia: float | None = None
    load_torque: float | None = None
    minimum: float | None = None
    variation: float = 0.0

    @property
    def softest(self) -> float:
        """Return the smallest stiffness of a mesh over its mean."""
        return 1.0 - 0.5 * self.variation

    def compliances(self, pairs: Pairs) -> tuple[Any, Any, Any]:
        """Return compliances [rad/(N mm)] at the output, meshes softest, in order of SPRINGS."""
        first, last = self._meshes(pairs)
        twist = shaft_compliance(self.shear_modulus, *self.shaft)
        return last / self.softest, twist / pairs[1].ratio ** 2, first / self.softest

    def variations(self, pairs: Pairs) -> tuple[Any, Any]:
        """Return by how much either mesh makes the windup vary [rad], peak to peak at the output.

        0 without a load torque.
        """
        torque = self.load_torque or 0.0
        first, last = (windup_variation(torque, c, self.variation) for c in self._meshes(pairs))
        return first, last

    def stiffest(self) -> "Springs":
        """Return springs whose meshes are as stiff as with any teeth, whatever these are."""
        if self.line_stiffness is not None:
            return self
        tooth = tooth_factor(LARGEST_FORM_FACTOR)
        line = specific_pair_stiffness(self.youngs_modulus, tooth, self.youngs_modulus, tooth)
        return replace(self, line_stiffness=line)

    def _meshes(self, pairs: Pairs) -> tuple[Any, Any]:
        """Return the compliance of either mesh at its mean stiffness, at the output."""
        first, second = pairs
        return self._mesh(first) / second.ratio**2, self._mesh(second)

    def _mesh(self, pair: GearPair) -> Any:
        """Return the compliance [rad/(N mm)] of a mesh at its wheel, its mean given or by Lewis."""
        stiffness: Any = self.line_stiffness
        if self.line_stiffness is None:
            pinion, wheel = (tooth_factor(lewis_form_factor(g.teeth) / math.pi) for g in pair.gears)
            stiffness = specific_pair_stiffness(
                self.youngs_modulus, pinion, self.youngs_modulus, wheel
            )
        return mesh_compliance(stiffness, pair.face_width, pair.wheel.reference_diameter)

    def numbers(self, face_width: float) -> Array:
        """Return `spring` of a `Kept`, meshes softest; face_width [mm]."""
        twist = shaft_compliance(self.shear_modulus, *self.shaft)
        line, elastic = self.line_stiffness or 0.0, self.youngs_modulus
        meshes = self.softest * line, self.softest * elastic, face_width
        return np.array([*meshes, twist, self.minimum or 0.0])

    def swings(self, face_width: float, teeth: Array) -> Array:
        """Return what gears make the windup of a mesh vary by, times d^2 of its wheel [rad mm2].

        Those of both gears add up, at the wheel under the load torque. face_width [mm].
        """
        line = self.line_stiffness
        soft = (
            1.0 / (self.youngs_modulus * tooth_factor(lewis_form_factor(teeth) / math.pi))
            if line is None
            else np.full(len(teeth), 0.5 / line)
        )
        unit = mesh_compliance(1.0, face_width, 1.0)
        return np.asarray(windup_variation(self.load_torque or 0.0, unit * soft, self.variation))

    def output_stiffness(self, pairs: Pairs) -> Any:
        """Return the stiffness at the output [N mm/rad]."""
        return 1.0 / output_compliance(self.compliances(pairs), (1.0, 1.0, 1.0))

    def design(self, pairs: Pairs) -> StiffnessDesign:
        """Return stiffness, frequency and windup of a train, with the share of every spring."""
        parts = [float(c) for c in self.compliances(pairs)]
        total = math.fsum(parts)
        inertia, torque = self.load_inertia, self.load_torque
        varied = sum(self.variations(pairs)) if self.variation and torque is not None else None
        return StiffnessDesign(
            output_Nm_per_rad=1e-3 / total,
            springs=tuple(
                Spring(name, part / total, 1e-3 / part)
                for name, part in zip(SPRINGS, parts, strict=True)
            ),
            frequency_Hz=None if inertia is None else float(locked_frequency(1.0 / total, inertia)),
            windup_deg=None if torque is None else math.degrees(torque * total),
            windup_variation_deg=None if varied is None else math.degrees(varied),
        )
