"""Drives whose stages are limited by ratings, small ones to be searched in full."""

import math
from fractions import Fraction

from gearopt.formulations.gear_train import FaceWidth, Stage, Train
from gearopt.formulations.strength import RATED
from gearopt.formulations.strength.agma import Agma
from gearopt.formulations.strength.iso6336 import Iso6336
from gearopt.formulations.strength.rated import Load, Option
from gearopt.formulations.toothing import Toothing
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
FREE = FaceWidth(F(3, 10), F(3, 4))


def agma(steels=STEELS, quality=7.0, hours=20000.0, **given):
    """Return the standard of both gears at full load."""
    operation = Operation(1.0, 1.0, hours, overload=1.25)
    return Agma((Load(hours),), operation, steels, Practice(quality=quality), **given)


def iso(materials=MATERIALS, practice=EIGHT, hours=20000.0, **given):
    """Return the standard ISO 6336 of both gears at full load."""
    operation = Operation(1.0, 1.0, hours, overload=1.25)
    return Iso6336((Load(hours),), operation, materials, practice, **given)


def rated_drive(ratio, faces, power=7.5e6, rpm=1450.0, helix=0.4363, options=None, **choice):
    """Return a drive of power [N mm/s], one stage a face width; choice: of every `Stage`."""
    speed = rpm * math.pi / 30.0
    options = (Option((agma(),)),) if options is None else options
    usual = {"modules": MODULES, "pinion_teeth": (20, 40)}
    usual |= {"toothing": Toothing(helix, (RACK, RACK)), "options": options}
    stages = tuple(Stage((), face, **(usual | choice)) for face in faces)
    return Train(power / speed, F(ratio), F(1, 100), stages, speed=speed, law=RATED)
