"""The lightest two-stage servo train of minimum stiffness, with real sizes: a geometric program."""

import math
from collections.abc import Iterable
from typing import Any

from gearopt.formulations.servo.split.bodies import clear_rows
from gearopt.formulations.servo.split.servo_train import (
    bending_stress,
    gear_mass,
    ratio_parameters,
    ratio_rows,
    train_error,
    train_inertia,
)
from gearopt.formulations.servo.split.springs import Springs
from gearopt.formulations.strength.laws.lewis import lewis
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.gears import Gear, GearPair, disc_mass
from gearopt.physics.stiffness import (
    mesh_compliance,
    output_compliance,
    shaft_compliance,
)

SEARCH_SPAN = 1e3  # factor between the lengths of a train and the ends of the search


@dataclass(frozen=True)
class StiffTrain:
    """A two-stage train whose output must be stiff; lengths in mm, the rest in N, rad, MPa, t.

    stiffness: minimum at the output, motor locked [N mm/rad]: (2 pi f)^2 J_L or a load torque over
    an angle. line_stiffness: of a mesh; shear_modulus: of the middle shaft. ratio: minimum and
    maximum. module: of both stages; pinion_teeth: minimum, of both pinions, which also give the
    form factors. bore: minimum reference diameter of gear 3, and by how much it must exceed the
    shaft's. wheel_tips: largest tip diameters of gears 2 and 4. output, motor: diameters of the
    output shaft with its hub and of the motor, kept clear as in `bodies.clear_rows`. face_width,
    shaft_diameter: minimum. inertia: maximum at the motor [t mm2]. The rest is as in `ServoTrain`.
    """

    stiffness: float
    line_stiffness: float
    shear_modulus: float
    ratio: tuple[float, float]
    module: float
    pinion_teeth: tuple[int, int]
    bore: tuple[float, float]
    wheel_tips: tuple[float, float]
    face_width: float
    shaft_diameter: float
    shaft_length: float
    density: float
    output_torque: float
    bending: float
    inertia: float
    lost_motion: tuple[float, float] | None = None
    error: float = math.inf
    sector: float = 1.0
    output: float = 0.0
    motor: float = 0.0
    elastic: Springs | None = None


def stiff(train: StiffTrain) -> Problem:
    """Minimise the mass [kg] of gears and middle shaft under a minimum stiffness of the output.

    Variables: pinion_diameter, face_width [mm] and ratio of both stages, shaft_diameter [mm]. The
    compliance at the output is that of both meshes and of the shaft between them.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        return _terms(train, x, p)

    bounded = math.isfinite(train.error)
    parameters = (
        Param("stiffness", "N mm/rad", train.stiffness, role="limit"),
        Param("inertia", "t mm2", train.inertia, role="limit"),
        *((Param("error", "rad", train.error, role="limit"),) if bounded else ()),
        Param("bending", "MPa", train.bending, role="limit"),
        *ratio_parameters(*train.ratio),
        Param("wheel_tip_diameter", "mm", train.wheel_tips, 2, role="limit"),
    )
    return Problem("split stiff", _variables(train), parameters, evaluate)


def _terms(train: StiffTrain, x: Any, p: Any) -> Terms:
    (d1, d3), (n1, n2), m = x.pinion_diameter, x.ratio, train.module
    both = (
        GearPair.of_diameter(m, d1 / m, d1, n1, x.face_width[0]),
        GearPair.of_diameter(m, d3 / m, d3, n2, x.face_width[1]),
    )
    wheels, shaft = [pair.wheel for pair in both], (x.shaft_diameter, train.shaft_length)
    gears = gear_mass(train.density, both, train.sector)
    long = disc_mass(train.density, train.shaft_length, x.shaft_diameter)
    inertia = train_inertia(train.density, both, shaft, train.sector)
    laws = [lewis(float(z)) for z in train.pinion_teeth]
    torques = train.output_torque / n2, train.output_torque
    tied = train.ratio[0] == train.ratio[1]
    ratio, equal = ratio_rows(p, tied, n1 * n2)
    limits = ratio | {
        "stiffness": p.stiffness * _compliance(train, x, wheels),
        "inertia": inertia / p.inertia,
        "stage_ratio_low": (1.0 / n1, 1.0 / n2),
        "bending_stress": tuple(
            bending_stress(torque, pair, law) / p.bending
            for torque, pair, law in zip(torques, both, laws, strict=True)
        ),
        "pinion_teeth_low": tuple(
            z * m / d for z, d in zip(train.pinion_teeth, (d1, d3), strict=True)
        ),
        "second_pinion_diameter_low": train.bore[0] / d3,
        "shaft_wall": (x.shaft_diameter + train.bore[1]) / d3,
        "wheel_tip_diameter": tuple(
            wheel.tip_diameter / t for wheel, t in zip(wheels, p.wheel_tip_diameter, strict=True)
        ),
        "face_width_low": tuple(train.face_width / wheel.face_width for wheel in wheels),
        "shaft_diameter_low": train.shaft_diameter / x.shaft_diameter,
    }
    if train.lost_motion is not None and math.isfinite(train.error):
        limits["error"] = train_error(train.lost_motion, both, train.elastic) / p.error
    limits |= clear_rows(x.shaft_diameter, train.output or None, train.motor or None, both)
    return Terms({"mass": gears + 1000.0 * long}, limits, equal=equal)


def _compliance(train: StiffTrain, x: Any, wheels: Iterable[Gear]) -> Any:
    """Return the compliance [rad/(N mm)] of meshes and shaft, seen at the output."""
    first, last = (
        mesh_compliance(train.line_stiffness, wheel.face_width, wheel.reference_diameter)
        for wheel in wheels
    )
    middle = shaft_compliance(train.shear_modulus, x.shaft_diameter, train.shaft_length)
    return output_compliance((last, middle, first), (1.0, x.ratio[1], x.ratio[1]))


def _variables(train: StiffTrain) -> tuple[Var, ...]:
    pinion = 1.1 * train.module * max(train.pinion_teeth)
    sizes = (pinion, train.module, train.face_width, train.shaft_diameter, *train.wheel_tips)
    least, most = min(sizes) / SEARCH_SPAN, max(sizes) * SEARCH_SPAN
    even = math.sqrt(train.ratio[0])
    width, shaft = 2.0 * train.face_width, 2.0 * train.shaft_diameter
    return (
        Var("pinion_diameter", "mm", least, most, pinion, 2, log=True, search=True),
        Var("ratio", "", 1.0 / SEARCH_SPAN, even**2 * SEARCH_SPAN, even, 2, log=True, search=True),
        Var("face_width", "mm", least, most, width, 2, log=True, search=True),
        Var("shaft_diameter", "mm", least, most, shaft, log=True, search=True),
    )
