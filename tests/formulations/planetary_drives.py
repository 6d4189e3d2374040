"""Small drives with planetary stages, and every candidate of them, built and rated on its own."""

import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
from mesh_loads import with_ring, with_sun
from rated_drives import MODULES, iso, rated_drive

from gearopt.formulations.drive.planetary import Cutting, InPlanetaryMesh, Planets
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.formulations.strength.standard import Option
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import ISO_53_A, Cutter, Gear, GearPair, reference_diameter
from gearopt.physics.geometry.internal import margins
from gearopt.physics.geometry.involute import involute, involute_angle
from gearopt.physics.iso6336.case import Practice, of_blanks
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS
from gearopt.physics.rating import Operation

HARD = Material("Eh", "MQ")
BENT = replace(HARD, reversed_load=True)
HOURS = 20000.0
EACH = (None,) * 3, (1.0,) * 3, (0.0,) * 3, (0.0,) * 3, ("",) * 3


def ways(cutting, counts, fewer, held="ring", **limits):
    """Options of a planetary stage."""
    made = []
    for count in counts:
        factor = {"K_gamma": MESH_LOAD_FACTORS[count]}
        for less in fewer:
            planets = Planets(cutting, count, held, less, **limits)
            turns, held_ring = (float(count), 1.0), 0.0 if held == "ring" else float(count)
            at_once = (-float(count) if held == "sun" else float(count)), 1.0
            outer = _standard((HARD, BENT), turns, at_once, factor)
            inner = _standard((BENT, HARD), turns[::-1], (1.0, held_ring), factor)
            rated = (
                InPlanetaryMesh(outer, planets, False, "_of_sun"),
                InPlanetaryMesh(inner, planets, True, "_of_ring"),
            )
            made.append(Option(rated, "", *EACH, planets=planets))
    return tuple(made)


def _standard(steels, contacts, meshes, factor):
    made = iso(steels, Practice(grades=(6.0, 6.0), meshes=meshes), HOURS, given=factor)
    return replace(made, operation=replace(made.operation, contacts=contacts))


def with_carrier(train, widths):
    """The drive whose first stage has a carrier; widths: of its cheeks, by number of planets."""
    first, options = train.stages[0], []
    for option in first.options:
        planets = replace(option.planets, carrier=widths[option.planets.count])
        rated = tuple(replace(standard, planets=planets) for standard in option.standards)
        options.append(replace(option, standards=rated, planets=planets))
    return replace(train, stages=(replace(first, options=tuple(options)), *train.stages[1:]))


def rings(cutting, **limits):
    """The option of a pinion in a ring."""
    planets = Planets(cutting, 0, **limits)
    rated = InPlanetaryMesh(_standard((HARD, HARD), (1.0, 1.0), None, {}), planets, True, "")
    two = (None,) * 2, (1.0,) * 2, (0.0,) * 2, (0.0,) * 2, ("",) * 2
    return (Option((rated,), "", *two, planets=planets),)


def some_internal_drive(seed):
    """A random small drive whose first stage is a pinion in a ring."""
    train = some_planetary_drive(seed, 1 + seed % 2, ("carrier",))
    first = train.stages[0]
    plain = {"shifts": (None, None, None), "blanks": (SOLID, SOLID), "outside": None}
    cutting = replace(first.options[0].planets.cutting, **plain)
    if seed % 3 == 0:
        cutting = replace(cutting, shifts=(None, 0.3, 0.2))
    first = replace(first, options=rings(cutting))
    return replace(train, stages=(first, *train.stages[1:]))


def some_planetary_drive(seed, count=1, kinds=("ring", "sun", "carrier")):
    """A random small drive of so many stages, the first of which is planetary."""
    rng = np.random.default_rng(seed)
    held = str(rng.choice(kinds))
    helix = float(rng.choice([0.0, 0.2]))
    cutter = Cutter(23, 0.0, 1.25, 0.2) if rng.random() < 0.3 else None
    shifts = [(None, None, None), (0.0, 0.0, None), (0.3, 0.1, None)][int(rng.integers(3))]
    cutting = Cutting(helix, cutter=cutter, shifts=shifts)
    counts = (3, 4) if rng.random() < 0.6 else (int(rng.integers(3, 6)),)
    fewer = (
        (0, 1, 2) if shifts == (None, None, None) else ((0,), (0, 1))[int(any(map(bool, shifts)))]
    )
    order = str(rng.choice(["any", "any", "sequential", "simultaneous", "hunting"]))
    options = ways(cutting, counts, fewer, held, order=order, spaced=bool(rng.random() < 0.7))
    low = int(rng.integers(14, 24))
    sun = low, low + int(rng.integers(2, 5))
    ring_over_sun = float(rng.uniform(1.8, 5.0))
    if seed % 4 == 1:  # bodies of another shape in every module, of a mass
        bores = Blank(bore=0.3 * low * 2.0, hub_over_bore=1.2), Blank(bore=10.0)
        outside = 1.05 * float(MODULES[4]) * low * ring_over_sun + 25.0
        cutting = replace(cutting, blanks=bores, outside=None if seed % 8 == 1 else outside)
        options = ways(cutting, counts, fewer, held, order=order)
    own = {"ring": 1 + ring_over_sun, "carrier": ring_over_sun, "sun": 1 + 1 / ring_over_sun}[held]
    begin = int(rng.integers(2, 6))
    modules = MODULES[begin : begin + 3]
    d = float(modules[1]) * low
    torque = d**3 * float(rng.choice([0.1, 0.3, 0.6]))
    face = (
        FaceWidth(F(3, 5), F(3, 5)) if rng.random() < 0.5 else FaceWidth(F(1, 2), F(1), step=F(5))
    )
    if held == "sun":
        sun = round(low * ring_over_sun), round(low * ring_over_sun) + 3
        face = FaceWidth(F(1, 5), F(1, 5))
    rest = float(rng.uniform(1.5, 3.0)) if count > 1 else 1.0
    drive = rated_drive(
        F(round(100 * own * rest), 100),
        (face,) + (FaceWidth(F(3, 5), F(3, 5)),) * (count - 1),
        torque * 150.0,
        1450.0,
        helix=0.2,
        options=(Option((iso((HARD, HARD), hours=HOURS),)),),
        modules=modules,
        pinion_teeth=(18, 20),
    )
    first = replace(
        drive.stages[0], options=options, pinion_teeth=sun, toothings=(Toothing(helix),)
    )
    aim = {"objective": "mass" if seed % 2 else "gear_volume", "density": 7.85e-9}
    tolerance = F(2, 100) if count == 1 else F(1, 200)
    return replace(
        drive, stages=(first, *drive.stages[1:]), safety=(1.3, 1.05), tolerance=tolerance, **aim
    )


def candidates(stage, z1, z2, module):
    """Every set of gears of a pair of a planetary stage that fits: option and gears of 1 mm."""
    for option in stage.options:
        way = option.planets
        cut, n = way.cutting, way.count
        if cut.cutter and (z2 - z1 if way.held == "ring" and n else z2) <= cut.cutter.teeth:
            continue
        if not n:
            made = pinion_in_ring(cut, module, z1, z2) if z2 > z1 else None
            if made is not None and margins_left(made):
                yield option, made, (z1, z1, z2)
            continue
        sun, ring = (z2 - z1, z1) if way.held == "sun" else (z1, z2 - z1)
        if way.held == "carrier":
            ring = z2
        if sun < 5 or ring < sun or (ring - sun - way.fewer) % 2:
            continue
        planet = (ring - sun - way.fewer) // 2
        if planet < 5:
            continue
        if way.spaced and (sun + ring) % n:
            continue
        hunting = math.gcd(sun, planet) == 1 == math.gcd(planet, ring)
        alike = {"any": True, "hunting": hunting, "simultaneous": sun % n == 0}
        if not alike.get(way.order, sun % n != 0):
            continue
        made = gears_of(cut, module, sun, planet, ring)
        if made is not None and fits(way, made, sun + ring, module):
            yield option, made, (sun, planet, ring)


def pinion_in_ring(cut, module, pinion, ring):
    """Pinion (twice), ring and distance: without backlash at their shifts."""
    t, each = math.atan(math.tan(math.radians(20)) / math.cos(cut.helix_angle)), module
    each = module / math.cos(cut.helix_angle)
    x = max(0.0, not_undercut(cut, t, pinion)) if cut.shifts[1] is None else cut.shifts[1]
    a, outward = each * (ring - pinion) / 2, x
    w = t
    if cut.shifts[2] is not None:
        outward = -cut.shifts[2]
        change = 2 * (outward - x) * math.tan(math.radians(20)) / (ring - pinion)
        w = involute_angle(involute(t) + change)
        a *= math.cos(t) / math.cos(w)
    tip = ring_tip(cut, module, pinion, ring, a, x, outward, w)
    rows = (pinion, x, 0.0), (pinion, x, 0.0), (-ring, -outward, tip)
    return None if math.isnan(a) else (*_cut(cut, module, rows), a)


def margins_left(made):
    """Whether the mesh of the ring breaks no limit but that of radial assembly."""
    _, planet, ring, a = made
    left = margins(GearPair(planet, ring, -a))
    accepted = "radial_assembly", "cutter_infeed"
    return not any(v < -1e-9 for n, v in left.items() if n not in accepted)


def ring_tip(cut, module, planet, ring, a, x, outward, w):
    """Tip alteration of a ring that ends at the form circle of the planets."""
    t, each = math.atan(math.tan(math.radians(20)) / math.cos(cut.helix_angle)), module
    each = module / math.cos(cut.helix_angle)
    deep = 1.25 - 0.38 * (1 - math.sin(math.radians(20))) - x
    form = each * planet * math.sin(t) / 2 - module * deep / math.sin(t)
    least = math.hypot(each * ring * math.cos(t) / 2, a * math.sin(w) + form)
    tip = max(least, each * ring / 2 + module * (outward - 1.0))
    return (each * ring / 2 - tip) / module + outward - 1.0


def _cut(cut, module, rows):
    """Gears of teeth, shifts and tip alterations."""
    made = []
    for z, x, tips in rows:
        d = reference_diameter(module, float(z), cut.helix_angle)
        cutter = cut.cutter if z < 0 else None
        of_teeth = module, float(z), d, 1.0, cut.helix_angle, ISO_53_A, x, tips
        made.append(Gear(*of_teeth, cutter=cutter))
    return made


def not_undercut(cut, t, z):
    """Least shift of a gear by the basic rack A of ISO 53 without undercut."""
    deep = 1.25 - 0.38 * (1 - math.sin(math.radians(20))) + 1e-4
    return deep - z * math.sin(t) ** 2 / (2 * math.cos(cut.helix_angle))


def gears_of(cut, module, sun, planet, ring):
    """Sun, planet, ring and distance by the formulas of textbooks, ring with positive teeth."""
    t, each = math.atan(math.tan(math.radians(20)) / math.cos(cut.helix_angle)), module
    each = module / math.cos(cut.helix_angle)
    a0, a1 = each * (sun + planet) / 2, each * (ring - planet) / 2
    tan = math.tan(math.radians(20))
    if cut.shifts[0] is None:
        a = (a0 + a1) / 2
        x = (involute(math.acos(a0 * math.cos(t) / a)) - involute(t)) * (sun + planet) / (2 * tan)
        one, other = (not_undercut(cut, t, z) for z in (sun, planet))
        if one + other > x:
            x = one + other
            w = involute_angle(involute(t) + 2 * x * tan / (sun + planet))
            a = a0 * math.cos(t) / math.cos(w)
        xs = max(one, min(x / 2, x - other))
        xp = x - xs
    else:
        xs, xp = cut.shifts[:2]
        w = involute_angle(involute(t) + 2 * (xs + xp) * tan / (sun + planet))
        a = a0 * math.cos(t) / math.cos(w)
    if a1 * math.cos(t) >= a:
        return None
    w = math.acos(a1 * math.cos(t) / a)
    outward = (involute(w) - involute(t)) * (ring - planet) / (
        2 * tan
    ) + xp  # of the ring's profile
    k = (a - a0) / module - xs - xp
    kr = ring_tip(cut, module, planet, ring, a, xp, outward, w)
    rows = (sun, xs, k), (planet, xp, k), (-ring, -outward, kr)
    return (*_cut(cut, module, rows), a)


def fits(way, made, teeth, module):
    """Whether gears go together: margins of the ring's mesh, and room between planets."""
    sun, planet, ring, a = made
    if not margins_left(made):
        return False
    for one, other in ((sun, planet), (planet, sun)):
        if a - one.tip_diameter / 2 - other.root_diameter / 2 < -1e-9 * module:
            return False
    part = 1 / way.count if way.spaced else (teeth // way.count) / teeth
    return 2 * a * math.sin(math.pi * part) - planet.tip_diameter >= module * (0.5 - 1e-9)


def body(gear, width, outside=None):
    """Volume of a gear as the disc of its mean diameter, of a ring as the tube around it."""
    inside = (gear.tip_diameter + gear.root_diameter) / 2
    out = 2 * inside if outside is None else outside
    return math.pi / 4 * width * (inside**2 if outside is None else out**2 - inside**2)


def volume(way, made, width, module, mass=False):
    """Volume of all gears of a stage [mm3]."""
    sun, planet, ring, a = made
    outside = way.cutting.outside or abs(ring.root_diameter) + 7.0 * module
    if not way.count:
        return body(sun, width) + body(ring, width, outside)
    first, second = (
        body(gear, width) - (taken(blank, gear, width) if mass else 0.0)
        for blank, gear in zip(way.cutting.blanks, (sun, planet), strict=True)
    )
    cheeks = math.pi * width * way.carrier * (a + 0.35 * planet.reference_diameter) ** 2
    return first + way.count * second + body(ring, width, outside) + cheeks


def taken(blank, gear, width):
    """Volume of the bore of a gear, whose hub has to lie within its root circle."""
    fits = blank.bore * blank.hub_over_bore < gear.root_diameter * (1.0 - 1e-9)
    return math.pi / 4 * width * blank.bore**2 if fits else 0.0


def safe(train, way, made, teeth, width, torque):
    """Whether both meshes have the safety factors that are asked for."""
    speed = train.speed * train.torque / torque
    (sun, planet, ring), n = teeth, way.count
    of_sun, relative = torque, speed
    if n and way.held == "ring":
        relative = speed - speed * sun / (sun + ring)  # less that of the carrier
    if n and way.held == "sun":
        of_sun, relative = torque * sun / ring, speed * ring / (sun + ring)
    load = Operation(of_sun * relative, relative, HOURS, overload=1.25)
    if not n:
        pair = GearPair(*(replace(gear, face_width=width) for gear in made[1:3]), -made[3])
        return _meets(pair, load, (HARD, HARD), Practice(grades=(6.0, 6.0)), {})
    g1, g2, g3, a = (*(replace(g, face_width=width) for g in made[:3]), made[3])
    outer, inner = (
        with_sun(load, n, way.held == "sun"),
        with_ring(load, n, planet / sun, way.held == "ring"),
    )
    g3 = replace(g3, outside_diameter=way.cutting.outside and -way.cutting.outside)
    blanks = (*way.cutting.blanks, SOLID)
    pairs = [
        (GearPair(g1, g2, a), outer, (HARD, BENT)),
        (GearPair(g2, g3, -a), inner, (BENT, HARD)),
    ]
    for k, (pair, mesh, steels) in enumerate(pairs):
        bare = Practice(grades=(6.0, 6.0), meshes=mesh.meshes)
        practice = of_blanks(bare, pair, (blanks[k], blanks[k + 1]))
        factor = {"K_gamma": MESH_LOAD_FACTORS[n]}
        if not _meets(pair, mesh.operation, steels, practice, factor):
            return False
    return True


def _meets(pair, operation, steels, practice, factor):
    """Whether a mesh has the safety factors that are asked for."""
    try:
        found = rate(pair, operation, steels, practice, factor)
    except ValueError:
        return False
    reached = min(found.bending_safety) / 1.3, min(found.contact_safety) / 1.05
    return min(reached) >= 1.0 - 1e-11


def widths(face, d1):
    """Face widths of a stage."""
    if face.step is None:
        return [float(face.low) * d1]
    step = float(face.step)
    counts = range(1, math.floor(float(face.high) * d1 / step + 1e-9) + 1)
    return [step * n for n in counts if step * n >= float(face.low) * d1 - 1e-9]


def least_share(train, k, torque, z1, z2, most=math.inf):
    """Least share of a planetary stage with these teeth."""
    stage, found = train.stages[k], []
    for module in map(float, stage.modules):
        d1 = module * z1 / math.cos(stage.toothing.helix_angle)
        for option, made, teeth in candidates(stage, z1, z2, module):
            for width in widths(stage.face_width, d1):
                heavy = train.objective == "mass"
                share = volume(option.planets, made, width, module, heavy)
                share *= 1000 * train.density if heavy else 1.0
                if share < most:
                    found.append((share, len(found), option.planets, made, teeth, width))
    for share, _, way, made, teeth, width in sorted(found, key=lambda row: row[:2]):
        if safe(train, way, made, teeth, width, torque):
            return share
    return math.inf
