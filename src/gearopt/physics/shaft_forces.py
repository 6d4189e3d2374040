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
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.tooth import helix_angle_at
from gearopt.physics.loads import torque_ratios

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


def hands(first: Sequence[str | None], drivers: Sequence[str] = ()) -> list[str]:
    """Return the hand of every pinion; None: right of the first, else that of the wheel beside it.

    Two gears of one hand on an intermediate shaft, of which one is driven and one drives, have
    opposite axial forces: so pinions follow in turn, but where the driver is another member than
    that of the stage before (drivers: as of `torque_ratios`).
    """
    every: list[str] = []
    for k, hand in enumerate(first):
        alike = not drivers or drivers[k] == drivers[k - 1]
        before = every[-1] if every else "left"
        every.append(hand or (OTHER[before] if alike or not every else before))
    return every


def train_forces(
    pairs: Sequence[GearPair],
    torque: float,
    pinion_hands: Sequence[str],
    drivers: Sequence[str] = (),
) -> list[GearForces]:
    """Return the forces on every gear of a train; torque of the input [N mm].

    drivers: as of `torque_ratios`. The axial force of a driving gear points along its angular
    velocity where its helix is right handed (the right-hand rule); its mate has the opposite force.
    """
    every = []
    ratios = torque_ratios([float(pair.ratio) for pair in pairs], drivers)
    for k, (pair, (at_pinion, _)) in enumerate(zip(pairs, ratios, strict=True)):
        forces = mesh_forces(pair, torque * at_pinion)
        turning = 1.0 if k % 2 == 0 else -1.0  # shafts turn in turn one way and the other
        load, radial = float(forces.tangential), float(forces.radial)
        for member, diameter in zip(MEMBERS, pair.working_diameters, strict=True):
            drives = member == (drivers[k] if drivers else "pinion")
            hand = pinion_hands[k] if member == "pinion" else OTHER[pinion_hands[k]]
            way = 1.0 if drives else -1.0  # the driven one turns and is handed the other way
            axial = turning * HANDS[hand if drives else OTHER[hand]] * float(forces.axial)
            shaft, radius = k + 1 if drives else k + 2, 0.5 * float(diameter)
            every.append(
                GearForces(k + 1, shaft, member, hand, radius, -way * load, radial, way * axial)
            )
    return every


def rotation(shaft: int) -> str:
    """Return how a shaft turns, seen from the input end."""
    return "clockwise" if shaft % 2 else "anticlockwise"


def rpm(speed: float) -> float:
    """Return a speed [rad/s] in revolutions a minute."""
    return speed * 30.0 / math.pi
