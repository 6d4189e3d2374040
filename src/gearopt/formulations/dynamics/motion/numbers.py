"""Plain numbers of a moving pair, as its kernels take them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS, stiffness_along
from gearopt.physics.motion.moving_pair import MovingPair

KINDS = ("exact", "tangent", "paper", "paper_linear")  # as `motion_kernel.contact` counts them
FORMS = {"way": 1, "angles": 2}  # coordinates of which delta is a difference


WHOLE = ("level", "form", "kinematics")
REAL = (
    *("m1", "m2", "mesh_mass", "load", "kx1", "ky1", "kx2", "ky2", "cx1", "cy1", "cx2", "cy2"),
    *("damping", "drag", "backlash", "sine", "cosine", "radii", "centres", "tangent"),
    *("r1", "r2", "i1", "i2", "torque1", "torque2", "omega"),
)
KIND = np.dtype([(name, np.int64) for name in WHOLE] + [(name, np.float64) for name in REAL])


class Numbers(NamedTuple):
    """A pair at a level, for kernels, with the units of `MovingPair`.

    pair (1,): a record of WHOLE and REAL, `level`: how many coordinates. waves (3, H): cosines and
    sines of the mesh stiffness [N/mm], and what the error's cosines add to delta'' [mm/s2].
    """

    pair: NDArray[np.void]
    waves: Array


def numbers(pair: MovingPair, level: str) -> Numbers:
    """Return the numbers of a pair at a level of LEVELS."""
    p, w = pair.rotors
    k1, k2, c1, c2 = p.stiffness, w.stiffness, p.damping, w.damping
    if level == "line":
        (a, c), (b, d) = (stiffness_along(pair, r) for r in pair.rotors)
        k1, k2, c1, c2 = (a, a), (b, b), (c, c), (d, d)
    rest, omega = pair.rest, 2.0 * math.pi * pair.mesh_frequency
    backlash = math.inf if pair.backlash is None else pair.backlash
    found = (
        *(LEVELS[level][0], FORMS.get(level, 0), KINDS.index(pair.kinematics)),
        *(p.mass, w.mass, pair.mesh_mass, pair.load, *k1, *k2, *c1, *c2),
        *(pair.damping, pair.drag, backlash),
        *(math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)),
        *(rest.base_radii, rest.centre_distance, rest.tangent_length),
        *(p.base_radius, w.base_radius, p.inertia, w.inertia, p.torque, w.torque, omega),
    )
    cosines, errors = pair.wave.cosines, pair.error
    waves = np.zeros((3, max(len(cosines), len(errors))))
    waves[0, : len(cosines)], waves[1, : len(cosines)] = cosines, pair.wave.sines
    waves[2, : len(errors)] = [-a * (h * omega) ** 2 for h, a in enumerate(errors, 1)]
    return Numbers(np.array([found], dtype=KIND), waves)


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
