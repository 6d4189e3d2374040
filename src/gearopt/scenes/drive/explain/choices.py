"""Remedies that move no limit: the nearest ratio, a tolerance, switches of [teeth]."""

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import Context, Decimal
from fractions import Fraction
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.proposed import DIGITS
from gearopt.optimise.explaining.repair import SLACK_TRIED
from gearopt.scenes.drive.driving import largest_ratio, trains
from gearopt.scenes.drive.explain.least_product import is_real
from gearopt.scenes.drive.explain.moves import inherited
from gearopt.scenes.drive.explain.tried import Case, any_possible
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import as_remedy, least
from gearopt.scenes.explaining.moves import DUTY, Move, changed, with_each
from gearopt.scenes.explaining.numbers import SHORT, STEP_FROM_ZERO, allowed, eased, put, written
from gearopt.scenes.reading.module_series import SERIES, family, series_of
from gearopt.scenes.reading.toml_writing import toml_text
from gearopt.units import Quantity

TOLERANCE, MODULES = ("duty", "ratio_tolerance"), ("teeth", "modules")
WIDEST = (
    Fraction(1, 2),
    Fraction(999, 1000),
)  # distances to which ratios are sought, up and down
NEARER = Fraction(1, 10**9)  # part of its distance by which one that is nearer is asked for
# part of its distance to which that of real-valued teeth is known
RATIO_TOLERANCE = Fraction(1, 10**5)
# part of its distance from where all that is nearer is asked for at once
NEARER_ASKED = Fraction(1, 10)
SLACK_FRACTION = Fraction(SLACK_TRIED)
QUESTIONS = 40  # at most, for nearer ratios
LONGEST_DIGITS = 15  # digits of what is written


@dataclass(frozen=True)
class Reached:
    """Ratios that a design exists for, at a distance from the one asked for (a part of it).

    Of real-valued teeth the one below and the one above: at least one of them is reached.
    """

    away: Fraction
    ratios: tuple[Fraction, ...]


def nearest_ratio(case: Case, away: Fraction | None) -> Remedy | None:
    """Return the ratio next to the one asked for that a design exists for, written into the duty.

    away: the smallest tolerance known to suffice, None where the file can hold none.
    """
    far = max(WIDEST[0], min(WIDEST[1], 1 - 1 / largest_ratio(case.scene.duty)))
    reached = _ratio_within(case, away or far)
    if isinstance(reached, str) or reached.away == 0:
        return None
    reached, word = _nearest(case, reached)
    for other in (one for ratio in reached.ratios for one in _scenes_of_ratio(case.scene, ratio)):
        if case.status(other) == "feasible":
            place = ("duty", "ratio" if other.duty.output_speed is None else "output_speed")
            (change,) = changed(case.scene, other, [Move(place, 1, inherits=inherited)]).changes
            verified = {"with": "feasible", "nearer": word}
            return Remedy("choice", "ratio", (change,), change.factor, None, verified)
    return None


def _nearest(case: Case, best: Reached) -> tuple[Reached, str]:
    """Return the nearest ratio that designs reach, and whether a nearer one is infeasible.

    Whole teeth are known to be next in exact numbers, real-valued ones but for SLACK_TRIED of the
    distance, as limits are met in doubles.
    """
    whole, low = case.scene.teeth is not None, case.scene.duty.ratio_tolerance
    sharp = NEARER if whole else RATIO_TOLERANCE
    proven = low  # below it nothing is reached, between it and `low` that is not known
    excluded = whole  # by the last answer: perhaps all that is nearer is
    for _ in range(QUESTIONS):
        if best.away - low <= sharp * best.away:
            break
        away = Fraction(math.sqrt(max(low, best.away * SLACK_FRACTION) * best.away))
        if excluded and best.away - low <= NEARER_ASKED * best.away:
            away = best.away * (1 - NEARER)
        met = _ratio_within(case, away)
        excluded = whole and isinstance(met, str)
        if isinstance(met, Reached):
            best = met
        else:
            low, proven = away, away if met == "infeasible" else proven
        if case.clock.over:
            break
    known = best.away - proven <= (NEARER if whole else SLACK_FRACTION) * best.away
    return best, "infeasible" if known else "undecided"


def _ratio_within(case: Case, away: Fraction) -> Reached | str:
    """Return a ratio within a distance, or else what is known: infeasible or undecided."""
    asked, within = case.scene.duty.total_ratio, _within(case.scene, away)
    if case.scene.teeth is None:
        word, below, above = case.status(within), asked * (1 - away), asked * (1 + away)
        return Reached(away, (below, above)) if word == "feasible" else word
    if is_real(within, case.clock):
        return "infeasible"
    for train in trains(within):
        if teeth := case.teeth(train):
            ratio = Fraction(math.prod(z2 for _, z2 in teeth), math.prod(z1 for z1, _ in teeth))
            ratio = ratio if train.driver == "pinion" else 1 / ratio
            return Reached(abs(ratio / asked - 1), (ratio,))
        if teeth is None:
            return "undecided"
    return "infeasible"


def _within(scene: Scene, tolerance: Fraction) -> Scene:
    changed_scene: Scene = put(scene, TOLERANCE, tolerance)
    return changed_scene


def _scenes_of_ratio(scene: Scene, ratio: Fraction) -> Iterator[Scene]:
    """Yield the scene that asks for a ratio, as a file can write it, or its output speed.

    Whole teeth: exactly, or so that the ratio is within the tolerance. Real-valued ones: a short
    number that is as near, or else one rounded away from the ratio asked for.
    """
    asked, speed = scene.duty.total_ratio, scene.duty.output_speed
    number = ratio if speed is None else speed.number * asked / ratio
    way = 1 if (number > asked if speed is None else number > speed.number) else -1
    if scene.teeth is not None:
        numbers = [_short(number, digits) for digits in range(DIGITS, LONGEST_DIGITS + 1)]
    else:
        numbers = [_short(number, SHORT), eased(number, 1.0, way)]
    for k, value in enumerate(numbers):
        new: Any = value if speed is None else replace(speed, number=value)
        other: Scene = put(scene, ("duty", "ratio" if speed is None else "output_speed"), new)
        if not allowed(other):
            continue
        written = other.duty.total_ratio
        missed = abs(ratio - written)
        if scene.teeth is not None and missed <= scene.duty.ratio_tolerance * written:
            yield other
            return
        if scene.teeth is None and (k or missed <= Fraction(SLACK_TRIED) * abs(ratio - asked)):
            yield other


def _short(number: Fraction, digits: int) -> Fraction:
    numerator, denominator = Decimal(number.numerator), Decimal(number.denominator)
    return Fraction(Context(prec=digits).divide(numerator, denominator))


def eased_tolerance(case: Case) -> Remedy | None:
    """Return the smallest ratio tolerance with which a drive of none is possible."""
    widest = 1.0 + float(WIDEST[0] / STEP_FROM_ZERO)
    move = Move(TOLERANCE, 1, DUTY, TOLERANCE[-1], far=widest, inherits=inherited)
    asked = replace(case.asked, far=widest)
    known = least(asked, ((move, 1.0),))
    return None if known is None else as_remedy(asked, known, "less")


def switches(case: Case) -> Iterator[Remedy]:
    """Yield switches of [teeth] that suffice alone: not hunting, one module more, both series."""
    teeth = case.scene.teeth
    assert teeth is not None
    named, widest = series_of(teeth.modules), family(teeth.modules)[-1]
    ways = [*with_each(case.scene, ("teeth", "coprime"), [False] * teeth.coprime)]
    ways += with_each(case.scene, MODULES, () if named else _one_more(teeth.modules))
    if not {*SERIES[widest]} <= {*teeth.modules}:
        was = toml_text(named or written(teeth.modules, MODULES))
        change = Change("teeth.modules", was, toml_text(widest), 1.0)
        ways.append(((change,), put(case.scene, MODULES, SERIES[widest])))
    done = set()
    for changes, other in ways:
        field = changes[0].key.removeprefix("teeth.")
        kind = (field, changes[0].write.startswith("["))
        if kind not in done and any_possible(case, trains(other)):
            done.add(kind)
            yield Remedy("choice", field, changes, 1.0, None, {"with": "feasible"})


def _one_more(modules: tuple[Quantity, ...]) -> list[tuple[Quantity, ...]]:
    """Return the list with one module of a series more: the first series, the near ones first."""
    sizes = {m.exact[0] for m in modules}

    def far(module: Quantity) -> float:
        size = module.exact[0]
        return min(float(max(m, size) / min(m, size)) for m in sizes)

    added: list[Quantity] = []
    for name in family(modules):
        new = [m for m in SERIES[name] if m.exact[0] not in sizes and m not in added]
        added += sorted(new, key=far)
    return [tuple(sorted((*modules, m), key=lambda m: m.number)) for m in added]
