"""A drive without the tables that a question leaves aside: layout, processes, rating, webs."""

from typing import Any

from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.tables.blanks import BlankKeys
from gearopt.scenes.drive.tables.rating import MATERIAL, GivenTable


def without(scene: Scene, *tables: str) -> Scene:
    """Drive without its "layout", "processes", "rating" or "webs", whatever it has of them.

    Webs stay where ratings limit the sizes.
    """
    for table in tables:
        scene = DROPPED[table](scene)
    return scene


def _unlaid(scene: Scene) -> Scene:
    return scene.model_copy(update={"layout": None, "place": (), "keep_out": ()})


def _unruled(scene: Scene) -> Scene:
    return scene.model_copy(update=dict.fromkeys(PROCESSES))


def _unrated(scene: Scene) -> Scene:
    """Drive without the keys that only a rating afterwards reads."""
    if scene.rating is None:
        return scene
    bare = _without_keys(scene, MATERIAL)
    stages = tuple(stage.model_copy(update={"given": GivenTable()}) for stage in bare.stage)
    return bare.model_copy(update={"rating": None, "load": (), "stage": stages})


def _solid(scene: Scene) -> Scene:
    """Drive with solid gears: the same limits, where no ratings limit it."""
    return scene if scene.by_ratings else _without_keys(scene, tuple(BlankKeys.model_fields))


def _without_keys(scene: Scene, keys: tuple[str, ...]) -> Scene:
    """Drive without these keys of all gears and of each."""
    none: dict[str, Any] = dict.fromkeys(keys)
    stages = [
        stage.model_copy(
            update={m: getattr(stage, m).model_copy(update=none) for m in ("pinion", "wheel")}
        )
        for stage in scene.stage
    ]
    gears = scene.gears.model_copy(update=none)
    return scene.model_copy(update={"gears": gears, "stage": tuple(stages)})


DROPPED = {"layout": _unlaid, "processes": _unruled, "rating": _unrated, "webs": _solid}
