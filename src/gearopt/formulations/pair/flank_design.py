"""Fields of a report on contact over the flank of a pair: line loads, pressure, errors, stiffness.

Fields are keys of a result, with their units.
"""

from typing import Annotated

from gearopt.formulations.pair.design import Columns, ElasticTeeth, LoadedMesh
from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown


@dataclass(frozen=True, kw_only=True)
class FlankLoad(LoadedMesh):
    """Contact over the flank at one load.

    line load: transverse normal force per face width, largest at position s on the path of contact
    and y across the face, as the largest contact stress. face_load_factor: largest over mean of the
    force per face width, summed over all lines and averaged over a base pitch. line_load, stress:
    one row per place across the face, over the path of the flank.
    """

    normal_force_N: Annotated[float, Shown("transverse normal force", "forces")]
    largest_line_load_N_per_mm: Annotated[
        float, Shown("largest line load", "forces", unit="N_per_mm")
    ]
    line_load_position_mm: Annotated[float, Shown("at s on the path", "forces")]
    line_load_place_mm: Annotated[float, Shown("and y across the face", "forces")]
    face_load_factor: Annotated[float, Shown("face load factor of the flank", "forces")]
    contact_stress_position_mm: Annotated[float, Shown("there at s", "stress")]
    contact_stress_place_mm: Annotated[float, Shown("there at y", "stress")]
    plain_peak_to_peak_mm: Annotated[
        float | None, Shown("the same without relief", "motion", "um")
    ] = None
    open_share: float
    line_load_N_per_mm: tuple[Columns, ...]
    contact_stress_MPa: tuple[Columns, ...]


@dataclass(frozen=True, kw_only=True)
class FlankContact(ElasticTeeth):
    """Contact over the flank of a pair of gears, helical or spur, by slices across the face.

    crowning, helix_correction, misalignment: gaps of both flanks together. relief: amounts at the
    tips of pinion and wheel, lengths on the path and diameters where it starts. contact_lines:
    least, mean and largest length of all, by closed form. path_mm: positions s of the columns of a
    flank; place_mm: y of its rows, from the middle of the face towards the end where contact
    begins. travel_mm: over one base pitch; unloaded_error_mm: by how much unloaded flanks are apart
    there.
    """

    slices: int
    crowning_mm: float
    helix_correction_mm: float
    misalignment_mm: float
    relief_mm: tuple[float, float]
    relief_length_mm: tuple[float, float]
    relief_diameters_mm: tuple[float, float]
    base_helix_angle_deg: float
    face_width_mm: float
    overlap_ratio: float
    contact_lines_mm: tuple[float, float, float]
    path_mm: Columns
    place_mm: Columns
    travel_mm: Columns
    unloaded_error_mm: Columns
    loads: tuple[FlankLoad, ...]
    validity: tuple[str, ...] = ()
