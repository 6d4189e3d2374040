"""A planetary stage between a motor and a load: inertia, lost motion and stiffness.

In the frame of the carrier sun and ring turn by theta_s and theta_r, and delta = r_bs theta_s +
r_br theta_r (base radii, both above 0) is how far their lines of action press a planet together, or
by how much it is free within its backlash. All planets have one delta: they are springs in
parallel, and the play that is left is the least of theirs. Derived from the geometry of involutes;
tests hold it to springs, plays and particles in the plane. Lengths in mm.
"""

from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, GearPair, disc_inertia, disc_mass
from gearopt.physics.geometry.tooth import circumferential_backlash
from gearopt.physics.iso6336.stiffness import mesh_stiffness, single_stiffness
from gearopt.physics.mesh_loss import tooth_loss_factor
from gearopt.physics.planetary.willis import Flow, flow, simple_set


@dataclass(frozen=True)
class Gearset:
    """Sun, planet and ring (z < 0) at a centre distance [mm]; held: ring, carrier or sun."""

    sun: Gear
    planet: Gear
    ring: Gear
    distance: Any
    planets: int
    held: str

    def pairs(self, outwards: Any = 0.0) -> tuple[GearPair, GearPair]:
        """Sun and planet, planet and ring, with the planet's axis moved outwards [mm]."""
        a = self.distance + outwards
        return GearPair(self.sun, self.planet, a), GearPair(self.planet, self.ring, -a)

    def flow(self, friction: float = 0.0) -> Flow:
        """Speeds of members at a speed 1 of the motor, and torques; meshes lose friction mu H_V."""
        sun, planet, ring = (round(abs(float(g.teeth))) for g in (self.sun, self.planet, self.ring))
        lost = (friction and friction * float(tooth_loss_factor(p)) for p in self.pairs())
        outer, inner = (1 - Fraction(part) for part in lost)
        return flow(simple_set(self.held), [(sun, planet, planet, ring)], [(outer, inner)])

    @property
    def lever(self) -> Any:
        """Delta [mm] over the angle of the output, the motor being locked."""
        ring = -0.5 * self.ring.base_diameter
        return ring if self.held == "carrier" else ring + 0.5 * self.sun.base_diameter

    @property
    def pin_share(self) -> tuple[Any, Any]:
        """Delta per displacement of a pin along its circle, and along the force on it.

        cos(alpha_1) + cos(alpha_2) of both working angles; |u_1 + u_2| of unit vectors u along the
        lines of action.
        """
        first, second = (pair.working_angle for pair in self.pairs())
        return np.cos(first) + np.cos(second), np.sqrt(2.0 + 2.0 * np.cos(first + second))


def inertias(
    gears: Gearset, density: Any, bores: tuple[Any, Any] = (0.0, 0.0), carrier: Any = 0.0
) -> tuple[Any, dict[str, Any]]:
    """Mass of the gears [t], and inertias [t mm2] of all members at the motor: 2 E_kin/omega^2.

    Planets turn about their axes and go round with the carrier: N (J n_p^2 + m a^2 n_c^2), n in
    speeds of the motor. density [t/mm3]; bores of sun and planets [mm]; carrier: its inertia.
    """
    n = {name: float(speed) for name, speed in gears.flow().speeds.items()}
    discs = [(g, g.width, bore) for g, bore in zip((gears.sun, gears.planet), bores, strict=True)]
    sun, planet = (g.inertia(density) - disc_inertia(density, *hole) for g, *hole in discs)
    core, mass = (g.mass(density) - disc_mass(density, *hole) for g, *hole in discs)
    around = planet * n["planets"] ** 2 + mass * (gears.distance * n["carrier"]) ** 2
    return core + gears.planets * mass + gears.ring.mass(density), {
        "sun": sun * n["sun"] ** 2,
        "planets": gears.planets * around,
        "ring": gears.ring.inertia(density) * n["ring"] ** 2,
        "carrier": carrier * n["carrier"] ** 2,
    }


def planet_play(gears: Gearset, outwards: Any = 0.0) -> Any:
    """Delta [mm] within which a planet, moved outwards, is free: j_wt cos(alpha_wt), in sum."""
    pairs = gears.pairs(outwards)
    return sum(circumferential_backlash(p) * np.cos(p.working_angle) for p in pairs)


def lost_motion(gears: Gearset, play: Any, clearance: Any = 0.0, apart: Any = 0.0) -> Any:
    """Angle [rad] of the output between both flanks, the motor locked; below 0 planets bind.

    play: the least `planet_play`; clearance of the planets' bearings, on the diameter; apart: by
    how much places of two pins along their circle differ.
    """
    tangential, along = gears.pin_share
    return (play + clearance * along - apart * tangential) / gears.lever


def compliances(gears: Gearset, torque: Any | None = None, pin: Any = np.inf) -> tuple[Any, ...]:
    """Compliances [rad/(N mm)] at the output: meshes at the sun, meshes at the ring, pins.

    N planets of 1/(c_gamma_alpha b) in each mesh and |u_1 + u_2|^2/k_pin share the torque alike,
    over N lever^2. c_gamma_alpha of ISO 6336-1 for steel, along the line of action; torque [N mm]
    at the output, for F_t/b; None: of 100 N/mm and more. pin: stiffness [N/mm] with its bearing.
    """
    whole, line = gears.planets * gears.lever**2, np.inf
    if torque is not None:
        force = torque / (gears.planets * gears.lever)
        line = force * np.cos(gears.sun.transverse_pressure_angle) / gears.sun.face_width
    springs = []
    for pair in gears.pairs():
        mean, _ = mesh_stiffness(single_stiffness(pair, line), pair.transverse_contact_ratio)
        springs.append(1.0 / (mean * pair.face_width))
    return tuple(c / whole for c in (*springs, gears.pin_share[1] ** 2 / pin))
