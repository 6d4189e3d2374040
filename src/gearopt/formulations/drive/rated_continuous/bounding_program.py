"""A geometric program below a drive that ratings limit, from whose optimum its sizing starts.

Its limits are below those of the ratings (`strength.standard.Floor`), so its dual bound is one of
the drive, in real-valued and in whole teeth.
"""

import math
from types import SimpleNamespace
from typing import Any

from gearopt.formulations.drive import sizing_text
from gearopt.formulations.drive.shares import least_share
from gearopt.formulations.drive.train import BY_WIDTH, LENGTHS, Train
from gearopt.formulations.strength.standard import Box
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Result
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Terms
from gearopt.physics.gears import GearPair

Choice = tuple[tuple[str, ...], ...]  # of every stage and standard

ITERATIONS = 300  # of Ipopt, of which smooth problems take some tens
SEARCH_SPAN = 1e6  # teeth and ratios beyond which no bound holds: the ends of the search


def bounding(train: Train, choice: Choice, most: float = math.inf) -> Problem | None:
    """Return a geometric program below the drive in one combination; None where there is none.

    most: the bound need only hold for designs of at most this objective.
    """
    floors: list[list[Any]] = []
    for k, stage in enumerate(train.stages):
        box = stage_box(train, k, most)
        standards = stage.options[0].standards if stage.options else ()
        floors.append([s.floor(box, choice[k][j]) for j, s in enumerate(standards)])
    if any(row and all(floor is None for floor in row) for row in floors):
        return None

    def evaluate(x: Any, p: Any) -> Terms:
        def rated(k: int, pair: GearPair, torque: Any, speed: Any, safety: Any) -> dict[str, Any]:
            rows: dict[str, Any] = {}
            for standard, floor in zip(
                train.stages[k].options[0].standards, floors[k], strict=True
            ):
                if floor is None:
                    continue
                used = floor.utilisations(pair, torque, speed, safety)
                rows |= {n + standard.suffix: v for n, v in used.items()}
                rows |= {n + standard.suffix: v for n, v in floor.limits(pair).items()}
            return rows

        gears = sizing_text.text_pairs(train, x, p)
        return sizing_text.terms(train, p, gears, rated=rated, shares=_least)

    return Problem(
        "bounding", sizing_text.variables(train), sizing_text.parameters(train), evaluate
    )


def _least(train: Train, k: int, pair: GearPair, density: Any, option: int, objective: str) -> Any:
    """Return the `least_share` of a stage, by the fewest teeth that it may have."""
    stage = train.stages[k]
    pinion = float(stage.pinion_teeth[0])
    wheel = max(float(stage.wheel_teeth[0]), pinion * float(stage.ratio[0]))
    return least_share(train, k, pair, density, option, (pinion, wheel), objective)


def stage_box(train: Train, k: int, most: float) -> Box:
    """Bounds of a stage's sizes over all designs whose objective is at most a value."""
    stage, highest = train.stages[k], float(train.highest_ratio)
    numbers = SimpleNamespace(**train.numbers())
    teeth = max(1.0, numbers.pinion_low[k]), min(SEARCH_SPAN, numbers.pinion_high[k])
    alone = len(train.stages) == 1
    low = max(float(train.lowest_ratio) if alone else 1.0, numbers.ratio_low[k])
    ratio = low, max(low, min(highest, numbers.ratio_high[k]))
    before = train.stages[:k]
    fast = math.prod(float(stage.ratio[0]) for stage in before)
    slow = math.prod(float(stage.ratio[1] or highest) for stage in before)
    speed = train.speed / min(highest, slow), train.speed / fast
    return Box(teeth, ratio, speed, _widest(train, k, low, most), stage.toothing)


def _widest(train: Train, k: int, ratio: float, most: float) -> float:
    """Return the largest face width [mm] of a stage of at most this share; inf: unknown."""
    face = train.stages[k].face_width
    if face.fixed is not None:
        return float(face.fixed)
    sized = train.objective in (*BY_WIDTH, *LENGTHS)
    if not sized or not math.isfinite(most) or not math.isfinite(face.widest):
        return math.inf
    stage = train.stages[k].toothing
    unit = stage.of_diameter(stage.cosine / 20.0, 20.0, 1.0, ratio, face.widest)
    alone = float(least_share(train, k, unit))  # of d1 = 1 mm and the widest face
    power = 1.0 / 3.0 if train.by_width else 1.0
    return float(face.widest * (most / alone) ** power * (1.0 + FEASIBLE))


def solved(clock: Clock, made: Problem) -> Result:
    """Certified answer of Ipopt within ITERATIONS and the budget that a clock has left."""
    before, left = clock.evaluations, clock.left
    most = ITERATIONS if left.evaluations is None else min(ITERATIONS, left.evaluations)
    allowed = Budget(left.seconds, most)
    result = solve(made, "ipopt", allowed, watch=clock.inner(values=False))
    clock.evaluations = before + result.evaluations
    clock.tell()
    return result
