"""Remedies of an impossible drive: edits of its file, each of them tried."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedies, Remedy
from gearopt.optimise.explaining.handles import Handle
from gearopt.optimise.explaining.repair import FARTHEST, PRODUCT_TIE, any_resolves, conflict, even
from gearopt.optimise.problem import Problem
from gearopt.scenes.drive.driving import may_drive
from gearopt.scenes.drive.explain.choices import eased_tolerance, nearest_ratio, switches
from gearopt.scenes.drive.explain.least_product import (
    is_real,
    is_stepped,
    posed,
    smallest_together,
    together,
    widest,
)
from gearopt.scenes.drive.explain.moves import bound_of, comparable, shared, steps
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import (
    JOINT,
    FactorBracket,
    FeasibilityQuestions,
    as_remedy,
    enlarged,
    least,
    smallest,
    trimmed,
)
from gearopt.scenes.explaining.moves import DUTY, LIMIT, Move, Moves
from gearopt.scenes.explaining.numbers import read
from gearopt.scenes.parts import Duty

NEARLY = 1.0 - 1e-6  # times what real-valued sizes need: a step that close to it is that one
Proposal = tuple[str, FactorBracket]  # kind of a remedy, and its moves


def remedies(scene: Scene, clock: Clock) -> Remedies:
    """Return the conflict and the remedies of an impossible drive, the smallest change first.

    Every remedy was tried: a design exists with it.
    """
    case, real = Case(scene, clock), len(may_drive(scene)) == 1 and is_real(scene, clock)
    asked = case.asked
    base, known, movable = posed(scene)
    blamed = _conflict(base, known, clock) if real else ()
    singles = _tried(asked, _singles(case, asked, base if real else None, movable, blamed))
    floor, beside = together(case, base, movable) if real else (None, None)
    listed = _changes(case, asked, movable, singles, beside, floor)
    if scene.duty.ratio_tolerance == 0 and (remedy := eased_tolerance(case)) is not None:
        listed.append(remedy)
    if (remedy := nearest_ratio(case, _tolerance(listed))) is not None:
        listed.append(remedy)
    if scene.teeth is not None:
        listed += switches(case)
    late = "time ran out before all remedies were tried" if clock.over else ""
    sure = scene.teeth is None and any_resolves(base, known, blamed, clock)
    return Remedies(tuple(h.name for h in blamed), tuple(listed), late, sure)


def _tolerance(found: Sequence[Remedy]) -> Fraction | None:
    """Return the ratio tolerance that one of the remedies writes."""
    written = [c.write for r in found for c in r.changes if c.key == "duty.ratio_tolerance"]
    value = read(Duty, "ratio_tolerance", written[0].strip('"')) if written else None
    return None if value is None else Fraction(value)


def _conflict(base: Problem, known: Sequence[Handle], clock: Clock) -> tuple[Handle, ...]:
    """Return the limits in conflict; with what is given where limits alone are not."""
    limits = [h for h in known if not h.given]
    return conflict(base, limits, clock) or conflict(base, known, clock)


def _singles(
    case: Case,
    asked: FeasibilityQuestions,
    base: Problem | None,
    movable: Sequence[Move],
    blamed: Sequence[Handle],
) -> Iterator[Proposal]:
    """Yield every number that suffices alone, moved as little as that takes.

    base: the problem with real-valued sizes where that is impossible too; only what moves a limit
    of the conflict helps it.
    """
    places = {(h.kind, h.place) for h in blamed if not h.given}
    conflicting = places and all(not h.given for h in blamed)
    common: dict[tuple[str, int], float] = {}  # smallest factors of all stages: one needs no less
    for move in movable:
        if case.clock.over:
            return
        start, bound = 1.0, None
        if base is not None:
            given = any(h.given for h in move.handles)
            if (
                conflicting
                and not given
                and places.isdisjoint((h.kind, h.place) for h in move.handles)
            ):
                continue
            alike = even(base, move.handles, case.clock)
            if alike is None:
                continue
            start, bound = alike.factor, bound_of(case.scene, move, alike.bound)
        kind = "less" if move.role == DUTY else ("even" if shared(move) else "one")
        if is_stepped(case.scene, move):
            known = _given(case, move, FARTHEST * start)
        elif move.listed:
            there = [f for f in steps(case.scene, move) if start * NEARLY <= f <= FARTHEST * start]
            stepped = replace(move, steps=tuple(there))
            known = smallest(asked, ((stepped, 1.0),)) if there else None
        else:
            start = max(start, common.get((move.family, move.way), 1.0))
            doubts = len(case.open)
            known = None if math.isinf(start) else least(asked, ((move, start),))
            if shared(move) and len(case.open) == doubts:  # else a smaller one may do
                factor = math.inf if known is None else known.at(known.high)[0][1]
                common[move.family, move.way] = factor
        if known is not None:
            known.bound = bound
            yield kind, known
    yield from _alike(case, asked, base, movable)


def _given(case: Case, move: Move, most: float) -> FactorBracket | None:
    """Return the smallest change of a given whole number that suffices."""
    alone = smallest_together(case, [move], most)
    return None if alone is None else FactorBracket(alone[0], 1.0, 1.0, alone[1], stepped=alone[1])


def _tried(
    asked: FeasibilityQuestions, proposals: Iterable[Proposal]
) -> list[tuple[Proposal, Remedy]]:
    """Return proposals with their edits, each as it is found, until time runs out."""
    return [(p, r) for p in proposals if (r := as_remedy(asked, p[1], p[0])) is not None]


def _alike(
    case: Case, asked: FeasibilityQuestions, base: Problem | None, movable: Sequence[Move]
) -> Iterator[Proposal]:
    """Yield one factor for a kind of limit that every stage has for itself, and for load limits."""
    limits = [m for m in movable if m.role == LIMIT]
    common = {m.family for m in limits if shared(m)}
    groups = [
        [m for m in limits if m.family == family and not shared(m)]
        for family in dict.fromkeys(m.family for m in limits)
        if family not in common
    ]
    loads = [m for m in limits if m.family in case.scene.limits.LAW.names]
    groups.append([m for m in loads if shared(m) or m.family not in common])
    for group in groups:
        if len(group) < 2 or case.clock.over:
            continue
        start, bound = 1.0, None
        if base is not None:
            alike = even(base, [h for m in group for h in m.handles], case.clock)
            if alike is None:
                continue
            start = alike.factor
            bound = alike.bound if comparable(case.scene, group) else None
        known = least(asked, tuple((m, start) for m in group))
        if known is not None:
            known.bound = bound
            yield "even", known


def _changes(
    case: Case,
    asked: FeasibilityQuestions,
    movable: list[Move],
    singles: list[tuple[Proposal, Remedy]],
    beside: Moves | None,
    floor: float | None,
) -> list[Remedy]:
    """Return the remedies of limits and sizes, the smallest first, then those that ask for less."""
    whole, joint = case.scene.teeth is not None, []
    if beside is not None and len(beside) > 1:
        joint.append(beside)
    for (kind, known), _ in singles:
        if kind == "even" and len(known.moves) > 1 and whole:
            joint.append(trimmed(asked, known.at(known.high)))
    proposals = [(JOINT, FactorBracket(moves, 1.0, 1.0, bound=floor)) for moves in joint]
    rows = [r for _, r in (*singles, *_tried(asked, proposals))]
    best = min((_product(r) for r in rows if r.kind != "less"), default=FARTHEST)
    given = smallest_together(case, movable, best * (1.0 - PRODUCT_TIE))
    if given is not None:
        known = FactorBracket(given[0], 1.0, 1.0, given[1], bound=floor, stepped=given[1])
        rows += [r for _, r in _tried(asked, [(JOINT, known)])]
    if not any(r.kind != "less" for r in rows) and (r := _all_limits(case, asked, movable)):
        rows.append(r)
    nearest = sorted((r for r in rows if r.kind != "less"), key=_product)
    nearest.sort(key=lambda r: r.kind == "even" and len(r.changes) > 1)  # its numbers move alike
    if nearest:
        all_known = not (case.clock.over or case.open) and _product(nearest[0]) <= FARTHEST
        tried = "need more" if all_known else "not all known"
        least = replace(
            nearest[0],
            kind=JOINT,
            factor=_product(nearest[0]),
            bound=nearest[0].bound if floor is None else floor,
            verified={**nearest[0].verified, "others": tried},
        )
        nearest = [least, *_worth_reporting(r for r in nearest[1:] if r.kind != "least")]
    return _least_by_keys([*nearest, *(r for r in rows if r.kind == "less")])


def _worth_reporting(found: Any) -> Iterator[Remedy]:
    """Yield of the numbers of single stages the smallest one of each kind."""
    seen = set()
    for remedy in found:
        if remedy.kind != "one" or remedy.what not in seen:
            yield remedy
        seen.add(remedy.what if remedy.kind == "one" else "")


def _all_limits(case: Case, asked: FeasibilityQuestions, movable: list[Move]) -> Remedy | None:
    """Return all limits enlarged alike, then each made as small as the others allow."""
    moves = tuple((m, 1.0) for m in widest(movable))
    larger = enlarged(asked, moves) if moves and case.scene.teeth is not None else None
    return (
        None
        if larger is None
        else as_remedy(asked, FactorBracket(trimmed(asked, larger), 1.0, 1.0), JOINT)
    )


def _product(remedy: Remedy) -> float:
    return math.prod(c.factor for c in remedy.changes)


def _least_by_keys(found: Sequence[Remedy]) -> list[Remedy]:
    """Return of remedies that edit the same keys, the one of the smallest factor."""
    best: dict[tuple[str, ...], Remedy] = {}
    for remedy in found:
        keys = tuple(sorted(c.key for c in remedy.changes))
        if keys not in best or _product(remedy) < _product(best[keys]) * (1.0 - PRODUCT_TIE):
            best[keys] = remedy
    return list(best.values())
