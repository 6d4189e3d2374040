"""Running-in allowances y_alpha, y_beta, C_ay of one material, by parts 1 of 2006 and 2019.

Deviations and allowances [mm], sigma_Hlim [MPa], speed [mm/s]; floats, arrays, casadi scalars.
"""

from typing import Any

import numpy as np

from gearopt.physics.choosing import choose

MICROMETRE = 1e-3  # mm
SLOW, FAST = 5000.0, 10000.0  # mm/s: limits of an allowance change there
TEMPERED = ("St", "V", "GTS", "GGG")  # GGG: pearlitic and bainitic
CAST = ("GG", "GGG ferritic")


def kind(family: str) -> str:
    """Return the kind of a family in the laws below, in all of which sigma_Hlim is of one use.

    Tempered ones run in more the less it is; of the others it does not count.
    """
    return "tempered" if family in TEMPERED else "cast" if family in CAST else "hard"


def pitch_allowance(family: str, deviation: Any, contact_limit: Any, speed: Any) -> Any:
    """Return y_alpha of a base pitch or profile deviation.

    St, V, GTS, GGG: 160/sigma_Hlim of it, above 5 m/s up to 12800/sigma_Hlim um, above 10 m/s
    6400/sigma_Hlim um; GG, GGG ferritic: 0.275, 22, 11 um; others: 0.075, up to 3 um. Never more
    than the deviation. Source: ISO 6336-1:2006, 8.3.5; printed reports have it of
    surface hardened gears and, below 5 m/s, of tempered steel; the rest is of memory.
    """
    if family in TEMPERED:
        return tempered(deviation, 160.0 / contact_limit, speed)
    if family in CAST:
        return tempered(deviation, 0.275, speed)
    return np.minimum(0.075 * deviation, 3.0 * MICROMETRE)


def helix_allowance(family: str, deviation: Any, contact_limit: Any, speed: Any) -> Any:
    """Return y_beta of an initial equivalent misalignment F_betax.

    St, V, GTS, GGG: 320/sigma_Hlim of it, above 5 m/s up to 25600/sigma_Hlim um, above 10 m/s
    12800/sigma_Hlim um; GG, GGG ferritic: 0.55, 45, 22 um; others: 0.15, up to 6 um. Never more
    than the deviation. Source: ISO 6336-1:2006, 7.5; hanslhansl/din3990 has that of DIN 3990.
    """
    if family in TEMPERED:
        return tempered(deviation, 320.0 / contact_limit, speed)
    return cast_helix(deviation, speed) if family in CAST else hard_helix(deviation)


def tempered(deviation: Any, share: Any, speed: Any) -> Any:
    """Return share of a deviation, which counts up to 80 um above 5 m/s, above 10 m/s to 40."""
    counted = choose(speed > FAST, 40.0, choose(speed > SLOW, 80.0, np.inf))
    return np.minimum(share, 1.0) * np.minimum(deviation, counted * MICROMETRE)


def cast_helix(deviation: Any, speed: Any) -> Any:
    """Return y_beta of GG and ferritic GGG."""
    limit = choose(speed > FAST, 22.0, 45.0) * MICROMETRE
    return choose(speed > SLOW, np.minimum(0.55 * deviation, limit), 0.55 * deviation)


def hard_helix(deviation: Any) -> Any:
    """Return y_beta of hardened gears."""
    return np.minimum(0.15 * deviation, 6.0 * MICROMETRE)


def tip_relief(contact_limit: Any) -> Any:
    """Return C_ay = (sigma_Hlim/97 - 18.45)^2/18 + 1.5 um [mm], relief that wear gives.

    Source: ISO 6336-1:2006, 6.5; a printed report has 2.0 um of 1500 MPa.
    """
    return ((contact_limit / 97.0 - 18.45) ** 2 / 18.0 + 1.5) * MICROMETRE
