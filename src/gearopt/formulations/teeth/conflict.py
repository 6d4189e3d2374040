"""Why no train meets all limits: which single limit, widened, would let one through."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.teeth.search import search
from gearopt.formulations.train import FaceWidth, Stage, Train
from gearopt.optimise.result import Budget, Watch
from gearopt.physics.modules import MODULES

FREE = 1e30  # a load limit that never binds
SECONDS = 2.0  # at most, for one widened limit
# Widened to what a gear engineer might still accept, not without end: a wide range costs time.
TOLERANCE = Fraction(1, 10)
PINION = (12, 100)
WIDEST = Fraction(10)  # face width over pinion diameter


@dataclass(frozen=True)
class Widened:
    """suffice: limits of which any one, widened alone, makes the drive possible.

    undecided: those for which it was not found out in time.
    """

    suffice: tuple[str, ...]
    undecided: tuple[str, ...]


def widened(train: Train, seconds: float | None, watch: Watch | None) -> Widened:
    """Try to widen each limit alone, within `seconds` in all (None: SECONDS each)."""
    deadline = None if seconds is None else time.perf_counter() + seconds
    found: dict[str, bool | None] = {}
    for name, widen in _widenings().items():
        wider = widen(train)
        if wider == train:
            continue
        left = SECONDS if deadline is None else min(SECONDS, deadline - time.perf_counter())
        found[name] = _possible(wider, left, watch) if left > 0.0 else None
    return Widened(
        tuple(n for n, possible in found.items() if possible),
        tuple(n for n, possible in found.items() if possible is None),
    )


def _possible(train: Train, seconds: float, watch: Watch | None) -> bool | None:
    """Whether the drive is possible; None where that is not known in time."""

    def first(event: Any) -> bool:
        told = watch is None or watch(event) is not False
        return event.best is None and told  # one train is enough

    try:
        progress = search(train, 1, Budget(seconds=seconds), first)
    except SolveError:  # too many pairs to look at
        return None
    if progress.found:
        return True
    return None if progress.stopped else False


def _widenings() -> dict[str, Callable[[Train], Train]]:
    def every(**changes: Any) -> Callable[[Train], Train]:
        return lambda t: _stagewise(t, lambda s: replace(s, **changes))

    series = MODULES["ISO 54 I+II"]
    return {
        "ratio_tolerance": lambda t: replace(t, tolerance=max(t.tolerance, TOLERANCE)),
        "k_factor": every(k_factor=FREE),
        "unit_load": every(unit_load=FREE),
        "wheel_diameter": every(wheel_diameter=None),
        "stage_ratio": every(ratio=(Fraction(1), None)),
        "module": lambda t: _stagewise(
            t, lambda s: replace(s, modules=tuple(sorted({*s.modules, *series})))
        ),
        "pinion_teeth": lambda t: _stagewise(t, _more_teeth),
        "wheel_teeth": every(wheel_teeth=(1, None)),
        "face_width": lambda t: _stagewise(
            t, lambda s: replace(s, face_width=FaceWidth(Fraction(0), WIDEST))
        ),
        "coprime": lambda t: replace(t, coprime=False),
    }


def _stagewise(train: Train, change: Callable[[Stage], Stage]) -> Train:
    return replace(train, stages=tuple(change(s) for s in train.stages))


def _more_teeth(stage: Stage) -> Stage:
    least, most = stage.pinion_teeth
    return replace(stage, pinion_teeth=(min(PINION[0], least), max(PINION[1], most or 0)))
