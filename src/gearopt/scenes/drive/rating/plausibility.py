"""What is unusual about rated gears, told beside their rating: proportions, steel against size."""

import math
from collections.abc import Iterator, Sequence

from gearopt.formulations.drive.rating import DriveRating, MeshName
from gearopt.formulations.drive.train import STEEL_DENSITY
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.iso6336.load_factors import Shaft
from gearopt.physics.loads import torque_ratios
from gearopt.scenes.drive.rating.gears import Tables
from gearopt.scenes.drive.rating.steels import chosen
from gearopt.scenes.drive.tables.rating import GearTable

WIDEST, NARROWEST = 2.0, 3.0  # b/d1 and b/m_n, beyond which gears are unusual (books; unverified)
FLAT = math.radians(10.0)  # normal pressure angle below which no law of the rating was tried
LEAST_SHIFT, LARGEST_SHIFT = -0.7, 1.2  # x of usual gears (books; unverified)
OVERSIZED = 2.0  # times the power asked for, from which on no strength decides the size
FARTHEST, FARTHEST_OVERHUNG = 0.3, 0.5  # s/l up to which figure 13 of ISO 6336-1 holds
HEAVY = 200.0  # kg, of gears from which on it is told what decides their size
PLATE = 1.5  # diameter of a bar that hardens as a plate of a thickness does (EN 10083; memory)


def unusual(
    pairs: Sequence[GearPair],
    tables: Sequence[Tables],
    drivers: Sequence[str],
    shafts: Sequence[Shaft | None],
    named: Sequence[MeshName],
) -> Iterator[str]:
    """Yield sentences on what is unusual about pairs of floats; tables: of their gears.

    named: of drives with planets or rings, of every mesh; else none.
    """
    if not named:
        yield from _modules(pairs, drivers)
    each = named or [MeshName(stage=k + 1, title="") for k in range(len(pairs))]
    alike = dict[str, list[str]]()
    for pair, both, shaft, name in zip(pairs, tables, shafts, each, strict=True):
        yield from _proportions(pair, name.words)
        yield from _shifts(pair, name)
        yield from _on_shaft(pair, shaft, name.words)
        cores = (text for table in both for text in _soft_core(table, pair, name.words))
        yield from dict.fromkeys(cores)
        for member, gear, table in zip(name.gears, pair.gears, both, strict=True):
            for text in _of_steel(table, gear):
                alike.setdefault(text, []).append(f"the {member} of stage {name.stage}")
    for text, gears in alike.items():
        *some, last = dict.fromkeys(gears)  # a planet is in two meshes
        rest = ", ".join(some)
        yield text.format(f"{rest} and {last} are" if rest else f"{last} is")


def weighty(pairs: Sequence[GearPair], rated: DriveRating) -> Iterator[str]:
    """Yield what decides the mass of heavy gears, were they solid steel.

    Of the stage of most of it, by the standard of least capacity: what governs; nothing does where
    all stages carry far more than is asked for.
    """
    each = [sum(1e3 * float(g.mass(STEEL_DENSITY)) for g in pair.gears) for pair in pairs]
    if sum(each) < HEAVY:
        return
    stage = max(range(len(each)), key=lambda k: each[k]) + 1
    rows = [mesh for one in rated.each for mesh in one.meshes if mesh.stage == stage]
    mesh = min(rows, key=lambda mesh: mesh.power_capacity_kW)
    mode, _, member = mesh.governs.partition(" of the ")
    power = "the square of " * (mode == "contact")
    first, capacity = rated.shafts[0], min(one.power_capacity_kW for one in rated.each)
    asked = first.torque_Nm * first.speed_rpm * math.pi / 3e4
    part = f", {each[stage - 1]:,.0f} kg of it in stage {stage}" if len(each) > 1 else ""
    weight = f"As solid steel the gears weigh {sum(each):,.0f} kg{part}"
    if capacity > OVERSIZED * asked:
        yield (
            f"{weight}, and carry {capacity:,.4g} kW where {asked:,.4g} kW is asked for: far "
            "smaller gears would do."
        )
        return
    yield (
        f"{weight}. The {mode} stress of {'its' if len(each) > 1 else 'the'} "
        f"{member} decides that: mass grows with the torque and falls with "
        f"{power}the permissible {mode} stress, so that harder or better steel makes it lighter."
    )


def _modules(pairs: Sequence[GearPair], drivers: Sequence[str]) -> Iterator[str]:
    """Yield where the stage of the larger torque has the smaller module."""
    torques = [at for at, _ in torque_ratios([float(pair.ratio) for pair in pairs], drivers)]
    modules = [float(pair.normal_module) for pair in pairs]
    for k in range(len(pairs) - 1):
        weak, strong = sorted((k, k + 1), key=torques.__getitem__)
        times = torques[strong] / torques[weak]
        if modules[strong] < modules[weak] * (1.0 - 1e-9) and times > 1.0:
            yield (
                f"The modules of stages {k + 1} and {k + 2}, {modules[k]:.4g} and "
                f"{modules[k + 1]:.4g} mm, are out of proportion: the torque of stage "
                f"{strong + 1} is {times:.3g} times as large."
            )


def _proportions(pair: GearPair, mesh: str) -> Iterator[str]:
    width, angle = float(pair.face_width), float(pair.pinion.rack.pressure_angle)
    if angle < FLAT:
        yield (
            f"The normal pressure angle of {mesh} is {math.degrees(angle):.3g}°: below "
            f"{math.degrees(FLAT):.0f}° teeth are undercut and slim, and the laws of the rating "
            "were not made for them."
        )
    over = width / float(pair.pinion.reference_diameter)
    if over > WIDEST:
        yield (
            f"The face width of {mesh} is {over:.3g} d1: above {WIDEST:g} little of it "
            "carries, as shafts bend and twist."
        )
    over = width / float(pair.normal_module)
    if over < NARROWEST:
        yield (
            f"The face width of {mesh} is {over:.3g} m_n: below {NARROWEST:g} it is too "
            "narrow for the laws of the rating, which are those of usual gears."
        )
    overlap = float(pair.overlap_ratio)
    if 0.0 < overlap < 1.0 and (text := f"{overlap:.3g}") != "1":
        yield (
            f"The overlap ratio of {mesh} is {text}: below 1 helical gears run "
            "little quieter than spur gears, and still load their bearings axially."
        )


def _on_shaft(pair: GearPair, shaft: Shaft | None, mesh: str) -> Iterator[str]:
    """Yield where a shaft does not fit its pinion, or K_Hbeta has no figure for it."""
    if shaft is None:
        return
    root, share = float(pair.pinion.root_diameter), shaft.offset / shaft.span
    if shaft.diameter >= root:
        yield (
            f"The shaft of {mesh}, {shaft.diameter:.4g} mm, is not thinner than the root "
            f"circle of its pinion, {root:.4g} mm."
        )
    if not shaft.overhung and shaft.offset + 0.5 * float(pair.pinion.width) > 0.5 * shaft.span:
        yield (
            f"The pinion of {mesh} reaches beyond a bearing: it is "
            f"{float(pair.pinion.width):.4g} mm wide, {shaft.offset:.4g} mm off the middle of a "
            f"span of {shaft.span:.4g} mm."
        )
    if share > (most := FARTHEST_OVERHUNG if shaft.overhung else FARTHEST):
        yield (
            f"The pinion of {mesh} is {share:.3g} of the span off its middle; figure 13 of "
            f"ISO 6336-1, by which K_Hbeta is rated, ends at {most:g}."
        )


def _shifts(pair: GearPair, name: MeshName) -> Iterator[str]:
    """Yield profile shifts beyond those of usual gears."""
    for member, gear in zip(name.gears, pair.gears, strict=True):
        shift = float(gear.profile_shift)
        if not LEAST_SHIFT <= shift <= LARGEST_SHIFT:
            yield (
                f"The profile shift of the {member} of stage {name.stage} is {shift:.3g}: those of "
                f"usual gears are from {LEAST_SHIFT:g} to {LARGEST_SHIFT:g}."
            )


def _of_steel(table: GearTable, gear: Gear) -> Iterator[str]:
    """Yield where the hardness of a gear is not that of its steel; {} is for gears with a verb."""
    steel = chosen(table)
    if steel is None:
        return
    core = table.hardness if steel.hardened and steel.core else None
    if core is not None and steel.core and not steel.core[0] <= core.value <= steel.core[1]:
        yield (
            f"The core of {table.steel}, {steel.heat}, has {steel.core[0]:g} to {steel.core[1]:g} "
            f"HB as a rule; {{}} rated with {core}."
        )
    asked = table.flank_hardness if steel.hardened else table.hardness
    low, high = steel.hardness
    value = 0.0 if asked is None else asked.value
    size = min(abs(float(gear.tip_diameter)), PLATE * float(gear.width))
    reached = steel.hardness_at(size)
    if asked is not None and not low <= value <= high:
        yield (
            f"{table.steel} is {steel.heat} to {low:g} to {high:g} {steel.unit} as a rule; "
            f"{{}} rated with {asked}."
        )
    elif reached is not None and reached < value:
        yield (
            f"In such a section, as a bar of {size:.3g} mm, {table.steel} reaches some "
            f"{reached:.0f} HB (DIN 743-2, unverified); {{}} rated with {asked}."
        )


def _soft_core(table: GearTable, pair: GearPair, mesh: str) -> Iterator[str]:
    """Yield where the module is above that to which the core of a steel reaches 25 HRC."""
    steel = chosen(table)
    module = float(pair.normal_module)
    if steel is None or steel.module is None or module <= steel.module or table.iso_quality == "ML":
        return
    yield (
        f"The core of {table.steel} reaches 25 HRC to a module of {steel.module:g} mm or so, and "
        f'{mesh} has {module:.4g} mm: rate it with iso_quality = "ML" unless the core is '
        "certified."
    )
