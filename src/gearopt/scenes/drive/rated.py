"""The rating of a drive: of gears that are all given, and of those that were chosen."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.design import StageDesign, drive_design, of_pairs
from gearopt.formulations.rating import (
    DriveRating,
    GearRating,
    LoadLevel,
    MeshRating,
    RatingFactor,
    ShaftRating,
)
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import FEASIBLE, Result, versions
from gearopt.optimise.typed import untyped
from gearopt.physics.agma.life import LONGEST
from gearopt.physics.agma.rating import Rating, rate_spectrum
from gearopt.physics.agma.rating import rate as rate_pair
from gearopt.physics.agma.rating_factors import Operation
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import total_contact_ratio
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.geometry.tooth import (
    circumferential_backlash,
    helix_angle_at,
    normal_backlash,
)
from gearopt.physics.loads import torque
from gearopt.physics.mesh_loss import (
    FRICTION_ERROR,
    friction_coefficient,
    mesh_efficiency,
    tooth_loss_factor,
)
from gearopt.physics.shaft_forces import hands, mesh_forces, rotation, rpm, train_forces
from gearopt.scenes.drive import rated_gears
from gearopt.scenes.drive.assumptions import rating_assumptions
from gearopt.scenes.drive.rated_gears import MEMBERS
from gearopt.scenes.drive.rated_words import NAMES, UNITS, material
from gearopt.scenes.drive.rating_checks import not_given
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tooth_geometry import tooth_geometry
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.toml import dotted

STANDARD = "ANSI/AGMA 2001-{} (2101), geometry factors of AGMA 908-B89"


@dataclass(frozen=True)
class Mesh:
    """One stage (from 1) with its rating: hardest of all levels, and safety against all of them."""

    stage: int
    pair: GearPair
    tables: tuple[Any, Any]
    operations: tuple[Operation, ...]
    levels: tuple[Rating, ...]
    bending_safety: tuple[float, float]
    contact_safety: tuple[float, float]
    damages: tuple[tuple[float, float], tuple[float, float]] | None  # of bending, of contact

    @property
    def hardest(self) -> Rating:
        """Return the level of the largest load."""
        return max(self.levels, key=lambda level: level.load)


def rate(scene: Scene, ask: Ask) -> Result:
    """Return the rating of gears that are all given, status `evaluated`; SolveError why not."""
    if scene.rating is None:
        raise SolveError("there is no table [rating]: write one; gearopt new rating shows how")
    if missing := [dotted(place) for place in not_given(scene.gears, scene.stage)]:
        raise SolveError(
            f"the gears are not all given, which a rating needs: write {', '.join(missing)}; or "
            "gearopt solve FILE, which sizes them and rates what it finds"
        )
    clock = Clock(ask.budget, ask.watch)
    pairs = rated_gears.given_pairs(scene)
    found = rating(scene, pairs)
    limits = utilisations(found)
    speed = scene.duty.input_speed.value
    asked = scene.duty.total_ratio if scene.duty.asks_ratio else None
    density = scene.objective.density
    made = of_pairs(
        scene.limits.LAW,
        pairs,
        torque(scene.duty.power.value, speed),
        speed,
        asked,
        density.value if density else None,
    )
    return Result(
        name="rating",
        status="evaluated",
        method=scene.rating.standard,
        objective={},
        certificate={"feasibility": max(0.0, max(limits.values()) - 1.0)},
        design=untyped(replace(made, rating=found)),
        limits=limits,
        report={"assumptions": rating_assumptions(scene)},
        evaluations=1,
        seconds=clock.seconds,
        seed=ask.seed,
        versions=versions("numpy"),
    )


def with_rating(scene: Scene, result: Result) -> Result:
    """Return the answer with the rating of its gears, or with the reason why there is none."""
    if scene.rating is None or result.value is None:
        return result
    held = scene.held(len(result.design["stages"]))
    try:
        found = rating(held, chosen_pairs(held, drive_design(result.design).stages))
    except SolveError as reason:
        notes = [*result.report.get("notes", []), f"There is no rating: {reason}."]
        return replace(result, report=result.report | {"notes": notes})
    found = replace(found, flaws=())  # they stand in the notes of the drive
    return replace(result, design=result.design | {"rating": untyped(found)})


def chosen_pairs(scene: Scene, stages: Sequence[StageDesign]) -> tuple[GearPair, ...]:
    """Return the pairs of a design, with the tools of the file."""
    return tuple(
        rated_gears.pair_of(
            scene, k, s.normal_module_mm, (s.pinion_teeth, s.wheel_teeth), s.face_width_mm
        )
        for k, s in enumerate(stages)
    )


def utilisations(found: DriveRating) -> dict[str, float]:
    """Return what of its safety factors every gear uses: asked for over there, of stress."""
    limits = {}
    for gear in found.gears:
        bending = found.minimum_bending_safety / gear.bending_safety
        contact = found.minimum_contact_safety / gear.contact_safety
        limits[f"{gear.member}_bending[{gear.stage}]"] = bending
        limits[f"{gear.member}_contact[{gear.stage}]"] = contact
    return limits


def rating(scene: Scene, pairs: Sequence[GearPair]) -> DriveRating:
    """Return the rating of all stages; SolveError names the stage that has none, and why."""
    asked = scene.rating
    assert asked
    meshes, slower = [], 1.0
    for k, pair in enumerate(pairs):
        found = flaws(pair)
        told = [flaw.sentence[0].lower() + flaw.sentence[1:].rstrip(".") for flaw in found]
        if found and found[0].fatal:
            raise SolveError(f"stage {k + 1} cannot be rated: {told[0]}")
        try:
            meshes.append(_mesh(scene, k, pair, slower))
        except ValueError as reason:
            why = "; ".join([str(reason), *told])
            raise SolveError(f"stage {k + 1} cannot be rated: {why}") from None
        slower *= float(pair.ratio)
    wanted = float(asked.minimum_bending_safety), float(asked.minimum_contact_safety)
    rows = [_mesh_row(scene, mesh, wanted) for mesh in meshes]
    gears = tuple(_gear_row(mesh, k) for mesh in meshes for k in (0, 1))
    least = min(range(len(rows)), key=lambda k: rows[k].power_capacity_kW)
    lives = [gear.life_h for gear in gears]
    losses = [row.mesh_efficiency_percent for row in rows]
    errors = [e for row in rows if (e := row.mesh_efficiency_error_percent) is not None]
    factors = tuple(row for mesh in meshes for row in _factor_rows(mesh))
    moved, speed = _largest_load(scene)
    turned = hands([table.pinion_hand for table in scene.stage] or [None] * len(pairs))
    forces = train_forces(pairs, moved, turned)
    return DriveRating(
        standard=STANDARD.format(asked.edition),
        safe=all(
            wanted[0] <= (1.0 + FEASIBLE) * g.bending_safety
            and wanted[1] <= (1.0 + FEASIBLE) * g.contact_safety
            for g in gears
        ),
        governs=f"{rows[least].governs}, stage {least + 1}",
        minimum_bending_safety=wanted[0],
        minimum_contact_safety=wanted[1],
        power_capacity_kW=rows[least].power_capacity_kW,
        required_life_h=rated_gears.required_hours(scene),
        life_h=min((life for life in lives if life is not None), default=None),
        efficiency_percent=_product(losses),
        efficiency_error_percent=sum(errors) if errors else None,
        gears=gears,
        meshes=tuple(rows),
        factors=factors,
        shafts=_shafts(pairs, forces, moved, speed),
        teeth=tuple(
            tooth_geometry(mesh.stage, mesh.pair, k, turned[mesh.stage - 1])
            for mesh in meshes
            for k in (0, 1)
        ),
        levels=tuple(row for mesh in meshes if scene.load for row in _level_rows(scene, mesh)),
        unverified=tuple(
            dict.fromkeys(f"{r.symbol} of stage {r.stage}" for r in factors if not r.verified)
        ),
        flaws=tuple(tooth_warnings(pairs)),
    )


def _largest_load(scene: Scene) -> tuple[float, float]:
    """Return torque [N mm] and speed [rad/s] of the input at the level of the largest torque."""
    usual = scene.duty.input_speed
    levels = [(level.power.value, (level.input_speed or usual).value) for level in scene.load]
    levels = levels or [(scene.duty.power.value, usual.value)]
    return max((torque(power, speed), speed) for power, speed in levels)


def _mesh(scene: Scene, k: int, pair: GearPair, slower: float) -> Mesh:
    """Rate one stage (from 0); slower: input over pinion speed."""
    gears = rated_gears.own(scene, k, "pinion"), rated_gears.own(scene, k, "wheel")
    steels = rated_gears.steel(gears[0]), rated_gears.steel(gears[1])
    made = rated_gears.practice(scene, pair, gears)
    levels = rated_gears.operations(scene, slower, gears)
    given = rated_gears.given_factors(scene, k)
    if not scene.load:
        one = rate_pair(pair, levels[0], steels, made, given)
        both = one.bending_safety, one.contact_safety
        return Mesh(k + 1, pair, gears, levels, (one,), *both, None)
    found = rate_spectrum(pair, levels, steels, made, given)
    damages = found.bending_damage, found.contact_damage
    both = found.bending_safety, found.contact_safety
    return Mesh(k + 1, pair, gears, levels, found.levels, *both, damages)


def _gear_row(mesh: Mesh, k: int) -> GearRating:
    one, operation = mesh.hardest, mesh.operations[mesh.levels.index(mesh.hardest)]
    stresses = one.bending_stress[k], one.contact_stress[k]
    safeties = one.bending_safety[k], one.contact_safety[k]
    cycles = sum(level.cycles[k] for level in mesh.levels)
    lives, life = _lives(mesh, k, cycles, operation)
    return GearRating(
        stage=mesh.stage,
        member=MEMBERS[k],
        material=material(mesh.tables[k]),
        bending_stress_MPa=stresses[0],
        permissible_bending_stress_MPa=stresses[0] * safeties[0],
        bending_safety=mesh.bending_safety[k],
        contact_stress_MPa=stresses[1],
        permissible_contact_stress_MPa=stresses[1] * safeties[1],
        contact_safety=mesh.contact_safety[k],
        cycles=cycles,
        bending_life_cycles=lives[0],
        contact_life_cycles=lives[1],
        life_h=life,
        bending_damage=None if mesh.damages is None else mesh.damages[0][k],
        contact_damage=None if mesh.damages is None else mesh.damages[1][k],
    )


def _lives(
    mesh: Mesh, k: int, cycles: float, operation: Operation
) -> tuple[list[float | None], float | None]:
    """Return the lives in cycles, of bending and contact, and the shorter one in hours.

    None: beyond the end of the curves. Of a spectrum by Miner: cycles over the sum.
    """
    one = mesh.levels[0]
    if mesh.damages is None:
        lives = [one.bending_life[k], one.contact_life[k]]
    else:
        sums = (mesh.damages[0][k], mesh.damages[1][k])
        lives = [cycles / s if s > 0.0 else math.inf for s in sums]
    hours = sum(level.hours for level in mesh.operations)
    within = [life if life <= LONGEST else None for life in lives]
    known = [life for life in within if life is not None]
    return within, min(known) / cycles * hours if known else None


def _mesh_row(scene: Scene, mesh: Mesh, wanted: tuple[float, float]) -> MeshRating:
    pair, one, asked = mesh.pair, mesh.hardest, scene.rating
    assert asked
    margins = [
        margin
        for k in (0, 1)
        for margin in (
            (mesh.bending_safety[k] / wanted[0], f"bending of the {MEMBERS[k]}"),
            ((mesh.contact_safety[k] / wanted[1]) ** 2, f"contact of the {MEMBERS[k]}"),
        )
    ]
    least, governs = min(margins)
    power, pinion = scene.duty.power.value, pair.working_diameters[0]
    operation = mesh.operations[mesh.levels.index(one)]
    forces = mesh_forces(pair, torque(operation.power, operation.pinion_speed))
    loss, friction = float(tooth_loss_factor(pair)), _friction(scene, mesh)
    strongest = max(level.power for level in mesh.operations)
    return MeshRating(
        stage=mesh.stage,
        governs=governs,
        power_capacity_kW=1e-6 * least * (strongest if scene.load else power),
        tangential_force_N=float(forces.tangential),
        radial_force_N=float(forces.radial),
        axial_force_N=float(forces.axial),
        pitch_line_velocity_m_per_s=1e-3 * one.speed,
        working_pressure_angle_deg=math.degrees(pair.working_angle),
        working_helix_angle_deg=math.degrees(helix_angle_at(pair.pinion, pinion)),
        transverse_contact_ratio=float(pair.transverse_contact_ratio),
        overlap_ratio=float(pair.overlap_ratio),
        total_contact_ratio=float(total_contact_ratio(pair)),
        circumferential_backlash_mm=float(circumferential_backlash(pair)),
        normal_backlash_mm=float(normal_backlash(pair)),
        tooth_loss_factor=loss,
        friction_coefficient=friction,
        mesh_efficiency_percent=(
            None if friction is None else 100.0 * float(mesh_efficiency(loss, friction))
        ),
        mesh_efficiency_error_percent=(
            None
            if friction is None or asked.oil_viscosity is None
            else 100.0 * FRICTION_ERROR * friction * loss
        ),
    )


def _friction(scene: Scene, mesh: Mesh) -> float | None:
    """Return the coefficient of friction, given or of the oil; None where neither is known."""
    asked, one = scene.rating, mesh.hardest
    assert asked
    if asked.friction_coefficient is not None:
        return float(asked.friction_coefficient)
    if asked.oil_viscosity is None:
        return None
    roughness = 0.5 * sum(rated_gears.steel(table).finish for table in mesh.tables)
    return float(
        friction_coefficient(mesh.pair, one.load, one.speed, asked.oil_viscosity.value, roughness)
    )


def _product(percents: Sequence[float | None]) -> float | None:
    known = [p for p in percents if p is not None]
    return 100.0 * math.prod(p / 100.0 for p in known) if len(known) == len(percents) else None


def _factor_rows(mesh: Mesh) -> list[RatingFactor]:
    rows = []
    for symbol, factor in mesh.hardest.factors.items():
        value = factor.value
        first, second = value if isinstance(value, tuple) else (value, None)
        rows.append(
            RatingFactor(
                stage=mesh.stage,
                symbol=symbol,
                name=NAMES[symbol],
                pinion=first,
                wheel=second,
                unit=UNITS.get(symbol, ""),
                source=factor.clause,
                verified=factor.verified,
                remark=factor.remark,
            )
        )
    return rows


def _shafts(
    pairs: Sequence[GearPair], forces: Sequence[Any], input_torque: float, speed: float
) -> tuple[ShaftRating, ...]:
    rows, ratio = [], 1.0
    for shaft in range(1, len(pairs) + 2):
        rows.append(
            ShaftRating(
                shaft=shaft,
                torque_Nm=1e-3 * input_torque * ratio,
                speed_rpm=rpm(speed / ratio),
                rotation=rotation(shaft),
                axial_force_N=sum(f.axial for f in forces if f.shaft == shaft),
            )
        )
        ratio *= float(pairs[shaft - 1].ratio) if shaft <= len(pairs) else 1.0
    return tuple(rows)


def _level_rows(scene: Scene, mesh: Mesh) -> list[LoadLevel]:
    rows = []
    for n, (level, one) in enumerate(zip(scene.load, mesh.levels, strict=True), 1):
        for k in (0, 1):
            rows.append(
                LoadLevel(
                    stage=mesh.stage,
                    member=MEMBERS[k],
                    level=n,
                    power_kW=1e-6 * level.power.value,
                    input_speed_rpm=rpm((level.input_speed or scene.duty.input_speed).value),
                    share_percent=100.0 * float(level.share),
                    cycles=one.cycles[k],
                    bending_stress_MPa=one.bending_stress[k],
                    contact_stress_MPa=one.contact_stress[k],
                    bending_damage=_damage(one.cycles[k], one.bending_life[k]),
                    contact_damage=_damage(one.cycles[k], one.contact_life[k]),
                )
            )
    return rows


def _damage(cycles: float, life: float) -> float | None:
    """Return a level's part of Miner's sum; None where it breaks or pits at once."""
    return cycles / life if life > 0.0 else None
