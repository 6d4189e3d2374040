"""A pair of teeth in slices across its face: how far each gives way, and how they hold each other.

A slice is a spur pair of the virtual gears in the normal section, z_n = z/(cos(beta_b)^2
cos(beta)), whose compliance a level of the ladder gives; along the transverse line of action and
per face width it is that over cos(beta_b), as ISO 6336-1 has c' proportional to cos(beta). What a
slice gives way at its contact (Hertz) is its own. The rest, tooth and body, is a bed of springs on
which neighbouring slices hold each other as strips of a plate do: stiffness k u - (k lambda^2 u')',
lambda = `HOLD` times the height of the load over the root circle. Towards the side faces the bed of
helical teeth is softer (`END`). Under an even load a spur pair of many slices is that of one.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.geometry.contact import ContactPath
from gearopt.physics.geometry.tooth import base_helix_angle, virtual_teeth
from gearopt.physics.tooth.elastic import POISSON, STEEL, ElasticPair
from gearopt.physics.tooth.hertz import contact_compliance

# lambda over the height of the load. A cantilever plate of height h that keeps the shape of a beam
# under an end load, (3 x^2/h^2 - x^3/h^3)/2, has lambda^2 = 0.8 (1 - nu) h^2 from its twist: 0.75.
HOLD = 0.75
# Towards the side faces the structure of helical teeth is 1 + END tan(beta_b)^2 exp(-d/h) times as
# soft, d from the side, h height of the load: the axial part of the force, tan(beta_b), is held on
# one side alone. Measured, as the docs have it, on finite elements in space of two pairs.
END = 3.0


@dataclass(frozen=True)
class Sliced:
    """A pair of teeth whose slices touch anywhere on the path of contact.

    pair: as it is; path: its transverse one; normal: its virtual spur pair. compliance(s): of
    a pair of teeth by a level, at positions of the path of `normal` [mm/N]; force [N]: the
    transverse normal force of the law of the contact; coupling c_12 [mm/N] of all slices.
    """

    pair: GearPair
    path: ContactPath
    normal: ElasticPair
    compliance: Callable[[Any], Any]
    force: float
    coupling: float

    @property
    def cosine(self) -> float:
        """cos(beta_b)."""
        return float(np.cos(base_helix_angle(self.pair.pinion)))

    def in_normal_section(self, positions: Any) -> Any:
        """Return positions [mm] on the path of the virtual pair; ends of the paths go together."""
        if self.cosine == 1.0:
            return positions
        other = self.normal.path
        share = (np.asarray(positions) - self.path.start) / self.path.length
        return np.clip(other.start + share * other.length, other.start, other.end)

    def compliances(self, positions: Any) -> "Slices":
        """Compliances of slices at transverse positions s [mm] on the path."""
        at = self.in_normal_section(positions)
        wide = float(self.pair.face_width) / self.cosine
        lines = self.normal.load_lines(at)
        whole = self.compliance(at) * wide
        contact = contact_compliance(self.normal, at, lines, self.force) * wide
        structure = whole - contact - self.coupling * float(self.pair.face_width)
        heights = [
            line.height - member.root_radius
            for member, line in zip(self.normal.members, lines, strict=True)
        ]
        return Slices(contact, structure, 0.5 * (heights[0] + heights[1]))


@dataclass(frozen=True)
class Slices:
    """Compliances times face width [mm^2/N] at positions; heights [mm] of the loads.

    contact: of the flanks alone; structure: of teeth and bodies, without the coupling.
    """

    contact: Any
    structure: Any
    heights: Any

    def springs(self, width: float, slope: float) -> tuple[Any, Any]:
        """Return the bed (..., m) and the links (..., m - 1) of the slices of a face [N/mm].

        width [mm] of a slice; slope tan(beta_b).
        """
        count = np.shape(self.structure)[-1]
        away = width * (np.arange(count) + 0.5)
        ends = np.exp(-away / self.heights) + np.exp(-away[::-1] / self.heights)
        soft = self.structure * (1.0 + END * slope**2 * ends)
        held = (HOLD * self.heights) ** 2 / soft
        return width / soft, 0.5 * (held[..., 1:] + held[..., :-1]) / width


def normal_section(
    pair: GearPair,
    bores: tuple[float, float],
    moduli: tuple[float, float] = (STEEL, STEEL),
    poissons: tuple[float, float] = (POISSON, POISSON),
    plane: str = "strain",
) -> ElasticPair:
    """Return the elastic virtual spur pair of a helical one, a spur pair as it is.

    bores [mm] grow with the root circles; further arguments as of `ElasticPair`. sin(alpha_wn) =
    sin(alpha_wt) cos(beta_b). Source: ISO 21771:2007, virtual number of teeth.
    """
    if pair.pinion.helix_angle == 0.0:
        return ElasticPair(pair, bores, moduli, poissons, plane)
    first, second = (_virtual(gear) for gear in pair.gears)
    cosine = np.cos(base_helix_angle(pair.pinion))
    working = np.arcsin(np.sin(pair.working_angle) * cosine)
    plain = 0.5 * (first.reference_diameter + second.reference_diameter)
    distance = float(plain * np.cos(first.rack.pressure_angle) / np.cos(working))
    grown = [
        float(bore * virtual.root_diameter / gear.root_diameter)
        for bore, virtual, gear in zip(bores, (first, second), pair.gears, strict=True)
    ]
    virtual = GearPair(first, second, distance)
    return ElasticPair(virtual, (grown[0], grown[1]), moduli, poissons, plane)


def _virtual(gear: Gear) -> Gear:
    """Return the virtual spur gear of a helical one."""
    teeth = float(virtual_teeth(gear))
    diameter = float(gear.normal_module) * teeth
    return replace(gear, teeth=teeth, reference_diameter=diameter, helix_angle=0.0)
