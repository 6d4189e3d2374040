"""A planetary stage between a motor and a load: inertia, lost motion and stiffness.

In the frame of the carrier sun and ring turn by theta_s and theta_r against each other while
delta = r_bs theta_s + r_br theta_r (base radii, both above 0) is 0; else a planet is pressed
between both by delta, which its two meshes share, or delta is within their backlash. With a pin
displaced along the lines of action, delta is less by what both meshes see of it. All planets have
one delta, so that they are springs in parallel, and the play that is left is the least of theirs.
Derived from the geometry of involutes; tests hold it to springs in the plane and to places of
teeth. The source drives, the sink drives the load, the third member is held. Lengths in mm.
"""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, GearPair, disc_inertia, disc_mass
from gearopt.physics.geometry.tooth import circumferential_backlash
from gearopt.physics.iso6336.stiffness import mesh_stiffness, single_stiffness
from gearopt.physics.mesh_loss import mesh_efficiency, tooth_loss_factor
from gearopt.physics.planetary.kinematics import Balance, Mesh, balances, speeds

SOURCES = {"ring": "sun", "carrier": "sun", "sun": "ring"}  # of a reduction, by what is held
SINKS = {"ring": "carrier", "carrier": "ring", "sun": "carrier"}


@dataclass(frozen=True)
class Gearset:
    """Sun, planets and ring (z < 0) at a centre distance [mm]; held: ring, carrier or sun."""

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

    def meshes(self, efficiencies: tuple[Fraction, Fraction] = (Fraction(1),) * 2) -> list[Mesh]:
        """Both meshes, as the kinematics of trains take them."""
        sun, planet, ring = (round(float(g.teeth)) for g in (self.sun, self.planet, self.ring))
        return [
            Mesh("sun", "planet", "carrier", sun, planet, efficiencies[0]),
            Mesh("planet", "ring", "carrier", planet, ring, efficiencies[1]),
        ]

    def speeds(self) -> dict[str, Fraction]:
        """Speeds of all members at a speed 1 of the source."""
        given = {SOURCES[self.held]: Fraction(1), self.held: Fraction(0)}
        return speeds(self.meshes(), given)

    @property
    def lever(self) -> Any:
        """Delta [mm] over the angle of the sink, the source being locked."""
        ring = -0.5 * self.ring.base_diameter
        return ring if self.held == "carrier" else ring + 0.5 * self.sun.base_diameter

    @property
    def pin_share(self) -> tuple[Any, Any]:
        """Delta per tangential displacement of a pin, and per one along the force on it.

        cos(alpha_1) + cos(alpha_2), and |u_1 + u_2| = sqrt(2 + 2 cos(alpha_1 + alpha_2)) with unit
        vectors u of the lines of action; alpha: working angles of both meshes.
        """
        first, second = (pair.working_angle for pair in self.pairs())
        return np.cos(first) + np.cos(second), np.sqrt(2.0 + 2.0 * np.cos(first + second))


def balance(gears: Gearset, friction: float) -> Balance:
    """Torques and rolling power where the source drives, of meshes that lose mu H_V of theirs."""
    first, second = (
        Fraction(float(mesh_efficiency(tooth_loss_factor(pair), friction)))
        for pair in gears.pairs()
    )
    meshes, held = gears.meshes((first, second)), gears.held
    (flow,) = balances(meshes, gears.speeds(), SOURCES[held], SINKS[held], (held,))
    return flow


def inertias(
    gears: Gearset, density: Any, bores: tuple[Any, Any] = (0.0, 0.0), carrier: Any = 0.0
) -> dict[str, Any]:
    """Inertias [t mm2] of all members at the source: 2 E_kin/omega^2.

    Planets turn about their own axes and go round with the carrier: N (J n_p^2 + m a^2 n_c^2), n in
    speeds of the source. density [t/mm3]; bores of sun and planets [mm]; carrier: its inertia about
    its axis, pins and bearings included.
    """
    turns: Mapping[str, float] = {name: float(n) for name, n in gears.speeds().items()}
    discs = zip((gears.sun, gears.planet), bores, strict=True)
    sun, planet = (g.inertia(density) - disc_inertia(density, g.width, bore) for g, bore in discs)
    orbit = masses(gears, density, bores)["planets"] * gears.distance**2
    return {
        "sun": sun * turns["sun"] ** 2,
        "planets": gears.planets * planet * turns["planet"] ** 2 + orbit * turns["carrier"] ** 2,
        "ring": gears.ring.inertia(density) * turns["ring"] ** 2,
        "carrier": carrier * turns["carrier"] ** 2,
    }


def masses(gears: Gearset, density: Any, bores: tuple[Any, Any] = (0.0, 0.0)) -> dict[str, Any]:
    """Masses [t] of sun, all planets and ring; density [t/mm3]; bores of sun and planets [mm]."""
    discs = zip((gears.sun, gears.planet), bores, strict=True)
    sun, planet = (g.mass(density) - disc_mass(density, g.width, bore) for g, bore in discs)
    return {"sun": sun, "planets": gears.planets * planet, "ring": gears.ring.mass(density)}


def planet_play(gears: Gearset, outwards: Any = 0.0) -> Any:
    """Delta [mm] within which a planet is free: sum of j_wt cos(alpha_wt) of its meshes.

    Thickness allowances are those of the gears. Moved outwards a planet has more backlash at the
    sun, and less at the ring: of equal working angles the sum stays, to first order.
    """
    pairs = gears.pairs(outwards)
    return sum(circumferential_backlash(p) * np.cos(p.working_angle) for p in pairs)


def lost_motion(gears: Gearset, play: Any, clearance: Any = 0.0, position: Any = 0.0) -> Any:
    """Angle [rad] of the sink between both flanks, the source locked; below 0 planets bind.

    play: the least `planet_play`; clearance: of the planets' bearings, on the diameter, within
    which a pin goes to and fro along the forces; position: by how much tangential places of two
    pins differ, the first that drives one way being another than that of the other way.
    """
    tangential, along = gears.pin_share
    return (play + clearance * along - position * tangential) / gears.lever


def compliances(gears: Gearset, torque: Any | None = None, pin: Any = np.inf) -> tuple[Any, ...]:
    """Compliances [rad/(N mm)] at the sink: meshes at the sun, meshes at the ring, pins.

    N planets of 1/(c_gamma_alpha b) in both meshes and |u_1 + u_2|^2/k_pin in series share the
    torque alike: c = sum/(N lever^2). c' of ISO 6336-1 for steel; torque [N mm] at the sink, below
    whose 100 N/mm c' falls (unverified); None: none so low. pin: stiffness [N/mm] of a pin with its
    bearing, alike in all directions. c_gamma_alpha is taken along the line of action.
    """
    whole = gears.planets * gears.lever**2
    line = np.inf
    if torque is not None:
        normal = torque / (gears.planets * gears.lever)
        line = normal * np.cos(gears.sun.transverse_pressure_angle) / gears.sun.face_width
    springs = []
    for pair in gears.pairs():
        mean, _ = mesh_stiffness(single_stiffness(pair, line), pair.transverse_contact_ratio)
        springs.append(1.0 / (mean * pair.face_width))
    springs.append(gears.pin_share[1] ** 2 / pin)
    return tuple(c / whole for c in springs)
