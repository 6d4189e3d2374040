"""Compiled kernels: numba modules `*_kernel.py`, whose machine code is kept between runs."""

import gc
import hashlib
import logging
import os
import re
import time
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget, Event, Watch

logger = logging.getLogger("gearopt.kernels")
COMPILING = "compiling, once for this version of gearopt"  # the part of events meanwhile
UNREADY = "stopped while kernels were compiled"
PATIENCE = (
    3.0  # s that a process runs kernels uncompiled; compiling those of layouts takes twice that
)
FRAME_WORDS = 70_000  # words of a frame: Python then takes 1 MB for it and all frames that it calls
CHECKSUM = 32  # bytes at the end of a file of machine code: SHA-256 of those before
_SOURCES = Path(__file__).parents[1]


@cache
def kernel(module: str) -> ModuleType:
    """Import a kernel module by its full name; its first use on a machine compiles it.

    numba would keep the code beside the source and look at that file alone, so that a change in a
    kernel that another one calls went unnoticed. Here the folder's name holds a hash of all kernels
    and numba's version. NUMBA_CACHE_DIR, where the user sets it, is the place of these folders.
    """
    import numba

    numba.config.CACHE_DIR = str(_folder() / _key())
    _announced()
    return import_module(module)


@cache
def _announced() -> None:
    """Have it said, once in a process, that kernels are compiled, should that become necessary."""
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc, unused-ignore]
        """Says so; an interface of numba."""

        said = False

        def on_start(self, found: Any) -> None:
            """Say so of the first function."""
            if not self.said:
                logger.info("%s: this takes some seconds", COMPILING)
            self.said = True

        def on_end(self, found: Any) -> None:
            """Do nothing."""

    event.register("numba:compile", Listener())


def compiled(work: Callable[[], Any], entries: tuple[Any, ...], watch: Watch | None = None) -> bool:
    """Call `work`, whose kernels are compiled on their first use; False if the watcher ended that.

    entries: the kernels that `work` calls. Before each function that is compiled the watcher is
    told how many were, of how many. What was compiled is kept.
    """
    from numba.core import event

    functions = set[Any]()
    for entry in entries:
        functions.update(_called(entry, functions))
    clock, begun = Clock(Budget(), watch), list[Any]()

    class Listener(event.Listener):  # type: ignore[misc, unused-ignore]
        """Tells of every function; an interface of numba."""

        def on_start(self, found: Any) -> None:
            """Tell of a function; raise where the watcher wants no more."""
            function = found.data["dispatcher"]
            if watch is None or function not in functions or function in begun:
                return
            begun.append(function)
            part = f"{COMPILING}: {len(begun)} of {len(functions)}"
            if watch(Event(clock.seconds, 0, part=part)) is False:
                raise _Ended

        def on_end(self, found: Any) -> None:
            """Do nothing."""

    try:
        with event.install_listener("numba:compile", Listener()):
            compiling(work)
    except _Ended:
        return False
    return True


def compiling(work: Callable[[], Any]) -> Any:
    """Result of `work`, which compiles kernels; it takes four fifths of the time so."""
    collects = gc.isenabled()
    gc.disable()  # what numba makes of a function is kept until it is compiled
    try:
        return _roomy(work)
    finally:
        if collects:
            gc.enable()


@dataclass
class Warm:
    """Kernels that run uncompiled for PATIENCE seconds, unless their machine code is at hand.

    Small problems are solved before a compiler would be through, and with the same numbers.
    seconds: CPU time spent so; it has state because it counts that, for all runs of a process.
    """

    seconds: float = 0.0

    def waits(self, entry: Any) -> bool:
        """Return whether a kernel is called uncompiled as yet."""
        return self.seconds < PATIENCE and not _kept(entry)

    def call(self, clock: Clock, entry: Any, *given: Any) -> Any:
        """Call a kernel; the time of compiling it is not the clock's. None if that was ended."""
        if self.waits(entry):
            begun, drawn = time.process_time(), np.random.get_state()  # noqa: NPY002
            try:
                with np.errstate(all="ignore"):  # as machine code does
                    return plain(entry)(*given)
            finally:  # a kernel seeds the generator that is the user's here
                np.random.set_state(drawn)  # noqa: NPY002
                self.seconds += time.process_time() - begun
        return compiling_aside(clock, entry, lambda: entry(*given))


def compiling_aside(clock: Clock, entry: Any, work: Callable[[], Any]) -> Any:
    """Result of `work`; the time of compiling the kernel it calls is not the clock's.

    None if the watcher ended that.
    """
    if _kept(entry):
        return work()
    begun, found = time.perf_counter(), list[Any]()
    clock.stopped = not compiled(lambda: found.append(work()), (entry,), clock.watch)
    clock.start += time.perf_counter() - begun
    return found[0] if found else None


warm = cache(Warm)


@cache
def plain(entry: Any) -> Callable[..., Any]:
    """Return a kernel as the Python it was written in, with all kernels that it calls."""
    copies = {
        one: FunctionType(one.py_func.__code__, dict(one.py_func.__globals__))
        for one in _called(entry, set())
    }
    for copy in copies.values():
        own, names = copy.__globals__, copy.__code__.co_names
        own |= {n: copies[own[n]] for n in names if hasattr(own.get(n), "py_func")}
    return copies[entry]


def _kept(entry: Any) -> bool:
    """Return whether the machine code of a kernel is at hand."""
    name = f"{entry.py_func.__module__.rsplit('.', 1)[-1]}.{entry.py_func.__name__}-*.nb[ci]"
    files = [] if entry.signatures else list((_folder() / _key()).rglob(name))
    return bool(entry.signatures or files) and all(map(sound, files))


def sound(path: str | Path) -> bool:
    """Return whether a file of machine code is there and ends with its checksum."""
    try:
        data = Path(path).read_bytes()
    except FileNotFoundError:
        return False
    except OSError as refused:
        say(f"kept machine code cannot be read ({path}: {refused.strerror})")
        return False
    if hashlib.sha256(data[:-CHECKSUM]).digest() == data[-CHECKSUM:]:
        return True
    say(f"kept machine code is damaged ({path}) and is compiled again")
    return False


@cache
def say(words: str) -> None:
    """Say something once in a process, on a terminal and elsewhere."""
    logger.warning(words)


class _Ended(Exception):
    """The watcher wants no more functions compiled."""


def _called(entry: Any, known: set[Any]) -> Iterator[Any]:
    """Yield a kernel function and all kernel functions that it calls, each once."""
    found, left = set(known), [entry]
    while left:
        one = left.pop()
        if one not in found:
            found.add(one)
            yield one
            names = map(one.py_func.__globals__.get, one.py_func.__code__.co_names)
            cells = (cell.cell_contents for cell in one.py_func.__closure__ or ())
            left += [other for other in (*names, *cells) if hasattr(other, "py_func")]


def _call(work: Callable[[], Any]) -> Any:
    return work()


# Python keeps frames in blocks of 16 KB, and asks the system for the next one whenever a call goes
# across the end of one: in a loop that costs more than the call. A compiler's deep recursion always
# has such loops. A frame that asks for much gets a block in which the others have room too.
_roomy = FunctionType(_call.__code__.replace(co_stacksize=FRAME_WORDS), globals())


@cache
def _folder() -> Path:
    from platformdirs import user_cache_path

    chosen = os.environ.get("NUMBA_CACHE_DIR")
    return Path(chosen) if chosen else user_cache_path("gearopt") / "numba"


@cache
def _key() -> str:
    """Return A name that changes with the text of any kernel and with numba's version.

    With that of the laws that kernels import, too.
    """
    text = hashlib.sha256(import_module("numba").__version__.encode())
    left, known = sorted(_SOURCES.rglob("*_kernel.py")), set[Path]()
    while left:
        path = left.pop(0)
        if path not in known and path.is_file():
            known.add(path)
            source = path.read_bytes()
            text.update(path.name.encode() + source)
            rooms = re.findall(rb"(?m)^from gearopt\.((?:form|phys)[\w.]*) import", source)
            left += [_SOURCES / (room.decode().replace(".", "/") + ".py") for room in rooms]
    return text.hexdigest()[:16]
