"""The rows of a rating's tables: gears, meshes, factors, shafts, levels of load."""

import math
from collections.abc import Sequence
from typing import Any

from gearopt.formulations.drive.rating import (
    GIVEN,
    GearRating,
    LoadLevel,
    MeshRating,
    RatingFactor,
    ShaftRating,
    StaticRating,
)
from gearopt.physics.agma.life import LONGEST_LIFE
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.contact import contact_path, usable_path
from gearopt.physics.geometry.tooth import (
    circumferential_backlash,
    helix_angle_at,
    normal_backlash,
)
from gearopt.physics.loads import torque_ratios
from gearopt.physics.mesh_loss import (
    FRICTION_ERROR,
    friction_coefficient,
    mesh_efficiency,
    tooth_loss_factor,
)
from gearopt.physics.shaft_forces import mesh_forces, rotation, rpm, train_forces
from gearopt.scenes.drive.rating.mesh import Mesh
from gearopt.scenes.drive.tables.rating import LoadTable, RatingTable
from gearopt.units import Quantity

SHORTER = 1e-6  # relative, by which a path is shorter than another
LOAD_MARGIN = 1e-10  # margin of load at which a capacity is found
MOST_STEPS, FLATTEST, LARGEST = (
    100,
    0.05,
    30.0,
)  # of the search: steps, slope, logarithm of a factor


def gear_row(mesh: Mesh, k: int, own: tuple[float | None, float | None]) -> GearRating:
    """Return the pinion (0) or the wheel (1) of a mesh.

    own: safety factors asked of its stage, None: those of the drive.
    """
    hardest = mesh.hardest
    stresses = hardest.bending_stress[k], hardest.contact_stress[k]
    safeties = hardest.bending_safety[k], hardest.contact_safety[k]
    cycles = sum(level.cycles[k] for level in mesh.levels)
    lives = _lives(mesh, k)
    return GearRating(
        stage=mesh.stage,
        member=MEMBERS[k],
        material=mesh.standard.material(mesh.tables[k]),
        bending_stress_MPa=stresses[0],
        permissible_bending_stress_MPa=stresses[0] * safeties[0],
        bending_safety=mesh.bending_safety[k],
        contact_stress_MPa=stresses[1],
        permissible_contact_stress_MPa=stresses[1] * safeties[1],
        contact_safety=mesh.contact_safety[k],
        cycles=cycles,
        bending_life_cycles=_within(lives[0]),
        contact_life_cycles=_within(lives[1]),
        life_h=None if _within(min(lives)) is None else _hours(mesh, min(lives), cycles),
        bending_damage=None if mesh.damages is None else mesh.damages[0][k],
        contact_damage=None if mesh.damages is None else mesh.damages[1][k],
        required_bending_safety=own[0],
        required_contact_safety=own[1],
    )


def _lives(mesh: Mesh, k: int) -> tuple[float, float]:
    """Return the lives in cycles, of bending and contact; of a spectrum cycles over Miner's sum."""
    if mesh.damages is None:
        return mesh.levels[0].bending_life[k], mesh.levels[0].contact_life[k]
    cycles = sum(level.cycles[k] for level in mesh.levels)
    bent, pressed = (
        cycles / s if s > 0.0 else math.inf for s in (sums[k] for sums in mesh.damages)
    )
    return bent, pressed


def _within(life: float) -> float | None:
    """Return a life in cycles; None beyond the end of the curves."""
    return life if life <= LONGEST_LIFE else None


def _hours(mesh: Mesh, life: float, cycles: float) -> float:
    """A life of a gear in hours; life: in cycles, and cycles of the hours asked for."""
    return float(life / cycles * sum(level.hours for level in mesh.operations))


def mesh_row(rating: RatingTable, mesh: Mesh, wanted: Sequence[float]) -> MeshRating:
    """Row of a mesh; wanted: S_F and S_H asked for, then those of static strength."""
    pair, (moved, speed) = mesh.pair, mesh.largest_load
    growth, governs = _capacity(mesh, wanted), _margins(mesh, wanted)[1]
    forces = mesh_forces(pair, moved)
    strongest = max(level.power for level in mesh.operations)
    return MeshRating(
        stage=mesh.stage,
        governs=governs,
        power_capacity_kW=1e-6 * growth * strongest / (mesh.own.share if mesh.own else 1.0),
        tangential_force_N=float(forces.tangential),
        radial_force_N=float(forces.radial),
        axial_force_N=float(forces.axial),
        pitch_line_velocity_m_per_s=1e-3 * speed,
        working_pressure_angle_deg=math.degrees(pair.working_angle),
        working_helix_angle_deg=math.degrees(
            helix_angle_at(pair.pinion, pair.working_diameters[0])
        ),
        transverse_contact_ratio=float(pair.transverse_contact_ratio),
        overlap_ratio=float(pair.overlap_ratio),
        total_contact_ratio=float(pair.transverse_contact_ratio + pair.overlap_ratio),
        usable_contact_ratio=_usable(pair),
        circumferential_backlash_mm=float(circumferential_backlash(pair)),
        normal_backlash_mm=float(normal_backlash(pair)),
        accuracy_grades=_grades(rating, mesh),
        **_losses(rating, mesh),
    )


def _grades(rating: RatingTable, mesh: Mesh) -> tuple[int, int] | None:
    """Return the accuracy grades by ISO 1328-1 that the file gives for both gears."""
    shared = rating.iso6336.accuracy_grade or (None, None)
    rows = zip(mesh.tables, shared, strict=True)
    first, second = (g if t.accuracy_grade is None else t.accuracy_grade for t, g in rows)
    return None if first is None or second is None else (first, second)


def _usable(pair: GearPair) -> float | None:
    """Return the transverse contact ratio between form circles, where they shorten the path."""
    bare, left = contact_path(pair), usable_path(pair)
    short = float(left.length) < float(bare.length) * (1.0 - SHORTER)
    return float(left.transverse_ratio) if short else None


def _losses(rating: RatingTable, mesh: Mesh) -> dict[str, Any]:
    """Losses by the sliding of teeth, where the friction is known."""
    loss, (friction, sure) = float(tooth_loss_factor(mesh.pair)), _friction(rating, mesh)
    fields: dict[str, Any] = {"tooth_loss_factor": loss, "friction_coefficient": friction}
    if friction is not None and friction * loss < 1.0:  # else the formula is far from its tests
        fields["mesh_efficiency_percent"] = 100.0 * float(mesh_efficiency(loss, friction))
        if not sure:
            fields["mesh_efficiency_error_percent"] = 100.0 * FRICTION_ERROR * friction * loss
    return fields


def _margins(mesh: Mesh, wanted: Sequence[float]) -> tuple[float, str]:
    """Return the least margin of load against the safety factors asked for, and whose it is."""
    rows = []
    for k, member in enumerate(MEMBERS):
        rows.append((mesh.bending_safety[k] / wanted[0], f"bending of the {member}"))
        rows.append(((mesh.contact_safety[k] / wanted[1]) ** 2, f"contact of the {member}"))
        if (held := mesh.static) is not None:
            bent, pressed = held.bending_safety[k] / wanted[2], held.contact_safety[k] / wanted[3]
            rows.append((bent, f"static bending of the {member}"))
            rows.append((pressed**2, f"static contact of the {member}"))
    return min(rows)


def _capacity(mesh: Mesh, wanted: Sequence[float]) -> float:
    """Return the factor by which all loads may grow until the least margin is 1.

    The margin itself where factors of load do not depend on it, as by AGMA; else by secants of its
    logarithm over that of the load. 0 where no load is small enough.
    """
    low, of_low = 0.0, math.log(_margins(mesh, wanted)[0])
    if mesh.standard.PROPORTIONAL:
        return math.exp(of_low)
    at = of_low
    for _ in range(MOST_STEPS):
        margin = math.log(_margins(mesh.grown(math.exp(at)), wanted)[0])
        if abs(margin) < LOAD_MARGIN:
            return math.exp(at)
        slope = (margin - of_low) / (at - low) if at != low else -1.0
        low, of_low = at, margin
        at -= margin / min(slope, -FLATTEST)
        if at < -LARGEST:
            break
    return 0.0


def _friction(rating: RatingTable, mesh: Mesh) -> tuple[float | None, bool]:
    """Coefficient of friction, None where nothing is known; whether it is given."""
    moved, speed = mesh.largest_load
    if rating.friction_coefficient is not None:
        return float(rating.friction_coefficient), True
    if rating.oil_viscosity is None:
        return None, False
    roughness = 0.5 * sum(mesh.standard.finish(table) for table in mesh.tables)
    load = 2.0 * moved / float(mesh.pair.working_diameters[0])
    known = load, speed, rating.oil_viscosity.value, roughness
    return float(friction_coefficient(mesh.pair, *known)), False


def factor_rows(rating: RatingTable, mesh: Mesh) -> list[RatingFactor]:
    """Return the factors of a mesh at its hardest level."""
    rows, computed = [], mesh.standard.names(rating)
    for symbol, factor in mesh.hardest.factors.items():
        value = factor.value
        first, second = value if isinstance(value, tuple) else (value, None)
        rows.append(
            RatingFactor(
                stage=mesh.stage,
                symbol=symbol,
                name=(mesh.standard.NAMES if factor.clause == GIVEN else computed)[symbol],
                pinion=first,
                wheel=second,
                unit=mesh.standard.UNITS.get(symbol, ""),
                source=factor.clause,
                verified=factor.verified,
                remark=factor.remark,
            )
        )
    return rows


def shaft_rows(
    pairs: Sequence[GearPair],
    pinion_hands: Sequence[str],
    drivers: Sequence[str],
    moved: float,
    speed: float,
) -> tuple[ShaftRating, ...]:
    """Loads of every shaft; moved: torque [N mm] of the input, speed [rad/s]."""
    forces = train_forces(pairs, moved, pinion_hands, drivers)
    ratios = torque_ratios([float(pair.ratio) for pair in pairs], drivers)
    return _shafts(ratios, [True] * len(ratios), (moved, speed), forces)


def shafts_of_stages(meshes: Sequence[Any], moved: float, speed: float) -> tuple[ShaftRating, ...]:
    """`shaft_rows` of drives with planets or rings, without axial forces.

    meshes: `AsMesh` of every mesh.
    """
    last = [m for m, after in zip(meshes, [*meshes[1:], None], strict=True) if m.ends(after)]
    ratios = torque_ratios([m.ratio for m in last], [m.driver for m in last])
    return _shafts(ratios, [m.reverses for m in last], (moved, speed), ())


def _shafts(
    ratios: Sequence[tuple[float, float]],
    reverses: Sequence[bool],
    loads: tuple[float, float],
    forces: Sequence[Any],
) -> tuple[ShaftRating, ...]:
    """Shafts at torque [N mm] and speed [rad/s] of the input, by `torque_ratios`."""
    moved, speed = loads
    turns = [1 + sum(reverses[:k]) for k in range(len(reverses) + 1)]
    return tuple(
        ShaftRating(
            shaft=shaft,
            torque_Nm=1e-3 * moved * ratio,
            speed_rpm=rpm(speed / ratio),
            rotation=rotation(turns[shaft - 1]),
            axial_force_N=sum(f.axial for f in forces if f.shaft == shaft),
        )
        for shaft, ratio in enumerate((1.0, *(behind for _, behind in ratios)), 1)
    )


def static_rows(mesh: Mesh, asked: tuple[float, float]) -> list[StaticRating]:
    """Return pinion and wheel of a mesh under the peak torque, if any; asked: static S_F, S_H."""
    if (held := mesh.static) is None:
        return []
    return [
        StaticRating(
            stage=mesh.stage,
            member=member,
            torque_Nm=5e-4 * held.load * float(mesh.pair.pinion.reference_diameter),
            static_bending_stress_MPa=held.bending_stress[k],
            static_bending_limit_MPa=held.bending_stress[k] * held.bending_safety[k],
            static_bending_safety=held.bending_safety[k],
            static_contact_stress_MPa=held.contact_stress[k],
            static_contact_limit_MPa=held.contact_stress[k] * held.contact_safety[k],
            static_contact_safety=held.contact_safety[k],
            required_static_bending_safety=asked[0],
            required_static_contact_safety=asked[1],
        )
        for k, member in enumerate(MEMBERS)
    ]


def level_rows(levels: Sequence[LoadTable], usual: Quantity, mesh: Mesh) -> list[LoadLevel]:
    """Levels of a load spectrum, for each gear of a mesh; usual: the input speed of the duty."""
    rows = []
    for n, (level, rated) in enumerate(zip(levels, mesh.levels, strict=True), 1):
        for k in (0, 1):
            rows.append(
                LoadLevel(
                    stage=mesh.stage,
                    member=MEMBERS[k],
                    level=n,
                    power_kW=1e-6 * level.power.value,
                    input_speed_rpm=rpm((level.input_speed or usual).value),
                    share_percent=100.0 * float(level.share),
                    cycles=rated.cycles[k],
                    bending_stress_MPa=rated.bending_stress[k],
                    contact_stress_MPa=rated.contact_stress[k],
                    bending_damage=_damage(rated.cycles[k], rated.bending_life[k]),
                    contact_damage=_damage(rated.cycles[k], rated.contact_life[k]),
                )
            )
    return rows


def _damage(cycles: float, life: float) -> float | None:
    """Return a level's part of Miner's sum; None where it breaks or pits at once."""
    return cycles / life if life > 0.0 else None
