"""A planetary train: its teeth, what turns how fast, what flows where, and where planets are."""

import math
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.epicyclic.design import EpicyclicDesign
from gearopt.formulations.epicyclic.request import COUPLED, SETS, SIMPLE
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.physics.planetary.willis import PLANETS
from gearopt.report.drawing.planetary_view import GearSet, Wheel, animation, outline
from gearopt.report.kinds import generic
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import Section, Table, Tile, records

OWN = ("sun1", "ring1", "carrier1", "sun2", "ring2", "carrier2")


def _design(result: Result) -> EpicyclicDesign:
    train: EpicyclicDesign = typed(EpicyclicDesign, result.design, "design")
    return train


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Ratio and efficiency as key figures."""
    if not result.design:
        return []
    design = _design(result)
    exact = "" if design.exact_ratio == f"{design.ratio:g}" else f"= {design.exact_ratio}"
    locked = "locks itself" if design.efficiency == 0.0 else "of the meshes alone"
    return [
        Tile("ratio", f"{design.ratio:.8g}", exact),
        Tile("efficiency", f"{100.0 * design.efficiency:.3f} %", locked),
    ]


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """What keeps a train from its ratio."""
    if not result.design or result.objective.get("name") != "ratio_error":
        return ""
    if result.value == 0.0:
        return "the train has the ratio exactly"
    if result.status == "optimal":
        return "no train of the allowed teeth that meets the limits has the ratio exactly"
    return "the train does not have the ratio exactly"


def train(result: Result, measures: Measures) -> Section | None:
    """Tables of the train, and whether its planets can be assembled."""
    if not result.design:
        return None
    design = _design(result)
    names = {n: n for sets in design.sets for n in sets}
    if len(design.gears) == len(OWN):
        same = dict(zip(OWN, sum(design.sets, ()), strict=True))
        names = {n: " = ".join(o for o in OWN if same[o] == n) for n in same.values()}
    members = [replace(m, name=names.get(m.name) or m.name) for m in design.members]
    named: dict[str, Any] = {"gears": design.gears, "members": members}
    named |= {"meshes": design.meshes, "planets": design.places}
    tables = [Table(name, *records(rows, measures)) for name, rows in named.items() if rows]
    words = (assembly(design), flow(design))
    return Section("Train", words=words, tables=tables, terminal=(*words, *tables))


def assembly(design: EpicyclicDesign) -> str:
    """Where planets are, and how they mesh with the suns."""
    phases = {place.sun_phase for place in design.places}
    meshing = {1: "in step", 2: "in counter-phase" if 0.5 in phases else ""}.get(len(phases))
    turns = list(dict.fromkeys(place.turn for place in design.places))
    counts = Counter(place.planets for place in design.places)
    equal = all(Fraction(p.turn) * counts[p.planets] == p.planet - 1 for p in design.places)
    spaced = "spaced equally" if equal else f"at {', '.join(turns)} of a turn"
    return (
        f"All planets are alike and can be assembled {spaced}; they mesh "
        f"{meshing or 'one after the other'} at the sun; between tip circles of neighbours "
        f"{design.gap_modules:.3g} modules are left."
    )


def flow(design: EpicyclicDesign) -> str:
    """How power flows, against the input's."""
    if not design.meshes:
        return "The train locks itself: no power reaches the output."
    most = max(design.meshes, key=lambda mesh: mesh.rolling_power)
    lost = sum(mesh.lost for mesh in design.meshes)
    return (
        f"Of the input's power {100.0 * lost:.3g} % is lost in meshes; the most rolling power, "
        f"{most.rolling_power:.3g} times the input's, has the mesh of {most.gears}. Torques act "
        "on the members from outside: where torque and speed have one sign, power flows in, else "
        "out."
    )


def turning(result: Result, measures: Measures) -> Section | None:
    """The train as it turns; in modules and without shifts."""
    if not result.design:
        return None
    design = _design(result)
    count = 1 if design.arrangement == SIMPLE else 2  # sets, or steps of the planets
    used = sorted((m.use, m.name, m.speed) for m in design.members if m.use in ("input", "output"))
    ends = [(f"{name} ({use})", speed) for use, name, speed in used]
    words = "lengths are in modules, teeth are not involutes."
    sets = [gear_set(design, k) for k in range(count)]
    turns = animation(sets, "the train as it turns", ends, words)
    return Section("The train along its axis", animations=[turns])


def gear_set(design: EpicyclicDesign, k: int) -> GearSet:
    """A set, or a step of the planets, with what is in mesh with it there; from 0."""
    (s, p, q, r), (sun, ring, carrier) = SETS[design.arrangement][-k], design.sets[-k]
    moon = PLANETS[1 if k and design.arrangement == COUPLED else 0]
    speeds = {member.name: member.speed for member in design.members}

    def wheel(gear: int, speed: float) -> Wheel:
        it = design.gears[gear]
        shape = outline(it.teeth, it.module, inside=gear == r)
        return Wheel(it.name, it.teeth, speed, shape)

    teeth = [gear.teeth for gear in design.gears]
    return GearSet(
        wheel(s, speeds[sun]),
        wheel(q if k else p, speeds[moon]),
        wheel(r, speeds[ring]),
        teeth[p],
        teeth[q],
        speeds[carrier],
        [math.radians(at.angle_deg) for at in design.places if at.planets == moon],
        0.5 * (teeth[s] + teeth[p]),
        (not k or p == q, bool(k) or p == q),
    )


PAGES = replace(
    generic.PAGES,
    sections=(*generic.OPENING, turning, train, *generic.REQUEST, *generic.CLOSING),
    terminal=(train, *generic.PAGES.terminal[1:]),
    tiles=tiles,
    binding_limit=binding_limit,
    drawn=False,
)
