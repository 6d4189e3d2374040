"""The data of a rating by AGMA 2001-D04, and every factor with its clause."""

import math
from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.agma import allowables, factors, life
from gearopt.physics.agma.refusals import GeometryFactors, single_factors
from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, GearPair, is_internal
from gearopt.physics.rating import Factor, Operation

SURFACE_HARD_KINDS = ("carburised", "nitrided")  # whose pinions count as 48 HRC and more
EDITIONS = ("D04", "B88")
BEYOND = "beyond the curve"  # how the remark begins on a K_v of a speed that has none
PAIRED = ("K_B", "K_s", "J", "s_at", "s_ac", "Y_N", "Z_N", "C_H")  # one value for each gear
SHARING = "K_gamma"  # mesh load factor of planets, which AGMA has not: given alone, beside K_o
SHARED = ("K_o", "K_v", "K_m", "K_R", "K_T", "C_f", "C_p", "I")


@dataclass(frozen=True)
class Steel:
    """A gear's material: treatment of `allowables.TREATMENTS`, grade, hardness.

    hardness [HB]: of through-hardened steel, of the core of nitrided steel; of a wheel against a
    surface hardened pinion its own. surface: as in `allowables.CONTACT`; modulus E [MPa], poisson
    nu; finish R_a [mm] of the flanks; reversed_load: for idlers, s_at times 0.7. allowables: its
    own s_ac and s_at [MPa], 0: those of the tables.
    """

    treatment: str = "through-hardened"
    grade: int = 1
    hardness: float = 0.0
    surface: str = ""
    modulus: float = 206000.0
    poisson: float = 0.3
    finish: float = 0.8e-3
    reversed_load: bool = False
    allowables: tuple[float, float] = (0.0, 0.0)

    @property
    def kind(self) -> str:
        """Kind of its life curves, one of `life.KINDS`."""
        return allowables.CURVES.get(self.treatment, "carburised")


@dataclass(frozen=True)
class Practice:
    """What AGMA 2101 asks for beside geometry and load: quality, mounting, crowning, rims, service.

    quality Q_v; curve, crowned, offset, adjusted: of `factors.load_distribution_factor`; backup:
    ratios m_B of both rims, or None for solid blanks; size: whether K_s is Shigley's; service: of
    `life.SERVICES`; load: of `bending.LOADS`; edition: of EDITIONS.
    """

    quality: float = 6.0
    curve: str = "commercial"
    crowned: bool = False
    offset: float = 0.0
    adjusted: bool = False
    backup: tuple[float | None, float | None] = (None, None)
    size: bool = False
    service: str = "general"
    load: str = "highest single"
    edition: str = "D04"


@dataclass(frozen=True)
class Case:
    """Data that the factors are computed from."""

    pair: GearPair
    operation: Operation
    steels: tuple[Steel, Steel]
    practice: Practice
    given: Mapping[str, Any] = field(default_factory=dict)

    @property
    def diameter(self) -> Any:
        """Working pitch diameter of the pinion [mm]."""
        return self.pair.working_diameters[0]

    @property
    def speed(self) -> Any:
        """Pitch line velocity [mm/s]."""
        return 0.5 * self.operation.pinion_speed * self.diameter

    @cached_property
    def geometry(self) -> GeometryFactors:
        """I and J of AGMA 908; ValueError where it refuses the pair."""
        return single_factors(self.pair, self.practice.load)

    @property
    def cycles(self) -> tuple[Any, Any]:
        """Stress cycles of pinion and wheel."""
        rpm = self.operation.pinion_speed * 30.0 / math.pi
        first, second = self.operation.contacts
        hours = self.operation.hours
        wheel = life.cycles_of(hours, rpm / abs(self.pair.ratio), second)
        return life.cycles_of(hours, rpm, first), wheel


def value(case: Case, symbol: str) -> Any:
    """Value of a factor of _LAWS, given or by its law: of floats, arrays or casadi scalars."""
    given = case.given.get(symbol)
    return _LAWS[symbol](case) if given is None else given


def distribution(practice: Practice, width: Any, diameter: Any) -> Any:
    """K_m of a face width and the working pitch diameter of the pinion [mm]."""
    made = practice.curve, practice.crowned, practice.offset, practice.adjusted
    return factors.load_distribution_factor(width, diameter, *made)


def _sizes(case: Case) -> tuple[Any, Any]:
    if not case.practice.size:
        return 1.0, 1.0
    first, second = (
        factors.size_factor(
            gear.face_width, gear.reference_diameter / gear.teeth, factors.lewis_form(gear.teeth)
        )
        for gear in case.pair.gears
    )
    return first, second


def ring_backup(gear: Gear) -> Any:
    """Return m_B of a ring, whose rim ends at its outside."""
    return (gear.root_diameter - gear.outside) / (gear.tip_diameter - gear.root_diameter)


@np.errstate(invalid="ignore", divide="ignore")  # NaN of a ring without a rim
def _rims(case: Case) -> tuple[Any, Any]:
    law = factors.rim_factor if case.practice.edition == "D04" else factors.rim_factor_b88
    first, second = (1.0 if ratio is None else law(ratio) for ratio in case.practice.backup)
    wheel = case.pair.wheel
    if is_internal(wheel.teeth):
        second = choose(np.less(wheel.teeth, 0.0), law(ring_backup(wheel)), second)
    return first, second


def _life_factors(case: Case, contact: bool) -> tuple[Any, Any]:
    (pinion, wheel), (first, second) = life_curves(case, contact), case.cycles
    return pinion.factor(first), wheel.factor(second)


def _hardness_ratios(case: Case) -> tuple[Any, Any]:
    pinion, wheel = case.steels
    if wheel.kind != "through-hardened" or unknown_hardness(pinion) or unknown_hardness(wheel):
        return 1.0, 1.0
    if pinion.kind in SURFACE_HARD_KINDS:
        return 1.0, factors.surface_hardened_factor(pinion.finish, wheel.hardness)
    ratio = abs(case.pair.ratio)
    return 1.0, factors.hardness_ratio_factor(pinion.hardness, wheel.hardness, ratio)


_LAWS = {
    "K_v": lambda case: factors.dynamic_factor(case.speed, case.practice.quality),
    "K_m": lambda case: distribution(case.practice, case.pair.face_width, case.diameter),
    "K_s": _sizes,
    "K_B": _rims,
    "Y_N": lambda case: _life_factors(case, False),
    "Z_N": lambda case: _life_factors(case, True),
    "C_H": _hardness_ratios,
}


def all_factors(case: Case) -> list[Factor]:
    """Return all factors of a case, given ones in the place of computed ones; SHARING if given."""
    shown = [SHARING] if SHARING in case.given else []
    return [computed(case, symbol) for symbol in (SHARED[0], *shown, *SHARED[1:], *PAIRED)]


def computed(case: Case, symbol: str) -> Factor:
    """Return a factor of a case by its symbol, of SHARED or PAIRED; as it is given, if it is."""
    if symbol in case.given:
        return Factor(symbol, case.given[symbol], "given")
    return _COMPUTED[symbol](case)


def _dynamic(case: Case) -> Factor:
    most = float(factors.highest_speed(case.practice.quality))
    remark = "" if case.speed <= most else f"{BEYOND}, which ends at {1e-3 * most:.1f} m/s"
    return Factor("K_v", float(value(case, "K_v")), "2001-D04, 8", remark=remark)


def _distribution(case: Case) -> Factor:
    width, remark = case.pair.face_width, ""
    if width > factors.WIDEST:
        remark = f"face widths up to {factors.WIDEST:.0f} mm"
    elif width > 2.0 * case.diameter:
        remark = "face widths up to 2 pinion diameters"
    return Factor("K_m", float(value(case, "K_m")), "2001-D04, 15", remark=remark)


def _reliability(case: Case) -> Factor:
    wanted = case.operation.reliability
    if wanted in factors.RELIABILITY:
        return Factor("K_R", factors.RELIABILITY[wanted], "2001-D04, 18, table 11")
    if not 0.5 <= wanted <= 0.9999:
        raise ValueError(f"no K_R of a reliability of {wanted:g}: 0.5 to 0.9999")
    return Factor("K_R", float(factors.reliability_factor(wanted)), "fit of 2001-D04, table 11")


def _temperature(case: Case) -> Factor:
    celsius = case.operation.temperature_C
    value = float(factors.temperature_factor(celsius))
    if celsius <= factors.WARM:
        return Factor("K_T", value, "2001-D04, 19")
    remark = f"above {factors.WARM:g} °C the standard has no value"
    return Factor("K_T", value, "customary", "", False, remark)


def _elastic(case: Case) -> Factor:
    moduli = [number for steel in case.steels for number in (steel.modulus, steel.poisson)]
    return Factor("C_p", float(factors.elastic_coefficient(*moduli)), "2001-D04, 12", "sqrt(MPa)")


def _pitting(case: Case) -> Factor:
    return Factor("I", float(case.geometry.pitting), "908-B89, 4", "", *_of_helix(case))


def _bending(case: Case) -> Factor:
    first, second = case.geometry.bending
    return Factor("J", (float(first), float(second)), "908-B89, 5", "", *_of_helix(case))


def _of_helix(case: Case) -> tuple[bool, str]:
    """Whether published values confirm I and J, and the remark on it."""
    if is_internal(case.pair.wheel_teeth):
        return False, "internal: AGMA 908 has external gears only, no published value"
    if case.pair.overlap_ratio == 0.0:
        return True, ""
    return False, "helical: two sources have the method, no published table confirms its values"


def _rim(case: Case) -> Factor:
    ratios, sound, wheel = case.practice.backup, True, case.pair.wheel
    if is_internal(wheel.teeth):
        ratios, sound = (ratios[0], ring_backup(wheel)), False
    thinnest = min(math.inf if ratio is None else ratio for ratio in ratios)
    if thinnest <= 0.0:
        raise ValueError(f"no K_B of a backup ratio of {thinnest:g}: above 0")
    remark = "" if sound else "of the ring: the law of external rims"
    remark = remark if thinnest >= factors.THINNEST else "rims thinner than the chart has"
    clause = f"2001-{case.practice.edition}, annex B"
    return Factor("K_B", _floats(_rims(case)), clause, "", sound, remark)


def _size(case: Case) -> Factor:
    clause = "Shigley, eq. 14-10" if case.practice.size else "2001-D04, 20"
    return Factor("K_s", _floats(_sizes(case)), clause)


def _floats(both: tuple[Any, Any]) -> tuple[float, float]:
    return float(both[0]), float(both[1])


def unknown_hardness(steel: Steel) -> bool:
    """Return whether a hardness that matters is missing: strengths may be given without one."""
    return steel.kind == "through-hardened" and not steel.hardness > 0.0


def _strength(case: Case, contact: bool) -> Factor:
    """Return s_ac or s_at of both gears."""
    made = []
    for steel in case.steels:
        if stress := steel.allowables[not contact]:
            made.append(allowables.Allowable(stress, "given with the gear", True))
        elif case.practice.edition == "B88" and steel.treatment == "through-hardened":
            old = allowables.contact_allowable_b88 if contact else allowables.bending_allowable_b88
            made.append(old(steel.grade, steel.hardness))
        elif contact:
            kind = steel.treatment, steel.grade, steel.hardness, steel.surface
            made.append(allowables.contact_allowable(*kind))
        else:
            made.append(allowables.bending_allowable(steel.treatment, steel.grade, steel.hardness))
    used = [
        1.0 if contact or not steel.reversed_load else allowables.REVERSED for steel in case.steels
    ]
    first, second = (a.stress * u for a, u in zip(made, used, strict=True))
    remark = "" if all(a.within for a in made) else "hardness outside the range of its line"
    sources = "; ".join(dict.fromkeys(a.source for a in made))
    verified = all(a.verified and a.within for a in made)
    return Factor("s_ac" if contact else "s_at", (first, second), sources, "MPa", verified, remark)


def _cycle_factor(case: Case, contact: bool) -> Factor:
    remark = "" if max(case.cycles) <= life.LONGEST_LIFE else f"beyond {life.LONGEST_LIFE:g} cycles"
    if not contact and any(unknown_hardness(steel) for steel in case.steels):
        remark = remark or f"no hardness: curve of {min(life.BENDING):g} HB"
    symbol = "Z_N" if contact else "Y_N"
    induction = not contact and any(s.treatment.startswith("induction") for s in case.steels)
    if any(s.kind == "iron" for s in case.steels):
        induction, remark = True, remark or "iron by the lowest curve of steel"
    made = _floats(_life_factors(case, contact))
    return Factor(symbol, made, "2001-D04, 17", "", not induction, remark)


def check_lives(given: Mapping[str, Any]) -> None:
    """Refuse life factors that are given for a spectrum, by ValueError."""
    if {"Y_N", "Z_N"} & set(given):
        raise ValueError("Y_N and Z_N follow from the levels of a spectrum and cannot be given")


def life_curves(case: Case, contact: bool) -> tuple[life.Curve, life.Curve]:
    """Return the life curves of pinion and wheel, of contact or of bending."""
    service = case.practice.service
    first, second = (
        life.pitting_curve(steel.kind, service)
        if contact
        else life.bending_curve(steel.kind, steel.hardness, service)
        for steel in case.steels
    )
    return first, second


def _hardness_ratio(case: Case) -> Factor:
    pinion, wheel = case.steels
    clause, remark, made = "2001-D04, 14", "", _floats(_hardness_ratios(case))
    if wheel.kind != "through-hardened":
        return Factor("C_H", made, clause)
    if unknown_hardness(pinion) or unknown_hardness(wheel):
        return Factor("C_H", made, clause, remark="1: no hardness")
    (low, high), most = factors.WHEELS, factors.LARGEST_RATIO
    if pinion.kind in SURFACE_HARD_KINDS:
        remark = "" if low <= wheel.hardness <= high else f"wheels of {low:g} to {high:g} HB"
    elif abs(case.pair.ratio) > most and made[1] > 1.0:
        remark = f"that of a ratio of {most:g}, where the chart ends"
    return Factor("C_H", made, clause, "", not remark, remark)


_COMPUTED = {
    "K_o": lambda case: Factor("K_o", case.operation.overload, "2001-D04, 9"),
    "K_v": _dynamic,
    "K_m": _distribution,
    "K_R": _reliability,
    "K_T": _temperature,
    "C_f": lambda case: Factor("C_f", 1.0, "2001-D04, 13"),
    "C_p": _elastic,
    "I": _pitting,
    "K_B": _rim,
    "K_s": _size,
    "J": _bending,
    "s_at": lambda case: _strength(case, False),
    "s_ac": lambda case: _strength(case, True),
    "Y_N": lambda case: _cycle_factor(case, False),
    "Z_N": lambda case: _cycle_factor(case, True),
    "C_H": _hardness_ratio,
}
