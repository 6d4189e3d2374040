"""The factors of a rating by ISO 6336 with clause and method, unit, doubts."""

import math
from collections.abc import Callable
from typing import Any

from gearopt.physics.gears import is_internal
from gearopt.physics.iso6336.accuracy import beyond
from gearopt.physics.iso6336.bending_factors import THICK_RING
from gearopt.physics.iso6336.case import Case, ring_rim
from gearopt.physics.iso6336.chain import shaft_misalignment, shared
from gearopt.physics.iso6336.contact_factors import HARD_LIMIT
from gearopt.physics.iso6336.curves import LONGEST_LIFE
from gearopt.physics.iso6336.load_factors import MAIN, lower_limit
from gearopt.physics.iso6336.materials import Material, strength
from gearopt.physics.iso6336.running_in import CAST, SLOW, TEMPERED
from gearopt.physics.iso6336.stiffness import LEAST_LINE_LOAD
from gearopt.physics.rating import Factor

Values = dict[str, Any]
SHIFTS = -0.5, 2.0  # x_1 + x_2 for which c' holds. Source: part 1, 9.3 [memory]
# angles above which results want experience. Source: IACS UR M56, 3.1, of parts 2 and 3
PRESSURE_ANGLE, HELIX_ANGLE = math.radians(25.0) + 1e-9, math.radians(30.0) + 1e-9
UNCHECKED = "not checked against any source"
PLANETARY = "method C has no planets on pins, B* of a sun is from memory: better given"
EXPERIENCE = "to be confirmed by experience"
NITROCARBURISED = "NV nitrocarburised"
RANGE = 3000.0  # mm/s of v z1/100 sqrt(u^2/(1 + u^2)): below, K_v by method B is hardly above 1

# symbol: clause and method, unit
CLAUSES = {
    "K_A": ("6336-1, 5, method B", ""),
    "K_gamma": ("6336-1, 5: one mesh", ""),
    "K_v": ("6336-1, 6.5, method B", ""),
    "K_Hbeta": ("6336-1, 7.5, method C", ""),
    "K_Fbeta": ("6336-1, 7.6", ""),
    "K_Halpha": ("6336-1, 8.3, method B", ""),
    "K_Falpha": ("6336-1, 8.3, method B", ""),
    "c_prime": ("6336-1, 9.3, method B", "MPa"),
    "c_gamma_alpha": ("6336-1, 9.3, method B", "MPa"),
    "c_gamma_beta": ("6336-1, 9.3, method B", "MPa"),
    "N": ("6336-1, 6.5, method B", ""),
    "f_pb": ("ISO 1328-1", "mm"),
    "f_falpha": ("ISO 1328-1", "mm"),
    "f_ma": ("6336-1, 7.5, method C", "mm"),
    "C_a": ("6336-1, 6.5", "mm"),
    "Z_H": ("6336-2, 6", ""),
    "Z_E": ("6336-2, 7", "sqrt(MPa)"),
    "Z_eps": ("6336-2, 8", ""),
    "Z_beta": ("6336-2, 9", ""),
    "Y_beta": ("6336-3, 8", ""),
    "Y_DT": ("6336-3, 10", ""),
    "Y_ST": ("6336-3, 5", ""),
    "Z_X": ("6336-2, 14, method B", ""),
    "Z_BD": ("6336-2, 6", ""),
    "Z_NT": ("6336-2, 11, method B", ""),
    "Z_L": ("6336-2, 12, method B", ""),
    "Z_v": ("6336-2, 12, method B", ""),
    "Z_R": ("6336-2, 12, method B", ""),
    "Z_W": ("6336-2, 13, method B", ""),
    "sigma_Hlim": ("6336-5, table 1", "MPa"),
    "Y_F": ("6336-3, 6, method B", ""),
    "Y_S": ("6336-3, 7, method B", ""),
    "Y_B": ("6336-3, 9, method B", ""),
    "Y_NT": ("6336-3, 12, method B", ""),
    "Y_deltarelT": ("6336-3, 13, method B", ""),
    "Y_RrelT": ("6336-3, 14, method B", ""),
    "Y_X": ("6336-3, 15, method B", ""),
    "Y_M": ("6336-5, 5.3", ""),
    "sigma_Flim": ("6336-5, table 1", "MPa"),
}
PAIRED = tuple(CLAUSES)[list(CLAUSES).index("Z_BD") :]  # one value for each gear
SHARED = tuple(CLAUSES)[: list(CLAUSES).index("Z_BD")]


def factors(case: Case, values: Values) -> dict[str, Factor]:
    """Return the factors of the quantities of a chain, by symbol."""
    table = {}
    for symbol, (clause, unit) in CLAUSES.items():
        value = _plain(values[symbol], symbol in PAIRED)
        if symbol in case.given:
            table[symbol] = Factor(symbol, value, "given", unit)
            continue
        verified, remark = DOUBTS.get(symbol, _none)(case, values)
        if clause.startswith("ISO 1328-1"):
            clause = f"{clause}:{case.practice.tolerances}"
        elif not clause.startswith("6336-5"):
            clause = clause.replace(",", f":{case.practice.edition},", 1)
        table[symbol] = Factor(symbol, value, clause, unit, verified, remark)
    return table


def _plain(value: Any, paired: bool) -> float | tuple[float, float]:
    if not paired:
        return float(value)
    first, second = value if isinstance(value, tuple | list) else (value, value)
    return float(first), float(second)


Doubt = tuple[bool, str]


def _none(case: Case, values: Values) -> Doubt:
    return True, ""


def _of_2019(case: Case, what: str) -> Doubt:
    """Doubts of factors that only the edition of 2019 has."""
    return (
        (False, f"{what} of 2019: {UNCHECKED}") if case.practice.edition == "2019" else (True, "")
    )


def _stiffness(case: Case, values: Values) -> Doubt:
    line = case.load * values["K_A"] * values["K_gamma"] / case.pair.face_width
    if line < LEAST_LINE_LOAD:
        return False, f"below 100 N/mm: formula {UNCHECKED}"
    shifts = sum(gear.profile_shift for gear in case.pair.gears)
    if not SHIFTS[0] <= shifts <= SHIFTS[1]:
        return False, "x_1 + x_2 outside -0.5 to 2: beyond the range of c'"
    return True, ""


def _ring(case: Case) -> bool:
    """Return whether the wheel of a case is a ring."""
    return is_internal(case.pair.wheel_teeth)


def _resonance(case: Case, values: Values) -> Doubt:
    sound, remark = _stiffness(case, values)
    meshes = case.practice.meshes
    if sound and _ring(case) and (meshes is None or meshes[1] > 0.0):
        return False, f"mass of a ring that turns: {UNCHECKED}"
    return sound, remark


def _rim(case: Case, values: Values) -> Doubt:
    if not _ring(case):
        return True, ""
    if ring_rim(case.pair.wheel) < THICK_RING:
        return False, f"rim of a ring below {THICK_RING:g} m_n: formula {UNCHECKED}"
    assumed = case.pair.wheel.outside_diameter is None
    return True, f"rim of the ring of {THICK_RING:g} m_n taken for granted" if assumed else ""


def _sharing(case: Case, values: Values) -> Doubt:
    """Doubts of K_gamma = 1, which is of one mesh."""
    if case.practice.meshes is None:
        return True, ""
    return False, "1 takes for granted that all planets carry alike: give K_gamma"


def _tolerance(case: Case, values: Values) -> Doubt:
    outside = beyond(case.pair, case.practice.grades, case.practice.tolerances)
    return not outside, f"{', '.join(outside)} outside ISO 1328-1" if outside else ""


def _tempered(case: Case) -> bool:
    """Return whether running-in is of a law, or of a limit above 5 m/s, without a second source."""
    fast = case.speed > SLOW
    return any(m.family in CAST or fast and m.family in TEMPERED for m in case.materials)


def _dynamic(case: Case, values: Values) -> Doubt:
    sound, remark = _resonance(case, values)
    line = case.load * values["K_A"] * values["K_gamma"] / case.pair.face_width
    resonance = values["N"]
    if resonance > lower_limit(line):
        name = "main resonance" if resonance <= MAIN else "above the main resonance"
        return False, f"{name}, N = {resonance:.2f}: no published value"
    if _tempered(case):
        return False, f"running-in of these materials: {UNCHECKED}"
    ratio = case.pair.ratio
    travel = case.speed * case.pair.pinion_teeth / 100.0 * (ratio**2 / (1.0 + ratio**2)) ** 0.5
    slow = "slow: below the range where method B is of use" if travel < RANGE else ""
    return sound, remark or slow


def _face(case: Case, values: Values) -> Doubt:
    if (chosen := case.practice.helix_modification) != "none":
        bent = shaft_misalignment(case, values) if "deflection" in chosen else 0.0
        height = 500.0 * (values["f_ma"] + bent)  # that B_1 and B_2 take for granted [memory]
        taken = f", C_beta of {height:.3g} µm taken for granted" * ("crowned" in chosen)
        return False, f"{chosen}{taken}: {UNCHECKED}"
    if case.practice.meshes is not None:
        return False, PLANETARY
    if _ring(case):
        return False, "beside a ring: no published value"
    if case.practice.shaft.offset:
        return False, f"pinion off the middle, K' for s/l below 0.3 (c: 0.5): {UNCHECKED}"
    sound, remark = _stiffness(case, values)
    return sound, remark or (
        "above 2: one end is out of contact" if values["K_Hbeta"] > 2.0 else ""
    )


def _root_face(case: Case, values: Values) -> Doubt:
    return (True, "") if "K_Hbeta" in case.given else _face(case, values)


def _transverse(case: Case, values: Values) -> Doubt:
    if _tempered(case):
        return False, f"running-in of these materials: {UNCHECKED}"
    return _stiffness(case, values)


def _transverse_root(case: Case, values: Values) -> Doubt:
    changed = _of_2019(case, "its limit")
    return _transverse(case, values) if changed[0] else changed


def _form(case: Case, values: Values) -> Doubt:
    light = case.pair.overlap_ratio < 1.0 or case.forms[0].virtual_ratio >= 2.0
    sound, remark = _of_2019(case, "load sharing f_eps") if light else (True, "")
    if _ring(case) and (case.practice.edition == "2019" or case.pair.overlap_ratio > 0.0):
        return False, "helical rings, and rings by the edition of 2019: no published value"
    steep = max(gear.rack.pressure_angle for gear in case.pair.gears) > PRESSURE_ANGLE
    return sound, remark or (f"alpha_n above 25 degrees: {EXPERIENCE}" if steep else "")


def _notch(case: Case, values: Values) -> Doubt:
    off = [f for f in case.forms if not 1.0 <= f.notch < 8.0]
    return True, "q_s outside 1 to 8" if off else ""


def _helix(case: Case, values: Values) -> Doubt:
    steep = abs(case.pair.pinion.helix_angle) > HELIX_ANGLE
    return True, f"beta above 30 degrees: {EXPERIENCE}" if steep else ""


def _single(case: Case, values: Values) -> Doubt:
    overlap, chosen = case.pair.overlap_ratio, case.practice.profile_modification
    if _ring(case) and overlap:
        return _of_2019(case, "f_ZCa beside a ring")
    if not overlap or overlap >= 1.0 and chosen == "none":
        return True, ""
    return _of_2019(case, "f_ZCa of helical gears")


def _both(value: Any) -> tuple[Any, Any]:
    first, second = value if isinstance(value, tuple | list) else (value, value)
    return first, second


def _hardening(case: Case, values: Values) -> Doubt:
    hardening = _both(values["Z_W"])
    if any(value != 1.0 and shared(case, k, True) < 1.0 for k, value in enumerate(hardening)):
        return False, f"short lives: static strength {UNCHECKED}"
    return True, "below 1, where rules of ship classes take 1" if min(hardening) < 1.0 else ""


def _confirmed(material: Material, stress: str) -> bool:
    """Return whether a second source has the line: data.js of waa552, or a printed report."""
    if material.quality == "ME":
        return material.name in ("St", "V carbon", "V alloy")
    return (material.name, material.quality, stress) == ("Eh", "MQ", "H")


def _strength(stress: str) -> Callable[[Case, Values], Doubt]:
    def doubt(case: Case, values: Values) -> Doubt:
        within = all(strength(m, stress).within for m in case.materials)
        known = all(m.own(stress) or _confirmed(m, stress) for m in case.materials)
        remark = "" if within else "hardness outside the range of its line: its end is taken"
        return known, remark or ("" if known else "read from pictures of the table")

    return doubt


def _life(case: Case, values: Values) -> Doubt:
    return True, f"beyond {LONGEST_LIFE:g} cycles" if max(case.cycles) > LONGEST_LIFE else ""


def _slip(case: Case, values: Values) -> Doubt:
    if any(m.family in ("St", "GTS", "GGG", *CAST, NITROCARBURISED) for m in case.materials):
        return False, f"slip layer {UNCHECKED}"
    tempered = [m for m in case.materials if m.family == "V"]
    if any(m.yield_strength <= 0.0 for m in tempered):
        return False, "yield point estimated from hardness"
    off = any(not 500.0 <= m.yield_strength <= 1000.0 for m in tempered)
    return True, "yield point outside 500 to 1000 MPa: its end is taken" if off else ""


def _surface(case: Case, values: Values) -> Doubt:
    if any(m.family in (*CAST, NITROCARBURISED) for m in case.materials):
        return False, f"line of these materials {UNCHECKED}"
    return True, "roughness above 40 µm" if max(m.root for m in case.materials) > 40e-3 else ""


def _lubrication(case: Case, values: Values) -> Doubt:
    between = 850.0 < min(_both(values["sigma_Hlim"])) < HARD_LIMIT
    return True, "sigma_Hlim between 850 MPa and 1200 MPa: no published value" if between else ""


DOUBTS: dict[str, Callable[[Case, Values], Doubt]] = {
    "K_gamma": _sharing,
    **dict.fromkeys(("f_pb", "f_falpha", "f_ma"), _tolerance),
    "c_prime": _stiffness,
    "c_gamma_alpha": _stiffness,
    "c_gamma_beta": _stiffness,
    "N": _resonance,
    "K_v": _dynamic,
    "K_Hbeta": _face,
    "K_Fbeta": _root_face,
    "K_Halpha": _transverse,
    "K_Falpha": _transverse_root,
    "Z_BD": _single,
    "Z_NT": _life,
    "Y_NT": _life,
    "Z_L": _lubrication,
    "Z_v": _lubrication,
    "Z_R": _lubrication,
    "Z_W": _hardening,
    "sigma_Hlim": _strength("H"),
    "sigma_Flim": _strength("F"),
    "Y_B": _rim,
    "Y_F": _form,
    "Y_S": _notch,
    "Y_beta": _helix,
    "Y_deltarelT": _slip,
    "Y_RrelT": _surface,
}
