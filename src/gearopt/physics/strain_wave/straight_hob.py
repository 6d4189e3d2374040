"""Flanks of the flexspline that a straight-sided hob cuts, on a deformed or on a round blank.

In place of the circular spline a rack moves along the tangent of the major axis, one pitch for each
tooth of the blank that passes: the second way of Jun and Oh. On a round blank it cuts an involute.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, arc_angle, curvature, radii
from gearopt.physics.strain_wave.vectors import Vector, polar

SEARCH = np.radians(np.linspace(-30.0, 30.0, 241))  # polar angles at which heights are cut
NEWTON, ON_HEIGHT = 8, 1e-10  # steps from the nearest of them, and mm left where a height is cut


@dataclass(frozen=True)
class Cut:
    """A flank in the tooth's frame (height over the neutral curve, half thickness) as it is cut.

    edge: where on the hob, out from the blank's axis and across from the middle of the hob's space
    [mm]. Points that no place of the hob cuts are NaN.
    """

    tooth: Profile
    edge: Vector

    @property
    def regular(self) -> bool:
        """Whether all points are cut, and none is undercut."""
        return bool(np.isfinite(self.tooth.points.y).all() and (self.tooth.curvatures < 0.0).all())


def round_blank(gearing: StrainWave) -> NeutralCurve:
    """Return the neutral curve of a blank that is not deformed."""
    radius = gearing.neutral_radius
    return NeutralCurve(radius, "cosine", radius, 0.0, 0.0)


@np.errstate(invalid="ignore", divide="ignore")
def hobbed(
    gearing: StrainWave, curve: NeutralCurve, angle: float, offset: float, heights: Any
) -> Cut:
    """Return the flank that a straight edge cuts at heights (n,) [mm] over the neutral curve.

    angle a [rad] of the edge to the tooth's axis; offset d [mm]: its distance from the axis of the
    blank with a tooth on the major axis. An offset moves the flank along its normals.
    """
    _, points, _, radius, _ = _envelope(gearing, curve, angle, offset, SEARCH)
    known = np.where(np.isfinite(radius) & (radius > 0.0), points.x, np.inf)
    at = SEARCH[np.abs(known - np.asarray(heights)[:, None]).argmin(axis=1)]
    for _ in range(NEWTON):
        _, points, _, _, rate = _envelope(gearing, curve, angle, offset, at)
        at = at + np.clip((heights - points.x) / rate, -0.02, 0.02)
    edge, points, along, radius, _ = _envelope(gearing, curve, angle, offset, at)
    known = np.where(np.abs(points.x - heights) < ON_HEIGHT, 1.0, np.nan)
    return Cut(Profile(points * known, along, -1.0 / radius), edge)


def _envelope(
    gearing: StrainWave, curve: NeutralCurve, angle: float, offset: float, at: Any
) -> tuple[Vector, Vector, Vector, Any, Any]:
    """Envelope at polar angles p [rad]: place on the hob, point, tangent, radius, height's rate.

    With n = (sin a, cos a), place q and normal angle Psi of the tooth and the hob's travel v phi,
    v = m z_f/2, the edge has in the tooth's frame the normal angle theta = pi/2 - a - Psi and the
    support function s = d + n.(i v phi - q): its envelope is s n + s_theta i n with the radius
    s + s_theta_theta (convex above 0); dPsi/dphi = R_m kappa.
    """
    travel, size = gearing.blank_radius, curve.radius
    normal = Vector(math.sin(angle), math.cos(angle))
    rho, slope, _, _ = radii(curve, at)
    kappa, kappa_rate = curvature(curve, at)
    arc, arc_rate = arc_angle(curve, at), np.sqrt(rho * rho + slope * slope) / size
    turn = at - np.arctan2(slope, rho)
    place, outward = polar(rho, at), polar(size, turn)
    turned = size * kappa  # Psi by phi, which is -theta
    support = offset + normal.dot(Vector(0.0, travel * arc) - place)
    first = normal.dot(Vector(0.0, travel) - outward.left)
    second = normal.dot(outward) * turned - first * kappa_rate / (arc_rate * kappa)
    radius = support + second / turned**2
    here = normal.turned(-turn)
    point = here * support - here.left * (first / turned)
    edge = place + point.turned(turn) - Vector(0.0, travel * arc)
    along = -here.left
    return edge, point, along, radius, radius * turned * arc_rate * along.x


def reference_radius(gearing: StrainWave, angle: float, offset: float) -> float:
    """Return the distance [mm] of the hob's reference line from the blank's axis.

    On the reference line teeth and spaces of the hob are pi m/2 wide.
    """
    quarter = 0.25 * math.pi * float(gearing.module)
    return (offset - math.cos(angle) * quarter) / math.sin(angle)


def relieved(tooth: Profile, relief: float) -> Profile:
    """Return a flank with a relief [mm], normal to it, that grows as a parabola from root to tip.

    Heights stay; the half thickness y(x) loses C u^2, u from 0 at the root to 1 at the tip, and the
    curvature y''/(1 + y'^2)^(3/2) follows.
    """
    x, along = tooth.points.x, tooth.directions
    height = x[-1] - x[0]
    share = (x - x[0]) / height
    most = relief / along.left.y[-1]
    slope = along.y / along.x
    bend = tooth.curvatures * (1.0 + slope * slope) ** 1.5 - 2.0 * most / height**2
    slope = slope - 2.0 * most * share / height
    steep = np.sqrt(1.0 + slope * slope)
    points, along = Vector(x, tooth.points.y - most * share**2), Vector(1.0 / steep, slope / steep)
    return Profile(points, along, bend / steep**3)
