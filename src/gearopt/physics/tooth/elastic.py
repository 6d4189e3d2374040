"""The elastic pair: two spur gears with bores and materials, and where a force acts on a tooth."""

from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS, Gear, GearPair
from gearopt.physics.geometry.contact import ContactPath, usable_path
from gearopt.physics.geometry.fillet import fillet_point, half_angle
from gearopt.physics.geometry.tooth import tip_thickness

PLANES = ("stress", "strain")
STEEL, POISSON = 206000.0, 0.3  # MPa, -: of the gear steels that ISO 6336-1 has in mind
SLACK = 1e-9  # base pitches that a position may lie outside the path, for rounding


@dataclass(frozen=True)
class ElasticGear:
    """A spur gear that deforms, on a rigid shaft.

    bore d_i [mm] > 0, where the ring is held; modulus E [MPa], poisson nu; plane: "stress" (narrow
    gears, zero stress across the face) or "strain" (wide ones).
    """

    gear: Gear
    bore: float
    modulus: float = STEEL
    poisson: float = POISSON
    plane: str = "strain"

    @property
    def plane_factor(self) -> float:
        """1 of plane stress, 1 - nu^2 of plane strain: strain per stress, times E."""
        return 1.0 if self.plane == "stress" else 1.0 - self.poisson**2

    @property
    def lateral(self) -> float:
        """Poisson's ratio in the plane: nu of plane stress, nu/(1 - nu) of plane strain."""
        return self.poisson if self.plane == "stress" else self.poisson / (1.0 - self.poisson)

    @property
    def shear_modulus(self) -> float:
        """G = E/(2 (1 + nu)) [MPa]."""
        return self.modulus / (2.0 * (1.0 + self.poisson))

    @property
    def rigidity(self) -> float:
        """E b [N/mm], which compliances are counted in."""
        return self.modulus * float(self.gear.face_width)

    @property
    def base_radius(self) -> float:
        """Base radius r_b [mm]."""
        return 0.5 * float(self.gear.base_diameter)

    @property
    def root_radius(self) -> float:
        """Root radius r_f [mm]."""
        return 0.5 * float(self.gear.root_diameter)

    @property
    def root_half_angle(self) -> float:
        """theta_f [rad]: half the angle of the tooth where its fillet meets the root circle."""
        return float(fillet_point(self.gear, 0.5 * np.pi).half_angle)

    @property
    def bore_ratio(self) -> float:
        """h_fi = r_f/r_i of root circle and bore."""
        return 2.0 * self.root_radius / self.bore

    def load_line(self, curvature: Any) -> "LoadLine":
        """Return the load line at a radius of curvature rho [mm] of the flank; floats or arrays."""
        base = self.base_radius
        radius = np.hypot(base, curvature)
        half = half_angle(self.gear, radius)
        angle = np.arctan2(curvature, base) - half
        across = radius * np.sin(half) / np.cos(angle)
        return LoadLine(radius, angle, base / np.cos(angle), radius * np.cos(half), across)


@dataclass(frozen=True)
class LoadLine:
    """Where the force on a tooth acts; arrays of one shape, lengths [mm].

    radius R of the contact; angle alpha_L [rad] between force and normal of the tooth's centre
    line; crossing y_F = r_b/cos(alpha_L): where the force crosses the centre line, and height
    y = R cos(psi) of the contact, both from the gear's axis; depth h = R sin(psi)/cos(alpha_L) from
    the contact to the centre line, along the force.
    """

    radius: Any
    angle: Any
    crossing: Any
    height: Any
    depth: Any


@dataclass(frozen=True)
class ElasticPair:
    """A spur pair that deforms: a pair of floats, bores d_i1, d_i2 [mm], and its material.

    moduli E [MPa], poissons nu; plane "stress" or "strain" for both gears. ValueError for helical
    gears, a bore outside 0 to d_f, an unknown plane, and teeth whose flanks meet below the tip
    circle, which have no stiffness there.
    """

    pair: GearPair
    bores: tuple[float, float]
    moduli: tuple[float, float] = (STEEL, STEEL)
    poissons: tuple[float, float] = (POISSON, POISSON)
    plane: str = "strain"

    def __post_init__(self) -> None:
        if self.plane not in PLANES:
            raise ValueError(f"no plane {self.plane!r}; known: {', '.join(PLANES)}")
        for member, gear, bore in zip(MEMBERS, self.pair.gears, self.bores, strict=True):
            if gear.helix_angle != 0.0:
                raise ValueError(f"the {member} is helical: elastic teeth are those of spur gears")
            if not 0.0 < bore < gear.root_diameter:
                raise ValueError(
                    f"the bore of the {member}, {bore:g} mm, has to lie between 0 and its root "
                    f"diameter {float(gear.root_diameter):.4g} mm"
                )
            if not gear.tip_diameter > gear.base_diameter or not tip_thickness(gear) > 0.0:
                raise ValueError(
                    f"the teeth of the {member} are pointed: their flanks meet below the tip "
                    "circle; take a smaller profile shift or a shorter addendum"
                )

    @cached_property
    def members(self) -> tuple[ElasticGear, ElasticGear]:
        """Pinion and wheel as they deform."""
        rows = zip(self.pair.gears, self.bores, self.moduli, self.poissons, strict=True)
        pinion, wheel = (ElasticGear(*row, self.plane) for row in rows)
        return pinion, wheel

    @cached_property
    def path(self) -> ContactPath:
        """The path of contact as far as tips and form circles of both gears allow it."""
        return usable_path(self.pair)

    def load_lines(self, positions: Any) -> tuple[LoadLine, LoadLine]:
        """Return the load lines on pinion and wheel tooth in contact at positions s [mm].

        ValueError for a position outside the `path`.
        """
        slack = SLACK * self.path.base_pitch
        s = np.asarray(positions, float)
        if not ((s >= self.path.start - slack) & (s <= self.path.end + slack)).all():
            raise ValueError(
                f"a position outside the path of contact, {float(self.path.start):.6g} to "
                f"{float(self.path.end):.6g} mm: no teeth touch there"
            )
        pinion, wheel = self.members
        first, second = self.path.radii_of_curvature(s)
        return pinion.load_line(first), wheel.load_line(second)
