"""Assumptions of the rating of a drive, and its materials that no gear may have."""

from collections.abc import Iterator

from gearopt.formulations.strength.standard import MIDWAY
from gearopt.physics.agma.allowables import IRONS
from gearopt.physics.gears import MEMBERS
from gearopt.physics.iso6336.case import Practice
from gearopt.scenes.drive.driving import drivers
from gearopt.scenes.drive.face_widths import excesses
from gearopt.scenes.drive.idlers import idlers
from gearopt.scenes.drive.planetary import every_mesh, planet_assumptions
from gearopt.scenes.drive.rating.iso_material import steel
from gearopt.scenes.drive.rating.materials import Named, choices, unused
from gearopt.scenes.drive.rating.options import by, of_stage
from gearopt.scenes.drive.rating.steels import chosen
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.rating import GearTable, RatingTable

WIDER = (
    "A gear that is wider than its mesh bends over its own width, at most one module m_n beyond "
    "the mesh at each end (ISO 6336-3 from memory: unverified); all K factors are of the mesh's."
)


def rating_assumptions(scene: Scene) -> list[str]:
    """Assumptions of a rating, in sentences."""
    asked = scene.rating
    assert asked
    agma, iso = asked.standard != "iso6336", asked.standard != "agma"
    members = dict.fromkeys(drivers(scene))
    drive = "the gears named drive" if len(members) > 1 else f"the {next(iter(members))}s drive"
    external = not any(stage.epicyclic for stage in scene.stage)
    drive, outer = (drive, "external ") if external else ("the members named input drive", "")
    sentences = [
        f"The rating is of {outer}cylindrical gears on parallel shafts; {drive}. "
        "Torques and forces are computed without losses.",
        "Formulas and values were taken from textbooks, tables and public programs, not from the "
        "standards themselves; those with a single source are marked unverified.",
        *_idlers(scene),
        *planet_assumptions(scene),
        *_named_steels(scene),
        *(_agma_assumptions(scene, asked) if agma else []),
        *(_iso_assumptions(scene, asked) if iso else []),
        "Scuffing, micropitting, flank fracture, wear, shafts and bearings were not rated.",
        "S_H is a ratio of contact stresses; its square is a ratio of loads. A life ends where a "
        "safety factor falls to 1.",
    ]
    unstated = _unstated(asked, agma, iso)
    return [*sentences, f"Not in the file: {', '.join(unstated)}."] if unstated else sentences


def _idlers(scene: Scene) -> Iterator[str]:
    """Sentences on gears in two meshes."""
    for k in idlers(scene.stage):
        yield (
            f"The idler of stages {k - 1} and {k} is one gear, counted in the first, on a shaft "
            "without torque. A revolution loads each flank once and bends its teeth once each way: "
            "one load cycle, of reversed bending (unverified). Load distribution is that of pairs. "
            "Pinion and wheel are taken not to touch: their axes lie in one plane, or nearly."
        )


def _named_steels(scene: Scene) -> list[str]:
    """Sentences on the steels that gears have by name: their treatment, hardness, sources."""
    used = {table.steel: steel for table, _ in every_gear(scene) if (steel := chosen(table))}
    if not used:
        return []
    each = []
    for name, one in used.items():
        heat = "" if one.heat == "none" else f"{one.heat}, "
        known = "two sources or more" if one.verified else "unverified"
        each.append(
            f"{name}, {heat}{one.hardness[0]:g} to {one.hardness[1]:g} {one.unit} ({known})"
        )
    iron = any(not one.treatment and not one.hardened for one in used.values())
    return [
        *["Irons and castings have the elastic modulus of steel unless the file gives one."] * iron,
        f"Steels by name: {'; '.join(each)}. The least hardness counts for which the standards "
        "have strengths, unless the file gives one; class, quality and grade are those usual for "
        "the treatment (unverified: the supplier's certificate decides).",
    ]


def _agma_assumptions(scene: Scene, asked: RatingTable) -> list[str]:
    """Assumptions of a rating by AGMA; where J is given it has its own load."""
    load = (
        "at the highest point of single tooth contact"
        if asked.bending_load == "highest single"
        else "at the tip"
    )
    known = [by("agma").given(asked, own) for own in scene.stage_tables]
    staged = [float(of_stage(asked, own).pinion_offset) for own in scene.stage_tables]
    offsets = dict.fromkeys(f"{offset:g}" for offset in staged)
    bending = (
        "Bending stresses of spur gears, and of helical ones of low overlap ratio, are those of a "
        f"load {load}"
        f"{' (AGMA)' * (asked.standard == 'both')}."
    )
    words = "" if all("K_v" in own for own in known) else by("agma").stated_accuracy(asked)
    owned = any(table.quality is not None for table, _ in every_gear(scene))
    iron = any(table.treatment in IRONS for table, _ in every_gear(scene))
    others = ", or of the gear's own where the file gives it" if owned else ""
    return [
        *([f"K_v is that of transmission accuracy {words}{others}."] if words else []),
        f"K_m follows the curve of {asked.mounting} gearing"
        + (", crowned" if asked.crowned else ", teeth without crowning")
        + f"; the pinion offset S_1/S is {' and '.join(offsets)}.",
        *([] if all("J" in own for own in known) else [bending]),
        *[
            "Irons by ASTM have the lower strengths of AGMA's ranges (unverified) and the lowest "
            "stress cycle factors of steel, for the standard has none of iron; unless the file "
            "gives one, the elastic modulus of A48 is 152 GPa, of A536 165 GPa (unverified)."
        ]
        * iron,
    ]


def _iso_assumptions(scene: Scene, asked: RatingTable) -> list[str]:
    """Assumptions of a rating by ISO 6336: materials, misalignment."""
    chosen = dict.fromkeys(
        f"{table.treatment or 'none given'} as {steel(table).name}"
        for table, _ in every_gear(scene)
        if table.iso_material is None and table.steel is None
    )
    helix = asked.iso6336.helix_modification
    modified = "without helix modification" if helix == "none" else f"helix modification: {helix}"
    placed = any(of_stage(asked, own).shaft for own in scene.stage_tables)
    where = "where its [shaft] has it, else " * placed + "midway between its bearings"
    overloaded = bool(scene.load) and asked.overload_factor != 1
    words = [f"Materials of ISO 6336-5 by treatment: {', '.join(chosen)}."] if chosen else []
    return [
        *words,
        f"K_Hβ by method C of ISO 6336-1, for a pinion {where} on a solid "
        f"shaft; {modified}. Bending by method B: the load acts at the outer point of single pair "
        "contact.",
        *[WIDER] * any(any(excesses(own, scene.gears)) for own in scene.stage_tables),
        *[f"K_A = {float(asked.overload_factor):g} multiplies every level of load."][:overloaded],
    ]


def pinions_in_box(scene: Scene) -> list[str]:
    """Return that a rating does not know where a layout puts pinions; nothing where none is so."""
    asked = scene.rating
    if asked is None or scene.layout is None:
        return []
    stages = scene.stage_tables
    iso = asked.standard != "agma" and any(
        not of_stage(asked, own).shaft and "K_Hbeta" not in by("iso6336").given(asked, own)
        for own in stages
    )
    agma = (asked.standard != "iso6336" and not asked.pinion_offset) and any(
        "K_m" not in by("agma").given(asked, own) for own in stages
    )
    if not (iso or agma):
        return []
    factor = "K_Hβ (C_pm by AGMA)" if iso and agma else "K_Hβ" if iso else "C_pm"
    return [
        f"{MIDWAY}; where the layout puts it elsewhere, {factor} may be larger than rated: this "
        "is not fed back."
    ]


def _unstated(asked: RatingTable, by_agma: bool, by_iso: bool) -> list[str]:
    """Return defaults that a rating takes where the file says nothing."""
    given, iso = asked.stated, asked.iso6336.stated
    usual = Practice()
    rows = (
        (True, "overload_factor" in given, "overload factor 1"),
        (by_agma, "reliability" in given, "reliability 99 %"),
        (by_agma, "mounting" in given, f"mounting {asked.mounting}"),
        (by_iso, "oil_grade" in iso, f"oil of {usual.viscosity:g} mm²/s at 40 °C"),
    )
    return [f"{words} (default)" for enters, stated, words in rows if enters and not stated]


def unused_materials(scene: Scene) -> list[str]:
    """Return a note on the materials of the file that no gear may have, if there are any."""
    names = unused(every_mesh(scene.stage_tables), scene.gears, scene.material)
    return [f"[[material]] in no list of a gear: {', '.join(names)}."] if names else []


def every_gear(scene: Scene) -> Iterator[tuple[GearTable, Named | None]]:
    """Every gear with each material that it may have, and that material."""
    for stage in every_mesh(scene.stage_tables):
        for member in MEMBERS:
            yield from choices(getattr(stage, member), scene.gears, scene.material)
