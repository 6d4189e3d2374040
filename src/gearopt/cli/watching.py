"""Following long work: progress on the terminal, and Ctrl-C that keeps the best found so far."""

import logging
import math
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import field, replace
from typing import Any

from rich.console import Console
from rich.text import Text

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Event, Result, Watch
from gearopt.optimise.scale import gap
from gearopt.report.measures import METRIC, Measures, read_in
from gearopt.report.screen import Screen

NEWS_OF = ("kernels", "remedies")  # loggers that are heard
PATIENCE = 0.5  # seconds of a run without a line about it
PAUSE = 0.2  # seconds between one line and the next
LONGEST_SECONDS = 1e5  # seconds: a limit above it is none
GRACE, KEEPING = 0.5, 5.0  # seconds from Ctrl-C to the end: with nothing to keep, and at most
SHOW_CURSOR = b"\r\x1b[K\x1b[?25h"  # and clear the line of the progress that hid it


@contextmanager
def watching(seconds: float, quiet: bool, measures: Measures = METRIC) -> Iterator[Watch]:
    """Yield a watcher of one run that ends it at Ctrl-C and shows long work."""
    said = quiet

    def words(event: Event) -> str:
        return progress(event, measures)

    with following(words, quiet, seconds, kept=lambda event: event.best is not None) as watch:

        def telling(event: Event) -> bool:
            nonlocal said
            if event.known is not None and not said:
                said = True
                _tell(event.known, seconds - event.seconds)
            return watch(event)

        yield telling


def _tell(known: Result, seconds: float) -> None:
    """Print what is proven while its remedies are sought, for so many seconds, on stderr."""
    from gearopt.report.headline import headline

    screen = Console(stderr=True, highlight=False)
    of_stages = replace(known, scene=known.scene or known.name)
    screen.print(Text(headline(of_stages)))
    most = f" (at most {max(seconds, 1.0):.0f} s)" if seconds < LONGEST_SECONDS else ""
    words = f"Looking for changes with which a design exists{most}; Ctrl-C ends it."
    screen.print(Text(words), style="dim")


@contextmanager
def following(
    words: Callable[[Any], str],
    quiet: bool,
    limit: float = math.inf,
    kept: Callable[[Any], bool] = lambda progress: False,
) -> Iterator[Callable[[Any], bool]]:
    """Yield a watcher, False after Ctrl-C (the second one kills), that shows words(progress).

    A run that does not end by itself is ended GRACE after Ctrl-C, where kept(progress) says that
    there is something to keep KEEPING after it, with its last words on stderr.

    On a terminal a line of what was reached last and of the seconds spent moves after half a
    second, whether or not the run has anything to report. limit: seconds that it may take.
    """
    last: Any = None
    screen = Screen(stderr=True, highlight=False)
    shown = screen.is_terminal and not quiet

    def ending() -> str | None:
        return None if last is None else words(last)

    with (
        _interruptible(shown, ending, lambda: last is not None and kept(last)) as runs,
        _line(screen, shown, limit) as line,
        _told_news(screen, quiet),
    ):

        def watch(progress: Any) -> bool:
            nonlocal last
            last = progress
            if line is not None and line.due():
                line.words = words(progress)
            return runs()

        yield watch


@contextmanager
def _interruptible(
    hides_cursor: bool, ending: Callable[[], str | None], worth_keeping: Callable[[], bool]
) -> Iterator[Callable[[], bool]]:
    """Yield whether Ctrl-C has not come; the process ends where a run does not heed it in time."""
    stopped, ended = False, threading.Event()
    cursor = SHOW_CURSOR if hides_cursor else b""

    def stop(number: int, frame: Any) -> None:
        nonlocal stopped
        if stopped:
            os.write(2, cursor)
            signal.signal(signal.SIGINT, before)
            signal.raise_signal(signal.SIGINT)
        stopped = True
        threading.Thread(target=leave, daemon=True).start()

    def leave() -> None:
        if ended.wait(GRACE) or (worth_keeping() and ended.wait(KEEPING - GRACE)):
            return
        said = "" if (words := ending()) is None else f" ({words})"
        os.write(2, cursor)
        os.write(2, f"gearopt: interrupted{said}\n".encode())
        os._exit(130)

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield lambda: not stopped
    finally:
        ended.set()
        signal.signal(signal.SIGINT, before)


@contextmanager
def _line(screen: Screen, shown: bool, limit: float) -> Iterator["_Line | None"]:
    """Yield the line that a terminal shows of long work; None where none is shown."""
    if not shown:
        yield None
        return
    line = _Line(limit)
    with ExitStack() as moving:
        begin = threading.Timer(PATIENCE, lambda: moving.enter_context(screen.status(line)))
        begin.start()
        try:
            yield line
        finally:
            begin.cancel()
            begin.join()


@contextmanager
def _told_news(screen: Screen, quiet: bool) -> Iterator[None]:
    """Print what kernels and remedies log meanwhile."""
    loggers, news = [logging.getLogger(f"gearopt.{name}") for name in NEWS_OF], _News(screen)
    for logger in loggers if not quiet else ():
        logger.addHandler(news)
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        for logger in loggers:
            logger.removeHandler(news)


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


@dataclass
class _Line:
    """Progress of a run on the terminal; an interface of rich.

    It has state because time passes and the run continues.
    """

    limit: float
    words: str = "begins"
    clock: Clock = field(default_factory=Clock)
    shown: float = 0.0

    def due(self) -> bool:
        """Return whether other words may be shown: a few times in a second."""
        now = self.clock.seconds
        if now < self.shown + PAUSE:
            return False
        self.shown = now
        return True

    def __rich__(self) -> str:
        """Return the words with the seconds spent, asked again for every frame."""
        now = self.clock.seconds
        of = f" of {self.limit:.0f}" if now <= self.limit < LONGEST_SECONDS else ""
        return f"{now:.0f}{of} s  {self.words}"


def progress(event: Event, measures: Measures = METRIC) -> str:
    """Return the part of a run, its best value, bound and gap, and the evaluations spent."""
    spent = [f"{event.evaluations:,} evaluations"] if event.evaluations else []
    return ": ".join(filter(None, (event.part, ", ".join([*reached(event, measures), *spent]))))


def reached(event: Event, measures: Measures = METRIC) -> list[str]:
    """Return the best value, the bound and the gap of an event in words."""
    from gearopt.report.words import amount

    unit, best, bound = read_in(event.objective, event.unit), event.best, event.bound
    words = [] if best is None else [f"best {amount(best, unit, measures)}"]
    if bound is None:
        return words
    words.append(f"bound {amount(bound, unit, measures, best)}")
    away = math.inf if best is None else gap(best, bound)
    return [*words, f"gap {100.0 * away:.2g} %"] if math.isfinite(away) else words
