"""Checks of the tables of a rating, and of keys that only a rating needs."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from gearopt.formulations.strength import Law
from gearopt.physics.agma.allowables import CONTACT, IRONS, bending_allowable, contact_allowable
from gearopt.physics.agma.rating_factors import SURFACE_HARD_KINDS, Steel
from gearopt.physics.gears import MEMBERS
from gearopt.physics.iso6336.materials import SURFACE_HARDENED, strength
from gearopt.scenes.drive.face_widths import fixed_width
from gearopt.scenes.drive.rating.iso_material import SOFT_ROOTS, steel
from gearopt.scenes.drive.rating.materials import Named, choices
from gearopt.scenes.drive.rating.steels import chosen
from gearopt.scenes.drive.tables.drive import Gears, Objective, StageTable
from gearopt.scenes.drive.tables.iso6336 import ISO_KEYS, IsoTable, of_meshes
from gearopt.scenes.drive.tables.rating import (
    MATERIAL,
    OF_STAGE,
    STEEL,
    GearTable,
    GivenTable,
    LoadTable,
    RatingTable,
)
from gearopt.scenes.reading.choices import values_of
from gearopt.scenes.reading.fields import Table, refuse
from gearopt.scenes.reading.toml_writing import dotted

Place = tuple[Any, ...]
NEED_HARDNESS = ("through-hardened",)  # of the life curves and the hardness ratio too
AGMA = (  # keys of [rating] that only AGMA has
    *("edition", "reliability", "temperature", "quality", "accuracy", "mounting", "crowned"),
    *("adjusted", "pinion_offset", "size_factor", "bending_load", "service", "given"),
)
AGMA_KEYS = ("grade", "surface_hardness", "quality", "s_ac", "s_at")  # of gears
OWN_STRENGTH = (
    "Give sigma_Hlim and sigma_Flim, and an iso_material with its yield_strength, without steel"
)
NO_YIELD = {"Eh", "IF", "NT", "NV", "NV nitrocarburised", "GTS", "GG", "GGG ferritic"}
CORELESS = "changes nothing: only Eh of quality MQ has strengths by core"
YIELDLESS = "changes nothing: of surface-hardened steel no strength depends on it"
SMOOTHLESS = "changes nothing beside flank_rz, which the rating by ISO 6336 takes"
DRY = (
    "changes nothing: without oil_viscosity only C_H takes it, that of the pinion, where that is "
    "surface-hardened and the wheel through-hardened"
)
CYCLES = ("Y_N", "Z_N", "Y_NT", "Z_NT")  # factors that follow from the levels of a spectrum


def not_given(gears: Gears, stages: Sequence[StageTable]) -> Iterator[Place]:
    """Yield the places of open sizes: a tooth number, module or width to be found."""
    if not stages:
        yield ("stage",)
    for k, stage in enumerate(stages):
        width = stage.face_width_over_diameter or gears.face_width_over_diameter
        fixed: Any = (given,) * 2 if (given := fixed_width(stage)) else width
        first, second = stage.teeth_keys
        sizes: tuple[tuple[str, Any], ...] = (
            ("module", stage.size),
            (first, stage.pinion_teeth),
            (second, stage.wheel_teeth),
            ("face_width", fixed),
        )
        if first == "sun_teeth":
            more = stage.planets or (stage.counts[0],) * 2
            sizes += ("planet_teeth", stage.planet_teeth), ("planets", more)
        for name, ends in sizes:
            if ends is None or ends[0] != ends[1]:
                yield ("stage", k, name)


def check_given(gears: Gears, stages: Sequence[StageTable]) -> None:
    """Refuse a drive without limits and ratio whose gears are open: it can only be rated."""
    if place := next(not_given(gears, stages), None):
        held = stages and getattr(stages[place[1]], place[2])
        what = "is a range" if held else "is missing"
        rule = f"{what}: a rating takes given gears, and to size them takes [limits] and a ratio"
        raise refuse(rule, at=place, action="sample")


def check_sized(law: Law, own: Law, stages: Sequence[StageTable], ruled: Sequence[str]) -> None:
    """Refuse the keys that gears limited by ratings cannot have: processes, own load limits.

    law: what limits the loads beside ratings; own: of which stages have limits of their own; ruled:
    names of the processes asked for.
    """
    for k, stage in enumerate(stages):
        for name in own.names if not law.limits else ():
            if getattr(stage, name) is not None:
                rule = f"needs {name} in [limits], without which ratings alone limit the gears"
                raise refuse(rule, at=("stage", k, name), action="remove")
    for name in ruled if not law.limits else ():
        rule = f"is a process by {own.title}, which [limits] does not have (give preset)"
        raise refuse(rule, at=(name,), action="remove")


def check_unsized(own: Law, stages: Sequence[StageTable]) -> None:
    """Refuse load limits of given gears, which nothing sizes; own: the law of these limits."""
    for k, stage in enumerate(stages):
        for name in own.names:
            if getattr(stage, name) is not None:
                rule = "changes nothing: the gears are given"
                raise refuse(rule, at=("stage", k, name), action="remove")


def check_objective(
    asked: Objective, gears: Gears, stages: Sequence[StageTable], materials: Sequence[Named]
) -> None:
    """Refuse mass without densities, and cost without prices."""
    if asked.minimise not in ("mass", "cost"):
        return
    used = [
        one
        for stage in stages or (StageTable(),)
        for member in MEMBERS
        for _, one in choices(getattr(stage, member), gears, materials)
    ]
    if asked.minimise == "cost" and None in used:
        rule = "needs materials of every gear, with their prices in [[material]]"
        raise refuse(rule, "gear_volume", ("objective", "minimise"))
    for material in used:
        if asked.minimise == "cost" and material and material.price is None:
            at = ("material", materials.index(material), "price")
            raise refuse("is missing: cost needs it", at=at)
        if asked.density is None and (material is None or material.density is None):
            raise refuse(f"is missing: {asked.minimise} needs it", at=("objective", "density"))


def check_unrated(
    gears: Gears,
    stages: Sequence[StageTable],
    load: Sequence[LoadTable],
    materials: Sequence[Named],
    used: Sequence[str] = (),
) -> None:
    """Refuse keys that change nothing without a table [rating]; used: keys of gears that do."""
    if materials:
        raise refuse("needs a table [rating]", at=("material",), action="remove")
    for place in _only_rated(gears, stages, load):
        if place[-1] in used:
            continue
        raise refuse("needs a table [rating]", at=place, action="remove")


def _only_rated(
    gears: Gears, stages: Sequence[StageTable], load: Sequence[LoadTable]
) -> Iterator[Place]:
    yield from [("load",)] * bool(load)
    yield from [("gears", "same_materials")] * gears.same_materials
    tables: list[tuple[Place, Table]] = [(("gears",), gears)]
    for k, stage in enumerate(stages):
        yield from [("stage", k, "given")] * (stage.given != GivenTable())
        yield from [("stage", k, "given_iso6336")] * bool(stage.given_iso6336.factors())
        yield from [("stage", k, "idler")] * stage.idler
        for name in ("pinion_hand", *OF_STAGE):
            yield from [("stage", k, name)] * (getattr(stage, name) is not None)
        tables += [(("stage", k, member), getattr(stage, member)) for member in MEMBERS]
    for place, table in tables:
        yield from ((*place, n) for n in MATERIAL if getattr(table, n) is not None)


def check_rated(
    rating: RatingTable,
    gears: Gears,
    stages: Sequence[StageTable],
    load: Sequence[LoadTable],
    materials: Sequence[Named],
) -> None:
    """Refuse a rating whose gears lack their strength, or whose loads do not fit together."""
    _check_standard(rating, gears, stages)
    for name in of_meshes(rating.iso6336.given):
        rule = "has values of two meshes, which are of [stage.given_iso6336]"
        raise refuse(rule, at=("rating", "iso6336", "given", name), action="remove")
    _check_hands(gears, stages)
    if rating.by_iso6336:
        _check_needed("iso_core", CORELESS, _by_core, gears, stages, materials)
        _check_needed("yield_strength", YIELDLESS, _by_yield, gears, stages, materials)
    for k, stage in enumerate(stages or (StageTable(),)):
        given = rating.given.factors() | stage.given.factors()
        given_factors = rating.iso6336.given.factors() | stage.given_iso6336.factors()
        for name in CYCLES if load else ():
            if name in given or name in given_factors:
                rule = "follows from the levels [[load]] and cannot be given"
                raise refuse(rule, at=_given_at(rating, stage, k, name), action="remove")
        if rating.by_iso6336:
            _check_accuracy(rating, given_factors)
        for member in MEMBERS:
            table = getattr(stage, member)
            place = ("stage", k, member) if table.model_fields_set & set(MATERIAL) else ("gears",)
            for gear, material in choices(table, gears, materials):
                at = place if material is None else ("material", materials.index(material))
                if rating.by_agma:
                    _check_steel(gear, at, given)
                if rating.by_iso6336:
                    _check_material(gear, at, given_factors)
    _check_roughness(rating, gears, stages, materials)
    total = sum(level.share for level in load)
    if load and total != 1:
        rest = load[-1].share + 1 - total
        rule = f"makes the shares of all levels {float(100 * total):.6g} %, not 100 %"
        write = f"{float(100 * rest):.6g} %" if 0 < rest <= 1 else None
        raise refuse(rule, write, ("load", len(load) - 1, "share"))


def _given_at(rating: RatingTable, stage: StageTable, k: int, name: str) -> Place:
    """Return where a factor is given: for the stage (from 0), or for all."""
    places: list[tuple[Place, dict[str, Any]]] = [
        (("stage", k, "given"), stage.given.factors()),
        (("stage", k, "given_iso6336"), stage.given_iso6336.factors()),
        (("rating", "given"), rating.given.factors()),
        (("rating", "iso6336", "given"), rating.iso6336.given.factors()),
    ]
    return (*next(place for place, held in places if name in held), name)


def check_pinion(stage: StageTable, k: int, drives: bool = False, idle: bool = False) -> None:
    """Refuse given gears of which the wheel has fewer teeth.

    drives: it may be the one to drive; idle: one of them is an idler.
    """
    pinion, wheel = stage.pinion_teeth, stage.wheel_teeth
    if pinion and wheel and wheel[1] < pinion[0]:
        if stage.epicyclic:
            inner, ring = stage.teeth_keys
            rule = f"is below {inner}, whose gear runs within the ring"
            raise refuse(rule, inner, ("stage", k, ring), "swap")
        rule = "is below pinion_teeth: the pinion is the gear with fewer teeth"
        if idle:
            tell = "Rate each mesh as a pair, the idler with reversed_load = true"
            raise refuse(rule, tell, ("stage", k, "wheel_teeth"), "tell")
        rule += ', and driver = "wheel" says that the other one drives' * drives
        raise refuse(rule, "pinion_teeth", ("stage", k, "wheel_teeth"), "swap")


def _check_accuracy(rating: RatingTable, given: dict[str, Any]) -> None:
    """Refuse a rating by ISO 6336 without accuracy, unless what follows from it is given."""
    asked = rating.iso6336
    if asked.accuracy_grade is not None:
        return
    names = given.keys()
    pitch = names >= {"f_pb", "f_falpha"} or names >= {"K_v", "K_Halpha", "K_Falpha"}
    helix = "K_Hbeta" in names or (asked.helix_modification == "none" and "f_ma" in names)
    if not (pitch and helix):
        rule = "is missing (or give f_pb, f_falpha and f_ma in [rating.iso6336.given])"
        raise refuse(rule, 6, ("rating", "iso6336", "accuracy_grade"), "sample")


def _check_standard(rating: RatingTable, gears: Gears, stages: Sequence[StageTable]) -> None:
    """Refuse what changes nothing because its standard is not the one asked for, all at once."""
    if rating.standard == "both":
        return
    idle = _of_iso6336 if rating.standard == "agma" else _of_agma
    first, *others = [*idle(rating, gears, stages)] or [()]
    if not first:
        return
    other = "iso6336" if rating.standard == "agma" else "agma"
    rule = f'changes nothing with standard = "{rating.standard}", but with "{other}" or "both"'
    if not others:
        raise refuse(rule, at=first, action="remove")
    names = ", ".join(dotted(place) for place in others)
    raise refuse(
        f"{rule}; nor does {names}", 'Remove all, or write standard = "both"', first, "tell"
    )


def _of_iso6336(rating: RatingTable, gears: Gears, stages: Sequence[StageTable]) -> Iterator[Place]:
    yield from [("rating", "iso6336")] * (rating.iso6336 != IsoTable())
    yield from [("rating", "shaft")] * (rating.shaft is not None)
    for k, stage in enumerate(stages):
        yield from [("stage", k, "shaft")] * (stage.shaft is not None)
        yield from [("stage", k, "given_iso6336")] * bool(stage.given_iso6336.factors())
    yield from _written(gears, stages, ISO_KEYS)


def _of_agma(rating: RatingTable, gears: Gears, stages: Sequence[StageTable]) -> Iterator[Place]:
    yield from (("rating", name) for name in AGMA if name in rating.model_fields_set)
    for k, stage in enumerate(stages):
        yield from [("stage", k, "given")] * bool(stage.given.factors())
    yield from _written(gears, stages, AGMA_KEYS)


def _written(gears: Gears, stages: Sequence[StageTable], names: Sequence[str]) -> Iterator[Place]:
    """Yield the places of keys of gears."""
    tables: list[tuple[Place, Table]] = [(("gears",), gears)]
    for k, stage in enumerate(stages):
        tables += [(("stage", k, member), getattr(stage, member)) for member in MEMBERS]
    for place, table in tables:
        yield from ((*place, name) for name in names if getattr(table, name) is not None)


def _check_needed(
    name: str,
    rule: str,
    needed: Callable[[int, str, GearTable], bool],
    gears: Gears,
    stages: Sequence[StageTable],
    materials: Sequence[Named],
) -> None:
    """Refuse a key of gears at a place where it changes nothing of any gear.

    needed: whether the gear of a stage (from 0), a member, with a material, depends on it.
    """
    counts: dict[Place, bool] = {}
    for k, stage in enumerate(stages or (StageTable(),)):
        for member in MEMBERS:
            table = getattr(stage, member)
            for gear, material in choices(table, gears, materials):
                if getattr(gear, name) is None:
                    continue
                at: Place = ("gears", name)
                if material is not None and name in STEEL:
                    at = ("material", materials.index(material), name)
                elif getattr(table, name) is not None:
                    at = ("stage", k, member, name)
                counts[at] = counts.get(at, False) or needed(k, member, gear)
    for at, counted in counts.items():
        if not counted:
            raise refuse(rule, at=at, action="remove")


def _by_core(_stage: int, _member: str, gear: GearTable) -> bool:
    """Return whether the strength of a gear depends on its core, or its steel is missing."""
    known = gear.treatment is not None or gear.iso_material is not None
    return not known or steel(gear).by_core


def _by_yield(_stage: int, _member: str, gear: GearTable) -> bool:
    """Return whether Y_deltarelT depends on the yield strength, or the steel is missing."""
    known = gear.treatment is not None or gear.iso_material is not None
    return not known or steel(gear).name not in SURFACE_HARDENED


def _check_roughness(
    rating: RatingTable,
    gears: Gears,
    stages: Sequence[StageTable],
    materials: Sequence[Named],
) -> None:
    """Refuse the roughness R_a of gears for which neither friction nor a factor takes it."""
    if rating.standard == "iso6336":

        def rough(_stage: int, _member: str, gear: GearTable) -> bool:
            return gear.flank_rz is None

        _check_needed("roughness", SMOOTHLESS, rough, gears, stages, materials)
    if rating.standard != "agma" or rating.oil_viscosity is not None:
        return

    def of_ratio(stage: int, member: str, gear: GearTable) -> bool:
        """Whether C_H is that of a surface-hardened pinion and a through-hardened wheel."""
        wheel = (stages or (StageTable(),))[stage].wheel
        soft = (g.treatment in NEED_HARDNESS for g, _ in choices(wheel, gears, materials))
        kind = Steel(gear.treatment or "").kind
        return member == "pinion" and kind in SURFACE_HARD_KINDS and any(soft)

    _check_needed("roughness", DRY, of_ratio, gears, stages, materials)


def _check_hands(gears: Gears, stages: Sequence[StageTable]) -> None:
    """Refuse the hand of spur gears."""
    for k, stage in enumerate(stages):
        angle = gears.helix_angle if stage.helix_angle is None else stage.helix_angle
        spur = not any(one.number for one in values_of(angle))
        if stage.pinion_hand is not None and spur:
            rule = "is the hand of a helix, and these are spur gears"
            raise refuse(rule, at=("stage", k, "pinion_hand"), action="remove")


def _check_material(gear: GearTable, place: Place, given: dict[str, Any]) -> None:
    """Refuse a gear whose material has no strength in ISO 6336-5."""
    if gear.steel and gear.iso_material is None and gear.treatment != SOFT_ROOTS:
        rule = "has no class of ISO 6336-5"
        raise refuse(rule, OWN_STRENGTH, (*place, "steel"), "tell")
    if gear.treatment is None and gear.iso_material is None:
        rule = "is missing: a rating needs the material of every gear (or give treatment)"
        raise refuse(rule, "Eh", (*place, "iso_material"), "sample")
    _check_own(gear, place, given, ("sigma_Hlim", "sigma_Flim"))
    soft = not gear.iso_material and "sigma_Flim" not in given and not gear.sigma_Flim
    if gear.treatment == SOFT_ROOTS and soft:
        rule = "leaves the roots soft: ISO 6336-5 has the bending strength of hardened ones alone"
        tell = 'Give sigma_Flim in [rating.iso6336.given], or write treatment = "induction, roots"'
        raise refuse(rule, tell, (*place, "treatment"), "tell")
    material = steel(gear)
    for stress in ("H", "F"):
        if f"sigma_{stress}lim" in given:
            continue
        try:
            strength(material, stress)
        except ValueError as reason:
            key = "hardness" if material.name not in SURFACE_HARDENED else "flank_hardness"
            key = "iso_quality" if "quality" in str(reason) else key
            write = {"hardness": "240 HB", "flank_hardness": "600 HV", "iso_quality": "MQ"}[key]
            missing = key != "iso_quality"
            rule = f"is missing: {reason}" if missing else str(reason)
            raise refuse(rule, write, (*place, key), "sample") from None
    unknown = not material.strength_for_notches and material.family not in NO_YIELD
    if unknown and "Y_deltarelT" not in given:
        rule = f"is missing: Y_deltarelT of {material.name} follows from it (or give hardness)"
        raise refuse(rule, "500 MPa", (*place, "yield_strength"), "sample")


def _check_own(gear: GearTable, place: Place, given: dict[str, Any], names: Sequence[str]) -> None:
    """Refuse a strength of a gear's own beside the one that the file gives for both gears."""
    for name in names:
        if getattr(gear, name) is not None and name in given:
            rule = "changes nothing beside the factor that is given for both gears"
            raise refuse(rule, at=(*place, name), action="remove")


def _check_steel(gear: GearTable, place: Place, given: dict[str, Any]) -> None:
    """Refuse a gear whose steel has no strength in the tables, unless that is given."""
    _check_own(gear, place, given, ("s_ac", "s_at"))
    if gear.steel and gear.treatment is None:
        rule = "has no strength by AGMA 2001, which has tables by treatment and by ASTM classes"
        iron, tell = chosen(gear), 'Write standard = "iso6336" in [rating], or another steel'
        if iron and iron.us in IRONS:
            tell = f'Write treatment = "{iron.us}" instead of steel, or standard = "iso6336"'
        elif gear.iso_material is None:
            rule = "has neither a strength by AGMA 2001 nor a class of ISO 6336-5"
            tell = f'{OWN_STRENGTH}, and standard = "iso6336" in [rating]; or another steel'
        raise refuse(rule, tell, (*place, "steel"), "tell")
    if gear.treatment is None:
        rule = "is missing: a rating needs the steel of every gear (or give steel)"
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
        if "s_at" not in given and not gear.s_at:
            bending_allowable(gear.treatment, grade, hardness)
        if "s_ac" not in given and not gear.s_ac:
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
