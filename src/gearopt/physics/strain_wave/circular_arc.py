"""Teeth of later practice: the half-scale locus, and the double circular arc with its conjugate.

Both touch over a wider part of the wave than a tooth conjugate to a 20 degree involute.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, angle_of_arc
from gearopt.physics.strain_wave.tooth_motion import Motion, motion
from gearopt.physics.strain_wave.vectors import Vector, polar


def rack_locus(module: Any, angle: Any) -> Vector:
    """Return the path of a tooth past a rack, (m/2)(2 phi - sin 2 phi), m cos 2 phi [mm].

    module m [mm]; angle phi [rad]; w = 1, infinitely many teeth. x runs across the tooth, y along.
    """
    double = 2.0 * angle
    return Vector(0.5 * module * (double - np.sin(double)), module * np.cos(double))


def half_locus_flanks(locus: Vector) -> tuple[Vector, Vector]:
    """Return the flanks of rigid and flexible teeth: the locus at half scale, and its negative.

    A tooth that stands at the point L of its path touches the flank L/2 with its point -L/2, for
    every L: all teeth on the used part of the path touch. Source: S. Ishikawa, US 4 823 638.
    """
    return locus * 0.5, locus * -0.5


def teeth_on_path(gearing: StrainWave, first: float, last: float) -> float:
    """Return the teeth per lobe and flank between two angles phi [rad] of the path."""
    return float((last - first) * gearing.teeth / (2.0 * math.pi))


def exact_locus(gearing: StrainWave, curve: NeutralCurve, angle: Any) -> tuple[Vector, Any]:
    """Return the path of a tooth, developed on the circular spline's pitch circle, and its turn.

    angle: the polar angle p [rad]. x = r_p arg P, y = |P| - (R_m + w_0) [mm]; turn Phi [rad].
    """
    at = motion(gearing, curve, angle)
    top = gearing.neutral_radius + gearing.radial_deflection
    return Vector(gearing.pitch_radius * at.place.angle, at.place.length - top), at.turn


def half_locus_gaps(
    gearing: StrainWave, curve: NeutralCurve, arcs: tuple[float, float], poses: Any
) -> tuple[Any, Any]:
    """Return the least and largest lateral gap [mm] of half-locus teeth that turn, per pose.

    arcs [rad]: the polar angles between which the path makes the flanks; poses (k,) [rad]. The
    tooth's turn, which a rack does not have, makes the flanks interfere by O(m/z). NaN where the
    flanks do not overlap in height.
    """
    path, _ = exact_locus(gearing, curve, np.linspace(*arcs, 400))
    rigid, flexible = half_locus_flanks(path)
    order = np.argsort(rigid.y)
    least, most = [], []
    places, turns = exact_locus(gearing, curve, np.asarray(poses))
    for k in range(len(places.x)):
        moved = places[k] + Vector(flexible.x, flexible.y).turned(-turns[k])
        inside = (moved.y > rigid.y.min()) & (moved.y < rigid.y.max())
        gap = np.interp(moved.y[inside], rigid.y[order], rigid.x[order]) - moved.x[inside]
        least.append(gap.min() if inside.any() else math.nan)
        most.append(gap.max() if inside.any() else math.nan)
    return np.array(least), np.array(most)


@dataclass(frozen=True)
class DoubleArc:
    """A flexspline's flank of a convex arc, a common tangent and a concave arc.

    radii rho_a, rho_f [mm] of the convex and the concave arc; slope [rad]: angle of the tangent to
    the tooth's axis; middle [mm]: height and half thickness of the tangent's middle; straight
    [mm]: half the tangent's length.
    """

    radii: tuple[float, float]
    slope: float
    middle: Vector
    straight: float

    @property
    def direction(self) -> Vector:
        """Unit vector along the tangent, towards the tip: half thickness falls."""
        return polar(1.0, -self.slope)

    @property
    def centres(self) -> tuple[Vector, Vector]:
        """Centres of the convex arc, inside the tooth, and of the concave one, outside [mm]."""
        along, normal = self.direction, self.direction.left
        convex = self.middle + along * self.straight - normal * self.radii[0]
        concave = self.middle - along * self.straight + normal * self.radii[1]
        return convex, concave

    def points(self, extent: tuple[float, float], count: int = 60) -> Vector:
        """Return the flank from root to tip; extent [rad]: angles of the arcs, convex first."""
        steps = np.linspace(0.0, 1.0, count)
        normal = self.direction.left
        convex, concave = self.centres
        tip = normal.turned(-extent[0] * steps) * self.radii[0]
        root = normal.turned(-extent[1] * steps[::-1]) * -self.radii[1]
        return Vector(
            np.concatenate([concave.x + root.x, convex.x + tip.x]),
            np.concatenate([concave.y + root.y, convex.y + tip.y]),
        )


def conjugate_of_arc(at: Motion, centre: Vector, radius: Any) -> Vector:
    """Return where a circular arc of the tooth touches its conjugate, in the space [mm].

    The normal through the instant centre passes the arc's centre. radius [mm]: positive where the
    point of the arc lies on the far side of its centre from the instant centre.
    """
    pole = at.of_tooth(at.centre)
    outward = centre - pole
    return at.placed(centre + outward * (radius / outward.length))


def conjugate_spline(
    gearing: StrainWave, curve: NeutralCurve, tooth: DoubleArc, arcs: Any
) -> tuple[Vector, Vector]:
    """Return the circular spline's flank that a double arc needs: of its convex and concave part.

    arcs phi [rad] (k,) of the poses, |phi| <= pi/2. Points that lie beyond an arc's end are no
    part of the flank: `DoubleArc.points` says which are.
    """
    at = motion(gearing, curve, angle_of_arc(curve, np.asarray(arcs)))
    convex, concave = tooth.centres
    first, second = tooth.radii
    return conjugate_of_arc(at, convex, first), conjugate_of_arc(at, concave, -second)
