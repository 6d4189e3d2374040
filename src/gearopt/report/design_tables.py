"""The numbers of a design as tables: its stages, and whatever lists and groups it holds."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from gearopt.formulations.strength import laws
from gearopt.optimise.result import Result
from gearopt.report.measures import INCH, Measures, diametral_pitch
from gearopt.report.section import Cell, Section, Table, Tile, percent
from gearopt.report.words import EXACT, MODULE, heading, number, objective, parted

STAGE_ROWS = {  # what a key is called, and its unit (modules are metric in any system)
    "normal_module_mm": ("module m_n [mm]", ""),
    "pinion_teeth": ("teeth z1", ""),
    "wheel_teeth": ("teeth z2", ""),
    "ratio": ("ratio u", ""),
    "face_width_mm": ("face width b", "mm"),
    "pinion_diameter_mm": ("diameter d1", "mm"),
    "wheel_diameter_mm": ("diameter d2", "mm"),
    "pinion_tip_diameter_mm": ("tip diameter d_a1", "mm"),
    "wheel_tip_diameter_mm": ("tip diameter d_a2", "mm"),
    "pinion_root_diameter_mm": ("root diameter d_f1", "mm"),
    "wheel_root_diameter_mm": ("root diameter d_f2", "mm"),
    "centre_distance_mm": ("centre distance a", "mm"),
    "transverse_contact_ratio": ("transverse contact ratio ε_α", ""),
    "overlap_ratio": ("overlap ratio ε_β", ""),
    "pinion_torque_Nm": ("torque T1", "Nm"),
    "pitch_line_velocity_m_per_s": ("pitch-line velocity v", "m_per_s"),
    **{limit.design_key: (limit.label, limit.unit) for law in laws() for limit in law.limits},
    "gear_volume_mm3": ("volume", "cm3"),
    "pinion_mass_kg": ("pinion mass", "kg"),
    "wheel_mass_kg": ("wheel mass", "kg"),
    "mass_kg": ("mass of the pair", "kg"),
}
PAGE_ONLY = {
    *("pinion_tip_diameter_mm", "wheel_tip_diameter_mm"),
    *("pinion_root_diameter_mm", "wheel_root_diameter_mm"),
    *("transverse_contact_ratio", "overlap_ratio", "pitch_line_velocity_m_per_s"),
    *("pinion_mass_kg", "wheel_mass_kg", "mass_kg"),
}


def tables(result: Result, measures: Measures) -> Section | None:
    """Return all tables of the design, on the terminal stages and totals; None without one."""
    design = dict(result.design)
    if not design:
        return None
    stages = design.pop("stages", [])
    tables = [stage_table(stages, measures)] if stages else []
    found = tables_of("", design, measures)
    short = [*tables, *(table for table in found if table.name == "totals")]
    return Section(
        "Design",
        tables=[*tables, *_shares(stages, measures), *found],
        terminal=short if result.value is not None or result.status == "evaluated" else (),
    )


def stage_table(
    stages: Sequence[Mapping[str, Any]],
    measures: Measures,
    page_only: Collection[str] = PAGE_ONLY,
) -> Table:
    """Return the stages side by side; page_only: keys of rows that only the page shows."""
    heads = ["", *(f"stage {k}" for k in range(1, len(stages) + 1))]
    found, hidden = [], []
    for key, (words, unit) in STAGE_ROWS.items():
        if not all(key in s for s in stages):
            continue
        label = f"{words} [{measures.unit(unit)}]" if unit else words
        found.append([label, *(measures.of(s[key], unit) for s in stages)])
        if key in page_only:
            hidden.append(label)
        if key == MODULE and measures is INCH:
            pitches = [diametral_pitch(s[key]) for s in stages]
            found.append(["diametral pitch P_nd [1/in]", *pitches])
    return Table("stages", heads, found, page_only=hidden, across=True)


def ratio_tile(ratio: float, error_percent: float) -> Tile:
    """Return the total ratio and its error from the one that is asked for."""
    return Tile("total ratio", number(ratio), f"error {error_percent:+.3f} %")


def _shares(stages: Sequence[Mapping[str, Any]], measures: Measures) -> list[Table]:
    """Return volume and mass per stage; nothing to share out for one stage."""
    if len(stages) < 2 or not all("gear_volume_mm3" in s for s in stages):
        return []
    volumes = [s["gear_volume_mm3"] for s in stages]
    heads = ["", f"volume [{measures.unit('cm3')}]", "share, %"]
    columns = [
        [measures.of(v, "cm3") for v in volumes],
        [percent(v / sum(volumes)) for v in volumes],
    ]
    if all("mass_kg" in s for s in stages):
        heads.append(f"mass [{measures.unit('kg')}]")
        columns.append([measures.of(s["mass_kg"], "kg") for s in stages])
    rows = [[f"stage {k}", *cells] for k, cells in enumerate(zip(*columns, strict=True), 1)]
    return [Table("volume and mass", heads, rows)]


def trains(result: Result, measures: Measures) -> Section | None:
    """Return the best distinct trains in proven order; None where only one was asked for."""
    gears = (part for part in result.parts if part.name == "gears")
    best = next((one for one in (result, *gears) if len(one.report.get("trains", ())) > 1), None)
    if best is None:
        return None
    found, (name, unit), length = best.report["trains"], objective(best), measures.unit("mm")
    minimum = found[0]["objective"]
    goal, centres = (f"{name}\n{measures.unit(unit)}", f"centre distances\n{length}")
    names = {head.replace("\n", " "): head for head in (goal, centres)}
    rows = [_train_row(k, train, minimum, unit, measures) for k, train in enumerate(found, 1)]
    first, last = names
    heads = ("", first, "above the best, %", "ratio", "m_n, z1/z2", last)
    table = Table(
        "best trains", heads, rows, page_only=("above the best, %",), short=names, left=6, wrap=6
    )
    words = (
        "Distinct choices of teeth, each with its best modules and widths. The list is complete: "
        "no other train is better than the last one."
    )
    whole = best.proof.get("method") == "exhausted" and (best.gap or 0.0) <= EXACT
    words = words if whole else "The best trains of those evaluated; others may be better."
    short = (table,) if result.value is not None else ()
    return Section("Next best trains", words=(words,), tables=(table,), terminal=short)


def _train_row(
    rank: int, train: Mapping[str, Any], minimum: float, unit: str, measures: Measures
) -> list[Any]:
    stages, extra = train["stages"], 100.0 * (train["objective"] / minimum - 1.0)
    teeth = "  ".join(f"{s[MODULE]:g}, {s['pinion_teeth']}/{s['wheel_teeth']}" for s in stages)
    distances = [s["centre_distance_mm"] for s in stages]
    return [
        rank,
        measures.of(train["objective"], unit),
        Cell(extra, f"{extra:.2f}"),
        Cell(train["ratio"], f"{train['ratio']:.4f}"),
        teeth,
        Cell([measures.of(a, "mm") for a in distances], "  ".join(map(measures.length, distances))),
    ]


def tables_of(name: str, group: Mapping[str, Any], measures: Measures) -> list[Table]:
    """Return a table of the single values, then one for every list of records and every group."""
    found, single = [], []
    for key, value in group.items():
        if isinstance(value, Mapping):
            found += tables_of(heading(key, measures), value, measures)
        elif _records(value):
            found.append(records(heading(key, measures), value, measures))
        elif value is not None and value != []:
            single.append((heading(key, measures), _converted(key, value, measures)))
    return ([Table(name or "totals", ("", ""), single, name)] if single else []) + found


def _records(value: Any) -> bool:
    return isinstance(value, Sequence) and bool(value) and isinstance(value[0], Mapping)


def records(name: str, rows: Sequence[Mapping[str, Any]], measures: Measures) -> Table:
    """Return a row for every record, a column for every key."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    cells = [[_converted(key, row.get(key), measures) for key in keys] for row in rows]
    return Table(name, [heading(key, measures) for key in keys], cells, name)


def _converted(key: str, value: Any, measures: Measures) -> Any:
    """Return a value of a design in the unit that is shown."""
    unit = parted(key, measures)[1]
    if unit and isinstance(value, list):
        return [measures.of(v, unit) for v in value]
    return measures.of(value, unit) if unit and value is not None else value
