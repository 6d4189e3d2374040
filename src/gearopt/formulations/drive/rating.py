"""The rating of a drive for its report: stresses, safety, lives, factors, forces, tooth geometry.

Fields are keys of a result, with their units; a list is a table. Stages and shafts count from 1.
"""

from dataclasses import dataclass

from gearopt.optimise.result import FEASIBLE


@dataclass(frozen=True, kw_only=True)
class GearRating:
    """One gear in its mesh.

    permissible stresses: allowable stress numbers times factors of life, hardness, temperature and
    reliability, without a safety factor. Of a load spectrum stresses are those of the level where
    they are largest, safety factors those of all levels. Lives: None beyond the end of the
    curves; 0 where it fails at once. damages: Miner's sums, of a spectrum.
    """

    stage: int
    member: str
    material: str
    bending_stress_MPa: float
    permissible_bending_stress_MPa: float
    bending_safety: float
    contact_stress_MPa: float
    permissible_contact_stress_MPa: float
    contact_safety: float
    cycles: float
    bending_life_cycles: float | None
    contact_life_cycles: float | None
    life_h: float | None
    bending_damage: float | None = None
    contact_damage: float | None = None


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
    """One mesh: contact, forces at the working pitch circles, losses, what it may transmit.

    Of a load spectrum forces, velocity and friction are those of the level of largest force.
    governs: member and mode of the least safety, against the safety factors that are asked for;
    power_capacity: at which it is just met. Contact ratios are those of the tip circles, which the
    standards take; usable: the transverse one that undercut leaves, None where it is all.
    friction, efficiency: None where nothing is known of the oil; the error, up or down, is that of
    a computed friction.
    """

    stage: int
    governs: str
    power_capacity_kW: float
    tangential_force_N: float
    radial_force_N: float
    axial_force_N: float
    pitch_line_velocity_m_per_s: float
    working_pressure_angle_deg: float
    working_helix_angle_deg: float
    transverse_contact_ratio: float
    overlap_ratio: float
    total_contact_ratio: float
    usable_contact_ratio: float | None
    circumferential_backlash_mm: float
    normal_backlash_mm: float
    tooth_loss_factor: float
    friction_coefficient: float | None = None
    mesh_efficiency_percent: float | None = None
    mesh_efficiency_error_percent: float | None = None


@dataclass(frozen=True, kw_only=True)
class ShaftRating:
    """One shaft: what it carries without losses.

    rotation: seen from the input end, where the input turns clockwise. axial_force: sum of its
    gears, positive away from the input end; the other way round with the rotation.
    """

    shaft: int
    torque_Nm: float
    speed_rpm: float
    rotation: str
    axial_force_N: float


@dataclass(frozen=True, kw_only=True)
class ToothGeometry:
    """The teeth of one gear (ISO 21771): shifts in normal modules, diameters, measurements.

    generating shift: of the tool, with the thickness allowance. active root: where contact with the
    mate ends; largest specific sliding, at the ends of contact. Span and balls of whole teeth
    only, and where they touch the flanks; ball of 1.7 m_n or so.
    """

    stage: int
    member: str
    hand: str
    teeth: float
    profile_shift: float
    generating_shift: float
    reference_diameter_mm: float
    working_pitch_diameter_mm: float
    base_diameter_mm: float
    tip_diameter_mm: float
    root_diameter_mm: float
    form_diameter_mm: float
    active_root_diameter_mm: float | None
    tip_thickness_mm: float
    tip_clearance_mm: float
    largest_specific_sliding: float | None
    span_teeth: int | None = None
    span_mm: float | None = None
    ball_diameter_mm: float | None = None
    over_balls_mm: float | None = None


@dataclass(frozen=True, kw_only=True)
class LoadLevel:
    """One level of a load spectrum: its share of the life, and of Miner's sums of one gear."""

    stage: int
    member: str
    level: int
    power_kW: float
    input_speed_rpm: float
    share_percent: float
    cycles: float
    bending_stress_MPa: float
    contact_stress_MPa: float
    bending_damage: float | None
    contact_damage: float | None


@dataclass(frozen=True, kw_only=True)
class DriveRating:
    """The rating of all stages.

    safe: whether every gear meets the safety factors that are asked for, and the gears fit. life_h:
    the shortest of all gears, None beyond the end of the curves. unverified: symbols of factors,
    and what else no second source has. misfits: sentences on gears that cannot be assembled or
    cannot run. flaws: on what a designer may accept, and on the ratio of given gears that is not
    the one asked for. by: the standard in short; beside: the rating by another one.
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
    beside: "DriveRating | None" = None

    @property
    def each(self) -> tuple["DriveRating", ...]:
        """Return the ratings by all standards, this one first."""
        return (self,) if self.beside is None else (self, self.beside)

    @property
    def met(self) -> bool:
        """Return whether every gear meets the safety factors asked for, whether or not it fits."""
        return all(
            self.minimum_bending_safety <= (1.0 + FEASIBLE) * gear.bending_safety
            and self.minimum_contact_safety <= (1.0 + FEASIBLE) * gear.contact_safety
            for gear in self.gears
        )

    @property
    def met_by_all(self) -> bool:
        """Return whether every gear meets the safety factors by all standards."""
        return all(one.met for one in self.each)

    @property
    def safe_by_all(self) -> bool:
        """Return whether the gears fit and meet the safety factors by all standards."""
        return all(one.safe for one in self.each)
