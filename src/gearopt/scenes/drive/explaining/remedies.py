"""Remedies of an impossible drive: edits of its file, each of them tried."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedies, Remedy
from gearopt.optimise.explaining.handles import Handle
from gearopt.optimise.explaining.repair import (
    FARTHEST,
    PRODUCT_TIE,
    SLACK_TRIED,
    any_resolves,
    conflict,
    even,
)
from gearopt.optimise.problem import Problem
from gearopt.scenes.drive.explaining.choices import eased_tolerance, nearest_ratio, switches
from gearopt.scenes.drive.explaining.movable import (
    Movable,
    Moves,
    applied,
    bound_of,
    comparable,
    less,
)
from gearopt.scenes.drive.explaining.together import (
    is_real,
    is_stepped,
    posed,
    smallest_together,
    together,
    widest,
)
from gearopt.scenes.drive.explaining.tried import (
    Case,
    enlarged,
    smallest_alike,
    smallest_step,
    trimmed,
)
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import read
from gearopt.scenes.parts import Duty


def remedies(scene: Scene, clock: Clock) -> Remedies:
    """Return the conflict and the remedies of an impossible drive, the smallest change first.

    Every remedy was tried: a design exists with it.
    """
    case, real = Case(scene, clock), is_real(scene, clock)
    base, known, movable = posed(scene)
    blamed = _conflict(base, known, clock) if real else ()
    singles = _tried(case, _singles(case, base if real else None, movable, blamed))
    floor, beside = together(case, base, movable) if real else (None, None)
    found = _changes(case, movable, singles, beside, floor)
    if scene.duty.ratio_tolerance == 0 and (remedy := eased_tolerance(case)) is not None:
        found.append(remedy)
    if (remedy := nearest_ratio(case, _tolerance(found))) is not None:
        found.append(remedy)
    if scene.teeth is not None:
        found += switches(case)
    late = "time ran out before all remedies were tried" if clock.over else ""
    sure = scene.teeth is None and any_resolves(base, known, blamed, clock)
    return Remedies(tuple(h.name for h in blamed), tuple(found), late, sure)


def _tolerance(found: Sequence[Remedy]) -> Fraction | None:
    """Return the ratio tolerance that one of the remedies writes."""
    written = [c.write for r in found for c in r.changes if c.key == "duty.ratio_tolerance"]
    value = read(Duty, "ratio_tolerance", written[0].strip('"')) if written else None
    return None if value is None else Fraction(value)


def _conflict(base: Problem, known: Sequence[Handle], clock: Clock) -> tuple[Handle, ...]:
    """Return the limits in conflict; with what is given where limits alone are not."""
    limits = [h for h in known if not h.given]
    return conflict(base, limits, clock) or conflict(base, known, clock)


@dataclass(frozen=True)
class Proposal:
    """Moves that suffice, what they are called, and the proven minimum factor.

    sure: every smaller change of the same numbers is known to be impossible; None: try a step less.
    """

    kind: str
    moves: Moves
    bound: float | None
    sure: bool | None = None


def _singles(
    case: Case, base: Problem | None, movable: Sequence[Movable], blamed: Sequence[Handle]
) -> Iterator[Proposal]:
    """Yield every number that suffices alone, moved as little as that takes.

    base: the problem with real-valued sizes where that is impossible too; only what moves a limit
    of the conflict helps it.
    """
    places = {(h.kind, h.place) for h in blamed if not h.given}
    conflicting = places and all(not h.given for h in blamed)
    common: dict[tuple[str, int], float] = {}  # smallest factors of all stages: one needs no less
    for number in movable:
        start, bound = 1.0, None
        if base is not None:
            own = {(h.kind, h.place) for h in number.handles}
            given = any(h.given for h in number.handles)
            if conflicting and not given and not own & places:
                continue
            alike = even(base, number.handles, case.clock)
            if alike is None:
                continue
            start, bound = alike.factor, bound_of(case.scene, number, alike.bound)
        if case.clock.over:
            return
        kind = "less" if number.sort == "duty" else ("even" if number.shared else "one")
        if is_stepped(case.scene, number):
            alone = smallest_together(case, [number], FARTHEST * start)
            if alone is not None:
                yield Proposal(kind, alone[0], bound, alone[1] or None)
        elif number.path[-1] == "module" and case.scene.teeth is not None:
            stepped = smallest_step(case, number, FARTHEST * start)
            if stepped is not None:
                yield Proposal(kind, ((number, stepped[0]),), bound, stepped[1])
        else:
            start = max(start, common.get((number.family, number.direction), 1.0))
            doubts = len(case.open)
            moves = None if math.isinf(start) else smallest_alike(case, ((number, start),))
            if number.shared and len(case.open) == doubts:  # else a smaller one may do
                least = math.inf if moves is None else moves[0][1]
                common[number.family, number.direction] = least
            if moves is not None:
                yield Proposal(kind, moves, bound)
    yield from _alike(case, base, movable)


def _tried(case: Case, proposals: Iterable[Proposal]) -> list[tuple[Proposal, Remedy]]:
    """Return proposals with their edits, each as it is found, until time runs out."""
    return [(proposal, r) for proposal in proposals if (r := _remedy(case, proposal)) is not None]


def _alike(case: Case, base: Problem | None, movable: Sequence[Movable]) -> Iterator[Proposal]:
    """Yield one factor for a kind of limit that every stage has for itself, and for load limits."""
    limits = [m for m in movable if m.sort == "limit"]
    common = {m.family for m in limits if m.shared}
    groups = [
        [m for m in limits if m.family == family and not m.shared]
        for family in dict.fromkeys(m.family for m in limits)
        if family not in common
    ]
    loads = [m for m in limits if m.family in case.scene.limits.LAW.names]
    groups.append([m for m in loads if m.shared or m.family not in common])
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
        moves = smallest_alike(case, tuple((m, start) for m in group))
        if moves is not None:
            yield Proposal("even", moves, bound)


def _changes(
    case: Case,
    movable: list[Movable],
    singles: list[tuple[Proposal, Remedy]],
    beside: Moves | None,
    floor: float | None,
) -> list[Remedy]:
    """Return the remedies of limits and sizes, the smallest first, then those that ask for less."""
    proposals = []
    if beside is not None and len(beside) > 1:
        proposals.append(Proposal("least", beside, floor))
    for proposal, _ in singles:
        several = (
            proposal.kind == "even" and len(proposal.moves) > 1 and case.scene.teeth is not None
        )
        if several:
            proposals.append(Proposal("least", trimmed(case, proposal.moves), floor))
    rows = [r for _, r in (*singles, *_tried(case, proposals))]
    best = min((_product(r) for r in rows if r.kind != "less"), default=FARTHEST)
    joint = smallest_together(case, movable, best * (1.0 - PRODUCT_TIE))
    if joint is not None and (
        r := _remedy(case, Proposal("least", joint[0], floor, joint[1] or None))
    ):
        rows.append(r)
    if not any(r.kind != "less" for r in rows) and (r := _all_limits(case, movable)):
        rows.append(r)
    own = sorted((r for r in rows if r.kind != "less"), key=_product)
    own.sort(key=lambda r: r.kind == "even" and len(r.changes) > 1)  # its numbers move alike
    if own:
        all_known = not (case.clock.over or case.open) and _product(own[0]) <= FARTHEST
        tried = "need more" if all_known else "not all known"
        least = replace(
            own[0],
            kind="least",
            factor=_product(own[0]),
            bound=own[0].bound if floor is None else floor,
            verified={**own[0].verified, "others": tried},
        )
        own = [least, *_worth_reporting(r for r in own[1:] if r.kind != "least")]
    return _distinct([*own, *(r for r in rows if r.kind == "less")])


def _worth_reporting(found: Any) -> Iterator[Remedy]:
    """Yield of the numbers of single stages the smallest one of each kind."""
    seen = set()
    for remedy in found:
        if remedy.kind != "one" or remedy.what not in seen:
            yield remedy
        seen.add(remedy.what if remedy.kind == "one" else "")


def _all_limits(case: Case, movable: list[Movable]) -> Remedy | None:
    """Return all limits enlarged alike, then each made as small as the others allow."""
    moves = tuple((m, 1.0) for m in widest(movable))
    larger = enlarged(case, moves) if moves and case.scene.teeth is not None else None
    return None if larger is None else _remedy(case, Proposal("least", trimmed(case, larger), None))


def _product(remedy: Remedy) -> float:
    return math.prod(c.factor for c in remedy.changes)


def _distinct(found: Sequence[Remedy]) -> list[Remedy]:
    """Return of remedies that edit the same keys, the one of the smallest factor."""
    best: dict[tuple[str, ...], Remedy] = {}
    for remedy in found:
        keys = tuple(sorted(c.key for c in remedy.changes))
        if keys not in best or _product(remedy) < _product(best[keys]) * (1.0 - PRODUCT_TIE):
            best[keys] = remedy
    return list(best.values())


def _remedy(case: Case, proposal: Proposal) -> Remedy | None:
    """Return a remedy as edits, tried as they are written; None if it is none."""
    edited = applied(case.scene, proposal.moves)
    if edited is None or case.status(edited.scene) != "feasible":
        return None
    if proposal.sure is not None:
        word = "infeasible" if proposal.sure else "undecided"
    else:
        each = (None,) if proposal.kind == "even" else range(len(edited.changes))
        words = {case.status(less(case.scene, edited, SLACK_TRIED, k)) for k in each}
        word = words.pop() if len(words) == 1 else "mixed"
    factors = [c.factor for c in edited.changes]
    return Remedy(
        proposal.kind,
        ", ".join(dict.fromkeys(number.family for number, _ in proposal.moves)),
        edited.changes,
        max(factors) if proposal.kind == "even" else math.prod(factors),
        proposal.bound,
        {"with": "feasible", "with_less": word},
    )
