"""How long a user's text may run on symbols: as long as its budget, and no simulation for ever.

A text that waits for a number (the next step of an integration) may wait for ever on symbols, which
are no numbers. It is ended by an exception in its own thread.
"""

import ctypes
import faulthandler
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import CodeType

SLOWEST = 1000.0  # times the text on floats: tapes of large texts took up to 100 times
LONGEST = 5.0  # s, of a text that is fast on floats
SHORTEST = 1.0  # s, of what is left of a budget: most tapes take some hundredths
WAITED = 4.0  # times as long, of a text that waits or gets no processor
SIMULATING = 0.25  # s; after them a text within scipy steps through numbers that it never gets
TURNS = 8  # of a loop; an exception from outside is raised at the first
AGAIN = 0.2  # s; a bare `except` in casadi may have stopped the exception
_END: ContextVar[float | None] = ContextVar("end of the budget", default=None)


class _Late(BaseException):
    """Ends a text from outside; no `except Exception` of the text stops it."""


@contextmanager
def until(seconds: float | None) -> Iterator[None]:
    """Let texts within run on symbols for so many seconds from now, None: those around it."""
    end = _END.get()
    if seconds is not None:
        now = time.perf_counter() + seconds
        end = now if end is None else min(end, now)
    token = _END.set(end)
    try:
        yield
    finally:
        _END.reset(token)


def passed() -> bool:
    """Whether the seconds of the run around this are over."""
    end = _END.get()
    return end is not None and time.perf_counter() >= end


def allowed(on_floats: float) -> float:
    """Return the seconds that a text may take on symbols; on_floats: those that it takes there."""
    most, end = max(LONGEST, SLOWEST * on_floats), _END.get()
    return most if end is None else min(most, max(SHORTEST, end - time.perf_counter()))


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise TimeoutError from work that has not ended after so many seconds, with its line.

    Of its thread's processor time, where other work on the machine makes that the smaller, but for
    WAITED times as long at most. A simulation of scipy is ended after SIMULATING.
    """
    thread, ended, lock = threading.get_ident(), threading.Event(), threading.Lock()
    late, used = threading.Event(), _processor_clock(thread)
    began, start, caller = used(), time.perf_counter(), sys._getframe(2).f_code
    latest = start + WAITED * seconds

    def wait() -> None:
        pause = min(seconds, SIMULATING)
        while not ended.wait(pause):
            pause = min(began + seconds - used(), latest - time.perf_counter())
            if pause > 0.0 and not _simulates(thread, caller):
                pause = min(pause, SIMULATING)
                continue
            with lock:
                if not ended.is_set():
                    late.set()
                    _raise_late(thread)
            pause = AGAIN

    try:
        try:
            threading.Thread(target=wait, daemon=True).start()
            yield
        finally:
            with lock:
                ended.set()
            for _ in range(late.is_set() * TURNS):  # what is not raised yet is raised at a turn
                pass
    except (_Late, Exception) as stopped:
        ended.set()
        if not late.is_set():
            raise
        words = f"it has not ended after {min(seconds, time.perf_counter() - start):.2g} s"
        raise TimeoutError(words).with_traceback(stopped.__traceback__) from None


def _simulates(thread: int, caller: CodeType) -> bool:
    """Return whether a thread has gone from its caller into scipy, which knows no symbols.

    By the stack as it stands at one moment: frames of a running thread can vanish under a walk.
    """
    with tempfile.TemporaryFile() as file:
        faulthandler.dump_traceback(file)
        file.seek(0)
        stacks = file.read().decode(errors="replace").split("\n\n")
    stack = next((s for s in stacks if f"{thread:x} (most recent" in s), "")
    _, *calls = stack.splitlines() or [""]
    begun = f'File "{caller.co_filename}"', f" in {caller.co_name}"
    for call in calls:
        if call.strip().startswith(begun[0]) and call.endswith(begun[1]):
            return False
        if f"{os.sep}scipy{os.sep}" in call:
            return True
    return False


def _processor_clock(thread: int) -> Callable[[], float]:
    """Return the clock of a thread's processor time [s]; that of the wall where there is none."""
    clock = getattr(time, "pthread_getcpuclockid", None)
    if clock is None:
        return time.perf_counter
    number = clock(thread)
    return lambda: time.clock_gettime(number)


def _raise_late(thread: int) -> None:
    """Raise _Late in a thread at its next instruction.

    It is never taken back: CPython 3.11 would go on to look for it before every instruction, which
    takes a tenth longer, and without end where a tracer or a profiler is set.
    """
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(_Late))
