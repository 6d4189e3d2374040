"""A REXS model as the tables of a drive whose gears are given: power flow, stages, rating."""

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction

from gearopt.frozen import dataclass
from gearopt.scenes.drive.rexs.gears_read import (
    GEARS,
    GRADE,
    Keys,
    custom,
    flanks,
    gear_keys,
    material_of,
    module_of,
    needed,
    same,
)
from gearopt.scenes.drive.rexs.loads_read import SPEED, TORQUE, changed_first, loads, says
from gearopt.scenes.drive.rexs.model import Component, Model, Said, in_unit, wrong
from gearopt.scenes.drive.rexs.places import places

OTHER_STAGES = ("bevel_stage", "hypoid_stage", "worm_stage")
RIGID = ("coupling", "switchable_coupling", "feather_key_connection", "involute_spline_connection")
FITS = ("cylindrical_interference_fit", "tapered_interference_fit")
CASING = "gear_casing"
THROUGH = {"ring": ("sun", "carrier"), "carrier": ("sun", "ring"), "sun": ("ring", "carrier")}
APPLICATION = ("application_factor_iso_6336_2019", "application_factor_iso_6336_2006")
SHARED = ("mesh_load_factor_iso_6336_2019", "mesh_load_factor_iso_6336_2006")
OF_IDLER = (  # keys that are those of the wheel that it is
    *("module", "pinion_teeth", "pressure_angle", "helix_angle", "pinion_hand", "face_width"),
    "pinion",
)


@dataclass(frozen=True)
class Step:
    """A stage of the power flow, entered at a shaft: its gears by member, and its ratio.

    ends: bodies of the faster and the slower shaft, of a pair of the pinion's and the wheel's;
    ratio: of their speeds. meshes: its `cylindrical_stage`. planets: all of them.
    """

    stage: Component
    type: str
    gears: Mapping[str, Component]
    ends: tuple[int, int]
    ratio: Fraction
    meshes: Sequence[Component]
    planets: Sequence[Component] = ()
    fixed: str = ""


def tables_of(model: Model, remarks: list[str]) -> Keys:
    """Tables of a drive; values that the file says are `Said`, so are samples of what it lacks."""
    for stage in model.of_type(*OTHER_STAGES):
        rule = f'is no stage of cylindrical gears, and kind = "drive" has none of type {stage.type}'
        raise wrong(str(stage), None, rule, "Remove it from the model")
    bodies = _bodies(model)
    steps = [*_planetary(model, bodies), *_pairs(model, bodies)]
    if not steps:
        remedy = "Export the stages with their gears"
        raise wrong("relations", None, "has no relation of type stage: no gears mesh", remedy)
    start, path = _in_order(model, steps, bodies, remarks)
    shafts = {start: Fraction(1)}
    for step, forwards in path:
        near, far = step.ends if forwards else step.ends[::-1]
        shafts[far] = shafts[near] * (step.ratio if forwards else 1 / step.ratio)
    if all(step.type == "parallel" for step, _ in path):
        remarks += places(model, bodies, list(shafts))
    unit = next(iter(model.of_type("gear_unit")), None)
    tables: Keys = loads(model, bodies, shafts, unit, remarks)
    tables["stage"] = _stages(model, path, remarks)
    of_gears = [c for s in steps for g in s.gears.values() for c in material_of(model, g)]
    density = {value for c in of_gears if (value := c.number("density")) is not None}
    if len(density) == 1:
        tables["objective"] = {"density": in_unit(density.pop(), "kg / dm^3")}
    tables["rating"] = _rating(model, unit, tables["stage"], tables.pop("life"), remarks)
    return {k: tables[k] for k in ("duty", "stage", "rating", "load", "objective") if tables.get(k)}


def _bodies(model: Model) -> dict[int, int]:
    """Which components turn as one: the number of their body, by component."""
    body = {number: number for number in model.components}

    def root(number: int) -> int:
        while body[number] != number:
            body[number] = body[body[number]]
            number = body[number]
        return number

    pins = {r.of("shaft") for r in model.relations if r.type == "planet_pin"}
    for relation in model.relations:
        kinds = {role: model.components[i].type for role, i in relation.refs}
        pair: tuple[int | None, int | None] = (None, None)
        if relation.type == "assembly" and kinds["assembly"] in ("shaft", "planet_carrier"):
            pair = relation.of("assembly"), relation.of("part")
            if kinds["part"] in GEARS and pair[0] in pins:
                continue  # a planet turns on its pin
        elif relation.type == "side" and kinds["assembly"] in (*RIGID, *FITS):
            pair = relation.of("inner_part"), relation.of("outer_part")
        elif relation.type == "planet_carrier_shaft":
            carriers = _carriers(model, relation.of("planetary_stage"))
            pair = relation.of("shaft"), carriers[0].id if carriers else None
        if None not in pair:
            body[root(pair[0])] = root(pair[1])  # type: ignore[arg-type]
    return {number: root(number) for number in body}


def _carriers(model: Model, stage: int | None) -> list[Component]:
    parts = model.related("assembly", "assembly", stage or 0, "part")
    return [c for c in parts if c.type == "planet_carrier"]


def _meshing(model: Model, stage: Component) -> tuple[Component, Component]:
    """The two gears of a stage."""
    pairs = [r for r in model.relations if r.type == "stage" and r.of("stage") == stage.id]
    if len(pairs) != 1:
        rule = f"has {len(pairs)} relations of type stage" if pairs else "has no gears"
        raise wrong(str(stage), None, rule, "Give it one relation of type stage")
    first, second = (model.components[pairs[0].of(f"gear_{k}") or 0] for k in (1, 2))
    for gear in (first, second):
        if gear.type not in GEARS:
            rule = f"meshes {gear}, which is no cylindrical gear"
            raise wrong(str(stage), None, rule, "Correct the relation of type stage")
    if first.id == second.id:
        raise wrong(str(stage), None, "has one gear twice", "Correct the relation of type stage")
    return (second, first) if first.type == "ring_gear" else (first, second)


def _pairs(model: Model, bodies: Mapping[int, int]) -> Iterator[Step]:
    """Pairs of gears, of which none has a planetary stage."""
    inside = {c.id for s in model.of_type("planetary_stage") for c in _parts(model, s)}
    for stage in model.of_type("cylindrical_stage"):
        if stage.id in inside:
            continue
        gears = _meshing(model, stage)
        _check_pair(stage, gears)
        teeth = [int(needed(g, "number_of_teeth")) for g in gears]
        internal = gears[1].type == "ring_gear"
        if teeth[1] < teeth[0] and not internal:
            gears, teeth = gears[::-1], teeth[::-1]
        names = ("pinion", "ring" if internal else "wheel")
        yield Step(
            stage,
            "internal" if internal else "parallel",
            dict(zip(names, gears, strict=True)),
            (bodies[gears[0].id], bodies[gears[1].id]),
            Fraction(teeth[1], teeth[0]),
            (stage,),
        )


def _check_pair(stage: Component, gears: Sequence[Component]) -> None:
    """Refuse gears that cannot mesh: of other modules, or helices that do not fit."""
    same(gears, "normal_module")
    angle = "helix_angle_reference_diameter"
    first, second = (g.number(angle) or Decimal(0) for g in gears)
    inside = "ring_gear" in (g.type for g in gears)
    if second != (first if inside else -first):
        how = "equal" if inside else "opposite"
        rule = f"is not {how} to the {first} of {gears[0]}, with which it meshes in {stage}"
        raise wrong(gears[1].at(angle), str(second), rule, "Correct the sign or the angle")


def _parts(model: Model, stage: Component) -> list[Component]:
    """The meshes of a planetary stage."""
    parts = model.related("assembly", "assembly", stage.id, "part")
    return [c for c in parts if c.type == "cylindrical_stage"]


def _planetary(model: Model, bodies: Mapping[int, int]) -> Iterator[Step]:
    """Planetary stages: a sun, planets alike and a ring, of which one member stands still."""
    for stage in model.of_type("planetary_stage"):
        meshes = [(mesh, *_meshing(model, mesh)) for mesh in _parts(model, stage)]
        rings = {b.id for _, _, b in meshes if b.type == "ring_gear"}
        planets = {a.id for _, a, b in meshes if b.type == "ring_gear"}
        others = {g.id for _, *pair in meshes for g in pair} - rings - planets
        with_sun = {g.id for _, *pair in meshes for g in pair if {p.id for p in pair} & others}
        if len(rings) != 1 or len(others) != 1 or with_sun - others != planets:
            rule = "is no set of one sun, one ring and planets that mesh with both"
            raise wrong(str(stage), None, rule, "gearopt has no other planetary stage")
        if len(meshes) != 2 * len(planets):
            rule = f"has {len(meshes)} meshes, and {len(planets)} planets have two each"
            raise wrong(str(stage), None, rule, "Add the missing ones")
        for mesh, *pair in meshes:
            _check_pair(mesh, pair)
        each = [model.components[i] for i in sorted(planets)]
        sun, ring = model.components[others.pop()], model.components[rings.pop()]
        carriers = _carriers(model, stage.id)
        if not carriers:
            raise wrong(str(stage), None, "has no planet_carrier", "Add it as a part")
        members = {
            "sun": bodies[sun.id],
            "carrier": bodies[carriers[0].id],
            "ring": bodies[ring.id],
        }
        z_sun, z_ring = (int(needed(g, "number_of_teeth")) for g in (sun, ring))
        fixed = _fixed(model, stage, members, bodies)
        r = Fraction(z_ring, z_sun)
        yield Step(
            stage,
            "planetary",
            {"sun": sun, "planet": each[0], "ring": ring},
            (members[THROUGH[fixed][0]], members[THROUGH[fixed][1]]),
            {"ring": 1 + r, "carrier": r, "sun": 1 + 1 / r}[fixed],
            [mesh for mesh, *_ in meshes],
            each,
            fixed,
        )


def _fixed(
    model: Model, stage: Component, members: Mapping[str, int], bodies: Mapping[int, int]
) -> str:
    """The member that stands still: it is joined to the casing, or nothing else is joined to it."""
    still = {bodies[c.id] for c in model.of_type(CASING)}
    if held := [name for name, body in members.items() if body in still]:
        if len(held) == 1:
            return held[0]
        rule = f"has {' and '.join(held)} joined to the casing: nothing turns"
        raise wrong(str(stage), None, rule, "Leave one of these couplings")
    inside = {g.id for mesh in _parts(model, stage) for g in _meshing(model, mesh)}
    busy = {bodies[c.id] for c in model.of_type("external_load", *GEARS) if c.id not in inside}
    idle = [name for name, body in members.items() if body not in busy]
    if len(idle) == 1:
        return idle[0]
    rule = "does not say which of sun, carrier and ring stands still"
    raise wrong(str(stage), None, rule, "Couple that member's shaft to the gear_casing")


def _in_order(
    model: Model, steps: Sequence[Step], bodies: Mapping[int, int], remarks: list[str]
) -> tuple[int, list[tuple[Step, bool]]]:
    """The input shaft, and the stages from there on, each with whether it is entered there."""
    touching: dict[int, list[Step]] = {}
    for step in steps:
        for body in step.ends:
            touching.setdefault(body, []).append(step)
    for body, met in touching.items():
        if len(met) > 2:
            listed = ", ".join(str(s.stage) for s in met)
            rule = f"share one shaft, and a drive is a series: {model.components[body]}"
            raise wrong(listed, None, rule, "Remove all but one power path")
    ends = [body for body, met in touching.items() if len(met) == 1]
    if len(ends) != 2:
        rule = "form a circle" if not ends else "are not joined into one series of shafts"
        listed = ", ".join(str(s.stage) for s in steps)
        raise wrong(listed, None, rule, "Join gears and shafts by relations of type assembly")
    first = _input(model, steps, bodies, ends)
    path = _path(touching, first)
    against = [s for s, forwards in path if not forwards and s.type != "parallel"]
    if against:
        other = next(body for body in ends if body != first)
        first, path = other, _path(touching, other)
        if mixed := [s for s, forwards in path if not forwards and s.type != "parallel"]:
            rule = f"turns faster and {against[0].stage} slower than its input"
            raise wrong(str(mixed[0].stage), None, rule, "gearopt rates one of both sorts")
        remarks.append(
            f"{against[0].stage} increases the speed: the drive is described from its fast end, "
            "where without losses all stresses are the same"
        )
    return first, path


def _path(touching: Mapping[int, Sequence[Step]], body: int) -> list[tuple[Step, bool]]:
    """Stages in the order of a walk from a shaft."""
    path: list[tuple[Step, bool]] = []
    last: Step | None = None
    while onwards := [s for s in touching[body] if s is not last]:
        last = onwards[0]
        forwards = last.ends[0] == body
        path.append((last, forwards))
        body = last.ends[1] if forwards else last.ends[0]
    return path


def _input(
    model: Model, steps: Sequence[Step], bodies: Mapping[int, int], ends: Sequence[int]
) -> int:
    """The end at which power enters: torque and speed of one sign; else the fast end."""
    case = model.cases[0] if model.cases else {}
    speeds: dict[int, Decimal] = {}
    for c in changed_first(model.of_type("shaft"), case, SPEED):
        if bodies[c.id] in ends and (n := says(c, case, SPEED).number(SPEED)):
            speeds.setdefault(bodies[c.id], n)
    for c in changed_first(model.of_type("external_load"), case, TORQUE):
        body, power = bodies[c.id], says(c, case, "power").number("power")
        torque = says(c, case, TORQUE).number(TORQUE)
        if body in ends and (torque or power):
            flow = torque * speeds.get(body, torque) if torque else power
            return next(b for b in ends if (b == body) is bool(flow and flow > 0))
    if speeds:
        return next(iter(speeds))
    return next((s.ends[0] for s in steps if s.ends[0] in ends), ends[0])


def _stages(model: Model, path: Sequence[tuple[Step, bool]], remarks: list[str]) -> list[Keys]:
    """Tables of the stages in their order."""
    tables: list[Keys] = []
    last: tuple[Step, bool] | None = None
    for step, forwards in path:
        table = _stage(model, step, remarks)
        if not forwards:
            table["driver"] = Said("wheel", str(step.stage))
        if last is not None:
            driven = list(last[0].gears.values())[-1 if last[1] else 0]
            drives = list(step.gears.values())[0 if forwards else -1]
            if driven.id == drives.id:
                if not (last[1] and forwards and step.type == "parallel"):
                    rule = "is an idler of more teeth than the gear that it drives"
                    raise wrong(str(driven), None, rule, "Rate each of its meshes as a pair")
                table = {k: v for k, v in table.items() if k not in OF_IDLER}
                table["idler"] = Said(True, str(driven))
        tables.append(table)
        last = step, forwards
    return tables


def _teeth(gear: Component) -> tuple[int, str]:
    return int(needed(gear, "number_of_teeth")), gear.at("number_of_teeth")


def _stage(model: Model, step: Step, remarks: list[str]) -> Keys:
    """The table of a stage."""
    first, *_ = gears = list(step.gears.values())
    module_of(first)
    table: Keys = {}
    for mesh in step.meshes:
        table |= custom(mesh, "stage")
    table |= {"type": step.type} if step.type != "parallel" else {}
    if step.type == "planetary":
        table |= {"planets": Said(len(step.planets), str(step.stage))}
        table |= {"fixed": step.fixed} if step.fixed != "ring" else {}
    table["module"] = first.said("normal_module")
    for member, gear in step.gears.items():
        table[f"{member}_teeth"] = Said(*_teeth(gear))
    sides = [f for g in gears for f in flanks(model, g)]
    if (alpha := same(sides, "normal_pressure_angle")) is not None:
        table["pressure_angle"] = alpha[0].said("normal_pressure_angle")
    beta = first.number("helix_angle_reference_diameter")
    if beta:
        table["helix_angle"] = first.said("helix_angle_reference_diameter", sign=False)
        if step.type == "parallel":
            table["pinion_hand"] = "right" if beta > 0 else "left"
    table |= _distance(step) | _factors(step)
    widths = {g.id: needed(g, "face_width") for g in gears}
    narrow = min(gears, key=lambda g: widths[g.id])
    table["face_width"] = narrow.said("face_width")
    for member, gear in step.gears.items():
        keys = gear_keys(model, gear, remarks)
        if step.type == "parallel" and widths[gear.id] != widths[narrow.id]:
            keys["face_width"] = gear.said("face_width")
        table[member] = keys
    _check_planets(model, step)
    if step.type != "parallel" and len(set(widths.values())) > 1:
        remarks.append(f"{step.stage}: the narrowest face width is taken for all of its gears")
    return table


def _distance(step: Step) -> Keys:
    known = same(step.meshes, "center_distance")
    return {} if known is None else {"centre_distance": known[0].said("center_distance")}


def _factors(step: Step) -> Keys:
    """Application factor and mesh load factor of a stage."""
    keys: Keys = {}
    for names, key in ((APPLICATION, "overload_factor"), (SHARED, "mesh_load_factor")):
        for name in names:
            known = same(step.meshes, name)
            if known is not None and key not in keys:
                keys[key] = known[0].said(name)
    if step.type != "planetary":
        keys.pop("mesh_load_factor", None)
    return keys


def _check_planets(model: Model, step: Step) -> None:
    """Refuse planets that are not alike."""
    plain = [
        {k: v.value for k, v in gear_keys(model, planet, []).items()}
        | {n: planet.number(n) for n in ("normal_module", "number_of_teeth", "face_width")}
        for planet in step.planets
    ]
    for planet, keys in zip(step.planets[1:], plain[1:], strict=True):
        if differing := [k for k in {**plain[0], **keys} if plain[0].get(k) != keys.get(k)]:
            rule = f"differs from {step.planets[0]} in {', '.join(differing)}"
            raise wrong(str(planet), None, rule, "gearopt has planets that are alike")


def _rating(
    model: Model,
    unit: Component | None,
    stages: Sequence[Keys],
    life: Said | None,
    remarks: list[str],
) -> Keys:
    """The table of the rating, with samples of what it needs and the file does not say."""
    rating: Keys = {"standard": "iso6336"} | (custom(unit, "rating") if unit else {})
    held = rating.pop("iso6336", Said({}, ""))
    iso: Keys = dict(held.value)
    if life is not None:
        rating["life"] = life
    elif "input_revolutions" not in rating:
        rating["life"] = Said("20000 h", "", True)
    oiled = model.of_type(CASING, "cylindrical_stage")
    oils = [c for o in oiled for c in model.related("reference", "origin", o.id, "referenced")]
    for lubricant in (c for c in oils if c.type == "lubricant"):
        if (grade := lubricant.said("viscosity_at_40_degree_celsius")) is not None:
            iso.setdefault("oil_grade", grade)
    if (relief := _relief(model, remarks)) is not None:
        iso["tip_relief"] = relief
    standard = getattr(rating["standard"], "value", rating["standard"])
    gears = [g for s in stages for g in s.values() if isinstance(g, dict)]
    if standard != "agma":
        if any(g.has(GRADE) for g in model.of_type(*GEARS)):
            iso["tolerances"] = "2013"
        if not iso.keys() & {"accuracy_grade"} and "accuracy" not in rating:
            grades = [g["accuracy_grade"] for g in gears if "accuracy_grade" in g]
            lacking = not grades or len(grades) < len(gears)
            coarsest = Said(6, "", True) if lacking else max(grades, key=lambda g: f"{g.value:>4}")
            iso["accuracy_grade"] = coarsest
        for g in gears:
            if not g.keys() & {"iso_material", "steel", "treatment"}:
                g["iso_material"] = Said("Eh", "", True)
        rating["iso6336"] = iso
    return {k: v for k, v in rating.items() if v != {}}


def _relief(model: Model, remarks: list[str]) -> Said | None:
    """Tip relief of all flanks, where they have one; REXS has depths in mm."""
    reliefs = [c for c in model.of_type("tip_relief") if c.has("tip_relief_depth")]
    known = {c.number("tip_relief_depth") for c in reliefs}
    if len(known) != 1 or len(reliefs) < len(model.of_type(*GEARS)):
        if reliefs:
            remarks.append("tip_relief: it is not the same at all flanks, and is left out")
        return None
    return reliefs[0].said("tip_relief_depth")
