"""A rating in sentences and key figures: safe or not, what governs, its symbols in Greek."""

import re
from collections.abc import Sequence
from math import isclose, pi

from gearopt.formulations.drive.rating import DriveRating, GearRating, MeshRating, StaticRating
from gearopt.optimise.result import FEASIBLE, Result
from gearopt.optimise.typed import held
from gearopt.physics.agma import life as life_curves
from gearopt.physics.mesh_loss import FRICTION_ERROR
from gearopt.report.measures import METRIC, Measures, rounded
from gearopt.report.section import Tile
from gearopt.report.words import counted, series_of

SAFETY_DIGITS = 4  # of safety factors, capacities and lives, wherever they stand
ROUNDING = 1e-8  # relative; a safety factor so near to a shorter number is that one
FRICTION = (  # `mesh_loss.FRICTION_ERROR`
    f"the error is that of the friction, which may be {100 * FRICTION_ERROR:.0f} % off (unverified)"
)
LONGEST_LIFE = f"{life_curves.LONGEST_LIFE:g}".replace("e+", "e")  # cycles
AT_ONCE = "fails at once"
FAR_APART = 2.0  # times the power capacity by one standard: by the other one it governs by far
MODES = {"bending": "S_F", "contact": "S_H"}
ALL_MODES = MODES | {f"static {mode}": f"static {symbol}" for mode, symbol in MODES.items()}
STANDARD_HEADS = {"AGMA": "AGMA", "ISO 6336": "ISO"}  # a standard in a column's head
SYMBOLS = {  # of stresses, by standard
    "AGMA": {
        "bending_stress_MPa": "s_t",
        "contact_stress_MPa": "s_c",
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
EXPLAINED = {"N": "N (resonance ratio)"}  # symbols that are not known without a word
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eps": "ε", "sigma": "σ"}
_SYMBOL = re.compile(r"\b[A-Za-z]{1,5}_\w+")  # a letter or its name, and an index
_NAME = re.compile("|".join(GREEK))
SHOWN_UNITS = {  # units of factors that are shown in others: deviations of flanks, stiffnesses
    **dict.fromkeys(("f_pb", "f_falpha", "f_ma", "C_a"), "um_or_uin"),
    **dict.fromkeys(("c_prime", "c_gamma_alpha", "c_gamma_beta"), "N_per_mm_um"),
}


def rating_of(result: Result) -> DriveRating | None:
    """The rating that a design holds; None without one."""
    return held(DriveRating, result.design, "rating")


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Whether given gears are safe, and what governs."""
    rating = rating_of(result)
    return _verdict(rating) if rating else ""


def figures(result: Result) -> str:
    """The least safety factor and the power capacity, as the end of a sentence."""
    rating = rating_of(result)
    return _figures(rating) if rating else ""


def warns(result: Result, measures: Measures = METRIC) -> list[str]:
    """Warnings: an optimum that is not safe, gears that do not fit, flaws."""
    if (rating := rating_of(result)) is None:
        return list(result.report.get("misfits", ()))
    unsafe = [] if rating.safe_by_all or not result.objective else [sentence_of(rating)]
    return [*unsafe, *map(greek, (*rating.misfits, *rating.flaws))]


def sentence_of(rating: DriveRating) -> str:
    """Whether an optimum is safe, and what governs, in a sentence."""
    return f"{'Safe' if rating.safe_by_all else 'Not safe'} by its rating: {_verdict(rating)}."


def rated_sentence(rating: DriveRating) -> str:
    """The rating of an optimum with its figures; what a warning said is not said again."""
    first = sentence_of(rating).rstrip(".") if rating.safe_by_all else "Rating"
    return f"{first}{_figures(rating)}."


def _verdict(rating: DriveRating) -> str:
    """Whether the gears fit, what meets the safety factors asked for, and what governs."""
    if rating.misfits:
        return f"the gears do not fit; as to strength, {_strength(rating)}"
    return _strength(rating)


def _strength(rating: DriveRating) -> str:
    """Gears that meet the safety factors asked for and gears that do not; the one that governs."""
    if rating.met_by_all:
        return f"all required safety factors are met{_by_both(rating)}; {_governs(rating)}"
    short = [(rated.by, _short(rated)) for rated in rating.each if not rated.met]
    if rating.beside is None:
        return short[0][1]
    if len(short) == 2 and short[0][1] == short[1][1]:
        return f"by {short[0][0]} and by {short[1][0]}, {short[0][1]}"
    parts = [f"by {by}, {words}" for by, words in short]
    good = "met" if rating.misfits else "safe"
    return "; ".join(
        [*parts, *(f"{good} by {rated.by} alone" for rated in rating.each if rated.met)]
    )


def _by_both(rating: DriveRating) -> str:
    return "" if rating.beside is None else " by " + " and by ".join(o.by for o in rating.each)


def _governs(rating: DriveRating) -> str:
    """Governing gear and mode by every standard; of power, where safety factors have another."""
    words = []
    for rated in rating.each:
        name, _, reached, asked = _governing(rated)
        least = min(reached / asked for _, reached, asked in _all(rated))
        of_power = " the power capacity" * (reached / asked > least * (1.0 + ROUNDING))
        words.append(f"{name} governs{of_power}")
    if len(set(words)) == 1:
        return f"{words[0]}{' both' * (len(words) > 1)}"
    return of_standards(rating, words)


def _short(rating: DriveRating) -> str:
    """Safety factors of a standard that fall short."""
    words = _governing(rating)[0]
    short = sum(
        (1.0 + FEASIBLE) * safety_factor < asked for _, safety_factor, asked in _all(rating)
    )
    return (
        f"{words} falls short" if short < 2 else f"{short} safety factors fall short, {words} most"
    )


def _figures(rating: DriveRating) -> str:
    """Least safety factor and power capacity by every standard, and what is asked for."""
    least = [_governing(rated)[1:] for rated in rating.each]
    values = [
        f"{symbol} {beside(reached, asked, f'{asked:g}')}" for symbol, reached, asked in least
    ]
    asked = dict.fromkeys(f"{symbol} {asked:g}" for symbol, _, asked in least)
    wanted = f"{least[0][2]:g}" if len(asked) == 1 else " and ".join(asked)
    power, capacities = _powers(rating)
    weak, *stronger = sorted(rating.each, key=lambda rated: rated.power_capacity_kW)
    apart = all(r.power_capacity_kW > FAR_APART * weak.power_capacity_kW for r in stronger)
    governing = f"; {weak.by} governs" if stronger and apart else ""
    return (
        f": {of_standards(rating, values)}, {wanted} required; power capacity "
        f"{of_standards(rating, capacities)}, {power} required{governing}"
    )


def _powers(rating: DriveRating) -> tuple[str, list[str]]:
    """The power asked for and the capacities by every standard, with their unit."""
    asked = required(rating)
    text = rounded(asked, SAFETY_DIGITS)
    capacities = [beside(rated.power_capacity_kW, asked, text) for rated in rating.each]
    return f"{text} kW", [f"{capacity} kW" for capacity in capacities]


def _all(rating: DriveRating) -> list[tuple[str, float, float]]:
    """Every safety factor: of what, its value, what is asked for."""
    return [
        (f"{mode} of the {gear_words(rating, gear)}", reached, least)
        for gear, mode, reached, least in rating.margins
    ]


def _governing(rating: DriveRating) -> tuple[str, str, float, float]:
    """Governing gear and mode in words, its symbol, safety factor and the one asked for."""
    mesh = weakest(rating)
    mode, _, member = mesh.governs.partition(" of the ")
    gear = next(g for g in rating.gears if (g.stage, g.member) == (mesh.stage, member))
    words = f"{mode} of the {gear_words(rating, gear)}"
    reached, asked = next(
        (reached, asked) for name, reached, asked in _all(rating) if name == words
    )
    return words, ALL_MODES[mode], reached, asked


def nearest(rating: DriveRating) -> list[str]:
    """The safety factor of every stage nearest to the one asked for, and its gear, in words."""
    words = []
    for mesh in rating.meshes:
        rows = [
            (
                reached / asked,
                f"{mode} ({ALL_MODES[mode]}) of the {rating.called(gear)}",
                rated.by,
            )
            for rated in rating.each
            for gear, mode, reached, asked in rated.margins
            if gear.stage == mesh.stage
        ]
        _, what, by = min(rows)
        of = f" by {by}" if rating.beside is not None else ""
        words.append(f"{rating.titled(mesh.stage)}, {what}{of}")
    return words


def weakest(rating: DriveRating) -> MeshRating:
    """The mesh that may transmit least."""
    return min(rating.meshes, key=lambda mesh: mesh.power_capacity_kW)


def gear_words(rating: DriveRating, gear: GearRating | StaticRating) -> str:
    """A gear in a sentence: of several stages with its own."""
    called = rating.called(gear)
    return called if len(rating.meshes) == 1 else f"{called} of stage {rating.stage_of(gear.stage)}"


def required(rating: DriveRating) -> float:
    """The power [kW] that is asked for, the largest one of a load spectrum."""
    first = rating.shafts[0]
    duty = first.torque_Nm * first.speed_rpm * pi / 30.0 / 1000.0
    return max((level.power_kW for level in rating.levels), default=duty)


def least_safeties(results: Sequence[Result]) -> list[list[str]]:
    """A row for S_F and S_H of every standard: its name, the least of every design."""
    ratings = [rating_of(result) for result in results]
    first = ratings[0]
    if first is None:
        return []
    rows = []
    for k, rated in enumerate(first.each):
        by = f", {rated.by}" if first.beside else ""
        for mode, symbol in MODES.items():
            key = f"{mode}_safety"
            least = [
                "" if other is None else safety(min(getattr(g, key) for g in other.each[k].gears))
                for other in ratings
            ]
            rows.append([f"minimum {symbol}{by}", *least])
    return rows


def safety(factor: float) -> str:
    """A safety factor, capacity or life for reading: never larger than it is."""
    text = rounded(factor, SAFETY_DIGITS)
    near = isclose(float(text.replace(",", "")), factor, rel_tol=ROUNDING)
    return text if near else rounded(factor, SAFETY_DIGITS, way=-1)


def beside(reached: float, asked: float, text: str) -> str:
    """A safety factor or capacity beside the one asked for: as the text of that where it is met.

    Rounded down it would seem to fall short.
    """
    shown, met = safety(reached), (1.0 + FEASIBLE) * reached >= asked
    return text if met and _number(shown) < _number(text) else shown


def _number(text: str) -> float:
    return float(text.replace(",", ""))


def efficiency(rating: DriveRating) -> str:
    """The efficiency of all meshes, with the error of a computed friction."""
    assert rating.efficiency_percent is not None
    error = rating.efficiency_error_percent
    about = "" if error is None else f" ± {rounded(error, 2)}"
    return f"{rounded(rating.efficiency_percent, 4)}{about} %"


def unsure(rating: DriveRating) -> str:
    """Remark that the error of an efficiency is unverified; nothing where friction is given."""
    return "" if rating.efficiency_error_percent is None else ", unverified"


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Least safety factors, power capacity, life and efficiency as key figures."""
    if (rating := rating_of(result)) is None:
        return []
    power, capacities = _powers(rating)
    asked, capacities = measures.words(power), [measures.words(each) for each in capacities]
    powers = [rated.power_capacity_kW for rated in rating.each]
    lives = [life(rated, rated.shortest_lived) for rated in rating.each]
    ends = [rated.known_life_h(rated.shortest_lived) for rated in rating.each]
    shown = [
        *(_safety_tile(rated, "bending", rating) for rated in rating.each),
        *(_safety_tile(rated, "contact", rating) for rated in rating.each),
        _tile(rating, "power capacity", powers, capacities, [], asked),
        _tile(
            *(rating, "life at S = 1", ends, lives),
            *([life_governed(rated) for rated in rating.each], hours(rating.required_life_h)),
        ),
    ]
    if rating.efficiency_percent is not None:
        remark = "tooth friction alone"
        shown.append(Tile("efficiency", efficiency(rating), remark))
    return shown


def _safety_tile(rating: DriveRating, mode: str, whole: DriveRating) -> Tile:
    """The least safety factor of a mode by one of the standards of the whole rating."""
    key, place = f"{mode}_safety", [*MODES].index(mode)
    least = min(rating.gears, key=lambda g: float(getattr(g, key)) / rating.asked_of(g)[place])
    asked = rating.asked_of(least)[place]
    remark = f"{gear_words(rating, least)}; {asked:g} required"
    of = "" if whole.beside is None else f" by {rating.by}"
    reached = beside(getattr(least, key), asked, f"{asked:g}")
    alike = len({rating.asked_of(gear)[place] for gear in rating.gears}) == 1
    name = f"minimum {MODES[mode]}" if alike else f"{MODES[mode]} nearest to that required"
    return Tile(f"{name}, {mode}{of}", reached, remark)


def _tile(
    rating: DriveRating,
    name: str,
    sizes: Sequence[float],
    values: Sequence[str],
    remarks: Sequence[str],
    asked: str,
) -> Tile:
    """A key figure: of two standards the smaller size in its words, the other in the remark."""
    order = sorted(range(len(values)), key=sizes.__getitem__)
    said = [remarks[order[0]]] if remarks else []
    for k in order[1:]:
        same = values[k] == values[order[0]]
        said.append(f"{'the same' if same else values[k]} by {rating.each[k].by}")
    by = "" if rating.beside is None else f" by {rating.each[order[0]].by}"
    return Tile(f"{name}{by}", values[order[0]], "; ".join([*said, f"{asked} required"]))


def life(rating: DriveRating, gear: GearRating) -> str:
    """The life of a gear for reading: to the end of its curve, or none before it begins."""
    over = "over " if gear.life_h is None else ""
    return AT_ONCE if gear.life_h == 0.0 else f"{over}{hours(rating.known_life_h(gear))}"


def hours(value: float) -> str:
    """A number of hours for reading, never larger than it is."""
    return f"{safety(value)} h"


def life_governed(rating: DriveRating) -> str:
    """The gear that governs the life of a drive, and that its curve ends there, if it does."""
    gear = rating.shortest_lived
    if gear.life_h is not None:
        return gear_words(rating, gear)
    beyond = f"{gear_words(rating, gear)}, beyond {LONGEST_LIFE} cycles"
    if rating.known_life_h(gear) >= rating.required_life_h:
        return beyond
    rated = "with its curve extended" if rating.by == "AGMA" else "at the strength of that end"
    return f"{beyond}, where life curves end; the required life lies farther and is rated {rated}"


def unverified(rating: DriveRating) -> list[str]:
    """A sentence with the symbols of unverified values, by every standard that has any."""
    return [line for rated in rating.each for line in _unverified(rated, rating.beside is not None)]


def _unverified(rating: DriveRating, named: bool) -> list[str]:
    """The sentence of one standard, which is named: symbols by the stages where they are so."""
    stages: dict[str, list[str]] = {}
    for name in rating.unverified:
        symbol, _, stage = name.partition(" of stage ")
        stages.setdefault(symbol, []).append(stage)
    alike: dict[tuple[str, ...], list[str]] = {}
    for symbol, of_symbol in stages.items():
        known = tuple(filter(None, of_symbol)) if len(rating.meshes) > 1 else ()
        alike.setdefault(known, []).append(EXPLAINED.get(symbol, greek(symbol)))
    if not alike:
        return []
    sets = [mesh.title.removeprefix("stage ") for mesh in rating.named if mesh.suffix]
    parts = [f"{_in_stages(known, sets)}{series_of(symbols)}" for known, symbols in alike.items()]
    of = f" by {rating.by}" if named else ""
    return [f"Unverified{of} (one source, or no published value): {'; '.join(parts)}."]


def _in_stages(stages: Sequence[str], sets: Sequence[str]) -> str:
    """Stages where symbols are unverified; sets: all meshes of planets."""
    plain = [stage for stage in stages if stage.isdigit()]
    words = [f"stage{'s' * (len(plain) > 1)} {counted(plain)}"] if plain else []
    rest = [stage for stage in stages if stage not in plain]
    if not rest:
        return f"in {words[0]} " if words else ""
    every = len(sets) > 2 and set(sets) <= set(rest)
    meshes = [] if not every else ["all planetary meshes"]
    of_stage = dict[str, list[str]]()
    for stage in (stage for stage in rest if not (every and stage in sets)):
        number, _, gears = stage.partition(", ")
        of_stage.setdefault(number, []).append(gears)
    meshes += [f"stage {number} ({'; '.join(gears)})" for number, gears in of_stage.items()]
    return f"in {series_of([*meshes, *words])}: "


def greek(text: str) -> str:
    """A text with its symbols as engineers write them: "K_Hbeta" as "K_Hβ"."""
    return _SYMBOL.sub(lambda found: _written(found[0]), text)


def _written(symbol: str) -> str:
    return WRITTEN.get(symbol) or _NAME.sub(lambda name: GREEK[name[0]], symbol)


def stress_words(rating: DriveRating, key: str, words: str) -> str:
    """Name of a stress with its symbol by every standard: "stress s_t, sigma_F"."""
    symbols = [SYMBOLS[rated.by][key] for rated in rating.each if key in SYMBOLS[rated.by]]
    return " ".join([words, ", ".join(symbols)]) if symbols else words


def of_standards(rating: DriveRating, values: list[str], joint: str = ", ") -> str:
    """Values, one by each standard, as words; a value alone without its standard."""
    if len(values) == 1:
        return values[0]
    pairs = zip(rating.each, values, strict=True)
    return joint.join(f"{value} by {rated.by}" for rated, value in pairs)
