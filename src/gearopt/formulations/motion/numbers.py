"""Plain numbers of a moving pair, as its kernels take them."""

import math
from typing import NamedTuple

import numpy as np

from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS, stiffness_along
from gearopt.physics.motion.moving_pair import MovingPair

KINDS = ("exact", "tangent", "paper", "paper_linear")  # as `motion_kernel.contact` counts them
FORMS = {"way": 1, "angles": 2}  # coordinates of which delta is a difference


class Numbers(NamedTuple):
    """A pair at a level; `level`: how many coordinates; the rest as in `MovingPair`, units too."""

    level: int
    form: int
    kinematics: int
    m1: float
    m2: float
    mesh_mass: float
    load: float
    kx1: float
    ky1: float
    kx2: float
    ky2: float
    cx1: float
    cy1: float
    cx2: float
    cy2: float
    damping: float
    drag: float
    backlash: float
    sine: float
    cosine: float
    radii: float
    centres: float
    tangent: float
    r1: float
    r2: float
    i1: float
    i2: float
    torque1: float
    torque2: float
    omega: float
    cosines: Array
    sines: Array
    errors: Array


def numbers(pair: MovingPair, level: str) -> Numbers:
    """Return the numbers of a pair at a level of LEVELS."""
    p, w = pair.rotors
    k1, k2, c1, c2 = p.stiffness, w.stiffness, p.damping, w.damping
    if level == "line":
        (a, c), (b, d) = (stiffness_along(pair, r) for r in pair.rotors)
        k1, k2, c1, c2 = (a, a), (b, b), (c, c), (d, d)
    rest = pair.rest
    held = dict(zip(("kx1", "ky1", "kx2", "ky2"), map(float, (*k1, *k2)), strict=True))
    held |= dict(zip(("cx1", "cy1", "cx2", "cy2"), map(float, (*c1, *c2)), strict=True))
    return Numbers(
        level=LEVELS[level][0],
        form=FORMS.get(level, 0),
        kinematics=KINDS.index(pair.kinematics),
        m1=float(p.mass),
        m2=float(w.mass),
        mesh_mass=float(pair.mesh_mass),
        load=float(pair.load),
        **held,
        damping=float(pair.damping),
        drag=float(pair.drag),
        backlash=math.inf if pair.backlash is None else float(pair.backlash),
        sine=math.sin(pair.pressure_angle),
        cosine=math.cos(pair.pressure_angle),
        radii=float(rest.base_radii),
        centres=rest.centre_distance,
        tangent=rest.tangent_length,
        r1=float(p.base_radius),
        r2=float(w.base_radius),
        i1=float(p.inertia),
        i2=float(w.inertia),
        torque1=float(p.torque),
        torque2=float(w.torque),
        omega=2.0 * math.pi * pair.mesh_frequency,
        cosines=np.array(pair.wave.cosines, float),
        sines=np.array(pair.wave.sines, float),
        errors=np.array(pair.error, float),
    )


def deformation(pair: MovingPair, level: str, states: Array) -> Array:
    """Return delta [mm] of states (..., 2 n) of a level."""
    size = LEVELS[level][0]
    if level not in FORMS:
        return np.asarray(states[..., size // 2])
    u, v = states[..., 3] - states[..., 0], states[..., 4] - states[..., 1]
    g = pair.contact(u, v).approach
    if level == "way":
        return np.asarray(g - states[..., 2])
    turned = pair.pinion.base_radius * states[..., 2] + pair.wheel.base_radius * states[..., 5]
    return np.asarray(g - turned)
