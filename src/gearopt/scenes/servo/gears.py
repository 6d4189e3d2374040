"""Four gears of a servo train as every part of its result shows them."""

import math
from dataclasses import replace

from gearopt.formulations.servo.servo_design import KG_M2, ErrorSource, Stage, TrainDesign
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.split.servo_train import objectives, pairs
from gearopt.formulations.servo.split.teeth import bending_stress
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import Source


def sensitivity(pairs: Pairs, source: Source) -> float:
    """Return the error of the output [rad] per mm of a deviation."""
    first, second = pairs
    if source.stage == 1:
        return float(source.per_mm / (first.wheel.reference_diameter * second.ratio))
    return float(source.per_mm / second.wheel.reference_diameter)


def of_point(scene: Scene, x: Array) -> Pairs:
    """Return the gear pairs of a point of `split.problem`."""
    width = math.nan if scene.train is None else scene.servo_train().face_width
    return pairs((*(round(float(z)) for z in x[:4]), float(x[4]), float(x[5])), width)


def to_point(pairs: Pairs) -> Array:
    """Return the point of `split.problem` of gear pairs."""
    import numpy as np

    names = ("pinion_teeth", "wheel_teeth", "normal_module")
    return np.array([getattr(pair, name) for name in names for pair in pairs], float)


def given_gears(scene: Scene) -> Pairs | None:
    """Return the gear pairs that a file gives in its [[mesh]] tables."""
    if not scene.mesh or not scene.mesh[0].given:
        return None
    width = math.nan if scene.train is None else scene.servo_train().face_width
    first, second = (mesh.pair(width) for mesh in scene.mesh)
    return first, second


def errors(scene: Scene, gears: Pairs) -> tuple[ErrorSource, ...]:
    """Every source of error at the output, all at their worst; they add up."""
    return tuple(
        ErrorSource(
            source=s.name,
            kind=s.kind,
            stage=s.stage,
            tolerance_mm=s.tolerance,
            error_deg=math.degrees(s.tolerance * sensitivity(gears, s)),
        )
        for s in scene.sources
    )


def _stage(pair: GearPair, stress: float | None) -> Stage:
    """A stage in the words of a drawing; stress and width where the train is known."""
    pinion, wheel = pair.gears
    return Stage(
        normal_module_mm=pair.normal_module,
        pinion_teeth=pinion.teeth,
        wheel_teeth=wheel.teeth,
        ratio=pair.ratio,
        pinion_diameter_mm=float(pinion.reference_diameter),
        wheel_diameter_mm=float(wheel.reference_diameter),
        pinion_tip_diameter_mm=float(pinion.tip_diameter),
        wheel_tip_diameter_mm=float(wheel.tip_diameter),
        centre_distance_mm=float(pair.centre_distance),
        face_width_mm=None if stress is None else pair.face_width,
        bending_stress_MPa=stress,
    )


def described(scene: Scene, gears: Pairs) -> TrainDesign:
    """The train of a result."""
    first, second = gears
    n, table = first.ratio * second.ratio, scene.train
    train = None if table is None else scene.servo_train()
    stresses: tuple[float | None, float | None] = (None, None)
    if train is not None:
        torques = train.output_torque / second.ratio, train.output_torque
        one, two = (bending_stress(t, p) for t, p in zip(torques, gears, strict=True))
        stresses = float(one), float(two)
    error = sum(s.tolerance * sensitivity(gears, s) for s in scene.sources)
    found = TrainDesign(
        stages=(_stage(first, stresses[0]), _stage(second, stresses[1])),
        ratio=n,
        error_deg=math.degrees(error) if scene.sources else None,
    )
    if table is None or train is None:
        return found
    worth = objectives(train, ("inertia", "mass"), gears)
    single = table.ratio[0] == table.ratio[1]
    return replace(
        found,
        ratio_error_percent=100.0 * (n / float(train.ratio) - 1.0) if single else None,
        inertia_kg_m2=float(KG_M2 * worth["inertia"]),
        mass_kg=float(worth["mass"]),
        sector=float(table.sector),
    )
