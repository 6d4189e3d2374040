"""The pair of Yoon, Kim and Chung in mm, t, N; the oscillator of Kahraman and Singh as a pair."""

import math

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.timeline import timeline
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


def oscillator(ratio, load, shake=0.0, wave=None, frequency=0.1):
    """x'' + 2 zeta x' + k(t) f(x) = F_m + F_a W^2 cos W t with a gap of 2, as a pair of unit mass.

    x = 1 - delta: contact at x > 1, apart between -1 and 1.
    """
    rotor = Rotor(1.0, 1.0, 2.0, (1.0, 1.0), torque=load)
    mesh = constant(1.0) if wave is None else wave
    return MovingPair(
        rotor, rotor, 0.3, mesh, frequency, drag=2.0 * ratio, backlash=2.0, error=(shake,)
    )


def steady(pair, periods, state, points=100, kept=10):
    """RMS of delta about its mean over the last periods kept, its extremes and its last state."""
    phases = np.arange(kept * points + 1) / points + periods
    times = np.append(np.arange(0.0, periods, 5.0), phases) / pair.mesh_frequency
    longest = 1.0 / pair.mesh_frequency / 30.0
    made = march(pair, "fixed", timeline(pair, times, False), "rk8", longest, state)
    delta = made.delta[-kept * points :]
    return delta.std(), delta.min(), delta.max(), made.states[-1]
