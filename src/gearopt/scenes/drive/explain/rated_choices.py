"""Choices of an impossible rated drive that make it possible alone: steels, series, stages ..."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.physics.iso6336.materials import QUALITIES, Material
from gearopt.scenes.drive.explain.choice_moves import finer_series
from gearopt.scenes.drive.explain.planets import one_number, ways_of_planets
from gearopt.scenes.drive.explain.rated_conflict import Conflict
from gearopt.scenes.drive.explain.requirements import DISTANCE
from gearopt.scenes.drive.scene import MOST_STAGES, Scene
from gearopt.scenes.explaining.numbers import allowed, content, written
from gearopt.scenes.reading.module_series import SERIES, family, series_of
from gearopt.scenes.reading.toml_writing import toml_text

Works = Callable[[Scene], bool | None]
Ways = Iterator[tuple[tuple[Change, ...], Scene]]
GRADES = (1, 2, 3)  # metallurgical ones of AGMA


def choices(scene: Scene, known: Conflict, works: Works) -> Iterator[Remedy]:
    """Yield choices that suffice alone: more materials, a better grade, a series, another count.

    known: what is in no conflict is not tried. works(scene): whether a changed drive has a design.
    """
    every: tuple[tuple[str, Callable[[Scene], Ways]], ...] = (
        ("same_materials", _own_materials),
        ("materials", _materials),
        ("material_grade", _with_better_grades),
        ("coaxial", _not_coaxial),
        ("sum_of_centre_distances", _of_any_sum),
        ("", _by_rule),
        (DISTANCE, _finer_distances),
        ("", _others),
    )
    families = {name.split("[")[0] for name in known.names}
    for name, ways in every:
        if name and families and name not in families:
            continue
        yield from _first(ways(scene), works)
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


def _materials(scene: Scene) -> Ways:
    """Yield the drives whose gears may have one material of the file more."""
    chosen = scene.gears.materials
    for material in scene.material if chosen else ():
        assert chosen
        if material.name not in chosen:
            more = (*chosen, material.name)
            change = Change("gears.materials", toml_text(list(chosen)), toml_text(list(more)), 1.0)
            yield (change,), _with_gears(scene, {"materials": more})


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
        better: dict[str, Any] = {}
        for key, now, ladder in ladders:
            k = min(ladder.index(now) + more, len(ladder) - 1)
            better |= {key: (getattr(gears, key), ladder[k])} if ladder[k] != now else {}
        some = [{key: value} for key, value in better.items()]
        for update in [*some, better] if len(some) > 1 else some:
            changes = tuple(
                Change(f"gears.{key}", "" if was is None else toml_text(was), toml_text(new), 1.0)
                for key, (was, new) in update.items()
            )
            yield changes, _with_gears(scene, {key: new for key, (_, new) in update.items()})


def _not_coaxial(scene: Scene) -> Ways:
    """Yield the drive whose stages need not have one centre distance."""
    if scene.limits.coaxial:
        yield (Change("limits.coaxial", "true", "false", 1.0),), _limited(scene, {"coaxial": False})


def _of_any_sum(scene: Scene) -> Ways:
    """Yield the drive whose centre distances may have any sum."""
    now = scene.limits.sum_of_centre_distances
    if now is not None:
        key = "sum_of_centre_distances"
        was = toml_text(written(now, ("limits", key)))
        yield (Change(f"limits.{key}", was, "", 1.0),), _limited(scene, {key: None})


def _by_rule(scene: Scene) -> Ways:
    """Yield the drive whose profile shifts are those of a rule."""
    shift = scene.shift
    if shift is not None and shift.pinion_shift is not None:
        was = toml_text(written(shift.pinion_shift, ("shift", "pinion_shift")))
        other = shift.model_copy(update={"pinion_shift": None})
        change = Change("shift.pinion_shift", was, "", 1.0)
        yield (change,), scene.model_copy(update={"shift": other})


def _finer_distances(scene: Scene) -> Ways:
    """Yield the drives whose stages choose of a finer series of distances, each alone or all."""
    finer = {k: [*finer_series(own.centre_distance)] for k, own in enumerate(scene.stage)}
    finer = {k: series for k, series in finer.items() if series}
    alone = [(k,) for k in finer] if not scene.limits.coaxial else []
    for places in [*alone, tuple(finer)] if len(finer) > 1 else [tuple(finer)][: len(finer)]:
        for step in range(min(len(finer[k]) for k in places)):
            changes, stages = [], list(scene.stage)
            for k in places:
                was, new = stages[k].centre_distance, finer[k][step]
                old, write = (toml_text(written(one, ("stage", k, DISTANCE))) for one in (was, new))
                changes.append(Change(f"stage[{k + 1}].{DISTANCE}", old, write, 1.0))
                stages[k] = stages[k].model_copy(update={DISTANCE: new})
            yield tuple(changes), scene.model_copy(update={"stage": tuple(stages)})


def _limited(scene: Scene, update: dict[str, Any]) -> Scene:
    return scene.model_copy(update={"limits": scene.limits.model_copy(update=update)})


def _own_materials(scene: Scene) -> Ways:
    """Yield the drive with materials of every stage's own in place of the same for all."""
    if scene.gears.same_materials:
        change = Change("gears.same_materials", "true", "false", 1.0)
        yield (change,), _with_gears(scene, {"same_materials": False})


def _others(scene: Scene) -> Ways:
    """Yield the drives without hunting teeth, and with modules of a wider series."""
    teeth = scene.teeth
    if teeth is None:
        return
    if teeth.coprime:
        other = teeth.model_copy(update={"coprime": False})
        change = Change("teeth.coprime", "true", "false", 1.0)
        yield (change,), scene.model_copy(update={"teeth": other})
    was = toml_text(series_of(teeth.modules) or [str(m) for m in teeth.modules])
    for name in family(teeth.modules):
        if not set(SERIES[name]) <= set(teeth.modules):
            other = teeth.model_copy(update={"modules": SERIES[name]})
            change = Change("teeth.modules", was, toml_text(name), 1.0)
            yield (change,), scene.model_copy(update={"teeth": other})


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
    write = toml_text({key: one_number(value) for key, value in content(last).items()})
    return (f"stage[{n}]", "", write), scene.model_copy(update={"stage": (*scene.stage, last)})


def _with_gears(scene: Scene, update: dict[str, Any]) -> Scene:
    """Return the drive with keys of all its gears changed, as a file that gives them."""
    gears = scene.gears.model_copy(update=update)
    return scene.model_copy(update={"gears": gears})


def _gears(scene: Scene) -> list[Any]:
    return [gear for stage in scene.stage for gear in (stage.pinion, stage.wheel)]
