"""Teeth of any law in mesh: the flexspline's are given and sweep the circular spline's.

The space of the circular spline is bounded by what a tooth sweeps over the whole wave, so that
nothing interferes; where the boundary is the envelope of the tooth, the flanks are conjugate.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, angle_of_arc
from gearopt.physics.strain_wave.tooth_motion import Motion, motion
from gearopt.physics.strain_wave.vectors import Vector

RADII = 400  # of the space: 2 um apart, so that chords are within 1 nm of it
STEP_DEG = 0.05  # of the wave, at which the tooth is swept; a parabola refines the worst pose
FINE_DEG = 0.001  # of the wave, at the ends of contact
ON_SPACE = 1e-5  # mm: an envelope further inside than 0.01 um is cut away by other poses


@dataclass(frozen=True)
class Touching:
    """Poses of conjugate contact, in order: arcs phi [rad], heights [mm] on the tooth.

    radii [mm] and arms [mm] of the contact's normal about the circular spline's axis; curvatures
    [1/mm] of tooth and space as in `conjugate.Contact`; gap_curvature 1/R of Hertz's contact.
    """

    arcs: Any
    heights: Any
    radii: Any
    arms: Any
    curvatures: tuple[Any, Any]
    gap_curvature: Any


@dataclass(frozen=True, eq=False)  # a mesh is itself alone, and a key of caches
class SweptMesh:
    """A tooth and the space that it leaves of the circular spline.

    tooth: flank from root to tip in the tooth's frame (height over the neutral curve, half
    thickness) [mm]. radii r [mm] from the circular spline's tip to where the tooth reaches, halves
    [rad]: half the angle of the space there.
    """

    gearing: StrainWave
    curve: NeutralCurve
    tooth: Profile
    radii: Any
    halves: Any

    @property
    def spline_land(self) -> float:
        """Tip land of the circular spline's teeth [mm]."""
        left = math.pi / self.gearing.circular_teeth - self.halves[0]
        return float(2.0 * self.radii[0] * left)


def swept_mesh(gearing: StrainWave, curve: NeutralCurve, tooth: Profile) -> SweptMesh:
    """Return the space that a tooth leaves: at every radius the largest angle over all poses.

    The tooth's height must grow from root to tip. The largest angle of poses STEP_DEG apart is
    that of the parabola through it and its neighbours. Source: the circular spline as the envelope
    of the flexspline's tooth; the sweep needs no equation of meshing.
    """
    most = curve.radius + gearing.radial_deflection + float(tooth.points.x.max())
    radii = np.linspace(float(gearing.tip_radius), most, RADII + 1)[:-1]
    angles = np.radians(np.arange(-90.0 + STEP_DEG, 90.0, STEP_DEG))
    swept = tooth_angles(motion(gearing, curve, angles), tooth, radii)
    best = swept.argmax(axis=0)
    column = np.arange(RADII)
    before, at, after = (swept[np.clip(best + k, 0, len(angles) - 1), column] for k in (-1, 0, 1))
    with np.errstate(invalid="ignore"):
        bend = before - 2.0 * at + after
    known = np.isfinite(bend) & (bend < 0.0)
    safe = np.where(known, bend, -1.0)
    rise = np.where(known, np.where(known, after - before, 0.0) ** 2 / (-8.0 * safe), 0.0)
    return SweptMesh(gearing, curve, tooth, radii, at + rise)


def tooth_angles(at: Motion, tooth: Profile, radii: Any) -> Any:
    """Return the polar angle [rad] of the tooth's flank at radii (n,) [mm], per pose: (k, n).

    Minus infinity where the flank does not reach.
    """
    angles = np.full((len(at.place.x), len(radii)), -np.inf)
    for k in range(len(angles)):
        placed = at.place[k] + tooth.points.turned(at.turn[k])
        radius = placed.length
        if radius[-1] > radii[0]:
            of_pose = np.interp(radii, radius, placed.angle, left=-np.inf, right=-np.inf)
            angles[k] = of_pose
    return angles


def gaps(mesh: SweptMesh, angles: Any) -> Any:
    """Return the least clearance [mm] of a tooth at polar angles (k,) of its pose.

    Along the normal of the space, to first order, at the radii of the space and at the ends of the
    flank. Infinite where the tooth is outside.
    """
    at = motion(mesh.gearing, mesh.curve, np.atleast_1d(angles))
    across = mesh.radii * np.gradient(mesh.halves, mesh.radii, edge_order=2)
    lean = np.sqrt(1.0 + across * across)
    room = mesh.radii * (mesh.halves - tooth_angles(at, mesh.tooth, mesh.radii))
    least: Any = (room / lean).min(axis=1)
    for end in (0, -1):
        place = at.placed(mesh.tooth.points[end])
        radius = place.length
        half, leaning = (np.interp(radius, mesh.radii, v) for v in (mesh.halves, lean))
        inside = (radius >= mesh.radii[0]) & (radius <= mesh.radii[-1])
        gap = np.where(inside, radius * (half - place.angle) / leaning, np.inf)
        least = np.minimum(least, gap)
    return least


def tooth_gaps(mesh: SweptMesh, arcs: Any) -> Any:
    """Return the least clearances [mm] of teeth at angles phi [rad] of the flexspline."""
    return gaps(mesh, angle_of_arc(mesh.curve, np.asarray(arcs, float)))


def touching(mesh: SweptMesh) -> Touching:
    """Return where tooth and space are conjugate, over the whole wave.

    Poses are STEP_DEG apart, and FINE_DEG where the contact of a stretch begins and ends.
    """
    step = math.radians(STEP_DEG)
    coarse = np.arange(-0.5 * math.pi + step, 0.5 * math.pi, step)
    ends = angle_of_arc(mesh.curve, np.ravel(intervals(_conjugate(mesh, coarse))))
    around = np.arange(-step, step, math.radians(FINE_DEG))
    fine = (ends[:, None] + around).ravel()
    return _conjugate(mesh, np.unique(np.concatenate([coarse, fine])))


def _conjugate(mesh: SweptMesh, angles: Any) -> Touching:
    """Return contacts at polar angles [rad]: the tooth's normal passes the instant centre.

    At a pose these are the points z of the flank with (z - C).T = 0, found between its points. With
    v_f = C'.T/(1 + kappa_f (z - C).N) the speed of contact along the tooth, slide V.T and
    v_c = v_f + V.T, kappa_c - kappa_f = (Phi' - kappa_f V.T)/v_c. Those that other poses cut away
    from the space are left out.
    """
    at = motion(mesh.gearing, mesh.curve, angles)
    flank = mesh.tooth
    centre = at.of_tooth(at.centre)
    off = (flank.points.x - centre.x[:, None]) * flank.directions.x
    off = off + (flank.points.y - centre.y[:, None]) * flank.directions.y
    pose, point = np.nonzero(np.sign(off[:, 1:]) != np.sign(off[:, :-1]))
    share = off[pose, point] / (off[pose, point] - off[pose, point + 1])
    here, along, bent = _between(flank, point, share)
    moving = motion(mesh.gearing, mesh.curve, angles[pose])
    place, turned = moving.placed(here), along.turned(moving.turn)
    lever = (place - moving.centre).dot(turned.left)
    slow = moving.centre_rate.dot(turned) / (1.0 + bent * lever)
    slide = turned.dot((place - moving.centre).left) * moving.turn_rate
    gap = (moving.turn_rate - bent * slide) / (slow + slide)
    inside = mesh.radii[0] <= place.length
    half = np.interp(place.length, mesh.radii, mesh.halves)
    kept = inside & (place.length * (half - place.angle) < ON_SPACE) & (gap > 0.0)
    arm = np.abs(place.dot(turned))
    return Touching(
        moving.arc[kept],
        here.x[kept],
        place.length[kept],
        arm[kept],
        (bent[kept], (bent + gap)[kept]),
        gap[kept],
    )


def _between(flank: Profile, point: Any, share: Any) -> tuple[Vector, Vector, Any]:
    """Return point, unit tangent and curvature between a point of a flank and the next."""

    def mixed(values: Any) -> Any:
        return values[point] * (1.0 - share) + values[point + 1] * share

    along = Vector(mixed(flank.directions.x), mixed(flank.directions.y))
    here = Vector(mixed(flank.points.x), mixed(flank.points.y))
    return here, along * (1.0 / along.length), mixed(flank.curvatures)


def intervals(found: Touching) -> list[tuple[float, float]]:
    """Return the stretches of phi [rad] in which tooth and space touch, in order."""
    arcs = np.unique(found.arcs)
    if not len(arcs):
        return []
    breaks = np.flatnonzero(np.diff(arcs) > 2.5 * math.radians(STEP_DEG))
    first, last = np.r_[0, breaks + 1], np.r_[breaks, len(arcs) - 1]
    return [(float(arcs[a]), float(arcs[b])) for a, b in zip(first, last, strict=True)]


def mean_pairs(mesh: SweptMesh, stretches: list[tuple[float, float]]) -> float:
    """Return the mean pairs of conjugate teeth per lobe and flank, by their stretches of phi."""
    return sum(b - a for a, b in stretches) * float(mesh.gearing.teeth) / (2.0 * math.pi)
