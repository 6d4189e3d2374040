"""Forces of a mesh, and loads of the shafts of a train by statics, without losses.

Axes are parallel; the input turns clockwise, seen from its end: its angular velocity points away
from that end, as positive axial forces do. Arguments of `mesh_forces` are floats, arrays of one
shape or casadi scalars; those of trains floats.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.tooth import helix_angle_at

HANDS = {"right": 1.0, "left": -1.0}  # sign of a helix
OTHER = {"right": "left", "left": "right"}


@dataclass(frozen=True)
class MeshForces:
    """Magnitudes [N] of the forces at the working pitch circles, the same on both gears."""

    tangential: Any
    radial: Any
    axial: Any


@dataclass(frozen=True)
class GearForces:
    """Forces [N] on one gear of a train: stage from 1, shaft from 1, member.

    tangential: positive where it drives its shaft on, negative where it holds it back; radial,
    towards its axis; axial, positive away from the input end. radius: working pitch radius [mm].
    """

    stage: int
    shaft: int
    member: str
    hand: str
    radius: float
    tangential: float
    radial: float
    axial: float


def mesh_forces(pair: GearPair, torque: Any) -> MeshForces:
    """Return the forces of a mesh: F_t = 2 T1/d_w1, F_t tan(alpha_wt), F_t tan(beta_w).

    torque T1 of the pinion [N mm]. Source: statics; Shigley, eq. (13-40), on working circles.
    """
    pinion, _ = pair.working_diameters
    load = 2.0 * torque / pinion
    helix = np.abs(helix_angle_at(pair.pinion, pinion))
    return MeshForces(load, load * np.tan(pair.working_angle), load * np.tan(helix))


def hands(first: Sequence[str | None]) -> list[str]:
    """Return the hand of every pinion; None: right of the first, else that of the wheel beside it.

    Two gears of one hand on an intermediate shaft, of which one is driven and one drives, have
    opposite axial forces.
    """
    every: list[str] = []
    for hand in first:
        every.append(hand or (OTHER[every[-1]] if every else "right"))
    return every


def train_forces(
    pairs: Sequence[GearPair], torque: float, pinion_hands: Sequence[str]
) -> list[GearForces]:
    """Return the forces on every gear of a train, pinions drive; torque of the input [N mm].

    The axial force of a driving gear points along its angular velocity where its helix is right
    handed (the right-hand rule); its mate has the opposite force.
    """
    every = []
    for k, pair in enumerate(pairs):
        forces = mesh_forces(pair, torque)
        turning = 1.0 if k % 2 == 0 else -1.0  # shafts turn in turn one way and the other
        axial = turning * HANDS[pinion_hands[k]] * float(forces.axial)
        radii = [0.5 * float(d) for d in pair.working_diameters]
        load, radial = float(forces.tangential), float(forces.radial)
        pinion_hand, wheel_hand = pinion_hands[k], OTHER[pinion_hands[k]]
        every.append(
            GearForces(k + 1, k + 1, "pinion", pinion_hand, radii[0], -load, radial, axial)
        )
        every.append(GearForces(k + 1, k + 2, "wheel", wheel_hand, radii[1], load, radial, -axial))
        torque *= float(pair.ratio)
    return every


def rotation(shaft: int) -> str:
    """Return how a shaft turns, seen from the input end."""
    return "clockwise" if shaft % 2 else "anticlockwise"


def rpm(speed: float) -> float:
    """Return a speed [rad/s] in revolutions a minute."""
    return speed * 30.0 / math.pi
