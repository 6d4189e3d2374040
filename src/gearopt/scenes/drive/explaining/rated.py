"""Remedies of an impossible drive that ratings limit: each number or choice of the file alone."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import THERE
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.explaining.repair import FACTOR_TOLERANCE, FACTORS_TRIED, SLACK_TRIED
from gearopt.optimise.result import Budget
from gearopt.scenes.drive.explaining.influences import GRADES, eases
from gearopt.scenes.drive.explaining.movable import WIDTH, next_module
from gearopt.scenes.drive.explaining.rated_choices import choices
from gearopt.scenes.drive.explaining.rated_conflict import Conflict, conflict, possible
from gearopt.scenes.drive.explaining.requirements import ORDER, TEETH
from gearopt.scenes.drive.explaining.tried import Case
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import (
    Number,
    apart,
    eased,
    moved,
    numbers,
    taken_back,
    written,
)
from gearopt.scenes.reading.toml import toml_text

DUTY = ("duty", "power")
# at most, for the conflict beside an answer, and beside remedies
CONFLICT_SECONDS, CONFLICT_SECONDS_BESIDE_REMEDIES = 3.0, 6.0
# s, at most, for the numbers that help, and for one question
ROUGH_SECONDS, QUESTION_SECONDS = 7.0, 2.0
# factors of a remedy of use; the first that the file may have
FACTORS_OFFERED = (3.0, 2.0, 1.4, 1.2, 1.1)
ROUGH = 1.02  # ratio of a refused to an allowed factor up to which every number is known first
SHARE_OF_TIME = 0.4  # at most, of the time that is left, for each of these
SHARPEN_SECONDS, CHOICE_SECONDS = 2.0, 4.0  # s, at most, to make them sharper, and for choices
STEPPED = (*GRADES, "accuracy_grade", "grade")  # moved by ones

Works = Callable[[Scene], bool | None]


@dataclass
class _Found:
    """A number that helps alone; it has state because the search narrows it.

    low: the largest factor, or step, that is known not to suffice, high: the smallest that is known
    to; sure: whether `low` is proven not to.
    """

    number: Number
    way: int
    low: float
    high: float
    sure: bool = True
    values: tuple[Any, ...] = ()

    def value(self, at: float) -> Any:
        """Return what to write for a factor, or a step."""
        if self.values:
            return self.values[round(at)]
        return eased(self.number.value, at, self.way)


def conflict_soon(scene: Scene, clock: Clock) -> Remedies | None:
    """Conflict of an impossible drive alone; None where it is not found soon."""
    known = conflict(Case(scene, Clock(Budget(clock.within(CONFLICT_SECONDS)), clock.watch)))
    if not known.proven:
        return None
    return Remedies(known.names, any_resolves=known.any_resolves, untried=True)


def remedies(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Remedies:
    """Return the conflict, and what alone makes the drive possible, smallest changes first.

    status(scene): of a changed drive, solved; asked where sizes are real-valued.
    """

    def within(seconds: float) -> Clock:
        left = clock.left.seconds
        own = seconds if left is None else min(seconds, SHARE_OF_TIME * left)
        return Clock(Budget(own), clock.watch)

    known = conflict(Case(scene, within(CONFLICT_SECONDS_BESIDE_REMEDIES)))
    case = Case(scene, clock, seconds=QUESTION_SECONDS)

    def works(other: Scene) -> bool | None:
        if other.teeth is None:
            word = status(other)
            return True if word in THERE else (False if word == "infeasible" else None)
        return possible(case, [other.held(count).train() for count in other.counts])

    first = within(ROUGH_SECONDS)
    found = _known(scene, known, first, works)
    if not found:
        first = clock
        found = _known(scene, Conflict(), clock, works, FACTORS_TRIED[::-1])
    untried = first.over
    sharp = within(SHARPEN_SECONDS)
    own = [_remedy(scene, one, sharp, works) for one in found]
    own.sort(key=lambda r: (r.kind == "less", r.factor))
    own = _with_least(own, not (untried or clock.over or case.open))
    last = within(CHOICE_SECONDS)
    chosen = tuple(choices(scene, known, lambda other: None if last.over else works(other)))
    untried = untried or last.over
    late = "time ran out before all remedies were tried" if clock.over else ""
    late = late or ("not all remedies were tried" if untried else "")
    words = "; ".join(filter(None, (_doubts(known), late)))
    return Remedies(known.names, (*own, *chosen), words, known.any_resolves, known.unsure)


def _doubts(known: Conflict) -> str:
    return "" if known.names else "time ran out before the conflict was identified"


def _with_least(found: list[Remedy], tried: bool) -> list[Remedy]:
    """Return remedies of which the smallest that keeps the duty is said to be so.

    tried: whether all others were, with an answer.
    """
    if not found or found[0].kind == "less":
        return found
    sure = tried and found[0].verified["with_less"] == "infeasible"
    verified = {**found[0].verified, "others": "need more" if sure else "not all known"}
    return [replace(found[0], kind="least", verified=verified), *found[1:]]


def _known(
    scene: Scene,
    known: Conflict,
    clock: Clock,
    works: Works,
    most: Sequence[float] = FACTORS_OFFERED,
) -> list[_Found]:
    """Return the numbers that help alone, each known roughly."""
    found = []
    for number, way in _numbers(scene, known):
        one = None if clock.over else _first(scene, number, way, works, most)
        if one is not None:
            _narrow(scene, one, clock, works, ROUGH)
            found.append(one)
    return found


def _numbers(scene: Scene, known: Conflict) -> Iterator[tuple[Number, int]]:
    """Yield the numbers that may help, and the direction that does; teeth come last.

    What is in no conflict keeps the drive impossible however it is moved.
    """
    dropped = known.names and {name.split("[")[0] for name in known.names}
    for number in sorted(numbers(scene), key=_rank):
        way = -1 if number.path == DUTY else eases(scene, number) or _wider(number)
        name = _name(number) if way else ""
        if way and not (dropped and name in _PROVEN and name not in dropped):
            yield number, way


_PROVEN = (  # whose moves up to FACTORS_OFFERED are within what the conflict was proven without
    *("minimum_bending_safety", "minimum_contact_safety", "life", "module_high", "module_low"),
    *("wheel_diameter", "stage_ratio_high", "stage_ratio_low", "least_face_width"),
    *("face_width_over_module_high", "face_width_over_module_low", "face_width_low"),
    *("wheel_teeth_high", "wheel_teeth_low", "face_width_high"),
)


def _name(number: Number) -> str:
    """Return the requirement that a number is of."""
    end = number.path[-1] if isinstance(number.path[-1], int) else None
    field = str(number.path[-1] if end is None else number.path[-2])
    own = {"minimum_face_width": "least_face_width", "input_revolutions": "life"}
    tail = ("_low", "_high")[end] if end in (0, 1) else ""
    return own.get(field, field.replace(WIDTH, "face_width" if tail else WIDTH)) + tail


def _wider(number: Number) -> int:
    """Return +1 for a face width that is tied or given, else 0."""
    return int(number.path[-1] in (WIDTH, "face_width"))


def _rank(number: Number) -> tuple[bool, int]:
    """Return what sorts numbers: ranges of teeth take longest, and likely conflicts come first."""
    slow = any(str(step).endswith("_teeth") for step in number.path)
    likely, name = ORDER[0], _name(number)
    return slow, likely.index(name) if name in likely else len(likely)


def _first(
    scene: Scene, number: Number, way: int, works: Works, most: Sequence[float]
) -> _Found | None:
    """Return a number that helps within the largest factor its file allows; None: it does not."""
    values = _steps(scene, number, way)
    if values is not None:
        for k, value in enumerate(values):
            other = moved(scene, number.path, value)
            answer = None if other is None else works(other)
            if answer:
                return _Found(number, way, k - 1, k, True, values)
            if answer is None:
                break
        return None
    if isinstance(number.value, int):
        most = tuple(min(f, float(TEETH)) for f in most)
    for factor in most:
        other = moved(scene, number.path, eased(number.value, factor, way))
        answer = None if other is None else works(other)
        if answer is not None:
            return _Found(number, way, 1.0, factor) if answer else None
    return None


def _steps(scene: Scene, number: Number, way: int) -> tuple[Any, ...] | None:
    """Return the next values of a number that takes steps, near ones first; None: it takes none."""
    if scene.teeth is not None and "module" in number.path:
        found, value = list[Any](), next_module(scene, number.value, way)
        while value is not None and apart(number.value, value) <= FACTORS_OFFERED[0]:
            found.append(value)
            value = next_module(scene, value, way)
        return tuple(found)
    if number.path[-1] in STEPPED:
        return tuple(number.value + way * k for k in (1, 2, 3))
    return None


def _narrow(scene: Scene, one: _Found, clock: Clock, works: Works, close: float) -> None:
    """Halve what is not known of a number, until its ends are as close as this."""
    while not one.values and one.high > one.low * close and not clock.over:
        middle = math.sqrt(one.low * one.high)
        if one.value(middle) in (one.value(one.high), one.value(one.low)):
            break  # of whole numbers
        other = moved(scene, one.number.path, one.value(middle))
        answer = None if other is None else works(other)
        one.low, one.high = (one.low, middle) if answer else (middle, one.high)
        one.sure = bool(answer) and one.sure or answer is False
    return None


def _remedy(scene: Scene, one: _Found, clock: Clock, works: Works) -> Remedy:
    """Return a number that helps as a remedy, as little as is known to suffice."""
    _narrow(scene, one, clock, works, FACTOR_TOLERANCE)
    number = one.number
    value = one.value(one.high)
    was, write = (toml_text(written(v, number.path)) for v in (number.value, value))
    factor = apart(number.value, value)
    change = Change(number.key, was, write, factor)
    kind = "less" if number.path == DUTY else "alone"
    verified = {"with": "feasible", "with_less": _less(scene, one, clock, works)}
    return Remedy(kind, number.key, (change,), factor, None, verified)


def _less(scene: Scene, one: _Found, clock: Clock, works: Works) -> str:
    """Return what is known of a number moved a little less: infeasible or undecided."""
    number, value = one.number, one.value(one.high)
    if one.values:
        return "infeasible"  # every step before was tried
    if clock.over:
        return "undecided"
    back = moved(scene, number.path, taken_back(value, number.value, SLACK_TRIED))
    return "infeasible" if back is not None and works(back) is False else "undecided"
