"""Loads on the meshes of a planetary stage, as ratings of gear pairs take them.

F_t of a mesh is the torque of the sun over N planets, without the mesh load factor K_gamma, which
stands beside K_A (a printed report of three planets has F_t and K_gamma = 1.10 so). Speeds and load
cycles are those against the carrier: of N planets a turn a tooth of sun or ring meets N, a tooth of
a planet one of each with either flank, so that its root is bent both ways: `reversed_load` of its
material. Floats, arrays or casadi scalars.
"""

from dataclasses import replace
from typing import Any

from gearopt.frozen import dataclass
from gearopt.physics.rating import Operation


@dataclass(frozen=True)
class MeshLoad:
    """A mesh as a rating takes it: operation of one planet; meshes in which both gears are at once.

    meshes: as of `iso6336.case.Practice`.
    """

    operation: Operation
    meshes: tuple[float, float]


def with_sun(sun: Operation, planets: int, held: bool = False) -> MeshLoad:
    """The load of sun (as pinion) and planet; held: the sun, by the casing.

    sun: operation of the sun: its speed [rad/s] against the carrier, as power [N mm/s] its torque
    times that speed (the power of the meshes, not of the shaft).
    """
    operation = replace(sun, power=sun.power / planets, contacts=(float(planets), 1.0))
    return MeshLoad(operation, (float(-planets if held else planets), 1.0))


def with_ring(sun: Operation, planets: int, ratio: Any, held: bool) -> MeshLoad:
    """The load of planet (as pinion) and ring.

    sun: as of `with_sun`; ratio z_p/z_s of planet and sun, of stepped planets that of the step on
    the sun. held: by the casing.
    """
    speed = sun.pinion_speed / ratio
    shared = sun.power / planets
    contacts = 1.0, float(planets)
    operation = replace(sun, power=shared, pinion_speed=speed, contacts=contacts)
    return MeshLoad(operation, (1.0, 0.0 if held else float(planets)))


def turned(load: MeshLoad, ratio: Any) -> MeshLoad:
    """A load whose wheel is taken as the pinion, ratio u of the pair as the load has it.

    For AGMA, whose pinion has fewer teeth, of a sun with more teeth than a planet; ISO 6336 takes
    the sun as the pinion, whose twist it counts.
    """
    (first, second), given = load.operation.contacts, load.operation
    operation = replace(given, pinion_speed=given.pinion_speed / ratio, contacts=(second, first))
    return MeshLoad(operation, load.meshes[::-1])
