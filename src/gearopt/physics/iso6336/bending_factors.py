"""Factors of tooth root stress and of its permissible value by ISO 6336-3.

Floats, arrays or casadi scalars unless a docstring says otherwise; strengths [MPa], roughness [mm].
"""

from typing import Any

import numpy as np

from gearopt.physics.choosing import choose

TEST_GEAR = 2.0  # Y_ST, stress correction factor of the test gears
REVERSED = 0.7  # Y_M of idlers and fully reversed loads. ISO 6336-5, 5.3; IACS UR M56, 3.9


def helix_factor(helix: Any, overlap: Any, edition: str = "2006") -> Any:
    """Return Y_beta = 1 - eps_beta beta/120 degrees, eps_beta up to 1, beta up to 30 degrees.

    2019: over cos(beta)^3. helix [rad]. Source: ISO 6336-3:2006, 8; a printed report of 2019.
    """
    return inclined(helix, overlap, edition != "2006")


def inclined(helix: Any, overlap: Any, newer: bool) -> Any:
    """Y_beta of `helix_factor`; newer: of 2019."""
    degrees = np.minimum(np.degrees(np.abs(helix)), 30.0)
    found = 1.0 - np.minimum(overlap, 1.0) * degrees / 120.0
    return found / np.cos(helix) ** 3 if newer else found


def rim_factor(backup: Any) -> Any:
    """Return Y_B = 1.6 ln(2.242 h_t/s_R), 1 from s_R/h_t = 1.2; backup s_R/h_t above 0.5.

    The two do not quite meet: 1.0000 against 1.0001. Source: ISO 6336-3:2006, 9; IACS UR M56, 3.6,
    has it, and K_B of AGMA 2001 is the same.
    """
    found = 1.6 * np.log(2.242 / np.minimum(backup, 1.2))
    return choose(backup >= 1.2, 1.0, found)


THIN_RING, THICK_RING = 1.75, 3.5  # s_R/m_n of rings: below, and from which on Y_B is 1


def ring_rim_factor(rim: Any) -> Any:
    """Return Y_B = 1.15 ln(8.324 m_n/s_R) of a ring, 1 from s_R/m_n = 3.5; NaN up to 1.75.

    The two do not quite meet: 0.9963 against 1, and at least 1 is taken. rim: s_R/m_n outside the
    root circle. Source: ISO 6336-3:2006, 9 [memory: unverified].
    """
    thin = np.maximum(1.15 * np.log(8.324 / np.maximum(rim, THIN_RING)), 1.0)
    return choose(rim > THIN_RING, choose(rim >= THICK_RING, 1.0, thin), np.nan)


def deep_tooth_factor(virtual_ratio: Any, grade: Any) -> Any:
    """Return Y_DT: 1 to eps_alphan = 2.05, then, of grades to 4, 2.366 - 0.666 eps_alphan.

    0.7 above 2.5; 1 for grades from 5 on. Source: ISO 6336-3:2006, 10; IACS UR M56, 3.7.
    """
    found = 2.366 - 0.666 * np.clip(virtual_ratio, 2.05, 2.5)
    found = choose(virtual_ratio > 2.5, 0.7, found)
    return choose(grade <= 4.0, choose(virtual_ratio > 2.05, found, 1.0), 1.0)


def root_stress(load: Any, width: Any, module: Any, product: Any) -> Any:
    """Return sigma_F0 = F_t/(b m_n) Y_F Y_S Y_beta Y_B Y_DT [MPa]; product of the Y. Part 3, 5."""
    return load / (width * module) * product


# rho' [mm] of the slip layer by yield point (tensile strength of cast iron) [MPa].
# Source: ISO 6336-3:2006, table 2; IACS UR M56, 3.11, has those of V, NT, NV, Eh and IF, the rest
# is of memory; 0.0030 and 0.0014 are met by printed reports
SLIP_LAYERS: dict[str, tuple[tuple[float, float], ...]] = {
    **dict.fromkeys(("GG", "GGG ferritic"), ((150.0, 0.3124), (300.0, 0.3095))),
    **dict.fromkeys(("NT", "NV", "NV nitrocarburised"), ((0.0, 0.1005),)),
    "St": ((300.0, 0.0833), (400.0, 0.0445)),
    **dict.fromkeys(
        ("V", "GTS", "GGG"),
        ((500.0, 0.0281), (600.0, 0.0194), (800.0, 0.0064), (1000.0, 0.0014)),
    ),
    **dict.fromkeys(("Eh", "IF"), ((0.0, 0.0030),)),
}


def slip_layer(family: str, yield_strength: float) -> float:
    """Return rho' [mm] of a family of materials; straight between the listed strengths."""
    known = SLIP_LAYERS[family]
    return float(np.interp(yield_strength, [s for s, _ in known], [r for _, r in known]))


def notch_factor(slip: Any, notch: Any) -> Any:
    """Return Y_deltarelT = (1 + sqrt(rho' chi))/(1 + sqrt(rho' chi_T)), chi = (1 + 2 q_s)/5.

    chi_T = 1.2, of q_s = 2.5; slip rho' [mm]; notch q_s. Source: ISO 6336-3:2006, 13.
    """
    gradient = 0.2 * (1.0 + 2.0 * notch)
    return (1.0 + np.sqrt(slip * gradient)) / (1.0 + np.sqrt(slip * 1.2))


def static_notch_factor(family: str, concentration: Any, yield_strength: float) -> Any:
    """Return Y_deltarelT of static strength, a line in Y_S that is 1 at Y_S = 2.

    Source: ISO 6336-3:2006, 13; hanslhansl/din3990 has it, GTS is of memory.
    """
    lines = {
        **dict.fromkeys(("Eh", "IF"), 0.44),
        **dict.fromkeys(("NT", "NV", "NV nitrocarburised"), 0.20),
        "GTS": 0.075,
    }
    if family in ("GG", "GGG ferritic"):
        return 1.0 + 0.0 * concentration
    if family in lines:
        return 1.0 + lines[family] * (concentration - 2.0)
    height, known = (0.93, 200.0) if family == "St" else (0.82, 300.0)
    slope = height * (known / yield_strength) ** 0.25
    return (1.0 + slope * (concentration - 1.0)) / (1.0 + slope)


# Y_RrelT: value below 1 um, then a - b (R_z + 1)^c. Source: ISO 6336-3:2006, 14; rules of the
# Korean Register, part 5, have all three lines (IACS UR M56, 3.12), of nitrided steels the third
SURFACES = {
    **dict.fromkeys(("V", "GTS", "GGG", "Eh", "IF"), (1.12, 1.674, 0.529, 0.1)),
    "St": (1.07, 5.306, 4.203, 0.01),
    **dict.fromkeys(
        ("GG", "GGG ferritic", "NT", "NV", "NV nitrocarburised"), (1.025, 4.299, 3.259, 0.0058)
    ),
}


def surface_factor(family: str, roughness: Any) -> Any:
    """Return Y_RrelT of a root of roughness R_z [mm], 1 to 40 um; constant below 1 um.

    Its value there is that of the standard, up to 1.2 % above the line.
    """
    smooth, height, slope, power = SURFACES[family]
    line = height - slope * (1e3 * roughness + 1.0) ** power
    return choose(roughness < 1e-3, smooth, line)


# Y_X = a - b m_n between 5 mm and the module where it ends. Source: ISO 6336-3:2006, 15;
# hanslhansl/din3990 has it (its 0.85 for the end of grey cast iron is not on its own line)
SIZES = {
    **dict.fromkeys(("St", "V", "GTS", "GGG"), (1.03, 0.006, 30.0)),
    **dict.fromkeys(("Eh", "IF", "NT", "NV", "NV nitrocarburised"), (1.05, 0.010, 25.0)),
    **dict.fromkeys(("GG", "GGG ferritic"), (1.075, 0.015, 25.0)),
}


def size_factor(family: str, module: Any) -> Any:
    """Return Y_X of a normal module [mm]."""
    height, slope, end = SIZES[family]
    return height - slope * np.clip(module, 5.0, end)
