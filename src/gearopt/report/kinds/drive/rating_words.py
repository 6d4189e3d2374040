"""A rating in sentences and key figures: safe or not, what governs, its symbols in Greek."""

import re
from collections.abc import Sequence
from math import isclose, pi

from gearopt.formulations.drive.rating import DriveRating, GearRating, MeshRating
from gearopt.optimise.result import FEASIBLE, Result
from gearopt.optimise.typed import typed
from gearopt.physics.agma import life as life_curves
from gearopt.physics.mesh_loss import FRICTION_ERROR
from gearopt.report.measures import Measures, rounded
from gearopt.report.section import Tile
from gearopt.report.words import counted, series_of

SAFETY_DIGITS = 4  # of safety factors, capacities and lives, wherever they stand
ROUNDING = 1e-8  # relative; a safety factor so near to a shorter number is that one
FRICTION = (  # `mesh_loss.FRICTION_ERROR`
    f"the error is that of the friction, which may be {100 * FRICTION_ERROR:.0f} % off (unverified)"
)
LONGEST_LIFE = f"{life_curves.LONGEST_LIFE:g} cycles".replace("e+", "e")
AT_ONCE = "fails at once"
MODES = {"bending": "S_F", "contact": "S_H"}
SHORT = {"AGMA": "AGMA", "ISO 6336": "ISO"}  # a standard in a column's head
SYMBOLS = {  # of stresses, by standard
    "AGMA": {
        "bending_stress_MPa": "s_t",
        "permissible_bending_stress_MPa": "s_t",
        "contact_stress_MPa": "s_c",
        "permissible_contact_stress_MPa": "s_c",
    },
    "ISO 6336": {
        "bending_stress_MPa": "sigma_F",
        "permissible_bending_stress_MPa": "sigma_FG",
        "contact_stress_MPa": "sigma_H",
        "permissible_contact_stress_MPa": "sigma_HG",
    },
}
WRITTEN = {  # symbols that differ from their letters
    "c_prime": "c'",
    "c_gamma_alpha": "c_γα",
    "c_gamma_beta": "c_γβ",
    "Z_BD": "Z_B, Z_D",
}
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eps": "ε", "sigma": "σ"}
_SYMBOL = re.compile(r"\b[A-Za-z]{1,5}_\w+")  # a letter or its name, and an index
_NAME = re.compile("|".join(GREEK))
SHOWN_UNITS = {  # units of factors that are shown in others: deviations of flanks, stiffnesses
    **dict.fromkeys(("f_pb", "f_falpha", "f_ma", "C_a"), "um_or_uin"),
    **dict.fromkeys(("c_prime", "c_gamma_alpha", "c_gamma_beta"), "N_per_mm_um"),
}


def rating_of(result: Result) -> DriveRating | None:
    """Return the rating that a design holds; None without one."""
    held = result.design.get("rating")
    found: DriveRating | None = typed(DriveRating, held, "rating") if held else None
    return found


def binding_limit(result: Result) -> str:
    """Return whether given gears are safe, and what governs."""
    found = rating_of(result)
    return _verdict(found) if found else ""


def figures(result: Result) -> str:
    """Return the least safety factor and the power capacity, as the end of a sentence."""
    found = rating_of(result)
    return _figures(found) if found else ""


def warns(result: Result) -> list[str]:
    """Return that an optimum is not safe, which gears do not fit, and flaws."""
    if (found := rating_of(result)) is None:
        return list(result.report.get("misfits", ()))
    unsafe = [] if found.safe_by_all or not result.objective else [sentence_of(found)]
    return [*unsafe, *map(greek, (*found.misfits, *found.flaws))]


def sentence_of(found: DriveRating) -> str:
    """Return whether an optimum is safe, and what governs, in a sentence."""
    return f"{'Safe' if found.safe_by_all else 'Not safe'} by its rating: {_verdict(found)}."


def told(found: DriveRating) -> str:
    """Return the rating of an optimum with its figures; what a warning said is not said again."""
    first = sentence_of(found).rstrip(".") if found.safe_by_all else "Rating"
    return f"{first}{_figures(found)}."


def _verdict(found: DriveRating) -> str:
    """Return whether the gears fit, what meets the safety factors asked for, and what governs."""
    if found.misfits:
        return f"the gears do not fit; as to strength, {_strength(found)}"
    return _strength(found)


def _strength(found: DriveRating) -> str:
    """Return what meets the safety factors that are asked for and what does not; what governs."""
    if found.met_by_all:
        return f"all safety factors are met{_by_both(found)}; {_governs(found)}"
    short = [(one.by, _short(one)) for one in found.each if not one.met]
    if found.beside is None:
        return short[0][1]
    if len(short) == 2 and short[0][1] == short[1][1]:
        return f"by {short[0][0]} and by {short[1][0]}, {short[0][1]}"
    parts = [f"by {by}, {words}" for by, words in short]
    good = "met" if found.misfits else "safe"
    return "; ".join([*parts, *(f"{good} by {one.by} alone" for one in found.each if one.met)])


def _by_both(found: DriveRating) -> str:
    return "" if found.beside is None else " by " + " and by ".join(o.by for o in found.each)


def _governs(found: DriveRating) -> str:
    """Return what governs by every standard; what is the same once."""
    words = [f"{_governing(one)[0]} governs" for one in found.each]
    if len(set(words)) == 1:
        return f"{words[0]}{' both' * (len(words) > 1)}"
    return of_standards(found, words)


def _short(found: DriveRating) -> str:
    """Return which safety factors of a standard fall short."""
    words = _governing(found)[0]
    short = sum((1.0 + FEASIBLE) * own < asked for _, own, asked in _all(found))
    return (
        f"{words} falls short" if short < 2 else f"{short} safety factors fall short, {words} most"
    )


def _figures(found: DriveRating) -> str:
    """Return least safety factor and power capacity by every standard, and what is asked for."""
    least = [_governing(one)[1:] for one in found.each]
    values = [f"{symbol} {safety(own)}" for symbol, own, _ in least]
    asked = dict.fromkeys(f"{symbol} {asked:g}" for symbol, _, asked in least)
    wanted = f"{least[0][2]:g}" if len(asked) == 1 else " and ".join(asked)
    capacities = [f"{safety(one.power_capacity_kW)} kW" for one in found.each]
    power = rounded(required(found), SAFETY_DIGITS)
    return (
        f": {of_standards(found, values)}, {wanted} asked for; power capacity "
        f"{of_standards(found, capacities)}, {power} kW asked for"
    )


def _all(found: DriveRating) -> list[tuple[str, float, float]]:
    """Return every safety factor: of what, its value, what is asked for."""
    asked = found.minimum_bending_safety, found.minimum_contact_safety
    return [
        (f"{mode} of the {gear_words(found, gear)}", own, least)
        for gear in found.gears
        for mode, own, least in zip(
            MODES, (gear.bending_safety, gear.contact_safety), asked, strict=True
        )
    ]


def _governing(found: DriveRating) -> tuple[str, str, float, float]:
    """Return what governs: its words, symbol, safety factor and the one asked for."""
    mesh = weakest(found)
    mode, _, member = mesh.governs.partition(" of the ")
    gear = next(g for g in found.gears if (g.stage, g.member) == (mesh.stage, member))
    words = f"{mode} of the {gear_words(found, gear)}"
    own, asked = next((own, asked) for name, own, asked in _all(found) if name == words)
    return words, MODES[mode], own, asked


def nearest(found: DriveRating) -> list[str]:
    """Return of every stage what comes nearest to the safety factors asked for, in words."""
    words = []
    for mesh in found.meshes:
        rows = [
            (own / asked, f"{mode} of the {gear.member}", one.by)
            for one in found.each
            for gear in one.gears
            if gear.stage == mesh.stage
            for mode, own, asked in (
                ("bending", gear.bending_safety, one.minimum_bending_safety),
                ("contact", gear.contact_safety, one.minimum_contact_safety),
            )
        ]
        _, what, by = min(rows)
        of = f" by {by}" if found.beside is not None else ""
        words.append(f"in stage {mesh.stage} {what}{of}")
    return words


def weakest(found: DriveRating) -> MeshRating:
    """Return the mesh that may transmit least."""
    return min(found.meshes, key=lambda mesh: mesh.power_capacity_kW)


def gear_words(found: DriveRating, gear: GearRating) -> str:
    """Return a gear in a sentence: of several stages with its own."""
    return gear.member if len(found.meshes) == 1 else f"{gear.member} of stage {gear.stage}"


def required(found: DriveRating) -> float:
    """Return the power [kW] that is asked for, the largest one of a load spectrum."""
    first = found.shafts[0]
    duty = first.torque_Nm * first.speed_rpm * pi / 30.0 / 1000.0
    return max((level.power_kW for level in found.levels), default=duty)


def least_safeties(results: Sequence[Result]) -> list[list[str]]:
    """Return a row for S_F and S_H of every standard: its name, the least of every design."""
    found = [rating_of(result) for result in results]
    first = found[0]
    if first is None:
        return []
    rows = []
    for k, one in enumerate(first.each):
        by = f", {one.by}" if first.beside else ""
        for mode, symbol in MODES.items():
            key = f"{mode}_safety"
            least = [
                "" if other is None else safety(min(getattr(g, key) for g in other.each[k].gears))
                for other in found
            ]
            rows.append([f"least {symbol}{by}", *least])
    return rows


def safety(factor: float) -> str:
    """Return a safety factor, capacity or life for reading: never larger than it is."""
    text = rounded(factor, SAFETY_DIGITS)
    near = isclose(float(text.replace(",", "")), factor, rel_tol=ROUNDING)
    return text if near else rounded(factor, SAFETY_DIGITS, way=-1)


def efficiency(found: DriveRating) -> str:
    """Return the efficiency of all meshes, with the error of a computed friction."""
    assert found.efficiency_percent is not None
    error = found.efficiency_error_percent
    about = "" if error is None else f" ± {rounded(error, 2)}"
    return f"{rounded(found.efficiency_percent, 4)}{about} %"


def unsure(found: DriveRating) -> str:
    """Return that the error of an efficiency is unverified; nothing where friction is given."""
    return "" if found.efficiency_error_percent is None else ", unverified"


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Return least safety factors, power capacity, life and efficiency as key figures."""
    if (found := rating_of(result)) is None:
        return []
    capacities = [measures.words(f"{safety(one.power_capacity_kW)} kW") for one in found.each]
    asked = measures.words(f"{rounded(required(found), SAFETY_DIGITS)} kW")
    lives = [life(one.life_h) for one in found.each]
    made = [
        *(_safety_tile(one, "bending", found) for one in found.each),
        *(_safety_tile(one, "contact", found) for one in found.each),
        _tile(found, "power capacity", capacities, asked),
        _tile(found, "life at S = 1", lives, life(found.required_life_h)),
    ]
    if found.efficiency_percent is not None:
        remark = "tooth friction alone"
        made.append(Tile("efficiency", efficiency(found), remark))
    return made


def _safety_tile(found: DriveRating, mode: str, whole: DriveRating) -> Tile:
    """Return the least safety factor of a mode by one of the standards of the whole rating."""
    key, asked = f"{mode}_safety", float(getattr(found, f"minimum_{mode}_safety"))
    least = min(found.gears, key=lambda gear: float(getattr(gear, key)))
    remark = f"{gear_words(found, least)}; {asked:g} asked for"
    of = "" if whole.beside is None else f" by {found.by}"
    return Tile(f"least {MODES[mode]}, {mode}{of}", safety(getattr(least, key)), remark)


def _tile(found: DriveRating, name: str, values: Sequence[str], asked: str) -> Tile:
    """Return a key figure: its value, or by each of two standards in the remark the second."""
    if found.beside is None:
        return Tile(name, values[0], f"{asked} asked for")
    first, second = found.each
    remark = f"{values[1]} by {second.by}; {asked} asked for"
    return Tile(f"{name} by {first.by}", values[0], remark)


def life(hours: float | None) -> str:
    """Return a life for reading; None: beyond the end of the curves, 0: before they begin."""
    if not hours:
        return f"beyond {LONGEST_LIFE}" if hours is None else AT_ONCE
    return f"{safety(hours)} h"


def unverified(found: DriveRating) -> list[str]:
    """Return a sentence with the symbols of unverified values, by every standard that has any."""
    return [line for one in found.each for line in _unverified(one, found.beside is not None)]


def _unverified(found: DriveRating, named: bool) -> list[str]:
    """Return the sentence of one standard, which is named."""
    stages: dict[str, list[str]] = {}
    for name in found.unverified:
        symbol, _, stage = name.partition(" of stage ")
        stages.setdefault(symbol, []).append(stage)
    if not stages:
        return []
    several = len(found.meshes) > 1
    names = [_of_stages(symbol, own if several else []) for symbol, own in stages.items()]
    of = f" by {found.by}" if named else ""
    return [
        f"Unverified{of}, with a single source or no published value that confirms them: "
        f"{series_of(list(map(greek, names)))}."
    ]


def _of_stages(symbol: str, stages: Sequence[str]) -> str:
    own = [stage for stage in stages if stage]
    return f"{symbol} of stage{'s' * (len(own) > 1)} {counted(own)}" if own else symbol


def greek(text: str) -> str:
    """Return a text with its symbols as engineers write them: "K_Hbeta" as "K_Hβ"."""
    return _SYMBOL.sub(lambda found: _written(found[0]), text)


def _written(symbol: str) -> str:
    return WRITTEN.get(symbol) or _NAME.sub(lambda name: GREEK[name[0]], symbol)


def stress_words(found: DriveRating, key: str, words: str) -> str:
    """Return what a stress is called, with its symbol by every standard: "stress s_t, sigma_F"."""
    symbols = [SYMBOLS[one.by][key] for one in found.each if key in SYMBOLS[one.by]]
    return " ".join([words, ", ".join(symbols)]) if symbols else words


def of_standards(found: DriveRating, values: list[str], joint: str = ", ") -> str:
    """Return values, one by each standard, as words; a value alone without its standard."""
    if len(values) == 1:
        return values[0]
    pairs = zip(found.each, values, strict=True)
    return joint.join(f"{value} by {one.by}" for one, value in pairs)
