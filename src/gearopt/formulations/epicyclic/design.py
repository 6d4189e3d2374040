"""A planetary train as a result holds it: speeds, torques, powers, places of its planets."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Annotated

from gearopt.formulations.epicyclic.request import COUPLED, SIMPLE, STEPPED, WOLFROM, Request
from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown
from gearopt.physics.planetary import assembly
from gearopt.physics.planetary.kinematics import Balance, Mesh, balances, speeds

PHASES = ("in step", "in counter-phase", "one after the other")


@dataclass(frozen=True, kw_only=True)
class GearTeeth:
    """A gear of the train: its name, teeth, and diameter in modules of the first step."""

    name: Annotated[str, Shown("gear")]
    teeth: Annotated[int, Shown("teeth z")]
    diameter_modules: Annotated[float, Shown("reference diameter/module")]


@dataclass(frozen=True, kw_only=True)
class Member:
    """A member: speed, torque from outside and power over those of the input; None: locked."""

    name: Annotated[str, Shown("member")]
    use: Annotated[str, Shown("use")]
    speed: Annotated[float, Shown("speed/input speed", form=".6g")]
    exact_speed: Annotated[str, Shown("exactly")]
    torque: Annotated[float | None, Shown("torque/input torque", form=".6g")]
    power: Annotated[float | None, Shown("power/input power", form=".6g")]


@dataclass(frozen=True, kw_only=True)
class RollingPower:
    """A mesh, of all planets together: what its driving gear gives in the frame of the carrier."""

    gears: Annotated[str, Shown("mesh")]
    driver: Annotated[str, Shown("driving gear")]
    efficiency: Annotated[float, Shown("efficiency", form=".4f")]
    rolling_power: Annotated[float, Shown("rolling power/input power", form=".4g")]
    lost: Annotated[float, Shown("lost/input power", form=".4g")]


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a planet is, and phases of its meshes against the first one's, in pitches."""

    carrier: Annotated[str, Shown("carrier")]
    planet: Annotated[int, Shown("planet")]
    angle_deg: Annotated[float, Shown("angle", form=".6f")]
    exact_turn: Annotated[str, Shown("of a turn")]
    sun_phase: Annotated[float, Shown("phase at sun", form=".4f")]
    ring_phase: Annotated[float, Shown("phase at ring", form=".4f")]


@dataclass(frozen=True, kw_only=True)
class EpicyclicDesign:
    """A train. ratio_exact: as a fraction; efficiency: 0 where it locks itself.

    gaps_modules: between tip circles of neighbours, of every carrier.
    """

    arrangement: str
    gears: tuple[GearTeeth, ...]
    ratio: float
    ratio_exact: str
    ratio_error_percent: float | None
    efficiency: float
    members: tuple[Member, ...]
    meshes: tuple[RollingPower, ...]
    places: tuple[Place, ...]
    gaps_modules: tuple[float, ...]
    phases: tuple[str, ...]


def meshes(request: Request, z: Sequence[int]) -> list[Mesh]:
    """The meshes of all gears of a train; one planet stands for all of a carrier."""
    sets, (last_sun, last_ring) = request.use.sets, request.losses[-1]
    (s, r, c), (sun, ring) = sets[0], request.losses[0]
    if request.arrangement == STEPPED:
        both = Mesh(s, "planets", c, z[0], z[1], sun), Mesh("planets", r, c, z[2], -z[3], ring)
        return [*both]
    known = [Mesh(s, "planets", c, z[0], z[1], sun), Mesh("planets", r, c, z[1], -z[2], ring)]
    if request.arrangement == WOLFROM:
        known.append(Mesh("planets", sets[1][1], c, z[3], -z[4], last_ring))
    if request.arrangement == COUPLED:
        s, r, c = sets[1]
        known.append(Mesh(s, "planets of set 2", c, z[3], z[4], last_sun))
        known.append(Mesh("planets of set 2", r, c, z[4], -z[5], last_ring))
    return known


def describe(request: Request, z: Sequence[int]) -> EpicyclicDesign:
    """The train of numbers of teeth that has a ratio."""
    use, gears = request.use, meshes(request, z)
    turning = speeds(gears, {use.source: Fraction(1)} | dict.fromkeys(use.held, Fraction(0)))
    flows = balances(gears, turning, use.source, use.sink, use.held)
    flow = min(flows, key=lambda known: known.efficiency, default=None)
    ratio = 1 / turning[use.sink]
    error = None if request.ratio is None else 100.0 * float(ratio / request.ratio - 1)
    second = float(request.modules)
    sizes = [second if _of_second_step(request, k) else 1.0 for k in range(len(z))]
    suns = [name for name in request.gears if name.startswith("sun")]
    return EpicyclicDesign(
        arrangement=request.arrangement,
        gears=tuple(
            GearTeeth(name=name, teeth=teeth, diameter_modules=size * teeth)
            for name, teeth, size in zip(request.gears, z, sizes, strict=True)
        ),
        ratio=float(ratio),
        ratio_exact=str(ratio),
        ratio_error_percent=error,
        efficiency=float(flow.efficiency) if flow else 0.0,
        members=tuple(_members(request, turning, flow)),
        meshes=tuple(_powers(flow)),
        places=tuple(_places(request, z)),
        gaps_modules=tuple(float(gap) for gap in request.gaps(z)),
        phases=tuple(
            PHASES[int(assembly.in_step(z[3 * k], request.planets[k]))] if request.equal else ""
            for k in range(len(suns))
        ),
    )


def _of_second_step(request: Request, k: int) -> bool:
    """Whether a gear has the module of the second step."""
    return k >= {STEPPED: 2, WOLFROM: 3}.get(request.arrangement, len(request.gears))


def _members(
    request: Request, turning: dict[str, Fraction], flow: Balance | None
) -> Iterator[Member]:
    use = request.use
    uses = dict.fromkeys(use.held, "fixed") | {use.source: "input", use.sink: "output"}
    for name, speed in turning.items():
        planets = name.startswith("planets")
        torque = None if flow is None else float(flow.torques.get(name, 0))
        yield Member(
            name=_joined(request, name),
            use="" if planets else uses.get(name, "free"),
            speed=float(speed),
            exact_speed=str(speed),
            torque=torque,
            power=None if torque is None else torque * float(speed),
        )


def _joined(request: Request, name: str) -> str:
    """A member by all names of what is joined in it."""
    plain = ("sun1", "ring1", "carrier1"), ("sun2", "ring2", "carrier2")
    if request.arrangement != COUPLED or name.startswith("planets"):
        return name
    here = zip(sum(plain, ()), sum(request.use.sets, ()), strict=True)
    return " = ".join(own for own, group in here if group == name)


def _powers(flow: Balance | None) -> Iterator[RollingPower]:
    for known in flow.meshes if flow else ():
        yield RollingPower(
            gears=f"{known.mesh.first}, {known.mesh.second}",
            driver=known.driver,
            efficiency=float(known.mesh.efficiency),
            rolling_power=float(known.rolling),
            lost=float(known.lost),
        )


def _places(request: Request, z: Sequence[int]) -> Iterator[Place]:
    """Places of all planets; phases of a Wolfrom train at the ring on the first step."""
    ring = -1 if request.arrangement in (SIMPLE, STEPPED) else 2
    for k, (count, n) in enumerate(zip(request.places(z), request.planets, strict=True)):
        for j, place in enumerate(assembly.spread(count, n).tolist()):
            turn = Fraction(place, int(count)) if not request.equal else Fraction(j, n)
            phases = [
                float(teeth * turn % 1) for teeth in (z[3 * k], z[3 * k + ring if k else ring])
            ]
            yield Place(
                carrier=_joined(request, request.use.sets[k][2]),
                planet=j + 1,
                angle_deg=360.0 * float(turn),
                exact_turn=str(turn),
                sun_phase=phases[0],
                ring_phase=phases[1],
            )
