"""The path of contact: its points A to E, contact ratios, sliding, active diameters.

Positions s [mm] lie on the transverse line of action, 0 at the pitch point C, positive towards the
pinion's tip; the pinion drives, so contact runs from A to E. Radii of curvature of a ring are
negative, as its diameters are.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, GearPair, signed
from gearopt.physics.geometry.fillet import form_diameter


@dataclass(frozen=True)
class ContactPath:
    """Points on the line of action as positions s [mm] from the pitch point, transverse.

    start A, end E of contact; lowest B and highest D point of single tooth contact of the pinion,
    one base pitch p_bt from E and A; curvatures: distances T1 C and T2 C from the base circles'
    tangent points to the pitch point, r_b1 tan(alpha_wt) and r_b2 tan(alpha_wt).
    """

    start: Any
    end: Any
    base_pitch: Any
    curvatures: tuple[Any, Any]

    @property
    def lowest_single(self) -> Any:
        """Lowest point of single tooth contact B of the pinion (LPSTC) [mm]."""
        return self.end - self.base_pitch

    @property
    def highest_single(self) -> Any:
        """Highest point of single tooth contact D of the pinion (HPSTC) [mm]."""
        return self.start + self.base_pitch

    @property
    def length(self) -> Any:
        """Length of the path of contact g_alpha [mm]; negative where the gears never touch."""
        return self.end - self.start

    @property
    def transverse_ratio(self) -> Any:
        """Transverse contact ratio eps_alpha = g_alpha/p_bt."""
        return self.length / self.base_pitch

    def radii_of_curvature(self, position: Any) -> tuple[Any, Any]:
        """Transverse radii of curvature (T1 C + s, T2 C - s) of both flanks [mm]."""
        first, second = self.curvatures
        return first + position, second - position

    @property
    def root_curvatures(self) -> tuple[Any, Any]:
        """Radii of curvature [mm] at the root end of contact of each flank."""
        return self.radii_of_curvature(self.start)[0], self.radii_of_curvature(self.end)[1]


def curvature_at(gear: Gear, diameter: Any, inside: Any = None) -> Any:
    """Radius of curvature sqrt(d_y^2 - d_b^2)/2 [mm] of a flank at d_y [mm]; below 0 of a ring.

    inside: the least d_y^2 - d_b^2; None: NaN inside the base circle.
    """
    square = diameter**2 - gear.base_diameter**2
    square = square if inside is None else np.maximum(square, inside)
    return signed(0.5 * np.sqrt(square), gear.teeth)


@np.errstate(invalid="ignore")
def contact_path(pair: GearPair, form_diameters: tuple[Any, Any] | None = None) -> ContactPath:
    """Path of contact between the tip circles, or between form circles within them.

    form_diameters d_Ff of pinion and wheel [mm] (`fillet.form_diameter`): contact ends there where
    the mate's tip reaches deeper, as undercut and interference make it. Source: ISO 21771:2007,
    path of contact.
    """
    tangent = np.tan(pair.working_angle)
    first, second = (0.5 * gear.base_diameter * tangent for gear in pair.gears)
    reaches = [curvature_at(gear, gear.active_tip_diameter) for gear in pair.gears]
    start, end = second - reaches[1], reaches[0] - first
    if form_diameters is not None:
        rows = zip(form_diameters, pair.gears, strict=True)
        least = [curvature_at(gear, d, inside=0.0) for d, gear in rows]
        start, end = np.maximum(start, least[0] - first), np.minimum(end, second - least[1])
    return ContactPath(start, end, pair.base_pitch, (first, second))


def usable_path(pair: GearPair) -> ContactPath:
    """Return the path of contact as far as tips and form circles of both gears allow it."""
    return contact_path(pair, (form_diameter(pair.pinion), form_diameter(pair.wheel)))


@np.errstate(invalid="ignore")
def active_root_diameters(pair: GearPair) -> tuple[Any, Any]:
    """Start of active profile diameters d_Nf [mm] that the mate's tip circle gives.

    d_Nf1 = sqrt(d_b1^2 + (2 a sin(alpha_wt) - z2/|z2| sqrt(d_a2^2 - d_b2^2))^2); NaN where the
    mate's tip passes the tangent point of the base circle. Source: ISO 21771:2007.
    """
    diameters = []
    for at, gear in zip(contact_path(pair).root_curvatures, pair.gears, strict=True):
        diameter = np.hypot(gear.base_diameter, 2.0 * at)
        diameters.append(signed(diameter + 0.0 * np.sqrt(signed(at, gear.teeth)), gear.teeth))
    return diameters[0], diameters[1]


def diameters_at(pair: GearPair, path: ContactPath, position: Any) -> tuple[Any, Any]:
    """Return the diameters [mm] of pinion and wheel that touch at a position s [mm]."""
    first, second = path.radii_of_curvature(position)
    return (
        np.hypot(pair.pinion.base_diameter, 2.0 * first),
        signed(np.hypot(pair.wheel.base_diameter, 2.0 * second), pair.wheel.teeth),
    )


def specific_sliding(path: ContactPath, ratio: Any, position: Any) -> tuple[Any, Any]:
    """Specific sliding zeta_1 = 1 - rho_2/(u rho_1), zeta_2 = 1 - u rho_1/rho_2 (ISO 21771:2007).

    position s [mm]. Minus infinity where a flank's radius of curvature is 0.
    """
    first, second = path.radii_of_curvature(position)
    return 1.0 - second / (ratio * first), 1.0 - ratio * first / second


def root_sliding(path: ContactPath, pair: GearPair) -> tuple[Any, Any]:
    """Specific sliding of both flanks at their root ends of contact."""
    first, second = (specific_sliding(path, pair.ratio, s) for s in (path.start, path.end))
    return first[0], second[1]


@np.errstate(invalid="ignore", divide="ignore")
def largest_sliding(pair: GearPair) -> Any:
    """Largest specific sliding of both flanks, without its sign, at their root ends of contact.

    Inf where the mate's tip passes the end of an involute.
    """
    path = contact_path(pair)
    rows = zip(path.root_curvatures, pair.gears, strict=True)
    roots = [signed(at, gear.teeth) for at, gear in rows]
    return np.where(np.minimum(*roots) > 0.0, -np.minimum(*root_sliding(path, pair)), np.inf)[()]
