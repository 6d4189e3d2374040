"""The numbers of a drive's file that a remedy may move, and the file with some of them moved."""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from gearopt.optimise.explaining.handles import Handle
from gearopt.optimise.explaining.repair import FACTOR_TOLERANCE
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.explaining.moves import DUTY, LIMIT, SIZE, Edited, Move, Moves, edited
from gearopt.scenes.explaining.numbers import Path, eased, taken_back, written
from gearopt.scenes.reading.toml_writing import exact
from gearopt.units import Quantity

FIELDS: dict[str, tuple[str, int | None]] = {
    # name of a limit or of a given size -> key in the file, and its end of a range; limits of the
    # strength law are written under their names
    "wheel_diameter": ("wheel_diameter", None),
    "module_low": ("module", 0),
    "module_high": ("module", 1),
    "pinion_teeth_low": ("pinion_teeth", 0),
    "pinion_teeth_high": ("pinion_teeth", 1),
    "wheel_teeth_low": ("wheel_teeth", 0),
    "wheel_teeth_high": ("wheel_teeth", 1),
    "stage_ratio_low": ("stage_ratio", 0),
    "stage_ratio_high": ("stage_ratio", 1),
    "face_width_over_diameter_low": ("face_width_over_diameter", 0),
    "face_width_over_diameter_high": ("face_width_over_diameter", 1),
    "face_width_over_module_low": ("face_width_over_module", 0),
    "face_width_over_module_high": ("face_width_over_module", 1),
    "minimum_face_width": ("minimum_face_width", None),
    "sum_of_centre_distances_low": ("sum_of_centre_distances", 0),
    "sum_of_centre_distances_high": ("sum_of_centre_distances", 1),
    "overlap_ratio": ("overlap_ratio", None),
    "axial_force": ("axial_force", None),
    "module": ("module", None),
    "pinion_teeth": ("pinion_teeth", None),
    "wheel_teeth": ("wheel_teeth", None),
    "face_width": ("face_width", None),
    "face_width_over_diameter": ("face_width_over_diameter", None),
}
OF_DUTY = {"ratio_low": "ratio_tolerance", "ratio_high": "ratio_tolerance"}
WIDTH = "face_width_over_diameter"


def moves_of(scene: Scene, handles: Sequence[Handle]) -> list[Move]:
    """Return every number that a remedy may move, with the handles of the problem behind it.

    A number of [limits] or [gears] for all stages that have none of their own, and that of each
    stage alone; where a single stage takes it from there, once.
    """
    moves: list[Move] = []
    groups: dict[tuple[str, int], list[Handle]] = {}
    of_duty = OF_DUTY | {"torque": scene.duty.load_key}
    for handle in handles:
        groups.setdefault((handle.family, handle.direction), []).append(handle)
    for (family, direction), group in groups.items():
        if family in of_duty:
            path: Path = ("duty", of_duty[family])
            if inherited(scene, path):  # a tolerance of zero has no factor
                end = {"ratio_low": 0, "ratio_high": 1}.get(family)
                moves.append(_move(scene, family, path, end, direction, DUTY, tuple(group)))
        elif family in fields(scene):
            moves += _of_stages(scene, family, direction, {stage_of(h): h for h in group})
    return moves


def _of_stages(scene: Scene, family: str, direction: int, group: dict[int, Handle]) -> list[Move]:
    field, own_end = fields(scene)[family]
    table = "gears" if field == WIDTH else "limits"
    shared = getattr(getattr(scene, table), field, None)
    takers = [k for k in group if not scene.stage or getattr(scene.stage[k], field) is None]
    given = next(iter(group.values())).given
    # A range of [limits] with equal ends is widened; a size that a stage gives is moved, and b/d1.
    widened = given and field != WIDTH
    end = (0 if direction < 0 else 1) if widened else own_end
    taken = LIMIT if widened or not given else SIZE
    moves = []
    if shared is not None and takers:
        behind = tuple(group[k] for k in takers)
        moves.append(_move(scene, family, (table, field), end, direction, taken, behind))
    for k, handle in group.items():
        path = ("stage", k, field)
        if k not in takers:
            role = SIZE if given else LIMIT
            moves.append(_move(scene, family, path, own_end, direction, role, (handle,)))
        elif shared is not None and takers != [k]:
            moves.append(_move(scene, family, path, end, direction, taken, (handle,)))
        elif shared is None and inherited(scene, path) is not None:  # a load limit of a preset
            moves.append(_move(scene, family, path, own_end, direction, LIMIT, (handle,)))
    return moves


def fields(scene: Scene) -> dict[str, tuple[str, int | None]]:
    """Return FIELDS with the limits of the strength law before them."""
    return {name: (name, None) for name in scene.limits.LAW.names} | FIELDS


def stage_of(handle: Handle) -> int:
    """Return the stage (from 0) that a handle belongs to."""
    return int(handle.name.split("[")[1].rstrip("]")) - 1 if "[" in handle.name else 0


def staged(scene: Scene) -> Scene:
    """Return the scene with one table per stage."""
    if scene.stage:
        return scene
    return scene.model_copy(update={"stage": (StageTable(),) * scene.counts[0]})


def _move(
    scene: Scene,
    family: str,
    path: Path,
    end: int | None,
    way: int,
    role: str,
    behind: tuple[Handle, ...],
) -> Move:
    """Return a move of a number of the file, or of an end of a range (None: the number, or both).

    More of it is never harder of limits, the duty, and b/d1.
    """
    series = path[-1] == "module" and scene.teeth is not None
    return Move(
        path,
        1 if path[-1] == "ratio_tolerance" else way,  # of the lowest ratio, too
        role,
        family,
        far=min(handle.reach for handle in behind),
        far_first=role != SIZE or family == WIDTH,
        handles=behind,
        inherits=inherited,
        write=partial(_value, scene, end),
        back=partial(_module_back, scene) if series else taken_back,
        text=_raw,
        listed=series,
    )


def shared(move: Move) -> bool:
    """Return whether a number holds for more than one stage."""
    return move.path[0] != "stage"


def applied(scene: Scene, moves: Moves) -> Edited | None:
    """Return the scene with numbers moved, those that stages share first; None: it is refused."""
    return edited(staged(scene), tuple(sorted(moves, key=lambda move: not shared(move[0]))))


def _raw(value: Any, path: Path) -> Any:
    """Return a value as its table writes it: in [limits] a range stays one with equal ends."""
    raw = written(value, path)
    pair = isinstance(value, tuple) and path[0] == "limits" and not isinstance(raw, list)
    return [raw, raw] if pair else raw


def _value(scene: Scene, end: int | None, now: Any, factor: float, move: Move) -> Any:
    """Return the value to write for a factor; None where no module of [teeth] is left."""
    if move.path[-1] == "ratio_tolerance":
        return max(now, eased(tolerance(now, end, factor), 1.0, 1))
    if not isinstance(now, tuple):
        return eased(now, factor, move.way)
    ends = list(now)
    for k in (0, 1) if end is None else (end,):
        ends[k] = eased(ends[k], factor, move.way)
        if move.listed:
            ends[k] = next_module(scene, ends[k], move.way, beyond=False)
    return None if None in ends else tuple(ends)


def steps(scene: Scene, move: Move) -> list[float]:
    """Return the factors of all values of a whole number or module, near ones first; else empty."""
    now = inherited(scene, move.path)
    now = now[moved_end(move) or 0] if isinstance(now, tuple) else now
    if move.listed:
        size = now.exact[0]
        assert scene.teeth is not None
        beyond = [m for m in scene.teeth.sizes if (m - size) * move.way > 0]
        return sorted(float(max(m, size) / min(m, size)) for m in beyond)
    if not isinstance(now, int):
        return []
    far = 4 * now if move.way > 0 else max(1, now // 4)
    values = range(now + move.way, far + move.way, move.way)
    return [max(v, now) / min(v, now) for v in values]


def moved_end(move: Move) -> int | None:
    """Return which end of a range moves; None: it is a number, or both move."""
    assert isinstance(move.write, partial)
    end: int | None = move.write.args[1]
    return end


def tolerance(now: Fraction, end: int | None, factor: float) -> Fraction:
    """Return the ratio tolerance at which the lowest (0) or highest (1) ratio is a factor out."""
    f = Fraction(factor)
    return 1 - (1 - now) / f if end == 0 else (1 + now) * f - 1


def bound_of(scene: Scene, move: Move, bound: float | None) -> float | None:
    """Return the proven minimum factor of a number as the file has it, from that of its handles."""
    if bound is None:
        return None
    if move.path[-1] == "ratio_tolerance":
        now = scene.duty.ratio_tolerance
        return float(tolerance(now, moved_end(move), bound) / now)
    return None if _mismatched(scene, move) else bound


def _mismatched(scene: Scene, move: Move) -> bool:
    """Return whether the problem has another number than the file: an end between two modules."""
    now, end = inherited(scene, move.path), moved_end(move)
    if not move.listed or end is None:
        return False
    return any(float(now[end].exact[0]) != h.value for h in move.handles)


def comparable(scene: Scene, found: Sequence[Move]) -> bool:
    """Return whether a proven minimum product of handles is one of the file's numbers."""
    return not any(_mismatched(scene, move) for move in found)


def reachable(scene: Scene, move: Move) -> Move:
    """The number with its reach cut to the range that the file's rules allow (1: no move)."""
    low, high = 1.0, max((h.reach for h in move.handles), default=1.0)
    if applied(scene, ((move, high),)) is not None:
        return move
    while high > low * FACTOR_TOLERANCE:
        middle = math.sqrt(low * high)
        refused = applied(scene, ((move, middle),)) is None
        low, high = (low, middle) if refused else (middle, high)
    return replace(move, far=low, handles=tuple(replace(h, reach=low) for h in move.handles))


def _module_back(scene: Scene, now: Any, before: Any, part: float) -> Any:
    """Return a range of modules with its moved ends one module nearer to where they were."""
    ends = list(now)
    for k, (new, old) in enumerate(zip(now, before, strict=True)):
        sizes = new.exact[0], old.exact[0]
        if sizes[0] != sizes[1]:
            way = 1 if sizes[1] > sizes[0] else -1
            neighbour = next_module(scene, new, way)
            ends[k] = (
                old if neighbour is None or (neighbour.exact[0] - sizes[1]) * way > 0 else neighbour
            )
    return tuple(ends)


def inherited(scene: Scene, path: Path) -> Any:
    """Value at a place of the file: its own, or that for all stages."""
    field = str(path[-1])
    stage = scene.stage[path[1]] if path[0] == "stage" and scene.stage else None  # type: ignore[index]
    if stage is not None and getattr(stage, field) is not None:
        return getattr(stage, field)
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
    """Return the next module of [teeth] up (+1) or down (-1), beyond or at one; in its unit."""
    assert scene.teeth is not None
    size = module.exact[0]
    candidates = [
        m for m in scene.teeth.sizes if (m - size) * direction > 0 or (m == size and not beyond)
    ]
    if not candidates:
        return None
    nearest = module.of(min(candidates, key=lambda m: abs(m - size)))
    decimal = Fraction(exact(nearest.number)) == nearest.number
    return nearest if decimal else eased(nearest, 1.0, direction)
