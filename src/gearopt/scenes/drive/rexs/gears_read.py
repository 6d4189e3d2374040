"""The gears of a REXS model as tables of a drive: teeth, tools, materials."""

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import Any

from gearopt.physics.gears import ISO_53_A
from gearopt.physics.iso6336.materials import SURFACE_HARDENED
from gearopt.scenes.drive.rexs.model import (
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

GEARS = ("cylindrical_gear", "ring_gear")
GRADE = "global_tolerance_class_iso_1328_2013"
GRADES = re.compile(r"[0-9]{1,3}")
ALLOWANCES = tuple(f"{end}_backlash_allowance_referenced_to_span" for end in ("upper", "lower"))
BETA = "helix_angle_reference_diameter"
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
    own, teeth = custom(gear, "gear"), keys_of(sides, m=m)
    if not any(flank.has(name) for flank in sides for name in SHIFTS):
        remarks.append(f"{gear}: no profile shift is said: 0 is taken")
    addendum = teeth["addendum"].value if "addendum" in teeth else Decimal(repr(ISO_53_A.addendum))
    if addendum == Decimal(repr(ISO_53_A.addendum)):
        teeth.pop("addendum", None)
    shift = teeth["profile_shift"].value if "profile_shift" in teeth else Decimal(0)
    k = _tip_alteration(gear, m, shift, addendum, remarks)
    if k and "tip_alteration" not in own:
        teeth["tip_alteration"] = Said(k, gear.at("tip_diameter"))
    keys = own | teeth | _thinner(gear, sides) | _tool(model, gear, sides, remarks)
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
