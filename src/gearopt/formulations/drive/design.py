"""The design of a drive for its drawing: diameters, distances and loads of every stage."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, astuple, field, replace
from fractions import Fraction
from typing import Annotated, Any

from gearopt.formulations.drive.drawing_data import DrawingData
from gearopt.formulations.drive.layout.layout_design import LayoutDesign
from gearopt.formulations.drive.rating import DriveRating
from gearopt.formulations.drive.train import STEEL_DENSITY, Train
from gearopt.formulations.pair.design import PairContact, PairRelief
from gearopt.formulations.pair.flank_design import FlankContact
from gearopt.formulations.strength import Law
from gearopt.formulations.strength.standard import Option
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import INLINE, Shown, typed
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import ISO_53_A, MEMBERS, Cutter, Gear, GearPair, Rack
from gearopt.physics.loads import pitch_line_velocity, torque_ratios

# as in a `Rack`
TOOL = ("addendum", "tool_addendum", "tool_tip_radius", "tool_protuberance", "tip_chamfer")
TEETH = ("profile_shift", "tip_alteration", "thickness_allowance_mm")  # as in a `Gear`


def gears_first(sized: Result) -> str:
    """Return the scope of a layout of gears that were sized before it, for their own objective."""
    least = str(sized.objective["name"]).replace("_", " ")
    early = ", which was stopped early" if sized.status == "limit" else ""
    return f"gears sized first for least {least}{early}"


@dataclass(frozen=True, kw_only=True)
class StageDesign:
    """A gear pair with its loads; fields are the keys of a result, with their units.

    Fields with a default say how its teeth are cut, of which materials, of several, its gears are,
    and what their blanks have, None of what a gear does not have; a result leaves out those that
    hold it. Fields stand in the order of the table of stages. working_pressure_angle: transverse;
    None: on the reference circles. idler: its pinion is the wheel of the stage before, where it is
    counted. type: of a stage with planets sun and planet stand as pinion and wheel, mass_kg
    counting all planets; torque and speed are those of the sun against the carrier. Of a pinion in
    a ring the ring is the wheel. Numbers of a ring are above 0, but a positive profile shift moves
    its teeth towards the centre.
    """

    type: Annotated[str, Shown("type")] = "parallel"
    fixed: Annotated[str, Shown("fixed member")] = ""
    planets: Annotated[int | None, Shown("number of planets")] = None
    sun_teeth: Annotated[float | None, Shown("teeth of the sun z_s")] = None
    planet_teeth: Annotated[float | None, Shown("teeth of a planet z_p")] = None
    ring_teeth: Annotated[float | None, Shown("teeth of the ring z_r")] = None
    normal_module_mm: float
    pinion_teeth: Annotated[float, Shown("teeth z1")]
    wheel_teeth: Annotated[float, Shown("teeth z2")]
    driver: Annotated[str, Shown("driving gear")] = "pinion"
    ratio: Annotated[float, Shown("ratio u")]
    face_width_mm: Annotated[float, Shown("face width b")]
    pinion_face_width_mm: Annotated[float | None, Shown("face width of the pinion")] = None
    wheel_face_width_mm: Annotated[float | None, Shown("face width of the wheel")] = None
    pinion_diameter_mm: Annotated[float, Shown("reference diameter d1")]
    wheel_diameter_mm: Annotated[float, Shown("reference diameter d2")]
    pinion_tip_diameter_mm: Annotated[float, Shown("tip diameter d_a1")]
    wheel_tip_diameter_mm: Annotated[float, Shown("tip diameter d_a2")]
    pinion_root_diameter_mm: Annotated[float, Shown("root diameter d_f1")]
    wheel_root_diameter_mm: Annotated[float, Shown("root diameter d_f2")]
    centre_distance_mm: Annotated[float, Shown("centre distance a")]
    idler: bool = False
    helix_angle_deg: Annotated[float, Shown("helix angle β")] = 0.0
    pressure_angle_deg: Annotated[float, Shown("normal pressure angle α_n")] = 20.0
    working_pressure_angle_deg: Annotated[float | None, Shown("working pressure angle α_wt")] = None
    pinion_profile_shift: Annotated[float, Shown("profile shift x1")] = 0.0
    wheel_profile_shift: Annotated[float, Shown("profile shift x2")] = 0.0
    pinion_tip_alteration: Annotated[float, Shown("tip alteration k1")] = 0.0
    wheel_tip_alteration: Annotated[float, Shown("tip alteration k2")] = 0.0
    pinion_thickness_allowance_mm: Annotated[float, Shown("thickness allowance A_sn1")] = 0.0
    wheel_thickness_allowance_mm: Annotated[float, Shown("thickness allowance A_sn2")] = 0.0
    transverse_contact_ratio: Annotated[float, Shown("transverse contact ratio ε_α")]
    overlap_ratio: Annotated[float, Shown("overlap ratio ε_β")]
    pinion_torque_Nm: Annotated[float, Shown("torque T1")]
    pitch_line_velocity_m_per_s: Annotated[float, Shown("pitch-line velocity v")]
    indices: Mapping[str, float] = field(metadata=INLINE)  # of the strength law: name_unit
    gear_volume_mm3: Annotated[float, Shown("volume")]
    pinion_mass_kg: Annotated[float, Shown("pinion mass")]
    wheel_mass_kg: Annotated[float, Shown("wheel mass")]
    mass_kg: Annotated[float, Shown("mass of the pair")]
    pinion_material: Annotated[str, Shown("pinion material")] = ""
    wheel_material: Annotated[str, Shown("wheel material")] = ""
    pinion_rim_thickness_mm: Annotated[float | None, Shown("pinion rim thickness s_R1")] = None
    wheel_rim_thickness_mm: Annotated[float | None, Shown("wheel rim thickness s_R2")] = None
    pinion_web_thickness_mm: Annotated[float | None, Shown("pinion web thickness b_s1")] = None
    wheel_web_thickness_mm: Annotated[float | None, Shown("wheel web thickness b_s2")] = None
    pinion_hub_diameter_mm: Annotated[float | None, Shown("pinion hub diameter")] = None
    wheel_hub_diameter_mm: Annotated[float | None, Shown("wheel hub diameter")] = None
    pinion_bore_mm: Annotated[float | None, Shown("pinion bore")] = None
    wheel_bore_mm: Annotated[float | None, Shown("wheel bore")] = None
    mesh_load_factor: Annotated[float | None, Shown("mesh load factor K_γ")] = None
    ring_diameter_mm: Annotated[float | None, Shown("reference diameter of the ring")] = None
    ring_tip_diameter_mm: Annotated[float | None, Shown("tip diameter of the ring")] = None
    ring_root_diameter_mm: Annotated[float | None, Shown("root diameter of the ring")] = None
    ring_outside_diameter_mm: Annotated[float | None, Shown("outside diameter of the ring")] = None
    ring_profile_shift: Annotated[float | None, Shown("profile shift of the ring")] = None
    ring_tip_alteration: Annotated[float | None, Shown("tip alteration of the ring")] = None
    ring_contact_ratio: Annotated[float | None, Shown("contact ratio with the ring ε_α")] = None
    ring_mass_kg: Annotated[float | None, Shown("mass of the ring")] = None
    ring_material: Annotated[str, Shown("material of the ring")] = ""
    carrier_diameter_mm: Annotated[float | None, Shown("diameter of the carrier's cheeks")] = None
    carrier_width_mm: Annotated[float | None, Shown("width of both cheeks")] = None
    carrier_mass_kg: Annotated[float | None, Shown("mass of the carrier")] = None
    pinion_addendum: float = ISO_53_A.addendum
    wheel_addendum: float = ISO_53_A.addendum
    pinion_tool_addendum: float = ISO_53_A.dedendum
    wheel_tool_addendum: float = ISO_53_A.dedendum
    pinion_tool_tip_radius: float = ISO_53_A.tip_radius
    wheel_tool_tip_radius: float = ISO_53_A.tip_radius
    pinion_tool_protuberance: float = ISO_53_A.protuberance
    wheel_tool_protuberance: float = ISO_53_A.protuberance
    pinion_tip_chamfer: float = ISO_53_A.tip_chamfer
    wheel_tip_chamfer: float = ISO_53_A.tip_chamfer
    ring_addendum: float = ISO_53_A.addendum
    ring_tool_addendum: float = ISO_53_A.dedendum
    ring_tool_tip_radius: float = ISO_53_A.tip_radius
    ring_tool_protuberance: float = ISO_53_A.protuberance
    ring_tip_chamfer: float = ISO_53_A.tip_chamfer
    ring_thickness_allowance_mm: float = 0.0
    ring_cutter: tuple[float, ...] | None = None  # as in a `Cutter`

    @property
    def end_diameters(self) -> tuple[float, float]:
        """Reference diameters [mm] of the gear that drives and of the one that is driven."""
        first, second = self.pinion_diameter_mm, self.wheel_diameter_mm
        if self.type != "parallel":
            first = second = self.ring_outside_diameter_mm or second
        return (first, second) if self.driver == "pinion" else (second, first)

    @property
    def bodies(self) -> tuple[float, float]:
        """Diameters [mm] of the cylinders as which a pair counts.

        d, or d + 2 x m_n where shifts were chosen, see `Toothing`: its volume tells which.
        """
        d = self.pinion_diameter_mm, self.wheel_diameter_mm
        shifts = self.pinion_profile_shift, self.wheel_profile_shift
        each = zip(d, shifts, strict=True)
        shifted = [diameter + 2.0 * x * self.normal_module_mm for diameter, x in each]
        widths = [gear.width for gear in self.pair.gears]

        def off(diameters: Sequence[float]) -> float:
            rows = zip(widths, diameters, strict=True)
            volume = sum(0.25 * math.pi * float(b) * diameter**2 for b, diameter in rows)
            return abs(volume - self.gear_volume_mm3)

        return (shifted[0], shifted[1]) if off(shifted) < off(d) else d

    @property
    def pair(self) -> GearPair:
        """The gears with their teeth, at their centre distance."""
        shifted = self.working_pressure_angle_deg is not None
        gears = [self._gear(member) for member in ("pinion", "wheel")]
        distance = self.centre_distance_mm
        if self.type == "internal":
            gears[1], distance = self._as_ring(gears[1]), -distance
        return GearPair(gears[0], gears[1], distance if shifted else None)

    @property
    def ring(self) -> Gear:
        """The ring of a planetary stage as its tool cuts it."""
        return self._as_ring(self._gear("ring"))

    def _as_ring(self, gear: Gear) -> Gear:
        cutter = None if self.ring_cutter is None else Cutter(*self.ring_cutter)
        z, d = -gear.teeth, -gear.reference_diameter
        return replace(gear, teeth=z, reference_diameter=d, cutter=cutter)

    def _gear(self, member: str) -> Gear:
        names = (*TOOL, *TEETH, "teeth", "diameter_mm")
        values: dict[str, Any] = {n: getattr(self, f"{member}_{n}") or 0.0 for n in names}
        width = getattr(self, f"{member}_face_width_mm", None) or self.face_width_mm
        gear = Gear(
            self.normal_module_mm,
            values["teeth"],
            values["diameter_mm"],
            self.face_width_mm,
            math.radians(self.helix_angle_deg),
            Rack(math.radians(self.pressure_angle_deg), *(values[n] for n in TOOL)),
            *(values[n] for n in TEETH),
        )
        return replace(gear, width_excess=width - self.face_width_mm)


@dataclass(frozen=True, kw_only=True)
class GearCost:
    """What a gear costs, in the currency of the prices."""

    gear: str
    mass_kg: float
    material: float
    treatment: float
    cutting: float
    total: float


@dataclass(frozen=True, kw_only=True)
class DriveDesign:
    """Stages and totals of a drive; where its gears are, once laid out.

    costs: of every gear, where cost is an objective. contact, relief: of one pair whose file asks
    for them. drawing: data of the drawings of its gears, where it is asked for.
    """

    stages: tuple[StageDesign, ...]
    ratio: float
    ratio_error_percent: float
    output_torque_Nm: float
    gear_volume_mm3: float
    sum_of_centre_distances_mm: float
    total_length_mm: float
    mass_kg: float
    costs: tuple[GearCost, ...] = ()
    layout: LayoutDesign | None = None
    rating: DriveRating | None = None
    contact: PairContact | None = None
    relief: PairRelief | None = None
    flank: FlankContact | None = None
    drawing: DrawingData | None = None


def drive_design(data: Mapping[str, Any]) -> DriveDesign:
    """Design that a result of a drive holds; ValueError names the keys that do not belong."""
    design: DriveDesign = typed(DriveDesign, data, "design")
    return design


def describe(train: Train, pairs: tuple[GearPair, ...], options: Sequence[int] = ()) -> DriveDesign:
    """Return stages and totals of a drive; masses as of `of_pairs`, or of the options' materials.

    options: of every stage, from 0; none: the first. Only the last one may have an idler.
    """
    loaded, asked = (float(train.torque), float(train.speed)), train.ratio
    if train.driver == "wheel":
        asked = 1 / (train.ratio * (1 - train.tolerance**2))
    if not train.rated:
        blanks = [stage.blanks for stage in train.stages]
        return of_pairs(train.law, pairs, *loaded, asked, train.density, blanks, train.drivers)
    chosen = zip(train.stages, options or (0,) * len(pairs), pairs, train.drivers, strict=True)
    rows = [
        (mesh, s.blanks, s.options[k], driver)
        for s, k, pair, driver in chosen
        for mesh in ((pair,) if s.options[k].planets else s.options[k].meshes(pair))
    ]
    meshes, bodies, made, drivers = zip(*rows, strict=True)
    idlers = range(len(rows), len(pairs), -1)
    design = of_pairs(train.law, meshes, *loaded, asked, train.density, bodies, drivers, idlers)
    usual, each = train.density or STEEL_DENSITY, zip(design.stages, made, strict=True)
    stages = tuple(
        _of_materials(stage, option, usual)
        if option.planets is None
        else of_planets(train.law, stage, mesh, option, usual)
        for (stage, option), mesh in zip(each, meshes, strict=True)
    )
    if any(option.planets is not None for option in made):
        design = with_planets(design, stages)
    costs = tuple(cost for k in range(len(made)) for cost in _costs(k + 1, stages[k], made[k]))
    priced = "cost" in train.objectives
    return replace(
        design,
        stages=stages,
        mass_kg=sum(s.mass_kg for s in stages),
        costs=costs if priced else (),
    )


def _costs(number: int, stage: StageDesign, option: Option) -> Iterator[GearCost]:
    """Yield what the gears of a stage cost, its number counted from 1."""
    for k, (member, gear) in enumerate(zip(MEMBERS, stage.pair.gears, strict=True)):
        mass = stage.pinion_mass_kg if k == 0 else stage.wheel_mass_kg
        treatment = mass * option.treatment_prices[k]
        material = mass * option.prices[k] - treatment
        cutting = 1e-3 * option.cutting_prices[k] * gear.teeth * gear.width
        yield GearCost(
            gear=f"{member} {number}",
            mass_kg=mass,
            material=material,
            treatment=treatment,
            cutting=cutting,
            total=material + treatment + cutting,
        )


def of_planets(
    law: Law, stage: StageDesign, pair: GearPair, option: Option, usual: float
) -> StageDesign:
    """Return the stage with planets, or with a ring, for which a pair stood.

    usual: the density [t/mm3] of gears of no material.
    """
    planets = option.planets
    mesh, ring = planets.meshes(pair)[0], planets.meshes(pair)[-1].wheel
    torque, relative = planets.slower(pair, False) if planets.count else (1.0, 1.0)
    driven = 1e3 * stage.pinion_torque_Nm * torque * max(planets.count, 1)
    speed = 2e3 * stage.pitch_line_velocity_m_per_s / stage.pinion_diameter_mm * relative
    bodies = planets.cutting.blanks if planets.count else (planets.cutting.blanks[0], SOLID)
    made = _stage(law, mesh, driven, speed, usual, bodies, stage.driver)
    volumes = planets.volumes(pair)
    densities = [own or usual for own in option.densities]
    masses = [1000.0 * rho * float(volume) for rho, volume in zip(densities, volumes, strict=True)]
    z_s, z_p, z_r = (_whole(float(z)) for z in planets.teeth(pair))
    factors = getattr(option.standards[0], "standard", None)
    sharing = None if factors is None else factors.given.get("K_gamma")
    gears: dict[str, Any] = {"sun_teeth": z_s, "planet_teeth": z_p, "planets": planets.count}
    carrier = _carrier(planets, pair, densities[1])
    each = (masses[1] - carrier.get("carrier_mass_kg", 0.0)) / max(planets.count, 1)
    gears |= {"fixed": planets.held, "wheel_mass_kg": each} | carrier
    gears |= {"mesh_load_factor": sharing, "wheel_material": option.materials[1]}
    if not planets.count:
        names = ("teeth", "diameter_mm", "tip_diameter_mm", "root_diameter_mm")
        gears = {f"wheel_{name}": abs(getattr(made, f"wheel_{name}")) for name in names}
        gears |= {"wheel_mass_kg": masses[-1], "wheel_material": option.materials[-1]}
    cutter = None if ring.cutter is None else astuple(ring.cutter)
    return replace(
        made,
        type="planetary" if planets.count else "internal",
        ratio=stage.ratio,
        centre_distance_mm=abs(made.centre_distance_mm),
        gear_volume_mm3=float(sum(planets.volumes(pair, solid=True))),
        pinion_mass_kg=masses[0],
        mass_kg=sum(masses),
        pinion_material=option.materials[0],
        ring_teeth=z_r,
        ring_diameter_mm=-float(ring.reference_diameter),
        ring_tip_diameter_mm=-float(ring.tip_diameter),
        ring_root_diameter_mm=-float(ring.root_diameter),
        ring_outside_diameter_mm=-float(ring.outside),
        ring_profile_shift=float(ring.profile_shift),
        ring_tip_alteration=float(ring.tip_alteration),
        ring_contact_ratio=float(planets.meshes(pair)[-1].transverse_contact_ratio),
        ring_mass_kg=masses[-1],
        ring_material=option.materials[-1],
        ring_cutter=None if cutter is None else tuple(map(float, cutter)),
        **_tool("ring", ring),
        **gears,
    )


def _carrier(planets: Any, pair: GearPair, density: float) -> dict[str, Any]:
    """The carrier of a stage of `of_planets` by its keys; nothing where it does not count."""
    if not planets.carrier:
        return {}
    across, width, volume = map(float, planets.cheeks(pair))
    sizes = {"carrier_diameter_mm": across, "carrier_width_mm": width}
    return sizes | {"carrier_mass_kg": 1000.0 * density * volume}


def with_planets(design: DriveDesign, stages: tuple[StageDesign, ...]) -> DriveDesign:
    """A drive with its planetary stages, whose shafts are in one line, and their totals."""
    apart = [s.centre_distance_mm for s in stages if s.type != "planetary"]
    ends = stages[0].end_diameters[0] + stages[-1].end_diameters[1]
    return replace(
        design,
        stages=stages,
        mass_kg=sum(s.mass_kg for s in stages),
        gear_volume_mm3=sum(s.gear_volume_mm3 for s in stages),
        sum_of_centre_distances_mm=sum(apart),
        total_length_mm=0.5 * ends + sum(apart),
    )


def _of_materials(stage: StageDesign, option: Option, usual: float) -> StageDesign:
    """Return a stage of the materials of an option; usual: the density [t/mm3] of others."""
    first, second = ((own or usual) / usual for own in option.densities)
    masses = first * stage.pinion_mass_kg, second * stage.wheel_mass_kg
    return replace(
        stage,
        pinion_mass_kg=masses[0],
        wheel_mass_kg=masses[1],
        mass_kg=sum(masses),
        pinion_material=option.materials[0],
        wheel_material=option.materials[1],
    )


def of_pairs(
    law: Law,
    pairs: tuple[GearPair, ...],
    torque: float,
    speed: float,
    asked_ratio: Fraction | None = None,
    density: float | None = None,
    blanks: Sequence[tuple[Blank, Blank]] = (),
    drivers: Sequence[str] = (),
    idlers: Sequence[int] = (),
) -> DriveDesign:
    """Return stages and totals of a drive; idlers: stages whose pinion is the wheel before, from 1.

    torque [N mm], speed [rad/s] of the input; asked_ratio: None where none is asked for. Masses are
    those of the blanks of every stage, by default solid and of steel; density [t/mm3]. drivers: as
    of `torque_ratios`.
    """
    density, drivers = density or STEEL_DENSITY, drivers or ("pinion",) * len(pairs)
    ratios = torque_ratios([float(pair.ratio) for pair in pairs], drivers)
    rows = zip(pairs, blanks or [(SOLID, SOLID)] * len(pairs), drivers, ratios, strict=True)
    stages = [
        _stage(law, pair, torque * at, speed / at, density, bodies, driver)
        for pair, bodies, driver, (at, _) in rows
    ]
    for k in idlers:
        stages[k - 1] = _without_pinion(stages[k - 1], pairs[k - 1])
    ratio = ratios[-1][1]
    volume = sum(s.gear_volume_mm3 for s in stages)
    centres = sum(s.centre_distance_mm for s in stages)
    ends = stages[0].end_diameters[0] + stages[-1].end_diameters[1]
    return DriveDesign(
        stages=tuple(stages),
        ratio=ratio,
        ratio_error_percent=(
            0.0 if asked_ratio is None else round(100.0 * (ratio / float(asked_ratio) - 1.0), 9)
        ),
        output_torque_Nm=1e-3 * torque * ratio,
        gear_volume_mm3=volume,
        sum_of_centre_distances_mm=centres,
        total_length_mm=0.5 * ends + centres,
        mass_kg=sum(s.mass_kg for s in stages),
    )


def _without_pinion(stage: StageDesign, pair: GearPair) -> StageDesign:
    """A stage whose pinion is an idler, which is counted in the stage before."""
    volume, mass = stage.gear_volume_mm3 - float(pair.pinion.volume), stage.wheel_mass_kg
    return replace(stage, idler=True, gear_volume_mm3=volume, pinion_mass_kg=0.0, mass_kg=mass)


def _stage(
    law: Law,
    pair: GearPair,
    torque: float,
    speed: float,
    density: float,
    blanks: tuple[Blank, Blank],
    driver: str,
) -> StageDesign:
    """Describe a pair; torque [N mm] and speed [rad/s] are its pinion's."""
    pinion, wheel = pair.gears
    d, loads = pinion.reference_diameter, law.indices(pair, torque, speed)
    rows = zip(blanks, pair.gears, strict=True)
    masses = [1000.0 * density * float(blank.volume(gear)) for blank, gear in rows]
    return StageDesign(
        normal_module_mm=float(pair.normal_module),
        pinion_teeth=_whole(pair.pinion_teeth),
        wheel_teeth=_whole(pair.wheel_teeth),
        driver=driver,
        ratio=float(pair.ratio),
        face_width_mm=float(pair.face_width),
        pinion_face_width_mm=float(pinion.width) if pinion.width_excess else None,
        wheel_face_width_mm=float(wheel.width) if wheel.width_excess else None,
        pinion_diameter_mm=float(d),
        wheel_diameter_mm=float(wheel.reference_diameter),
        pinion_tip_diameter_mm=float(pinion.tip_diameter),
        wheel_tip_diameter_mm=float(wheel.tip_diameter),
        pinion_root_diameter_mm=float(pinion.root_diameter),
        wheel_root_diameter_mm=float(wheel.root_diameter),
        centre_distance_mm=float(pair.centre_distance),
        transverse_contact_ratio=float(pair.transverse_contact_ratio),
        overlap_ratio=float(pair.overlap_ratio),
        pinion_torque_Nm=1e-3 * torque,
        pitch_line_velocity_m_per_s=float(1e-3 * pitch_line_velocity(speed, d)),
        indices={
            limit.design_key: float(load) for limit, load in zip(law.limits, loads, strict=True)
        },
        gear_volume_mm3=float(pair.volume),
        pinion_mass_kg=masses[0],
        wheel_mass_kg=masses[1],
        mass_kg=sum(masses),
        **_teeth(pair),
        **_bodies(pair, blanks),
    )


def _teeth(pair: GearPair) -> dict[str, Any]:
    """Words of a stage on how its teeth are cut."""
    working, reference = pair.working_angle, pair.pinion.transverse_pressure_angle
    words: dict[str, Any] = {
        "helix_angle_deg": round(math.degrees(pair.pinion.helix_angle), 12),
        "pressure_angle_deg": round(math.degrees(pair.pinion.rack.pressure_angle), 12),
        "working_pressure_angle_deg": None if working == reference else math.degrees(working),
    }
    for member, gear in zip(("pinion", "wheel"), pair.gears, strict=True):
        words |= _tool(member, gear)
        words[f"{member}_profile_shift"] = float(gear.profile_shift)
        words[f"{member}_tip_alteration"] = float(gear.tip_alteration)
    return words


def _tool(member: str, gear: Gear) -> dict[str, Any]:
    """Words on the rack that cuts a gear, and how much thinner its teeth are."""
    rack = gear.rack
    tool = rack.addendum, rack.dedendum, rack.tip_radius, rack.protuberance, rack.tip_chamfer
    words = {f"{member}_{n}": float(v) for n, v in zip(TOOL, tool, strict=True)}
    return words | {f"{member}_thickness_allowance_mm": float(gear.thickness_allowance)}


def _bodies(pair: GearPair, blanks: tuple[Blank, Blank]) -> dict[str, Any]:
    """Return the dimensions of rims, webs, hubs and bores."""
    dimensions: dict[str, Any] = {}
    for member, blank, gear in zip(MEMBERS, blanks, pair.gears, strict=True):
        rows = asdict(blank.body(gear)).items()
        dimensions |= {f"{member}_{name}_mm": value for name, value in rows}
    return dimensions


def _whole(teeth: float) -> float | int:
    """Return a number of teeth as an integer where it is one."""
    return round(teeth) if abs(teeth - round(teeth)) < 1e-9 else float(teeth)
