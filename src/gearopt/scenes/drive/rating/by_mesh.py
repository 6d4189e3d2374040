"""Stages with planets, or a pinion in a ring, mesh by mesh, as ratings take them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.design import (
    DriveDesign,
    StageDesign,
    of_pairs,
    of_planets,
    with_planets,
)
from gearopt.formulations.drive.planetary import Planets
from gearopt.formulations.drive.rating import GIVEN, MeshName, MeshRating, RatingFactor
from gearopt.formulations.drive.train import STEEL_DENSITY
from gearopt.formulations.strength.standard import Option
from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.flaws import Flaw
from gearopt.physics.loads import torque_ratios
from gearopt.physics.rating import Rating
from gearopt.scenes.drive.driving import drivers
from gearopt.scenes.drive.face_widths import fixed_width
from gearopt.scenes.drive.idlers import copied
from gearopt.scenes.drive.planetary import at_once, cuttings, meshes, options, ways
from gearopt.scenes.drive.rating.gears import given_pairs
from gearopt.scenes.drive.rating.mesh import Materials, Mesh, rated_meshes
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.planetary import INTERNAL, PLANETARY

BY_PLANETS = "by the number of planets, practice of wind turbines"  # source of K_gamma
CALLED = {  # meshes by whether the ring is in them: title, gears, ending of limits
    False: ("sun and planet", "sun", "planet at the sun", "_of_sun"),
    True: ("planet and ring", "planet at the ring", "ring", "_of_ring"),
}


@dataclass(frozen=True)
class AsMesh:
    """A mesh of a stage that is rated in the place of a stage.

    slower: input over pinion speed, against the carrier; share of the drive's power in the mesh;
    rolled: in all meshes of this kind; meshes: as of `Practice`. ratio and driver of the stage, and
    whether its output turns the other way.
    """

    name: MeshName
    slower: float
    share: float
    rolled: float
    meshes: tuple[float, float] | None
    ratio: float
    driver: str
    reverses: bool

    def ends(self, after: "AsMesh | None") -> bool:
        """Whether it is the last mesh of its stage."""
        return after is None or after.name.stage != self.name.stage


Meshes = tuple[Scene, tuple[GearPair, ...], list[tuple[str, str]]]


def by_mesh(scene: Scene, design: DriveDesign) -> Meshes:
    """The drive with every mesh in the place of a stage, its pairs, and names of materials."""
    pairs, tables = list[GearPair](), list[StageTable]()
    names = list[tuple[str, str]]()
    plain = [s.type == "parallel" for s in design.stages]
    drivers = [s.driver for s in design.stages]
    slower = torque_ratios([s.ratio for s in design.stages], drivers)
    for k, (own, stage) in enumerate(zip(scene.stage_tables, design.stages, strict=True)):
        if plain[k]:
            pairs.append(scene.pair(own, stage))
            names.append((stage.pinion_material, stage.wheel_material))
            tables.append(own)
            title = MeshName(stage=k + 1, title=f"stage {k + 1}")
            rated = [AsMesh(title, slower[k][0], 1.0, 1.0, None, stage.ratio, stage.driver, True)]
        else:
            rows, both = _meshes_of(scene, own, stage, k, slower[k][0])
            pairs += both
            tables += meshes(own, stage.planets or 0)
            materials = stage.pinion_material, stage.wheel_material, stage.ring_material
            names += [materials[:2], materials[1:]] if stage.planets else [materials[:2]]
            rated = rows
        if not all(plain):
            for place, mesh in enumerate(rated, len(tables) - len(rated)):
                tables[place] = tables[place].rated_as(mesh)
    made = scene if all(plain) else scene.model_copy(update={"stage": tuple(tables)})
    return made, tuple(pairs), names


def mesh_names(scene: Scene) -> tuple[MeshName, ...]:
    """What the meshes of a scene of `by_mesh` are called; none of one of pairs alone."""
    known = (mesh.as_mesh for mesh in scene.stage_tables)
    return tuple(mesh.name for mesh in known if mesh is not None)


def _meshes_of(
    scene: Scene, own: StageTable, stage: StageDesign, k: int, slower: float
) -> tuple[list[AsMesh], tuple[GearPair, ...]]:
    """Meshes of a stage (from 0) of a design; slower: input over pinion speed of its pair."""
    planets = planets_of(scene, own, stage)
    pair = planets.pair(
        stage.normal_module_mm,
        stage.sun_teeth or stage.pinion_teeth,
        stage.ring_teeth,
        stage.face_width_mm,
    )
    rated = []
    kinds = [False, True] if planets.count else [True]
    for with_ring in kinds:
        torque, speed = planets.slower(pair, with_ring)
        called = CALLED[with_ring] if planets.count else ("pinion and ring", "pinion", "ring", "")
        title, first, second, suffix = called
        title = f"stage {k + 1}, {title}"
        name = MeshName(stage=k + 1, title=title, pinion=first, wheel=second, suffix=suffix)
        share = float(torque * speed)
        times = max(planets.count, 1)
        held = at_once(own, planets.count, with_ring)
        turns = planets.count > 0 and planets.held == "carrier"
        of_stage = stage.ratio, stage.driver, turns
        rated.append(AsMesh(name, slower / float(speed), share, times * share, held, *of_stage))
    return rated, planets.meshes(pair)


def meshes_by(
    scene: Scene, pairs: tuple[GearPair, ...], standard: Any, names: Materials
) -> list[Mesh]:
    """`rated_meshes`; AGMA rates a sun with more teeth than a planet as the wheel."""
    if not standard.FEWER_FIRST or not any(table.as_mesh for table in scene.stage_tables):
        return rated_meshes(scene, pairs, standard, names)
    turned, both, materials = with_fewer_first(scene, pairs, names)
    rated = rated_meshes(turned, both, standard, materials)
    rows = zip(rated, pairs, scene.stage_tables, strict=True)
    return [sun_first(mesh, pair, table.as_mesh) for mesh, pair, table in rows]


def with_fewer_first(scene: Scene, pairs: tuple[GearPair, ...], names: Materials) -> Meshes:
    """Meshes of a drive in which a sun with more teeth than a planet is the wheel, as by AGMA."""
    tables, both, materials = list(scene.stage_tables), list(pairs), list(names)
    for k, (stage, pair) in enumerate(zip(scene.stage_tables, pairs, strict=True)):
        mesh = stage.as_mesh
        if mesh is None or stage.type != PLANETARY or not 0.0 < pair.ratio < 1.0:
            continue
        turned = replace(mesh, slower=mesh.slower * float(pair.ratio))
        swapped = copied(stage, {"pinion": stage.wheel, "wheel": stage.pinion})
        tables[k], materials[k] = swapped.rated_as(turned), names[k][::-1]
        both[k] = replace(pair, pinion=pair.wheel, wheel=pair.pinion)
    return scene.model_copy(update={"stage": tuple(tables)}), tuple(both), materials


def sun_first(mesh: Mesh, pair: GearPair, as_mesh: AsMesh | None) -> Mesh:
    """A rated mesh with its gears in the order of a pair, which it was rated in or turned."""
    if mesh.pair.pinion.teeth == pair.pinion.teeth:
        return mesh
    u, damages = float(mesh.pair.ratio), mesh.damages
    operations = tuple(
        replace(level, pinion_speed=level.pinion_speed / u, contacts=level.contacts[::-1])
        for level in mesh.operations
    )
    return replace(
        mesh,
        pair=pair,
        tables=mesh.tables[::-1],
        operations=operations,
        levels=tuple(map(_swapped, mesh.levels)),
        bending_safety=mesh.bending_safety[::-1],
        contact_safety=mesh.contact_safety[::-1],
        damages=None if damages is None else (damages[0][::-1], damages[1][::-1]),
        grown=lambda factor: sun_first(mesh.grown(factor), pair, as_mesh),
        own=as_mesh,
    )


def _swapped(rating: Rating) -> Rating:
    """A rating with pinion and wheel swapped."""
    changed: dict[str, Any] = {k: v[::-1] for k, v in vars(rating).items() if isinstance(v, tuple)}
    member, mode = rating.governs
    changed["governs"] = MEMBERS[1 - MEMBERS.index(member)], mode
    changed["factors"] = {
        symbol: replace(f, value=f.value[::-1]) if isinstance(f.value, tuple) else f
        for symbol, f in rating.factors.items()
    }
    return replace(rating, **changed)


def planets_of(scene: Scene, own: StageTable, stage: StageDesign) -> Planets:
    """The planets, or the ring, of a stage of a design."""
    internal = own.type == INTERNAL
    shifts = stage.pinion_profile_shift, stage.wheel_profile_shift, stage.ring_profile_shift
    tips = stage.pinion_tip_alteration, stage.wheel_tip_alteration, stage.ring_tip_alteration
    if internal:
        shifts, tips = (shifts[0], *shifts[::2]), (tips[0], *tips[::2])
    cutting = cuttings(scene, own)[0]
    distance = None if cutting.distance is None else stage.centre_distance_mm
    cut = replace(cutting, shifts=shifts, shift_sum=None, tip_alterations=tips, distance=distance)
    if internal or not stage.planets:
        return Planets(cut, 0)
    assert stage.ring_teeth and stage.sun_teeth and stage.planet_teeth
    fewer = round(stage.ring_teeth - stage.sun_teeth - 2 * stage.planet_teeth)
    return Planets(cut, stage.planets, own.held, fewer)


def given_design(scene: Scene) -> DriveDesign:
    """The design of gears that are all given, some of which are planets or rings."""
    rows = list[tuple[GearPair, Option | None]]()
    for own in scene.stage_tables:
        assert own.size
        module, fixed = float(own.size[0].exact[0]), fixed_width(own)
        option = options(scene, own)[0] if own.epicyclic else None
        if option is None:
            rows.append((given_pairs((own,), scene.gears)[0], None))
            continue
        assert own.pinion_teeth and own.wheel_teeth
        teeth = float(own.pinion_teeth[0]), float(own.wheel_teeth[0])
        free = replace(option.planets, spaced=False, order="any")  # `assembly_flaws` says more
        option, pair = replace(option, planets=free), free.pair(module, *teeth, 1.0)
        span = own.face_width_over_diameter or scene.gears.face_width_over_diameter or (0, 0)
        width = float(span[0]) * float(pair.pinion.reference_diameter)
        rows.append((pair.of_width(fixed.value if fixed else width), option))
    pairs, law, density = tuple(pair for pair, _ in rows), scene.limits.LAW, scene.objective.density
    usual, speed = density.value if density else STEEL_DENSITY, scene.duty.input_speed.value
    asked = scene.duty.total_ratio if scene.duty.asks_ratio else None
    design = of_pairs(law, pairs, scene.torque, speed, asked, usual, scene.blanks, drivers(scene))
    each = zip(design.stages, rows, strict=True)
    stages = tuple(
        stage if option is None else of_planets(law, stage, pair, option, usual)
        for stage, (pair, option) in each
    )
    return with_planets(design, stages)


def shared(scene: Scene, row: RatingFactor) -> RatingFactor:
    """A factor of a mesh in the place of a stage; K_gamma that no file gives is marked."""
    own = scene.stage_tables[row.stage - 1]
    by_rule = own.type == PLANETARY and own.mesh_load_factor is None
    if row.symbol != "K_gamma":
        return row
    if row.source == GIVEN and "K_gamma" not in own.given_iso6336.factors():
        return replace(row, source="one mesh")
    if not by_rule:
        return row
    return replace(row, source=BY_PLANETS, verified=False)


def governing(named: Sequence[MeshName], least: MeshRating) -> str:
    """What governs the power capacity, and the stage; named: all meshes, or none."""
    if not named:
        return f"{least.governs}, stage {least.stage}"
    of_mesh = named[least.stage - 1]
    mode, _, member = least.governs.partition(" of the ")
    called = of_mesh.wheel if member == "wheel" else of_mesh.pinion
    return f"{mode} of the {called}, stage {of_mesh.stage}"


def assembly_flaws(scene: Scene, design: DriveDesign) -> Iterator[Flaw]:
    """Yield why planets of given gears cannot be put together, or are close to each other."""
    for k, (own, stage) in enumerate(zip(scene.stage_tables, design.stages, strict=True), 1):
        if stage.type != "planetary" or not (stage.planets and stage.sun_teeth):
            continue
        asked = next(ways(scene, own))
        total, count = stage.sun_teeth + (stage.ring_teeth or 0), stage.planets
        if asked.spaced and total % count:
            text = f"z_s + z_r = {total:g} of stage {k} is no multiple of its {count} planets: "
            yield Flaw("assembly", f"{text}they cannot be equally spaced.", misfit=1.0)
        module = stage.normal_module_mm
        size = stage.sun_teeth, stage.ring_teeth, stage.face_width_mm
        planets = replace(planets_of(scene, own, stage), spaced=asked.spaced)
        pair = planets.pair(module, *size)
        for rule, kept in asked.rules(pair.pinion_teeth, pair.wheel_teeth):
            if rule.endswith("(mesh_order)") and not kept:
                text = f"The teeth of stage {k} do not keep mesh_order: it asks for "
                yield Flaw("order", f"{text}{rule.removesuffix(' (mesh_order)')}.", misfit=1.0)
        gap = float(planets.gap(pair))
        if gap < asked.clearance * module:
            text = f"Neighbouring planets of stage {k} are {gap:.3f} mm apart at their tips, below "
            text += f"{asked.clearance:g} m_n."
            yield Flaw("planets close", text, misfit=max(0.0, -gap / module))
