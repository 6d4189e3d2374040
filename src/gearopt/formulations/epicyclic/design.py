"""A planetary train as a result holds it: speeds, torques, powers, places of its planets."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Annotated

from gearopt.formulations.epicyclic.request import Request
from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown
from gearopt.physics.planetary import assembly
from gearopt.physics.planetary.willis import PLANETS, Flow, MeshPower, Use, flow


@dataclass(frozen=True, kw_only=True)
class GearTeeth:
    """A gear of the train; module: over that of the first step."""

    name: Annotated[str, Shown("gear")]
    teeth: Annotated[int, Shown("teeth z")]
    module: Annotated[float, Shown("module/module of the first step")]


@dataclass(frozen=True, kw_only=True)
class Member:
    """A member: speed, torque from outside and power over those of the input; None: locked."""

    name: Annotated[str, Shown("member")]
    use: Annotated[str, Shown("use")]
    speed: Annotated[float, Shown("speed/input speed", form=".6g")]
    exact_speed: Annotated[str, Shown("exact speed")]
    torque: Annotated[float | None, Shown("torque/input torque", form=".6g")]
    power: Annotated[float | None, Shown("power/input power", form=".6g")]


@dataclass(frozen=True, kw_only=True)
class RollingPower:
    """A mesh, of all planets together: what its driving gear gives in the frame of the carrier."""

    gears: Annotated[str, Shown("mesh")]
    driver: Annotated[str, Shown("driving gear")]
    efficiency: Annotated[float, Shown("efficiency", form=".4f")]
    rolling_power: Annotated[float, Shown("rolling power/input power", form=".4g")]
    lost: Annotated[float, Shown("loss/input power", form=".4g")]


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a planet is, and phases of its meshes against the first one's, in pitches."""

    planets: Annotated[str, Shown("of")]
    planet: Annotated[int, Shown("planet")]
    angle_deg: Annotated[float, Shown("angle", unit="deg", form=".6f")]
    turn: Annotated[str, Shown("of a turn")]
    sun_phase: Annotated[float, Shown("phase at the sun", form=".4f")]
    ring_phase: Annotated[float, Shown("phase at the ring", form=".4f")]


@dataclass(frozen=True, kw_only=True)
class EpicyclicDesign:
    """A train. exact_ratio: as a fraction; efficiency: 0 where it locks itself.

    sets: names of sun, ring and carrier, of what turns together one. gap_modules: between tip
    circles of neighbours, the smallest.
    """

    arrangement: str
    sets: tuple[tuple[str, str, str], ...]
    gears: tuple[GearTeeth, ...]
    ratio: float
    exact_ratio: str
    ratio_error_percent: float | None
    efficiency: float
    members: tuple[Member, ...]
    meshes: tuple[RollingPower, ...]
    places: tuple[Place, ...]
    gap_modules: float


def describe(request: Request, z: Sequence[int]) -> EpicyclicDesign:
    """The train of numbers of teeth that has a ratio."""
    use, sets = request.use, request.sets(z)
    known = flow(use, sets, request.losses)
    ratio, asked = 1 / known.speeds[use.sink], request.ratio
    gears = enumerate(request.gears)
    return EpicyclicDesign(
        arrangement=request.arrangement,
        sets=use.sets,
        gears=tuple(GearTeeth(name=n, teeth=z[k], module=request.module(k)) for k, n in gears),
        ratio=float(ratio),
        exact_ratio=str(ratio),
        ratio_error_percent=None if asked is None else 100.0 * float(ratio / asked - 1),
        efficiency=float(known.efficiency),
        members=tuple(_members(use, known)),
        meshes=tuple(map(_power, known.meshes)),
        places=tuple(_places(request, z)),
        gap_modules=min(float(apart - tips) for apart, tips in request.neighbours(z)),
    )


def _members(use: Use, known: Flow) -> Iterator[Member]:
    for name, speed in known.speeds.items():
        torque = float(known.torques.get(name, 0)) if known.torques else None
        yield Member(
            name=name,
            use=use.roles.get(name, ""),
            speed=float(speed),
            exact_speed=str(speed),
            torque=torque,
            power=None if torque is None else 0.0 + torque * float(speed),
        )


def _power(known: MeshPower) -> RollingPower:
    return RollingPower(
        gears=", ".join(known.gears),
        driver=known.driver,
        efficiency=float(known.efficiency),
        rolling_power=float(known.rolling),
        lost=float(known.lost),
    )


def _places(request: Request, z: Sequence[int]) -> Iterator[Place]:
    """Places of all planets; phases of a Wolfrom train at its first ring."""
    for k, (count, n) in enumerate(zip(request.places(z), request.planets, strict=True)):
        sun, _, _, ring = request.sets(z)[k]
        turns = assembly.turns(n if request.equal else int(count), n)
        yield from placed(PLANETS[k], turns, sun, ring)


def placed(of: str, turns: Sequence[Fraction], sun: int, ring: int) -> Iterator[Place]:
    """Planets at parts of a turn; teeth of sun and ring."""
    for number, turn in enumerate(turns, 1):
        yield Place(
            planets=of,
            planet=number,
            angle_deg=360.0 * float(turn),
            turn=str(turn),
            sun_phase=float(sun * turn % 1),
            ring_phase=float(ring * turn % 1),
        )
