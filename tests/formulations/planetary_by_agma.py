"""Small drives with planetary stages by AGMA, or by both standards, and their candidates."""

from dataclasses import replace

import planetary_drives as own
from mesh_loads import turned, with_ring, with_sun
from rated_drives import agma

from gearopt.formulations.drive.planetary import PLANET, SUN, InPlanetaryMesh
from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.gears import GearPair
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS
from gearopt.physics.rating import Operation

HARD = Steel("carburised", 2)
BENT = Steel("carburised", 2, reversed_load=True)
MADE = Practice(quality=9.0)
BY_ISO = own.safe  # before tests put another in its place


def by_agma(train, both=False, size=False):
    """The drive with its planetary stages by AGMA, beside ISO 6336 or alone."""
    stages = []
    for stage in train.stages:
        if stage.planetary:
            made = [way for option in stage.options for way in _ways(option, both, size)]
            stage = replace(stage, options=tuple(made))
        stages.append(stage)
    return replace(train, stages=tuple(stages))


def _ways(option, both, size):
    count = option.planets.count
    factor = {"K_gamma": MESH_LOAD_FACTORS[count]} if count else {}

    def standard(steels, contacts):
        made = agma(steels, hours=own.HOURS, practice=replace(MADE, size=size), given=factor)
        return replace(made, operation=replace(made.operation, contacts=contacts))

    for fewest in (SUN, PLANET) if count else (None,):
        made = {} if both else {"thinnest": 0.0}  # every rim has a K_B
        planets = replace(option.planets, fewest=fewest, **made)
        inner = standard((BENT if count else HARD, HARD), (1.0, float(max(count, 1))))
        rated = [InPlanetaryMesh(inner, planets, True, "_of_ring")]
        if count:
            flip = fewest == PLANET
            pair, contacts = ((HARD, BENT), (float(count), 1.0))
            outer = standard(pair[::-1], contacts[::-1]) if flip else standard(pair, contacts)
            rated.insert(0, InPlanetaryMesh(outer, planets, False, "_of_sun", turned=flip))
        if both:
            of_iso = (replace(s, planets=planets) for s in option.standards)
            rated += [replace(s, suffix=f"{s.suffix}_iso") for s in of_iso]
        yield replace(option, standards=tuple(rated), planets=planets)


def safe(train, way, made, teeth, width, torque, size=False):
    """Whether both meshes have the safety factors that are asked for by AGMA.

    K_gamma is here a part of K_o; the gear with fewer teeth is the pinion.
    """
    speed = train.speed * train.torque / torque
    (sun, planet, ring), n = teeth, way.count
    of_sun, relative = torque, speed
    if n and way.held == "ring":
        relative = speed * ring / (sun + ring)
    if n and way.held == "sun":
        of_sun, relative = torque * sun / ring, speed * ring / (sun + ring)
    overload = 1.25 * (MESH_LOAD_FACTORS[n] if n else 1.0)
    load = Operation(of_sun * relative, relative, own.HOURS, overload=overload)
    g1, g2, g3 = (replace(gear, face_width=width) for gear in made[:3])
    g3 = replace(g3, outside_diameter=way.cutting.outside and -way.cutting.outside)
    practice = replace(MADE, size=size)
    inner = GearPair(g2, g3, -made[3])
    if not n:
        return _meets(inner, load, (HARD, HARD), practice)
    outer, of_outer, steels = GearPair(g1, g2, made[3]), with_sun(load, n), (HARD, BENT)
    if sun > planet:
        of_outer = turned(of_outer, planet / sun)
        outer, steels = GearPair(g2, g1, made[3]), steels[::-1]
    of_inner = with_ring(load, n, planet / sun, way.held == "ring")
    return _meets(outer, of_outer.operation, steels, practice) and _meets(
        inner, of_inner.operation, (BENT, HARD), practice
    )


def _meets(pair, operation, steels, practice):
    try:
        rated = rate(pair, operation, steels, practice)
    except ValueError:
        return False
    reached = min(rated.bending_safety) / 1.3, min(rated.contact_safety) / 1.05
    return min(reached) >= 1.0 - 1e-11


def safe_by_both(*args):
    """Whether a candidate is safe by AGMA and by ISO 6336."""
    return safe(*args) and BY_ISO(*args)
