"""A drive's file with some of its numbers changed, and with the changes taken back a step."""

from dataclasses import dataclass, replace
from typing import Any

from gearopt.optimise.explaining.explanation import Change
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import Path, at, put
from gearopt.scenes.explaining.remedies import taken_back
from gearopt.units import Quantity


@dataclass(frozen=True)
class Cure:
    """A changed scene, the edits that lead to it and the places they concern."""

    scene: Scene
    changes: tuple[Change, ...]
    paths: tuple[Path, ...]


def less(scene: Scene, cured: Cure, part: float, only: int | None = None) -> Scene:
    """The cured scene with its changes (or one of them) taken back by a part of their size.

    Whole numbers go back by one, modules of [teeth] to the one before.
    """
    found = cured.scene
    for k, path in enumerate(cured.paths):
        if only is not None and k != only:
            continue
        now, before = at(found, path), inherited(scene, path)
        series = path[-1] == "module" and scene.teeth is not None
        back = _module_back(scene, now, before) if series else taken_back(now, before, part)
        found = put(found, path, back)
    return found


def _module_back(scene: Scene, now: Any, before: Any) -> Any:
    """A range of modules with its moved ends one module nearer to where they were."""
    ends = list(now)
    for k, (new, old) in enumerate(zip(now, before, strict=True)):
        sizes = new.exact[0], old.exact[0]
        if sizes[0] != sizes[1]:
            way = 1 if sizes[1] > sizes[0] else -1
            one = next_module(scene, new, way)
            ends[k] = old if one is None or (one.exact[0] - sizes[1]) * way > 0 else one
    return tuple(ends)


def inherited(scene: Scene, path: Path) -> Any:
    """What holds at a place of the file: its own value, or that of the table for all stages."""
    field = str(path[-1])
    own = scene.stage[path[1]] if path[0] == "stage" and scene.stage else None  # type: ignore[index]
    if own is not None and getattr(own, field) is not None:
        return getattr(own, field)
    if path[0] == "duty":
        return getattr(scene.duty, field)
    if field == "face_width_over_diameter":
        return scene.gears.face_width_over_diameter
    if field in scene.limits.LAW.names:
        return scene.limits.load(field)
    return getattr(scene.limits, field, None)


def next_module(
    scene: Scene, module: Quantity, direction: int, beyond: bool = True
) -> Quantity | None:
    """The next module of [teeth] up (+1) or down (-1), beyond or at a module; in its unit."""
    assert scene.teeth is not None
    size = module.exact[0]
    found = [
        m for m in scene.teeth.modules if (m - size) * direction > 0 or (m == size and not beyond)
    ]
    if not found:
        return None
    nearest = min(found, key=lambda m: abs(m - size))
    return replace(module, number=nearest * module.number / size)
