"""Remedies where gears may bind: a smaller minimum backlash, or other allowances.

j = -(A_s1 + A_s2) + 2 tan(alpha) A_a, all at the ends that close the mesh (`physics.backlash`).
"""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.servo.choice import binding, train_problem
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.explaining.repair import SLACK_TRIED
from gearopt.optimise.solve import solve_within
from gearopt.scenes.explaining.numbers import cut, moved, times
from gearopt.scenes.reading.toml_writing import dotted
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import THICKNESS, TWO_SIDED
from gearopt.units import Quantity

DIGITS = 3  # of a minimum backlash that is proposed


def binds(scene: Scene, clock: Clock) -> Remedies | None:
    """Minimum backlashes that are not kept, with their remedies; None where all are.

    An allowance moves as a whole, both ends alike, so that its width stays. Where both stages may
    bind, a key moves in both.
    """
    choice = scene.choice()
    none = binding(choice.backlash)
    if none is None or none.proof is None:
        return None
    short_of = {k: asked - there for k, there, asked in choice.backlash if there < asked}
    tried = (_way(scene, key, short_of, clock) for key in ("minimum_backlash", *TWO_SIDED))
    ways = [way for way in tried if way is not None]
    return Remedies(tuple(none.proof["conflict"]), tuple(ways), none.message)


def _way(scene: Scene, key: str, missing: dict[int, float], clock: Clock) -> Remedy | None:
    """Return one key of some stages moved by what is missing [mm]; None where it is no answer."""
    slope = 2.0 * math.tan(scene.accuracy.pressure_angle.value)
    changes = list[Change]()
    changed: Any = scene
    back: Any = scene
    for k, lacking in missing.items():
        path, was = ("mesh", k - 1, key), getattr(scene.mesh[k - 1], key)
        if was is None or clock.over:
            return None
        by = -lacking if key == "minimum_backlash" or key in THICKNESS else lacking / slope
        new, less = _moved(was, key, by), _moved(was, key, by * (1.0 - SLACK_TRIED), exact=True)
        if new is None or (changed := moved(changed, path, new)) is None:
            return None
        back = None if less is None or back is None else moved(back, path, less)
        changes.append(Change(dotted(path), _text(was), _text(new), math.inf))
    status = solve_within(clock, train_problem(changed.choice())).status
    if status != "optimal":
        return None
    bound = back is not None and binding(back.choice().backlash) is not None
    verified = {"with": "feasible", "rounded": "to the side that eases the limit"}
    verified["with_less"] = "infeasible" if bound else "undecided"
    what = ", ".join(change.key for change in changes)
    return Remedy(
        "pair" if len(changes) > 1 else "alone", what, tuple(changes), math.inf, None, verified
    )


def _text(value: Any) -> str:
    """Return a length, or two allowances in the unit of the first, as a file writes them."""
    if isinstance(value, Quantity):
        return f'"{value}"'
    unit = value[0].unit
    low, high = (f"{float(value[0].of(end.exact[0]).number):+.10g}" for end in value)
    return f'"{low}/{high} {unit}"'


def _moved(was: Any, key: str, by: float, exact: bool = False) -> Any:
    """Return a value moved by so much [mm], rounded to the side that leaves more backlash."""
    if key == "minimum_backlash":
        new = times(was, 1.0 + by / was.value)
        if new.number <= 0:
            return None
        return new if exact else cut(new, -1, DIGITS)
    zero = times(was, 0.0) if isinstance(was, Quantity) else None
    ends = was if zero is None else ((times(was, -1.0), zero) if key in THICKNESS else (zero, was))
    way = -1 if key in THICKNESS else 1
    if exact:
        return tuple(end.of(end.exact[0] + Fraction(by)) for end in ends)
    return tuple(_shifted(end, by, way) for end in ends)


def _shifted(end: Quantity, by: float, way: int) -> Quantity:
    """Return an allowance moved by so much [mm], to a tenth of a micrometre beyond."""
    step = end.of(Fraction(1, 10_000)).number
    steps = (end.of(end.exact[0] + Fraction(by)).number) / step
    number = step * (math.ceil(steps) if way > 0 else math.floor(steps))
    return replace(end, number=Fraction(number))
