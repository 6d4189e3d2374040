"""The rating of a drive for its report: stresses, safety, lives, factors, forces, tooth geometry.

Fields are keys of a result, with their units; a list is a table. Stages and shafts count from 1.
"""

from collections.abc import Iterator
from typing import Annotated

from gearopt.frozen import dataclass
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.typed import Shown
from gearopt.physics.agma.life import LONGEST_LIFE

GIVEN = "given"  # source of a factor of the file


@dataclass(frozen=True, kw_only=True)
class GearRating:
    """One gear in its mesh.

    permissible stresses, for a safety factor of 1: allowable stress numbers times factors of life,
    hardness, temperature and reliability; by ISO 6336 the limits sigma_FG and sigma_HG. Of a load
    spectrum stresses are those of the level where they are largest, safety factors those of all
    levels. Lives: None beyond the end of the curves; 0 where it fails at once. damages: Miner's
    sums, of a spectrum. required safeties: of its stage; None: those of the drive.
    """

    stage: int
    member: str
    material: Annotated[str, Shown("material")]
    bending_stress_MPa: Annotated[float, Shown("bending stress")]
    permissible_bending_stress_MPa: Annotated[float, Shown("bending stress limit")]
    bending_safety: Annotated[float, Shown("S_F")]
    contact_stress_MPa: Annotated[float, Shown("contact stress")]
    permissible_contact_stress_MPa: Annotated[float, Shown("contact stress limit")]
    contact_safety: Annotated[float, Shown("S_H")]
    cycles: Annotated[float, Shown("load cycles")]
    bending_damage: Annotated[float | None, Shown("Miner's sum, bending")] = None
    contact_damage: Annotated[float | None, Shown("Miner's sum, contact")] = None
    bending_life_cycles: Annotated[float | None, Shown("life, bending")]
    contact_life_cycles: Annotated[float | None, Shown("life, contact")]
    life_h: Annotated[float | None, Shown("life")]
    required_bending_safety: float | None = None
    required_contact_safety: float | None = None


@dataclass(frozen=True, kw_only=True)
class StaticRating:
    """One gear under the peak torque, against static strength, with what is asked of it."""

    stage: int
    member: str
    torque_Nm: Annotated[float, Shown("peak torque of the pinion")]
    static_bending_stress_MPa: Annotated[float, Shown("bending stress sigma_F")]
    static_bending_limit_MPa: Annotated[float, Shown("static bending stress limit sigma_FG")]
    static_bending_safety: Annotated[float, Shown("static S_F")]
    static_contact_stress_MPa: Annotated[float, Shown("contact stress sigma_H")]
    static_contact_limit_MPa: Annotated[float, Shown("static contact stress limit sigma_HG")]
    static_contact_safety: Annotated[float, Shown("static S_H")]
    required_static_bending_safety: float
    required_static_contact_safety: float


@dataclass(frozen=True, kw_only=True)
class RatingFactor:
    """A factor: of the mesh (wheel None, the value under pinion), or of each gear.

    unit: "" or what `report.measures` knows. remark: what limits it; source: its clause.
    """

    stage: int
    symbol: str
    name: str
    pinion: float
    wheel: float | None
    unit: str
    source: str
    verified: bool
    remark: str


@dataclass(frozen=True, kw_only=True)
class MeshRating:
    """One mesh: contact, forces at the working pitch circles, losses, transmissible torque.

    Of a load spectrum forces, velocity and friction are those of the level of largest force.
    governs: member and mode of the least safety, against the safety factors that are asked for;
    power_capacity: at which it is just met. Contact ratios are those of the tip circles, which the
    standards take; usable: the transverse one that undercut leaves, None where it is all.
    friction, efficiency: None where nothing is known of the oil; the error, up or down, is that of
    a computed friction. accuracy_grades: of ISO 1328-1 of both gears, None where not given.
    """

    stage: int
    governs: Annotated[str, Shown("governs the power capacity", "governing")]
    power_capacity_kW: Annotated[float, Shown("power capacity", "governing")]
    tangential_force_N: Annotated[float, Shown("tangential force F_t")]
    radial_force_N: Annotated[float, Shown("radial force F_r")]
    axial_force_N: Annotated[float, Shown("axial force F_a")]
    pitch_line_velocity_m_per_s: Annotated[float, Shown("pitch-line velocity v")]
    working_pressure_angle_deg: Annotated[float, Shown("working pressure angle α_wt")]
    working_helix_angle_deg: Annotated[float, Shown("working helix angle β_w")]
    transverse_contact_ratio: Annotated[float, Shown("transverse contact ratio ε_α")]
    overlap_ratio: Annotated[float, Shown("overlap ratio ε_β")]
    total_contact_ratio: Annotated[float, Shown("total contact ratio ε_γ")]
    usable_contact_ratio: Annotated[
        float | None, Shown("transverse contact ratio that undercut leaves")
    ]
    circumferential_backlash_mm: Annotated[float, Shown("circumferential backlash j_wt")]
    normal_backlash_mm: Annotated[float, Shown("normal backlash j_bn")]
    tooth_loss_factor: Annotated[float, Shown("tooth loss factor H_V")]
    friction_coefficient: Annotated[float | None, Shown("coefficient of friction μ")] = None
    mesh_efficiency_percent: Annotated[float | None, Shown("efficiency of the mesh")] = None
    mesh_efficiency_error_percent: Annotated[float | None, Shown("its error, up or down")] = None
    accuracy_grades: tuple[int, int] | None = None


@dataclass(frozen=True, kw_only=True)
class ShaftRating:
    """One shaft: its torque, speed and forces without losses.

    rotation: seen from the input end, where the input turns clockwise. axial_force: sum of its
    gears, positive away from the input end; the other way round with the rotation.
    """

    shaft: int
    torque_Nm: Annotated[float, Shown("torque")]
    speed_rpm: Annotated[float, Shown("speed")]
    rotation: Annotated[str, Shown("turns")]
    axial_force_N: Annotated[float, Shown("axial force")]


@dataclass(frozen=True, kw_only=True)
class ToothGeometry:
    """The teeth of one gear (ISO 21771): shifts in normal modules, diameters, measurements.

    generating shift: of the tool, with the thickness allowance. active root: where contact with the
    mate ends; largest specific sliding, at the ends of contact. Span and balls of whole teeth
    only, and where they touch the flanks; ball of 1.7 m_n or so.
    """

    stage: int
    member: str
    hand: Annotated[str, Shown("hand of the helix")]
    teeth: Annotated[float, Shown("teeth z")]
    profile_shift: Annotated[float, Shown("profile shift x")]
    generating_shift: Annotated[float, Shown("generating shift x_E")]
    face_width_mm: Annotated[float | None, Shown("face width b")] = None
    reference_diameter_mm: Annotated[float, Shown("reference diameter d")]
    working_pitch_diameter_mm: Annotated[float, Shown("working pitch diameter d_w")]
    base_diameter_mm: Annotated[float, Shown("base diameter d_b")]
    tip_diameter_mm: Annotated[float, Shown("tip diameter d_a")]
    tip_form_diameter_mm: Annotated[float | None, Shown("tip form diameter d_Na")] = None
    root_diameter_mm: Annotated[float, Shown("root diameter d_f")]
    form_diameter_mm: Annotated[float, Shown("root form diameter d_Ff")]
    active_root_diameter_mm: Annotated[float | None, Shown("active root diameter d_Nf")]
    tip_thickness_mm: Annotated[float, Shown("tip thickness s_a")]
    tip_clearance_mm: Annotated[float, Shown("tip clearance c")]
    largest_specific_sliding: Annotated[float | None, Shown("largest specific sliding ζ")]
    span_teeth: Annotated[int | None, Shown("teeth spanned k")] = None
    span_mm: Annotated[float | None, Shown("span W_k")] = None
    ball_diameter_mm: Annotated[float | None, Shown("ball diameter D_M")] = None
    over_balls_mm: Annotated[float | None, Shown("diameter over balls M_dK")] = None


@dataclass(frozen=True, kw_only=True)
class LoadLevel:
    """One level of a load spectrum: its share of the life, and of Miner's sums of one gear."""

    stage: int
    member: str
    level: Annotated[int, Shown("level")]
    power_kW: Annotated[float, Shown("power")]
    input_speed_rpm: Annotated[float, Shown("input speed")]
    share_percent: Annotated[float, Shown("share of life")]
    cycles: Annotated[float, Shown("cycles")]
    bending_stress_MPa: Annotated[float, Shown("bending stress")]
    contact_stress_MPa: Annotated[float, Shown("contact stress")]
    bending_damage: Annotated[float | None, Shown("damage, bending")]
    contact_damage: Annotated[float | None, Shown("damage, contact")]


@dataclass(frozen=True, kw_only=True)
class MeshName:
    """What a mesh and its gears are called; stage: that has it, from 1; suffix: of its limits."""

    stage: int
    title: str
    pinion: str = "pinion"
    wheel: str = "wheel"
    suffix: str = ""

    @property
    def gears(self) -> tuple[str, str]:
        """Both gears, whichever mesh they are in."""
        return self.pinion.partition(" at ")[0], self.wheel.partition(" at ")[0]

    @property
    def words(self) -> str:
        """The mesh in a sentence: by its stage, of one with planets by its gears, too."""
        return f"{' and '.join(self.gears)} of " * bool(self.suffix) + f"stage {self.stage}"


@dataclass(frozen=True, kw_only=True)
class DriveRating:
    """The rating of all stages.

    safe: whether every gear meets the safety factors that are asked for, by the rating beside it,
    too, and the gears fit. life_h: that of the `shortest_lived` gear, None beyond the end of its
    curve. unverified: symbols of factors, and what else no second source has. misfits: sentences
    on gears that cannot be assembled or cannot run. flaws: on what a designer may accept, and on
    the ratio of given gears that is not the one asked for. by: the standard in short; beside: the
    rating by another one. static: of every gear under a peak torque. idlers: stages whose pinion
    is the wheel of the stage before, one gear in two meshes. named: of
    drives with planets or rings, of every mesh, which its rows then count in place of stages.
    """

    standard: str
    safe: bool
    governs: str
    minimum_bending_safety: float
    minimum_contact_safety: float
    power_capacity_kW: float
    required_life_h: float
    life_h: float | None
    efficiency_percent: float | None
    efficiency_error_percent: float | None
    gears: tuple[GearRating, ...]
    meshes: tuple[MeshRating, ...]
    factors: tuple[RatingFactor, ...]
    shafts: tuple[ShaftRating, ...]
    teeth: tuple[ToothGeometry, ...]
    levels: tuple[LoadLevel, ...] = ()
    unverified: tuple[str, ...] = ()
    misfits: tuple[str, ...] = ()
    flaws: tuple[str, ...] = ()
    by: str = "AGMA"
    static: tuple[StaticRating, ...] = ()
    idlers: tuple[int, ...] = ()
    named: tuple["MeshName", ...] = ()
    beside: "DriveRating | None" = None

    @property
    def each(self) -> tuple["DriveRating", ...]:
        """Return the ratings by all standards, this one first."""
        return (self,) if self.beside is None else (self, self.beside)

    def asked_of(self, gear: GearRating) -> tuple[float, float]:
        """S_F and S_H asked for of a gear."""
        bending, contact = gear.required_bending_safety, gear.required_contact_safety
        return (
            self.minimum_bending_safety if bending is None else bending,
            self.minimum_contact_safety if contact is None else contact,
        )

    def called(self, gear: GearRating | StaticRating | ToothGeometry | LoadLevel) -> str:
        """What a gear is: pinion, wheel or idler, sun, planet or ring."""
        if self.named:
            of_mesh = self.named[gear.stage - 1]
            return of_mesh.wheel if gear.member == "wheel" else of_mesh.pinion
        return "idler" if gear.stage + (gear.member == "wheel") in self.idlers else gear.member

    def titled(self, mesh: int) -> str:
        """A mesh (from 1) by its stage."""
        return self.named[mesh - 1].title if self.named else f"stage {mesh}"

    def mesh_words(self, mesh: int) -> str:
        """A mesh (from 1) in a sentence."""
        return self.named[mesh - 1].words if self.named else f"stage {mesh}"

    def stage_of(self, mesh: int) -> int:
        """The stage of a mesh, both from 1."""
        return self.named[mesh - 1].stage if self.named else mesh

    def known_life_h(self, gear: GearRating) -> float:
        """Life of a gear [h] as far as its curve reaches: at least that."""
        if gear.life_h is not None:
            return gear.life_h
        return LONGEST_LIFE / gear.cycles * self.required_life_h

    @property
    def shortest_lived(self) -> GearRating:
        """The gear whose life, as far as it is known, is shortest: it governs that of the drive."""
        return min(self.gears, key=self.known_life_h)

    @property
    def met(self) -> bool:
        """Return whether every gear meets the safety factors asked for, whether or not it fits."""
        return all(asked <= (1.0 + FEASIBLE) * reached for *_, reached, asked in self.margins)

    @property
    def margins(self) -> Iterator[tuple[GearRating | StaticRating, str, float, float]]:
        """Every gear with a mode, the safety factor reached and the one asked for."""
        for gear in self.gears:
            bending, contact = self.asked_of(gear)
            yield gear, "bending", gear.bending_safety, bending
            yield gear, "contact", gear.contact_safety, contact
        for held in self.static:
            bending = held.required_static_bending_safety
            contact = held.required_static_contact_safety
            yield held, "static bending", held.static_bending_safety, bending
            yield held, "static contact", held.static_contact_safety, contact

    @property
    def met_by_all(self) -> bool:
        """Return whether every gear meets the safety factors by all standards."""
        return all(one.met for one in self.each)

    @property
    def safe_by_all(self) -> bool:
        """Return whether the gears fit and meet the safety factors by all standards."""
        return all(one.safe for one in self.each)
