"""Assumptions of a drive, and notes for the reader of its result."""

from collections.abc import Sequence
from dataclasses import replace

from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.drive.shares import FRICTION
from gearopt.formulations.drive.train import STEEL_DENSITY
from gearopt.optimise.result import Result
from gearopt.physics.gears import ISO_53_A, MEMBERS
from gearopt.physics.geometry.profile_shift import ROOT_SAFETY
from gearopt.scenes.drive.driving import driving_words
from gearopt.scenes.drive.planetary import every_mesh
from gearopt.scenes.drive.rating.assumptions import (
    every_gear,
    pinions_in_box,
    rating_assumptions,
    unused_materials,
)
from gearopt.scenes.drive.rating.by_mesh import by_mesh, mesh_names
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.blanks import blank, body_flaws
from gearopt.scenes.drive.tables.drive import ORIGINS
from gearopt.scenes.drive.tables.layout import Layout
from gearopt.scenes.drive.tables.rating import with_shared
from gearopt.scenes.drive.toothings import inclination
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.reading.choices import in_words
from gearopt.scenes.reading.module_series import unverified

WEAKER = " Its contact ratio is less than the one given, its root is weaker."
CLEARANCES = {
    "gear_clearance": "between gears that do not mesh",
    "shaft_clearance": "between a shaft and what is not on it",
    "wall_clearance": "to the walls across the shafts",
    "axial_clearance": "along the shafts",
}


MESH_LOSS = (
    f"The mesh loss is {FRICTION:g} π (1/z1 + 1/z2) of the input power a stage: a coefficient of "
    f"friction of {FRICTION:g}, and no influence of the contact ratio. Formula and coefficient are "
    "not checked against any source; they compare designs."
)


OF_EXTREMES = {
    "axial_force": "The axial force is the largest of all stages, 2 T tan(β)/d; spur gears have "
    "none, so that every spur drive is one of least axial force, and large gears have little: "
    "limit wheel_diameter, or weigh it against gear_volume by gearopt pareto",
    "specific_sliding": "The specific sliding is the largest of all gears, without its sign, at "
    "the ends of contact between tip circles",
    "inverse_contact_ratio": "The contact ratio is the smallest of all stages, of ε_α + ε_β "
    "between tip circles; its inverse is minimised",
}
TIES = "Of designs up to this value the one of least gear volume is shown."


def of_objectives(scene: Scene, names: Sequence[str]) -> list[str]:
    """How objectives are computed whose names alone do not say it."""
    sentences = {"mesh_loss": MESH_LOSS} | {n: f"{words}." for n, words in OF_EXTREMES.items()}
    return [words for name, words in sentences.items() if name in names]


def notes(scene: Scene, exact: bool) -> list[str]:
    """Notes for the reader of a result beside the numbers."""
    sentences = of_objectives(scene, [scene.objective.minimise])
    limits, stages = scene.limits, scene.stage
    sentences += [TIES] * bool(scene.objective.extreme)
    if limits.preset is not None:
        sentences.append(f"The load limits are those of preset {limits.preset}, not of a standard.")
    if scene.teeth is not None and not exact:
        sentences.append("Teeth and modules are real numbers here; the table [teeth] was not used.")
    names = ("wheel_teeth", "stage_ratio", "wheel_diameter")
    if not any(getattr(table, name) for table in (limits, *stages) for name in names):
        sentences.append("No limit on wheel teeth, stage ratio or wheel diameter was set.")
    if exact and scene.gears.same_materials and scene.by_ratings:
        sentences.append("All pinions have one material, and all wheels have one.")
    inclining = any(inclination(own, scene.gears) for own in scene.stage_tables)
    shifting = any(scene.shift_ranges(own) for own in scene.stage_tables)
    if exact or inclining or shifting:
        sentences += _chosen(scene)
    if inclining or shifting:
        ranges = " and ".join(["helix angles"] * inclining + ["profile shifts"] * shifting)
        sentences.append(
            f"Within ranges of {ranges} the bound interpolates what teeth alone decide, with a "
            "margin that was checked on random designs and is not proven."
        )
    if exact and scene.teeth is not None:
        sentences += unverified(scene.teeth.modules)
    if scene.objective.density is None and not _dense(scene):
        sentences.append(f"The density is that of steel, {1e9 * STEEL_DENSITY:g} kg/dm³ (assumed).")
    return sentences + unused_materials(scene)


def with_notes(scene: Scene, result: Result, exact: bool) -> Result:
    """Sized gears with notes on them; those with real-valued sizes are a part with their own.

    exact: the gears have whole teeth.
    """
    parts = (_noted(scene, p, False) if p.name == "sizing" else p for p in result.parts)
    return replace(_noted(scene, result, exact), parts=tuple(parts))


def _noted(scene: Scene, result: Result, exact: bool) -> Result:
    if not result.design:
        return result
    design = drive_design(result.design)
    held = scene.held(len(design.stages))
    meshed, pairs, _ = by_mesh(held, design)
    named = mesh_names(meshed)
    bodies = dict.fromkeys(f.sentence for f in body_flaws(meshed.blanks, pairs, (), named))
    remarks = [*notes(held, exact), *bodies, *tooth_warnings(pairs, WEAKER, named)]
    report = result.report | ({"notes": remarks} if remarks else {})
    if any(len(held.helix_angles(own)) > 1 for own in held.stage_tables):
        report |= {"chosen": ["helix_angle_deg"]}
    return replace(result, report=report)


def _chosen(scene: Scene) -> list[str]:
    """Sentences on the stages that choose from several helix angles, distances or shifts."""
    stages: dict[tuple[str, str], list[int]] = {}
    for k, table in enumerate(scene.stage_tables, 1):
        helix = scene.gears.helix_angle if table.helix_angle is None else table.helix_angle
        asked = scene.shift if scene.shifted(table) else None
        shift, total = (asked.pinion_shift, asked.sum) if asked else (None, None)
        choices = {
            "helix angle": helix,
            "centre distance": table.centre_distance,
            "profile shift of the pinion": shift,
            "sum of profile shifts": total,
        }
        for name, held in choices.items():
            if held is not None and (words := in_words(held)):
                stages.setdefault((name, words), []).append(k)
    sentences = []
    for (name, words), where in stages.items():
        several = {
            "profile shift of the pinion": "profile shifts of the pinions",
            "sum of profile shifts": "sums of profile shifts",
        }.get(name, f"{name}s")
        are = f"{several} of stages {' and '.join(map(str, where))} were"
        are = are if len(where) > 1 else f"{name} of stage {where[0]} was"
        sentences.append(f"The {are} chosen from {words}.")
    if scene.limits.coaxial:
        sentences.append(
            "Both stages have one centre distance: the output is in line with the input."
        )
    return sentences


def _dense(scene: Scene) -> bool:
    """Return whether every gear has the density of its material."""
    return all(material and material.density for _, material in every_gear(scene))


def assumptions(scene: Scene) -> list[str]:
    """Assumptions of a design, in sentences."""
    stages = scene.stage_tables
    angles = dict.fromkeys(str(own.pressure_angle or scene.gears.pressure_angle) for own in stages)
    angle = " and ".join(angles)
    stated = "pressure_angle" in scene.gears.model_fields_set or any(
        own.pressure_angle for own in stages
    )
    assumed = "" if stated else " (default)"
    sentences = [
        *_teeth(scene),
        *_loads(scene, angle, assumed),
        masses(scene),
        *driving_words(scene),
    ]
    if scene.limits.preset is not None:
        name = scene.limits.preset
        sentences.insert(3, f"The load limits are those of preset {name}: {ORIGINS[name]}.")
    if scene.layout is None:
        return sentences
    return [*sentences, *_layout_assumptions(scene.layout), *pinions_in_box(scene)]


def masses(scene: Scene, noted: bool = True) -> str:
    """Return the bodies of volumes and masses, and their density; noted: a note gives steel's."""
    density = scene.objective.density
    steel = "the density of steel" + f", {1e9 * STEEL_DENSITY:g} kg/dm³" * (not noted)
    mass = (
        f"the density of the file, {density}"
        if density
        else f"{steel}, because the file gives none"
    )
    if scene.material:
        mass = f"the densities of the materials, else from {mass}"
    return f"{_bodies(scene)}; masses follow from {mass}."


def _bodies(scene: Scene) -> str:
    """The bodies whose volumes and masses are given."""
    stages = scene.stage_tables
    pairs = [stage for stage in stages if not stage.epicyclic]
    if not pairs:
        gears = [gear for stage in every_mesh(stages) for gear in (stage.pinion, stage.wheel)]
        bored = any(with_shared(gear, scene.gears).bore for gear in gears)
        less = ", masses those without the bores of the file" if bored else ""
        return f"Volumes are those of solid cylinders, of rings those of tubes{less}"
    of = "Volumes" if len(pairs) == len(stages) else "Volumes of pairs"
    tables = [with_shared(getattr(stage, m), scene.gears) for stage in pairs for m in MEMBERS]
    if all(blank(table, None).solid and not table.web_thickness for table in tables):
        if any(map(scene.shifted, stages)):
            return (
                f"{of} are those of solid cylinders of face width; where shifts are "
                "chosen their diameter is d + 2 x m_n, else the reference one"
            )
        return f"{of} are those of solid cylinders of reference diameter and face width"
    return (
        f"{of} are those of solid cylinders of reference diameter; masses are those of rims, "
        "webs and hubs, with the teeth as a ring between root and reference circle"
    )


def _loads(scene: Scene, angle: str, assumed: str) -> list[str]:
    """The limits of the loads, and the laws that the pressure angle enters."""
    if scene.by_ratings:
        title = scene.limits.LAW.title
        also = f", beside {title}," if scene.limits.loaded else ""
        return [
            f"The required safety factors{also} are the only limits on loads, at nominal sizes.",
            f"The normal pressure angle is {angle}{assumed}.",
            *rating_assumptions(scene),
        ]
    law = scene.limits.LAW
    alone = f"and {law.title}" if law.pressure_angle else f"alone; {law.title} do not depend on it"
    return [
        f"Loads are limited by {law.title} alone: {law.kind}.",
        f"The normal pressure angle of {angle}{assumed} enters contact ratio and undercut {alone}.",
    ]


def _teeth(scene: Scene) -> list[str]:
    """Assumptions on the teeth: shifts, tools, backlash."""
    pairs = [own for own in scene.stage_tables if not own.epicyclic]
    each = [scene.toothings(own)[0] for own in pairs or scene.stage_tables]
    shifted = any(any(cut.profile_shifts) for cut in each)
    shifts = "with the profile shifts of the file" if shifted else "without profile shift"
    given = next((cut for cut in each if cut.shifting is not None), None)
    if given is not None and given.shifting is not None:
        source = "the given centre distances" if given.shift_sum is None else "their given sum"
        shifts = (
            f"whose profile shifts follow from {source}, shared out by the rule "
            f"{given.shifting.rule}, with both tips shortened alike"
        )
        if given.shifting.rule == ROOT_SAFETY:
            by = "AGMA 2001" if scene.rating and scene.rating.standard == "agma" else "ISO 6336"
            shifts += (
                f" (S_F1 = S_F2 by {by} at equal stage ratios; pairs of which no shift does that "
                "are left out)"
            )
        if given.pinion_shift is not None:
            shifts = (
                "whose pinions have the profile shift of the file, that of their wheels following "
                f"from {source}, with both tips shortened alike"
            )
    ends = "torques are computed without losses in meshes and bearings"
    what = "The gears" if len(pairs) == len(scene.stage_tables) else "The gears of pairs"
    sentences = [f"{what} are external cylindrical gears {shifts}; {ends}."]
    if not pairs:
        sentences = [f"{ends.capitalize()}."]
    usual = {replace(ISO_53_A, pressure_angle=r.pressure_angle) for cut in each for r in cut.racks}
    if {rack for cut in each for rack in cut.racks} <= usual:
        sentences.append(
            "Tip and root circles follow from the basic rack ISO 53 profile A: addendum "
            f"{ISO_53_A.addendum:g} m_n, dedendum {ISO_53_A.dedendum:g} m_n; sizes are nominal, "
            "without backlash."
        )
    else:
        sentences.append(
            "Tip and root circles follow from the tools of the file; sizes are nominal."
        )
    if shifted and scene.limits.loaded:
        sentences.append(f"{scene.limits.LAW.title} are those of the reference circles.")
    return sentences


def _layout_assumptions(layout: Layout) -> list[str]:
    """Return of a layout: clearances, shafts, bearings, walls."""
    clear = [
        f"{words} {getattr(layout, name)}{'' if name in layout.model_fields_set else ' (default)'}"
        for name, words in CLEARANCES.items()
    ]
    shafts = (
        "Shaft diameters are those of the file; they are not checked."
        if layout.shaft_stress is None
        else f"Shaft diameters follow from torsion alone at {layout.shaft_stress}: no bending, no "
        "keyways or other notches."
    )
    bearings = (
        "Bearings are those of the file; their life is not checked."
        if layout.bearing_diameters
        else "The file gives no bearings: the box is made without room for them."
    )
    ends = "run from wall to wall" if layout.span == "full" else "end beside their gears"
    return [
        f"Clearances of the layout: {', '.join(clear)}.",
        f"{shafts} Shafts {ends}.",
        f"{bearings} The box is measured inside its walls.",
    ]
