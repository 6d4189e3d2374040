"""The effort of a run, and how it is followed: its clock, and the watchers of its parts."""

import math
import time
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

from gearopt.frozen import dataclass
from gearopt.optimise.result import Budget, Event, Result, Watch

if TYPE_CHECKING:
    from gearopt.optimise.conic.problem import Conic
    from gearopt.optimise.problem import Problem

NEWS = ("seconds", "evaluations", "best", "bound")
OTHERS = "other numbers"  # the part of events of changed problems


@dataclass
class Clock:
    """A budget as it is spent; it has state because time passes and the run continues.

    start: when the run began (`time.perf_counter`). evaluations, best, bound: spent and reached so
    far (inf and -inf: nothing yet). stopped: `tell` said so once; refused: because of the watcher.
    """

    budget: Budget = Budget()
    watch: Watch | None = None
    start: float = field(default_factory=time.perf_counter)
    evaluations: int = 0
    best: float = math.inf
    bound: float = -math.inf
    stopped: bool = False
    refused: bool = False

    @property
    def seconds(self) -> float:
        """Return seconds since the run began."""
        return time.perf_counter() - self.start

    @property
    def left(self) -> Budget:
        """Rest of the budget."""
        return self.budget.less(self.seconds, self.evaluations)

    @property
    def over(self) -> bool:
        """Return whether the run was stopped, or nothing is left of its budget."""
        return self.stopped or self._spent(self.evaluations)

    def _spent(self, evaluations: int) -> bool:
        seconds, most = self.budget.seconds, self.budget.evaluations
        late = seconds is not None and self.seconds >= seconds
        return late or (most is not None and evaluations >= most)

    def within(self, seconds: float) -> float:
        """So many seconds, or the rest of the budget if that is less."""
        left = self.left.seconds
        return seconds if left is None else min(seconds, left)

    def tell(self, more: int = 0) -> bool:
        """Report best value and bound to the watcher; return whether the run continues.

        more: evaluations under way that are not counted yet.
        """
        if self.stopped:
            return False
        spent = self.evaluations + more
        best, bound = self.best, min(self.bound, self.best)
        if self.watch is not None:
            event = Event(self.seconds, spent, _known(best), _known(bound))
            self.refused = self.watch(event) is False
        self.stopped = self.refused or self._spent(spent)
        return not self.stopped

    def inner(self, values: bool = True) -> Watch:
        """Return a watcher of a run within this one, whose evaluations and best value count.

        values: False where its values are not this run's.
        """
        before = self.evaluations

        def follow(event: Event) -> bool:
            self.evaluations = before + event.evaluations
            if values and event.best is not None:
                self.best = min(self.best, event.best)
            return self.tell()

        return follow


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def in_part(
    watch: Watch | None, unit: str = "", part: str = "", factor: float = 1.0
) -> Watch | None:
    """Return a watcher of one part of a run, whose events name the part and its unit.

    part: "" keeps the name that an event has. factor: from the values of the method to that unit.
    """
    if watch is None:
        return None

    def follow(event: Event) -> bool:
        best, bound = (None if v is None else factor * v for v in (event.best, event.bound))
        named = part or event.part
        return watch(replace(event, best=best, bound=bound, part=named, unit=unit)) is not False

    return follow


def of_problem(watch: Watch | None, problem: "Problem | Conic") -> Watch | None:
    """Watcher whose events name their problem and its objective."""
    if watch is None:
        return None
    name, objective = problem.name, problem.rows.objectives[0]

    def follow(event: Event) -> bool:
        return watch(replace(event, part=event.part or name, objective=objective)) is not False

    return follow


def of_others(watch: Watch | None, part: str = OTHERS) -> Watch | None:
    """Return a watcher of other problems than the run's, whose values are left out."""
    if watch is None:
        return None

    def follow(event: Event) -> bool:
        return watch(Event(event.seconds, event.evaluations, part=part)) is not False

    return follow


def tell_known(watch: Watch | None, result: Result) -> None:
    """Tell a watcher the facts that are proven already, before its remedies are sought."""
    if watch is not None:
        watch(Event(result.seconds, result.evaluations, part=OTHERS, known=result))


def whole(watch: Watch | None) -> Watch | None:
    """Return a watcher of a run of many parts, on one clock.

    Seconds are those since it was made; evaluations go on where another search begins to count;
    best and bound are those reached so far in their part.
    """
    if watch is None:
        return None
    clock, before, last = Clock(), 0, 0
    reached: dict[str, tuple[float | None, float | None]] = {}

    def follow(event: Event) -> bool:
        nonlocal before, last
        before += last if event.evaluations < last else 0
        last = event.evaluations
        best, bound = reached.get(event.part, (None, None))
        best = min((v for v in (best, event.best) if v is not None), default=None)
        bound = max((v for v in (bound, event.bound) if v is not None), default=None)
        reached[event.part] = best, bound
        values = replace(event, best=best, bound=bound)
        spent = before + last
        return watch(replace(values, seconds=clock.seconds, evaluations=spent)) is not False

    return follow


def following(watch: Watch | None) -> tuple[Watch, list[dict[str, Any]]]:
    """Return a watcher that passes events on, and the list it fills with those that are better.

    An entry holds NEWS of an event; best falls, or bound rises, from each to the next.
    """
    events: list[dict[str, Any]] = []

    def follow(event: Event) -> bool:
        last = events[-1] if events else {"best": None, "bound": None}
        better = event.best is not None and (last["best"] is None or event.best < last["best"])
        tighter = event.bound is not None and (last["bound"] is None or event.bound > last["bound"])
        if better or tighter:
            events.append({key: getattr(event, key) for key in NEWS})
        return watch is None or watch(event) is not False

    return follow, events
