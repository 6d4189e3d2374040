"""Following long work: progress on the terminal, and Ctrl-C that keeps the best found so far."""

import logging
import math
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console

from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget, Event, Watch
from gearopt.optimise.scale import gap

SHOW_CURSOR = b"\r\x1b[K\x1b[?25h"  # and clear the line of the progress that hid it


@contextmanager
def watching(seconds: float, quiet: bool) -> Iterator[Watch]:
    """Yield a watcher of one run that ends it at Ctrl-C and shows long work."""
    clock = Clock(Budget(seconds))

    def words(event: Event) -> str:
        return progress(event, clock.within(seconds))

    with following(words, quiet) as watch:
        yield watch


@contextmanager
def following(words: Callable[[Any], str], quiet: bool) -> Iterator[Callable[[Any], bool]]:
    """Yield a watcher, False after Ctrl-C (the second one kills), that shows words(progress)."""
    stopped = False
    screen = Console(stderr=True, highlight=False)
    status = screen.status("") if screen.is_terminal and not quiet else None

    def stop(number: int, frame: Any) -> None:
        nonlocal stopped
        if stopped:
            os.write(2, b"" if status is None else SHOW_CURSOR)
            signal.signal(signal.SIGINT, before)
            signal.raise_signal(signal.SIGINT)
        stopped = True

    before = signal.signal(signal.SIGINT, stop)
    clock, shown = Clock(), 0.0
    news = _News(screen)
    if not quiet:
        logger = logging.getLogger("gearopt.kernels")
        logger.addHandler(news)
        logger.setLevel(logging.INFO)

    def watch(progress: Any) -> bool:
        nonlocal shown
        now = clock.seconds
        if status is not None and now > 0.5 and now > shown + 0.2:
            shown = now
            status.start()
            status.update(words(progress))
        return not stopped

    try:
        yield watch
    finally:
        logging.getLogger("gearopt.kernels").removeHandler(news)
        if status is not None:
            status.stop()
        signal.signal(signal.SIGINT, before)


@contextmanager
def unbroken() -> Iterator[None]:
    """Hold Ctrl-C back until what is being written is written."""
    came: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            signal.raise_signal(signal.SIGINT)


class _News(logging.Handler):
    """Prints what a run has to say, each sentence once; a third-party interface."""

    def __init__(self, screen: Console) -> None:
        super().__init__()
        self.screen, self.said = screen, set[str]()

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record."""
        if (words := record.getMessage()) not in self.said:
            self.said.add(words)
            self.screen.print(words[0].upper() + words[1:] + ".", style="dim")


def progress(event: Event, left: float) -> str:
    """Return part, evaluations, best value and gap of a run, and the seconds it has left."""
    words = [f"{event.evaluations:,} evaluations", *reached(event), f"{max(left, 0.0):.0f} s left"]
    return ": ".join(filter(None, (event.part, ", ".join(words))))


def reached(event: Event) -> list[str]:
    """Return the best value and the bound of an event in words."""
    from gearopt.report.words import amount

    unit, best, bound = event.unit, event.best, event.bound
    words = [] if best is None else [f"best {amount(best, unit)}"]
    if bound is None:
        return words
    away = math.inf if best is None else gap(best, bound)
    shown = math.isfinite(away)
    return [*words, f"gap {100.0 * away:.2g} %" if shown else f"bound {amount(bound, unit)}"]
