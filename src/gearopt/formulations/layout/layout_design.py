"""A layout in the words of its drawing: what a result holds of box, shafts, gears and gaps.

Fields are the keys of a result, with their units; x runs along the shafts from the inner face of
the box, y and z across them from the axis of shaft 1, the input. Counting starts at 1.
"""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class BoxDesign:
    """Inside of the box: sizes, and where its left and lower walls are."""

    width_mm: float
    height_mm: float
    length_mm: float
    left_mm: float
    bottom_mm: float
    volume_mm3: float
    plan_area_mm2: float
    face_area_mm2: float

    @property
    def sides(self) -> tuple[float, float, float]:
        """Return width, height and length [mm]."""
        return self.width_mm, self.height_mm, self.length_mm


@dataclass(frozen=True, kw_only=True)
class ShaftDesign:
    """Where a shaft is, and where it ends."""

    shaft: int
    y_mm: float
    z_mm: float
    diameter_mm: float
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class GearDesign:
    """A gear on its shaft; member: pinion or wheel."""

    name: str
    stage: int
    member: str
    shaft: int
    teeth: float
    normal_module_mm: float
    reference_diameter_mm: float
    tip_diameter_mm: float
    root_diameter_mm: float
    helix_angle_deg: float
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class BearingDesign:
    """A bearing on its shaft."""

    shaft: int
    diameter_mm: float
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class GapDesign:
    """Clear distance of two bodies that must keep apart, what is needed, and that of their axes."""

    between: tuple[str, str]
    gap_mm: float
    needed_mm: float
    axes_mm: float


@dataclass(frozen=True, kw_only=True)
class ClearanceDesign:
    """Clearances that the layout keeps."""

    gear_to_gear_mm: float
    gear_to_shaft_mm: float
    wall_mm: float
    axial_mm: float


@dataclass(frozen=True, kw_only=True)
class KeepOutDesign:
    """A box that must stay free."""

    name: str
    left_mm: float
    right_mm: float
    bottom_mm: float
    top_mm: float
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class MotorDesign:
    """The motor on the input shaft, at the face where the output shaft leaves."""

    diameter_mm: float


@dataclass(frozen=True, kw_only=True)
class LayoutDesign:
    """Where everything is; slabs: the stages side by side; split: shafts on the split line."""

    box: BoxDesign
    shafts: tuple[ShaftDesign, ...]
    gears: tuple[GearDesign, ...]
    bearings: tuple[BearingDesign, ...]
    link_angles_deg: tuple[float, ...]
    slabs: tuple[tuple[int, ...], ...]
    gaps: tuple[GapDesign, ...]
    clearances: ClearanceDesign
    obstacles: tuple[KeepOutDesign, ...]
    motor: MotorDesign | None
    split: tuple[int, ...]
