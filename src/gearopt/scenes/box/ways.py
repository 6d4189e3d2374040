"""Ways out of an impossible layout, as edits of its file that were tried before they are told."""

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict
from itertools import combinations
from typing import Any

from gearopt.formulations import layout
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.layout.possible import possible
from gearopt.formulations.train import Sizes
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.repair import Clock
from gearopt.scenes.box.moves import Move, moves, switches
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.tables.drive import Scene
from gearopt.units import Quantity

SECONDS = 2.0  # at most, for one question whether a layout is possible
COARSE = 8  # halvings of the common size of two moves, by which pairs are compared
PAIRS = 6  # that are worked out

Possible = Callable[[Scene], bool | None]


def ways(scene: Scene, sizes: Sizes, ask: Ask) -> dict[str, Any]:
    """Each change that alone makes these gears possible to lay out; else pairs of changes."""
    clock = Clock(ask.budget, ask.watch)

    def tried(other: Scene) -> bool | None:
        left = clock.left.seconds
        if clock.over:
            return None
        box = gearbox_of(other, sizes)
        if box is None or layout.faults(box):
            return False
        return possible(box, SECONDS if left is None else min(SECONDS, left), clock.watch)

    single, choices = moves(scene, sizes), switches(scene)
    found = [r for m in single if (r := _moved(scene, m, tried)) is not None]
    found.sort(key=lambda r: r[0])
    chosen = [_chosen(scene, m, tried) for m in choices]
    alone = [r for _, r in found] + [r for r in chosen if r is not None]
    remedies = alone or [r for _, r in sorted(_pairs(scene, single + choices, tried), key=_size)]
    late = "" if remedies else "no change of one number or of two makes a layout possible"
    late = "time ran out before all ways out were tried" if clock.over else late
    return {"conflict": [], "remedies": [asdict(r) for r in remedies], "message": late}


def _size(found: tuple[float, Remedy]) -> float:
    return found[0]


def gearbox_of(scene: Scene, sizes: Sizes) -> Gearbox | None:
    """The gearbox of a scene; None where numbers that were moved contradict each other."""
    try:
        return scene.gearbox(sizes)
    except ValueError:
        return None


def _moved(scene: Scene, move: Move, tried: Possible) -> tuple[float, Remedy] | None:
    """The least size of one move and its remedy; None where none does, or it is not known."""

    def fits(size: float) -> bool | None:
        return tried(move.put(scene, move.searched(size)))

    if not fits(1.0):
        return None
    size = _least(fits, 1.0, move.steps)
    value = None if size is None else _proposal(scene, move, size, tried)
    if size is None or value is None:
        return None
    less = tried(move.put(scene, move.back(value)))
    verified = {"with": "feasible", "with_less": _word(less)}
    change = _change(scene, move, value)
    return move.change(size), Remedy("least", move.what, (change,), change.factor, None, verified)


def _least(fits: Callable[[float], bool | None], high: float, steps: int) -> float | None:
    """The least size up to `high`, which fits; None where that is not known in time."""
    low = 0.0
    for _ in range(steps):
        middle = 0.5 * (low + high)
        found = fits(middle)
        if found is None:
            return None
        low, high = (low, middle) if found else (middle, high)
    return high


def _proposal(scene: Scene, move: Move, size: float, tried: Possible) -> Any:
    """What to write for a move of some size: the first that a layout exists with."""
    return next((v for v in move.proposed(size) if tried(move.put(scene, v))), None)


def _word(found: bool | None) -> str:
    return "undecided" if found is None else ("feasible" if found else "infeasible")


def _change(scene: Scene, move: Move, value: Any) -> Change:
    """The edit of a move; its factor where a number is multiplied, else infinite (not told)."""
    factor = math.inf
    if move.texts:
        factor = 1.0
    elif isinstance(value, Quantity):
        now = move.searched(0.0)
        factor = max(value.value / now.value, now.value / value.value)
    return Change(move.key(), move.was(scene), move.write(value), factor)


def _chosen(scene: Scene, move: Move, tried: Possible) -> Remedy | None:
    """A switch that suffices alone."""
    value = move.searched(1.0)
    if not tried(move.put(scene, value)):
        return None
    change = _change(scene, move, value)
    return Remedy("choice", str(move.path[-1]), (change,), 1.0, None, {"with": "feasible"})


def _pairs(
    scene: Scene, single: tuple[Move, ...], tried: Possible
) -> Iterator[tuple[float, Remedy]]:
    """Two changes that do together, each as small as the other allows; the smallest of them."""
    rough = []
    for pair in combinations(single, 2):
        if pair[0].path == pair[1].path:
            continue

        def fits(size: float, pair: tuple[Move, ...] = pair) -> bool | None:
            return tried(_both(scene, pair, (size, size)))

        if fits(1.0):
            size = _least(fits, 1.0, COARSE if any(m.steps for m in pair) else 0)
            if size is not None:
                rough.append((sum(m.change(size) for m in pair), size, pair))
    for _, size, pair in sorted(rough, key=lambda r: r[0])[:PAIRS]:
        if (remedy := _together(scene, pair, size, tried)) is not None:
            yield remedy


def _both(scene: Scene, pair: tuple[Move, ...], sizes: tuple[float, ...]) -> Scene:
    for move, size in zip(pair, sizes, strict=True):
        scene = move.put(scene, move.searched(size))
    return scene


def _together(
    scene: Scene, pair: tuple[Move, ...], size: float, tried: Possible
) -> tuple[float, Remedy] | None:
    """The remedy of two moves that do with a common size: one made smaller, then the other."""
    sizes, values, now = [size, size], [], scene
    for k, move in enumerate(pair):

        def fits(own: float, k: int = k, now: Scene = now) -> bool | None:
            left = tuple(own if i == k else s for i, s in enumerate(sizes))
            return tried(_both(now, pair[k:], left[k:]))

        least = _least(fits, sizes[k], move.steps)
        if least is None:
            return None
        sizes[k] = least
        other = now if k else _both(now, pair[1:], tuple(sizes[1:]))
        value = _proposal(other, move, least, tried)
        if value is None:
            return None
        values.append(value)
        now = move.put(now, value)
    back = [
        tried(_put(scene, pair, [m.back(v) if i == k else v for i, v in enumerate(values)]))
        for k, m in enumerate(pair)
        if m.steps
    ]
    words = {_word(b) for b in back}
    verified = {"with": "feasible", "with_less": words.pop() if len(words) == 1 else "mixed"}
    if not back:
        verified.pop("with_less")
    changes = tuple(_change(scene, m, v) for m, v in zip(pair, values, strict=True))
    change = sum(m.change(s) for m, s in zip(pair, sizes, strict=True))
    what = " and ".join(m.what for m in pair)
    return change, Remedy("pair", what, changes, math.inf, None, verified)


def _put(scene: Scene, pair: tuple[Move, ...], values: list[Any]) -> Scene:
    for move, value in zip(pair, values, strict=True):
        scene = move.put(scene, value)
    return scene
