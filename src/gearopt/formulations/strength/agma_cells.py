"""Least d1^2 b that AGMA 2001 needs over cells of designs."""

from typing import TYPE_CHECKING, Any

import numpy as np

from gearopt.formulations.strength.cells import LOWER, UPPER, Cells
from gearopt.formulations.strength.teeth_alone import agma_teeth
from gearopt.optimise.terms import Array
from gearopt.physics.agma import factors
from gearopt.physics.agma.batch import safeties
from gearopt.physics.agma.rating_factors import distribution
from gearopt.physics.geometry.tooth import base_helix_angle

if TYPE_CHECKING:
    from gearopt.formulations.strength.agma import Agma


def needed(standard: "Agma", cells: Cells, safety: tuple[float, float]) -> tuple[Any, Any]:
    """Return the least d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending [1/MPa].

    safety: S_F and S_H asked for. Loads grow with speed, width and d1 as K_v, K_m and K_s do; life
    factors fall with the cycles, C_H rises with u.
    """
    teeth = cells.teeth_alone(agma_teeth(standard.practice.load, _regimes(cells)))
    given, practice = standard.given, standard.practice
    working, load = teeth["working"], standard.loads[0]
    pace = 0.5 * load.speed * cells.speed[LOWER] * cells.diameter[LOWER] * working[LOWER]
    width = np.minimum(cells.width[LOWER], factors.WIDEST)
    slim = np.minimum(
        cells.slim[LOWER] / working[UPPER],
        factors.WIDEST / (cells.diameter[UPPER] * working[UPPER]),
    )
    bare: dict[str, Any] = {"I": 1.0, "J": (1.0, 1.0)}
    bare["K_v"] = given["K_v"] if "K_v" in given else factors.dynamic_factor(pace, practice.quality)
    bare["K_m"] = given["K_m"] if "K_m" in given else distribution(practice, width, width / slim)
    transverse = cells.diameter[LOWER] / cells.teeth[UPPER]
    sizes = [
        factors.size_factor(cells.width[LOWER], transverse, factors.lewis_form(z))
        for z in (cells.teeth[LOWER], cells.teeth[LOWER] * cells.ratio[LOWER])
    ]
    bare["K_B"] = _rims(standard, cells)
    bare["K_s"] = tuple(sizes) if practice.size else (1.0, 1.0)
    module, d = cells.module[LOWER], cells.diameter[LOWER]
    pair = cells.cut(LOWER).of_diameter(module, cells.teeth[LOWER], d, cells.ratio[UPPER], 1.0)
    cases = [way.case(pair, 1.0, cells.speed[LOWER], bare) for way in standard.strongest_ways]
    every = zip(*(safeties(case, 1.0, (1.0, 1.0)) for case in cases), strict=True)
    made = [np.maximum.reduce(values) for values in every]
    own = pair.working_diameters[0]
    first, *both = _geometry(cells, teeth)
    first = 1.0 + 1.0 / cells.ratio[LOWER] if "I" in given else first  # `made` has what is given
    both = [1.0, 1.0] if "J" in given else both
    pressed = [(own * safety[1] / (s * working[UPPER])) ** 2 / first for s in made[2:]]
    bent = [
        own * (d / cells.teeth[LOWER]) / s * cells.teeth[LOWER] * safety[0] / (j * working[UPPER])
        for s, j in zip(made[:2], both, strict=True)
    ]
    return np.maximum(*pressed), np.maximum(*bent)


def _rims(standard: "Agma", cells: Cells) -> tuple[Any, Any]:
    """Return the least K_B, which falls with the backup ratio."""
    law = factors.rim_factor if standard.practice.edition == "D04" else factors.rim_factor_b88
    first, second = (
        law(cells.of_bodies(blank, k, blank.backups)[UPPER])
        for k, blank in enumerate(standard.blanks)
    )
    return first, second


def _regimes(cells: Cells) -> tuple[str, ...]:
    """Return the regimes of AGMA 908 that some cells may be in."""
    if not np.any(cells.helix_bounds[1]):
        return ("spur",)
    low, high = cells.overlap
    found = ("low",) if np.any(low <= 1.0) else ()
    return (*found, "conventional") if np.any(high > 1.0) else found


def _geometry(cells: Cells, teeth: dict[str, Array]) -> list[Any]:
    """Return the greatest I (1 + 1/u), J_1, J_2."""
    low, high = cells.overlap
    found = []
    for k in range(3):
        most = np.zeros(len(low))
        if "spur0" in teeth:
            most = teeth[f"spur{k}"][UPPER]
        if "low0" in teeth:
            ends = [1.0 - np.minimum(o, 1.0) * s for o in (low, high) for s in teeth["slope"]]
            factor = np.maximum(np.maximum.reduce(ends), 0.0) ** (0.5 if k else 1.0)
            most = np.where(low <= 1.0, teeth[f"low{k}"][UPPER] * factor, most)
        if "conventional0" in teeth:
            own = teeth[f"conventional{k}"][UPPER] * _lines(cells, teeth["contact"])
            most = np.where(high > 1.0, np.maximum(most, own), most)
        found.append(np.where(np.isnan(most), np.inf, most))
    return found


def _lines(cells: Cells, ratio: Array) -> Any:
    """Return the greatest L_min/b.

    (eps_alpha - lost/m_F)/cos(beta_b); of the fractions r and a of eps_alpha and m_F the smaller of
    a r and (1 - a)(1 - r) is lost.
    """
    helix = np.cos(base_helix_angle(cells.cut(UPPER).pair(1.0, 20.0, 40.0, 1.0).pinion))
    fractions = []
    for low, high in (ratio, np.maximum(cells.overlap, 1.0)):
        within = np.floor(low) == np.floor(high)
        fractions.append((np.where(within, low % 1.0, 0.0), np.where(within, high % 1.0, 1.0)))
    (r_low, r_high), (a_low, a_high) = fractions
    lost = np.minimum(a_low * r_low, (1.0 - a_high) * (1.0 - r_high))
    return (ratio[UPPER] - lost / np.maximum(cells.overlap[UPPER], 1.0)) / helix
