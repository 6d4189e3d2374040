"""Deformation of a mesh whose axes move: the part of the axes' displacement.

delta = g(u, v) - s: u, v [mm] are the displacement of the wheel's axis against the pinion's, along
the line of centres at rest and across it; s = r_b1 theta_1 + r_b2 theta_2. The functions here give
g, its gradient and its second derivatives, and the growth of the backlash. u, v are floats, arrays
of one shape or casadi scalars.
"""

import math
from collections.abc import Callable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from gearopt.frozen import dataclass


@dataclass(frozen=True)
class Rest:
    """Unloaded pair: R, the sum of the base radii [mm], and its pressure angle alpha [rad]."""

    base_radii: float
    pressure_angle: float

    @cached_property
    def centre_distance(self) -> float:
        """C_0 = R/cos(alpha) [mm]."""
        return self.base_radii / math.cos(self.pressure_angle)

    @cached_property
    def tangent_length(self) -> float:
        """Z_0 = R tan(alpha) [mm]: the line of action between both base circles."""
        return self.base_radii * math.tan(self.pressure_angle)


class Contact(NamedTuple):
    """g [mm]; its gradient (g_u, g_v); its second derivatives (g_uu, g_uv, g_vv) [1/mm]."""

    approach: Any
    gradient: tuple[Any, Any]
    curvature: tuple[Any, Any, Any]


class Growth(NamedTuple):
    """Growth of the backlash along the line of action [mm], and its gradient."""

    length: Any
    gradient: tuple[Any, Any]


def exact(rest: Rest, u: Any, v: Any) -> Contact:
    """Return the contact of two involutes: g = (Z - Z_0) - R (alpha' - alpha) + R phi.

    cos(alpha') = R/C, phi = atan2(v, C_0 + u), tan(alpha' - alpha) = R (Z - Z_0)/(R^2 + Z Z_0).
    The gradient is the unit vector of the line of action. Derived from the unwound lengths of both
    flanks; a rotation of the whole pair leaves delta as it is.
    """
    x, longer, z = _tangent(rest, u, v)
    r, square = rest.base_radii, x * x + v * v
    turned = np.arctan(r * longer / (r * r + z * rest.tangent_length))
    sine, cosine = (z * x - r * v) / square, (r * x + z * v) / square
    g = longer - r * turned + r * np.arctan2(v, x)
    curvature = (cosine * cosine / z, -sine * cosine / z, sine * sine / z)
    return Contact(g, (sine, cosine), curvature)


def paper(rest: Rest, u: Any, v: Any) -> Contact:
    """Return the contact as Yoon, Kim and Chung have it: g = Z - Z_0, the longer tangent alone.

    The turn of the tangent points on the base circles is missing: the gradient has the length
    1/sin(alpha'), and a rotation eps of the whole pair changes delta by -R eps. To compare with.
    Source: their eqs. (1) to (3).
    """
    x, longer, z = _tangent(rest, u, v)
    a, b = x / z, v / z
    return Contact(longer, (a, b), ((1.0 - a * a) / z, -a * b / z, (1.0 - b * b) / z))


def tangent(rest: Rest, u: Any, v: Any) -> Contact:
    """Return the contact along the line of action at rest: g = u sin(alpha) + v cos(alpha).

    `exact` to first order; equal to it while the axes move along that line, as they do from rest on
    isotropic bearings.
    """
    sine, cosine = math.sin(rest.pressure_angle), math.cos(rest.pressure_angle)
    return Contact(sine * u + cosine * v, (sine, cosine), (0.0, 0.0, 0.0))


def paper_linear(rest: Rest, u: Any, v: Any) -> Contact:
    """Return `paper` to first order at rest: g = u/sin(alpha)."""
    slope = 1.0 / math.sin(rest.pressure_angle)
    return Contact(slope * u, (slope, 0.0), (0.0, 0.0, 0.0))


KINEMATICS: Mapping[str, Callable[[Rest, Any, Any], Contact]] = MappingProxyType(
    {"exact": exact, "tangent": tangent, "paper": paper, "paper_linear": paper_linear}
)


def growth(kind: str, rest: Rest, u: Any, v: Any) -> Growth:
    """Return how much the backlash grows as the axes move apart, along the line of action.

    kind: of KINEMATICS. `exact`: 2 R (inv(alpha') - inv(alpha)), the gaps of both flanks summed;
    `tangent`: 2 u sin(alpha); of the others twice their g.
    """
    if kind == "tangent":
        sine = math.sin(rest.pressure_angle)
        return Growth(2.0 * sine * u, (2.0 * sine, 0.0))
    if kind != "exact":
        contact = KINEMATICS[kind](rest, u, v)
        return Growth(
            2.0 * contact.approach, (2.0 * contact.gradient[0], 2.0 * contact.gradient[1])
        )
    x, longer, z = _tangent(rest, u, v)
    r, square = rest.base_radii, x * x + v * v
    turned = np.arctan(r * longer / (r * r + z * rest.tangent_length))
    return Growth(2.0 * (longer - r * turned), (2.0 * z * x / square, 2.0 * z * v / square))


def _tangent(rest: Rest, u: Any, v: Any) -> tuple[Any, Any, Any]:
    """Return C_0 + u, Z - Z_0 and Z, without the digits that a difference would lose."""
    z_0, c_0 = rest.tangent_length, rest.centre_distance
    change = 2.0 * c_0 * u + u * u + v * v
    z = np.sqrt(z_0 * z_0 + change)
    return c_0 + u, change / (z + z_0), z
