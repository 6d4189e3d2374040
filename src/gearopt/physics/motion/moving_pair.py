"""A spur pair on moving axes: its data, and the forces between teeth and on bearings."""

import math
from typing import Any, NamedTuple

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.motion.kinematics import KINEMATICS, Contact, Rest
from gearopt.physics.motion.stiffness_wave import Wave


@dataclass(frozen=True)
class Rotor:
    """A gear on its bearings: base radius r_b [mm], mass [t], inertia [t mm2].

    stiffness (k_x, k_y) [N/mm] and damping (c_x, c_y) [N s/mm] of the bearings, x along the line of
    centres. torque [N mm], positive counter-clockwise.
    """

    base_radius: float
    mass: float
    inertia: float
    stiffness: tuple[float, float]
    damping: tuple[float, float] = (0.0, 0.0)
    torque: float = 0.0


@dataclass(frozen=True)
class MovingPair:
    """Two rotors in mesh.

    pressure_angle at rest [rad]; wave: the mesh stiffness over a period; mesh_frequency [Hz].
    damping [N s/mm] of the mesh, in contact; drag c_0 [N s/mm], in contact and apart. backlash [mm]
    along the line of action: teeth part at delta > 0 and meet on the coast flank at delta >
    backlash; None: a spring that also pulls. kinematics: of `kinematics.KINEMATICS`. error
    (e_1, e_2, ...) [mm]: transmission error Re sum of e_h exp(2 pi i h f t), by which unloaded
    teeth are apart; its acceleration acts on delta.
    """

    pinion: Rotor
    wheel: Rotor
    pressure_angle: float
    wave: Wave
    mesh_frequency: float = 0.0
    damping: float = 0.0
    drag: float = 0.0
    backlash: float | None = None
    kinematics: str = "exact"
    error: tuple[complex, ...] = ()

    @property
    def rotors(self) -> tuple[Rotor, Rotor]:
        """Pinion and wheel."""
        return self.pinion, self.wheel

    @property
    def rest(self) -> Rest:
        """The geometry of the unloaded pair."""
        return Rest(self.pinion.base_radius + self.wheel.base_radius, self.pressure_angle)

    @property
    def mesh_mass(self) -> float:
        """m_e = 1/(r_b1^2/I_1 + r_b2^2/I_2) [t]: both inertias on the line of action."""
        return 1.0 / sum(r.base_radius**2 / r.inertia for r in self.rotors)

    @property
    def load(self) -> float:
        """Normal load F = m_e (r_b1 T_1/I_1 + r_b2 T_2/I_2) [N] of torques that do not balance too.

        With T_1/r_b1 = T_2/r_b2 it is T_1/r_b1 and the speed stays; else the gears speed up.
        """
        drive = sum(r.base_radius * r.torque / r.inertia for r in self.rotors)
        return self.mesh_mass * drive

    def error_at(self, phase: Any) -> Any:
        """Return the transmission error of unloaded teeth at phases of the mesh [mm]."""
        angle = 2.0 * math.pi * np.multiply.outer(phase, np.arange(1, len(self.error) + 1))
        real, imaginary = np.array(self.error, complex).real, np.array(self.error, complex).imag
        return np.cos(angle) @ real - np.sin(angle) @ imaginary

    def contact(self, u: Any, v: Any) -> Contact:
        """Return the contact at displacements of the axes against each other [mm]."""
        return KINEMATICS[self.kinematics](self.rest, u, v)


class MeshForce(NamedTuple):
    """Force N of the drive flank and N_c of the coast flank [N], at most 0 where they press."""

    drive: float
    coast: float


def mesh_force(
    pair: MovingPair,
    stiffness: Any,
    delta: Any,
    rate: Any,
    room: float,
    faster: Any = None,
) -> MeshForce:
    """Return N = k delta + c delta' in contact and 0 apart, with c_0 delta' of a drag always.

    stiffness k [N/mm]; deformation delta [mm] and its rate [mm/s]; room: the backlash with its
    growth [mm]; the coast flank's gap is room - delta and closes at the rate `faster` (None: that
    of delta). A pair without backlash never parts.
    """
    dragged = pair.drag * rate if pair.drag else 0.0
    if pair.backlash is None or delta < 0.0:
        return MeshForce(stiffness * delta + pair.damping * rate + dragged, 0.0)
    if delta > room:
        closing = rate if faster is None else faster
        return MeshForce(dragged, stiffness * (room - delta) - pair.damping * closing)
    return MeshForce(dragged, 0.0)


class Turns(NamedTuple):
    """Angles theta_1, theta_2 [rad]."""

    pinion: Any
    wheel: Any


def turns(pair: MovingPair, way: Any, rigid: Any) -> Turns:
    """Return both angles from s = r_b1 theta_1 + r_b2 theta_2 and q = I_1 theta_1/r_b1 - ....

    way s [mm]; rigid q = I_1 theta_1/r_b1 - I_2 theta_2/r_b2 [t mm], which obeys
    q'' = T_1/r_b1 - T_2/r_b2 whatever the mesh does: for constant torques a closed form.
    Also of rates.
    """
    (r1, i1), (r2, i2) = ((r.base_radius, r.inertia) for r in pair.rotors)
    first = (rigid + i2 * way / r2**2) / (i1 / r1 + i2 * r1 / r2**2)
    return Turns(first, (way - r1 * first) / r2)


def damping_of(ratio: float, stiffness: float, mass: float) -> float:
    """Return c = 2 zeta sqrt(k m) [N s/mm]; k [N/mm], m [t]."""
    return 2.0 * ratio * math.sqrt(stiffness * mass)
