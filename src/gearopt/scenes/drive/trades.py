"""The objectives of a drive, and the problem of several of them at once."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive.teeth import load_front
from gearopt.formulations.drive.train import EXTREMES, OBJECTIVES, Train
from gearopt.optimise.pareto.objectives import EPSILON, EXACT, Limiting, Objective, Tradeoff
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.driving import may_drive
from gearopt.scenes.drive.idlers import idlers
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.sizing import sized
from gearopt.scenes.drive.stage_types import open_types, words
from gearopt.scenes.drive.without import without
from gearopt.scenes.reading.ask import Ask


def objectives(scene: Scene) -> dict[str, str]:
    """Objectives of a front of the drive: name and unit."""
    to_choose(scene)
    names = {name: unit for name, unit in OBJECTIVES.items() if not _why_lacking(scene, name)}
    used = {load_front.UTILISATION: ""} if scene.teeth is not None else {}
    pairs = not idlers(scene.stage) and not any(own.epicyclic for own in scene.stage)
    by_rating = used and scene.by_ratings and not scene.limits.loaded and pairs
    return names | used | (EXTREMES if by_rating else {}) | _of_box(scene)


def _of_box(scene: Scene) -> dict[str, str]:
    """Objectives of a front of the box: name and unit."""
    if scene.layout is None:
        return {}
    from gearopt.scenes.drive import sides

    return sides.objectives(scene)


def to_choose(scene: Scene) -> None:
    """Raise SolveError for a drive that can only be rated."""
    if not scene.to_size:
        raise SolveError(
            "the file has no [limits] and no ratio, so there is nothing to choose: gearopt rate "
            "FILE rates its gears"
        )


def _why_lacking(scene: Scene, name: str) -> str:
    """The reason why the drive lacks an objective; "" where it has it."""
    try:
        for each in scene.each if open_types(scene) else scene.each[:1]:
            replace(each.train(), objective=name)
    except ValueError as reason:
        return str(reason)
    return ""


def advice(scene: Scene, names: Sequence[str]) -> str:
    """Return why the drive has not one of these objectives; "" where nothing is known of it."""
    why = (_why_lacking(scene, name) for name in names if name in OBJECTIVES)
    what = next(filter(None, why), "")
    if not what and any(name in EXTREMES for name in names):
        what = "it needs a table [teeth], limits by [rating] alone and no idler, planets or ring"
    hint = ', as in [objective] density = "7.85 kg/dm^3"' if "density" in what else ""
    return what + hint


def traded(scene: Scene, names: Sequence[str], ask: Ask) -> Tradeoff:
    """Return the problem of a front; SolveError where the drive has none.

    With a [teeth] table it is of whole teeth, but for epsilon constraints, which are for
    real-valued sizes. Objectives of a box are those of gears that are sized first.
    """
    method, boxed = ask.method, [name for name in names if name in _of_box(scene)]
    if boxed:
        from gearopt.scenes.drive import sides

        if len(boxed) < len(names):
            raise SolveError(
                f"{', '.join(boxed)} of the box and objectives of the gears cannot share a front: "
                "the gears are sized first, and laid out then"
            )
        sides.check(scene)
        gears = sized(without(scene, "layout"), ask.beforehand)
        held = scene.held(len(gears.design["stages"])) if gears.value is not None else scene
        return sides.traded(held, names, gears)
    each = [
        replace(
            _of_train(scene, chosen.train(driver), names, method),
            part=f"{_words(scene, chosen)}, {driver} drives".removesuffix(", pinion drives"),
        )
        for chosen in scene.each
        for driver in may_drive(scene)
    ]
    curves = any(chosen.limiting is not None and not chosen.limiting.whole for chosen in each)
    if len(each) > 1 and (scene.teeth is None or method not in (None, EXACT) or curves):
        raise SolveError(
            "numbers of stages or their types, and ratios above 1 and below, are compared by "
            "complete fronts alone, of whole teeth: write stages = 2, or another number, one type "
            "for each [[stage]], and a ratio_tolerance on one side of 1"
        )
    return replace(each[0], others=tuple(each[1:])) if len(each) > 1 else replace(each[0], part="")


def _words(scene: Scene, held: Scene) -> str:
    n = held.counts[0]
    return words(held) if open_types(scene) else f"{n} stage{'s' * (n > 1)}"


def _of_train(scene: Scene, train: Train, names: Sequence[str], method: str | None) -> Tradeoff:
    """The problem of a front of one number of stages, of which one member drives."""
    if any(name in EXTREMES or name == load_front.UTILISATION for name in names):
        return _against_extreme(train, names)
    train = replace(train, objective=names[0], others=tuple(names[1:]))
    listed = tuple(Objective(name, OBJECTIVES[name]) for name in names)
    whole = scene.teeth is not None and method != EPSILON
    if not whole and train.rated:
        raise SolveError(
            "ratings limit whole teeth alone where there are several objectives: write a table "
            f"[teeth], and a method other than {EPSILON}"
        )
    if not whole:
        return Tradeoff(continuous_sizing.problem(train), listed, lambda x: _real_design(train, x))
    return Tradeoff(teeth.problem(train), listed, lambda x: _whole_design(train, x))


def _against_extreme(train: Train, names: Sequence[str]) -> Tradeoff:
    """Return the problem of a front against a largest value over the stages."""
    *others, extreme = (name for name in names if name not in OBJECTIVES)
    if others or len(names) != 2 or names[1] != extreme:
        raise SolveError(
            f"{extreme} is a maximum over the stages, which does not add up: it is the second of "
            f"two objectives, as in gear_volume,{extreme}"
        )
    train = replace(train, objective=names[0])
    listed = (
        Objective(names[0], OBJECTIVES[names[0]]),
        Objective(extreme, EXTREMES.get(extreme, "")),
    )
    limiting = Limiting(
        lambda name, most: load_front.limited(train, name, most, extreme),
        tuple(names),
        load_front.discrete(train),
    )
    problem = load_front.problem(train, tuple(names))
    return Tradeoff(problem, listed, lambda x: _whole_design(train, x), limiting)


def _real_design(train: Train, x: Array) -> Mapping[str, Any]:
    return _design(train, sizing_text.pairs(train, x))


def _whole_design(train: Train, x: Array) -> Mapping[str, Any]:
    return _design(train, *teeth.gears(train, x))


def _design(train: Train, *gears: Any) -> Mapping[str, Any]:
    from gearopt.formulations.drive.design import describe

    design: Mapping[str, Any] = untyped(describe(train, *gears))
    return design
