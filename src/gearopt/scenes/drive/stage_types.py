"""Stages whose type is chosen: the drives of every choice."""

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from gearopt.scenes.drive.planetary import NOT_YET, meaningless, with_gears_named
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.planetary import PARALLEL
from gearopt.scenes.reading.fields import refuse

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

MOST = 32  # choices of types that are compared
OF_PARALLEL = {*NOT_YET, "centre_distance"} - {"idler"}  # no stage that is sized has beside a ring


def open_types(scene: "Scene") -> bool:
    """Whether the type of a stage is to be chosen."""
    return any(len(stage.types) > 1 for stage in scene.stage)


def by_type(scene: "Scene") -> tuple["Scene", ...]:
    """The drives of all choices of types, in the order of the file; itself where it has one."""
    if not open_types(scene):
        return (scene,)
    return tuple(_of(scene, types) for types in product(*(stage.types for stage in scene.stage)))


def check_types(scene: "Scene") -> None:
    """Refuse types to choose from where none are chosen, or more choices than are compared."""
    if not open_types(scene):
        return
    rule = ""
    if not scene.to_size:
        rule = "has several types to choose from, of gears that are to be sized"
    elif scene.layout is not None:
        rule = "has several types, and a [layout] takes one"
    elif (number := math.prod(len(stage.types) for stage in scene.stage)) > MOST:
        rule = f"leaves {number} choices of types, and {MOST} at most are compared"
    if rule:
        k = max(k for k, stage in enumerate(scene.stage) if len(stage.types) > 1)
        raise refuse(rule, scene.stage[k].types[0], ("stage", k, "type"), "sample")


def held_as(scene: "Scene", design: Mapping[str, Any]) -> "Scene":
    """The drive with the number of stages of a design, and of their types."""
    types = [str(stage.get("type", PARALLEL)) for stage in design["stages"]]
    return _of(scene, types) if open_types(scene) else scene.held(len(types))


def words(scene: "Scene") -> str:
    """The types of the stages of a drive of one choice."""
    return ", ".join(stage.type for stage in scene.stage)


def _of(scene: "Scene", types: Sequence[str]) -> "Scene":
    rows = zip(scene.stage, types, strict=True)
    stages = (_as(stage, kind) if len(stage.types) > 1 else stage for stage, kind in rows)
    return scene.model_copy(update={"stage": tuple(stages)})


def _as(stage: StageTable, kind: str) -> StageTable:
    """A stage as one of its types, without the keys that only the others have."""
    wrong = {*meaningless(kind), *(OF_PARALLEL if kind != PARALLEL else ())}
    kept = {k: v for k, v in stage if k in stage.model_fields_set and k not in wrong}
    values: dict[str, Any] = kept | {"type": kind}
    return with_gears_named((StageTable.model_construct(set(values), **values),))[0]
