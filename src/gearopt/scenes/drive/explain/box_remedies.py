"""Remedies of an impossible layout, each of them tried; sensitivities of a possible one."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.design import DriveDesign, drive_design
from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.layout.faults import faults, possible
from gearopt.formulations.drive.layout.layout_text import placed, read
from gearopt.formulations.drive.layout.slabs import Arrangement, arrangements
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import STEP
from gearopt.optimise.explaining.explanation import Explanation, Remedies, Remedy
from gearopt.optimise.explaining.repair import CERTAIN, FACTOR_TOLERANCE
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.described_layout import described, keep_out_design
from gearopt.scenes.drive.explain import box_at_once
from gearopt.scenes.drive.explain.box_at_once import (
    LIMITS,
    SIDES,
    Search,
    first_layout,
    in_conflict,
    least_side,
    searches,
)
from gearopt.scenes.drive.explain.box_moves import (
    BoxMove,
    box_moves,
    limits_of,
    switches,
)
from gearopt.scenes.drive.explain.other_gears import other_gears
from gearopt.scenes.drive.layout import box_first, others_may_fit
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import (
    FactorBracket,
    FeasibilityQuestions,
    as_remedy,
    least,
    narrow,
    smallest,
)
from gearopt.scenes.explaining.influences import SMALL_CHANGES, Basis, influences, smooth
from gearopt.scenes.explaining.moves import SET, Move
from gearopt.scenes.explaining.numbers import numbers
from gearopt.scenes.explaining.possible import Verdict
from gearopt.units import Quantity

SECONDS = 2.0  # at most, for one question whether a layout is possible
HALF = 0.5  # the same while a size is halved: what fits is found in less, mostly
BRIEF = 0.2  # and beyond a size that stayed undecided
PAIRS = 6  # that are worked out
HALVINGS = 20  # questions of a change that may stay open
SENSITIVITY_GAP = 0.01  # gap of the proof behind a sensitivity: the polished layout is far closer
SIZE_TIE = 1e-7  # relative, of boxes that are equal
GEARS_FIRST = "smallest changes are those for the gears sized first: others may need less"
TABLES = ("layout", "place", "keep_out")
Pair = tuple[BoxMove, BoxMove]
Found = tuple[float, Remedy, Scene]  # how much is changed, and the file with it


def questions(scene: Scene, pairs: tuple[GearPair, ...], clock: Clock) -> FeasibilityQuestions:
    """Return the questions whether these gears can be laid out in changed files."""

    def fits(other: Scene, clock: Clock) -> Verdict:
        box = gearbox_of(other, pairs)
        if box is None or faults(box):
            return Verdict(False)
        return Verdict(possible(box, clock.within(SECONDS), clock.watch))

    return FeasibilityQuestions(
        scene,
        fits,
        clock,
        seconds=SECONDS,
        halving=(HALF, BRIEF),
        doubts=HALVINGS,
        ladder=(),
        far=math.inf,
    )


def remedies(scene: Scene, gears: Result, clock: Clock) -> Remedies:
    """Each change that alone lets these gears be laid out; else pairs of changes.

    drawn: a layout of the file with the first of them.
    """
    begun = clock.seconds
    layout.ready(clock.watch)
    clock.start += clock.seconds - begun  # compiling takes no time of the remedies
    pairs = scene.pairs(drive_design(gears.design))
    single, choices = box_moves(scene, pairs), switches(scene)
    if box_first(scene):
        return _of_any_gears(scene, single, choices, clock)
    asked = questions(scene, pairs, clock)
    chosen = [r for m in choices if (r := _sufficient_switch(asked, m)) is not None]
    moved = [r for m in single if (r := _least_change(asked, m)) is not None]
    sufficient = sorted(moved, key=_size) + chosen
    message = ""
    if sufficient and asked.open:
        message = f"time ran out before it was known whether {', '.join(asked.open)} alone suffices"
    elif not sufficient:
        both = _pairs(asked, single + choices[::-1])  # of two tables the last goes first
        sufficient = sorted(both, key=_size)
        if asked.open and not sufficient:
            message = "no remedy was found, and time ran out before every change was decided"
        elif not sufficient:
            none = "no layout was found by changing one or two numbers within these ranges"
            message = f"{none}: {', '.join(limits_of(single + choices))}"
    if clock.over:
        message = "time ran out before all remedies were tried"
    changed = sufficient[0][2] if sufficient else None
    known = tuple(remedy for _, remedy, _ in sufficient)
    more, unknown = other_gears(scene, pairs, known, clock)
    first = GEARS_FIRST if known and others_may_fit(scene, scene.gearbox(pairs)) else ""
    words = "; ".join(filter(None, (message, first, unknown)))
    ways = _of_gears(scene, known, more, words)
    drawn = None if changed is None else _nearest(scene, changed, gears, clock)
    return ways if drawn is None else replace(ways, drawn={"nearest_layout": drawn})


def _of_any_gears(
    scene: Scene, single: tuple[BoxMove, ...], choices: tuple[BoxMove, ...], clock: Clock
) -> Remedies:
    """Limits in conflict, and each change that alone lets some gears be laid out; else two sides.

    Sides of the box first: their least sizes are minima.
    """
    search = searches(scene)
    asked = box_at_once.questions(scene, search, clock)
    names, unsure = in_conflict(asked)
    sides = [m for m in single if m.path[-1] in LIMITS]
    sufficient = [r for m in sides if (r := _side(asked, search, m)) is not None]
    for move in (m for m in single if m not in sides):
        if (remedy := _least_change(asked, move)) is not None:
            sufficient.append(remedy)
    sufficient.sort(key=_size)
    sufficient += [r for m in choices if (r := _sufficient_switch(asked, m)) is not None]
    if not sufficient:
        sufficient = sorted(_pairs(asked, tuple(sides)), key=_size)
    message = "time ran out before all remedies were tried" if clock.over else ""
    if not sufficient and not message:
        none = "no layout was found by changing one number of the layout, or two sides of the box"
        message = f"{none}: {', '.join(limits_of((*single, *choices)))}"
    known = tuple(remedy for _, remedy, _ in sufficient)
    ways = Remedies(names, known, message, unsure=unsure)
    there = first_layout(search, sufficient[0][2], clock) if sufficient else None
    return ways if there is None else replace(ways, drawn={"nearest_layout": _drawn(scene, *there)})


def _side(asked: FeasibilityQuestions, search: Search, own: BoxMove) -> Found | None:
    """Return the least size of a side of the box, if some gears fit with it."""
    if own.key.removeprefix("layout.largest_") not in SIDES:
        return _least_change(asked, own)
    known = least_side(search, asked.scene, own.move, asked.clock)
    remedy = None if known is None else as_remedy(asked, known, "least")
    there = None if known is None else asked.edited(((own.move, known.high),))
    if known is None or remedy is None or there is None:
        return None
    return own.change(known.high), remedy, there.scene


def _nearest(scene: Scene, changed: Scene, sized: Result, clock: Clock) -> dict[str, Any] | None:
    """A layout of a changed file, and what of the file as it is differs, for a drawing.

    None where none is found in SECONDS.
    """
    design = drive_design(sized.design)
    pairs = scene.pairs(design)
    box = changed.gearbox(pairs)
    budget = replace(clock.left, seconds=clock.within(SECONDS))
    result, outcome = run(layout.problem(box, None), None, budget, watch=clock.watch)
    if result.value is None or outcome.x is None:
        return None
    return _drawn(scene, design, box, *read(arrangements(box), outcome.x))


def _drawn(
    scene: Scene, design: DriveDesign, box: Gearbox, angles: tuple[float, ...], order: Arrangement
) -> dict[str, Any]:
    """A layout of a changed file, and what of the file as it is differs."""
    asked, arranged = scene.gearbox(box.pairs), placed(box, order, angles)
    gone = [keep_out_design(k, arranged) for k in asked.keep_outs if k not in box.keep_outs]
    return {
        "layout": untyped(described(box, order, angles, design)),
        "keep_outs": [untyped(k) for k in gone],
        "motor_mm": 2.0 * asked.motor if asked.motor != box.motor else None,
        "largest_mm": [None if math.isinf(v) else v for v in asked.largest],
    }


def _of_gears(
    scene: Scene, found: tuple[Remedy, ...], more: tuple[Remedy, ...], message: str
) -> Remedies:
    """Return remedies for one choice of gears, and more with others, which need no less.

    What is least for these gears need not be for others, which `together = true` allows.
    """
    assert scene.layout is not None
    if not scene.layout.together:
        return Remedies((), (*more, *found), message)
    found = tuple(
        replace(r, verified={k: v if k == "with" else "undecided" for k, v in r.verified.items()})
        for r in found
    )
    return Remedies((), (*more, *found), message)


def _size(found: Found) -> float:
    return found[0]


def gearbox_of(scene: Scene, pairs: tuple[GearPair, ...]) -> Gearbox | None:
    """Return the gearbox of a scene; None where numbers that were moved contradict each other."""
    try:
        return scene.gearbox(pairs)
    except ValueError:
        return None


def _least_change(asked: FeasibilityQuestions, own: BoxMove) -> Found | None:
    """Return the smallest known change of one number; None where none is known."""
    known = least(asked, ((own.move, 1.0),))
    if known is None:
        return None
    for move in (own.point, own.move) if own.point else (own.move,):
        remedy = as_remedy(asked, FactorBracket(((move, 1.0),), known.low, known.high), "least")
        there = asked.edited(((move, known.high),))
        if remedy is not None and there is not None:
            return own.change(known.high), remedy, there.scene
    asked.open.append(own.key)
    return None


def _sufficient_switch(asked: FeasibilityQuestions, own: BoxMove) -> Found | None:
    """Return a switch that suffices alone."""
    there = asked.edited(((own.move, SET),))
    answer = False if there is None else asked.verdict_of(there).answer
    if answer is None:
        asked.open.append(own.key)
    if there is None or not answer:
        return None
    remedy = Remedy("choice", own.move.words, there.changes, 1.0, None, {"with": "feasible"})
    return own.change(SET), remedy, there.scene


def _pairs(asked: FeasibilityQuestions, single: tuple[BoxMove, ...]) -> list[Found]:
    """Return two changes that do together, each as small as the other allows."""
    rough: list[tuple[float, list[tuple[Move, float]], Pair]] = []
    for pair in combinations(single, 2):
        if _same_place(*pair):
            continue
        known = smallest(asked, tuple((own.scaled, 1.0) for own in pair))
        if known is not None:
            moves = [(own.move, own.unscaled(known.high)) for own in pair]
            rough.append((_joint_change(pair, moves), moves, pair))
    remedies_of_two = []
    for _, moves, pair in sorted(rough, key=lambda r: r[0])[:PAIRS]:
        if (remedy := _together(asked, pair, moves)) is not None:
            remedies_of_two.append(remedy)
        else:
            asked.open.append(" and ".join(own.key for own in pair))
    return remedies_of_two


def _joint_change(pair: Pair, moves: Sequence[tuple[Move, float]]) -> float:
    """Return how much two moves change together, relative."""
    return sum(own.change(factor) for own, (_, factor) in zip(pair, moves, strict=True))


def _same_place(one: BoxMove, other: BoxMove) -> bool:
    """Return whether two moves change the same table or number, so that one undoes the other."""
    shared = min(len(one.path), len(other.path))
    return one.path[:shared] == other.path[:shared]


def _together(
    asked: FeasibilityQuestions, pair: Pair, moves: list[tuple[Move, float]]
) -> Found | None:
    """Return the remedy of two moves that suffice: one made smaller, then the other."""
    for k, (move, factor) in enumerate(moves):
        known = FactorBracket(((move, 1.0),), 1.0, factor)
        if move.switch is None:
            narrow(asked.beside((moves[1 - k],)), known, FACTOR_TOLERANCE)
        moves[k] = (move, known.high)
    remedy = as_remedy(asked, FactorBracket(tuple(moves), 1.0, 1.0), "pair")
    there = asked.edited(tuple(moves))
    if remedy is None or there is None:
        return None
    what = " and ".join(own.move.words for own in pair)
    remedy = replace(remedy, what=what, factor=math.inf)
    return _joint_change(pair, moves), remedy, there.scene


def explained(scene: Scene, result: Result, clock: Clock) -> Explanation:
    """Return the sensitivities of the box to every number of the tables of a layout."""
    if result.status not in CERTAIN or result.value is None:
        return Explanation(
            result, message="sensitivities need a proven layout", seconds=clock.seconds
        )
    sized = next((p for p in result.parts if p.name == "gears"), result)
    pairs = scene.pairs(drive_design(sized.design))

    def solved(other: Scene) -> float | None:
        box = gearbox_of(other, pairs)
        if box is None or faults(box):
            return None
        left = replace(clock.left, gap=SENSITIVITY_GAP)
        return solve(layout.problem(box), None, left, watch=clock.watch, gap=SENSITIVITY_GAP).value

    wanted = [
        n
        for n in numbers(scene)
        if n.path[0] in TABLES and isinstance(n.value, Quantity) and smooth(n)
    ]
    sensitivities = tuple(influences(scene, Basis(result.value, solved, step=STEP), clock, wanted))
    late = "; time ran out before all numbers were tried" if clock.over else ""
    return Explanation(
        result,
        binding=tuple(n for n, v in result.limits.items() if v > 1.0 - SIZE_TIE),
        influences=sensitivities,
        message=f"sensitivities are those of the box around these gears, {SMALL_CHANGES}{late}",
        seconds=result.seconds + clock.seconds,
    )
