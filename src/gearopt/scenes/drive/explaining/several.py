"""Several numbers of an impossible drive moved together: the least product that suffices."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

from gearopt.formulations import sizing
from gearopt.formulations.gear_train import Train
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.handles import Handle, handles
from gearopt.optimise.explaining.repair import FARTHEST, SAME, least_factors
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import solve_within
from gearopt.scenes.drive.explaining.joint import least_together
from gearopt.scenes.drive.explaining.levers import (
    WIDTH,
    Lever,
    Moves,
    applied,
    comparable,
    levers,
    reachable,
    stage_of,
    steps,
)
from gearopt.scenes.drive.explaining.tried import Case, enlarged, trimmed
from gearopt.scenes.drive.scene import Scene

NEAR = 1.0 - 1e-6  # a value this close to what is needed is that one
MOST = 3  # whole numbers of which both neighbours are tried


def is_real(scene: Scene, clock: Clock) -> bool:
    """Whether real-valued sizes are impossible too."""
    return solve_within(clock, sizing.problem(scene.train())).status == "infeasible"


def posed(scene: Scene) -> tuple[Problem, list[Handle], list[Lever]]:
    """The problem with real-valued sizes, what may be relaxed in it, and the file's numbers."""
    train = scene.train()
    base = sizing.movable(train)
    known = [_named(h, train, scene.teeth is None) for h in handles(base)]
    movable = [reachable(scene, lever) for lever in levers(scene, known)]
    return base, known, [m for m in movable if m.reach > 1.0]


def _named(handle: Handle, train: Train, whole: bool) -> Handle:
    """A handle named as in the file, with its stage; whole: limits of teeth are rounded.

    Given teeth are not: they are set first, and the others follow.
    """
    name = handle.name
    if handle.family == "wheel_teeth":
        name = f"wheel_teeth[{sizing.given_wheels(train)[stage_of(handle)] + 1}]"
    if handle.family == "width_high" and handle.given:
        name = f"{WIDTH}[{stage_of(handle) + 1}]"
    return replace(handle, name=name, whole=whole and not handle.given and "teeth" in handle.family)


def together(case: Case, base: Problem, movable: list[Lever]) -> tuple[float | None, Moves | None]:
    """The proven least product over all limits and given sizes, and moves that need about that.

    Whole numbers that are given are set first: the others follow them.
    """
    found = _least_moves(case, base, movable)
    if found is None:
        return None, None
    moves, bound = found
    stepped = tuple(m for m in moves if is_stepped(case.scene, m[0]))
    others = tuple(m for m in moves if m not in stepped)
    for whole in _rounded(case.scene, stepped):
        cured = applied(case.scene, whole) if whole else None
        rest = others if cured is None else _after(case, cured.scene)
        made = None if rest is None else _beside(case, whole, rest)
        if made is not None:
            return bound, made
    return bound, _from_sizes(case, movable, tuple(m for m in others if m[0].sort == "size"))


def _rounded(scene: Scene, moves: Moves) -> list[Moves]:
    """Moves of whole numbers at the value beyond or before what real-valued sizes need."""
    ways = []
    for lever, factor in moves:
        known = [1.0, *steps(scene, lever)]
        beyond = next((k for k, f in enumerate(known) if f >= factor * NEAR), len(known) - 1)
        exact = known[beyond] <= factor / NEAR
        ways.append([(lever, f) for f in known[beyond - (not exact) : beyond + 1][::-1]])
    if len(ways) > MOST:  # too many to try all: all beyond
        ways = [way[:1] for way in ways]
    return [tuple(m for m in way if m[1] > 1.0) for way in itertools.product(*ways)]


def _beside(case: Case, fixed: Moves, rest: Moves) -> Moves | None:
    """Moves that are made as they are, and the least of others beside them that suffice."""
    if fixed and case.works(fixed):
        return fixed
    if case.scene.teeth is None and case.works((*fixed, *rest)):
        return (*fixed, *rest)
    limits = tuple(m for m in rest if m[0].sort == "limit")
    given = tuple(m for m in rest if m not in limits)
    for still, alike in ((given, limits), ((), rest)):  # what is given need not be easier further
        beside = (*fixed, *still)
        larger = enlarged(case, alike, beside) if alike else None
        if larger is not None:
            return (*beside, *trimmed(case, larger, beside))
    return None


def _from_sizes(case: Case, movable: list[Lever], real: Moves) -> Moves | None:
    """Given whole numbers moved least under wide limits, then limits as little as it takes.

    real: given real-valued sizes that move too.
    """
    limits = widest(movable)
    wide = [(m, min(FARTHEST, m.reach)) for m in limits]
    cured = applied(case.scene, (*wide, *real))
    if cured is None:
        return None
    there = least_together(Case(cured.scene, case.clock), movable, FARTHEST)
    rest = (*real, *((m, 1.0) for m in limits))
    return None if there is None else _beside(case, there[0], rest)


def _least_moves(
    case: Case, base: Problem, movable: Sequence[Lever]
) -> tuple[Moves, float | None] | None:
    """The moves of limits and given sizes with the least product, for real sizes; its bound."""
    groups = [m for m in movable if m.sort != "duty"]
    found = least_factors(base, [m.handles for m in groups], case.clock) if groups else None
    if found is None:
        return None
    factors, _, bound = found
    moves = tuple((m, float(f)) for m, f in zip(groups, factors, strict=True) if f > 1.0 + SAME)
    return moves, bound if comparable(case.scene, groups) else None


def _after(case: Case, scene: Scene) -> Moves | None:
    """The moves of limits and real-valued sizes that a changed scene needs; None: none do."""
    if not is_real(scene, case.clock):
        return ()
    base, _, movable = posed(scene)
    found = _least_moves(case, base, [m for m in movable if not is_stepped(scene, m)])
    return None if found is None else found[0]


def is_stepped(scene: Scene, lever: Lever) -> bool:
    """Whether a number is given and may only take steps."""
    return lever.sort == "size" and bool(steps(scene, lever))


def widest(movable: Sequence[Lever]) -> list[Lever]:
    """All limits, where they stand for most stages."""
    limits = [m for m in movable if m.sort == "limit"]
    shared = {m.family for m in limits if m.shared}
    return [m for m in limits if m.shared or m.family not in shared]
