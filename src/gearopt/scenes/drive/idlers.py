"""Idlers: gears in two meshes, each the wheel of one stage and the pinion of the next."""

from typing import Any, TypeVar

from gearopt.scenes.drive.driving import drivers, may_drive
from gearopt.scenes.drive.face_widths import excesses
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.rating import OF_STAGE, with_shared
from gearopt.scenes.reading.fields import Table, refuse

T = TypeVar("T", bound=Table)
SHARED = (  # keys of a stage that follow from the wheel before, which is its pinion
    *("module", "diametral_pitch", "helix_angle", "pressure_angle", "face_width"),
    *("face_width_over_diameter", "face_width_step", "face_width_over_module"),
    "minimum_face_width",
)
# keys of both stages that no search beside an idler knows
UNSIZED = ("centre_distance", "stage_ratio", "overlap_ratio", "axial_force", *OF_STAGE[1:])


def idlers(stages: tuple[StageTable, ...]) -> tuple[int, ...]:
    """Stages, from 1, whose pinion is the wheel of the stage before."""
    return tuple(k for k, own in enumerate(stages, 1) if own.idler)


def check_idlers(scene: Any, lacks: str) -> None:
    """Refuse idlers that are laid out, and those of gears that are sized where no search can.

    lacks: what the file lacks for gears to be sized by ratings alone; "" for nothing.
    """
    for k in idlers(scene.stage):
        sized = scene.to_size or not scene.given
        rule = _beside(scene, k) if sized else ""
        rule = f"needs {lacks}" if lacks and sized else rule
        if "wheel" in (may_drive(scene) if sized else drivers(scene)[k - 2 : k]):
            rule = "needs pinions that drive, and a ratio of 1 at least, tolerance included"
        if scene.layout is not None:
            rule = "does not go together with a [layout]: a gear in two meshes is not laid out"
        if rule:
            tell = "Or give all gears, without [limits] and [layout], and gearopt rate FILE"
            raise refuse(rule, tell, ("stage", k - 1, "idler"), "tell")


def _beside(scene: Any, k: int) -> str:
    """Why gears beside the idler of a stage (from 1) are not sized; "" where they are."""
    both = scene.stage[k - 2 : k]
    gears = [with_shared(gear, scene.gears) for own in both for gear in (own.pinion, own.wheel)]
    if k < len(scene.stage) or any(own.idler for own in scene.stage[: k - 1]):
        return "is sized in the last stage alone, without another idler"
    if both[0].wheel_teeth is None:
        return f"needs its teeth: wheel_teeth of stage {k - 1}, a number or a range"
    if scene.objective.minimise not in ("gear_volume", "mass"):
        return f'needs minimise = "gear_volume" or "mass", not "{scene.objective.minimise}"'
    plain = all(blank(g, None).solid and not (g.thickness_allowance or g.materials) for g in gears)
    chosen = scene.shift or len(scene.helix_angles(both[0])) > 1
    if not plain or chosen or (scene.teeth and scene.teeth.coprime):
        return "needs solid gears of one material, helix angle and shift each, without coprime"
    if any(any(excesses(own, scene.gears)) for own in both):
        return "does not go together with pinion_face_width_excess"
    if both[0].wheel_diameter is not None:
        return f"does not go together with wheel_diameter of stage {k - 1}: limit its wheel_teeth"
    names = [name for own in both for name in UNSIZED if getattr(own, name) is not None]
    return f"does not go together with {names[0]} of its stages" if names else ""


def with_idlers(stages: tuple[StageTable, ...]) -> tuple[StageTable, ...]:
    """Stages in which idlers have the keys of the wheels that they are, and reversed loads.

    What a file says of an idler twice, and otherwise, is refused.
    """
    made: list[StageTable] = []
    for k, own in enumerate(stages):
        if own.idler and not made:
            raise refuse("is of the first stage: no wheel is before it", False, (k, "idler"))
        if own.idler:
            before = made[-1]
            if before.wheel.reversed_load is False:
                place = (k - 1, "wheel", "reversed_load")
                raise refuse("is of an idler, whose teeth are bent both ways", at=place)
            wheel = copied(before.wheel, {"reversed_load": True})
            made[-1] = copied(before, {"wheel": wheel})
            own = _following(made[-1], own, k)
        made.append(own)
    return tuple(made)


def _following(before: StageTable, own: StageTable, k: int) -> StageTable:
    """A stage (from 0) with the keys that follow from the wheel before."""
    values: dict[str, Any] = {name: getattr(before, name) for name in SHARED}
    values |= {"pinion_teeth": before.wheel_teeth, "pinion_hand": None}
    held: list[Any] = [((name,), getattr(own, name), value) for name, value in values.items()]
    held += [(("pinion", n), getattr(own.pinion, n), value) for n, value in before.wheel]
    for place, said, value in held:
        if said not in (None, value):
            rule = f"follows from the wheel of stage {k}, which is this pinion"
            raise refuse(rule, at=(k, *place), action="remove")
    return copied(own, values | {"pinion": before.wheel})


def copied(table: T, values: dict[str, Any]) -> T:
    """A table with other values, which its file does not hold."""
    copy = table.model_copy(update=values)
    object.__setattr__(copy, "__pydantic_fields_set__", set(table.model_fields_set))
    return copy
