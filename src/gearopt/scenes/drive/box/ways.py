"""Ways out of an impossible layout, as edits of its file that were tried before they are told."""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from itertools import combinations
from typing import Any

from gearopt.formulations import layout
from gearopt.formulations.layout.faults import possible
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.box.moves import Move, limits_of, moves, switches
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import allowed
from gearopt.scenes.reading.ask import Ask
from gearopt.units import Quantity

SECONDS = 2.0  # at most, for one question whether a layout is possible
HALF = 0.5  # the same while a size is halved: what fits is found in less, mostly
BRIEF = 0.2  # and beyond a size that stayed undecided
COARSE = 8  # halvings of the common size of two moves, by which pairs are compared
PAIRS = 6  # that are worked out
HALVINGS = 20  # of the size within which the file's own rules hold

Pair = tuple[Move, Move]
Asks = Callable[[float, float], bool | None]  # size and seconds: whether a layout is possible


class Questions:
    """Asks whether changed files can be laid out, within one clock.

    It has state because questions stay open: open, what a message says of them.
    """

    def __init__(self, pairs: tuple[GearPair, ...], clock: Clock) -> None:
        self._pairs, self._clock, self.open = pairs, clock, list[str]()

    def fits(self, scene: Scene, seconds: float = SECONDS) -> bool | None:
        """Whether these gears can be laid out; None where that is not known in time."""
        if self._clock.over:
            return None
        box = self.read(scene)
        if box is None or layout.faults(box):
            return False
        return possible(box, self._clock.within(seconds), self._clock.watch)

    def read(self, scene: Scene) -> Gearbox | None:
        """The gearbox of a changed file; None where its own rules refuse it."""
        return gearbox_of(scene, self._pairs) if allowed(scene) else None

    def smallest(
        self, scene: Callable[[float], Scene], steps: int, key: str, high: float | None = None
    ) -> list[float]:
        """Sizes of a change known to fit, the smallest first; none where there is none.

        scene: the file with the change of some size. high: a size known to fit. A size that stays
        undecided is not known to fit; it is noted in `open` where no size is known to fit.
        """
        if self._clock.over:
            return []
        if high is None:
            high = self._farthest(scene) if steps else 1.0
            found = self.fits(scene(high))
            if found is None:
                self.open.append(key)
            if not found:
                return []
        return _halved(lambda size, seconds: self.fits(scene(size), seconds), high, steps)

    def _farthest(self, scene: Callable[[float], Scene]) -> float:
        """The largest size, up to 1, with which the rules of the file hold."""
        low, high = 0.0, 1.0
        if self.read(scene(high)) is not None:
            return high
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.read(scene(middle)) is None else (middle, high)
        return low

    def proposal(
        self, scene: Callable[[Any], Scene], move: Move, sizes: Sequence[float]
    ) -> tuple[float, Any] | None:
        """Size and what to write for it: the first that a layout is known to exist with."""
        seconds = SECONDS
        for size in sizes:
            for value in move.proposed(size):
                found = self.fits(scene(value), seconds)
                if found:
                    return size, value
                seconds = seconds if found is False else BRIEF
        return None


def ways(scene: Scene, pairs: tuple[GearPair, ...], ask: Ask) -> dict[str, Any]:
    """Each change that alone makes these gears possible to lay out; else pairs of changes."""
    clock = Clock(ask.budget, of_others(ask.watch))
    asked = Questions(pairs, clock)
    single, choices = moves(scene, pairs), switches(scene)
    chosen = [c for m in choices if (c := _chosen(scene, m, asked)) is not None]
    found = [r for m in single if (r := _moved(scene, m, asked)) is not None]
    remedies = [r for _, r in sorted(found, key=_size)] + chosen
    message = ""
    if remedies and asked.open:
        message = f"it is not known whether a change of {', '.join(asked.open)} alone does"
    elif not remedies:
        both = _pairs(scene, single + choices[::-1], asked)  # of two tables the last goes first
        remedies = [r for _, r in sorted(both, key=_size)]
        if asked.open and not remedies:
            message = "no way out was found, and not every change could be decided"
        elif not remedies:
            none = "no change of one number or of two makes a layout possible within what is tried"
            message = f"{none}: {', '.join(limits_of(single + choices))}"
    if clock.over:
        message = "time ran out before all ways out were tried"
    return {"conflict": [], "remedies": [asdict(r) for r in remedies], "message": message}


def _size(found: tuple[float, Remedy]) -> float:
    return found[0]


def gearbox_of(scene: Scene, pairs: tuple[GearPair, ...]) -> Gearbox | None:
    """The gearbox of a scene; None where numbers that were moved contradict each other."""
    try:
        return scene.gearbox(pairs)
    except ValueError:
        return None


def _halved(asks: Asks, high: float, steps: int) -> list[float]:
    """Sizes that fit, the smallest first, by halving from `high`, which fits."""
    low, known, seconds = 0.0, [high], HALF
    for _ in range(steps):
        middle = 0.5 * (low + known[0])
        found = asks(middle, seconds)
        if found:
            known.insert(0, middle)
            continue
        low = middle
        if found is None:  # no proof of less is found nearer: only what fits is
            seconds = BRIEF
    return known


def _moved(scene: Scene, move: Move, asked: Questions) -> tuple[float, Remedy] | None:
    """The least known size of one move and its remedy; None where none is known."""
    known = asked.smallest(
        lambda size: move.put(scene, move.searched(size)), move.steps, move.key()
    )
    found = asked.proposal(lambda value: move.put(scene, value), move, known)
    if found is None:
        if known:
            asked.open.append(move.key())
        return None
    size, value = found
    less = asked.fits(move.put(scene, move.back(value)))
    verified = {"with": "feasible", "with_less": _word(less)}
    change = _change(scene, move, value)
    return move.change(size), Remedy("least", move.what, (change,), change.factor, None, verified)


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


def _chosen(scene: Scene, move: Move, asked: Questions) -> Remedy | None:
    """A switch that suffices alone."""
    value = move.searched(1.0)
    if not asked.smallest(lambda _: move.put(scene, value), 0, move.key()):
        return None
    change = _change(scene, move, value)
    return Remedy("choice", move.what, (change,), 1.0, None, {"with": "feasible"})


def _pairs(scene: Scene, single: tuple[Move, ...], asked: Questions) -> list[tuple[float, Remedy]]:
    """Two changes that do together, each as small as the other allows; the smallest of them."""
    rough: list[tuple[float, float, Pair]] = []
    for pair in combinations(single, 2):
        if _same(*pair):
            continue

        def both(size: float, pair: Pair = pair) -> Scene:
            return _put(scene, pair, [m.searched(size) for m in pair])

        steps = COARSE if any(m.steps for m in pair) else 0
        key = " and ".join(m.key() for m in pair)
        for size in asked.smallest(both, steps, key)[:1]:
            rough.append((sum(m.change(size) for m in pair), size, pair))
    found = []
    for _, size, pair in sorted(rough, key=lambda r: r[0])[:PAIRS]:
        if (remedy := _together(scene, pair, size, asked)) is not None:
            found.append(remedy)
        else:
            asked.open.append(" and ".join(m.key() for m in pair))
    return found


def _same(one: Move, other: Move) -> bool:
    """Whether two moves change the same table or number, so that one undoes the other."""
    shared = min(len(one.path), len(other.path))
    return one.path[:shared] == other.path[:shared]


def _together(
    scene: Scene, pair: Pair, size: float, asked: Questions
) -> tuple[float, Remedy] | None:
    """The remedy of two moves that do with a common size: one made smaller, then the other."""
    sizes, values = [size, size], [m.searched(size) for m in pair]
    for k, move in enumerate(pair):

        def one(value: Any, k: int = k) -> Scene:
            return _put(scene, pair, [value if i == k else v for i, v in enumerate(values)])

        def searched(own: float, move: Move = move, one: Callable[[Any], Scene] = one) -> Scene:
            return one(move.searched(own))

        known = asked.smallest(searched, move.steps, move.key(), sizes[k])
        found = asked.proposal(one, move, known)
        if found is None:
            return None
        sizes[k], values[k] = found
    back = [
        asked.fits(_put(scene, pair, [m.back(v) if i == k else v for i, v in enumerate(values)]))
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


def _put(scene: Scene, pair: Pair, values: list[Any]) -> Scene:
    """Both changes, in the order of `moves` and `switches`: a table goes after others changed."""
    for move, value in zip(pair, values, strict=True):
        scene = move.put(scene, value)
    return scene
