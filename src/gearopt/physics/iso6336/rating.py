"""The rating of one gear pair by ISO 6336: stresses, safety factors, lives, governing one.

Of floats. What is given replaces what is computed, factor by factor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336 import chain
from gearopt.physics.iso6336.case import Case, Practice, check, check_rim
from gearopt.physics.iso6336.curves import Curve
from gearopt.physics.iso6336.factors import PAIRED, SHARED, factors
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.refusals import refuse
from gearopt.physics.rating import (
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

LIVES = ("Z_NT", "Y_NT")
ZERO = ("f_pb", "f_falpha", "f_ma", "C_a")  # deviations that may be given as 0


def rate(
    pair: GearPair,
    operation: Operation,
    materials: tuple[Material, Material],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Rating:
    """Return the rating of a pair.

    given: factors by symbol, of PAIRED as pairs, of SHARED as numbers, in mm and MPa. ValueError
    for a pair that `refusals` names, a symbol or word that is not known, a power, speed, K_A or
    given factor that is not above 0, and a strength that lacks its hardness.
    """
    case = _case(pair, operation, materials, practice, given)
    return _results(case, chain.quantities(case))


def _case(
    pair: GearPair,
    operation: Operation,
    materials: tuple[Material, Material],
    practice: Practice | None,
    given: Mapping[str, Any] | None,
) -> Case:
    """Return the case of a rating, checked."""
    practice, given = practice or Practice(), dict(given or {})
    check_symbols(given, (*SHARED, *PAIRED))
    check(practice)
    positive = {name: value for name, value in given.items() if name not in ZERO}
    check_numbers(operation, "application factor", positive)
    refuse(pair, practice)
    if "Y_B" not in given:
        check_rim(pair)
    return Case(pair, operation, materials, practice, given)


def _results(case: Case, found: dict[str, Any]) -> Rating:
    """Return stresses, safety factors and lives of all quantities."""
    bent, pressed = (_two(found[name]) for name in ("sigma_F", "sigma_H"))
    strong_f, strong_h = (_two(found[name]) for name in ("sigma_FG", "sigma_HG"))
    s_f = strong_f[0] / bent[0], strong_f[1] / bent[1]
    s_h = strong_h[0] / pressed[0], strong_h[1] / pressed[1]
    lives = [
        [float(strength_curve(case, found, k, contact).life(stress[k])) for k in (0, 1)]
        for contact, stress in ((False, bent), (True, pressed))
    ]
    least, governs = governing(s_f, s_h)
    return Rating(
        factors(case, found),
        float(case.load),
        float(case.speed),
        bent,
        pressed,
        s_f,
        s_h,
        _two(case.cycles),
        (lives[0][0], lives[0][1]),
        (lives[1][0], lives[1][1]),
        float(case.operation.power) * least,
        governs,
    )


def _two(value: Any) -> tuple[float, float]:
    first, second = value
    return float(first), float(second)


def strength_curve(case: Case, found: dict[str, Any], member: int, contact: bool) -> Curve:
    """Return sigma_HG or sigma_FG of a gear over its number of cycles [MPa], of floats or arrays.

    It passes through the strength that was found at N_L, whatever was given for it.
    """
    symbol = "sigma_HG" if contact else "sigma_FG"
    curve = case.curve(member, contact)
    values = [_strength_at(case, found, member, contact, n) for n in curve.cycles]
    bare = Curve(curve.cycles, tuple(values))
    scale = found[symbol][member] / bare.factor(case.cycles[member])
    return Curve(curve.cycles, tuple(scale * value for value in values))


def _strength_at(
    case: Case, found: dict[str, Any], member: int, contact: bool, cycles: float
) -> Any:
    """Return the strength [MPa] of a gear at another number of cycles."""
    hours = float(case.operation.hours) if case.operation.hours > 0.0 else 1.0
    one = replace(case, operation=replace(case.operation, hours=hours))
    hours = hours * cycles / one.cycles[member]
    other = replace(case, operation=replace(case.operation, hours=hours))
    return chain.strength_of(other, found, contact)[member]


def rate_spectrum(
    pair: GearPair,
    operations: tuple[Operation, ...],
    materials: tuple[Material, Material],
    practice: Practice | None = None,
    given: Mapping[str, Any] | None = None,
) -> Spectrum:
    """Return the rating of a pair under levels of load, each with its hours, speed and power.

    Load factors are those of each level, K_v and K_Hbeta by its own load. Z_NT and Y_NT may not be
    given (ValueError). One level gives what `rate` gives. Source: ISO 6336-6 (its annex C
    confirms the sum for contact; of bending unverified); Palmgren and Miner.
    """
    check_lives(given or {})
    cases = [_case(pair, one, materials, practice, given) for one in operations]
    found = [chain.quantities(case) for case in cases]
    sums = {}
    for contact in (False, True):
        for k in (0, 1):
            levels = levels_of(cases, found, k, contact)
            sums[contact, k] = float(damage(levels)), float(spectrum_safety(levels))
    return Spectrum(
        tuple(_results(case, one) for case, one in zip(cases, found, strict=True)),
        (sums[False, 0][0], sums[False, 1][0]),
        (sums[True, 0][0], sums[True, 1][0]),
        (sums[False, 0][1], sums[False, 1][1]),
        (sums[True, 0][1], sums[True, 1][1]),
    )


def check_lives(given: Mapping[str, Any]) -> None:
    """Refuse life factors that are given for a spectrum, by ValueError."""
    if set(LIVES) & set(given):
        raise ValueError("Y_NT and Z_NT follow from the levels of a spectrum and cannot be given")


def levels_of(
    cases: Sequence[Case], found: Sequence[dict[str, Any]], member: int, contact: bool
) -> list[Level]:
    """Return the levels of load of a gear, of floats or arrays; found: quantities of the cases."""
    symbol = "sigma_H" if contact else "sigma_F"
    return [
        Level(case.cycles[member], strength_curve(case, one, member, contact), one[symbol][member])
        for case, one in zip(cases, found, strict=True)
    ]
