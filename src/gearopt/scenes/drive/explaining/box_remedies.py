"""Remedies of an impossible layout, each of them tried; sensitivities of a possible one."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.drive.layout.faults import faults, possible
from gearopt.formulations.drive.layout.gearbox import Gearbox
from gearopt.formulations.drive.layout.layout_text import placed, read
from gearopt.formulations.drive.layout.slabs import arrangements
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import STEP
from gearopt.optimise.explaining.explanation import Change, Explanation, Remedies, Remedy
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run, solve
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.explaining.box_edits import Edit, edits, limits_of, switches
from gearopt.scenes.drive.explaining.other_gears import other_gears
from gearopt.scenes.drive.layout import others_may_fit
from gearopt.scenes.drive.layout_design import described, keep_out_design, pairs_of
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.influences import Basis, influences, smooth
from gearopt.scenes.explaining.numbers import allowed, numbers
from gearopt.units import Quantity

SECONDS = 2.0  # at most, for one question whether a layout is possible
HALF = 0.5  # the same while a size is halved: what fits is found in less, mostly
BRIEF = 0.2  # and beyond a size that stayed undecided
ROUGH_HALVINGS = 8  # halvings of the common size of two moves, by which pairs are compared
PAIRS = 6  # that are worked out
HALVINGS = 20  # of the size within which the file's own rules hold
SENSITIVITY_GAP = 0.01  # gap of the proof behind a sensitivity: the polished layout is far closer
SIZE_TIE = 1e-7  # relative, of boxes that are equal
GEARS_FIRST = "smallest changes are those for the gears sized first: others may need less"
TABLES = ("layout", "place", "keep_out")

Pair = tuple[Edit, Edit]
Found = tuple[float, Remedy, Scene]  # how much is changed, and the file with it
Asks = Callable[[float, float], bool | None]  # size and seconds: whether a layout is possible


class Questions:
    """Asks whether changed files can be laid out, within one clock.

    It has state because questions stay open: open, what a message says of them.
    """

    def __init__(self, pairs: tuple[GearPair, ...], clock: Clock) -> None:
        self._pairs, self._clock, self.open = pairs, clock, list[str]()

    def fits(self, scene: Scene, seconds: float = SECONDS) -> bool | None:
        """Return whether these gears can be laid out; None where that is not known in time."""
        if self._clock.over:
            return None
        box = self.read(scene)
        if box is None or faults(box):
            return False
        return possible(box, self._clock.within(seconds), self._clock.watch)

    def read(self, scene: Scene) -> Gearbox | None:
        """Return the gearbox of a changed file; None where its own rules refuse it."""
        return gearbox_of(scene, self._pairs) if allowed(scene) else None

    def smallest(
        self, scene: Callable[[float], Scene], steps: int, key: str, high: float | None = None
    ) -> list[float]:
        """Return sizes of a change known to fit, the smallest first; none where there is none.

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
        """Return the largest size, up to 1, with which the rules of the file hold."""
        low, high = 0.0, 1.0
        if self.read(scene(high)) is not None:
            return high
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.read(scene(middle)) is None else (middle, high)
        return low

    def proposal(
        self, scene: Callable[[Any], Scene], edit: Edit, sizes: Sequence[float]
    ) -> tuple[float, Any] | None:
        """Size and what to write for it: the first that a layout is known to exist with."""
        seconds = SECONDS
        for size in sizes:
            for value in edit.proposed(size):
                found = self.fits(scene(value), seconds)
                if found:
                    return size, value
                seconds = seconds if found is False else BRIEF
        return None


def remedies(scene: Scene, gears: Result, clock: Clock) -> Remedies:
    """Each change that alone lets these gears be laid out; else pairs of changes.

    drawn: a layout of the file with the first of them.
    """
    begun = clock.seconds
    layout.ready(clock.watch)
    clock.start += clock.seconds - begun  # compiling takes no time of the remedies
    pairs = pairs_of(scene, gears)
    asked = Questions(pairs, clock)
    single, choices = edits(scene, pairs), switches(scene)
    chosen = [c for m in choices if (c := _chosen(scene, m, asked)) is not None]
    moved = [r for m in single if (r := _moved(scene, m, asked)) is not None]
    found = sorted(moved, key=_size) + chosen
    message = ""
    if found and asked.open:
        message = f"time ran out before it was known whether {', '.join(asked.open)} alone suffices"
    elif not found:
        both = _pairs(scene, single + choices[::-1], asked)  # of two tables the last goes first
        found = sorted(both, key=_size)
        if asked.open and not found:
            message = "no remedy was found, and time ran out before every change was decided"
        elif not found:
            none = "no layout was found by changing one or two numbers within these ranges"
            message = f"{none}: {', '.join(limits_of(single + choices))}"
    if clock.over:
        message = "time ran out before all remedies were tried"
    changed = found[0][2] if found else None
    known = tuple(remedy for _, remedy, _ in found)
    more, unknown = other_gears(scene, pairs, known, clock)
    first = GEARS_FIRST if known and others_may_fit(scene, pairs) else ""
    words = "; ".join(filter(None, (message, first, unknown)))
    ways = _of_gears(scene, known, more, words)
    drawn = None if changed is None else _nearest(scene, changed, gears, clock)
    return ways if drawn is None else replace(ways, drawn={"nearest_layout": drawn})


def _nearest(scene: Scene, changed: Scene, sized: Result, clock: Clock) -> dict[str, Any] | None:
    """A layout of a changed file, and what of the file as it is differs, for a drawing.

    None where none is found in SECONDS.
    """
    pairs = pairs_of(scene, sized)
    asked, box = scene.gearbox(pairs), changed.gearbox(pairs)
    budget = replace(clock.left, seconds=clock.within(SECONDS))
    result, outcome = run(layout.problem(box, None), None, budget, watch=clock.watch)
    if result.value is None or outcome.x is None:
        return None
    angles, order = read(arrangements(box), outcome.x)
    found = placed(box, order, angles)
    gone = [keep_out_design(k, found) for k in asked.keep_outs if k not in box.keep_outs]
    return {
        "layout": untyped(described(box, order, angles, drive_design(sized.design))),
        "keep_outs": [untyped(k) for k in gone],
        "motor_mm": 2.0 * asked.motor if asked.motor != box.motor else None,
        "largest_mm": [None if math.isinf(v) else v for v in asked.largest],
    }


def _of_gears(
    scene: Scene, found: tuple[Remedy, ...], more: tuple[Remedy, ...], message: str
) -> Remedies:
    """Return remedies for one choice of gears, and more with others, which need no less.

    What is least for these gears need not be for others, which `together = true` allows.
    """
    assert scene.layout is not None
    if not scene.layout.together:
        return Remedies((), (*more, *found), message)
    found = tuple(
        replace(r, verified={k: v if k == "with" else "undecided" for k, v in r.verified.items()})
        for r in found
    )
    return Remedies((), (*more, *found), message)


def _size(found: Found) -> float:
    return found[0]


def gearbox_of(scene: Scene, pairs: tuple[GearPair, ...]) -> Gearbox | None:
    """Return the gearbox of a scene; None where numbers that were moved contradict each other."""
    try:
        return scene.gearbox(pairs)
    except ValueError:
        return None


def _halved(asks: Asks, high: float, steps: int) -> list[float]:
    """Return sizes that fit, the smallest first, by halving from `high`, which fits."""
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


def _moved(scene: Scene, edit: Edit, asked: Questions) -> Found | None:
    """Return the smallest known size of one edit and its remedy; None where none is known."""
    known = asked.smallest(
        lambda size: edit.put(scene, edit.searched(size)), edit.steps, edit.key()
    )
    found = asked.proposal(lambda value: edit.put(scene, value), edit, known)
    if found is None:
        if known:
            asked.open.append(edit.key())
        return None
    size, value = found
    less = asked.fits(edit.put(scene, edit.back(value)))
    verified = {"with": "feasible", "with_less": _word(less)}
    change = _change(scene, edit, value)
    remedy = Remedy("least", edit.what, (change,), change.factor, None, verified)
    return edit.change(size), remedy, edit.put(scene, value)


def _word(found: bool | None) -> str:
    return "undecided" if found is None else ("feasible" if found else "infeasible")


def _change(scene: Scene, edit: Edit, value: Any) -> Change:
    """Return an edit as a change; its factor is infinite where a number is shifted."""
    factor = math.inf
    if edit.texts:
        factor = 1.0
    elif isinstance(value, Quantity):
        now = edit.searched(0.0)
        factor = max(value.value / now.value, now.value / value.value)
    return Change(edit.key(), edit.was(scene), edit.write(value), factor)


def _chosen(scene: Scene, edit: Edit, asked: Questions) -> Found | None:
    """Return a switch that suffices alone."""
    value = edit.searched(1.0)
    if not asked.smallest(lambda _: edit.put(scene, value), 0, edit.key()):
        return None
    change = _change(scene, edit, value)
    remedy = Remedy("choice", edit.what, (change,), 1.0, None, {"with": "feasible"})
    return edit.change(1.0), remedy, edit.put(scene, value)


def _pairs(scene: Scene, single: tuple[Edit, ...], asked: Questions) -> list[Found]:
    """Return two changes that do together, each as small as the other allows."""
    rough: list[tuple[float, float, Pair]] = []
    for pair in combinations(single, 2):
        if _same(*pair):
            continue

        def both(size: float, pair: Pair = pair) -> Scene:
            return _put(scene, pair, [m.searched(size) for m in pair])

        steps = ROUGH_HALVINGS if any(m.steps for m in pair) else 0
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


def _same(one: Edit, other: Edit) -> bool:
    """Return whether two moves change the same table or number, so that one undoes the other."""
    shared = min(len(one.path), len(other.path))
    return one.path[:shared] == other.path[:shared]


def _together(scene: Scene, pair: Pair, size: float, asked: Questions) -> Found | None:
    """Return the remedy of two moves of a common size: one made smaller, then the other."""
    sizes, values = [size, size], [m.searched(size) for m in pair]
    for k, edit in enumerate(pair):

        def one(value: Any, k: int = k) -> Scene:
            return _put(scene, pair, [value if i == k else v for i, v in enumerate(values)])

        def searched(own: float, edit: Edit = edit, one: Callable[[Any], Scene] = one) -> Scene:
            return one(edit.searched(own))

        known = asked.smallest(searched, edit.steps, edit.key(), sizes[k])
        found = asked.proposal(one, edit, known)
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
    remedy = Remedy("pair", what, changes, math.inf, None, verified)
    return change, remedy, _put(scene, pair, values)


def _put(scene: Scene, pair: Pair, values: list[Any]) -> Scene:
    """Return both changes, in order: a table goes after others changed."""
    for edit, value in zip(pair, values, strict=True):
        scene = edit.put(scene, value)
    return scene


def explained(scene: Scene, result: Result, clock: Clock) -> Explanation:
    """Return the sensitivities of the box to every number of the tables of a layout."""
    if result.status not in CERTAIN or result.value is None:
        return Explanation(
            result, message="sensitivities need a proven layout", seconds=clock.seconds
        )
    pairs = pairs_of(scene, next((p for p in result.parts if p.name == "gears"), result))

    def solved(other: Scene) -> float | None:
        box = gearbox_of(other, pairs)
        if box is None or faults(box):
            return None
        left = replace(clock.left, gap=SENSITIVITY_GAP)
        return solve(layout.problem(box), None, left, watch=clock.watch, gap=SENSITIVITY_GAP).value

    wanted = [
        n
        for n in numbers(scene)
        if n.path[0] in TABLES and isinstance(n.value, Quantity) and smooth(n)
    ]
    found = tuple(influences(scene, Basis(result.value, solved, step=STEP), clock, wanted))
    late = "; time ran out before all numbers were tried" if clock.over else ""
    return Explanation(
        result,
        binding=tuple(n for n, v in result.limits.items() if v > 1.0 - SIZE_TIE),
        influences=found,
        message=f"sensitivities are those of the box around these gears{late}",
        seconds=result.seconds + clock.seconds,
    )
