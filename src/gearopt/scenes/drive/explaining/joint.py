"""Given tooth numbers and modules moved together: the least product of factors, by bisection.

A box is a range of each number; where a drive that may choose within the box is impossible, so is
every choice of its numbers. Boxes are taken by the least product they hold, so that the first
single choice that is possible is the least one.
"""

import heapq
import itertools
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.gear_train import Train
from gearopt.formulations.teeth import best_pairs
from gearopt.scenes.drive.explaining.levers import Lever, Moves, steps
from gearopt.scenes.drive.explaining.tried import Case
from gearopt.scenes.drive.scene import Scene

EDGE = 1.001  # a reach is known this closely; it ends between two values
QUESTIONS = 60  # at most, whether the drives of a box are possible
Box = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Choice:
    """A given number: its stage (from 0), and the factors (n,) and levers of its values, by size.

    Where the file's own value stands, the factor is 1 and the lever None.
    """

    stage: int
    field: str
    values: tuple[Any, ...]
    factors: tuple[float, ...]
    levers: tuple[Lever | None, ...]


def least_together(case: Case, levers: list[Lever], most: float) -> tuple[Moves, bool] | None:
    """Moves of given numbers with the least product below `most`; and whether none has less.

    None where there are none. After so many questions, the best that was met on the way.
    """
    choices = _choices(case, levers, most)
    if not choices:
        return None
    sure, order, train = True, itertools.count(), case.scene.train()
    whole: Box = tuple((0, len(c.values) - 1) for c in choices)
    best: Box | None = None
    heap = [(1.0, next(order), whole)]
    for _ in range(QUESTIONS):
        if not heap or heap[0][0] >= most:
            return None if best is None else (_moves(choices, best), sure)
        _, _, box = heapq.heappop(heap)
        one = all(i == j for i, j in box)
        found = _met(case, _within(train, choices, box), choices, box)
        sure = sure and found is not None
        if isinstance(found, tuple) and _product(choices, found) < most:
            best, most = found, _product(choices, found)
        if found is not False and not one:
            for part in _parts(choices, box):
                if (product := _product(choices, part)) < most:
                    heapq.heappush(heap, (product, next(order), part))
    return None if best is None else (_moves(choices, best), False)


def _met(case: Case, train: Train, choices: list[Choice], box: Box) -> Box | bool | None:
    """A single choice of a box that is possible; False where none is, None where it is not known.

    Where it is known to be possible, but not with which numbers, True for a box of several.
    """
    if case.scene.teeth is None:
        found = case.possible(train)
        return box if found and all(i == j for i, j in box) else found
    teeth = case.teeth(train)
    if not teeth:
        return False if teeth == () else None
    made = best_pairs(train, teeth)
    places = []
    for choice in choices:
        pinion, wheel = teeth[choice.stage]
        module = Fraction(made[choice.stage].normal_module).limit_denominator(10**6)
        value = {"pinion_teeth": pinion, "wheel_teeth": wheel, "module": module}[choice.field]
        places.append(choice.values.index(value))
    return tuple((j, j) for j in places)


def _choices(case: Case, levers: list[Lever], most: float) -> list[Choice]:
    """The numbers that may be moved together, with their values of a factor below `most`."""
    numbers: dict[tuple[Any, ...], list[tuple[Any, float, Lever | None]]] = {}
    for lever in levers:
        if lever.sort == "size":
            reach = EDGE * lever.reach
            for factor in steps(case.scene, lever):
                if factor < most and factor <= reach:
                    row = (_plain(case.scene, lever.path, factor, lever.direction), factor, lever)
                    numbers.setdefault(lever.path, []).append(row)
    found = []
    for path, known in numbers.items():
        rows = sorted([*known, (_plain(case.scene, path), 1.0, None)], key=lambda row: row[0])
        values, factors, moved = zip(*rows, strict=True)
        found.append(Choice(int(path[1]), str(path[2]), values, factors, moved))
    return found


def _plain(scene: Scene, path: tuple[Any, ...], factor: float = 1.0, direction: int = 1) -> Any:
    """A given number of a stage as the train has it, moved: teeth, or a module in mm."""
    stage = scene.train().stages[path[1]]
    if path[2] != "module":
        return round(getattr(stage, path[2])[0] * factor**direction)
    now = stage.modules[0]
    known = (now,) if factor == 1.0 or scene.teeth is None else scene.teeth.modules
    return min(known, key=lambda m: abs(float(m) - float(now) * factor**direction))


def _within(train: Train, choices: list[Choice], box: Box) -> Train:
    """The drive that may choose its given numbers from a box."""
    stages = list(train.stages)
    for choice, (i, j) in zip(choices, box, strict=True):
        ends: Any = (choice.values[i], choice.values[j])
        if choice.field == "module":
            ends = tuple(Fraction(v) for v in choice.values[i : j + 1])
        name = "modules" if choice.field == "module" else choice.field
        stages[choice.stage] = replace(stages[choice.stage], **{name: ends})
    return replace(train, stages=tuple(stages))


def _parts(choices: list[Choice], box: Box) -> list[Box]:
    """A box cut along its widest range: at the file's own value, else in halves."""
    spread = [
        math.log(max(c.factors[i : j + 1])) + (i < j) * 1e-9
        for c, (i, j) in zip(choices, box, strict=True)
    ]
    spread = [s if i < j else -1.0 for s, (i, j) in zip(spread, box, strict=True)]
    k = spread.index(max(spread))
    (i, j), factors = box[k], choices[k].factors
    own = factors.index(1.0)
    if i <= own <= j:
        ranges = [(i, own - 1), (own, own), (own + 1, j)]
    else:
        ranges = [(i, (i + j) // 2), ((i + j) // 2 + 1, j)]
    return [(*box[:k], r, *box[k + 1 :]) for r in ranges if r[0] <= r[1]]


def _product(choices: list[Choice], box: Box) -> float:
    """The least product of factors in a box."""
    return math.prod(min(c.factors[i : j + 1]) for c, (i, j) in zip(choices, box, strict=True))


def _moves(choices: list[Choice], box: Box) -> Moves:
    moved = []
    for choice, (i, _) in zip(choices, box, strict=True):
        lever = choice.levers[i]
        if lever is not None:
            moved.append((lever, choice.factors[i]))
    return tuple(moved)
