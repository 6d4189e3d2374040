"""Many ratings by AGMA 2001 at once, and the smooth form: of arrays or of casadi scalars.

The laws are those of `rating`, factor by factor; I and J come from `refusals.geometry_factors`, a
table of them, or the smooth form.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearopt.physics.agma import stress
from gearopt.physics.agma.rating_factors import (
    SHARING,
    Case,
    Practice,
    Steel,
    check_lives,
    computed,
    life_curves,
    value,
)
from gearopt.physics.agma.refusals import GeometryFactors, geometry_factors
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import Level, Operation, Ratings, spectrum_safety

MODES = (False, 0), (False, 1), (True, 0), (True, 1)  # contact, member: order of safety factors
CONSTANT = ("K_o", "K_R", "K_T", "C_f", "C_p", "s_at", "s_ac")  # of all pairs of a batch


def rate_rows(
    pair: GearPair,
    operation: Operation,
    steels: tuple[Steel, Steel],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Ratings:
    """Return the safety factors of a pair and an operation of arrays, one shape each or floats.

    given: as of `rating.rate`. Row by row the same as `rating.rate`, but that pairs without I and J
    have a refusal, unless both are given. ValueError for words and steels.
    """
    practice, given = practice or Practice(), given or {}
    geometry = _geometry(pair, practice, given)
    case = Case(pair, operation, steels, practice, given)
    safety = safeties(case, geometry.pitting, geometry.bending)
    return Ratings((safety[0], safety[1]), (safety[2], safety[3]), geometry.refusal)


def _geometry(pair: GearPair, practice: Practice, given: Mapping[str, Any]) -> GeometryFactors:
    """Return I and J, given ones without a refusal."""
    if {"I", "J"} <= set(given):
        return GeometryFactors(given["I"], given["J"], np.zeros(np.shape(pair.ratio)))
    return geometry_factors(pair, practice.load)


def safeties(case: Case, pitting: Any, bending: tuple[Any, Any]) -> tuple[Any, Any, Any, Any]:
    """Return S_F1, S_F2, S_H1, S_H2 of a case of floats, arrays or casadi scalars with I and J.

    Those that are given come first.
    """
    given = case.given
    pitting, bending = given.get("I", pitting), given.get("J", bending)
    one: dict[str, Any] = {symbol: computed(case, symbol).value for symbol in CONSTANT}
    diameter, operation = case.diameter, case.operation
    load = stress.tangential_load(operation.power, operation.pinion_speed, diameter)
    overload = one["K_o"] * given.get(SHARING, 1.0)
    shared = overload * (value(case, "K_v") * value(case, "K_m"))
    size, rim = value(case, "K_s"), value(case, "K_B")
    strong_f, strong_h = _strengths(case, one)
    width = case.pair.face_width
    transverse = case.pair.pinion.reference_diameter / case.pair.pinion_teeth
    found = []
    for k in (0, 1):
        used = stress.bending_stress(load, width, transverse, bending[k], shared * size[k] * rim[k])
        found.append(strong_f[k] / used)
    for k in (0, 1):
        used = stress.contact_stress(
            one["C_p"], load, width, diameter, pitting, shared * size[k] * one["C_f"]
        )
        found.append(strong_h[k] / used)
    return found[0], found[1], found[2], found[3]


def spectrum_rows(
    pair: GearPair,
    operations: Sequence[Operation],
    steels: tuple[Steel, Steel],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Ratings:
    """Return the safety factors under levels of load, of arrays of one shape each or floats.

    Row by row the same as `rating.rate_spectrum`; refusals and ValueError as of `rate_rows`, and
    ValueError for life factors that are given.
    """
    practice, given = practice or Practice(), given or {}
    geometry = _geometry(pair, practice, given)
    cases = [Case(pair, one, steels, practice, given) for one in operations]
    safety = spectrum_safeties(cases, geometry.pitting, geometry.bending)
    return Ratings((safety[0], safety[1]), (safety[2], safety[3]), geometry.refusal)


def spectrum_safeties(
    cases: Sequence[Case], pitting: Any, bending: tuple[Any, Any]
) -> tuple[Any, Any, Any, Any]:
    """Return S_F1, S_F2, S_H1, S_H2 under levels of load with I and J, of floats or arrays."""
    check_lives(cases[0].given)
    made = [safeties(case, pitting, bending) for case in cases]
    found = []
    for place, (contact, k) in enumerate(MODES):
        curve = life_curves(cases[0], contact)[k]
        cycles = [case.cycles[k] for case in cases]
        levels = [  # stress: the cycle factor at which a safety factor is 1
            Level(n, curve, curve.factor(n) / one[place])
            for n, one in zip(cycles, made, strict=True)
        ]
        found.append(spectrum_safety(levels))
    return found[0], found[1], found[2], found[3]


def _strengths(case: Case, one: Mapping[str, Any]) -> tuple[list[Any], list[Any]]:
    """Return s_at Y_N/(K_T K_R) and s_ac Z_N C_H/(K_T K_R) of pinion and wheel [MPa].

    one: constant factors by symbol.
    """
    weaker = one["K_T"] * one["K_R"]
    ratios = value(case, "C_H")
    made: list[list[Any]] = []
    for contact in (False, True):
        life = value(case, "Z_N" if contact else "Y_N")
        strong = one["s_ac" if contact else "s_at"]
        made.append([strong[k] * life[k] / weaker for k in (0, 1)])
    return made[0], [made[1][k] * ratios[k] for k in (0, 1)]
