"""Repairs of a drive written as its file would hold them: which key, and what to write there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from pydantic_core import PydanticCustomError

from gearopt.optimise.explaining.explanation import Change
from gearopt.optimise.explaining.handles import Handle
from gearopt.scenes.explaining.numbers import Path, at, eased, put, read, times, written
from gearopt.scenes.reading.toml import dotted, toml_text
from gearopt.scenes.tables.drive import Scene
from gearopt.scenes.tables.stages import StageTable
from gearopt.units import Quantity

FIELDS = {  # name of a limit or of a given size -> key in the file, and its end of a range
    "k_factor": ("k_factor", None),
    "unit_load": ("unit_load", None),
    "wheel_diameter": ("wheel_diameter", None),
    "module_low": ("module", 0),
    "module_high": ("module", 1),
    "pinion_teeth_low": ("pinion_teeth", 0),
    "pinion_teeth_high": ("pinion_teeth", 1),
    "wheel_teeth_low": ("wheel_teeth", 0),
    "wheel_teeth_high": ("wheel_teeth", 1),
    "stage_ratio_low": ("stage_ratio", 0),
    "stage_ratio_high": ("stage_ratio", 1),
    "face_width_low": ("face_width_over_diameter", 0),
    "face_width_high": ("face_width_over_diameter", 1),
    "module": ("module", None),
    "pinion_teeth": ("pinion_teeth", None),
    "face_width": ("face_width", None),
    "ratio": ("wheel_teeth", None),  # of a stage whose teeth are both given
}


@dataclass(frozen=True)
class Cure:
    """A changed scene, the edits that lead to it and the places they concern."""

    scene: Scene
    changes: tuple[Change, ...]
    paths: tuple[Path, ...]


def cure(scene: Scene, moves: Sequence[tuple[Handle, float]]) -> Cure | None:
    """The scene with limits moved by factors >= 1; None where the file cannot say so.

    Limits of all stages that move alike, and that the file sets for all, are changed where they
    stand; others in the table of their stage.
    """
    ends: dict[Path, dict[int | None, tuple[float, int]]] = {}
    count = len(scene.stage or ()) or int(scene.stages or 0)
    for handle, factor in moves:
        if handle.family in ("ratio_low", "ratio_high", "torque"):
            path: Path = ("duty", "power" if handle.family == "torque" else "ratio_tolerance")
            ends.setdefault(path, {})[_duty_end(handle)] = (factor, handle.direction)
            continue
        if handle.family not in FIELDS:
            return None
        field, end = FIELDS[handle.family]
        alike = [f for h, f in moves if h.family == handle.family and h.kind == handle.kind]
        stage = int(handle.name.split("[")[1].rstrip("]")) - 1 if "[" in handle.name else 0
        every = len(alike) == count and max(alike) == min(alike) and not handle.given
        home = _shared(scene, field) if every else None
        path = home or ("stage", stage, field)
        before = ends.setdefault(path, {}).get(end, (1.0, handle.direction))
        if before[1] != handle.direction:  # one number cannot move both ways
            return None
        ends[path][end] = (max(before[0], factor), handle.direction)
    changed, changes = _staged(scene, count), []
    for path, moved in ends.items():
        found = _moved(changed, path, moved)
        if found is None:
            return None
        was, value = found
        factor = _apart(inherited(changed, path), value)
        changed = put(changed, path, value)
        changes.append(Change(dotted(path), was, toml_text(written(value, path)), factor))
    return Cure(changed, tuple(changes), tuple(ends)) if changes else None


def _apart(before: Any, after: Any) -> float:
    """How far two values are apart, as a factor >= 1; of ranges, the ends that are furthest."""
    if isinstance(before, tuple):
        return max(_apart(a, b) for a, b in zip(before, after, strict=True))
    a, b = (float(v.number if isinstance(v, Quantity) else v) for v in (before, after))
    return max(a, b) / min(a, b) if min(a, b) > 0.0 else math.inf


def tolerance_factor(now: Fraction, handle: Handle, factor: float) -> float:
    """A factor of the lowest or highest ratio as one of the ratio tolerance now (> 0)."""
    return float(_tolerance(now, _duty_end(handle), factor) / now)


def less(scene: Scene, cured: Cure, part: float, only: int | None = None) -> Scene:
    """The cured scene with its changes (or one of them) taken back by a part of their size."""
    found = cured.scene
    for k, path in enumerate(cured.paths):
        if only is not None and k != only:
            continue
        now, before = at(found, path), inherited(scene, path)
        found = put(found, path, _towards(now, before, part))
    return found


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
    if field in ("k_factor", "unit_load"):
        return scene.limits.load(field)
    return getattr(scene.limits, field, None)


def _duty_end(handle: Handle) -> int | None:
    return {"ratio_low": 0, "ratio_high": 1}.get(handle.family)


def _shared(scene: Scene, field: str) -> Path | None:
    """The table that sets a field for all stages, if the file's stages all take it from there."""
    if any(getattr(own, field) is not None for own in scene.stage):
        return None
    table = "gears" if field == "face_width_over_diameter" else "limits"
    return (table, field) if getattr(getattr(scene, table), field, None) is not None else None


def _staged(scene: Scene, count: int) -> Scene:
    """The scene with one table a stage."""
    if scene.stage:
        return scene
    return scene.model_copy(update={"stage": (StageTable(),) * count})


def _moved(
    scene: Scene, path: Path, moved: dict[int | None, tuple[float, int]]
) -> tuple[str, Any] | None:
    """What stands at a place and the eased value, read back as a file would be; None if refused."""
    now = inherited(scene, path)
    if now is None:
        return None
    if path[-1] == "ratio_tolerance":
        value: Any = eased(max(_tolerance(now, end, f) for end, (f, _) in moved.items()), 1.0, 1)
    elif not isinstance(now, tuple):
        ((factor, direction),) = moved.values()
        value = eased(now, factor, direction)
    else:
        low, high = now
        for end, (factor, direction) in moved.items():
            changed = eased(now[0 if end is None else end], factor, direction)
            low = low if end == 1 else changed
            high = high if end == 0 else changed
        value = (low, high)
    if path[-1] == "module" and scene.teeth is not None:
        value = _standard(scene, value, moved)
        if value is None:
            return None
    raw = written(value, path)
    if isinstance(value, tuple) and path[0] != "stage" and not isinstance(raw, list):
        raw = [raw, raw]
    try:
        return toml_text(written(now, path)), read(type(at(scene, path[:-1])), str(path[-1]), raw)
    except PydanticCustomError:
        return None


def _standard(scene: Scene, value: Any, moved: dict[int | None, tuple[float, int]]) -> Any:
    """A range of modules with its moved ends at modules of [teeth]; None where there is none."""
    ends = list(value)
    for end, (_, direction) in moved.items():
        for k in (0, 1) if end is None else (end,):
            found = next_module(scene, ends[k], direction, beyond=False)
            if found is None:
                return None
            ends[k] = found
    return tuple(ends)


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


def _tolerance(now: Fraction, end: int | None, factor: float) -> Fraction:
    """The ratio tolerance at which the lowest (0) or highest (1) ratio is a factor further out."""
    f = Fraction(factor)
    return 1 - (1 - now) / f if end == 0 else (1 + now) * f - 1


def _towards(now: Any, before: Any, part: float) -> Any:
    """A value moved back by a part of its size; integers by one."""
    if isinstance(now, tuple):
        old = before if isinstance(before, tuple) else (before, before)
        return tuple(_towards(a, b, part) for a, b in zip(now, old, strict=True))
    number, target = (v.number if isinstance(v, Quantity) else v for v in (now, before))
    if number == target:
        return now
    if isinstance(now, int):
        return now + (1 if target > number else -1)
    return times(now, 1.0 - part if number > target else 1.0 + part)
