"""Trains that are shown without being held to what their gears must keep clear of."""

from fractions import Fraction
from typing import Any

from gearopt.formulations.servo.split import Bodies
from gearopt.formulations.servo.split.bodies import rows
from gearopt.optimise.result import Result
from gearopt.scenes.servo.gears import given_gears
from gearopt.scenes.servo.scene import Scene

TIGHT = 1.0 + 1e-9  # a tie is no overlap
WHAT = {
    "output_shaft": "the first wheel runs into the output shaft",
    "hub": "the output shaft is thicker than the last wheel's root circle",
    "shaft": "the middle shaft is thicker than the root circle of a gear on it",
    "motor": "the motor runs into the middle shaft",
}


def given_overlap(scene: Scene) -> str:
    """What of the gears of [[mesh]] is in the way of something; empty where nothing is."""
    gears = given_gears(scene)
    if scene.train is None or gears is None:
        return ""
    bodies = scene.servo_train().bodies
    assert bodies is not None
    return _told("In the given train", _broken(rows(bodies, gears.diameters, gears.modules)))


def overlaps(scene: Scene, results: tuple[Result, ...]) -> list[str]:
    """The same of the lightest train, whose limits are relaxed: its mass then is a floor alone."""
    found = [r for r in results if r.name == "stiff" and r.value is not None]
    if not found:
        return []
    design, train = found[0].design, scene.servo_train()
    assert train.bodies is not None
    d1, d3 = design["pinion_diameter_mm"]
    n1, n2 = design["ratio"]
    module = float(train.modules[0])
    bodies = Bodies(
        Fraction(design["shaft_diameter_mm"]), train.bodies.output_shaft, train.bodies.motor
    )
    broken = _broken(rows(bodies, (d1, n1 * d1, d3, n2 * d3), (module, module)))
    return [said] if (said := _told("In the lightest train", broken)) else []


def _broken(found: dict[str, Any]) -> list[str]:
    values = {name: v if isinstance(v, tuple) else (v,) for name, v in found.items()}
    return [name for name, parts in values.items() if not all(0.0 <= v <= TIGHT for v in parts)]


def _told(whose: str, broken: list[str]) -> str:
    return f"{whose} {' and '.join(WHAT[name] for name in broken)}." if broken else ""
