"""A rating in sentences and key figures: safe or not, what governs, what it rests on."""

from collections.abc import Sequence
from math import isclose, pi

from gearopt.formulations.rating import DriveRating, GearRating, MeshRating
from gearopt.optimise.result import FEASIBLE, Result
from gearopt.optimise.typed import typed
from gearopt.physics.agma import life as life_curves
from gearopt.physics.mesh_loss import FRICTION_ERROR
from gearopt.report.measures import Measures, rounded
from gearopt.report.section import Tile
from gearopt.report.words import counted, series_of

SAFETY_DIGITS = 3  # of safety factors in sentences and key figures
ROUNDING = 1e-8  # relative; a safety factor so near to a shorter number is that one
FRICTION = (  # `mesh_loss.FRICTION_ERROR`
    f"the error is that of the friction, which may be {100 * FRICTION_ERROR:.0f} % off (unverified)"
)
LONGEST = f"{life_curves.LONGEST:g} cycles".replace("e+", "e")
AT_ONCE = "fails at once"
MODES = {"bending": "S_F", "contact": "S_H"}


def rating_of(result: Result) -> DriveRating | None:
    """Return the rating that a design holds; None without one."""
    held = result.design.get("rating")
    found: DriveRating | None = typed(DriveRating, held, "rating") if held else None
    return found


def decides(result: Result) -> str:
    """Return whether given gears are safe, and what governs."""
    found = rating_of(result)
    return _verdict(found) if found else ""


def figures(result: Result) -> str:
    """Return the least safety factor and the power capacity, as the end of a sentence."""
    found = rating_of(result)
    return _figures(found) if found else ""


def warns(result: Result) -> list[str]:
    """Return that an optimum is not safe, and flaws of teeth."""
    if (found := rating_of(result)) is None:
        return []
    unsafe = [] if found.safe or not result.objective else [sentence_of(found)]
    return [*unsafe, *found.flaws]


def sentence_of(found: DriveRating) -> str:
    """Return whether an optimum is safe, and what governs, in a sentence."""
    return f"{'Safe' if found.safe else 'Not safe'} by its rating: {_verdict(found)}."


def told(found: DriveRating) -> str:
    """Return the rating of an optimum with its figures; what a warning said is not said again."""
    first = sentence_of(found).rstrip(".") if found.safe else "Rating"
    return f"{first}{_figures(found)}."


def _verdict(found: DriveRating) -> str:
    words = _governing(found)[0]
    if found.safe:
        return f"all safety factors are met; {words} governs"
    short = sum((1.0 + FEASIBLE) * own < asked for _, own, asked in _all(found))
    return (
        f"{words} falls short" if short < 2 else f"{short} safety factors fall short, {words} most"
    )


def _figures(found: DriveRating) -> str:
    _, symbol, own, asked = _governing(found)
    power = rounded(required(found), SAFETY_DIGITS)
    return (
        f": {symbol} {safety(own)}, {asked:g} asked for; power capacity "
        f"{safety(found.power_capacity_kW)} kW, {power} kW asked for"
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


def safety(factor: float) -> str:
    """Return a safety factor, or a capacity, for reading: never larger than it is."""
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
    made = [
        _safety_tile(found, "bending", found.minimum_bending_safety),
        _safety_tile(found, "contact", found.minimum_contact_safety),
        Tile(
            "power capacity",
            measures.amount(found.power_capacity_kW, "kW"),
            f"{measures.amount(required(found), 'kW')} asked for",
        ),
        Tile("life", life(found.life_h), f"{life(found.required_life_h)} asked for"),
    ]
    if found.efficiency_percent is not None:
        remark = "tooth friction alone"
        made.append(Tile("efficiency", efficiency(found), remark))
    return made


def _safety_tile(found: DriveRating, mode: str, asked: float) -> Tile:
    key = f"{mode}_safety"
    least = min(found.gears, key=lambda gear: float(getattr(gear, key)))
    remark = f"{gear_words(found, least)}; {asked:g} asked for"
    return Tile(f"least {MODES[mode]}, {mode}", safety(getattr(least, key)), remark)


def life(hours: float | None) -> str:
    """Return a life for reading; None: beyond the end of the curves, 0: before they begin."""
    if not hours:
        return f"beyond {LONGEST}" if hours is None else AT_ONCE
    return f"{rounded(hours, SAFETY_DIGITS)} h"


def unverified(found: DriveRating) -> list[str]:
    """Return a sentence with the symbols of unverified values; nothing without any."""
    stages: dict[str, list[str]] = {}
    for name in found.unverified:
        symbol, _, stage = name.partition(" of stage ")
        stages.setdefault(symbol, []).append(stage)
    if not stages:
        return []
    several = len(found.meshes) > 1
    names = [_of_stages(symbol, own if several else []) for symbol, own in stages.items()]
    return [
        "Unverified, because a single source has it or no published value confirms it: "
        f"{series_of(names)}."
    ]


def _of_stages(symbol: str, stages: Sequence[str]) -> str:
    own = [stage for stage in stages if stage]
    return f"{symbol} of stage{'s' * (len(own) > 1)} {counted(own)}" if own else symbol
