"""Four gears of a servo train as every part of its result shows them."""

import math
from dataclasses import dataclass, replace

from gearopt.formulations.servo.servo_design import KG_M2, ErrorSource, Stage, TrainDesign
from gearopt.formulations.servo.split.servo_train import ServoTrain, lewis_stress, objectives
from gearopt.optimise.terms import Array
from gearopt.physics.gears import ISO_53_A
from gearopt.physics.stiffness import lewis_form_factor
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import Source


@dataclass(frozen=True)
class Gears:
    """Modules [mm] and teeth of both stages, from the motor on."""

    modules: tuple[float, float]
    pinions: tuple[int, int]
    wheels: tuple[int, int]

    @property
    def ratios(self) -> tuple[float, float]:
        """Ratios of both stages."""
        (z1, z3), (z2, z4) = self.pinions, self.wheels
        return z2 / z1, z4 / z3

    @property
    def diameters(self) -> tuple[float, float, float, float]:
        """Pitch diameters of gears 1 to 4 [mm]."""
        (m1, m2), (z1, z3), (z2, z4) = self.modules, self.pinions, self.wheels
        return m1 * z1, m1 * z2, m2 * z3, m2 * z4

    @property
    def point(self) -> Array:
        """The point of `split.problem`."""
        import numpy as np

        return np.array([*self.pinions, *self.wheels, *self.modules], float)

    def sensitivity(self, source: Source) -> float:
        """Error of the output [rad] per mm of a deviation."""
        wheel = self.diameters[1] if source.stage == 1 else self.diameters[3]
        return source.per_mm / (wheel * (self.ratios[1] if source.stage == 1 else 1.0))


def of_point(x: Array) -> Gears:
    """The gears of a point of `split.problem`."""
    z1, z3, z2, z4 = (round(float(z)) for z in x[:4])
    return Gears((float(x[4]), float(x[5])), (z1, z3), (z2, z4))


def given_gears(scene: Scene) -> Gears | None:
    """The gears that a file gives in its [[mesh]] tables."""
    if not scene.mesh or not scene.mesh[0].given:
        return None
    first, second = scene.mesh
    assert first.module is not None and second.module is not None
    return Gears(
        (first.module.value, second.module.value),
        (int(first.pinion_teeth or 0), int(second.pinion_teeth or 0)),
        (int(first.wheel_teeth or 0), int(second.wheel_teeth or 0)),
    )


def errors(scene: Scene, gears: Gears) -> tuple[ErrorSource, ...]:
    """Every source of error at the output, all at their worst; they add up."""
    return tuple(
        ErrorSource(
            source=s.name,
            kind=s.kind,
            stage=s.stage,
            tolerance_mm=s.tolerance,
            error_deg=math.degrees(s.tolerance * gears.sensitivity(s)),
        )
        for s in scene.sources
    )


def _stage(gears: Gears, k: int, train: ServoTrain | None) -> Stage:
    """A stage (0 or 1) in the words of a drawing; stress and width where the train is known."""
    m, z1, z2, n = gears.modules[k], gears.pinions[k], gears.wheels[k], gears.ratios[k]
    stress = None
    if train is not None:
        torque = train.output_torque / (gears.ratios[1] if k == 0 else 1.0)
        factor = lewis_form_factor(z1)
        stress = lewis_stress(torque, m * z2, train.face_width, m, factor)
    return Stage(
        normal_module_mm=m,
        pinion_teeth=z1,
        wheel_teeth=z2,
        ratio=n,
        pinion_diameter_mm=m * z1,
        wheel_diameter_mm=m * z2,
        pinion_tip_diameter_mm=m * (z1 + 2.0 * ISO_53_A.addendum),
        wheel_tip_diameter_mm=m * (z2 + 2.0 * ISO_53_A.addendum),
        centre_distance_mm=0.5 * m * (z1 + z2),
        face_width_mm=None if train is None else train.face_width,
        bending_stress_MPa=stress,
    )


def described(scene: Scene, gears: Gears) -> TrainDesign:
    """The train of a result."""
    n, table = gears.ratios[0] * gears.ratios[1], scene.train
    train = None if table is None else scene.servo_train()
    error = sum(s.tolerance * gears.sensitivity(s) for s in scene.sources)
    found = TrainDesign(
        stages=(_stage(gears, 0, train), _stage(gears, 1, train)),
        ratio=n,
        error_deg=math.degrees(error) if scene.sources else None,
    )
    if table is None or train is None:
        return found
    worth = objectives(train, ("inertia", "mass"), gears.diameters, gears.ratios)
    single = table.ratio[0] == table.ratio[1]
    return replace(
        found,
        ratio_error_percent=100.0 * (n / float(train.ratio) - 1.0) if single else None,
        inertia_kg_m2=KG_M2 * worth["inertia"],
        mass_kg=worth["mass"],
        sector=float(table.sector),
    )
