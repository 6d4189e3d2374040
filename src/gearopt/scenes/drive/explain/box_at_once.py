"""Which files have gears and a box at once: questions, least sides, and limits in conflict.

A changed [layout] leaves the drive and its tables of teeth as they are; each question is a search
of all its gears and places that ends with the first layout.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from gearopt.formulations.drive import teeth, together
from gearopt.formulations.drive.design import DriveDesign, describe
from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.layout.slabs import Arrangement
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.optimise.certified import point_of, run
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Event, Result
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.explain.requirements import requirements
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.without import without
from gearopt.scenes.explaining.engine import FactorBracket, FeasibilityQuestions
from gearopt.scenes.explaining.moves import Move
from gearopt.scenes.explaining.possible import Verdict, of_status

SIDES = ("width", "height")  # that a search minimises
LIMITS = ("largest_width", "largest_height", "largest_length")
SECONDS = 8.0  # at most, for one question
HALVING = (4.0, 1.0)  # the same while a number is halved, and beyond one that stayed undecided
DOUBTS = 4  # questions of a change that may stay open
CLOSE = 2e-4  # gap of a least side: what is 0.1 % less is impossible

Search = Callable[[Scene, Clock, str], Result]


def searches(scene: Scene) -> Search:
    """Return a search of all gears and places of files that differ in their layout alone.

    search(other, clock, side): the first layout, or the least "width" or "height" whatever the
    largest one is.
    """
    train = without(scene, "layout").train()
    tables = stage_tables(train, train.highest_ratio)

    def search(other: Scene, clock: Clock, side: str = "") -> Result:
        def make(pairs: tuple[GearPair, ...]) -> Gearbox:
            box = other.gearbox(pairs)
            if not side:
                return box
            ends = [math.inf if n == side else v for n, v in zip(SIDES, box.largest, strict=False)]
            return replace(box, objective=side, largest=(ends[0], ends[1], box.largest[2]))

        def first(event: Event) -> bool:
            return clock.tell() and (event.best is None or bool(side))

        problem = together.problem(train, make, tables=tables)
        budget = replace(clock.left, gap=CLOSE)
        return run(problem, "exact", budget, watch=first, gap=CLOSE)[0]

    return search


def first_layout(
    search: Search, changed: Scene, clock: Clock
) -> tuple[DriveDesign, Gearbox, tuple[float, ...], Arrangement] | None:
    """Return gears of a changed file with a layout of theirs; None where none is known in time."""
    result = search(changed, clock, "")
    if result.value is None:
        return None
    train, point = without(changed, "layout").train(), point_of(result.design)
    count = sum(v.size for v in teeth.problem(train).variables)
    design = describe(train, *teeth.gears(train, point[:count]))
    return design, *together.laid_out(train, changed.gearbox, point)


def questions(scene: Scene, search: Search, clock: Clock) -> FeasibilityQuestions:
    """Return the questions whether some gears of the file can be laid out in changed files."""

    def fits(other: Scene, clock: Clock) -> Verdict:
        result = search(other, clock, "")
        return Verdict(True) if result.value is not None else of_status(result.status)

    return FeasibilityQuestions(
        scene,
        fits,
        clock,
        seconds=SECONDS,
        halving=HALVING,
        doubts=DOUBTS,
        ladder=(),
        far=math.inf,
    )


def least_side(search: Search, scene: Scene, move: Move, clock: Clock) -> FactorBracket | None:
    """Return the least factor of largest_width or largest_height; None: none, or not known."""
    side = str(move.path[-1]).removeprefix("largest_")
    result = search(scene, clock, side)
    if result.value is None or result.bound is None:
        return None
    asked = getattr(scene.layout, f"largest_{side}").value
    low, high = result.bound / asked, result.value / asked
    return FactorBracket(((move, 1.0),), max(low, 1.0), high * (1.0 + 1e-9))


def in_conflict(asked: FeasibilityQuestions) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return largest sides without any of which a design exists, the others kept, and what else.

    What else: sides of which that is not known, and what gears are asked for. Nothing where all
    sides can be dropped: then no box fits, or it is not known.
    """
    scene, sure, unsure = asked.scene, list[str](), list[str]()
    given = [name for name in LIMITS if getattr(scene.layout, name) is not None]

    def open_at(names: list[str]) -> Scene:
        table = scene.layout.model_copy(update=dict.fromkeys(names))
        other: Scene = scene.model_copy(update={"layout": table})
        return other

    dropped = list[str]()
    for name in given[::-1]:
        answer = asked.ask(open_at([*dropped, name]), asked.possible).answer
        if answer is False:
            dropped.append(name)
        else:
            (sure if answer else unsure).append(name)
    if not sure:
        return (), ()
    gears = [n for group in requirements(without(scene, "layout")) for fam in group for n in fam]
    rest = (*unsure[::-1], *gears)
    return (*sure[::-1], *rest), rest
