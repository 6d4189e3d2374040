"""Teeth of later practice, given by the flexspline's flank: double circular arc, half the locus.

Both touch over a wider part of the wave than a tooth conjugate to a 20 degree involute.
`swept_mesh` gives the circular spline that they need.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve
from gearopt.physics.strain_wave.tooth_motion import motion
from gearopt.physics.strain_wave.vectors import Vector, polar

POINTS = 801  # of a flank: chords are within 1 nm of it
# polar angle at which half the locus begins: R is 0.1 mm there, 0 at 0
FIRST_ANGLE = math.radians(6.0)
LAST_ANGLE = math.radians(89.0)  # and before which it ends
STEP = 1e-4  # rad, of differences along the locus: errors below 1e-7 of its curvature
STEEPEST = math.radians(85.0)  # slope of an arc at its end, against the axis of the tooth


def exact_locus(gearing: StrainWave, curve: NeutralCurve, angle: Any) -> tuple[Vector, Any]:
    """Return the path of a tooth, developed on the circular spline's pitch circle, and its turn.

    angle: the polar angle p [rad]. x = r_p arg P, y = |P| - (R_m + w_0) [mm]; turn Phi [rad].
    """
    at = motion(gearing, curve, angle)
    top = gearing.neutral_radius + gearing.radial_deflection
    return Vector(gearing.pitch_radius * at.place.angle, at.place.length - top), at.turn


def tooth_heights(gearing: StrainWave) -> tuple[float, float, float]:
    """Return heights [mm] of root, middle and tip of the flank over the neutral curve.

    The circular spline's tip is at c m + h/2 on the major axis, the flank's tip 2 h_a m above it;
    its root is half the clearance below it, so that the flank never ends in the space.
    """
    clearance, rim = float(gearing.clearance * gearing.module), 0.5 * float(gearing.rim)
    depth = float(gearing.addendum * gearing.module)
    end = rim + clearance
    return end - 0.5 * clearance, end + depth, end + 2.0 * depth


def half_locus_tooth(gearing: StrainWave, curve: NeutralCurve, thickness: float) -> Profile:
    """Return a tooth whose upper half is the locus of its own motion at half scale.

    thickness [mm] at half the height, from which a tangent goes down to the root. The locus is
    `exact_locus`; it ends where it has fallen by 2 h_a m. ValueError where it never does.
    Source: S. Ishikawa, US 4 823 638: flanks by the locus at half scale, the other gear's by its
    negative, touch at every pose of a rack. Teeth that turn would cut each other so, by O(m/z):
    here the circular spline follows from the flexspline (`swept_mesh`).
    """
    root, middle, tip = tooth_heights(gearing)
    angle = np.linspace(FIRST_ANGLE, LAST_ANGLE, 20 * POINTS)
    fall = -0.5 * exact_locus(gearing, curve, angle)[0].y
    fall -= fall[0]
    if fall[-1] < tip - middle:
        most = fall[-1] / float(gearing.module)
        raise ValueError(f"half the locus is {most:.4g} modules high: no addendum above it")
    heights = np.linspace(root, tip, POINTS)
    below = heights < middle
    at = np.interp(np.maximum(heights - middle, 0.0), fall, angle)
    path, before, after = (exact_locus(gearing, curve, at + s)[0] for s in (0.0, -STEP, STEP))
    start = exact_locus(gearing, curve, np.array([FIRST_ANGLE]))[0]
    first = (before - after) * (0.25 / STEP)
    second = (path * 2.0 - before - after) * (0.5 / STEP**2)
    along = Vector(first.y, first.x)
    bend = (first.y * second.x - first.x * second.y) / along.length**3
    unit = along * (1.0 / along.length)
    falls = 0.5 * (path.x - start.x)
    falls = np.where(below, (heights - middle) * -unit.y[0] / unit.x[0], falls)
    return Profile(Vector(heights, 0.5 * thickness - falls), unit, np.where(below, 0.0, bend))


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

    def least_radius(self, depth: float) -> float:
        """Return the least radius [mm] of an arc that reaches `depth` [mm] from the middle.

        Its slope at the end is STEEPEST at most.
        """
        rise = depth - self.straight * math.cos(self.slope)
        return max(0.0, rise) / (math.sin(STEEPEST) - math.sin(self.slope))

    def profile(self, low: float, high: float, count: int = POINTS) -> Profile:
        """Return the flank between two heights [mm], root and tip, evenly by height."""
        height = np.linspace(low, high, count)
        convex, concave = self.centres
        reach = self.straight * math.cos(self.slope)
        tip, root = height - self.middle.x > reach, height - self.middle.x < -reach
        falls = np.full(count, math.sin(self.slope))  # sine of the slope
        falls = np.where(tip, (height - convex.x) / self.radii[0], falls)
        falls = np.where(root, (concave.x - height) / self.radii[1], falls)
        level = np.sqrt(1.0 - falls**2)
        half = self.middle.y - (height - self.middle.x) * math.tan(self.slope)
        half = np.where(tip, convex.y + self.radii[0] * level, half)
        half = np.where(root, concave.y - self.radii[1] * level, half)
        bend = np.where(tip, -1.0 / self.radii[0], np.where(root, 1.0 / self.radii[1], 0.0))
        return Profile(Vector(height, half), Vector(level, -falls), bend)
