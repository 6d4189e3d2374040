"""A tooth as a rectangle below a trapezoid, of Nakada and Utagawa, in a form without 0/0.

The cantilever has the width S_F up to the height C over its foundation, then falls linearly to S_K
at the height h of the tip. The load acts at the height S_C on its centre line.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear
from gearopt.physics.geometry.fillet import (
    NEGLIGIBLE,
    fillet_end,
    fillet_point,
    half_angle,
    undercut_depth,
)
from gearopt.physics.iso6336.tooth_form import tangent_theta, virtual_gear
from gearopt.physics.tooth.elastic import ElasticGear, LoadLine

TERMS = 25  # of the series below
SERIES = 0.15  # |eps| below which the series is taken: 0.15^25/27 is below rounding
CENTRE_SLOPE = 24.0 / np.pi  # of a half plane under the linear pressure of a moment


@dataclass(frozen=True)
class Trapezoid:
    """The cantilever that stands for a tooth; lengths [mm].

    base: radius of its foundation y_0; root_width S_F; tip_width S_K; height h of the tip and
    rectangle C, both over the foundation.
    """

    base: float
    root_width: float
    tip_width: float
    height: float
    rectangle: float

    def slope_part(self, load: Any) -> Any:
        """Return eps = (S_C - C)(1 - S_K/S_F)/(h - C): how much of S_F is lost at the load."""
        lost = 1.0 - self.tip_width / self.root_width
        return (load - self.rectangle) * lost / (self.height - self.rectangle)


def is_waisted(gear: Gear) -> bool:
    """Return whether undercut makes a tooth thinner at its root, as no trapezoid is; of floats."""
    return bool(undercut_depth(gear) > NEGLIGIBLE * gear.normal_module)


@lru_cache(maxsize=256)
def trapezoid(member: ElasticGear, convention: str) -> Trapezoid:
    """Return the cantilever of a gear by one of three conventions; the paper leaves it open.

    A: foundation at the 30-degree tangents to the fillet, whose chord is S_F; B: foundation on the
    root circle, S_F as A; C: foundation on the root circle, S_F the chord where fillet and involute
    meet. The rectangle reaches to where they meet. ValueError for an undercut tooth, which has a
    waist.
    """
    gear = member.gear
    if is_waisted(gear):
        raise ValueError(
            "an undercut tooth has a waist, which no trapezoid has: take a profile model"
        )
    tool_angle = 0.5 * np.pi - tangent_theta(virtual_gear(gear, "generating"))
    tangent, joint = fillet_point(gear, tool_angle), fillet_point(gear, fillet_end(gear))
    base = float(tangent.y) if convention == "A" else member.root_radius
    width = 2.0 * float(joint.x if convention == "C" else tangent.x)
    tip = 0.5 * float(gear.tip_diameter)
    half = float(half_angle(gear, tip))
    height = tip * np.cos(half) - base
    return Trapezoid(base, width, 2.0 * tip * np.sin(half), height, float(joint.y) - base)


def bending_series(eps: Any) -> Any:
    """Return g(eps) = (-2 eps - eps^2 - 2 ln(1 - eps))/eps^3 = 2 sum eps^k/(k + 3), eps < 1.

    g(0) = 2/3: a parallel-sided tooth; eps < 0: one that is wider at its tip. Good to 2e-14 from
    -5 to 0.9999; it grows without bound towards 1, a pointed tooth loaded at its apex.
    """
    eps = np.asarray(eps, float)
    small = np.abs(eps) < SERIES
    of = np.where(small, 1.0, eps)
    closed = (-2.0 * of - of**2 - 2.0 * np.log1p(-np.where(small, 0.0, eps))) / of**3
    return np.where(small, _power_sum(np.where(small, eps, 0.0), 2.0, 3), closed)


def shear_series(eps: Any) -> Any:
    """Return l(eps) = -ln(1 - eps)/eps = sum eps^k/(k + 1), eps < 1; l(0) = 1."""
    eps = np.asarray(eps, float)
    small = np.abs(eps) < SERIES
    closed = -np.log1p(-np.where(small, 0.0, eps)) / np.where(small, 1.0, eps)
    return np.where(small, _power_sum(np.where(small, eps, 0.0), 1.0, 1), closed)


def _power_sum(eps: Any, factor: float, first: int) -> Any:
    """Return factor sum_k eps^k/(k + first) by Horner's rule."""
    total = np.zeros_like(eps)
    for k in range(TERMS - 1, -1, -1):
        total = total * eps + factor / (k + first)
    return total


def bending_integral(shape: Trapezoid, load: Any) -> Any:
    """Return 12 int_0^{S_C} (S_C - x)^2/s(x)^3 dx, dimensionless; load S_C [mm] >= C.

    (12 C S_C (S_C - C) + 4 C^3 + 6 (S_C - C)^3 g(eps))/S_F^3. Source: the paper's eq. (7),
    corrected: its first bracket lacks the factor C, its second -2 ln Z - 3; with Q - C = infinity
    of a parallel-sided tooth replaced by g.
    """
    low, above = shape.rectangle, load - shape.rectangle
    plain = 12.0 * low * load * above + 4.0 * low**3
    return (plain + 6.0 * above**3 * bending_series(shape.slope_part(load))) / shape.root_width**3


def shear_integral(shape: Trapezoid, load: Any) -> Any:
    """Return int_0^{S_C} dx/s(x) = (C + (S_C - C) l(eps))/S_F, dimensionless; load S_C [mm]."""
    above = load - shape.rectangle
    return (shape.rectangle + above * shear_series(shape.slope_part(load))) / shape.root_width


def trapezoid_compliance(
    member: ElasticGear, line: LoadLine, convention: str, shear: float, factor: float
) -> Any:
    """Return bending and shear of a tooth as a trapezoid [mm/N].

    cos^2(aL)/(E b) {f 12 int (S_C - x)^2/s^3 dx + 2 kappa (1 + nu) int dx/s}; convention: of
    `trapezoid`; shear kappa; factor f of the bending.
    """
    shape = trapezoid(member, convention)
    load = line.crossing - shape.base
    twist = 2.0 * shear * (1.0 + member.poisson) * shear_integral(shape, load)
    bent = factor * bending_integral(shape, load)
    return np.cos(line.angle) ** 2 / member.rigidity * (bent + twist)


def nakada_compliance(member: ElasticGear, line: LoadLine, convention: str) -> Any:
    """Return bending, shear and rotation of the foundation by Nakada and Utagawa [mm/N].

    `trapezoid_compliance` with kappa = 1 and f = 1, and 24 S_C^2 cos^2(aL)/(pi E b S_F^2). The
    foundation only rotates, by the slope at the middle of its section, and the body below is a
    half plane: 2 to 3 times too stiff with the contact the paper takes. Source: the paper's
    eqs. (6) to (11), corrected.
    """
    shape = trapezoid(member, convention)
    load = line.crossing - shape.base
    turned = CENTRE_SLOPE * (load / shape.root_width) ** 2
    bent = trapezoid_compliance(member, line, convention, 1.0, 1.0)
    return bent + np.cos(line.angle) ** 2 / member.rigidity * turned
