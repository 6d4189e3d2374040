"""A pair, materials and a load that tests of ISO 6336 share."""

from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

EH = Material("Eh", "MQ")
V = Material("V alloy", "ML", 300.0, yield_strength=700.0)
LOAD = Operation(5e7, 150.0, 2000.0, overload=1.25)


def spur(**more):
    return GearPair.of_teeth(4.0, 21, 63, 40.0, **more)


def helical(angle=0.25):
    return GearPair.of_teeth(4.0, 21, 63, 40.0, angle, profile_shifts=(0.2, 0.0))


def steels(material):
    return material, material
