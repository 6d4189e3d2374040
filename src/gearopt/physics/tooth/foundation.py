"""How the body below a tooth gives way: Sainsot, Cornell, and the ring in torsion."""

from typing import Any

import numpy as np

from gearopt.physics.tooth.elastic import ElasticGear, ElasticPair, LoadLine

# Coefficients of X = A/theta_f^2 + B h^2 + C h/theta_f + D/theta_f + E h + F, h = r_f/r_i.
# Source: Sainsot, Velex and Duverger, J. Mech. Des. 126 (2004), table 1; several public programs
# list the same.
SAINSOT = np.array(
    [
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],  # L
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],  # M
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],  # P
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],  # Q
    ]
)
SAINSOT_BORE_RATIOS = 1.4, 7.0  # h_fi over which the polynomials were fitted
SAINSOT_HALF_ANGLES = 0.01, 0.12  # theta_f [rad] of the same fit
LINEAR_PRESSURE = 16.67 / np.pi  # rotation of an elastic half plane under a moment (O'Donnell)


def _root_lever(member: ElasticGear, line: LoadLine) -> Any:
    """Return u/S_f: lever over the root circle, over the arc 2 r_f theta_f of the tooth's root."""
    width = 2.0 * member.root_radius * member.root_half_angle
    return (line.crossing - member.root_radius) / width


def sainsot_compliance(member: ElasticGear, line: LoadLine) -> Any:
    """Return the compliance of an elastic ring below the tooth, held at its bore [mm/N].

    f cos^2(aL)/(E b) {L (u/S_f)^2 + M u/S_f + P (1 + Q tan^2(aL))}. It contains the torsion of the
    ring: nothing may be added. Fitted for bore ratios 1.4 to 7 and theta_f from 0.01 to 0.12 rad;
    f: `ElasticGear.plane_factor` (the fit is of plane stress).
    Source: Sainsot, Velex and Duverger (2004), eq. (1), as several public programs have it.
    """
    theta, ratio = member.root_half_angle, member.bore_ratio
    powers = np.array([theta**-2, ratio**2, ratio / theta, 1.0 / theta, ratio, 1.0])
    square, linear, constant, axial = SAINSOT @ powers
    lever, across = _root_lever(member, line), np.cos(line.angle) ** 2
    inner = square * lever**2 + linear * lever + constant * (1.0 + axial * np.tan(line.angle) ** 2)
    return member.plane_factor * across / member.rigidity * inner


def cornell_compliance(member: ElasticGear, line: LoadLine) -> Any:
    """Return the compliance of an elastic half plane below the tooth [mm/N].

    cos^2(aL)/(E b) {f 16.67/pi (u/S_f)^2 + c u/S_f + f 1.534 (1 + tan^2(aL)/(2.4 (1 + nu)))};
    c = 2 (1 - nu) of plane stress, 2 (1 - nu - 2 nu^2) of plane strain. A half plane does not turn
    with a ring: add `torsion_compliance`. Source: Cornell, J. Mech. Des. 103 (1981), constants not
    checked against the paper; with torsion within 11 % of finite elements.
    """
    nu, factor = member.poisson, member.plane_factor
    linear = 2.0 * (1.0 - nu) if member.plane == "stress" else 2.0 * (1.0 - nu - 2.0 * nu**2)
    lever, tangent = _root_lever(member, line), np.tan(line.angle)
    axial = 1.534 * factor * (1.0 + tangent**2 / (2.4 * (1.0 + nu)))
    inner = LINEAR_PRESSURE * factor * lever**2 + linear * lever + axial
    return np.cos(line.angle) ** 2 / member.rigidity * inner


def torsion_compliance(member: ElasticGear) -> float:
    """Return how far a unit force on the line of action turns the ring [mm/N], there.

    u = r_b^2/(4 pi G b) (1/r_i^2 - 1/r_f^2): shear of a ring between bore and root circle, the
    bore held. Exact for a torque spread over the root circle.
    """
    inner, outer = 0.5 * member.bore, member.root_radius
    shear = 4.0 * np.pi * member.shear_modulus * float(member.gear.face_width)
    return float(member.base_radius**2 / shear * (inner**-2 - outer**-2))


def ring_torsion(elastic: ElasticPair) -> float:
    """Return the torsion of both rings [mm/N], which neighbouring pairs of teeth share.

    As a coupling c_12 it is a lower estimate: about half of what finite elements find.
    """
    return sum(torsion_compliance(member) for member in elastic.members)
