"""The answer to a drive as a REXS model, and its file in XML."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import field, replace
from datetime import UTC, datetime
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive.design import DriveDesign, drive_design
from gearopt.formulations.drive.layout.layout_design import LayoutDesign
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.physics.gears import MEMBERS, Gear
from gearopt.physics.shaft_forces import rpm
from gearopt.scenes.drive.rating.checks import AGMA_KEYS
from gearopt.scenes.drive.rating.gears import gear_tables, required_hours
from gearopt.scenes.drive.rating.materials import choices
from gearopt.scenes.drive.rexs.flow import THROUGH
from gearopt.scenes.drive.rexs.loads_read import SHARE, SPEED, TIME, TORQUE
from gearopt.scenes.drive.rexs.model import (
    BETA,
    EDITIONS,
    SPECS,
    VERSION,
    Component,
    Model,
    Relation,
)
from gearopt.scenes.drive.rexs.tables import (
    ALLOWANCES,
    CUSTOM,
    FLANKS,
    GRADE,
    MATERIALS,
    TREATED,
)
from gearopt.scenes.drive.stage_types import held_as
from gearopt.scenes.drive.tables.iso6336 import ISO_KEYS
from gearopt.scenes.drive.tables.planetary import gear_of
from gearopt.scenes.explaining.numbers import content
from gearopt.scenes.reading.load import load
from gearopt.scenes.reading.toml_writing import toml_text

UNIT, CASING = 1, 2  # numbers of components
SOLVED = {"tip_alteration", "face_width", "materials", "thickness_allowance"}  # keys of a gear
OF_STAGE = (  # keys that REXS has no attribute for
    *("minimum_bending_safety", "minimum_contact_safety", "shaft", "given", "given_iso6336"),
    *("mesh_order", "planet_clearance", "carrier_over_face_width", "equally_spaced"),
)
IDLE = {"agma": ISO_KEYS, "iso6336": AGMA_KEYS}  # keys of gears that a rating does not read
SIZES = {"mum": 1000, "kg / dm^3": 10**9}  # of gearopt's own units, mm and t/mm3


@dataclass(frozen=True)
class Draft:
    """A model that is being made of a drive: components and relations are numbered as they come.

    shared: materials and tools that gears share, by what they say.
    """

    scene: Any
    design: DriveDesign
    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    shared: dict[str, int] = field(default_factory=dict)

    def add(self, type: str, name: str = "", **values: Any) -> int:
        """Add a component; return its number."""
        number = len(self.components) + 1
        self.components[number] = Component(number, type, name, of_schema(type, values))
        return number

    def part(self, type: str, name: str = "", of: int = 1, **values: Any) -> int:
        """Add a component that is a part of another one, by default of the gear unit."""
        number = self.add(type, name, **values)
        self.relate("assembly", assembly=of, part=number)
        return number

    def say(self, number: int, **values: Any) -> None:
        """Add attributes to a component."""
        component = self.components[number]
        component.attributes.update(of_schema(component.type, values))

    def relate(self, type: str, order: int = 0, **roles: int) -> None:
        """Add a relation of components by role."""
        self.relations.append(Relation(type, roles, order))

    def once(self, type: str, name: str, **values: Any) -> int:
        """Add a component once for all gears that have the same; return its number."""
        key = f"{type} {sorted((k, v) for k, v in values.items() if v is not None)}"
        if key not in self.shared:
            self.shared[key] = self.add(type, name, **values)
        return self.shared[key]


def of_schema(type: str, values: Mapping[str, Any]) -> dict[str, tuple[Any, str]]:
    """Attributes with the units of the schema; what is None is left out."""
    return {
        name: (value, "none" if name.startswith(CUSTOM) else SPECS[type][name].unit)
        for name, value in values.items()
        if value is not None
    }


def attributes(
    type: str, record: Any, by: str = "key", m: float = 1.0, edition: str = ""
) -> dict[str, Any]:
    """Attributes of a component that a record says, by keys of a problem file, or by "result".

    record: an object or a dict. m: normal module [mm]. edition: of ISO 6336, where rated by it.
    """
    values: dict[str, Any] = {}
    done = set[str]()
    for name, spec in SPECS[type].items():
        source = getattr(spec, by)
        raw = record.get(source) if isinstance(record, Mapping) else getattr(record, source, None)
        if raw is None or source in done or (name[-4:] in EDITIONS and name[-4:] != edition):
            continue
        number = raw.exact[0] if hasattr(raw, "exact") else raw
        value = float(number * SIZES.get(spec.unit, 1)) * (m if spec.times == "m" else 1.0)
        if by == "key":
            if not value and spec.range == ">0":
                continue  # a length in mm may be 0
            done.add(source)
        elif spec.range:  # a ring's are below 0 inside
            value = abs(value)
        values[name] = round(value) if spec.sort == "integer" else value
    return values


def rexs(result: Result) -> bytes:
    """The drive of an answer as a REXS file, XML of version 2.0.0; SolveError where it has none."""
    if not result.design.get("stages"):
        raise SolveError("there are no gears to write: the answer has no design")
    scene: Any = load(result.asked).scene
    draft = Draft(held_as(scene, result.design), drive_design(result.design))
    title = draft.scene.title or "drive"
    draft.add("gear_unit", title, model_name=title)
    draft.part("gear_casing", "casing")
    first = shaft = draft.part("shaft", "shaft 1")
    driven, mesh = 0, 1
    for k, stage in enumerate(draft.design.stages):
        planetary = stage.type == "planetary"
        shaft, driven = (_planetary if planetary else _pair)(draft, k, mesh, shaft, driven)
        mesh += 1 + planetary
    layout = draft.design.layout
    if layout is not None and all(s.type == "parallel" for s in draft.design.stages):
        _places(draft, layout)
    cases = _loads(draft, first, shaft)
    if draft.scene.rating is not None:
        _rating(draft)
    source = f"gearopt {result.gearopt}"
    return xml_of(Model(VERSION, source, draft.components, draft.relations, cases))


def _places(draft: Draft, layout: LayoutDesign) -> None:
    """Add where shafts and their gears lie: u along the shafts, w upwards."""
    axes = {"u_axis_vector": [1.0, 0.0, 0.0], "w_axis_vector": [0.0, 0.0, 1.0]}
    at = [(row.from_mm, row) for row in layout.shafts]
    of_gears = [(0.5 * (g.from_mm + g.to_mm), layout.shafts[g.shaft - 1]) for g in layout.gears]
    for type, places in (("shaft", at), ("cylindrical_gear", of_gears)):
        numbers = [c.id for c in draft.components.values() if c.type == type]
        for number, (along, row) in zip(numbers, places, strict=True):
            draft.say(number, support_vector=[along, row.y_mm, row.z_mm], **axes)


def _pair(draft: Draft, k: int, mesh: int, near: int, driven: int) -> tuple[int, int]:
    """Add a pair of gears, or a pinion in a ring; the shaft and the gear that it drives.

    near, driven: the shaft that drives it, and the gear there of the stage before. mesh: from 1.
    """
    stage, scene = draft.design.stages[k], draft.scene
    chosen = stage.pinion_material, stage.wheel_material
    tables = gear_tables(scene.stage_tables[k], scene.gears, scene.material, k, chosen)
    far = draft.part("shaft", f"shaft {k + 2}")
    shafts = (near, far) if stage.driver == "pinion" else (far, near)
    beta, internal = _beta(draft, k, mesh), stage.type == "internal"
    names = "pinion", "ring" if internal else "wheel"
    betas = beta, beta if internal else -beta
    rows = zip(names, tables, stage.pair.gears, betas, shafts, strict=True)
    gears = [
        driven if stage.idler and row[0] == "pinion" else _gear(draft, k, *row) for row in rows
    ]
    _mesh(draft, k, mesh, UNIT, (gears[0], gears[1]), stage.ratio)
    return far, gears[stage.driver == "pinion"]


def _planetary(draft: Draft, k: int, mesh: int, near: int, driven: int) -> tuple[int, int]:
    """Add a planetary stage; the shaft that it drives, and no gear."""
    stage, scene = draft.design.stages[k], draft.scene
    asked, fixed = scene.stage_tables[k], stage.fixed or "ring"
    chosen = stage.pinion_material, stage.wheel_material
    of_sun, of_planet = gear_tables(asked, scene.gears, scene.material, k, chosen)
    known = choices(gear_of(asked.ring), scene.gears, scene.material)
    of_ring = next(t for t, m in known if len(known) == 1 or (m and m.name == stage.ring_material))
    whole = draft.part("planetary_stage", f"stage {k + 1}")
    carrier = draft.part("planet_carrier", "planet carrier", whole)
    entered, left = THROUGH[fixed][:: 1 if stage.driver == "pinion" else -1]
    shafts = {m: near if m == entered else draft.part("shaft", m) for m in THROUGH}
    beta = _beta(draft, k, mesh)
    sun, planet, ring = (*stage.pair.gears, stage.ring)
    first = _gear(draft, k, "sun", of_sun, sun, beta, shafts["sun"])
    last = _gear(draft, k, "ring", of_ring, ring, -beta, shafts["ring"])
    for member in ("sun", "ring"):
        draft.relate("central_shaft", planetary_stage=whole, shaft=shafts[member])
    draft.relate("assembly", assembly=carrier, part=shafts["carrier"])
    draft.relate("planet_carrier_shaft", planetary_stage=whole, shaft=shafts["carrier"])
    brake = draft.add("coupling", f"holds the {fixed}")
    draft.relate("side", assembly=brake, inner_part=shafts[fixed], outer_part=CASING)
    for _ in range(stage.planets or 0):
        shaft = draft.part("shaft", "planet")
        gear = _gear(draft, k, "planet", of_planet, planet, -beta, shaft)
        draft.relate("planet_shaft", planetary_stage=whole, shaft=shaft)
        _mesh(draft, k, mesh, whole, (first, gear), planet.teeth / sun.teeth)
        _mesh(draft, k, mesh + 1, whole, (gear, last), -ring.teeth / planet.teeth)
    return shafts[left], 0


def _beta(draft: Draft, k: int, mesh: int) -> float:
    """Helix angle of a pinion [deg], above 0 of a right-hand one (ISO 21771)."""
    angle, rating = draft.design.stages[k].helix_angle_deg, draft.design.rating
    rows = rating.teeth if rating else ()
    known = [row.hand for row in rows if (row.stage, row.member) == (mesh, "pinion")]
    return -angle if "left" in (known[:1] or [draft.scene.stage_tables[k].pinion_hand]) else angle


def _mesh(draft: Draft, k: int, mesh: int, of: int, gears: tuple[int, int], ratio: float) -> None:
    """Add a mesh of two gears, and the data that each has in it; contact, stresses and safeties."""
    scene, stage = draft.scene, draft.design.stages[k]
    asked, rating = scene.stage_tables[k], scene.rating
    said: dict[str, Any] = {"centre_distance": stage.centre_distance_mm}
    edition = ""
    if rating is not None and rating.standard != "agma":
        edition, of_all = rating.iso6336.edition, rating.overload_factor
        factor = of_all if asked.overload_factor is None else asked.overload_factor
        said |= {"overload_factor": factor, "mesh_load_factor": stage.mesh_load_factor}
    values = attributes("cylindrical_stage", said, edition=edition)
    names = OF_STAGE if edition else (*OF_STAGE, "overload_factor", "mesh_load_factor")
    kept = {key: v for key, v in content(asked, False).items() if key in names}
    values |= {f"{CUSTOM}stage": toml_text(kept)} if kept else {}
    number = draft.part("cylindrical_stage", "", of, gear_ratio=float(ratio), **values)
    draft.relate("stage", stage=number, gear_1=gears[0], gear_2=gears[1])
    data = [draft.add("cylindrical_stage_gear_data") for _ in gears]
    for gear, in_mesh in zip(gears, data, strict=True):
        draft.relate("stage_gear_data", stage=number, gear=gear, stage_gear_data=in_mesh)
    for rated in draft.design.rating.each if draft.design.rating else ():
        year = edition if "ISO" in rated.by else ""
        rows: list[tuple[int, Any]] = [(number, vars(r)) for r in rated.meshes if r.stage == mesh]
        factors = {f.symbol: f.pinion for f in rated.factors if f.stage == mesh}
        rows.append((number, factors))
        of_gears: tuple[Any, ...] = (*rated.gears, *rated.teeth)
        for row in of_gears:
            if row.stage == mesh:
                member = MEMBERS.index(row.member)
                rows += [(data[member], vars(row)), (gears[member], vars(row))]
        for component, record in rows:
            type = draft.components[component].type
            draft.say(component, **attributes(type, record, "result", edition=year))


def _gear(
    draft: Draft, k: int, member: str, table: Any, gear: Gear, beta: float, shaft: int
) -> int:
    """Add a gear with its flanks, tool and material."""
    scene, kind = draft.scene, "ring_gear" if member == "ring" else "cylindrical_gear"
    sort, standard = table.iso_material, scene.rating and scene.rating.standard
    table = table.model_copy(update=dict.fromkeys(IDLE.get(standard, ())))  # a steel says them
    span = float(gear.thickness_allowance) * math.cos(gear.rack.pressure_angle) * 1000.0 or None
    said = attributes(kind, gear, "result") | attributes(kind, table)
    said |= {BETA: beta, "root_diameter": abs(float(gear.root_diameter))}
    said |= dict.fromkeys(ALLOWANCES, span) | {GRADE: _grade(scene, table, member, k)}
    number = draft.part(kind, f"{member} of stage {k + 1}", shaft, **said)
    of_material = _material(draft, number, table, sort)
    tool, of_tool = _tool(draft, table, gear)
    _flanks(draft, number, table, gear, tool)
    kept = content(table, False)
    if member == "ring":
        outside = content(scene.stage_tables[k].ring, False).get("outside_diameter")
        kept |= {"outside_diameter": outside} if outside else {}
    if member == "planet":
        kept.pop("reversed_load", None)
    written = SOLVED | of_material | of_tool | ({"accuracy_grade"} if said[GRADE] else set())
    written |= {spec.key for of in (kind, "cylindrical_gear_flank") for spec in SPECS[of].values()}
    if rest := {key: value for key, value in kept.items() if key not in written}:
        draft.say(number, **{f"{CUSTOM}gear": toml_text(rest)})
    return number


def _grade(scene: Any, table: Any, member: str, k: int) -> str | None:
    """Tolerance class of a gear where it is of ISO 1328:2013."""
    rating = scene.rating
    if rating is None or rating.standard == "agma" or rating.iso6336.tolerances != "2013":
        return None
    grade, of_all = table.accuracy_grade, rating.iso6336.accuracy_grade
    if grade is None and of_all is not None:
        idler = member == "wheel" and any(s.idler for s in scene.stage_tables[k + 1 : k + 2])
        if (idler or member in ("sun", "planet", "ring")) and of_all[0] != of_all[1]:
            return None  # a planet is pinion and wheel, and so is an idler
        grade = of_all[member != "pinion"]
    return str(grade) if grade else None


def _tool(draft: Draft, table: Any, gear: Gear) -> tuple[int, set[str]]:
    """Add the tool of a gear, unless another one has the same; the keys of such a tool."""
    m, rack, cutter = float(gear.normal_module), gear.rack, gear.cutter
    kind, said = (
        "rack_shaped_tool",
        {
            "tool_addendum": rack.dedendum,
            "tool_tip_radius": rack.tip_radius,
            "tool_protuberance": table.tool_protuberance or None,
        },
    )
    if cutter is not None:
        kind, said = (
            "cutter_wheel_tool",
            {
                "cutter_teeth": cutter.teeth,
                "cutter_profile_shift": cutter.profile_shift or None,
                "cutter_addendum": cutter.addendum,
                "cutter_tip_radius": cutter.tip_radius,
            },
        )
    angle = math.degrees(rack.pressure_angle)
    values = attributes(kind, said, m=m)
    tool = draft.once(kind, "tool", normal_module=m, normal_pressure_angle=angle, **values)
    return tool, set(said)


def _flanks(draft: Draft, gear: int, table: Any, of: Gear, tool: int) -> None:
    """Add both flanks of a gear, alike, each with the step that cuts it."""
    said = {
        "profile_shift": of.profile_shift,
        "addendum": of.rack.addendum,
        "tip_chamfer": of.rack.tip_chamfer or None,
        "grinding_allowance": table.grinding_allowance or None,
    }
    kind, angle = "cylindrical_gear_flank", math.degrees(of.rack.pressure_angle)
    values = attributes(kind, said, m=float(of.normal_module))
    sides = {side: draft.add(kind, normal_pressure_angle=angle, **values) for side in FLANKS}
    draft.relate("flank", gear=gear, **sides)
    for flank in sides.values():
        settings = draft.add("cylindrical_gear_manufacturing_settings")
        draft.relate(
            "manufacturing_step", 1, workpiece=flank, tool=tool, manufacturing_settings=settings
        )


def _material(draft: Draft, gear: int, table: Any, sort: str | None) -> set[str]:
    """Add the material of a gear, of a sort by ISO 6336-5; the keys that it says."""
    values = attributes("material", table)
    if "nitr" in (table.treatment or ""):
        values.pop("surface_hardness_brinell", None)
    done = {SPECS["material"][name].key for name in values}
    kinds = [kind for kind, names in MATERIALS.items() if sort in names]
    values |= dict.fromkeys(TREATED[:1], *kinds) if kinds else {}
    if (density := draft.scene.objective.density) is not None:
        values["density"] = float(density.exact[0] * 10**9)  # of t/mm3
    if values:
        name = table.steel or sort or "steel"
        material = draft.once("material", name, material_designation=name, **values)
        draft.relate("reference", origin=gear, referenced=material)
    return done


def _loads(draft: Draft, first: int, last: int) -> list[dict[int, Component]]:
    """Add the duty at input and output shaft; the load cases of a spectrum."""
    duty = draft.scene.duty
    torque, speed = duty.input_torque / 1000.0, _rpm(duty.input_speed)
    driving = {"transmits_torque": True, "defines_torque": True, TORQUE: torque}
    load_on = draft.part("external_load", "input", first, **driving)
    draft.part("external_load", "output", last, transmits_torque=True, defines_torque=False)
    draft.say(first, defines_speed=True, **{SPEED: speed})
    cases = []
    for level in draft.scene.load:
        at = level.input_speed or duty.input_speed
        said: dict[int, dict[str, Any]] = {
            UNIT: {SHARE: float(100 * level.share)},
            first: {SPEED: _rpm(at)},
            load_on: {TORQUE: level.power.value / at.value / 1000.0},
        }
        parts = [draft.components[i] for i in said]
        cases.append({c.id: replace(c, attributes=of_schema(c.type, said[c.id])) for c in parts})
    return cases


def _rpm(speed: Any) -> float:
    return float(speed.number) if speed.unit == "rpm" else rpm(speed.value)


def _rating(draft: Draft) -> None:
    """Add life, oil and tip relief, and what REXS has no attribute for."""
    rating = draft.scene.rating
    draft.say(UNIT, **{TIME: required_hours(rating, draft.scene.duty)})
    kept = content(rating, False)
    iso = kept.pop("iso6336", {})
    for key, kind in (("oil_grade", "lubricant"), ("tip_relief", "tip_relief")):
        if not (values := attributes(kind, rating.iso6336)):
            continue
        iso.pop(key, None)
        flanks = [c.id for c in draft.components.values() if c.type == "cylindrical_gear_flank"]
        for origin in flanks if kind == "tip_relief" else [CASING]:
            draft.relate("reference", origin=origin, referenced=draft.add(kind, **values))
    names = ["life", "input_revolutions", *["overload_factor"] * (rating.standard != "agma")]
    rest = {key: value for key, value in kept.items() if key not in names}
    table = {"standard": rating.standard, **rest, **({"iso6336": iso} if iso else {})}
    draft.say(UNIT, **{f"{CUSTOM}rating": toml_text(table)})


def xml_of(model: Model) -> bytes:
    """A model as a REXS file in XML."""
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    application, _, version = model.source.partition(" ")
    head = {"version": VERSION, "applicationId": application, "applicationVersion": version}
    root = ET.Element("model", {**head, "date": stamp, "applicationLanguage": "en"})
    group = ET.SubElement(root, "relations")
    for k, relation in enumerate(model.relations, 1):
        order = {"order": str(relation.order)} if relation.order else {}
        about = {"id": str(k), "type": relation.type, **order}
        element = ET.SubElement(group, "relation", about)
        for role, number in relation.refs.items():
            hint = model.components[number].type
            ET.SubElement(element, "ref", {"id": str(number), "role": role, "hint": hint})
    group = ET.SubElement(root, "components")
    for component in model.components.values():
        _add(group, component)
    if model.cases:
        spectrum = ET.SubElement(root, "load_spectrum", {"id": "1"})
        for k, case in enumerate(model.cases, 1):
            group = ET.SubElement(spectrum, "load_case", {"id": str(k)})
            for component in case.values():
                _add(group, component)
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _add(group: ET.Element, component: Component) -> None:
    """Add the element of a component."""
    head = {"id": str(component.id), "type": component.type}
    head |= {"name": component.name} if component.name else {}
    element = ET.SubElement(group, "component", head)
    for id, (value, unit) in component.attributes.items():
        entry = ET.SubElement(element, "attribute", {"id": id, "unit": unit})
        if isinstance(value, list):
            array = ET.SubElement(entry, "array")
            for number in value:
                ET.SubElement(array, "c").text = str(number)
        else:
            entry.text = str(value).lower() if isinstance(value, bool) else str(value)
