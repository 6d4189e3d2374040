"""The pair of Yoon, Kim and Chung in mm, t, N, with what their print leaves open."""

import math

from gearopt.physics.motion.moving_pair import MovingPair, Rotor
from gearopt.physics.motion.stiffness_wave import constant

ANGLE = math.radians(20.0)


def paper_pair(
    kinematics="exact",
    k=2e5,
    kx=1e3,
    ky=None,
    torques=(2e5, 0.0),
    masses=(6e-4, 9e-4),
    wave=None,
    frequency=0.0,
    bearing=0.0,
    **more,
):
    """k [N/mm]: mesh, unless a wave is given; kx, ky [N/mm] and bearing [N s/mm]: bearings."""
    held, damped = (kx, kx if ky is None else ky), (bearing, bearing)
    pinion = Rotor(60.0, masses[0], 2.0, held, damped, torques[0])
    wheel = Rotor(80.0, masses[1], 4.0, held, damped, torques[1])
    mesh = constant(k) if wave is None else wave
    return MovingPair(pinion, wheel, ANGLE, mesh, frequency, kinematics=kinematics, **more)
