"""What the tables of a rating must agree on; what only a rating needs."""

from collections.abc import Iterator, Sequence
from typing import Any

from gearopt.physics.agma.allowables import CONTACT, bending_allowable, contact_allowable
from gearopt.physics.gears import MEMBERS
from gearopt.physics.iso6336.materials import SURFACE_HARDENED, strength
from gearopt.scenes.drive.drive_tables import Gears, StageTable
from gearopt.scenes.drive.rating.iso_material import steel
from gearopt.scenes.drive.rating.tables import (
    MATERIAL,
    GearTable,
    GivenTable,
    LoadTable,
    RatingTable,
    with_shared,
)
from gearopt.scenes.reading.fields import Table, refuse

Place = tuple[Any, ...]
NEED_HARDNESS = ("through-hardened",)  # of the life curves and the hardness ratio too
CYCLES = ("Y_N", "Z_N")  # factors that follow from the levels of a spectrum


def not_given(gears: Gears, stages: Sequence[StageTable]) -> Iterator[Place]:
    """Yield the places of what leaves gears open: a tooth number, module or width to be found."""
    if not stages:
        yield ("stage",)
    for k, stage in enumerate(stages):
        width = stage.face_width_over_diameter or gears.face_width_over_diameter
        fixed: Any = (stage.face_width,) * 2 if stage.face_width else width
        for name, ends in (
            ("module", stage.size),
            ("pinion_teeth", stage.pinion_teeth),
            ("wheel_teeth", stage.wheel_teeth),
            ("face_width", fixed),
        ):
            if ends is None or ends[0] != ends[1]:
                yield ("stage", k, name)


def check_given(gears: Gears, stages: Sequence[StageTable]) -> None:
    """Refuse a drive without limits and ratio whose gears are open: it can only be rated."""
    if place := next(not_given(gears, stages), None):
        held = stages and getattr(stages[place[1]], place[2])
        what = "is a range" if held else "is missing"
        rule = f"{what}: a rating takes given gears, and to size them takes [limits] and a ratio"
        raise refuse(rule, at=place, action="sample")


def check_unrated(gears: Gears, stages: Sequence[StageTable], load: Sequence[LoadTable]) -> None:
    """Refuse what changes nothing without a table [rating]."""
    for place in _only_rated(gears, stages, load):
        raise refuse("needs a table [rating]", at=place, action="remove")


def _only_rated(
    gears: Gears, stages: Sequence[StageTable], load: Sequence[LoadTable]
) -> Iterator[Place]:
    yield from [("load",)] * bool(load)
    tables: list[tuple[Place, Table]] = [(("gears",), gears)]
    for k, stage in enumerate(stages):
        yield from [("stage", k, "given")] * (stage.given != GivenTable())
        yield from [("stage", k, "pinion_hand")] * (stage.pinion_hand is not None)
        tables += [(("stage", k, member), getattr(stage, member)) for member in MEMBERS]
    for place, table in tables:
        yield from ((*place, n) for n in MATERIAL if getattr(table, n) is not None)


def check_rated(
    rating: RatingTable,
    gears: Gears,
    stages: Sequence[StageTable],
    load: Sequence[LoadTable],
) -> None:
    """Refuse a rating whose gears lack their strength, or whose loads do not fit together."""
    for k, stage in enumerate(stages or (StageTable(),)):
        given = rating.given.factors() | stage.given.factors()
        for name in CYCLES:
            if load and name in given:
                at = ("stage", k, "given") if getattr(stage.given, name) else ("rating", "given")
                rule = "follows from the levels [[load]] and cannot be given"
                raise refuse(rule, at=(*at, name), action="remove")
        _check_pinion(stage, k)
        for member in MEMBERS:
            own = getattr(stage, member)
            place = ("stage", k, member) if own.model_fields_set & set(MATERIAL) else ("gears",)
            gear = with_shared(own, gears)
            if rating.by_agma:
                _check_steel(gear, place, given)
            if rating.by_iso6336:
                _check_material(gear, place)
    total = sum(level.share for level in load)
    if load and total != 1:
        rest = load[-1].share + 1 - total
        rule = f"makes the shares of all levels {float(100 * total):.6g} %, not 100 %"
        write = f"{float(100 * rest):.6g} %" if 0 < rest <= 1 else None
        raise refuse(rule, write, ("load", len(load) - 1, "share"))


def _check_pinion(stage: StageTable, k: int) -> None:
    """Refuse given gears of which the wheel has fewer teeth."""
    pinion, wheel = stage.pinion_teeth, stage.wheel_teeth
    if pinion and wheel and wheel[1] < pinion[0]:
        rule = "is below pinion_teeth: the pinion is the gear with fewer teeth"
        raise refuse(rule, "pinion_teeth", ("stage", k, "wheel_teeth"), "swap")


def _check_material(gear: GearTable, place: Place) -> None:
    """Refuse a gear whose material has no strength in ISO 6336-5."""
    if gear.treatment is None and gear.iso_material is None:
        rule = "is missing: a rating needs the material of every gear (or give treatment)"
        raise refuse(rule, "Eh", (*place, "iso_material"), "sample")
    found = steel(gear)
    for stress in ("H", "F"):
        try:
            strength(found, stress)
        except ValueError as reason:
            key = "hardness" if found.name not in SURFACE_HARDENED else "flank_hardness"
            key = "iso_quality" if "quality" in str(reason) else key
            write = {"hardness": "240 HB", "flank_hardness": "600 HV", "iso_quality": "MQ"}[key]
            missing = key != "iso_quality"
            rule = f"is missing: {reason}" if missing else str(reason)
            raise refuse(rule, write, (*place, key), "sample") from None


def _check_steel(gear: GearTable, place: Place, given: dict[str, Any]) -> None:
    """Refuse a gear whose steel has no strength in the tables, unless that is given."""
    if gear.treatment is None:
        rule = "is missing: a rating needs the steel of every gear"
        raise refuse(rule, "through-hardened", (*place, "treatment"), "sample")
    hardness = gear.hardness.value if gear.hardness else 0.0
    if not hardness and gear.treatment in NEED_HARDNESS:
        rule = f"is missing: the strength of {gear.treatment} steel follows from it"
        raise refuse(rule, "240 HB", (*place, "hardness"), "sample")
    surfaces = {surface for treatment, surface, _ in CONTACT if treatment == gear.treatment}
    if gear.surface_hardness and surfaces == {""}:
        rule = f"changes nothing: of {gear.treatment} steel no strength depends on it"
        raise refuse(rule, at=(*place, "surface_hardness"), action="remove")
    grade = gear.grade or 1
    try:
        if "s_at" not in given:
            bending_allowable(gear.treatment, grade, hardness)
        if "s_ac" not in given:
            contact_allowable(gear.treatment, grade, hardness, gear.surface_hardness or "")
    except ValueError as reason:
        if "needs its hardness" in str(reason):
            rule = f"is missing: the strength of {gear.treatment} steel follows from its core"
            raise refuse(rule, "300 HB", (*place, "hardness"), "sample") from None
        key = "surface_hardness" if gear.surface_hardness and grade == 1 else "grade"
        known = str(reason).partition("; known: ")[2]
        rule = f'has no strength of "{gear.treatment}" in the tables'
        tell = f"Known: {known}; or give s_at and s_ac in [rating.given]"
        raise refuse(rule, tell, (*place, key), "tell") from None
