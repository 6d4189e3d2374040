"""A REXS model as the tables of a drive whose gears are given: stages and rating."""

from collections.abc import Sequence
from itertools import pairwise

from gearopt.scenes.drive.rexs.flow import CASING, Step, bodies_of, in_order
from gearopt.scenes.drive.rexs.gears_read import (
    BETA,
    GEARS,
    GRADE,
    custom,
    flanks,
    gear_keys,
    material_of,
)
from gearopt.scenes.drive.rexs.loads_read import loads
from gearopt.scenes.drive.rexs.model import Component, Keys, Model, Said, keys_of, same, wrong
from gearopt.scenes.drive.rexs.places import places

OF_IDLER = (  # keys that are those of the wheel that it is
    *("module", "pinion_teeth", "pressure_angle", "helix_angle", "pinion_hand", "face_width"),
    "pinion",
)
TABLES = ("duty", "stage", "rating", "load", "objective")


def tables_of(model: Model, remarks: list[str]) -> Keys:
    """Tables of a drive; values that the file says are `Said`, so are samples of what it lacks."""
    bodies = bodies_of(model)
    shafts, path = in_order(model, bodies, remarks)
    if all(step.type == "parallel" for step, _ in path):
        remarks += places(model, bodies, list(shafts))
    unit = next(iter(model.of_type("gear_unit")), None)
    tables = loads(model, bodies, shafts, unit, remarks)
    tables["stage"] = _stages(model, path, remarks)
    steels = [c for step, _ in path for g in step.gears.values() for c in material_of(model, g)]
    known = [said for c in steels if (said := c.said("density"))]
    if len({said.value for said in known}) == 1:
        tables["objective"] = {"density": known[0]}
    tables["rating"] = _rating(model, unit, tables, remarks)
    return {key: tables[key] for key in TABLES if tables.get(key)}


def _stages(model: Model, path: Sequence[tuple[Step, bool]], remarks: list[str]) -> list[Keys]:
    """Tables of the stages in their order."""
    tables = [_stage(model, step, remarks) for step, _ in path]
    for table, (step, forwards) in zip(tables, path, strict=True):
        if not forwards:
            table["driver"] = Said("wheel", str(step.stage))
    for k, ((last, onwards), (step, forwards)) in enumerate(pairwise(path), 1):
        driven = list(last.gears.values())[-1 if onwards else 0]
        if driven is not list(step.gears.values())[0 if forwards else -1]:
            continue
        if not (onwards and forwards and step.type == "parallel"):
            rule = "is an idler of more teeth than the gear that it drives"
            raise wrong(driven, None, rule, "Rate each of its meshes as a pair")
        kept = {key: value for key, value in tables[k].items() if key not in OF_IDLER}
        tables[k] = kept | {"idler": Said(True, str(driven))}
    return tables


def _stage(model: Model, step: Step, remarks: list[str]) -> Keys:
    """The table of a stage."""
    gears, parallel = list(step.gears.values()), step.type == "parallel"
    gears[0].needed("normal_module")
    table: Keys = {} if parallel else {"type": step.type}
    for mesh in step.meshes:
        table = custom(mesh, "stage") | table
    if step.planets:
        table["planets"] = Said(len(step.planets), str(step.stage))
        table |= {"fixed": step.fixed} if step.fixed != "ring" else {}
    table["module"] = gears[0].said("normal_module")
    for member, gear in step.gears.items():
        table[f"{member}_teeth"] = gear.said("number_of_teeth")
    sides = [flank for gear in gears for flank in flanks(model, gear)]
    if (alpha := same(sides, "normal_pressure_angle")) is not None:
        table["pressure_angle"] = alpha[0].said("normal_pressure_angle")
    if (beta := gears[0].said(BETA)) and gears[0].number(BETA):
        table["helix_angle"] = Said(beta.value.lstrip("-"), beta.origin)
        if parallel:
            table["pinion_hand"] = "left" if beta.value.startswith("-") else "right"
    table |= keys_of(step.meshes, leave="" if step.planets else "mesh_load_factor")
    narrow = min(gears, key=lambda gear: gear.needed("face_width"))
    table["face_width"] = narrow.said("face_width")
    widths = {gear.number("face_width") for gear in gears}
    for member, gear in step.gears.items():
        table[member] = keys = gear_keys(model, gear, remarks)
        if parallel and gear.number("face_width") != narrow.number("face_width"):
            keys["face_width"] = gear.said("face_width")
    _check_planets(model, step)
    if not parallel and len(widths) > 1:
        remarks.append(f"{step.stage}: the narrowest face width is taken for all of its gears")
    return table


def _check_planets(model: Model, step: Step) -> None:
    """Refuse planets that are not alike."""
    first: Keys = {}
    for planet in step.planets:
        keys: Keys = {k: v.value for k, v in gear_keys(model, planet, []).items()}
        for name in ("normal_module", "number_of_teeth", "face_width"):
            keys[name] = planet.number(name)
        first = first or keys
        if differing := [k for k in first | keys if first.get(k) != keys.get(k)]:
            rule = f"differs from {step.planets[0]} in {', '.join(differing)}"
            raise wrong(planet, None, rule, "gearopt has planets that are alike")


def _rating(model: Model, unit: Component | None, tables: Keys, remarks: list[str]) -> Keys:
    """The table of the rating, with samples of what it needs and the file does not say."""
    rating: Keys = {"standard": Said("iso6336", "")} | custom(unit, "rating")
    held = rating.pop("iso6336", Said({}, ""))
    if not isinstance(iso := held.value, dict):
        raise wrong(held.origin, iso, "has no table as iso6336", "Remove the attribute")
    if tables["life"] is not None or "input_revolutions" not in rating:
        rating["life"] = tables["life"] or Said("20000 h", "", True)
    for owner in model.of_type(CASING, "cylindrical_stage"):
        for oil in model.related("reference", "origin", owner.id, "referenced", "lubricant"):
            iso = keys_of([oil]) | iso
    iso |= _relief(model, remarks)
    if rating["standard"].value == "agma":
        return rating
    gears = [g for stage in tables["stage"] for g in stage.values() if isinstance(g, dict)]
    if any(g.has(GRADE) for g in model.of_type(*GEARS)):
        iso["tolerances"] = "2013"
    if "accuracy_grade" not in iso and "accuracy" not in rating:
        grades = [g["accuracy_grade"] for g in gears if "accuracy_grade" in g]
        lacking = not grades or len(grades) < len(gears)
        coarsest = max(grades, key=lambda g: f"{g.value!s:>4}", default=None)
        iso["accuracy_grade"] = Said(6, "", True) if lacking else coarsest
    for g in gears:
        if not g.keys() & {"iso_material", "steel", "treatment"}:
            g["iso_material"] = Said("Eh", "", True)
    return rating | ({"iso6336": iso} if iso else {})


def _relief(model: Model, remarks: list[str]) -> Keys:
    """Tip relief of all flanks, where they have one; REXS has depths in mm."""
    reliefs = [c for c in model.of_type("tip_relief") if c.has("tip_relief_depth")]
    if not reliefs:
        return {}
    known = {c.number("tip_relief_depth") for c in reliefs}
    if len(known) == 1 and len(reliefs) >= len(model.of_type(*GEARS)):
        return keys_of(reliefs)
    remarks.append("tip_relief: it is not the same at all flanks, and is left out")
    return {}
