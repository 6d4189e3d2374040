"""The numbers of a design as tables: its stages, and whatever lists and groups it holds."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, fields
from itertools import zip_longest
from typing import Any

from gearopt.formulations.drive.design import StageDesign
from gearopt.formulations.strength.laws import laws
from gearopt.optimise.result import Result
from gearopt.physics.planetary.willis import simple_set
from gearopt.report.measures import DIGITS, Measures, error_of, rounded
from gearopt.report.section import ABSENT, Cell, Section, Table, Tile, cell, listed_fields, percent
from gearopt.report.words import EXACT, MODULE, heading, is_module, objective, parted, teeth_of

VOLUME = "gear_volume_mm3"
SIZES = {it.key: (it.label, it.unit) for it in listed_fields(StageDesign)}
AFTER_LIMITS = [*SIZES][[*SIZES].index(VOLUME) :]
STAGE_ROWS = {  # what a key is called, and its unit
    MODULE: ("", ""),  # see `Measures.module`
    **{key: named for key, named in SIZES.items() if key not in AFTER_LIMITS},
    **{limit.design_key: (limit.label, limit.unit) for law in laws() for limit in law.limits},
    **{key: SIZES[key] for key in AFTER_LIMITS},
}
OF_TEETH = {f.name: f.default for f in fields(StageDesign) if f.default is not MISSING}
DRIVER = "driver"
OF_FILE = ("helix_angle_deg", "pressure_angle_deg")  # said by the file where stages are alike
SHARE = "share of the volume, %"
PAGE_ONLY = {
    *("pinion_tip_diameter_mm", "wheel_tip_diameter_mm"),
    *("pinion_root_diameter_mm", "wheel_root_diameter_mm"),
    *("transverse_contact_ratio", "overlap_ratio", "pitch_line_velocity_m_per_s"),
    *("pinion_mass_kg", "wheel_mass_kg", "mass_kg"),
}
EXACT_RATIO = 1e-11  # relative error of a ratio below which it is rounding
MATES = {
    "parallel": ("pinion", "wheel"),
    "planetary": ("sun", "planet"),
    "internal": ("pinion", "ring"),
}
OF_RINGS = tuple(key for key in SIZES if key.startswith("ring_") and "outside" not in key)
OF_SETS = "sun_teeth", "planet_teeth"  # the teeth z1 and z2 of planetary stages
OF_LINES = "sum_of_centre_distances_mm", "total_length_mm"  # of shafts beside each other
LISTED = {"between": ("from", "to")}  # lists of as many values: what each is called


def teeth_head(measures: Measures) -> str:
    """The head of a column of modules and teeth, for reading."""
    return "{1} [{2}], z1/z2".format(*measures.module)


def teeth_heads(measures: Measures) -> tuple[str, str, str]:
    """The heads of the same each in a column, in the CSV."""
    return measures.module[1], "z1", "z2"


def design_section(result: Result, measures: Measures) -> Section | None:
    """All tables of the design, on the terminal stages and totals; None without one."""
    design = dict(result.design)
    if not design:
        return None
    stages = design.pop("stages", [])
    if types(stages) - {"parallel"}:
        design = {key: value for key, value in design.items() if key not in OF_LINES}
    chosen = result.report.get("chosen", ())
    shown = [stage_table(stages, measures, chosen=chosen)] if stages else []
    shown += tables_of("", design, measures)
    short = [table for table in shown if table.name in ("stages", "totals", "costs")]
    known = result.value is not None or result.given
    return Section("Design", tables=shown, terminal=short if known else ())


def types(stages: Sequence[Mapping[str, Any]]) -> frozenset[str]:
    """Types of stages."""
    return frozenset(stage.get("type", "parallel") for stage in stages)


def stage_table(
    stages: Sequence[Mapping[str, Any]],
    measures: Measures,
    page_only: Collection[str] = PAGE_ONLY,
    chosen: Collection[str] = (),
) -> Table:
    """The stages side by side; page_only: keys of rows that only the page shows.

    chosen: keys of the teeth that were chosen from several of the file.
    """
    heads = ["", *(f"stage {k}" for k in range(1, len(stages) + 1))]
    rows, hidden, absent = [], [], False
    for key, (_, unit) in STAGE_ROWS.items():
        every_stage = _own_teeth(key, stages) if key in OF_TEETH else all(key in s for s in stages)
        if not (every_stage or key in chosen) or key in OF_SETS:
            continue
        if key in OF_RINGS and "planetary" not in types(stages):  # the ring is the wheel
            continue
        label = stage_label(key, measures, types(stages))
        if key == MODULE:
            rows.append([label, *(measures.of_module(s[key]) for s in stages)])
            continue
        values = [driving(s) if key == DRIVER else s.get(key, OF_TEETH.get(key)) for s in stages]
        absent = absent or None in values
        rows.append(
            [label, *(Cell(v, ABSENT) if v is None else cell(v, unit, measures) for v in values)]
        )
        if key in page_only:
            hidden.append(label)
        if key == VOLUME and len(stages) > 1:
            whole = sum(s[key] for s in stages)
            rows.append([SHARE, *(percent(s[key] / whole) for s in stages)])
    caption = f"{ABSENT}: the gear has none." if absent else ""
    return Table("stages", heads, rows, caption, page_only=[*hidden, SHARE], across=True)


def driving(stage: Mapping[str, Any]) -> str:
    """The gear, or the carrier, that drives a stage."""
    kind, driver = stage.get("type", "parallel"), str(stage.get(DRIVER, OF_TEETH[DRIVER]))
    if kind == "planetary":
        return simple_set(stage["fixed"], driver != "pinion").source
    return MATES[kind][MATES["parallel"].index(driver)]


def _own_teeth(key: str, stages: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a key of the teeth, or the mate's, says more than its default or the file.

    Of blanks one that says anything.
    """
    if OF_TEETH[key] is None:
        return any(s.get(key) is not None for s in stages)
    both = key, key.replace("pinion", "wheel"), key.replace("wheel", "pinion")
    values = {s.get(name, OF_TEETH[key]) for s in stages for name in both}
    return len(values) > 1 or not (key in OF_FILE or values == {OF_TEETH[key]})


def stage_label(key: str, measures: Measures, kinds: Collection[str] = ("parallel",)) -> str:
    """Label of a key of a stage, with its unit; kinds: types of the stages that stand beside."""
    if key == MODULE:
        return "{} {} [{}]".format(*measures.module)
    words, unit = STAGE_ROWS.get(key, (key, ""))
    member, *_ = key.split("_")
    if {*kinds} != {"parallel"} and member in MATES["parallel"]:
        named = dict.fromkeys(
            MATES[kind][MATES["parallel"].index(member)] for kind in sorted(kinds)
        )
        words = f"{words.replace(f'{member} ', '')} of the {' or '.join(named)}"
    elif key == "mass_kg" and {*kinds} != {"parallel"}:
        words = "mass of the gears"
    elif key == DRIVER and "planetary" in kinds:
        words = "driving member"
    return f"{words} [{measures.unit(unit)}]" if unit else words


def ratio_text(ratio: float, error_percent: float) -> str:
    """A ratio with the digits that tell its error from the ratio asked for, to a tenth of it."""
    error, digits = abs(ratio * error_percent) / 100.0, DIGITS
    if error > EXACT_RATIO * ratio:
        digits += max(
            0, math.ceil(1.0 - math.log10(error)) + math.floor(math.log10(ratio)) + 1 - digits
        )
    return rounded(ratio, digits)


def ratio_tile(ratio: float, error_percent: float) -> Tile:
    """The total ratio and its error from the one that is asked for."""
    return Tile("total ratio", ratio_text(ratio, error_percent), f"error {error_of(error_percent)}")


def trains(result: Result, measures: Measures) -> Section | None:
    """The best distinct trains in proven order; None where only one was asked for."""
    gears = (part for part in result.parts if part.name == "gears")
    best = next(
        (
            candidate
            for candidate in (result, *gears)
            if len(candidate.report.get("trains", ())) > 1
        ),
        None,
    )
    if best is None:
        return None
    ranked, (name, unit) = best.report["trains"], objective(best)
    minimum, stages = ranked[0]["objective"], max(len(train["stages"]) for train in ranked)
    length = measures.unit("mm")
    goal, centres = (
        f"{name}\n[{measures.unit(unit)}]" if unit else name,
        f"centre distances\n[{length}]",
    )
    names = {head.replace("\n", " "): head for head in (goal, centres)}
    single = [
        f"{words} {k}" for k in range(1, stages + 1) for words in (*teeth_heads(measures), "a")
    ]
    single = [f"{h} [{length}]" if h[0] == "a" else h for h in single]
    teeth = teeth_head(measures)
    if any(stage.get("ring_teeth") for train in ranked for stage in train["stages"]):
        teeth += "/z_r"
    rows = [_train_row(k, train, minimum, unit, measures) for k, train in enumerate(ranked, 1)]
    widest = max(len(row) for row in rows)
    rows = [row + [""] * (widest - len(row)) for row in rows]  # of trains of fewer stages
    first, last = names
    heads = ("", first, "above the best, %", "ratio", teeth, last, *single)
    table = Table(
        "best trains",
        heads,
        rows,
        page_only=("above the best, %",),
        csv_only=single,
        read_only=(teeth, last),
        short=names,
        left=6,
        wrap=6,
    )
    has = "modules and face widths"
    if "helix_angle_deg" in best.report.get("chosen", ()):
        has = "modules, helix angles and face widths"
    words = (
        f"The trains differ in their teeth; each has its best {has}. The list is complete: no "
        "other train is better than the last one."
    )
    whole = best.proof.get("method") == "exhausted" and (best.gap or 0.0) <= EXACT
    words = words if whole else "The best trains of those evaluated; others may be better."
    short = (table,) if result.value is not None else ()
    return Section(
        "Next best trains", words=(words,), tables=(table,), terminal=short, appendix=True
    )


def _train_row(
    rank: int, train: Mapping[str, Any], minimum: float, unit: str, measures: Measures
) -> list[Any]:
    stages, extra = train["stages"], 100.0 * (train["objective"] / minimum - 1.0)
    gears = [(measures.of_module(s[MODULE]), s["pinion_teeth"], s["wheel_teeth"]) for s in stages]
    rows = zip(gears, stages, strict=True)
    teeth = "; ".join(f"{m:g}, {teeth_of(stage)}" for (m, *_), stage in rows)
    sizes = [cell(s["centre_distance_mm"], "mm", measures) for s in stages]
    single = [value for gear, size in zip(gears, sizes, strict=True) for value in (*gear, size)]
    return [
        rank,
        cell(train["objective"], unit, measures),
        Cell(extra, f"{extra:.2f}"),
        train["ratio"],
        teeth,
        Cell(None, "  ".join(size.text for size in sizes)),
        *single,
    ]


def tables_of(name: str, group: Mapping[str, Any], measures: Measures) -> list[Table]:
    """A table of the single values, then one for every list of records and every group.

    Several values of a key stand side by side.
    """
    lists, single = [], []
    for key, value in group.items():
        if isinstance(value, Mapping):
            lists += tables_of(heading(key, measures), value, measures)
        elif _records(value):
            lists.append(records(heading(key, measures), value, measures))
        elif key == "ratio" and "ratio_error_percent" in group:
            text = ratio_text(value, group["ratio_error_percent"])
            single.append([heading(key, measures), Cell(value, text)])
        elif value is not None and value != []:
            single.append([heading(key, measures), *_cells(key, value, measures)])
    if not single:
        return lists
    rows = list(zip(*zip_longest(*single, fillvalue=""), strict=True))
    heads = [""] * len(rows[0])
    return [Table(name or "totals", heads, rows, name), *lists]


def _records(value: Any) -> bool:
    return isinstance(value, Sequence) and bool(value) and isinstance(value[0], Mapping)


def records(
    name: str,
    rows: Sequence[Mapping[str, Any]],
    measures: Measures,
) -> Table:
    """A row for every record, a column for every key."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    heads = [h for key in keys for h in LISTED.get(key, (heading(key, measures),))]
    cells = [[c for key in keys for c in _cells(key, row.get(key), measures)] for row in rows]
    return Table(name, heads, cells, name)


def _cells(key: str, value: Any, measures: Measures) -> list[Cell]:
    """A value of a design in the unit that is shown, or each of several."""
    unit = parted(key, measures)[1]
    values = value if isinstance(value, list | tuple) else [value]
    if is_module(key):
        values = list(map(measures.of_module, values))
    return [cell(_joined(v), unit, measures) for v in values]


def _joined(value: Any) -> Any:
    """Several numbers as words: those of stages in one plane."""
    return " and ".join(map(str, value)) if isinstance(value, list | tuple) else value
