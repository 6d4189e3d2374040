"""The rating of a file as what limits the gears that are to be sized."""

from dataclasses import replace
from typing import Any

from gearopt.errors import CertificateError
from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.strength.rated import Option
from gearopt.optimise.result import Result
from gearopt.physics.gears import MEMBERS
from gearopt.scenes.drive.rating import by_agma, by_iso6336
from gearopt.scenes.drive.rating.gears import gear_choices, loads, unit_operation
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.rating import GearTable

STANDARDS: dict[str, tuple[Any, ...]] = {  # of the key standard
    "agma": (by_agma,),
    "iso6336": (by_iso6336,),
    "both": (by_agma, by_iso6336),
}
SECOND = "_iso"  # after the names of limits by the second of two standards


def of_stages(scene: Scene, count: int) -> tuple[tuple[Option, ...], ...]:
    """Return the ways of making the gears of every stage.

    Where all stages have the same materials these alone, in the order of the first stage.
    """
    found = tuple(options(scene, k) for k in range(count))
    if not scene.gears.same_materials:
        return found
    named = [{option.materials: option for option in stage} for stage in found]
    shared = [names for names in named[0] if all(names in stage for stage in named)]
    return tuple(tuple(stage[names] for names in shared) for stage in named)


def options(scene: Scene, stage: int) -> tuple[Option, ...]:
    """Return the ways of making the gears of a stage (from 0)."""
    first, second = (gear_choices(scene, stage, member) for member in MEMBERS)
    return tuple(_option(scene, stage, a, b) for a in first for b in second)


def _option(
    scene: Scene, stage: int, pinion: tuple[GearTable, Any], wheel: tuple[GearTable, Any]
) -> Option:
    """Return one way of making the gears of a stage: what each has, and its material or None."""
    assert scene.rating
    gears, materials = zip(pinion, wheel, strict=True)
    operation = unit_operation(scene, gears)
    made = [
        one.limits(scene, stage, gears, operation, loads(scene))
        for one in STANDARDS[scene.rating.standard]
    ]
    if len(made) > 1:
        made[1] = replace(made[1], suffix=SECOND)
    named = tuple(one.name if one else "" for one in materials)
    densities = tuple(one.density.value if one and one.density else None for one in materials)
    prices = tuple(float(one.price) if one and one.price is not None else 1.0 for one in materials)
    words = " and ".join(filter(None, named))
    return Option(tuple(made), words, _two(densities), _two(prices), _two(named))


def _two(values: tuple[Any, ...]) -> tuple[Any, Any]:
    return values[0], values[1]


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
    if found is None or not found.met_by_all:
        why = "has no rating" if found is None else f"is unsafe: {found.governs}"
        raise CertificateError(f"the design that ratings limit {why}")


def rated_afterwards(scene: Scene, result: Result) -> Result:
    """Return a result whose proof names its scope, where its rating did not limit the sizes."""
    if scene.rating is None or scene.by_ratings or scene.given or result.value is None:
        return result
    before = result.proof.get("scope")
    words = ", ".join(filter(None, (before, "sized by load limits alone, rated afterwards")))
    return replace(result, proof=result.proof | {"scope": words})
