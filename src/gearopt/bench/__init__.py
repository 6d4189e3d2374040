"""Speed against error: each module is a bench, `run(repeat) -> rows`; `gearopt bench NAME`."""

import statistics
from collections.abc import Callable
from pkgutil import iter_modules
from typing import TypeVar

from gearopt.optimise.clock import Clock

T = TypeVar("T")


def names() -> tuple[str, ...]:
    """Return names of the benches: the modules of this folder, not its folders of cases."""
    return tuple(sorted(m.name for m in iter_modules(__path__) if not m.ispkg))


def timed(call: Callable[[], T], repeat: int) -> tuple[T, dict[str, float]]:
    """Return the last result and the times [ms] of so many calls, without the first."""
    times = []
    for _ in range(repeat + 1):
        clock = Clock()
        result = call()
        times.append(1000.0 * clock.seconds)
    times = times[1:]
    milliseconds = {
        "median_ms": statistics.median(times),
        "least_ms": min(times),
        "most_ms": max(times),
    }
    return result, {name: round(ms, 2) for name, ms in milliseconds.items()}
