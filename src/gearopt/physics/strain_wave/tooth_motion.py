"""How a tooth of the flexspline moves past the space of the circular spline that it engages.

The frame is that of the space: its axis of symmetry is the x axis.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, arc_angle, curvature, radii
from gearopt.physics.strain_wave.vectors import Vector, polar


@dataclass(frozen=True)
class Motion:
    """A pose of a tooth and its instant centre; rates are derivatives by the polar angle p.

    angle p, arc phi [rad]: where the tooth is on the wave, deformed and undeformed; place P [mm]
    of its foot on the neutral curve; turn Phi [rad] of its axis. centre C [mm]: the instant centre.
    A point (height, half thickness) of the tooth stands at P + the point turned by Phi.
    """

    angle: Any
    arc: Any
    place: Vector
    turn: Any
    turn_rate: Any
    centre: Vector
    centre_rate: Vector

    def placed(self, point: Vector) -> Vector:
        """Return where a point of the tooth stands in the space of the circular spline."""
        return self.place + point.turned(self.turn)

    def of_tooth(self, point: Vector) -> Vector:
        """Return a point of the space in the tooth's frame."""
        return (point - self.place).turned(-self.turn)


def motion(gearing: StrainWave, curve: NeutralCurve, angle: Any) -> Motion:
    """Return the pose of a tooth at the polar angle p [rad], |p| <= pi/2.

    P = e^(-i k phi) q and Phi = Psi - k phi, with q = rho e^(ip) and the normal angle
    Psi = p - arctan(rho'/rho). With kappa the curvature of the curve and E = q - e^(i Psi)/kappa
    from the axis to its centre of curvature, C = e^(-i k phi) E R_m kappa/(R_m kappa - k), as
    dq/dphi = i R_m e^(i Psi) and dPsi/dphi = R_m kappa: the instant centre lies on the ray through
    the centre of curvature (Aronhold and Kennedy).
    """
    k, radius = gearing.teeth_ratio, curve.radius
    rho, slope, _, _ = radii(curve, angle)
    kappa, kappa_rate = curvature(curve, angle)
    arc = arc_angle(curve, angle)
    arc_rate = np.sqrt(rho * rho + slope * slope) / radius
    normal = angle - np.arctan2(slope, rho)
    outward = polar(1.0, normal)
    evolute = polar(rho, angle) - outward * (1.0 / kappa)
    relative = radius * kappa - k
    lever = radius * kappa / relative
    lever_rate = -k * radius * kappa_rate / relative**2
    back = -k * arc
    centre = (evolute * lever).turned(back)
    moved = (outward * (kappa_rate / kappa**2 * lever) + evolute * lever_rate).turned(back)
    return Motion(
        angle,
        arc,
        polar(rho, angle + back),
        normal + back,
        relative * arc_rate,
        centre,
        moved - centre.left * (k * arc_rate),
    )
