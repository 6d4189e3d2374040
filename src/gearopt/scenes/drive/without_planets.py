"""What of a file does not go together with planets or a ring, by its key."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from gearopt.scenes.drive.idlers import idlers
from gearopt.scenes.drive.rating.checks import not_given
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.planetary import INTERNAL, PLANETARY
from gearopt.scenes.reading.choices import values_of
from gearopt.scenes.reading.fields import refuse
from gearopt.scenes.reading.toml_writing import dotted

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

AIMS = ("gear_volume", "mass", "mesh_loss")
NO_RATING = 'Write a table [rating] with standard = "iso6336"; gearopt new planetary shows how'


def against(scene: "Scene", stage: StageTable, k: int) -> Iterator[PydanticCustomError]:
    """Yield why a file cannot have a stage (from 0) with planets or a ring."""
    kind = f'does not go together with type = "{stage.type}"'
    if scene.UNRATED:
        rule = "is of drives: a pair has external gears"
        yield refuse(rule, 'Write kind = "drive"', ("stage", k, "type"), "tell")
    if scene.rating is None:
        rule = f'is missing: type = "{stage.type}" is rated by ISO 6336'
        yield refuse(rule, NO_RATING, ("rating",), "tell")
    for place, why in _only_of_pairs(scene, stage):
        yield refuse(kind + why, at=place, action="remove")
    if scene.to_size and scene.objective.minimise not in AIMS:
        rule = f"{kind}, which has {', '.join(AIMS[:-1])} and {AIMS[-1]}"
        yield refuse(rule, AIMS[0], ("objective", "minimise"), "sample")
    if scene.to_size and stage.centre_distance is not None:
        if scene.given:
            rule = "sizes nothing: all gears are given, and at a centre_distance only rated"
            yield refuse(rule, at=("limits",), action="remove")
        rule = "is of gears that are all given: that of chosen ones follows from their shifts"
        yield refuse(rule, at=("stage", k, "centre_distance"), action="remove")
    for at, table in ((("stage", k), stage), (("gears",), scene.gears)):
        several = table.helix_angle is not None and len(values_of(table.helix_angle)) > 1
        if several and len(scene.helix_angles(stage)) > 1:
            first = str(scene.helix_angles(stage)[0])
            yield refuse(f"{kind}: it takes one", first, (*at, "helix_angle"), "sample")


def _only_of_pairs(scene: "Scene", stage: StageTable) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Yield places of what pairs of external gears alone have, each with the reason."""
    for name in ("process_one", "process_two"):
        if getattr(scene, name) is not None:
            yield (name,), ": processes are of external gears"
    if scene.layout is not None:
        yield from _of_layout(scene, stage)
    for k in idlers(scene.stage):
        yield ("stage", k - 1, "idler"), " in one drive"
    if scene.gears.same_materials:
        yield ("gears", "same_materials"), ""
    if scene.teeth and scene.teeth.coprime:
        yield ("teeth", "coprime"), ' (planets have mesh_order = "hunting")'
    for name in ("coaxial", "sum_of_centre_distances", "axial_force"):
        if getattr(scene.limits, name):
            yield ("limits", name), ": it is of pairs"


def _of_layout(scene: "Scene", table: StageTable) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Yield what of a [layout] a stage does not go together with."""
    assert scene.layout is not None
    if table.type == INTERNAL:
        yield ("layout",), ": a pinion stands inside its ring"
    if scene.layout.together:
        yield ("layout", "together"), ": its gears are sized before they are laid out"
    for name in ("bearing_widths", "slabs"):
        if getattr(scene.layout, name):
            yield ("layout", name), ": where they may be is not known"
    if all(stage.type == PLANETARY for stage in scene.stage):
        yield ("layout",), " alone, where all is in one line: another stage is of external gears"


def lacking(scene: "Scene", stage: StageTable) -> PydanticCustomError | None:
    """Why gears of a stage that is sized cannot be chosen by ratings; None where they can."""
    if scene.teeth is None:
        rule = f'is missing: with type = "{stage.type}" whole teeth are chosen'
        return refuse(rule, at=("teeth",))
    limits = ("preset", *scene.limits.LAW.names)
    if name := next((name for name in limits if getattr(scene.limits, name) is not None), None):
        rule = f'does not go together with type = "{stage.type}", which [rating] alone limits'
        return refuse(rule, at=("limits", name), action="remove")
    return None


def no_limits(scene: "Scene") -> PydanticCustomError:
    """The refusal of a file that lacks [limits], to size gears."""
    if not any(stage.epicyclic for stage in scene.stage):
        return refuse("is missing", at=("limits",))
    open_sizes = ", ".join(dotted(place) for place in not_given(scene.gears, scene.stage))
    rule = f"is missing (or, to rate given gears, write {open_sizes})"
    return refuse(rule, {"pinion_teeth": [12, 40]}, ("limits",), "sample")
