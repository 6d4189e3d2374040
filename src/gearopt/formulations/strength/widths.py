"""The narrowest face width that carries, proven: no width below it does.

What of the load capacity is used may rise with the width, and jump. It is followed from the
narrowest width on: as long as the lower bound of a step is above 1, no width in it carries. Of
several standards each goes on from where the others carry, so that it rates what they left. Arrays
and kernels take the same steps.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import field
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from gearopt.formulations.strength import ALLOWANCE
from gearopt.formulations.strength.standard import REFUSED, Rows
from gearopt.frozen import dataclass
from gearopt.optimise import kernels
from gearopt.optimise.result import Event
from gearopt.optimise.terms import Array
from gearopt.physics.choosing import choose

PAST_BORDER = 1.0 + 1e-12  # a border is passed by this factor
ROUNDING = 1e-13  # of a bound
MAX_STEPS = 2000  # of a row; a bound of 1 is reached in some tens
SHY = 0.97  # of a step that would lead to a bound of 1
LARGEST_POWER = 4.0  # power of what is used, of a step
SHORT = 1e-14  # relative length of a step that ends a row
KERNEL = "gearopt.formulations.strength.use.rating_kernel"
FEW = 30_000  # rows of a process that arrays are quick enough for
LOADING = 1.0  # s that loading kernels may take

Index = Any


@dataclass
class Compiled:
    """Whether kernels are used as yet; it has state as it counts the rows of a process."""

    rows: int = 0
    kernel: ModuleType | None = None

    def of(self, name: str, count: int, left: Callable[[], float]) -> Any:
        """Kernel for so many rows more; None: it is not compiled, or arrays are as quick.

        left: the seconds left.
        """
        self.rows += count
        if self.kernel is None and self.rows > FEW and left() > LOADING:
            self.kernel = kernels.kernel(KERNEL)
        entry = getattr(self.kernel, name, None)
        return None if entry is None or kernels.warm().waits(entry) else entry


compiled = cache(Compiled)


@dataclass
class Standing:
    """Rows by several standards, each made for those that the ones before it left.

    makers: rows of places, which increase. It has state as it keeps the rows that were made.
    """

    makers: Sequence[Callable[[Index], Rows]]
    tick: Callable[[], float] = lambda: math.inf
    kept: list[tuple[Index, Rows]] = field(default_factory=list)

    def first_width(
        self, place: Index, low: Array, high: Array, close: float, steps: int = MAX_STEPS
    ) -> Array:
        """`first_width` of the rows at places, which are among those of the first call."""
        first, here = np.full(len(low), np.inf), np.array(low, float)
        moved = np.flatnonzero(here <= high * (1.0 + ALLOWANCE))
        while len(moved):
            before = here.copy()
            for k in range(len(self.makers)):
                rows = self._rows(k, place[moved])
                widths = first_width(rows, here[moved], high[moved], close, steps, self.tick)
                here[moved] = widths
                moved = moved[np.isfinite(widths)]
            if steps != MAX_STEPS or len(self.makers) == 1:  # steps: lower bounds
                first[moved] = here[moved]
                break
            still = here[moved] > before[moved]
            first[moved[~still]] = here[moved[~still]]
            moved = moved[still]
        return first

    def _rows(self, k: int, place: Index) -> Rows:
        if k == len(self.kept):
            self.kept.append((place, self.makers[k](place)))
        places, rows = self.kept[k]
        return rows if len(places) == len(place) else rows.take(np.searchsorted(places, place))


def first_width(
    rows: Rows,
    low: Array,
    high: Array,
    close: float = ALLOWANCE,
    steps: int = MAX_STEPS,
    tick: Callable[[], float] = lambda: math.inf,
) -> Array:
    """Return the first face width [mm] (n,) from low to high that carries; inf: none.

    A lower bound of it where close, what may be used above 1, is more than rounding, or after so
    many steps. tick: the seconds left, called before kernels are loaded and before every function
    that is compiled; what it raises ends that.
    """
    posed = rows.posed
    kernel = None if posed is None else compiled().of(posed[0], len(low), tick)
    if posed is None or kernel is None:
        begun = time.process_time()
        first = _first_width_numpy(rows, low, high, close, steps)
        kernels.warm().seconds += (time.process_time() - begun) * (posed is not None)
    elif kernel.signatures:
        first = kernel(*posed[1], low, high, close, steps)
    else:
        results: list[Array] = []

        def goes_on(event: Event) -> bool:
            tick()
            return True

        def work() -> None:
            results.append(kernel(*posed[1], low, high, close, steps))

        kernels.compiled(work, (kernel,), goes_on)
        (first,) = results
    if steps == MAX_STEPS and np.isnan(first).any():
        raise ArithmeticError(f"no narrowest face width was found in {MAX_STEPS} steps")
    return np.asarray(first)


def _first_width_numpy(rows: Rows, low: Array, high: Array, close: float, steps: int) -> Array:
    """First widths; NaN where so many steps are too few, of MAX_STEPS."""
    first, here, top = np.full(len(low), np.inf), np.array(low, float), np.asarray(high, float)
    active = np.flatnonzero(here <= top * (1.0 + ALLOWANCE))
    rows = rows.take(active)
    here, top, power = here[active], top[active], np.ones(len(active))
    for _ in range(steps):
        if not len(active):
            break
        now = _utilisation(rows, here, here)
        carries = now <= 1.0 + close
        first[active[carries]] = here[carries]
        goes = ~carries & (here < top)
        if not goes.all():
            active, rows = active[goes], rows.take(goes)
            here, top, power, now = here[goes], top[goes], power[goes], now[goes]
        border = rows.border(here)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            there = tried(here, np.minimum(top, border), now, power)
            bound = _utilisation(rows, here, there)
            here, power = stepped(here, there, now, bound, border)
    first[active] = np.nan if steps == MAX_STEPS else here  # what is left is bounded from below
    return first


def _utilisation(rows: Rows, low: Array, high: Array) -> Array:
    """Return `used` of rows between widths [mm]; inf where it is no number (NaN)."""
    part = rows.used(low, high)
    return np.asarray(np.where(np.isnan(part), np.inf, part))


def tried(here: Any, end: Any, now: Any, power: Any) -> Any:
    """Return the width to try from one at which so much is used, up to an end."""
    return np.minimum(here * np.minimum(now, REFUSED) ** power, end)


def stepped(here: Any, there: Any, now: Any, bound: Any, border: Any) -> tuple[Any, Any]:
    """Return the width after a step, and the power of what is used that the next one tries.

    A power is that at which the bound, falling as it did in this step, would be near 1.
    """
    now = np.maximum(np.minimum(now, REFUSED), PAST_BORDER)
    falls = np.log(now / np.minimum(bound, REFUSED)) / np.log(there / here)
    at_border = here >= border
    goes = (bound >= 1.0 - ROUNDING) | at_border | (there <= here * (1.0 + SHORT))
    falls = choose(np.logical_not(goes) & (now == REFUSED), 2.0 * falls, falls)
    here = choose(goes, choose(at_border, border * PAST_BORDER, there), here)
    return here, choose(np.isfinite(falls), SHY / np.maximum(falls, SHY / LARGEST_POWER), 1.0)
