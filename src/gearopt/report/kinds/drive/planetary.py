"""Stages with planets or a ring: as they turn, in space, places and loads of planets, powers."""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Any

import numpy as np

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.epicyclic.design import Place, placed
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import Shown
from gearopt.physics.gears import Gear
from gearopt.physics.planetary import assembly
from gearopt.physics.planetary.willis import Use, simple_set
from gearopt.physics.planetary.willis import flow as train_flow
from gearopt.report.design_tables import types
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


def _pinion_speed(stage: StageDesign) -> float:
    """Speed [rad/s] of the pinion, of a sun against the carrier."""
    return 2e3 * stage.pitch_line_velocity_m_per_s / stage.pinion_diameter_mm


def flow(stage: StageDesign) -> tuple[Use, dict[str, float], dict[str, float]]:
    """Who does what in a planetary stage, speeds [rad/s] and torques [N m], without losses."""
    z_s, z_p, z_r = _teeth(stage)
    use = simple_set(stage.fixed, stage.driver != "pinion")
    known = train_flow(use, [(z_s, z_p, z_p, z_r)], [(Fraction(1), Fraction(1))])
    slip = known.speeds["sun"] - known.speeds["carrier"]
    speed = _pinion_speed(stage) / abs(float(slip))
    torque = stage.pinion_torque_Nm / abs(float(known.torques["sun"]))
    speeds = {name: speed * float(n) for name, n in known.speeds.items()}
    return use, speeds, {name: torque * float(t) for name, t in known.torques.items()}


def members(stage: StageDesign, number: int) -> list[Member]:
    """Members of a stage (its number from 1) under load, of pairs pinion and wheel, or ring."""
    return [
        Member(
            stage=number,
            member=name,
            use=use,
            teeth=teeth,
            speed_rpm=30.0 / math.pi * speed,
            torque_Nm=torque,
            power_kW=1e-3 * torque * speed + 0.0,
        )
        for name, use, teeth, speed, torque in (
            _of_set(stage) if stage.type == "planetary" else _of_pair(stage)
        )
    ]


def _of_set(stage: StageDesign) -> Iterator[tuple[str, str, int | None, float, float]]:
    """Yield members with what they do, teeth, speed [rad/s] and torque [N m]."""
    (use, speeds, torques), (z_s, _, z_r) = flow(stage), _teeth(stage)
    for name, teeth in (("sun", z_s), ("ring", z_r), ("carrier", None)):
        yield name, use.roles[name], teeth, speeds[name], torques[name]


def _of_pair(stage: StageDesign) -> Iterator[tuple[str, str, int | None, float, float]]:
    """Yield what `_of_set` does of a pair of gears."""
    speed, ring = _pinion_speed(stage), stage.type == "internal"
    other, drives = speed / stage.ratio * (1.0 if ring else -1.0), stage.driver == "pinion"
    power = speed * stage.pinion_torque_Nm
    speeds = (speed, other) if drives else (math.copysign(speed, other), abs(other))
    rows = ("pinion", stage.pinion_teeth), ("ring" if ring else "wheel", stage.wheel_teeth)
    for (name, z), n, first in zip(rows, speeds, (drives, not drives), strict=True):
        yield name, "input" if first else "output", round(z), n, (power if first else -power) / n


def planets(stage: StageDesign, number: int = 1) -> list[Place]:
    """Places of the planets of a stage (its number from 1), as equal as teeth allow."""
    z_s, _, z_r = _teeth(stage)
    turns = assembly.turns(z_s + z_r, stage.planets or 1)
    return [*placed(f"stage {number}", turns, z_s, z_r)]


def planet_load(stage: StageDesign) -> PlanetLoad:
    """Forces on a pin, T_c/(N a) along the path of the planets, and what turns on it.

    Both meshes have the force T_s/(N r_bs) along their lines of action.
    """
    n, a, (z_s, z_p, z_r) = stage.planets or 1, stage.centre_distance_mm, _teeth(stage)
    _, speeds, torques = flow(stage)
    outer = stage.pair
    base = 0.5 * float(outer.pinion.base_diameter)
    inner = math.acos(min(base / z_s * (z_r - z_p) / a, 1.0))
    along = 1e3 * abs(torques["sun"]) / (n * base)
    spacing = float(assembly.least_spacing(z_s + z_r, n))
    apart = float(assembly.neighbour_distance(a, spacing)) - stage.wheel_tip_diameter_mm
    return PlanetLoad(
        tangential_N=1e3 * abs(torques["carrier"]) / (n * a),
        radial_N=along * (math.sin(float(outer.working_angle)) - math.sin(inner)),
        speed_rpm=30.0 / math.pi * (speeds["planets"] - speeds["carrier"]),
        gap_mm=apart if n > 1 else None,
        rolling_kW=1e-3 * abs(torques["sun"] * (speeds["sun"] - speeds["carrier"])),
    )


def gear_set(stage: StageDesign, gears: tuple[Gear, Gear, Gear]) -> GearSet:
    """A stage as it is seen along its axis, in mm."""
    n, (use, speeds, _) = stage.planets or 1, flow(stage)
    turning = {name: speed / speeds[use.source] for name, speed in speeds.items()}
    teeth = [abs(round(gear.teeth)) for gear in gears]
    points = 2 * (teeth[0] + n * teeth[1] + teeth[2])
    flank = next((flank for flank in FLANKS if flank * points < POINTS), FLANKS[-1])
    rims = 0.0, 0.0, 0.5 * (stage.ring_outside_diameter_mm or 0.0)

    def wheel(k: int, name: str, speed: str) -> Wheel:
        angle, r = np.array(outline(gears[k], flank, 0.0)).T
        shape = np.stack((r * np.cos(angle), r * np.sin(angle)), axis=1)
        return Wheel(name, teeth[k], turning[speed], shape, rims[k])

    return GearSet(
        wheel(0, "sun", "sun"),
        wheel(1, "planet", "planets"),
        wheel(2, "ring", "ring"),
        teeth[1],
        teeth[1],
        turning["carrier"],
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
        (use, speeds, _), seen = flow(stage), gear_set(stage, gears)
        ratio = speeds[use.sink] / speeds[use.source]
        ends = [(f"{use.source} (input)", 1.0), (f"{use.sink} (output)", ratio)]
        held = f"The {stage.fixed} of stage {k} is held."
        turns.append(animation([seen], f"stage {k} as it turns", ends, f"{TRUE} {held}"))
        figures.append(figure(stage, k, seen, gears, measures))
    if not turns and not words:
        return None
    return Section(
        "Planetary stages", words=words, animations=turns, figures=figures, appendix=True
    )


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
        tables.append(Table("planets", *records(where, measures), appendix=True))
        words.append(PINS)
    return Section("Power flow", words=words, tables=tables, terminal=tables)
