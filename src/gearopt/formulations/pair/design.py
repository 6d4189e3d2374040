"""Fields of a report on a spur pair in contact: stiffness, shares, errors and stresses, relief.

Fields are keys of a result, with their units; lists of one table are columns of equal length.
"""

from typing import Annotated

from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown
from gearopt.physics.tooth.measured import Errors

Columns = tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class ContactPoint:
    """A point of the path of contact with the stiffness of one pair of teeth there.

    roll angles: from where the involutes begin. stiffness: force per face width and
    approach along the line of action.
    """

    point: Annotated[str, Shown("point")]
    position_mm: Annotated[float, Shown("s")]
    pinion_diameter_mm: Annotated[float, Shown("pinion diameter")]
    wheel_diameter_mm: Annotated[float, Shown("wheel diameter")]
    pinion_roll_angle_deg: Annotated[float, Shown("pinion roll angle", form=".3f")]
    wheel_roll_angle_deg: float
    pair_stiffness_MPa: Annotated[float, Shown("stiffness of a pair", unit="N_per_mm_um")]


@dataclass(frozen=True, kw_only=True)
class LoadedMesh:
    """A pair of gears at one load, over one base pitch of travel.

    load: relative to the torque of the duty. transmission error: approach of the gears along the
    transverse line of action at every travel; its harmonics: amplitudes at the mesh frequency and
    its multiples. mesh stiffness: normal force over face width and approach.
    """

    load: float
    normal_force_N: Annotated[float, Shown("normal force", "forces")]
    largest_contact_stress_MPa: Annotated[float, Shown("largest contact stress", "stress")]
    mean_transmission_error_mm: Annotated[float, Shown("transmission error, mean", "motion", "um")]
    peak_to_peak_mm: Annotated[float, Shown("peak to peak", "motion", "um")]
    harmonics_mm: Columns
    mean_mesh_stiffness_MPa: Annotated[
        float, Shown("mesh stiffness, mean", "stiffness", "N_per_mm_um")
    ]
    least_mesh_stiffness_MPa: Annotated[
        float, Shown("mesh stiffness, minimum", "stiffness", "N_per_mm_um")
    ]
    most_mesh_stiffness_MPa: Annotated[
        float, Shown("mesh stiffness, maximum", "stiffness", "N_per_mm_um")
    ]
    transmission_error_mm: Columns


@dataclass(frozen=True, kw_only=True)
class ContactLoad(LoadedMesh):
    """Contact of a spur pair at one load.

    share, contact stress: of the pair of teeth at every position of the path of contact.
    """

    largest_tooth_force_N: Annotated[float, Shown("largest load on a tooth", "forces")]
    largest_share: float
    share: Columns
    contact_stress_MPa: Columns


@dataclass(frozen=True, kw_only=True)
class ElasticTeeth:
    """The teeth of a pair in contact, as they give way.

    level, plane, coupling: models of the teeth's compliance; the load of one pair of teeth moves
    the others by coupling_mm_per_N. error: least and largest of the level's stiffness against
    finite elements, of all pairs it was measured on. bores: where the gears are held. iso: c' and
    c_gamma_alpha of ISO 6336-1, beside.
    """

    level: str
    error_percent: tuple[float, float]
    plane: str
    coupling: str
    coupling_mm_per_N: float
    pinion_bore_mm: float
    wheel_bore_mm: float
    base_pitch_mm: float
    contact_ratio: float
    iso_single_stiffness_MPa: float
    iso_mesh_stiffness_MPa: float


@dataclass(frozen=True, kw_only=True)
class PairContact(ElasticTeeth):
    """The contact of a spur pair.

    path: columns along the path of contact from SAP to EAP, both sides of points where pairs come
    and go. rule_relief: what off the tips of pinion and wheel lets pairs come and go without load
    at the duty's torque, by rule. in_mesh: errors of level and coupling together, where they are
    known. travel_mm: of the pinion's base circle over one base pitch, 0 where a pair comes into
    contact. validity: sentences on what models do not cover.
    """

    rule_relief_mm: tuple[float, float]
    points: tuple[ContactPoint, ...]
    position_mm: Columns
    pinion_diameter_mm: Columns
    wheel_diameter_mm: Columns
    pinion_roll_angle_deg: Columns
    wheel_roll_angle_deg: Columns
    pair_stiffness_MPa: Columns
    travel_mm: Columns
    loads: tuple[ContactLoad, ...]
    validity: tuple[str, ...] = ()
    in_mesh: Errors | None = None


@dataclass(frozen=True, kw_only=True)
class FlankRelief:
    """Depth removed from the flanks of one gear: a (1 - x/l)^p at x from the tip.

    amount a: normal to the flank, at the tip; length l: on the line of action; exponent p, None of
    a shape of its own, which the profile tells; diameter and roll angle where it starts, which a
    grinder needs.
    """

    amount_mm: Annotated[float, Shown("amount at the tip", unit="um")]
    start_diameter_mm: Annotated[float, Shown("starts at diameter", form=".3f")]
    start_roll_angle_deg: Annotated[float, Shown("starts at roll angle", form=".3f")]
    tip_diameter_mm: Annotated[float, Shown("tip diameter", form=".3f")]
    tip_roll_angle_deg: Annotated[float, Shown("roll angle at the tip", form=".3f")]
    length_mm: Annotated[float, Shown("length on the path")]
    exponent: float | None = None


@dataclass(frozen=True, kw_only=True)
class ReliefRow:
    """A relief by rule, or none, beside the one that is designed.

    peak_to_peak_mm, load_jump: at every load the relief is made for. value: of what is minimised.
    """

    name: str
    pinion_amount_mm: Annotated[float, Shown("pinion", unit="um")]
    wheel_amount_mm: Annotated[float, Shown("wheel", unit="um")]
    value: float
    peak_to_peak_mm: Columns
    load_jump: Columns
    exponent: float | None = None


@dataclass(frozen=True, kw_only=True)
class MadeRelief:
    """The relief as it is made: amounts and lengths off by their tolerances, either way.

    worst: largest peak-to-peak of all loads that was found, at these amounts and lengths of pinion
    and wheel; bound: none exceeds it, proven. median, most: of so many drawn ones, uniformly, half
    and 95 % stay below them.
    """

    amount_tolerance_mm: float
    length_tolerance_mm: float
    worst_mm: float
    bound_mm: float
    worst_amounts_mm: tuple[float, float]
    worst_lengths_mm: tuple[float, float]
    drawn: int
    median_mm: float
    most_mm: float


@dataclass(frozen=True, kw_only=True)
class JudgedRelief:
    """The same flanks by the finest level, beside the one under which they were chosen.

    value: of what is minimised, without_relief: without any; peak_to_peak: at every load the relief
    is made for.
    """

    level: str
    value: float
    without_relief: float
    peak_to_peak_mm: Columns


@dataclass(frozen=True, kw_only=True)
class PairRelief:
    """The relief of a spur pair.

    minimise: of the worst of all loads, relative to the torque of the duty. pinion_removed_mm,
    wheel_removed_mm: columns beside those of the path of contact. at: what happens at every load of
    the contact with it. rows: rules beside it, and no relief. break_even: load below
    which the gears run more evenly without it, None where there is none. finer_mm: peak-to-peak at
    every load on ten times as many positions. made: within tolerances. level, coupling: under which
    it is chosen, and what is said of it holds; judged: by the finest level, None where that is the
    same or unjudged says why not; in_mesh: measured errors of level and coupling, where known.
    """

    minimise: str
    loads: Columns
    pinion: FlankRelief
    wheel: FlankRelief
    pinion_removed_mm: Columns
    wheel_removed_mm: Columns
    at: tuple[ContactLoad, ...]
    rows: tuple[ReliefRow, ...]
    break_even: float | None = None
    finer_mm: Columns = ()
    made: MadeRelief | None = None
    level: str = ""
    coupling: str = ""
    judged: JudgedRelief | None = None
    unjudged: str = ""
    in_mesh: Errors | None = None
