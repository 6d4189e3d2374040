"""Factors of contact stress and of its permissible value by ISO 6336-2 (pitting).

Floats, arrays or casadi scalars unless a docstring says otherwise; strengths [MPa].
"""

from typing import Any

import numpy as np

from gearopt.physics.choosing import choose
from gearopt.physics.gears import GearPair, is_internal
from gearopt.physics.geometry.tooth import base_helix_angle

# f_ZCa of 2019 by what is known of the profile modification [memory; a printed report has 1.2]
PROFILE_MODIFICATIONS = {"none": 1.2, "by experience": 1.07, "by analysis": 1.0}
LARGEST_HARDENING = 1.2  # of Z_W, static or not
SOFT_LIMIT, HARD_LIMIT = 850.0, 1200.0  # MPa, between which C_ZL and C_ZR change
STEEPEST, HARDEST = 130.0, 470.0  # HB between which Z_W falls


def zone_factor(pair: GearPair) -> Any:
    """Return Z_H = sqrt(2 cos(beta_b) cos(alpha_wt)/(cos(alpha_t)^2 sin(alpha_wt))). Part 2, 6."""
    working, angle = pair.working_angle, pair.pinion.transverse_pressure_angle
    helix = base_helix_angle(pair.pinion)
    return np.sqrt(2.0 * np.cos(helix) * np.cos(working) / np.sin(working)) / np.cos(angle)


def elasticity_factor(moduli: tuple[Any, Any], poissons: tuple[Any, Any]) -> Any:
    """Return Z_E = (pi ((1 - nu1^2)/E1 + (1 - nu2^2)/E2))^(-1/2) [sqrt(MPa)]. Part 2, 7."""
    rows = zip(moduli, poissons, strict=True)
    return sum(np.pi * (1.0 - nu**2) / e for e, nu in rows) ** -0.5


def contact_ratio_factor(transverse: Any, overlap: Any) -> Any:
    """Return Z_eps = sqrt((4 - eps_alpha)/3 (1 - eps_beta) + eps_beta/eps_alpha). Part 2, 8.

    eps_beta counts up to 1: above it is sqrt(1/eps_alpha), for spur gears sqrt((4 - eps_alpha)/3).
    """
    share = np.minimum(overlap, 1.0)
    return np.sqrt((4.0 - transverse) / 3.0 * (1.0 - share) + share / transverse)


def helix_factor(helix: Any) -> Any:
    """Return Z_beta = 1/sqrt(cos(beta)). ISO 6336-2:2006/Cor.1:2008 and 2019, 9.

    The first print of 2006 has sqrt(cos(beta)), as DIN 3990 has.
    """
    return 1.0 / np.sqrt(np.cos(helix))


@np.errstate(invalid="ignore", divide="ignore")
def single_contact_ratios(pair: GearPair, transverse: Any) -> tuple[Any, Any]:
    """Return M1 and M2: contact stress at B of the pinion, D of the wheel, over that at C.

    tan(alpha_wt)/sqrt((t1 - 2 pi/z1) (t2 - (eps_alpha - 1) 2 pi/z2)), t = sqrt((d_a/d_b)^2 - 1),
    and the same seen from the wheel, 1 of a ring. NaN where the point lies at or below a base
    circle. Part 2, 6.
    """
    tips = [np.sqrt((g.active_tip_diameter / g.base_diameter) ** 2 - 1.0) for g in pair.gears]
    steps = [2.0 * np.pi / g.teeth for g in pair.gears]
    found = []
    for own, other in ((0, 1), (1, 0)):
        first = tips[own] - steps[own]
        second = tips[other] - (transverse - 1.0) * steps[other]
        inside = choose(np.minimum(first, second) > 0.0, first * second, np.nan)
        found.append(np.tan(pair.working_angle) / np.sqrt(inside))
    if is_internal(pair.wheel_teeth):
        found[1] = choose(np.less(pair.wheel_teeth, 0.0), 1.0 + 0.0 * found[0], found[1])
    return found[0], found[1]


def single_contact_factor(ratio: Any, overlap: Any, helical: Any = 1.0) -> Any:
    """Return Z_B or Z_D of M (`ratio`): the larger of 1 and M for spur gears, 1 for eps_beta >= 1.

    Between, straight in eps_beta. helical: what is taken for eps_beta >= 1, sqrt(f_ZCa) in 2019.
    Source: ISO 6336-2:2006, 6.
    """
    spur, share = np.maximum(ratio, 1.0), np.minimum(overlap, 1.0)
    mixed = spur + share * (helical - spur)
    return choose(overlap >= 1.0, helical, mixed)


def contact_stress(load: Any, diameter: Any, width: Any, ratio: Any, product: Any) -> Any:
    """Return sigma_H0 = Z sqrt(F_t (u + 1)/(d1 b u)) [MPa]; product Z = Z_H Z_E Z_eps Z_beta.

    load F_t [N] at the reference diameter d1, face width b [mm]. Part 2, 5.
    """
    return product * np.sqrt(load * (ratio + 1.0) / (diameter * width * ratio))


def lubricant_factor(limit: Any, viscosity: Any) -> Any:
    """Return Z_L = C + 4 (1 - C)/(1.2 + 134/nu_40)^2, C_ZL of the softer gear's sigma_Hlim.

    C_ZL 0.83 to 850 MPa, sigma_Hlim/4375 + 0.6357, 0.91 from 1200 MPa; viscosity nu_40 [mm2/s].
    Part 2, 12; gfsReboucas/Drivetrain has it.
    """
    c = _lubrication(limit)
    return c + 4.0 * (1.0 - c) / (1.2 + 134.0 / viscosity) ** 2


def velocity_factor(limit: Any, speed: Any) -> Any:
    """Return Z_v = C + 2 (1 - C)/sqrt(0.8 + 32/v), C = C_ZL + 0.02; speed [mm/s]. Part 2, 12."""
    c = _lubrication(limit) + 0.02
    return c + 2.0 * (1.0 - c) / np.sqrt(0.8 + 32000.0 / speed)


def counted_limit(limit: float) -> float:
    """Return sigma_Hlim [MPa] as far as it counts for Z_L, Z_v and Z_R."""
    return min(max(limit, SOFT_LIMIT), HARD_LIMIT)


def _lubrication(limit: Any) -> Any:
    rise = np.clip((limit - SOFT_LIMIT) / (HARD_LIMIT - SOFT_LIMIT), 0.0, 1.0)
    return 0.83 + 0.08 * rise  # sigma_Hlim/4375 + 0.6357


def reduced_curvature(pair: GearPair) -> Any:
    """Return rho_red [mm] at the pitch point, of rho = d_b tan(alpha_wt)/2, transverse."""
    first, second = (0.5 * g.base_diameter * np.tan(pair.working_angle) for g in pair.gears)
    return first * second / (first + second)


def roughness_factor(limit: Any, roughness: Any, curvature: Any) -> Any:
    """Return Z_R = (3 um/R_z10)^C, R_z10 = R_z (10 mm/rho_red)^(1/3).

    C_ZR 0.15 to 850 MPa, 0.32 - 0.0002 sigma_Hlim, 0.08 from 1200 MPa; roughness R_z, the mean of
    both gears [mm]; curvature rho_red [mm]. Part 2, 12; gfsReboucas/Drivetrain has it.
    """
    rise = np.clip((limit - SOFT_LIMIT) / (HARD_LIMIT - SOFT_LIMIT), 0.0, 1.0)
    at_ten = roughness * (10.0 / curvature) ** (1.0 / 3.0)
    return (3e-3 / at_ten) ** (0.15 - 0.07 * rise)


def equivalent_roughness(hard: Any, soft: Any, curvature: Any, speed: Any, viscosity: Any) -> Any:
    """Return R_zH [mm] of a hard pinion against a soft wheel, 3 to 16 um.

    R_z1 (10/rho_red)^0.33 (1500/(v nu_40))^0.33 (R_z1/R_z2)^0.66: a film hides roughness.
    roughness hard, soft [mm]; speed [mm/s], viscosity [mm2/s]. Part 2, 13; IACS UR M56, 2.11.
    """
    film = (1500.0 / (1e-3 * speed * viscosity)) ** 0.33
    found = hard * (10.0 / curvature) ** 0.33 * film * (hard / soft) ** 0.66
    return np.clip(found, 3e-3, 16e-3)


def work_hardening_factor(brinell: Any, roughness: Any) -> Any:
    """Return Z_W = (1.2 - (HB - 130)/1700) (3 um/R_zH)^0.15 of a soft gear against a hard one.

    HB from 130 to 470, beyond which the ends count; roughness R_zH [mm]. Part 2, 13; IACS UR M56,
    2.11, has it, but takes at least 1.
    """
    counted = np.clip(brinell, STEEPEST, HARDEST)
    return (1.2 - (counted - 130.0) / 1700.0) * (3e-3 / roughness) ** 0.15


def tempered_hardening_factor(pinion: Any, wheel: Any, ratio: Any) -> Any:
    """Return Z_W = 1 + A (u - 1) of a through-hardened wheel against a harder pinion.

    A = 0.00898 HB1/HB2 - 0.00829 for HB1/HB2 from 1.2 to 1.7, beyond which it is 0 and 0.00698; u
    counts up to 20. Part 2, 13; IACS UR M56, 2.11; C_H of AGMA 2001 is the same.
    """
    harder = pinion / wheel
    slope = 0.00898 * np.minimum(harder, 1.7) - 0.00829
    slope = choose(harder < 1.2, 0.0, slope)
    return 1.0 + slope * (np.clip(np.abs(ratio), 1.0, 20.0) - 1.0)


def static_hardening_factor(brinell: Any) -> Any:
    """Return Z_W = 1.05 - (HB - 130)/6800 of static strength, HB 130 to 470. [memory]."""
    return 1.05 - (np.clip(brinell, STEEPEST, HARDEST) - 130.0) / 6800.0
