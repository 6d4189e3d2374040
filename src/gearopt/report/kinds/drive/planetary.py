"""Stages with planets or a ring: as they turn, in space, places and loads of planets, powers."""

import math
from fractions import Fraction
from typing import Annotated, Any

import numpy as np

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.epicyclic.design import Place, place_at
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import Shown
from gearopt.physics.gears import Gear
from gearopt.physics.planetary import assembly
from gearopt.physics.planetary.kinematics import Balance, Mesh, balances, speeds
from gearopt.report.design_tables import types
from gearopt.report.drawing.drawn_stage import ENDS
from gearopt.report.drawing.planetary_view import GearSet, Wheel, animation
from gearopt.report.drawing.player import Animation
from gearopt.report.drawing.solid import outline
from gearopt.report.drawing.stage_gears import sun_planet_ring
from gearopt.report.kinds.drive.planetary_solid import figure
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table, records, side_by_side

POINTS = 8_000  # of the outlines of a set
FLANKS = (10, 8, 6, 5, 4, 3, 2)  # points on a flank
TRUE = (
    "teeth and lengths are those of the design, in a transverse section, the planets on the arms "
    "of their carrier."
)
FLOW = (
    "Speeds, torques and powers are without losses, of each stage with the turning of its input "
    "above 0. Torques act on the members from outside: where torque and speed have one sign, power "
    "flows in, else out."
)
PINS = (
    "The power that rolls in the meshes is the torque of the sun times its speed against the "
    "carrier. The force on a pin is that of both meshes on a planet, 2 F_t where both have one "
    "working pressure angle, as the mean of all planets, without K_γ; positive radial forces "
    "point outwards. Centrifugal forces are left out."
)


@dataclass(frozen=True)
class Flow:
    """What turns how fast in a stage, and what flows: over the speed and torque of its input.

    speed [rad/s] and torque [N m] of the input.
    """

    source: str
    sink: str
    held: str
    turning: dict[str, Fraction]
    balance: Balance
    speed: float
    torque: float


@dataclass(frozen=True, kw_only=True)
class Member:
    """A member of a stage under load."""

    stage: Annotated[int, Shown("stage")]
    member: Annotated[str, Shown("member")]
    use: Annotated[str, Shown("use")]
    teeth: Annotated[int | None, Shown("teeth z")]
    speed_rpm: Annotated[float, Shown("speed")]
    torque_Nm: Annotated[float, Shown("torque")]
    power_kW: Annotated[float, Shown("power")]


@dataclass(frozen=True, kw_only=True)
class PlanetLoad:
    """What a planet and its pin carry."""

    tangential_N: Annotated[float, Shown("tangential force on a pin")]
    radial_N: Annotated[float, Shown("radial force on a pin")]
    speed_rpm: Annotated[float, Shown("speed of a planet on its pin")]
    gap_mm: Annotated[float | None, Shown("gap between tips of neighbours")]
    rolling_kW: Annotated[float, Shown("power that rolls in the meshes")]


def _teeth(stage: StageDesign) -> tuple[int, int, int]:
    """Teeth of sun, planet and ring."""
    z_s, z_p, z_r = (round(z or 0) for z in (stage.sun_teeth, stage.planet_teeth, stage.ring_teeth))
    return z_s, z_p, z_r


def flow(stage: StageDesign) -> Flow:
    """Speeds and torques of a planetary stage, without losses."""
    z_s, z_p, z_r = _teeth(stage)
    known = [Mesh("sun", "planets", "carrier", z_s, z_p)]
    known.append(Mesh("planets", "ring", "carrier", z_p, -z_r))
    ends = ENDS[stage.fixed]
    source, sink = ends if stage.driver == "pinion" else ends[::-1]
    turning = speeds(known, {source: Fraction(1), stage.fixed: Fraction(0)})
    balance = balances(known, turning, source, sink, (stage.fixed,))[0]
    rolls = 2e3 * stage.pitch_line_velocity_m_per_s / stage.pinion_diameter_mm
    speed = rolls / abs(float(turning["sun"] - turning["carrier"]))
    torque = stage.pinion_torque_Nm / abs(float(balance.torques["sun"]))
    return Flow(source, sink, stage.fixed, turning, balance, speed, torque)


def members(stage: StageDesign, number: int) -> list[Member]:
    """Members of a stage (its number from 1) under load, of pairs pinion and wheel, or ring."""
    if stage.type != "planetary":
        return _pair(stage, number)
    it, (z_s, _, z_r) = flow(stage), _teeth(stage)
    uses = {it.source: "input", it.sink: "output", it.held: "fixed"}
    rows = []
    for name, teeth in (("sun", z_s), ("ring", z_r), ("carrier", None)):
        speed = it.speed * float(it.turning[name])
        torque = it.torque * float(it.balance.torques[name])
        rows.append(_member(number, name, uses[name], teeth, speed, torque))
    return rows


def _pair(stage: StageDesign, number: int) -> list[Member]:
    speed = 2e3 * stage.pitch_line_velocity_m_per_s / stage.pinion_diameter_mm
    ring = stage.type == "internal"
    other = speed / stage.ratio * (1.0 if ring else -1.0)
    power, rows = speed * stage.pinion_torque_Nm, []
    drives = stage.driver == "pinion"
    speeds_of = (speed, other) if drives else (math.copysign(speed, other), abs(other))
    names = "pinion", "ring" if ring else "wheel"
    teeth = round(stage.pinion_teeth), round(stage.wheel_teeth)
    for name, z, own, first in zip(names, teeth, speeds_of, (drives, not drives), strict=True):
        use, given = ("input", power) if first else ("output", -power)
        rows.append(_member(number, name, use, z, own, given / own))
    return rows


def _member(
    stage: int, name: str, use: str, teeth: int | None, speed: float, torque: float
) -> Member:
    """A row of the table; speed [rad/s], torque [N m]."""
    return Member(
        stage=stage,
        member=name,
        use=use,
        teeth=teeth,
        speed_rpm=30.0 / math.pi * speed,
        torque_Nm=torque,
        power_kW=1e-3 * torque * speed + 0.0,
    )


def planets(stage: StageDesign, number: int = 1) -> list[Place]:
    """Places of the planets of a stage (its number from 1), as equal as teeth allow."""
    z_s, z_p, z_r = _teeth(stage)
    whole = int(assembly.places(z_s, z_p, z_p, z_r))
    where = assembly.spread(whole, stage.planets or 1).tolist()
    turns = [Fraction(place, whole) for place in where]
    return [place_at(f"stage {number}", k, at, z_s, z_r) for k, at in enumerate(turns, 1)]


def planet_load(stage: StageDesign) -> PlanetLoad:
    """Forces on a pin, T_c/(N a) along the path of the planets, and what turns on it.

    Both meshes have the force T_s/(N r_bs) along their lines of action.
    """
    it, n, a = flow(stage), stage.planets or 1, stage.centre_distance_mm
    torques = {name: 1e3 * it.torque * float(t) for name, t in it.balance.torques.items()}
    outer = stage.pair
    base = 0.5 * float(outer.pinion.base_diameter)
    z_s, z_p, z_r = _teeth(stage)
    inner = math.acos(min(base / z_s * (z_r - z_p) / a, 1.0))
    along = abs(torques["sun"]) / (n * base)
    rolls = it.speed * float(it.turning["sun"] - it.turning["carrier"])
    own = it.speed * float(it.turning["planets"] - it.turning["carrier"])
    angles = [360.0, *(360.0 + at.angle_deg for at in planets(stage)[1:]), 720.0]
    closest = min(end - start for start, end in zip(angles, angles[1:], strict=False))
    apart = 2.0 * a * math.sin(math.radians(0.5 * closest)) - stage.wheel_tip_diameter_mm
    return PlanetLoad(
        tangential_N=abs(torques["carrier"]) / (n * a),
        radial_N=along * (math.sin(float(outer.working_angle)) - math.sin(inner)),
        speed_rpm=30.0 / math.pi * own,
        gap_mm=apart if n > 1 else None,
        rolling_kW=1e-6 * abs(torques["sun"] * rolls),
    )


def gear_set(stage: StageDesign, gears: tuple[Gear, Gear, Gear]) -> GearSet:
    """A stage as it is seen along its axis, in mm."""
    n, turning = stage.planets or 1, flow(stage).turning
    teeth = [abs(round(gear.teeth)) for gear in gears]
    points = 2 * (teeth[0] + n * teeth[1] + teeth[2])
    flank = next((flank for flank in FLANKS if flank * points < POINTS), FLANKS[-1])
    rims = 0.0, 0.0, 0.5 * (stage.ring_outside_diameter_mm or 0.0)

    def wheel(k: int, name: str, speed: str) -> Wheel:
        angle, r = np.array(outline(gears[k], flank, 0.0)).T
        shape = np.stack((r * np.cos(angle), r * np.sin(angle)), axis=1)
        return Wheel(name, teeth[k], float(turning[speed]), shape, rims[k])

    return GearSet(
        wheel(0, "sun", "sun"),
        wheel(1, "planet", "planets"),
        wheel(2, "ring", "ring"),
        teeth[1],
        teeth[1],
        float(turning["carrier"]),
        [math.radians(at.angle_deg) for at in planets(stage)],
        stage.centre_distance_mm,
    )


def _stages(result: Result) -> list[tuple[int, StageDesign]]:
    """The planetary stages of a design, with their numbers from 1."""
    return [(k, stage) for k, stage in _with_rings(result) if stage.type == "planetary"]


def _with_rings(result: Result) -> list[tuple[int, StageDesign]]:
    """All stages, with their numbers from 1, of a design in which there is a ring."""
    if types(result.design.get("stages", ())) <= {"parallel"}:
        return []
    return [*enumerate(drive_design(result.design).stages, 1)]


def turning(result: Result, measures: Measures) -> Section | None:
    """Planetary stages as they turn, and in space."""
    turns: list[Animation] = []
    figures, words = [], []
    for k, stage in _stages(result):
        if (gears := sun_planet_ring(stage)) is None:
            words.append(
                f"Stage {k} is not drawn with its teeth: the ring has other diameters than its "
                "tool cuts."
            )
            continue
        it, seen = flow(stage), gear_set(stage, gears)
        both = ("input", it.source), ("output", it.sink)
        ends = [(f"{name} ({use})", float(it.turning[name])) for use, name in both]
        held = f"The {it.held} of stage {k} is held."
        turns.append(animation([seen], f"stage {k} as it turns", ends, f"{TRUE} {held}"))
        figures.append(figure(stage, k, seen, gears, measures))
    if not turns and not words:
        return None
    return Section("Planetary stages", words=words, animations=turns, figures=figures)


def loads(result: Result, measures: Measures) -> Section | None:
    """Power flow, places of planets and forces on their pins; None without a ring."""
    if not (every := _with_rings(result)):
        return None
    flows: list[Any] = [row for k, stage in every for row in members(stage, k)]
    tables = [Table("members", *records(flows, measures), texts=("member", "use"))]
    words = [FLOW]
    if stages := _stages(result):
        heads = ["", *(f"stage {k}" for k, _ in stages)]
        where: list[Any] = [row for k, stage in stages for row in planets(stage, k)]
        carried = side_by_side([planet_load(stage) for _, stage in stages], measures)
        tables.append(Table("planet pins", heads, carried, across=True))
        tables.append(Table("planets", *records(where, measures)))
        words.append(PINS)
    return Section("Power flow", words=words, tables=tables, terminal=tables)
