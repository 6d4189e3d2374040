"""Planetary stages and pinions in a ring: stages whose pair has their ratio, but is not in mesh.

A pair stands for the gears of a stage, by the member that is held: z1, z2 are z_s, z_s + z_r of a
held ring (sun to carrier), z_r, z_r + z_s of a held sun (ring to carrier), z_s, z_r of a held
carrier (sun to ring), so that z2/z1 is the ratio, exactly. Number of planets and their teeth are a
way of making them. A pinion in a ring has z1 and z2 of both, and no planets.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strength.standard import Rows
from gearopt.frozen import dataclass
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import ISO_53_A, RIM, Cutter, Gear, GearPair, Rack, reference_diameter
from gearopt.physics.geometry.internal import margins
from gearopt.physics.geometry.involute import angle_at_distance, shift_sum, working_pressure_angle
from gearopt.physics.geometry.tooth import tip_clearances
from gearopt.physics.iso6336.bending_factors import THIN_RING
from gearopt.physics.iso6336.case import ring_rim

HELD = ("ring", "sun", "carrier")
ORDERS = ("any", "simultaneous", "sequential", "hunting")
SUN, PLANET, RING = 0, 1, 2
ACCEPTED = ("radial_assembly", "cutter_infeed")  # gears are put together, and cut, axially
LARGE = 1e6  # teeth: no limit
CHEEK = 0.35  # reference diameters of a planet, by which cheeks of a carrier exceed its circle
NO_UNDERCUT = 1e-4  # normal modules, by which shifts exceed that of the edge of an undercut
LEAST_PLANET = 5  # teeth
ROUNDING = 1e-9  # of margins [normal modules]
Three = tuple[Any, Any, Any]


@dataclass(frozen=True)
class Cutting:
    """How sun, planet and ring are cut; of three values that of the ring is last.

    helix_angle beta [rad]; racks; cutter of the ring; shifts x, None: by the rule, or as the
    distance asks; shift_sum x_s + x_p, None: of the shifts, or by the rule; tip_alterations k,
    None: by the rule; distance a [mm], None: without backlash of sun and planet. rim s_R [normal
    modules] of the ring below its roots, or outside [mm], its diameter; blanks of sun and planet;
    allowances A_sn [mm] of gears that are given.

    The rule: a is midway between the reference distances of both meshes, or as much larger as
    keeps sun and planet from undercut; x_s is half of x_s + x_p, as far as neither is undercut, of
    a given sum that is too small the planet alone; sun and planet are shortened by k = y - x_s -
    x_p, y m_n being by how much a exceeds their reference distance. x_r leaves no backlash, and
    tips of the ring reach no lower than the form circle of the planets.
    """

    helix_angle: float = 0.0
    racks: tuple[Rack, Rack, Rack] = (ISO_53_A,) * 3
    cutter: Cutter | None = None
    shifts: tuple[float | None, float | None, float | None] = (None, None, None)
    shift_sum: float | None = None
    tip_alterations: tuple[float | None, float | None, float | None] = (None, None, None)
    distance: float | None = None
    rim: float = RIM
    outside: float | None = None
    blanks: tuple[Blank, Blank] = (SOLID, SOLID)
    allowances: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def solid(self) -> bool:
        """Whether bodies of all modules have one shape."""
        return self.outside is None and all(blank.solid for blank in self.blanks)

    @np.errstate(invalid="ignore", divide="ignore")
    def gears(self, module: Any, teeth: Three, width: Any) -> tuple[Gear, Gear, Gear, Any]:
        """Sun, planet and ring of numbers of teeth above 0, and their distance [mm].

        A gear counts as the cylinder, or hole, of its mean diameter (d_a + d_f)/2.
        """
        sun, planet, ring = teeth
        pressure, transverse = self.angles
        each = module / math.cos(self.helix_angle)
        reference, inner = 0.5 * each * (sun + planet), 0.5 * each * (ring - planet)
        total = self._sum_of_given
        if self.distance is not None:
            distance = self.distance + 0.0 * reference
        elif total is None:
            distance = 0.5 * (reference + inner)
        if total is None:
            working = angle_at_distance(reference, transverse, distance)
            total = _exact(shift_sum(working, sun + planet, pressure, transverse))
            if self.distance is None:
                total = np.fmax(total, self._least(SUN, sun) + self._least(PLANET, planet))
        if self.distance is None:
            working = working_pressure_angle(total, sun + planet, pressure, transverse)
            distance = reference * math.cos(transverse) / np.cos(working)
        first, second = self._shares(total, sun, planet)
        shorter = _exact((distance - reference) / module - first - second)
        third = self._inside(module, planet, ring, distance, second)
        tips = shorter, shorter, self._ring_tip(module, planet, ring, distance, second, third)
        rows = zip((sun, planet, -ring), (first, second, third), tips, strict=True)
        made = [self._gear(k, module, width, *row) for k, row in enumerate(rows)]
        return made[SUN], made[PLANET], made[RING], distance

    @np.errstate(invalid="ignore", divide="ignore")
    def pinion_in_ring(self, module: Any, teeth: Three, width: Any) -> tuple[Gear, Gear, Any]:
        """Pinion and ring of numbers of teeth above 0, and their distance [mm].

        Shifts that are not given are 0 of the pinion, or what keeps it from undercut, and of the
        ring as the distance asks.
        """
        _, pinion, ring = teeth
        pressure, transverse = self.angles
        reference = 0.5 * module / math.cos(self.helix_angle) * (ring - pinion)
        first, second = self.shifts[PLANET:]
        if first is None:
            first = np.maximum(self._least(PLANET, pinion), 0.0)
        if self.distance is not None:
            distance = self.distance + 0.0 * reference
        elif second is None:
            distance = reference
        else:
            working = working_pressure_angle(first + second, pinion - ring, pressure, transverse)
            distance = reference * math.cos(transverse) / np.cos(working)
        second = self._inside(module, pinion, ring, distance, first)
        tip = self._ring_tip(module, pinion, ring, distance, first, second)
        rows = (pinion, first, 0.0), (-ring, second, tip)
        made = [self._gear(k, module, width, *row) for k, row in enumerate(rows, PLANET)]
        return made[0], made[1], distance

    @property
    def angles(self) -> tuple[float, float]:
        """Normal and transverse pressure angle [rad]."""
        normal = self.racks[RING].pressure_angle
        return normal, math.atan(math.tan(normal) / math.cos(self.helix_angle))

    def _inside(self, module: Any, planet: Any, ring: Any, distance: Any, shift: Any) -> Any:
        """Shift of the ring: as given, else without backlash at a distance [mm]."""
        if self.shifts[RING] is not None:
            return self.shifts[RING]
        pressure, transverse = self.angles
        reference = 0.5 * module / math.cos(self.helix_angle) * (ring - planet)
        working = angle_at_distance(reference, transverse, distance)
        return _exact(shift_sum(working, planet - ring, pressure, transverse) - shift)

    def _ring_tip(
        self, module: Any, planet: Any, ring: Any, distance: Any, first: Any, second: Any
    ) -> Any:
        """Tip alteration of the ring at most 0: its tips reach the form circle of planets.

        d_Nf = d_Ff of ISO 21771:2007 in closed form, without undercut, protuberance and chamfer:
        rho_F = (d sin(alpha_t) - 2 m_n h/sin(alpha_t))/2, h = h_fP - rho_fP (1 - sin(alpha_n)) - x;
        rho_a2 = a sin(alpha_wt) + rho_F. first, second: shifts.
        """
        if (own := self.tip_alterations[RING]) is not None:
            return own
        each, rack = module / math.cos(self.helix_angle), self.racks[PLANET]
        normal, transverse = self.angles
        inside = angle_at_distance(0.5 * each * (ring - planet), transverse, distance)
        depth = rack.dedendum - rack.tip_radius * (1.0 - math.sin(normal)) - first
        form = 0.5 * each * planet * math.sin(transverse) - module * depth / math.sin(transverse)
        base = 0.5 * each * ring * math.cos(transverse)
        reach = np.hypot(base, distance * np.sin(inside) + form)
        height = (0.5 * each * ring - reach) / module - self.racks[RING].addendum
        return np.minimum(height - second, 0.0)

    @property
    def _sum_of_given(self) -> float | None:
        """x_s + x_p, where they are given."""
        first, second, _ = self.shifts
        if first is not None and second is not None:
            return first + second
        return self.shift_sum

    def _shares(self, total: Any, sun: Any, planet: Any) -> tuple[Any, Any]:
        """Shifts of sun and planet of their sum."""
        first, second, _ = self.shifts
        if first is not None:
            return first, total - first if second is None else second
        if second is not None:
            return total - second, second
        first = np.minimum(0.5 * total, total - self._least(PLANET, planet))
        first = np.maximum(first, self._least(SUN, sun))
        return first, total - first

    def _least(self, k: int, teeth: Any) -> Any:
        """Shift of a gear, by its place: as given, or the least without undercut."""
        if (given := self.shifts[k]) is not None:
            return given
        rack, (pressure, transverse) = self.racks[k], self.angles
        depth = rack.dedendum - rack.tip_radius * (1.0 - math.sin(pressure))
        depth += NO_UNDERCUT
        return depth - 0.5 * teeth * math.sin(transverse) ** 2 / math.cos(self.helix_angle)

    def _gear(self, k: int, module: Any, width: Any, teeth: Any, shift: Any, shorter: Any) -> Gear:
        """A gear, by its place; shorter: k, where none is given."""
        rack, d = self.racks[k], reference_diameter(module, teeth, self.helix_angle)
        own = self.tip_alterations[k]
        tip = shorter if own is None else own
        cutter = self.cutter if k == RING else None
        gear = Gear(
            *(module, teeth, d, width, self.helix_angle, rack, shift, tip, self.allowances[k]),
            cutter=cutter,
        )
        root, outside = gear.root_diameter, None
        if k == RING:
            outside = root - 2.0 * self.rim * module
            outside = outside if self.outside is None else 0.0 * root - self.outside
        mean = 0.5 * (gear.tip_diameter + root)
        return replace(gear, body_diameter=mean, outside_diameter=outside)


@dataclass(frozen=True)
class Planets:
    """A way of making a stage: planets of so many teeth less than (z_r - z_s)/2, in halves.

    count N of planets, 0: a pinion in a ring; held: of HELD; fewer: twice the teeth that a planet
    has less. sun, planet, ring: ranges of teeth. spaced: equally; order: of ORDERS; clearance of
    the tips of neighbours [normal modules]. widest: outside diameter [mm] of the ring. fewest: SUN
    or PLANET, whichever has fewer teeth (a sun of as many, too), None: either. thinnest: s_R/m_n
    of rings up to which a standard rates none. carrier: face widths of both its cheeks together, 0:
    it does not count.
    """

    cutting: Cutting
    count: int
    held: str = "ring"
    fewer: int = 0
    sun: tuple[float, float] = (1.0, LARGE)
    planet: tuple[float, float] = (1.0, LARGE)
    ring: tuple[float, float] = (1.0, LARGE)
    spaced: bool = True
    order: str = "any"
    clearance: float = 0.5
    widest: float = math.inf
    fewest: int | None = None
    thinnest: float = THIN_RING
    carrier: float = 0.0

    @property
    def may_be_thin(self) -> bool:
        """Whether the rim of a ring may be too thin to be rated."""
        return self.cutting.outside is not None or self.cutting.rim <= self.thinnest

    def teeth(self, pair: GearPair) -> Three:
        """Numbers of teeth of sun (or pinion), planet and ring of pairs, above 0."""
        return self.teeth_of(pair.pinion_teeth, pair.wheel_teeth)

    def teeth_of(self, z1: Any, z2: Any) -> Three:
        """`teeth` of numbers of teeth of pairs."""
        if self.held == "sun":
            sun, ring = z2 - z1, z1
        else:
            sun, ring = z1, z2 - z1 if self.held == "ring" and self.count else z2
        return sun, 0.5 * (ring - sun - self.fewer) if self.count else sun, ring

    def possible(self, z1: Any, z2: Any) -> Any:
        """Whether numbers of teeth of pairs are allowed and can be put together."""
        return np.logical_and.reduce([kept for _, kept in self.rules(z1, z2)])

    def rules(self, z1: Any, z2: Any) -> Iterator[tuple[str, Any]]:
        """Yield what is asked of numbers of teeth of pairs, and whether they keep it."""
        sun, planet, ring = self.teeth_of(z1, z2)
        yield (
            f"{_teeth(self.sun)} of the {'sun' if self.count else 'pinion'}",
            _within(sun, self.sun),
        )
        larger = np.greater(ring, planet) & np.greater_equal(planet, LEAST_PLANET)
        least = f"planets of {LEAST_PLANET} teeth or more" if self.count else "the pinion"
        yield f"a ring with room for {least}", larger
        yield f"{_teeth(self.ring)} of the ring", _within(ring, self.ring)
        if self.cutting.cutter is not None:
            cutter = self.cutting.cutter.teeth
            yield f"a ring of more teeth than its cutter, {cutter:g}", np.greater(ring, cutter)
        if not self.count:
            return
        yield f"{_teeth(self.planet)} of a planet", _within(planet, self.planet)
        less = f"z_p = (z_r - z_s{f' - {self.fewer}' if self.fewer else ''})/2"
        yield f"whole teeth of a planet, {less}", np.mod(planet, 1.0) == 0.0
        if self.spaced:
            text = f"a sum z_s + z_r that is a multiple of {self.count} planets"
            yield text, np.mod(sun + ring, self.count) == 0
        if self.order == "hunting":
            whole = [np.rint(z).astype(np.int64) for z in (sun, planet, ring)]
            alone = (np.gcd(whole[0], whole[1]) == 1) & (np.gcd(whole[1], whole[2]) == 1)
            yield "hunting teeth in both meshes (mesh_order)", alone
        elif self.order != "any":
            text = "a" if self.order == "simultaneous" else "no"
            alike = (np.mod(sun, self.count) == 0) == (self.order == "simultaneous")
            yield f"{text} multiple of {self.count} planets as z_s (mesh_order)", alike
        if self.fewest is not None:
            text = "a sun of no more teeth" if self.fewest == SUN else "a sun of more teeth"
            yield f"{text} than a planet", np.less_equal(sun, planet) == (self.fewest == SUN)

    def gears(self, pair: GearPair) -> tuple[Gear, Gear, Gear, Any]:
        """Sun, planet (or pinion) and ring of pairs, and their distance [mm]."""
        size = pair.normal_module, self.teeth(pair), pair.face_width
        if self.count:
            return self.cutting.gears(*size)
        pinion, ring, distance = self.cutting.pinion_in_ring(*size)
        return pinion, pinion, ring, distance

    def pair(self, module: Any, sun: Any, ring: Any, width: Any) -> GearPair:
        """The pair that stands for a stage of sun (or pinion) and ring; a module [mm]."""
        z1, z2 = sun, ring
        if self.count and self.held != "carrier":
            z1, z2 = ring if self.held == "sun" else sun, sun + ring
        return GearPair.of_teeth(module, z1, z2, width, self.cutting.helix_angle)

    def mesh(self, pair: GearPair, with_ring: bool) -> GearPair:
        """Planet and ring, or sun and planet, the sun as the pinion, whose twist counts."""
        sun, planet, ring, distance = self.gears(pair)
        if with_ring:
            return GearPair(planet, ring, -distance)
        return GearPair(sun, planet, distance)

    def meshes(self, pair: GearPair) -> tuple[GearPair, ...]:
        """The pairs in mesh."""
        return tuple(self.mesh(pair, which) for which in ((False, True) if self.count else (True,)))

    def room(self, pair: GearPair) -> Any:
        """Whether gears of pairs that are possible fit each other, in any module."""
        return np.logical_and.reduce([kept for _, kept in self.fits(pair)])

    def fits(self, pair: GearPair) -> Iterator[tuple[str, Any]]:
        """Yield what gears have to keep beside each other, and whether those of pairs keep it."""
        sun, planet, ring, distance = self.gears(pair)
        with np.errstate(invalid="ignore"):
            yield "a centre distance without backlash", np.isfinite(distance + ring.profile_shift)
        module, inner = pair.normal_module, "planet and ring" if self.count else "pinion and ring"
        if self.count:
            gap = self.gap(pair) >= (self.clearance - ROUNDING) * module
            yield f"{self.clearance:g} m_n between the tips of neighbouring planets", gap
        for name, margin in margins(GearPair(planet, ring, -distance)).items():
            if name not in ACCEPTED:
                limit = name.rstrip("01").replace("_", " ")
                free = "interference" in name or name == "cutter_overcut"
                words = f"{inner} without {limit}" if free else f"{limit} of {inner}"
                yield words, margin >= -ROUNDING
        for clear in tip_clearances(GearPair(sun, planet, distance)) if self.count else ():
            yield "tip clearance of sun and planet", clear >= -ROUNDING * module

    def gap(self, pair: GearPair) -> Any:
        """Least gap [mm] of the tip circles of neighbouring planets."""
        _, planet, _, distance = self.gears(pair)
        if self.count < 2:
            return distance
        return 2.0 * distance * np.sin(0.5 * self._angle(pair)) - planet.tip_diameter

    def _angle(self, pair: GearPair) -> Any:
        """Least angle [rad] between planets: equal, or as close to that as teeth allow."""
        if self.spaced:
            return 2.0 * math.pi / self.count
        sun, _, ring = self.teeth(pair)
        return 2.0 * math.pi * np.floor((sun + ring) / self.count) / (sun + ring)

    def volumes(self, pair: GearPair, solid: bool = False) -> tuple[Any, ...]:
        """Volumes [mm3] of sun, all planets with their carrier, and ring; infinite if impossible.

        solid: without bores.
        """
        fits = self.possible(pair.pinion_teeth, pair.wheel_teeth)
        with np.errstate(invalid="ignore"):
            sun, planet, ring, _ = self.gears(pair)
            fits = fits & (ring.outside < ring.root_diameter)  # with a rim below its roots
            shapes = (SOLID, SOLID) if solid else self.cutting.blanks
            each = [shape.volume(gear) for shape, gear in zip(shapes, (sun, planet), strict=True)]
        parts = [each[SUN], self.count * each[PLANET]] if self.count else [each[PLANET]]
        if self.carrier:
            parts[PLANET] = parts[PLANET] + self.cheeks(pair)[2]
        every = (*parts, ring.volume)
        return tuple(np.where(fits & np.isfinite(part), part, np.inf)[()] for part in every)

    def cheeks(self, pair: GearPair) -> tuple[Any, Any, Any]:
        """Diameter, width [mm] of both together and volume [mm3] of the cheeks of the carrier."""
        _, planet, _, distance = self.gears(pair)
        across = 2.0 * (distance + CHEEK * planet.reference_diameter)
        width = self.carrier * pair.face_width
        return across, width, 0.25 * math.pi * width * across**2

    def slower(self, pair: GearPair, with_ring: bool) -> tuple[Any, Any]:
        """Torque and speed of the driving gear of a mesh over those of the pair's pinion.

        Of one planet, against the carrier.
        """
        if not self.count:
            return 1.0, 1.0
        sun, planet, ring = self.teeth(pair)
        torque = (sun / ring if self.held == "sun" else 1.0) / self.count
        speed = 1.0 if self.held == "carrier" else ring / (sun + ring)
        if with_ring:
            return torque * planet / sun, speed * sun / planet
        return torque, speed

    def lightest_with(self, rivals: Iterable["Planets"]) -> "Lightest":
        """A virtual way that is no heavier than this one and others."""
        return Lightest(tuple(dict.fromkeys((self, *rivals))))

    def loss(self, pair: GearPair) -> Any:
        """Sum of 1/z1 + 1/z2 over the meshes, times the part of the power that rolls."""
        sun, planet, ring = self.teeth(pair)
        inner = 1.0 / planet - 1.0 / ring
        if not self.count:
            return inner
        part = {"ring": ring, "sun": sun, "carrier": sun + ring}[self.held] / (sun + ring)
        return part * (1.0 / sun + 1.0 / planet + inner)


def _exact(value: Any) -> Any:
    """Shifts and tip alterations [normal modules], of which rounding errors are 0."""
    return np.where(np.abs(value) < ROUNDING, 0.0, value)[()]


def _within(teeth: Any, span: tuple[float, float]) -> Any:
    return np.greater_equal(teeth, span[0]) & np.less_equal(teeth, span[1])


def _teeth(span: tuple[float, float]) -> str:
    """A range of teeth in words."""
    low, high = span
    if high >= LARGE:
        return f"{low:g} teeth or more"
    return f"{low:g} teeth" if low == high else f"{low:g} to {high:g} teeth"


def no_teeth(ways: Sequence[Planets], z1: Any, z2: Any) -> str:
    """Why no way takes any of some numbers of teeth (n,) of pairs; "" where one does.

    By the way that keeps most of what is asked, in its order.
    """
    if not np.size(z1):
        return "No numbers of teeth allowed have the ratio"
    said = [_first_unkept([*way.rules(z1, z2)]) for way in ways]
    most = max(said, key=lambda each: each[0])
    if not most[1]:
        return ""
    counts = " or ".join(str(n) for n in dict.fromkeys(way.count for way in ways))
    law = {"ring": "1 + z_r/z_s", "sun": "1 + z_s/z_r", "carrier": "z_r/z_s"}[ways[0].held]
    which = f" with {counts} planets have the ratio {law}" if ways[0].count else " have the ratio"
    before = f", {most[2]}" if most[2] else ""
    return f"No numbers of teeth{which}{before} and {most[1]} together"


def _first_unkept(rules: Sequence[tuple[str, Any]]) -> tuple[int, str, str]:
    """How many rules some rows (n,) keep together, the first that none keeps then, and the last."""
    left, before = True, ""
    for k, (name, kept) in enumerate(rules):
        if not np.any(left & kept):
            return k, name, before
        if not np.all(kept | ~np.asarray(left)):
            before = name
        left = left & kept
    return len(rules), "", ""


def no_room(ways: Sequence[Planets], pairs: GearPair) -> str:
    """Why no planets or ring fit any of the pairs (n,), of the least module; "" where some do."""
    first = ways[0]
    left = [(way, way.possible(pairs.pinion_teeth, pairs.wheel_teeth)) for way in ways]
    rows = [[("", fits), *way.fits(pairs)] for way, fits in left]
    missed = max((_first_unkept(each) for each in rows), key=lambda each: each[0])
    if missed[1]:
        before = f"{missed[2]} and " if missed[2] else ""
        return f"No gears of the teeth that can be put together have {before}{missed[1]}"
    left = [(way, fits & way.room(pairs)) for way, fits in left]
    least = min(
        (float(np.min(-way.gears(pairs)[RING].outside[fits])) for way, fits in left if fits.any()),
        default=0.0,
    )
    if least > first.widest:
        return f"The smallest ring is {least:.5g} mm wide, {first.widest:.5g} mm are allowed"
    if first.may_be_thin and not any(
        (ring_rim(way.gears(pairs)[RING])[fits] > way.thinnest).any() for way, fits in left
    ):
        law = ", which has no Y_B in ISO 6336" if first.thinnest else ""
        what = f"has a rim of {first.thinnest:g} m_n or less below its roots{law}"
        return f"Every ring, of the least module too, {what}: make its outside larger"
    return ""


@dataclass(frozen=True)
class Lightest:
    """A virtual way of making a stage, whose volumes are the least of all ways."""

    ways: tuple[Planets, ...]

    def volumes(self, pair: GearPair, solid: bool = False) -> tuple[Any, ...]:
        """Least volumes [mm3] of each of the gears."""
        rows = zip(*(way.volumes(pair, solid) for way in self.ways), strict=True)
        return tuple(np.minimum.reduce(row) for row in rows)

    def loss(self, pair: GearPair) -> Any:
        """Least of the losses."""
        return np.minimum.reduce([way.loss(pair) for way in self.ways])


@dataclass(frozen=True)
class Ready:
    """What a standard takes of meshes (n,), and whether their gears fit each other."""

    teeth: Any
    fits: Any

    def take(self, place: Any) -> "Ready":
        """Those of some meshes."""
        return Ready(self.teeth.take(place), self.fits[place])

    def scaled(self, factor: Any) -> "Ready":
        """Those of meshes whose lengths are all greater by a factor."""
        return Ready(self.teeth.scaled(factor), self.fits)


@dataclass(frozen=True)
class InPlanetaryMesh:
    """A standard that rates one mesh of stages with planets, or a pinion in a ring.

    with_ring: whether the mesh is that of planet and ring, else of sun and planet. turned: whether
    the planet is taken as the pinion of a sun, as by AGMA where it has fewer teeth.
    """

    standard: Any
    planets: Planets
    with_ring: bool
    suffix: str
    monotone: bool = False
    turned: bool = False

    def mesh(self, pair: GearPair) -> GearPair:
        """The mesh, of pairs that stand for stages."""
        mesh = self.planets.mesh(pair, self.with_ring)
        return replace(mesh, pinion=mesh.wheel, wheel=mesh.pinion) if self.turned else mesh

    def _loads(self, pair: GearPair, fits: Any) -> tuple[Any, Any]:
        """`Planets.slower`; torques are NaN where gears do not fit, or a ring is large or thin."""
        torque, speed = self.planets.slower(pair, self.with_ring or self.turned)
        fits = fits & self.planets.possible(pair.pinion_teeth, pair.wheel_teeth)
        ring = self.planets.gears(pair)[RING]
        if math.isfinite(self.planets.widest):
            fits = fits & (-ring.outside <= self.planets.widest)
        if self.planets.may_be_thin:
            fits = fits & (ring_rim(ring) > self.planets.thinnest)
        return np.where(fits, torque, np.nan)[()], speed

    def safeties(self, pair: GearPair, torque: Any, speed: Any) -> Any:
        """Return S_F1, S_F2, S_H1, S_H2; NaN where the gears do not fit or are refused.

        Those of the sun come first, turned or not.
        """
        slower, relative = self._loads(pair, self.planets.room(pair))
        each = self.standard.safeties(self.mesh(pair), torque * slower, speed * relative)
        return (each[1], each[0], each[3], each[2]) if self.turned else each

    def best_with(self, rivals: Any) -> None:
        """No virtual way: other planets differ in more than strength."""

    def like(self, other: Any) -> bool:
        """Whether `prepared` of another standard returns the same."""
        if not isinstance(other, InPlanetaryMesh):
            return False
        alike = self._shape == other._shape
        return bool(alike and self.standard.like(other.standard))

    @property
    def _shape(self) -> Any:
        """What gears and their room depend on."""
        own = self.planets
        gears = own.cutting, own.held, own.fewer, own.count, own.clearance, own.spaced
        return gears, self.with_ring, self.turned

    def prepared(self, pair: GearPair) -> Ready:
        """Numbers of pairs (n,) that `rows` takes, of any load and width."""
        return Ready(self.standard.prepared(self.mesh(pair)), self.planets.room(pair))

    def rows(self, prepared: Ready, pair: GearPair, torque: Any, speed: Any, safety: Any) -> Rows:
        """Rows of the mesh, at torques and speeds of its driving gear."""
        slower, relative = self._loads(pair, prepared.fits)
        loads = tuple(t * slower for t in torque), tuple(w * relative for w in speed)
        rows: Rows = self.standard.rows(prepared.teeth, self.mesh(pair), *loads, safety)
        return rows
