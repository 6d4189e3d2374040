"""A rating as sections of tables: gears, factors, forces and contact, teeth, load spectrum."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isclose
from typing import Any

from gearopt.formulations.rating import DriveRating, LoadLevel
from gearopt.optimise.result import Result
from gearopt.report.design_tables import stage_label, tables
from gearopt.report.measures import Measures, rounded
from gearopt.report.rating_words import (
    AT_ONCE,
    FRICTION,
    LONGEST,
    ROUNDING,
    efficiency,
    life,
    rating_of,
    told,
    unsure,
    unverified,
)
from gearopt.report.section import Cell, Section, Table, cell, percent
from gearopt.report.words import MODULE, RATING, heading, module_words, number, parted

GEARS = {  # keys of a gear's rating: what they are called
    "material": "material",
    "bending_stress_MPa": "bending stress s_t",
    "permissible_bending_stress_MPa": "permissible s_t",
    "bending_safety": "S_F",
    "contact_stress_MPa": "contact stress s_c",
    "permissible_contact_stress_MPa": "permissible s_c",
    "contact_safety": "S_H",
    "cycles": "load cycles",
    "bending_damage": "Miner's sum, bending",
    "contact_damage": "Miner's sum, contact",
    "bending_life_cycles": "life, bending",
    "contact_life_cycles": "life, contact",
    "life_h": "life",
}
STRESSES = [key for key in GEARS if key.endswith("_MPa")]
LIVES = [key for key in GEARS if "life" in key]
MESHES = {
    "governs": "governs",
    "power_capacity_kW": "power capacity",
    "tangential_force_N": "tangential force F_t",
    "radial_force_N": "radial force F_r",
    "axial_force_N": "axial force F_a",
    "pitch_line_velocity_m_per_s": "pitch-line velocity v",
    "working_pressure_angle_deg": "working pressure angle α_wt",
    "working_helix_angle_deg": "working helix angle β_w",
    "transverse_contact_ratio": "transverse contact ratio ε_α",
    "overlap_ratio": "overlap ratio ε_β",
    "total_contact_ratio": "total contact ratio ε_γ",
    "circumferential_backlash_mm": "circumferential backlash j_wt",
    "normal_backlash_mm": "normal backlash j_bn",
    "tooth_loss_factor": "tooth loss factor H_V",
    "friction_coefficient": "coefficient of friction μ",
    "mesh_efficiency_percent": "efficiency of the mesh",
    "mesh_efficiency_error_percent": "its error, up or down",
}
SHAFTS = {
    "torque_Nm": "torque",
    "speed_rpm": "speed",
    "rotation": "turns",
    "axial_force_N": "axial force",
}
TEETH = {  # ISO 21771
    "hand": "hand of the helix",
    "teeth": "teeth z",
    "profile_shift": "profile shift x",
    "generating_shift": "generating shift x_E",
    "reference_diameter_mm": "reference diameter d",
    "working_pitch_diameter_mm": "working pitch diameter d_w",
    "base_diameter_mm": "base diameter d_b",
    "tip_diameter_mm": "tip diameter d_a",
    "root_diameter_mm": "root diameter d_f",
    "form_diameter_mm": "root form diameter d_Ff",
    "active_root_diameter_mm": "active root diameter d_Nf",
    "tip_thickness_mm": "tip thickness s_a",
    "tip_clearance_mm": "tip clearance c",
    "largest_specific_sliding": "largest specific sliding ζ",
    "span_teeth": "teeth spanned k",
    "span_mm": "span W_k",
    "ball_diameter_mm": "ball diameter D_M",
    "over_balls_mm": "diameter over balls M_dK",
}
LEVELS = {
    "level": "level",
    "power_kW": "power",
    "input_speed_rpm": "input speed",
    "share_percent": "share of life",
    "cycles": "cycles",
    "bending_stress_MPa": "s_t",
    "contact_stress_MPa": "s_c",
    "bending_damage": "damage, bending",
    "contact_damage": "damage, contact",
}
ONCE = (
    "level",
    "power_kW",
    "input_speed_rpm",
    "share_percent",
)  # of a level, for all gears
IN_DESIGN = {  # keys of stages and totals that tables of a rating show
    *("pinion_diameter_mm", "wheel_diameter_mm", "pinion_tip_diameter_mm"),
    *("wheel_tip_diameter_mm", "pinion_root_diameter_mm", "wheel_root_diameter_mm"),
    *("transverse_contact_ratio", "overlap_ratio", "pitch_line_velocity_m_per_s"),
    *("working_pressure_angle_deg", "pinion_profile_shift", "wheel_profile_shift"),
    *("pinion_torque_Nm", "output_torque_Nm"),
}
DAMAGE_DIGITS = 3
ABREAST = 2  # stages whose teeth fit beside another table


def gears(result: Result, measures: Measures) -> Section | None:
    """Return stresses, safety factors and lives of every gear; None without a rating."""
    if (found := rating_of(result)) is None:
        return None
    rows = list(_gear_rows(found, measures))
    hidden = [label(key, GEARS, measures) for key in STRESSES] if found.levels else []
    table = Table("gears", ["", *names(found)], rows, csv_only=hidden, across=True)
    words = [
        f"By {found.standard}.",
        "S_F and S_H are permissible over present stress; S_H squared is the safety of the load.",
    ]
    if found.levels:
        words.append("Safety factors are those of all load levels together, by Miner's rule.")
    if any(None in (g.bending_life_cycles, g.contact_life_cycles) for g in found.gears):
        words.append(f"Beyond: more than {LONGEST}, where the life curves end.")
    shown = _told(result, found, measures)
    return Section("Rating", words=words, tables=(table,), half=_single(found), terminal=shown)


def _single(found: DriveRating) -> bool:
    """Return whether there is one stage, whose tables leave room beside them."""
    return len(found.meshes) == 1


def design(result: Result, measures: Measures) -> Section | None:
    """Return the tables of a design, without those of its rating; None without a design."""
    own = {key: value for key, value in result.design.items() if key != "rating"}
    return tables(replace(result, design=own), measures)


def beside(table: Table, result: Result, measures: Measures) -> Table:
    """Return stages or totals without what a rating, or the only stage, shows of them."""
    stages, hidden = result.design["stages"], set(IN_DESIGN)
    if table.name == "stages":
        return replace(table, csv_only=[stage_label(key, measures) for key in hidden])
    if table.name != "totals":
        return table
    if len(stages) == 1:
        hidden |= {*stages[0], "sum_of_centre_distances_mm"}
    if not {"ratio", "output_speed"} & set(result.asked.get("duty", ())):
        hidden.add("ratio_error_percent")
    return replace(table, csv_only=[heading(key, measures) for key in hidden])


def names(found: DriveRating) -> list[str]:
    """Return the names of all gears: of several stages with their stage."""
    return [name(found, gear) for gear in found.gears]


def name(found: DriveRating, gear: Any) -> str:
    """Return the name of a gear of some table, with its stage where there are several."""
    return gear.member if len(found.meshes) == 1 else f"{gear.member} {gear.stage}"


def label(key: str, words: Mapping[str, str], measures: Measures) -> str:
    """Return what a key is called, with its unit."""
    unit = parted(key, measures)[1]
    return f"{words[key]} [{measures.unit(unit)}]" if unit else words[key]


def _rows(
    items: Sequence[Any], words: Mapping[str, str], measures: Measures
) -> Iterator[tuple[str, list[Any]]]:
    """Yield key and row of everything that is known of some item."""
    for key in words:
        values, unit = [getattr(item, key) for item in items], parted(key, measures)[1]
        if any(value is not None for value in values):
            yield key, [label(key, words, measures), *(cell(v, unit, measures) for v in values)]


def _across(
    name: str,
    heads: Sequence[str],
    items: Sequence[Any],
    words: Mapping[str, str],
    measures: Measures,
) -> Table:
    """Return a table of items side by side."""
    rows = [row for _, row in _rows(items, words, measures)]
    return Table(name, ["", *heads], rows, across=True)


def _gear_rows(found: DriveRating, measures: Measures) -> Iterator[list[Any]]:
    """Yield the rows of gears, and below every safety factor how much of it is used."""
    asked = {
        "bending_safety": found.minimum_bending_safety,
        "contact_safety": found.minimum_contact_safety,
    }
    known = dict(_rows(found.gears, GEARS, measures))
    steels = (gear.material for gear in found.gears)
    known["material"] = ["material", *(Cell(s, s.replace(", ", "\n")) for s in steels)]
    for key in GEARS:
        if key in LIVES:
            lives = (_life(getattr(gear, key), key, measures) for gear in found.gears)
            yield [label(key, GEARS, measures), *lives]
        elif found.levels and key.endswith("_damage"):
            yield [GEARS[key], *(_damage(getattr(gear, key)) for gear in found.gears)]
        elif key in known:
            yield known[key]
        if key in asked:
            used = (_used(asked[key], getattr(gear, key)) for gear in found.gears)
            yield [f"utilisation, {GEARS[key]} {asked[key]:g} asked for [%]", *used]


def _used(asked: float, own: float) -> Cell:
    return percent(asked / own) if own > 0.0 else Cell(None, AT_ONCE, 1.0)


def _life(value: float | None, key: str, measures: Measures) -> Cell:
    """Return a life; None beyond the end of the curves, 0 before they begin."""
    if not value:
        return Cell(value, "beyond" if value is None else AT_ONCE)
    return cell(value, parted(key)[1], measures)


def _damage(value: float | None) -> Cell:
    """Return a part of Miner's sum; None where the tooth breaks or pits at once."""
    return Cell(None, AT_ONCE) if value is None else Cell(value, rounded(value, DAMAGE_DIGITS))


def _told(result: Result, found: DriveRating, measures: Measures) -> list[str | Table]:
    """Return what the terminal shows of all gears; of an optimum first how it is rated."""
    keys = [key for key in GEARS if key.endswith(("_MPa", "_safety"))]
    sign = measures.unit("MPa")
    strong = f"permissible\n{sign}"
    short = (f"bending\n{sign}", strong, "S_F", f"contact\n{sign}", strong, "S_H")
    rows = [
        [name, *(cell(getattr(gear, key), parted(key)[1], measures) for key in keys)]
        for name, gear in zip(names(found), found.gears, strict=True)
    ]
    heads = [label(key, GEARS, measures) for key in keys]
    read = dict(zip(heads, short, strict=True))
    table = Table("gears", ["gear", *heads], rows, short=read, wrap=9)
    lasts = f"Life: {life(found.life_h)}, {life(found.required_life_h)} asked for."
    if found.efficiency_percent is not None:
        lasts += f" Efficiency of the meshes: {efficiency(found)}{unsure(found)}."
    first = [] if result.name == RATING else [measures.words(told(found))]
    end = unverified(found) if first else []
    return [*first, table, "\n".join([lasts, f"By {found.standard}.", *end])]


def forces(result: Result, measures: Measures) -> Section | None:
    """Return contact and forces of every mesh, and what shafts carry; None without a rating."""
    if (found := rating_of(result)) is None:
        return None
    heads = [f"stage {mesh.stage}" for mesh in found.meshes]
    meshes = _across("meshes", heads, found.meshes, MESHES, measures)
    heads = [f"shaft {shaft.shaft}" for shaft in found.shafts]
    shafts = _across("shafts", heads, found.shafts, SHAFTS, measures)
    axial = [label("axial_force_N", SHAFTS, measures), *_end_words(found, measures)]
    shafts = replace(shafts, rows=[*shafts.rows[:-1], axial])
    level = ", at the load level of largest force" if found.levels else ""
    words = [
        f"Forces of a mesh act at the working pitch circles{level}. Shafts carry them without "
        "losses; rotations are seen from the input end, axial forces point away from it where "
        "they are positive, and the other way where the input turns anticlockwise."
    ]
    if found.efficiency_percent is not None:
        words.append(
            "Efficiencies are those of tooth friction alone, without bearings, seals and churned "
            "oil" + ("." if found.efficiency_error_percent is None else f"; {FRICTION}.")
        )
    stages = result.design["stages"]
    told = "\n".join(f"{_mesh_words(found, stage, k, measures)}" for k, stage in enumerate(stages))
    half = _single(found)
    return Section(
        "Forces and contact", words=words, tables=(meshes, shafts), half=half, terminal=(told,)
    )


def _mesh_words(found: DriveRating, stage: Mapping[str, Any], k: int, measures: Measures) -> str:
    """Return sizes, contact and forces of a stage (from 0) in a sentence."""
    mesh, size = found.meshes[k], measures.amount
    parts = [
        f"Stage {k + 1}: {module_words(stage[MODULE], measures)}",
        f"z {number(stage['pinion_teeth'])}/{number(stage['wheel_teeth'])}",
        f"b {size(stage['face_width_mm'], 'mm')}",
        f"a {size(stage['centre_distance_mm'], 'mm')}; contact ratio "
        f"{number(mesh.total_contact_ratio)}",
        f"v {size(mesh.pitch_line_velocity_m_per_s, 'm_per_s')}; "
        f"F_t {size(mesh.tangential_force_N, 'N')}",
        f"F_r {size(mesh.radial_force_N, 'N')}",
        f"F_a {size(mesh.axial_force_N, 'N')}.",
    ]
    return ", ".join(parts)


def teeth(result: Result, measures: Measures) -> Section | None:
    """Return the geometry of the teeth of every gear; None without a rating."""
    if (found := rating_of(result)) is None:
        return None
    table = _across("teeth", names(found), found.teeth, TEETH, measures)
    words = [
        "Terms of ISO 21771; shifts in normal modules. The generating shift is that of the tool, "
        "with the allowance of the tooth thickness; contact with the mate ends at the active root "
        "diameter."
    ]
    return Section("Teeth", words=words, tables=(table,), half=len(found.meshes) <= ABREAST)


def levels(result: Result, measures: Measures) -> Section | None:
    """Return the load spectrum with the damage of every level; None without one."""
    found = rating_of(result)
    if found is None or not found.levels:
        return None
    of_gear = [key for key in LEVELS if key not in ONCE]
    heads = [label(key, LEVELS, measures) for key in (*ONCE, *of_gear)]
    heads.insert(len(ONCE), "gear")
    ordered = sorted(found.levels, key=lambda level: level.level)
    rows = [_level_row(found, level, of_gear, measures) for level in ordered]
    words = (
        "A level's damage is its load cycles over those that the gear would bear at this level "
        "alone; it fails where their sum (Miner's) is 1.",
    )
    return Section("Load spectrum", words=words, tables=(Table("levels", heads, rows),))


def _level_row(
    found: DriveRating, level: LoadLevel, of_gear: Sequence[str], measures: Measures
) -> list[Any]:
    """Return a level of a gear; the page shows its load once, at the first gear."""
    load = [cell(getattr(level, key), parted(key)[1], measures) for key in ONCE]
    if name(found, level) != names(found)[0]:
        load = [replace(one, text="") for one in load]
    values = ((key, getattr(level, key)) for key in of_gear)
    cells = (
        _damage(value) if key.endswith("damage") else cell(value, parted(key)[1], measures)
        for key, value in values
    )
    return [*load, name(found, level), *cells]


def _end_words(found: DriveRating, measures: Measures) -> list[Any]:
    """Return the axial forces of shafts, those of one gear by the name of its mesh's."""
    cells = [cell(shaft.axial_force_N, "N", measures) for shaft in found.shafts]
    for k, mesh in ((0, found.meshes[0]), (-1, found.meshes[-1])):
        own = found.shafts[k].axial_force_N
        if own and isclose(abs(own), mesh.axial_force_N, rel_tol=ROUNDING):
            sign = "−" if own < 0.0 else ""
            cells[k] = replace(cells[k], text=f"{sign}F_a of stage {mesh.stage}")
    return cells
