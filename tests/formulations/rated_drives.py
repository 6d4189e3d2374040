"""Drives whose stages are limited by ratings, small ones to be searched in full."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength import RATED
from gearopt.formulations.strength.agma import Agma
from gearopt.formulations.strength.iso6336 import Iso6336
from gearopt.formulations.strength.standard import Load, Option
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.gears import Rack
from gearopt.physics.iso6336.case import Practice as IsoPractice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

F = Fraction
MODULES = tuple(F(m) for m in ("1 1.25 1.5 2 2.5 3 4 5 6 8 10 12".split()))
RACK = Rack(tip_radius=0.25)
STEELS = Steel(hardness=335.0), Steel(hardness=300.0)
MATERIALS = Material("V alloy", "ML", 335.0), Material("V alloy", "ML", 300.0)
EIGHT = IsoPractice(grades=(8.0, 8.0))
TIED = FaceWidth(F(3, 5), F(3, 5))
AIMS = "gear_volume", "mass", "sum_of_centre_distances", "total_length"
FREE = FaceWidth(F(3, 10), F(3, 4))


def agma(steels=STEELS, quality=7.0, hours=20000.0, **given):
    """Return the standard of both gears at full load."""
    operation = Operation(1.0, 1.0, hours, overload=1.25)
    practice = given.pop("practice", Practice(quality=quality))
    return Agma((Load(hours),), operation, steels, practice, **given)


def iso(materials=MATERIALS, practice=EIGHT, hours=20000.0, **given):
    """Return the standard ISO 6336 of both gears at full load."""
    operation = Operation(1.0, 1.0, hours, overload=1.25)
    return Iso6336((Load(hours),), operation, materials, practice, **given)


def static(factor=2.5, safety=(1.0, 1.0), **given):
    """Return the static strength of both gears by ISO 6336 at a factor of the torque."""
    still = iso(hours=0.0, suffix="_static", safety=safety, **given)
    operation = replace(still.operation, overload=1.0)
    return replace(still, loads=(Load(0.0, factor),), operation=operation)


def by(*standards):
    """Return the only way of making gears, rated by "agma", "iso", "static" or several."""
    made = {"agma": agma(), "iso": iso(suffix="_iso"), "static": static(7.0, (1.4, 1.2))}
    return (Option(tuple(made[name] for name in standards)),)


def rated_drive(ratio, faces, power=7.5e6, rpm=1450.0, helix=0.4363, options=None, **choice):
    """Return a drive of power [N mm/s], one stage a face width; choice: of every `Stage`."""
    speed = rpm * math.pi / 30.0
    options = (Option((agma(),)),) if options is None else options
    usual = {"modules": MODULES, "pinion_teeth": (20, 40)}
    usual |= {"toothings": (Toothing(helix, (RACK, RACK)),), "options": options}
    stages = tuple(Stage((), face, **(usual | choice)) for face in faces)
    return Train(power / speed, F(ratio), F(1, 100), stages, speed=speed, law=RATED)


TREATMENTS = (
    STEELS,
    (Steel("carburised", 2),) * 2,
    (Steel("carburised", 1), Steel(hardness=280.0)),
    (Steel("nitrided", 2, 300.0),) * 2,
)


OF_STEEL = {
    "through-hardened": Material("V alloy", "MQ", 320.0),
    "carburised": Material("Eh", "MQ"),
    "nitrided": Material("NV", "MQ", 500.0),
}


def some_iso(steels=STEELS, quality=7.0, hours=20000.0):
    """Return the standard ISO 6336 for what `agma` takes."""
    materials = tuple(OF_STEEL[steel.kind] for steel in steels)
    grades = 15.0 - quality, 14.0 - quality
    edition = "2019" if quality % 2 else "2006"
    practice = IsoPractice(edition, "2013" if quality > 8 else "1995", grades)
    return iso(materials, practice, hours, suffix="_iso")


def some_face(rng, module, teeth):
    """Return a face width of any kind that fits about a module [mm] and a number of teeth."""
    low = F(int(rng.integers(2, 7)), 10)
    high = low * F(int(rng.integers(11, 30)), 10)
    kind = rng.choice(["tied", "free", "stepped", "fixed"])
    if kind == "tied":
        return FaceWidth(low, low)
    if kind == "free":
        return FaceWidth(low, high)
    if kind == "stepped":
        return FaceWidth(low, high, step=F(int(rng.integers(2, 9))))
    return FaceWidth(F(0), None, fixed=F(round(float(high * module * teeth))))


def some_rated_drive(seed, stages=None, kinds=("tied", "free", "stepped", "fixed"), standard=agma):
    """Return a random small drive whose loads about fit its modules."""
    rng = np.random.default_rng(seed)
    count = stages or int(rng.integers(1, 3))
    helix = float(rng.choice([0.0, rng.uniform(0.1, 0.5)]))
    begin = int(rng.integers(0, 7))
    modules = MODULES[begin : begin + int(rng.integers(3, 6))]
    low = int(rng.integers(18, 26))
    teeth = low, low + int(rng.integers(1, 4))
    middle = float(modules[len(modules) // 2])
    rpm = float(10.0 ** rng.uniform(1.7, 3.6))
    torque = 12.0 * float(10.0 ** rng.uniform(-0.6, 0.3)) * middle**3 * low**2 * 0.1
    faces = []
    while len(faces) < count:
        face = some_face(rng, middle, low)
        kind = (
            "fixed" if face.fixed else "stepped" if face.step else "tied" if face.tied else "free"
        )
        faces += [face] if kind in kinds else []
    made = standard(
        TREATMENTS[int(rng.integers(0, len(TREATMENTS)))],
        float(rng.integers(5, 12)),
        float(10.0 ** rng.uniform(1.0, 5.0)),
    )
    ratio = F(int(rng.integers(20, 60 if count == 1 else 160)), 10)
    train = rated_drive(
        ratio,
        faces,
        power=torque * rpm * math.pi / 30.0,
        rpm=rpm,
        helix=helix,
        options=(Option((made,)),),
        modules=modules,
        pinion_teeth=teeth,
    )
    safety = float(rng.uniform(0.9, 1.6)), float(rng.uniform(0.9, 1.3))
    return replace(train, safety=safety, objective=str(rng.choice(AIMS)), density=7.8e-9)


def impossible(train, seed):
    """Return a drive that no teeth, modules or widths meet, by a limit that is out of reach."""
    rng = np.random.default_rng(seed)
    kind = rng.choice(["safety", "wheel", "ratio", "width"])
    if kind == "safety":
        return replace(train, safety=(1e3, train.safety[1]) if rng.random() < 0.5 else (1.0, 1e3))
    first = train.stages[0]
    if kind == "wheel":
        least = first.modules[0] * first.pinion_teeth[0]  # cos(beta) at most 1
        first = replace(first, wheel_diameter=least * F(99, 100))
    elif kind == "ratio":
        stages = [replace(s, ratio=(F(1), F(1))) for s in train.stages]
        return replace(train, stages=tuple(stages))
    else:
        widest = first.modules[-1] * first.pinion_teeth[1] / F(first.toothing.cosine)
        face = FaceWidth(F(1, 10), F(1), fixed=widest * F(101, 100))
        first = replace(first, face_width=face)
    return replace(train, stages=(first, *train.stages[1:]))
