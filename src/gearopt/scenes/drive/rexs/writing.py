"""The answer to a drive as a REXS model: its gears, materials, tools, loads and ratings."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.drive.layout.layout_design import LayoutDesign
from gearopt.formulations.drive.rating import DriveRating
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.physics.gears import MEMBERS, Gear
from gearopt.physics.shaft_forces import rpm
from gearopt.scenes.drive.rating.gears import gear_tables, required_hours
from gearopt.scenes.drive.rating.materials import choices
from gearopt.scenes.drive.rexs.drive_read import THROUGH
from gearopt.scenes.drive.rexs.gears_read import (
    CUSTOM,
    ELASTIC,
    FLANKS,
    GRADE,
    MATERIALS,
    RACK,
    STRENGTH,
    SURFACE,
    TREATED,
)
from gearopt.scenes.drive.rexs.loads_read import SPEED, TORQUE
from gearopt.scenes.drive.rexs.model import SPECS, VERSION, Attribute, Component, Model, Relation
from gearopt.scenes.drive.rexs.xml_writing import xml_of
from gearopt.scenes.drive.stage_types import held_as
from gearopt.scenes.drive.tables.planetary import gear_of
from gearopt.scenes.explaining.numbers import content
from gearopt.scenes.reading.load import load
from gearopt.scenes.reading.toml_writing import toml_text

GIVEN = ("profile_shift", "tip_alteration", "face_width", "materials", "thickness_allowance")
PROFILE = ("addendum", "tip_chamfer", "grinding_allowance")
TO_MUM = 1000.0
OF_STAGE = ("minimum_bending_safety", "minimum_contact_safety", "shaft", "given", "given_iso6336")
OF_PLANETS = ("mesh_order", "planet_clearance", "carrier_over_face_width", "equally_spaced")
OF_MESH = {  # symbols of factors: attributes of a stage, without the edition
    "K_v": "dynamic_factor",
    "K_Hbeta": "face_load_factor_contact_stress",
    "K_Fbeta": "face_load_factor_root_stress",
    "K_Halpha": "transverse_load_factor_contact_stress",
    "K_Falpha": "transverse_load_factor_root_stress",
}
OF_GEAR = {  # fields of the rating of a gear: attributes of its data, without the edition
    "contact_stress_MPa": "contact_stress",
    "permissible_contact_stress_MPa": "permissible_contact_stress",
    "contact_safety": "safety_factor_pitting",
    "bending_stress_MPa": "tooth_root_stress",
    "permissible_bending_stress_MPa": "permissible_tooth_root_stress",
    "bending_safety": "safety_factor_tooth_root",
}
MEASURES = {  # fields of the geometry of a gear: attributes of the gear
    "form_diameter_mm": "root_form_diameter",
    "base_diameter_mm": "base_diameter",
    "span_teeth": "number_of_teeth_for_span_measurement",
    "span_mm": "span_measurement",
    "ball_diameter_mm": "diameter_of_measuring_ball_or_pin",
    "over_balls_mm": "size_over_balls",
}


class Draft:
    """A model that is being made: components and relations are numbered as they come."""

    def __init__(self) -> None:
        self.components: dict[int, Component] = {}
        self.relations: list[Relation] = []
        self.known: dict[Any, int] = {}  # materials and tools that gears share

    def add(self, type: str, name: str = "", **values: Any) -> int:
        """Add a component; return its number."""
        number = len(self.components) + 1
        self.components[number] = Component(number, type, name, of_schema(type, values))
        return number

    def say(self, number: int, **values: Any) -> None:
        """Add attributes to a component."""
        component = self.components[number]
        more = {**component.attributes, **of_schema(component.type, values)}
        self.components[number] = replace(component, attributes=more)

    def relate(self, type: str, order: int = 0, **roles: int) -> None:
        """Add a relation of components by role."""
        self.relations.append(Relation(type, (*roles.items(),), order, len(self.relations) + 1))

    def shared(self, type: str, name: str, **values: Any) -> int:
        """Return a component that is added once for all that have the same."""
        key = type, toml_text({k: v for k, v in values.items() if v is not None})
        if key not in self.known:
            self.known[key] = self.add(type, name, **values)
        return self.known[key]


@dataclass(frozen=True)
class Mesh:
    """Stages that a mesh is, one for each planet, and the data of pinion and wheel in each."""

    stages: list[int]
    pinions: list[int]
    wheels: list[int]


def of_schema(type: str, values: Mapping[str, Any]) -> dict[str, Attribute]:
    """Attributes with the units of the schema; what is None is left out."""
    return {
        name: Attribute(value, "none" if name.startswith(CUSTOM) else SPECS[type, name].unit)
        for name, value in values.items()
        if value is not None
    }


@dataclass(frozen=True)
class Place:
    """Where a stage (from 0) is added: to a draft, at the shaft that drives it.

    idler: the gear that drives it, where that is the wheel of the stage before.
    """

    draft: Draft
    scene: Any
    unit: int
    casing: int
    shaft: int
    k: int
    idler: int | None
    rating: DriveRating | None


def rexs(result: Result) -> bytes:
    """The drive of an answer as a REXS file, XML of version 2.0.0; SolveError where it has none."""
    if not result.design.get("stages"):
        raise SolveError("there are no gears to write: the answer has no design")
    scene: Any = load(result.asked).scene
    scene = held_as(scene, result.design)
    design, draft = drive_design(result.design), Draft()
    title = scene.title or "drive"
    unit = draft.add("gear_unit", title, model_name=title)
    casing = draft.add("gear_casing", "casing")
    draft.relate("assembly", assembly=unit, part=casing)
    first = shaft = _shaft(draft, unit, "shaft 1")
    meshes: list[Mesh] = []
    driven = 0
    for k, stage in enumerate(design.stages):
        idler = driven if stage.idler else None
        place = Place(draft, scene, unit, casing, shaft, k, idler, design.rating)
        add = _planetary if stage.type == "planetary" else _pair
        shaft, driven = add(place, stage, meshes)
    if design.layout is not None and all(s.type == "parallel" for s in design.stages):
        _places(draft, design.layout)
    cases = _loads(draft, scene, unit, (first, shaft))
    if scene.rating is not None:
        _rating(draft, scene, unit, casing)
    for rating in design.rating.each if design.rating else ():
        _results(draft, scene, rating, meshes)
    source = f"gearopt {result.gearopt}"
    return xml_of(Model(VERSION, source, draft.components, draft.relations, cases))


def _shaft(draft: Draft, unit: int, name: str) -> int:
    shaft = draft.add("shaft", name)
    draft.relate("assembly", assembly=unit, part=shaft)
    return shaft


def _places(draft: Draft, layout: LayoutDesign) -> None:
    """Add where shafts and their gears lie: u along the shafts, w upwards."""
    axes = {"u_axis_vector": [1.0, 0.0, 0.0], "w_axis_vector": [0.0, 0.0, 1.0]}
    shafts = [c.id for c in draft.components.values() if c.type == "shaft"]
    for number, row in zip(shafts, layout.shafts, strict=True):
        draft.say(number, support_vector=[row.from_mm, row.y_mm, row.z_mm], **axes)
    gears = [c.id for c in draft.components.values() if c.type == "cylindrical_gear"]
    for number, gear in zip(gears, layout.gears, strict=True):
        row = layout.shafts[gear.shaft - 1]
        middle = 0.5 * (gear.from_mm + gear.to_mm)
        draft.say(number, support_vector=[middle, row.y_mm, row.z_mm], **axes)


def _pair(place: Place, stage: StageDesign, meshes: list[Mesh]) -> tuple[int, int]:
    """Add a pair of gears, or a pinion in a ring; the shaft and the gear that it drives."""
    draft, k = place.draft, place.k
    asked = place.scene.stage_tables[k]
    chosen = stage.pinion_material, stage.wheel_material
    tables = gear_tables(asked, place.scene.gears, place.scene.material, k, chosen)
    far = _shaft(draft, place.unit, f"shaft {k + 2}")
    shafts = (place.shaft, far) if stage.driver == "pinion" else (far, place.shaft)
    angle = _signed(place, stage, len(meshes) + 1)
    gears = []
    for member, table, gear, shaft in zip(MEMBERS, tables, stage.pair.gears, shafts, strict=True):
        if place.idler is not None and member == "pinion":
            gears.append(place.idler)
            continue
        internal = stage.type == "internal"
        name = "ring" if internal and member == "wheel" else member
        sign = 1.0 if internal or member == "pinion" else -1.0
        gears.append(_gear(place, name, table, gear, sign * angle))
        draft.relate("assembly", assembly=shaft, part=gears[-1])
    mesh = _mesh(place, stage, (gears[0], gears[1]), stage.ratio)
    draft.relate("assembly", assembly=place.unit, part=mesh.stages[0])
    meshes.append(mesh)
    return far, gears[1] if stage.driver == "pinion" else gears[0]


def _planetary(place: Place, stage: StageDesign, meshes: list[Mesh]) -> tuple[int, int]:
    """Add a planetary stage; the shaft and the gear that it drives."""
    draft, scene, unit = place.draft, place.scene, place.unit
    asked = scene.stage_tables[place.k]
    chosen = stage.pinion_material, stage.wheel_material
    tables = list(gear_tables(asked, scene.gears, scene.material, place.k, chosen))
    known = choices(gear_of(asked.ring), scene.gears, scene.material)
    tables.append(
        next(t for t, m in known if len(known) == 1 or (m and m.name == stage.ring_material))
    )
    angle = _signed(place, stage, len(meshes) + 1)
    whole = draft.add("planetary_stage", f"stage {place.k + 1}")
    carrier = draft.add("planet_carrier", "planet carrier")
    draft.relate("assembly", assembly=unit, part=whole)
    draft.relate("assembly", assembly=whole, part=carrier)
    sun, planet, ring = (*stage.pair.gears, stage.ring)
    entered, left = THROUGH[stage.fixed or "ring"][:: 1 if stage.driver == "pinion" else -1]
    shafts = {entered: place.shaft}
    shafts |= {m: _shaft(draft, unit, m) for m in ("sun", "carrier", "ring") if m != entered}
    first = _gear(place, "sun", tables[0], sun, angle)
    last = _gear(place, "ring", tables[2], ring, -angle)
    for member, gear in (("sun", first), ("ring", last)):
        draft.relate("assembly", assembly=shafts[member], part=gear)
        draft.relate("central_shaft", planetary_stage=whole, shaft=shafts[member])
    draft.relate("assembly", assembly=carrier, part=shafts["carrier"])
    draft.relate("planet_carrier_shaft", planetary_stage=whole, shaft=shafts["carrier"])
    brake = draft.add("coupling", f"holds the {stage.fixed or 'ring'}")
    held = shafts[stage.fixed or "ring"]
    draft.relate("side", assembly=brake, inner_part=held, outer_part=place.casing)
    of_sun, of_ring = Mesh([], [], []), Mesh([], [], [])
    for _ in range(stage.planets or 0):
        shaft = _shaft(draft, unit, "planet")
        gear = _gear(place, "planet", tables[1], planet, -angle)
        draft.relate("assembly", assembly=shaft, part=gear)
        draft.relate("planet_shaft", planetary_stage=whole, shaft=shaft)
        rows = (
            (of_sun, first, gear, planet.teeth / sun.teeth),
            (of_ring, gear, last, -ring.teeth / planet.teeth),
        )
        for mesh, pinion, wheel, ratio in rows:
            more = _mesh(place, stage, (pinion, wheel), ratio)
            draft.relate("assembly", assembly=whole, part=more.stages[0])
            for name in ("stages", "pinions", "wheels"):
                getattr(mesh, name).extend(getattr(more, name))
    meshes += of_sun, of_ring
    return shafts[left], 0


def _signed(place: Place, stage: StageDesign, mesh: int) -> float:
    """Helix angle of a pinion [deg], above 0 of a right-hand one (ISO 21771)."""
    rows = place.rating.teeth if place.rating else ()
    known = [row.hand for row in rows if row.stage == mesh and row.member == "pinion"]
    asked = place.scene.stage_tables[place.k].pinion_hand
    left = "left" in (known[:1] or [asked])
    return -stage.helix_angle_deg if left else stage.helix_angle_deg


def _mesh(place: Place, stage: StageDesign, gears: tuple[int, int], ratio: float) -> Mesh:
    """Add a mesh of two gears, and the data that each has in it."""
    draft, scene = place.draft, place.scene
    asked = scene.stage_tables[place.k]
    factors: dict[str, Any] = {}
    if scene.rating is not None and scene.rating.standard != "agma":
        edition = scene.rating.iso6336.edition
        applied = asked.overload_factor, scene.rating.overload_factor
        factors[f"application_factor_iso_6336_{edition}"] = float(applied[applied[0] is None])
        if stage.mesh_load_factor is not None:
            factors[f"mesh_load_factor_iso_6336_{edition}"] = stage.mesh_load_factor
    kept = {k: v for k, v in content(asked, False).items() if k in (*OF_STAGE, *OF_PLANETS)}
    if kept:
        factors[f"{CUSTOM}stage"] = toml_text(kept)
    a = stage.centre_distance_mm
    number = draft.add(
        "cylindrical_stage", "", center_distance=a, gear_ratio=float(ratio), **factors
    )
    draft.relate("stage", stage=number, gear_1=gears[0], gear_2=gears[1])
    data = [draft.add("cylindrical_stage_gear_data") for _ in gears]
    for gear, of_gear in zip(gears, data, strict=True):
        draft.relate("stage_gear_data", stage=number, gear=gear, stage_gear_data=of_gear)
    return Mesh([number], [data[0]], [data[1]])


def _gear(place: Place, member: str, table: Any, gear: Gear, angle: float) -> int:
    """Add a gear with its flanks, tool and material."""
    draft, scene = place.draft, place.scene
    m, rack = float(gear.normal_module), gear.rack
    kind = "ring_gear" if member == "ring" else "cylindrical_gear"
    kept = content(table, False)
    if member == "ring":
        outside = content(scene.stage_tables[place.k].ring, False).get("outside_diameter")
        kept |= {"outside_diameter": outside} if outside else {}
    if member == "planet":
        kept.pop("reversed_load", None)
    span = float(gear.thickness_allowance) * math.cos(rack.pressure_angle) * TO_MUM or None
    grade = _grade(scene, table, member)
    number = draft.add(
        kind,
        f"{member} of stage {place.k + 1}",
        normal_module=m,
        number_of_teeth=round(abs(float(gear.teeth))),
        helix_angle_reference_diameter=angle,
        face_width=float(gear.width),
        reference_diameter_cylindrical_gear=abs(float(gear.reference_diameter)),
        tip_diameter=abs(float(gear.tip_diameter)),
        root_diameter=abs(float(gear.root_diameter)),
        upper_backlash_allowance_referenced_to_span=span,
        lower_backlash_allowance_referenced_to_span=span,
        **{name: _mum(getattr(table, key)) for key, name in SURFACE.items()},
        **{GRADE: grade},
    )
    written = {*GIVEN, *PROFILE, *SURFACE, *_made_of(draft, scene, number, table)}
    written |= {*RACK} if gear.cutter is None else set()
    written |= {"accuracy_grade"} if grade else set()
    rest = {k: v for k, v in kept.items() if k not in written}
    if rest:
        draft.say(number, **{f"{CUSTOM}gear": toml_text(rest)})
    _flanks(draft, number, table, gear, _tool(draft, gear))
    return number


def _mum(length: Any) -> float | None:
    return None if length is None else length.value * TO_MUM


def _grade(scene: Any, table: Any, member: str) -> str | None:
    """Tolerance class of a gear where it is of ISO 1328:2013."""
    rating = scene.rating
    if rating is None or rating.standard == "agma" or rating.iso6336.tolerances != "2013":
        return None
    of_all = rating.iso6336.accuracy_grade
    grade = table.accuracy_grade
    if grade is None and of_all is not None:
        if member in ("sun", "planet", "ring") and of_all[0] != of_all[1]:
            return None  # a planet is pinion and wheel
        grade = of_all[member != "pinion"]
    return str(grade) if grade else None


def _tool(draft: Draft, gear: Gear) -> int:
    """Add the tool of a gear, unless another one has the same."""
    m, rack = float(gear.normal_module), gear.rack
    common = {
        "normal_module": m,
        "normal_pressure_angle": math.degrees(rack.pressure_angle),
        "protuberance_amount_factor": float(rack.protuberance) or None,
        "tip_corner_radius_factor_reference_profile": float(rack.tip_radius),
    }
    addendum = "addendum_coefficient_reference_profile"
    if gear.cutter is None:
        return draft.shared(
            "rack_shaped_tool", "tool", **common, **{addendum: float(rack.dedendum)}
        )
    cutter = {
        "number_of_teeth": round(gear.cutter.teeth),
        "addendum_modification_coefficient": gear.cutter.profile_shift or None,
        "tip_corner_radius_cutter": m * gear.cutter.tip_radius or None,
        addendum: float(gear.cutter.addendum),
    }
    return draft.shared("cutter_wheel_tool", "cutter", **common | cutter)


def _flanks(draft: Draft, number: int, table: Any, gear: Gear, tool: int) -> None:
    """Add both flanks of a gear, alike, each with the step that cuts it."""
    m, rack = float(gear.normal_module), gear.rack
    stock = table.grinding_allowance
    sides = {
        side: draft.add(
            "cylindrical_gear_flank",
            normal_pressure_angle=math.degrees(rack.pressure_angle),
            addendum_modification_coefficient=float(gear.profile_shift),
            addendum_coefficient_basic_profile=float(rack.addendum),
            tooth_tip_chamfer=m * float(rack.tip_chamfer) or None,
            grinding_allowance=m * float(stock) if stock else None,
        )
        for side in FLANKS
    }
    draft.relate("flank", gear=number, **sides)
    for flank in sides.values():
        settings = draft.add("cylindrical_gear_manufacturing_settings")
        draft.relate(
            "manufacturing_step", 1, workpiece=flank, tool=tool, manufacturing_settings=settings
        )


def _made_of(draft: Draft, scene: Any, gear: int, table: Any) -> list[str]:
    """Add the material of a gear; the keys that it says."""
    values: dict[str, Any] = {}
    done = []
    for key, name in {**{k: v[0] for k, v in STRENGTH.items()}, **ELASTIC}.items():
        value = getattr(table, key)
        if value is None or (key == "hardness" and "nitr" in (table.treatment or "")):
            continue
        values[name] = float(getattr(value, "value", value))
        done.append(key)
    kinds = [kind for kind, names in MATERIALS.items() if table.iso_material in names]
    values |= dict.fromkeys(TREATED[:1], *kinds) if kinds else {}
    density = scene.objective.density
    values["density"] = density and float(density.exact[0] * 10**9)  # of t/mm3
    if any(values.values()):
        name = table.steel or table.iso_material or "steel"
        material = draft.shared("material", name, material_designation=name, **values)
        draft.relate("reference", origin=gear, referenced=material)
    return done


def _loads(
    draft: Draft, scene: Any, unit: int, ends: tuple[int, int]
) -> list[dict[int, Component]]:
    """Add the duty at input and output shaft; the load cases of a spectrum."""
    duty = scene.duty
    loads = [
        draft.add("external_load", name, transmits_torque=True) for name in ("input", "output")
    ]
    for shaft, load_on in zip(ends, loads, strict=True):
        draft.relate("assembly", assembly=shaft, part=load_on)
    torque, speed = duty.input_torque / 1000.0, _rpm(duty.input_speed)
    draft.say(loads[0], defines_torque=True, **{TORQUE: torque})
    draft.say(loads[1], defines_torque=False)
    draft.say(ends[0], defines_speed=True, **{SPEED: speed})
    cases = []
    for level in scene.load:
        at = level.input_speed or duty.input_speed
        said: dict[int, dict[str, Any]] = {
            unit: {"operating_time_fraction": float(100 * level.share)},
            ends[0]: {SPEED: _rpm(at)},
            loads[0]: {TORQUE: level.power.value / at.value / 1000.0},
        }
        parts = {i: draft.components[i] for i in said}
        cases.append(
            {i: replace(parts[i], attributes=of_schema(parts[i].type, said[i])) for i in said}
        )
    return cases


def _rpm(speed: Any) -> float:
    return float(speed.number) if speed.unit == "rpm" else rpm(speed.value)


def _rating(draft: Draft, scene: Any, unit: int, casing: int) -> None:
    """Add life, oil and tip relief, and what REXS has no attribute for."""
    rating = scene.rating
    draft.say(unit, operating_time=required_hours(rating, scene.duty))
    kept = content(rating, False)
    iso = kept.get("iso6336", {})
    names = ["life", "input_revolutions"]
    if rating.standard != "agma":
        names.append("overload_factor")
    if (oil := rating.iso6336.oil_grade) is not None:
        lubricant = draft.add("lubricant", "oil", viscosity_at_40_degree_celsius=oil.value)
        draft.relate("reference", origin=casing, referenced=lubricant)
        iso = {k: v for k, v in iso.items() if k != "oil_grade"}
    if (relief := rating.iso6336.tip_relief) is not None:
        for flank in [c for c in draft.components.values() if c.type == "cylindrical_gear_flank"]:
            tip = draft.add("tip_relief", tip_relief_depth=relief.value)
            draft.relate("reference", origin=flank.id, referenced=tip)
        iso = {k: v for k, v in iso.items() if k != "tip_relief"}
    rest = {"standard": rating.standard}
    rest |= {k: v for k, v in kept.items() if k not in (*names, "iso6336")}
    draft.say(unit, **{f"{CUSTOM}rating": toml_text(rest | ({"iso6336": iso} if iso else {}))})


def _results(draft: Draft, scene: Any, rating: DriveRating, meshes: Sequence[Mesh]) -> None:
    """Add contact ratios and measures, and of ISO 6336 factors, stresses and safeties."""
    iso = "ISO" in rating.by
    edition = f"_iso_6336_{scene.rating.iso6336.edition}"
    for row, mesh in zip(rating.meshes, meshes, strict=True):
        said: dict[str, Any] = {
            "radial_contact_ratio": row.transverse_contact_ratio,
            "overlap_contact_ratio": row.overlap_ratio,
            "total_contact_ratio": row.total_contact_ratio,
            "minimum_transverse_backlash": row.circumferential_backlash_mm,
            "maximum_transverse_backlash": row.circumferential_backlash_mm,
        }
        for factor in rating.factors if iso else ():
            if factor.stage == row.stage and factor.symbol in OF_MESH:
                said[OF_MESH[factor.symbol] + edition] = factor.pinion
        for number in mesh.stages:
            draft.say(number, **said)
    data_of = {"pinion": "pinions", "wheel": "wheels"}
    for gear in rating.gears:
        values = {name + edition: getattr(gear, field) for field, name in OF_GEAR.items() if iso}
        for number in getattr(meshes[gear.stage - 1], data_of[gear.member]):
            draft.say(number, number_of_load_cycles=gear.cycles, **values)
    for teeth in rating.teeth:
        for number in getattr(meshes[teeth.stage - 1], data_of[teeth.member]):
            draft.say(
                number,
                pitch_diameter=abs(teeth.working_pitch_diameter_mm),
                active_root_diameter=teeth.active_root_diameter_mm
                and abs(teeth.active_root_diameter_mm),
                tip_clearance=teeth.tip_clearance_mm,
            )
            of = next(r.of("gear") for r in draft.relations if r.of("stage_gear_data") == number)
            measures = {name: getattr(teeth, field) for field, name in MEASURES.items()}
            draft.say(of or 0, **{k: v and abs(v) for k, v in measures.items()})
