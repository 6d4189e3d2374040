"""How stiff a servo train is at its output: meshes and shaft in series, motor locked."""

import math
from collections.abc import Iterable
from typing import Any

from gearopt.physics.stiffness import (
    lewis_form_factor,
    line_stiffness,
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    tooth_factor,
)
from gearopt.scenes.servo.gears import Gears
from gearopt.scenes.servo.scene import Scene


def compliances(
    scene: Scene, diameters: tuple[Any, Any], teeth: tuple[Any, Any, Any, Any], ratio_2: Any
) -> tuple[Any, Any, Any]:
    """Compliances [rad/(N mm)] at the output of mesh 2, shaft and mesh 1; arrays too.

    diameters of wheels 2 and 4 [mm]; teeth z1, z2, z3, z4; ratio_2 of the second stage.
    """
    spring, shaft, train = scene.stiffness, scene.shaft, scene.train
    assert spring is not None and shaft is not None and train is not None
    width, (d2, d4) = train.face_width.value, diameters
    first, second = (_line(scene, pair) for pair in (teeth[:2], teeth[2:]))
    twist = shaft_compliance(spring.shear_modulus.value, shaft.diameter.value, shaft.length.value)
    return (
        mesh_compliance(second, width, d4),
        twist / ratio_2**2,
        mesh_compliance(first, width, d2) / ratio_2**2,
    )


def _line(scene: Scene, pair: tuple[Any, ...]) -> Any:
    """Line stiffness [MPa] of a pair of gears, given or by Lewis's form of its teeth."""
    spring = scene.stiffness
    assert spring is not None
    if spring.line_stiffness is not None:
        return spring.line_stiffness.value
    assert spring.youngs_modulus is not None
    modulus = spring.youngs_modulus.value
    one, two = (tooth_factor(lewis_form_factor(z) / math.pi) for z in pair)
    return line_stiffness(modulus, one, modulus, two)


def output_stiffness(scene: Scene, point: Iterable[Any]) -> Any:
    """Stiffness at the output [N mm/rad] of the six numbers of a point of `split.problem`."""
    z1, z3, z2, z4, m1, m2 = point
    parts = compliances(scene, (m1 * z2, m2 * z4), (z1, z2, z3, z4), z4 / z3)
    return 1.0 / output_compliance(parts, (1.0, 1.0, 1.0))


def stiffness_of(scene: Scene, gears: Gears) -> dict[str, Any]:
    """Stiffness, frequency and windup of a train, with the share of every spring."""
    (z1, z3), (z2, z4), n2 = gears.pinions, gears.wheels, gears.ratios[1]
    _, d2, _, d4 = gears.diameters
    parts = [float(c) for c in compliances(scene, (d2, d4), (z1, z2, z3, z4), n2)]
    total = math.fsum(parts)
    names = ("mesh of stage 2", "shaft between the stages", "mesh of stage 1")
    found: dict[str, Any] = {"output_Nm_per_rad": 1e-3 / total}
    spring, load = scene.stiffness, scene.load
    assert spring is not None
    if load is not None:
        found["frequency_Hz"] = float(locked_frequency(1.0 / total, load.inertia.value))
    if spring.load_torque is not None:
        found["windup_deg"] = math.degrees(spring.load_torque.value * total)
    found["springs"] = [
        {"name": name, "compliance_share": part / total, "referred_Nm_per_rad": 1e-3 / part}
        for name, part in zip(names, parts, strict=True)
    ]
    return found
