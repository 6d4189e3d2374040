"""Stress of a strain wave gearing: contact, rim, and the torque at which its teeth ratchet."""

import math
from typing import Any

import numpy as np

from gearopt.physics.strain_wave.gearing import StrainWave


def contact_modulus(moduli: tuple[Any, Any], poissons: tuple[Any, Any]) -> Any:
    """Return E* [MPa], 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2.

    The E of (7) in the paper is 2 E*: its factor 2 pi and this pi give the same pressure.
    """
    flexibility = [(1.0 - nu**2) / e for e, nu in zip(moduli, poissons, strict=True)]
    return 1.0 / (flexibility[0] + flexibility[1])


def hertz_pressure(line_load: Any, modulus: Any, gap_curvature: Any) -> Any:
    """Return the line pressure p_0 = sqrt(q E* kappa/pi) [MPa] of Hertz.

    line_load q [N/mm] >= 0; modulus E* [MPa]; gap_curvature kappa = 1/R_f - 1/R_c [1/mm] >= 0, at
    which 0 is a flat contact. Source: (7) of the paper, which is Hertz's line contact.
    """
    return np.sqrt(line_load * modulus * gap_curvature / math.pi)


def equal_share(torque: Any, arm: Any, pairs: Any) -> Any:
    """Return the load P = M/(L N) [N] of each of N equally loaded pairs of one lobe.

    torque T of both lobes [N mm], M = T/2; arm L = r_b [mm], the same for every pair, as all
    normals of the involute touch its base circle. Source: (1) and (6) of the paper.
    """
    return 0.5 * torque / (arm * pairs)


def rim_stresses(
    gearing: StrainWave,
    curvatures: tuple[Any, Any],
    torque: Any,
    modulus: Any,
    notch: Any,
    wall: Any,
) -> tuple[Any, Any]:
    """Return the alternating bending and the shear stress of the flexspline [MPa].

    sigma_a = Y E (h/2)(kappa_0 - kappa_1)/2, half of what a fibre goes through in a turn of the
    wave, tau = Y T/(2 pi R_m^2 t). curvatures kappa_0, kappa_1 [1/mm] of the neutral curve on the
    major and minor axis; torque T [N mm]; modulus E [MPa]; notch Y >= 1: of teeth and fillets, a
    guess; wall t over h: thickness of the cup's wall. Source: thin rings and tubes.
    """
    radius, rim = gearing.neutral_radius, gearing.rim
    bending = notch * modulus * 0.25 * rim * (curvatures[0] - curvatures[1])
    shear = notch * torque / (2.0 * math.pi * radius**2 * wall * rim)
    return bending, shear


def rim_utilisation(stresses: tuple[Any, Any], strengths: tuple[Any, Any], safety: Any) -> Any:
    """Return S sqrt((sigma_a/sigma_F)^2 + (tau/tau_F)^2): at most 1 where the rim endures.

    strengths: fatigue limits sigma_F, tau_F [MPa] of bending and shear; safety S.
    """
    (bending, shear), (bent, sheared) = stresses, strengths
    return safety * np.sqrt((bending / bent) ** 2 + (shear / sheared) ** 2)


def ratcheting_torque(gearing: StrainWave, radial_stiffness: Any, flank_slope: Any) -> Any:
    """Return the torque [N mm] at which teeth slip by one: 2 r_b k (2 h_a m)/tan(flank angle).

    A model that is assumed, not published: the flexspline yields radially by the working depth.
    radial_stiffness k [N/mm]; flank_slope: tangent of the flank's angle to the tooth axis.
    """
    depth = 2.0 * gearing.addendum * gearing.module
    return 2.0 * gearing.base_radius * radial_stiffness * depth / flank_slope
