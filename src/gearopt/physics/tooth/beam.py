"""A tooth as a cantilever of its exact profile: bending, shear and compression up to the load."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.physics.geometry.fillet import profile
from gearopt.physics.tooth.elastic import ElasticGear, LoadLine

SHEAR = 1.2  # kappa of a rectangular section: the shear strain energy of its parabola of stresses
POINTS = 400  # of fillet and of flank each; the integrals are then good to 1e-5


@dataclass(frozen=True)
class Profile:
    """Integrals over a tooth's centre line from the root circle to heights y [mm]; w: its width.

    bending: of 1/w^3, y/w^3, y^2/w^3 (3, N); slender: of 1/w (N,).
    """

    heights: Any
    bending: Any
    slender: Any


@lru_cache(maxsize=64)
def tabulated(member: ElasticGear) -> Profile:
    """Return the integrals of one gear, by the trapezoidal rule; w need not fall outwards."""
    x, y = profile(member.gear, POINTS, POINTS)
    width = 2.0 * x
    rows = np.stack([np.ones_like(y), y, y * y])
    return Profile(y, _cumulative(rows / width**3, y), _cumulative(1.0 / width, y))


def _cumulative(rows: Any, y: Any) -> Any:
    """Return integrals over y from its first value, along the last axis."""
    steps = 0.5 * (rows[..., 1:] + rows[..., :-1]) * np.diff(y)
    return np.concatenate((np.zeros((*rows.shape[:-1], 1)), np.cumsum(steps, axis=-1)), axis=-1)


def profile_compliance(member: ElasticGear, line: LoadLine) -> Any:
    """Return bending, shear and compression of a tooth of its exact width w(y) [mm/N].

    cos^2(aL)/(E b) {12 f int (y_F - y)^2/w^3 dy + 2 kappa (1 + nu) int dy/w} + f sin^2(aL)/(E b)
    int dy/w, from the root circle to the contact; f: `ElasticGear.plane_factor`, kappa 1.2. As
    (y_F - y)^2 expands, each load takes four table look-ups. Holds for undercut teeth too, whose w
    has a waist. Source: the strain energy of a cantilever (Weber and Banaschek; Cornell).
    """
    table = tabulated(member)
    flat = [np.interp(line.height, table.heights, row) for row in (*table.bending, table.slender)]
    lever, factor = line.crossing, member.plane_factor
    across, along = np.cos(line.angle) ** 2, np.sin(line.angle) ** 2
    bending = 12.0 * factor * (lever**2 * flat[0] - 2.0 * lever * flat[1] + flat[2])
    shear = 2.0 * SHEAR * (1.0 + member.poisson) * flat[3]
    return (across * (bending + shear) + along * factor * flat[3]) / member.rigidity
