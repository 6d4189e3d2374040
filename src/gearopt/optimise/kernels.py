"""Compiled kernels: numba modules `*_kernel.py`, whose machine code is kept between runs."""

import gc
import hashlib
import logging
import os
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget, Event, Watch

logger = logging.getLogger("gearopt.kernels")
COMPILING = "compiling, once for this version of gearopt"  # the part of events meanwhile
UNREADY = "stopped while kernels were compiled"
ROOM = 70_000  # words of a frame: Python then takes 1 MB for it and all frames that it calls
_SOURCES = Path(__file__).parents[1]


@cache
def kernel(module: str) -> ModuleType:
    """Import a kernel module by its full name; its first use on a machine compiles it.

    numba would keep the code beside the source and look at that file alone, so that a change in a
    kernel that another one calls went unnoticed. Here the folder's name holds a hash of all kernels
    and numba's version. NUMBA_CACHE_DIR, where the user sets it, is the place of these folders.
    """
    import numba

    folder = _folder() / _key()
    numba.config.CACHE_DIR = str(folder)
    if not any(folder.rglob(f"{module.rsplit('.', 1)[-1]}.*.nbi")):
        logger.info("%s: this takes some seconds", COMPILING)
    return import_module(module)


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

    collects = gc.isenabled()
    gc.disable()  # what numba makes of a function is kept until it is compiled: a sixth of the time
    try:
        with event.install_listener("numba:compile", Listener()):
            _roomy(work)
    except _Ended:
        return False
    finally:
        if collects:
            gc.enable()
    return True


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
            left += [other for other in names if hasattr(other, "py_func")]


def _call(work: Callable[[], Any]) -> None:
    work()


# Python keeps frames in blocks of 16 KB, and asks the system for the next one whenever a call goes
# across the end of one: in a loop that costs more than the call. A compiler's deep recursion always
# has such loops. A frame that asks for much gets a block in which the others have room too.
_roomy = FunctionType(_call.__code__.replace(co_stacksize=ROOM), globals())


@cache
def _folder() -> Path:
    from platformdirs import user_cache_path

    chosen = os.environ.get("NUMBA_CACHE_DIR")
    return Path(chosen) if chosen else user_cache_path("gearopt") / "numba"


@cache
def _key() -> str:
    """Return A name that changes with the text of any kernel and with numba's version."""
    text = hashlib.sha256(version("numba").encode())
    for path in sorted(_SOURCES.rglob("*_kernel.py")):
        text.update(path.name.encode() + path.read_bytes())
    return text.hexdigest()[:16]
