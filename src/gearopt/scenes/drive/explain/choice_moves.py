"""Moves of what stages choose from: centre distances, their sum, helix angles, shifts, their sum.

A list gets one entry more, a range with a step goes on by its steps, a series of preferred numbers
ends later. Of many values that may be added it is asked first whether all of them together make a
design possible, so that few questions lead to the nearest that does.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.physics.preferred_numbers import PREFERRED, preferred_numbers
from gearopt.scenes.drive.distances import MAX_ROWS, reach
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import Group
from gearopt.scenes.explaining.moves import Move
from gearopt.scenes.explaining.numbers import Path, allowed, at, put
from gearopt.scenes.reading.choices import Between, Choice, Preferred, Steps, values_of
from gearopt.units import Quantity, parse

FARTHEST = Fraction(5, 2)  # times the nearest distance of a file; of its sum, too
MOST_VALUES, MOST_SUMS = 12, 60  # that are tried one way
HELICES = tuple(parse(f"{n} deg", "angle") for n in range(0, 36, 5))
SHIFTS = tuple(Fraction(n, 10) for n in range(-6, 13))
SHIFT_SUMS = tuple(Fraction(n, 10) for n in range(-5, 16))
TEN_DEGREES = math.radians(10.0)  # counts as the factor 2, where a helix angle is or becomes zero
USUAL_SERIES = "R20"  # of distances that belong to none


def choice_groups(scene: Scene, way: int) -> Iterator[Group]:
    """Yield distances to choose from with further values above (way +1) or below them (-1).

    The sum of centre distances comes first, which distances of stages have to keep; last those of
    all stages together.
    """
    if scene.limits.sum_of_centre_distances is not None:
        yield from _sums(scene, way)
    places = _distances(scene)
    if len(places) > 1:
        places.append([path for own in places for path in own])
    for paths in places:
        yield from _group(scene, paths, _further_distances(scene, paths, way), way)


def teeth_groups(scene: Scene, way: int) -> Iterator[Group]:
    """Yield helix angles and profile shifts with further values above or below, as of distances."""
    for path, usual in _of_teeth(scene):
        now = at(scene, path)
        step = now.step if isinstance(now, Steps) else None
        further = _beyond(now, usual, step, way)
        within = [row for row in further if allowed(put(scene, path, with_value(now, row[1])))]
        yield from _group(scene, [path], within, way)


def _of_teeth(scene: Scene) -> Iterator[tuple[Path, Sequence[Any]]]:
    """Yield the places of helix angles and profile shifts that stages have, and usual values."""
    own: list[Path] = [
        ("stage", k, "helix_angle") for k, s in enumerate(scene.stage) if s.helix_angle is not None
    ]
    if not scene.stage or len(own) < len(scene.stage):
        yield ("gears", "helix_angle"), HELICES
    for path in own:
        yield path, HELICES
    for name, usual in (("pinion_shift", SHIFTS), ("sum", SHIFT_SUMS)):
        if getattr(scene.shift, name, None) is not None:
            yield ("shift", name), usual


def distances_of(scene: Scene) -> list[list[Fraction]]:
    """Centre distances [mm] that every stage chooses from."""
    return [
        sorted({a.exact[0] for a in values_of(own.centre_distance, reach(scene, own))})
        for own in scene.stage
        if own.centre_distance is not None
    ]


def _distances(scene: Scene) -> list[list[Path]]:
    """Places of distances that may be added: of coaxial stages to both, of others to each."""
    places: list[Path] = [
        ("stage", k, "centre_distance")
        for k, own in enumerate(scene.stage)
        if own.centre_distance is not None
    ]
    if scene.limits.coaxial:
        return [places]
    return [[p] for p in places if not isinstance(at(scene, p), Quantity)]


def _further_distances(
    scene: Scene, paths: Sequence[Path], way: int
) -> list[tuple[float, Quantity]]:
    """Factors and distances beyond those of some stages, near ones first.

    Of a range with a step they follow in its steps, of others in the series of its preferred
    numbers: the coarsest that has them all.
    """
    values = [at(scene, path) for path in paths]
    stepped = next((v for v in values if isinstance(v, Steps)), None)
    if stepped is not None:
        return _beyond(stepped, (), stepped.step, way)
    listed = [v for v in values if not isinstance(v, Preferred)]
    held = {a.exact[0] for v in listed for a in values_of(v)}
    ends = [v for v in values if isinstance(v, Preferred) and v.low is not None]
    held |= {a.exact[0] for v in ends for a in v.within(0.0, 0.0)}
    if not held:
        return []
    low, high = min(held), max(held)
    names = {v.series for v in ends} or {n for n in PREFERRED if held <= {*_all_of(n, low, high)}}
    series = min(names or {USUAL_SERIES}, key=lambda name: len(PREFERRED[name]))
    every = _all_of(series, low / FARTHEST, high * FARTHEST)
    beyond = [a for a in every if a not in held and (a < low if way < 0 else a > low)]
    near = sorted(beyond, key=lambda a: _apart(a, held))[:MOST_VALUES]
    return [(_apart(a, held), Quantity(a, "mm", "length")) for a in near]


def _all_of(series: str, low: Fraction, high: Fraction) -> tuple[Fraction, ...]:
    return preferred_numbers(series, low, high)


def _apart(value: Fraction, held: set[Fraction]) -> float:
    """How far a value is from the nearest of others, as a factor."""
    return min(float(max(value, other) / min(value, other)) for other in held)


def _beyond(now: Any, usual: Sequence[Any], step: Any | None, way: int) -> list[tuple[float, Any]]:
    """Factors and values beyond those of a choice, near ones first: by its step, or usual ones."""
    values = values_of(now)
    end = max(values, key=_size) if way > 0 else min(values, key=_size)
    if step is None:
        beyond = [v for v in usual if (_size(v) - _size(end)) * way > 1e-9]
        beyond.sort(key=lambda v: abs(_size(v) - _size(end)))
    else:
        beyond = [_shifted(end, step, way * n) for n in range(1, MOST_VALUES + 1)]
        beyond = [v for v in beyond if isinstance(v, Fraction) or _size(v) > 0.0]
    near, own = beyond[:MOST_VALUES], _size(end)
    if isinstance(end, Quantity) and min(own, *map(_size, near), 1.0) > 0.0:
        return [(max(_size(v), own) / min(_size(v), own), v) for v in near]
    return [
        (1.0 + abs(_size(v) - own) / (TEN_DEGREES if isinstance(v, Quantity) else 1.0), v)
        for v in near
    ]


def _size(value: Any) -> float:
    return float(value.value) if isinstance(value, Quantity) else float(value)


def _shifted(end: Any, step: Any, times: int) -> Any:
    """A value so many steps from another."""
    if isinstance(end, Quantity):
        return replace(end, number=end.number + times * step.number)
    return end + times * step


def with_value(now: Any, value: Any) -> Any:
    """What a stage chooses from, with one value more; of one number that value in its place."""
    if isinstance(now, Steps | Between):
        low, high = sorted((now.low, now.high, value), key=_size)[::2]
        return replace(now, low=low, high=high)
    if isinstance(now, Preferred):
        if now.low is None or now.high is None:
            return now
        low, high = sorted((now.low, now.high, value), key=_size)[::2]
        return replace(now, low=low, high=high)
    if isinstance(now, tuple):
        return now if _in(value, now) else tuple(sorted((*now, value), key=_size))
    return value


def _in(value: Any, values: Sequence[Any]) -> bool:
    return any(_size(value) == _size(other) for other in values)


def _together(now: Any, values: Sequence[Any]) -> Any:
    """What a stage chooses from, with several values more."""
    new = now if isinstance(now, tuple | Steps | Preferred | Between) else (now,)
    for value in values:
        new = with_value(new, value)
    return new


def _group(
    scene: Scene, paths: Sequence[Path], further: Sequence[tuple[float, Any]], way: int
) -> Iterator[Group]:
    """Yield the group of choices at some places that get the same further values."""
    values = [value for _, value in further]
    factors = [factor for factor, _ in further]
    moves = []
    for path in paths:
        now = at(scene, path)
        new = [with_value(now, value) for value in values]
        every = [_together(now, values[: k + 1]) for k in range(len(values))]
        if any(one != now for one in new):
            moves.append(Move(path, way).to_choices(now, factors, new, every))
    if moves:
        yield Group(tuple(moves))


def _sums(scene: Scene, way: int) -> Iterator[Group]:
    """Yield the limit on the sum of centre distances, with the next sums that stages have."""
    span = scene.limits.sum_of_centre_distances
    lists = distances_of(scene)
    assert span is not None
    if math.prod(map(len, lists)) > MAX_ROWS:
        return
    sums = {sum(row, Fraction(0)) for row in itertools.product(*lists)}
    path, number = ("limits", "sum_of_centre_distances"), span[0] == span[1]
    end = span[way > 0].exact[0]
    beyond = [s for s in sums if (s - end) * way > 0 and _apart(s, {end}) <= FARTHEST]
    near = sorted(beyond, key=lambda s: abs(s - end))[:MOST_SUMS]
    ends = [span[0].of(s) for s in near]
    every = [(span[0], e) if way > 0 else (e, span[1]) for e in ends]
    new = [(e, e) for e in ends] if number else every
    if near:
        yield Group(
            (Move(path, way).to_choices(span, [_apart(s, {end}) for s in near], new, every),)
        )


def finer_series(now: Choice | None) -> Iterator[Preferred]:
    """Yield the series that hold all values of a series and more, the coarsest first.

    Nothing where the choice is no series.
    """
    if isinstance(now, Preferred):
        names = list(PREFERRED)
        for name in names[names.index(now.series) + 1 :]:
            yield replace(now, series=name)
