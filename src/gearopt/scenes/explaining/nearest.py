"""The nearest total ratio that the limits of an impossible drive reach, as an edit of its duty."""

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import Context, Decimal
from fractions import Fraction
from typing import Any

from gearopt.formulations.teeth.progress import Teeth
from gearopt.optimise.explaining.explain import DIGITS, TAKEN_BACK
from gearopt.optimise.explaining.explanation import Remedy
from gearopt.scenes.explaining.levers import edits
from gearopt.scenes.explaining.numbers import SHORT, allowed, eased, put
from gearopt.scenes.explaining.switches import TOLERANCES
from gearopt.scenes.explaining.tried import Case, least_value
from gearopt.scenes.tables.drive import Scene

TOLERANCE = ("duty", "ratio_tolerance")
WIDEST = Fraction(999, 1000)  # part of the ratio asked for, down to which others are looked for
NEARER = Fraction(1, 10**9)  # part of its distance by which one that is nearer is asked for
SHARP = 1e-5  # part of its distance to which that of real-valued teeth is known
QUESTIONS = 20  # at most, for nearer ratios
LONGEST = 15  # digits of what is written


def nearest_ratio(case: Case, away: Fraction | None) -> Remedy | None:
    """The ratio next to the one asked for that a design exists for, written into the duty.

    away: the least tolerance known to suffice, None where the file can hold none.
    """
    away = away or _least_tolerance(case)
    if away is None:
        return None
    reached, word = (_real if case.scene.teeth is None else _of_teeth)(case, away)
    for found in (one for ratio in reached for one in _written(case.scene, ratio)):
        if case.status(found) == "feasible":
            place = ("duty", "ratio" if found.duty.output_speed is None else "output_speed")
            change = edits(case.scene, found, [place]).changes[0]
            verified = {"with": "feasible", "nearer": word}
            return Remedy("choice", "ratio", (change,), change.factor, None, verified)
    return None


def _least_tolerance(case: Case) -> Fraction | None:
    """The least tolerance that suffices, also beyond those that a file may hold."""
    scene, few = case.scene, TOLERANCES[0]

    def works(value: float, back: float = 0.0) -> bool | None:
        word = case.status(_within(scene, Fraction(value * (1.0 - back))))
        return {"feasible": True, "infeasible": False}.get(word)

    widest = float(max(TOLERANCES[1], min(WIDEST, 1 - 1 / scene.duty.total_ratio)))
    if works(widest) is not True:  # one question where no ratio helps
        return None
    least = least_value(float(scene.duty.ratio_tolerance or few), (widest,), works)
    return None if least is None else Fraction(least)


def _within(scene: Scene, tolerance: Fraction) -> Scene:
    found: Scene = put(scene, TOLERANCE, tolerance)
    return found


def _real(case: Case, away: Fraction) -> tuple[list[Fraction], str]:
    """The ratios of real-valued teeth next to the one asked for, below and above it.

    And whether those nearer by TAKEN_BACK of the distance are impossible.
    """
    low, high = case.scene.duty.ratio_tolerance, away
    while high - low > SHARP * high:
        middle = (low + high) / 2
        found = case.status(_within(case.scene, middle))
        if found == "undecided":  # too near to the limits for doubles
            break
        low, high = (low, middle) if found == "feasible" else (middle, high)
    asked = case.scene.duty.total_ratio
    word = "infeasible" if high - low <= TAKEN_BACK * high else "undecided"
    return [asked * (1 - high), asked * (1 + high)], word


def _of_teeth(case: Case, away: Fraction) -> tuple[list[Fraction], str]:
    """The ratio of whole teeth next to the one asked for, in integers; whether none is nearer."""
    train, asked, word = case.scene.train(), case.scene.duty.total_ratio, "undecided"
    best: list[Fraction] = []
    for _ in range(QUESTIONS):
        teeth = case.teeth(replace(train, tolerance=away))
        if not teeth:
            word = "infeasible" if teeth == () else "undecided"
            break
        best = [_ratio(teeth)]
        away = abs(best[0] / asked - 1) * (1 - NEARER)
    return best, word


def _ratio(teeth: Teeth) -> Fraction:
    return Fraction(math.prod(z2 for _, z2 in teeth), math.prod(z1 for z1, _ in teeth))


def _written(scene: Scene, ratio: Fraction) -> Iterator[Scene]:
    """The scene that asks for a ratio, as a file can write it; the output speed where it has that.

    Whole teeth: exactly, or so that the ratio is within the tolerance. Real-valued ones: a short
    number that is as near, or else one rounded away from the ratio asked for.
    """
    asked, speed = scene.duty.total_ratio, scene.duty.output_speed
    number = ratio if speed is None else speed.number * asked / ratio
    way = 1 if (number > asked if speed is None else number > speed.number) else -1
    if scene.teeth is not None:
        numbers = [_short(number, digits) for digits in range(DIGITS, LONGEST + 1)]
    else:
        numbers = [_short(number, SHORT), eased(number, 1.0, way)]
    for k, value in enumerate(numbers):
        new: Any = value if speed is None else replace(speed, number=value)
        found: Scene = put(scene, ("duty", "ratio" if speed is None else "output_speed"), new)
        if not allowed(found):
            continue
        written = found.duty.total_ratio
        missed = abs(ratio - written)
        if scene.teeth is not None and missed <= scene.duty.ratio_tolerance * written:
            yield found
            return
        if scene.teeth is None and (k or missed <= Fraction(TAKEN_BACK) * abs(ratio - asked)):
            yield found


def _short(number: Fraction, digits: int) -> Fraction:
    one, other = Decimal(number.numerator), Decimal(number.denominator)
    return Fraction(Context(prec=digits).divide(one, other))
