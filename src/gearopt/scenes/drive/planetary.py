"""Stages with planets, or a pinion in a ring: how their tables fit together, and their ways."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from gearopt.formulations.drive.planetary import (
    LARGE,
    PLANET,
    SUN,
    Cutting,
    InPlanetaryMesh,
    Planets,
)
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import Stage
from gearopt.formulations.strength.standard import Option
from gearopt.physics.gears import RIM, Cutter
from gearopt.physics.iso6336.bending_factors import THIN_RING
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS
from gearopt.scenes.drive.idlers import copied
from gearopt.scenes.drive.rating.checks import check_objective, check_rated
from gearopt.scenes.drive.rating.gears import loads, required_hours
from gearopt.scenes.drive.rating.materials import check_materials, choices
from gearopt.scenes.drive.rating.options import of_stage, option
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import ShiftTable, StageTable
from gearopt.scenes.drive.tables.iso6336 import of_meshes
from gearopt.scenes.drive.tables.planetary import (
    INTERNAL,
    OF_INTERNAL,
    OWN,
    PARALLEL,
    PLANETARY,
    REDUCTIONS,
    bent,
    gear_of,
)
from gearopt.scenes.drive.tables.rating import GearTable, RatingTable, with_shared
from gearopt.scenes.drive.toothings import check_tools, rack
from gearopt.scenes.drive.without_planets import against, lacking
from gearopt.scenes.reading.choices import values_of
from gearopt.scenes.reading.fields import refuse

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

OF_PAIRS = {  # keys of a stage that one with planets, or a pinion in a ring, does not have
    PLANETARY: ("pinion_teeth", "wheel_teeth", "pinion", "wheel"),
    INTERNAL: ("wheel_teeth", "wheel"),
}
NOT_YET = (  # that no stage with a ring takes
    *("pinion_face_width_excess", "overlap_ratio", "axial_force", "driver", "pinion_hand"),
    *("shaft", "idler"),
)
MEMBERS = {PLANETARY: ("sun", "planet", "ring"), INTERNAL: ("pinion", "ring")}
NAMES = {  # of what checks call the gears of a pair
    PLANETARY: {"pinion": "sun", "wheel": "planet", "pinion_teeth": "sun_teeth"},
    INTERNAL: {"wheel": "ring"},
}
RING_TEETH = {"wheel_teeth": "ring_teeth"}
OF_INNER = {"pinion": "planet", "wheel": "ring"}
OF_MESH = ("I", "K_B", "K_s", "J", "s_at", "s_ac", "Y_N", "Z_N", "C_H")  # given to AGMA
OF_GEAR = (  # keys of gears that no stage with planets or a ring takes
    *("contacts", "reversed_load", "face_width", "rim_thickness", "web_thickness"),
    "web_over_face_width",
)


def with_gears_named(stages: tuple[StageTable, ...]) -> tuple[StageTable, ...]:
    """Stages in which sun and planet, or pinion and ring, are what checks call pinion and wheel.

    Keys that mean nothing of a type are refused.
    """
    tables = []
    for k, stage in enumerate(stages):
        each = [meaningless(kind) for kind in stage.types]
        wrong = [name for name in each[0] if all(name in names for names in each)]
        if name := next((name for name in wrong if name in stage.model_fields_set), None):
            kinds = " or ".join(f'"{kind}"' for kind in stage.types)
            rule = f"needs {_kinds(name)}" if PARALLEL in stage.types else f"is not of {kinds}"
            if "type" not in stage.model_fields_set:  # it may be forgotten
                raise refuse(rule, f"Write {_kinds(name)}, or remove it", (k, name), "tell")
            other = (NAMES.get(stage.type, {}) | RING_TEETH).get(name)
            if other and PARALLEL not in stage.types and other not in stage.model_fields_set:
                raise refuse(rule, f"Write {other} in its place", (k, name), "tell")
            raise refuse(rule, at=(k, name), action="remove")
        for name in of_meshes(stage.given_iso6336) if stage.type != PLANETARY else ():
            rule = 'has values of two meshes, which a stage of type = "planetary" has'
            raise refuse(rule, at=(k, "given_iso6336", name), action="remove")
        if stage.type == PLANETARY and "K_gamma" in stage.given_iso6336.factors():
            tell = "Write mesh_load_factor in the [[stage]]"
            raise refuse("has another name here", tell, (k, "given_iso6336", "K_gamma"), "tell")
        tables.append(stage.with_gears_named())
    return tuple(tables)


def meaningless(kind: str) -> tuple[str, ...]:
    """Keys of a stage that mean nothing of a type."""
    if kind == INTERNAL:
        return (*OF_PAIRS[kind], *(name for name in OWN if name not in OF_INTERNAL))
    return OF_PAIRS.get(kind, OWN)


def _kinds(name: str) -> str:
    both = 'type = "planetary" or "internal"' if name in OF_INTERNAL else 'type = "planetary"'
    return both


def inner(stage: StageTable) -> StageTable:
    """A planetary stage as its mesh of planet and ring."""
    return copied(stage, {"pinion": bent(stage.planet), "wheel": gear_of(stage.ring)})


def every_mesh(stages: Sequence[StageTable]) -> tuple[StageTable, ...]:
    """Tables of stages, and those of planet and ring beside the ones of sun and planet."""
    rings = (inner(stage) for stage in stages if stage.type == PLANETARY and stage.as_mesh is None)
    return (*stages, *rings)


def renamed(scene: "Scene", wrong: PydanticCustomError, names: Any = None) -> PydanticCustomError:
    """The refusal of a check of pairs, by the names of the gears of a stage."""
    context = dict(wrong.context or {})
    place = tuple(context.get("at", ()))
    if len(place) > 2 and place[0] == "stage" and place[1] < len(scene.stage):
        kind = scene.stage[place[1]].type
        called = names if names and kind == PLANETARY else NAMES.get(kind, {})
        called = called | (RING_TEETH if kind in NAMES else {})
        context["at"] = (*place[:2], called.get(place[2], place[2]), *place[3:])
    return PydanticCustomError("gearopt", "{rule}", context)


def check_rings(scene: "Scene", rating: RatingTable) -> None:
    """Check the materials of planets and rings, as those of pairs are."""
    if not any(stage.type == PLANETARY for stage in scene.stage):
        return
    stages = [inner(stage) if stage.type == PLANETARY else stage for stage in scene.stage]
    places = [(("stage", k), stage) for k, stage in enumerate(stages)]
    try:
        check_materials(places, scene.gears, scene.material)
        check_rated(rating, scene.gears, stages, scene.load, scene.material)
        check_objective(scene.objective, scene.gears, stages, scene.material)
        check_tools(tuple(stages), scene.gears)
    except PydanticCustomError as wrong:
        raise renamed(scene, wrong, OF_INNER) from None


def check_planetary(scene: "Scene") -> None:
    """Refuse what does not go together with planets or a ring."""
    for k, stage in enumerate(scene.stage):
        if not stage.epicyclic:
            continue
        if wrong := next(against(scene, stage, k), None):
            raise wrong
        if scene.to_size and not scene.given and (wrong := lacking(scene, stage)):
            raise wrong
        for name in NOT_YET:
            if getattr(stage, name):
                rule = f'is not of type = "{stage.type}"'
                raise refuse(rule, at=("stage", k, name), action="remove")
        _check_gears(scene, stage, k)
        _check_teeth(scene, stage, k)
        _check_given(scene, stage, k)


def _check_gears(scene: "Scene", stage: StageTable, k: int) -> None:
    """Refuse keys of gears that a stage with a ring sets, or does not have."""
    for name in OF_GEAR:
        for place, table in ((("gears",), scene.gears), (("stage", k, "pinion"), stage.pinion)):
            written = place[0] == "gears" or stage.type == INTERNAL
            if written and getattr(table, name, None) is not None:
                rule = f'does not go together with type = "{stage.type}"'
                raise refuse(rule, at=(*place, name), action="remove")
    for member in MEMBERS[stage.type]:
        thinner = getattr(stage, member).thickness_allowance
        if thinner is not None and (scene.to_size or thinner.number > 0):
            rule = "is for gears that are given, and below zero: teeth are thinned"
            raise refuse(rule, at=("stage", k, member, "thickness_allowance"), action="remove")
    if stage.ring.outside_diameter is not None and gear_of(stage.ring).rim_over_module is not None:
        rule = "conflicts with outside_diameter; one is enough"
        raise refuse(rule, at=("stage", k, "ring", "rim_over_module"), action="remove")
    of_all = scene.rating.iso6336.given if scene.rating else stage.given_iso6336
    given = of_all.factors() | stage.given_iso6336.factors()
    iso = "Y_B" not in given and (scene.rating is None or scene.rating.standard != "agma")
    rim = gear_of(stage.ring).rim_over_module
    if iso and rim is not None and rim <= THIN_RING:
        rule = f"is {THIN_RING:g} or less, for which ISO 6336 has no Y_B of rings"
        raise refuse(rule, 3.5, ("stage", k, "ring", "rim_over_module"))
    most = stage.ring_teeth or scene.limits.wheel_teeth
    if (
        stage.ring.cutter_teeth is not None
        and most
        and most[1]
        and most[1] <= stage.ring.cutter_teeth
    ):
        rule = f"is no less than the ring has, {most[1]}: the cutter runs within it"
        raise refuse(rule, most[1] // 3, ("stage", k, "ring", "cutter_teeth"), "sample")
    if stage.ring.cutter_teeth is None:
        for name in ("cutter_profile_shift", "cutter_addendum", "cutter_tip_radius"):
            if getattr(stage.ring, name) is not None:
                rule = "needs cutter_teeth, of the cutter that shapes the ring"
                raise refuse(rule, at=("stage", k, "ring", name), action="remove")
    sized = scene.to_size and not scene.given
    planet = with_shared(stage.wheel if stage.type == PLANETARY else stage.pinion, scene.gears)
    if sized and planet.tool_protuberance and gear_of(stage.ring).tip_alteration is None:
        rule = "is missing: beside a tool_protuberance of its mates it has no rule"
        raise refuse(rule, -0.1, ("stage", k, "ring", "tip_alteration"), "sample")
    if sized and stage.type == PLANETARY and gear_of(stage.ring).profile_shift is not None:
        rule = "follows from the distance of sun and planet"
        raise refuse(rule, at=("stage", k, "ring", "profile_shift"), action="remove")


def _check_given(scene: "Scene", stage: StageTable, k: int) -> None:
    """Refuse factors of AGMA that are those of one mesh, of stages that have two."""
    assert scene.rating
    tables = (("stage", k, "given"), stage.given), (("rating", "given"), scene.rating.given)
    for place, table in tables if stage.type == PLANETARY else ():
        for symbol in OF_MESH:
            if getattr(table, symbol) is not None:
                rule = "is of one mesh: sun and planet, and planet and ring have their own"
                raise refuse(rule, at=(*place, symbol), action="remove")


def _with_room(scene: "Scene", stage: StageTable) -> int:
    """How many planets have room, by reference circles; 0 where the stage has no ratio asked.

    Pi/N above asin(z_p/(z_s + z_p)), z_p = (z_r - z_s)/2.
    """
    if len(scene.stage) > 1 or not scene.duty.asks_ratio:
        return 0
    asked = float(max(scene.duty.total_ratio, 1 / scene.duty.total_ratio))
    if stage.held != "carrier":  # z_r/z_s of the ratio, or z_s/z_r
        asked -= 1.0
    asked = max(asked, 1.0 / asked) if asked > 0.0 else 1.0
    return 0 if asked == 1.0 else math.floor(math.pi / math.asin((asked - 1.0) / (asked + 1.0)))


def _check_teeth(scene: "Scene", stage: StageTable, k: int) -> None:
    """Refuse numbers of planets without K_gamma, and reductions that leave no whole teeth."""
    if stage.mesh_load_factor is None:
        for count in stage.counts if stage.type == PLANETARY else ():
            if count and count not in MESH_LOAD_FACTORS:
                if 3 <= (most := _with_room(scene, stage)) < count:
                    rule = f"{count} have no room at this ratio, about {most} do by their circles"
                    write = [stage.counts[0], most] if stage.counts[0] < most else most
                    raise refuse(rule, write, ("stage", k, "planets"))
                rule = f"is missing: {count} planets have no K_gamma by default"
                raise refuse(rule, 1.1, ("stage", k, "mesh_load_factor"), "sample")
        of_all = scene.rating and scene.rating.iso6336.given.factors().get("K_gamma")
        if stage.type == PLANETARY and of_all:
            rule = "is missing beside K_gamma of [rating.iso6336.given], which is not of planets"
            raise refuse(rule, of_all, ("stage", k, "mesh_load_factor"), "sample")
    if stage.equally_spaced is False and stage.mesh_order in ("simultaneous", "sequential"):
        rule = "is of equally spaced planets"
        raise refuse(rule, at=("stage", k, "mesh_order"), action="remove")
    for step in stage.planet_teeth_reduction or ():
        if (2 * step).denominator != 1:
            rule = "has a value that is no multiple of 0.5"
            raise refuse(rule, [0, 0.5, 1], ("stage", k, "planet_teeth_reduction"), "sample")
    if stage.held == "sun" and stage.ring_teeth is None and not scene.limits.wheel_teeth:
        rule = "is missing: a ring that drives needs a range"
        raise refuse(rule, [60, 140], ("stage", k, "ring_teeth"), "sample")
    if stage.held == "sun" and not (stage.face_width or stage.face_width_over_diameter):
        rule = "is missing: over the ring's diameter, where the sun is held; [gears] has the sun's"
        raise refuse(rule, [0.1, 0.3], ("stage", k, "face_width_over_diameter"), "sample")


def cuttings(scene: "Scene", stage: StageTable) -> tuple[Cutting, ...]:
    """Ways to cut the gears of a stage: by the sums of profile shifts that are given."""
    first_two = (stage.pinion, stage.pinion if stage.type == INTERNAL else stage.wheel)
    tables = [with_shared(gear, scene.gears) for gear in (*first_two, gear_of(stage.ring))]
    pressure = (stage.pressure_angle or scene.gears.pressure_angle).value
    first, second, third = (rack(table, pressure) for table in tables)
    cutter = None
    if stage.ring.cutter_teeth is not None:
        cutter = Cutter(
            float(stage.ring.cutter_teeth),
            float(stage.ring.cutter_profile_shift or 0),
            float(stage.ring.cutter_addendum or third.dedendum),
            float(stage.ring.cutter_tip_radius or 0),
        )
    outside = stage.ring.outside_diameter
    x = [_number(table.profile_shift) for table in tables]
    tips = [_number(table.tip_alteration) for table in tables]
    width = stage.face_width.value if stage.face_width else None
    thinner = [t.thickness_allowance.value if t.thickness_allowance else 0.0 for t in tables]
    cutting = Cutting(
        scene.helix_angles(stage)[0].value,
        (first, second, third),
        cutter,
        (x[0], x[1], x[2]),
        None,
        (tips[0], tips[1], tips[2]),
        values_of(stage.centre_distance)[0].value if stage.centre_distance is not None else None,
        float(tables[2].rim_over_module or RIM),
        outside.value if outside else None,
        (blank(tables[0], width), blank(tables[1], width)),
        (thinner[0], thinner[1], thinner[2]),
    )
    shift = scene.shift or ShiftTable()
    if stage.type == INTERNAL or None not in cutting.shifts[:2]:
        return (cutting,)
    sums = [float(total) for total in values_of(shift.sum)] if shift.sum is not None else [None]
    starts = [x[0]]
    if shift.pinion_shift is not None and x[0] is None:
        starts = [float(start) for start in values_of(shift.pinion_shift)]
    return tuple(
        replace(cutting, shift_sum=total, shifts=(start, x[1], x[2]))
        for total, start in product(sums, starts)
    )


def _number(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def ways(scene: "Scene", stage: StageTable) -> Iterator[Planets]:
    """Ways of making a stage, without its materials."""
    diameter = stage.wheel_diameter or scene.limits.wheel_diameter
    usual = scene.limits.wheel_teeth or (1, None)
    sun = stage.pinion_teeth or scene.limits.pinion_teeth
    reductions = stage.planet_teeth_reduction or REDUCTIONS
    fewer = [0] if stage.type == INTERNAL else [int(2 * step) for step in reductions]
    each = stage.sun_teeth, stage.planet_teeth, stage.ring_teeth
    if all(ends is not None and ends[0] == ends[1] for ends in each):
        z_s, z_p, z_r = (ends[0] for ends in each if ends is not None)
        fewer = [z_r - z_s - 2 * z_p]
    for cutting, count, less in product(cuttings(scene, stage), stage.counts, fewer):
        yield Planets(
            cutting,
            count,
            stage.held,
            less,
            _span(sun),
            _span(stage.planet_teeth or (1, None)),
            _span(stage.ring_teeth or usual),
            stage.equally_spaced is not False,
            stage.mesh_order or "any",
            Planets.clearance if stage.planet_clearance is None else float(stage.planet_clearance),
            diameter.value if diameter else math.inf,
            carrier=float(stage.carrier_over_face_width or 0),
        )


def _span(ends: tuple[int, int | None]) -> tuple[float, float]:
    return float(ends[0]), LARGE if ends[1] is None else float(ends[1])


def stage_with_planets(scene: "Scene", table: StageTable, stage: Stage) -> Stage:
    """The stage whose pair has the ratio of one with planets, or of a pinion in a ring."""
    sun, ring = stage.pinion_teeth, stage.wheel_teeth
    first, second = sun, ring
    if table.type == PLANETARY and table.held != "carrier":
        most = None if None in (sun[1], ring[1]) else (sun[1] or 0) + (ring[1] or 0)
        second = sun[0] + ring[0], most
        first = ring if table.held == "sun" else sun
    angle = scene.helix_angles(table)[0].value
    pressure = (table.pressure_angle or scene.gears.pressure_angle).value
    plain = rack(GearTable(), pressure)
    return replace(
        stage,
        pinion_teeth=first,
        wheel_teeth=second,
        wheel_diameter=None,
        toothings=(Toothing(angle, (plain, plain)),),
    )


def planet_assumptions(scene: "Scene") -> Iterator[str]:
    """What the gears of planets and rings take for granted, in sentences."""
    stages = [stage for stage in scene.stage if stage.epicyclic]
    if not stages:
        return
    yield (
        "Sun, planets and ring, or a pinion in a ring, are put together axially and count as "
        "cylinders of the mean diameter (d_a + d_f)/2, a ring as the tube from there to its "
        "outside; pins and bearings are left out."
    )
    cheeks = [stage.carrier_over_face_width for stage in stages if stage.type == PLANETARY]
    if any(cheeks):
        yield (
            "Carriers count in volume and mass as two discs of the material of their planets, 2 a "
            "+ 0.7 d_p in diameter, as wide together as carrier_over_face_width has it, with "
            "neither a hub nor what joins them."
        )
    if not all(cheeks):
        yield "Carriers of planetary stages without carrier_over_face_width are left out."
    if any(stage.type == PLANETARY for stage in stages):
        yield (
            "Profile shifts that the file does not give follow a rule of this program: the centre "
            "distance is midway between the reference distances of both meshes, or as much larger "
            "as keeps sun and planets from undercut, x_s is half of x_s + x_p as far as neither is "
            "undercut, sun and planets are shortened by x_s + x_p - y, the ring has no backlash, "
            "and its tips end at the form circle of the planets. A positive shift moves the ring's "
            "teeth towards its centre."
        )
        if any(stage.held == "sun" and stage.face_width is None for stage in stages):
            yield "The face width of a stage whose sun is held is limited over its ring's diameter."
        yield (
            "Meshes of planets are rated against the carrier, with the torque over their number "
            "times K_γ. K_Hβ (K_m by AGMA) takes sun and planets for pinions on shafts of their "
            "own, without pins and carrier: where the alignment is known, give K_Hbeta (K_m) for "
            "both meshes."
        )
    if scene.rating and scene.rating.standard != "iso6336":
        yield (
            "AGMA 2001 and 908 are of external gears: I and J of rings are those of signed radii "
            "and of a tooth with the ring's fillet, K_B is the law of external rims (unverified). "
            "AGMA has no mesh load factor: K_γ multiplies K_o. Its pinion is the gear with fewer "
            "teeth, be it the planet."
        )


def load_factor(stage: StageTable, count: int) -> Fraction:
    """K_gamma of a number of planets."""
    if stage.mesh_load_factor is not None:
        return stage.mesh_load_factor
    return Fraction(str(MESH_LOAD_FACTORS[count]))


def meshes(stage: StageTable, count: int) -> tuple[StageTable, ...]:
    """Tables of the meshes of a stage, with their load cycles and K_gamma; count: of planets."""
    if not count:
        return (stage,)
    given, shared = stage.given_iso6336, {"K_gamma": load_factor(stage, count)}
    names = of_meshes(given)
    outer, second = (
        {"given_iso6336": copied(given, {n: getattr(given, n)[k] for n in names} | shared)}
        for k in (0, 1)
    )
    sun, ring = (copied(gear_of(gear), {"contacts": count}) for gear in (stage.sun, stage.ring))
    planet = bent(stage.planet)
    return (
        copied(stage, outer | {"pinion": sun, "wheel": planet}),
        copied(stage, second | {"pinion": planet, "wheel": ring}),
    )


def at_once(stage: StageTable, count: int, with_ring: bool) -> tuple[float, float] | None:
    """`Practice.meshes` of a mesh of a stage."""
    if not count:
        return None
    held = 0.0 if stage.held == "ring" else float(count)
    return (1.0, held) if with_ring else (float(-count if stage.held == "sun" else count), 1.0)


def options(scene: "Scene", stage: StageTable) -> tuple[Option, ...]:
    """Ways of making the gears of a stage, each with the ratings that limit its meshes."""
    assert scene.rating
    asked, duty = of_stage(scene.rating, stage), scene.duty
    hours, levels = required_hours(asked, duty), loads(asked, duty, scene.load)
    gears = [
        choices(table, scene.gears, scene.material)
        for table in ((stage.pinion, stage.wheel) if stage.type == INTERNAL else ())
    ]
    every = []
    agma = asked.standard != "iso6336"
    for planets in _by_fewest(scene, stage) if agma else ways(scene, stage):
        tables = meshes(stage, planets.count)
        if planets.count:
            outer, second = tables
            members = (outer.pinion, outer.wheel, second.wheel)
            gears = [choices(table, scene.gears, scene.material) for table in members]
        for row in product(*gears):
            pairs = [(row[k], row[k + 1]) for k in range(len(tables))]
            each = [
                option(asked, table, pair, hours, levels)
                for table, pair in zip(tables, pairs, strict=True)
            ]
            if planets.fewest == PLANET:  # AGMA, the first standard, takes it as the pinion
                turned = option(asked, tables[0], pairs[0][::-1], hours, levels)
                standards = turned.standards[0], *each[0].standards[1:]
                each[0] = replace(each[0], standards=standards)
            every.append(_combined(stage, planets, each, agma))
    return tuple(every)


def _by_fewest(scene: "Scene", stage: StageTable) -> Iterator[Planets]:
    """Ways of making a stage, with the sun as the pinion of its mesh by AGMA and with planets."""
    for planets in ways(scene, stage):
        if not planets.count:
            yield planets
            continue
        sun, planet, ring = planets.sun[0], planets.planet[1], planets.ring[1]
        of_sun = sun <= min(planet, 0.5 * (ring - sun - planets.fewer))
        members = (SUN, PLANET) if not scene.given else (PLANET, SUN)[of_sun:][:1]
        for member in members:
            yield replace(planets, fewest=member)


def _combined(stage: StageTable, planets: Planets, each: Sequence[Option], agma: bool) -> Option:
    """One way of making a stage of those of its meshes; agma: AGMA is the first standard."""
    standards: list[Any] = []
    rated_rings: list[Any] = [*each[-1].standards]
    planets = replace(planets, thinnest=max(by.thinnest_ring for by in rated_rings))
    for k, one in enumerate(each):
        with_ring = k == len(each) - 1
        words = "" if len(each) == 1 else "_of_ring" if with_ring else "_of_sun"
        for n, standard in enumerate(one.standards):
            rated: Any = standard
            turned = agma and n == 0 and not with_ring and planets.fewest == PLANET
            if n or not agma:
                at = replace(rated.practice, meshes=at_once(stage, planets.count, with_ring))
                rated = replace(rated, practice=at)
            name = words + rated.suffix
            standards.append(InPlanetaryMesh(rated, planets, with_ring, name, turned=turned))
    first, last = each[0], each[-1]

    def three(name: str) -> Any:
        more = getattr(last, name)[1:] if len(each) > 1 else ()
        return (*getattr(first, name), *more)

    names = ("densities", "prices", "treatment_prices", "cutting_prices", "materials")
    words = f"{planets.count} planets" if planets.count else "ring"
    fields: dict[str, Any] = {name: three(name) for name in names}
    return Option(tuple(standards), words, planets=planets, **fields)
