"""Sensitivities of the objective to every number of a file: by multipliers, checked by solving."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import field, replace
from functools import partial
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import EASE, slope
from gearopt.optimise.explaining.explanation import Influence
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.explaining.sensitivity import Sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Array
from gearopt.scenes.explaining.numbers import STEP_FROM_ZERO, Number, Path, eased, moved, times
from gearopt.units import Quantity

POSED = 1e-5  # of ln number, to either side, at most: where a problem is posed again
STEP = 1e-4  # relative, of the re-solves: small enough for most choices to stay as they are
NEAREST = 1e-10  # relative change of a number below which it is not asked whether they do
SMALL_CHANGES = "and hold for small changes only, while the same bodies touch"
HALVINGS = 12  # of the logarithm of the change up to which they do
OBJECTIVE_TIE = 1e-9  # relative: objectives that are equal
SOLVED = 1e-7  # relative: the same of what was solved to GAP
FARTHEST = 64  # whole steps up to which the first that makes a difference is sought

Solved = Callable[[Any], float | None]  # a changed scene -> its objective; None: no design
Easing = Callable[[Number], tuple[str, float | None]]


@dataclass(frozen=True)
class Basis:
    """The problem of the sensitivities: its optimum `point` (None: sensitivities by solving alone).

    posed(scene): that of a changed file; value: its objective; solved(scene): the same of a changed
    file; step: relative, of the re-solves; memo: what was solved, by number and factor.
    """

    value: float
    solved: Solved
    posed: Callable[[Any], Problem] | None = None
    point: Array | None = None
    known: Sensitivities | None = None
    step: float = STEP
    memo: dict[tuple[Path, float], float | None] = field(default_factory=dict)

    def chained(self, scene: Any, number: Number, step: float) -> float | None:
        """Return d ln objective / d ln number by multipliers, through all that follows from it.

        None where the rules of the file allow one side alone: there multipliers are not unique.
        """
        if self.posed is None or self.point is None or self.known is None:
            return None
        ends = [_times(scene, number, math.exp(s)) for s in (-step, step)]
        try:
            below, above = (None if end is None else self.posed(end) for end in ends)
        except ValueError:  # a formulation's own rule
            return None
        if below is None or above is None:
            return None
        return self.known.along(self.posed(scene), self.point, (below, above), step)

    def at(self, scene: Any, number: Number, factor: float) -> float | None:
        """Return the objective with the number times a factor, by solving again."""
        if (number.path, factor) not in self.memo:
            other = _times(scene, number, factor)
            self.memo[number.path, factor] = None if other is None else self.solved(other)
        return self.memo[number.path, factor]

    def kept(self, scene: Any, number: Number) -> tuple[float, float]:
        """Return how far a number may fall and rise, up to a part `step`, until the point changes.

        That is where whole numbers or choices are others; real-valued variables are chosen anew.
        0: at once.
        """

        def same(change: float) -> bool:
            other, solved = (
                _times(scene, number, 1.0 + change),
                self.at(scene, number, 1.0 + change),
            )
            if other is None or solved is None or self.posed is None or self.point is None:
                return True  # no design, which the sensitivities show
            held, tie = self._of_same(other)
            if held is None:
                return True  # not known, and nothing is claimed
            return math.isfinite(held) and bool(abs(held - solved) <= tie * abs(held))

        def far(way: int) -> float:
            low, high = NEAREST, self.step
            if same(way * high):
                return high
            for _ in range(HALVINGS):
                middle = math.sqrt(low * high)
                low, high = (middle, high) if same(way * middle) else (low, middle)
            return low if low > NEAREST else 0.0

        return far(-1), far(1)

    def _of_same(self, scene: Any) -> tuple[float | None, float]:
        """Return the objective of a changed file with the whole numbers and choices of the point.

        None where a point was found that need not be their minimum, inf where none was found. With
        the relative difference of values that counts as none.
        """
        assert self.posed is not None and self.point is not None
        problem = self.posed(scene)
        lower, upper, _ = problem.bounds()
        if (lower == upper).all():
            return float(problem.batch(lower[None]).F[0, 0]), OBJECTIVE_TIE  # the file's own sizes
        result = solve(problem.starting(self.point), "ipopt")
        if result.value is None:
            return math.inf, SOLVED
        return (result.value if result.status in CERTAIN else None), SOLVED


def _times(scene: Any, number: Number, factor: float) -> Any:
    return moved(scene, number.path, times(number.value, factor))


def smooth(number: Number) -> bool:
    """Return whether a small change of a number means anything: not of zero or whole ones."""
    return bool(getattr(number.value, "number", number.value)) and not isinstance(number.value, int)


def influences(
    scene: Any,
    basis: Basis | None,
    clock: Clock,
    wanted: Iterable[Number],
    easing: Easing = lambda number: ("", None),
    sloped: Callable[[Number], bool] = smooth,
    near: Callable[[Number], tuple[float, float]] | None = None,
) -> Iterator[Influence]:
    """Yield the influence of every wanted number on the objective, while the clock allows.

    easing(number): the step that eases it and what that brings. sloped: whether a small change
    of it means anything.
    near(number): the relative steps of its re-solves down and up, by default those of the basis;
    0: none to that side.
    """
    for number in wanted:
        if clock.over:
            return
        by_chain_rule: float | None = None
        both: tuple[float | None, float | None] = (None, None)
        if basis is not None and sloped(number):
            down, up = near(number) if near else (basis.step, basis.step)
            by_chain_rule = basis.chained(scene, number, min(POSED, max(down, up) or POSED))
            solved = partial(basis.at, scene, number)
            low, high = (slope(basis.value, solved, 1.0 + s) if s else None for s in (-down, up))
            both = low, high
        step, brings = easing(number)
        if clock.over:  # the row may be half done
            return
        yield Influence(number.key, number.text, by_chain_rule, both, step, brings)


def stepped(
    scene: Any, number: Number, direction: int, value: float, solved: Solved, whole: Solved
) -> tuple[str, float | None]:
    """Return the step of a number, and the relative change of the objective that it brings.

    direction: that eases it, 0 where none is known: then 1 % of no number is tried, a whole number
    is tried both ways. solved: of changed quantities; whole: of changed whole numbers.
    """
    now = number.value
    if isinstance(now, int):
        return _whole(scene, number, direction, value, whole)
    if not getattr(now, "number", now):
        if not isinstance(now, Quantity):
            return "", None
        new = replace(now, number=now.number + STEP_FROM_ZERO)
        return _brings(scene, number, f"to {new}", new, value, solved)
    if direction == 0:
        return "", None
    new = eased(now, 1.0 + EASE, direction)
    return _brings(scene, number, per_cent(now, direction), new, value, solved)


def per_cent(now: Any, direction: int) -> str:
    """Return the step of EASE that a number takes in a direction of its quantity, in words."""
    way = -direction if isinstance(now, Quantity) and now.reciprocal else direction
    return f"{way * EASE:+.0%}"


def _brings(
    scene: Any, number: Number, step: str, new: Any, value: float, solved: Solved
) -> tuple[str, float | None]:
    other = moved(scene, number.path, new)
    if other is None:
        return "", None
    changed = solved(other)
    return step, None if changed is None or value == 0.0 else (changed - value) / abs(value)


def _whole(
    scene: Any, number: Number, direction: int, value: float, solved: Solved
) -> tuple[str, float | None]:
    """Return the first step of a whole number that improves the objective; else what one does."""

    def brings(step: int) -> float | None:
        other = moved(scene, number.path, number.value + step)
        changed = None if other is None else solved(other)
        return None if changed is None or value == 0.0 else (changed - value) / abs(value)

    gains = {way: brings(way) for way in ((direction,) if direction else (-1, 1))}
    known = {way: b for way, b in gains.items() if b is not None}
    if not known:
        return "", None
    way = min(known, key=lambda w: known[w])
    if known[way] < -OBJECTIVE_TIE or direction == 0:
        return f"{way:+d}", known[way]
    low, high, best = 1, 2, known[way]
    while high <= FARTHEST:
        gain = brings(way * high)
        if gain is None:
            return f"{way:+d}", known[way]
        if gain < -OBJECTIVE_TIE:
            best = gain
            break
        low, high = high, 2 * high
    else:
        return f"{way * low:+d}", best
    while high - low > 1:  # a wider range never does worse
        middle = (low + high) // 2
        gain = brings(way * middle)
        if gain is not None and gain < -OBJECTIVE_TIE:
            high, best = middle, gain
        else:
            low = middle
    return f"{way * high:+d}", best
