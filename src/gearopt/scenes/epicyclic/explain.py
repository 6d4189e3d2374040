"""Limits in conflict of an impossible train, and the numbers that alone make it possible.

Each question is a whole search, which proves its answer; a limit that is a number of the best train
but for it (ratio, loss) moves to that number at once.
"""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial

from gearopt.formulations.epicyclic.request import (
    ASSEMBLY,
    COAXIAL,
    DIFFERENCE,
    EFFICIENCY,
    ERROR,
    LOSS,
    NEIGHBOURS,
    TOLERANCE,
    Request,
)
from gearopt.formulations.epicyclic.search import Key, best
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedies
from gearopt.optimise.result import Result
from gearopt.scenes.epicyclic.tables import MAX_PLANETS, MAX_SHIFTED, MAX_TEETH, MIN_TEETH, Scene
from gearopt.scenes.explaining.engine import FeasibilityQuestions, Group, singles, with_least
from gearopt.scenes.explaining.moves import DUTY, Move
from gearopt.scenes.explaining.numbers import apart, cut, numbers
from gearopt.scenes.explaining.possible import UNKNOWN, Verdict

FAR = 8.0  # times the end of a range of teeth, at most
NEAR = 12  # teeth by which a given number is moved, at most
DIGITS = 6  # of a limit that is set to what a train reaches
ASKED = (NEIGHBOURS, DIFFERENCE, ASSEMBLY, EFFICIENCY, TOLERANCE)  # left out in this order


def _able(request: Request, clock: Clock) -> bool | None:
    """Whether some train meets all limits; None: not known in time."""
    known = best(request, Clock(clock.left, clock.watch))
    return True if known.key is not None else (False if known.done else None)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Whether some train meets all limits."""
    answer = _able(scene.request(), clock)
    return UNKNOWN if answer is None else Verdict(answer)


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies:
    """The conflict, and every number that alone makes the file possible."""
    names, unsure = conflict(scene.request(), clock)
    asked = FeasibilityQuestions(scene, possible, clock, lower_bounds=True)
    known = singles(asked, (Group((move,)) for move in _moves(scene, clock)))
    known = [replace(r, kind="choice") if r.changes[0].key == "train.spacing" else r for r in known]
    late = "the budget ended before all remedies were tried" if clock.over else ""
    return Remedies(names, with_least(known, not clock.over), late, unsure=unsure)


def conflict(request: Request, clock: Clock) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Limits that no train meets together, each of which is needed for that; those not sure.

    Equal centre distances are kept: alone in conflict where no limit else is needed.
    """
    kept, unsure = [*ASKED], []
    for name in ASKED:
        fewer = [other for other in kept if other != name]
        without = tuple(other for other in ASKED if other not in fewer)
        answer = _able(replace(request, without=without), clock)
        if answer is False:
            kept = fewer
        elif answer is None:
            unsure.append(name)
    return (tuple(kept) or (COAXIAL,)), tuple(unsure)


def _nearest(request: Request, goal: str, limit: str, clock: Clock) -> Key | None:
    """The best train for a goal without a limit, as `Best` has it."""
    return best(replace(request, goal=goal, without=(limit,)), Clock(clock.left)).key


def _moves(scene: Scene, clock: Clock) -> Iterator[Move]:
    request, train, limits = scene.request(), scene.train, scene.limits
    if limits.ratio_tolerance is not None and (key := _nearest(request, ERROR, TOLERANCE, clock)):
        if (tolerance := cut(key[0], 1, DIGITS)) > 0:
            place = ("limits", "ratio_tolerance")
            yield Move(place, 1).to_values(limits.ratio_tolerance, [tolerance])
        ratio = request.exact_ratio(key[2])
        yield Move(("train", "ratio"), 1, DUTY).to_values(request.ratio, [ratio])
    if limits.minimum_efficiency is not None:
        key = _nearest(request, LOSS, EFFICIENCY, clock)
        if key is not None and (eta := cut(Fraction(1 - key[0]), -1, DIGITS)) > 0:
            place = ("limits", "minimum_efficiency")
            yield Move(place, -1).to_values(limits.minimum_efficiency, [eta])
    yield Move(("limits", "ring_minus_planet"), -1)
    if limits.neighbour_clearance:
        yield Move(("limits", "neighbour_clearance"), -1)
    now = limits.coaxial_difference
    more = [*range(now + 1, min(now + 5, MAX_SHIFTED) + 1)]
    steps = [1.0 + k for k, _ in enumerate(more, 1)]
    yield Move(("limits", "coaxial_difference"), 1).to_choices(now, steps, more, more)
    for name in ("planets", "planets2"):
        if count := getattr(train, name):
            others = [n for n in range(2, min(count + 2, MAX_PLANETS) + 1) if n != count]
            near = sorted(others, key=partial(apart, count))
            yield Move(("train", name), 1).to_values(count, near)
    if request.equal:
        switch = ("train.spacing", '"equal"', '"nearest"')
        yield Move(("train", "spacing"), 1, steps=(2.0,), write=lambda *_: "nearest", switch=switch)
    for number in numbers(scene):
        if number.path[0] == "teeth" and len(number.path) == 3:
            yield Move(number.path, 1 if number.path[2] else -1, far=FAR)
        elif number.path[0] == "teeth":
            z = number.value
            near = [z + k * way for k in range(1, NEAR + 1) for way in (1, -1)]
            allowed = [z for z in near if MIN_TEETH <= z <= MAX_TEETH]
            yield Move(number.path, 1).to_values(z, allowed)
