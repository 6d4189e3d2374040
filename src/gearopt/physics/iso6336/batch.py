"""Many ratings at once, and the smooth form: all quantities of arrays or of casadi scalars.

Both are the text of `chain`. The smooth form takes deviations without the steps of ISO 1328 and the
law of one range of K_v, and so has no jumps but the standard's small ones (C_v at eps_gamma = 2,
Y_RrelT at 1 um, f_eps of 2019); its kinks are those of the limits in the laws.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.case import Case, Practice, check
from gearopt.physics.iso6336.chain import quantities
from gearopt.physics.iso6336.load_factors import MAIN, RANGES, SUPER, lower_limit
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import check_lives, levels_of
from gearopt.physics.iso6336.refusals import refusal
from gearopt.physics.rating import Operation, Ratings, spectrum_safety


def rate_rows(
    pair: GearPair,
    operation: Operation,
    materials: tuple[Material, Material],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Ratings:
    """Return the safety factors of a pair and an operation of arrays, one shape each or floats.

    given: as of `rating.rate`, floats or arrays. Row by row the same as `rating.rate`. ValueError
    for words and materials, none for rows: those have a refusal.
    """
    practice = practice or Practice()
    check(practice)
    found = quantities(Case(pair, operation, materials, practice, given or {}))
    code = refusal(pair, practice.shift)
    bending = [a / b for a, b in zip(found["sigma_FG"], found["sigma_F"], strict=True)]
    contact = [a / b for a, b in zip(found["sigma_HG"], found["sigma_H"], strict=True)]
    values = [np.where(code == 0, value, np.nan)[()] for value in (*bending, *contact)]
    return Ratings((values[0], values[1]), (values[2], values[3]), code)


def spectrum_rows(
    pair: GearPair,
    operations: Sequence[Operation],
    materials: tuple[Material, Material],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Ratings:
    """Return the safety factors under levels of load, of arrays of one shape each or floats.

    Row by row the same as `rating.rate_spectrum`; ValueError as of `rate_rows`, and for life
    factors that are given.
    """
    practice, given = practice or Practice(), given or {}
    check(practice)
    check_lives(given)
    cases = [Case(pair, one, materials, practice, given) for one in operations]
    found = [quantities(case) for case in cases]
    code = refusal(pair, practice.shift)
    values = [
        np.where(code == 0, spectrum_safety(levels_of(cases, found, k, contact)), np.nan)[()]
        for contact in (False, True)
        for k in (0, 1)
    ]
    return Ratings((values[0], values[1]), (values[2], values[3]), code)


def range_of(case: Case) -> str:
    """Return the range of `load_factors.RANGES` in which a pair of floats runs.

    Between the main resonance and the supercritical range the nearer one.
    """
    values = quantities(case)
    line = case.load * values["K_A"] * values["K_gamma"] / case.pair.face_width
    if values["N"] <= lower_limit(line):
        return RANGES[0]
    return RANGES[1] if values["N"] < 0.5 * (MAIN + SUPER) else RANGES[2]


def smooth_safeties(
    pair: GearPair,
    operation: Operation,
    materials: tuple[Material, Material],
    practice: Practice,
    within: str,
    given: Mapping[str, Any] | None = None,
) -> tuple[Any, Any, Any, Any]:
    """Return S_F1, S_F2, S_H1, S_H2 in the smooth form, of floats, arrays or casadi scalars.

    within: the range of K_v, of `load_factors.RANGES`; ValueError for another word. The pair has
    to be one that `refusals` does not name.
    """
    if within not in RANGES:
        raise ValueError(f"no range {within!r}; known: {', '.join(RANGES)}")
    check(replace(practice, backup=(None, None)))  # whose ratios may be no numbers here
    values = quantities(Case(pair, operation, materials, practice, given or {}, within))
    (b1, b2), (c1, c2) = (
        [a / b for a, b in zip(values[strong], values[stress], strict=True)]
        for strong, stress in (("sigma_FG", "sigma_F"), ("sigma_HG", "sigma_H"))
    )
    return b1, b2, c1, c2


def smooth_error(
    pair: GearPair,
    operation: Operation,
    materials: tuple[Material, Material],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> tuple[float, ...]:
    """Return S_F1, S_F2, S_H1, S_H2 of the smooth form less the exact ones, relative to these.

    Of floats. Positive: the smooth form is optimistic.
    """
    practice = practice or Practice()
    case = Case(pair, operation, materials, practice, given or {})
    exact = rate_rows(pair, operation, materials, practice, given)
    smooth = smooth_safeties(pair, operation, materials, practice, range_of(case), given)
    known = (*exact.bending, *exact.contact)
    return tuple(float(a / b) - 1.0 for a, b in zip(smooth, known, strict=True))
