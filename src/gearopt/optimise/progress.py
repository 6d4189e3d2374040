"""What a run found when: the improvements that its events told of."""

from dataclasses import asdict
from typing import Any

from gearopt.optimise.result import Event, Watch


def following(watch: Watch | None) -> tuple[Watch, list[dict[str, Any]]]:
    """A watcher that passes events on, and the list it fills with those that bring something new.

    An entry is an event as a dict; best falls, or bound rises, from each to the next.
    """
    events: list[dict[str, Any]] = []

    def told(event: Event) -> bool:
        last = events[-1] if events else {"best": None, "bound": None}
        better = event.best is not None and (last["best"] is None or event.best < last["best"])
        tighter = event.bound is not None and (last["bound"] is None or event.bound > last["bound"])
        if better or tighter:
            events.append(asdict(event))
        return watch is None or watch(event) is not False

    return told, events
