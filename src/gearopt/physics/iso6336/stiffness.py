"""Mesh stiffness by method B of ISO 6336-1, clause 9: c', c_gamma_alpha, c_gamma_beta.

Stiffness per face width in MPa: 1 N/(mm um) is 1000 MPa. Floats, arrays or casadi scalars.
"""

from typing import Any

import numpy as np

from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, GearPair, Rack, is_internal
from gearopt.physics.geometry.tooth import virtual_teeth

STEEL = 206000.0  # MPa
PER_MICROMETRE = 1000.0  # MPa
THEORETICAL = 0.8  # C_M: measured over theoretical stiffness, solid discs
LEAST_LINE_LOAD = 100.0  # N/mm, below which c' falls with the load


def flexibility(teeth: tuple[Any, Any], shifts: tuple[Any, Any]) -> Any:
    """Return q' [mm um/N], the least flexibility of a pair of teeth.

    virtual numbers of teeth z_n1, z_n2, of the gear with fewer teeth first; profile shifts x.
    Source: ISO 6336-1:2006, 9.3, table 9; met by ISO/TR 6336-30, example 1, to every digit.
    """
    (z1, z2), (x1, x2) = teeth, shifts
    return (
        0.04723
        + 0.15551 / z1
        + 0.25791 / z2
        - 0.00635 * x1
        - 0.11654 * x1 / z1
        - 0.00193 * x2
        - 0.24188 * x2 / z2
        + 0.00529 * x1**2
        + 0.00182 * x2**2
    )


def theoretical_stiffness(pair: GearPair) -> Any:
    """Return c'_th = 1/q' [MPa]; the gear with fewer teeth counts as the pinion.

    Of a ring 1/z_n2 = 0; its x_2 counts. Source: ISO 6336-1:2006, 9.3; met by two printed rings.
    """
    gears = [(virtual_teeth(g), g.profile_shift) for g in pair.gears]
    (z1, x1), (z2, x2) = gears
    if is_internal(z2):
        z2 = choose(np.less(z2, 0.0), np.inf, z2)
    ahead = flexibility((z1, z2), (x1, x2))
    turned = flexibility((z2, z1), (x2, x1))
    return PER_MICROMETRE / choose(z1 <= z2, ahead, turned)


def rack_factor(racks: tuple[Rack, Rack]) -> Any:
    """Return C_B = (1 + 0.5 (1.2 - h_fP/m_n)) (1 - 0.02 (20 - alpha_n)), the mean of both racks.

    alpha_n in degrees. Source: ISO 6336-1:2006, 9.3.
    """
    made = [
        (1.0 + 0.5 * (1.2 - r.dedendum)) * (1.0 - 0.02 * (20.0 - np.degrees(r.pressure_angle)))
        for r in racks
    ]
    return 0.5 * (made[0] + made[1])


def blank_factor(web: Any, rim: Any) -> Any:
    """Return C_R = 1 + ln(b_s/b)/(5 exp(s_R/(5 m_n))) of a gear with a web; 1 for a solid disc.

    web b_s/b, from 0.2 to 1.2, beyond which the ends count; rim s_R/m_n, at least 1.
    Source: ISO 6336-1:2006, 9.3; met by a printed report (0.898).
    """
    part = np.minimum(np.maximum(web, 0.2), 1.2)
    return 1.0 + np.log(part) / (5.0 * np.exp(np.maximum(rim, 1.0) / 5.0))


def mean_blank_factor(webs: tuple[Any, Any]) -> Any:
    """Return the mean C_R of both gears; webs: (b_s/b, s_R/m_n) of each, None: a solid disc."""
    first, second = (1.0 if web is None else blank_factor(*web) for web in webs)
    return 0.5 * (first + second)


def single_stiffness(
    pair: GearPair,
    line_load: Any,
    moduli: tuple[Any, Any] = (STEEL, STEEL),
    blank: Any = 1.0,
) -> Any:
    """Return c' = c'_th C_M C_R C_B cos(beta) E/E_st [MPa], the largest of one pair of teeth.

    line_load F_t K_A/b [N/mm]: below 100 N/mm times (line_load/100)^0.25 (unverified: of memory;
    DIN 3990 has a linear law); moduli E1, E2 [MPa], E = 2 E1 E2/(E1 + E2); blank C_R.
    Source: ISO 6336-1:2006, 9.3.
    """
    modulus = 2.0 * moduli[0] * moduli[1] / (moduli[0] + moduli[1])
    racks = pair.pinion.rack, pair.wheel.rack
    product = THEORETICAL * blank * rack_factor(racks) * np.cos(pair.pinion.helix_angle)
    return theoretical_stiffness(pair) * product * modulus / STEEL * light_load(line_load)


def light_load(line_load: Any) -> Any:
    """Part of c' that is left at a line load F_t K_A/b [N/mm], as `single_stiffness` has it."""
    return np.minimum(line_load / LEAST_LINE_LOAD, 1.0) ** 0.25


def mesh_stiffness(single: Any, transverse_ratio: Any) -> tuple[Any, Any]:
    """Return c_gamma_alpha = c' (0.75 eps_alpha + 0.25) and c_gamma_beta = 0.85 of it [MPa].

    For eps_alpha >= 1.2; below, the standard lets them be reduced by up to 10 %, which is not done.
    Source: ISO 6336-1:2006, 9.3.
    """
    mean = single * (0.75 * transverse_ratio + 0.25)
    return mean, 0.85 * mean


def reduced_mass(
    pair: GearPair,
    densities: tuple[Any, Any],
    bores: tuple[Any, Any],
    meshes: tuple[float, float] | None = None,
) -> Any:
    """Return m_red [t/mm] of a pair of solid or bored discs, per face width at the line of action.

    pi/8 (d_m1/d_b1)^2 d_m1^2/(1/((1 - q1^4) rho1) + 1/((1 - q2^4) rho2 u^2)), d_m = (d_a + d_f)/2,
    q = d_i/d_m. densities [t/mm3]; bores d_i [mm]. Of rings, and of gears of planetary stages in
    several meshes, `shared_mass`. Source: ISO 6336-1:2006, 6.5.
    """
    if meshes is not None:
        return shared_mass(pair, densities, bores, meshes)
    first, second = (mean_diameter(g) for g in pair.gears)
    inverse = 1.0 / ((1.0 - (bores[0] / first) ** 4) * densities[0])
    heavy = (1.0 - (bores[1] / second) ** 4) * densities[1]
    inverse = inverse + 1.0 / (heavy * pair.ratio**2)
    mass = np.pi / 8.0 * (first / pair.pinion.base_diameter) ** 2 * first**2 / inverse
    if is_internal(pair.wheel_teeth):
        rings = shared_mass(pair, densities, bores, (1.0, 1.0))
        mass = choose(np.less(pair.wheel_teeth, 0.0), rings, mass)
    return mass


def shared_mass(
    pair: GearPair,
    densities: tuple[Any, Any],
    bores: tuple[Any, Any],
    meshes: tuple[float, float],
) -> Any:
    """Return m_red = 1/(p_1/m_1 + p_2/m_2) [t/mm] of gears in p_1 and p_2 meshes at once.

    m = pi/8 rho |1 - q^4| d_m^4/d_b^2, as in `reduced_mass`, d_i of a ring its outside diameter. p:
    the number of planets for a sun or ring, 1 for a planet, 0 and less for what the casing holds:
    m_sun m_pla/(p m_pla + m_sun), and m_pla for planet and fixed ring. Source: ISO 6336-1:2006, 6.5
    [memory], and gfsReboucas/Drivetrain; a printed report meets both to every digit (1.534e-7,
    1.4684e-6); of a ring that turns the same rule, unverified.
    """
    inverse: Any = 0.0
    for gear, density, bore, count in zip(pair.gears, densities, bores, meshes, strict=True):
        mean = mean_diameter(gear)
        end = gear.outside if is_internal(gear.teeth) else bore
        left = np.abs(1.0 - (end / mean) ** 4) * density
        inverse = inverse + max(count, 0.0) * gear.base_diameter**2 / (left * mean**4)
    return np.pi / 8.0 / inverse


def mean_diameter(gear: Gear) -> Any:
    """Return d_m, the mean of tip and root diameter [mm]."""
    return 0.5 * (gear.tip_diameter + gear.root_diameter)
