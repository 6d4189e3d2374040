"""The gears of a REXS model as tables of a drive: teeth, tools, materials."""

import math
import tomllib
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import Any

from gearopt.physics.gears import ISO_53_A
from gearopt.physics.iso6336.materials import SURFACE_HARDENED
from gearopt.scenes.drive.rexs.model import Component, Model, Said, in_unit, wrong

GEARS = ("cylindrical_gear", "ring_gear")
GRADE = "global_tolerance_class_iso_1328_2013"
FLANKS = ("left", "right")
TOOLS = ("rack_shaped_tool", "cutter_wheel_tool")
RACK = {  # key of a tool: factor, and length in mm
    "tool_addendum": ("addendum_coefficient_reference_profile", "addendum_reference_profile"),
    "tool_tip_radius": (
        "tip_corner_radius_factor_reference_profile",
        "tip_corner_radius_reference_profile",
    ),
    "tool_protuberance": ("protuberance_amount_factor", "protuberance_amount"),
}
SURFACE = {
    "roughness": "arithmetic_mean_roughness_flank_iso_4287_1997",
    "flank_rz": "mean_peak_to_valley_roughness_flank_iso_4287_1997",
    "root_rz": "mean_peak_to_valley_roughness_root_iso_4287_1997",
}
STRENGTH = {  # key: attributes of a material, the later edition first
    "sigma_Hlim": (
        "allowable_stress_number_contact_iso_6336_2016",
        "allowable_stress_number_contact_iso_6336_2003",
    ),
    "sigma_Flim": (
        "nominal_stress_number_tooth_root_iso_6336_2016",
        "nominal_stress_number_tooth_root_iso_6336_2003",
    ),
}
BASIC = (  # sigma_FE = 2 sigma_Flim
    "allowable_stress_number_tooth_root_iso_6336_2016",
    "allowable_stress_number_tooth_root_iso_6336_2003",
)
ELASTIC = {
    "elastic_modulus": "elastic_modulus",
    "poisson_ratio": "poisson_ratio",
    "yield_strength": "yield_strength",
    "hardness": "surface_hardness_brinell",
    "flank_hardness": "surface_hardness_vickers",
}
TREATED = ("heat_treated_material_type_iso_6336_2019", "heat_treated_material_type_iso_6336_2006")
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
SMALL = 12  # digits after the point of what follows from diameters
Keys = dict[str, Any]  # of a table; values that the file says are `Said`


def custom(component: Component, name: str) -> Keys:
    """Keys of gearopt's own attribute of a component, none where it has none."""
    text = component.word(CUSTOM + name)
    if text is None:
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
    return [f for side in FLANKS for f in model.related("flank", "gear", gear.id, side)]


def same(components: Iterable[Component], name: str) -> tuple[Component, Decimal] | None:
    """A number that components share, with the first that has it; SceneError where it differs."""
    known: tuple[Component, Decimal] | None = None
    for component in components:
        value = component.number(name)
        if value is not None and known is not None and value != known[1]:
            rule = f"differs from {known[1]} of {known[0]}"
            raise wrong(component.at(name), str(value), rule, "gearopt takes equal ones alone")
        known = known or (None if value is None else (component, value))
    return known


def module_of(gear: Component) -> Decimal:
    """Normal module of a gear [mm]; SceneError where it is missing."""
    return needed(gear, "normal_module")


def needed(component: Component, name: str) -> Decimal:
    """A number without which there is no gear."""
    value = component.number(name)
    if value is None:
        raise wrong(component.at(name), None, "is missing", "Export the geometry of all gears")
    return value


def gear_keys(model: Model, gear: Component, remarks: list[str]) -> Keys:
    """Keys of a gear, but its module, teeth, helix and width."""
    keys = custom(gear, "gear")
    keys |= _teeth(model, gear, keys, remarks) | _tools(model, gear, remarks)
    for key, name in SURFACE.items():
        if (value := gear.said(name)) is not None:
            keys[key] = value
    if (grade := gear.word(GRADE)) is not None:
        at = gear.at(GRADE)
        keys["accuracy_grade"] = Said(int(grade) if grade.isdigit() else grade, at)
    return keys | _material(model, gear, keys, remarks)


def _teeth(model: Model, gear: Component, keys: Mapping[str, Any], remarks: list[str]) -> Keys:
    """Profile shift, addendum, tips and thickness of the teeth of a gear."""
    sides, m = flanks(model, gear), module_of(gear)
    teeth: Keys = {}
    shift = same(sides, "addendum_modification_coefficient")
    length = same(sides, "addendum_modification")
    if shift is not None:
        x, at = shift[1], shift[0].at("addendum_modification_coefficient")
    elif length is not None:
        x, at = length[1] / m, length[0].at("addendum_modification")
    else:
        x, at = Decimal(0), str(gear)
        remarks.append(f"{gear}: no profile shift is said: 0 is taken")
    if x:
        teeth["profile_shift"] = Said(x, at)
    addendum = same(sides, "addendum_coefficient_basic_profile")
    if addendum is not None and addendum[1] != Decimal(repr(ISO_53_A.addendum)):
        teeth["addendum"] = Said(addendum[1], addendum[0].at("addendum_coefficient_basic_profile"))
    for name, key in (("tooth_tip_chamfer", "tip_chamfer"), ("grinding_allowance",) * 2):
        length = same(sides, name)
        if length is not None and length[1]:
            teeth[key] = Said(_short(length[1] / m), length[0].at(name))
    height = addendum[1] if addendum is not None else Decimal(repr(ISO_53_A.addendum))
    if (k := _tip_alteration(gear, m, x, height, remarks)) and "tip_alteration" not in keys:
        teeth["tip_alteration"] = Said(k, gear.at("tip_diameter"))
    return teeth | _thinner(gear, pressure_angle(sides))


def _tip_alteration(
    gear: Component, m: Decimal, x: Decimal, addendum: Decimal, remarks: list[str]
) -> Decimal | None:
    """Tip alteration k of the tip diameter d_a = d + 2 m (h_a + x + k), a ring's with minus."""
    tip = gear.number("tip_diameter")
    if tip is None:
        return None
    beta = math.radians(float(gear.number("helix_angle_reference_diameter") or 0))
    d = float(m * needed(gear, "number_of_teeth")) / math.cos(beta)
    sign = -1.0 if gear.type == "ring_gear" else 1.0
    k = sign * (float(tip) - d) / (2.0 * float(m)) - float(addendum) - float(x)
    if not -0.9 * float(addendum) < k < 0.9:
        remarks.append(
            f"{gear}: tip_diameter {tip} mm is no tip circle of teeth of z "
            f"{gear.number('number_of_teeth')}, m_n {m}, x {x}: it is left out"
        )
        return None
    return _short(Decimal(repr(k)))


def _short(value: Decimal) -> Decimal:
    """A number without the rounding errors of what it follows from."""
    return Decimal(round(value, SMALL)).normalize()


def pressure_angle(sides: Iterable[Component]) -> float:
    """Normal pressure angle of flanks [rad]."""
    alpha = same(sides, "normal_pressure_angle")
    return math.radians(20.0 if alpha is None else float(alpha[1]))


def _thinner(gear: Component, alpha: float) -> Keys:
    """Allowance of the tooth thickness, the mean of those of the span: A_sn = A_W/cos alpha_n."""
    names = ("upper", "lower")
    ends = [gear.number(f"{n}_backlash_allowance_referenced_to_span") for n in names]
    known = [end for end in ends if end is not None]
    if not known or not any(known):
        return {}
    mean = float(sum(known)) / len(known) / 1000.0
    at = gear.at("upper_backlash_allowance_referenced_to_span")
    return {"thickness_allowance": Said(in_unit(mean / math.cos(alpha), "mm"), at)}


def _tools(model: Model, gear: Component, remarks: list[str]) -> Keys:
    """Keys of the tool that cuts a gear: the first of its steps that has a profile."""
    sides = flanks(model, gear)
    steps = [
        t for f in sides for t in model.related("manufacturing_step", "workpiece", f.id, "tool")
    ]
    for kind in ("ordered_reference", "reference"):  # of versions before 1.4
        steps += model.related(kind, "origin", gear.id, "referenced")
    tools = [t for t in steps if t.type in TOOLS]
    if not tools:
        return {}
    first = tools[0]
    m = first.number("normal_module") or module_of(gear)
    if first.type == "cutter_wheel_tool":
        if gear.type != "ring_gear":
            remarks.append(f"{gear}: its shaper cutter, {first}, is taken as a rack")
        else:
            return _cutter(first, m)
    return _profile(first, m, RACK)


def _profile(tool: Component, m: Decimal, names: Mapping[str, tuple[str, str]]) -> Keys:
    """Numbers of a tool in normal modules, of factors or of lengths."""
    keys: Keys = {}
    for key, (factor, length) in names.items():
        if tool.has(factor):
            keys[key] = tool.said(factor)
        elif (value := tool.number(length)) is not None:
            keys[key] = Said(_short(value / m), tool.at(length))
    return {k: v for k, v in keys.items() if v.value or k == "tool_addendum"}


def _cutter(tool: Component, m: Decimal) -> Keys:
    """Keys of the pinion-type cutter of a ring."""
    keys: Keys = {
        "cutter_teeth": Said(int(needed(tool, "number_of_teeth")), tool.at("number_of_teeth"))
    }
    if tool.number("addendum_modification_coefficient"):
        keys["cutter_profile_shift"] = tool.said("addendum_modification_coefficient")
    profile = _profile(tool, m, RACK)
    if "tool_addendum" in profile:
        keys["cutter_addendum"] = profile["tool_addendum"]
    if radius := tool.number("tip_corner_radius_cutter"):
        keys["cutter_tip_radius"] = Said(_short(radius / m), tool.at("tip_corner_radius_cutter"))
    return keys


def _first(components: Iterable[Component], names: Iterable[str]) -> Said | None:
    """The first of some attributes that any component has."""
    said = (c.said(name) for c in components for name in names if c.has(name))
    return next(said, None)


def _material(model: Model, gear: Component, keys: Mapping[str, Any], remarks: list[str]) -> Keys:
    """Strengths and elasticity of a gear: of its material, in early versions of its own."""
    materials = material_of(model, gear)
    sources = [*materials, gear]
    steel: Keys = {}
    for key, names in STRENGTH.items():
        if (value := _first(sources, names)) is not None:
            steel[key] = value
    if "sigma_Flim" not in steel and (basic := _first(sources, BASIC)) is not None:
        half = Decimal(basic.value.split()[0]) / 2
        steel["sigma_Flim"] = Said(in_unit(half, "MPa"), basic.origin)
    if not keys.keys() & {"steel", "treatment", "iso_material"}:
        steel |= _sort(materials, remarks)
    hard = getattr(steel.get("iso_material"), "value", "") in SURFACE_HARDENED
    for key, name in ELASTIC.items():
        if key == ("hardness" if hard else "flank_hardness") and "iso_material" in steel:
            continue  # it is of the other sort of steels
        if (value := _first(materials, (name,))) is not None:
            steel[key] = value
    return steel


def _sort(materials: Iterable[Component], remarks: list[str]) -> Keys:
    """The material of ISO 6336-5 by its heat treatment."""
    for material in materials:
        for name in TREATED:
            if (kind := material.word(name)) is None:
                continue
            if kind not in MATERIALS:
                known = ", ".join(MATERIALS)
                raise wrong(material.at(name), kind, "is no known material", f"Known: {known}")
            taken, *others = MATERIALS[kind]
            if others:
                remarks.append(f"{material}: {kind} may be {others[0]}; {taken} is taken")
            return {"iso_material": Said(taken, material.at(name))}
    return {}


def material_of(model: Model, gear: Component) -> list[Component]:
    """The material of a gear, or none."""
    listed = model.related("reference", "origin", gear.id, "referenced")
    return [c for c in listed if c.type == "material"]
