"""Clearance between tooth and space over the whole wave, exact for the involute."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.physics.strain_wave.conjugate import Flank, tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc
from gearopt.physics.strain_wave.tooth_motion import Motion, motion
from gearopt.physics.strain_wave.vectors import Vector, polar

CURVE_NODES = 7  # points of a flank through which a polynomial replaces it to 1e-6 um


@np.errstate(invalid="ignore")
def involute_gap(gearing: StrainWave, place: Vector) -> tuple[Any, Any]:
    """Return the signed distance [mm] of points to the circular spline's flank, and their radius.

    d = r_b (eta - (t - arctan t) - arg z), t = sqrt((|z|/r_b)^2 - 1); positive inside the space.
    Exact, as parallel curves of an involute are involutes of one base circle. NaN below it.
    """
    radius = place.length
    tangent = np.sqrt((radius / gearing.base_radius) ** 2 - 1.0)
    room = gearing.half_angle - (tangent - np.arctan(tangent)) - place.angle
    return gearing.base_radius * room, radius


def corner(gearing: StrainWave) -> Vector:
    """Return where the circular spline's flank ends at its tip circle [mm]."""
    tangent, _ = tangents(gearing)
    along = polar(1.0, gearing.half_angle - tangent)
    place: Vector = along * gearing.base_radius + along.left * (gearing.base_radius * tangent)
    return place


def thickness_at(points: tuple[Vector, ...], height: Any) -> Any:
    """Return the half thickness [mm] at a height: Lagrange's polynomial through points of a flank.

    points: of different heights, in order along the flank.
    """
    total: Any = 0.0
    for i, here in enumerate(points):
        weight: Any = 1.0
        for j, other in enumerate(points):
            if j != i:
                weight = weight * ((height - other.x) / (here.x - other.x))
        total = total + here.y * weight
    return total


def curve_points(points: Vector) -> tuple[Vector, ...]:
    """Return CURVE_NODES points of a flank (..., n), evenly taken, for `thickness_at`."""
    count = np.shape(points.x)[-1]
    at = np.rint(np.linspace(0, count - 1, CURVE_NODES)).astype(int)
    return tuple(Vector(points.x[..., k : k + 1], points.y[..., k : k + 1]) for k in at)


@np.errstate(invalid="ignore")
def clearances(flank: Flank, angles: Any, points: int = 51) -> Any:
    """Return the least clearance [mm] of a tooth at polar angles (..., k) of its pose: (..., k).

    The lesser of flank points that have passed the tip circle against the involute, and of the
    circular spline's corner against the flank. Infinite where the tooth is outside the space.
    points: how many of the flank's are taken. Numbers of the gearing as `conjugate.flank` has them.
    """
    gearing, flex = flank.gearing, flank.contacts.point
    count = flex.x.shape[-1]
    at = motion(gearing, flank.curve, angles)
    nearest: Any = math.inf
    for k in np.unique(np.rint(np.linspace(0, count - 1, points)).astype(int)):
        one = Vector(flex.x[..., k : k + 1], flex.y[..., k : k + 1])
        gap, radius = involute_gap(gearing, at.placed(one))
        nearest = np.minimum(nearest, np.where(radius >= gearing.tip_radius, gap, math.inf))
    return np.minimum(nearest, corner_clearance(flank, at))


def corner_clearance(flank: Flank, at: Motion) -> Any:
    """Return the distance [mm] of the circular spline's corner to the flank, along its normal.

    To first order in the distance; infinite beside the flank's ends.
    """
    nodes = curve_points(flank.contacts.point)
    seen = at.of_tooth(corner(flank.gearing))
    inside = (seen.x >= nodes[0].x) & (seen.x <= nodes[-1].x)
    height = np.where(inside, seen.x, nodes[0].x)
    step = 1e-4 * (nodes[-1].x - nodes[0].x)
    half = thickness_at(nodes, height)
    slope = (thickness_at(nodes, height + step) - thickness_at(nodes, height - step)) / (2 * step)
    return np.where(inside, (seen.y - half) / np.sqrt(1.0 + slope * slope), math.inf)


def poses(step_deg: float, reach_deg: float = 90.0) -> Any:
    """Return polar angles [rad] over the whole wave at least as fine as a step [degrees]."""
    count = 2 * math.ceil(reach_deg / step_deg - 1e-9) + 1
    return np.radians(np.linspace(-reach_deg, reach_deg, count))


@dataclass(frozen=True)
class Interference:
    """The least clearance [mm] over the whole wave, at a polar angle [rad]; negative: teeth cut."""

    least: float
    angle: float

    @property
    def free(self) -> bool:
        """Whether nothing interferes, by more than rounding (1e-9 mm)."""
        return self.least >= -1e-9


def interference(flank: Flank, step_deg: float = 0.05, points: int = 51) -> Interference:
    """Return the least clearance of one gearing over all poses from -90 to 90 degrees."""
    angles = poses(step_deg)
    found = clearances(flank, angles, points)
    k = int(np.argmin(found))
    return Interference(float(found[k]), float(angles[k]))


def tooth_arcs(flank: Flank, teeth: Any, shift: float = 0.0) -> Any:
    """Return the angles phi [rad] of teeth by their number from the middle of the arc of contact.

    shift: turn of the wave generator, in pitches of the flexspline.
    """
    arc = flank.contacts.motion.arc
    pitch = 2.0 * math.pi / flank.gearing.teeth
    return 0.5 * (arc[0] + arc[-1]) + (np.asarray(teeth) + shift) * pitch


def tooth_clearances(flank: Flank, arcs: Any) -> Any:
    """Return the least clearances [mm] of teeth at angles phi [rad] of the undeformed flexspline.

    |phi| <= pi/2.
    """
    return clearances(flank, angle_of_arc(flank.curve, np.asarray(arcs, float)))


def teeth_within(flank: Flank, gaps: Any, count: int = 8001) -> Any:
    """Return the mean number of teeth per lobe and flank whose clearance is at most `gaps` [mm].

    By `count` places of a tooth up to 45 degrees of the wave from the middle of the arc of contact.
    """
    reach = 0.25 * math.pi
    arcs = float(tooth_arcs(flank, 0)) + np.linspace(-reach, reach, count)
    found = np.sort(tooth_clearances(flank, arcs))
    each = 2.0 * reach / (count - 1) * flank.gearing.teeth / (2.0 * math.pi)
    return np.searchsorted(found, gaps, side="right") * each
