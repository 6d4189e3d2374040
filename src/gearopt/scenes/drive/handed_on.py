"""The gears of a drive, or of one of its stages, as the tables of a file that takes them."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.drive.train import STEEL_DENSITY
from gearopt.physics.gears import ISO_53_A, MEMBERS
from gearopt.scenes.drive.rating.gears import gear_tables, required_hours
from gearopt.scenes.drive.rating.materials import names
from gearopt.scenes.drive.stage_types import held_as
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.drive.tables.rating import MATERIAL, OF_STAGE, GearTable
from gearopt.scenes.explaining.numbers import content
from gearopt.scenes.parts import Duty
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import refuse
from gearopt.scenes.reading.handed_on import STAGE, HandedOn, Place, every, takes
from gearopt.scenes.reading.linked_files import Input
from gearopt.units import Quantity, parse

HANDED = ("duty", "gears", "stage", "rating", "material", "load", "objective")  # tables
SIZING = ("limits", "teeth", "shift", "layout", "place", "keep_out", "stages")  # of chosen gears
PROCESSES = ("process_one", "process_two")
SHARED = {  # keys of [gears] that a stage has as numbers of its own
    *("from", "stage", "helix_angle", "pressure_angle", "face_width_over_diameter"),
    *("face_width_step", "face_width_over_module", "minimum_face_width", "same_materials"),
    *("materials", "pinion_face_width_excess"),
}
KEPT = (*OF_STAGE, "pinion_hand", "given", "given_iso6336", "pressure_angle", "pinion", "wheel")
PRICELESS = {"price": None, "treatment_price": Fraction(0), "cutting_price": Fraction(0)}
SHIFTS = ("profile_shift", "tip_alteration")
RATED_ALONE = {*MATERIAL, *OF_STAGE, "pinion_hand", "given", "given_iso6336"}
USUAL: dict[str, Any] = {  # what a gear has that a file says nothing of
    "addendum": ISO_53_A.addendum,
    "tool_addendum": ISO_53_A.dedendum,
    "tool_tip_radius": ISO_53_A.tip_radius,
    **dict.fromkeys(("tool_protuberance", "grinding_allowance", "tip_chamfer"), 0.0),
    "thickness_allowance": parse("0 mm", "length"),
    "bore": parse("0 mm", "length"),
    "contacts": 1,
    "reversed_load": False,
}


def stages_of(source: Input, number: int | None, ask: Ask) -> HandedOn:
    """The drive that a file takes from another one: all of its stages, or one."""
    return _handed(source, number, ask, number is None)


def stage_of(source: Input, number: int | None, ask: Ask) -> HandedOn:
    """The stage that a pair takes from another file."""
    return _handed(source, number, ask, False)


def _handed(source: Input, number: int | None, ask: Ask, whole: bool) -> HandedOn:
    """Tables of a drive (whole) or of a stage, counted from 1, of a file that is solved."""
    design = drive_design(source.result(ask).design)
    drive: Any = source.scene
    types = [{"type": stage.type} for stage in design.stages]
    drive = held_as(drive.drive if source.kind == "pair" else drive, {"stages": types})
    count = len(design.stages)
    if not whole:
        number = number or (1 if count == 1 else None)
        if number is None or number > count:
            known = " and ".join(map(str, range(1, count + 1)))
            has = f"{source.file} has stage{'s' * (count > 1)} {known}"
            rule = f"is missing: {has}" if number is None else f"is none of its stages: {has}"
            raise refuse(rule, count, STAGE, "sample", "stage")
    places = range(count) if whole else [number - 1] if number else []
    for k in places:
        _check(design.stages[k], f"stage {k + 1} of {source.file}", whole)
    slower = Fraction(1)
    for stage in design.stages[: places[0]]:
        slower *= _ratio(stage)
    stages = [design.stages[k] for k in places]
    of = source.file if whole or count == 1 else f"stage {number} of {source.file}"
    tables: dict[str, Any] = {"gears": _shared(drive.gears), "stage": []}
    follows: dict[Place, Any] = {}
    _add_duty(drive, stages, slower, whole, tables, follows)
    used = set[str]()
    for at, k in enumerate(places):
        table = drive.stage_tables[k]
        tables["stage"].append(_stage(drive, table, design.stages[k], used))
        follows |= _known(drive, table, k, design.stages[k], at)
    _add_rating(drive, slower, tables, follows, used)

    def own_key(place: Place) -> bool:
        if drive.rating is None and (
            place[0] in ("rating", "load", "material") or {*place} & RATED_ALONE
        ):
            return True
        return place[0] not in (*HANDED, *SIZING, *PROCESSES)

    def spread(place: Place) -> Iterator[Place]:
        if place[0] != "gears" or len(place) != 2:
            yield place
        elif place[1] in GearTable.model_fields:
            yield from (("stage", at, m, place[1]) for at in range(len(places)) for m in MEMBERS)
        else:
            yield from (("stage", at, place[1]) for at in range(len(places)))

    return HandedOn(of, tables, follows, own_key, spread)


def _check(stage: StageDesign, called: str, whole: bool) -> None:
    """Refuse a stage that is no pair of two gears of its own."""
    lacks = {
        f"is a {stage.type} stage": stage.type == "planetary",
        "has a ring": stage.type == "internal",
        "has an idler, the wheel of the stage before": stage.idler,
        "is driven by its wheel": stage.driver == "wheel" and not whole,
        "has no whole teeth, as its file has no table [teeth]": any(
            z != round(z) for z in (stage.pinion_teeth, stage.wheel_teeth)
        ),
    }
    for words, lacking in lacks.items():
        if lacking:
            write = "Take another stage; `gearopt rate` takes the kept result of a whole drive, too"
            place = ("gears", "from") if whole else STAGE
            raise refuse(f"takes gears that are no pair: {called} {words}", write, place, "tell")


def _ratio(stage: StageDesign) -> Fraction:
    """Input over output speed of a stage; of a pair that of its numbers of teeth."""
    ratio = Fraction(stage.ratio)
    if stage.type == "parallel":
        ratio = Fraction(stage.wheel_teeth) / Fraction(stage.pinion_teeth)
    return ratio if stage.driver == "pinion" else 1 / ratio


def _add_duty(
    drive: Any,
    stages: list[StageDesign],
    slower: Fraction,
    whole: bool,
    tables: dict[str, Any],
    follows: dict[Place, Any],
) -> None:
    """Add the duty at the input of stages; slower: speed of the drive's input over theirs."""
    duty: Duty = drive.duty
    speed = replace(duty.input_speed, number=duty.input_speed.number / slower)
    load = duty.power or replace(duty.torque, number=duty.torque.number * slower)  # type: ignore
    ratio = Fraction(1)
    for stage in stages:
        ratio *= _ratio(stage)
    alone = {duty.load_key: load, "input_speed": speed}
    tables["duty"] = content(duty, False) if whole else alone
    values: dict[str, Any] = {
        "power": Quantity(Fraction(duty.input_power) / 1000, "W", "power"),
        "torque": Quantity(Fraction(duty.input_torque) * slower, "N mm", "torque"),
        "input_speed": speed,
        "output_speed": replace(speed, number=speed.number / ratio),
        "ratio": ratio,
        duty.load_key: load,
    }
    if whole:
        values["ratio_tolerance"] = duty.ratio_tolerance
        values |= {n: v for n, v in duty if n in ("ratio", "output_speed") and v is not None}
    follows |= {("duty", name): value for name, value in values.items()}


def _shared(gears: Gears) -> dict[str, Any]:
    return {k: v for k, v in content(gears, False).items() if k not in SHARED}


def _sizes(stage: StageDesign) -> dict[str, Any]:
    """The sizes of a stage that its own table gives."""
    return {
        "module": _of(stage.normal_module_mm, "mm", "module"),
        "pinion_teeth": int(stage.pinion_teeth),
        "wheel_teeth": int(stage.wheel_teeth),
        "face_width": _of(stage.face_width_mm),
        "helix_angle": _of(stage.helix_angle_deg, "deg", "angle"),
        "pressure_angle": _of(stage.pressure_angle_deg, "deg", "angle"),
        "centre_distance": _of(stage.centre_distance_mm),
        "driver": stage.driver,
    }


def _stage(drive: Any, asked: StageTable, stage: StageDesign, used: set[str]) -> dict[str, Any]:
    """The table of a stage; used: names of materials, to which its own are added."""
    table = {k: v for k, v in content(asked, False).items() if k in KEPT} | _sizes(stage)
    if asked.pinion.face_width or asked.wheel.face_width:
        table["face_width"] = asked.face_width
    elif excess := asked.pinion_face_width_excess or drive.gears.pinion_face_width_excess:
        table["pinion_face_width_excess"] = excess
    if stage.working_pressure_angle_deg is None:
        del table["centre_distance"]
    if stage.driver == "pinion":
        del table["driver"]
    for member in MEMBERS:
        gear = {k: v for k, v in table.get(member, {}).items() if k != "materials"}
        for name in SHIFTS:
            gear.pop(name, None)
            if value := getattr(stage, f"{member}_{name}"):
                gear[name] = Fraction(value)
        if known := names(getattr(asked, member), drive.gears):
            gear["materials"] = [getattr(stage, f"{member}_material") or known[0]]
            used.update(gear["materials"])
        table[member] = gear
    return {name: value for name, value in table.items() if value is not None}


def _known(drive: Any, asked: StageTable, k: int, stage: StageDesign, at: int) -> dict[Place, Any]:
    """What is known of a stage (from 0), which stands at a place of the file that takes it."""
    m, b, d = stage.normal_module_mm, stage.face_width_mm, stage.pinion_diameter_mm
    values = _sizes(stage) | {"type": "parallel", "idler": False}
    values["diametral_pitch"] = Fraction(25.4 / m)
    values["face_width_over_diameter"] = Fraction(b / d)
    values["face_width_over_module"] = Fraction(b / m)
    for name in OF_STAGE if drive.rating is not None else ():
        value = getattr(asked, name)
        values[name] = getattr(drive.rating, name) if value is None and name != "shaft" else value
    held: dict[Place, Any] = {("stage", at, name): value for name, value in values.items()}
    chosen = stage.pinion_material, stage.wheel_material
    tables = gear_tables(asked, drive.gears, drive.material, k, chosen)
    for member, gear in zip(MEMBERS, tables, strict=True):
        rows = {n: USUAL.get(n) if value is None else value for n, value in gear}
        rows |= {name: Fraction(getattr(stage, f"{member}_{name}")) for name in SHIFTS}
        rows["face_width"] = _of(getattr(stage, f"{member}_face_width_mm") or b)
        for name, value in rows.items():
            if value is not None or drive.rating is not None or name not in MATERIAL:
                held["stage", at, member, name] = value
    return held


def _add_rating(
    drive: Any,
    slower: Fraction,
    tables: dict[str, Any],
    follows: dict[Place, Any],
    used: set[str],
) -> None:
    """Add rating, materials, loads and density; slower: as of `_add_duty`."""
    density = drive.objective.density
    usual = Quantity(Fraction(STEEL_DENSITY) * 10**12, "kg/m^3", "density")
    follows["objective", "density"] = density or usual
    if density:
        tables["objective"] = {"density": density}
    if drive.rating is None:
        return
    rating = drive.rating
    if rating.input_revolutions is not None:
        turns = rating.input_revolutions / slower
        rating = rating.model_copy(update={"input_revolutions": turns})
    tables["rating"] = content(rating, False)
    follows |= dict(every(rating, ("rating",)))
    hours = required_hours(drive.rating, drive.duty)
    follows["rating", "life"] = Quantity(Fraction(hours), "h", "time")
    if rating.accuracy is not None or rating.quality is not None:
        a, q = rating.accuracy, rating.quality
        follows["rating", "accuracy"], follows["rating", "quality"] = a or 17 - q, q or 17 - a
    chosen = [row for row in drive.material if row.name in used]
    listed = [row.model_copy(update=PRICELESS) for row in chosen]
    levels = []
    for level in drive.load:
        at = level.input_speed
        at = at and replace(at, number=at.number / slower)
        levels.append(level.model_copy(update={"input_speed": at}))
    for table, rows in (("material", listed), ("load", levels)):
        tables |= {table: [content(row, False) for row in rows]} if rows else {}
        for k, row in enumerate(rows):
            follows |= dict(every(row, (table, k)))


def _of(value: float, unit: str = "mm", dimension: str = "length") -> Quantity:
    return Quantity(Fraction(repr(value)), unit, dimension)


TAKES_DRIVE, TAKES_STAGE = takes(stages_of), takes(stage_of)
