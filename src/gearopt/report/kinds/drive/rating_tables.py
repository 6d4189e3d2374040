"""A rating as sections of tables: forces and contact, teeth; names and rows of its tables."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isclose
from typing import Any

from gearopt.formulations.drive.rating import DriveRating, MeshRating, ToothGeometry
from gearopt.optimise.result import Result
from gearopt.physics.gears import MEMBERS
from gearopt.report.design_tables import design_section, driving, stage_label, types
from gearopt.report.kinds.drive.rating_words import FRICTION, ROUNDING, rating_of, safety
from gearopt.report.measures import Measures
from gearopt.report.section import ABSENT, Cell, Section, Table, cell, listed_fields, side_by_side
from gearopt.report.words import MODULE, heading, module_words, number, parted

IN_DESIGN = {  # keys of stages and totals that tables of a rating show
    *("pinion_diameter_mm", "wheel_diameter_mm", "pinion_tip_diameter_mm"),
    *("wheel_tip_diameter_mm", "pinion_root_diameter_mm", "wheel_root_diameter_mm"),
    *("transverse_contact_ratio", "overlap_ratio", "pitch_line_velocity_m_per_s"),
    *("working_pressure_angle_deg", "pinion_profile_shift", "wheel_profile_shift"),
    *("pinion_torque_Nm", "output_torque_Nm", "mesh_load_factor", "ring_contact_ratio"),
    *("ring_diameter_mm", "ring_tip_diameter_mm", "ring_root_diameter_mm", "ring_profile_shift"),
}
REASONS = {  # why a gear or a mesh may lack a value that others have, by field
    "usable_contact_ratio": "undercut leaves all of the transverse contact ratio",
    "mesh_efficiency_percent": "the loss is too large for the formula of the efficiency",
    "active_root_diameter_mm": "the mate's tip passes the end of the involute",
    "span_mm": "a span cannot be measured, as it would not touch the flanks within the face width",
    "over_balls_mm": "balls would not touch the flanks, or not stand out of the tips",
}
ABREAST = 2  # stages whose teeth fit beside another table


def single(rating: DriveRating) -> bool:
    """Whether there is one stage, whose tables leave room beside them."""
    return len(rating.meshes) == 1


def design(result: Result, measures: Measures) -> Section | None:
    """The tables of a design, without those of rating and drawings; None without a design."""
    apart = ("rating", "drawing")
    others = {key: value for key, value in result.design.items() if key not in apart}
    return design_section(replace(result, design=others), measures)


def beside(table: Table, result: Result, measures: Measures) -> Table:
    """Stages or totals without what a rating, or the only stage, shows of them."""
    stages, hidden = result.design["stages"], set(IN_DESIGN)
    if table.name == "stages":
        labels = [stage_label(key, measures, types(stages)) for key in hidden]
        return replace(table, csv_only=labels)
    if table.name != "totals":
        return table
    if len(stages) == 1:
        hidden |= {*stages[0], "sum_of_centre_distances_mm"}
    if not {"ratio", "output_speed"} & set(result.asked.get("duty", ())):
        hidden.add("ratio_error_percent")
    return replace(table, csv_only=[heading(key, measures) for key in hidden])


def names(rating: DriveRating) -> list[str]:
    """The names of all gears: of several stages with their stage."""
    return [name(rating, gear) for gear in rating.gears]


def name(rating: DriveRating, gear: Any) -> str:
    """The name of a gear of some table, with its stage where there are several."""
    return (
        rating.called(gear)
        if len(rating.meshes) == 1
        else f"{rating.called(gear)} {rating.stage_of(gear.stage)}"
    )


def figure(value: Any, key: str, measures: Measures) -> Any:
    """A value as its sentence has it, of what is never rounded up."""
    unit = parted(key, measures)[1]
    if value is None or not key.endswith(("_safety", "capacity_kW")):
        return cell(value, unit, measures)
    text = measures.words(f"{safety(value)} kW").split()[0] if unit else safety(value)
    return Cell(measures.of(value, unit), text)


def _lacking(items: Sequence[Any], measures: Measures) -> tuple[list[list[Any]], list[str]]:
    """A row for every field, a dash where one is lacking, and the reasons in a sentence."""
    rows = [
        [label, *(replace(c, text=ABSENT) if c.value is None else c for c in cells)]
        for label, *cells in side_by_side(items, measures)
    ]
    held = {it.key for it in listed_fields(items[0].__class__)}
    reasons = [
        reason
        for key, reason in REASONS.items()
        if key in held and {getattr(item, key) is None for item in items} == {True, False}
    ]
    return rows, [f"{ABSENT}: {'; '.join(reasons)}."] if reasons else []


def forces(result: Result, measures: Measures) -> Section | None:
    """Contact and forces of every mesh, and what shafts carry; None without a rating."""
    if (rating := rating_of(result)) is None:
        return None
    heads = ["", *(rating.titled(mesh.stage) for mesh in rating.meshes)]
    shown, lacking = _lacking(rating.meshes, measures)
    if drawn := bool(result.design.get("drawing")):  # whose backlash has a table of its own
        shown = [[re.sub(r" (j_\w+)", r" \1, nominal", label), *cells] for label, *cells in shown]
    rows = [*_least_rows(rating, measures), *shown]
    meshes = Table("meshes", heads, rows, across=True)
    heads = ["", *(f"shaft {shaft.shaft}" for shaft in rating.shafts)]
    *rows, (axial, *_) = side_by_side(rating.shafts, measures)
    if not rating.named:  # else each sun, planet and ring has axial forces of its own
        rows.append([axial, *_end_words(rating, measures)])
    flow = [row[0] for row in rows[:2]] if rating.named else ()  # a table of members has them
    shafts = Table("shafts", heads, rows, across=True, csv_only=flow)
    level = ", at the load level of largest force" if rating.levels else ""
    words = [
        f"Forces of a mesh act at the working pitch circles{level}. Shafts transmit torques "
        "without losses. Rotations are seen from the input end, for an input that turns "
        "clockwise; positive axial forces point away from that end, and all reverse with the "
        "rotation of the input."
    ]
    if rating.efficiency_percent is not None:
        words.append(
            "Efficiencies are those of tooth friction alone, without bearings, seals and oil "
            "churning" + ("." if rating.efficiency_error_percent is None else f"; {FRICTION}.")
        )
    if drawn:
        words.append("Nominal backlash is without the allowances of the drawing data.")
    words += lacking
    stages = result.design["stages"]
    sentences = "\n".join(
        _mesh_words(rating, stages[rating.stage_of(mesh.stage) - 1], k, measures)
        for k, mesh in enumerate(rating.meshes)
    )
    half = single(rating)
    return Section(
        "Forces and contact", words=words, tables=(meshes, shafts), half=half, terminal=(sentences,)
    )


def _least_rows(rating: DriveRating, measures: Measures) -> Iterator[list[Any]]:
    """Yield what governs every mesh and what it may transmit, by every standard."""
    for it in listed_fields(MeshRating, "governing"):
        for rated in rating.each:
            of = "" if rating.beside is None else f" by {rated.by}"
            values = (figure(getattr(mesh, it.key), it.key, measures) for mesh in rated.meshes)
            yield [replace(it, label=it.label + of).head(measures), *values]


def _mesh_words(rating: DriveRating, stage: Mapping[str, Any], k: int, measures: Measures) -> str:
    """Sizes, contact and forces of a stage (from 0) in a sentence."""
    mesh, size = rating.meshes[k], measures.amount
    teeth = [stage["pinion_teeth"], stage["wheel_teeth"]]
    if rating.called(rating.gears[2 * k + 1]) == "ring":
        teeth = [stage.get("planet_teeth", teeth[0]), stage["ring_teeth"]]
    parts = [
        f"{rating.titled(k + 1).capitalize()}: {module_words(stage[MODULE], measures)}",
        f"z {'/'.join(map(number, teeth))}"
        + f", the {driving(stage)} drives" * ("driver" in stage),
        f"b {size(stage['face_width_mm'], 'mm')}",
        *(f"{m} {size(b, 'mm')}" for m in MEMBERS if (b := stage.get(f"{m}_face_width_mm"))),
        f"a {size(stage['centre_distance_mm'], 'mm')}; contact ratio "
        f"{number(mesh.total_contact_ratio)}{_left(mesh)}",
        f"v {size(mesh.pitch_line_velocity_m_per_s, 'm_per_s')}; "
        f"F_t {size(mesh.tangential_force_N, 'N')}",
        f"F_r {size(mesh.radial_force_N, 'N')}",
        f"F_a {size(mesh.axial_force_N, 'N')}.",
    ]
    return ", ".join(parts)


def _left(mesh: MeshRating) -> str:
    """Part of the transverse contact ratio that undercut leaves, where it leaves less."""
    left, whole = mesh.usable_contact_ratio, mesh.transverse_contact_ratio
    return (
        "" if left is None else f" (undercut leaves {number(left)} of {number(whole)} transverse)"
    )


def teeth(result: Result, measures: Measures) -> Section | None:
    """The geometry of the teeth of every gear; None without a rating."""
    if (rating := rating_of(result)) is None:
        return None
    shown = [_above_zero(gear) for gear in rating.teeth]
    if len({(gear.stage, gear.face_width_mm) for gear in shown}) == len(rating.meshes):
        shown = [replace(gear, face_width_mm=None) for gear in shown]  # b of the stage
    rows, lacking = _lacking(shown, measures)
    table = Table("teeth", ["", *names(rating)], rows, across=True)
    words = [
        "Terms are those of ISO 21771, shifts are in normal modules. The generating shift is that "
        "of the tool, with the allowance of the tooth thickness; contact with the mate ends at the "
        "active root diameter.",
        *lacking,
    ]
    return Section("Teeth", words=words, tables=(table,), half=len(rating.meshes) <= ABREAST)


def _above_zero(gear: ToothGeometry) -> ToothGeometry:
    """A gear whose teeth and diameters are above 0: those of rings count as negative."""
    keys = ["teeth", "over_balls_mm", *(k for k in vars(gear) if k.endswith("diameter_mm"))]
    known = {key: getattr(gear, key) for key in keys}
    return replace(gear, **{key: abs(v) for key, v in known.items() if v is not None})


def _end_words(rating: DriveRating, measures: Measures) -> list[Any]:
    """The axial forces of shafts, those of one gear by the name of its mesh's."""
    cells = [cell(shaft.axial_force_N, "N", measures) for shaft in rating.shafts]
    for k, mesh in ((0, rating.meshes[0]), (-1, rating.meshes[-1])):
        force = rating.shafts[k].axial_force_N
        if force and isclose(abs(force), mesh.axial_force_N, rel_tol=ROUNDING):
            sign = "−" if force < 0.0 else ""
            cells[k] = replace(cells[k], text=f"{sign}F_a of stage {mesh.stage}")
    return cells
