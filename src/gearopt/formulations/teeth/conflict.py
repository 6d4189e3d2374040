"""Why no train meets all limits: which single limit, lifted, would let one through."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.teeth.search import search
from gearopt.formulations.train import FaceWidth, Stage, Train
from gearopt.optimise.result import Budget
from gearopt.physics.modules import MODULES

FREE = 1e30  # a load limit that never binds
SECONDS = 2.0  # at most, for one lifted limit


def lifting(train: Train) -> list[str]:
    """Names of the limits of which any one, lifted alone, makes the drive possible.

    A limit whose lifting is not decided within SECONDS is left out.
    """
    return [name for name, lift in _lifts().items() if _possible(lift(train))]


def _possible(train: Train) -> bool:
    return bool(search(train, 1, Budget(seconds=SECONDS)).found)


def _lifts() -> dict[str, Callable[[Train], Train]]:
    def every(**changes: Any) -> Callable[[Train], Train]:
        return lambda t: replace(t, stages=tuple(replace(s, **changes) for s in t.stages))

    series = MODULES["ISO 54 I+II"]
    return {
        "ratio_tolerance": lambda t: replace(t, tolerance=max(t.tolerance, Fraction(1, 10))),
        "k_factor": every(k_factor=FREE),
        "unit_load": every(unit_load=FREE),
        "wheel_diameter": every(wheel_diameter=None),
        "stage_ratio": every(ratio=(Fraction(1), None)),
        "module": lambda t: _stagewise(
            t, lambda s: replace(s, modules=tuple(sorted({*s.modules, *series})))
        ),
        "pinion_teeth": lambda t: _stagewise(
            t,
            lambda s: replace(
                s, pinion_teeth=(min(12, s.pinion_teeth[0]), max(100, s.pinion_teeth[1] or 0))
            ),
        ),
        "wheel_teeth": every(wheel_teeth=(1, None)),
        "face_width": lambda t: _stagewise(t, _any_width),
        "coprime": lambda t: replace(t, coprime=False),
    }


def _stagewise(train: Train, change: Callable[[Stage], Stage]) -> Train:
    return replace(train, stages=tuple(change(s) for s in train.stages))


def _any_width(stage: Stage) -> Stage:
    """Widths up to ten pinion diameters."""
    return replace(stage, face_width=FaceWidth(Fraction(0), Fraction(10)))
