"""The cutter of a flank: its envelope as pitch circles roll, for racks and pinion-type cutters.

The tooth's axis is the x axis, the flexspline's centre the origin; the undeformed blank is cut.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.physics.strain_wave.vectors import Vector


@dataclass(frozen=True)
class Profile:
    """Points (n,) of a flank [mm] with unit tangents and curvatures [1/mm] along them."""

    points: Vector
    directions: Vector
    curvatures: Any


@dataclass(frozen=True)
class Envelope:
    """The mate of a profile. roll [rad]: turn of the blank at contact; speeds: the mate's by its.

    regular: the speed along the mate exists everywhere and keeps its sign, so it has no cusp.
    """

    profile: Profile
    roll: Any
    speeds: Any

    @property
    def regular(self) -> bool:
        """Whether the envelope can be a cutting edge."""
        return bool(np.isfinite(self.speeds).all() and (self.speeds > 0.0).all())


def blank_profile(flank: Flank) -> Profile:
    """Return a conjugate flank on the undeformed flexspline, seen from its centre."""
    at = flank.contacts
    points = Vector(flank.gearing.neutral_radius + at.point.x, at.point.y)
    return Profile(points, at.direction, at.curvatures[1])


@np.errstate(invalid="ignore")
def envelope(profile: Profile, pitch_radius: float, cutter_radius: float = math.inf) -> Envelope:
    """Return the mate of a profile in closed form; cutter_radius inf: a rack.

    The normal at z meets the pitch circle P_f at z + lambda n, at the polar angle theta: there
    |lambda| is the least of two. The mate is (z e^(-i theta) - A) e^(-i theta P_f/P_b), with
    A = P_f + P_b, of a rack z e^(-i theta) - P_f + i P_f theta: the cutter's centre (pitch line)
    is the origin, the blank on its negative x axis. Along arc length of the profile
    theta' = (1 - lambda kappa)/(P_f e_theta.T), the mate's speed is 1 - lambda theta'(1 + P_f/P_b)
    and its curvature (kappa - theta'(1 + P_f/P_b))/speed. NaN where the normal misses the circle.
    Source: (10) to (13) of the paper, corrected (`superposition`), without its roll steps.
    """
    z, along = profile.points, profile.directions
    normal = along.left
    half = z.dot(normal)
    root = np.sqrt(half * half - z.dot(z) + pitch_radius**2)
    lever = -half - np.copysign(1.0, -half) * root  # the root of smaller magnitude
    foot = z + normal * lever
    roll, spread = foot.angle, 1.0 + pitch_radius / cutter_radius
    turned = z.turned(-roll)
    if math.isinf(cutter_radius):
        points = Vector(turned.x - pitch_radius, turned.y + pitch_radius * roll)
    else:
        apart = Vector(turned.x - pitch_radius - cutter_radius, turned.y)
        points = apart.turned(-roll * pitch_radius / cutter_radius)
    rate = (1.0 - lever * profile.curvatures) / foot.left.dot(along)
    speeds = 1.0 - lever * rate * spread
    mate = Profile(
        points, along.turned(-roll * spread), (profile.curvatures - rate * spread) / speeds
    )
    return Envelope(mate, roll, speeds)


@np.errstate(invalid="ignore")
def generated(cutter: Profile, pitch_radius: float, cutter_radius: float = math.inf) -> Vector:
    """Profile that a cutter's points generate on a blank of a pitch radius [mm]: (13) backwards."""
    if math.isinf(cutter_radius):
        z, normal = cutter.points, cutter.directions.left
        roll = (z.y - z.x * normal.y / normal.x) / pitch_radius
        return Vector(z.x + pitch_radius, z.y - pitch_radius * roll).turned(roll)
    mirrored = Profile(-cutter.points, -cutter.directions, cutter.curvatures)
    return -envelope(mirrored, cutter_radius, pitch_radius).profile.points


def least_teeth(profile: Profile, pitch_radius: float, teeth: int, most: int = 60) -> int | None:
    """Return the smallest number of teeth Z_b of a regular cutter, from 6 on; None above `most`.

    P_b = P_f Z_b/Z_f, (10) of the paper. teeth: Z_f.
    """
    for count in range(6, most + 1):
        if envelope(profile, pitch_radius, pitch_radius * count / teeth).regular:
            return count
    return None


def superposition(
    profile: Profile, pitch_radii: tuple[float, float], rolls: Any, at: Any, printed: bool = False
) -> Any:
    """Return the edge (n,) [rad] of the paper's construction: the blank's flank at many rolls.

    pitch_radii P_f, P_b [mm]; rolls beta (k,) [rad] round the fixed cutter, alpha = beta P_b/P_f,
    (11). Points are turned by alpha + beta, (12), and moved by A e^(-i beta), A = P_f + P_b, (13)
    corrected; printed: across by A tan(beta), along by A. At each radius `at` (n,) [mm] from the
    cutter's centre the edge is where the flanks reach the least angle to the line of centres.
    """
    blank, cutter = pitch_radii
    apart = blank + cutter
    beta = np.asarray(rolls)[:, None]
    turned = profile.points.turned(-beta * (1.0 + cutter / blank))
    across = np.tan(beta) if printed else np.sin(beta)
    along = np.ones_like(beta) if printed else np.cos(beta)
    swept = Vector(along, -across) * apart - turned
    angles = np.full((len(beta), len(at)), np.nan)
    for k, (radius, angle) in enumerate(zip(swept.length, swept.angle, strict=True)):
        order = np.argsort(radius)
        angles[k] = np.interp(at, radius[order], angle[order], left=np.nan, right=np.nan)
    return np.nanmin(angles, axis=0)
