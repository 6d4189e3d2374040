"""Clearance between tooth and space over the whole wave, exact for the involute."""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.conjugate import Flank, tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc
from gearopt.physics.strain_wave.tooth_motion import Pose, pose_of
from gearopt.physics.strain_wave.vectors import Vector, polar

CURVE_NODES = 7  # points of a flank through which a polynomial replaces it to 1e-6 um
SECANTS = 6  # each leaves a thousandth of an error, as poses are near each other
PARABOLAS = 3  # the same: clearances are off by less than 1e-9 mm
Look = Callable[[Any, Pose], tuple[Any, Any]]


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
    at = pose_of(gearing, flank.curve, angles)
    nearest: Any = math.inf
    for k in np.unique(np.rint(np.linspace(0, count - 1, points)).astype(int)):
        place = Vector(flex.x[..., k : k + 1], flex.y[..., k : k + 1])
        gap, radius = involute_gap(gearing, at.placed(place))
        nearest = np.minimum(nearest, np.where(radius >= gearing.tip_radius, gap, math.inf))
    return np.minimum(nearest, corner_clearance(flank, at))


def corner_clearance(flank: Flank, at: Pose) -> Any:
    """Return the distance [mm] of the circular spline's corner to the flank, along its normal.

    To first order in the distance; infinite beside the flank's ends.
    """
    gap, depth = corner_gap(flank, at)
    return np.where(depth >= 0.0, gap, math.inf)


def corner_gap(flank: Flank, at: Pose) -> tuple[Any, Any]:
    """Return the corner's distance to the flank [mm], and how far it is within the flank's ends."""
    nodes = curve_points(flank.contacts.point)
    seen = at.of_tooth(corner(flank.gearing))
    low, high = nodes[0].x, nodes[-1].x
    height, step = np.clip(seen.x, low, high), 1e-4 * (high - low)
    half, above, below = thickness_at(nodes, np.stack((height, height + step, height - step)))
    slope = (above - below) / (2 * step)
    gap = (seen.y - half) / np.sqrt(1.0 + slope * slope)
    return gap, np.minimum(seen.x - low, high - seen.x)


def poses(step_deg: float, reach_deg: float = 90.0) -> Any:
    """Return polar angles [rad] over the whole wave at least as fine as a step [degrees]."""
    count = 2 * math.ceil(reach_deg / step_deg - 1e-9) + 1
    return np.radians(np.linspace(-reach_deg, reach_deg, count))


@dataclass(frozen=True)
class Least:
    """A least clearance [mm] of one point over its poses, at a polar angle [rad] of the tooth.

    Negative: it cuts. point: its place on the flank from 0 (root) to 1 (tip); None: the circular
    spline's corner. passing: whether it is where the point passes the tip circle of the circular
    spline, or the corner an end of the flank, beyond which nothing can touch it.
    """

    gap: float
    angle: float
    point: float | None
    passing: bool

    @property
    def free(self) -> bool:
        """Whether nothing interferes, by more than rounding (1e-9 mm)."""
        return self.gap >= -1e-9


def interference(flank: Flank, step_deg: float = 0.05, points: int = 51) -> Least:
    """Return the least clearance of one gearing over the whole wave, the first of `least_gaps`.

    Infinite where the teeth do not reach each other.
    """
    return next(iter(least_gaps(flank, step_deg, points)), Least(math.inf, 0.0, None, False))


@lru_cache(maxsize=4)  # the parts of a description ask for the same
@np.errstate(invalid="ignore", divide="ignore")
def least_gaps(flank: Flank, step_deg: float = 0.05, points: int = 51) -> tuple[Least, ...]:
    """Return all least clearances over the wave from -90 to 90 degrees, the smallest first.

    They are bracketed by poses of a step [degrees] and then found exactly: where a point passes the
    tip circle by bisection, else by golden section, both to 1e-8 rad. points: how many of the
    flank's, evenly; between them a clearance is less by at most the square of their distance over
    8 R.
    """
    gearing, flex = flank.gearing, flank.contacts.point
    last = len(flex.x) - 1
    taken = np.unique(np.rint(np.linspace(0, last, points)).astype(int))

    def pose(angle: Any) -> Pose:
        return pose_of(gearing, flank.curve, angle)

    def of_point(k: Any, at: Pose) -> tuple[Any, Any]:
        gap, radius = involute_gap(gearing, at.placed(flex[k]))
        return gap, radius - gearing.tip_radius

    def of_corner(k: Any, at: Pose) -> tuple[Any, Any]:
        return corner_gap(flank, at)

    angles = poses(step_deg)
    at = pose(angles)
    of_points = _minima(of_point, pose, taken, angles, at)
    corners = _minima(of_corner, pose, np.array([-1]), angles, at)
    minima = [Least(gap, angle, float(k / last), passing) for k, gap, angle, passing in of_points]
    minima += [Least(gap, angle, None, passing) for _, gap, angle, passing in corners]
    return tuple(sorted(minima, key=lambda least: least.gap))


def interferes(flank: Flank, step_deg: float, points: int) -> bool:
    """Return whether teeth cut each other; arguments as of `least_gaps`.

    Where they do at a pose that is looked at, no least clearance is sought.
    """
    gearing, flex = flank.gearing, flank.contacts.point
    taken = np.unique(np.rint(np.linspace(0, len(flex.x) - 1, points)).astype(int))
    at = pose_of(gearing, flank.curve, poses(step_deg))
    with np.errstate(invalid="ignore"):
        gap, radius = involute_gap(gearing, at.placed(flex[taken[:, None]]))
        gaps, depth = corner_gap(flank, at)
    gap = np.where(radius >= gearing.tip_radius, gap, np.inf).min()
    nearest = min(float(gap), float(np.where(depth >= 0.0, gaps, np.inf).min()))
    return (
        not Least(nearest, 0.0, None, False).free or not interference(flank, step_deg, points).free
    )


def _minima(
    look: Look, pose: Callable[[Any], Pose], items: Any, angles: Any, at: Pose
) -> list[tuple[int, float, float, bool]]:
    """Least gaps of every item: item, gap, angle, whether at an end of the counted range.

    look(items, poses) -> gap, and how far it counts: where that is at least 0. at: the poses of
    the angles.
    """
    gaps, depth = (np.atleast_2d(v) for v in look(items[:, None], at))
    inside = depth >= 0.0
    counted = np.where(inside, gaps, np.inf)
    beside = np.pad(counted, ((0, 0), (1, 1)), constant_values=np.inf)
    row, k = np.nonzero(inside & (counted <= beside[:, :-2]) & (counted <= beside[:, 2:]))
    item, both = items[row], np.tile(row, 2)
    next_to = np.concatenate([np.maximum(k - 1, 0), np.minimum(k + 1, len(angles) - 1)])
    passing = ~inside[both, next_to]
    ends, at_ends = angles[next_to], gaps[both, next_to]
    out = np.flatnonzero(passing)
    if len(out):
        of = both[out]
        between = angles[np.tile(k, 2)[out]], ends[out]
        depths = depth[of, np.tile(k, 2)[out]], depth[of, next_to[out]]
        ends[out] = _angles_at_limit(look, pose, items[of], between, depths)
        at_ends[out] = look(items[of], pose(ends[out]))[0]
    sides = [np.split(v, 2) for v in (ends, at_ends)]
    three = [(angles[k], counted[row, k]), *zip(*sides, strict=True)]
    middle = _lowest(look, pose, item, three)
    poses_and_gaps = [middle, *three[1:]]
    best = np.stack([gap for _, gap in poses_and_gaps]).argmin(axis=0)
    angle, gap = (np.choose(best, [one[n] for one in poses_and_gaps]) for n in (0, 1))
    leaving = np.choose(best, [np.zeros(len(row), bool), *np.split(passing, 2)])
    rows = zip(item, gap, angle, leaving, strict=True)
    return [(int(k), float(g), float(a), bool(p)) for k, g, a, p in rows]


def _angles_at_limit(
    look: Look, pose: Callable[[Any], Pose], items: Any, ends: tuple[Any, Any], depths: Any
) -> Any:
    """Return the angles at which gaps cease to count, between two, by false position."""
    (low, high), (first, last) = ends, depths
    middle = low
    for _ in range(SECANTS):
        share = np.where(first - last > 0.0, first / (first - last), 0.5)
        middle = low + share * (high - low)
        depth = look(items, pose(middle))[1]
        counts = depth >= 0.0
        low, first = np.where(counts, middle, low), np.where(counts, depth, first)
        high, last = np.where(counts, high, middle), np.where(counts, last, depth)
    return middle


def _lowest(
    look: Look, pose: Callable[[Any], Pose], items: Any, three: Sequence[tuple[Any, Any]]
) -> tuple[Any, Any]:
    """Return the poses of the least gap about a pose of three, and that gap, by parabolas.

    three: middle, which has the least gap, low and high, with their gaps.
    """
    (middle, b), (low, a), (high, c) = three
    for _ in range(PARABOLAS):
        left, right = middle - low, high - middle
        up, down = (b - a) * right, (b - c) * left
        step = 0.5 * (down * left - up * right) / np.where(up + down < 0.0, up + down, -np.inf)
        new = np.clip(middle - step, low, high)
        gap = look(items, pose(new))[0]
        better = gap < b
        end, there = np.where(better, middle, new), np.where(better, b, gap)
        above = better == (new < middle)
        low, a = np.where(above, low, end), np.where(above, a, there)
        high, c = np.where(above, end, high), np.where(above, there, c)
        middle, b = np.where(better, new, middle), np.where(better, gap, b)
    return middle, b


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
    sorted_clearances = np.sort(tooth_clearances(flank, arcs))
    each = 2.0 * reach / (count - 1) * flank.gearing.teeth / (2.0 * math.pi)
    return np.searchsorted(sorted_clearances, gaps, side="right") * each
