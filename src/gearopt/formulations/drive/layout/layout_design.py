"""A layout as a result holds it: box, shafts, gears and gaps, by the names of its drawing.

Fields are the keys of a result, with their units; x runs along the shafts from the inner face of
the box, y and z across them from the axis of shaft 1, the input. Counting starts at 1.
"""

import math
from typing import Any

from gearopt.frozen import dataclass
from gearopt.physics.gears import ISO_53_A, Gear, Rack


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
    """A gear on its shaft; member: pinion or wheel.

    Fields with a default, of which lengths without a unit are in normal modules, say how its teeth
    are cut; a result leaves out those that hold it. hand: right or left, where it is given.
    """

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
    pressure_angle_deg: float = 20.0
    profile_shift: float = 0.0
    tip_alteration: float = 0.0
    thickness_allowance_mm: float = 0.0
    tool_addendum: float = ISO_53_A.dedendum
    tool_tip_radius: float = ISO_53_A.tip_radius
    tool_protuberance: float = ISO_53_A.protuberance
    addendum: float = ISO_53_A.addendum
    hand: str = ""

    @property
    def gear(self) -> Gear:
        """The gear with its teeth; its helix angle has no hand."""
        return Gear(
            self.normal_module_mm,
            self.teeth,
            self.reference_diameter_mm,
            self.to_mm - self.from_mm,
            math.radians(abs(self.helix_angle_deg)),
            Rack(
                math.radians(self.pressure_angle_deg),
                self.addendum,
                self.tool_addendum,
                self.tool_tip_radius,
                self.tool_protuberance,
            ),
            self.profile_shift,
            self.tip_alteration,
            self.thickness_allowance_mm,
        )


def gear_sizes(gear: Gear) -> dict[str, Any]:
    """Return the fields of a `GearDesign` that a gear has by itself, but for its teeth."""
    rack = gear.rack
    sizes = {
        "normal_module_mm": gear.normal_module,
        "reference_diameter_mm": gear.reference_diameter,
        "tip_diameter_mm": gear.tip_diameter,
        "root_diameter_mm": gear.root_diameter,
        "helix_angle_deg": math.degrees(gear.helix_angle),
        "pressure_angle_deg": math.degrees(rack.pressure_angle),
        "profile_shift": gear.profile_shift,
        "tip_alteration": gear.tip_alteration,
        "thickness_allowance_mm": gear.thickness_allowance,
        "tool_addendum": rack.dedendum,
        "tool_tip_radius": rack.tip_radius,
        "tool_protuberance": rack.protuberance,
        "addendum": rack.addendum,
    }
    return {key: float(value) for key, value in sizes.items()}


@dataclass(frozen=True, kw_only=True)
class BearingDesign:
    """A bearing on its shaft."""

    shaft: int
    diameter_mm: float
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class GapDesign:
    """Clear distance of two bodies that must keep apart, the least one, and that of their axes."""

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
