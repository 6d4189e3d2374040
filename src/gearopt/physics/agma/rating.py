"""The rating of one gear pair by AGMA 2001-D04: stresses, safety factors, lives, governing one.

Of floats. What is given replaces what is computed, factor by factor.
"""

from collections.abc import Mapping
from typing import Any

from gearopt.physics.agma import stress
from gearopt.physics.agma.rating_factors import (
    EDITIONS,
    PAIRED,
    SHARED,
    SHARING,
    Case,
    Practice,
    Steel,
    all_factors,
    check_lives,
    life_curves,
)
from gearopt.physics.agma.refusals import check_teeth
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import (
    Factor,
    Level,
    Operation,
    Rating,
    Spectrum,
    check_numbers,
    check_symbols,
    damage,
    governing,
    spectrum_safety,
)


def rate(
    pair: GearPair,
    operation: Operation,
    steels: tuple[Steel, Steel],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Rating:
    """Return the rating of a pair.

    given: factors by symbol, of PAIRED as pairs, else as numbers; s_at and s_ac in MPa, C_p in
    sqrt(MPa). ValueError for a pair that AGMA 908 refuses (unless I and J are given), a symbol that
    is not known, a power, speed, K_o or given factor that is not above 0, and what the laws refuse.
    """
    practice, given = practice or Practice(), dict(given or {})
    check_symbols(given, (*SHARED, SHARING, *PAIRED))
    if practice.edition not in EDITIONS:
        raise ValueError(f"no edition {practice.edition!r}; known: {', '.join(EDITIONS)}")
    check_numbers(operation, "overload factor", given)
    check_teeth(pair)
    case = Case(pair, operation, steels, practice, given)
    return _results(case, {factor.symbol: factor for factor in all_factors(case)})


def _results(case: Case, found: dict[str, Factor]) -> Rating:
    """Return stresses, safety factors and lives of the factors."""
    one: dict[str, Any] = {symbol: factor.value for symbol, factor in found.items()}
    power, speed = case.operation.power, case.operation.pinion_speed
    diameter = float(case.diameter)
    load = stress.tangential_load(power, speed, diameter)
    width, weaker = case.pair.face_width, (one["K_T"], one["K_R"])
    transverse = case.pair.pinion.reference_diameter / case.pair.pinion_teeth
    bent, pressed, s_f, s_h = [], [], [], []
    overload = one["K_o"] * one.get(SHARING, 1.0)
    for k in (0, 1):
        product = overload * one["K_v"] * one["K_m"] * one["K_s"][k]
        of_rim = product * one["K_B"][k]
        bent.append(float(stress.bending_stress(load, width, transverse, one["J"][k], of_rim)))
        own = one["C_p"], load, width, diameter, one["I"], product * one["C_f"]
        pressed.append(float(stress.contact_stress(*own)))
        s_f.append(stress.bending_safety(one["s_at"][k], one["Y_N"][k], *weaker, bent[k]))
        strong = one["s_ac"][k], one["Z_N"][k], one["C_H"][k]
        s_h.append(stress.contact_safety(*strong, *weaker, pressed[k]))
    bending, contact = (life_curves(case, mode) for mode in (False, True))
    y_n, z_n = ([float(c[k].factor(case.cycles[k])) for k in (0, 1)] for c in (bending, contact))
    lives_f = [float(stress.bending_life(bending[k], y_n[k], s_f[k])) for k in (0, 1)]
    lives_h = [float(stress.contact_life(contact[k], z_n[k], s_h[k])) for k in (0, 1)]
    least, governs = governing(s_f, s_h)
    return Rating(
        found,
        float(load),
        float(case.speed),
        (bent[0], bent[1]),
        (pressed[0], pressed[1]),
        (s_f[0], s_f[1]),
        (s_h[0], s_h[1]),
        case.cycles,
        (lives_f[0], lives_f[1]),
        (lives_h[0], lives_h[1]),
        power * least,
        governs,
    )


def rate_spectrum(
    pair: GearPair,
    operations: tuple[Operation, ...],
    steels: tuple[Steel, Steel],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Spectrum:
    """Return the rating of a pair under levels of load, each with its hours, speed and power.

    Temperature and reliability enter each level's strength; Y_N and Z_N may not be given
    (ValueError). One level gives what `rate` gives. Source: Palmgren and Miner.
    """
    check_lives(given or {})
    practice = practice or Practice()
    levels = tuple(rate(pair, one, steels, practice, given) for one in operations)
    case = Case(pair, operations[0], steels, practice)
    bent = [_miner(case, levels, k, False) for k in (0, 1)]
    pressed = [_miner(case, levels, k, True) for k in (0, 1)]
    return Spectrum(
        levels,
        (bent[0][0], bent[1][0]),
        (pressed[0][0], pressed[1][0]),
        (bent[0][1], bent[1][1]),
        (pressed[0][1], pressed[1][1]),
    )


def _miner(
    case: Case, levels: tuple[Rating, ...], member: int, contact: bool
) -> tuple[float, float]:
    """Return Miner's sum and the safety factor of one gear."""
    curve = life_curves(case, contact)[member]
    loads = []
    for level in levels:  # the cycle factor at which a safety factor is 1
        safety = (level.contact_safety if contact else level.bending_safety)[member]
        value: Any = level.factors["Z_N" if contact else "Y_N"].value
        loads.append(Level(level.cycles[member], curve, value[member] / safety))
    return float(damage(loads)), float(spectrum_safety(loads))
