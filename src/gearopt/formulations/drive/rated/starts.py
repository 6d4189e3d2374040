"""Starts of the sizing of rated drives, and designs made so large that the exact rating accepts."""

from dataclasses import replace

import numpy as np

from gearopt.formulations.drive import sizing, teeth
from gearopt.formulations.drive.train import Train
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Result
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Array
from gearopt.physics.gears import SERIES_I, GearPair

SAFE = 1.0 + FEASIBLE  # utilisation up to which the exact rating accepts a design
GROWTH = tuple(10.0 ** (0.5 * k) for k in range(-14, -3))  # of lengths, in a repair
LESS, SMALLEST, HALVINGS = 1e-5, 0.7, 24  # of lengths that an exact rating finds too large
FINER = (1.0, 1.4, 2.0)  # times the least teeth, of starts without a bounding program
# teeth above the least of a pinion without a limit, of a search among whole teeth
TEETH_SEARCHED = 20
SECONDS = 5.0  # at most, for that search


def point_of(train: Train, pairs: tuple[GearPair, ...]) -> Array:
    """Return the point of `sizing.problem` of a design."""
    rows = [
        {
            "module": pair.normal_module,
            "pinion_teeth": pair.pinion_teeth,
            "ratio": pair.ratio,
            "face_width": pair.face_width,
        }
        for pair in pairs
    ]
    return np.array([float(r[v.name]) for v in sizing.variables(train) for r in rows])


def starts(exact: Problem) -> list[Array]:
    """Return starts of more and more, smaller teeth."""
    lower, upper, guess = exact.bounds()
    names = [v.name for v, _ in exact.columns]
    found = []
    for factor in FINER:
        change = {"module": 1.0 / factor, "pinion_teeth": factor}
        moved = [g * change.get(n, 1.0) for g, n in zip(guess, names, strict=True)]
        found.append(np.clip(moved, lower, upper))
    return found


def whole(train: Train, clock: Clock) -> list[Array]:
    """Return the best train of whole teeth and standard modules as a point, if one is found."""
    stages = []
    for stage in train.stages:
        least, most = min(stage.modules, default=None), max(stage.modules, default=None)
        if least is None or most is None:
            series = SERIES_I
        else:
            series = tuple(sorted({least, most, *(m for m in SERIES_I if least < m < most)}))
        low, high = stage.pinion_teeth
        stages.append(
            replace(stage, modules=series, pinion_teeth=(low, high or low + TEETH_SEARCHED))
        )
    near = replace(train, stages=tuple(stages))
    answer = solve(teeth.problem(near), budget=Budget(clock.within(SECONDS)))
    found = point_of_result(teeth.problem(near), answer)
    if found is None:
        return []
    return [point_of(train, teeth.pairs(near, found))]


def point_of_result(made: Problem, found: Result) -> Array | None:
    """Return the point of a result; None where it has none."""
    if not found.design:
        return None
    values = [np.atleast_1d(v) for v in found.design.values()]
    return np.concatenate(values).astype(float)


def safe(exact: Problem, x: Array) -> bool:
    """Return whether the exact text accepts a point."""
    made = exact.batch(x[None])
    return bool(max(made.G.max(initial=0.0), 1.0 + np.abs(made.H - 1.0).max(initial=0.0)) <= SAFE)


def repaired(exact: Problem, at: Array) -> Array | None:
    """Return a design as it is, or as much larger as the exact rating needs; None: by too much.

    Stages that could be smaller by LESS are made so.
    """
    lengths = np.array([v.unit == "mm" for v, _ in exact.columns])
    stage = [int(n.rsplit("[", 1)[1][:-1]) if v.size > 1 else 1 for v, n in exact.columns]
    lower, upper, _ = exact.bounds()

    def scaled(x: Array, factor: float, chosen: Array) -> Array:
        return np.clip(np.where(chosen, x * factor, x), lower, upper)

    here = next((s for g in (0.0, *GROWTH) if safe(exact, s := scaled(at, 1 + g, lengths))), None)
    if here is None:
        return None
    for k in range(1, max(stage) + 1):
        own = lengths & (np.array(stage) == k)
        if not safe(exact, scaled(here, 1.0 - LESS, own)):
            continue
        low, high = SMALLEST, 1.0 - LESS
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            good = safe(exact, scaled(here, middle, own))
            low, high = (low, middle) if good else (middle, high)
        here = scaled(here, high, own)
    return here
