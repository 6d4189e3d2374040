"""The power flow of a REXS model: which parts turn as one, its stages in order, its shafts."""

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction

from gearopt.frozen import dataclass
from gearopt.scenes.drive.rexs.loads_read import SPEED, TORQUE, said_first
from gearopt.scenes.drive.rexs.model import (
    BETA,
    GEARS,
    Component,
    Model,
    as_number,
    in_unit,
    same,
    wrong,
)

OTHER_STAGES = ("bevel_stage", "hypoid_stage", "worm_stage")
JOINING = (
    *("coupling", "switchable_coupling", "feather_key_connection", "involute_spline_connection"),
    *("cylindrical_interference_fit", "tapered_interference_fit"),
)
CASING = "gear_casing"
THROUGH = {"ring": ("sun", "carrier"), "carrier": ("sun", "ring"), "sun": ("ring", "carrier")}
Bodies = Mapping[int, int]  # the number of the body that a component turns with


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


def bodies_of(model: Model) -> Bodies:
    """Which components turn as one: the number of their body, by component."""
    body = {number: number for number in model.components}

    def root(number: int) -> int:
        while body[number] != number:
            body[number] = body[body[number]]
            number = body[number]
        return number

    pins = {r.refs.get("shaft") for r in model.relations if r.type == "planet_pin"}
    for relation in model.relations:
        refs, pair = relation.refs, list[int]()
        kinds = {role: model.components[i].type for role, i in refs.items()}
        if relation.type == "assembly" and kinds["assembly"] in ("shaft", "planet_carrier"):
            if kinds["part"] not in GEARS or refs["assembly"] not in pins:  # on which planets turn
                pair = [refs["assembly"], refs["part"]]
        elif relation.type == "side" and kinds["assembly"] in JOINING:
            pair = [refs["inner_part"], refs["outer_part"]]
        elif relation.type == "planet_carrier_shaft":
            carriers = _parts(model, refs["planetary_stage"], "planet_carrier")
            pair = [refs["shaft"], *(c.id for c in carriers)][:2]
        if len(pair) == 2:
            body[root(pair[0])] = root(pair[1])
    return {number: root(number) for number in body}


def _parts(model: Model, stage: int, type: str) -> list[Component]:
    return model.related("assembly", "assembly", stage, "part", type)


def steps_of(model: Model, bodies: Bodies) -> list[Step]:
    """The stages of a model, planetary ones first."""
    for stage in model.of_type(*OTHER_STAGES):
        rule = f'is no stage of cylindrical gears, and kind = "drive" has none of type {stage.type}'
        raise wrong(stage, None, rule, "Remove it from the model")
    sets = model.of_type("planetary_stage")
    inside = {mesh.id for s in sets for mesh in _parts(model, s.id, "cylindrical_stage")}
    pairs = [s for s in model.of_type("cylindrical_stage") if s.id not in inside]
    steps = [_planetary(model, s, bodies) for s in sets] + [_pair(model, s, bodies) for s in pairs]
    if not steps:
        remedy = "Export the stages with their gears"
        raise wrong("relations", None, "has no relation of type stage: no gears mesh", remedy)
    return steps


def _meshing(model: Model, stage: Component) -> tuple[Component, Component]:
    """The two gears of a stage, a ring last; SceneError for gears that cannot mesh."""
    gears = [g for k in "12" for g in model.related("stage", "stage", stage.id, f"gear_{k}")]
    rule = f"has {len(gears) // 2} relations of type stage" if gears else "has no gears"
    if len(gears) == 2:
        odd = next((g for g in gears if g.type not in GEARS), None)
        rule = f"meshes {odd}, which is no cylindrical gear" if odd else ""
        rule = "has one gear twice" if gears[0] is gears[1] else rule
        rule = "meshes two rings" if {g.type for g in gears} == {"ring_gear"} else rule
    if rule:
        raise wrong(stage, None, rule, "Give it one relation of type stage, with two gears")
    same(gears, "normal_module")
    first, second = (g.number(BETA) or Decimal(0) for g in gears)
    inside = "ring_gear" in (g.type for g in gears)
    if second != (first if inside else -first):
        how = "equal" if inside else "opposite"
        rule = f"is not {how} to the {first} of {gears[0]}, with which it meshes in {stage}"
        raise wrong(gears[1].at(BETA), str(second), rule, "Correct the sign or the angle")
    first_gear, second_gear = gears if gears[0].type != "ring_gear" else gears[::-1]
    return first_gear, second_gear


def _pair(model: Model, stage: Component, bodies: Bodies) -> Step:
    """A pair of gears, or a pinion in a ring."""
    gears = sorted(_meshing(model, stage), key=_size)
    ratio = Fraction(*(int(g.needed("number_of_teeth")) for g in gears[::-1]))
    internal = gears[1].type == "ring_gear"
    named = dict(zip(("pinion", "ring" if internal else "wheel"), gears, strict=True))
    ends = bodies[gears[0].id], bodies[gears[1].id]
    return Step(stage, "internal" if internal else "parallel", named, ends, ratio, (stage,))


def _size(gear: Component) -> tuple[bool, Decimal]:
    return gear.type == "ring_gear", gear.needed("number_of_teeth")


def _planetary(model: Model, stage: Component, bodies: Bodies) -> Step:
    """A planetary stage: a sun, planets alike and a ring, of which one member stands still."""
    meshes = _parts(model, stage.id, "cylindrical_stage")
    pairs = [_meshing(model, mesh) for mesh in meshes]
    rings = {b.id for _, b in pairs if b.type == "ring_gear"}
    planets = {a.id for a, b in pairs if b.type == "ring_gear"}
    suns = {g.id for pair in pairs for g in pair} - rings - planets
    with_sun = {g.id for pair in pairs if suns & {g.id for g in pair} for g in pair}
    if len(rings) != 1 or len(suns) != 1 or with_sun - suns != planets:
        rule = "is no set of one sun, one ring and planets that mesh with both"
        raise wrong(stage, None, rule, "gearopt has no other planetary stage")
    if len(meshes) != 2 * len(planets):
        rule = f"has {len(meshes)} meshes, and {len(planets)} planets have two each"
        raise wrong(stage, None, rule, "Add the missing ones")
    carriers = _parts(model, stage.id, "planet_carrier")
    if not carriers:
        raise wrong(stage, None, "has no planet_carrier", "Add it as a part")
    sun, first, ring = (model.components[min(each)] for each in (suns, planets, rings))
    members = dict(sun=bodies[sun.id], carrier=bodies[carriers[0].id], ring=bodies[ring.id])
    fixed = _fixed(model, stage, members, bodies, suns | planets | rings)
    r = Fraction(*(int(g.needed("number_of_teeth")) for g in (ring, sun)))
    return Step(
        stage,
        "planetary",
        {"sun": sun, "planet": first, "ring": ring},
        (members[THROUGH[fixed][0]], members[THROUGH[fixed][1]]),
        {"ring": 1 + r, "carrier": r, "sun": 1 + 1 / r}[fixed],
        meshes,
        [model.components[i] for i in sorted(planets)],
        fixed,
    )


def _fixed(
    model: Model, stage: Component, members: Mapping[str, int], bodies: Bodies, inside: set[int]
) -> str:
    """The member that stands still: it is joined to the casing, or nothing else is joined to it."""
    still = {bodies[c.id] for c in model.of_type(CASING)}
    held = [name for name, body in members.items() if body in still]
    busy = {bodies[c.id] for c in model.of_type("external_load", *GEARS) if c.id not in inside}
    idle = [name for name, body in members.items() if body not in busy]
    if len(held) > 1:
        rule = f"has {' and '.join(held)} joined to the casing: nothing turns"
        raise wrong(stage, None, rule, "Leave one of these couplings")
    if not held and len(idle) != 1:
        rule = "does not say which of sun, carrier and ring stands still"
        raise wrong(stage, None, rule, "Couple that member's shaft to the gear_casing")
    return (held or idle)[0]


def in_order(
    model: Model, bodies: Bodies, remarks: list[str]
) -> tuple[dict[int, Fraction], list[tuple[Step, bool]]]:
    """Stages from the input on, each with whether it is entered at its faster shaft.

    First the bodies of the shafts, with the speed of the input over theirs.
    """
    steps = steps_of(model, bodies)
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
        rule = "are not joined into one series of shafts" if ends else "form a circle"
        listed = ", ".join(str(s.stage) for s in steps)
        raise wrong(listed, None, rule, "Join gears and shafts by relations of type assembly")
    first = _input(model, steps, bodies, ends)
    path = list(_path(touching, first))
    if against := _against(path):
        first = next(body for body in ends if body != first)
        path = list(_path(touching, first))
        if mixed := _against(path):
            rule = f"turns faster and {against[0].stage} slower than its input"
            raise wrong(mixed[0].stage, None, rule, "gearopt rates one of both sorts")
        remarks.append(
            f"{against[0].stage} increases the speed: the drive is described from its fast end, "
            "where without losses all stresses are the same"
        )
    shafts = {first: Fraction(1)}
    for step, forwards in path:
        near, far = step.ends if forwards else step.ends[::-1]
        shafts[far] = shafts[near] * (step.ratio if forwards else 1 / step.ratio)
    return shafts, path


def _against(path: Sequence[tuple[Step, bool]]) -> list[Step]:
    """Stages that are entered at their slower shaft, and cannot be."""
    return [step for step, forwards in path if not forwards and step.type != "parallel"]


def _path(touching: Mapping[int, Sequence[Step]], body: int) -> Iterator[tuple[Step, bool]]:
    """Yield stages in the order of a walk from a shaft."""
    last: Step | None = None
    while onwards := [s for s in touching[body] if s is not last]:
        last = onwards[0]
        forwards = last.ends[0] == body
        yield last, forwards
        body = last.ends[1] if forwards else last.ends[0]


def _input(model: Model, steps: Sequence[Step], bodies: Bodies, ends: Sequence[int]) -> int:
    """The end at which power enters: torque and speed of one sign; else the fast end."""
    case = model.cases[0] if model.cases else {}
    outside = [c for c in model.of_type("shaft", "external_load") if bodies[c.id] in ends]
    speeds: dict[int, Decimal] = {}
    for c in said_first(outside, case, SPEED, "shaft"):
        if n := c.number(SPEED):
            speeds.setdefault(bodies[c.id], n)
    powers = {c.id: c for c in said_first(outside, case, "power", "external_load")}
    for c in said_first(outside, case, TORQUE, "external_load"):
        body, torque, power = bodies[c.id], c.number(TORQUE), powers[c.id].number("power")
        if torque or power:
            flow = torque * speeds.get(body, torque) if torque else power
            return next(b for b in ends if (b == body) is bool(flow and flow > 0))
    return next(iter(speeds), next((s.ends[0] for s in steps if s.ends[0] in ends), ends[0]))


PARALLEL = Decimal("0.999999")  # cosine
AXES = ("u_axis_vector", "w_axis_vector", "support_vector")


def places(model: Model, bodies: Mapping[int, int], path: Sequence[int]) -> list[str]:
    """A line for every shaft after the first: its place from there, y along v, z along w.

    path: bodies of the shafts from the input on. None where a shaft does not say where it is, or
    is not parallel to the first.
    """
    shafts = [
        next((c for c in model.of_type("shaft") if bodies[c.id] == body and _says(c)), None)
        for body in path
    ]
    placed = [(c, [_vector(c, name) for name in AXES]) for c in shafts if c is not None]
    if not placed or len(placed) < len(shafts):
        return []
    _, (u, w, origin) = placed[0]
    v = [w[i - 2] * u[i - 1] - w[i - 1] * u[i - 2] for i in range(3)]
    lines: list[str] = []
    for k, (shaft, (axis, _, here)) in enumerate(placed[1:], 2):
        if abs(_dot(axis, u)) < PARALLEL:
            return []
        away = [a - b for a, b in zip(here, origin, strict=True)]
        y, z = (in_unit(_dot(away, along), "mm") for along in (v, w))
        lines.append(
            f"shaft {k} is {shaft}; with a table [layout] its place is a table [[place]] of "
            f'shaft = {k}, y = "{y}", z = "{z}"'
        )
    return lines


def _says(shaft: Component) -> bool:
    return all(map(shaft.has, AXES))


def _dot(a: Sequence[Decimal], b: Sequence[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _vector(component: Component, name: str) -> list[Decimal]:
    """A vector of three numbers."""
    value, _ = component.get(name)
    numbers = [as_number(x) for x in value] if isinstance(value, list) else []
    vector = [x for x in numbers if x is not None]
    if len(vector) != 3 or len(numbers) != 3:
        rule = "is no vector of three numbers"
        raise wrong(component.at(name), value, rule, "Write an array of three")
    return vector
