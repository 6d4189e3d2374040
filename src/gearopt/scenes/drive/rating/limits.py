"""The rating of a file as what limits the gears that are to be sized."""

from dataclasses import replace
from typing import Any

from gearopt.errors import CertificateError, SolveError
from gearopt.formulations.design import drive_design
from gearopt.formulations.strength.rated import Option
from gearopt.optimise.result import Result
from gearopt.scenes.drive.rating import by_agma, by_iso6336
from gearopt.scenes.drive.rating.gears import loads, own, unit_operation
from gearopt.scenes.drive.scene import Scene

STANDARDS: dict[str, tuple[Any, ...]] = {  # of the key standard
    "agma": (by_agma,),
    "iso6336": (by_iso6336,),
    "both": (by_agma, by_iso6336),
}
SECOND = "_iso"  # after the names of limits by the second of two standards


def options(scene: Scene, stage: int) -> tuple[Option, ...]:
    """Return the ways of making the gears of a stage (from 0); SolveError for none that limit."""
    asked = scene.rating
    assert asked
    if scene.load:
        raise SolveError(
            "gears cannot be sized under a load spectrum yet: give K-factor and unit load in "
            "[limits], by which they are sized and then rated, or leave [[load]] out"
        )
    gears = own(scene, stage, "pinion"), own(scene, stage, "wheel")
    operation = unit_operation(scene, gears)
    made = [
        one.limits(scene, stage, gears, operation, loads(scene))
        for one in STANDARDS[asked.standard]
    ]
    if len(made) > 1:
        made[1] = replace(made[1], suffix=SECOND)
    return (Option(tuple(made)),)


def required(scene: Scene) -> tuple[float, float]:
    """Return the safety factors asked for against bending and against pitting."""
    asked = scene.rating
    assert asked
    return float(asked.minimum_bending_safety), float(asked.minimum_contact_safety)


def check_safe(scene: Scene, result: Result) -> None:
    """Refuse gears that the rating was to limit and that it finds unsafe: an error of ours."""
    if not scene.by_ratings or result.value is None:
        return
    found = drive_design(result.design).rating
    if found is None or not found.safe_by_all:
        why = "has no rating" if found is None else f"is unsafe: {found.governs}"
        raise CertificateError(f"the design that ratings limit {why}")
