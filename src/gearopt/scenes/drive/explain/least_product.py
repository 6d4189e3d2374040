"""Several numbers of an impossible drive moved together: the minimum product of factors.

Real-valued numbers by the elastic form; given tooth numbers and modules by bisection of boxes. A
box is a range of each number; where a drive that may choose within the box is impossible, so is
every choice of its numbers. Boxes are taken by the smallest product they hold, so that the first
single choice that is possible is the minimum.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.drive import continuous_sizing, sizing_text
from gearopt.formulations.drive.teeth.choices import best_pairs
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import best_first
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.handles import Handle, handles
from gearopt.optimise.explaining.repair import FARTHEST, PRODUCT_TIE, least_factors
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import solve_within
from gearopt.scenes.drive.driving import trains
from gearopt.scenes.drive.explain.moves import (
    WIDTH,
    applied,
    comparable,
    moves_of,
    reachable,
    shared,
    stage_of,
    steps,
)
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import enlarged, trimmed
from gearopt.scenes.explaining.moves import DUTY, LIMIT, SIZE, Move, Moves

EDGE = 1.001  # a reach is known this closely; it ends between two values
QUESTIONS = 60  # at most, whether the drives of a box are possible
MET_FROM = 1.0 - 1e-6  # a value this close to what is needed is that one
MAX_ROUNDED_NUMBERS = 3  # whole numbers of which both neighbours are tried
Box = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Choice:
    """A given number: its stage (from 0), and the factors (n,) and moves of its values, by size.

    Where the file's own value stands, the factor is 1 and the number None.
    """

    stage: int
    field: str
    values: tuple[Any, ...]
    factors: tuple[float, ...]
    moves: tuple[Move | None, ...]


def smallest_together(case: Case, movable: list[Move], most: float) -> tuple[Moves, bool] | None:
    """Return moves of given numbers with the smallest product below `most`; whether that is proven.

    None where there are none. After so many questions, the best that was met on the way.
    """
    choices = _choices(case, movable, most)
    if not choices:
        return None
    sure, asked, train = True, 0, case.scene.train()
    best: Box | None = None

    def branch(_: float, box: Box) -> Iterator[tuple[float, Box]]:
        nonlocal sure, asked, best, most
        single = all(i == j for i, j in box)
        met = _possible_choice(case, _within(train, choices, box), choices, box)
        asked, sure = asked + 1, sure and met is not None
        if isinstance(met, tuple) and _product(choices, met) < most:
            best, most = met, _product(choices, met)
        if met is not False and not single:
            for part in _parts(choices, box):
                if (product := _product(choices, part)) < most:
                    yield product, part

    whole: Box = tuple((0, len(c.values) - 1) for c in choices)
    left = best_first(
        [(1.0, whole)], lambda product, _: asked < QUESTIONS and product < most, branch
    )
    if best is None:
        return None
    return _moves(choices, best), sure and left.least >= most


def _possible_choice(
    case: Case, train: Train, choices: list[Choice], box: Box
) -> Box | bool | None:
    """Return a single choice of a box that is possible; False: none is; None: not known.

    Where it is known to be possible, but not with which numbers, True for a box of several.
    """
    if case.scene.teeth is None:
        verdict = case.possible(train)
        return box if verdict and all(i == j for i, j in box) else verdict
    teeth = case.teeth(train)
    if not teeth:
        return False if teeth == () else None
    pairs = best_pairs(train, teeth)
    places = []
    for choice in choices:
        pinion, wheel = teeth[choice.stage]
        module = Fraction(pairs[choice.stage].normal_module).limit_denominator(10**6)
        value = {"pinion_teeth": pinion, "wheel_teeth": wheel, "module": module}[choice.field]
        places.append(choice.values.index(value))
    return tuple((j, j) for j in places)


def _choices(case: Case, movable: list[Move], most: float) -> list[Choice]:
    """Return the numbers that may be moved together, with their values of a factor below `most`."""
    numbers: dict[tuple[Any, ...], list[tuple[Any, float, Move | None]]] = {}
    train = case.scene.train()
    for number in movable:
        if number.role == SIZE:
            reach = EDGE * number.far
            for factor in steps(case.scene, number):
                if factor < most and factor <= reach:
                    value = _plain(case.scene, train, number.path, factor, number.way)
                    numbers.setdefault(number.path, []).append((value, factor, number))
    choices = []
    for path, known in numbers.items():
        given = _plain(case.scene, train, path), 1.0, None
        rows = sorted([*known, given], key=lambda row: row[0])
        values, factors, moved = zip(*rows, strict=True)
        choices.append(Choice(int(path[1]), str(path[2]), values, factors, moved))
    return choices


def _plain(
    scene: Scene, train: Train, path: tuple[Any, ...], factor: float = 1.0, direction: int = 1
) -> Any:
    """Given number of a stage as the train has it, moved: teeth, or a module in mm."""
    stage = train.stages[path[1]]
    if path[2] != "module":
        return round(getattr(stage, path[2])[0] * factor**direction)
    now = stage.modules[0]
    known = (now,) if factor == 1.0 or scene.teeth is None else scene.teeth.sizes
    return min(known, key=lambda m: abs(float(m) - float(now) * factor**direction))


def _within(train: Train, choices: list[Choice], box: Box) -> Train:
    """Return the drive that may choose its given numbers from a box."""
    stages = list(train.stages)
    for choice, (i, j) in zip(choices, box, strict=True):
        ends: Any = (choice.values[i], choice.values[j])
        if choice.field == "module":
            ends = tuple(Fraction(v) for v in choice.values[i : j + 1])
        name = "modules" if choice.field == "module" else choice.field
        stages[choice.stage] = replace(stages[choice.stage], **{name: ends})
    return replace(train, stages=tuple(stages))


def _parts(choices: list[Choice], box: Box) -> list[Box]:
    """Return a box cut along its widest range: at the file's own value, else in halves."""
    spread = [
        math.log(max(c.factors[i : j + 1])) + (i < j) * 1e-9
        for c, (i, j) in zip(choices, box, strict=True)
    ]
    spread = [s if i < j else -1.0 for s, (i, j) in zip(spread, box, strict=True)]
    k = spread.index(max(spread))
    (i, j), factors = box[k], choices[k].factors
    unchanged = factors.index(1.0)
    if i <= unchanged <= j:
        ranges = [(i, unchanged - 1), (unchanged, unchanged), (unchanged + 1, j)]
    else:
        ranges = [(i, (i + j) // 2), ((i + j) // 2 + 1, j)]
    return [(*box[:k], r, *box[k + 1 :]) for r in ranges if r[0] <= r[1]]


def _product(choices: list[Choice], box: Box) -> float:
    """Return the smallest product of factors in a box."""
    return math.prod(min(c.factors[i : j + 1]) for c, (i, j) in zip(choices, box, strict=True))


def _moves(choices: list[Choice], box: Box) -> Moves:
    moved = []
    for choice, (i, _) in zip(choices, box, strict=True):
        number = choice.moves[i]
        if number is not None:
            moved.append((number, choice.factors[i]))
    return tuple(moved)


def is_real(scene: Scene, clock: Clock) -> bool:
    """Return whether real-valued sizes are impossible too."""
    real = (continuous_sizing.problem(train) for train in trains(scene))
    return all(solve_within(clock, one).status == "infeasible" for one in real)


def posed(scene: Scene) -> tuple[Problem, list[Handle], list[Move]]:
    """The problem with real-valued sizes, its relaxable numbers, and the file's."""
    train = scene.train()
    base = sizing_text.movable(train)
    known = [_named(h, train, scene.teeth is None) for h in handles(base)]
    movable = [reachable(scene, number) for number in moves_of(scene, known)]
    return base, known, [m for m in movable if m.far > 1.0]


def _named(handle: Handle, train: Train, whole: bool) -> Handle:
    """Return a handle named as in the file, with its stage; whole: limits of teeth are rounded.

    Given teeth are not: they are set first, and the others follow.
    """
    name = handle.name
    if handle.family == "wheel_teeth":
        name = f"wheel_teeth[{sizing_text.given_wheels(train)[stage_of(handle)] + 1}]"
    if handle.family == "width_high" and handle.given:
        name = f"{WIDTH}[{stage_of(handle) + 1}]"
    return replace(handle, name=name, whole=whole and not handle.given and "teeth" in handle.family)


def together(case: Case, base: Problem, movable: list[Move]) -> tuple[float | None, Moves | None]:
    """Return the proven minimum product over all limits and given sizes, and moves of about that.

    Whole numbers that are given are set first: the others follow them.
    """
    smallest = _smallest_moves(case, base, movable)
    if smallest is None:
        return None, None
    moves, bound = smallest
    stepped = tuple(m for m in moves if is_stepped(case.scene, m[0]))
    others = tuple(m for m in moves if m not in stepped)
    for whole in _rounded(case.scene, stepped):
        edited = applied(case.scene, whole) if whole else None
        rest = others if edited is None else _after(case, edited.scene)
        with_rest = None if rest is None else _beside(case, whole, rest)
        if with_rest is not None:
            return bound, with_rest
    return bound, _from_sizes(case, movable, tuple(m for m in others if m[0].role == SIZE))


def _rounded(scene: Scene, moves: Moves) -> list[Moves]:
    """Return moves of whole numbers at the value beyond or before what real-valued sizes need."""
    ways = []
    for number, factor in moves:
        known = [1.0, *steps(scene, number)]
        beyond = next((k for k, f in enumerate(known) if f >= factor * MET_FROM), len(known) - 1)
        exact = known[beyond] <= factor / MET_FROM
        ways.append([(number, f) for f in known[beyond - (not exact) : beyond + 1][::-1]])
    if len(ways) > MAX_ROUNDED_NUMBERS:  # too many to try all: all beyond
        ways = [way[:1] for way in ways]
    return [tuple(m for m in way if m[1] > 1.0) for way in itertools.product(*ways)]


def _beside(case: Case, fixed: Moves, rest: Moves) -> Moves | None:
    """Return fixed moves, and the smallest of others that suffice beside them."""
    asked = case.asked
    if fixed and asked.possible_with(fixed):
        return fixed
    if case.scene.teeth is None and asked.possible_with((*fixed, *rest)):
        return (*fixed, *rest)
    limits = tuple(m for m in rest if m[0].role == LIMIT)
    given = tuple(m for m in rest if m not in limits)
    for still, alike in ((given, limits), ((), rest)):  # what is given need not be easier further
        beside = (*fixed, *still)
        larger = enlarged(asked.beside(beside), alike) if alike else None
        if larger is not None:
            return (*beside, *trimmed(asked.beside(beside), larger))
    return None


def _from_sizes(case: Case, movable: list[Move], real: Moves) -> Moves | None:
    """Return given whole numbers moved as little as possible under wide limits, then limits.

    real: given real-valued sizes that move too.
    """
    limits = widest(movable)
    wide = [(m, min(FARTHEST, m.far)) for m in limits]
    edited = applied(case.scene, (*wide, *real))
    if edited is None:
        return None
    there = smallest_together(Case(edited.scene, case.clock), movable, FARTHEST)
    rest = (*real, *((m, 1.0) for m in limits))
    return None if there is None else _beside(case, there[0], rest)


def _smallest_moves(
    case: Case, base: Problem, movable: Sequence[Move]
) -> tuple[Moves, float | None] | None:
    """Return the moves of limits and given sizes of the smallest product, and its bound."""
    groups = [m for m in movable if m.role != DUTY]
    solution = least_factors(base, [m.handles for m in groups], case.clock) if groups else None
    if solution is None:
        return None
    factors, _, bound = solution
    moves = tuple(
        (m, float(f)) for m, f in zip(groups, factors, strict=True) if f > 1.0 + PRODUCT_TIE
    )
    return moves, bound if comparable(case.scene, groups) else None


def _after(case: Case, scene: Scene) -> Moves | None:
    """Return the moves of limits and real-valued sizes that a scene needs; None: none do."""
    if not is_real(scene, case.clock):
        return ()
    base, _, movable = posed(scene)
    smallest = _smallest_moves(case, base, [m for m in movable if not is_stepped(scene, m)])
    return None if smallest is None else smallest[0]


def is_stepped(scene: Scene, number: Move) -> bool:
    """Return whether a number is given and may only take steps."""
    return number.role == SIZE and bool(steps(scene, number))


def widest(movable: Sequence[Move]) -> list[Move]:
    """Return all limits, where they stand for most stages."""
    limits = [m for m in movable if m.role == LIMIT]
    common = {m.family for m in limits if shared(m)}
    return [m for m in limits if shared(m) or m.family not in common]
