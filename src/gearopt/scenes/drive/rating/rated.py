"""The rating of a drive: of gears that are all given, and of those that were chosen."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import CertificateError, SolveError
from gearopt.formulations.drive.design import DriveDesign, drive_design, of_pairs
from gearopt.formulations.drive.rating import DriveRating, MeshRating, ShaftRating
from gearopt.formulations.drive.train import STEEL_DENSITY
from gearopt.optimise.result import Result, versions
from gearopt.optimise.typed import typed, untyped
from gearopt.physics.agma.rating_factors import BEYOND
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.flaws import Flaw
from gearopt.physics.iso6336.load_factors import RANGES
from gearopt.physics.loads import torque
from gearopt.physics.shaft_forces import hands
from gearopt.scenes.drive.drawing import with_drawing
from gearopt.scenes.drive.driving import driven, drivers
from gearopt.scenes.drive.idlers import idlers
from gearopt.scenes.drive.notes import masses
from gearopt.scenes.drive.rating.assumptions import rating_assumptions, unused_materials
from gearopt.scenes.drive.rating.by_mesh import (
    BY_PLANETS,
    assembly_flaws,
    by_mesh,
    governing,
    mesh_names,
    meshes_by,
    shared,
)
from gearopt.scenes.drive.rating.by_mesh import given_design as given_planets
from gearopt.scenes.drive.rating.checks import not_given
from gearopt.scenes.drive.rating.gears import (
    Blanks,
    blanks,
    gear_tables,
    given_pairs,
    required_hours,
)
from gearopt.scenes.drive.rating.geometry import tooth_geometry
from gearopt.scenes.drive.rating.materials import choices
from gearopt.scenes.drive.rating.mesh import Materials, Mesh
from gearopt.scenes.drive.rating.options import (
    SECOND,
    STANDARDS,
    STATIC,
    by,
    of_stage,
    own_safety,
    required,
    required_static,
)
from gearopt.scenes.drive.rating.plausibility import unusual, weighty
from gearopt.scenes.drive.rating.rows import (
    factor_rows,
    gear_row,
    level_rows,
    mesh_row,
    shaft_rows,
    shafts_of_stages,
    static_rows,
)
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.blanks import body_flaws
from gearopt.scenes.parts import tooth_flaws
from gearopt.scenes.plan import Step, carried_out
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.toml_writing import dotted

FULL_CONTACT = 2.0  # K_Hbeta up to which the whole face width carries load


def rate(scene: Scene, ask: Ask) -> Result:
    """Rating of gears that are all given, status `evaluated`; SolveError why not."""
    _check_rated(scene)
    if missing := [dotted(place) for place in not_given(scene.gears, scene.stage)]:
        raise SolveError(
            f"the gears are not all given, which a rating needs: write {', '.join(missing)}; or "
            "gearopt solve FILE, which sizes them and rates what it finds"
        )
    drawn: tuple[Step[Scene], ...] = (Step(with_drawing),) if scene.drawing is not None else ()
    return carried_out((Step(with_given_rating), Step(with_given_gears), *drawn), scene, ask)


def _check_rated(scene: Scene) -> None:
    """Raise SolveError for a file without a rating."""
    if scene.rating is None:
        raise SolveError("there is no table [rating]: write one; gearopt new rating shows how")


def rate_design(scene: Scene, ask: Ask, design: Mapping[str, Any]) -> Result:
    """Rating of a design that was found for a file, as of gears that are given."""
    _check_rated(scene)
    try:
        found = replace(drive_design(design), rating=None)
    except ValueError as why:
        raise SolveError(f"the design is no drive: {why}") from None
    meshed, pairs, materials = by_mesh(driven(scene.held(len(found.stages)), found), found)
    rated = _rated(meshed, ask, pairs, materials)
    result = _with_gears(meshed, rated, pairs, found, _bodies(meshed, pairs, materials))
    return result if scene.drawing is None else with_drawing(scene, ask, result)


def _bodies(scene: Scene, pairs: tuple[GearPair, ...], materials: Materials) -> list[Blanks]:
    """Blanks of the gears of pairs; materials: as of `rated_meshes`."""
    rows = enumerate(zip(scene.stage_tables, materials, pairs, strict=True))
    return [
        blanks(gear_tables(own, scene.gears, scene.material, k, chosen), pair)
        for k, (own, chosen, pair) in rows
    ]


def _weighty(pairs: tuple[GearPair, ...], rated: DriveRating) -> list[str]:
    """Sentences on what decides the mass; of stages with planets or rings none are known."""
    return [] if rated.named else [*weighty(pairs, rated)]


def with_given_rating(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Rating of gears that are all given; SolveError where they have none."""
    if any(own.epicyclic for own in scene.stage):
        meshed, pairs, materials = by_mesh(scene, given_planets(scene))
        return _rated(meshed, ask, pairs, materials)
    return _rated(scene, ask, given_pairs(scene.stage, scene.gears))


def _rated(
    scene: Scene, ask: Ask, pairs: tuple[GearPair, ...], materials: Materials | None = None
) -> Result:
    """Rating of gears, status `evaluated`; materials: as of `rating`."""
    assert scene.rating is not None
    rated = rating(scene, pairs, materials)
    limits, remarks = utilisations(rated), [*unused_materials(scene), *_weighty(pairs, rated)]
    return Result(
        name="rating",
        status="evaluated",
        method=scene.rating.standard,
        objective={},
        certificate={"feasibility": max(0.0, *(used - 1.0 for used in limits.values()))},
        design={"rating": untyped(rated)},
        limits=limits,
        report={"assumptions": [*rating_assumptions(scene), masses(scene, noted=False)]}
        | ({"notes": remarks} if remarks else {}),
        evaluations=1,
        seed=ask.seed,
        versions=versions("numpy"),
    )


def with_given_gears(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The rating with its gears and their flaws: by some it is not safe, others may be accepted."""
    assert known is not None
    if any(own.epicyclic for own in scene.stage):
        design = given_planets(scene)
        meshed, pairs, materials = by_mesh(scene, design)
        made = meshed, known, pairs, design, _bodies(meshed, pairs, materials)
        return _with_gears(*made, tuple(assembly_flaws(scene, design)))
    pairs = given_pairs(scene.stage, scene.gears)
    return _with_gears(scene, known, pairs, *given_design(scene, pairs))


def _with_gears(
    scene: Scene,
    known: Result,
    pairs: tuple[GearPair, ...],
    design: DriveDesign,
    bodies: Sequence[Blanks],
    others: Sequence[Flaw] = (),
) -> Result:
    """The rating of a design with its gears and their flaws, and others of planets."""
    bored = [(s.pinion.bore is not None, s.wheel.bore is not None) for s in scene.stage_tables]
    named = mesh_names(scene)
    bodily = dict.fromkeys(body_flaws(bodies, pairs, bored, named))
    geometric = (*others, *tooth_flaws(pairs, named), *bodily)
    accepted = (flaw.sentence for flaw in geometric if not flaw.misfit)
    rated: DriveRating = typed(DriveRating, known.design["rating"])
    rated = fitted(rated, [flaw.sentence for flaw in geometric if flaw.misfit])
    rated = replace(rated, flaws=(*off_ratio(scene, design), *accepted, *rated.flaws))
    beyond = max([known.certificate["feasibility"] or 0.0, *(flaw.misfit for flaw in geometric)])
    return replace(
        known,
        certificate={"feasibility": beyond},
        design=untyped(replace(design, rating=rated)),
    )


def fitted(rated: DriveRating, misfits: Sequence[str]) -> DriveRating:
    """Rating that knows which gears do not fit, and is not safe then, by any standard."""
    if not misfits:
        return rated
    beside = replace(rated.beside, safe=False) if rated.beside else None
    return replace(rated, safe=False, misfits=tuple(misfits), beside=beside)


def given_design(
    scene: Scene, pairs: tuple[GearPair, ...]
) -> tuple[DriveDesign, list[tuple[Blank, Blank]]]:
    """Return the design of gears that are all given, and the blanks of every stage."""
    speed = scene.duty.input_speed.value
    asked = scene.duty.total_ratio if scene.duty.asks_ratio else None
    density = scene.objective.density
    bodies = [
        blanks(gear_tables(own, scene.gears, scene.material, k), pair)
        for k, (own, pair) in enumerate(zip(scene.stage_tables, pairs, strict=True))
    ]
    design = of_pairs(
        scene.limits.LAW,
        pairs,
        scene.torque,
        speed,
        asked,
        density.value if density else None,
        bodies,
        drivers(scene),
        idlers(scene.stage),
    )
    return _of_materials(scene, design), bodies


def _of_materials(scene: Scene, design: DriveDesign) -> DriveDesign:
    """A drive of given gears with the names and densities of their materials."""
    usual, stages = scene.objective.density, []
    for table, stage in zip(scene.stage_tables, design.stages, strict=True):
        values: dict[str, Any] = {}
        for member in MEMBERS:
            material = choices(getattr(table, member), scene.gears, scene.material)[0][1]
            dense = material.density.value if material and material.density else None
            mass = getattr(stage, f"{member}_mass_kg")
            before = usual.value if usual else STEEL_DENSITY
            values[f"{member}_mass_kg"] = mass * (dense / before if dense else 1.0)
            values[f"{member}_material"] = material.name if material else ""
        total = sum(values[f"{member}_mass_kg"] for member in MEMBERS)
        stages.append(replace(stage, mass_kg=total, **values))
    return replace(design, stages=tuple(stages), mass_kg=sum(stage.mass_kg for stage in stages))


def off_ratio(scene: Scene, design: DriveDesign) -> list[str]:
    """Return how far given gears are off the ratio that is asked for, beyond its tolerance."""
    off = design.ratio_error_percent
    if abs(off) <= 100.0 * float(scene.duty.ratio_tolerance):
        return []
    way = "above" if off > 0.0 else "below"
    return [
        f"The gears have a ratio of {design.ratio:.5g}, {abs(off):.3g} % {way} the one asked for."
    ]


def with_rating(scene: Scene, result: Result) -> Result:
    """Return the answer with the rating of its gears, or with the reason why there is none.

    Its report tells misfits apart from the notes, in which other flaws stand.
    """
    if result.value is None:
        return result
    design = drive_design(result.design)
    held = driven(scene.held(len(design.stages)), design)
    held, pairs, materials = by_mesh(held, design)
    notes = result.report.get("notes", [])
    if misfits := [flaw.sentence for flaw in tooth_flaws(pairs, mesh_names(held)) if flaw.misfit]:
        notes = [note for note in notes if note not in misfits]
        result = replace(result, report=result.report | {"misfits": misfits, "notes": notes})
    if scene.rating is None:
        return result
    try:
        rated = fitted(rating(held, pairs, materials), misfits)
    except SolveError as reason:
        report = result.report | {"notes": [*notes, f"There is no rating: {reason}."]}
        return replace(result, report=report)
    report = result.report | {"notes": [*notes, *_weighty(pairs, rated)]}
    return replace(result, design=result.design | {"rating": untyped(rated)}, report=report)


def check_safe(scene: Scene, result: Result) -> None:
    """Refuse gears that the rating was to limit and that it finds unsafe: an error of ours."""
    if not scene.by_ratings or result.value is None:
        return
    rating = drive_design(result.design).rating
    if rating is None or not rating.met_by_all:
        why = "has no rating" if rating is None else f"is unsafe: {rating.governs}"
        raise CertificateError(f"the design that ratings limit {why}")


def rated_afterwards(scene: Scene, result: Result) -> Result:
    """Result whose proof names its scope, where its rating did not limit the sizes."""
    if scene.rating is None or scene.by_ratings or scene.given or result.value is None:
        return result
    before = result.proof.get("scope")
    words = ", ".join(filter(None, (before, "sized by load limits alone, rated afterwards")))
    return replace(result, proof=result.proof | {"scope": words})


def utilisations(rated: DriveRating) -> dict[str, float]:
    """Utilisations of the safety factors of every gear: asked for over there, of stress.

    Of two standards those of the second, which is ISO 6336, have names of their own.
    """
    limits = {}
    for by_standard, of_second in zip(rated.each, ("", SECOND), strict=False):
        for gear, mode, reached, asked in by_standard.margins:
            static, end = mode.startswith("static "), mode.split(" ")[-1]
            of_mesh = by_standard.named[gear.stage - 1].suffix if by_standard.named else ""
            place = by_standard.stage_of(gear.stage)
            name = f"{gear.member}_{end}{of_mesh}{STATIC if static else of_second}[{place}]"
            limits[name] = asked / reached
    return limits


def rating(
    scene: Scene, pairs: tuple[GearPair, ...], materials: Materials | None = None
) -> DriveRating:
    """Return the rating of all stages by all standards asked for; SolveError why there is none.

    materials: as of `rated_meshes`; by default there was no choice. Flaws are those of load.
    """
    assert scene.rating
    names = materials or [("", "")] * len(pairs)
    first, *others = (
        _by(scene, pairs, standard, names) for standard in map(by, STANDARDS[scene.rating.standard])
    )
    if others:  # safe by both, as the verdict of the whole rating
        first = replace(first, beside=others[0], safe=first.safe and others[0].safe)
    tables = [
        gear_tables(own, scene.gears, scene.material, k, of_stage)
        for k, (own, of_stage) in enumerate(zip(scene.stage_tables, names, strict=True))
    ]
    placed = [of_stage(scene.rating, own).shaft for own in scene.stage_tables]
    shafts = [None if table is None else table.made for table in placed]
    odd = unusual(pairs, tables, drivers(scene), shafts, mesh_names(scene))
    flaws = (*_partial_contact(first), *_unsure_dynamics(first), *dict.fromkeys(odd))
    return replace(first, flaws=flaws)


def _partial_contact(rated: DriveRating) -> Iterator[str]:
    """Yield a sentence on the stages whose load lies on a part of the face width.

    Of a straight distribution K_Hbeta reaches 2 where the line load is 0 at one end;
    beyond, b_cal/b = 2/K_Hbeta is loaded. Source: ISO 6336-1:2006, 7.5, method C.
    """
    parts = [
        f"{100.0 * FULL_CONTACT / row.pinion:.3g} % of the face width of "
        f"{by_standard.mesh_words(row.stage)} "
        f"(K_Hbeta {row.pinion:.4g})"
        for by_standard in rated.each
        for row in by_standard.factors
        if row.symbol == "K_Hbeta" and row.pinion > FULL_CONTACT
    ]
    if parts:
        yield (
            f"Only {' and '.join(parts)} {'is' if len(parts) == 1 else 'are'} in contact; above "
            f"K_Hbeta = {FULL_CONTACT:g} the line load falls to zero at one end. A helix "
            "modification, stiffer shafts or a narrower face would spread the load better."
        )


def _unsure_dynamics(rated: DriveRating) -> Iterator[str]:
    """Yield a sentence on each mesh in main resonance, or faster than its standard's K_v goes."""
    rows = [(one, row) for one in rated.each for row in one.factors if row.symbol == "K_v"]
    for one, row in rows:
        mesh, factor = one.mesh_words(row.stage), f"K_v {row.pinion:.4g} by {one.by}"
        _, _, end = row.remark.partition(", ")
        if row.remark.startswith(RANGES[1]):
            yield (
                f"The mesh of {mesh} runs in its main resonance, {end.partition(':')[0]}: it "
                f"vibrates most there, and {factor} is an estimate that no published value "
                "confirms. Another speed or other numbers of teeth leave it."
            )
        elif row.remark.startswith(BEYOND):
            yield (
                f"The pitch line velocity of {mesh} is {BEYOND} of K_v, {end}: {factor} is "
                "extrapolated. Give K_v, or a better quality."
            )


def _by(
    scene: Scene, pairs: tuple[GearPair, ...], standard: Any, materials: Materials
) -> DriveRating:
    """Return the rating of all stages; SolveError names the stage that has none, and why."""
    asked = scene.rating
    assert asked
    meshes = meshes_by(scene, pairs, standard, materials)
    still = required_static(asked)
    wanted = [(*required(of_stage(asked, own)), *still) for own in scene.stage_tables]
    rows = tuple(mesh_row(asked, mesh, w) for mesh, w in zip(meshes, wanted, strict=True))
    least = min(rows, key=lambda row: row.power_capacity_kW)
    each = zip(meshes, scene.stage_tables, strict=True)
    gears = tuple(gear_row(mesh, k, own_safety(own)) for mesh, own in each for k in (0, 1))
    factors = tuple(shared(scene, row) for mesh in meshes for row in factor_rows(asked, mesh))
    by_hand = [table.pinion_hand for table in scene.stage] or [None] * len(pairs)
    turned = hands(by_hand, drivers(scene))
    efficiency, error = _efficiency(rows, meshes)
    named = mesh_names(scene)

    def title(mesh: int) -> str:
        return named[mesh - 1].title if named else f"stage {mesh}"

    rated = DriveRating(
        standard=standard.title(asked, factors),
        safe=False,
        governs=governing(named, least),
        minimum_bending_safety=float(asked.minimum_bending_safety),
        minimum_contact_safety=float(asked.minimum_contact_safety),
        power_capacity_kW=least.power_capacity_kW,
        required_life_h=required_hours(asked, scene.duty),
        life_h=None,
        efficiency_percent=efficiency,
        efficiency_error_percent=error,
        gears=gears,
        meshes=rows,
        factors=factors,
        shafts=_shafts(scene, pairs, turned),
        teeth=tuple(
            tooth_geometry(mesh.stage, mesh.pair, k, turned[mesh.stage - 1])
            for mesh in meshes
            for k in (0, 1)
        ),
        levels=tuple(
            row
            for mesh in meshes
            if scene.load
            for row in level_rows(scene.load, scene.duty.input_speed, mesh)
        ),
        unverified=(
            *dict.fromkeys(f"{n} of {title(m.stage)}" for m in meshes for n in m.unverified),
            *(f"{f.symbol} of {title(f.stage)}" for f in factors if f.source == BY_PLANETS),
            *(standard.UNVERIFIED_SPECTRUM if scene.load else ()),
        ),
        by=standard.NAME,
        static=tuple(row for mesh in meshes for row in static_rows(mesh, still)),
        idlers=idlers(scene.stage),
        named=named,
    )
    return replace(rated, safe=rated.met, life_h=rated.shortest_lived.life_h)


def _shafts(
    scene: Scene, pairs: tuple[GearPair, ...], turned: Sequence[str]
) -> tuple[ShaftRating, ...]:
    """Shafts of a drive under its largest load; turned: hands of pinions. Idlers have no torque."""
    if mesh_names(scene):
        known = [table.as_mesh for table in scene.stage_tables]
        return shafts_of_stages(known, *_largest_load(scene))
    rows = shaft_rows(pairs, turned, drivers(scene), *_largest_load(scene))
    idle = idlers(scene.stage)
    return tuple(replace(row, torque_Nm=0.0) if row.shaft in idle else row for row in rows)


def _efficiency(
    rows: Sequence[MeshRating], meshes: Sequence[Mesh]
) -> tuple[float | None, float | None]:
    """Return the efficiency of all meshes and its error [%]; None where one is not known.

    Of a planetary stage the losses of its meshes are those of the power that rolls.
    """
    parts = [1.0 if mesh.own is None else mesh.own.rolled for mesh in meshes]
    known = [
        1.0 - part * (1.0 - p / 100.0)
        for row, part in zip(rows, parts, strict=True)
        if (p := row.mesh_efficiency_percent) is not None
    ]
    errors = [
        e * part
        for row, part in zip(rows, parts, strict=True)
        if (e := row.mesh_efficiency_error_percent) is not None
    ]
    whole = 100.0 * math.prod(known) if len(known) == len(rows) else None
    return whole, sum(errors) if errors else None


def _largest_load(scene: Scene) -> tuple[float, float]:
    """Return torque [N mm] and speed [rad/s] of the input at the level of the largest torque."""
    usual = scene.duty.input_speed
    levels = [(level.power.value, (level.input_speed or usual).value) for level in scene.load]
    levels = levels or [(scene.duty.input_power, usual.value)]
    return max((torque(power, speed), speed) for power, speed in levels)
