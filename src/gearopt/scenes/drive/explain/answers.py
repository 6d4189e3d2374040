"""Remedies of an impossible drive, and the sensitivities of a possible one."""

import math
from dataclasses import replace

from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.result import Result
from gearopt.scenes.drive.driving import trains
from gearopt.scenes.drive.explain.counts import remedies_of_counts
from gearopt.scenes.drive.explain.influences import explained
from gearopt.scenes.drive.explain.rated_remedies import conflict_soon
from gearopt.scenes.drive.explain.rated_remedies import remedies as of_rated
from gearopt.scenes.drive.explain.tried import Case, any_possible
from gearopt.scenes.drive.layout import APART, at_once_of_count, gears_of
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.sizing import of_count, sized
from gearopt.scenes.drive.stage_types import held_as, open_types, words
from gearopt.scenes.drive.without import without
from gearopt.scenes.explaining.possible import UNKNOWN, Verdict
from gearopt.scenes.reading.ask import Ask

OF_ONE = (
    "remedies are of one choice of types: gearopt explain of a file with one type for each "
    "[[stage]] names them"
)
ANY_DESIGN_GAP = 1e9  # gap of a design that need not be the best


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies | None:
    """Remedies: of the box where the gears are possible, else of the gears.

    soon: of a drive that ratings limit, its conflict at most; None where that is not known soon.
    """
    if open_types(scene):
        return Remedies(message=OF_ONE)
    if scene.layout is not None and scene.layout.together and scene.several:
        return _of_boxes(without(scene, "processes"), clock)
    gears = gears_of(result)
    if gears is None and any(part.name == APART for part in result.parts):
        return Remedies()
    if gears is not None:
        return _of_box(without(scene, "processes"), clock, gears)
    if scene.by_ratings:
        bare = without(scene, "layout")
        if soon:
            return conflict_soon(bare, clock)
        return of_rated(bare, clock, lambda other: _status(other, clock))
    solid = without(scene, "webs")
    return remedies_of_counts(solid, without(solid, "layout", "processes"), clock)


def _of_box(scene: Scene, clock: Clock, gears: Result) -> Remedies:
    """Remedies of a box for these gears."""
    from gearopt.scenes.drive.explain import box_remedies

    held = scene.held(len(gears.design["stages"]))
    return box_remedies.remedies(held, gears, clock)


def _of_boxes(scene: Scene, clock: Clock) -> Remedies:
    """Remedies of the number of stages that needs least to have a box."""
    known = []
    for count in scene.counts:
        held = scene.held(count)
        result = at_once_of_count(held, Ask(budget=clock.left, watch=clock.watch))
        if gears := gears_of(result):
            known.append(_of_box(held, clock, gears))
    if not known:
        solid = without(scene, "webs")
        return remedies_of_counts(solid, without(solid, "layout"), clock)
    return min(known, key=lambda ways: min((r.factor for r in ways.remedies), default=math.inf))


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Whether a drive has a design; of one that is laid out not known where it has gears."""
    case = Case(scene, clock)
    answer = any_possible(case, [t for each in scene.each for t in trains(each)])
    return UNKNOWN if answer and scene.layout is not None else Verdict(answer)


def _status(scene: Scene, clock: Clock) -> str:
    """Whether a drive that ratings limit is possible, in what is left of the time."""
    ask = Ask(budget=replace(clock.left, gap=ANY_DESIGN_GAP), watch=clock.watch)
    result = sized(scene, ask)
    return result.status if result.value is None else "feasible"


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Sensitivities of a design to every number of the file; the number of stages is held."""
    scene = without(scene, "processes", *(() if scene.by_ratings else ("rating",)))
    clock = Clock(ask.budget, of_others(ask.watch))
    if result.value is None:
        return Explanation(result, message="no design was found in time", seconds=clock.seconds)
    if len(scene.each) > 1:
        chosen = held_as(scene, result.design)
        kept = f"types of the stages are held: {words(chosen)}"
        kept = f"number of stages is held at {chosen.counts[0]}" if scene.several else kept
        held = influences(chosen, ask, result)
        return replace(held, message="; ".join(filter(None, (held.message, f"the {kept}"))))
    if scene.layout is not None:
        from gearopt.scenes.drive.explain import box_remedies

        return box_remedies.explained(scene, result, clock)

    def answer(other: Scene) -> Result:
        """The drive of another file, one train, searched to the end."""
        budget = replace(clock.left, gap=0.0)
        return of_count(other, replace(ask, budget=budget, watch=clock.watch, gap=GAP, top=1))

    return explained(scene, result, clock, answer)
