"""Choices of an impossible rated drive that make it possible alone: steels, series, stages ..."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.physics.iso6336.materials import QUALITIES, Material
from gearopt.scenes.drive.explain.choice_moves import finer_series
from gearopt.scenes.drive.explain.planets import ways_of_planets
from gearopt.scenes.drive.explain.rated_conflict import Conflict
from gearopt.scenes.drive.explain.requirements import DISTANCE
from gearopt.scenes.drive.scene import MOST_STAGES, Scene
from gearopt.scenes.explaining.moves import with_each, with_values
from gearopt.scenes.explaining.numbers import Path, allowed, content, put
from gearopt.scenes.reading.module_series import SERIES, family, series_of
from gearopt.scenes.reading.toml_writing import toml_text

Works = Callable[[Scene], bool | None]
Ways = Iterator[tuple[tuple[Change, ...], Scene]]
SUM = "sum_of_centre_distances"
GRADES = (1, 2, 3)  # metallurgical ones of AGMA


def choices(scene: Scene, known: Conflict, works: Works) -> Iterator[Remedy]:
    """Yield choices that suffice alone: more materials, a better grade, a series, another count.

    known: what is in no conflict is not tried. works(scene): whether a changed drive has a design.
    """
    gears, limits, shift = scene.gears, scene.limits, scene.shift
    chosen, summed = gears.materials or (), limits.sum_of_centre_distances is not None
    more = [(*chosen, m.name) for m in scene.material if chosen and m.name not in chosen]
    same, coaxial = [False] * gears.same_materials, [False] * limits.coaxial
    by_rule = [None] * (shift is not None and shift.pinion_shift is not None)
    every = (
        ("same_materials", with_each(scene, ("gears", "same_materials"), same)),
        ("materials", with_each(scene, ("gears", "materials"), more)),
        ("material_grade", _with_better_grades(scene)),
        ("coaxial", with_each(scene, ("limits", "coaxial"), coaxial)),
        (SUM, with_each(scene, ("limits", SUM), [None] * summed)),
        ("", with_each(scene, ("shift", "pinion_shift"), by_rule)),
        (DISTANCE, _finer_distances(scene)),
        ("", _others(scene)),
    )
    families = {name.split("[")[0] for name in known.names}
    for name, ways in every:
        if name and families and name not in families:
            continue
        yield from _first(ways, works)
    if scene.teeth is not None:
        yield from _stages(scene, works)


def choices_of_planets(scene: Scene, works: Works) -> Iterator[Remedy]:
    """Yield what stages with planets or a ring may write otherwise, each key alone."""
    for ways in ways_of_planets(scene):
        yield from _first(ways, works)


def _first(ways: Ways, works: Works) -> Iterator[Remedy]:
    """Yield the first way that suffices, if one does."""
    for changes, other in ways:
        if allowed(other) and works(other):
            what = ", ".join(change.key.split(".")[-1] for change in changes)
            yield Remedy("choice", what, changes, 1.0, None, {"with": "feasible"})
            return


def _with_better_grades(scene: Scene) -> Ways:
    """Yield the drives of the next better grades of steel that all gears share."""
    asked, gears = scene.rating, scene.gears
    assert asked
    if gears.materials or any(gear.grade or gear.iso_quality for gear in _gears(scene)):
        return
    ladders: list[tuple[str, Any, Sequence[Any]]] = []
    if asked.by_agma and (gears.grade is None or asked.by_iso6336):  # else it is a number's remedy
        ladders.append(("grade", gears.grade or GRADES[0], GRADES))
    if asked.by_iso6336:
        ladders.append(("iso_quality", gears.iso_quality or Material().quality, QUALITIES))
    for more in (1, 2):
        better: dict[Path, Any] = {}
        for key, now, ladder in ladders:
            k = min(ladder.index(now) + more, len(ladder) - 1)
            better |= {("gears", key): ladder[k]} if ladder[k] != now else {}
        some = [{key: value} for key, value in better.items()]
        for update in [*some, better] if len(some) > 1 else some:
            yield with_values(scene, update)


def _finer_distances(scene: Scene) -> Ways:
    """Yield the drives whose stages choose of a finer series of distances, each alone or all."""
    finer = {k: [*finer_series(own.centre_distance)] for k, own in enumerate(scene.stage)}
    finer = {k: series for k, series in finer.items() if series}
    alone = [(k,) for k in finer] if not scene.limits.coaxial else []
    for places in [*alone, tuple(finer)] if len(finer) > 1 else [tuple(finer)][: len(finer)]:
        for step in range(min(len(finer[k]) for k in places)):
            yield with_values(scene, {("stage", k, DISTANCE): finer[k][step] for k in places})


def _others(scene: Scene) -> Ways:
    """Yield the drives without hunting teeth, and with modules of a wider series."""
    teeth = scene.teeth
    if teeth is None:
        return
    yield from with_each(scene, ("teeth", "coprime"), [False] * teeth.coprime)
    was = toml_text(series_of(teeth.modules) or [str(m) for m in teeth.modules])
    for name in family(teeth.modules):
        if not set(SERIES[name]) <= set(teeth.modules):
            change = Change("teeth.modules", was, toml_text(name), 1.0)
            yield (change,), put(scene, ("teeth", "modules"), SERIES[name])


def _stages(scene: Scene, works: Works) -> Iterator[Remedy]:
    """Yield the next number of stages, up or down, with which the drive is possible."""
    low, high = scene.counts[0], scene.counts[-1]
    for n in (high + 1, low - 1):
        other = _of_stages(scene, n) if 1 <= n <= MOST_STAGES else None
        if other is None or not allowed(other[1]) or not works(other[1].held(n)):
            continue
        factor = n / high if n > high else low / n
        change = Change(*other[0], factor)
        yield Remedy("choice", "stages", (change,), factor, None, {"with": "feasible"})
        return


def _of_stages(scene: Scene, n: int) -> tuple[tuple[str, str, str], Scene] | None:
    """Return key, value and new value of a file with so many stages too, and its drive.

    A file with tables of its stages gets one more, like its last; it loses none.
    """
    low, high = scene.counts[0], scene.counts[-1]
    if not scene.stage:
        span = (min(low, n), max(high, n)) if scene.several else (n, n)
        was, write = (toml_text(list(s) if scene.several else s[0]) for s in ((low, high), span))
        return ("stages", was, write), scene.model_copy(update={"stages": span})
    if n < high or scene.stages is not None:  # else two places are to be written
        return None
    last = scene.stage[-1]
    write = toml_text({key: _one_number(value) for key, value in content(last).items()})
    return (f"stage[{n}]", "", write), scene.model_copy(update={"stage": (*scene.stage, last)})


def _one_number(value: Any) -> Any:
    """A range of equal ends as one number."""
    pair = isinstance(value, list) and len(value) == 2 and value[0] == value[1]
    return value[0] if pair else value


def _gears(scene: Scene) -> list[Any]:
    return [gear for stage in scene.stage for gear in (stage.pinion, stage.wheel)]
