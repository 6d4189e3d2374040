"""How a run is followed: what its events are of, on one clock, and which of them brought news."""

import time
from dataclasses import replace
from typing import Any

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Event, Watch

NEWS = ("seconds", "evaluations", "best", "bound")
OTHERS = "other numbers"  # the part of events of changed problems


def in_part(
    watch: Watch | None, unit: str = "", part: str = "", factor: float = 1.0
) -> Watch | None:
    """A watcher of one part of a run: its events say which, and in what unit their values are.

    part: "" keeps the name that an event has. factor: from the values of the method to that unit.
    """
    if watch is None:
        return None

    def told(event: Event) -> bool:
        best, bound = (None if v is None else factor * v for v in (event.best, event.bound))
        named = part or event.part
        return watch(replace(event, best=best, bound=bound, part=named, unit=unit)) is not False

    return told


def of_problem(watch: Watch | None, problem: Problem | Conic) -> Watch | None:
    """A watcher whose events say what problem they are of, and what is minimised."""
    if watch is None:
        return None
    name, objective = problem.name, problem.rows.objectives[0]

    def told(event: Event) -> bool:
        return watch(replace(event, part=event.part or name, objective=objective)) is not False

    return told


def of_others(watch: Watch | None, part: str = OTHERS) -> Watch | None:
    """A watcher of other problems than the run's, whose values are not its own: left out."""
    if watch is None:
        return None

    def told(event: Event) -> bool:
        return watch(Event(event.seconds, event.evaluations, part=part)) is not False

    return told


def whole(watch: Watch | None) -> Watch | None:
    """A watcher of a run of many parts, told on one clock.

    Seconds are those since it was made; evaluations go on where another search begins to count;
    best and bound are those reached so far in their part.
    """
    if watch is None:
        return None
    start, before, last = time.perf_counter(), 0, 0
    reached: dict[str, tuple[float | None, float | None]] = {}

    def told(event: Event) -> bool:
        nonlocal before, last
        before += last if event.evaluations < last else 0
        last = event.evaluations
        best, bound = reached.get(event.part, (None, None))
        best = min((v for v in (best, event.best) if v is not None), default=None)
        bound = max((v for v in (bound, event.bound) if v is not None), default=None)
        reached[event.part] = best, bound
        seconds = time.perf_counter() - start
        return (
            watch(
                replace(event, seconds=seconds, evaluations=before + last, best=best, bound=bound)
            )
            is not False
        )

    return told


def following(watch: Watch | None) -> tuple[Watch, list[dict[str, Any]]]:
    """A watcher that passes events on, and the list it fills with those that bring something new.

    An entry holds NEWS of an event; best falls, or bound rises, from each to the next.
    """
    events: list[dict[str, Any]] = []

    def told(event: Event) -> bool:
        last = events[-1] if events else {"best": None, "bound": None}
        better = event.best is not None and (last["best"] is None or event.best < last["best"])
        tighter = event.bound is not None and (last["bound"] is None or event.bound > last["bound"])
        if better or tighter:
            events.append({key: getattr(event, key) for key in NEWS})
        return watch is None or watch(event) is not False

    return told, events
