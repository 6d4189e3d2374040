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
from gearopt.scenes.explaining.numbers import Path, allowed, put
from gearopt.scenes.explaining.switches import TOLERANCES
from gearopt.scenes.explaining.tried import Case, least_value
from gearopt.scenes.tables.drive import Scene

TOLERANCE = ("duty", "ratio_tolerance")
WIDEST = Fraction(999, 1000)  # part of the ratio asked for, down to which others are looked for
NEARER = Fraction(1, 10**9)  # part of its distance by which a ratio nearer than one is asked for
QUESTIONS = 20  # at most, for nearer ratios
LONGEST = 15  # digits of what is written


def nearest_ratio(case: Case, away: Fraction | None) -> Remedy | None:
    """The ratio next to the one asked for that a design exists for, written into the duty.

    away: the least tolerance known to suffice, None where the file can hold none.
    """
    away = away or _least_tolerance(case)
    if away is None:
        return None
    asked = case.scene.duty.total_ratio
    if case.scene.teeth is not None:
        reached, word = _of_teeth(case, away)
    else:
        reached = [asked * (1 - away), asked * (1 + away)]
        word = case.status(_within(case.scene, away * (1 - Fraction(TAKEN_BACK))))
    for ratio in reached:
        for path, found in _written(case.scene, ratio):
            if case.status(found) == "feasible":
                change = edits(case.scene, found, [path]).changes[0]
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


def _written(scene: Scene, ratio: Fraction) -> Iterator[tuple[Path, Scene]]:
    """The scene that asks for a ratio, as the file can write it: exactly, or within its tolerance.

    The output speed is written where the file has that.
    """
    duty, speed = scene.duty, scene.duty.output_speed
    field = "ratio" if speed is None else "output_speed"
    for digits in range(DIGITS, LONGEST + 1):
        value: Any = _short(ratio, digits)
        if speed is not None:
            value = replace(speed, number=_short(speed.number * duty.total_ratio / ratio, digits))
        found = put(scene, ("duty", field), value)
        written = found.duty.total_ratio
        if abs(ratio - written) <= duty.ratio_tolerance * written and allowed(found):
            yield ("duty", field), found
            return


def _short(number: Fraction, digits: int) -> Fraction:
    return Fraction(Context(prec=digits).divide(Decimal(number.numerator), Decimal(number.denominator)))
