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


@dataclass(frozen=True)
class SharingRule:
    """K_gamma by number of planets; more: of any number above these, None: unknown.

    verified: whether two sources have it.
    """

    values: dict[int, float]
    more: float | None = None
    verified: bool = False


# wind: gfsReboucas/Drivetrain, 1.10 of three printed in its reports; class society: rules of one,
# as a vendor's help has them; square root: 1 + 0.25 sqrt(N - 3), memory
SHARING_RULES = {
    "wind": SharingRule({3: 1.10, 4: 1.25, 5: 1.35, 6: 1.44, 7: 1.47}),
    "class society": SharingRule({3: 1.0, 4: 1.2, 5: 1.3, 6: 1.4}, 1.4, verified=True),
    "square root": SharingRule({n: 1.0 + 0.25 * (n - 3) ** 0.5 for n in range(3, 13)}),
}


def mesh_load_factor(planets: int, rule: str) -> float:
    """Return K_gamma of a number of planets by one of SHARING_RULES; 1 of a single planet.

    ValueError for another rule, and for a number of planets that the rule has not.
    """
    if rule not in SHARING_RULES:
        raise ValueError(f"no rule {rule!r} of K_gamma; known: {', '.join(SHARING_RULES)}")
    known = SHARING_RULES[rule]
    if planets == 1:
        return 1.0
    if planets > max(known.values) and known.more is not None:
        return known.more
    if planets not in known.values:
        numbers = f"{min(known.values)} to {max(known.values)}"
        raise ValueError(f"no K_gamma of {planets} planets by {rule!r}: {numbers}; give K_gamma")
    return known.values[planets]


def with_sun(sun: Operation, planets: int, held: bool = False) -> MeshLoad:
    """Return the load of sun (as pinion) and planet; held: the sun, by the casing.

    sun: operation of the sun: its speed [rad/s] against the carrier, as power [N mm/s] its torque
    times that speed (the power of the meshes, not of the shaft).
    """
    operation = replace(sun, power=sun.power / planets, contacts=(float(planets), 1.0))
    return MeshLoad(operation, (float(-planets if held else planets), 1.0))


def with_ring(sun: Operation, planets: int, ratio: Any, held: bool) -> MeshLoad:
    """Return the load of planet (as pinion) and ring.

    sun: as of `with_sun`; ratio z_p/z_s of planet and sun, of stepped planets that of the step on
    the sun. held: by the casing.
    """
    speed = sun.pinion_speed / ratio
    shared = sun.power / planets
    contacts = 1.0, float(planets)
    operation = replace(sun, power=shared, pinion_speed=speed, contacts=contacts)
    return MeshLoad(operation, (1.0, 0.0 if held else float(planets)))


def turned(load: MeshLoad, ratio: Any) -> MeshLoad:
    """Return a load whose wheel is taken as the pinion, ratio u of the pair as the load has it.

    For AGMA, whose pinion has fewer teeth, of a sun with more teeth than a planet; ISO 6336 takes
    the sun as the pinion, whose twist it counts.
    """
    (first, second), given = load.operation.contacts, load.operation
    operation = replace(given, pinion_speed=given.pinion_speed / ratio, contacts=(second, first))
    return MeshLoad(operation, load.meshes[::-1])
