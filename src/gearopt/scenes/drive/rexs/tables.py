"""A REXS model as the tables of a drive whose gears are given: gears, stages, rating."""

import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from itertools import pairwise
from typing import Any

from gearopt.physics.gears import ISO_53_A
from gearopt.physics.iso6336.materials import SURFACE_HARDENED
from gearopt.scenes.drive.rexs.flow import CASING, Step, bodies_of, in_order, places
from gearopt.scenes.drive.rexs.loads_read import loads
from gearopt.scenes.drive.rexs.model import (
    BETA,
    GEARS,
    Component,
    Keys,
    Model,
    Said,
    in_unit,
    keys_of,
    rounded,
    same,
    wrong,
)

GRADE = "global_tolerance_class_iso_1328_2013"
GRADES = re.compile(r"[0-9]{1,3}")
ALLOWANCES = tuple(f"{end}_backlash_allowance_referenced_to_span" for end in ("upper", "lower"))
SHIFTS = ("addendum_modification_coefficient", "addendum_modification")
FLANKS = ("left", "right")
TOOLS = ("rack_shaped_tool", "cutter_wheel_tool")
TREATED = tuple(f"heat_treated_material_type_iso_6336_{year}" for year in ("2019", "2006"))
MATERIALS = {  # of ISO 6336-5, by the type of REXS; the first is taken
    "case_hardened_wrought_steel": ("Eh",),
    "through_hardened_wrought_steel": ("V alloy", "V carbon"),
    "through_hardened_cast_steel": ("V cast alloy", "V cast carbon"),
    "flame_or_induction_hardened_steel": ("IF",),
    "nitrided_steel": ("NT",),
    "nitrided_through_hardened_steel": ("NV",),
    "nitrocaburized_wrought_steel": ("NV nitrocarburised",),
    "normalized_wrought_low_carbon_steel": ("St",),
    "normalized_cast_steel": ("St cast",),
    "grey_cast_iron": ("GG",),
    "black_malleable_cast_iron": ("GTS",),
    "nodular_cast_iron_perlitic_or_bainitic_structure": ("GGG",),
    "nodular_cast_iron_ferritic_structure": ("GGG ferritic",),
}
CUSTOM = "custom_gearopt_"  # attributes with tables in TOML: keys that REXS has no attribute for


def custom(component: Component | None, name: str) -> Keys:
    """Keys of gearopt's own attribute of a component, none where it has none."""
    text = component.word(CUSTOM + name) if component else None
    if component is None or text is None:
        return {}
    at = component.at(CUSTOM + name)
    try:
        table = tomllib.loads(f"table = {text}", parse_float=Decimal)
    except (tomllib.TOMLDecodeError, RecursionError):
        table = {}
    keys = table.get("table")
    if not isinstance(keys, dict) or len(table) > 1:
        raise wrong(at, text, "is no table in TOML", "Remove the attribute")
    return {key: Said(value, at) for key, value in keys.items()}


def flanks(model: Model, gear: Component) -> list[Component]:
    """The flanks of a gear: left and right, one of both, or none."""
    sides = [f for side in FLANKS for f in model.related("flank", "gear", gear.id, side)]
    for odd in (f for f in sides if f.type != "cylindrical_gear_flank"):
        raise wrong(odd, None, f"is no flank of {gear}", "Correct the relation of type flank")
    return sides


def material_of(model: Model, gear: Component) -> list[Component]:
    """The material of a gear, or none."""
    return model.related("reference", "origin", gear.id, "referenced", "material")


def gear_keys(model: Model, gear: Component, remarks: list[str]) -> Keys:
    """Keys of a gear, but its module, teeth, helix and width."""
    sides, m = flanks(model, gear), gear.needed("normal_module")
    kept, teeth = custom(gear, "gear"), keys_of(sides, m=m)
    if not any(flank.has(name) for flank in sides for name in SHIFTS):
        remarks.append(f"{gear}: no profile shift is said: 0 is taken")
    addendum = teeth["addendum"].value if "addendum" in teeth else Decimal(repr(ISO_53_A.addendum))
    if addendum == Decimal(repr(ISO_53_A.addendum)):
        teeth.pop("addendum", None)
    shift = teeth["profile_shift"].value if "profile_shift" in teeth else Decimal(0)
    k = _tip_alteration(gear, m, shift, addendum, remarks)
    if k and "tip_alteration" not in kept:
        teeth["tip_alteration"] = Said(k, gear.at("tip_diameter"))
    keys = kept | teeth | _thinner(gear, sides) | _tool(model, gear, sides, remarks)
    keys |= keys_of([gear])
    if (grade := gear.word(GRADE)) is not None:
        keys["accuracy_grade"] = Said(
            int(grade) if GRADES.fullmatch(grade) else grade, gear.at(GRADE)
        )
    return keys | _material(model, gear, keys, remarks)


def _tip_alteration(
    gear: Component, m: Decimal, x: Decimal, addendum: Decimal, remarks: list[str]
) -> Decimal | None:
    """Tip alteration k of the tip diameter d_a = d + 2 m (h_a + x + k), a ring's with minus."""
    tip = gear.number("tip_diameter")
    if tip is None:
        return None
    beta = math.radians(float(gear.number(BETA) or 0))
    d = float(m * gear.needed("number_of_teeth")) / math.cos(beta)
    sign = -1.0 if gear.type == "ring_gear" else 1.0
    k = sign * (float(tip) - d) / (2.0 * float(m)) - float(addendum) - float(x)
    if not -0.9 * float(addendum) < k < 0.9:
        remarks.append(
            f"{gear}: tip_diameter {tip} mm is no tip circle of teeth of z "
            f"{gear.number('number_of_teeth')}, m_n {m}, x {x}: it is left out"
        )
        return None
    return rounded(k)


def _thinner(gear: Component, sides: Iterable[Component]) -> Keys:
    """Allowance of the tooth thickness, the mean of those of the span: A_sn = A_W/cos alpha_n."""
    alpha = same(sides, "normal_pressure_angle")
    known = [end for name in ALLOWANCES if (end := gear.number(name)) is not None]
    if not any(known):
        return {}
    mean = float(sum(known)) / len(known) / 1000.0
    cosine = math.cos(math.radians(20.0 if alpha is None else float(alpha[1])))
    return {"thickness_allowance": Said(in_unit(mean / cosine, "mm"), gear.at(ALLOWANCES[0]))}


def _tool(model: Model, gear: Component, sides: Iterable[Component], remarks: list[str]) -> Keys:
    """Keys of the tool that cuts a gear: the first of its steps that has a profile."""
    ways = [("manufacturing_step", "workpiece", flank.id, "tool") for flank in sides]
    for kind in ("ordered_reference", "reference"):  # of versions before 1.4
        ways.append((kind, "origin", gear.id, "referenced"))
    tool = next((t for way in ways for t in model.related(*way, *TOOLS)), None)
    if tool is None:
        return {}
    m, kind = tool.number("normal_module") or gear.needed("normal_module"), tool.type
    if kind == "cutter_wheel_tool" and gear.type != "ring_gear":
        remarks.append(f"{gear}: its shaper cutter, {tool}, is taken as a rack")
        kind = "rack_shaped_tool"
    elif kind == "cutter_wheel_tool":
        tool.needed("number_of_teeth")
    return keys_of([tool], kind, m)


def _material(model: Model, gear: Component, keys: Mapping[str, Any], remarks: list[str]) -> Keys:
    """Strengths and elasticity of a gear: of its material, in early versions of its own."""
    materials, steel, leave = material_of(model, gear), Keys(), ""
    if not keys.keys() & {"steel", "treatment", "iso_material"}:
        steel = _sort(materials, remarks)
    if "iso_material" in steel:  # the hardness of the other sort of steels
        leave = "hardness" if steel["iso_material"].value in SURFACE_HARDENED else "flank_hardness"
    for source in (*materials, gear):
        steel = keys_of([source], "material", leave=leave) | steel
    return steel


def _sort(materials: Iterable[Component], remarks: list[str]) -> Keys:
    """The material of ISO 6336-5 by its heat treatment."""
    for material, name in ((m, name) for m in materials for name in TREATED if m.has(name)):
        kind = material.word(name) or ""
        if kind not in MATERIALS:
            known = ", ".join(MATERIALS)
            raise wrong(material.at(name), kind, "is no known material", f"Known: {known}")
        taken, *others = MATERIALS[kind]
        if others:
            remarks.append(f"{material}: {kind} may be {others[0]}; {taken} is taken")
        return {"iso_material": Said(taken, material.at(name))}
    return {}


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
        tables[k]["wheel"]["face_width"] = step.gears["wheel"].said("face_width")
        if width := tables[k - 1].pop("face_width", None):  # it would be that of the idler's mesh
            for member in last.gears:
                tables[k - 1][member].setdefault("face_width", width)
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
