"""K_v by method B, K_Hbeta and K_Fbeta by method C, K_Halpha and K_Falpha by method B, of part 1.

Line loads [N/mm], stiffness [MPa], deviations [mm]; floats or arrays.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose

MAIN, SUPER = 1.15, 1.5  # resonance ratios at which the main resonance and the range above end
LIGHT = 100.0  # N/mm
RANGES = ("subcritical", "main resonance", "supercritical")


def resonance_speed(pinion_teeth: Any, stiffness: Any, mass: Any) -> Any:
    """Return omega_E1 = sqrt(c_gamma_alpha/m_red)/z1 [rad/s]; n_E1 in other units.

    stiffness [MPa], mass m_red [t/mm]. Source: ISO 6336-1:2006, 6.5.
    """
    return np.sqrt(stiffness / mass) / pinion_teeth


def lower_limit(line_load: Any) -> Any:
    """Return N_S, where the main resonance begins: 0.5 + 0.35 sqrt(w/100), at most 0.85.

    line_load w = F_t K_A/b [N/mm]. Source: ISO 6336-1:2006, 6.5.
    """
    return 0.5 + 0.35 * np.sqrt(np.minimum(line_load / LIGHT, 1.0))


@dataclass(frozen=True)
class Dynamics:
    """Data of K_v but the speed: relative deviations B_p, B_f, B_k, and eps_gamma.

    B_p = c' f_pbeff/w, B_f = c' f_falphaeff/w, B_k = |1 - c' C_a/w|, w = F_t K_A/b.
    """

    pitch: Any
    form: Any
    relief: Any
    total_ratio: Any


def coefficients(total_ratio: Any) -> tuple[Any, ...]:
    """Return C_v1 to C_v7 of a total contact ratio eps_gamma.

    Up to 2: 0.32, 0.34, 0.23, 0.90, 0.47, 0.47; above it hyperbolas in eps_gamma, which do
    not quite meet there: C_v2, C_v3, C_v4, C_v6 jump by -1.4, -5.1, -6.7, -1.8 %.
    Source: ISO 6336-1:2006, table 8 (6.5); gfsReboucas/Drivetrain has it.
    """
    e = np.maximum(total_ratio, 2.0)
    above = total_ratio > 2.0
    second = choose(above, 0.57 / (e - 0.3), 0.34)
    third = choose(above, 0.096 / (e - 1.56), 0.23)
    fourth = choose(above, (0.57 - 0.05 * e) / (e - 1.44), 0.90)
    sixth = choose(above, 0.12 / (e - 1.74), 0.47)
    phase = np.minimum(np.maximum(total_ratio, 1.5), 2.5) - 2.0
    return 0.32, second, third, fourth, 0.47, sixth, 0.125 * np.sin(np.pi * phase) + 0.875


def dynamic_factor(dynamics: Dynamics, resonance: Any, line_load: Any, within: str = "") -> Any:
    """Return K_v at a resonance ratio N = omega_1/omega_E1.

    Up to N_S 1 + N (C_v1 B_p + C_v2 B_f + C_v3 B_k); at the main resonance, to 1.15, 1 + C_v1 B_p +
    C_v2 B_f + C_v4 B_k: a jump at N_S, which is the standard's; from 1.5 C_v5 B_p + C_v6 B_f +
    C_v7; straight between 1.15 and 1.5. line_load F_t K_A/b [N/mm]; within: one of RANGES, whose
    law then counts without a jump.
    Source: ISO 6336-1:2006, 6.5.
    """
    low, main, high = dynamic_ranges(dynamics, resonance)
    if within:
        return dict(zip(RANGES, (low, main, high), strict=True))[within]
    rise = np.clip((resonance - MAIN) / (SUPER - MAIN), 0.0, 1.0)
    above = main + (high - main) * rise
    return choose(resonance <= lower_limit(line_load), low, above)


def dynamic_ranges(dynamics: Dynamics, resonance: Any) -> tuple[Any, Any, Any]:
    """Return K_v of the subcritical range, of the main resonance and of the supercritical range."""
    c1, c2, c3, c4, c5, c6, c7 = coefficients(dynamics.total_ratio)
    pitch, form, relief = dynamics.pitch, dynamics.form, dynamics.relief
    shared = c1 * pitch + c2 * form
    low = 1.0 + resonance * (shared + c3 * relief)
    return low, 1.0 + shared + c4 * relief, c5 * pitch + c6 * form + c7


# Part of f_sh and f_ma that remains: B_1, B_2. Source: ISO 6336-1:2006, 7.5 [memory; iso.py of
# efirvida/python-gearbox has all but "crowned for deflection"; only "none" is met by print]
HELIX_MODIFICATIONS = {
    "none": (1.0, 1.0),
    "crowned": (1.0, 0.5),
    "crowned for deflection": (0.5, 0.5),
    "helix corrected": (0.1, 1.0),
    "helix corrected and crowned": (0.1, 0.5),
    "end relief": (0.7, 0.7),
}
LIGHT_ENDS = ("crowned", "crowned for deflection", "helix corrected and crowned", "end relief")
# K' of figure 13, of pinions that do not stiffen their shaft. Source: ISO 6336-1:2006, in iso.py of
# efirvida/python-gearbox; a public program of DIN 3990-11, figure 3.2, has the same.
ARRANGEMENTS = {"a": 0.8, "b": -0.8, "c": 1.33, "d": -0.6, "e": -1.0}
STIFF, LEFT = 1.15, 0.6  # d1/d_sh from which a pinion stiffens its shaft; what is left of K'
STRAIGHT = 0.7  # of f_sh: what twist adds to bending
PER_LOAD = 0.023e-3  # mm of f_sh per N/mm
LEAST_PER_LOAD = 0.005e-3  # mm of F_betax per N/mm, at least


@dataclass(frozen=True)
class Shaft:
    """A pinion s off the middle of bearings l apart, on a shaft of diameter d_sh, all [mm].

    arrangement: of ARRANGEMENTS; stiffened: by the pinion, where d1 >= STIFF d_sh.
    """

    span: float = 0.0
    offset: float = 0.0
    diameter: float = 1.0
    arrangement: str = "a"
    stiffened: bool = True

    @property
    def overhung(self) -> bool:
        """Whether the pinion is beyond the bearings."""
        return self.arrangement == "c"

    def bending(self, diameter: Any) -> Any:
        """Return K = K' l s/d1^2 (d1/d_sh)^4 of a pinion diameter d1 [mm]."""
        part: Any = ARRANGEMENTS[self.arrangement]
        if self.stiffened and not self.overhung:
            part = choose(diameter >= STIFF * self.diameter, LEFT * part, part)
        return part * self.span * self.offset * diameter**2 / self.diameter**4


def twist_of_meshes(meshes: float) -> float:
    """The part of K of `shaft_misalignment` that is due to a pinion in several meshes at once.

    B* - 1 = 2 (100 - k)/k for k = 100/p per cent of its torque in each of p meshes: 4 of three.
    Source: ISO 6336-1:2006, 7.5, method C [memory: unverified].
    """
    return 2.0 * max(meshes - 1.0, 0.0)


def shaft_misalignment(line_load: Any, width_ratio: Any, bending: Any = 0.0) -> Any:
    """Return f_sh = w 0.023 um (|1 + K - 0.3| + 0.3) (b/d1)^2 [mm].

    line_load w = F_t K_A K_v/b [N/mm]; width_ratio b/d1; bending K of a `Shaft`.
    Source: ISO 6336-1:2006, 7.5.
    """
    return line_load * PER_LOAD * (np.abs(STRAIGHT + bending) + 0.3) * width_ratio**2


def initial_misalignment(
    shaft: Any, alignment: Any, line_load: Any, slope: Any, parts: tuple[float, float] = (1.0, 1.0)
) -> Any:
    """Return F_betax = 1.33 B_1 f_sh + B_2 f_ma [mm], at least 0.005 um w and 0.5 f_Hbeta.

    line_load w [N/mm]; slope: the larger f_Hbeta [mm]; parts B_1, B_2: of HELIX_MODIFICATIONS.
    Source: ISO 6336-1:2006, 7.5.
    """
    initial = 1.33 * parts[0] * shaft + parts[1] * alignment
    return np.maximum(initial, np.maximum(LEAST_PER_LOAD * line_load, 0.5 * slope))


def face_load_factor(misalignment: Any, stiffness: Any, line_load: Any) -> Any:
    """Return K_Hbeta = 1 + x, or 2 sqrt(x) for x >= 1, x = F_betay c_gamma_beta/(2 w).

    misalignment F_betay after running-in [mm]; stiffness c_gamma_beta [MPa]; line_load w =
    F_t K_A K_v/b [N/mm]. Source: ISO 6336-1:2006, 7.5, method C.
    """
    x = misalignment * stiffness / (2.0 * line_load)
    return choose(x >= 1.0, 2.0 * np.sqrt(x), 1.0 + x)


def root_face_load_factor(contact: Any, width: Any, depth: Any) -> Any:
    """Return K_Fbeta = K_Hbeta^N_F, N_F = 1/(1 + h/b + (h/b)^2), b/h at least 3.

    face width b, tooth depth h [mm]. Source: ISO 6336-1:2006, 7.6.
    """
    return contact ** root_exponent(width, depth)


def root_exponent(width: Any, depth: Any) -> Any:
    """Return N_F of `root_face_load_factor`, 9/13 to 1."""
    slim = np.minimum(depth / width, 1.0 / 3.0)
    return 1.0 / (1.0 + slim + slim**2)


def transverse_load_factor(stiffness: Any, deviation: Any, line_load: Any, total_ratio: Any) -> Any:
    """Return K_Halpha = K_Falpha without their limits, of eps_gamma = total_ratio.

    q = c_gamma_alpha (f - y_alpha)/w; eps_gamma/2 (0.9 + 0.4 q) up to eps_gamma = 2, then 0.9 + 0.4
    sqrt(2 (eps_gamma - 1)/eps_gamma) q: both meet at 2. stiffness [MPa]; deviation f - y_alpha
    [mm], f the larger of f_pb and f_falpha; line_load w = F_t K_A K_v K_Hbeta/b [N/mm].
    Source: ISO 6336-1:2006, 8.3; met by a printed report (1.069).
    """
    q = stiffness * deviation / line_load
    ratio = np.maximum(total_ratio, 1e-9)
    low = 0.5 * ratio * (0.9 + 0.4 * q)
    high = 0.9 + 0.4 * np.sqrt(2.0 * np.maximum(ratio - 1.0, 0.0) / ratio) * q
    return choose(total_ratio <= 2.0, low, high)


def limited(factor: Any, most: Any) -> Any:
    """Return a factor between 1 and the greatest value that has a meaning, at least 1."""
    return np.maximum(np.minimum(factor, most), 1.0)
